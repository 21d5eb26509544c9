"""Elimination of the displacements: what is left are the crack's own unknowns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BaseMatrix, BitArray
from pyngcore import SuspendTaskManager

from .. import _ngsxfem_contact as core
from ..arguments import check_type
from ..processes import Exchange
from ..protocols import DirectSolver
from . import pardiso
from .matrices import csr_view
from .substructuring import Substructuring
from .symmetric_system import SymmetricSystem, unit_scale

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scipy.sparse import csc_matrix, csr_matrix

FEW = 8  # unknowns of a border whose columns are kept, so that each further solve is one back-substitution
CG = "cg"  # the name of conjugate gradients: see contact.iterative, in space contact.condensed
OF_NGSOLVE = ("sparsecholesky", "pardiso", "umfpack", "superlu", "masterinverse", "mumps")  # where it was built with them
SOLVERS = (*OF_NGSOLVE, Substructuring.name, CG)
PARDISO_PAYS = 30_000  # unknowns; below, NGSolve's sparse Cholesky is as fast or faster (docs/measured.md)


class BackSubstitution:
    """K A⁻¹ Kᵀ by one solve for each row of K, with any direct solver of NGSolve."""

    def __init__(self, matrix: BaseMatrix, inner: BitArray, K: csc_matrix, inverse: str) -> None:
        self.name, self.K = inverse, K
        self.factors = matrix.Inverse(inner, inverse=inverse)
        self.x, self.r = matrix.CreateColVector(), matrix.CreateColVector()
        self.schur = self.Schur()
        self.positive: bool | None = None

    def Schur(self) -> np.ndarray:
        """K A⁻¹ Kᵀ, dense."""
        rows = self.K.tocsr()
        columns = np.array([self.Couple(row.toarray().ravel()) for row in rows])
        S = columns.reshape((rows.shape[0],) * 2)
        return 0.5 * (S + S.T)

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
        """A⁻¹ rhs; zero where an unknown is not in the factorisation."""
        self.r.FV().NumPy()[:] = rhs
        self.x.data = self.factors * self.r
        return self.x.FV().NumPy().copy()

    def Couple(self, rhs: np.ndarray) -> np.ndarray:
        """K A⁻¹ rhs."""
        return self.K @ self.Solve(rhs)


class PartialFactorisation(BackSubstitution):
    """K A⁻¹ Kᵀ from NGSolve's sparse Cholesky factors: one sweep through the blocks that K reaches, all rows at once."""

    def __init__(self, matrix: BaseMatrix, inner: BitArray, K: csc_matrix) -> None:
        super().__init__(matrix, inner, K, "sparsecholesky")
        self.positive = core.NumNegativePivots(self.factors) == 0

    def Schur(self) -> np.ndarray:
        """K A⁻¹ Kᵀ, dense."""
        return core.SchurComplement(self.factors, self.K.shape[0], self.K.indptr, self.K.indices, self.K.data)


def factorise(matrix: BaseMatrix, inner: BitArray, K: scipy.sparse.csc_matrix, inverse: str | None, exchange: Exchange) -> DirectSolver:
    """A⁻¹ on the unknowns of a BitArray and K A⁻¹ Kᵀ, by the strategy of a name: "substructuring", or one that goes with a direct solver of NGSolve, for one process."""
    inverse = inverse or (Substructuring.name if exchange.several else default_inverse(matrix.height))
    if inverse == Substructuring.name:
        return Substructuring(matrix, inner, K, exchange)
    exchange.Refuse(f"inverse={inverse!r}")
    if inverse == CG:
        raise ValueError(f"inverse={CG!r} is there for ContactProblem.Solve and LoadSteps; here the displacements are eliminated, by a direct solver")
    if inverse == "sparsecholesky":
        return PartialFactorisation(matrix, inner, K)
    if inverse == "pardiso":
        return pardiso.Pardiso(matrix, inner, K)
    return BackSubstitution(matrix, inner, K, inverse)


def check_inverse(inverse: Any) -> None:
    """Raises TypeError or ValueError for what names no solver, before any work; None chooses."""
    check_type(inverse, str | None, "inverse", f"the name of a solver, one of {SOLVERS}, or None")
    if inverse is not None and inverse not in SOLVERS:
        raise ValueError(f"inverse={inverse!r} names no solver; take one of {SOLVERS}, or None, which chooses")


def default_inverse(size: int) -> str:
    """MKL's Pardiso where it is installed and worth it."""
    return "pardiso" if size > PARDISO_PAYS and pardiso.is_available() else "sparsecholesky"


@dataclass
class ReducedVector:
    """A right-hand side F with A⁻¹F as the crack feels it.

    Parameters
    ----------
    partial
        What is left of F at the tips' unknowns; of conjugate gradients A⁻¹F.
    crack
        C A⁻¹F.

    Notes
    -----
    Linear in F: reduced vectors add and are multiplied by numbers.
    """

    rhs: np.ndarray
    partial: np.ndarray
    crack: np.ndarray

    def __add__(self, other: ReducedVector) -> ReducedVector:
        return ReducedVector(self.rhs + other.rhs, self.partial + other.partial, self.crack + other.crack)

    def __rmul__(self, factor: float) -> ReducedVector:
        return ReducedVector(factor * self.rhs, factor * self.partial, factor * self.crack)


