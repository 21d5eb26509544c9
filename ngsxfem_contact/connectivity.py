"""The connected parts of Ω∖Γ_C as the space V_h sees them, and their rigid motions."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from .spaces import mask

SLIVER = 1e-12  # of the largest part of an element: a smaller one holds nothing together


def sides_of_parts(parts):
    """The signs with respect to its cracks of the parts of an element, each once: {()} for an element that no crack meets."""
    if not parts:
        return {()}
    corners = np.array([part.piece.triangle for part in parts])
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return {tuple(map(int, part.sides)) for part, area in zip(parts, areas) if area > SLIVER * areas.max()}


class VertexCopies:
    """A vertex whose function is enriched has a copy on each side of the crack; the others have one.

    labels: the connected part of each copy.    parts: their number.    index: (vertex, sides) → copy, where sides are
    the signs with respect to the cracks that enrich the vertex; a vertex that none enriches is its own copy.
    """

    def __init__(self, V):
        self.V, self.nv = V, V.mesh.nv
        self.enriched = {}
        for j in range(V.num_heaviside):
            dof, shift = V.Heaviside(j)
            if dof < self.nv:
                self.enriched.setdefault(dof, []).append((j, shift, V.HeavisideCrack(j)))
        self.index = {}
        edges = np.concatenate([self._uncut_edges(), np.array(self._crack_edges(), dtype=int).reshape(-1, 2)])
        copies = self.nv + len(self.index)
        rows, columns = edges.T
        self.parts, self.labels = connected_components(coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(copies, copies)), directed=False)
        self._forget_unused()

    def _forget_unused(self):
        """Enriched vertices have no single copy: their entry (v, ()) belongs to no part."""
        used = np.ones(len(self.labels), dtype=bool)
        used[list(self.enriched)] = False
        parts, self.labels[used] = np.unique(self.labels[used], return_inverse=True)
        self.labels[~used] = -1
        self.parts = len(parts)

    def _copy(self, vertex, element, forced):
        """The copy on the side of an element, or on forced sides {crack: side} with respect to the cracks that divide it."""
        own = tuple(self.V.HeavisideSide(j, element) or forced[crack] for j, _, crack in self.enriched.get(vertex, []))
        return self.index.setdefault((vertex, own), self.nv + len(self.index)) if own else vertex

    def _uncut_edges(self):
        """Two edges of each element away from the cracks; the others are kept in `beside`."""
        mesh = self.V.mesh
        vertices = mesh.ngmesh.Elements2D().NumPy()["nodes"][:, :3].astype(int) - 1
        enriched = np.zeros(self.nv, dtype=bool)
        enriched[list(self.enriched)] = True
        beside = mask(self.V.body.CrackElements(None)) | enriched[vertices].any(axis=1)
        self.beside = [(int(element), vertices[element].tolist()) for element in np.flatnonzero(beside)]
        return np.concatenate([vertices[~beside][:, [0, 1]], vertices[~beside][:, [0, 2]]])

    def _crack_edges(self):
        """Each part of an element beside a crack joins the copies of its vertices on its sides."""
        edges = []
        body = self.V.body
        for element, vertices in self.beside:
            cracks = body.CracksOf(element)
            for sides in sides_of_parts(body.Parts(element)):
                first, *others = [self._copy(v, element, dict(zip(cracks, sides))) for v in vertices]
                edges += [(first, other) for other in others]
        return edges

    def RigidMotions(self, part):
        """Coefficients in V of the two translations and the rotation of one part, zero elsewhere: (ndof, 3)."""
        points = self.V.mesh.ngmesh.Coordinates()[: self.nv]
        fields = [(1 + 0 * points[:, 0], 0 * points[:, 0]), (0 * points[:, 0], 1 + 0 * points[:, 0]), (-points[:, 1], points[:, 0])]
        return np.column_stack([self._coefficients(field, part) for field in fields])

    def _coefficients(self, field, part):
        vec = np.zeros(self.V.ndof)
        inside = self.labels[: self.nv] == part
        scalar = self.V.scalar_space.ndof
        for component in range(2):
            vec[component * scalar + np.flatnonzero(inside)] = field[component][inside]
            for vertex, functions in self.enriched.items():
                larger = tuple(shift for _, shift, _ in functions)
                on_larger = self._is_in(vertex, larger, part)
                vec[component * scalar + vertex] = on_larger * field[component][vertex]
                for k, (j, shift, _) in enumerate(functions):
                    # the function ½(H - s) φ is -s φ on the other side
                    other = larger[:k] + (-shift,) + larger[k + 1 :]
                    difference = self._is_in(vertex, other, part) - on_larger
                    vec[self.V.HeavisideDof(j, component)] = -shift * difference * field[component][vertex]
        return vec

    def _is_in(self, vertex, sides, part):
        copy = self.index.get((vertex, sides)) if sides else vertex
        return float(copy is not None and self.labels[copy] == part)
