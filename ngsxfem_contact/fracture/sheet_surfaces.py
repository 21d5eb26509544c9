"""The surfaces that curved sheets are parts of, with two derivatives: what the coordinates around their fronts ask of them (section 21 of docs/method.md)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from .._ngsxfem_contact import Crack, HeightField, Sheet

# Rows: what 1, t, t², t³ contribute to the four B-splines that are not zero on an interval, t from 0 to 1.
SPLINES = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6


@dataclass
class SurfacePlaces:
    """n places of a surface X(p).

    Attributes
    ----------
    points
        X, (n, 3).
    tangents
        ∂_i X, (n, 2, 3).
    bends
        ∂_i ∂_j X, (n, 2, 2, 3).
    """

    points: np.ndarray
    tangents: np.ndarray
    bends: np.ndarray

    def Along(self, v: np.ndarray) -> np.ndarray:
        """∂_v X, (n, 3), for v (n, 2) in the coordinates."""
        return np.einsum("ni,nik->nk", v, self.tangents)

    def Bend(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """∂_v ∂_w X, (n, 3), v and w constant."""
        return np.einsum("ni,nj,nijk->nk", v, w, self.bends)

    def Components(self, vectors: np.ndarray) -> np.ndarray:
        """The v (n, 2) whose ∂_v X are vectors (n, 3) along the surface."""
        metric = np.einsum("nik,njk->nij", self.tangents, self.tangents)
        return np.linalg.solve(metric, np.einsum("nik,nk->ni", self.tangents, vectors)[..., None])[..., 0]

    def Normals(self, *directions: np.ndarray) -> tuple[np.ndarray, ...]:
        """n, and its derivatives along directions (n, 2)."""
        first, second = self.tangents[:, 0], self.tangents[:, 1]
        across = np.cross(first, second)
        size = np.linalg.norm(across, axis=1)[:, None]
        normal = across / size
        found = [normal]
        for v in directions:
            by = np.einsum("ni,nijk->njk", v, self.bends)
            change = np.cross(by[:, 0], second) + np.cross(first, by[:, 1])
            found.append(without(change, normal) / size)
        return tuple(found)


def without(vectors: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """vectors (n, 3) without their components along unit vectors (n, 3)."""
    return vectors - (vectors * unit).sum(axis=1)[:, None] * unit


class SheetSurface(Protocol):
    """A surface with coordinates: that of a curved sheet, and how it goes on beyond the sheet."""

    def At(self, y: np.ndarray) -> SurfacePlaces:
        """At coordinates (n, 2)."""

    def Jumps(self, y: np.ndarray, radius: float) -> np.ndarray:
        """Whether its curvature jumps nearer to the places y (n, 2) than a radius, (n,)."""

    def Kinks(self, y: np.ndarray, radius: float) -> np.ndarray:
        """Whether there is a kink, or what lies behind one, nearer to the places y (n, 2) than a radius, (n,)."""


class ExtrudedSurface:
    """That of an extruded crack, which goes on beyond its ends with the curvature that it has there."""

    def __init__(self, sheet: Sheet, crack: Crack) -> None:
        self.crack, self.origin, self.axes = crack, np.array(sheet.origin), np.array(sheet.axes)

    def At(self, y: np.ndarray) -> SurfacePlaces:
        """p₁ is the distance along the direction, p₂ the arc length."""
        crack = self.crack
        of_p, number = np.unique(y[:, 1], return_inverse=True)
        s = np.clip(of_p, 0, crack.length)
        point, tangent = np.array([crack.PointAt(t) for t in s]), np.array([crack.TangentAt(t) for t in s])
        bend = np.array([crack.CurvatureAt(t) for t in s])
        left, angle = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1), bend * (of_p - s)
        beyond = (of_p - s)[:, None]  # on the circle of curvature at the end
        point = point + beyond * (np.sinc(angle / np.pi)[:, None] * tangent + np.sin(0.5 * angle)[:, None] * np.sinc(0.5 * angle / np.pi)[:, None] * left)
        tangent = np.cos(angle)[:, None] * tangent + np.sin(angle)[:, None] * left
        in_space = lambda vectors: (vectors @ self.axes)[number]
        first, along, normal = np.cross(*self.axes), in_space(tangent), in_space(np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1))
        bends = np.zeros((len(y), 2, 2, 3))
        bends[:, 1, 1] = bend[number][:, None] * normal
        return SurfacePlaces(self.origin + in_space(point) + y[:, :1] * first, np.stack([first + 0 * along, along], axis=1), bends)

    def Jumps(self, y: np.ndarray, radius: float) -> np.ndarray:
        """By more than a tenth of its largest curvature between places that are a thousandth of its length apart."""
        places = np.linspace(0, self.crack.length, 1001)
        bend = np.array([self.crack.CurvatureAt(p) for p in places])
        jumps = places[1:][np.abs(np.diff(bend)) > 0.1 * np.abs(bend).max()]
        return np.array([(np.abs(jumps - p) < radius).any() for p in y[:, 1]], dtype=bool)

    def Kinks(self, y: np.ndarray, radius: float) -> np.ndarray:
        """By distances in the plane of the crack, from one kink or more."""
        crack, step = self.crack, 1e-9 * self.crack.length
        kinks = [p for p in crack.kinks if np.linalg.norm(np.subtract(crack.TangentAt(p + step), crack.TangentAt(p - step))) > 1e-6]
        if not kinks:
            return np.zeros(len(y), dtype=bool)
        places = [*kinks, *np.linspace(0, crack.length, 1001)]
        points, part = np.array([crack.PointAt(p) for p in places]), np.asarray(np.searchsorted(kinks, places, side="right"))
        part[: len(kinks)] = -1  # a kink is met from both sides
        of_p = np.clip(y[:, 1], 0, crack.length)
        behind = [points[part != np.searchsorted(kinks, p)] for p in of_p]
        return np.array([(np.linalg.norm(beyond - crack.PointAt(p), axis=1) < radius).any() for beyond, p in zip(behind, of_p)], dtype=bool)


class HeightSurface:
    """X(p) = p₁ a₁ + p₂ a₂ + f(p) a₃ with a sum f of cubic B-splines, of which those at the boundary of the grid go on beyond it as polynomials."""

    def __init__(self, sheet: Sheet, heights: HeightField) -> None:
        self.origin, axes = np.array(sheet.origin), np.array(sheet.axes)
        self.axes = np.array([*axes, np.cross(*axes)])
        self.lower, self.spacing, self.coefficients = np.array(heights.lower), np.array(heights.spacing), heights.coefficients

    def Heights(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """f (n,), its derivatives (n, 2) and second derivatives (n, 2, 2)."""
        t = (y - self.lower) / self.spacing
        first = np.clip(np.floor(t).astype(int), 0, np.array(self.coefficients.shape) - 4)
        t, one, zero = t - first, np.ones_like(t), np.zeros_like(t)
        powers = [[one, t, t**2, t**3], [zero, one, 2 * t, 3 * t**2], [zero, zero, 2 * one, 6 * t]]
        by = [np.einsum("pnk,pj->nkj", np.array(of_order), SPLINES) / (self.spacing**order)[:, None] for order, of_order in enumerate(powers)]
        near = self.coefficients[first[:, 0, None, None] + np.arange(4)[:, None], first[:, 1, None, None] + np.arange(4)]
        of = lambda i, j: np.einsum("na,nb,nab->n", by[i][:, 0], by[j][:, 1], near)
        mixed = of(1, 1)
        return of(0, 0), np.stack([of(1, 0), of(0, 1)], axis=-1), np.stack([of(2, 0), mixed, mixed, of(0, 2)], axis=-1).reshape(-1, 2, 2)

    def At(self, y: np.ndarray) -> SurfacePlaces:
        """Over the plane."""
        f, slopes, second = self.Heights(y)
        up = self.axes[2]
        points = self.origin + y @ self.axes[:2] + f[:, None] * up
        return SurfacePlaces(points, self.axes[:2] + slopes[..., None] * up, second[..., None] * up)

    def Jumps(self, y: np.ndarray, radius: float) -> np.ndarray:
        """Nowhere."""
        return np.zeros(len(y), dtype=bool)

    Kinks = Jumps


def surface_of(sheet: Sheet) -> SheetSurface:
    """That of a curved sheet."""
    if sheet.curve is not None:
        return ExtrudedSurface(sheet, sheet.curve)
    assert sheet.heights is not None
    return HeightSurface(sheet, sheet.heights)
