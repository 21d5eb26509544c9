"""Cracks whose stress intensity factors are known: in the infinite plate in closed form, in finite plates from handbooks."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, log, pi, sin, sqrt, tan
from typing import TYPE_CHECKING, Any

from ngsolve import CF, CoefficientFunction, x, y
from ngsolve import sqrt as root

from .closed_forms import half_angle

if TYPE_CHECKING:
    from ..material import Isotropic


@dataclass(frozen=True)
class InfinitePlate:
    """u (2) in the whole plane, the factors at both tips (K_II: the sign of the slip), the multiplier σ_n on the crack."""

    u: CoefficientFunction
    K_I: float
    K_II: float
    sigma_n: float


def infinite_plate(material: Isotropic, a: Any, normal: float, shear: float, along: float = 0, friction: float = 0) -> InfinitePlate:
    """The crack |x| < a, y = 0 under σ_yy = normal, σ_xy = shear, σ_xx = along at infinity.

    Westergaard's functions Z = σ z/√(z² - a²): K_I = normal √(πa), K_II = shear √(πa). Under compression the faces touch,
    σ_n = normal, K_I = 0, and friction (the coefficient of Coulomb) carries up to friction |normal| of the shear.
    """
    opening = max(normal, 0)
    carried = min(abs(shear), friction * max(-normal, 0)) * (1 if shear > 0 else -1)
    kappa, mu = material.kappa, material.mu
    uniform = _uniform(material, along - opening, normal - opening, carried)
    re, im = _root(a)  # √(z² - a²)
    square = re * re + im * im
    re_Z, im_Z = (x * re + y * im) / square, (y * re - x * im) / square  # z/√(z² - a²)
    first = CF((0.5 * (kappa - 1) * re - y * im_Z, 0.5 * (kappa + 1) * im - y * re_Z))
    second = CF((0.5 * (kappa + 1) * im + y * re_Z, -0.5 * (kappa - 1) * re - y * im_Z))
    u = uniform + 0.5 / mu * (opening * first + (shear - carried) * second)
    return InfinitePlate(u, opening * sqrt(pi * a), (shear - carried) * sqrt(pi * a), min(normal, 0))


def _root(a: Any) -> tuple[CoefficientFunction, CoefficientFunction]:
    """Real and imaginary part of √(z - a) √(z + a): the cut is the crack."""
    (c1, s1), (c2, s2) = (half_angle(x - d, y, root((x - d) ** 2 + y**2 + 1e-200)) for d in (a, -a))
    return c1 * c2 - s1 * s2, c1 * s2 + s1 * c2


def _uniform(material: Isotropic, xx: float, yy: float, xy: float) -> CoefficientFunction:
    """The linear displacement of a uniform stress."""
    return material.Strain(CF((xx, xy, xy, yy), dims=(2, 2))) * CF((x, y))


def inclined(stress: float, psi: float) -> tuple[float, float, float]:
    """(normal, shear, along) on a crack under uniaxial `stress` whose axis makes the angle psi with the crack.

    The axis points to (cos ψ, sin ψ) in the crack's coordinates. For compression, stress = -σ, with the angle of friction φ:
    K_II = -σ sin ψ (cos ψ - sin ψ tan φ) √(πa), as long as it slips.
    """
    return stress * sin(psi) ** 2, stress * sin(psi) * cos(psi), stress * cos(psi) ** 2


def single_edge_tension(ratio: float) -> float:
    """K_I / (σ√(πa)) of an edge crack a = ratio W in a long strip of width W: Tada, Paris, Irwin, The Stress Analysis of Cracks Handbook, within 0.5 %."""
    half = pi * ratio / 2
    return sqrt(tan(half) / half) * (0.752 + 2.02 * ratio + 0.37 * (1 - sin(half)) ** 3) / cos(half)


def centre_crack_tension(ratio: float) -> float:
    """K_I / (σ√(πa)) of a central crack 2a = ratio 2W in a long strip of width 2W: Tada, Paris, Irwin, within 0.1 %."""
    return (1 - 0.025 * ratio**2 + 0.06 * ratio**4) / sqrt(cos(pi * ratio / 2))


@dataclass(frozen=True)
class DugdaleStrip:
    """Where the zone of constant traction ends, its length measured from the middle of the crack, and the opening at the tip of the crack."""

    end: float
    opening: float


def dugdale_strip(a: float, stress: float, strength: float, modulus: float) -> DugdaleStrip:
    """The crack |x| < a under σ_yy = stress at infinity whose ligament yields at a strength: c = a sec(π σ / 2 σ_y), 8 σ_y a / (π E′) ln(c/a).

    modulus: E′, E in plane stress. Dugdale, J. Mech. Phys. Solids 8 (1960) 100-104; the opening is that of Burdekin and Stone, J. Strain Analysis 1 (1966) 145-153.
    """
    secant = 1 / cos(pi * stress / (2 * strength))
    return DugdaleStrip(a * secant, 8 * strength * a / (pi * modulus) * log(secant))
