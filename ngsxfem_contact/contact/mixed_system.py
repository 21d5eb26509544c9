"""Barbosa-Hughes stabilisation where the material is nearly incompressible: section 11 of docs/method.md.

γ ‖λ - R_h(u)‖² must not exceed the energy, which for R_h with a pressure λ_L D u leaves only γ ~ h/λ_L. So each larger part beside the crack gets
a pressure of its own, π, polynomials as D u has them: of

    ½ a(u,u) - L(u) - ∫λ g_n - ½ ∫_Γ γ (λ - R_h(u) - π)² - ½ ∫ π²/λ_L

the saddle point is convex in u and concave in (λ, π) for γ ~ h/μ. Eliminating π in its element leaves (38) with one change: products ∫γ a b of
normal tractions become ∫γ a b - ⟨a⟩·M⁻¹⟨b⟩, ⟨a⟩ = ∫_Γ γ a q, M = ∫ q q/λ_L + ∫_Γ γ q q. The stress on these parts is σ(u) + π I.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import L2, VOL, BilinearForm, BitArray, ElementId, GridFunction, LinearForm

from .. import _ngsxfem_contact as core
from ..algebra.matrices import add_to, to_scipy
from ..operators import NORMAL
from ..spaces.incompressible import projection_degree
from .contact_system import ContactSystem
from .stabilisation import carries_pressure, crack_elements

if TYPE_CHECKING:
    from collections.abc import Callable

    from ngsolve import CoefficientFunction
    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace, CutDifferentialSymbol, TraceSpace
    from ..operators import Component
    from .problem import ContactProblem


def bits(size: int, numbers: list[int]) -> BitArray:
    """A BitArray with some bits set."""
    chosen = BitArray(size)
    chosen.Clear()
    for number in numbers:
        chosen.Set(number)
    return chosen


class LocalPressures:
    """The polynomials q in which π is sought, on the elements of nearly incompressible material that one crack meets.

    Parameters
    ----------
    problem : ContactProblem
    gamma
        γ.
    """

    def __init__(self, problem: ContactProblem, gamma: CoefficientFunction) -> None:
        self.problem, self.gamma = problem, gamma
        self.space = L2(problem.body.mesh, order=projection_degree(problem.V))
        self.locations = [T for T, used in zip(crack_elements(problem.body), carries_pressure(problem.V, problem.material)) if used]
        elements = [T.element for T in self.locations]
        self.dofs = np.array([self.space.GetDofNrs(ElementId(VOL, e)) for e in elements], dtype=int).reshape(len(elements), -1)
        self.elements = bits(problem.body.mesh.ne, elements)
        self.inverse = self._inverse()

    def _inverse(self) -> csr_matrix:
        """M⁻¹."""
        q, p = self.space.TnT()
        body, compliance = self.problem.body, self.problem.material.compliance
        whole = bits(body.mesh.ne, [T.element for T in self.locations if T.kind == core.ElementKind.Tip])
        divided = self.elements & ~whole
        form = BilinearForm(self.gamma * q * p * self._crack)
        for measure, chosen in ((body.dlarger, divided), (body.dx, whole)):
            form += compliance * q * p * measure(definedonelements=chosen)
        M, n = to_scipy(form.Assemble().mat), self.dofs.shape[1]
        blocks = np.array([M[dofs][:, dofs].toarray() for dofs in self.dofs]).reshape(-1, n, n)
        count = np.arange(len(blocks) + 1)
        return scipy.sparse.bsr_matrix((np.linalg.inv(blocks), count[:-1], count), shape=(self.dofs.size, self.dofs.size)).tocsr()

    @property
    def _crack(self) -> CutDifferentialSymbol:
        return self.problem.W.dcrack(space=self.problem.V, definedonelements=self.elements)

    def Moments(self, f: CoefficientFunction) -> np.ndarray:
        """⟨f⟩ of a CoefficientFunction."""
        return LinearForm(self.gamma * f * self.space.TestFunction() * self._crack).Assemble().vec.FV().NumPy()[self.dofs.ravel()]

    def MomentRows(self, space: CrackFESpace | TraceSpace, operator: Callable[..., Any]) -> csr_matrix:
        """⟨operator(u)⟩ of the functions u of a space, a scipy matrix."""
        form = BilinearForm(trialspace=space, testspace=self.space)
        form += self.gamma * operator(space.TrialFunction()) * self.space.TestFunction() * self._crack
        return to_scipy(form.Assemble().mat)[self.dofs.ravel()]

    def TractionRows(self) -> csr_matrix:
        """⟨R_h(u)⟩ of the functions of V."""
        traction = self.problem.ComparedTraction()
        return self.MomentRows(self.problem.V, lambda u: traction.Summed(u, NORMAL))

    def Stiffness(self) -> csr_matrix:
        """⟨R_h(u)⟩·M⁻¹⟨R_h(v)⟩: what π takes from K_γ, a scipy matrix."""
        R = self.TractionRows()
        return R.T @ self.inverse @ R

    def Fit(self, f: CoefficientFunction) -> PressureField:
        """π for f = λ - R_h(u) - r_0, a function on the cracks: a PressureField."""
        function = GridFunction(self.space)
        function.vec.FV().NumPy()[self.dofs.ravel()] = self.inverse @ self.Moments(f)
        return PressureField(self.problem.body, function)


class PressureField:
    """π in the body and on the faces: zero on the smaller part of a divided element."""

    def __init__(self, body: CrackedMesh, function: GridFunction) -> None:
        self.body, self.function = body, function

    def At(self, side: str | None) -> CoefficientFunction:
        """On a side, or None: by the position of the point."""
        return self.function if side == "larger" else self.function * self.body.InLargerPart(side)


class MixedSystem(ContactSystem):
    """The blocks of (38) with the changed products; see the module."""

    def _assemble(self, problem: ContactProblem) -> None:
        super()._assemble(problem)
        self.pressures = LocalPressures(problem, self.gamma)
        self.R = self.pressures.TractionRows()
        self.T = self.pressures.MomentRows(problem.W, lambda lam: lam)
        MR, MT = self.pressures.inverse @ self.R, self.pressures.inverse @ self.T
        own = problem.V.share.IsOwn(np.array([T.element for T in self.pressures.locations], dtype=int)).repeat(self.pressures.dofs.shape[1])
        add_to(self.stiffness, self.R.T @ scipy.sparse.diags(own.astype(float)) @ MR)
        n = problem.W.ndof
        self.E = scipy.sparse.vstack([self.E[:n] + self.T.T @ MR, self.E[n:]], format="csr")
        normal = self.D[:n, :n] - self.T.T @ MT
        self.D = scipy.sparse.block_diag([normal, self.D[n:, n:]], format="csr") if self.D.shape[0] > n else normal.tocsr()

    def _given_forces(self, shift: Callable[..., Any]) -> np.ndarray:
        return super()._given_forces(shift) - self.exchange.Additive(self.R).T @ self._given(shift)

    def _given_moments(self, component: Component, shift: Callable[..., Any]) -> np.ndarray:
        moments = super()._given_moments(component, shift)
        return moments - self.T.T @ self._given(shift) if component is NORMAL else moments

    def _given(self, shift: Callable[..., Any]) -> np.ndarray:
        """M⁻¹⟨r_0⟩."""
        return self.pressures.inverse @ self.pressures.Moments(self.traction.Given(NORMAL, shift))
