"""Conjugate gradients that stop where the energy of the answer is known well enough."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass
class Found:
    """x of A x = r, and what each step added to its energy x·Ax."""

    x: np.ndarray
    gains: list[float] = field(default_factory=list)

    @property
    def energy(self) -> float:
        """x·Ax."""
        return float(sum(self.gains))

    @property
    def missing(self) -> float:
        """What further steps would add to the energy if the gains went on falling as the last two did."""
        if len(self.gains) < 2 or not 0 < self.gains[-1] < self.gains[-2]:
            return self.gains[-1] if self.gains else 0.0
        factor = self.gains[-1] / self.gains[-2]
        return self.gains[-1] * factor / (1 - factor)


def conjugate_gradients(A: Callable[[np.ndarray], np.ndarray], M: Callable[[np.ndarray], np.ndarray], r: np.ndarray, accuracy: float, most: int) -> Found:
    """Solves A x = r with the preconditioner M until what is missing of the energy is less than `accuracy` of it, in `most` steps at most.

    Parameters
    ----------
    A, M
        Symmetric and positive (semi-)definite, as functions of vectors; x stays in the range of M.
    """
    x, r, gains = np.zeros(len(r)), r.copy(), []
    z = M(r)
    p, rz = z, r @ z
    found = Found(x, gains)
    while rz > 0 and len(gains) < most:
        q = A(p)
        step = rz / (p @ q)
        x += step * p
        r -= step * q
        gains.append(step * rz)
        if len(gains) > 1 and found.missing <= accuracy * found.energy:
            break
        z = M(r)
        rz, before = r @ z, rz
        p = z + rz / before * p
    return found
