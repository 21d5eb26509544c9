"""The mesh of the pictures: NGSolve interpolates inside an element and so smears the jump across a crack.

In a SplitMesh the elements that a crack meets are replaced by their parts on either side, and the points on the crack are doubled.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BND, CF, H1, Discontinuous, GridFunction, Mesh, x, y

from ..algebra.matrices import mask
from ..points import mesh_arrays, mesh_points

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import BitArray, CoefficientFunction

    from .._ngsxfem_contact import Crack, CrackedMesh, PartTriangle

LIPS = (1, -1)  # plus and minus
BESIDE = 1e-9  # of the way to a triangle's centre: beside a point at which cracks meet, where no crack has a side of its own
PULL = 0.05  # stresses are taken this part of the way from a corner to the triangle's centre: they jump, and are infinite at tips


class SplitMesh:
    """The mesh of a body's pictures: conforming triangles, none of them crossed by a crack.

    Parameters
    ----------
    body : CrackedMesh
    subdivision
        How often each triangle is divided into four.

    Attributes
    ----------
    points (N,2)
        Those on a crack twice, once for each lip, but tips once.
    triangles (M,3)
        Counterclockwise.
    element (M,)
        The element of body.mesh that holds the triangle.
    side (M,)
        1 plus, -1 minus, 0 away from the cracks.
    point_side (N,)
        The lip of a doubled point, 0 for other points and where cracks meet.
    meeting (N,)
        Whether several cracks meet at a point, which is there once for each of the sectors between them.
    lips (L,2), lip_side (L,), lip_crack (L,)
        The edges on the cracks, each once for each lip.
    """

    def __init__(self, body: CrackedMesh, subdivision: int = 0) -> None:
        self.body, self._mesh = body, None
        tolerance = 1e-9 * min((location.h for c in range(len(body.cracks)) for location in body.Elements(c)), default=0.0)
        points, triangles, parent = conforming_triangles(body, tolerance)
        carried = np.array([mask(body.CrackElements(c)) for c in range(len(body.cracks))], dtype=bool).reshape(-1, body.mesh.ne).T
        for _ in range(subdivision):
            places = self._Places(points, triangles, parent)
            edge, _, crack_of, _ = crack_edges(body.cracks, places, triangles, carried[parent], tolerance)
            ends = triangles.ravel()[[edge, next_corner(edge)]]
            middles = on_curves(body, crack_of, points[ends], places[ends])
            points, triangles = divide_in_four(points, triangles, edge, middles)
            parent = np.tile(parent, 4)
        self.element = parent
        places = self._Places(points, triangles, self.element)
        self._Double(points, triangles, *crack_edges(body.cracks, places, triangles, carried[self.element], tolerance))
        self.reference = reference_coordinates(body.mesh, self.points[self.triangles], self.element)
        if body.mesh.GetCurveOrder() > 1:
            self.points = self.Evaluate(*[CF((x, y))] * 3)

    def _Double(
        self, points: np.ndarray, triangles: np.ndarray, edge: np.ndarray, values_from: np.ndarray, edge_crack: np.ndarray, edge_side: np.ndarray
    ) -> None:
        """One point for each fan of triangles that are connected around it without crossing a crack."""
        first, second = twin_edges(triangles)
        a, b = np.stack([first, second])[:, ~np.isin(first, edge)]
        fan = components(triangles.size, np.concatenate([a, next_corner(a)]), np.concatenate([next_corner(b), b]))
        lip_corners = np.stack([edge, next_corner(edge)], axis=1)
        self.corner = np.empty(fan.max() + 1, dtype=int)
        self.corner[fan] = np.arange(triangles.size)
        several = on_several_cracks(triangles.ravel()[lip_corners], edge_crack)
        self.meeting = np.isin(triangles.ravel()[self.corner], several)
        of_one = ~np.isin(triangles.ravel()[lip_corners], several)
        self.corner[fan[lip_corners][of_one]] = values_from[of_one]
        self.points, self.triangles = points[triangles.ravel()[self.corner]], fan.reshape(-1, 3)
        self.lips, self.lip_edges, self.lip_side, self.lip_crack = fan[lip_corners], edge, edge_side, edge_crack
        self.point_side = np.zeros(len(self.points), dtype=int)
        for side in LIPS:  # a tip is on both lips: 0
            self.point_side[np.unique(self.lips[edge_side == side])] += side
        self.point_side[self.meeting] = 0
        self.side = self._Sides()

    def _Sides(self) -> np.ndarray:
        """(M,) the side of the nearest crack of its element on which a triangle lies, or of a lip that it touches; 0 for others."""
        sides, centres = np.sign(self.point_side[self.triangles].sum(axis=1)), self.points[self.triangles].mean(axis=1)
        for t in np.flatnonzero(mask(self.body.CrackElements(None))[self.element]):
            here, centre = [self.body.cracks[c] for c in self.body.CracksOf(int(self.element[t]))], tuple(centres[t])
            nearest = here[0] if len(here) == 1 else min(here, key=lambda crack: crack.Distance(centre))
            sides[t] = int(nearest.SideOf(centre))
        return sides

    def _Places(self, points: np.ndarray, triangles: np.ndarray, element: np.ndarray) -> np.ndarray:
        """Where points (N,2), given in the straight triangles of the elements (M,), lie in the body."""
        if self.body.mesh.GetCurveOrder() == 1:
            return points
        reference, places = reference_coordinates(self.body.mesh, points[triangles], element), points.copy()
        places[triangles.ravel()] = self._At(CF((x, y)), np.repeat(element, 3), reference.reshape(-1, 2))
        return places

    def _At(self, cf: CoefficientFunction, elements: BitArray, reference: np.ndarray) -> np.ndarray:
        """Values (n, dim) at reference coordinates (n,2) in elements (n,)."""
        places = mesh_points(self.body.mesh, elements, *reference.T)
        return np.reshape(cf(places), (len(elements), cf.dim)) if len(elements) else np.zeros((0, cf.dim))

    def Evaluate(self, plus: CoefficientFunction, minus: CoefficientFunction, middle: CoefficientFunction) -> np.ndarray:
        """Values (N, dim) of CoefficientFunctions at the points: plus and minus on the two lips, middle elsewhere.

        Plus(u) and Minus(u) are limits on the crack, no continuations: off the crack the position gives u its side. Where cracks meet, the position
        decides, too.
        """
        triangle = self.corner // 3
        elements, reference = self.element[triangle], self.reference.reshape(-1, 2)[self.corner]
        reference[self.meeting] += BESIDE * (self.reference[triangle[self.meeting]].mean(axis=1) - reference[self.meeting])
        values = np.empty((len(self.points), middle.dim))
        for side, cf in ((1, plus), (-1, minus), (0, middle)):
            chosen = self.point_side == side
            values[chosen] = self._At(cf, elements[chosen], reference[chosen])
        return values

    def EvaluateInside(self, cf: CoefficientFunction) -> np.ndarray:
        """Values (M, 3, dim) a little inside the corners of each triangle: for stresses, which jump."""
        near = (1 - PULL) * self.reference + PULL * self.reference.mean(axis=1, keepdims=True)
        return self._At(cf, np.repeat(self.element, 3), near.reshape(-1, 2)).reshape(len(self.triangles), 3, -1)

    @property
    def mesh(self) -> Mesh:
        """An ngsolve.Mesh: vertex i is points[i], element i triangles[i]; boundaries as the body's, and "crack" for the lips."""
        if self._mesh is None:
            self._mesh = boundary_mesh(self.points, self.triangles, *boundary_edges(self)[:2])
        return self._mesh

    def GridFunction(self, values: np.ndarray) -> GridFunction:
        """On `mesh`: continuous from values (N, dim) at the points, discontinuous from values (M, 3, dim) at the corners."""
        return linear_function(self.mesh, values)


