"""Nodal problems with rigid motions that only the faces hold: find p and α of w = Q p + q + Bα with Bᵀp + pull = 0.

Q and q hold how the motions were pinned before the displacements were eliminated, by amounts in the range of B. On tractions that balance the load, p = p_0 + Pp
with P the projection onto Bᵀp = 0, they drop out:

    w = (P Q P + κ U Uᵀ) p + P (q + Q p_0) + Bα̂,

U an orthonormal basis of the range of B, whatever κ is. All in units in which a node counts by its weight.
"""

from __future__ import annotations

import numpy as np

from .compliance import Compliance


class Balance:
    """The problem in this form.

    Parameters
    ----------
    Q
        (m, m), symmetric positive definite.
    B
        (m, r); r = 0 leaves all as it is.
    weights
        (m,), of the nodes of all components.

    Attributes
    ----------
    compliance
        P Q P + κ U Uᵀ.
    """

    def __init__(self, Q: np.ndarray, B: np.ndarray, weights: np.ndarray) -> None:
        self.Q, self.B, self.unit = Q, B, np.sqrt(weights)
        self.U, self.sizes, self.Vt = np.linalg.svd(B / self.unit[:, None], full_matrices=False)
        if not B.shape[1]:
            self.compliance = Compliance(Q)
            return
        W = (Q @ (self.U / self.unit[:, None])) / self.unit[:, None]
        inner = self.U.T @ W
        kappa = (np.diag(Q) @ self.unit**-2 - np.trace(inner)) / max(len(Q) - B.shape[1], 1)
        A = self.unit[:, None] * (W - 0.5 * self.U @ (inner + kappa * np.eye(len(inner))))
        V = self.unit[:, None] * self.U
        self.compliance = Compliance(Q - np.hstack([A, V]) @ np.hstack([V, A]).T)

    def _projected(self, columns: np.ndarray) -> np.ndarray:
        return columns - self.U @ (self.U.T @ columns)

    def RightSide(self, q: np.ndarray, pull: np.ndarray) -> np.ndarray:
        """P (q + Q p_0)."""
        if not self.B.shape[1]:
            return q
        p_0 = -self.U @ ((self.Vt @ pull) / self.sizes)
        return self.unit * self._projected((q + self.Q @ (p_0 / self.unit)) / self.unit)

    def Motions(self, p: np.ndarray, alpha: np.ndarray, q: np.ndarray, pull: np.ndarray) -> np.ndarray:
        """α for α̂."""
        if not self.B.shape[1]:
            return alpha
        w = self.compliance.matrix @ p + self.RightSide(q, pull) + self.B @ alpha
        return self.Vt.T @ ((self.U.T @ ((w - self.Q @ p - q) / self.unit)) / self.sizes)
