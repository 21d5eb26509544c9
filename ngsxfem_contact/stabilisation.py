"""The Barbosa-Hughes stabilisation of the multiplier: (12), (13) and (38) of [AHLMR12].

R_h(v) is σ_n of the polynomial of the larger part of each cut element, and γ = γ_0 h_T on each. The tip functions
take part in R_h. The two vector modes have σ_n = 0 on the lips; single functions of (8) have σ_n ~ r^{-1/2} there, so
that ∫γ R_h(v)² diverges: with them γ falls linearly to zero within h_T of the tip (docs/method.md, section 5).
"""

from dataclasses import dataclass

import numpy as np
from ngsolve import L2, BilinearForm, CoefficientFunction, ElementId, GridFunction, IfPos, InnerProduct, sqrt, x, y

from . import _ngsxfem_contact as core
from .operators import NormalStress, Strain


@dataclass(frozen=True)
class Unstabilised:
    """K_γ = C_γ = D_γ = 0."""

    def Gamma(self, V, material):
        """None: there is no γ."""
        return None


@dataclass(frozen=True)
class BarbosaHughes:
    """γ on the cracks.

    gamma0: γ = gamma0 h_T with h_T the longest edge of each element; gamma has the unit of length over stress.
        None (default): γ_T = theta h_T / C_T on each element, C_T the largest value of
        ∫_{T∩Γ} h_T R_h(v)² / a_T(v,v), a_T over the larger part: K - K_γ is coercive with 1 - theta.
    theta: between 0 and 1.
    """

    gamma0: float | None = None
    theta: float = 0.5

    def __post_init__(self):
        if self.gamma0 is not None and not 0 < self.gamma0 < float("inf"):
            raise ValueError(f"BarbosaHughes: gamma0={self.gamma0} must be positive; stabilisation=None switches it off")
        if not 0 < self.theta < 1:
            raise ValueError(f"BarbosaHughes: theta={self.theta} must lie between 0 and 1")

    def Gamma(self, V, material):
        """γ as a CoefficientFunction on the elements that the cracks meet."""
        gamma = GridFunction(L2(V.mesh, order=0))
        for location, limit in zip(crack_elements(V.body), self._limits(V, material)):
            gamma.vec[location.element] = limit * location.h
        return gamma * tip_weight(V)

    def _limits(self, V, material):
        if self.gamma0 is not None:
            return np.full(len(crack_elements(V.body)), self.gamma0)
        constants = trace_constants(V, material)
        # an element on which R_h vanishes needs no bound of its own
        return self.theta / np.maximum(constants, 1e-3 * constants.max())


def crack_elements(body):
    """The ElementLocations of all cracks."""
    return [location for c in range(len(body.cracks)) for location in body.Elements(c)]


def tip_weight(V):
    """min(1, r/h_T) around the tips with scalar functions (8), 1 elsewhere."""
    h = GridFunction(L2(V.mesh, order=0))
    for location in crack_elements(V.body):
        h.vec[location.element] = location.h
    weight = CoefficientFunction(1)
    for tip, spec in zip(V.body.tips, V.tip_specs):
        if spec is not None and spec.basis == core.TipBasis.branch:
            r = sqrt((x - tip.point[0]) ** 2 + (y - tip.point[1]) ** 2)
            weight = weight * IfPos(h - r, r / h, 1)
    return weight


def normal_stress(u, material, body, side="larger"):
    """R_h(u)."""
    return NormalStress(material.Stress(Strain(u, side)), body)


def trace_constants(V, material):
    """C_T for each element of crack_elements: the local eigenproblems of docs/method.md, section 5.

    C_T = max ∫_{T∩Γ} h_T w R_h(v)² / a_T(v,v) over the functions of V that live on T, w = tip_weight. Dimensionless
    times stress; with γ_T = θ h_T / C_T, ∫γ R_h(v)² ≤ θ a(v,v), because the larger parts are disjoint.
    """
    u, v = V.TnT()
    body = V.body
    energy = BilinearForm(V)
    energy += InnerProduct(material.Stress(Strain(u)), Strain(v)) * body.dlarger
    trace = BilinearForm(V)
    trace += tip_weight(V) * normal_stress(u, material, body) * normal_stress(v, material, body) * body.dcrack
    return np.array([location.h * _largest_ratio(V, location.element, trace, energy) for location in crack_elements(body)])


def _largest_ratio(V, element, trace, energy, kernel=1e-10):
    """The largest eigenvalue of the element matrices of trace against energy, beside the common kernel."""
    ei = ElementId(element)
    fe, trafo = V.GetFE(ei), V.mesh.GetTrafo(ei)
    R, A = (np.array(form.integrators[0].CalcElementMatrix(fe, trafo)) for form in (trace, energy))
    diagonal = A.diagonal().copy()
    used = diagonal > 1e-28 * diagonal.max()
    scale = 1 / np.sqrt(diagonal[used])
    R, A = (M[np.ix_(used, used)] * scale[:, None] * scale for M in (R, A))
    values, vectors = np.linalg.eigh(A)
    regular = values > kernel * values[-1]
    basis = vectors[:, regular] / np.sqrt(values[regular])
    return np.linalg.eigvalsh(basis.T @ R @ basis)[-1]
