"""Closed-form solutions with a crack on y = 0, plane strain, no body force: (a) to (e) in section 10 of docs/method.md.

They hold in the whole plane, so that any polygon may be the body: rotate and shift the body, not the formulas.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import CF, CoefficientFunction, IfPos, InnerProduct, Integrate, Mesh, atan2, cos, exp, sin, sqrt, x, y

from .._ngsxfem_contact import Crack
from ..operators import Slip

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..contact.solution import ContactSolution
    from ..material import Isotropic


def half_angle(
    X: CoefficientFunction, Y: CoefficientFunction, r: CoefficientFunction, side: CoefficientFunction | int | None = None
) -> tuple[CoefficientFunction, CoefficientFunction]:
    """√r cos(θ/2), √r sin(θ/2), θ the angle of (X, Y).

    Parameters
    ----------
    side
        None for θ in (-π, π]; otherwise ±1, which of the two sides of the cut a point with X < 0 belongs to: the cut may be any curve that leaves the
        origin at θ = π.
    """
    large = sqrt(0.5 * (r + IfPos(X, X, -X)))
    small = 0.5 * IfPos(Y, Y, -Y) / large
    sign = IfPos(-Y, -1, 1)
    behind = sign if side is None else side
    return IfPos(X, large, sign * behind * small), IfPos(X, sign * small, behind * large)


@dataclass(frozen=True)
class ClosedForm:
    """Exact fields as CoefficientFunctions of x and y: u (2), stress (2, 2), and on the crack pressure = σ_n ≤ 0, gap, shear = σ_t, slip."""

    u: CoefficientFunction
    stress: CoefficientFunction
    pressure: CoefficientFunction
    gap: CoefficientFunction
    shear: CoefficientFunction = CF(0)
    slip: CoefficientFunction | None = None


def uniform_compression(material: Isotropic, p: float = 1, sigma_xx: float = 0.3) -> ClosedForm:
    """(a): a closed crack under σ_yy = -p, σ_xx given; u is linear."""
    strain = material.Strain(CF((sigma_xx, 0, 0, -p), dims=(2, 2)))
    return ClosedForm(strain * CF((x, y)), _matrix(CF(sigma_xx), CF(0), CF(-p)), CF(-p), CF(0))


def uniform_stress(material: Isotropic, sigma_xx: float, sigma_xy: float, sigma_yy: float) -> ClosedForm:
    """A sticking, closed crack under constant stress, σ_yy ≤ 0: the body without a crack."""
    closed = uniform_compression(material, -sigma_yy, sigma_xx)
    u = closed.u + 0.5 * sigma_xy / material.mu * CF((y, x))
    return ClosedForm(u, _matrix(CF(sigma_xx), CF(sigma_xy), CF(sigma_yy)), CF(sigma_yy), CF(0), CF(sigma_xy), CF(0))


def sticking_crack(material: Isotropic, a: Any = 1.5, p: float = 10) -> Any:
    """The uncracked body under Airy's function cos(ax) exp(-ay) and σ_yy = -p: smooth, sheared, closed where p is large."""
    wave = exp(-a * y)
    u, uniform = CF((a * sin(a * x), a * cos(a * x))) * wave / (2 * material.mu), uniform_stress(material, 0, 0, -p)
    xx, xy = a * a * cos(a * x) * wave, -a * a * sin(a * x) * wave
    return ClosedForm(u + uniform.u, _matrix(xx, xy, -xx) + uniform.stress, -xx - p, CF(0), xy, CF(0))


def williams_tip(material: Isotropic, opening: Sequence[float] = (), sliding: Sequence[float] = (), p: float = 0, tip: float = 0) -> ClosedForm:
    """Williams' expansion at a tip (tip, 0) with the crack on x < tip, and σ_yy = -p: open without p, closed without opening terms.

    Parameters
    ----------
    opening, sliding
        The coefficients of r^{m-1/2}, m = 1, 2, ..., with lips free of traction: φ = a z^{m-1/2}, a √(2π) = opening - i sliding, of Kolosov's
        2μ (u_x + i u_y) = κ φ - z φ'* - ψ*. The first ones are K_I and K_II. The jumps are (κ+1)/(μ √(2π)) (-1)^{m-1} (-x)^{m-1/2} times the coefficients.
    """
    X, kappa, scale = x - tip, material.kappa, 1 / np.sqrt(2 * pi)
    r, theta = sqrt(X * X + y * y + 1e-200), atan2(y, X)
    rotated = lambda c, k: (c.real * cos(k * theta) - c.imag * sin(k * theta), c.real * sin(k * theta) + c.imag * cos(k * theta))
    closed = uniform_compression(material, p, 0)
    u, stress, jumps = closed.u, closed.stress, [CF(0), CF(0)]
    for m, pair in enumerate(zip_longest(opening, sliding, fillvalue=0.0)):
        power, a = m + 0.5, scale * complex(pair[0], -pair[1])
        b = a.conjugate() - power * a
        displacement = [kappa * f - g - h for f, g, h in zip(rotated(a, power), rotated(power * a.conjugate(), 2 - power), rotated(b.conjugate(), -power))]
        mean = 2 * power * rotated(a, power - 1)[0]
        shift, shear = (f + g for f, g in zip(rotated(power * (power - 1) * a, power - 3), rotated(power * b, power - 1)))
        u = u + r**power / (2 * material.mu) * CF(tuple(displacement))
        stress = stress + r ** (power - 1) * _matrix(mean - shift, shear, mean + shift)
        behind = (-1) ** m * scale * (kappa + 1) / material.mu * IfPos(-X, -X, 0) ** power
        jumps = [jump + coefficient * behind for jump, coefficient in zip(jumps, pair)]
    return ClosedForm(u, stress, CF(-p), jumps[0], CF(0), jumps[1])


