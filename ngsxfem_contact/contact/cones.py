"""The closed convex cones of multipliers: (9), (10), (11) of [AHLMR12], as changes of variables.

Each cone is {L = T p, p ≤ 0}: the condition L ∈ M⁻, (L' - L)ᵀ r ≥ 0 for all L' ∈ M⁻ becomes p ≤ 0, Tᵀr ≤ 0,
p·Tᵀr = 0 for each component, which one active-set method solves for all cones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..protocols import Cone
from ..spaces.trace_space import mass_matrix

if TYPE_CHECKING:
    from ..protocols import Nodes


@dataclass(frozen=True)
class Nonpositive:
    """M₀⁻ (9) and M₁⁻ (10): λ ≤ 0 at every node."""

    def Transformation(self, W: Nodes) -> np.ndarray:
        """T, dense; p are the nodal values."""
        values = W.NodalValues()
        return np.eye(W.ndof) if values is None else np.linalg.inv(values)

    def Values(self, W: Nodes, nodal: np.ndarray) -> np.ndarray:
        """The p of a function with the given nodal values."""
        return nodal


@dataclass(frozen=True)
class Weak:
    """M₁*⁻ (11): ∫λψ ≥ 0 for all ψ in M₁⁻, that is p = ∫λψ_i ≤ 0 for the nodal functions ψ_i."""

    def Transformation(self, W: Any) -> np.ndarray:
        """T = M⁻¹ for nodal functions; with N their values at the nodes, (N⁻ᵀM)⁻¹ for others."""
        values = W.NodalValues()
        mass = mass_matrix(W).toarray()
        if values is not None:
            mass = np.linalg.solve(values.T, mass)
        return np.linalg.inv(mass)

    def Values(self, W: Any, nodal: np.ndarray) -> np.ndarray:
        """The p of a function with the given nodal values: its moments ∫ f ψ_i."""
        values = W.NodalValues()
        coefficients = nodal if values is None else np.linalg.solve(values, nodal)
        return np.linalg.solve(self.Transformation(W), coefficients)


CONES: dict[str, Cone] = {"nonpositive": Nonpositive(), "weak": Weak()}
