"""The weight of the L² projection of given displacements where a crack cuts a boundary edge."""

import numpy as np
from ngsolve import BND, BilinearForm, CoefficientFunction, GridFunction, IfPos, SurfaceL2, x, y

from .spaces import to_scipy

SHORT = 1e-4  # of an edge: on a shorter part only the functions of the vertex in it are given


def mouth_weight(body, power=3):
    """(ℓ/ℓ_s)³ on the shorter part, of length ℓ_s, of an edge of length 2ℓ that a crack cuts, 1 elsewhere; at most (ℓ/SHORT)³.

    On a short part the functions that live there alone would make up for the error that their neighbours have at its end,
    with slopes as large as that error over ℓ_s: the given displacement at the nodes beside the mouth would be wrong.
    """
    mesh = body.mesh
    points = np.array([vertex.point for vertex in mesh.vertices])
    edges = points[[[vertex.nr for vertex in element.vertices] for element in mesh.Elements(BND)]]
    weight = CoefficientFunction(1)
    for crack in body.cracks:
        for end in (crack.points[0], crack.points[-1]):
            for number in cut_edges(edges, np.asarray(end)):
                a, b = sorted(edges[number], key=lambda corner: np.hypot(*(corner - end)))
                short, length = np.hypot(*(a - end)), np.hypot(*(b - a))
                extra = GridFunction(SurfaceL2(mesh, order=0))
                extra.vec[int(number)] = (0.5 / max(short / length, SHORT if power == 3 else 0)) ** power - 1
                weight = weight * (1 + IfPos(short**2 - (x - a[0]) ** 2 - (y - a[1]) ** 2, extra, 0))
    return weight


def boundary_mass(V, region, weight):
    """∫ weight u·v over a boundary region, scipy CSR."""
    u, v = V.TnT()
    return to_scipy(BilinearForm(weight * u * v * V.body.ds(region)).Assemble().mat)


def short_traces(V, region):
    """Unknowns whose function has a trace on the region, but on a short part of an edge and smaller than SHORT there.

    They cannot be read off their traces; left free they change a given displacement by SHORT² of an edge times the jump.
    """
    size = boundary_mass(V, region, mouth_weight(V.body, power=1)).diagonal()
    return np.flatnonzero((size > 0) & (size < SHORT**2 * size.max()))


def cut_edges(edges, point, tolerance=1e-9):
    """The numbers of the edges (n, 2, 2) that have a point inside."""
    a, d = edges[:, 0], edges[:, 1] - edges[:, 0]
    length = np.hypot(*d.T)
    t = ((point - a) * d).sum(axis=1) / length**2
    away = np.hypot(*(point - a - t[:, None] * d).T)
    return np.flatnonzero((away < tolerance * length) & (t > tolerance) & (t < 1 - tolerance))
