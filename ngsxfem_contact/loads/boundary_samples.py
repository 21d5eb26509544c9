"""Where displacements given on the boundary must fit together: at corners between regions, and at the two faces of a mouth."""

from __future__ import annotations

from functools import cached_property, singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND

from .._ngsxfem_contact import CrackedSolid, EndKind
from ..points import boundary_points, crack_points
from ..sheets import heights_over

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackedMesh
    from .supports import HeldSide

BESIDE = 1e-6  # of an edge: how far beside a mouth a given displacement is read
AT = 1e-8  # of an edge: a mouth nearer to a vertex is at the vertex
CORNERS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])  # reference coordinates of the corners of a triangle


@singledispatch
def boundary_samples(body: Any) -> BoundarySamples:
    """Those of a body."""
    return BoundarySamples(body)


class BoundarySamples:
    """The two ends of each boundary element and, beside them, a point on either side of each mouth.

    Arrays, one row for each point: element, xi (reference coordinate), region, vertex (-1 for points beside mouths), mouth (its number, or -1) and side
    (±1 beside mouths).

    Attributes
    ----------
    mouths
        (number of the crack, arc length) of each.
    size
        The lengths of the boundary elements, in space their areas.
    """

    def __init__(self, body: Any) -> None:
        self.body = body
        elements = list(body.mesh.Elements(BND))
        corners = np.array([[vertex.nr for vertex in element.vertices] for element in elements])
        edges = body.mesh.ngmesh.Coordinates()[corners, :2]
        rows = [[number, xi, vertex, -1, 0] for number, ends in enumerate(corners) for vertex, xi in zip(ends, (1, 0))]
        self.size = np.hypot(*(edges[:, 1] - edges[:, 0]).T)
        self.mouths: list[Any] = list(mouths_of(body))
        for number, (crack, s) in enumerate(self.mouths):
            point = body.cracks[crack].PointAt(s)
            for element, at in elements_at(edges, point):
                for end, xi in ((0, 1), (1, 0)):
                    if abs(at - xi) < AT:
                        rows[2 * element + end][3] = number
                    else:
                        side = body.cracks[crack].SideOf(tuple(0.5 * (edges[element, end] + point)))
                        rows.append([element, at + BESIDE * (xi - at), -1, number, int(side)])
        element, self.xi, vertex, mouth, side = np.array(rows).T
        self.element, self.vertex, self.mouth, self.side = (column.astype(int) for column in (element, vertex, mouth, side))
        self.region = np.array([element.index for element in elements])[self.element]

    @cached_property
    def beside(self) -> np.ndarray:
        """The rows beside mouths."""
        return np.flatnonzero(self.side)

    def Values(self, function: CoefficientFunction, region: int) -> np.ndarray:
        """A CoefficientFunction at the points of a region, NaN at the others: (rows, components)."""
        rows = self.region == region
        values = np.full((len(rows), function.dim), np.nan)
        values[rows] = function(self._points(rows)).reshape(np.count_nonzero(rows), -1)
        return values

    def _points(self, rows: np.ndarray) -> np.ndarray:
        return boundary_points(self.body.mesh, self.element[rows], self.xi[rows])

    def Zero(self, region: int) -> np.ndarray:
        """Zero at the points of a region, NaN at the others."""
        return np.where(self.region == region, 0, np.nan)

    def Sizes(self, region: int, functions: np.ndarray) -> np.ndarray:
        """The size of the part of a region at the vertex of each φ_i; 1 for functions of edges, which in the plane belong to one region alone."""
        ends = np.flatnonzero((self.region == region) & (self.vertex >= 0))
        of_vertex = np.bincount(self.vertex[ends], self.size[self.element[ends]], minlength=self.body.mesh.nv)
        return np.where(functions < len(of_vertex), of_vertex[np.minimum(functions, len(of_vertex) - 1)], 1)

    def Corners(self) -> list[np.ndarray]:
        """Arrays of the rows at each vertex at which regions meet and no crack ends."""
        rows = np.flatnonzero((self.vertex >= 0) & (self.mouth < 0))
        rows = rows[np.argsort(self.vertex[rows], kind="stable")]
        same = np.diff(self.vertex[rows]) == 0
        meeting = np.unique(self.vertex[rows[1:][same & (np.diff(self.region[rows]) != 0)]])
        rows = rows[np.isin(self.vertex[rows], meeting)]
        return np.split(rows, np.flatnonzero(np.diff(self.vertex[rows])) + 1) if len(rows) else []

    def NormalJumps(self, sides: dict[tuple[int, int], HeldSide]) -> np.ndarray:
        """The normal jump n·(u⁺ - u⁻) that is given at each mouth; NaN where it is not given on both faces.

        Parameters
        ----------
        sides
            (region, component) → HeldSide.
        """
        jumps = np.zeros(len(self.mouths))
        for number in range(len(jumps)):
            for component, normal in enumerate(self.Normal(number)):
                if abs(normal) > 1e-8:
                    jumps[number] += normal * (self._given(sides, number, 1, component) - self._given(sides, number, -1, component))
        return jumps

    def Normal(self, mouth: int) -> tuple[float, ...]:
        """n at a mouth."""
        crack, s = self.mouths[mouth]
        tangent = self.body.cracks[crack].TangentAt(s)
        return -tangent[1], tangent[0]

    def Place(self, mouth: int) -> tuple[float, ...]:
        """Where a mouth is."""
        crack, s = self.mouths[mouth]
        return self.body.cracks[crack].PointAt(s)

    def AtMouth(self, function: CoefficientFunction, mouth: int) -> float:
        """A scalar function at a mouth."""
        crack, s = self.mouths[mouth]
        return function(crack_points(self.body, crack, [s])).item()

    def _given(self, sides: dict[tuple[int, int], HeldSide], mouth: int, side: int, component: int) -> float:
        """What is given on one face of a mouth, NaN if nothing is."""
        rows = self.beside[(self.mouth[self.beside] == mouth) & (self.side[self.beside] == side)]
        given = [sides[self.region[row], component].samples[row] for row in rows if (self.region[row], component) in sides]
        return given[0] if given else np.nan


