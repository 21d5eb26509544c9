"""What a law of the faces is asked about: nodes with their weights, and what the faces have gone through."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..protocols import Cone, Nodes


@dataclass(frozen=True)
class FaceHistory:
    """What the faces have gone through at n nodes, in values that mean the same on other nodes.

    Attributes
    ----------
    traction
        (k, n), the components of λ: stresses.
    jump
        (k, n), opening and slip since the body was whole, lengths.
    variables
        What a law remembers beside, (n,) each; FaceLaw.Variables says which.
    """

    traction: np.ndarray
    jump: np.ndarray
    variables: dict[str, np.ndarray] = field(default_factory=dict)


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
        (k n,), the diagonal of Q.
    history
        Their FaceHistory; None: nothing has happened.

    Notes
    -----
    p and w hold all components one after the other; p·w is minus the work of the tractions, Σ m t·g over nodes with weights m.
    """

    nodes: Nodes
    cone: Cone
    compliance: np.ndarray
    history: FaceHistory | None = None

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
        return self.jump_weights / (self.compliance.reshape(-1, len(self.nodes)) * self.traction_weights)

    def Tractions(self, p: np.ndarray) -> np.ndarray:
        """(k, n) stresses."""
        return p.reshape(-1, len(self.nodes)) / self.traction_weights

    def Jumps(self, w: np.ndarray) -> np.ndarray:
        """(k, n) lengths: means of opening and slip."""
        return -w.reshape(-1, len(self.nodes)) / self.jump_weights

    def After(self, p: np.ndarray, w: np.ndarray, variables: dict[str, np.ndarray]) -> FaceHistory:
        """The FaceHistory that ends with p and w."""
        return FaceHistory(self.Tractions(p), self.Jumps(w), variables)
