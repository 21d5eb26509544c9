"""Nitsche's method for contact and friction (Chouly, Hild, Renard): no multiplier, section 8 of docs/method.md.

With P_n(u) = R_n(u) + (g_n(u) + g_0)/γ, P_t(u) = R_t(u) + (g_t(u) - g_t,previous)/γ, λ = min(0, P_n), λ_t the projection of
P_t onto [-s, s], find u such that for all v

    a(u,v) - θ ∫γ (R_n(u) R_n(v) + R_t(u) R_t(v)) + ∫λ (g_n(v) + θγ R_n(v)) + ∫λ_t (g_t(v) + θγ R_t(v)) = L(v).

The law holds at each point of a Gauss rule on the crack. In w = ωγ (λ - P) it is λ ≤ 0, w ≤ 0, λw = 0, with weights ω:
that is (38) with E = -ω(g + γR), D = diag(ωγ) at the points, and E_θ = -ω(g + θγR) in the first row. For θ = 1 it is
Barbosa-Hughes with a multiplier that is free at every point. With A = K - θK_γ the reduced matrix E A⁻¹ E_θᵀ + D is
positive definite for θ = 1 and K_γ < K, for θ = 0 and K_γ < 4K, and for θ = -1 whatever γ is, so that the law has one
solution for given thresholds and the nodal methods end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import CoefficientFunction, ElementId, GridFunction, Id, Sym

from ..algebra.matrices import add_to
from ..arguments import check_number, check_positive, check_whole
from ..loads.terms import unit_limits
from ..operators import NORMAL
from ..spaces.incompressible import is_projected
from ..spaces.nodes import CurveNodes
from ..spaces.trace_space import mass_matrix
from .cones import Nonpositive
from .contact_system import ContactSystem, stiffness_form
from .stabilisation import BarbosaHughes, Defaults

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace
    from ..loads.face_traction import Joint
    from ..material import Isotropic
    from ..operators import Component
    from ..protocols import Cone
    from .problem import ContactProblem


@dataclass(frozen=True)
class Nitsche(Defaults):
    """In place of a stabilised multiplier: ContactProblem(..., stabilisation=Nitsche(theta=1)).

    Parameters
    ----------
    theta
        1 (symmetric), 0 (fewest terms) or -1 (coercive for every γ).
    gamma0, coercivity
        γ as BarbosaHughes(gamma0, coercivity) has it.
    points
        Gauss points on each interval of the crack; default order + 3.

    Notes
    -----
    The W of the problem only presents the pressure: `solution.multiplier` is its L² projection onto W.
    """

    theta: int = 1
    gamma0: float | None = None
    coercivity: float = 0.5
    points: int | None = None

    sides = {"larger": 1}

    def __post_init__(self) -> None:
        if self.theta not in (-1, 0, 1):
            raise ValueError(f"Nitsche: theta={self.theta} is not one of -1, 0, 1")
        if self.points is not None:
            check_whole(self.points, "Nitsche: points", 1)
        if self.gamma0 is not None:
            check_positive(self.gamma0, "Nitsche: gamma0")
        check_number(self.coercivity, "Nitsche: coercivity", lambda coercivity: 0 < coercivity < 1, "lie between 0 and 1")

    @property
    def _barbosa_hughes(self) -> WholeTraction:
        return WholeTraction(self.gamma0, self.coercivity)

    def Gamma(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> CoefficientFunction:
        """γ as a CoefficientFunction on the elements that the cracks meet."""
        return self._barbosa_hughes.Gamma(V, material, components)

    def IsSafe(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> bool:
        """Whether the method is known to have one solution without an eigenvalue problem on the whole body."""
        return self.theta == -1 or self._barbosa_hughes.IsSafe(V, material, components)

    @property
    def needs_eigenvalue(self) -> bool:
        """θ = 0: its factorised matrix K is positive for every γ, which shows nothing."""
        return self.theta == 0

    def Remedy(self, smallest: float) -> str:
        """A smaller γ, or θ = -1."""
        if self.gamma0 is None:
            return f"γ was chosen element by element for a coercivity of {1 - self.coercivity:g}: take a smaller coercivity=..., or theta=-1"
        return self._barbosa_hughes.Remedy(smallest) + ", or theta=-1, which allows every γ"

    def System(self, problem: ContactProblem) -> NitscheSystem:
        """The matrices of the problem: a NitscheSystem."""
        return NitscheSystem(problem, self)


class WholeTraction(BarbosaHughes):
    """γ for a law at points, which leaves no room for a pressure of its own: it falls like h/λ_L where the material is nearly incompressible."""

    def Law(self, V: CrackFESpace, material: Isotropic) -> Isotropic:
        """The material."""
        return material


class CrackPoints(CurveNodes):
    """Gauss points between the points where the cracks meet mesh edges, in √r around a tip; in place of the nodes of a multiplier."""

    def __init__(self, body: CrackedMesh, number: int) -> None:
        rules = [rule(body.MeshNodes(c, True), [tip.s for tip in body.tips if tip.crack == c], number) for c in range(len(body.cracks))]
        super().__init__(body, *zip(*rules))
        self._arguments = body, number

    def __reduce__(self) -> Any:
        return CrackPoints, self._arguments

    def Rows(self, V: CrackFESpace, operator: str) -> list[csr_matrix]:
        """The values of an operator of V at the points: for each of its components a sparse matrix (n, V.ndof)."""
        evaluator = V.TrialFunction().Operator(operator).__diffop__()
        blocks, columns = [], []
        for point in self.points:
            element = ElementId(int(point["nr"]))
            blocks.append(np.array(evaluator(V.GetFE(element), point)))
            columns.append(np.array(V.GetDofNrs(element)))
        pointers = np.concatenate([[0], np.cumsum([len(c) for c in columns])])
        return [
            scipy.sparse.csr_matrix((np.concatenate([b[i] for b in blocks]), np.concatenate(columns), pointers), shape=(len(self), V.ndof))
            for i in range(len(blocks[0]))
        ]


def rule(nodes: Any, tips: list[float], number: int) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths and weights of Gauss points on each interval, in the square root of the distance to the nearest tip if there is one."""
    nodes = np.array(nodes)
    middle = 0.5 * sum(tips)
    if len(tips) == 2 and np.abs(nodes - middle).min() > 1e-9 * nodes[-1]:
        nodes = np.union1d(nodes, middle)
    x, w = np.polynomial.legendre.leggauss(number)
    points, weights = [], []
    for a, b in zip(nodes, nodes[1:]):
        if not tips:
            points.append(0.5 * (a + b) + 0.5 * (b - a) * x)
            weights.append(0.5 * (b - a) * w)
            continue
        tip = min(tips, key=lambda s: abs(s - 0.5 * (a + b)))
        roots = np.sqrt(np.abs(np.array([a, b]) - tip))
        root = 0.5 * (roots[0] + roots[1]) + 0.5 * (roots[1] - roots[0]) * x
        points.append(tip + (1 if b > tip else -1) * root**2)
        weights.append(np.abs(roots[1] - roots[0]) * root * w)
    return np.concatenate(points), np.concatenate(weights)


