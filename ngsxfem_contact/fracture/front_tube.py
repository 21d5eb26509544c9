"""The tube around a front in which its integrals are taken: hats along the front, where there is room for the tube, and rules of quadrature.

Section 14 of docs/method.md. Coordinates: x = C(s) + r cos θ e₁ + r sin θ e₂, dV = (1 + κ r cos θ) r dr dθ ds, θ = ±π on the faces.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import VOL, ElementId

from ..material import Isotropic
from ..points import place, points_inside
from ..spaces.resolution import size_at_front
from .curved_tube import CurvedTube

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackedSolid

BENT = 0.8  # of the radius of curvature, or of the volume around a straight front: no tube is wider, or loses more
SAMPLES = 1001  # points of another front: a tube keeps its radius from them
CIRCLE = np.linspace(-np.pi, np.pi, 25)[:-1] + np.pi / 24


class Hats:
    """The piecewise linear functions N_k of the arc length on [start, end], at equal distances; periodic along a closed front."""

    def __init__(self, start: float, end: float, intervals: int, closed: bool) -> None:
        self.closed, self.intervals, self.start, self.end = closed, intervals, start, end
        self.width = (end - start) / intervals
        self.nodes = start + self.width * np.arange(intervals + (not closed))

    def Sum(self, s: np.ndarray, values: np.ndarray, slopes: np.ndarray | None = None) -> np.ndarray:
        """Σ N_k(s) values + N_k'(s) slopes over points, (number of hats, m); values and slopes are (n, m)."""
        position = (s - self.start) / self.width
        left = np.clip(np.floor(position).astype(int), 0, self.intervals - 1)
        right, t = (left + 1) % len(self.nodes), (position - left)[:, None]
        change = 0 if slopes is None else slopes / self.width
        total = np.zeros((len(self.nodes), values.shape[1]))
        np.add.at(total, left, (1 - t) * values - change)
        np.add.at(total, right, t * values + change)
        return total

    def Values(self, moments: np.ndarray, window: int = 3) -> np.ndarray:
        """Of a function at the nodes from its moments ∫ N_k f ds, (number of hats, m): those of the parabola that has, or nearly has, the moments of f with
        as many neighbouring hats as the window says.

        Exact for parabolas. Three hats around a node give (-1, 14, -1)/12 of the mean values, with an error of order 4.
        """
        count, values = len(self.nodes), np.empty_like(moments)
        for k in range(count):
            first = k - window // 2 if self.closed else min(max(k - window // 2, 0), count - window)
            hats = np.arange(first, first + window)
            values[k] = np.linalg.pinv([self._powers(int(i), int(i) - k) for i in hats])[0] @ moments[hats % count]
        return values / self.width

    def _powers(self, hat: int, offset: int) -> np.ndarray:
        """∫ N (1, t, t²) dt of a hat around t = offset, of the one or two halves that it has."""
        halves = [half for half, there in ((-1, hat > 0), (1, hat < self.intervals)) if there or self.closed]
        return np.sum([(0.5, 0.5 * offset + half / 6, 0.5 * offset**2 + half * offset / 3 + 1 / 12) for half in halves], axis=0)

    def Largest(self, values: np.ndarray) -> np.ndarray:
        """At each node the largest of its value and those of its neighbours."""
        at = np.arange(len(values))[:, None] + [-1, 0, 1]
        return values[at % len(values) if self.closed else np.clip(at, 0, len(values) - 1)].max(axis=1)

    @property
    def weights(self) -> np.ndarray:
        """∫ N_k ds."""
        return self.width * np.array([self._powers(k, 0)[0] for k in range(len(self.nodes))])


