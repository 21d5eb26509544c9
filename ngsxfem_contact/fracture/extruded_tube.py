"""Coordinates around a front of an extruded crack in which the sheet is flat: section 21 of docs/method.md.

    x = X(y) + x₂ n(y),  y = C(s) + x₁ e₁,  S on x₂ = 0, x₁ < 0,

with X the extruded crack, which goes on beyond its ends with the curvature that it has there. The frame e₁, e₂ = n, e₃ turns with X.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .front_fields import matrices

if TYPE_CHECKING:
    from .._ngsxfem_contact import Sheet
    from .front_tube import FrontCurve


@dataclass
class Places:
    """Points of a tube with what is needed to differentiate there, all in the components of the frames.

    Attributes
    ----------
    points, frames
        (n, 3) in space, and (n, 3, 3), the rows e₁, e₂, e₃.
    dual
        (n, 3, 3): rows ∇x₁, ∇x₂, ∇s.
    turn
        (n, 3, 3, 3): turn[:, α, i] is the derivative of e_i by x₁, x₂, s.
    volume
        dV / (dx₁ dx₂ ds).
    across
        (n, 3): the normal of the disc s = const, times dA / (dx₁ dx₂).
    """

    points: np.ndarray
    frames: np.ndarray
    dual: np.ndarray
    turn: np.ndarray
    volume: np.ndarray
    across: np.ndarray


class ExtrudedTube:
    """The coordinates around a front of an extruded crack."""

    def __init__(self, curve: FrontCurve) -> None:
        self.curve, self.sheet = curve, curve.sheet

    def At(self, s: np.ndarray, x1: np.ndarray, x2: np.ndarray) -> Places:
        """At points with coordinates (n,) each."""
        of_s, number = np.unique(s, return_inverse=True)
        C, directions = (values[number] for values in self.curve.Flat(of_s))
        kappa = self.curve.Curvatures(of_s)[number]
        y, ahead, along = C + x1[:, None] * directions[:, 0], directions[:, 0], directions[:, 1]
        point, first, second, normal, bend = surface(self.sheet, y)
        turned = lambda d: d[:, :1] * first + d[:, 1:] * second
        frames = np.stack([turned(ahead), normal, turned(along)], axis=1)
        b11, b13, b33 = bend * ahead[:, 1] ** 2, bend * ahead[:, 1] * along[:, 1], bend * along[:, 1] ** 2
        h, zero, one = 1 + kappa * x1, 0 * x1, 1 + 0 * x1
        jacobian = matrices([[1 - x2 * b11, zero, -h * x2 * b13], [zero, one, zero], [-x2 * b13, zero, h * (1 - x2 * b33)]])
        by_x1 = matrices([[zero, b11, zero], [-b11, zero, -b13], [zero, b13, zero]])
        by_s = matrices([[zero, h * b13, kappa], [-h * b13, zero, -h * b33], [-kappa, h * b33, zero]])
        across = np.stack([x2 * b13, zero, 1 - x2 * b11], axis=-1)
        return Places(
            point + x2[:, None] * normal, frames, np.linalg.inv(jacobian), np.stack([by_x1, 0 * by_x1, by_s], axis=1), np.linalg.det(jacobian), across
        )


def surface(sheet: Sheet, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """X, its derivatives by the coordinates y (n, 2), n and the curvature along the crack: (n, 3) each, (n,)."""
    curve, axes = sheet.curve, np.array(sheet.axes)
    assert curve is not None
    of_p, number = np.unique(y[:, 1], return_inverse=True)
    s = np.clip(of_p, 0, curve.length)
    point, tangent = np.array([curve.PointAt(t) for t in s]), np.array([curve.TangentAt(t) for t in s])
    bend = np.array([curve.CurvatureAt(t) for t in s])
    left, angle = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1), bend * (of_p - s)
    beyond = (of_p - s)[:, None]  # on the circle of curvature at the end
    point = point + beyond * (np.sinc(angle / np.pi)[:, None] * tangent + np.sin(0.5 * angle)[:, None] * np.sinc(0.5 * angle / np.pi)[:, None] * left)
    tangent = np.cos(angle)[:, None] * tangent + np.sin(angle)[:, None] * left
    in_space = lambda vectors: (vectors @ axes)[number]
    first = np.cross(*axes)
    normal = in_space(np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1))
    return np.array(sheet.origin) + in_space(point) + y[:, :1] * first, first + 0 * normal, in_space(tangent), normal, bend[number]