@dataclass(frozen=True)
class GivenJump:
    """What the operators of a component need of a displacement with a given jump."""

    jump: CoefficientFunction

    def Operator(self, name: str) -> CoefficientFunction:
        """The jump, whatever the operator."""
        return self.jump


class NitscheSystem(ContactSystem):
    """The blocks at the points of the crack; see the module.

    Parameters
    ----------
    method
        Nitsche, its θ and the number of its points.
    """

    nodes: CrackPoints

    def __init__(self, problem: ContactProblem, method: Nitsche) -> None:
        self.method, self.theta = method, method.theta
        super().__init__(problem)

    def _assemble(self, problem: ContactProblem) -> None:
        self.CheckCone(problem.cone)
        components = problem.law.components
        self.nodes = nodes = CrackPoints(problem.body, self.method.points or problem.V.order + 3)
        omega, gamma = nodes.weights, nodes.Values(self.gamma)
        jumps, tractions = component_rows(problem, nodes)
        weighted = [scipy.sparse.diags(-omega * gamma) @ R for R in tractions]
        self.R = scipy.sparse.vstack(weighted, format="csr")
        self.E = scipy.sparse.vstack([scipy.sparse.diags(-omega) @ g + R for g, R in zip(jumps, weighted)], format="csr")
        self.D = scipy.sparse.block_diag([scipy.sparse.diags(omega * gamma)] * len(components), format="csr")
        self.stiffness = stiffness_form(problem).Assemble().mat
        own = np.tile(problem.V.share.IsOwn(nodes.points["nr"]), len(components))  # of each point one process adds what it gives
        add_to(self.stiffness, -self.theta * (self.R.T @ scipy.sparse.diags(own / self.D.diagonal()) @ self.R))

    def _given_moments(self, component: Component, shift: Callable[..., Any]) -> np.ndarray:
        """ωγ r_0 of one component."""
        return self.nodes.weights * self.nodes.Values(self.gamma * self.traction.Given(component, shift))

    def _given_forces(self, shift: Callable[..., Any]) -> np.ndarray:
        """θ ∫γ r_0 R_h(v) = -θ Rᵀ r_0."""
        values = np.concatenate([self.nodes.Values(self.traction.Given(component, shift)) for component in self.components])
        return -self.theta * (self.exchange.Additive(self.R).T @ values)

    def CheckCone(self, cone: Cone) -> None:
        """Raises ValueError for the weak cone."""
        if not isinstance(cone, Nonpositive):
            raise ValueError("Nitsche: the law holds at points; cone='weak' belongs to a multiplier, leave the cone at 'nonpositive'")

    def InitialGap(self, problem: ContactProblem) -> np.ndarray:
        """ω g_0."""
        return self.nodes.weights * self.nodes.Values(problem.gap)

    def Function(self, problem: ContactProblem, values: np.ndarray, name: str) -> GridFunction:
        """The L² projection of the law's values at the points onto W."""
        W = problem.W
        function = GridFunction(W, name)
        moments = np.empty(W.ndof)
        for i in range(W.ndof):
            function.vec[:] = 0
            function.vec[i] = 1
            moments[i] = self.nodes.weights * values @ self.nodes.Values(function)
        function.vec.FV().NumPy()[:] = scipy.sparse.linalg.spsolve(mass_matrix(W).tocsc(), moments)
        return function

    def OfFunction(self, moments: np.ndarray) -> np.ndarray:
        """Through the projection onto W."""
        function = GridFunction(self.problem.W)
        function.vec.FV().NumPy()[:] = scipy.sparse.linalg.spsolve(mass_matrix(self.problem.W).tocsc(), moments)
        return self.nodes.weights * self.nodes.Values(function)

    @property
    def C(self) -> csr_matrix:
        """E, and γR beside it unless θ = 1."""
        rows = self.E if self.theta == 1 else scipy.sparse.vstack([self.E, self.R], format="csr")
        return self.exchange.Additive(rows)

    @property
    def distribution(self) -> csr_matrix:
        """E_θᵀ = Eᵀ - (1 - θ) Rᵀ."""
        identity = super().distribution
        return identity if self.theta == 1 else scipy.sparse.vstack([identity, (self.theta - 1) * identity], format="csr")


