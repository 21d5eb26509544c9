"""Where cracks start: what starts, and where a mean stress reaches the strength in the body or on ∂Ω. docs/method.md, section 9."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import atan2, degrees
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BND, CF, x, y

from .._ngsxfem_contact import Crack
from ..arguments import check_positive, check_type
from ..errors import warn
from ..operators import OutwardNormal
from ..points import boundary_points, mesh_arrays, mesh_points, place
from ..share import share_in
from ..spaces.resolution import element_sizes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import Mesh

    from .._ngsxfem_contact import CrackedMesh
    from ..contact.solution import ContactSolution

DISK = 1  # elements in its radius
ACROSS = 0.5  # the least cosine between a crack that starts on ∂Ω and the normal


@dataclass(frozen=True)
class NewCrack:
    """A crack that starts.

    Parameters
    ----------
    crack
        The Crack; its name does not count.
    point
        Where it starts, (x, y).
    stress
        That makes it start.
    origin
        What it starts from, as its name shall say.
    reason
        In words.
    """

    crack: Crack
    point: tuple[float, float]
    stress: float
    origin: str
    reason: str

    @property
    def angle(self) -> float:
        """Of the crack, in degrees from the direction of x."""
        (a, b), (c, d) = self.crack.points[0], self.crack.points[-1]
        return degrees(atan2(d - b, c - a))


def segment(a: np.ndarray, b: np.ndarray) -> Crack:
    """The straight crack between two points."""
    return Crack([tuple(a.tolist()), tuple(b.tolist())])


def stress_at(solution: ContactSolution, points: Any) -> np.ndarray:
    """(n, 3): σ_xx, σ_yy, σ_xy at mesh points."""
    return solution.stress(points)[:, [0, 3, 1]]


def size_at(body: CrackedMesh, point: Sequence[float] | np.ndarray) -> float:
    """Of the element at a point."""
    return float(share_in(body).AtPoints([point], lambda points: element_sizes(body, np.atleast_1d(points)["nr"].tolist()))[0])


def warn_of_small_radius(who: str, radius: float, point: tuple[float, float], size: float, least: int) -> None:
    """A stress over less than some elements is that of the mesh."""
    if radius < 0.9 * least * size:  # triangles of one mesh differ by as much
        warn(
            f"{who}: radius={radius:.3g} at {place(point)} is {radius / size:.1f} elements: with less than {least} the stress depends on the mesh; "
            f"refine to h <= {radius / least:.2g} there"
        )


class StressSamples:
    """σ of a solution at the points of a rule with their weights, in some regions; means over disks."""

    def __init__(self, solution: ContactSolution, region: str) -> None:
        mesh, self.share = solution.body.mesh, solution.problem.V.share
        element, xi, eta, self.weights, x, y = solution.body.dx.Points(2 * solution.problem.V.order)
        inside = np.array(list(mesh.Materials(region).Mask()), dtype=bool)[mesh.ngmesh.Elements2D().NumPy()["index"] - 1][element]
        inside &= self.share.IsOwn(element)
        if not self.share.Max(inside.any()):
            raise ValueError(f"StressInitiation: region={region!r} matches no region; the mesh has {sorted(set(mesh.GetMaterials()))}")
        element, xi, eta, self.weights, x, y = (values[inside] for values in (element, xi, eta, self.weights, x, y))
        self.positions, self.stresses = np.column_stack([x, y]), stress_at(solution, mesh_points(mesh, element, xi, eta))
        self.tree = scipy.spatial.cKDTree(self.positions)

    @cached_property
    def largest(self) -> np.ndarray:
        """(n,): the principal stress at each of the points."""
        return principal(self.stresses)[0]

    def Reach(self, points: np.ndarray, radius: float, strength: float) -> np.ndarray:
        """(n,) boolean: at which of points (n, 2) the mean over a disk may have a principal stress of the strength, since a point of the disk has."""
        high = np.concatenate(self.share.Gather(self.positions[self.largest >= strength]))
        return scipy.spatial.cKDTree(high).query(points)[0] <= radius if len(high) else np.zeros(len(points), dtype=bool)

    def Means(self, points: np.ndarray, radius: float) -> np.ndarray:
        """(n, 3): the mean of σ over the part of each disk that is in the body; 0 where there is none. All processes ask for the same points."""
        sums = np.zeros((len(points), 4))
        for i, inside in enumerate(self.tree.query_ball_point(points, radius)):
            if inside:
                sums[i] = self.weights[inside] @ np.column_stack([self.stresses[inside], np.ones(len(inside))])
        *stresses, area = self.share.Sum(sums).T
        return np.divide(stresses, area, out=np.zeros((3, len(points))), where=area > 0).T


def principal(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,), (n, 2): the largest principal stress of (n, 3), and its direction."""
    xx, yy, xy = stress.T
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    return 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy), np.column_stack([np.cos(angle), np.sin(angle)])


def first_largest(values: np.ndarray) -> int:
    """Where the first of the largest values is: means over disks that hold the same points differ by round-off only."""
    return int(np.argmax(values >= values.max() - 1e-9 * abs(values.max())))


