"""The error of a solution in the energy norm, and where it comes from: section 16 of docs/method.md."""

from __future__ import annotations

from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import L2, CoefficientFunction, LinearForm

from ..description import Described
from ..points import place
from ..sheets import check_plane
from ..spaces.incompressible import stress_power
from .contact_defect import contact_defect
from .goal_estimate import GoalEstimate
from .next_order import NextOrder
from .norm_estimate import NormEstimate, is_norm

if TYPE_CHECKING:
    from typing import Any

    from .._ngsxfem_contact import CrackFESpace
    from ..contact.problem import ContactProblem
    from ..contact.solution import ContactSolution
    from ..description import Lines
    from ..protocols import Goal, Norm

ELSEWHERE = "save the solution, solution.Save(path), and ask for it in a script without mpirun that loads the file"
SMOOTH, SINGULAR = 1.5, 0.5  # exponents of r in u that the polynomials have to approximate: beside tip functions, and without them


class ErrorEstimate(Described):
    """How far a solution is off in the energy norm |||v|||² = a(v, v), and where.

    Parameters
    ----------
    solution : ContactSolution
        Whose error is sought; its problem must have the loads and supports of the solve.

    Attributes
    ----------
    e
        The part of u - u_h in the space of the next order, a GridFunction.
    notes
        What the estimate does not see, sentences.

    Raises
    ------
    ValueError
        For a load whose coefficients have changed since the solve, and one whose terms NGSolve does not look into.
    NotImplementedError
        With several processes.

    Notes
    -----
    The residual of u_h and λ_h is tested with all functions of order k + 1 (`next_order`), and the energy of the answer is multiplied by `saturation`, for what the orders beyond
    have; contact adds how far λ_h and the gap are from being complementary. Elements of an error that is far above the others are those to refine.
    """

    def __init__(self, solution: ContactSolution) -> None:
        check_plane(solution.body, "ErrorEstimate")
        solution.problem.V.share.Refuse("An estimate of the error", instead=ELSEWHERE)
        solution.CheckLoad()
        self.solution, self.next_order = solution, NextOrder(solution)
        self.e, self._found = self.next_order.Error()
        self.saturation = saturation(solution.problem.V)
        self.notes = [*self.next_order.notes, *unseen(solution.problem)]

    def Description(self) -> Lines:
        """The error, absolute and relative, and its parts."""
        elastic, contact = (sqrt(part.sum()) for part in (self._elastic, self._contact))
        return [
            ("error", f"{self.energy:.3g} in the energy norm, {100 * self.relative:.2g} % of that of u_h"),
            ("of it", f"{self.saturation:.2f} × {elastic:.3g} of the next order, {contact:.2g} of contact"),
            ("found by", f"{len(self._found.gains)} steps of conjugate gradients on {self.next_order.space.ndof} unknowns"),
            *(("note", note) for note in self.notes),
        ]

    def Goal(self, goal: Goal | Norm) -> GoalEstimate | NormEstimate:
        """How far a quantity is off: a GoalEstimate, by a dual problem on the factors of the solve; or how large a norm of the error is, a NormEstimate.

        Parameters
        ----------
        goal
            StressIntensityFactor("K_I", tip), ContactForce(crack), ContactEdge(crack, number), Displacement(region, component), or an object with the role Goal;
            ContactPressure(crack), or an object with the role Norm.

        Raises
        ------
        ValueError
            For laws of the faces that hold node by node, parts that only the faces hold, and nearly incompressible materials.
        """
        return NormEstimate(self, goal) if is_norm(goal, "Goal: goal") else GoalEstimate(self, goal)

    @property
    def energy(self) -> float:
        """The error |||u - u_h|||, √(stress × length²)."""
        return float(np.sqrt(self.squares.sum()))

    @property
    def relative(self) -> float:
        """The same, relative to |||u_h|||."""
        return self.energy / sqrt(2 * self.solution.Energy()) if self.energy else 0.0

    @property
    def elements(self) -> np.ndarray:
        """(number of triangles,): the error of each; the squares add up to that of `energy`."""
        return np.sqrt(self.squares)

    @cached_property
    def squares(self) -> np.ndarray:
        """(number of triangles,): the squares of `elements`."""
        return self.saturation**2 * self._elastic + self._contact

    @cached_property
    def _elastic(self) -> np.ndarray:
        return np.maximum(self.OfElements(stress_power(self.solution.problem.material, self.e, self.e)), 0)

    @cached_property
    def _contact(self) -> np.ndarray:
        solution = self.solution
        if not solution.body.cracks or has_own_law(solution.problem):
            return np.zeros(solution.body.mesh.ne)
        return self.OfCracks(contact_defect(solution))

    def OfElements(self, density: CoefficientFunction) -> np.ndarray:
        """(number of triangles,): integrals of products of stresses and strains of the next order.

        Parameters
        ----------
        density : CoefficientFunction
            The product.
        """
        space = self.next_order.space
        return self._by_element(density, self.solution.body.dx(space=space, bonus_intorder=2 * space.order - 2))

    def OfCracks(self, density: CoefficientFunction, crack: int | None = None) -> np.ndarray:
        """(number of triangles,): integrals over the cracks in each.

        Parameters
        ----------
        density : CoefficientFunction
            What is integrated.
        crack : int or None
            The number of one of them; None: all.
        """
        problem = self.solution.problem
        return self._by_element(density, problem.W.dcrack(crack=crack, bonus_intorder=2 * problem.V.order + 2))

    def _by_element(self, density: CoefficientFunction, measure: Any) -> np.ndarray:
        constants = L2(self.solution.body.mesh, order=0)
        return LinearForm(density * constants.TestFunction() * measure).Assemble().vec.FV().NumPy().copy()


def saturation(V: CrackFESpace) -> float:
    """1/√(1 - (k/(k+1))^{2α}), k the order of V: of a field r^α around a point inside an element polynomials of order k leave an error ~ k^{-α}.

    α = 3/2 at transitions and at tips, whose functions have r^{1/2}, and 1/2 at tips without functions. Where u is smooth the factor is larger than needed.
    """
    alpha = SINGULAR if any(spec is None for spec in V.tip_specs) else SMOOTH
    return 1 / sqrt(1 - (V.order / (V.order + 1)) ** (2 * alpha))


def has_own_law(problem: ContactProblem) -> bool:
    """Whether the faces have a law that holds node by node, by which they may overlap or pull."""
    return hasattr(problem.law, "softening")


def unseen(problem: ContactProblem) -> list[str]:
    """Notes of laws of the faces, and of tips without functions: where the crack ends inside an element no function of any order jumps."""
    V = problem.V
    law = ["how far the law of the faces holds between the nodes is no part of the estimate"] if has_own_law(problem) else []
    tips = [tip for tip, spec in zip(V.body.tips, V.tip_specs) if spec is None]
    return law + [
        f"the space has no functions at the tip {place(tip.point)}, and the error may be twice the estimate; give CrackFESpace(..., tip=TipEnrichment(...))"
        for tip in tips
    ]