class SurfaceSamples(BoundarySamples):
    """The three corners of each boundary triangle of a body in space and, on either side of each piece of a mouth, a point of the triangle that it runs through, or beside.

    Attributes
    ----------
    mouths
        (number of the sheet, a boundary element, reference coordinates of the middle of the piece) of each.
    """

    def __init__(self, body: CrackedSolid) -> None:
        self.body, self.mouths = body, []
        elements = list(body.mesh.Elements(BND))
        self.corners = np.array([[vertex.nr for vertex in element.vertices] for element in elements])
        self.points = np.array(body.mesh.ngmesh.Coordinates())
        a, b, c = np.moveaxis(self.points[self.corners], 1, 0)
        self.size = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        heights = [heights_over(sheet, self.points) for sheet in body.cracks]
        self.thickness = AT * np.ptp(self.points, axis=0).max()
        on_plane = np.min(np.abs(heights), axis=0) <= self.thickness
        rows, reference = [], []  # beside the mouths
        for sheet, of_points in enumerate(heights):
            of_points[np.abs(of_points) <= self.thickness] = 0
            for pieces in self._pieces(sheet, of_points):
                mouth = len(self.mouths)
                self.mouths.append((sheet, pieces[0][0], pieces[0][1] @ CORNERS))
                for element, middle in pieces:
                    h = of_points[self.corners[element]]
                    for side in (1, -1):
                        k = int(np.argmax(side * h))
                        if side * h[k] > 0:
                            rows.append((element, -1, mouth, side))
                            reference.append((middle + BESIDE * (np.eye(3)[k] - middle)) @ CORNERS)
        number, vertex = np.repeat(np.arange(len(self.corners)), 3), self.corners.ravel()
        at_corners = np.column_stack([number, vertex, np.where(on_plane[vertex], 0, -1), np.zeros(len(vertex), dtype=int)])
        self.element, self.vertex, self.mouth, self.side = np.concatenate([at_corners, np.array(rows, dtype=int).reshape(-1, 4)]).T
        self.reference = np.concatenate([np.tile(CORNERS, (len(self.corners), 1)), np.array(reference).reshape(-1, 2)])
        self.region = np.array([element.index for element in elements])[self.element]

    def _pieces(self, sheet: int, heights: np.ndarray) -> Iterator[list[tuple[int, np.ndarray]]]:
        """Of each piece of a mouth the boundary triangles that it runs through or beside, with the barycentric coordinates of its middle."""
        contains = self.body.cracks[sheet].Contains
        inside = lambda element, middle: contains(tuple(middle @ self.points[self.corners[element]]))
        for element in self.body.CutBoundaryElements(sheet):
            middle = middle_of_section(heights[self.corners[element]])
            if inside(element, middle):
                yield [(element, middle)]
        on_plane = heights[self.corners] == 0
        beside: dict[tuple[int, ...], list[tuple[int, np.ndarray]]] = {}
        for element in np.flatnonzero(on_plane.sum(axis=1) == 2):
            edge = tuple(sorted(self.corners[element][on_plane[element]]))
            beside.setdefault(edge, []).append((int(element), 0.5 * on_plane[element]))
        yield from (pieces for pieces in beside.values() if inside(*pieces[0]))

    def _points(self, rows: np.ndarray) -> np.ndarray:
        return boundary_points(self.body.mesh, self.element[rows], *self.reference[rows].T)

    def Normal(self, mouth: int) -> tuple[float, ...]:
        """n of the sheet."""
        sheet = self.body.cracks[self.mouths[mouth][0]]
        return sheet.FrameAt(*sheet.Flat(self.Place(mouth))[:2])[0]

    def Place(self, mouth: int) -> tuple[float, ...]:
        """The middle of the piece."""
        _, element, reference = self.mouths[mouth]
        return tuple(np.append(reference, 1 - reference.sum()) @ self.points[self.corners[element]])

    def AtMouth(self, function: CoefficientFunction, mouth: int) -> float:
        """A scalar function at the middle of the piece."""
        _, element, reference = self.mouths[mouth]
        return function(boundary_points(self.body.mesh, np.array([element]), *reference[:, None])).item()


