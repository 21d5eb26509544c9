"""Circular and elliptic cracks in infinite space, loaded on their faces: closed forms (3b) to (3h) of docs/method.md, section 10.

Confocal coordinates (ζ, w) of a crack x²/a² + y²/b² ≤ 1: ζ² the largest root of x²/(a²+ζ²) + y²/(b²+ζ²) + z²/ζ² = 1, w = z/ζ. On the crack ζ = 0 and
w = ±√(1 - x²/a² - y²/b²), on its plane beside it w = 0; both are smooth away from the front. Stresses decay at infinity; add `uniform_stress` for a remote load.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import ellipe

from .jets import Jet, arccot, choose, root
from .space_forms import SpaceForm, stress_matrix, uniform_stress

if TYPE_CHECKING:
    from ..material import Isotropic

TINY = 1e-300  # what else would be 0/0 in the branch that is not taken
STEPS = 7  # of the iterations for ζ and of Carlson's for R_D, each to round-off


def confocal(x: Any, y: Any, z: Any, a: float, b: float, side: int = 0) -> tuple[Any, Any]:
    """ζ and w with as many derivatives as x, y, z, which are Jet.Variables, or values."""
    if not isinstance(x, Jet):
        return _confocal_values(x, y, z, a, b, side)
    x, y, z = x.value, y.value, z.value
    zeta, w = confocal(x, y, z, a, b, side)
    first, second = x / (a * a + zeta * zeta), y / (b * b + zeta * zeta)
    in_plane = first * first + second * second
    D = w * w + zeta * zeta * in_plane
    return Jet(zeta, (zeta * first / D, zeta * second / D, w / D)), Jet(w, (-w * first / D, -w * second / D, zeta * in_plane / D))


def _confocal_values(x: Any, y: Any, z: Any, a: float, b: float, side: int) -> tuple[Any, Any]:
    """From Λ = ζ², the larger root of Λ (q + Λ m(Λ)) = z²: exact for a circle; else with m fixed, then by Newton's method on this convex function of Λ."""
    square = x * x + y * y + z * z - b * b
    q = 1 - x * x / (a * a) - y * y / (b * b)
    m = lambda L: x * x / (a * a * (a * a + L)) + y * y / (b * b * (b * b + L))
    L = 0.5 * (root(square * square + 4 * b * b * z * z) + square)  # of the circle of radius b
    if a != b:
        for _ in range(3):
            L = _larger_root(q, m(L), z)
        for _ in range(STEPS):
            first, second = x / (a * a + L), y / (b * b + L)
            L = _positive(L - (L * (q + L * m(L)) - z * z) / (q + L * m(L) + L * (first * first + second * second) + TINY))
    L = _larger_root(q, m(L), z)  # without cancellation
    height = choose(z, z, -z)
    w = root(_positive(q + L * m(L)))
    zeta = choose(q, height / (w + TINY), root(L))
    sign = side if side else choose(-z, -1.0, 1.0)
    return zeta, sign * choose(q, w, height / (zeta + TINY))


def _positive(f: Any) -> Any:
    return choose(f, f, 0 * f)


def _larger_root(q: Any, m: Any, z: Any) -> Any:
    """Of Λ (q + m Λ) = z²."""
    s = root(q * q + 4 * m * z * z)
    return choose(q, 2 * z * z / (q + s + TINY), 0.5 * (s - q) / (m + TINY))


def carlson_rd(x: Any, y: Any, z: Any) -> Any:
    """R_D(x, y, z) = (3/2) ∫ ds / ((s+z) √((s+x)(s+y)(s+z))), s from 0 to ∞.

    References
    ----------
    B. C. Carlson, Numerical computation of real or complex elliptic integrals, Numer. Algorithms 10 (1995) 13-26.
    """
    total, power = 0.0, 1.0
    for _ in range(STEPS):
        sx, sy, sz = root(x), root(y), root(z)
        shift = sx * sy + sy * sz + sz * sx
        total = total + power / (sz * (z + shift))
        power *= 0.25
        x, y, z = 0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift)
    mean = 0.2 * (x + y + 3 * z)
    X, Y = 1 - x / mean, 1 - y / mean
    Z = -(X + Y) / 3
    E2, E3, E4, E5 = X * Y - 6 * Z * Z, (3 * X * Y - 8 * Z * Z) * Z, 3 * (X * Y - Z * Z) * Z * Z, X * Y * Z * Z * Z
    series = 1 - 3 / 14 * E2 + E3 / 6 + 9 / 88 * E2 * E2 - 3 / 22 * E4 - 9 / 52 * E2 * E3 + 3 / 26 * E5
    return 3 * total + power * series / (mean * root(mean))


