"""What a law of the faces is asked about: nodes with their weights, and what the faces have gone through."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..algebra.compliance import Compliance

if TYPE_CHECKING:
    from ..protocols import Cone, Nodes


@dataclass(frozen=True)
class FaceHistory:
    """What the faces have gone through at n nodes, in values that mean the same on other nodes.

    Parameters
    ----------
    traction
        (k, n), the components of λ, normal first: stresses.
    jump
        (k, n), opening and slip since the body was whole, lengths.
    variables
        What a law remembers beside, (n,) each; FaceLaw.Variables says which.
    """

    traction: np.ndarray
    jump: np.ndarray
    variables: dict[str, np.ndarray] = field(default_factory=dict)

    def Carried(self, old: Nodes, new: Nodes) -> FaceHistory:
        """The same on other nodes, those of another mesh or of longer cracks: interpolated along each arm of a crack, zero on parts that are new.

        Parameters
        ----------
        old
            The nodes of this history.
        new
            Those of cracks with the same numbers.

        Raises
        ------
        ValueError
            If a crack of the old nodes is not part of the one with its number.
        """
        check_continued(old, new)
        P = between_nodes(old, new).T
        return FaceHistory(self.traction @ P, self.jump @ P, {name: values @ P for name, values in self.variables.items()})


def check_continued(old: Nodes, new: Nodes) -> None:
    """Raises ValueError unless each old node lies on the crack of its number, to an interval between nodes; in space there are none."""
    if old.positions.shape[1] == 3:
        raise ValueError("a history in space stays on its spaces: give previous= a solution of the same V and W")
    for crack in np.unique(old.cracks):
        there, before, now = old.positions[old.cracks == crack], intervals(old, crack), intervals(new, crack)
        if not len(now):
            raise ValueError(f"the history of crack {crack} has no place: there is none of that number now; give all cracks in the order in which they were")
        a, b = new.positions[now.T]
        feet = nearest_on(there, a, b)
        off = np.linalg.norm(to_feet(there, a[feet], b[feet])[1], axis=1)
        if off.max() > max(longest(old, before), longest(new, now)):
            place = ", ".join(f"{value:.6g}" for value in there[int(np.argmax(off))])
            raise ValueError(f"the history of crack {crack} at ({place}) is not on that crack now; each may be longer than it was, but not another one")


def longest(nodes: Nodes, pairs: np.ndarray) -> float:
    """Of intervals; of nodes alone their weight."""
    return float(max(np.linalg.norm(nodes.positions[pairs[:, 1]] - nodes.positions[pairs[:, 0]], axis=1).max(), nodes.weights[pairs].max()))


def between_nodes(old: Nodes, new: Nodes) -> np.ndarray:
    """(len(new), len(old)): linear interpolation between neighbours on the same arm of a crack; rows of zeros beyond the last node by more than half an interval, and than its weight.

    Where arms meet each has a node at the same place: a new one belongs to the arm on which its neighbours are.
    """
    P, inward = np.zeros((len(new), len(old))), directions_inward(new)
    for crack in np.unique(new.cracks):
        pairs, here = intervals(old, crack), np.flatnonzero(new.cracks == crack)
        if not len(pairs):
            continue  # a crack that has started
        a, b = old.positions[pairs.T]
        feet = nearest_on(new.positions[here] + 1e-3 * inward[here], a, b)
        part, ways = to_feet(new.positions[here], a[feet], b[feet])
        near = np.linalg.norm(ways, axis=1) <= 1.0001 * np.maximum(
            0.5 * np.linalg.norm((b - a)[feet], axis=1), old.weights[pairs[feet, (part > 0.5).astype(int)]]
        )
        for end, share in ((0, 1 - part), (1, part)):
            np.add.at(P, (here[near], pairs[feet[near], end]), share[near])
    return P


def intervals(nodes: Nodes, crack: int) -> np.ndarray:
    """(k, 2): the numbers of neighbours on a crack; a node without one is an interval of no length."""
    on = np.flatnonzero(nodes.cracks == crack)
    alone = np.setdiff1d(on, nodes.neighbours)
    return np.concatenate([nodes.neighbours[nodes.cracks[nodes.neighbours[:, 0]] == crack], np.column_stack([alone, alone])]).astype(int)


def to_feet(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,), how much of the intervals from a to b is before the foot of each point, from 0 to 1, and (n, dimension), the way to it; (n, dimension) each, or one point."""
    part = np.clip(((points - a) * (b - a)).sum(axis=1) / np.maximum(((b - a) ** 2).sum(axis=1), np.finfo(float).tiny), 0, 1)
    return part, a + part[:, None] * (b - a) - points


