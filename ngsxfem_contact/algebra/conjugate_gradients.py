"""Conjugate gradients that stop where the energy of the answer is known well enough."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..errors import NotCoercive, NotConverged

if TYPE_CHECKING:
    from collections.abc import Callable

ACCURACY = 1e-11  # of a displacement, in the energy norm
MOST = 500  # steps for one right-hand side
NOT_POSITIVE = "K - K_γ is not positive definite: look for terms of problem.a with negative stiffness, or take BarbosaHughes(), which chooses γ itself"


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


class ConjugateGradients:
    """A x = r step by step, from x = 0.

    Parameters
    ----------
    A, M
        Symmetric and positive (semi-)definite, as functions of vectors; x stays in the range of M.
    r
        Taken over, and changed.
    dot
        The product of a residual, or what A gives, with what M gives: of several processes r and A x are additive, x and M r consistent.

    Attributes
    ----------
    x, r
        The approximation, and what is left of the right-hand side.
    gains
        What each step added to x·Ax.
    positive
        Whether A and M were so in all directions up to now.
    """

    def __init__(
        self,
        A: Callable[[np.ndarray], np.ndarray],
        M: Callable[[np.ndarray], np.ndarray],
        r: np.ndarray,
        dot: Callable[[np.ndarray, np.ndarray], float] = np.dot,
    ) -> None:
        self.A, self.M, self.dot, self.r, self.x = A, M, dot, r, np.zeros(len(r))
        self.p = M(r)
        self.rz = float(dot(r, self.p))
        self.gains: list[float] = []
        self.positive = self.rz >= 0

    @property
    def size(self) -> float:
        """√(r·Mr), of r."""
        return float(np.sqrt(max(self.rz, 0)))

    def Step(self) -> None:
        """The next approximation."""
        q = self.A(self.p)
        curvature = float(self.dot(q, self.p))
        step = self.rz / curvature
        self.x += step * self.p
        self.r -= step * q
        self.gains.append(step * self.rz)
        z = self.M(self.r)
        self.rz, before = float(self.dot(self.r, z)), self.rz
        self.positive = self.positive and curvature > 0 and self.rz >= 0
        self.p = z + self.rz / before * self.p

    def Reach(self, size: Callable[[], float], remedy: str) -> int:
        """Steps until the residual is as small as a number, which may change with them; returns how many.

        Raises
        ------
        NotCoercive
            Where A is not positive definite in a direction that is met.
        NotConverged
            After MOST steps altogether, with the remedy.
        """
        before = len(self.gains)
        while self.size > size() or not self.positive:
            if not self.positive:
                raise NotCoercive(f"conjugate gradients met a displacement of negative energy: {NOT_POSITIVE}")
            self.Step()
            if len(self.gains) >= MOST:
                raise NotConverged(
                    f"conjugate gradients left {self.size:.1e} in the energy norm, which should be {size():.1e}, after {MOST} steps: look for flat elements, or "
                    f"moduli that differ by many orders of magnitude; {remedy}"
                )
        return len(self.gains) - before


def conjugate_gradients(A: Callable[[np.ndarray], np.ndarray], M: Callable[[np.ndarray], np.ndarray], r: np.ndarray, accuracy: float, most: int) -> Found:
    """Solves A x = r with the preconditioner M until what is missing of the energy is less than `accuracy` of it, in `most` steps at most.

    Parameters
    ----------
    A, M
        Symmetric and positive (semi-)definite, as functions of vectors; x stays in the range of M.
    """
    iteration = ConjugateGradients(A, M, r.copy())
    found = Found(iteration.x, iteration.gains)
    while iteration.rz > 0 and len(found.gains) < most:
        iteration.Step()
        if len(found.gains) > 1 and found.missing <= accuracy * found.energy:
            break
    return found
