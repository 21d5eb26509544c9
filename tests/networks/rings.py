"""A disk or a ring inside a ring that touch along a circle without friction and do not part: the solution by series.

Kolosov's potentials φ = c z^k and ψ = d z^m give, with 2μ(u_r + i u_θ) = e^{-iθ} (κφ - z conj φ' - conj ψ), one term cos nθ each: n = |k - 1|, n = |m + 1|.
(N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity, the chapters on regions bounded by circles.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Term:
    """φ or ψ = length (z/length)^power."""

    potential: str
    power: int
    mu: float
    kappa: float
    length: float

    @property
    def turns(self):
        """n of cos nθ, with a sign."""
        return self.power - 1 if self.potential == "phi" else self.power + 1

    def Amplitudes(self, r):
        """Of u_r, σ_rr, σ_θθ with cos nθ and of u_θ, σ_rθ with sin nθ, n ≥ 0."""
        k, sign = self.power, np.sign(self.turns)
        s = (r / self.length) ** (k - 1)
        u = s * r / (2 * self.mu)
        if self.potential == "phi":
            return dict(
                ur=u * (self.kappa - k), ut=u * float(sign * (self.kappa + k)), rr=s * (k * (3 - k)), tt=s * (k * (k + 1)), rt=s * int(sign * k * (k - 1))
            )
        return dict(ur=-u, ut=u * int(sign), rr=-k * s, tt=k * s, rt=s * int(sign * k))


def terms(n, material, length, hole):
    """The Terms of cos nθ of a material (λ, μ); those that are regular at the centre come first, and are all without a hole."""
    lam, mu = material
    phi, psi = (lambda power, name=name: Term(name, power, mu, (lam + 3 * mu) / (lam + mu), length) for name in ("phi", "psi"))
    if n == 0:
        return [phi(1), psi(-1)] if hole else [phi(1)]
    return [phi(1 + n), psi(n - 1)] + ([phi(1 - n), psi(-n - 1)] if hole else [])


@dataclass(frozen=True)
class RingContact:
    """Inside r < a a disk, or a ring r > hole, with a free hole; outside a ring a < r < b; plane strain, bilateral contact without friction at r = a.

    Parameters
    ----------
    inner, outer
        (λ, μ), Lamé's constants.
    load : dict
        n → (amplitude of cos nθ, amplitude of sin nθ) at r = b, n = 0 or ≥ 2: of (σ_rr, σ_rθ), or of (u_r, u_θ).
    given
        "traction" or "displacement": what the load is.
    """

    inner: tuple[float, float]
    outer: tuple[float, float]
    load: dict
    a: float = 0.5
    b: float = 1.0
    hole: float = 0.0
    given: str = "traction"

    def Terms(self, n):
        """Those of the inner and of the outer part."""
        return terms(n, self.inner, self.a, self.hole > 0), terms(n, self.outer, self.a, True)

    def _Rows(self, n):
        """(inner, outer, right-hand side) of the conditions, as functions of amplitudes: inner ones less outer ones."""
        names = ("rr", "rt") if self.given == "traction" else ("ur", "ut")
        rows = [(self.a, "rr", 1, 1, 0), (self.a, "ur", 1, 1, 0), (self.a, "rt", 1, 0, 0), (self.a, "rt", 0, 1, 0)]
        rows += [(self.b, name, 0, -1, value) for name, value in zip(names, self.load[n])]
        rows += [(self.hole, name, 1, 0, 0) for name in ("rr", "rt")] if self.hole else []
        return [row for row in rows if n or row[1] not in ("rt", "ut")]

    @cached_property
    def coefficients(self):
        """n → coefficients of the terms of the inner and of the outer part."""
        return {n: self._Solve(n) for n in self.load}

    def _Solve(self, n):
        if n == 1 or n < 0:
            raise ValueError(f"n = {n}: cos θ is a force without a counterpart; take 0, 2, 3, ...")
        inner, outer = self.Terms(n)
        rows = self._Rows(n)
        matrix = [[i * t.Amplitudes(r)[q] for t in inner] + [-o * t.Amplitudes(r)[q] for t in outer] for r, q, i, o, _ in rows]
        scale = np.abs(matrix).max(axis=1)
        solved = np.linalg.solve(np.array(matrix) / scale[:, None], [row[-1] / s for row, s in zip(rows, scale)])
        return solved[: len(inner)].tolist(), solved[len(inner) :].tolist()

    def Polar(self, part, r):
        """n → amplitudes of u_r, u_θ, σ_rr, σ_θθ, σ_rθ at r; part 0 is the inner one."""
        found = {}
        for n, coefficients in self.coefficients.items():
            amplitudes = [t.Amplitudes(r) for t in self.Terms(n)[part]]
            found[n] = {q: sum(c * A[q] for c, A in zip(coefficients[part], amplitudes)) for q in ("ur", "ut", "rr", "tt", "rt")}
        return found

    @property
    def pressure(self):
        """n → p_n of the contact pressure p(θ) = Σ p_n cos nθ; ValueError where it is not positive all round."""
        p = {n: -A["rr"] for n, A in self.Polar(0, self.a).items()}
        angle = np.linspace(0, 2 * np.pi, 1001)
        if sum(p_n * np.cos(n * angle) for n, p_n in p.items()).min() <= 0:
            raise ValueError(f"the parts do not press on each other all round: p_n = {p}; add to the load's n = 0")
        return p

    def Fields(self, part, x, y):
        """((u_x, u_y), (σ_xx, σ_xy, σ_yy)) at points that are not the origin: numbers, arrays or CoefficientFunctions."""
        r = (x * x + y * y) ** 0.5
        c, s = x / r, y / r
        ur, ut, rr, tt, rt = self._Sums(part, r, c, s)
        mean, half = (rr + tt) / 2, (rr - tt) / 2
        c2, s2 = c * c - s * s, 2 * c * s
        return (ur * c - ut * s, ur * s + ut * c), (mean + half * c2 - rt * s2, half * s2 + rt * c2, mean - half * c2 + rt * s2)

    def _Sums(self, part, r, c, s):
        """u_r, u_θ, σ_rr, σ_θθ, σ_rθ where cos θ = c, sin θ = s."""
        total = dict(ur=0, ut=0, rr=0, tt=0, rt=0)
        for n, amplitudes in self.Polar(part, r).items():
            cn, sn = 1, 0
            for _ in range(n):
                cn, sn = cn * c - sn * s, cn * s + sn * c
            for q, A in amplitudes.items():
                total[q] = total[q] + A * (sn if q in ("ut", "rt") else cn)
        return total.values()


def with_pressure(inner, outer, pressure, **geometry):
    """The RingContact under σ_rr at r = b whose contact pressure is Σ pressure[n] cos nθ."""
    unit = RingContact(inner, outer, dict.fromkeys(pressure, (1.0, 0.0)), **geometry)
    response = {n: -A["rr"] for n, A in unit.Polar(0, unit.a).items()}
    return RingContact(inner, outer, {n: (p / response[n], 0.0) for n, p in pressure.items()}, **geometry)
