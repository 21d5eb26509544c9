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
from ..spaces.exchange import exchange_of
from ..spaces.unknowns import Unknowns

if TYPE_CHECKING:
    from ngsolve import BaseMatrix

    from .problem import ContactProblem


TINY = np.finfo(float).tiny


def free_motions(problem: ContactProblem) -> FreeMotions | None:
    """What neither supports nor springs of the problem hold, or None."""
    return RigidMotions(problem.V).Free(~mask(problem.free), problem.a)


def most_independent(rows: np.ndarray, number: int) -> np.ndarray:
    """The most independent ones of rows (n, k), at most so many, by a pivoted QR decomposition."""
    return scipy.linalg.qr(rows.T, mode="r", pivoting=True)[1][:number] if len(rows) else np.zeros(0, dtype=int)


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
        self.R, self.centres, self.exchange = np.zeros((problem.V.ndof, 0)), np.zeros((0, problem.V.mesh.dim)), exchange_of(problem.V)
        free = free_motions(problem)
        if free is None:
            return
        fixed = ~mask(problem.free)
        self.R = np.where(fixed[:, None], 0, free.Coefficients())
        self._refuse(self.exchange.FromFirst(without_effect(self.R[Unknowns(problem.V).heaviside])), free)
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
            self._refuse(self.exchange.FromFirst(without_effect(means, float(np.linalg.norm(means, 2)))), self.free)

    def Without(self, free: BitArray, stiffness: BaseMatrix) -> BitArray:
        """The unknowns that neither supports nor pins take away.

        Parameters
        ----------
        stiffness
            Of V: pins are where much energy resists, of rows √K_ii R_i the most independent ones. On a sliver of an element a pin would hold nothing.
        """
        rest = BitArray(free)
        if len(self):
            size = np.abs(self.exchange.Cumulated(csr_view(stiffness).diagonal()))
            rows = np.sqrt(self.exchange.Additive(size))[:, None] * self.R  # each unknown counts once
            mine = most_independent(rows, len(self))
            of_all = self.exchange.Gather(rows[mine])
            chosen = most_independent(np.concatenate(of_all), len(self)) - sum(map(len, of_all[: self.exchange.rank]))
            pins = np.zeros(len(rows))
            pins[mine[chosen[(chosen >= 0) & (chosen < len(mine))]]] = 1
            for pin in np.flatnonzero(self.exchange.Cumulated(pins)):
                rest.Clear(int(pin))
        return rest

    def Forces(self, *forces: np.ndarray) -> np.ndarray:
        """(r,): the work of additive forces in each motion."""
        return self.exchange.Sum(self.R.T @ sum(forces))

    def Imbalance(self, *forces: np.ndarray) -> float:
        """Of the parts that only the faces hold, relative to the additive forces on them."""
        if not len(self):
            return 0.0
        of_each = [self.exchange.Additive(np.abs(self.exchange.Cumulated(force))) for force in forces]
        size = self.exchange.Sum(np.abs(self.R).T @ sum(of_each))
        return float(np.abs(self.Forces(*forces)).max() / max(size.max(), TINY))

    @property
    def notes(self) -> list[str]:
        """A sentence for each part."""
        return [f"the part of the body around {in_words(centre)} is held by the faces of cracks alone" for centre in self.centres]