def component_rows(problem: ContactProblem, nodes: CrackPoints) -> tuple[list[csr_matrix], list[csr_matrix]]:
    """Jumps and tractions R of each component at the points: two lists of sparse matrices."""
    body, material = problem.body, problem.material
    jump, gradient = (nodes.Rows(problem.V, operator) for operator in ("jump", "gradlarger"))
    units = lambda n, **dims: [CoefficientFunction(tuple(row), **dims) for row in np.eye(n)]
    stresses = [*(material.Stress(Sym(e), 0) for e in units(4, dims=(2, 2))), material.Stress(0 * Id(2), 1)]
    gradient = [*gradient, dilatation_rows(problem, nodes, gradient)]
    combined = lambda functions, rows: sum(scipy.sparse.diags(nodes.Values(f)) @ r for f, r in zip(functions, rows))
    jumps, tractions = [], []
    for component in problem.law.components:
        jumps.append(combined([component.jump(GivenJump(e), body) for e in units(2)], jump))
        tractions.append(combined([component.traction(stress, body) for stress in stresses], gradient))
    joint = problem.a.joint
    return jumps, tractions if joint is None else [t + r for t, r in zip(tractions, joint_rows(problem, joint, nodes))]


def dilatation_rows(problem: ContactProblem, nodes: CrackPoints, gradient: list[csr_matrix]) -> csr_matrix:
    """What λ_L multiplies in the stress at the points: D u of the larger part where the material is nearly incompressible, div u elsewhere."""
    divergence, material = gradient[0] + gradient[3], problem.material
    if not is_projected(problem.V, material):
        return divergence
    projected = nodes.Values(CoefficientFunction(material.projected))
    return scipy.sparse.diags(projected) @ nodes.Rows(problem.V, "dilatationlarger")[0] + scipy.sparse.diags(1 - projected) @ divergence


def joint_rows(problem: ContactProblem, joint: Joint, nodes: CrackPoints) -> Iterator[csr_matrix]:
    """What the joint adds to R at the points, for each component a sparse matrix."""
    columns = [joint.Tractions(u) for pair in unit_limits(2) for u in pair]
    rows = [row for operator in ("plus", "minus") for row in nodes.Rows(problem.V, operator)]
    for component in problem.law.components:
        yield sum(scipy.sparse.diags(nodes.Values(t.Shift(component, "larger", problem.body))) @ row for t, row in zip(columns, rows))