def _attraction(zeta: Any, a: float, b: float) -> Any:
    """∫ ds / ((a²+s) √(s(a²+s)(b²+s))), s from ζ² to ∞; a Jet of order 1."""
    L = zeta.value * zeta.value
    alpha, beta = a * a + L, b * b + L
    return zeta.Chain(2 / 3 * carlson_rd(beta, L, alpha), -2 / (alpha * root(alpha * beta)))


def ellipse(material: Isotropic, a: float, b: float, p: float = 1) -> SpaceForm:
    """(3h): x²/a² + y²/b² ≤ 1 under the pressure p on its faces, b ≤ a.  K_I = p √(πb)/E(k) (sin² t + (b/a)² cos² t)^{1/4} at x = a cos t (Irwin)."""
    if not 0.05 * a <= b <= a:
        raise ValueError(f"ellipse: the half axes a={a}, b={b} must fulfil a/20 ≤ b ≤ a; turn the ellipse by axes")
    mu, nu, E = material.mu, material.nu, float(ellipe(1 - b * b / (a * a)))
    C = a * b * b * p / (4 * E)

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        x, y, z = Jet.Variables(X, Y, Z)
        zeta, w = confocal(x, y, z, a, b, side)
        alpha, beta, I, J = a * a + zeta * zeta, b * b + zeta * zeta, _attraction(zeta, a, b), _attraction(zeta, b, a)
        first, second, Delta = x / alpha, y / beta, root(alpha * beta)
        D = w * w + zeta * zeta * (first * first + second * second)
        mixed, along = 4 * C * w * w * zeta / (D * Delta), 4 * C * zeta / (D * Delta)
        flat = along * (first * first + second * second) - 2 * C * (I + J)  # φ_xx + φ_yy = -φ_zz
        phi_z = -2 * C * w * (2 / Delta - zeta * (I + J))
        plane = [(1 - 2 * nu) * -2 * C * x * I + mixed * first, (1 - 2 * nu) * -2 * C * y * J + mixed * second]
        return [1 / (2 * mu) * f for f in (*plane, -2 * (1 - nu) * phi_z - z * flat)]

    def jump(X: Any, Y: Any) -> tuple[Any, ...]:
        return 0 * X, 0 * X, 2 * (1 - nu) * p * b / (mu * E) * root(_positive(1 - X * X / (a * a) - Y * Y / (b * b)))

    def factors(X: Any, Y: Any) -> tuple[Any, ...]:
        return p * sqrt(pi * b) / E * ((Y / b) ** 2 + (b / a) ** 2 * (X / a) ** 2) ** 0.25, 0 * X, 0 * X

    return SpaceForm(material, displacement, lambda X, Y: (0 * X, 0 * X, -p + 0 * X), jump, factors)


def _root_of_disk(a: float, X: Any, Y: Any) -> Any:
    """√(a² - ρ²)."""
    return root(_positive(a * a - X * X - Y * Y))


def _oblate(X: Any, Y: Any, Z: Any, a: float, side: int, order: int = 1) -> tuple[Any, ...]:
    """x, y, z, ξ = ζ/a, η = w and arccot ξ as Jets."""
    x, y, z = Jet.Variables(X, Y, Z, order)
    zeta, eta = confocal(x, y, z, a, a, side)
    xi = 1 / a * zeta
    return x, y, z, xi, eta, arccot(xi)


def _of_potential(material: Isotropic, phi: Jet, phi_z: Jet, z: Any) -> list[Any]:
    """u of a harmonic φ and φ_z, Jets of order 2: 2μ(u_x, u_y) = (1-2ν)(φ_x, φ_y) + z(φ_xz, φ_yz), 2μu_z = -2(1-ν)φ_z + zφ_zz; σ_zz = -φ_zz on z = 0, without shear."""
    mu, nu = material.mu, material.nu
    plane = [(1 - 2 * nu) * phi.slopes[i] + z * phi_z.slopes[i] for i in range(2)]
    return [1 / (2 * mu) * f for f in (*plane, -2 * (1 - nu) * phi_z.value + z * phi_z.slopes[2])]


