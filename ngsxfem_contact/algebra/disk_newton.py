"""Contact with friction in space, on the crack's own unknowns: semi-smooth Newton with the projection onto disks.

With the displacements eliminated the problem is: find p = (p_n, p_t), p_t ∈ R² at each of m nodes, w = Q p + q with

    p_n ≤ 0,  w_n ≤ 0,  p_n w_n = 0,    |p_t| ≤ s,  w_t = -α p_t with α ≥ 0,  α = 0 where |p_t| < s.

-w_t is a mean of the slip, so p_t has its direction where a node slips. In the projection form, y = p - r w with any r > 0,

    p_n = min(0, y_n),    p_t = s y_t / max(s, |y_t|),    s = base + slope |p_n|.

Q scaled by its diagonal is well conditioned, so that some accelerated steps of the projected gradient (Beck and Teboulle, SIAM J. Imaging Sci. 2 (2009) 183-202; restarts: O'Donoghue and
Candès, Found. Comput. Math. 15 (2015) 715-732) come near, and Newton's method, which from farther away cycles among nodes that stick, ends it. Its matrix has at a node in contact w_n' = 0
else p_n' = 0, where it sticks w_t' = 0, and where it slips, e = y_t/|y_t|,
p_t' - (s/|y_t|) (1 - e eᵀ) (p_t' - r w_t') - e s' = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..errors import NotConverged

if TYPE_CHECKING:
    from .nodal_newton import Threshold

TOLERANCE = 1e-11  # of the residual, relative to the largest |y| of its kind
TINY = np.finfo(float).tiny
FIRST_STEPS = (30, 300)  # of the projected gradient before Newton's method, which may cycle from farther away


def projection(y: np.ndarray, s: np.ndarray) -> np.ndarray:
    """(3, m): of y onto p_n ≤ 0 and |p_t| ≤ s."""
    return np.array([np.minimum(0, y[0]), *(s / np.maximum(np.maximum(s, np.linalg.norm(y[1:], axis=0)), TINY) * y[1:])])


def slope_of_disks(y: np.ndarray, s: np.ndarray) -> np.ndarray:
    """(2, 2, m): the derivative of the projection onto disks by y, (2, m)."""
    size = np.maximum(np.linalg.norm(y, axis=0), TINY)
    slip, e = size > s, y / size
    return np.minimum(s, size) / size * (np.eye(2)[:, :, None] - np.where(slip, 1.0, 0.0) * e[:, None] * e[None])


@dataclass
class DiskResult:
    """The solution p, (3, m); per iteration the nodes in contact, and at the end those that slip, boolean; changes of the threshold of a fixed point."""

    p: np.ndarray
    contact: list[np.ndarray]
    slip: np.ndarray
    method: str
    threshold_changes: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class DiskProblem:
    """Q (3m, 3m), q (3m,): all normal components first, then those along the two tangents; threshold: s at the nodes."""

    Q: np.ndarray
    q: np.ndarray
    threshold: Threshold

    @property
    def r(self) -> np.ndarray:
        """(3, m): of the projections, the same for both tangents."""
        normal, first, second = np.diag(self.Q).reshape(3, -1)
        return 1 / np.array([normal, 0.5 * (first + second), 0.5 * (first + second)])

    def Trial(self, p: np.ndarray) -> np.ndarray:
        """y, (3, m)."""
        return p - self.r * (self.Q @ p.ravel() + self.q).reshape(3, -1)

    def Threshold(self, p: np.ndarray, y: np.ndarray) -> np.ndarray:
        """s, (m,)."""
        return self.threshold.At(p[0], y[0] < 0)

    def Residual(self, p: np.ndarray) -> np.ndarray:
        """p - projection of y, (3, m)."""
        y = self.Trial(p)
        return p - projection(y, self.Threshold(p, y))

    def Step(self, p: np.ndarray) -> np.ndarray:
        """Newton's correction, (3, m)."""
        m, y = p.shape[1], self.Trial(p)
        s, size = self.Threshold(p, y), np.maximum(np.linalg.norm(y[1:], axis=0), TINY)
        contact, slip, e = y[0] < 0, size > s, y[1:] / size
        # rows: P p' + W w', W = r (projection's derivative) where it is not the identity
        slope = np.where(contact & (p[0] < 0), -self.threshold.slope, 0.0)
        turn = slope_of_disks(y[1:], s)
        J = np.zeros((3, m, 3 * m))
        Q = self.Q.reshape(3, m, 3 * m)
        node = np.arange(m)
        J[0] = np.where(contact, self.r[0], 0.0)[:, None] * Q[0]
        J[0, node, node] += np.where(contact, 0.0, 1.0)
        for a in range(2):
            for b in range(2):
                J[1 + a] += (turn[a, b] * self.r[1 + b])[:, None] * Q[1 + b]
                J[1 + a, node, (1 + b) * m + node] += (a == b) - turn[a, b]
            J[1 + a, node, node] -= np.where(slip, e[a] * slope, 0.0)
        return np.linalg.solve(J.reshape(3 * m, 3 * m), -self.Residual(p).ravel()).reshape(3, m)

    def Size(self, p: np.ndarray) -> float:
        """The largest residual, relative."""
        y, residual = self.Trial(p), self.Residual(p)
        return float(np.abs(residual).max() / max(np.abs(y).max(), np.abs(p).max(), TINY))

    def Approached(self, p: np.ndarray, steps: int) -> np.ndarray:
        """p after accelerated steps of the projected gradient in the metric of r, with restarts; thresholds follow p_n."""
        root = np.sqrt(self.r).ravel()
        largest = scipy.sparse.linalg.eigsh(self.Q * root * root[:, None], k=1, which="LA", tol=1e-2, v0=np.ones(len(root)), return_eigenvectors=False)[0]
        r, ahead, momentum = self.r / (1.05 * largest), p, 1.0
        for _ in range(steps):
            y = ahead - r * (self.Q @ ahead.ravel() + self.q).reshape(3, -1)
            new = projection(y, self.Threshold(ahead, y))
            if ((ahead - new) / r * (new - p)).sum() > 0:
                momentum = 1.0
            momentum, before = 0.5 * (1 + np.sqrt(1 + 4 * momentum**2)), momentum
            ahead, p = new + (before - 1) / momentum * (new - p), new
        return p


