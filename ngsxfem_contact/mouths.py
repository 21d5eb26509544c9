"""The weight of the L² projection of given displacements where a crack cuts a boundary edge."""

import numpy as np
from ngsolve import BND, CoefficientFunction, GridFunction, IfPos, SurfaceL2, x, y


def mouth_weight(body):
    """(ℓ/ℓ_s)³ on the shorter part, of length ℓ_s, of an edge of length 2ℓ that a crack cuts, 1 elsewhere.

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
                extra.vec[int(number)] = (0.5 * length / short) ** 3 - 1
                weight = weight * (1 + IfPos(short**2 - (x - a[0]) ** 2 - (y - a[1]) ** 2, extra, 0))
    return weight


def cut_edges(edges, point, tolerance=1e-9):
    """The numbers of the edges (n, 2, 2) that have a point inside."""
    a, d = edges[:, 0], edges[:, 1] - edges[:, 0]
    length = np.hypot(*d.T)
    t = ((point - a) * d).sum(axis=1) / length**2
    away = np.hypot(*(point - a - t[:, None] * d).T)
    return np.flatnonzero((away < tolerance * length) & (t > tolerance) & (t < 1 - tolerance))
