"""Elimination of the displacements: what is left are the crack's own unknowns."""

import numpy as np


class StiffnessInverse:
    """The inverse of a symmetric positive definite matrix of NGSolve on the free unknowns, with iterative refinement."""

    def __init__(self, matrix, free, inverse):
        self.matrix, self.factors = matrix, matrix.Inverse(free, inverse=inverse)
        self.fixed = ~np.array(free, dtype=bool)
        self.x, self.y, self.r = (matrix.CreateColVector() for _ in range(3))

    def Solve(self, rhs):
        """The solution for a right-hand side, arrays of length ndof; zero on fixed unknowns."""
        self.r.FV().NumPy()[:] = rhs
        self.x.data = self.factors * self.r
        self.r.data -= self.matrix * self.x
        self.r.FV().NumPy()[self.fixed] = 0
        self.y.data = self.factors * self.r
        return self.x.FV().NumPy() + self.y.FV().NumPy()


def schur_complement(E, inverse):
    """E A⁻¹ Eᵀ, dense (m, m), for a scipy matrix E (m, n); one solve for each row, nothing of size m × n is kept dense."""
    columns = E.T.tocsc()
    S = np.empty((E.shape[0],) * 2)
    for j in range(E.shape[0]):
        S[:, j] = E @ inverse.Solve(columns[:, [j]].toarray().ravel())
    return 0.5 * (S + S.T)
