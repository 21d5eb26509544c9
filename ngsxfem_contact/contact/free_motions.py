"""Rigid motions that no support holds: of parts of a body that cracks cut off, and that only the faces of the cracks hold, by contact, friction or glue.

With R such motions, K R = 0. Pins that take them away make K regular, and u = u_p + R α, with two conditions: the jumps of R α belong to the jumps, and the
pins carry nothing, Rᵀ(F + Eᵀ L) = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import BitArray

from ..algebra.matrices import mask
from ..spaces.connectivity import HELD, RigidMotions
from ..spaces.unknowns import Unknowns
from .checks import check_rigid_motions
from .nodal_law import NodalLaw

if TYPE_CHECKING:
    from .problem import ContactProblem


class FreeMotions:
    """The motions of a problem that its faces have to hold.

    Attributes
    ----------
    R
        (V.ndof, r), each motion in units of the size of its part.
    pins
        r unknowns that take them away.

    Raises
    ------
    SingularSystem
        For motions that no face feels, and, with a law that does not hold node by node, for all.
    """

    def __init__(self, problem: ContactProblem) -> None:
        if not isinstance(problem.law, NodalLaw):
            check_rigid_motions(problem)
            self.R, self.pins = np.zeros((problem.V.ndof, 0)), np.zeros(0, dtype=int)
            return
        motions, fixed = RigidMotions(problem.V), ~mask(problem.free)
        unknowns, rows = motions.Coefficients()
        values = rows @ null_space(motions.Constraints(fixed, problem.a))
        self.R = np.zeros((problem.V.ndof, values.shape[1]))
        self.R[unknowns] = np.where(fixed[unknowns, None], 0, values)
        layout = Unknowns(problem.V)
        if np.linalg.matrix_rank(self.R[layout.heaviside], tol=HELD) < self.R.shape[1]:  # the jumps are not independent
            check_rigid_motions(problem)
        self.pins = self._chosen(layout.polynomial.stop)

    def _chosen(self, polynomials: int) -> np.ndarray:
        """Of the rows of R the most independent ones; those of polynomials, if they are enough."""
        number = self.R.shape[1]
        rows = self.R[:polynomials] if np.linalg.matrix_rank(self.R[:polynomials], tol=HELD) == number else self.R
        return scipy.linalg.qr(rows.T, mode="r", pivoting=True)[1][:number]

    def Without(self, free: BitArray) -> BitArray:
        """The unknowns that neither supports nor pins take away."""
        rest = BitArray(free)
        for pin in self.pins:
            rest.Clear(int(pin))
        return rest


def null_space(constraints: np.ndarray) -> np.ndarray:
    """An orthonormal basis, as columns, of what constraints leave."""
    size = constraints.shape[1]
    triangle = np.linalg.qr(np.concatenate([constraints, np.zeros((size, size))]), mode="r")
    _, sizes, motions = np.linalg.svd(triangle)
    return motions[sizes < HELD].T
