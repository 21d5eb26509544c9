"""The integrals around a front of a curved sheet, in coordinates in which the sheet is flat: section 21 of docs/method.md.

V = q N e₁ and the auxiliary fields b = U_i(x₁, x₂) e_i are functions of the coordinates of CurvedTube, whose frame turns with the sheet, with their true gradients and
body forces, so that nothing is neglected for the curvature of S.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF

from ..points import points_inside
from .curved_tube import CurvedTube, Places
from .front_fields import LocalField, angular_functions, local_field, stress_of
from .front_integral import FrontIntegrals, load, product, weight
from .front_tube import points_on_sheet
from .tip_fields import SIDE

if TYPE_CHECKING:
    from ..material import Elasticity

STEP = 1e-4  # of r, for derivatives of stresses


def displacements(material: Elasticity, x1: np.ndarray, x2: np.ndarray, theta: np.ndarray | None = None) -> list[tuple[np.ndarray, np.ndarray]]:
    """U (n, 3) and its derivatives by x₁, x₂ (n, 2, 3) of the fields of unit K_I, K_II, K_III. theta: by default that of the point."""
    r, theta = np.hypot(x1, x2), np.arctan2(x2, x1) if theta is None else theta
    on_face = np.abs(theta) == np.pi
    c, s = np.where(on_face, 0.0, np.cos(0.5 * theta)), np.sin(0.5 * theta)
    cos, sin = np.where(on_face, -1.0, np.cos(theta)), np.where(on_face, 0.0, np.sin(theta))
    scale, root, zero = 1 / (2 * material.mu * np.sqrt(2 * np.pi)), np.sqrt(r), (0 * r, 0 * r)
    fields = []
    for components in (*((first, second, zero) for first, second in angular_pairs(material.kappa, c, s)), (zero, zero, (4 * s, 2 * c))):
        value = np.stack([scale * root * g for g, _ in components], axis=-1)
        by_x1 = np.stack([scale / root * (0.5 * cos * g - sin * dg) for g, dg in components], axis=-1)
        by_x2 = np.stack([scale / root * (0.5 * sin * g + cos * dg) for g, dg in components], axis=-1)
        fields.append((value, np.stack([by_x1, by_x2], axis=1)))
    return fields


def angular_pairs(kappa: float, c: np.ndarray, s: np.ndarray) -> list[tuple[tuple[np.ndarray, np.ndarray], ...]]:
    """Of modes I and II (g, g') of the components ahead and to the left."""
    return [((g1, d1), (g2, d2)) for (g1, g2), (d1, d2) in angular_functions(kappa, c, s)]


def gradients(places: Places, fields: list[tuple[np.ndarray, np.ndarray]]) -> list[np.ndarray]:
    """∇b (n, 3, 3) in the frames: Σ_α (∂_α U_i e_i + U_i ∂_α e_i) ⊗ ∇x_α."""
    found = []
    for value, change in fields:
        by = np.einsum("ni,naij->naj", value, places.turn)
        by[:, :2] += change
        found.append(np.einsum("nai,naj->nij", by, places.dual))
    return found


@dataclass
class CurvedFrontIntegrals(FrontIntegrals):
    """FrontIntegrals of a front of a curved sheet."""

    @property
    def tube(self) -> CurvedTube:
        """Its coordinates."""
        assert self.curve.tube is not None
        return self.curve.tube

    def _auxiliary(self, places: Places, s: np.ndarray, x1: np.ndarray, x2: np.ndarray) -> list[LocalField]:
        """The modes inside of the body, with their body force -div σ: Σ_α ∂_α σ ∇x_α, derivatives of components by differences."""
        material = self.material
        fields = [LocalField.Of(material, gradient) for gradient in gradients(places, displacements(material, x1, x2))]
        by: list[list[np.ndarray]] = [[] for _ in fields]
        r = np.hypot(x1, x2)
        for axis, step in enumerate((STEP * r, STEP * r, np.full_like(r, STEP * self.curve.length))):
            shifted = []
            for sign in (1, -1):
                at = [s.copy(), x1.copy(), x2.copy()]
                at[(axis + 1) % 3] += sign * step
                there = self.tube.At(*at)
                shifted.append([stress_of(material, g) for g in gradients(there, displacements(material, at[1], at[2]))])
            for i, (after, before) in enumerate(zip(*shifted)):
                by[i].append((after - before) / (2 * step)[:, None, None])
        for field, change in zip(fields, by):
            turned = np.einsum("naki,nkj->naij", places.turn, field.stress)  # Σ_k (∂_α e_k)_i σ_kj
            derivative = np.stack(change, axis=1) + turned + turned.swapaxes(2, 3)
            field.force = -np.einsum("naij,naj->ni", derivative, places.dual)
        return fields

    def _on_discs(self, s: np.ndarray) -> tuple[Any, ...]:
        """Places, the field and the modes on discs at s; s, r, θ and weights r dr dθ of the points."""
        r, theta, weights = (np.tile(of_disc, len(s)) for of_disc in self.rule.Disc(self.radii))
        s = np.repeat(s, len(r) // len(s))
        x1, x2 = r * np.cos(theta), r * np.sin(theta)
        places = self.tube.At(s, x1, x2)
        at = points_inside(self.curve.body.mesh, places.points)
        if (at["nr"] < 0).any():
            outside = tuple(float(c) for c in places.points[np.argmax(at["nr"] < 0)])
            raise ValueError(f"the tube of radius {self.radii[0]:.4g} around front {self.curve.number} leaves the body at {outside}; choose a smaller radius")
        return places, local_field(self.field, self.material, at, places.frames), self._auxiliary(places, s, x1, x2), (s, r, theta, weights)

    def _over_discs(self, s: np.ndarray, ds: np.ndarray) -> np.ndarray:
        places, field, auxiliary, (s, r, theta, weights) = self._on_discs(s)
        weights = weights * np.repeat(ds, len(r) // len(ds)) * places.volume
        across, along, value = [], [], []
        for other in (*auxiliary, field):
            flow = np.einsum("nij,naj->nai", whole_momentum(field, other), places.dual)  # M ∇x_α
            across.append(flow[:, 0, 0] * np.cos(theta) + flow[:, 1, 0] * np.sin(theta))
            along.append(flow[:, 2, 0])
            value.append(np.einsum("nai,nai->n", places.turn[:, :, 0], flow) + load(field, other))
        terms = [-weights[:, None] * np.stack(term, axis=-1) for term in (across, along, value)]
        return np.stack([self._sum(s, r, radius, *terms) for radius in self.radii])

    def _disc(self, s: float) -> np.ndarray:
        places, field, auxiliary, (_, r, _, weights) = self._on_discs(np.array([s]))
        flow = np.stack([np.einsum("nj,nj->n", whole_momentum(field, other)[:, 0], places.across) for other in (*auxiliary, field)], axis=-1)
        return np.stack([(weight(r, radius)[0] * weights) @ flow for radius in self.radii])

    def _joints(self) -> np.ndarray:
        if len(self.curve.JointsOn(self.hats)):
            raise ValueError(
                f"front_factors: the curvature of front {self.curve.number} jumps, which there is for planar sheets only; bound the sheet by one smooth curve"
            )
        return np.zeros((len(self.radii), len(self.hats.nodes), 4))

    def _on_face(self) -> tuple[Places, Any, np.ndarray, np.ndarray, np.ndarray]:
        """Places on the sheet and mesh points there, s, r and weights."""
        (s, ds), (r, dr) = self.rule.Along(self.curve.Edges(self.hats)), self.rule.Radius(self.radii)
        weights, s, r = np.outer(ds, dr).ravel(), np.repeat(s, len(r)), np.tile(r, len(s))
        places = self.tube.At(s, -r, 0 * r)
        return places, points_on_sheet(self.curve.body, self.curve.front.sheet, places.points), s, r, weights * places.volume

    def _face_modes(self, places: Places, r: np.ndarray, sign: int) -> list[LocalField]:
        return [LocalField.Of(self.material, g) for g in gradients(places, displacements(self.material, -r, 0 * r, sign * np.pi + 0 * r))]

    def _face_points(self) -> tuple[Any, ...]:
        places, points, s, r, weights = self._on_face()
        return points, places.frames, s, r, weights, None

    def Doubt(self) -> np.ndarray:
        """As for a planar sheet."""
        if self.field.doubt is None:
            return np.zeros((len(self.hats.nodes), 3))
        places, points, s, r, weights = self._on_face()
        doubt = np.einsum("npi,ni->np", places.frames, CF(self.field.doubt)(points))
        plus, minus = (self._face_modes(places, r, sign) for sign in (1, -1))
        density = np.stack([np.abs(product(doubt, a.ahead - b.ahead)) for a, b in zip(plus, minus)], axis=-1)
        return self.hats.Sum(s, (weight(r, self.radii[0])[0] * weights)[:, None] * density)

    def _faces(self) -> np.ndarray:
        places, points, s, r, weights = self._on_face()
        flow = np.zeros((len(s), 4))
        for side, sign in SIDE.items():
            field = local_field(self.field, self.material, points, places.frames, side)
            traction = self._traction(side, points, places.frames)
            for i, other in enumerate(self._face_modes(places, r, sign)):
                flow[:, i] += sign * (product(other.stress[:, :, 1], field.ahead) + product(traction, other.ahead))
            flow[:, 3] += sign * 2 * product(traction, field.ahead)
        return np.stack([self.hats.Sum(s, (weight(r, radius)[0] * weights)[:, None] * flow) for radius in self.radii])


def whole_momentum(a: LocalField, b: LocalField) -> np.ndarray:
    """M (n, 3, 3)."""
    energy = product(a.whole, b.gradient) + product(b.given, a.gradient)
    return energy[:, None, None] * np.eye(3) - np.einsum("nki,nkj->nij", a.gradient, b.whole) - np.einsum("nki,nkj->nij", b.gradient, a.whole)
