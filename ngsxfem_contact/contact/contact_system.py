"""The matrices of (38) of [AHLMR12] and the loads that go with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BilinearForm, GridFunction, LinearForm, Parameter

from ..algebra.matrices import assembled, mask
from ..spaces.exchange import exchange_of
from ..spaces.forms import bilinear_form
from ..spaces.incompressible import add_stress_power
from ..spaces.trace_space import trace_nodes

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CutDifferentialSymbol
    from ..loads.load import LoadTerms
    from ..operators import Component
    from ..protocols import Cone, Nodes
    from .problem import ContactProblem


@dataclass
class GivenTraction:
    """What r_0 adds to the right-hand sides of (38): F = Σ ∫γ r_0 R_h(v), and G = ∫γ r_0 ψ_i for each component. Linear in the load."""

    F: np.ndarray
    G: np.ndarray

    def __add__(self, other: GivenTraction) -> GivenTraction:
        return GivenTraction(self.F + other.F, self.G + other.G)

    def __rmul__(self, factor: float) -> GivenTraction:
        return GivenTraction(factor * self.F, factor * self.G)


class ContactSystem:
    """K - K_γ as an NGSolve matrix; E = B - C_γ and D_γ as scipy matrices; G, the initial gap, an array: the blocks of (38).

    Attributes
    ----------
    gamma
        γ or None.
    nodes
        The Nodes where the signs are taken.
    traction
        The ComparedTraction, R_h.

    Notes
    -----
    Of several processes that share the body each has the whole of what belongs to the cracks, and an additive part of stiffness, C and forces.
    Stationarity is (K - K_γ) U - (B - C_γ)ᵀ L = F, and the second row's residual (B - C_γ) U + D_γ L - G.
    With friction the multiplier is L = (L_n, L_t), the rows of B are -∫ψ_i g_n and -∫ψ_i g_t, those of C_γ ∫γψ_i R_n and
    ∫γψ_i R_t, R_t = σ_t of the larger part, and K_γ = ∫γ (R_n R_n + R_t R_t).
    """

    nodes: Nodes

    def __init__(self, problem: ContactProblem) -> None:
        self.problem, self.components = problem, problem.law.components
        self.exchange = exchange_of(problem.V)
        self.dcrack = problem.W.dcrack(space=problem.V)  # one rule for K_γ, C_γ and D_γ
        self.dcrack_stress, self.dcrack_products = self._equal_orders(problem)
        self.numbers = np.flatnonzero(mask(problem.body.CrackElements(None)))
        self.traction, self.gamma = problem.ComparedTraction(), problem.Gamma()
        self._assemble(problem)
        self._x, self._y = self.stiffness.CreateColVector(), self.stiffness.CreateColVector()
        self.G = np.zeros(self.E.shape[0])
        self.G[: len(self.nodes)] = self.InitialGap(problem)

    def _equal_orders(self, problem: ContactProblem) -> tuple[CutDifferentialSymbol, CutDifferentialSymbol]:
        """The measures of ∫γψR_h and of ∫γψψ, ∫ψg_0: with functions that have kinks inside the triangles of rules all orders are that of ∫ψg, so that what cancels does so point by point."""
        V, W = problem.V, problem.W
        if not getattr(W, "has_kinks", False):
            return self.dcrack, self.dcrack
        return W.dcrack(space=V, bonus_intorder=1), W.dcrack(space=V, bonus_intorder=V.order - W.order)

    def _assemble(self, problem: ContactProblem) -> None:
        """nodes, stiffness, E, D."""
        V, W = problem.V, problem.W
        u, v = V.TnT()
        lam, mu = W.TnT()
        stiffness = stiffness_form(problem)
        mass = scipy.sparse.csr_matrix((W.ndof, W.ndof))
        if self.gamma is not None:
            stiffness += V.share.Own(-self.gamma * self.traction.Squared(u, v, self.components) * self.dcrack)
            mass = assembled(BilinearForm(self.gamma * lam * mu * self.dcrack_products), self.numbers)
        self.nodes, self.stiffness = trace_nodes(W), stiffness.Assemble().mat
        self.E = scipy.sparse.vstack([self._coupling(problem, component) for component in self.components], format="csr")
        self.D = scipy.sparse.block_diag([mass] * len(self.components), format="csr")

    def _coupling(self, problem: ContactProblem, component: Component) -> csr_matrix:
        """The rows of B - C_γ of one component."""
        V, W = problem.V, problem.W
        u, mu = V.TrialFunction(), W.TestFunction()
        coupling = BilinearForm(trialspace=V, testspace=W)
        coupling += -mu * component.jump(u, problem.body) * self.dcrack
        if self.gamma is not None:
            coupling += -self.gamma * mu * self.traction.Summed(u, component) * self.dcrack_stress
        return assembled(coupling, self.numbers)

    def CheckCone(self, cone: Cone) -> None:
        """Raises ValueError for a cone that does not go with the system; a multiplier may have any."""

    def InitialGap(self, problem: ContactProblem) -> np.ndarray:
        """∫ψ_i g_0."""
        if isinstance(problem.gap, Parameter) and problem.gap.Get() == 0:
            return np.zeros(problem.W.ndof)
        mu = problem.W.TestFunction()
        return LinearForm(problem.gap * mu * self.dcrack_products).Assemble().vec.FV().NumPy()

    def Given(self, load: LoadTerms) -> GivenTraction:
        """The GivenTraction of LoadTerms: zero where nothing is given on the faces, and without γ."""
        if self.gamma is None or not load.acts_on_faces:
            return GivenTraction(np.zeros(self.problem.V.ndof), np.zeros(self.E.shape[0]))
        shift = lambda component, side: load.Shift(component, side, self.problem.body)
        return GivenTraction(self._given_forces(shift), np.concatenate([self._given_moments(component, shift) for component in self.components]))

    def _given_forces(self, shift: Callable[..., Any]) -> np.ndarray:
        """Σ ∫γ r_0 R_h(v)."""
        v = self.problem.V.TestFunction()
        form = LinearForm(self.problem.V.share.Own(self.gamma * self.traction.WithGiven(v, self.components, shift) * self.dcrack))
        return form.Assemble().vec.FV().NumPy().copy()

    def _given_moments(self, component: Component, shift: Callable[..., Any]) -> np.ndarray:
        """∫γ r_0 ψ_i of one component."""
        mu = self.problem.W.TestFunction()
        return LinearForm(self.gamma * self.traction.Given(component, shift) * mu * self.dcrack_products).Assemble().vec.FV().NumPy().copy()

    def Function(self, problem: ContactProblem, values: np.ndarray, name: str) -> GridFunction:
        """The GridFunction of W for one component of L."""
        function = GridFunction(problem.W, name)
        function.vec.FV().NumPy()[:] = values
        return function

    def OfFunction(self, moments: np.ndarray) -> np.ndarray:
        """The derivative by one component of L of a quantity that has one by the functions of W, moments."""
        return moments

    @property
    def C(self) -> csr_matrix:
        """The rows whose products with (K - K_γ)⁻¹ are needed; the first are E. Of several processes their additive parts."""
        return self.exchange.Additive(self.E)

    @property
    def distribution(self) -> csr_matrix:
        """From L to the coefficients of C's rows in the forces on the displacements, Cᵀ distribution L."""
        return scipy.sparse.identity(self.E.shape[0], format="csr")

    def Forces(self, L: np.ndarray) -> np.ndarray:
        """What L exerts on the displacements, (B - C_γ)ᵀ L."""
        return self.C.T @ (self.distribution @ L)

    def Stiffness(self, U: np.ndarray) -> np.ndarray:
        """(K - K_γ) U for an array U."""
        self._x.FV().NumPy()[:] = U
        self._y.data = self.stiffness * self._x
        return self._y.FV().NumPy().copy()

    def Moments(self, U: np.ndarray, L: np.ndarray) -> np.ndarray:
        """(B - C_γ) U + D_γ L of the second row of (38)."""
        return self.E @ U + self.D @ L


def stiffness_form(problem: ContactProblem) -> BilinearForm:
    """a(u, v) with the terms of problem.a, not assembled."""
    form = bilinear_form(problem.V)
    own = problem.V.share.OwnOf(None)
    add_stress_power(form, problem.material, problem.body.dx if own is None else problem.body.dx(definedonelements=own))
    problem.a.AddTo(form)
    return form
