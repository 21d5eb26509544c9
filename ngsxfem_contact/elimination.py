"""Elimination of the displacements: what is left are the crack's own unknowns."""

import numpy as np


class StiffnessInverse:
    """The inverse of a symmetric positive definite matrix of NGSolve on the free unknowns."""

    def __init__(self, matrix, free, inverse):
        self.matrix, self.factors = matrix, matrix.Inverse(free, inverse=inverse)
        self.fixed = ~np.array(free, dtype=bool)
        self.x, self.r = matrix.CreateColVector(), matrix.CreateColVector()

    def Solve(self, rhs):
        """The solution for a right-hand side, arrays of length ndof; zero on fixed unknowns."""
        self.r.FV().NumPy()[:] = rhs
        self.x.data = self.factors * self.r
        return self.x.FV().NumPy().copy()

    def SolveRefined(self, rhs):
        """The same with one step of iterative refinement."""
        x = self.Solve(rhs)
        self.r.data -= self.matrix * self.x
        residual = self.r.FV().NumPy().copy()
        residual[self.fixed] = 0
        return x + self.Solve(residual)


def schur_complement(E, inverse):
    """E A⁻¹ Eᵀ, dense (m, m), for a scipy matrix E (m, n); one solve for each row, nothing of size m × n is kept dense."""
    columns = E.T.tocsc()
    S = np.empty((E.shape[0],) * 2)
    for j in range(E.shape[0]):
        S[:, j] = E @ inverse.Solve(columns[:, [j]].toarray().ravel())
    return 0.5 * (S + S.T)
