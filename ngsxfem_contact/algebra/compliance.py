"""The matrix of w = Q p + q, minus the weighted jumps for tractions p, and its inverse, which serves all sets of nodes, load steps and laws.

Where w is known at all nodes but k, the inverse leaves k equations: in large networks of cracks, of which few nodes are open or slip, Newton's methods cost what
these do.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy

from .symmetric_system import unit_scale


class Compliance:
    """Q.

    Parameters
    ----------
    matrix
        (m, m), positive definite; symmetric except for Nitsche's method with θ ≠ 1.
    """

    def __init__(self, matrix: np.ndarray) -> None:
        self.matrix = matrix

    @property
    def diagonal(self) -> np.ndarray:
        """(m,)."""
        return np.diag(self.matrix)

    @cached_property
    def symmetric_inverse(self) -> np.ndarray | None:
        """Q⁻¹ by Cholesky's factors; None where Q is not symmetric and positive definite."""
        scale = unit_scale(self.diagonal)
        scaled = self.matrix * scale
        scaled *= scale[:, None]
        if not len(scaled) or np.abs(scaled - scaled.T).max() > 1e-10:
            return None
        factor, failed = scipy.linalg.lapack.dpotrf(scaled.T, lower=1, clean=1, overwrite_a=1)
        if failed:
            return None
        lower, _ = scipy.linalg.lapack.dpotri(factor, lower=1, overwrite_c=1)
        inverse = lower + lower.T
        inverse[np.diag_indices_from(inverse)] = lower.diagonal()
        inverse *= scale
        inverse *= scale[:, None]
        return inverse

    @cached_property
    def inverse(self) -> np.ndarray:
        """Q⁻¹; raises numpy.linalg.LinAlgError where there is none."""
        return np.linalg.inv(self.matrix) if self.symmetric_inverse is None else self.symmetric_inverse

    def Scaled(self, a: np.ndarray) -> Compliance:
        """a_i Q_ij a_j."""
        if (a == 1).all():
            return self
        scaled = Compliance(a[:, None] * self.matrix * a)
        scaled.inverse = self.inverse / a[:, None] / a
        return scaled