@dataclass(frozen=True)
class TubeRule:
    """Gauss points in the coordinates of a tube.

    Parameters
    ----------
    along : int
        Their number between two nodes, in s.
    radial : int
        In √r, in each of three parts of the radius.
    angular : int
        In θ, from one face to the other.
    """

    along: int = 8
    radial: int = 6
    angular: int = 40

    def Along(self, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """s and ds.

        Parameters
        ----------
        edges
            Between which there are points, ascending.
        """
        x, w = np.polynomial.legendre.leggauss(self.along)
        half = 0.5 * np.diff(edges)[:, None]
        return (edges[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()

    def Radius(self, radii: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
        """r and dr up to the largest radius.

        Parameters
        ----------
        radii
            At which the rule is divided.
        """
        edges = np.sqrt([0.0, *sorted(radii)])
        x, w = np.polynomial.legendre.leggauss(self.radial)
        root = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (1 + x)).ravel()
        return root**2, root * (np.diff(edges)[:, None] * w).ravel()

    def Disc(self, radii: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """r, θ and r dr dθ on the disc of the largest radius.

        Parameters
        ----------
        radii
            As for Radius.
        """
        (r, dr), (x, w) = self.Radius(radii), np.polynomial.legendre.leggauss(self.angular)
        each, theta = (a.ravel() for a in np.meshgrid(r, np.pi * x, indexing="ij"))
        return each, theta, np.outer(r * dr, np.pi * w).ravel()


class FrontCurve:
    """A front as arrays: points, frames (e₁, e₂, e₃ as rows), curvatures at arc lengths."""

    def __init__(self, body: CrackedSolid, number: int) -> None:
        self.body, self.number, self.front = body, number, body.fronts[number]
        self.sheet = body.cracks[self.front.sheet]
        self.length, self.closed = self.front.length, self.front.closed and not self.front.corners

    def Inside(self, s: np.ndarray) -> np.ndarray:
        """s along a closed curve, or between its ends."""
        return s % self.length if self.front.closed else np.clip(s, 0, self.length)

    def Points(self, s: np.ndarray) -> np.ndarray:
        """(n, 3)."""
        return np.array([self.front.PointAt(t) for t in self.Inside(s)])

    def Frames(self, s: np.ndarray) -> np.ndarray:
        """(n, 3, 3)."""
        return np.array([self.front.FrameAt(t) for t in self.Inside(s)])

    def Curvatures(self, s: np.ndarray) -> np.ndarray:
        """κ = 1/R_f, (n,)."""
        return np.array([self.front.CurvatureAt(t) for t in self.Inside(s)])

    @cached_property
    def tube(self) -> CurvedTube | None:
        """The coordinates around it, of a curved sheet."""
        return None if self.sheet.planar else CurvedTube(self)

    def Speeds(self, s: np.ndarray) -> np.ndarray:
        """The length in space for each unit of s, (n,): 1, but for heights over a plane."""
        return np.ones(len(s)) if self.tube is None else self.tube.Front(s).speed

    def Slants(self, s: np.ndarray) -> np.ndarray:
        """The cosine of the angle that C' and the direction of x₁ have in the coordinates of the sheet, (n,): 0, but for heights over a plane."""
        if self.tube is None:
            return np.zeros(len(s))
        front = self.tube.Front(s)
        return np.abs((front.along * front.ahead).sum(axis=1))

    def Circles(self, s: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 24, 3) at a distance from C(s), around it, and by what the volume there is less than around a straight front of a plane, (n,)."""
        x1, x2 = radius * np.cos(CIRCLE), radius * np.sin(CIRCLE)
        if self.tube is None:
            frames = self.Frames(s)
            return self.Points(s)[:, None] + x1[:, None] * frames[:, None, 0] + x2[:, None] * frames[:, None, 1], radius * np.abs(self.Curvatures(s))
        places = self.tube.At(np.repeat(s, len(CIRCLE)), *np.tile([x1, x2], len(s)))
        return places.points.reshape(len(s), -1, 3), 1 - places.volume.reshape(len(s), -1).min(axis=1) / self.Speeds(s)

    def Beside(self, s: np.ndarray, x1: float) -> np.ndarray:
        """The points (n, 3) of the sheet's surface at a distance x₁ ahead."""
        if self.tube is None:
            return self.Points(s) + x1 * self.Frames(s)[:, 0]
        return self.tube.At(s, x1 + 0 * s, 0 * s).points

    def Jumps(self, s: np.ndarray, radius: float) -> np.ndarray:
        """Whether the sheet's curvature jumps nearer to C(s) than a radius, (n,)."""
        return np.zeros(len(s), dtype=bool) if self.tube is None else self.tube.surface.Jumps(self.tube.Front(s).at, radius)

    def Kinks(self, s: np.ndarray, radius: float) -> np.ndarray:
        """Whether the sheet has a kink, or what lies behind one, nearer to C(s) than a radius, (n,)."""
        return np.zeros(len(s), dtype=bool) if self.tube is None else self.tube.surface.Kinks(self.tube.Front(s).at, radius)

    @cached_property
    def joints(self) -> np.ndarray:
        """Arc lengths where κ jumps, such as between an arc and a segment: by bisection between points of which it differs by more than smooth curves allow."""
        s = np.linspace(0, self.length, 401)
        kappa, tolerance = self.Curvatures(s), 1e-8 / self.length
        found = []
        for i in np.flatnonzero(np.abs(np.diff(kappa)) > tolerance):
            a, b, at_a, at_b = s[i], s[i + 1], kappa[i], kappa[i + 1]
            while b - a > 1e-13 * self.length and abs(at_b - at_a) > tolerance:
                middle = 0.5 * (a + b)
                at = self.front.CurvatureAt(middle)
                if abs(at - at_a) > abs(at_b - at):
                    b, at_b = middle, at
                else:
                    a, at_a = middle, at
            if abs(at_b - at_a) > tolerance:
                found.append(0.0 if self.front.closed and b > (1 - 1e-12) * self.length else b)
        return np.array(sorted(found))

    def JointsOn(self, hats: Hats) -> np.ndarray:
        """The joints under hats."""
        joints = np.array([*self.joints, *(self.joints + self.length if self.front.closed else [])])
        return joints[(joints < hats.end) & (joints >= hats.start if hats.closed else joints > hats.start)]

    def Edges(self, hats: Hats) -> np.ndarray:
        """Nodes, the end, and joints, between which integrands are smooth along s."""
        return np.unique([*hats.nodes, hats.end, *self.JointsOn(hats)])

    def CurvatureChange(self, s: np.ndarray) -> np.ndarray:
        """κ'(s) between joints, by differences."""
        s, step = self.Inside(s), 1e-5 * self.length
        edges = np.array([-np.inf if self.front.closed else 0, *self.joints, np.inf if self.front.closed else self.length])
        piece = np.searchsorted(edges, s, side="right") - 1
        low, high = np.maximum(s - step, edges[piece] + 1e-9 * self.length), np.minimum(s + step, edges[piece + 1] - 1e-9 * self.length)
        return (self.Curvatures(high) - self.Curvatures(low)) / (high - low)

    @property
    def h(self) -> float:
        """The longest edge of the elements that hold the front, their mean."""
        return size_at_front(self.body, self.number)

    def Parts(self) -> list[tuple[float, float]]:
        """Start and end of its parts between corners; along a closed one without corners the whole."""
        corners = list(self.front.corners)
        if self.front.closed and corners:
            return list(zip(corners, [*corners[1:], corners[0] + self.length]))
        cuts = [0.0, *corners, self.length]
        return list(zip(cuts[:-1], cuts[1:]))


class Room:
    """What a tube meets: ∂Ω, other sheets, other parts of its front, another material."""

    def __init__(self, curve: FrontCurve, material: Isotropic) -> None:
        self.curve, self.body, self.mesh = curve, curve.body, curve.body.mesh
        others = [FrontCurve(self.body, i) for i in range(len(self.body.fronts)) if i != curve.number]
        self.others = scipy.spatial.cKDTree(np.concatenate([np.empty((0, 3)), *(other.Points(np.linspace(0, other.length, SAMPLES)) for other in others)]))
        self.regions = self.mesh.ngmesh.Elements3D().NumPy()["index"] if len(material.regions) > 1 else None
        cells = [[self._place(i, p) for p in cell.polygon] for i in range(len(self.body.cracks)) if i != curve.front.sheet for cell in self.body.Elements(i)]
        self.centres = np.array([np.mean(c, axis=0) for c in cells]).reshape(-1, 3)
        self.sizes = np.array([np.linalg.norm(np.array(c) - np.mean(c, axis=0), axis=1).max() for c in cells])

    def _place(self, crack: int, p: tuple[float, float]) -> np.ndarray:
        return np.array(self.body.cracks[crack].PointAt(*p))

    def Obstacles(self, s: np.ndarray, radius: float) -> list[str]:
        """What the disc of a radius at each s meets, "" for nothing."""
        points = self.curve.Points(s)
        s, found = self.curve.Inside(s), np.full(len(s), "", dtype=object)
        for share in (0.5, 1):
            circle, lost = self.curve.Circles(s, share * radius)
            at = self.mesh(*np.concatenate([circle, points[:, None]], axis=1).reshape(-1, 3).T)["nr"].reshape(len(s), -1)
            found[(at < 0).any(axis=1)] = "the boundary of the body"
            if self.regions is not None:
                inside = (at >= 0).all(axis=1)
                numbers = self.regions[np.maximum(at, 0)]
                found[inside & (numbers != numbers[np.argmax(inside), -1]).any(axis=1)] = "another material"
        found[lost > BENT] = "its own centre of curvature"
        found[self.curve.Jumps(s, radius)] = "a jump of the sheet's curvature"
        found[self.curve.Kinks(s, radius)] = "a kink of the sheet, or what lies behind it"
        allowed = 1e-6 * self.curve.length + radius * self.curve.Slants(s) / (1 - BENT)
        beside = [self.curve.Beside(s, side * radius) for side in (1, -1)]
        for i, point in enumerate(points):
            if found[i]:
                continue
            nearest = [self.curve.front.Tube(tuple(places[i]))[2] - s[i] for places in beside]
            if any(min(abs(d), self.curve.length - abs(d) if self.curve.front.closed else np.inf) > allowed[i] for d in nearest):
                found[i] = "another part of the same front"
            elif self.others.query(point)[0] <= radius:
                found[i] = "another front"
            elif len(self.centres) and (np.linalg.norm(self.centres - point, axis=1) < self.sizes + radius).any():
                found[i] = "another sheet"
        return list(found)

    def Stretch(self, start: float, end: float, radius: float, h: float) -> tuple[float, float] | str:
        """Where between start and end the discs have room, all but near ends that are corners or on ∂Ω; or what they meet."""
        inset = 0.0 if self.curve.closed else 1e-7 * h
        s = np.linspace(start + inset, end - inset, max(9, int(np.ceil(4 * (end - start) / h)) + 1))
        met = self.Obstacles(s, radius)
        free = [i for i, what in enumerate(met) if not what]
        first, last = (free[0], free[-1]) if free else (0, 0)
        near_end = 0.0 if self.curve.closed else 2 * radius
        wrong = [i for i, what in enumerate(met) if what and (first < i < last or near_end < s[i] - start and near_end < end - s[i])]
        if self.curve.closed or not free or s[last] - s[first] < 2 * h:
            wrong += [i for i, what in enumerate(met) if what]
        return f"{met[wrong[0]]} at {place(tuple(self.curve.Points(s[wrong[:1]])[0]))}" if wrong else (float(s[first]), float(s[last]))


def points_on_sheet(body: CrackedSolid, crack: int, points: np.ndarray) -> np.ndarray:
    """Mesh points at points (n, 3) of a sheet, in the elements that carry it: of two beside a face on the sheet it is one."""
    mesh = body.mesh
    at = points_inside(mesh, points)
    carriers = np.array([cell.element for cell in body.Elements(crack)])
    elsewhere = np.flatnonzero(~np.isin(at["nr"], carriers))
    if len(elsewhere):
        corners = np.array([[mesh[v].point for v in mesh[ElementId(VOL, int(number))].vertices] for number in carriers])
        edges = np.linalg.inv((corners[:, :3] - corners[:, 3:]).swapaxes(1, 2))
        for i in elsewhere:
            reference = np.einsum("eij,ej->ei", edges, points[i] - corners[:, 3])
            best = np.argmax(np.minimum(reference.min(axis=1), 1 - reference.sum(axis=1)))
            at["nr"][i] = carriers[best]
            at["x"][i], at["y"][i], at["z"][i] = reference[best]
    return at
