"""The mesh of the pictures of a body in space: tetrahedra that no sheet crosses, with the points on sheets doubled."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, H1, VOL, Discontinuous, ElementId, GridFunction, Mesh

from ..points import element_regions, element_vertices, mesh_points, reference_coordinates
from .solid_division import EDGES, FACES, SolidDivision
from .split_mesh import PULL, components

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackedSolid, SheetCell


class SplitSolid:
    """The mesh of a body's pictures: conforming tetrahedra, none of them crossed by a sheet.

    Parameters
    ----------
    body : CrackedSolid

    Attributes
    ----------
    points (N, 3)
        Those on a sheet twice, once for each lip, but those on fronts once.
    tets (M, 4)
        Of positive volume.
    element (M,)
        The element of body.mesh that holds the tetrahedron.
    point_side (N,)
        The lip of a doubled point, 0 for other points.
    side (M,)
        1 plus, -1 minus, of tetrahedra that touch a lip; 0 for others.
    lips (L, 3), lip_side (L,), lip_crack (L,)
        The triangles on the sheets, each once for each lip, and where they lie.

    Raises
    ------
    ValueError
        Where two sheets divide the same edge of the mesh.
    """

    def __init__(self, body: CrackedSolid) -> None:
        self.body = body
        division = SolidDivision(body, element_vertices(body.mesh), np.array(body.mesh.ngmesh.Coordinates()))
        points, tets = np.array(division.points), division.tets
        crossed = np.einsum("ij,ij->i", np.cross(*(points[tets[:, k]] - points[tets[:, 0]] for k in (1, 2))), points[tets[:, 3]] - points[tets[:, 0]])
        tets = np.where((crossed < 0)[:, None], tets[:, [1, 0, 2, 3]], tets)
        self.element = division.element
        self._Double(points, tets, division)

    def _Double(self, points: np.ndarray, tets: np.ndarray, division: SolidDivision) -> None:
        """One point for each fan of tetrahedra that hang together around it without crossing a sheet."""
        on_sheet = division.sheet_faces
        faces = tets[:, FACES].reshape(-1, 3)  # face 4t + a of tetrahedron t
        corner = (4 * np.arange(len(tets))[:, None, None] + FACES).reshape(-1, 3)
        order = np.argsort(faces, axis=1)
        faces, corner = np.take_along_axis(faces, order, axis=1), np.take_along_axis(corner, order, axis=1)
        key = (faces[:, 0] * len(points) + faces[:, 1]) * len(points) + faces[:, 2]
        by_key = np.argsort(key, kind="stable")
        same = np.flatnonzero(np.diff(key[by_key]) == 0)
        first, second = by_key[same], by_key[same + 1]
        is_lip = np.isin(key[first], [(a * len(points) + b) * len(points) + c for a, b, c in on_sheet])
        a, b = corner[first[~is_lip]].ravel(), corner[second[~is_lip]].ravel()
        fan = components(tets.size, a, b)
        place = np.empty(fan.max() + 1, dtype=int)
        place[fan] = tets.ravel()
        self.points, self.tets = points[place], fan.reshape(-1, 4)
        self.outside = np.setdiff1d(np.arange(len(faces)), np.concatenate([first, second]))  # faces on ∂Ω
        lips = np.concatenate([first[is_lip], second[is_lip]])
        self.lip_faces, self.lips = lips, fan[corner[lips]]
        found = [on_sheet[tuple(face)] for face in faces[lips].tolist()]
        self.lip_crack, self.lip_element = (np.array([row[k] for row in found], dtype=int) for k in (0, 1))
        self.lip_side = self._SidesOf(lips // 4)
        self.face_corners = fan[corner]
        doubled = np.bincount(place)[place] > 1
        self.point_side = np.zeros(len(place), dtype=int)
        self.point_side[self.lips.ravel()] = np.repeat(self.lip_side, 3)
        self.point_side[~doubled] = 0
        self.point_element = np.empty(len(place), dtype=int)
        self.point_element[self.tets.ravel()] = np.repeat(self.element, 4)
        self.on_sheet = np.zeros(len(place), dtype=bool)
        self.on_sheet[self.lips], self.point_element[self.lips.ravel()] = True, np.repeat(self.lip_element, 3)
        self.side = np.sign(self.point_side[self.tets].sum(axis=1))

    def _SidesOf(self, tets: np.ndarray) -> np.ndarray:
        """On which side of the sheet tetrahedra lie, one at each lip: by the plane of its triangle."""
        lips, normals = self.points[self.lips], np.empty((len(tets), 3))
        for crack, sheet in enumerate(self.body.cracks):
            own = self.lip_crack == crack
            if sheet.planar:
                normals[own] = sheet.normal
            elif own.any():
                upwards = {cell.element: self._Upwards(cell) for cell in self.body.Elements(crack)}
                plane = np.cross(lips[own, 1] - lips[own, 0], lips[own, 2] - lips[own, 0])
                normals[own] = plane * np.sign(np.einsum("ij,ij->i", plane, [upwards[element] for element in self.lip_element[own].tolist()]))[:, None]
        return np.where(np.einsum("ij,ij->i", self.points[self.tets[tets]].mean(axis=1) - lips[:, 0], normals) > 0, 1, -1)

    def _Upwards(self, cell: SheetCell) -> np.ndarray:
        """The direction in which heights over the sheet grow in an element."""
        corners = np.array([self.body.mesh[v].point for v in sorted(self.body.mesh[ElementId(VOL, cell.element)].vertices, key=lambda v: v.nr)])
        return np.linalg.solve(corners[1:] - corners[0], np.subtract(cell.heights[1:], cell.heights[0]))

    def _At(self, cf: CoefficientFunction, elements: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Values (n, dim) at places (n, 3) in elements (n,)."""
        if not len(elements):
            return np.zeros((0, cf.dim))
        mesh = self.body.mesh
        return np.reshape(cf(mesh_points(mesh, elements, *reference_coordinates(mesh, elements, places).T)), (len(elements), cf.dim))

    def _Limits(self, plus: Any, minus: Any, middle: Any, places: np.ndarray, elements: np.ndarray, side: np.ndarray, on_sheet: np.ndarray) -> np.ndarray:
        """Values (n, dim): plus and minus on the lips, on fronts their mean, middle elsewhere."""
        values = np.empty((len(places), middle.dim))
        for chosen, cf in ((on_sheet & (side > 0), plus), (on_sheet & (side < 0), minus), (on_sheet & (side == 0), 0.5 * (plus + minus)), (~on_sheet, middle)):
            values[chosen] = self._At(cf, elements[chosen], places[chosen])
        return values

    def Evaluate(self, plus: CoefficientFunction, minus: CoefficientFunction, middle: CoefficientFunction) -> np.ndarray:
        """Values (N, dim) of CoefficientFunctions at the points: plus and minus on the two lips, middle elsewhere."""
        return self._Limits(plus, minus, middle, self.points, self.point_element, self.point_side, self.on_sheet)

    @cached_property
    def edges(self) -> tuple[np.ndarray, np.ndarray]:
        """(E, 2), the edges, each with the point of the lower number first, in the order of these; and (M, 6), the numbers of those of each tetrahedron."""
        ends = np.sort(self.tets[:, EDGES], axis=2).reshape(-1, 2)
        keys, number = np.unique(self._Keys(ends), return_inverse=True)
        return np.stack(np.divmod(keys, len(self.points)), axis=1), number.reshape(-1, 6)

    def _Keys(self, ends: np.ndarray) -> np.ndarray:
        """A number for each edge (..., 2)."""
        low, high = np.moveaxis(np.sort(ends, axis=-1), -1, 0)
        return np.asarray(low * len(self.points) + high)

    def _EdgeNumbers(self, ends: np.ndarray) -> np.ndarray:
        return np.asarray(np.searchsorted(self._Keys(self.edges[0]), self._Keys(ends)))

    def EvaluateEdges(self, plus: CoefficientFunction, minus: CoefficientFunction, middle: CoefficientFunction) -> np.ndarray:
        """The same at the middles of `edges`; on those between two points of a front, which both lips share, the mean of plus and minus."""
        edges, of_tets = self.edges
        elements, side, on_sheet = np.empty(len(edges), dtype=int), np.zeros(len(edges), dtype=int), np.zeros(len(edges), dtype=bool)
        elements[of_tets] = self.element[:, None]
        of_lips = self._EdgeNumbers(self.lips[:, [(0, 1), (1, 2), (2, 0)]])
        elements[of_lips], side[of_lips], on_sheet[of_lips] = self.lip_element[:, None], self.lip_side[:, None], True
        side[(self.point_side[edges] == 0).all(axis=1)] = 0
        return self._Limits(plus, minus, middle, self.points[edges].mean(axis=1), elements, side, on_sheet)

    def EvaluateInside(self, cf: CoefficientFunction) -> np.ndarray:
        """Values (M, 4, dim) a little inside the corners of each tetrahedron: for stresses, which jump."""
        corners = self.points[self.tets]
        near = (1 - PULL) * corners + PULL * corners.mean(axis=1, keepdims=True)
        return self._At(cf, np.repeat(self.element, 4), near.reshape(-1, 3)).reshape(len(self.tets), 4, -1)

    def EvaluateCentres(self, cf: CoefficientFunction) -> np.ndarray:
        """Values (M, dim) at the centres of the tetrahedra."""
        return self._At(cf, self.element, self.points[self.tets].mean(axis=1))

    @cached_property
    def boundary(self) -> tuple[np.ndarray, np.ndarray]:
        """Triangles (n, 3) that only one tetrahedron has, and the names (n,) of their boundaries: those of the body, and "crack" for the lips."""
        names = {tuple(sorted(v.nr for v in el.vertices)): el.mat for el in self.body.mesh.Elements(BND)}
        corners, parent = self.face_corners[self.outside], self.element[self.outside // 4]
        elements = element_vertices(self.body.mesh)[parent]
        reference = reference_coordinates(self.body.mesh, np.repeat(parent, 3), self.points[corners].reshape(-1, 3)).reshape(-1, 3, 3)
        hats = np.concatenate([reference, 1 - reference.sum(axis=2, keepdims=True)], axis=2)
        opposite = np.abs(hats).max(axis=1).argmin(axis=1)  # the vertex whose hat function is 0 on the triangle
        others = FACES[opposite]
        found = [names.get(tuple(face), "") for face in np.sort(np.take_along_axis(elements, others, axis=1), axis=1).tolist()]
        return self.Outward(np.concatenate([self.outside, self.lip_faces])), np.array(found + ["crack"] * len(self.lips), dtype=str)

    def Outward(self, faces: np.ndarray) -> np.ndarray:
        """The corners (n, 3) of faces, numbered 4t + a of tetrahedron t opposite to its corner a, counter-clockwise seen from outside of it."""
        corners, opposite = self.face_corners[faces], self.tets[faces // 4, faces % 4]
        a, b, c = np.moveaxis(self.points[corners] - self.points[opposite][:, None], 1, 0)
        inward = np.einsum("ij,ij->i", np.cross(a, b), c) < 0
        corners[inward] = corners[inward][:, [0, 2, 1]]
        return corners

    @cached_property
    def mesh(self) -> Mesh:
        """An ngsolve.Mesh: vertex i is points[i], element i tets[i]; materials and boundaries as the body's, and "crack" for the lips."""
        triangles, names = self.boundary
        return tetrahedra_mesh(self.points, self.tets, triangles, names, element_regions(self.body.mesh)[self.element], self.body.mesh.GetMaterials())

    def GridFunction(self, values: np.ndarray, at_edges: np.ndarray | None = None) -> GridFunction:
        """On `mesh`: continuous from values (N, dim) at the points, of order 2 with those at the middles of edges, discontinuous from values (M, 4, dim)."""
        space = H1(self.mesh, order=1 if at_edges is None else 2, dim=values.shape[-1])
        function = GridFunction(space if values.ndim == 2 else Discontinuous(space, dim=space.dim))
        coefficients = values.reshape(-1, space.dim)
        if at_edges is not None:
            edges = np.array([[v.nr for v in edge.vertices] for edge in self.mesh.edges])
            bent = at_edges[self._EdgeNumbers(edges)] - values[edges].mean(axis=1)
            coefficients = np.concatenate([coefficients, -8 * bent])  # H1's function of an edge is -1/8 at its middle
        function.vec.FV().NumPy()[:] = coefficients.ravel()
        return function


def tetrahedra_mesh(points: np.ndarray, tets: np.ndarray, triangles: np.ndarray, names: np.ndarray, regions: np.ndarray, materials: Sequence[str]) -> Mesh:
    """The mesh of NGSolve with points (N, 3), tetrahedra (M, 4) in regions (M,), and triangles (n, 3) on boundaries with names (n,)."""
    import netgen.meshing as netgen

    mesh = netgen.Mesh(dim=3)
    mesh.AddPoints(points)
    for region, material in enumerate(materials):
        if np.any(regions == region):
            mesh.AddElements(dim=3, index=region + 1, data=tets[regions == region].astype(np.int32), base=0)
        mesh.SetMaterial(region + 1, material)
    for number, name in enumerate(np.unique(names), 1):
        mesh.Add(netgen.FaceDescriptor(surfnr=number, domin=1, bc=number))
        mesh.AddElements(dim=2, index=number, data=triangles[names == name].astype(np.int32), base=0)
        mesh.SetBCName(number - 1, str(name))
    return Mesh(mesh)
