"""The open crack on a circular arc in the infinite plane under remote stress, by Muskhelishvili's potentials.

N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity, chapter 18: the circular arc as a problem of linear relationship.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from ngsolve import CF, Conj, sqrt, x, y

from .._ngsxfem_contact import Crack
from ..material import Elasticity
from .closed_forms import ClosedForm


@dataclass(frozen=True)
class OpenArc:
    """The arc of radius 1 around the origin between the angles π/2 ± alpha, from left to right, lips free of traction.

    Parameters
    ----------
    material
        The Elasticity.
    alpha
        Half of the arc's angle.
    stress
        (σ₁, σ₂), the principal stresses at infinity.
    beta
        The angle of σ₁ with the x-axis.

    Notes
    -----
    With ω(z) = z Φ̄(1/z) + ψ̄(1/z), φ ± ω are continuous across the arc or
    change sign there: φ, ω = ½ (X q ± (D z - Γ̄'/z)), X = √((z-a)(z-b)) cut along the arc, q = C - E/(ab z). C, D, E follow from the stress at
    infinity and Ω(∞) = conj Φ(0). The body must not contain the origin, and the crack must be open: `exact.gap` > 0.
    """

    material: Elasticity
    alpha: float
    stress: tuple[float, float] = (1, 1)
    beta: float = 0

    @property
    def tips(self) -> Any:
        """a and b, complex: the first tip (on the left) and the last."""
        return 1j * np.exp(1j * self.alpha), 1j * np.exp(-1j * self.alpha)

    def Crack(self, start: Any = None) -> Any:
        """The whole arc, or the part from an angle start (a mouth) to the last tip."""
        first, last = np.pi / 2 + self.alpha if start is None else start, np.pi / 2 - self.alpha
        a, b, c = ((float(np.cos(t)), float(np.sin(t))) for t in (first, 0.5 * (first + last), last))
        return Crack.Arc(a, b, c)

    @property
    def far(self) -> Any:
        """Γ, Γ': Φ and Ψ at infinity."""
        first, second = self.stress
        return (first + second) / 4, -0.5 * (first - second) * np.exp(-2j * self.beta)

    @cached_property
    def constants(self) -> Any:
        """C, D, E, complex."""
        (a, b), (gamma, prime) = self.tips, self.far
        root, mean = _root(0j, a, b), 0.5 * (1 / a + 1 / b)
        E = -np.conj(prime) * root  # φ has no pole at 0
        twice_phi = lambda C, D: root * (-C * mean - E / (a * b) * (0.5 / (a * b) - 0.5 * mean**2)) + D  # 2Φ(0)

        def residual(unknowns: np.ndarray) -> np.ndarray:
            C, D = complex(*unknowns[:2]), complex(*unknowns[2:])
            equations = C + D - 2 * gamma, C - D - np.conj(twice_phi(C, D))
            return np.array([part for equation in equations for part in (equation.real, equation.imag)])

        at_zero = residual(np.zeros(4))
        solved = np.linalg.solve(np.column_stack([residual(e) - at_zero for e in np.eye(4)]), -at_zero)
        return complex(*solved[:2]), complex(*solved[2:]), complex(E)

    def Potential(self, z: Any, sign: Any = 1) -> Any:
        """φ (sign = 1) or ω (sign = -1) with two derivatives at z, complex numbers or CoefficientFunctions."""
        (a, b), (C, D, E) = self.tips, self.constants
        X = _root(z, a, b)
        number = complex if isinstance(z, complex) else CF
        C, D, e, p = (number(complex(value)) for value in (C, D, E / (a * b), np.conj(self.far[1])))
        dX = (z - number(0.5 * (a + b))) / X
        ddX = (1 - dX * dX) / X
        q, dq, ddq = C - e / z, e / z**2, -2 * e / z**3
        value = X * q + sign * (D * z - p / z)
        first = dX * q + X * dq + sign * (D + p / z**2)
        return 0.5 * value, 0.5 * first, 0.5 * (ddX * q + 2 * dX * dq + X * ddq - sign * 2 * p / z**3)

    def Solution(self) -> Any:
        """u and stress as a ClosedForm; gap and slip are left 0."""
        z = x + 1j * y
        reflected = z / (x * x + y * y)
        (phi, dphi, ddphi), (omega, domega, _) = self.Potential(z), self.Potential(reflected, -1)
        u = (self.material.kappa * phi - omega - (z - reflected) * Conj(dphi)) / (2 * self.material.mu)
        psi = (dphi - z * ddphi - Conj(domega)) / z**2
        trace, deviator = 4 * dphi.real, 2 * (Conj(z) * ddphi + psi)  # σ_xx + σ_yy, σ_yy - σ_xx + 2iσ_xy
        xy = 0.5 * deviator.imag
        stress = CF((0.5 * (trace - deviator.real), xy, xy, 0.5 * (trace + deviator.real)), dims=(2, 2))
        return ClosedForm(CF((u.real, u.imag)), stress, CF(0), CF(0))

    def StressIntensity(self, tip: Any) -> Any:
        """(K_I, K_II) at the first (0) or last (1) tip: K_I - i K_II = lim 2√(2πr) Φ = lim √(2πr) (Φ + Ω)."""
        here, ahead = self.tips[tip], self.tips[tip] * (1j if tip == 0 else -1j)
        r = 1e-8
        K = np.sqrt(2 * np.pi * r) * sum(self.Potential(here + r * ahead, sign)[1] for sign in (1, -1))
        return float(K.real), float(-K.imag)


def _root(z: Any, a: Any, b: Any) -> Any:
    """√((z-a)(z-b)) ~ z at infinity, cut along the arc of the unit circle through i from a to b: there (z-a)/(z-b) has one direction."""
    middle = (1j - a) / (1j - b)
    turn = -middle / abs(middle)
    half = np.exp(0.5j * np.angle(turn))
    number, root = (complex, np.sqrt) if isinstance(z, complex) else (CF, sqrt)
    return (z - number(b)) * half * root((z - number(a)) / (z - number(b)) / turn)
