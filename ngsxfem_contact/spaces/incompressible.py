"""Stresses of nearly incompressible materials: section 11 of docs/method.md.

Where λ_L/μ_L is large, div u of polynomials cannot be as small as it must be, and u, K and λ are wrong on any usual mesh ("locking"). There D u
takes the place of div u: its L² projection onto polynomials in each part of each element, of two degrees less than the highest of V; the
singular part s of the divergence of the tips' modes is left as it is. a(u, v) = ∫ 2μ ε(u):ε(v) + λ_L D u D v.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ngsolve import VOL, CoefficientFunction, ElementId, Trace

from .. import _ngsxfem_contact as core
from ..errors import warn
from ..material import Isotropic
from ..operators import Strain

if TYPE_CHECKING:
    from ngsolve import BilinearForm

    from .._ngsxfem_contact import CrackFESpace
    from ..contact.mixed_system import PressureField
    from ..protocols import Stabilisation

LOCKING = "order=1 locks: displacements, K and the pressure may be wrong by tens of percent; take CrackFESpace(..., order=2, material=...)"
NO_BUBBLE = "without bubbles the stresses of order={order} are those of one order less; take CrackFESpace(..., order={order}, material=...), which adds them"
BRANCH = "the functions (8) at a tip have no singular pressure; take the modes, CrackFESpace(..., material=...)"
AT_POINTS = "Nitsche's law at points is hardly stabilised, and the pressure may oscillate; take BarbosaHughes()"
ROUND_OFF = "round-off may spoil the answer, or Solve refuse it; take nu <= 0.49999, which changes stresses that tractions determine by 2e-5 of themselves"
MOST = 1e5  # λ_L/μ_L: above it round-off counts


@dataclass(frozen=True)
class WithoutPressure:
    """The stress 2μ ε + λ_L (1 - Π) s of a nearly incompressible material: what is left of it if the pressure of each part is chosen freely."""

    material: Isotropic
    dilatation = "singular"

    def __getattr__(self, name: str) -> Any:
        return getattr(self.material, name)


def is_projected(V: CrackFESpace, material: Isotropic | WithoutPressure) -> bool:
    """Whether the divergence is projected, somewhere in the body."""
    return material.nearly_incompressible and V.globalorder > 1


def projection_degree(V: CrackFESpace) -> int:
    """Of the polynomials onto which div u is projected."""
    return V.GetFE(ElementId(VOL, 0)).order - 2


def dilatation(material: Isotropic | WithoutPressure, u: CoefficientFunction, side: str | None = None) -> CoefficientFunction:
    """What takes the place of div u in the stress: D u where the material is nearly incompressible, div u elsewhere. side as for Gradient."""
    divergence = Trace(Strain(u, side))
    if not is_projected(u.space, material):
        return divergence
    projected = u.Operator(getattr(material, "dilatation", "dilatation") + (side or ""))
    return projected if isinstance(material.projected, int) else material.projected * projected + (1 - material.projected) * divergence


def stress(material: Isotropic | WithoutPressure, u: CoefficientFunction, side: str | None = None) -> CoefficientFunction:
    """σ of a trial or test function or GridFunction of a CrackFESpace, a 2 × 2 CoefficientFunction; side as for Gradient."""
    if not is_projected(u.space, material):
        return material.Stress(Strain(u, side))
    return material.Stress(Strain(u, side), dilatation(material, u, side))


def stress_power(
    material: Isotropic | WithoutPressure, u: CoefficientFunction, v: CoefficientFunction, pressure: PressureField | None = None
) -> CoefficientFunction:
    """σ(u):ε(v), in which D takes the place of both divergences; with a PressureField π, D + π/λ_L does."""
    if not is_projected(u.space, material):
        return material.StressPower(Strain(u), Strain(v))
    both = dilatation(material, u), dilatation(material, v)
    return material.StressPower(Strain(u), Strain(v), both, None if pressure is None else pressure.At(None))


def add_stress_power(form: BilinearForm, material: Isotropic | WithoutPressure, measure: Any) -> None:
    """Adds ∫ stress_power over a measure of the body to a bilinear form on a CrackFESpace."""
    V = form.space
    if is_projected(V, material):
        form += stress_power(material, *V.TnT()) * measure
    else:
        form += core.StressPower(V, CoefficientFunction(material.lam), CoefficientFunction(material.mu), measure)


def warn_of_locking(V: CrackFESpace, material: Isotropic, stabilisation: Stabilisation | None) -> None:
    """Says by an AccuracyWarning what does not go with a nearly incompressible material."""
    if not material.nearly_incompressible:
        return
    region = max(material.regions, key=lambda region: region.lam / region.mu)
    for doubt in [*doubts(V, stabilisation), *([ROUND_OFF] if region.lam > MOST * region.mu else [])]:
        warn(f"ContactProblem: the material is nearly incompressible (nu = {region.nu:.7g} in plane strain), and {doubt}")


def doubts(V: CrackFESpace, stabilisation: Stabilisation | None) -> list[str]:
    """What does not go with a nearly incompressible material, with its remedy."""
    if V.globalorder == 1:
        return [LOCKING]
    found = [] if projection_degree(V) >= V.globalorder - 1 else [NO_BUBBLE.format(order=V.globalorder)]
    if any(spec is not None and spec.basis == core.TipBasis.branch for spec in V.tip_specs):
        found.append(BRANCH)
    return [*found, AT_POINTS] if getattr(stabilisation, "System", None) else found
