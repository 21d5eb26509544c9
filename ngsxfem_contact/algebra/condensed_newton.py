"""Contact in the condensed form: multipliers are eliminated node by node, Newton's method runs on the displacements (docs/method.md, section 19).

With D diagonal the second row of (38) says p = P(y), y = D⁻¹(G - E U), P the projection onto p_n ≤ 0 and, with friction, |p_t| ≤ s. What is left is

    A U - Eᵀ P(D⁻¹(G - E U)) = F,

for a given threshold s the derivative of a convex function of U. Newton's matrix is A + EᵀH E with H = P'(y) D⁻¹, symmetric and positive definite whatever the
nodes do. Systems are solved by conjugate gradients as exactly as what the nodes do is known: while it does not change they go on. Where it does, without friction, the nodes
settle: a step of Newton's method around the cracks with all else at rest, which costs new factors and no conjugate gradients.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..errors import NotCoercive, NotConverged
from .conjugate_gradients import ACCURACY, NOT_POSITIVE, ConjugateGradients
from .disk_newton import projection, slope_of_disks

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from .condensed import CondensedMatrix
    from .nodal_newton import Threshold

ROUND, FRICTION_ROUND = 1e-1, 2e-2  # by which conjugate gradients reduce a residual before the nodes are looked at; with friction each look costs new factors
SETTLED = 20  # steps after which nodes are not settled any more, so that the energy falls at each step
ROUND_OFF = 1e-8  # of the largest y: nodes change sides by more
HUGE = 1e200  # a threshold below which all nodes stick


@dataclass
class Linearised:
    """P near y: p + slope (y' - y); s the bound that it was taken for."""

    contact: np.ndarray
    s: np.ndarray
    p: np.ndarray
    slope: np.ndarray

    def IsSame(self, other: Linearised) -> bool:
        """Whether both are one function."""
        return np.array_equal(self.contact, other.contact) and np.array_equal(self.slope, other.slope)


@dataclass(frozen=True)
class FaceTerms:
    """P and what it is applied to, at m nodes with k components, all normal ones first.

    Parameters
    ----------
    E
        (k m, n).
    D
        (k m,), > 0, the same for all components of a node.
    G
        (k m,).
    threshold
        Of k = 3 components; None for k = 1, without friction.
    """

    E: csr_matrix
    D: np.ndarray
    G: np.ndarray
    threshold: Threshold | None = None

    @property
    def k(self) -> int:
        """Components."""
        return 1 if self.threshold is None else 3

    def Trial(self, U: np.ndarray) -> np.ndarray:
        """y, (k, m)."""
        return ((self.G - self.E @ U) / self.D).reshape(self.k, -1)

    @property
    def follows_pressure(self) -> bool:
        """Whether the threshold does."""
        return self.threshold is not None and not self.threshold.is_fixed

    def At(self, y: np.ndarray, contact: np.ndarray) -> Linearised:
        """P near y; nodes that hardly change sides stay as they were, contact: (m,) bool."""
        contact = y[0] < np.where(contact, 1, -1) * ROUND_OFF * np.abs(y).max(initial=0)
        return self.Near(y, contact, self.Bound(y))

    def Bound(self, y: np.ndarray) -> np.ndarray:
        """s, (m,)."""
        return np.zeros(y.shape[1]) if self.threshold is None else self.threshold.At(np.minimum(y[0], 0), y[0] < 0)

    def Near(self, y: np.ndarray, contact: np.ndarray, s: np.ndarray) -> Linearised:
        """P near y for nodes in contact and thresholds."""
        slope = np.zeros((self.k, self.k, len(contact)))
        slope[0, 0] = contact
        if self.threshold is not None:
            slope[1:, 1:] = slope_of_disks(y[1:], s)
        return Linearised(contact, s, np.concatenate([np.where(contact, y[:1], 0), self.Project(y, s)[1:]]), slope)

    def Project(self, y: np.ndarray, s: np.ndarray) -> np.ndarray:
        """P(y), (k, m)."""
        return np.minimum(0, y) if self.threshold is None else projection(y, s)

    def Matrix(self, slope: np.ndarray) -> csr_matrix:
        """H, (k m, k m), for P'(y)."""
        a, b, node = np.nonzero(slope)
        size, m = len(self.D), slope.shape[2]
        return scipy.sparse.csr_matrix((slope[a, b, node] / self.D[node], (a * m + node, b * m + node)), shape=(size, size))

    def Energy(self, y: np.ndarray, s: np.ndarray) -> float:
        """Whose derivative by E U is -P(y), for a given s."""
        p = self.Project(y, s)
        return float((self.D.reshape(p.shape) * p * (y - 0.5 * p)).sum())


@dataclass
class CondensedResult:
    """U and p, (k, m); the nodes in contact at each step, and those that slip at the end, (m,) bool; steps of conjugate gradients for each matrix."""

    U: np.ndarray
    p: np.ndarray
    contact: list[np.ndarray]
    slip: np.ndarray
    linear_iterations: list[int]


class CondensedNewton:
    """Solves A U - Eᵀ P(D⁻¹(G - E U)) = F on the free unknowns.

    Parameters
    ----------
    U
        To begin with; it has the given values on those that are not free.
    contact
        Nodes in contact at first, (m,) bool, which stick, before there is a pressure that says how much friction there is; None: as U says.
    """

    def __init__(self, matrix: CondensedMatrix, terms: FaceTerms, F: np.ndarray, U: np.ndarray, contact: np.ndarray | None) -> None:
        self.matrix, self.terms, self.F = matrix, terms, F
        self._move_to(U)
        self.law = terms.At(self.y, self.y[0] < 0)
        if contact is not None:
            self.law = terms.Near(self.y, contact, np.where(contact, HUGE, 0) if terms.follows_pressure else self.law.s)
        self.contact, self.linear_iterations = [self.law.contact], []

    def _move_to(self, U: np.ndarray) -> None:
        self.U, self.AU, self.y = U, self.matrix.A @ U, self.terms.Trial(U)

    @property
    def size(self) -> float:
        """Of U in the energy norm."""
        return float(np.sqrt(max(self.U @ self.AU, 0)))

    def Solve(self, max_iterations: int) -> CondensedResult:
        """The CondensedResult.

        Raises
        ------
        NotConverged
            Where nodes go on changing, and where conjugate gradients stall.
        NotCoercive
            Where A is not positive definite.
        """
        for number in range(max_iterations):
            self._factorise()
            if self.terms.threshold is None and 0 < number < SETTLED:
                self._settle()
            if self._step(first=number == 0):
                slip = np.linalg.norm(self.y[1:], axis=0) > self.law.s * (1 + 1e-9)
                return CondensedResult(self.U, self.law.p, self.contact, slip, self.linear_iterations)
            self.contact.append(self.law.contact)  # those of the next step, when it begins
        raise NotConverged(
            f"the nodes still changed after {max_iterations} iterations (in contact {[int(a.sum()) for a in self.contact[-5:]]}): allow more by max_iterations=..., "
            "or give a better start=..."
        )

    def _factorise(self) -> None:
        self.matrix.Set(self.terms.Matrix(self.law.slope))
        if not self.matrix.positive:
            raise NotCoercive(f"{NOT_POSITIVE} (a pivot around the cracks is negative)")

    @property
    def _rhs(self) -> np.ndarray:
        """Of Newton's equation."""
        return self.F + self.terms.E.T @ self.law.p.ravel() - self.AU

    def _settle(self) -> None:
        """A step around the cracks."""
        before, rhs = self.law, self._rhs
        self._move_to(self.U + self.matrix.Extend(np.zeros(len(self.matrix.body)), rhs))
        self.law = self.terms.At(self.y, before.contact)
        if not before.IsSame(self.law):
            self._factorise()
            self.contact[-1] = self.law.contact

    def _step(self, first: bool) -> bool:
        """Towards the solution for the linearised P, and P there; True: that is the solution."""
        rhs = self._rhs
        found = ConjugateGradients(self.matrix.Apply, self.matrix.Precondition, self.matrix.Condense(rhs))
        size = 0.0 if first else self.size
        self.linear_iterations.append(0)
        if found.size <= ACCURACY * size and self.matrix.outside.any():  # where all is around the cracks the residual is on them
            return True
        part = ROUND if self.terms.threshold is None else FRICTION_ROUND
        while True:
            self._iterate(found, max(part * found.size, 0.5 * ACCURACY * size))
            delta = self.matrix.Extend(found.x, rhs)
            there = self.terms.At(self.terms.Trial(self.U + delta), self.law.contact)
            if not self.law.IsSame(there):
                self._move_to(self.U + (1.0 if first else self._part(delta)) * delta)
                self.law = self.terms.At(self.y, self.law.contact)
                return False
            size = self._size_at(delta)
            if found.size <= ACCURACY * size:
                self._move_to(self.U + delta)
                self.law = self.terms.At(self.y, self.law.contact)
                return True

    def _size_at(self, delta: np.ndarray) -> float:
        U = self.U + delta
        return float(np.sqrt(max(U @ (self.matrix.A @ U), 0)))

    def _iterate(self, found: ConjugateGradients, size: float) -> None:
        """Steps of conjugate gradients until the residual is as small as a number."""
        self.linear_iterations[-1] += found.Reach(lambda: size, 'inverse="sparsecholesky" solves directly')

    def _part(self, delta: np.ndarray) -> float:
        """How much of a step is taken: all, or where the function whose derivative is zero at the solution would grow half of it, ..."""
        change = -(self.terms.E @ delta / self.terms.D).reshape(self.y.shape)
        linear, square = float(delta @ (self.AU - self.F)), float(delta @ (self.matrix.A @ delta))
        energy = lambda part: part * linear + 0.5 * part**2 * square + self.terms.Energy(self.y + part * change, self.law.s)
        part, before = 1.0, self.terms.Energy(self.y, self.law.s)
        while energy(part) - before > 1e-12 * (abs(before) + square) and part > 1e-3:
            part *= 0.5
        return part