def linear_function(mesh: Mesh, values: np.ndarray) -> GridFunction:
    """On a mesh of N points and M triangles: continuous from values (N, dim), discontinuous from values (M, 3, dim) at the corners."""
    space = H1(mesh, order=1, dim=values.shape[-1])
    function = GridFunction(space if values.ndim == 2 else Discontinuous(space, dim=space.dim))
    function.vec.FV().NumPy()[:] = values.ravel()
    return function


def conforming_triangles(body: CrackedMesh, tolerance: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, triangles and their elements with no point inside an edge; no point is doubled yet. Curved elements are straight here."""
    vertices, elements = mesh_arrays(body.mesh)
    cut = mask(body.CrackElements(None))
    uncut = np.flatnonzero(~cut)
    parts = [(int(element), part) for element in np.flatnonzero(cut) for part in body.Parts(int(element))]
    flat_parts = [(t, element) for element, part in parts for t in flat(part)]
    corners = np.array([triangle for triangle, _ in flat_parts]).reshape(-1, 2)
    bends = np.concatenate([np.zeros((0, 2)), *(in_triangles(body, c, [0, *crack.kinks, crack.length]) for c, crack in enumerate(body.cracks))])
    points, number = merged(np.concatenate([vertices, corners, bends]), tolerance)
    new = number[len(vertices) :]
    triangles = np.concatenate([number[elements[uncut]], new[: len(corners)].reshape(-1, 3)])
    parent = np.concatenate([uncut, np.array([element for _, element in flat_parts], dtype=int)])
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    longest = np.linalg.norm([b - a, c - b, a - c], axis=2).max(axis=0)
    thick = np.abs(cross(b - a, c - a)) > tolerance * longest  # others have a corner on an edge: they would be divided for ever
    triangles, parent, a, b, c = (array[thick] for array in (triangles, parent, a, b, c))
    clockwise = cross(b - a, c - a) < 0
    triangles[clockwise] = triangles[clockwise, ::-1]
    triangles, parent = without_hanging_points(points, triangles, parent, np.unique(new), tolerance)
    return points, triangles, parent


def flat(part: PartTriangle) -> list[Sequence[tuple[float, float]]]:
    """The triangles of a part; a curved side becomes a polyline with kinks of less than 3 degrees."""
    apex, *side = part.Outline(0.05)
    return [(apex, a, b) for a, b in zip(side, side[1:])]


def in_triangles(body: CrackedMesh, crack: int, arclengths: Sequence[float]) -> np.ndarray:
    """Points (n,2) of a crack, in the straight triangles of the elements that carry them."""
    element, xi, eta = (np.array(values) for values in body.OnCrack(crack, list(arclengths)))
    vertices, elements = mesh_arrays(body.mesh)
    v0, v1, v2 = (vertices[elements[element, k]] for k in range(3))
    return v2 + xi[:, None] * (v0 - v2) + eta[:, None] * (v1 - v2)


def merged(points: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """The points without repetitions, and the number of each old one; the first of several stays."""
    label = components(len(points), *scipy.spatial.cKDTree(points).query_pairs(tolerance, output_type="ndarray").T)
    _, first, number = np.unique(label, return_index=True, return_inverse=True)
    return points[first], number


def components(size: int, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Number (size,) of the connected component of each of `size` things, of which first[i] and second[i] are linked."""
    links = scipy.sparse.coo_matrix((np.ones(len(first)), (first, second)), shape=(size, size))
    return scipy.sparse.csgraph.connected_components(links, directed=False)[1].astype(np.int64)  # 32 bits overflow in twin_edges


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a_x b_y - a_y b_x of arrays (..., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def without_hanging_points(points: np.ndarray, triangles: np.ndarray, parent: np.ndarray, candidates: np.ndarray, tolerance: float) -> list[np.ndarray]:
    """Triangles divided until no candidate lies inside an edge.

    Tips do: pieces of a tip's element end at the straight extension of the crack, which ends inside the neighbour's edge.
    """
    done = []
    while len(triangles):
        point, corner = hanging_points(points, triangles, candidates, tolerance)
        hangs = point >= 0
        done.append((triangles[~hangs], parent[~hangs]))
        rows, point = np.flatnonzero(hangs), point[hangs]
        a, b, c = (triangles[rows, (corner[hangs] + k) % 3] for k in range(3))
        triangles = np.concatenate([np.stack([a, point, c], axis=1), np.stack([point, b, c], axis=1)])
        parent = np.tile(parent[hangs], 2)
    return [np.concatenate(parts) for parts in zip(*done)]


def hanging_points(points: np.ndarray, triangles: np.ndarray, candidates: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """For each triangle a candidate inside one of its edges (or -1), and the corner at which that edge starts."""
    point, corner = np.full(len(triangles), -1), np.zeros(len(triangles), dtype=int)
    tree = scipy.spatial.cKDTree(points[candidates])
    for k in range(3):
        a, b = points[triangles[:, k]], points[triangles[:, (k + 1) % 3]]
        length = np.linalg.norm(b - a, axis=1)
        near = tree.query_ball_point((a + b) / 2, np.maximum(length / 2 - tolerance, 0))
        owner = np.repeat(np.arange(len(triangles)), [len(found) for found in near])
        found = candidates[np.concatenate(near).astype(int)]
        inside = np.abs(cross(b[owner] - a[owner], points[found] - a[owner])) <= tolerance * length[owner]
        point[owner[inside]], corner[owner[inside]] = found[inside], k
    return point, corner


def on_curves(body: CrackedMesh, crack_of: np.ndarray, ends: np.ndarray, places: np.ndarray) -> np.ndarray:
    """For edges on cracks (L,) with ends (2,L,2), in straight triangles, at places (2,L,2) the points (L,2) of the cracks half-way between."""
    middles = ends.mean(axis=0)
    for c, crack in enumerate(body.cracks):
        if body.mesh.GetCurveOrder() > 1 or any(kind != "segment" for kind, _ in crack.pieces):
            on = np.flatnonzero(crack_of == c)
            arclengths = [np.mean([crack.ArcLength(tuple(end)) for end in places[:, i]]) for i in on]
            middles[on] = in_triangles(body, c, list(map(float, arclengths)))
    return middles


def divide_in_four(points: np.ndarray, triangles: np.ndarray, edge: np.ndarray, middles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points with the middles of the edges, given (L,2) for some (L,), and triangles; those of the first quarter come first, and so on."""
    ends = np.sort([triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()], axis=0)
    edges, number = np.unique(ends, axis=1, return_inverse=True)
    p, q, r = triangles.T
    pq, qr, rp = (len(points) + number.reshape(-1, 3)).T
    quarters = [(p, pq, rp), (pq, q, qr), (rp, qr, r), (pq, qr, rp)]
    halves = points[edges].mean(axis=0)
    halves[number.ravel()[edge]] = middles
    return np.concatenate([points, halves]), np.concatenate([np.stack(part, axis=1) for part in quarters])


def on_several_cracks(points: np.ndarray, crack: np.ndarray) -> np.ndarray:
    """Those of the points (L,2), ends of edges on cracks (L,), that lie on more than one crack."""
    pairs = np.unique(np.stack([points.ravel(), np.repeat(crack, 2)], axis=1), axis=0)
    numbers, count = np.unique(pairs[:, 0], return_counts=True)
    return numbers[count > 1]


def next_corner(corner: np.ndarray) -> np.ndarray:
    """Of the corners 3t, 3t+1, 3t+2 of triangle t; an edge has the number of the corner at which it starts."""
    return corner - corner % 3 + (corner + 1) % 3


def twin_edges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The edges that two triangles share: the number in the one and the number in the other."""
    a, b = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(a, b) * (triangles.max() + 1) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    return order[same], order[same + 1]


def crack_edges(cracks: list[Crack], points: np.ndarray, triangles: np.ndarray, carried: np.ndarray, tolerance: float) -> list[np.ndarray]:
    """Edges (L,) on a crack, corners (L,2) that give the values at their ends, their cracks (L,), and the sides (L,) of their triangles.

    carried (M, cracks): whether a triangle's element carries a crack. Limits on a crack are defined in elements that carry it: where it runs along edges,
    the neighbour may carry another crack, to which Plus and Minus would refer.
    """
    first, second = twin_edges(triangles)
    near = (carried[first // 3] | carried[second // 3]).any(axis=1)
    edges, twins = np.concatenate([first[near], second[near]]), np.concatenate([second[near], first[near]])
    a, b = triangles.ravel()[edges], triangles.ravel()[next_corner(edges)]
    crack_of, side = np.full(len(edges), -1), np.zeros(len(edges), dtype=int)
    for c, crack in enumerate(cracks):
        rank = ranks_along(crack, points, np.unique([a, b]), tolerance)
        step = rank[b] - rank[a]
        if crack.closed:  # the last point is followed by the first
            last = rank.max()
            step = np.where(np.abs(step) == last, -np.sign(step), step) if last > 1 else step
        on = (rank[a] >= 0) & (rank[b] >= 0) & (np.abs(step) == 1)
        crack_of[on], side[on] = c, step[on]  # a triangle lies to the left of its edges
    own, other = np.stack([edges, next_corner(edges)], axis=1), np.stack([next_corner(twins), twins], axis=1)
    values_from = np.where(carried[edges // 3, crack_of][:, None], own, other)
    return [array[side != 0] for array in (edges, values_from, crack_of, side)]


def ranks_along(crack: Crack, points: np.ndarray, candidates: np.ndarray, tolerance: float) -> np.ndarray:
    """For each point its number in the order of arc length among those of the candidates that lie on the crack, else -1."""
    on = [i for i in candidates if crack.Distance(tuple(points[i])) <= tolerance]
    arclength = [crack.ArcLength(tuple(points[i])) for i in on]
    rank = np.full(len(points), -1)
    rank[np.array(on, dtype=int)[np.argsort(arclength)]] = np.arange(len(on))
    return rank


def reference_coordinates(mesh: Mesh, corners: np.ndarray, element: np.ndarray) -> np.ndarray:
    """Of points (M,3,2) in elements (M,); the vertices of NGSolve's reference triangle are (1,0), (0,1), (0,0)."""
    vertices, elements = mesh_arrays(mesh)
    v0, v1, v2 = (vertices[elements[element, k]][:, None] for k in range(3))
    a, b, d = v0 - v2, v1 - v2, corners - v2
    return np.stack([cross(d, b), cross(a, d)], axis=-1) / cross(a, b)[..., None]


def boundary_mesh(points: np.ndarray, triangles: np.ndarray, edges: np.ndarray, names: np.ndarray) -> Mesh:
    """The mesh of NGSolve with points (N, 2), triangles (M, 3), and edges (n, 2) on boundaries with names (n,)."""
    mesh = triangle_mesh(points, triangles)
    for i, name in enumerate(np.unique(names)):
        mesh.AddElements(dim=1, index=i + 1, data=edges[names == name].astype(np.int32), base=0)
        mesh.SetBCName(i, str(name))
    return Mesh(mesh)


def triangle_mesh(points: np.ndarray, triangles: np.ndarray) -> Any:
    """The mesh of Netgen with points (N, 2) and triangles (M, 3), without boundary elements."""
    import netgen.meshing as netgen

    mesh = netgen.Mesh(dim=2)
    mesh.Add(netgen.FaceDescriptor(surfnr=1, domin=1, bc=1))
    mesh.AddPoints(np.column_stack([points, np.zeros(len(points))]))
    mesh.AddElements(dim=2, index=1, data=triangles.astype(np.int32), base=0)
    return mesh


def boundary_edges(split: SplitMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges (n,2) of a SplitMesh that only one triangle has, the names of their boundaries, "" where other processes go on, and their triangles."""
    corners = np.setdiff1d(np.arange(split.triangles.size), np.concatenate(twin_edges(split.triangles)))
    ends = np.stack([corners, next_corner(corners)], axis=1)
    xi, eta = np.moveaxis(split.reference.reshape(-1, 2)[ends], -1, 0)
    opposite = np.argmin(np.abs([xi, eta, 1 - xi - eta]).max(axis=2), axis=0)  # the vertex whose hat function is 0 on the edge
    elements, mesh = mesh_arrays(split.body.mesh)[1], split.body.mesh
    between = np.sort([elements[split.element[corners // 3], (opposite + k) % 3] for k in (1, 2)], axis=0).T
    names = {tuple(sorted(v.nr for v in edge.vertices)): edge.mat for edge in mesh.Elements(BND)}
    on_crack = np.isin(corners, split.lip_edges)
    found = ["crack" if c else names.get(tuple(pair), "") for c, pair in zip(on_crack, between.tolist())]
    return split.triangles.ravel()[ends], np.array(found, dtype=str), corners // 3
