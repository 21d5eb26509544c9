"""A⁻¹ by conjugate gradients, and an approximation of C A⁻¹Cᵀ that learns from each solve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .conjugate_gradients import ACCURACY
from .elimination import CG, ReducedVector
from .matrices import csr_view
from .symmetric_system import SymmetricSystem
from .two_level import TwoLevel

if TYPE_CHECKING:
    from ngsolve import BaseMatrix, BitArray
    from scipy.sparse import csr_matrix

    from ..processes import Exchange
    from .aggregates import Vertices

KNOWN = 1e-3  # of d·S d: S is known well enough in a direction d in which it lacks less


class ApproximateElimination(SymmetricSystem):
    """A symmetric positive definite matrix A with an approximate inverse, see `TwoLevel`, whose parameters it has.

    Attributes
    ----------
    S
        (k, k), approximately C A⁻¹Cᵀ and at most that; the same on all processes.
    positive
        False where A is seen not to be positive definite, None: not known.
    iterations
        Of conjugate gradients, for each right-hand side.
    """

    name = CG

    def __init__(self, matrix: BaseMatrix, free: BitArray, border: np.ndarray, C: csr_matrix, vertices: Vertices, exchange: Exchange) -> None:
        super().__init__(matrix, free, exchange)
        self.C, self.A = C, csr_view(matrix)
        self.preconditioner = TwoLevel(self.A, ~self.fixed, C, border, vertices, exchange)
        self.S, self.positive = self.preconditioner.S, None if self.preconditioner.positive else False
        self.iterations: list[int] = []

    def Reduce(self, rhs: np.ndarray) -> ReducedVector:
        """The ReducedVector of a right-hand side of length ndof."""
        x = self.Solve(rhs)
        return ReducedVector(rhs, x, self.Felt(x))

    def Recover(self, reduced: ReducedVector, L: np.ndarray) -> np.ndarray:
        """A⁻¹(F + CᵀL) of a ReducedVector."""
        return reduced.partial + self.Solve(self.C.T @ L)

    def Felt(self, x: np.ndarray) -> np.ndarray:
        """C x."""
        return self.exchange.FromFirst(self.exchange.Sum(self.C @ x))

    def Size(self, x: np.ndarray) -> float:
        """In the energy norm."""
        return float(np.sqrt(max(self.exchange.Dot(self.A @ x, x), 0)))

    def Solve(self, rhs: np.ndarray, accuracy: float = ACCURACY, enough: float = 0.0) -> np.ndarray:
        """A⁻¹ rhs of an additive right-hand side: consistent, zero on fixed unknowns.

        Parameters
        ----------
        accuracy
            Of the answer in the energy norm, relative.
        enough
            The same, absolute: whichever is larger counts.

        Raises
        ------
        NotCoercive
            Where A is not positive definite in a direction that is met.
        NotConverged
            After too many steps.
        """
        x, found = self.preconditioner.Begin(rhs)
        energy = self.exchange.Dot(rhs, x)
        reached = lambda: max(accuracy * np.sqrt(max(energy + sum(found.gains), 0)), enough)
        found.Reach(reached, "a direct solver, without inverse=, does not mind")
        self.iterations.append(len(found.gains))
        return self.exchange.Cumulated(self.exchange.Additive(x + found.x))  # to the last bit

    def Learn(self, d: np.ndarray, felt: np.ndarray) -> None:
        """Makes S exact in a direction: felt = C A⁻¹Cᵀ d. The symmetric update of rank one, which keeps S below C A⁻¹Cᵀ, and what it knew of other directions."""
        missing = felt - self.S @ d
        energy = float(d @ missing)
        if energy > KNOWN * float(d @ felt):
            self.S = self.S + np.outer(missing, missing) / energy
