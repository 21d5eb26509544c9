"""Vectors and matrices of NGSolve as those of numpy and scipy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CreateVVector, Projector

from .. import _ngsxfem_contact as core

if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from ngsolve import BaseMatrix, BilinearForm, BitArray
    from scipy.sparse import csc_matrix, csr_matrix

    Matrix: TypeAlias = "np.ndarray | csr_matrix"


def mask(bits: BitArray) -> np.ndarray:
    """A BitArray as a boolean array; by iteration it takes a third of a second for a million."""
    ones, selected = CreateVVector(len(bits)), CreateVVector(len(bits))
    ones[:] = 1
    selected.data = Projector(bits, True) * ones
    return selected.FV().NumPy() != 0


def to_scipy(matrix: BaseMatrix) -> csr_matrix:
    """A matrix of NGSolve as a scipy matrix in CSR format."""
    values, columns, rows = matrix.CSR()
    return scipy.sparse.csr_matrix((np.array(values), np.array(columns), np.array(rows)), shape=(matrix.height, matrix.width))


def from_scipy(matrix: Any) -> BaseMatrix:
    """A sparse scipy matrix as one of NGSolve."""
    matrix = matrix.tocsr()
    matrix.sum_duplicates()  # and columns in ascending order
    return core.FromCSR(matrix.indptr, matrix.indices, matrix.data, matrix.shape[1])


def csr_view(matrix: BaseMatrix) -> csr_matrix:
    """The same without a copy: valid as long as the matrix is."""
    values, columns, rows = (np.asarray(part) for part in matrix.CSR())
    return scipy.sparse.csr_matrix((values, columns, rows), shape=(matrix.height, matrix.width), copy=False)


def is_identity(B: Matrix) -> bool:
    """Of a sparse matrix; False for a dense one."""
    return not isinstance(B, np.ndarray) and B.shape[0] == B.shape[1] == B.nnz and bool((B.tocsr().indices == np.arange(B.nnz)).all() and (B.data == 1).all())


def product(A: np.ndarray, B: Matrix) -> np.ndarray:
    """A B of a dense and any matrix; the identity costs nothing."""
    return A if is_identity(B) else A @ B


def added(A: np.ndarray, B: csr_matrix) -> np.ndarray:
    """A + B, dense."""
    A, B = A.copy(), B.tocoo()
    np.add.at(A, (B.row, B.col), B.data)
    return A


def congruent(T: Matrix, S: np.ndarray) -> np.ndarray:
    """Tᵀ S T."""
    return S if is_identity(T) else T.T @ (S @ T)


def assembled(form: BilinearForm, elements: np.ndarray) -> csr_matrix:
    """A scipy matrix in CSR format of the volume integrals of a bilinear form, which is not assembled, over some elements: without a loop over the others."""
    values, rows, columns = core.ElementMatrices(form, elements)
    rows, columns = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    regular = (rows >= 0) & (columns >= 0)
    return scipy.sparse.csr_matrix((values[regular], (rows[regular], columns[regular])), shape=(form.testspace.ndof, form.space.ndof))


def add_to(matrix: BaseMatrix, other: csc_matrix | csr_matrix) -> None:
    """Adds a scipy matrix with a smaller pattern to a matrix of NGSolve."""
    pattern, other = to_scipy(matrix), other.tocoo()
    width = np.int64(matrix.width)
    keys = np.repeat(np.arange(matrix.height, dtype=np.int64), np.diff(pattern.indptr)) * width + pattern.indices
    places = np.searchsorted(keys, other.row * width + other.col)
    np.add.at(matrix.AsVector().FV().NumPy(), places, other.data)
