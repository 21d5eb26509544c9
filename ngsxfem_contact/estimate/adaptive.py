"""Solve, estimate, refine, until the error is below a tolerance: section 18 of docs/method.md."""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
from netgen.meshing import NgException
from ngsolve import Mesh

from ..algebra.matrices import mask
from ..arguments import check_number, check_positive, check_type, check_whole
from ..description import Described
from ..errors import AccuracyWarning, SolveError, TooCoarse, warn
from ..fracture.tip_integral import elements_within
from ..processes import Processes
from ..spaces.resolution import coarse_elements
from ..tables import Table
from .norm_estimate import is_norm

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from ..contact.problem import ContactProblem
    from ..contact.solution import ContactSolution
    from ..description import Lines
    from ..protocols import Goal, Norm
    from .error_estimate import ErrorEstimate
    from .goal_estimate import GoalEstimate
    from .norm_estimate import NormEstimate

logger = logging.getLogger(__name__)

TOO_COARSE = "too coarse for the cracks"
REFUSALS = 4  # levels that are refined everywhere because the mesh was refused
FALLS = 6  # levels after which the error must be less than before


@dataclass
class Level:
    """A row of the table.

    Attributes
    ----------
    level, triangles, unknowns
        The mesh and the displacements on it.
    value, error, bar
        Of the goal, see GoalEstimate and NormEstimate; nan where there is none.
    energy
        The error in the energy norm, relative.
    relative
        What is compared with the tolerance.
    seconds
        Of make_problem, solve and estimate.
    state
        What was done next.
    """

    level: int
    triangles: int
    unknowns: int
    value: float = float("nan")
    error: float = float("nan")
    bar: float = float("nan")
    energy: float = float("nan")
    relative: float = float("nan")
    seconds: float = 0.0
    state: str = ""


@dataclass(eq=False, repr=False)
class AdaptiveSolution(Described):
    """What SolveAdaptive found.

    Parameters
    ----------
    solution
        The ContactSolution on the last mesh.
    estimate
        Its ErrorEstimate.
    quantity
        The GoalEstimate or NormEstimate of the goal, or None without one.
    reached
        Whether the error is below the tolerance.
    reason
        Why it ended, a sentence.
    levels
        A Level for each mesh.
    """

    solution: ContactSolution
    estimate: ErrorEstimate
    quantity: GoalEstimate | NormEstimate | None
    reached: bool
    reason: str
    levels: list[Level] = field(repr=False)

    @property
    def table(self) -> Table:
        """The levels, a Table."""
        return Table.OfRows(map(vars, self.levels), Level.__dataclass_fields__)

    def Description(self) -> Lines:
        """Why it ended, and what was found."""
        return [("ended", self.reason), ("levels", str(len(self.levels))), *(self.estimate if self.quantity is None else self.quantity).Description()]

    def Plot(self, path: str | Path) -> Path:
        """Draws the errors of the levels, and the last mesh with the error of each triangle, into a file (needs matplotlib); returns the path.

        Parameters
        ----------
        path
            Of the picture; the ending says of which kind.
        """
        from ..plotting.refinement import plot_refinement

        return plot_refinement(self, path)


def SolveAdaptive(
    make_problem: Callable[[Mesh], ContactProblem],
    mesh: Mesh,
    goal: Goal | Norm | None = None,
    tolerance: float = 0.01,
    max_unknowns: int = 200_000,
    max_levels: int = 40,
    fraction: float = 0.5,
    scale: float | None = None,
) -> AdaptiveSolution:
    """Solves, estimates, and refines the mesh where the error is, until it is below a tolerance: an AdaptiveSolution.

    Parameters
    ----------
    make_problem
        Function of a mesh that returns the ContactProblem on it, body, spaces, loads and supports included; it is called on each mesh.
    mesh : Mesh
        The first one. A copy of it is refined.
    goal
        What must be right: a quantity such as StressIntensityFactor("K_I"), an object with the role Goal, or a norm such as ContactPressure(), one with the role
        Norm; default the energy norm.
    tolerance
        Of the bar of the goal over |value|, or of the error in the energy norm over that of u_h; 0.01 is one percent.
    max_unknowns, max_levels
        Where it ends without the tolerance, with an AccuracyWarning.
    fraction
        The triangles with the largest errors are refined that have so much of the sum of all, of squares for the energy norm (Dörfler).
    scale
        What the tolerance of a goal is relative to, in place of |value|, for values that may be zero.

    Returns
    -------
    AdaptiveSolution
        With the last solution, its estimate, and a row for each mesh.

    Raises
    ------
    TypeError, ValueError
        For arguments that cannot be meant.
    SolveError
        As the solves.
    NotImplementedError
        With several processes.

    Warns
    -----
    AccuracyWarning
        Where the tolerance was not reached.

    Notes
    -----
    Cracks stay as they are, and what touches on a mesh is what the solve on the next one begins with. Where a mesh is too coarse for them, or refused, it is refined around them (or everywhere) before anything is solved, so that it may begin with a crack
    that is shorter than a triangle. NGSolve bisects, and curves the mesh as it was.
    """
    return Refinement(make_problem, mesh, goal, tolerance, max_unknowns, max_levels, fraction, scale).Run()


