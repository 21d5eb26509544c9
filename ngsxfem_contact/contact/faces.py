"""What a law of the faces is asked about: nodes with their weights, and what the faces have gone through."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..algebra.compliance import Compliance
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
        """The same on other nodes, those of another mesh or of longer cracks: interpolated along each crack, zero on parts that are new.

        Parameters
        ----------
        old
            The nodes of this history.
        new
            Those of cracks with the same numbers.
        """
        P = between_nodes(old, new).T
        return FaceHistory(self.traction @ P, self.jump @ P, {name: values @ P for name, values in self.variables.items()})


def between_nodes(old: Nodes, new: Nodes) -> np.ndarray:
    """(len(new), len(old)): linear interpolation between neighbours on the same crack; rows of zeros beyond half an interval after the last node."""
    P = np.zeros((len(new), len(old)))
    a, b = old.neighbours.T
    edges = old.positions[b] - old.positions[a]
    for i, (crack, point) in enumerate(zip(new.cracks, new.positions)):
        here = np.flatnonzero(old.cracks[a] == crack)
        if not len(here):
            P[i, np.flatnonzero(old.cracks == crack)] = 1  # a crack with one node
            continue
        lengths = (edges[here] ** 2).sum(axis=1)
        part = np.clip(((point - old.positions[a[here]]) * edges[here]).sum(axis=1) / lengths, 0, 1)
        distances = ((old.positions[a[here]] + part[:, None] * edges[here] - point) ** 2).sum(axis=1)
        nearest = int(np.argmin(distances))
        if distances[nearest] <= 0.2501 * lengths[nearest]:
            P[i, a[here[nearest]]], P[i, b[here[nearest]]] = 1 - part[nearest], part[nearest]
    return P


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
        Q.
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
    compliance: Compliance
    own: np.ndarray
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
        return self.jump_weights / (self.own.reshape(-1, len(self.nodes)) * self.traction_weights)

    def Tractions(self, p: np.ndarray) -> np.ndarray:
        """(k, n) stresses."""
        return p.reshape(-1, len(self.nodes)) / self.traction_weights

    def Jumps(self, w: np.ndarray) -> np.ndarray:
        """(k, n) lengths: means of opening and slip."""
        return -w.reshape(-1, len(self.nodes)) / self.jump_weights

    def After(self, p: np.ndarray, w: np.ndarray, variables: dict[str, np.ndarray]) -> FaceHistory:
        """The FaceHistory that ends with p and w."""
        return FaceHistory(self.Tractions(p), self.Jumps(w), variables)
