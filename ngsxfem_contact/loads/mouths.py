"""The weight of the L² projection of given displacements where a crack cuts a boundary edge."""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, H1, BilinearForm, CoefficientFunction, GridFunction, IfPos, SurfaceL2, x, y, z

from .._ngsxfem_contact import CrackedSolid
from ..algebra.matrices import to_scipy
from ..sheets import heights_over

if TYPE_CHECKING:
    from collections.abc import Iterator

    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace, Sheet

PROJECTION_BONUS = 4  # of the rules' order, one for both sides of the projection: on curved edges no order is exact
SHORT = 1e-4  # of an edge: on a shorter part only the functions of the vertex in it are given


@singledispatch
def mouth_weight(body: Any, power: int = 3) -> CoefficientFunction:
    """(ℓ/ℓ_s)³ on the shorter part, of length ℓ_s, of an edge of length 2ℓ that a crack cuts, 1 elsewhere; at most (ℓ/SHORT)³.

    On a short part the functions that live there alone would make up for the error that their neighbours have at its end,
    with slopes as large as that error over ℓ_s: the given displacement at the nodes beside the mouth would be wrong.
    """
    mesh = body.mesh
    edges = mesh.ngmesh.Coordinates()[[[vertex.nr for vertex in element.vertices] for element in mesh.Elements(BND)], :2]
    weight = CoefficientFunction(1)
    for number, end in mouths(body, edges):
        a, b = sorted(edges[number], key=lambda corner: np.hypot(*(corner - end)))  # of a curved edge the corners
        short, length = np.hypot(*(a - end)), np.hypot(*(b - a))
        extra = GridFunction(SurfaceL2(mesh, order=0))
        extra.vec[number] = (0.5 / max(short / length, SHORT if power == 3 else 0)) ** power - 1
        weight = weight * (1 + IfPos(short**2 - (x - a[0]) ** 2 - (y - a[1]) ** 2, extra, 0))
    return weight


@mouth_weight.register(CrackedSolid)
def weight_on_surface(body: CrackedSolid, power: int = 3) -> CoefficientFunction:
    """A/(2 A_s) t^{1 - power} on the smaller part, of area A_s, of a boundary triangle that a sheet divides, 1 elsewhere.

    t ≤ 1 is the largest value on that part of the functions that live there alone, those of the corners beyond: their mass is A_s t².
    """
    mesh, weight = body.mesh, CoefficientFunction(1)
    points = mesh.ngmesh.Coordinates()
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(BND)])
    for number, sheet in enumerate(body.cracks):
        divided = np.array(body.CutBoundaryElements(number), dtype=int)
        if not len(divided):
            continue
        of_corners = heights_over(sheet, points[corners[divided].ravel()]).reshape(-1, 3)
        height = height_on(body, sheet, corners[divided], of_corners)
        areas = np.array([body.BoundaryPartSizes(int(element)) for element in divided])
        side = np.where(areas[:, 0] < areas[:, 1], 1.0, -1.0)
        reach = np.array([of_corners.max(axis=1), -of_corners.min(axis=1)])
        t = np.where(side > 0, reach[0], reach[1]) / reach.sum(axis=0)
        extra, sides = GridFunction(SurfaceL2(mesh, order=0)), GridFunction(SurfaceL2(mesh, order=0))
        extra.vec.FV().NumPy()[divided] = 0.5 * areas.sum(axis=1) / areas.min(axis=1) * np.maximum(t, SHORT if power == 3 else 0) ** (1 - power) - 1
        sides.vec.FV().NumPy()[divided] = side
        weight = weight * (1 + IfPos(sides * height, extra, 0))
    return weight


def height_on(body: CrackedSolid, sheet: Sheet, corners: np.ndarray, of_corners: np.ndarray) -> CoefficientFunction:
    """Over the sheet, for points of boundary triangles with these corners (n, 3) and heights there: over a curved sheet linear in each of them, as it is divided."""
    if sheet.planar:
        return sum((coordinate - o) * n for coordinate, o, n in zip((x, y, z), sheet.origin, sheet.normal))
    height = GridFunction(H1(body.mesh, order=1))
    height.vec.FV().NumPy()[corners] = of_corners
    return height


def boundary_mass(V: CrackFESpace, region: str, weight: CoefficientFunction) -> csr_matrix:
    """∫ weight u·v over a boundary region, scipy CSR."""
    u, v = V.TnT()
    return to_scipy(BilinearForm(weight * u * v * V.body.ds(region, bonus_intorder=PROJECTION_BONUS)).Assemble().mat)


def short_traces(V: CrackFESpace, region: str) -> np.ndarray:
    """Unknowns whose function has a trace on the region, but on a short part of an edge and smaller than SHORT there.

    They cannot be read off their traces; left free they change a given displacement by SHORT² of an edge times the jump.
    """
    size = boundary_mass(V, region, mouth_weight(V.body, power=1)).diagonal()
    return np.flatnonzero((size > 0) & (size < SHORT**2 * size.max()))


def mouths(body: CrackedMesh, edges: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """(number, point) of the boundary edges (n, 2, 2) that a crack cuts at one of its ends: those that the space takes for cut."""
    for i, crack in enumerate(body.cracks):
        for number, point in body.CutBoundaryPoints(i):
            a, b = edges[number]
            if min(np.hypot(*np.subtract(point, end)) for end in (crack.points[0], crack.points[-1])) < 1e-9 * np.hypot(*(b - a)):
                yield number, np.asarray(point)
