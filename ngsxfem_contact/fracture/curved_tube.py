"""Coordinates around a front of a curved sheet in which the sheet is flat: section 21 of docs/method.md.

    x = X(y) + x₂ n(y),  y = C(s) + x₁ d(s),  S on x₂ = 0, x₁ < 0,

with the surface X of the sheet, its normal n, the front C in the coordinates of X, and d the direction there whose ∂_d X is e₁.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .sheet_surfaces import SheetSurface, surface_of, without

if TYPE_CHECKING:
    from .front_tube import FrontCurve


@dataclass
class Places:
    """Points of a tube with what is needed to differentiate there, all in the components of the frames.

    Attributes
    ----------
    points, frames
        (n, 3) in space, and (n, 3, 3), the rows e₁, e₂, e₃: e₁ along ∂₁X, e₂ = n.
    dual
        (n, 3, 3): rows ∇x₁, ∇x₂, ∇s.
    turn
        (n, 3, 3, 3): turn[:, α, i] is the derivative of e_i by x₁, x₂, s.
    volume
        dV / (dx₁ dx₂ ds).
    """

    points: np.ndarray
    frames: np.ndarray
    dual: np.ndarray
    turn: np.ndarray
    volume: np.ndarray

    @property
    def across(self) -> np.ndarray:
        """(n, 3): the normal of the disc s = const, times dA / (dx₁ dx₂)."""
        return self.volume[:, None] * self.dual[:, 2]


@dataclass
class FrontPlaces:
    """n places of a front in the coordinates of its surface, (n, 2) each: C, C' = τ of unit length, d, d'; and the length |∂_s X| (n,) for each unit of s."""

    at: np.ndarray
    along: np.ndarray
    ahead: np.ndarray
    turn: np.ndarray
    speed: np.ndarray

    def __getitem__(self, number: np.ndarray) -> FrontPlaces:
        return FrontPlaces(self.at[number], self.along[number], self.ahead[number], self.turn[number], self.speed[number])


class CurvedTube:
    """The coordinates around a front of a curved sheet."""

    def __init__(self, curve: FrontCurve) -> None:
        self.curve, self.sheet = curve, curve.sheet

    @cached_property
    def surface(self) -> SheetSurface:
        """That of the sheet."""
        return surface_of(self.sheet)

    def Front(self, s: np.ndarray) -> FrontPlaces:
        """The front at s (n,)."""
        curve = self.curve
        frames = curve.Frames(s)
        at = np.array([self.sheet.Flat(tuple(point))[:2] for point in curve.Points(s)]).reshape(-1, 2)
        places = self.surface.At(at)
        ahead, along = places.Components(frames[:, 0]), places.Components(frames[:, 2])
        speed = 1 / np.linalg.norm(along, axis=1)
        along = along * speed[:, None]
        normal, turned = places.Normals(along)
        bend = -curve.Curvatures(s)[:, None] * np.stack([-along[:, 1], along[:, 0]], axis=-1)  # τ'
        change = without(places.Bend(along, along) + places.Along(bend), frames[:, 2]) / speed[:, None]  # e₃'
        e1_change = np.cross(turned, frames[:, 2]) + np.cross(normal, change)
        return FrontPlaces(at, along, ahead, places.Components(e1_change - places.Bend(along, ahead)), speed)

    def At(self, s: np.ndarray, x1: np.ndarray, x2: np.ndarray) -> Places:
        """At points with coordinates (n,) each."""
        of_s, number = np.unique(s, return_inverse=True)
        front = self.Front(of_s)[number]
        ahead, by_s = front.ahead, front.along + x1[:, None] * front.turn
        places = self.surface.At(front.at + x1[:, None] * ahead)
        normal, *normal_turn = places.Normals(ahead, by_s)
        first = places.Along(ahead)
        size = np.linalg.norm(first, axis=1)[:, None]
        e1 = first / size
        e3 = np.cross(e1, normal)
        frames = np.stack([e1, normal, e3], axis=1)
        steps = [first + x2[:, None] * normal_turn[0], normal, places.Along(by_s) + x2[:, None] * normal_turn[1]]
        jacobian = np.einsum("nik,ank->nia", frames, np.array(steps))
        turn = np.zeros((len(s), 3, 3, 3))
        for axis, n_change, change in zip((0, 2), normal_turn, (places.Bend(ahead, ahead), places.Bend(ahead, by_s) + places.Along(front.turn))):
            e1_change = without(change, e1) / size
            turned = np.stack([e1_change, n_change, np.cross(e1_change, normal) + np.cross(e1, n_change)], axis=1)
            turn[:, axis] = np.einsum("nik,njk->nij", turned, frames)
        return Places(places.points + x2[:, None] * normal, frames, np.linalg.inv(jacobian), turn, np.linalg.det(jacobian))