def open_tip(material: Isotropic, K: float = 1, tip: float = 0) -> ClosedForm:
    """(b): K_I at a tip (tip, 0) with the crack on x < tip."""
    return williams_tip(material, opening=[K], tip=tip)


def slipping_tip(material: Isotropic, K: float = 1, p: float = 1, tip: float = 0) -> ClosedForm:
    """(c): K_II at a tip (tip, 0), crack on x < tip, closed under the uniform compression σ_yy = -p."""
    return williams_tip(material, sliding=[K], p=p, tip=tip)


def sliding_tip(material: Isotropic, mu_f: float, K: float = 1, p: float = 1, tip: int = 0) -> ClosedForm:
    """(e): (c) with K ≥ 0 and Coulomb friction, σ_xy = mu_f p: the closed crack slides on its whole length."""
    slipping, shear = slipping_tip(material, K, 0, tip), uniform_stress(material, 0, mu_f * p, -p)
    return ClosedForm(slipping.u + shear.u, slipping.stress + shear.stress, CF(-p), CF(0), CF(mu_f * p), slipping.slip)


def contact_transition(material: Isotropic, c: float = 1, x0: float = 0) -> ClosedForm:
    """(d): open for x > x0 with gap ∝ (x - x0)^{3/2}, closed for x < x0 with σ_n = -c √(x0 - x)."""
    X, sign = x - x0, IfPos(-y, -1, 1)
    Y = sign * y
    r = sqrt(X * X + Y * Y + 1e-200)
    C, S = half_angle(X, Y, r)
    re_Z, im_Z = -c * S, c * C
    re_Zhat, im_Zhat = -2 / 3 * c * (X * S + Y * C), 2 / 3 * c * (X * C - Y * S)
    re_dZ, im_dZ = 0.5 * c * S / r, 0.5 * c * C / r
    kappa, mu = material.kappa, material.mu
    u = 0.5 / mu * CF((0.5 * (kappa - 1) * re_Zhat - Y * im_Z, sign * (0.5 * (kappa + 1) * im_Zhat - Y * re_Z)))
    stress = _matrix(re_Z - Y * im_dZ, -sign * Y * re_dZ, re_Z + Y * im_dZ)
    opening = IfPos(X, X, 0)
    return ClosedForm(u, stress, -c * sqrt(IfPos(-X, -X, 0)), 0.5 / mu * (kappa + 1) * 2 / 3 * c * opening * sqrt(opening))


def _matrix(xx: CoefficientFunction, xy: CoefficientFunction, yy: CoefficientFunction) -> CoefficientFunction:
    return CF((xx, xy, xy, yy), dims=(2, 2)).Compile()


def rotated_square(angle: float, offset: tuple[float, float], maxh: float, size: int = 1) -> Mesh:
    """A mesh of the square of the given size, rotated by angle about its centre at offset; one boundary, "outer"."""
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*corner) for corner in corners(angle, offset, size)]
    for i in range(4):
        geometry.Append(["line", points[i], points[(i + 1) % 4]], bc="outer")
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def position(i: Any) -> Any:
    """Angle and offset of the i-th body of a series: irrational steps, the origin stays at least 0.4 away from its boundary."""
    return 0.1 + 0.7 * ((i * 0.618034) % 1), (0.05 * np.cos(2.4 * i), 0.05 * np.sin(2.4 * i))


def corners(angle: float, offset: tuple[float, float], size: int = 1) -> np.ndarray:
    """Of the rotated square, counter-clockwise: (4, 2)."""
    square = 0.5 * size * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return square @ rotation.T + np.asarray(offset)


def mouths(angle: float, offset: tuple[float, float], size: int = 1) -> list[float]:
    """The two x at which the line y = 0 leaves the rotated square."""
    p = corners(angle, offset, size)
    q = np.roll(p, -1, axis=0)
    crossing = p[:, 1] * q[:, 1] < 0
    a, b = p[crossing], q[crossing]
    return sorted(a[:, 0] - a[:, 1] * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1]))


def crack_on_axis(start: float, end: float) -> Crack:
    """The crack from (start, 0) to (end, 0)."""
    return Crack([(float(start), 0.0), (float(end), 0.0)])


def energy_error(solution: ContactSolution, exact: ClosedForm, bonus_intorder: int = 6) -> float:
    """(a(u - u_h, u - u_h))^{1/2}."""
    difference = solution.stress - exact.stress
    return np.sqrt(
        Integrate(InnerProduct(difference, solution.problem.material.Strain(difference)) * solution.body.dx(bonus_intorder=bonus_intorder), solution.body.mesh)
    )


def pressure_error(solution: ContactSolution, exact: ClosedForm, bonus_intorder: int = 10) -> float:
    """‖σ_n - λ_h‖ in L²(Γ_C)."""
    return error_on_crack(solution, solution.multiplier - exact.pressure, bonus_intorder)


def shear_error(solution: ContactSolution, exact: ClosedForm, bonus_intorder: int = 10) -> float:
    """‖σ_t - λ_t‖ in L²(Γ_C)."""
    return error_on_crack(solution, solution.tangential_multiplier - exact.shear, bonus_intorder)


def slip_error(solution: ContactSolution, exact: Any, bonus_intorder: Any = 10) -> Any:
    """‖g_t(u) - g_t(u_h)‖ in L²(Γ_C)."""
    return error_on_crack(solution, Slip(solution.u, solution.body) - exact.slip, bonus_intorder)


def error_on_crack(solution: ContactSolution, difference: CoefficientFunction, bonus_intorder: int) -> float:
    """‖difference‖ in L²(Γ_C)."""
    return np.sqrt(Integrate(difference * difference * solution.problem.W.dcrack(bonus_intorder=bonus_intorder), solution.body.mesh))
