"""The connected parts of Ω∖Γ_C as the space V_h sees them, and which of their rigid motions are held."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import GridFunction

from ..algebra.matrices import mask
from ..points import element_vertices
from .unknowns import Unknowns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .._ngsxfem_contact import CrackFESpace
    from ..loads.load import StiffnessForm
    from ..share import Share

SLIVER = 1e-12  # of the largest part of an element: a smaller one holds nothing together
HELD = 1e-8  # of a motion's size: what supports change by less is free


class VertexCopies:
    """A vertex is there once for each connected part of the support of its function.

    Attributes
    ----------
    corners
        (n, 3), in space (n, 4), the copies at the corners of each part of an element, or of a whole one.
    element
        (n,) the element of each.
    labels
        (n,) the part of the body to which it belongs: those are joined where they share an edge, in space a face; fewer copies are a hinge.
    parts
        Their number.
    vertex
        (copies,) the vertex of each: the vertices themselves, on the largest part of their supports, then those of `functions`.
    functions
        The numbers of the Heaviside functions of vertices, one for each further copy.
    """

    def __init__(self, V: CrackFESpace) -> None:
        self.V, self.nv = V, V.mesh.nv
        self.functions = [j for j in range(V.num_heaviside) if V.Heaviside(j)[0] < self.nv]
        self.vertex = np.concatenate([np.arange(self.nv), np.array([V.Heaviside(j)[0] for j in self.functions], dtype=int)])
        self.further: dict[int, list[tuple[int, int]]] = {}  # of a vertex its other copies, with their functions
        for copy, j in enumerate(self.functions, self.nv):
            self.further.setdefault(int(self.vertex[copy]), []).append((copy, j))
        away, beside = self._elements()
        parts = list(self._parts(beside))
        self.corners = np.concatenate([away[1], np.array([corners for _, corners in parts], dtype=int).reshape(-1, away[1].shape[1])])
        self.element = np.concatenate([away[0], np.array([element for element, _ in parts], dtype=int)])
        self.parts, self.labels = joined(V.share, self, *parts_joined_by_facets(self.corners, len(self.vertex)))

    def _elements(self) -> tuple[tuple[np.ndarray, np.ndarray], list[tuple[int, Any]]]:
        """Numbers (n,) and vertices, (n, 3) or (n, 4), of elements away from the cracks; number and vertices of the others."""
        vertices = element_vertices(self.V.mesh)
        enriched = np.zeros(self.nv, dtype=bool)
        enriched[list(self.further)] = True
        beside = mask(self.V.body.CrackElements(None)) | enriched[vertices].any(axis=1)
        return (np.flatnonzero(~beside), vertices[~beside]), [(int(element), vertices[element].tolist()) for element in np.flatnonzero(beside)]

    def _parts(self, elements: list[tuple[int, Any]]) -> Iterator[tuple[int, list[int]]]:
        """The element, and the copies at the corners, of each part of the elements beside a crack."""
        for element, vertices in elements:
            sizes = self.V.body.PartSizes(element)
            further = [[(copy, self.V.HeavisideFactors(j, element)) for copy, j in self.further.get(vertex, ())] for vertex in vertices]
            for part in np.flatnonzero(np.array(sizes) > SLIVER * max(sizes)):
                yield element, [next((copy for copy, factors in copies if factors[part]), vertex) for vertex, copies in zip(vertices, further)]

    def AcrossCracks(self) -> Iterator[tuple[int, int, int]]:
        """(j, copy, copy): the coefficient of the j-th Heaviside function is the displacement of the first copy minus that of the second."""
        for copy, j in enumerate(self.functions, self.nv):
            vertex, side_of_vertex = self.V.Heaviside(j)
            yield (j, vertex, copy) if side_of_vertex > 0 else (j, copy, vertex)


def parts_joined_by_facets(corners: np.ndarray, copies: int) -> tuple[int, np.ndarray]:
    """(number, labels) of the connected parts of triangles (n, 3) or tetrahedra (n, 4) that share edges, or faces."""
    n, number = corners.shape
    facets = np.zeros((n, number), dtype=np.int64)
    for k in range(number):  # without the k-th corner
        for corner in np.sort(np.delete(corners, k, axis=1), axis=1).T:
            facets[:, k] = facets[:, k] * copies + corner
    order = np.argsort(facets.ravel())
    shared = np.flatnonzero(np.diff(facets.ravel()[order]) == 0)
    pairs = order[shared] // number, order[shared + 1] // number
    return scipy.sparse.csgraph.connected_components(scipy.sparse.coo_matrix((np.ones(len(shared), dtype=bool), pairs), shape=(n, n)), directed=False)


def joined(share: Share, copies: VertexCopies, parts: int, labels: np.ndarray) -> tuple[int, np.ndarray]:
    """(number, labels) of the parts of the whole body, of those that each process sees: they are one where processes hold the same part of an element, or meet at a facet."""
    if not share.several:
        return parts, labels
    everywhere, corners = share.everywhere[copies.element], share.vertices[copies.vertex[copies.corners]]
    n = corners.shape[1]
    facets = np.stack([np.delete(corners, k, axis=1) for k in range(n)], axis=1).reshape(-1, n - 1)
    at_others = (share.own[copies.element] & ~everywhere).repeat(n) & np.isin(facets, share.vertices[share.interface]).all(axis=1)
    names = [(*facet, -1) for facet in np.sort(facets[at_others], axis=1).tolist()]
    held = share.elements[copies.element[everywhere]].tolist()
    names += [(element, part, -2) for element, part in zip(held, number_of_repeat(held))]
    own = np.concatenate([labels.repeat(n)[at_others], labels[everywhere]]).tolist()
    of_all = share.Gather((parts, names, own))
    first = np.concatenate([[0], np.cumsum([number for number, _, _ in of_all])])
    known: dict[tuple[int, ...], int] = {}
    links = [
        (first[rank] + label, known.setdefault(name, first[rank] + label)) for rank, (_, keys, those) in enumerate(of_all) for name, label in zip(keys, those)
    ]
    rows, columns = np.array(links, dtype=int).reshape(-1, 2).T
    graph = scipy.sparse.coo_matrix((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(first[-1], first[-1]))
    number, whole = scipy.sparse.csgraph.connected_components(graph, directed=False)
    return number, whole[first[share.comm.rank] + labels]


def number_of_repeat(names: list[Any]) -> list[int]:
    """How often each name was there before."""
    before: Counter[Any] = Counter()
    numbers = []
    for name in names:
        numbers.append(before[name])
        before[name] += 1
    return numbers


class RigidMotions:
    """Translations and turns of each part of a body, about its centre, in units of its size; what hinges and supports ask of them.

    Attributes
    ----------
    number
        Of the motions of a part: 3 in the plane, 6 in space.
    """

    def __init__(self, V: CrackFESpace) -> None:
        self.copies = copies = VertexCopies(V)
        self.dimension = V.mesh.dim
        self.turns = [(i, j) for j in range(self.dimension) for i in range(j)]  # each in a plane of two axes
        self.number = self.dimension + len(self.turns)
        keys = np.unique(copies.corners.astype(np.int64) * copies.parts + copies.labels[:, None])
        self.copy, self.part = keys // copies.parts, keys % copies.parts  # each pair once, ordered by copies
        self.points = V.mesh.ngmesh.Coordinates()[copies.vertex, : self.dimension]
        self.share, members = V.share, [self.points[self.copy[self.part == part]] for part in range(copies.parts)]
        corner = lambda sign: np.array([(sign * points).max(axis=0, initial=-np.inf) for points in members])
        high, low = (sign * np.max(self.share.Gather(corner(sign)), axis=0) for sign in (1, -1))
        self.centres, self.sizes = 0.5 * (low + high), (high - low).max(axis=1)
        self.hinges = np.flatnonzero(np.diff(self.copy) == 0)  # pairs i and i + 1 are one copy in two parts

    def Rows(self, pairs: np.ndarray, component: int) -> np.ndarray:
        """A component of the displacement of pairs of copy and part, as a matrix (len(pairs), number × parts) on the motions."""
        rows, part = np.zeros((len(pairs), self.number * self.copies.parts)), self.part[pairs]
        arm = (self.points[self.copy[pairs]] - self.centres[part]) / self.sizes[part][:, None]
        number = np.arange(len(pairs))
        rows[number, self.number * part + component] = 1
        for turn, (i, j) in enumerate(self.turns, self.dimension):
            if component in (i, j):
                rows[number, self.number * part + turn] = arm[:, i] if component == j else -arm[:, j]
        return rows

    def Coefficients(self) -> tuple[np.ndarray, np.ndarray]:
        """(unknowns, rows): the coefficients of the motions in V, a matrix (unknowns, number × parts) for the unknowns that are not zero."""
        copies, V = self.copies, self.copies.V
        pair = np.full(len(copies.vertex), -1)  # of each copy
        pair[self.copy] = np.arange(len(self.copy))
        vertices, across = pair[: copies.nv], [(j, pair[a], pair[b]) for j, a, b in copies.AcrossCracks() if min(pair[a], pair[b]) >= 0]
        jumps = np.array([both for _, *both in across], dtype=int).reshape(-1, 2)
        there = np.flatnonzero(vertices >= 0)
        unknowns, rows = [], []
        layout, number = Unknowns(V), np.array([j for j, _, _ in across], dtype=int)
        for k in range(self.dimension):
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
        hinges = [self.Rows(self.hinges, k) - self.Rows(self.hinges + 1, k) for k in range(self.dimension)]
        of_all = self.share.Gather(np.concatenate([*hinges, rows[fixed[unknowns]]]))
        return np.concatenate([*of_all, self._of_springs(springs, unknowns, rows)])

    def _of_springs(self, springs: StiffnessForm, unknowns: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """The square root of the energy of springs, relative to the largest: it vanishes where none resists."""
        if not springs.terms:
            return rows[:0]
        motion, forces = GridFunction(springs.V), []
        for column in rows.T:
            motion.vec[:] = 0
            motion.vec.FV().NumPy()[unknowns] = column
            forces.append(rows.T @ springs.Forces(motion)[unknowns])
        energies, modes = np.linalg.eigh(self.share.Sum(np.array(forces)))
        return np.sqrt(np.maximum(energies, 0) / max(energies[-1], np.finfo(float).tiny))[:, None] * modes.T

    def Free(self, fixed: np.ndarray, springs: StiffnessForm) -> FreeMotions | None:
        """Those that are not held, or None if all parts are; fixed, springs: see Constraints."""
        free = self.share.FromFirst(without_effect(self.Constraints(fixed, springs)))
        return FreeMotions(self, free.reshape(-1, self.copies.parts, self.number)) if len(free) else None


def without_effect(rows: np.ndarray, size: float = 1.0) -> np.ndarray:
    """(number, n): orthonormal combinations of the columns of rows (m, n) that are smaller than HELD × size, by a matrix of n columns only."""
    n = rows.shape[1]
    _, sizes, combinations = np.linalg.svd(np.linalg.qr(np.concatenate([rows, np.zeros((n, n))]), mode="r"))
    return combinations[sizes < HELD * size]


@dataclass
class FreeMotions:
    """Rigid motions that nothing holds.

    Attributes
    ----------
    motions
        (n, parts, number): translations and turns of each part of the body, orthonormal.
    """

    rigid: RigidMotions
    motions: np.ndarray

    @property
    def parts(self) -> np.ndarray:
        """The numbers of the parts that move."""
        return np.flatnonzero(np.linalg.norm(self.motions, axis=(0, 2)) > HELD)

    @property
    def centres(self) -> np.ndarray:
        """Those of the parts that move, (parts, dimension)."""
        return self.rigid.centres[self.parts]

    def Combined(self, combinations: np.ndarray) -> FreeMotions:
        """Some of the motions, given as columns (n, number)."""
        return FreeMotions(self.rigid, np.einsum("nc,npk->cpk", combinations, self.motions))

    def Coefficients(self) -> np.ndarray:
        """(ndof, n): the motions as functions of V."""
        unknowns, rows = self.rigid.Coefficients()
        coefficients = np.zeros((self.rigid.copies.V.ndof, len(self.motions)))
        coefficients[unknowns] = rows @ self.motions.reshape(len(self.motions), -1).T
        return coefficients

    @property
    def message(self) -> str:
        """What is free, of the part that moves most, and what to do."""
        rigid, part = self.rigid, int(np.argmax(np.linalg.norm(self.motions, axis=(0, 2))))
        number, centre = np.linalg.matrix_rank(self.motions[:, part], tol=HELD), in_words(rigid.centres[part])
        hinges = rigid.points[rigid.copy[[i for i in rigid.hinges if part in (rigid.part[i], rigid.part[i + 1])]]]
        name = "the body"
        if rigid.copies.parts > 1:
            name = f"one of the {rigid.copies.parts} parts into which the cracks divide the body, around {centre},"
        if len(hinges):
            vertices = ", ".join(map(in_words, hinges))
            name = f"the part of the body around {centre}, which hangs on others by {'the vertex' if len(hinges) == 1 else 'the vertices'} {vertices} alone,"
        return f"{number} rigid motion(s) of {name} are left free: fix them by dirichlet=... in the space or by Pin(...), or by springs in problem.a ([[support]] in a part's file)"


def in_words(point: np.ndarray) -> str:
    """A point in a message."""
    return f"({', '.join(f'{coordinate:g}' for coordinate in point)})"
