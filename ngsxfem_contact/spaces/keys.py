"""Names of unknowns that do not depend on the numbers that a process gives them: what is known at these goes from one division of a mesh to another."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CELL, EDGE, VERTEX, VOL, ElementId, NodeId

from .. import _ngsxfem_contact as core
from ..pickling import Unnumbered
from .unknowns import Unknowns

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import Any

    from ngsolve import FESpace, Mesh

WIDTH = 7
TIP = 3  # beside the kinds of nodes


def node_keys(space: FESpace, vertices: np.ndarray) -> np.ndarray:
    """(ndof, WIDTH) of a space of NGSolve in the plane: kind of node, three numbers of its vertices, which function of the node, and two zeros; -1 for unknowns of no node.

    Parameters
    ----------
    vertices
        (nv,), numbers on which all agree. Where they increase with the numbers of the mesh functions of edges and triangles have the same orientation everywhere.
    """
    keys = np.full((space.ndof, WIDTH), -1)
    for kind, (node, number, name) in ((kind, at) for kind, nodes in enumerate(nodes_of(space.mesh, vertices)) for at in nodes):
        for k, dof in enumerate(space.GetDofNrs(NodeId(node, number))):
            if dof >= 0:
                keys[dof] = kind, *name, k, 0, 0
    return keys


def nodes_of(mesh: Mesh, vertices: np.ndarray) -> Iterator[Iterator[tuple[Any, int, tuple[int, int, int]]]]:
    """(kind, number, agreed numbers of its vertices) of all vertices, edges and triangles."""
    yield ((VERTEX, vertex, (number, 0, 0)) for vertex, number in enumerate(vertices.tolist()))
    yield ((EDGE, edge.nr, (*sorted(int(vertices[vertex.nr]) for vertex in edge.vertices), 0)) for edge in mesh.edges)  # type: ignore[misc]
    yield ((CELL, element.nr, tuple(sorted(int(vertices[vertex.nr]) for vertex in element.vertices))) for element in mesh.Elements(VOL))  # type: ignore[misc]


def unknown_keys(space: FESpace, vertices: np.ndarray) -> np.ndarray:
    """The same of a space or of V_h, where the zeros are copy and component."""
    if not isinstance(space, core.CrackFESpace):
        return node_keys(space, vertices)
    unknowns, scalar = Unknowns(space), node_keys(space.scalar_space, vertices)
    rows, enriched = [], unknowns.enriched
    for functions, copies in ((np.arange(unknowns.functions), np.zeros(unknowns.functions, dtype=int)), (enriched, ordered_copies(space, scalar, vertices))):
        for component in range(unknowns.components):
            of_functions = scalar[functions]
            of_functions[:, -2], of_functions[:, -1] = copies, component
            rows.append(of_functions)
    tips = np.arange(len(unknowns.tips))
    return np.concatenate([*rows, np.column_stack([np.full(len(tips), TIP), tips, *np.zeros((WIDTH - 2, len(tips)), dtype=int)])])


def copies_of(enriched: np.ndarray) -> np.ndarray:
    """The number of each copy among those of its φ_i, from 1."""
    before: Counter[int] = Counter()
    copies = np.zeros(len(enriched), dtype=int)
    for j, function in enumerate(enriched.tolist()):
        before[function] += 1
        copies[j] = before[function]
    return copies


def ordered_copies(V: core.CrackFESpace, scalar: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """The number of each copy, from 1, in an order that does not depend on that of elements: by the first element, by agreed numbers, and the first part of it that a copy has.

    Parameters
    ----------
    scalar
        node_keys of the φ_i.
    """
    enriched = Unknowns(V).enriched
    copies, at = copies_of(enriched), {number: vertex for vertex, number in enumerate(vertices.tolist())}
    for function in np.unique(enriched[copies > 1]):
        mine = np.flatnonzero(enriched == function)
        ends = scalar[function, 1 : 2 + scalar[function, 0]].tolist()
        support = set.intersection(*({element.nr for element in V.mesh[NodeId(VERTEX, at[end])].elements} for end in ends))
        names = {element: sorted(int(vertices[vertex.nr]) for vertex in V.mesh[ElementId(VOL, element)].vertices) for element in support}
        first = [min((names[element], part) for element in support for part, factor in enumerate(V.HeavisideFactors(int(j), element)) if factor) for j in mine]
        copies[mine[sorted(range(len(mine)), key=first.__getitem__)]] = np.arange(1, len(mine) + 1)
    return copies


@dataclass(frozen=True)
class Keyed:
    """What is known at some unknowns, each once.

    Attributes
    ----------
    keys, values
        (n, WIDTH), (n,).
    """

    keys: np.ndarray
    values: np.ndarray

    @staticmethod
    def Of(parts: Sequence[Keyed], add: bool = False) -> Keyed:
        """That of all parts; where several know an unknown the sum, or the first."""
        keys, values = np.concatenate([part.keys for part in parts]), np.concatenate([part.values for part in parts])
        names, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        return Keyed(names, np.bincount(place.ravel(), values, len(names)) if add else values[first])

    def At(self, keys: np.ndarray) -> np.ndarray:
        """(m,): the values at other keys (m, WIDTH). Raises Unnumbered where one is not known."""
        place = places(self.keys, keys)
        if (place < 0).any():
            raise Unnumbered(f"{int((place < 0).sum())} of {len(keys)} unknowns are not known")
        return self.values[place]


def places(known: np.ndarray, keys: np.ndarray) -> np.ndarray:
    """(m,): where each of keys (m, WIDTH) is among the known ones (n, WIDTH), which differ; -1: nowhere."""
    _, number = np.unique(np.concatenate([known, keys]), axis=0, return_inverse=True)
    number = number.ravel()
    place = np.full(len(known) + len(keys), -1)
    place[number[: len(known)]] = np.arange(len(known))
    return place[number[len(known) :]]