@dataclass
class Refinement:
    """The loop of SolveAdaptive; its fields are the arguments."""

    make_problem: Callable[[Mesh], ContactProblem]
    first: Mesh
    goal: Goal | Norm | None
    tolerance: float
    max_unknowns: int
    max_levels: int
    fraction: float
    scale: float | None

    def __post_init__(self) -> None:
        check_type(self.first, Mesh, "SolveAdaptive: mesh", "an NGSolve Mesh")
        Processes.Of(self.first, "SolveAdaptive").Refuse("SolveAdaptive")
        if self.first.dim != 2:
            raise ValueError("SolveAdaptive: the mesh is not plane, and there is no estimate of errors in space yet; compare two meshes, or orders 1 and 2")
        if not callable(self.make_problem):
            raise TypeError(f"SolveAdaptive: make_problem={self.make_problem!r} is not a function of a mesh that returns a ContactProblem")
        if self.goal is not None:
            is_norm(self.goal, "SolveAdaptive: goal")
        check_positive(self.tolerance, "SolveAdaptive: tolerance")
        check_whole(self.max_unknowns, "SolveAdaptive: max_unknowns", 1)
        check_whole(self.max_levels, "SolveAdaptive: max_levels", 1)
        check_number(self.fraction, "SolveAdaptive: fraction", lambda fraction: 0 < fraction <= 1, "lie in (0, 1]")
        if self.scale is not None:
            check_positive(self.scale, "SolveAdaptive: scale")
        self.order = self.first.GetCurveOrder()
        self.mesh = Mesh(self.first.ngmesh.Copy())
        self.levels: list[Level] = []
        self.found: tuple[ContactSolution, ErrorEstimate, GoalEstimate | NormEstimate | None] | None = None

    def Run(self) -> AdaptiveSolution:
        """Level by level."""
        self._curve()
        while True:
            start = perf_counter()
            marks, row = self._level()
            row.seconds = perf_counter() - start
            self.levels.append(row)
            logger.info("refinement, level %d: %d unknowns, error %.3g", row.level, row.unknowns, row.relative)
            reason = self._end(row)
            if reason and self.found is not None:
                return self._ended(reason)
            if reason:
                raise SolveError(f"SolveAdaptive: {reason} before the mesh was fine enough for a first solution: {row.state}")
            self._refine(marks)

    def _end(self, row: Level) -> str:
        """Why to stop, or nothing."""
        if row.relative <= self.tolerance:
            return "the tolerance is reached"
        if row.unknowns > self.max_unknowns:
            return f"max_unknowns={self.max_unknowns} is reached"
        if len(self.levels) >= self.max_levels:
            return f"max_levels={self.max_levels} is reached"
        errors = [level.relative for level in self.levels if level.relative == level.relative]
        if len(errors) > 2 * FALLS and min(errors[-FALLS:]) > 0.9 * min(errors[:-FALLS]):
            return f"the error has not fallen in the last {FALLS} levels"
        return ""

    def _ended(self, reason: str) -> AdaptiveSolution:
        assert self.found is not None
        solution, estimate, quantity = self.found
        last = next(level.relative for level in reversed(self.levels) if level.relative == level.relative)
        reached = last <= self.tolerance
        if not reached:
            reason = f"{reason}; the error is {last:.2g}, the tolerance {self.tolerance:g}"
            warn(f"SolveAdaptive: {reason}: allow more, or ask for less")
        return AdaptiveSolution(solution, estimate, quantity, reached, reason, self.levels)

    def _level(self) -> tuple[np.ndarray, Level]:
        """(what to refine, boolean; the row) of a mesh."""
        row = Level(len(self.levels), self.mesh.ne, 0)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", AccuracyWarning)  # of what is refined next
                problem = self.make_problem(self.mesh)
        except (NgException, ValueError) as refusal:  # an end that the mesh does not separate from the boundary, a disk without room
            if self.found is not None or row.level >= min(REFUSALS, self.max_levels - 1):
                raise
            row.state = f"refined everywhere: {refusal}"
            return np.ones(self.mesh.ne, dtype=bool), row
        if not hasattr(problem, "Solve"):
            raise TypeError(f"SolveAdaptive: make_problem returned {problem!r}; it must return a ContactProblem")
        row.unknowns = int(problem.V.ndof)
        coarse = coarse_elements(problem.V)
        if len(coarse):
            row.state = f"refined around the cracks: {TOO_COARSE}"
            return np.isin(np.arange(self.mesh.ne), coarse), row
        return self._solved(problem, row)

    def _solved(self, problem: ContactProblem, row: Level) -> tuple[np.ndarray, Level]:
        solution = problem.Solve(start=None if self.found is None else self.found[0])
        estimate = solution.ErrorEstimate()
        row.energy = row.relative = estimate.relative
        indicators, quantity = estimate.squares, None
        if self.goal is not None:
            try:
                quantity = estimate.Goal(self.goal)
            except TooCoarse as refusal:
                row.relative, row.state = float("nan"), f"refined: {refusal}"
                return mask(elements_within(self.mesh, refusal.point, refusal.radius)), row
            row.value, row.error, row.bar = quantity.value, getattr(quantity, "error", row.error), quantity.bar
            row.relative = quantity.bar / (self.scale or max(abs(quantity.value), np.finfo(float).tiny))
            indicators = quantity.elements
        self.found = solution, estimate, quantity
        marks = worst(indicators, self.fraction)
        row.state = f"{int(marks.sum())} triangles refined"
        return marks, row

    def _refine(self, marks: np.ndarray) -> None:
        self.mesh.SetRefinementFlags(marks.tolist())
        self.mesh.Refine()
        self._curve()

    def _curve(self) -> None:
        if self.order > 1:
            self.mesh.Curve(self.order)


def worst(indicators: np.ndarray, fraction: float) -> np.ndarray:
    """Boolean: the smallest set with at least a fraction of the sum."""
    order = np.argsort(-indicators, kind="stable")
    number = np.searchsorted(np.cumsum(indicators[order]), fraction * indicators.sum() * (1 - 1e-12)) + 1
    marks = np.zeros(len(indicators), dtype=bool)
    marks[order[:number]] = True
    return marks
