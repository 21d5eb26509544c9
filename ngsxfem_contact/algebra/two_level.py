"""An approximate inverse of the stiffness of a cracked body in the plane, for one process or several (docs/method.md, section 20).

A direct solver on a subspace X: all functions around the cracks, aggregates of vertices times rigid motions elsewhere, and the tips' functions less what
polynomials approximate of them. For all the rest a polynomial of D⁻¹A, D the diagonal, which needs products with A only: it is the same however many processes
hold A. Vectors are *consistent* or *additive* as in `processes.Exchange`; the subspace is solved for by the first process, which has no elements of its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import BitArray

from .aggregates import tentative
from .conjugate_gradients import ConjugateGradients
from .elimination import Elimination
from .matrices import from_scipy

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ..processes import Exchange
    from .aggregates import Vertices

LAYERS = 2  # of functions around those of the cracks, which are solved directly
DEGREE, RATIO = 4, 20.0  # of the polynomial, and of the eigenvalues that it is small for
TIP_ACCURACY = 0.1  # of what a tip's function is without the polynomials that approximate it, in the energy norm
LANCZOS = 20  # steps, which find most of the largest eigenvalue
SAFETY = 1.1  # on it: beyond 1 + 1/RATIO of what is taken for it the polynomial is not positive
EXHAUSTED = 1e-20  # of r·D⁻¹r: there is nothing left
DAMPING = 4 / 3  # of the step of Jacobi's method, over the largest eigenvalue


class Chebyshev:
    """The polynomial p of a degree for which 1 - x p(x) is smallest on the upper eigenvalues of D⁻¹A, from λ/RATIO to λ; A (n, n) additive, on unknowns on: (n,) bool."""

    def __init__(self, A: csr_matrix, on: np.ndarray, exchange: Exchange) -> None:
        self.A, self.exchange = A, exchange
        diagonal = exchange.Cumulated(A.diagonal())
        self.D_inverse = np.divide(1, diagonal, out=np.zeros(len(diagonal)), where=on & (diagonal > 0))
        self.largest = self._largest()

    def _largest(self) -> float:
        """λ, by the tridiagonal matrix of conjugate gradients with D."""
        r = np.where(self.D_inverse > 0, np.random.default_rng(0).standard_normal(len(self.D_inverse)), 0)
        found = ConjugateGradients(self.A.__matmul__, lambda r: self.D_inverse * self.exchange.Cumulated(r), r, self.exchange.Dot)
        first, steps, ratios = found.rz, [], []
        while len(steps) < LANCZOS and found.rz > EXHAUSTED * first:
            before = found.rz
            found.Step()
            steps.append(found.gains[-1] / before)
            ratios.append(found.rz / before)
        if not steps:
            return 1.0
        inverse, ratio = 1 / np.array(steps), np.array(ratios[:-1])
        diagonal = inverse + np.concatenate([[0], ratio * inverse[:-1]])
        return SAFETY * float(scipy.linalg.eigvalsh_tridiagonal(diagonal, np.sqrt(ratio) * inverse[:-1])[-1])

    def Apply(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(p(D⁻¹A) D⁻¹r, consistent; what of r, additive, it leaves)."""
        centre, half = 0.5 * self.largest * (1 + 1 / RATIO), 0.5 * self.largest * (1 - 1 / RATIO)
        factor = half / centre
        step = self.D_inverse * self.exchange.Cumulated(r) / centre
        x, r = step.copy(), r - self.A @ step
        for _ in range(DEGREE - 1):
            before, factor = factor, 1 / (2 * centre / half - factor)
            step = factor * before * step + 2 * factor / half * self.D_inverse * self.exchange.Cumulated(r)
            x, r = x + step, r - self.A @ step
        return x, r


