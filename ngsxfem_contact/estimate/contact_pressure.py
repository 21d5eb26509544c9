"""How far the contact pressure is off in L²(Γ_C), and where: section 17 of docs/method.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CF, GridFunction, IfPos, Integrate

from ..algebra.matrices import mask
from ..arguments import crack_number
from ..fracture.tip_integral import elements_within
from ..operators import NORMAL, NormalGap
from ..points import crack_points
from ..spaces.trace_space import TraceSpace
from .contact_defect import stiffness_of_plane
from .goals import moments

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction

    from ..contact.solution import ContactSolution
    from .error_estimate import ErrorEstimate

NEAR = 0.25  # of the radius r1 of a tip's functions
TOUCHING = 1e-10  # of the largest pressure: what counts as contact


@dataclass(frozen=True)
class ContactPressure:
    """The error of λ in L² of a crack, or of all.

    Parameters
    ----------
    crack : int, str or None
        Number or name; None: all cracks.

    Notes
    -----
    Of λ alone, with friction, too. At closed tips, where λ is smooth, it is two to five times too large (docs/measured.md).
    """

    crack: int | str | None = None

    def __str__(self) -> str:
        return "contact pressure" if self.crack is None else f"contact pressure on crack {self.crack}"

    def Value(self, solution: ContactSolution) -> float:
        """‖λ_h‖, stress × √length."""
        return float(np.sqrt(self._square(solution, solution.multiplier)))

    def Squares(self, estimate: ErrorEstimate) -> np.ndarray:
        """(number of triangles,): ∫(λ_h - min(0, σ_n(u_h) + k (g_n + g_0)))² over the crack in each and what λ_h lacks where contact ends; and of what e changes of λ_h its share of
        the error in the energy norm.

        Raises
        ------
        ValueError
            For laws of the faces that hold node by node, and parts that only the faces hold.
        """
        solution = estimate.solution
        pulled = solution.Traction(NORMAL, "larger") + stiffness_of_plane(solution) * (NormalGap(solution.u, solution.body) + solution.problem.gap)
        distance = solution.multiplier - IfPos(pulled, 0, pulled)
        of_faces = estimate.OfCracks(distance * distance + at_edges(solution), self._number(solution))
        change = self._square(solution, self._change(estimate))
        return over_disks(of_faces + shares(estimate.squares, change), estimate)

    def _change(self, estimate: ErrorEstimate) -> CoefficientFunction:
        """What the gaps of e change of λ_h, with the states that were found."""
        solution, space = estimate.solution, estimate.next_order.space
        gaps = [moments(solution, component.jump(estimate.e, solution.body), space=space) for component in solution.problem.law.components]
        return solution.reduced.Response(solution, gaps)[0]

    def _square(self, solution: ContactSolution, function: CoefficientFunction) -> float:
        measure = solution.problem.W.dcrack(crack=self._number(solution), bonus_intorder=2)
        return Integrate(function * function * measure, solution.body.mesh)

    def _number(self, solution: ContactSolution) -> int | None:
        return None if self.crack is None else crack_number(self.crack, solution.body)


def at_edges(solution: ContactSolution) -> CoefficientFunction:
    """a²/30 on each interval on which λ_h falls from a to 0, where λ may fall like a square root: ∫₀¹ (√τ - τ)² dτ = 1/30. 0 for constant multipliers, whose steps are seen."""
    W, body = solution.problem.W, solution.body
    if W.order == 0:
        return CF(0)
    constants = TraceSpace(body, order=0, nodes=W.basis.division)
    density, nodes, least = GridFunction(constants), constants.nodes, TOUCHING * np.abs(solution.multiplier.vec.FV().NumPy()).max(initial=0)
    for crack, ends in enumerate(W.basis.division):
        values = np.abs(np.ravel(solution.multiplier(crack_points(body, crack, ends))))
        falls = np.diff(values > least) != 0
        squares = np.where(falls, np.maximum(values[:-1], values[1:]) ** 2 / 30, 0)
        mine = nodes.cracks == crack
        density.vec.FV().NumPy()[mine] = squares[np.searchsorted(ends, nodes.arclengths[mine]) - 1]
    return density


def over_disks(squares: np.ndarray, estimate: ErrorEstimate) -> np.ndarray:
    """With what is near a tip with functions spread over their disk, as the error in the energy norm is: there λ is off by their coefficients, which are decided where χ falls."""
    solution, squares = estimate.solution, squares.copy()
    for tip, spec in zip(solution.body.tips, solution.problem.V.tip_specs):
        if spec is None:
            continue
        near, disk = (mask(elements_within(solution.body.mesh, tip.point, radius)) for radius in (NEAR * spec.r1, spec.r1))
        of_tip = squares[near].sum()
        squares[near] = 0
        squares[disk] += shares(estimate.squares[disk], of_tip)
    return squares


def shares(parts: np.ndarray, total: float) -> np.ndarray:
    """A total divided as parts are, evenly where these are all 0."""
    return total * (parts / parts.sum() if parts.any() else np.full(len(parts), 1 / len(parts)))
