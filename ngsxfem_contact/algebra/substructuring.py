"""A⁻¹ and K A⁻¹Kᵀ of a matrix of which each process has an additive part, by substructuring.

Each process eliminates the unknowns that it shares with nobody by NGSolve's sparse Cholesky. What is left on the interface between processes is a dense
matrix, the sum of all, which every process factorises: of n_Γ unknowns on the interface 8 n_Γ² bytes and n_Γ³/3 operations on each.
"""

from __future__ import annotations

import os
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import BitArray

from .. import _ngsxfem_contact as core
from .matrices import csr_view, mask

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from scipy.sparse import csc_matrix

    from ..processes import Exchange


def check_memory(size: int) -> None:
    """Raises MemoryError where three dense matrices of a size, which are there at once, are more than the machine has."""
    needed, there = 3 * 8 * size**2, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        raise MemoryError(
            f"substructuring: {size} unknowns between processes and of the crack are a dense matrix, which needs {needed / 1e9:.0f} GB on each process, and this "
            f"machine has {there / 1e9:.0f} GB for all: take fewer processes, or a coarser mesh"
        )


class Substructuring:
    """A DirectSolver on the unknowns of a BitArray; matrix and K (CSC) are the additive parts of this process.

    Parameters
    ----------
    exchange
        How processes share the unknowns of A; with a single one there is no interface.

    Attributes
    ----------
    schur
        K A⁻¹Kᵀ, dense, on all processes.
    positive
        Whether A is positive definite.

    Raises
    ------
    MemoryError
        Where the dense matrix does not fit into the memory of the machine.
    """

    name = "substructuring"

    def __init__(self, matrix: BaseMatrix, inner: BitArray, K: csc_matrix, exchange: Exchange) -> None:
        self.exchange, self.n, self.K = exchange, matrix.height, K.tocsr()
        chosen = mask(inner)
        position = exchange.interface[chosen[exchange.shared[exchange.interface]]]
        self.interface = exchange.shared[position]
        on_interface = np.unique(np.concatenate(exchange.Gather(exchange.numbers[position])))
        self.place, self.size = np.searchsorted(on_interface, exchange.numbers[position]), len(on_interface)
        own = chosen & (exchange.owned if exchange.several else True)
        own[self.interface] = False
        self.own = np.flatnonzero(own)
        self.rows = scipy.sparse.vstack([csr_view(matrix)[self.interface], self.K]).tocsr()
        self.x, self.r = matrix.CreateColVector(), matrix.CreateColVector()
        self.factors = matrix.Inverse(BitArray(own.tolist()), inverse="sparsecholesky") if len(self.own) else None
        self._eliminate_interface(csr_view(matrix))

    def _eliminate_interface(self, A: scipy.sparse.csr_matrix) -> None:
        """What is left of A and of K on the interface, and of both on K."""
        g, k = len(self.interface), self.K.shape[0]
        check_memory(self.size + k)
        own = np.zeros((g + k, g + k))
        if self.factors is not None:
            rows = self.rows.tocsc()
            own = core.SchurComplement(self.factors, g + k, rows.indptr, rows.indices, rows.data)
        whole = np.zeros((self.size + k, self.size + k))
        at = np.concatenate([self.place, self.size + np.arange(k)])
        own[:g, :g] -= A[self.interface][:, self.interface].toarray()
        border = self.K[:, self.interface].toarray()
        own[g:, :g] -= border
        own[:g, g:] -= border.T
        whole[np.ix_(at, at)] = own
        whole = self.exchange.Sum(whole)
        self.H = -whole[self.size :, : self.size]
        negative = 0 if self.factors is None else core.NumNegativePivots(self.factors)
        self.positive = not any(self.exchange.Gather(negative))
        of_interface = -whole[: self.size, : self.size]
        try:
            self.solve = partial(scipy.linalg.cho_solve, scipy.linalg.cho_factor(of_interface)) if self.size else lambda forces: forces
        except np.linalg.LinAlgError:
            self.positive, self.solve = False, partial(scipy.linalg.lu_solve, scipy.linalg.lu_factor(of_interface))
        self.schur = whole[self.size :, self.size :] + self.H @ self.solve(self.H.T)

    def _of_own(self, rhs: np.ndarray) -> np.ndarray:
        """The inverse on own unknowns."""
        if self.factors is None:
            return np.zeros(self.n)
        self.r.FV().NumPy()[:] = rhs
        self.x.data = self.factors * self.r
        return self.x.FV().NumPy().copy()

    def _condensed(self, rhs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(values on own unknowns with nothing on the interface, forces that are left there, what K feels of the former)."""
        x = self._of_own(rhs)
        g, felt = len(self.interface), self.rows @ x
        whole = np.zeros(self.size + self.K.shape[0])
        whole[self.place] = rhs[self.interface] - felt[:g]
        whole[self.size :] = felt[g:]
        whole = self.exchange.Sum(whole)
        return x, whole[: self.size], whole[self.size :]

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
        """A⁻¹ rhs of an additive right-hand side: consistent, zero where an unknown is not in the factorisation."""
        x, forces, _ = self._condensed(rhs)
        values = self.solve(forces)[self.place]
        x -= self._of_own(self.rows[: len(values)].T @ values)
        x[self.interface] = values
        return self.exchange.Cumulated(self.exchange.Additive(x))

    def Couple(self, rhs: np.ndarray) -> np.ndarray:
        """K A⁻¹ rhs of an additive right-hand side."""
        _, forces, felt = self._condensed(rhs)
        return felt + self.H @ self.solve(forces)
