"""Laws of the faces beside contact and friction: elastic and rock joints, and cohesive cracks. Section 12 of docs/method.md."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, fields
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CoefficientFunction

from ..algebra.closures import HyperbolicClosure, LinearClosure
from ..algebra.face_relations import CohesiveRelation, ElasticRelation, SlidingRelation
from ..algebra.nodal_newton import Threshold
from ..algebra.softening import ExponentialSoftening, LinearSoftening
from ..arguments import INFINITY, check_function, check_number
from .nodal_law import NodalLaw

if TYPE_CHECKING:
    from ..algebra.softening import Softening
    from ..material import Coefficient
    from ..protocols import Points


class LawWithCoefficients(NodalLaw):
    """A dataclass whose fields are coefficients, ≥ 0: numbers, which are checked at once, or CoefficientFunctions, checked at the nodes."""

    positive: tuple[str, ...] = ()
    may_be_infinite: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in self._names():
            value = getattr(self, name)
            check_function(value, self._called(name), 1)
            if not isinstance(value, CoefficientFunction):
                check_number(value, self._called(name), partial(self._allows, name), f"be {self._must(name)}")

    def Values(self, nodes: Points, name: str) -> np.ndarray:
        """(n,): a coefficient in the mean at each node, so that ∫f is right. Raises ValueError for one that makes no sense at a node."""
        value = getattr(self, name)
        if not isinstance(value, CoefficientFunction):
            return np.full(len(nodes), float(value))
        values = nodes.Values(value)
        wrong = [i for i in range(len(nodes)) if not self._allows(name, float(values[i]))]
        if wrong:
            raise ValueError(f"{self._called(name)} is {values[wrong[0]]} at {nodes.Place(wrong[0])}: it must be {self._must(name)}")
        return nodes.Means(value)

    def _names(self) -> list[str]:
        return [each.name for each in fields(self)]  # type: ignore[arg-type]

    def _called(self, name: str) -> str:
        return f"{type(self).__name__}: {name}"

    def _allows(self, name: str, number: float) -> bool:
        return (number > 0 or (number == 0 and name not in self.positive)) and (number < INFINITY or (number == INFINITY and name in self.may_be_infinite))

    def _must(self, name: str) -> str:
        return f"{'' if name in self.may_be_infinite else 'finite and '}{'> 0' if name in self.positive else '>= 0'}"


@dataclass(frozen=True)
class Joint(LawWithCoefficients):
    """An elastic joint: λ_n = k_n g_n, λ_t = k_t g_t; where it is closed, g_n < 0, λ_n = k_closed g_n.

    Parameters
    ----------
    k_n, k_t
        Stiffnesses, stress / length: numbers or CoefficientFunctions ≥ 0, float("inf") for faces that are tied.
    k_closed
        In compression; float("inf") (default): the faces touch and do not give way.

    Raises
    ------
    ValueError
        For a coefficient that is negative or NaN.
    """

    k_n: Coefficient
    k_t: Coefficient
    k_closed: Coefficient = INFINITY

    depends_on_path = False
    may_be_infinite = ("k_n", "k_t", "k_closed")

    def At(self, nodes: Points) -> ElasticRelation:
        """The relation at nodes."""
        return ElasticRelation(*(self.Values(nodes, name) for name in ("k_n", "k_t", "k_closed")))


class Cohesive(LawWithCoefficients):
    """What cohesive laws share: rigid until the strength, then softening with the largest opening κ so far, irreversible; contact where it closes.

    The effective opening is d² = max(g_n, 0)² + beta² g_t²; with S = f(κ)/κ the tractions are λ_n = S g_n where it is open, λ_t = beta² S g_t, so that it unloads to
    the origin. The work of separation is the same in all modes, G_c.
    """

    beta: Coefficient

    @abstractmethod
    def Softening(self, nodes: Points) -> Softening:
        """f at the nodes."""

    def At(self, nodes: Points) -> CohesiveRelation:
        """The relation at nodes."""
        return CohesiveRelation(self.Softening(nodes), self.Values(nodes, "beta"))


@dataclass(frozen=True)
class CohesiveWithEnergy(Cohesive):
    """Those that separate: with a strength, a stress, and the work G_c that it takes."""

    strength: Coefficient
    G_c: Coefficient
    beta: Coefficient = 1.0

    positive = ("G_c", "beta")


@dataclass(frozen=True)
class LinearCohesive(CohesiveWithEnergy):
    """A cohesive crack with f = strength (1 - κ/κ_c), κ_c = 2 G_c / strength.

    Parameters
    ----------
    strength
        A stress, a number or CoefficientFunction ≥ 0; 0: nothing holds the faces together there.
    G_c
        The work of separation, stress × length, > 0.
    beta
        How much shear counts, > 0: the strength in shear is beta × strength.

    Raises
    ------
    ValueError
        For coefficients that make no sense.
    """

    @property
    def softening(self) -> Coefficient:
        """At the beginning."""
        return 0.5 * self.strength * self.strength / self.G_c

    def Softening(self, nodes: Points) -> LinearSoftening:
        """f at the nodes."""
        strength = self.Values(nodes, "strength")
        return LinearSoftening(strength, 0.5 * strength**2 / self.Values(nodes, "G_c"))


@dataclass(frozen=True)
class ExponentialCohesive(CohesiveWithEnergy):
    """A cohesive crack with f = strength exp(-κ strength / G_c).

    Parameters
    ----------
    strength, G_c, beta
        As for LinearCohesive.

    Raises
    ------
    ValueError
        For coefficients that make no sense.
    """

    @property
    def softening(self) -> Coefficient:
        """At the beginning."""
        return self.strength * self.strength / self.G_c

    def Softening(self, nodes: Points) -> ExponentialSoftening:
        """f at the nodes."""
        strength = self.Values(nodes, "strength")
        return ExponentialSoftening(strength, strength / self.Values(nodes, "G_c"))


@dataclass(frozen=True)
class Dugdale(Cohesive):
    """A cohesive crack with a constant traction, f = strength, whatever the opening: the strip of Dugdale (1960).

    Parameters
    ----------
    strength, beta
        As for LinearCohesive.

    Raises
    ------
    ValueError
        For coefficients that make no sense.
    """

    strength: Coefficient
    beta: Coefficient = 1.0

    positive = ("beta",)

    def Softening(self, nodes: Points) -> LinearSoftening:
        """f at the nodes."""
        return LinearSoftening(self.Values(nodes, "strength"), np.zeros(len(nodes)))


@dataclass(frozen=True)
class MohrCoulomb(LawWithCoefficients):
    """Faces that touch, and slide at |λ_t| = cohesion + mu_f |λ_n|; sliding opens them by the tangent of an angle of dilation.

    Parameters
    ----------
    mu_f
        ≥ 0.
    cohesion
        A stress ≥ 0, where the faces touch; nothing resists their opening.
    dilation
        tan ψ ≥ 0: g_n grows by tan ψ times the way that the faces slide.
    k_n, k_t
        Stiffnesses of the closed faces, stress / length, > 0; float("inf") (default): rigid.

    Raises
    ------
    ValueError
        For coefficients that make no sense.
    """

    mu_f: Coefficient
    cohesion: Coefficient = 0.0
    dilation: Coefficient = 0.0
    k_n: Coefficient = INFINITY
    k_t: Coefficient = INFINITY

    positive = ("k_n", "k_t")
    may_be_infinite = ("k_n", "k_t")

    def At(self, nodes: Points) -> SlidingRelation:
        """The relation at nodes."""
        mu_f, cohesion, dilation, k_n, k_t = (self.Values(nodes, name) for name in self._names())
        return SlidingRelation(LinearClosure(k_n), Threshold(cohesion, mu_f, in_contact_only=True), k_t, dilation)


@dataclass(frozen=True)
class BartonBandis(LawWithCoefficients):
    """A rock joint: under the pressure p it closes by p / (k_n0 + p/v_m), and slides at |λ_t| = mu_f p.

    Parameters
    ----------
    k_n0
        The stiffness at first, stress / length, > 0.
    v_m
        The largest closure, a length > 0.
    mu_f
        Of friction, ≥ 0.

    Raises
    ------
    ValueError
        For coefficients that make no sense.

    References
    ----------
    Bandis, Lumsden, Barton, Fundamentals of rock joint deformation, Int. J. Rock Mech. Min. Sci. 20 (1983) 249-268.
    """

    k_n0: Coefficient
    v_m: Coefficient
    mu_f: Coefficient = 0.0

    positive = ("k_n0", "v_m")

    def At(self, nodes: Points) -> SlidingRelation:
        """The relation at nodes."""
        k_n0, v_m, mu_f = (self.Values(nodes, name) for name in self._names())
        rigid, nothing = np.full(len(nodes), INFINITY), np.zeros(len(nodes))
        return SlidingRelation(HyperbolicClosure(k_n0, v_m), Threshold(nothing, mu_f), rigid, nothing)
