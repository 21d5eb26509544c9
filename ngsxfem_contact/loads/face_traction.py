"""What acts on the faces of the cracks: given tractions, joints that are elastic, and the tractions that λ is compared with.

A face carries the contact traction and its own: with t⁺, t⁻ on the two faces, in the direction in which they act on the body,
and a given stress σ⁰,

    λ = n·(σ(u⁺) + σ⁰)n + n·t⁺ = n·(σ(u⁻) + σ⁰)n - n·t⁻,

the same with the tangent for λ_t. So R_h of (12) of [AHLMR12] is affine, R_h(u) + r_0: section 5 of docs/method.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ngsolve import CF, CoefficientFunction, IfPos, InnerProduct, sqrt

from .. import _ngsxfem_contact as core
from ..material import Isotropic
from ..spaces.incompressible import stress
from .terms import replaced, restriction, tested, unit_limits

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .._ngsxfem_contact import CrackedMesh, FormTerm
    from ..operators import Component
    from ..spaces.incompressible import WithoutPressure


@dataclass(frozen=True)
class FaceTractions:
    """t⁺ and t⁻, vectors on the cracks (CoefficientFunctions): forces on the plus and on the minus face for each unit of length, in space of area."""

    plus: CoefficientFunction
    minus: CoefficientFunction

    @staticmethod
    def Zero(dimension: int) -> FaceTractions:
        """No tractions."""
        return FaceTractions(CF((0.0,) * dimension), CF((0.0,) * dimension))

    def __add__(self, other: FaceTractions) -> FaceTractions:
        return FaceTractions(self.plus + other.plus, self.minus + other.minus)

    def __rmul__(self, factor: float) -> FaceTractions:
        return FaceTractions(factor * self.plus, factor * self.minus)

    def Shift(self, component: Component, side: str | None, body: CrackedMesh) -> CoefficientFunction:
        """What σn on a side ("plus", "minus", "larger") lacks to be the contact traction: t⁺ or -t⁻, one component of it."""
        direction = component.direction(body)
        along = {"plus": InnerProduct(self.plus, direction), "minus": -InnerProduct(self.minus, direction)}
        return along[side] if side in along else IfPos(body.larger_side, along["plus"], along["minus"])


class Joint:
    """Terms ∫ v^s·M_{st} u^t over the cracks, s, t ∈ {⁺, ⁻}: they act on the faces with t^s = -Σ_t M_{st} u^t.

    Parameters
    ----------
    terms
        Core.FormTerms in Plus, Minus or Jump of trial and test functions.
    """

    def __init__(self, terms: list[FormTerm]) -> None:
        self.terms, self.dimension = terms, terms[0].body.mesh.dim

    def Tractions(self, u: CoefficientFunction) -> FaceTractions:
        """The FaceTractions of u: trial function, test function, GridFunction or `Limits`."""
        return sum((self._of_term(term, u) for term in self.terms), FaceTractions.Zero(self.dimension))

    @staticmethod
    def _of_term(term: FormTerm, u: CoefficientFunction) -> FaceTractions:
        here, trial = restriction(term), replaced(term.trial, u.Operator)
        sides = (CF(tuple(tested(term, v.Operator).Replace(trial)[0].coef for v in pair)) for pair in unit_limits(term.body.mesh.dim))
        return FaceTractions(*(-here * side for side in sides))

    def Stiffness(self) -> CoefficientFunction:
        """A bound of the largest eigenvalue of M, a CoefficientFunction in stress / length."""
        tractions = [self.Tractions(u) for pair in unit_limits(self.dimension) for u in pair]
        return sqrt(sum(InnerProduct(side, side) for t in tractions for side in (t.plus, t.minus)))


@dataclass(frozen=True)
class ComparedTraction:
    """R_h: the linear part of what the multipliers are compared with.

    Parameters
    ----------
    material : Elasticity
    sides
        Weights by side, {"larger": 1} for R_h of (12).
    joint
        Joint, or None.
    """

    body: core.CrackedMesh
    material: Isotropic | WithoutPressure
    sides: Mapping[str, float]
    joint: Joint | None = None

    def Of(self, u: CoefficientFunction, component: Component, side: str | None) -> CoefficientFunction:
        """One component of σ(u)n on a side, and what the joint adds."""
        traction = component.traction(stress(self.material, u, side), self.body)
        return traction if self.joint is None else traction + self.joint.Tractions(u).Shift(component, side, self.body)

    def Summed(self, u: CoefficientFunction, component: Component) -> CoefficientFunction:
        """Σ w R_h(u) over the sides: the factor of γμ in C_γ."""
        return sum(w * self.Of(u, component, side) for side, w in self.sides.items())

    def Squared(self, u: CoefficientFunction, v: CoefficientFunction, components: Sequence[Component]) -> CoefficientFunction:
        """Σ w R_h(u) R_h(v) over sides and components: the integrand of K_γ without γ."""
        return sum(w * self.Of(u, component, side) * self.Of(v, component, side) for side, w in self.sides.items() for component in components)

    def WithGiven(self, v: CoefficientFunction, components: Sequence[Component], shift: Callable[..., Any]) -> CoefficientFunction:
        """Σ w r_0 R_h(v): what given loads add to F, without γ; shift(component, side) is r_0."""
        return sum(w * shift(component, side) * self.Of(v, component, side) for side, w in self.sides.items() for component in components)

    def Given(self, component: Component, shift: Callable[..., Any]) -> CoefficientFunction:
        """Σ w r_0 of one component: what given loads add to G, without γ."""
        return sum(w * shift(component, side) for side, w in self.sides.items())