@dataclass(frozen=True)
class StressInitiation:
    """A crack starts where the largest principal stress, of the mean of σ over a disk, reaches the strength: across it, one in each state.

    In the body it lies on both sides of the place, on ∂Ω it runs inwards from a mouth. The disk ends at ∂Ω; that σ is a mean makes the place independent of the mesh.

    Parameters
    ----------
    strength
        A stress > 0.
    radius
        Of the disk, a length > 0: an element at the place or more.
    length
        Of the crack, a length > 0: some elements, so that its tips have room.
    region, boundary
        Where: names of regions and of boundaries, regular expressions, or None for none; default everywhere.

    Raises
    ------
    ValueError
        For numbers that make no sense.

    Notes
    -----
    Nothing starts nearer to a crack than `length`: tips have their toughness, junctions JunctionInitiation. Nor in the body nearer to ∂Ω, where it starts on ∂Ω, at 30° to it or
    more. Where supports or loads make σ singular, leave their boundaries out.

    References
    ----------
    Taylor, The Theory of Critical Distances (2007): means over areas.
    """

    strength: float
    radius: float
    length: float
    region: str | None = ".*"
    boundary: str | None = ".*"

    def __post_init__(self) -> None:
        for name in ("strength", "radius", "length"):
            check_positive(getattr(self, name), f"StressInitiation: {name}")
        for name in ("region", "boundary"):
            check_type(getattr(self, name), str | None, f"StressInitiation: {name}", "a name, a regular expression, or None")

    def Starts(self, solution: ContactSolution) -> list[NewCrack]:
        """The crack at the place with the largest stress, if it reaches the strength."""
        samples = StressSamples(solution, ".*" if self.region is None else self.region)
        found = [best for candidates in (self._on_boundary, self._inside) if (best := candidates(solution.body, samples)) is not None]
        return [max(found, key=lambda new: new.stress)] if found else []

    def _clear(self, body: CrackedMesh, points: np.ndarray) -> np.ndarray:
        """Those that are not beside a crack."""
        near = [any(crack.Distance(tuple(point)) < self.length for crack in body.cracks) for point in points.tolist()]
        return ~np.array(near, dtype=bool)

    def _new(self, body: CrackedMesh, crack: Crack, s: float, stress: float, origin: str, where: str) -> NewCrack:
        """s: the arc length at which it starts."""
        warn_of_small_radius("StressInitiation", self.radius, crack.PointAt(s), size_at(body, crack.PointAt(s + 1e-3 * self.length)), DISK)
        return NewCrack(crack, crack.PointAt(s), stress, origin, f"the principal stress {stress:.4g} has reached {self.strength:.4g} {where}")

    def _on_boundary(self, body: CrackedMesh, samples: StressSamples) -> NewCrack | None:
        if self.boundary is None:
            return None
        points, inward, names = points_along(body.mesh, self.boundary, 0.25 * self.radius)
        reach = samples.Reach(points, self.radius, self.strength)
        points, inward, names = points[reach], inward[reach], names[reach]
        stresses, directions = principal(samples.Means(points, self.radius))
        across = np.column_stack([-directions[:, 1], directions[:, 0]])
        slope = (across * inward).sum(axis=1)
        fits = (stresses >= self.strength) & (np.abs(slope) >= ACROSS)
        fits[fits] = self._clear(body, points[fits])
        if not fits.any():
            return None
        i = int(np.flatnonzero(fits)[first_largest(stresses[fits])])
        crack = segment(points[i], points[i] + self.length * np.sign(slope[i]) * across[i])
        name = str(names[i])
        return self._new(body, crack, 0.0, float(stresses[i]), name, f"on the boundary {name!r}")

    def _inside(self, body: CrackedMesh, samples: StressSamples) -> NewCrack | None:
        if self.region is None:
            return None
        points = mesh_arrays(body.mesh)[0]
        points = points[samples.Reach(points, self.radius, self.strength)]
        points = np.unique(np.concatenate(samples.share.Gather(points)), axis=0)
        points = points[self._clear(body, points) & self._inland(body, points)]
        if not len(points):
            return None
        best = points[first_largest(principal(samples.Means(points, self.radius))[0])]
        for step in self.radius * 0.5 ** np.arange(1, 7):  # between vertices
            around = best + step * np.array([(i, j) for i in (0, -1, 1) for j in (0, -1, 1)])
            best = around[first_largest(principal(samples.Means(around, self.radius))[0])]
        (stress,), (direction,) = principal(samples.Means(best[None], self.radius))
        if stress < self.strength:
            return None
        half = 0.5 * self.length * np.array([-direction[1], direction[0]])
        region = samples.share.AtPoints([best], lambda points: body.mesh.ngmesh.Elements2D().NumPy()["index"][np.atleast_1d(points)["nr"]])
        origin = body.mesh.GetMaterials()[int(region[0]) - 1]
        return self._new(body, segment(best - half, best + half), 0.5 * self.length, float(stress), origin, f"in {origin!r}")

    def _inland(self, body: CrackedMesh, points: np.ndarray) -> np.ndarray:
        """Those farther than the length from ∂Ω."""
        outer, _, _ = points_along(body.mesh, ".*", 0.25 * self.length)
        return scipy.spatial.cKDTree(outer).query(points)[0] > self.length if len(points) else np.zeros(0, dtype=bool)


def points_along(mesh: Mesh, pattern: str, spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of ∂Ω on some boundaries, about a spacing apart: (n, 2), the unit normals into the body, the names of the boundaries."""
    mask = list(mesh.Boundaries(pattern).Mask())
    elements = [element for element in mesh.Elements(BND) if mask[element.index] and len(mesh[element.edges[0]].elements) == 1]
    if not elements:
        raise ValueError(f"StressInitiation: boundary={pattern!r} matches no boundary; the mesh has {sorted(set(mesh.GetBoundaries()))}")
    lengths = [np.linalg.norm(np.subtract(*(mesh[v].point for v in element.vertices))) for element in elements]
    counts = np.ceil(np.array(lengths) / spacing).astype(int)
    part = np.concatenate([(np.arange(n) + 0.5) / n for n in counts])
    points = boundary_points(mesh, np.repeat([element.nr for element in elements], counts), part)
    return CF((x, y))(points), -OutwardNormal(mesh)(points), np.repeat([element.mat for element in elements], counts)
