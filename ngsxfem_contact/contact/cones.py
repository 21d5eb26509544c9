"""The closed convex cones of multipliers: (9), (10), (11) of [AHLMR12], as changes of variables.

Each cone is {L = T p, p ≤ 0}: the condition L ∈ M⁻, (L' - L)ᵀ r ≥ 0 for all L' ∈ M⁻ becomes p ≤ 0, Tᵀr ≤ 0,
p·Tᵀr = 0 for each component, which one active-set method solves for all cones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..protocols import Cone

if TYPE_CHECKING:
    from ..protocols import Nodes


@dataclass(frozen=True)
class Nonpositive:
    """M₀⁻ (9) and M₁⁻ (10): λ ≤ 0 at every node."""

    def Transformation(self, nodes: Nodes) -> np.ndarray:
        """T, dense; p are the nodal values."""
        return nodes.functions

    def Values(self, nodes: Nodes, nodal: np.ndarray) -> np.ndarray:
        """The p of a function with the given nodal values."""
        return nodal


@dataclass(frozen=True)
class Weak:
    """M₁*⁻ (11): ∫λψ ≥ 0 for all ψ in M₁⁻, that is p = ∫λψ_i ≤ 0 for the nodal functions ψ_i."""

    def Transformation(self, nodes: Nodes) -> np.ndarray:
        """T: from moments to nodal values, from these to coefficients."""
        return nodes.functions @ np.linalg.inv(nodes.mass)

    def Values(self, nodes: Nodes, nodal: np.ndarray) -> np.ndarray:
        """The p of a function with the given nodal values: its moments ∫ f ψ_i."""
        return nodes.mass @ nodal


CONES: dict[str, Cone] = {"nonpositive": Nonpositive(), "weak": Weak()}
