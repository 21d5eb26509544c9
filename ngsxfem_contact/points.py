"""Points of cracks, and distances in the plane."""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, VOL, ElementId, x, y, z

from ._ngsxfem_contact import CrackedSolid

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction, Mesh

    from ._ngsxfem_contact import CrackedMesh


ROUND_OFF = 1e-12  # of barycentric coordinates


def distance_to_segments(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> float:
    """Of a point from the nearest of the segments from a to b, (n, 2) each; inf if there are none."""
    if len(a) == 0:
        return np.inf
    t = np.clip(np.einsum("ij,ij->i", point - a, b - a) / np.einsum("ij,ij->i", b - a, b - a), 0, 1)
    return float(np.hypot(*(a + t[:, None] * (b - a) - point).T).min())


def place(point: tuple[float, ...]) -> str:
    """A point in a message."""
    return f"({', '.join(f'{coordinate:.4g}' for coordinate in point)})"


def crack_points(body: CrackedMesh, crack: int, arclengths: list[float] | np.ndarray) -> np.ndarray:
    """NGSolve's mesh points at arc lengths of a crack, each in an element that carries that part of it."""
    return mesh_points(body.mesh, *body.OnCrack(crack, list(arclengths)))


def mesh_points(mesh: Mesh, elements: np.ndarray, *reference: np.ndarray) -> np.ndarray:
    """NGSolve's mesh points at reference coordinates xi, eta (in space also zeta) in elements, (n,) each."""
    inside = np.mean([mesh[v].point for v in mesh[ElementId(VOL, 0)].vertices], axis=0)
    points = np.repeat(mesh(*inside[:, None]), len(elements))
    points["nr"] = elements
    for name, values in zip("xyz", reference):
        points[name] = values
    return points


def reference_coordinates(mesh: Mesh, elements: np.ndarray, places: np.ndarray) -> np.ndarray:
    """xi, eta, zeta, (n, 3), of places (n, 3) in straight tetrahedra (n,)."""
    corners = np.array(mesh.ngmesh.Coordinates())[element_vertices(mesh)[elements]]
    return np.linalg.solve(np.swapaxes(corners[:, :3] - corners[:, 3:], 1, 2), (places - corners[:, 3])[..., None])[..., 0]


def points_inside(mesh: Mesh, places: np.ndarray) -> np.ndarray:
    """NGSolve's mesh points at places (n, 3), nr < 0 outside of the mesh, each in the tetrahedron that holds it but for round-off.

    NGSolve takes the first one that it finds of those that hold it but for 1e-4 of their size, so that others would be taken if the mesh were numbered otherwise.
    """
    points, corners, at = mesh(*places.T), element_vertices(mesh), np.array(mesh.ngmesh.Coordinates())

    def hats(element: int, place: np.ndarray) -> np.ndarray:
        edges = at[corners[element]]
        reference = np.linalg.solve((edges[:3] - edges[3]).T, place - edges[3])
        return np.append(reference, 1 - reference.sum())

    found = np.array([points["x"], points["y"], points["z"]])
    for i in np.flatnonzero((points["nr"] >= 0) & (np.minimum(found.min(axis=0), 1 - found.sum(axis=0)) < -ROUND_OFF)):
        element, here = int(points["nr"][i]), hats(int(points["nr"][i]), places[i])
        while here.min() < -ROUND_OFF:
            opposite = corners[element][here.argmin()]
            faces = [face for face in mesh[ElementId(VOL, element)].faces if opposite not in [vertex.nr for vertex in mesh[face].vertices]]
            behind = [other.nr for face in faces for other in mesh[face].elements if other.nr != element]
            if not behind or (there := hats(behind[0], places[i])).min() <= here.min():
                break
            element, here = behind[0], there
        points["nr"][i], points["x"][i], points["y"][i], points["z"][i] = element, *here[:3]
    return points


def boundary_points(mesh: Mesh, elements: np.ndarray, *reference: np.ndarray) -> np.ndarray:
    """NGSolve's mesh points at reference coordinates in elements of the boundary, (n,) each; what is left out is 0."""
    points = mesh_points(mesh, elements, *reference, *[np.zeros(len(elements))] * (3 - len(reference)))
    points["VorB"] = int(BND)
    return points


def points_into(mesh: Mesh, normal: CoefficientFunction) -> np.ndarray:
    """On which elements of the boundary of the body (boolean) a normal vector points into it; False on those between two elements."""
    boundary = list(mesh.Elements(BND))
    beside = [mesh[(element.edges if mesh.dim == 2 else element.faces)[0]].elements for element in boundary]
    outer = np.flatnonzero([len(elements) == 1 for elements in beside])
    points = boundary_points(mesh, outer, *(np.full(len(outer), at) for at in (0.3, 0.4)[: mesh.dim - 1]))
    vertices = element_vertices(mesh)[[beside[number][0].nr for number in outer]].reshape(len(outer), mesh.dim + 1)
    centres = mesh.ngmesh.Coordinates()[:, : mesh.dim][vertices].mean(axis=1)
    places = np.column_stack([np.ravel(coordinate(points)) for coordinate in (x, y, z)[: mesh.dim]])
    into = np.zeros(len(boundary), dtype=bool)
    into[outer] = np.sum(normal(points).reshape(places.shape) * (places - centres), axis=1) < 0
    return into


@singledispatch
def points_of_crack(body: Any, crack: int, number: int) -> np.ndarray:
    """NGSolve's mesh points at some points of a crack."""
    return crack_points(body, crack, (np.arange(number) + 0.37) / number * body.cracks[crack].length)


@points_of_crack.register(CrackedSolid)
def points_of_sheet(body: CrackedSolid, crack: int, number: int) -> np.ndarray:
    """The same of a sheet: of the rule of order 1."""
    element, xi, eta, zeta, *_ = body.dcrack(crack=crack).Points(1)
    chosen = np.unique(np.linspace(0, len(element) - 1, number).astype(int))
    return mesh_points(body.mesh, element[chosen], xi[chosen], eta[chosen], zeta[chosen])


def netgen_elements(mesh: Mesh) -> np.ndarray:
    """Netgen's records of the triangles, or tetrahedra, of a mesh, in its numbering."""
    return (mesh.ngmesh.Elements2D() if mesh.dim == 2 else mesh.ngmesh.Elements3D()).NumPy()


def element_vertices(mesh: Mesh) -> np.ndarray:
    """(n, dimension + 1): numbers of the corners of the elements."""
    return netgen_elements(mesh)["nodes"][:, : mesh.dim + 1].astype(int) - 1


def element_regions(mesh: Mesh) -> np.ndarray:
    """(n,): numbers of the regions of the elements, counted from 0."""
    return netgen_elements(mesh)["index"].astype(int) - 1


def mesh_arrays(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n,2) and triangles (m,3) of an NGSolve mesh, in its numbering."""
    return mesh.ngmesh.Coordinates()[:, :2].copy(), mesh.ngmesh.Elements2D().NumPy()["nodes"][:, :3].astype(int) - 1