def middle_of_section(heights: np.ndarray) -> np.ndarray:
    """The barycentric coordinates, (3,), of the middle of the line on which a triangle has height 0, of the heights of its corners."""
    corners = np.eye(3)
    ends = [corners[i] for i in range(3) if heights[i] == 0]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if heights[i] * heights[j] < 0:
            ends.append((heights[i] * corners[j] - heights[j] * corners[i]) / (heights[i] - heights[j]))
    return np.mean(ends, axis=0)


boundary_samples.register(CrackedSolid, SurfaceSamples)


def mouths_of(body: CrackedMesh) -> Iterator[tuple[int, float]]:
    """(number of the crack, arc length) of the ends of cracks on the boundary."""
    for number in range(len(body.cracks)):
        for end in body.Ends(number):
            if end.kind == EndKind.Mouth:
                yield number, end.s


def elements_at(edges: np.ndarray, point: tuple[float, float]) -> Iterator[tuple[int, float]]:
    """(number, reference coordinate) of the boundary edges (n, 2, 2) on which a point lies; beside a curved boundary that of the nearest chord."""
    to_first, to_second, length = (np.hypot(*vectors.T) for vectors in (edges[:, 0] - point, edges[:, 1] - point, edges[:, 1] - edges[:, 0]))
    detour = (to_first + to_second) / length - 1
    numbers = np.flatnonzero(detour < max(1e-10, (1 + 1e-10) * detour.min()))
    return zip(numbers, np.minimum(to_second[numbers] / length[numbers], 1))
