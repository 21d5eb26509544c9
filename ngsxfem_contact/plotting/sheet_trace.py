"""What a sheet cuts out of its elements: polygons of its plane whose corners have numbers, which neighbours share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .polygons import Triangle, divided, ear_triangles, holds, inner_point, twice_area

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackedSolid, Sheet, SheetCell

SAME = 1e-7  # relative to an element: what is nearer is one point
SAG = 0.005  # between a curve and a chord of it, relative to the chord

Node = tuple[int, int]


class SheetTrace:
    """The polygons of a sheet; those that its curves enter are divided along them, and a curve is a polyline of its own points there.

    Parameters
    ----------
    body : CrackedSolid
    crack : int
        A number in `body.cracks`.

    Attributes
    ----------
    sheet, cells
        The Sheet, and its SheetCells.
    points (N, 2), places (N, 3)
        In the coordinates of the sheet, and in space: of a curved sheet on the polygons, which are plane.
    nodes
        {(i, j): number} of the points on edges of the mesh between vertices i < j, and (i, i) on the vertex i.
    sides
        {(p, q): ((i, j), (k, l))}: for each side of a polygon its ends p < q, and their nodes.
    between
        {(p, q): numbers}: the points of curves on such a side, from p to q.
    loops (n)
        Polygons as lists of numbers, counter-clockwise.
    loop_cell, inside (n,)
        The number in `cells` of each, and whether it belongs to the sheet.
    triangles (n)
        Those of each polygon, with further points where it belongs to the sheet: none has all corners on its outline, and none shares a side inside a polygon between two
        points of the outline, since what lies between points of a front only would not open.
    """

    def __init__(self, body: CrackedSolid, crack: int) -> None:
        self.sheet, self.cells = body.cracks[crack], body.Elements(crack)
        self._places: list[np.ndarray] = []
        self.nodes: dict[Node, int] = {}
        self.sides: dict[Node, tuple[Node, Node]] = {}
        self.between: dict[Node, list[int]] = {}
        corners = [self._Corners(cell) for cell in self.cells]
        lines = [self._Lines(cell, around) for cell, around in zip(self.cells, corners)]
        for (p, _), numbers in self.between.items():
            numbers.sort(key=lambda number, p=p: float(np.sum((self._places[number] - self._places[p]) ** 2)))  # type: ignore[misc]
        self._points = np.array(self._places).reshape(-1, 2)
        self.loops: list[list[int]] = []
        of_cell: list[int] = []
        inside: list[bool] = []
        for number, (around, across) in enumerate(zip(corners, lines)):
            loops = self._Divided(around, across)
            self.loops += loops
            of_cell += [number] * len(loops)
            inside += [True] if len(loops) == 1 and not self.cells[number].chords else [self._IsInside(loop) for loop in loops]
        self.loop_cell, self.inside = np.array(of_cell, dtype=int), np.array(inside, dtype=bool)
        on_outline = set(self.outline.ravel().tolist())
        self.triangles = [self._Triangles(loop, on_outline if here else set()) for loop, here in zip(self.loops, inside)]
        self.points = np.array(self._places).reshape(-1, 2)
        self.places = self._InSpace()

    @property
    def element(self) -> np.ndarray:
        """(n,): the element of the mesh that carries each polygon."""
        return np.array([cell.element for cell in self.cells], dtype=int)[self.loop_cell]

    def _InSpace(self) -> np.ndarray:
        """(N, 3): of a curved sheet by the affine map of a polygon that a point belongs to, from its coordinates to space."""
        if self.sheet.planar:
            return np.array(self.sheet.origin) + self.points @ np.array(self.sheet.axes)
        places = np.array([self.sheet.PointAt(*p) for p in self.points]).reshape(-1, 3)
        for number, loop, triangles in zip(self.loop_cell, self.loops, self.triangles):
            flat, space = np.array(self.cells[number].polygon), np.array(self.cells[number].points)
            affine, own = np.linalg.lstsq(flat[1:] - flat[0], space[1:] - space[0], rcond=None)[0], [*loop, *np.ravel(triangles)]
            places[own] = space[0] + (self.points[own] - flat[0]) @ affine
        return places

    @property
    def outline(self) -> np.ndarray:
        """(k, 2): sides of polygons of the sheet beyond which it does not go on."""
        loops = (loop for loop, inside in zip(self.loops, self.inside) if inside)
        sides = np.array([(p, q) for loop in loops for p, q in zip(loop, [*loop[1:], loop[0]])])
        found, count = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
        return found[count == 1]

    def _Triangles(self, loop: list[int], on_outline: set[int]) -> list[Triangle]:
        triangles, around = ear_triangles(self._points, loop), list(zip(loop, [*loop[1:], loop[0]]))
        sides = {frozenset(side) for side in around}
        edges = {frozenset(edge) for a, b, c in triangles for edge in ((a, b), (b, c), (c, a))} - sides
        shut = {edge for edge in edges if edge <= on_outline}
        if not shut and not on_outline.issuperset(triangles[0]):
            return triangles
        centre = self._points[loop].mean(axis=0)
        if all(twice_area(centre, self._points[p], self._points[q]) > 0 for p, q in around):
            return self._Star(centre, loop)
        middle = {edge: [self._Add(np.mean([self._places[p] for p in edge], axis=0))] for edge in shut}
        found: list[Triangle] = []
        for triangle in triangles:
            ring = [point for p, q in zip(triangle, (*triangle[1:], triangle[0])) for point in (p, *middle.get(frozenset((p, q)), []))]
            closed = len(ring) > 3 or on_outline.issuperset(triangle)
            found += self._Star(np.mean([self._places[p] for p in triangle], axis=0), ring) if closed else [triangle]
        return found

    def _Star(self, centre: np.ndarray, loop: list[int]) -> list[Triangle]:
        """The triangles from a new point in the middle of a polygon."""
        number = self._Add(centre)
        return [(number, p, q) for p, q in zip(loop, [*loop[1:], loop[0]])]

    def _Add(self, place: Any) -> int:
        self._places.append(np.asarray(place, dtype=float))
        return len(self._places) - 1

    def _Corners(self, cell: SheetCell) -> list[int]:
        """Numbers of the corners of a polygon, whose sides are noted."""
        nodes = [(int(i), int(j)) for i, j in cell.nodes]
        corners = [self.nodes[node] if node in self.nodes else self.nodes.setdefault(node, self._Add(place)) for node, place in zip(nodes, cell.polygon)]
        for k in range(len(corners)):
            (p, first), (q, second) = sorted(((corners[k - 1], nodes[k - 1]), (corners[k], nodes[k])))
            self.sides[p, q] = first, second
            self.between.setdefault((p, q), [])
        return corners

    def _Lines(self, cell: SheetCell, corners: list[int]) -> list[list[int]]:
        """The curves in a polygon as polylines from side to side, whose ends become points of these sides."""
        tolerance = SAME * cell.h
        lines: list[list[np.ndarray]] = []
        last: tuple[int, float] | None = None
        for loop, s0, s1 in in_order(cell, self.sheet.loops):
            line = polyline(self.sheet.loops[loop], s0, s1)
            if last is not None and last[0] == loop and abs(last[1] - s0) <= tolerance and self._Side(line[0], corners)[0] > tolerance:
                lines[-1] += line[1:]
            else:
                lines.append(line)
            last = loop, s1 % self.sheet.loops[loop].length
        found = []
        for line in lines:
            ends = [self._OnSide(*self._Side(place, corners)[1:], place, tolerance) for place in (line[0], line[-1])]
            found.append([ends[0], *map(self._Add, line[1:-1]), ends[1]])
        return [line for line in found if len(line) > 2 or line[0] != line[1]]

    def _Side(self, place: np.ndarray, corners: list[int]) -> tuple[float, int, int]:
        """The distance of a place from the nearest side (p, q) of a polygon, and the side, p < q."""
        found = []
        for k in range(len(corners)):
            p, q = sorted((corners[k - 1], corners[k]))
            a, b = self._places[p], self._places[q]
            part = np.clip((place - a) @ (b - a) / max((b - a) @ (b - a), np.finfo(float).tiny), 0, 1)
            found.append((float(np.linalg.norm(a + part * (b - a) - place)), p, q))
        return min(found)

    def _OnSide(self, p: int, q: int, place: np.ndarray, tolerance: float) -> int:
        """The number of a place on a side: that of an end, or of a point that is there already, where these are as near as a tolerance."""
        for number in (p, q, *self.between[p, q]):
            if np.linalg.norm(self._places[number] - place) <= tolerance:
                return number
        self.between[p, q].append(self._Add(place))
        return self.between[p, q][-1]

    def _Divided(self, corners: list[int], lines: list[list[int]]) -> list[list[int]]:
        """The polygon with the points on its sides, divided by lines."""
        loop = []
        for k in range(len(corners)):
            p, q = corners[k], corners[(k + 1) % len(corners)]
            loop += [p, *(self.between[p, q] if p < q else self.between[q, p][::-1])]
        loops = [loop]
        for line in lines:
            middle = self._points[line[len(line) // 2]] if len(line) > 2 else self._points[line].mean(axis=0)
            here = [part for part in loops if line[0] in part and line[-1] in part and line[0] != line[-1]]
            if here:
                part = here[0] if len(here) == 1 else next((part for part in here if holds(self._points, part, middle)), here[0])
                loops.remove(part)
                loops += divided(part, line)
        return loops

    def _IsInside(self, loop: list[int]) -> bool:
        return self.sheet.Contains(self.sheet.PointAt(*inner_point(self._points, loop)))


def middle_normal(sheet: Sheet) -> np.ndarray:
    """The unit normal, of a curved sheet that at the middle of its outer curve."""
    outline = sheet.loops[0].Outline()
    return np.array(sheet.FrameAt(*0.5 * (np.min(outline, axis=0) + np.max(outline, axis=0)))[0])


def in_order(cell: SheetCell, loops: Any) -> list[tuple[int, float, float]]:
    """The chords of a polygon along each curve of the sheet; what goes on over the start of a closed curve comes first."""
    chords = sorted((int(loop), s0, s1) for loop, s0, s1 in cell.chords)
    found = []
    for number, curve in enumerate(loops):
        own = [chord for chord in chords if chord[0] == number]
        if len(own) > 1 and own[0][1] <= SAME * cell.h and own[-1][2] >= curve.length - SAME * cell.h:
            gap = next((k for k in range(1, len(own)) if own[k][1] - own[k - 1][2] > SAME * cell.h), 0)
            own = own[gap:] + own[:gap]
        found += own
    return found


def polyline(curve: Any, s0: float, s1: float) -> list[np.ndarray]:
    """Points of a curve from one arc length to another, as many as its bend asks for."""
    start, middle, end = (np.array(curve.PointAt(s)) for s in (s0, 0.5 * (s0 + s1), s1))
    sag = np.linalg.norm(middle - 0.5 * (start + end)) / (s1 - s0)
    number = max(1, int(np.ceil(np.sqrt(sag / SAG) - 1e-6)))
    return [np.array(curve.PointAt(min(s, curve.length))) for s in np.linspace(s0, s1, number + 1)]
