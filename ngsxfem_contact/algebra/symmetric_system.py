"""A x = f of a symmetric matrix: its residual, in units that do not count."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..processes import Exchange
from .matrices import csr_view, mask

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import BaseMatrix, BitArray


def unit_scale(diagonal: np.ndarray) -> np.ndarray:
    """1/√|a_ii|, which makes a diagonal of ±1; 1 where it is zero."""
    size = np.sqrt(np.abs(diagonal))
    return 1 / np.where(size > 0, size, 1)


class SymmetricSystem:
    """A on the unknowns that are free.

    Parameters
    ----------
    free
        BitArray of the unknowns that are not fixed.
    exchange
        Of processes that share the unknowns: matrix and right-hand sides are additive then, solutions consistent.
    """

    def __init__(self, matrix: BaseMatrix, free: BitArray, exchange: Exchange = Exchange()) -> None:
        self.matrix, self.exchange, self.fixed = matrix, exchange, ~mask(free)
        self.scale = np.where(self.fixed, 0, unit_scale(exchange.Cumulated(csr_view(matrix).diagonal())))

    def RelativeResidual(self, forces: Sequence[np.ndarray], x: np.ndarray) -> float:
        """Of A x = Σ forces, each row divided by √A_ii, so that no unit counts; relative to the largest of the terms that cancel."""
        terms = [self.scale * self.exchange.Cumulated(force) for force in forces] + [x[~self.fixed] / self.scale[~self.fixed]]
        size = self.exchange.Max(max(np.abs(term).max(initial=0) for term in terms))
        residual = self.exchange.Max(np.abs(self.scale * self.Residual(np.sum(forces, axis=0), x)).max(initial=0))
        return float(residual / size) if size else 0.0

    def Residual(self, rhs: np.ndarray, x: np.ndarray) -> np.ndarray:
        """rhs - A x on the free unknowns, zero on the others."""
        r, y = self.matrix.CreateColVector(), self.matrix.CreateColVector()
        r.FV().NumPy()[:] = x
        y.data = self.matrix * r
        return np.where(self.fixed, 0, self.exchange.Cumulated(rhs - y.FV().NumPy()))