class Elimination(SymmetricSystem):
    """A symmetric positive definite matrix A, factorised, and S = C A⁻¹ Cᵀ for a sparse C (m, ndof).

    Long rows would ruin the ordering of a sparse factorisation: they stay outside of it, as a border, eliminated by block elimination.

    Parameters
    ----------
    free
        BitArray of the unknowns that are not fixed.
    border
        Those whose rows are long, see `spaces.unknowns.Unknowns`.
    inverse
        Name of NGSolve's direct solver: "sparsecholesky" and "pardiso" give S by a partial factorisation, others by one solve for each row of C; or
        "substructuring", the one of several processes.
    exchange
        Of processes that share the unknowns. Matrix, C and right-hand sides are additive then, solutions consistent, S is the same for all.

    Attributes
    ----------
    S
        Dense (m, m).
    positive
        Whether A is positive definite; None if the direct solver does not tell.
    """

    def __init__(
        self,
        matrix: BaseMatrix,
        free: BitArray,
        border: Sequence[int] | np.ndarray = (),
        C: csr_matrix | None = None,
        inverse: str | None = None,
        exchange: Exchange = Exchange(),
    ) -> None:
        super().__init__(matrix, free, exchange)
        self.C = scipy.sparse.csr_matrix((0, matrix.height)) if C is None else C
        self.border = np.array([dof for dof in border if free[int(dof)]], dtype=int)
        inner = BitArray(free)
        for dof in self.border:
            inner.Clear(int(dof))
        self.border_rows = csr_view(matrix)[self.border]
        K = scipy.sparse.vstack([self.border_rows, self.C]).tocsc()
        self.factors = factorise(matrix, inner, K, inverse, exchange)
        self.name = self.factors.name
        with SuspendTaskManager():  # its threads take turns with those of dense algebra otherwise
            self._eliminate_border(self.factors.schur)

    def _eliminate_border(self, schur: np.ndarray) -> None:
        t = len(self.border)
        matrix = self.exchange.Sum(self.border_rows[:, self.border].toarray()) - schur[:t, :t]
        self.border_scale = unit_scale(np.diag(matrix))  # tips with different functions have unknowns of different units
        self.border_matrix = matrix * self.border_scale * self.border_scale[:, None]
        self.coupling = self.exchange.Sum(self.C[:, self.border].toarray()) - schur[t:, :t]
        self.S = self.exchange.FromFirst(schur[t:, t:] + self.coupling @ self._at_border(self.coupling.T))
        self.positive = self.factors.positive and bool(np.all(np.linalg.eigvalsh(self.border_matrix) > 0))

    def _at_border(self, forces: np.ndarray) -> np.ndarray:
        return (self.border_scale * np.linalg.solve(self.border_matrix, (self.border_scale * forces.T).T).T).T

    def Reduce(self, rhs: np.ndarray) -> ReducedVector:
        """The ReducedVector of a right-hand side of length ndof."""
        t = len(self.border)
        coupled = self.factors.Couple(rhs)
        border = self.exchange.Sum(rhs[self.border]) - coupled[:t]
        return ReducedVector(rhs, border, self.exchange.FromFirst(coupled[t:] + self.coupling @ self._at_border(border)))

    def Recover(self, reduced: ReducedVector, L: np.ndarray | None = None) -> np.ndarray:
        """A⁻¹(F + CᵀL) of a ReducedVector; zero on fixed unknowns."""
        rhs, border = reduced.rhs, reduced.partial
        if L is not None:
            rhs, border = rhs + self.C.T @ L, border + self.coupling.T @ L
        at_border = self._at_border(border)
        x = self.factors.Solve(rhs - self.border_rows.T @ at_border)
        x[self.border] = at_border
        return x

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
        """A⁻¹ rhs; zero on fixed unknowns; of several processes consistent, for an additive rhs."""
        x = self.factors.Solve(rhs)
        if not len(self.border):
            return x
        at_border = self._at_border(self.exchange.Sum(rhs[self.border] - self.border_rows @ x))
        x -= self._border_columns @ at_border if len(self.border) <= FEW else self.factors.Solve(self.border_rows.T @ at_border)
        x[self.border] = at_border
        return x

    @cached_property
    def _border_columns(self) -> np.ndarray:
        """(ndof, t): A⁻¹ of the columns of the border."""
        return np.array([self.factors.Solve(row.toarray().ravel()) for row in self.border_rows]).T

    def SolveRefined(self, rhs: np.ndarray) -> np.ndarray:
        """The same with one step of iterative refinement."""
        x = self.Solve(rhs)
        return x + self.Solve(self.exchange.Additive(self.Residual(rhs, x)))
