"""A + EᵀH E, the condensed form of a contact problem: a direct solver around the cracks, conjugate gradients with multigrid in the rest of the body.

Section 19 of docs/method.md. Of the unknowns C are those around the cracks, all that a row of E has among them, and o the others, which belong to functions of the
uncracked body. C is eliminated, for each H by a sparse factorisation of its block M, so that conjugate gradients see

    A_oo - A_oC M⁻¹ A_Co    on o,

preconditioned by the multigrid of the uncracked body, A on o and on its functions around the cracks. That is a symmetric multiplicative Schwarz method of two
subspaces, which share these functions. With one process vectors are what they are; of several processes right-hand sides and residuals would be additive, solutions and directions consistent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from .. import _ngsxfem_contact as core
from .matrices import from_scipy
from .multigrid import Multigrid

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class SparseFactors:
    """A⁻¹ of a scipy matrix, symmetric and sparse, by NGSolve's sparse Cholesky.

    Attributes
    ----------
    positive
        Whether A is positive definite.
    """

    def __init__(self, A: csr_matrix) -> None:
        self.positive, self.size = True, A.shape[0]
        if not self.size:
            return
        matrix = from_scipy(A)
        self.factors = matrix.Inverse(inverse="sparsecholesky")
        self.x, self.r = matrix.CreateColVector(), matrix.CreateColVector()
        self.positive = core.NumNegativePivots(self.factors) == 0

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
        """A⁻¹ rhs."""
        if not self.size:
            return rhs
        self.r.FV().NumPy()[:] = rhs
        self.x.data = self.factors * self.r
        return self.x.FV().NumPy().copy()


class CondensedMatrix:
    """A + EᵀH E for several H.

    Parameters
    ----------
    A
        (n, n), scipy, symmetric.
    free
        (n,) bool, the unknowns that are not fixed.
    E
        (m, n).
    nodes
        (k, 3): of each function of the uncracked body the unknowns of its three components.
    near_kernel
        (k_1, 3, 6): the rigid motions at the first k_1 of them, the functions of order 1.
    """

    def __init__(self, A: csr_matrix, free: np.ndarray, E: csr_matrix, nodes: np.ndarray, near_kernel: np.ndarray) -> None:
        self.A = A
        around = np.ones(A.shape[0], dtype=bool)
        around[nodes.ravel()] = False
        of_faces = np.zeros(A.shape[0], dtype=bool)
        of_faces[E.indices] = True
        beside = A[around & free & ~of_faces].indices  # of functions of the cracks that reach beyond the elements of E, as modes of a whole radius do
        around[beside] = True
        around |= of_faces
        self.crack = np.flatnonzero(around & free)
        whole = free[nodes].any(axis=1)  # nodes without a free component are left out
        self.body, held = nodes[whole].ravel(), ~free[nodes[whole]].ravel()
        self.outside = ~held & ~around[self.body]
        of_body = A[self.body][:, self.body]
        kernel = near_kernel[whole[: len(near_kernel)]].reshape(-1, 6)
        self.multigrid = Multigrid(unit_rows(of_body, held), np.where(held[: len(kernel), None], 0, kernel))
        self.block = A[self.crack][:, self.crack]
        self.coupling = A[self.crack][:, self.body].multiply(self.outside[None, :]).tocsr()
        self.coupling.eliminate_zeros()
        self.transposed = self.coupling.T.tocsr()
        self.E_crack = E[:, self.crack].tocsc()

    def Set(self, H: csr_matrix) -> None:
        """H, (m, m), symmetric and positive semi-definite."""
        self.factors = SparseFactors(self.block + self.E_crack.T @ (H @ self.E_crack))

    @property
    def positive(self) -> bool:
        """Whether the block around the cracks is positive definite."""
        return self.factors.positive

    def Condense(self, rhs: np.ndarray) -> np.ndarray:
        """What of a right-hand side is left on o when C is eliminated; in the order of the multigrid, zero on its other unknowns."""
        return np.where(self.outside, rhs[self.body] - self.transposed @ self.factors.Solve(rhs[self.crack]), 0)

    def Extend(self, x: np.ndarray, rhs: np.ndarray) -> np.ndarray:
        """(n,): x on o, and what follows on C."""
        whole = np.zeros(len(rhs))
        whole[self.body[self.outside]] = x[self.outside]
        whole[self.crack] = self.factors.Solve(rhs[self.crack] - self.coupling @ x)
        return whole

    def Apply(self, x: np.ndarray) -> np.ndarray:
        """(A_oo - A_oC M⁻¹ A_Co) x."""
        y = self.multigrid.A @ x
        return np.where(self.outside, y - self.transposed @ self.factors.Solve(self.coupling @ x), 0)

    def Precondition(self, r: np.ndarray) -> np.ndarray:
        """The multigrid on o."""
        return np.where(self.outside, self.multigrid.Apply(r), 0)


def unit_rows(A: csr_matrix, held: np.ndarray) -> csr_matrix:
    """A with rows and columns of a diagonal matrix, of the size of A's diagonal, in place of those that are held."""
    if not held.any():
        return A
    keep = scipy.sparse.diags(np.where(held, 0.0, 1.0))
    return (keep @ A @ keep + scipy.sparse.diags(np.where(held, A.diagonal(), 0))).tocsr()
