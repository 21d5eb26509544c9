"""The symmetric form I(a,b) of two fields around a front, for all hats along it at once: section 14 of docs/method.md.

With V = q(r) N(s) e₁ for a hat N, σ = C:ε + σ⁰ and f the body force,

    ∫ N I(s) ds = -∫ M:∇V - ∫ V·(∇aᵀ f_b + ∇bᵀ f_a) - ∫ (∂_V σ⁰_a):∇b - ∫ (∂_V σ⁰_b):∇a + ∫_{faces, end discs} V·Mν,
    M = (C ε(a):∇b + σ⁰_a:∇b + σ⁰_b:∇a) 1 - ∇aᵀ σ_b - ∇bᵀ σ_a.

Nothing is approximated but the integrals: the curvature of the front is in ∇V, in the frame, and in the body force of the auxiliary fields.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF

from ..points import points_inside
from .front_fields import FrontField, LocalField, local_field, modes
from .front_tube import points_on_sheet
from .tip_fields import SIDE

if TYPE_CHECKING:
    from ..material import Elasticity
    from .front_tube import FrontCurve, Hats, TubeRule


BLOCK = 200_000  # points at once


def weight(r: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """q = 1 - t³ (10 - 15 t + 6 t²) for t = r/radius ≤ 1, else 0, and q'."""
    t = np.minimum(r / radius, 1)
    return 1 - t**3 * (10 - 15 * t + 6 * t**2), -30 * t**2 * (1 - t) ** 2 / radius