def nearest_on(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n,): which of the intervals from a to b, (k, dimension) each, is the nearest to each of the points."""
    return np.array([int(np.argmin((to_feet(point, a, b)[1] ** 2).sum(axis=1))) for point in points], dtype=int)


def directions_inward(nodes: Nodes) -> np.ndarray:
    """(n, dimension): of each node the sum of the ways to its neighbours; at the end of an arm it points into the arm."""
    ways, (a, b) = np.zeros_like(nodes.positions), nodes.neighbours.T
    np.add.at(ways, a, nodes.positions[b] - nodes.positions[a])
    np.add.at(ways, b, nodes.positions[a] - nodes.positions[b])
    return ways


@dataclass(frozen=True)
class FaceWork:
    """Energies of the faces for each unit of thickness, stress × length².

    Attributes
    ----------
    dissipated
        In this load step.
    error
        How far that may be off.
    stored
        What the faces would give back.
    """

    dissipated: float = 0.0
    error: float = 0.0
    stored: float = 0.0


@dataclass(frozen=True)
class Scales:
    """What tractions p and weighted jumps w, (k n,) or a number, are compared with."""

    traction: float
    moments: np.ndarray


@dataclass(frozen=True)
class Faces:
    """The nodes of the faces, and the cone that says what p and w = Q p + q mean there.

    Parameters
    ----------
    compliance
        Q; empty, as `own`, where the displacements are not eliminated.
    own
        (k n,), what the traction at a node moves itself: the diagonal of Q, whatever parts of the body only the faces hold.
    history
        Their FaceHistory; None: nothing has happened.
    motions
        (k n, r): the w of rigid motions that only the faces hold; w = Q p + q + motions α then.
    pull
        (r,): the work of the load on them, which motionsᵀ p balances.

    Notes
    -----
    p and w hold all components one after the other; p·w is minus the work of the tractions, Σ m t·g over nodes with weights m.
    """

    nodes: Nodes
    cone: Cone
    compliance: Compliance = field(default_factory=lambda: Compliance(np.zeros((0, 0))))
    own: np.ndarray = field(default_factory=lambda: np.zeros(0))
    history: FaceHistory | None = None
    motions: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    pull: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def traction_weights(self) -> np.ndarray:
        """(n,): p of the traction 1."""
        return self.cone.Values(self.nodes, np.ones(len(self.nodes)))

    @cached_property
    def jump_weights(self) -> np.ndarray:
        """(n,): -w of the jump 1."""
        return self.nodes.weights / self.traction_weights

    @cached_property
    def stiffness(self) -> np.ndarray:
        """(k, n), stress / length: what the body opposes to a jump at one node alone."""
        return self.jump_weights / (self._by_component(self.own) * self.traction_weights)

    def Tractions(self, p: np.ndarray) -> np.ndarray:
        """(k, n) stresses."""
        return self._by_component(p) / self.traction_weights

    def Jumps(self, w: np.ndarray) -> np.ndarray:
        """(k, n) lengths: means of opening and slip."""
        return -self._by_component(w) / self.jump_weights

    def _by_component(self, values: np.ndarray) -> np.ndarray:
        """(k, n)."""
        return values.reshape(len(values) // max(len(self.nodes), 1), len(self.nodes))

    def After(self, p: np.ndarray, w: np.ndarray, variables: dict[str, np.ndarray]) -> FaceHistory:
        """The FaceHistory that ends with p and w."""
        return FaceHistory(self.Tractions(p), self.Jumps(w), variables)
