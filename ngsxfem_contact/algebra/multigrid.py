"""Smoothed aggregation: an approximate inverse of the stiffness of an uncracked body, by pyamg's coarse levels.

The coarse functions of a level are aggregates of nodes times the rigid motions, smoothed by one step of Jacobi's method (Vaněk, Mandel, Brezina, Computing 56
(1996) 179-196). Functions of order 2 are a level more: below them are those of order 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

FEW = 300  # unknowns of the coarsest level, which is solved directly
REMEDY = 'pip install pyamg, or pip install "ngsxfem_contact[space]"'


def pyamg() -> Any:
    """The module, or None if it is not installed."""
    try:
        import pyamg as found
    except ImportError:
        return None
    return found


def is_available() -> bool:
    """Whether `pip install pyamg` was done, that is `pip install ngsxfem_contact[space]`."""
    return pyamg() is not None


def rigid_motions(points: np.ndarray) -> np.ndarray:
    """(3 n, 6): translations and turns about the centre of n points in space, (n, 3), node by node, of equal size."""
    arm = points - points.mean(axis=0)
    x, y, z = arm.T / max(np.abs(arm).max(), np.finfo(float).tiny)
    motions, zero = np.zeros((len(points), 3, 6)), np.zeros(len(points))
    motions[:, [0, 1, 2], [0, 1, 2]] = 1
    motions[:, :, 3:] = np.array([[-y, x, zero], [zero, -z, y], [z, zero, -x]]).transpose(2, 1, 0)
    return motions.reshape(-1, 6)


@dataclass
class Level:
    """A of a level, and how values come from the level below: P, None for the first ones of the unknowns, which are those of the level below."""

    A: csr_matrix
    P: csr_matrix | None

    def __post_init__(self) -> None:
        self.R = None if self.P is None else self.P.T.tocsr()

    def Smooth(self, x: np.ndarray, b: np.ndarray, forward: bool) -> None:
        """One sweep of Gauss and Seidel's method."""
        first, end, step = (0, len(b), 1) if forward else (len(b) - 1, -1, -1)
        pyamg().amg_core.gauss_seidel(self.A.indptr, self.A.indices, self.A.data, x, b, first, end, step)


class Multigrid:
    """A V-cycle with one sweep before and one after, symmetric and positive definite as A is; the spectral radius of its product with A is at most 1.

    Parameters
    ----------
    A
        (3 n, 3 n), symmetric and positive definite, node by node.
    near_kernel
        (3 n_1, 6): what costs no energy but for supports, zero on unknowns that are held; of the first n_1 nodes, whose functions are those of order 1.

    Raises
    ------
    ImportError
        Without pyamg.
    """

    def __init__(self, A: csr_matrix, near_kernel: np.ndarray) -> None:
        if not is_available():
            raise ImportError(f"smoothed aggregation needs pyamg: {REMEDY}")
        self.A, self.levels, first = A, [], len(near_kernel)
        if A.shape[0] > first:
            self.levels.append(Level(A, None))
            A = A[:first, :first]
        hierarchy = pyamg().smoothed_aggregation_solver(
            A.tobsr((3, 3)),
            B=near_kernel,
            symmetry="symmetric",
            strength=("symmetric", {"theta": 0.02}),
            smooth=("jacobi", {"omega": 4 / 3}),
            improve_candidates=None,
            presmoother=None,
            postsmoother=None,
            max_coarse=FEW,
        )
        for level in hierarchy.levels[:-1]:
            self.levels.append(Level(level.A.tocsr(), level.P.tocsr()))
        self.coarsest = pseudo_inverse(hierarchy.levels[-1].A.toarray())

    @property
    def sizes(self) -> list[int]:
        """The unknowns of each level."""
        return [level.A.shape[0] for level in self.levels] + [len(self.coarsest)]

    def Apply(self, b: np.ndarray, level: int = 0) -> np.ndarray:
        """The V-cycle of a right-hand side, from a level on."""
        if level == len(self.levels):
            return self.coarsest @ b
        here, x = self.levels[level], np.zeros(len(b))
        here.Smooth(x, b, True)
        r = b - here.A @ x
        if here.P is None:
            below = self.levels[level + 1].A.shape[0] if level + 1 < len(self.levels) else len(self.coarsest)
            x[:below] += self.Apply(r[:below], level + 1)
        else:
            x += here.P @ self.Apply(here.R @ r, level + 1)
        here.Smooth(x, b, False)
        return x


def pseudo_inverse(A: np.ndarray) -> np.ndarray:
    """Of a symmetric positive semi-definite matrix: aggregates of few nodes, or of held ones, have fewer motions than six."""
    scale = np.sqrt(np.maximum(np.diag(A), 0))
    scale = np.where(scale > 0, 1 / np.where(scale > 0, scale, 1), 0)
    return scale[:, None] * scipy.linalg.pinvh(A * scale[:, None] * scale, rtol=1e-12) * scale