def newton(problem: DiskProblem, p: np.ndarray, max_iterations: int) -> DiskResult:
    """From p, with steps halved as long as the residual does not fall; raises NotConverged."""
    contact, size = [problem.Trial(p)[0] < 0], problem.Size(p)
    for _ in range(max_iterations):
        if size < TOLERANCE:
            y = problem.Trial(p)
            slip = np.linalg.norm(y[1:], axis=0) > problem.Threshold(p, y) * (1 + 1e-9)
            return DiskResult(p, contact, slip, "Newton with projections onto disks")
        try:
            step = problem.Step(p)
        except np.linalg.LinAlgError:
            break
        part, new = 1.0, p + step
        while (next_size := problem.Size(new)) > 0.999 * size and part > 1e-3:
            part *= 0.5
            new = p + part * step
        if part <= 1e-3:
            new = p + step  # a full step may leave a cycle of short ones
            next_size = problem.Size(new)
        p, size = new, next_size
        contact.append(problem.Trial(p)[0] < 0)
    raise NotConverged(
        f"friction: Newton's method left a residual of {size:.1e} after {len(contact)} steps; allow more by max_iterations=..., or take smaller load steps"
    )


def newton_from_afar(problem: DiskProblem, p: np.ndarray, max_iterations: int) -> DiskResult:
    """Newton's method from where the projected gradient has led; raises NotConverged."""
    for steps in FIRST_STEPS:
        try:
            return newton(problem, problem.Approached(p, steps), max_iterations)
        except NotConverged as failure:
            last = failure
    raise last


def fixed_point(problem: DiskProblem, p: np.ndarray, max_iterations: int, tolerance: float = 1e-10, most: int = 200) -> DiskResult:
    """Thresholds that follow p_n, each a problem with one solution; raises NotConverged."""
    changes: list[float] = []
    contact: list[np.ndarray] = []
    s = problem.Threshold(p, problem.Trial(p))
    for _ in range(most):
        given = DiskProblem(problem.Q, problem.q, replace(problem.threshold, base=s, slope=np.zeros_like(s), in_contact_only=False))
        result = newton_from_afar(given, p, max_iterations)
        p, contact = result.p, contact + result.contact
        new = problem.Threshold(p, problem.Trial(p))
        changes.append(float(np.abs(new - s).max() / max(np.abs(new).max(), TINY)))
        s = new
        if changes[-1] < tolerance:
            return DiskResult(p, contact, result.slip, f"fixed point on the threshold ({len(changes)} steps)", changes)
    raise NotConverged(f"friction: the fixed point on the threshold still changed it by {changes[-1]:.1e}; Coulomb's law may have no or several solutions here")


def solve_disks(problem: DiskProblem, p: np.ndarray, max_iterations: int) -> DiskResult:
    """Newton's method on the whole law; where it fails, thresholds one after the other."""
    try:
        return newton_from_afar(problem, p, max_iterations)
    except NotConverged:
        if not problem.threshold.slope.any():
            raise
        return fixed_point(problem, p, max_iterations)