class TwoLevel:
    """The preconditioner.

    Parameters
    ----------
    A
        (n, n), symmetric; of several processes the additive part of this one.
    free
        (n,) bool, the unknowns that are not fixed.
    C
        (k, n), additive rows of the crack: its functions are those that these have.
    border
        Unknowns of the tips, whose rows are long.
    vertices
        Those of the mesh.
    exchange
        How processes share the unknowns.

    Attributes
    ----------
    S
        (k, k): C X (XᵀAX)⁻¹ XᵀCᵀ, at most C A⁻¹ Cᵀ; the same on all processes.
    positive
        Whether A is positive definite on X.
    size
        The dimension of X.
    tip_iterations
        Of conjugate gradients, for each of the tips' functions.
    """

    def __init__(self, A: csr_matrix, free: np.ndarray, C: csr_matrix, border: np.ndarray, vertices: Vertices, exchange: Exchange) -> None:
        self.A, self.C, self.exchange = A, C, exchange
        tips, others = border[free[border]], free.copy()
        others[border] = False
        around = self._around(np.unique(C.indices), border) & others
        self.smoother = Chebyshev(A, others, exchange)
        self._set([self._units(np.flatnonzero(around)), self._aggregates(vertices, others, others & ~around)])
        self.tip_iterations: list[int] = []
        if len(tips):
            columns = np.array([self._remainder(tip, others) for tip in tips])
            self._set([self.X, scipy.sparse.csc_matrix(columns.T)], len(tips))

    def _around(self, functions: np.ndarray, border: np.ndarray) -> np.ndarray:
        """(n,) bool: some functions and the next layers around them."""
        on_all = lambda mark: (self.exchange.Cumulated(mark) > 0).astype(float)
        mark = np.zeros(self.A.shape[0])
        mark[functions] = 1
        for _ in range(LAYERS):
            mark = on_all(mark)
            mark[border] = 0
            mark[self.A[np.flatnonzero(mark)].indices] = 1
        return on_all(mark) > 0

    def _units(self, dofs: np.ndarray) -> csr_matrix:
        """Functions of V_h as columns, in an order on which all agree."""
        numbers = self.exchange.Numbers(self.A.shape[0])[dofs]
        of_all = np.unique(np.concatenate(self.exchange.Gather(numbers)))
        return scipy.sparse.csr_matrix((np.ones(len(dofs)), (dofs, np.searchsorted(of_all, numbers))), shape=(self.A.shape[0], len(of_all)))

    def _aggregates(self, vertices: Vertices, free: np.ndarray, on: np.ndarray) -> csr_matrix:
        """Smoothed aggregates of the vertices with unknowns on, without their values on others, which are around the crack."""
        T = tentative(self.A, vertices, free, on[vertices.dofs].any(axis=1), self.exchange)
        at = np.zeros(len(on), dtype=bool)
        at[vertices.dofs.ravel()] = True
        jacobi = Chebyshev(self.A, on & at, self.exchange)
        change = scipy.sparse.diags(SAFETY * DAMPING / jacobi.largest * jacobi.D_inverse) @ self.exchange.CumulatedRows((self.A @ T).tocsr())
        return (scipy.sparse.diags((on & at).astype(float)) @ (T - change)).tocsr()

    def _remainder(self, tip: int, others: np.ndarray) -> np.ndarray:
        """A function of a tip less what those of others approximate of it; its coefficients."""
        r = np.where(others, self.A[:, [tip]].toarray().ravel(), 0)
        energy = self.exchange.Sum(float(self.A[tip, tip]))
        x, found = self.Begin(r)
        energy -= self.exchange.Dot(r, x)
        while found.size > TIP_ACCURACY * np.sqrt(max(energy - sum(found.gains), 0)) and found.positive and energy > sum(found.gains):
            found.Step()
        self.tip_iterations.append(len(found.gains))
        x = -(x + found.x)
        x[tip] = 1
        return x

    def _set(self, parts: list[csr_matrix], border: int = 0) -> None:
        """X, and its factors; the last unknowns are its border."""
        self.X = scipy.sparse.hstack(parts).tocsr()
        self.transposed, self.size = self.X.T.tocsr(), self.X.shape[1]
        matrix = self.exchange.Sum((self.transposed @ (self.A @ self.X)).tocsr())
        C = self.exchange.Sum((self.C @ self.X).tocsr())
        self.coarse = self.exchange.Together(lambda: factors_of(matrix, self.size - np.arange(border, 0, -1), C) if self.exchange.is_first else None)
        self.S = self.exchange.FromFirst(np.zeros(0) if self.coarse is None else self.coarse.S)
        self.positive = self.exchange.FromFirst(self.coarse is not None and self.coarse.positive)

    def Coarse(self, r: np.ndarray) -> np.ndarray:
        """X (XᵀAX)⁻¹ Xᵀ r of an additive r: consistent."""
        r = self.exchange.Sum(self.transposed @ r)
        return self.X @ self.exchange.FromFirst(np.zeros(0) if self.coarse is None else self.coarse.Solve(r))

    def Apply(self, r: np.ndarray) -> np.ndarray:
        """Of an additive r that X leaves nothing of: consistent (J. M. Tang and others, J. Sci. Comput. 39 (2009) 340-370: A-DEF2)."""
        x, left = self.smoother.Apply(r)
        return x + self.Coarse(left)

    def Begin(self, r: np.ndarray) -> tuple[np.ndarray, ConjugateGradients]:
        """(what X gives, conjugate gradients for the rest) of A x = r, additive."""
        x = self.Coarse(r)
        return x, ConjugateGradients(self.A.__matmul__, self.Apply, r - self.A @ x, self.exchange.Dot)


def factors_of(matrix: csr_matrix, border: np.ndarray, C: csr_matrix) -> Elimination:
    """The Elimination of a scipy matrix."""
    A = from_scipy(matrix)
    return Elimination(A, BitArray([True] * A.height), border, C, "sparsecholesky")
