"""MKL's Pardiso with its partial factorisation: [A Kᵀ; K 0] is factorised up to the rows of K, what is left is -K A⁻¹Kᵀ.

Parameters are those of Intel's oneMKL reference, "pardiso iparm Parameter", counted from zero.
"""

from __future__ import annotations

import ctypes
from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from pyngcore import GetNumThreads, SuspendTaskManager

from .. import _ngsxfem_contact as core
from .matrices import csr_view, mask

if TYPE_CHECKING:
    from ngsolve import BaseMatrix, BitArray
    from scipy.sparse import csc_matrix

SYMMETRIC_INDEFINITE = -2
ANALYSE, FACTORISE, FORWARD, BACKWARD, SOLVE, RELEASE = 11, 22, 331, 333, 33, -1
SCHUR = 35
PARAMETERS = {
    0: 1,  # the parameters below hold
    1: 2,  # nested dissection
    9: 13,  # a pivot below 1e-13 is perturbed
    20: 1,  # Bunch-Kaufman pivots
    23: 1,  # two-level parallel factorisation
    34: 1,  # zero-based indices
    SCHUR: 2,  # Schur complement, and factors that can solve
}
NEGATIVE_EIGENVALUES = 22


@cache
def library() -> Any:
    """The functions of MKL, or None if MKL is not installed."""
    try:
        files = [*(metadata.files("intel_openmp") or []), *(metadata.files("mkl") or [])]
    except metadata.PackageNotFoundError:
        return None
    try:
        for file in files:
            if file.match("*libiomp5.so") or file.match("*libiomp5md.dll"):
                ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
        return next((ctypes.CDLL(str(file.locate())) for file in files if file.match("*mkl_rt*")), None)
    except OSError:
        return None


def is_available() -> bool:
    """Whether `pip install mkl` was done, that is `pip install ngsxfem_contact[fast]`."""
    return library() is not None


def pointer(array: np.ndarray | None) -> Any:
    """For C; the array must live on."""
    return None if array is None else array.ctypes.data_as(ctypes.c_void_p)


def nonzero(values: Any) -> Any:
    """The values, 1 in place of 0."""
    return np.where(values == 0, 1, values)


class Pardiso:
    """A⁻¹ on the unknowns of a BitArray and K A⁻¹Kᵀ for K in CSC format; matrix: symmetric, a SparseMatrix of NGSolve.

    Attributes
    ----------
    schur
        K A⁻¹Kᵀ, dense.
    positive
        Whether A is positive definite.

    Raises
    ------
    ImportError
        Without MKL.
    RuntimeError
        With the number of a Pardiso error.

    Notes
    -----
    Pardiso compares pivots with the largest entries: the largest diagonal entry of A and the largest of each row of K are made 1 for it.
    """

    name = "pardiso"

    def __init__(self, matrix: BaseMatrix, inner: BitArray, K: csc_matrix) -> None:
        if not is_available():
            raise ImportError('inverse="pardiso" needs MKL: pip install mkl, or pip install "ngsxfem_contact[fast]"')
        self.inner, self.m = mask(inner), K.shape[0]
        self.unit = nonzero(csr_view(matrix).diagonal()[self.inner].max(initial=0))
        self.units = nonzero(abs(K).max(axis=1).toarray().ravel())
        K = (scipy.sparse.diags(self.unit / self.units) @ K).tocsc()
        K.sort_indices()
        self.first, self.column, self.value = core.BorderedMatrix(matrix, inner, self.m, K.indptr, K.indices, K.data)
        self.value /= self.unit
        self.size = len(self.first) - 1
        self.handle, self.parameters = np.zeros(64, dtype=np.int64), np.zeros(64, dtype=np.int32)
        self.parameters[list(PARAMETERS)] = list(PARAMETERS.values())
        if self.m == 0:  # Pardiso's partial solves end the process where the complement is empty
            self.parameters[SCHUR] = 0
        self.in_schur = np.zeros(self.size, dtype=np.int32)
        self.in_schur[self.size - self.m :] = 1
        negative = np.zeros((max(self.m, 1),) * 2)
        self._call(ANALYSE)
        self._call(FACTORISE, None, negative)
        scaled = -negative[: self.m, : self.m]
        scaled = 0.5 * (scaled + scaled.T)
        self.positive = self._is_positive(scaled)
        self.schur = scaled / self.unit * self.units * self.units[:, None]

    def _is_positive(self, schur: np.ndarray) -> bool:
        """Pardiso counts the negative eigenvalues of the whole matrix, those of -K A⁻¹Kᵀ among them (Sylvester)."""
        values = np.linalg.eigvalsh(schur)
        return int(self.parameters[NEGATIVE_EIGENVALUES]) <= int((values > 1e-10 * np.abs(values).max(initial=0)).sum())

    def _call(self, phase: int, rhs: np.ndarray | None = None, solution: np.ndarray | None = None) -> None:
        integer = lambda number: ctypes.byref(ctypes.c_int(number))
        mkl, error, suspended = library(), ctypes.c_int(0), SuspendTaskManager()
        threads = mkl.MKL_Set_Num_Threads_Local(GetNumThreads())
        mkl.pardiso_(
            pointer(self.handle), integer(1), integer(1), integer(SYMMETRIC_INDEFINITE), integer(phase), integer(self.size),
            pointer(self.value), pointer(self.first), pointer(self.column), pointer(self.in_schur), integer(1),
            pointer(self.parameters), integer(0), pointer(rhs), pointer(solution), ctypes.byref(error),
        )  # fmt: skip
        mkl.MKL_Set_Num_Threads_Local(threads)
        del suspended
        if error.value and phase != RELEASE:
            raise RuntimeError(f"MKL Pardiso: error {error.value} in phase {phase}; inverse='sparsecholesky' does without MKL")

    def _forward(self, rhs: np.ndarray) -> np.ndarray:
        padded, result = np.zeros(self.size), np.zeros(self.size)
        padded[: self.size - self.m] = rhs[self.inner] / self.unit
        if self.m == 0:
            return padded
        self._call(FORWARD, padded, result)
        return result

    def Couple(self, rhs: np.ndarray) -> np.ndarray:
        """K A⁻¹ rhs."""
        return -self._forward(rhs)[self.size - self.m :] * self.units

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
        """A⁻¹ rhs; zero where an unknown is not in the factorisation."""
        half, result, x = self._forward(rhs), np.zeros(self.size), np.zeros(len(self.inner))
        half[self.size - self.m :] = 0
        self._call(BACKWARD if self.m else SOLVE, half, result)
        x[self.inner] = result[: self.size - self.m]
        return x

    def __del__(self) -> None:
        if getattr(self, "handle", np.zeros(1)).any():
            self._call(RELEASE)
