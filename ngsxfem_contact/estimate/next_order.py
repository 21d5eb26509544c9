"""The elastic problem on the space of the next order, with the multipliers of a solution as loads on the faces: what its answer is beyond that of the solution."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CacheCF, GridFunction, InnerProduct, LinearForm

from .. import _ngsxfem_contact as core
from ..algebra.conjugate_gradients import Found, conjugate_gradients
from ..algebra.matrices import csr_view, mask
from ..loads.other_space import add_springs, load_on, spring_forces_on, supports_on
from ..operators import NORMAL, TANGENTIAL, Gradient
from ..spaces.higher_order import HigherOrder
from ..spaces.incompressible import add_stress_power

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import CoefficientFunction

    from ..contact.solution import ContactSolution

ACCURACY = 0.02  # of the energy of an answer
MOST = 30  # steps of conjugate gradients
SAME = 1e-9  # relative: displacements that are given are those of the solution
LOST = "what V_h loses of the displacements that are given is not known, and no part of the estimate: they are other ones now than in the solve, or were read from a file"


class NextOrder:
    """a(e, v) = r(v) for all v of V_{k+1}, r(v) = L(v) - a(u_h, v) - ∫λ_h g_n(v) - ∫λ_{h,t} g_t(v).

    Attributes
    ----------
    higher
        The HigherOrder space.
    notes
        What the estimate does not see.
    """

    def __init__(self, solution: ContactSolution) -> None:
        self.solution, self.notes = solution, []
        self.higher = HigherOrder(solution.problem.V)
        self.space = self.higher.space
        form = core.CrackBilinearForm(self.space, symmetric=True)
        add_stress_power(form, solution.problem.material, solution.body.dx)
        add_springs(form, solution.a)
        self.matrix = form.Assemble().mat
        self._x, self._y = self.matrix.CreateColVector(), self.matrix.CreateColVector()
        supports = supports_on(solution.problem.supports, self.space)
        self.free, self._given = mask(supports.free), supports.given.vec.FV().NumPy()
        diagonal = csr_view(self.matrix).diagonal()
        smoothed = self.higher.surplus & self.free & (diagonal > 0)
        self.inverse_diagonal = np.where(smoothed, 1 / np.where(smoothed, diagonal, 1), 0)

    def Energy(self, e: np.ndarray) -> np.ndarray:
        """K e of the space of the next order."""
        self._x.FV().NumPy()[:] = e
        self._y.data = self.matrix * self._x
        return self._y.FV().NumPy().copy()

    def Solve(self, r: np.ndarray) -> Found:
        """a(e, v) = r(v), e = 0 where displacements are given: the coarse functions by the factors of the solve, the others by their diagonal, conjugate gradients."""
        coarse, higher = self.solution.reduced.elimination, self.higher
        free = lambda values: np.where(self.free, values, 0)
        precondition = lambda r: self.inverse_diagonal * r + higher.Prolonged(coarse.Solve(higher.Restricted(r)))
        return conjugate_gradients(lambda e: free(self.Energy(e)), lambda r: free(precondition(r)), free(r), ACCURACY, MOST)

    @cached_property
    def residual(self) -> np.ndarray:
        """r, for all functions of the space."""
        solution = self.solution
        multipliers = [multiplier for multiplier in (solution.multiplier, solution.tangential_multiplier) if multiplier is not None]
        return load_on(solution.load, self.space) - self.Exerted(solution.u, solution.ElasticStress(None), multipliers)

    def Exerted(self, u: GridFunction, stress: CoefficientFunction, multipliers: Sequence[CoefficientFunction]) -> np.ndarray:
        """a(u, v) + ∫λ g_n(v) + ∫λ_t g_t(v) for all functions v of the space, with the stress of u."""
        solution, v = self.solution, self.space.TestFunction()
        power = sum(multiplier * component.jump(v, solution.body) for multiplier, component in zip(multipliers, (NORMAL, TANGENTIAL)))
        body = solution.body.dx(bonus_intorder=-2)  # two gradients
        form = LinearForm(InnerProduct(CacheCF(stress), Gradient(v)) * body + power * solution.problem.W.dcrack(space=self.space))
        return form.Assemble().vec.FV().NumPy() + spring_forces_on(solution.a, u, self.space)

    @cached_property
    def given(self) -> np.ndarray:
        """What the solution lacks of the displacements that are given, on the unknowns of the space that they fix."""
        supports, U = self.solution.problem.supports, self.solution.u.vec.FV().NumPy()
        fixed = ~mask(supports.free)
        ours, held = supports.given.vec.FV().NumPy()[fixed], U[fixed]
        size = np.abs(held).max(initial=0)
        factor = float(ours @ held / (ours @ ours)) if ours.any() else 0.0  # of a load step
        was_read = not supports.functions and any(side.explicit and side.samples.any() for side in supports.sides.values())
        if np.abs(held - factor * ours).max(initial=0) > SAME * size or was_read:
            self.notes.append(LOST)
            return np.zeros(self.space.ndof)
        return np.where(self.free, 0, factor * self._given - self.higher.Prolonged(U))

    def Error(self) -> tuple[GridFunction, Found]:
        """e, and how it was found."""
        found = self.Solve(self.residual - self.Energy(self.given))
        return self.Function(found.x + self.given), found

    def Function(self, values: np.ndarray) -> GridFunction:
        """Coefficients as a GridFunction."""
        function = GridFunction(self.space)
        function.vec.FV().NumPy()[:] = values
        return function
