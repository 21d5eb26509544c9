"""Tetrahedra of a mesh as tetrahedra that no sheet crosses, with common faces.

An element that a sheet's plane divides falls into two polyhedra; its neighbours keep their shape, and get new points on their edges. Faces of the mesh are divided once,
for both neighbours, and a polyhedron becomes the tetrahedra over its faces, seen from one of its corners or, where that cannot be, from its centre.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from ..points import place
from .polygons import Triangle, divided, ear_triangles
from .sheet_trace import SheetTrace

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from .._ngsxfem_contact import CrackedSolid

Face = tuple[int, int, int]
EDGES = np.array(list(combinations(range(4), 2)))
FACES = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])  # opposite to the corner
FLAT = 1e-9  # of the volume of a polyhedron: so little lies between a corner and a face that the corner is on it


class SolidDivision:
    """The division of the elements of a body.

    Parameters
    ----------
    body : CrackedSolid
    elements (m, 4), vertices (n, 3)
        Of its mesh.

    Attributes
    ----------
    points
        (3,) each, the vertices first.
    tets (M, 4), element (M,)
        Tetrahedra, and the elements that they lie in.
    sheet_faces
        {face: (crack, element)} of faces on sheets, three numbers in their order, and the element that carries this part of the sheet.

    Raises
    ------
    ValueError
        Where two sheets divide the same face of the mesh.
    """

    def __init__(self, body: CrackedSolid, elements: np.ndarray, vertices: np.ndarray) -> None:
        self.points = list(vertices)
        self.sheet_faces: dict[Face, tuple[int, int]] = {}
        self._edge_points: dict[tuple[int, int], list[int]] = {}
        self._across: dict[Face, list[int]] = {}  # faces that a plane divides: the line from edge to edge
        self._faces: dict[Face, list[list[Triangle]]] = {}
        self._cut: dict[int, tuple[dict[int, float], list[Triangle]]] = {}  # heights of the vertices, the polygon
        for crack in range(len(body.cracks)):
            self._Read(SheetTrace(body, crack), crack)
        touched = self._Touched(elements)
        tets, parents = [elements[~touched]], [np.flatnonzero(~touched)]
        for number in np.flatnonzero(touched):
            parts = np.concatenate([self._Cone(part) for part in self._Polyhedra(int(number), elements[number])])
            tets.append(parts)
            parents.append(np.full(len(parts), number))
        self.tets, self.element = np.concatenate(tets), np.concatenate(parents)

    def _Read(self, trace: SheetTrace, crack: int) -> None:
        """The points, lines and polygons of a sheet."""
        numbers = np.full(len(trace.points), -1)
        for (i, j), point in trace.nodes.items():
            if i == j:
                numbers[point] = i
        places, new = trace.places, np.flatnonzero(numbers < 0)
        numbers[new] = len(self.points) + np.arange(len(new))
        self.points += list(places[new])
        for edge, point in trace.nodes.items():
            if edge[0] != edge[1]:
                self._Note(self._edge_points, edge, [int(numbers[point])], places[point])
        for (p, q), ends in trace.sides.items():
            corners, line = sorted({*ends[0], *ends[1]}), [int(numbers[point]) for point in (p, *trace.between[p, q], q)]
            if len(corners) == 3:
                self._Note(self._across, tuple(corners), line, places[p])
            elif len(line) > 2:
                self._Note(self._edge_points, tuple(corners), line[1:-1] if line[0] < line[-1] else line[-2:0:-1], places[p])
        for found, number, inside in zip(trace.triangles, trace.loop_cell, trace.inside):
            cell, triangles = trace.cells[number], [(int(numbers[a]), int(numbers[b]), int(numbers[c])) for a, b, c in found]
            if all(i == j for i, j in cell.nodes):
                self._faces.setdefault(face_of(int(i) for i, _ in cell.nodes), []).append(triangles)
            else:
                vertices = sorted({int(i) for node in cell.nodes for i in node})
                self._cut.setdefault(cell.element, (dict(zip(vertices, cell.heights)), []))[1].extend(triangles)
            if inside:
                self.sheet_faces |= {face_of(triangle): (crack, cell.element) for triangle in triangles}

    @staticmethod
    def _Note(of: dict[Any, list[int]], key: tuple[int, ...], points: list[int], where: np.ndarray) -> None:
        if key in of:
            raise ValueError(
                f"the pictures of this body cannot be drawn: two sheets divide neighbouring elements near {place(tuple(where))}; refine the mesh between them"
            )
        of[key] = points

    def _Touched(self, elements: np.ndarray) -> np.ndarray:
        """(m,): elements that are divided, or have a divided edge or face."""
        size = int(elements.max()) + 1
        key = lambda ends: np.min(ends, axis=-1) * size + np.max(ends, axis=-1)
        edges = np.array([i * size + j for i, j in self._edge_points], dtype=int)
        touched = np.isin(key(elements[:, EDGES]), edges).any(axis=1)
        touched[list(self._cut)] = True
        faces = np.array(list(self._faces), dtype=int).reshape(-1, 3)
        on = np.isin(elements, faces).sum(axis=1) > 2
        touched[on] = True
        return touched

    def _Polyhedra(self, number: int, corners: np.ndarray) -> list[list[Triangle]]:
        """What an element falls into, as triangles around it."""
        faces = [triangles for face in np.sort(corners)[FACES].tolist() for triangles in self._Loops(face_of(face))]
        if number not in self._cut:
            return [[triangle for triangles in faces for triangle in triangles]]
        heights, polygon = self._cut[number]
        above = [max((heights.get(i, 0) for triangle in triangles for i in triangle), default=0) > 0 for triangles in faces]
        return [[*polygon, *(triangle for triangles, up in zip(faces, above) if up == side for triangle in triangles)] for side in (True, False)]

    def _Loops(self, face: Face) -> list[list[Triangle]]:
        """The triangles of the parts of a face of the mesh."""
        if face not in self._faces:
            around = []
            for a, b in zip(face, (*face[1:], face[0])):
                between = self._edge_points.get((min(a, b), max(a, b)), [])
                around += [a, *(between if a < b else between[::-1])]
            loops = divided(around, self._across[face]) if face in self._across else [around]
            self._faces[face] = [self._Triangles(loop, face) for loop in loops]
        return self._faces[face]

    def _Triangles(self, loop: list[int], face: Face) -> list[Triangle]:
        """Those of a part of a face, whose plane is that of three points."""
        if len(loop) == 3:
            return [(loop[0], loop[1], loop[2])]
        a, b, c = (self.points[i] for i in face)
        first = (b - a) / np.linalg.norm(b - a)
        second = (c - a) - ((c - a) @ first) * first
        plane = np.array([self.points[i] - a for i in loop]) @ np.column_stack([first, second / np.linalg.norm(second)])
        return [(loop[i], loop[j], loop[k]) for i, j, k in ear_triangles(plane, range(len(loop)))]

    def _Cone(self, triangles: Sequence[Triangle]) -> np.ndarray:
        """The tetrahedra over the triangles around a convex polyhedron, from the corner for which the least of them is largest, or from its centre."""
        around = np.array(triangles)
        corners, number = np.unique(around, return_inverse=True)
        places = np.array([self.points[corner] for corner in corners])
        shape = places[number.reshape(-1, 3)]
        best, apex = 0.0, -1
        for corner, at in zip(corners, places):
            volumes = volumes_from(shape[(around != corner).all(axis=1)], at)
            if volumes.min() > max(best, FLAT * volumes.sum()):
                best, apex = volumes.min(), int(corner)
        if apex < 0:
            apex = len(self.points)
            self.points.append(places.mean(axis=0))
        seen = around[(around != apex).all(axis=1)]
        return np.column_stack([np.full(len(seen), apex), seen])


def face_of(corners: Iterable[int]) -> Face:
    """Three numbers in their order."""
    a, b, c = sorted(corners)
    return a, b, c


def volumes_from(triangles: np.ndarray, apex: np.ndarray) -> np.ndarray:
    """(n,): six times those of tetrahedra over triangles (n, 3, 3)."""
    a, b, c = np.moveaxis(triangles - apex, 1, 0)
    return np.abs(np.einsum("ij,ij->i", np.cross(a, b), c))
