"""How laws with friction are solved: Newton's method of `nodal_newton`, and what takes over where it cycles."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from ..arguments import check_positive, check_whole
from ..errors import NotConverged
from .box_path import AT_LOWER, AT_UPPER, INSIDE, follow_path
from .compliance import Compliance
from .face_newton import FaceProblem, Stuck, shortened
from .face_newton import newton as face_newton
from .face_relations import rigid
from .nodal_newton import FREE, SLIP_MINUS, SLIP_PLUS, STICK, Cycle, NodalResult, States, Threshold, newton, next_states, solve_states


def safeguarded(Q: Compliance, q: np.ndarray, s: np.ndarray, states: States) -> NodalResult:
    """For given thresholds: the path from given states (box_path), p_n ≤ 0 and |p_t| ≤ s being its bounds; a NodalResult."""
    m, tangential = len(s), states.tangential
    lower, upper = np.concatenate([np.full(m, -np.inf), -s]), np.concatenate([np.zeros(m), s])
    contact = np.where(states.contact, INSIDE, AT_UPPER)
    start = np.concatenate([contact, np.where(tangential == STICK, INSIDE, np.where(tangential == SLIP_MINUS, AT_LOWER, AT_UPPER))])
    p, found, changes = follow_path(Q.matrix, q, lower, upper, start)
    slips = np.where(found[m:] == INSIDE, STICK, np.where(found[m:] == AT_UPPER, SLIP_PLUS, SLIP_MINUS))
    return NodalResult(p, [States(found[:m] == INSIDE, np.where(s > 0, slips, FREE))], changes)


def fixed_threshold(Q: Compliance, q: np.ndarray, s: np.ndarray, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
    """The problem with given thresholds: Newton's method, and where it cycles a path."""
    threshold = Threshold(s, np.zeros(len(s)))
    try:
        return newton(Q, q, threshold, r, start, max_iterations)
    except Cycle as cycle:
        result = safeguarded(Q, q, s, cycle.states[-1])
        return replace(result, states=cycle.states + result.states)


class NodalMethod(ABC):
    """How a law with friction finds p = (p_n, p_t) at m nodes from w = Q p + q."""

    @abstractmethod
    def Solve(self, Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
        """A NodalResult.

        Parameters
        ----------
        Q : Compliance
            Of 2 m components, in any scaling.
        q : (2 m,) array
            At the nodes, normal parts first.
        threshold : Threshold
            s at the nodes.
        r : (2 m,) array
            Of the projection, > 0.
        start : States
            The nodes in contact, and how they slip, at first.
        max_iterations : int
            Newton steps for each set of states.

        Raises
        ------
        NotConverged
        """


@dataclass(frozen=True)
class FixedPoint(NodalMethod):
    """Coulomb's law as a sequence of given thresholds: s ← s(p_n), each a problem with one solution.

    Parameters
    ----------
    tolerance
        Of the change of s, relative to the largest.
    max_iterations
        Number of thresholds.
    """

    tolerance: float = 1e-12
    max_iterations: int = 200

    def __post_init__(self) -> None:
        check_positive(self.tolerance, "FixedPoint: tolerance")
        check_whole(self.max_iterations, "FixedPoint: max_iterations", 1)

    def Solve(self, Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
        """A NodalResult; raises NotConverged where the thresholds do not settle."""
        m = len(start.contact)
        s, result, changes = threshold.At(np.zeros(m), start.contact), None, []
        history, fallback = [], 0
        for _ in range(self.max_iterations):
            result = fixed_threshold(Q, q, s, r, start, max_iterations)
            start, history, fallback = result.states[-1], history + result.states, fallback + result.fallback
            new = threshold.At(result.p[:m], start.contact)
            changes.append(float(np.abs(new - s).max() / max(np.abs(new).max(), np.finfo(float).tiny)))
            s = new
            if self._settled(changes):
                return self._finished(Q, q, threshold, r, NodalResult(result.p, history, fallback, threshold_changes=changes))
        raise NotConverged(
            f"the fixed point on the threshold still changed it, relatively by {' '.join(f'{change:.1e}' for change in changes[-3:])} in the last of "
            f"{len(changes)} steps: if that does not contract, the friction law may have no or several solutions for this friction coefficient "
            "and mesh; if it does, allow more by FixedPoint(max_iterations=...)"
        )

    def _settled(self, changes: list[float], round_off: float = 1e-9) -> bool:
        """Whether the last change is within the tolerance, or small and no longer falling: the round-off of an ill-conditioned Q is all that is left."""
        return changes[-1] <= self.tolerance or (len(changes) > 5 and round_off > changes[-1] > 0.5 * changes[-6])

    def _finished(self, Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, result: NodalResult) -> NodalResult:
        """With one Newton step from the states found, if it confirms them: p then satisfies the law to round-off."""
        last = result.states[-1]
        states = States(last.contact, np.where(threshold.At(result.p[: len(last.contact)], last.contact) > 0, last.tangential, FREE))
        try:
            result.p = newton(Q, q, threshold, r, states, 1).p
        except (Cycle, NotConverged):
            pass
        result.method = f"fixed point on the threshold ({len(result.threshold_changes)} steps)"
        return result


@dataclass(frozen=True)
class DampedNewton(NodalMethod):
    """Newton's method for trial tractions, as for other laws of the faces (`face_newton`): parts of its steps make the residual fall, and no state has to settle."""

    def Solve(self, Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
        """A NodalResult; raises NotConverged."""
        m = len(start.contact)
        problem = FaceProblem(Q, q, np.ones(m), rigid(threshold), 1 / Q.diagonal.reshape(2, m))
        p, w = solve_states(Q, q, threshold, start)
        try:
            z, steps = face_newton(problem, problem.With(p.reshape(2, m), -w.reshape(2, m)), max_iterations, shortened)
            states = next_states(problem.Traction(z).ravel(), -problem.Jump(z).ravel(), r, threshold, start)
            result = newton(Q, q, threshold, r, states, 5)  # which makes values exact that are known
        except (Stuck, Cycle, np.linalg.LinAlgError) as failure:
            raise NotConverged(f"damped Newton: {failure}") from None
        return replace(result, method=f"damped Newton ({steps} steps)")


@dataclass(frozen=True)
class FullNewton(NodalMethod):
    """Newton's method on the whole problem, the threshold's dependence on p_n in its matrix; if it cycles, safeguards.

    Where s is given that is `box_path.follow_path`.

    Parameters
    ----------
    safeguards : sequence of NodalMethod
        What takes over, one after the other, where s depends on p_n.
    """

    safeguards: tuple[NodalMethod, ...] = (DampedNewton(), FixedPoint())

    def Solve(self, Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
        """A NodalResult; raises NotConverged."""
        if threshold.is_fixed:
            result = fixed_threshold(Q, q, threshold.base, r, start, max_iterations)
            return replace(result, method="semi-smooth Newton")
        try:
            return replace(newton(Q, q, threshold, r, start, max_iterations), method="full semi-smooth Newton")
        except Cycle as cycle:
            result = self._safeguarded(Q, q, threshold, r, cycle.states[-1], max_iterations)
            return replace(result, states=cycle.states + result.states, method=f"full Newton until {cycle}, then {result.method}")

    def _safeguarded(self, Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
        """By the first safeguard that ends."""
        for number, method in enumerate(self.safeguards, 1):
            try:
                return method.Solve(Q, q, threshold, r, start, max_iterations)
            except NotConverged:
                if number == len(self.safeguards):
                    raise
        raise NotConverged("Newton's method cycles, and there is no safeguard")
