"""What a solve did: counts, times and residuals."""

from __future__ import annotations

import logging
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import isnan
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ..algebra.nodal_newton import SLIP_MINUS, SLIP_PLUS, STICK
from .faces import FaceWork

if TYPE_CHECKING:
    from collections.abc import Iterator

logger = logging.getLogger(__name__)


@dataclass(repr=False)
class Report:
    """What a solve did.

    Attributes
    ----------
    inverse
        The solver, as in Solve(inverse=...).
    choice
        Why this one, where nobody asked for it.
    linear_iterations
        Of conjugate gradients: in space for each matrix, one in each iteration of the active set, in the plane for the load and for each round with other pressures; empty for direct solvers.
    active
        The active set of each iteration, the first is where it started.
    coarse_iterations
        On the coarser problems that gave the first set.
    fallback
        Steps of descent after a cycle.
    converged
        Whether residual and complementarity are small; None until they are measured.
    residual
        Of the first row of (38), relative.
    complementarity
        Relative violation of the signs. Both are measured when u is recovered and NaN before (LoadSteps).
    timings
        Seconds.
    notes
        Of the body, on ends of cracks that it moved.
    projection
        The degree of the polynomials onto which div u is projected where the material is nearly incompressible; None: nowhere.
    method
        In words.
    threshold_changes
        Relative, of each step of a fixed point on the threshold.
    uniqueness
        Below 1 it proves that the law has one solution (0: convex problem, None: not known).
    tangential
        With friction the states of the nodes in each iteration, codes of `nodal_newton`.
    slipping
        In space, with friction: which nodes slip at the end; None otherwise.
    states
        The fraction of the nodes in each state, by its name, where a law has states of its own.
    work
        Of the faces in this step, a FaceWork.
    unknowns
        Of the displacement and of the multiplier.
    iterations
        Of the active set.
    """

    unknowns: tuple[int, int]
    inverse: str = ""
    timings: dict[str, float] = field(default_factory=dict)
    converged: bool | None = None
    iterations: int = 0
    active: list[Any] = field(default_factory=list)
    coarse_iterations: int = 0
    fallback: int = 0
    residual: float = float("nan")
    complementarity: float = float("nan")
    tangential: list[Any] = field(default_factory=list)
    slipping: Any = None
    method: str = "active set"
    threshold_changes: list[float] = field(default_factory=list)
    uniqueness: float | None = None
    notes: list[str] = field(default_factory=list)
    projection: int | None = None
    states: dict[str, float] = field(default_factory=dict)
    work: FaceWork = FaceWork()
    choice: str = ""
    linear_iterations: list[int] = field(default_factory=list)

    def Counts(self) -> dict[str, int]:
        """Nodes in contact and, with friction, nodes that stick and slip either way, at the end."""
        counts = {"contact": int(self.active[-1].sum())}
        if self.tangential:
            counts |= {name: int((self.tangential[-1] == code).sum()) for name, code in (("stick", STICK), ("slip+", SLIP_PLUS), ("slip-", SLIP_MINUS))}
        return counts

    def _solver_line(self) -> str:
        why = f" ({self.choice})" if self.choice else ""
        if not self.linear_iterations:
            return f"direct solver    {self.inverse}{why}"
        return f"solver           {self.inverse}{why}: {sum(self.linear_iterations)} conjugate gradients, {' '.join(map(str, self.linear_iterations))}"

    def _projection_lines(self) -> list[str]:
        if self.projection is None:
            return []
        return [f"divergence       projected onto P{self.projection} of each part where the material is nearly incompressible"]

    def _friction_lines(self) -> list[str]:
        if not self.tangential:
            return []
        lines = ["states           " + ", ".join(f"{number} {name}" for name, number in self.Counts().items()), f"method           {self.method}"]
        if len(self.threshold_changes) > 1:
            changes = self.threshold_changes
            lines.append(f"threshold        last changes {' '.join(f'{change:.1e}' for change in changes[-3:])}, factor {contraction(changes):.2g}")
        if self.uniqueness is None:
            return [*lines, "uniqueness       not known"]
        return [*lines, f"uniqueness       {'proved' if self.uniqueness < 1 else 'not proved'} (number {self.uniqueness:.2g}, below 1 is sufficient)"]

    def _law_lines(self) -> list[str]:
        if not self.states:
            return []
        return [
            "faces            " + ", ".join(f"{100 * fraction:.3g} % {name}" for name, fraction in self.states.items()),
            f"method           {self.method}",
            f"energy           {self.work.dissipated:.4g} dissipated in this step, {self.work.stored:.4g} stored in the faces",
        ]

    def __str__(self) -> str:
        sizes = " ".join(str(int(a.sum())) for a in self.active)
        times = "  ".join(f"{name} {seconds:.3f}" for name, seconds in self.timings.items())
        measured = lambda value: "measured when solution.u is first used" if isnan(value) else f"{value:.1e}"
        return "\n".join(
            [
                f"unknowns         {self.unknowns[0]} displacement, {self.unknowns[1]} multiplier",
                self._solver_line(),
                f"converged        {'not checked yet' if self.converged is None else self.converged} after {self.iterations} {'Newton' if self.states else 'active-set'} iterations ({self.coarse_iterations} on coarser sets before)",
                f"in contact       {sizes}" + (f"  (+ {self.fallback} safeguarded steps)" if self.fallback else ""),
                *self._projection_lines(),
                *self._friction_lines(),
                *self._law_lines(),
                f"residual         {measured(self.residual)}",
                f"complementarity  {measured(self.complementarity)}",
                f"seconds          {sum(self.timings.values()):.3f}: {times}",
                *(f"note             {note}" for note in self.notes),
            ]
        )

    __repr__ = __str__  # what a notebook shows


def contraction(changes: list[float]) -> float:
    """The mean factor from one change to the next over the last three that are above round-off."""
    above = [change for change in changes if change > 1e-13][-4:]
    return (above[-1] / above[0]) ** (1 / (len(above) - 1)) if len(above) > 1 else 0.0


@contextmanager
def stage(timings: dict[str, float], name: str, what: str) -> Iterator[None]:
    """Books the seconds of a block in `timings`; what: logged where it begins, and with its seconds where it ends."""
    logger.info(what)
    start = perf_counter()
    yield
    timings[name] = perf_counter() - start
    logger.debug("%s: %.3f s", what, timings[name])
