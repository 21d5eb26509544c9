"""Vectors and matrices of NGSolve as those of numpy and scipy."""

import numpy as np
from ngsolve import CreateVVector, Projector
from scipy.sparse import csr_matrix

from .. import _ngsxfem_contact as core


def mask(bits):
    """A BitArray as a boolean array; by iteration it takes a third of a second for a million."""
    ones, selected = CreateVVector(len(bits)), CreateVVector(len(bits))
    ones[:] = 1
    selected.data = Projector(bits, True) * ones
    return selected.FV().NumPy() != 0


def to_scipy(matrix):
    """A matrix of NGSolve as a scipy matrix in CSR format."""
    values, columns, rows = matrix.CSR()
    return csr_matrix((np.array(values), np.array(columns), np.array(rows)), shape=(matrix.height, matrix.width))


def csr_view(matrix):
    """The same without a copy: valid as long as the matrix is."""
    values, columns, rows = (np.asarray(part) for part in matrix.CSR())
    return csr_matrix((values, columns, rows), shape=(matrix.height, matrix.width), copy=False)


def assembled(form, elements):
    """A scipy matrix in CSR format of the volume integrals of a bilinear form, which is not assembled, over some elements: without a loop over the others."""
    values, rows, columns = core.ElementMatrices(form, elements)
    rows, columns = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    regular = (rows >= 0) & (columns >= 0)
    return csr_matrix((values[regular], (rows[regular], columns[regular])), shape=(form.testspace.ndof, form.space.ndof))


def add_to(matrix, other):
    """Adds a scipy matrix with a smaller pattern to a matrix of NGSolve."""
    pattern, other = to_scipy(matrix), other.tocoo()
    width = np.int64(matrix.width)
    keys = np.repeat(np.arange(matrix.height, dtype=np.int64), np.diff(pattern.indptr)) * width + pattern.indices
    places = np.searchsorted(keys, other.row * width + other.col)
    np.add.at(matrix.AsVector().FV().NumPy(), places, other.data)