def momentum(a: LocalField, b: LocalField) -> tuple[np.ndarray, np.ndarray]:
    """The row e₁·M (n, 3) and M_33 (n,)."""
    energy = product(a.whole, b.gradient) + product(b.given, a.gradient)
    column = lambda j: -np.einsum("nk,nkj->nj", a.gradient[:, :, j], b.whole) - np.einsum("nk,nkj->nj", b.gradient[:, :, j], a.whole)
    row, third = column(0), column(2)
    row[:, 0] += energy
    return row, third[:, 2] + energy


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a:b or a·b at each point."""
    return (a * b).reshape(len(a), -1).sum(axis=1)


def load(a: LocalField, b: LocalField) -> np.ndarray:
    """f_a·∂₁b + f_b·∂₁a + ∂₁σ⁰_a:∇b + ∂₁σ⁰_b:∇a, (n,)."""
    return product(a.force, b.ahead) + product(b.force, a.ahead) + product(a.given_ahead, b.gradient) + product(b.given_ahead, a.gradient)


@dataclass
class FrontIntegrals:
    """∫ N_k I ds for all hats, of a field with the three modes and of it with itself, for each of the radii: (number of radii, number of hats, 4).

    Parameters
    ----------
    field
        The FrontField.
    hats
        Along a part of the front.
    radii
        Of the tubes, the largest first.
    """

    curve: FrontCurve
    material: Elasticity
    field: FrontField
    hats: Hats
    radii: tuple[float, ...]
    rule: TubeRule

    def __call__(self) -> np.ndarray:
        total = self._volume() + self._faces() + self._joints()
        if not self.hats.closed:
            for index, s, sign in ((0, self.hats.start, -1), (-1, self.hats.end, 1)):
                total[:, index] += sign * self._disc(s)
        return total

    def Doubt(self) -> np.ndarray:
        """∫ q N_k |doubt·∂₁ jump(b)| for the modes: what a doubtful traction of the faces can do to the integrals of the largest tube, (number of hats, 3)."""
        if self.field.doubt is None:
            return np.zeros((len(self.hats.nodes), 3))
        points, frames, s, r, weights, kappa = self._face_points()
        doubt = np.einsum("npi,ni->np", frames, CF(self.field.doubt)(points))
        zero = 0 * r
        both = [modes(self.material, r, sign * np.pi + zero, kappa, zero) for sign in SIDE.values()]
        density = np.stack([np.abs(product(doubt, plus.ahead - minus.ahead)) for plus, minus in zip(*both)], axis=-1)
        return self.hats.Sum(s, (weight(r, self.radii[0])[0] * weights)[:, None] * density)

    def Pressed(self, h: float) -> np.ndarray:
        """Whether the faces press on each other over most of the last element before each node, by more than round-off, (number of hats,)."""
        if self.field.pressure is None:
            return np.zeros(len(self.hats.nodes), dtype=bool)
        points, _, s, r, weights, _ = self._face_points()
        pressure = np.ravel(CF(self.field.pressure)(points))
        weights = weights * (r < h)
        pressed = weights * (pressure < -1e-10 * np.abs(pressure).max())
        shares = self.hats.Sum(s, np.stack([pressed, weights], axis=-1))
        return shares[:, 0] > 0.5 * shares[:, 1]

    def _discs(self, s: np.ndarray) -> tuple[LocalField, list[LocalField], tuple[np.ndarray, ...]]:
        """The field and the modes on discs at s, points of one disc after those of another; r, θ, weights r dr dθ, κ there."""
        curve, (r, theta, weights) = self.curve, self.rule.Disc(self.radii)
        frames, kappa = curve.Frames(s), curve.Curvatures(s)
        offset = (r * np.cos(theta))[:, None] * frames[:, None, 0] + (r * np.sin(theta))[:, None] * frames[:, None, 1]
        points = (curve.Points(s)[:, None] + offset).reshape(-1, 3)
        at = points_inside(curve.body.mesh, points)
        if (at["nr"] < 0).any():
            outside = tuple(float(c) for c in points[np.argmax(at["nr"] < 0)])
            raise ValueError(f"the tube of radius {self.radii[0]:.4g} around front {curve.number} leaves the body at {outside}; choose a smaller radius")
        count = len(r)
        each = lambda of_s: np.repeat(of_s, count, axis=0)
        r, theta, weights = (np.tile(of_disc, len(s)) for of_disc in (r, theta, weights))
        change = each(curve.CurvatureChange(s))
        field = local_field(self.field, self.material, at, each(frames))
        return field, modes(self.material, r, theta, each(kappa), change), (r, theta, weights, each(kappa))

    def _volume(self) -> np.ndarray:
        s, ds = self.rule.Along(self.curve.Edges(self.hats))
        size = len(self.rule.Disc(self.radii)[0])
        blocks = np.array_split(np.arange(len(s)), -(-len(s) * size // BLOCK))
        return np.sum([self._over_discs(s[block], ds[block]) for block in blocks], axis=0)

    def _over_discs(self, s: np.ndarray, ds: np.ndarray) -> np.ndarray:
        """The part of some of the discs, with weights ds."""
        field, auxiliary, (r, theta, weights, kappa) = self._discs(s)
        count = len(r) // len(s)
        s, h3 = np.repeat(s, count), 1 + kappa * r * np.cos(theta)
        weights = weights * np.repeat(ds, count) * h3
        across, along, value = [], [], []
        for other in (*auxiliary, field):
            row, third = momentum(field, other)
            across.append(row[:, 0] * np.cos(theta) + row[:, 1] * np.sin(theta))
            along.append(row[:, 2] / h3)
            value.append(third * kappa / h3 + load(field, other))
        terms = [-weights[:, None] * np.stack(term, axis=-1) for term in (across, along, value)]
        return np.stack([self._sum(s, r, radius, *terms) for radius in self.radii])

    def _sum(self, s: np.ndarray, r: np.ndarray, radius: float, across: np.ndarray, along: np.ndarray, value: np.ndarray) -> np.ndarray:
        q, dq = (f[:, None] for f in weight(r, radius))
        return self.hats.Sum(s, dq * across + q * value, q * along)

    def _disc(self, s: float) -> np.ndarray:
        """∫ q e₁·M e₃ over the disc at an end."""
        field, auxiliary, (r, _, weights, _) = self._discs(np.array([s]))
        flow = np.stack([momentum(field, other)[0][:, 2] for other in (*auxiliary, field)], axis=-1)
        return np.stack([(weight(r, radius)[0] * weights) @ flow for radius in self.radii])

    def _joints(self) -> np.ndarray:
        """∫ q N [σ_b e₃]·∂₁a over discs where κ jumps: the force that the modes need there."""
        total = np.zeros((len(self.radii), len(self.hats.nodes), 4))
        for s in self.curve.JointsOn(self.hats):
            at, step = np.array([s]), 1e-7 * self.curve.length
            field, _, (r, theta, weights, _) = self._discs(at)
            after, before = (modes(self.material, r, theta, self.curve.Curvatures(at + side * step) + 0 * r, 0 * r) for side in (1, -1))
            flow = np.stack([product(a.stress[:, :, 2] - b.stress[:, :, 2], field.ahead) for a, b in zip(after, before)], axis=-1)
            for i, radius in enumerate(self.radii):
                total[i, :, :3] += self.hats.Sum(at, ((weight(r, radius)[0] * weights) @ flow)[None])
        return total

    def _face_points(self) -> tuple[Any, ...]:
        """Mesh points on the sheet in the tube, frames, s, r, weights and κ there."""
        curve, (s, ds) = self.curve, self.rule.Along(self.curve.Edges(self.hats))
        r, dr = self.rule.Radius(self.radii)
        frames, kappa = curve.Frames(s), curve.Curvatures(s)
        points = (curve.Points(s)[:, None] - r[:, None] * frames[:, None, 0]).reshape(-1, 3)
        weights = (ds[:, None] * dr * (1 - kappa[:, None] * r)).ravel()
        each = lambda of_s: np.repeat(of_s, len(r), axis=0)
        return points_on_sheet(curve.body, curve.front.sheet, points), each(frames), each(s), np.tile(r, len(s)), weights, each(kappa)

    def _faces(self) -> np.ndarray:
        """ν = -n on the plus face, n on the minus face; V·n = 0."""
        points, frames, s, r, weights, kappa = self._face_points()
        flow = np.zeros((len(s), 4))
        for side, sign in SIDE.items():
            field = local_field(self.field, self.material, points, frames, side)
            traction = self._traction(side, points, frames)
            for i, other in enumerate(modes(self.material, r, sign * np.pi + 0 * r, kappa, 0 * r)):
                flow[:, i] += sign * (product(other.stress[:, :, 1], field.ahead) + product(traction, other.ahead))
            flow[:, 3] += sign * 2 * product(traction, field.ahead)
        return np.stack([self.hats.Sum(s, (weight(r, radius)[0] * weights)[:, None] * flow) for radius in self.radii])

    def _traction(self, side: str, points: Any, frames: np.ndarray) -> np.ndarray:
        given = self.field.traction.get(side)
        return np.zeros((len(frames), 3)) if given is None else np.einsum("npi,ni->np", frames, CF(given)(points))
