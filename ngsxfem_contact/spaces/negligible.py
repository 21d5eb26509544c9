"""Heaviside functions that add nothing to a space but round-off (docs/conditioning.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BitArray

from ..algebra.matrices import csr_view
from .exchange import exchange_of
from .unknowns import Unknowns

if TYPE_CHECKING:
    from ngsolve import BaseMatrix
    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackFESpace

SLIVER = 1e-4  # of the energy of φ_i: only functions with less can be negligible
BOUND = 1e-13  # of the energy of φ_i: what a negligible function adds to the span of the others


def without_negligible(matrix: BaseMatrix, V: CrackFESpace, free: BitArray) -> BitArray:
    """The free unknowns without those of negligible functions, a new BitArray."""
    kept = BitArray(free)
    for dof in negligible_functions(matrix, V, free):
        kept.Clear(int(dof))
    return kept


def negligible_functions(matrix: BaseMatrix, V: CrackFESpace, free: BitArray) -> np.ndarray:
    """Unknowns b_i whose function is a combination of others on the same sliver but for BOUND of the energy of φ_i.

    A Gram-Schmidt elimination in the energy (matrix: an NGSolve matrix on V), from the largest functions to the
    smallest. Without them the energy norm of an answer changes by at most √BOUND |b_i| ‖φ_i‖ for each, and they would
    be pivots of round-off size.
    """
    A, exchange = csr_view(matrix), exchange_of(V)
    energies = exchange.Cumulated(A.diagonal())
    unknowns = Unknowns(V)
    whole, first = energies_of_whole_functions(unknowns, energies), unknowns.heaviside.start
    slivers = first + np.flatnonzero(energies[unknowns.heaviside] < SLIVER * whole)
    slivers = np.array([dof for dof in slivers if free[int(dof)]], dtype=int)
    if len(slivers) == 0:
        return slivers
    slivers = slivers[np.lexsort((exchange.Rank(slivers), -energies[slivers]))]
    adds = added_energies(exchange.Sum(A[slivers][:, slivers]).tocsr(), BOUND * whole[slivers - first])
    return slivers[~adds]


def energies_of_whole_functions(unknowns: Unknowns, energies: np.ndarray) -> np.ndarray:
    """That of φ_i for each unknown b_i, in the order of the unknowns."""
    return np.concatenate([energies[unknowns.Polynomial(component)][unknowns.enriched] for component in range(unknowns.components)])


def added_energies(A: csr_matrix, bounds: np.ndarray) -> np.ndarray:
    """Whether each function adds more than its bound to the span of those before it that do."""
    kept = np.zeros(A.shape[0], dtype=bool)
    ends = A.indptr.tolist()
    rows = [dict(zip(A.indices[a:b].tolist(), A.data[a:b].tolist())) for a, b in zip(ends, ends[1:])]
    for i, row in enumerate(rows):
        before = [j for j in row if kept[j]]
        scale = 1 / np.sqrt([rows[j][j] for j in before])
        block = np.array([[rows[j].get(k, 0.0) for k in before] for j in before]).reshape((len(before),) * 2) * scale[:, None] * scale
        kept[i] = row[i] - projection_energy(block, scale * np.array([row[j] for j in before])) > bounds[i]
    return kept


def projection_energy(block: np.ndarray, coupling: np.ndarray, cutoff: float = 1e-12) -> float:
    """couplingᵀ block⁺ coupling."""
    values, vectors = np.linalg.eigh(block) if len(block) else (np.zeros(0), np.zeros((0, 0)))
    regular = values > cutoff
    return float((((coupling @ vectors[:, regular]) ** 2) / values[regular]).sum())
