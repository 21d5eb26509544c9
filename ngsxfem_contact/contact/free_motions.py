"""Rigid motions that no support holds: of parts of a body that cracks cut off, and that only the faces of the cracks hold, by contact, friction or glue.

With R such motions, K R = 0. Pins that take them away make K regular, and u = u_p + R α, with two conditions: the jumps of R α belong to the jumps, and the
pins carry nothing, Rᵀ(F + Eᵀ L) = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import BitArray

from ..algebra.matrices import csr_view, mask
from ..errors import SingularSystem
from ..spaces.connectivity import FreeMotions, RigidMotions, in_words, without_effect
from ..spaces.unknowns import Unknowns

if TYPE_CHECKING:
    from ngsolve import BaseMatrix

    from .problem import ContactProblem


def free_motions(problem: ContactProblem) -> FreeMotions | None:
    """What neither supports nor springs of the problem hold, or None."""
    return RigidMotions(problem.V).Free(~mask(problem.free), problem.a)


class PinnedMotions:
    """The rigid motions of a problem that its faces have to hold.

    Attributes
    ----------
    R
        (V.ndof, r), each motion in units of the size of its part.
    centres
        (number, dimension), of the parts of the body that move.

    Raises
    ------
    SingularSystem
        For motions that no face feels.
    """

    def __init__(self, problem: ContactProblem) -> None:
        self.R, self.centres = np.zeros((problem.V.ndof, 0)), np.zeros((0, problem.V.mesh.dim))
        free = free_motions(problem)
        if free is None:
            return
        fixed = ~mask(problem.free)
        self.R = np.where(fixed[:, None], 0, free.Coefficients())
        self._refuse(without_effect(self.R[Unknowns(problem.V).heaviside]), free)
        problem.V.share.Refuse("A part of a body that only the faces of cracks hold")
        self.centres, self.free = free.centres, free

    def __len__(self) -> int:
        return self.R.shape[1]

    @staticmethod
    def _refuse(combinations: np.ndarray, free: FreeMotions) -> None:
        if len(combinations):
            raise SingularSystem(free.Combined(combinations.T).message)

    def CheckFelt(self, jumps: np.ndarray, weights: np.ndarray) -> None:
        """Raises SingularSystem for motions that do not change the gaps; jumps: (n, r), weighted gaps of the motions at n nodes with weights."""
        if len(self):
            means = jumps / weights[:, None]
            self._refuse(without_effect(means, float(np.linalg.norm(means, 2))), self.free)

    def Without(self, free: BitArray, stiffness: BaseMatrix) -> BitArray:
        """The unknowns that neither supports nor pins take away.

        Parameters
        ----------
        stiffness
            Of V: pins are where much energy resists, of rows √K_ii R_i the most independent ones. On a sliver of an element a pin would hold nothing.
        """
        rest = BitArray(free)
        if len(self):
            rows = np.sqrt(np.abs(csr_view(stiffness).diagonal()))[:, None] * self.R
            for pin in scipy.linalg.qr(rows.T, mode="r", pivoting=True)[1][: len(self)]:
                rest.Clear(int(pin))
        return rest

    @property
    def notes(self) -> list[str]:
        """A sentence for each part."""
        return [f"the part of the body around {in_words(centre)} is held by the faces of cracks alone" for centre in self.centres]