def penny(material: Isotropic, a: float, p: float = 1) -> SpaceForm:
    """(3b): ρ ≤ a under the pressure p on its faces.  K_I = 2p √(a/π)."""
    mu, nu = material.mu, material.nu

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        x, y, z, xi, eta, A = _oblate(X, Y, Z, a, side)
        D, g = xi * xi + eta * eta, A - xi / (1 + xi * xi)
        plane = p / (2 * pi * mu) * (2 * xi * eta * eta / (D * (1 + xi * xi)) - (1 - 2 * nu) * g)
        return [x * plane, y * plane, p / (pi * mu) * (2 * (1 - nu) * (a * eta - z * A) + z * (A - xi / D))]

    jump = lambda X, Y: (0 * X, 0 * X, 4 * (1 - nu) * p / (pi * mu) * _root_of_disk(a, X, Y))
    return SpaceForm(material, displacement, lambda X, Y: (0 * X, 0 * X, -p + 0 * X), jump, lambda X, Y: (2 * p * sqrt(a / pi) + 0 * X, 0 * X, 0 * X))


def sheared_penny(material: Isotropic, a: float, tau: float = 1) -> SpaceForm:
    """(3c): ρ ≤ a under σ_xz = -τ on its faces.  K_II = 4τ cos φ/(2-ν) √(a/π), K_III = 4(1-ν)τ sin φ/(2-ν) √(a/π)."""
    mu, nu = material.mu, material.nu
    C = -2 * tau / (pi * mu * (2 - nu))

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        x, y, z, xi, eta, A = _oblate(X, Y, Z, a, side)
        D, s = xi * xi + eta * eta, 1 + xi * xi
        g, E = A - xi / s, 1 / (a * a) * xi / (D * s * s)
        along = C * (-2 * (1 - nu) * (a * eta - z * A) + 0.5 * z * (g - 2 * x * x * E))
        return [along, -C * z * x * y * E, -C * x * (0.5 * (1 - 2 * nu) * g + xi * eta * eta / (D * s))]

    jump = lambda X, Y: (8 * (1 - nu) * tau / (pi * mu * (2 - nu)) * _root_of_disk(a, X, Y), 0 * X, 0 * X)

    def factors(X: Any, Y: Any) -> tuple[Any, ...]:
        size, rho = 4 * tau / (2 - nu) * sqrt(a / pi), np.hypot(X, Y)
        return 0 * X, size * X / rho, (1 - nu) * size * Y / rho

    return SpaceForm(material, displacement, lambda X, Y: (-tau + 0 * X, 0 * X, 0 * X), jump, factors)


def twisted_penny(material: Isotropic, a: float, tau: float = 1) -> SpaceForm:
    """(3e): ρ ≤ a under σ_φz = -τρ/a on its faces.  K_III = -(4/3) τ √(a/π)."""
    k = 4 * tau / (3 * pi * material.mu)

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        x, y, _, xi, eta, A = _oblate(X, Y, Z, a, side)
        turn = -0.5 * k * eta * (3 * xi * A - 3 + 1 / (1 + xi * xi))
        return [-y * turn, x * turn, 0 * X]

    def jump(X: Any, Y: Any) -> tuple[Any, ...]:
        turn = 2 * k / a * _root_of_disk(a, X, Y)
        return -Y * turn, X * turn, 0 * X

    traction = lambda X, Y: (tau / a * Y, -tau / a * X, 0 * X)
    return SpaceForm(material, displacement, traction, jump, lambda X, Y: (0 * X, 0 * X, -4 / 3 * tau * sqrt(a / pi) + 0 * X))


def bent_penny(material: Isotropic, a: float, s: float = 1) -> SpaceForm:
    """(3f): ρ ≤ a under the pressure s x on its faces.  K_I = (4/3) s a cos φ √(a/π); open together with `penny` of p ≥ ⅔ s a."""
    mu, nu = material.mu, material.nu

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        x, _, z, xi, eta, A = _oblate(X, Y, Z, a, side, order=2)
        first = xi / (1 + xi * xi) - A  # q₁′
        third = 0.5 * ((15 * xi * xi + 3) * A - xi * (15 * xi * xi + 13) / (1 + xi * xi))  # q₃′
        phi = 2 * s * a * a / (3 * pi) * x * ((15 * eta * eta - 3) * third * (1 / 60) - 0.2 * first)
        phi_z = 2 * s * a / (3 * pi) * x * eta * (3 * xi * A - 3 + 1 / (1 + xi * xi))
        return _of_potential(material, phi, phi_z, z.value)

    jump = lambda X, Y: (0 * X, 0 * X, 8 * (1 - nu) * s / (3 * pi * mu) * X * _root_of_disk(a, X, Y))
    factors = lambda X, Y: (4 / 3 * s * a * sqrt(a / pi) * X / np.hypot(X, Y), 0 * X, 0 * X)
    return SpaceForm(material, displacement, lambda X, Y: (0 * X, 0 * X, -s * X), jump, factors)


