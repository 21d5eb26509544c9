"""(3i) of docs/method.md, section 10: straight fronts along e₃ in any body, in plane strain and antiplane shear."""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING, Any

from .jets import Jet, choose, root
from .space_forms import SpaceForm

if TYPE_CHECKING:
    from ..material import Isotropic


def straight_front(material: Isotropic, K_I: float = 0, K_II: float = 0, K_III: float = 0) -> SpaceForm:
    """The crack X < 0 of the plane Z = 0 with the front X = 0, so that e₁, e₂ are the X- and Z-axis and e₃ is -Y: the fields of K_I, K_II, K_III and no others.

    In every plane Y = const the displacement is √r times functions of the angle, so that the body may be any that contains a part of the front.
    """
    mu, kappa = material.mu, 3 - 4 * material.nu

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        c, s, r = _half_angle(X, Z, side)
        cc, ss = c * c / r, s * s / r
        scale = 1 / (2 * mu * sqrt(2 * pi))
        ahead = K_I * c * (kappa - 1 + 2 * ss) + K_II * s * (kappa + 1 + 2 * cc)
        normal = K_I * s * (kappa + 1 - 2 * cc) - K_II * c * (kappa - 1 - 2 * ss)
        return [scale * ahead, -4 * K_III * scale * s, scale * normal]

    def jump(X: Any, Y: Any) -> tuple[Any, ...]:
        scale = (kappa + 1) / (mu * sqrt(2 * pi)) * root(choose(-X, -X, 0 * X))
        return scale * K_II, -4 / (kappa + 1) * scale * K_III, scale * K_I

    factors = lambda X, Y: (K_I + 0 * X, K_II + 0 * X, K_III + 0 * X)
    return SpaceForm(material, displacement, lambda X, Y: (0 * X, 0 * X, 0 * X), jump, factors)


def _half_angle(X: Any, Z: Any, side: int) -> tuple[Jet, Jet, Jet]:
    """√r cos(θ/2), √r sin(θ/2) and r, θ the angle of (X, Z) in (-π, π], as Jets of order 1."""
    r = root(X * X + Z * Z + 1e-200)
    large = root(0.5 * (r + choose(X, X, -X)))
    small = 0.5 * choose(Z, Z, -Z) / large
    sign = side if side else choose(-Z, -1.0, 1.0)
    c, s = choose(X, large, small), sign * choose(X, small, large)
    half = 0.5 / r
    return Jet(c, (c * half, 0.0, s * half)), Jet(s, (-1 * s * half, 0.0, c * half)), Jet(r, (X / r, 0.0, Z / r))
