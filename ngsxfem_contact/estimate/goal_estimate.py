"""The error of a quantity by the dual problem: section 17 of docs/method.md."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import GridFunction, Integrate, Norm, sqrt

from ..description import Described
from ..spaces.incompressible import stress, stress_power
from .contact_defect import contact_defect, stiffness_of_plane

if TYPE_CHECKING:
    from ..description import Lines
    from ..protocols import Goal
    from .error_estimate import ErrorEstimate

CONTACT = 3  # times what gaps do that the law does not allow: found by benchmarks/goal_errors.py


class GoalEstimate(Described):
    """How far a quantity J(u_h, λ_h) is off, as `ErrorEstimate.Goal` finds it.

    Parameters
    ----------
    estimate : ErrorEstimate
        Of the solution.
    goal
        The quantity, an object with the role Goal.

    Attributes
    ----------
    value
        J(u_h, λ_h).
    error
        J(u, λ) - J(u_h, λ_h), with its sign.
    z
        The dual displacement, a GridFunction of V.
    zeta
        The dual multipliers, functions of W.
    e
        What the next order adds to z, a GridFunction.

    Raises
    ------
    ValueError
        For laws of the faces that are not linearised, parts that only the faces hold, and nearly incompressible materials.
    """

    def __init__(self, estimate: ErrorEstimate, goal: Goal) -> None:
        self.estimate, self.goal = estimate, goal
        solution, next_order = estimate.solution, estimate.next_order
        if solution.problem.is_mixed:
            raise ValueError("Goal: the dual problem of nearly incompressible materials is not solved; ErrorEstimate().energy is for them, too")
        self.value = goal.Value(solution)
        of_space = goal.OfDisplacement(solution, next_order.space)
        z, self.zeta = solution.reduced.Adjoint(solution, next_order.higher.Restricted(of_space), goal.OfMultipliers(solution))
        self.z = GridFunction(solution.problem.V)
        self.z.vec.FV().NumPy()[:] = z
        rest = of_space - next_order.Exerted(self.z, stress(solution.problem.material, self.z), self.zeta)
        found = next_order.Solve(rest).x
        self.e = next_order.Function(found)
        self.error = float(next_order.residual @ next_order.higher.Prolonged(z)) + self._surplus(rest, found) - self._of_faces()

    def _surplus(self, rest: np.ndarray, e_z: np.ndarray) -> float:
        """rest(e), of second order in what conjugate gradients have left of either."""
        next_order, e = self.estimate.next_order, self.estimate.e.vec.FV().NumPy()
        still = next_order.residual - next_order.Energy(e)
        return float(rest @ e + np.where(next_order.free, still, 0) @ e_z)

    def _of_faces(self) -> float:
        """∫γ ζ_h (λ_h - R_h(u_h) - r_0)."""
        solution = self.estimate.solution
        if solution.gamma is None:
            return 0.0
        multipliers = (solution.multiplier, solution.tangential_multiplier)
        density = sum(
            zeta * (multiplier - solution.Traction(component, "larger"))
            for zeta, multiplier, component in zip(self.zeta, multipliers, solution.problem.law.components)
        )
        return Integrate(solution.gamma * density * solution.problem.W.dcrack(space=solution.problem.V), solution.body.mesh)

    @property
    def corrected(self) -> float:
        """value + error."""
        return self.value + self.error

    @cached_property
    def bar(self) -> float:
        """How far value may be off: |error| for all orders, what the elements may have missed if the signs of that are random, and where contact is not as the law says."""
        saturated = self.estimate.saturation**2 * abs(self.error)
        return float(saturated + np.sqrt((self._signed**2).sum()) + CONTACT * self._of_contact.sum())

    @property
    def elements(self) -> np.ndarray:
        """(number of triangles,): by what each may contribute to the error, whatever its sign: the error of u times that of z, and contact."""
        power = stress_power(self.estimate.solution.problem.material, self.e, self.e)
        dual = self.estimate.saturation**2 * np.maximum(self.estimate.OfElements(power), 0)
        return np.sqrt(self.estimate.squares * dual) + CONTACT * self._of_contact

    @cached_property
    def _signed(self) -> np.ndarray:
        """(number of triangles,): a_T(e_u, e_z)."""
        return self.estimate.OfElements(stress_power(self.estimate.solution.problem.material, self.estimate.e, self.e))

    @cached_property
    def _of_contact(self) -> np.ndarray:
        """(number of triangles,): ∫|ζ_h| δ, δ the gap by which the law is not fulfilled."""
        estimate = self.estimate
        if not estimate.solution.body.cracks:
            return np.zeros(estimate.solution.body.mesh.ne)
        defect = sqrt(contact_defect(estimate.solution) / stiffness_of_plane(estimate.solution))
        return estimate.OfCracks(Norm(self.zeta[0]) * defect)

    def Description(self) -> Lines:
        """The quantity, its value, and how far it is off."""
        return [
            ("goal", str(self.goal)),
            ("value", f"{self.value:.6g}, ± {self.bar:.2g}"),
            ("error", f"{self.error:+.2g}, which makes it {self.corrected:.6g}"),
        ]
