"""Matrices of scipy as those of NGSolve, and back."""

import numpy as np
import pytest
import scipy

from ngsxfem_contact import _ngsxfem_contact as core
from ngsxfem_contact.algebra.matrices import from_scipy, to_scipy


@pytest.mark.parametrize("kind", ["csr", "csc", "coo"])
def test_there_and_back(kind):
    """Rows that are empty, columns in any order, and entries that are there twice."""
    rng = np.random.default_rng(0)
    row, column = rng.integers(0, 30, 200), rng.integers(0, 17, 200)
    row[row == 7] = 8
    given = scipy.sparse.coo_matrix((rng.standard_normal(200), (row, column)), shape=(30, 17))
    matrix = from_scipy(given.asformat(kind))
    assert (matrix.height, matrix.width) == (30, 17) and np.array_equal(to_scipy(matrix).toarray(), given.toarray())
    turned = from_scipy(given.tocsr()[:, ::-1])
    assert np.array_equal(to_scipy(turned).toarray(), given.toarray()[:, ::-1])


def test_empty():
    assert to_scipy(from_scipy(scipy.sparse.csr_matrix((3, 4)))).nnz == 0


def test_arrays_that_do_not_fit():
    with pytest.raises(Exception, match="do not fit"):
        core.FromCSR([0, 1, 3], [0, 1], [1.0, 2.0], 2)
