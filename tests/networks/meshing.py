"""Meshes along straight arms of cracks, small at their ends, with doubled vertices: one copy for each fan of triangles that no arm divides."""

from __future__ import annotations

import numpy as np
from netgen.geom2d import SplineGeometry
from netgen.meshing import FaceDescriptor, NgException
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

SIDES = {"bottom": (0, -1), "right": (1, 0), "top": (0, 1), "left": (-1, 0)}


class Arm:
    """A straight arm from a to b, points of the plane; n is its normal to the left, on the plus side."""

    def __init__(self, a, b):
        self.a, self.b = np.array(a, float), np.array(b, float)
        self.length = np.linalg.norm(self.b - self.a)
        self.t = (self.b - self.a) / self.length
        self.n = np.array([-self.t[1], self.t[0]])


class SplitMesh:
    """The square [-half_width, half_width]² divided along arms; arguments as those of FittedBody.

    Attributes
    ----------
    points (N,2), triangles (M,3)
    old (N,)
        The vertex before doubling.
    lips
        (arm, edge on the plus side, edge on the minus side), both directed along the arm.
    mesh
        An ngsolve.Mesh with the same vertices.
    """

    def __init__(self, arms, half_width, maxh, tip_h, far):
        self.arms = arms
        coarse = coarse_mesh(self._Geometry(half_width, maxh, tip_h), far, [p for arm in arms for p in (arm.a, arm.b)], tip_h)
        points = np.array([p.p[:2] for p in coarse.Points()])
        triangles = np.array([[v.nr - 1 for v in e.vertices] for e in coarse.Elements2D()])
        segments = [(s.index - 1, *(v.nr - 1 for v in s.vertices)) for s in coarse.Elements1D()]
        corner = {(t[k], t[(k + 1) % 3]): 3 * i + k for i, t in enumerate(triangles) for k in range(3)}  # of directed edges, counterclockwise
        on_arms = {frozenset(s[1:]): s[0] - len(SIDES) for s in segments if s[0] >= len(SIDES)}
        self.triangles, self.old = doubled(triangles, corner, on_arms)
        self.points, ends = points[self.old], lambda c: self.triangles.ravel()[[c, following(c)]]
        self.lips = []
        for edge, arm in on_arms.items():
            a, b = sorted(edge, key=lambda i: points[i] @ arms[arm].t)
            self.lips.append((arm, tuple(ends(corner[a, b])), tuple(ends(corner[b, a])[::-1])))  # a triangle is to the left of its edges
        outer = [(side, *ends(corner[a, b])) for side, a, b in segments if side < len(SIDES)]
        self.mesh = ngsolve_mesh(self.points, self.triangles, outer, self.lips)

    def _Geometry(self, half_width, maxh, tip_h):
        geometry, w = SplineGeometry(), half_width
        corners = [geometry.AppendPoint(*p) for p in ((-w, -w), (w, -w), (w, w), (-w, w))]
        for k, side in enumerate(SIDES):
            geometry.Append(["line", corners[k], corners[(k + 1) % 4]], bc=side, leftdomain=1, rightdomain=0)
        ends = {tuple(p): None for arm in self.arms for p in (arm.a, arm.b)}
        number = {p: geometry.AppendPoint(*p, maxh=tip_h) for p in ends}
        for arm in self.arms:
            geometry.Append(["line", number[tuple(arm.a)], number[tuple(arm.b)]], leftdomain=1, rightdomain=1, maxh=maxh)
        return geometry


def following(corner):
    """Of the corners 3i, 3i+1, 3i+2 of triangle i."""
    return corner - corner % 3 + (corner + 1) % 3


def doubled(triangles, corner, cut):
    """Triangles with a vertex for each fan that no cut edge divides, and the old vertex of each; copies keep the order, by which NGSolve orients edges."""
    inner = [(c, corner[b, a]) for (a, b), c in corner.items() if a < b and (b, a) in corner and frozenset((a, b)) not in cut]
    links = np.array([pair for c, d in inner for pair in ((c, following(d)), (following(c), d))])
    fan = connected_components(coo_matrix((np.ones(len(links)), links.T), shape=(triangles.size,) * 2))[1]
    old = triangles.ravel()[np.unique(fan, return_index=True)[1]]
    rank = np.argsort(np.argsort(old, kind="stable"))
    return rank[fan].reshape(-1, 3), np.sort(old)


def coarse_mesh(geometry, far, ends, tip_h):
    """Netgen's; steep grading sometimes defeats it, or it forgets the size at an end: then another grading is tried."""
    for grading in (0.3, 0.35, 0.4, 0.25, 0.2):
        try:
            mesh = geometry.GenerateMesh(maxh=far, grading=grading)
        except NgException:
            continue
        points = np.array([p.p[:2] for p in mesh.Points()])
        nearest = [np.sort(np.linalg.norm(points - end, axis=1))[1] for end in ends]
        if max(nearest) < 3 * tip_h:
            return mesh
    raise RuntimeError("Netgen cannot mesh these arms: take another maxh or tip_h")


def ngsolve_mesh(points, triangles, outer, lips):
    """With boundaries bottom, right, top, left, and plus0, minus0, ... for the lips of the arms."""
    mesh = NetgenMesh(dim=2)
    mesh.Add(FaceDescriptor(surfnr=1, domin=1, bc=1))
    mesh.AddPoints(np.column_stack([points, np.zeros(len(points))]))
    mesh.AddElements(dim=2, index=1, data=triangles.astype(np.int32), base=0)
    named = [(list(SIDES)[side], edge) for side, *edge in outer]
    named += [(f"{lip}{arm}", edge) for arm, *pair in lips for lip, edge in zip(("plus", "minus"), pair)]
    for i, name in enumerate(dict.fromkeys(name for name, _ in named)):
        mesh.AddElements(dim=1, index=i + 1, data=np.array([edge for other, edge in named if other == name], dtype=np.int32), base=0)
        mesh.SetBCName(i, name)
    return Mesh(mesh)
