"""Which unknowns of V_h processes share: those of nodes that several hold, those of tips, and those of nodes around fronts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CELL, EDGE, H1, VERTEX, VOL, ElementId, NodeId

from ..points import element_vertices
from ..processes import Exchange
from .keys import TIP, copies_of
from .unknowns import Unknowns, scalar_flags

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..share import Share
    from .crack_fespace import CrackFESpace

FRONT = TIP + 1  # beside the kinds of nodes


def exchange_of(V: CrackFESpace) -> Exchange:
    """The Exchange of the unknowns of V, kept with V; of one process all are its own. Raises RuntimeError unless all count as many functions as NGSolve does."""
    known: dict[str, Exchange] = V.__dict__
    if "_exchange" not in known:
        known["_exchange"] = negotiated(V, V.share) if V.share.several else Exchange(V.share.comm)
        check_count(V, known["_exchange"])
    return known["_exchange"]


def check_count(V: CrackFESpace, exchange: Exchange) -> None:
    """Raises RuntimeError unless all φ_i are counted once: of the mesh that processes share NGSolve knows their number."""
    if not exchange.several:
        return
    counted = exchange.Sum(int(exchange.master[Unknowns(V).Polynomial(0)].sum()))
    number = H1(V.share.source, **scalar_flags(V)).ndofglobal
    if counted != number:
        raise RuntimeError(
            f"processes count {counted} functions φ_i, and there are {number}: they do not agree on what they share; please report it with the mesh"
        )


def negotiated(V: CrackFESpace, share: Share) -> Exchange:
    """The Exchange of V, found by keys on which all processes agree."""
    keys, owned = keys_of(V, share)
    dofs = np.flatnonzero(keys[:, 0] >= 0)
    of_all = share.Gather((keys[dofs], owned[dofs]))
    names, place, count = np.unique(np.concatenate([rows for rows, _ in of_all]), axis=0, return_inverse=True, return_counts=True)
    place = np.split(place.ravel(), np.cumsum([len(rows) for rows, _ in of_all])[:-1])
    owners, master = np.zeros(len(names), dtype=int), np.full(len(names), -1)
    for rank in reversed(range(len(of_all))):
        at = place[rank][of_all[rank][1]]
        owners[at] += 1
        master[at] = rank
    both = count > 1
    number = np.cumsum(both) - 1
    mine = place[share.comm.rank]
    here = both[mine]
    shared, of_shared = dofs[here], mine[here]
    is_master = owned.copy()
    is_master[shared] = master[of_shared] == share.comm.rank
    interface = np.flatnonzero((owners[of_shared] > 1) & (keys[shared, 0] != TIP))
    return Exchange(share.comm, shared, number[of_shared], int(both.sum()), is_master, owned, interface)


def keys_of(V: CrackFESpace, share: Share) -> tuple[np.ndarray, np.ndarray]:
    """(keys, owned): of each unknown that others may hold (kind of node, its numbers, function of the node, copy, component), of the others -1; and whether own elements have it."""
    unknowns = Unknowns(V)
    scalar, owned_scalar = np.full((unknowns.functions, 5), -1), np.ones(unknowns.functions, dtype=bool)
    for dof, key, is_own in keys_of_functions(V, share):
        scalar[dof], owned_scalar[dof] = key, is_own
    enriched = unknowns.enriched
    copies = copies_of(enriched)
    rows, owned = [], []
    for functions, copy in ((np.arange(unknowns.functions), np.zeros(unknowns.functions, dtype=int)), (enriched, copies)):
        for component in range(unknowns.components):
            rows.append(np.column_stack([scalar[functions], copy, np.full(len(functions), component)]))
            owned.append(owned_scalar[functions])
    tips = unknowns.tips
    rows.append(np.column_stack([np.full(len(tips), TIP), np.arange(len(tips)), *np.zeros((5, len(tips)), dtype=int)]))
    owned.append(np.full(len(tips), share.comm.rank == share.comm.size - 1))
    nodes = np.array(getattr(V, "front_nodes", ()), dtype=int).reshape(-1, 2)  # vertex, front
    modes = (V.ndof - unknowns.regular.stop - len(tips)) // max(len(nodes), 1)
    vertices, numbers = nodes[:, 0].repeat(modes), np.tile(np.arange(modes), len(nodes))
    rows.append(np.column_stack([np.full(len(vertices), FRONT), share.vertices[vertices], numbers, *np.zeros((4, len(vertices)), dtype=int)]))
    owned.append(own_vertices(share)[vertices])
    return np.concatenate(rows), np.concatenate(owned)


def keys_of_functions(V: CrackFESpace, share: Share) -> Iterator[tuple[int, tuple[int, ...], bool]]:
    """(φ_i, key, whether own elements have it) for those that others may hold."""
    mesh, scalar = share.mesh, V.scalar_space
    corners, own_vertex = element_vertices(mesh), own_vertices(share)
    may = share.interface.copy()
    may[np.unique(corners[share.everywhere])] = True
    nodes: dict[tuple[Any, int], tuple[tuple[int, int], bool]] = {}
    for vertex in np.flatnonzero(may).tolist():
        nodes[VERTEX, vertex] = (int(share.vertices[vertex]), 0), bool(own_vertex[vertex])
    for element in np.flatnonzero(may[corners].sum(axis=1) > 1).tolist() if scalar.ndof > mesh.nv else ():
        own, at = bool(share.own[element]), mesh[ElementId(VOL, element)]
        for edge in at.edges:
            a, b = sorted(int(share.vertices[vertex.nr]) for vertex in mesh[edge].vertices)
            nodes[EDGE, edge.nr] = (a, b), own or nodes.get((EDGE, edge.nr), (None, False))[1]
        if share.everywhere[element]:
            nodes[CELL, element] = (int(share.elements[element]), 0), own
    for (kind, number), (key, own) in nodes.items():
        for k, dof in enumerate(scalar.GetDofNrs(NodeId(kind, number))):
            yield dof, ((VERTEX, EDGE, CELL).index(kind), *key, k, 0), own


def own_vertices(share: Share) -> np.ndarray:
    """(nv,), whether own elements have a vertex."""
    own = np.zeros(share.mesh.nv, dtype=bool)
    own[np.unique(element_vertices(share.mesh)[share.own])] = True
    return own
