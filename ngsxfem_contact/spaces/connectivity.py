"""The connected parts of Ω∖Γ_C as the space V_h sees them, and which of their rigid motions are held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import GridFunction

from ..algebra.matrices import mask
from .unknowns import Unknowns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .._ngsxfem_contact import CrackFESpace, ElementPart
    from ..loads.load import StiffnessForm

SLIVER = 1e-12  # of the largest part of an element: a smaller one holds nothing together
HELD = 1e-8  # of a motion's size: what supports change by less is free


def sides_of_parts(parts: list[ElementPart]) -> set[tuple[int, ...]]:
    """The signs with respect to its cracks of the parts of an element, each once: {()} for an element that no crack meets."""
    if not parts:
        return {()}
    corners = np.array([part.triangle for part in parts])
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return {tuple(map(int, part.sides)) for part, area in zip(parts, areas) if area > SLIVER * areas.max()}


class VertexCopies:
    """A vertex whose function is enriched has a copy on each side of the crack; the others have one.

    Attributes
    ----------
    corners
        (n, 3), the copies at the corners of each part of an element, or of a whole one.
    labels
        (n,) the part of the body to which it belongs: those are joined where they share two copies, an edge; one copy alone is a hinge.
    parts
        Their number.
    index
        (vertex, sides) → copy, where sides are the signs with respect to the cracks that enrich the vertex; a vertex that none enriches is its own copy.
    vertex
        (copies,) the vertex of each.
    """

    def __init__(self, V: CrackFESpace) -> None:
        self.V, self.nv = V, V.mesh.nv
        self.enriched = {}
        for j in range(V.num_heaviside):
            dof, shift = V.Heaviside(j)
            if dof < self.nv:
                self.enriched.setdefault(dof, []).append((j, shift, V.HeavisideCrack(j)))
        self.index = {}
        away, beside = self._elements()
        self.corners = np.concatenate([away, np.array(list(self._parts(beside)), dtype=int).reshape(-1, 3)])
        self.vertex = np.concatenate([np.arange(self.nv), np.array([vertex for vertex, _ in self.index], dtype=int)])
        self.parts, self.labels = parts_joined_by_edges(self.corners, len(self.vertex))

    def _elements(self) -> tuple[np.ndarray, list[tuple[int, Any]]]:
        """The vertices of elements away from the cracks, (n, 3); number and vertices of the others."""
        vertices = self.V.mesh.ngmesh.Elements2D().NumPy()["nodes"][:, :3].astype(int) - 1
        enriched = np.zeros(self.nv, dtype=bool)
        enriched[list(self.enriched)] = True
        beside = mask(self.V.body.CrackElements(None)) | enriched[vertices].any(axis=1)
        return vertices[~beside], [(int(element), vertices[element].tolist()) for element in np.flatnonzero(beside)]

    def _parts(self, elements: list[tuple[int, Any]]) -> Iterator[list[int]]:
        """The copies at the corners of each part of the elements beside a crack."""
        body = self.V.body
        for element, vertices in elements:
            cracks = body.CracksOf(element)
            for sides in sides_of_parts(body.Parts(element)):
                yield [self._copy(v, element, dict(zip(cracks, sides))) for v in vertices]

    def _copy(self, vertex: int, element: int, forced: dict[int, int]) -> int:
        """The copy on the side of an element, or on forced sides {crack: side} with respect to the cracks that divide it."""
        if vertex not in self.enriched:
            return vertex
        own = tuple(self.V.HeavisideSide(j, element) or forced[crack] for j, _, crack in self.enriched[vertex])
        return self.index.setdefault((vertex, own), self.nv + len(self.index))

    def OnLargerSide(self) -> np.ndarray:
        """(nv,): the copy of each vertex whose displacement is the coefficient of φ_i; -1 if there is none."""
        copies = np.arange(self.nv)
        for vertex, functions in self.enriched.items():
            copies[vertex] = self.index.get((vertex, tuple(shift for _, shift, _ in functions)), -1)
        return copies

    def AcrossCracks(self) -> Iterator[tuple[int, int, int]]:
        """(j, copy, copy): the coefficient of the j-th Heaviside function is the jump, the displacement of the first copy minus that of the second."""
        for vertex, functions in self.enriched.items():
            larger = tuple(shift for _, shift, _ in functions)
            for k, (j, shift, _) in enumerate(functions):
                other = larger[:k] + (-shift,) + larger[k + 1 :]
                if {(vertex, larger), (vertex, other)} <= self.index.keys():
                    plus, minus = (larger, other)[::shift]
                    yield j, self.index[vertex, plus], self.index[vertex, minus]


def parts_joined_by_edges(corners: np.ndarray, copies: int) -> tuple[int, np.ndarray]:
    """(number, labels) of the connected parts of triangles (n, 3) that share edges."""
    n, following = len(corners), np.roll(corners, 1, axis=1)
    edges = (np.minimum(corners, following).astype(np.int64) * copies + np.maximum(corners, following)).ravel()
    order = np.argsort(edges)
    shared = np.flatnonzero(np.diff(edges[order]) == 0)
    pairs = order[shared] // 3, order[shared + 1] // 3
    return scipy.sparse.csgraph.connected_components(scipy.sparse.coo_matrix((np.ones(len(shared), dtype=bool), pairs), shape=(n, n)), directed=False)


@dataclass
class FreeMotion:
    """number: of free rigid motions.

    Parameters
    ----------
    centre
        Of the part that moves.
    hinges
        Points (n, 2) at which it hangs on others.
    parts
        Of the body.
    """

    number: int
    centre: np.ndarray
    hinges: np.ndarray
    parts: int


class RigidMotions:
    """Two translations and a turn for each part of a body, about its centre, in units of its size; what hinges and supports ask of them."""

    def __init__(self, V: CrackFESpace) -> None:
        self.copies = copies = VertexCopies(V)
        keys = np.unique(copies.corners.astype(np.int64) * copies.parts + copies.labels[:, None])
        self.copy, self.part = keys // copies.parts, keys % copies.parts  # each pair once, ordered by copies
        self.points = V.mesh.ngmesh.Coordinates()[copies.vertex, :2]
        members = [self.points[self.copy[self.part == part]] for part in range(copies.parts)]
        self.centres = np.array([0.5 * (points.min(axis=0) + points.max(axis=0)) for points in members])
        self.sizes = np.array([np.ptp(points, axis=0).max() for points in members])
        self.hinges = np.flatnonzero(np.diff(self.copy) == 0)  # pairs i and i + 1 are one copy in two parts

    def Rows(self, pairs: np.ndarray, component: int) -> np.ndarray:
        """A component of the displacement of pairs of copy and part, as a matrix (len(pairs), 3 parts) on the motions."""
        rows, part = np.zeros((len(pairs), 3 * self.copies.parts)), self.part[pairs]
        arm = (self.points[self.copy[pairs]] - self.centres[part]) / self.sizes[part][:, None]
        number = np.arange(len(pairs))
        rows[number, 3 * part + component] = 1
        rows[number, 3 * part + 2] = arm[:, 0] if component else -arm[:, 1]
        return rows

    def Coefficients(self) -> tuple[np.ndarray, np.ndarray]:
        """(unknowns, rows): the coefficients of the motions in V, a matrix (number, 3 parts) for the unknowns that are not zero."""
        copies, V = self.copies, self.copies.V
        pair = np.full(len(copies.vertex) + 1, -1)  # of each copy; -1 has none
        pair[self.copy] = np.arange(len(self.copy))
        vertices, across = pair[copies.OnLargerSide()], list(copies.AcrossCracks())
        jumps = np.array([(pair[a], pair[b]) for _, a, b in across], dtype=int).reshape(-1, 2)
        there = np.flatnonzero(vertices >= 0)
        unknowns, rows = [], []
        layout, number = Unknowns(V), np.array([j for j, _, _ in across], dtype=int)
        for k in range(2):
            unknowns += [layout.Polynomial(k).start + there, layout.Heaviside(k).start + number]
            rows += [self.Rows(vertices[there], k), self.Rows(jumps[:, 0], k) - self.Rows(jumps[:, 1], k)]
        return np.concatenate(unknowns), np.concatenate(rows)

    def Constraints(self, fixed: np.ndarray, springs: StiffnessForm) -> np.ndarray:
        """What must vanish, as a matrix on the motions.

        Parameters
        ----------
        fixed
            The unknowns of V that are, a boolean array.
        springs
            A StiffnessForm.
        """
        unknowns, rows = self.Coefficients()
        hinges = [self.Rows(self.hinges, k) - self.Rows(self.hinges + 1, k) for k in range(2)]
        return np.concatenate([*hinges, rows[fixed[unknowns]], self._of_springs(springs, unknowns, rows)])

    @staticmethod
    def _of_springs(springs: StiffnessForm, unknowns: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """The square root of the energy of springs, relative to the largest: it vanishes where none resists."""
        if not springs.terms:
            return rows[:0]
        motion, forces = GridFunction(springs.V), []
        for column in rows.T:
            motion.vec[:] = 0
            motion.vec.FV().NumPy()[unknowns] = column
            forces.append(rows.T @ springs.Forces(motion)[unknowns])
        energies, modes = np.linalg.eigh(forces)
        return np.sqrt(np.maximum(energies, 0) / max(energies[-1], np.finfo(float).tiny))[:, None] * modes.T

    def Free(self, fixed: np.ndarray, springs: StiffnessForm) -> FreeMotion | None:
        """The FreeMotion of the part that moves most, or None if all parts are held."""
        constraints, parts = self.Constraints(fixed, springs), self.copies.parts
        triangle = np.linalg.qr(np.concatenate([constraints, np.zeros((3 * parts, 3 * parts))]), mode="r")
        _, sizes, motions = np.linalg.svd(triangle)
        free = motions[sizes < HELD].reshape(-1, parts, 3)
        if len(free) == 0:
            return None
        part = int(np.argmax(np.linalg.norm(free, axis=(0, 2))))
        shared = [i for i in self.hinges if part in (self.part[i], self.part[i + 1])]
        return FreeMotion(int(np.linalg.matrix_rank(free[:, part], tol=HELD)), self.centres[part], self.points[self.copy[shared]], parts)