def partially_closed(material: Isotropic, c: float, p0: float = 1) -> SpaceForm:
    """(3g): a crack under σ_zz = p₀ - p₂ρ², p₂ = 3p₀/(2c²), open for ρ < c, where the gap is 8(1-ν)p₀/(3πμc²) (c²-ρ²)^{3/2}, closed from there to any front.

    λ = p₀ (1 - 3ρ²/(2c²) (1 - 2/π (S - t√(1-t²))) - 2/π S), t = c/ρ, S = arcsin t. No K: it is singular nowhere.
    """
    mu, nu = material.mu, material.nu
    kappa, p2 = 4 * p0 / (3 * pi * c * c), 3 * p0 / (2 * c * c)

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        x, y, z, xi, eta, A = _oblate(X, Y, Z, c, side, order=2)
        e, k = eta * eta, xi * xi
        P2, P4 = 0.5 * (3 * e - 1), 0.125 * (35 * e * e - 30 * e + 3)
        q1, q2, q3 = 1 - xi * A, 0.5 * ((3 * k + 1) * A - 3 * xi), 0.5 * xi * (5 * k + 3) * A - 2.5 * k - 2 / 3
        q4 = 0.125 * ((35 * k * k + 30 * k + 3) * A - 35 * k * xi - 55 / 3 * xi)
        rho2, z2 = x * x + y * y, z * z
        phi = 0.6 * kappa * c**4 * ((P4 * q4 + P2 * q2) * (1 / 7) + (P2 * q2 + A) * (1 / 3))
        phi = phi - 0.5 * p0 * (z2 - 0.5 * rho2) - p2 / 6 * (z2 * z2 - 3 * z2 * rho2 + 0.375 * rho2 * rho2)
        phi_z = 0.6 * kappa * c**3 * (0.5 * eta * (5 * e - 3) * q3 - eta * q1) - p0 * z - p2 / 6 * (4 * z2 * z - 6 * z * rho2)
        return _of_potential(material, phi, phi_z, z.value)

    def traction(X: Any, Y: Any) -> tuple[Any, ...]:
        rho2 = X * X + Y * Y
        outside = choose(rho2 - c * c, rho2, c * c + 0 * rho2)
        t = c / root(outside)
        # arcsin t = arccot √(1/t² - 1)
        S = arccot(root(_positive(1 / (t * t) - 1)))
        closed = p0 * (1 - 1.5 * outside / (c * c) * (1 - 2 / pi * (S - t * root(_positive(1 - t * t)))) - 2 / pi * S)
        return 0 * X, 0 * X, choose(rho2 - c * c, closed, 0 * X)

    def jump(X: Any, Y: Any) -> tuple[Any, ...]:
        open_part = _root_of_disk(c, X, Y)
        return 0 * X, 0 * X, 8 * (1 - nu) * p0 / (3 * pi * mu * c * c) * open_part * open_part * open_part

    return SpaceForm(material, displacement, traction, jump)


def penny_in_tension(material: Isotropic, a: float, p: float = 1) -> SpaceForm:
    """(3b) with the remote stress σ_zz = p: the faces are free of traction."""
    return penny(material, a, p) + uniform_stress(material, stress_matrix(zz=p))


def closed_penny(material: Isotropic, a: float, p: float = 1, tau: float = 1, friction: float = 0) -> SpaceForm:
    """(3d): remote σ_zz = -p, σ_xz = τ > μ_f p. The faces touch, λ = -p, and slide along x against the friction μ_f p; K_II, K_III are those of the shear τ - μ_f p."""
    carried = friction * p
    if not tau > carried:
        raise ValueError(f"closed_penny: tau={tau} does not exceed the friction {carried}; the faces stick, see uniform_stress")
    return sheared_penny(material, a, tau - carried) + uniform_stress(material, stress_matrix(zz=-p, xz=tau))
