"""Elimination of the displacements: what is left are the crack's own unknowns."""

import numpy as np
from ngsolve import BitArray


class StiffnessInverse:
    """The inverse of a symmetric positive definite matrix on a CrackFESpace, on the free unknowns.

    The rows of tip functions are as long as their disk is large and would ruin the ordering of a sparse factorisation:
    they stay outside of it, as a border, eliminated by block elimination.
    """

    def __init__(self, matrix, V, free, inverse="sparsecholesky"):
        self.matrix = matrix
        self.x, self.r = matrix.CreateColVector(), matrix.CreateColVector()
        self.border = np.array([dof for tip in range(len(V.body.tips)) for dof in V.TipDofs(tip) if free[dof]], dtype=int)
        inner = BitArray(free)
        for dof in self.border:
            inner.Clear(int(dof))
        self.factors = matrix.Inverse(inner, inverse=inverse)
        self.fixed = ~np.array(free, dtype=bool)
        self._eliminate_border()

    def _eliminate_border(self):
        shape = (len(self.border), len(self.r))
        self.columns = np.array([self._multiply(self._unit(dof)) for dof in self.border]).reshape(shape)
        self.inner_solutions = np.array([self._solve_inner(column) for column in self.columns]).reshape(shape)
        self.border_matrix = self.columns[:, self.border] - self.columns @ self.inner_solutions.T

    def _unit(self, dof):
        unit = np.zeros(len(self.r))
        unit[dof] = 1
        return unit

    def _multiply(self, array):
        self.r.FV().NumPy()[:] = array
        self.x.data = self.matrix * self.r
        return self.x.FV().NumPy().copy()

    def _solve_inner(self, rhs):
        self.r.FV().NumPy()[:] = rhs
        self.x.data = self.factors * self.r
        return self.x.FV().NumPy().copy()

    def Solve(self, rhs):
        """The solution for a right-hand side, arrays of length ndof; zero on fixed unknowns."""
        x = self._solve_inner(rhs)
        if len(self.border):
            at_border = np.linalg.solve(self.border_matrix, rhs[self.border] - self.columns @ x)
            x -= at_border @ self.inner_solutions
            x[self.border] = at_border
        return x

    def SolveRefined(self, rhs):
        """The same with one step of iterative refinement."""
        x = self.Solve(rhs)
        residual = np.where(self.fixed, 0, rhs - self._multiply(x))
        return x + self.Solve(residual)


def schur_complement(E, inverse):
    """E A⁻¹ Eᵀ, dense (m, m), for a scipy matrix E (m, n); one solve for each row, nothing of size m × n is kept dense."""
    columns = E.T.tocsc()
    S = np.empty((E.shape[0],) * 2)
    for j in range(E.shape[0]):
        S[:, j] = E @ inverse.Solve(columns[:, [j]].toarray().ravel())
    return 0.5 * (S + S.T)
