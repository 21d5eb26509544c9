"""The semi-smooth Newton method for (39) of [AHLMR12], which is an active-set method, on the crack's own unknowns.

With the displacements eliminated the problem is: find p ≤ 0 with w = Q p + q ≤ 0 and p·w = 0, Q positive definite, symmetric
except for Nitsche's method with θ ≠ 1. Its projection form p = min(0, p - r w) is solved by: i is active (in contact) where p_i - r w_i < 0; active
rows read w_i = 0, the others p_i = 0. After one step either p_i or w_i is zero, so the answer and, from the second step
on, the iterates do not depend on r > 0. An index changes sides only by more than round-off: where contact is lost with
zero pressure, p_i and w_i are both zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..errors import NotConverged, NotHeld
from .box_path import AT_UPPER, INSIDE, follow_path

ROUND_OFF = 1e-12


@dataclass
class ActiveSetResult:
    """The solution p, the active set of each iteration (boolean arrays), and the steps of descend after a cycle."""

    p: np.ndarray
    active: list[np.ndarray]
    fallback: int

    @property
    def iterations(self) -> int:
        """Sets that were tried, the first one among them."""
        return len(self.active)


def solve_active_set(Q: np.ndarray, q: np.ndarray, start: np.ndarray | None = None, max_iterations: int = 100) -> ActiveSetResult:
    """Solves p ≤ 0, w = Qp + q ≤ 0, p·w = 0.

    Parameters
    ----------
    Q
        (m, m), positive definite, in any scaling; r = 1/diag(Q).
    start
        First active set, boolean; default empty, see coarse_start.

    Notes
    -----
    If a set comes back (a cycle) a method that decreases the energy at every step takes over, see descend; without symmetry, box_path.
    """
    r = 1 / np.diag(Q)
    active = np.zeros(len(q), dtype=bool) if start is None else np.array(start, dtype=bool)
    if active.shape != q.shape:
        raise ValueError(f"start has {active.size} entries, there are {len(q)} nodal signs; give one boolean for each, or a ContactSolution")
    history = [active]
    seen = {active.tobytes()}
    for _ in range(max_iterations):
        p, w = solve_equalities(Q, q, active)
        y = p - r * w
        new = y < np.where(active, 1, -1) * ROUND_OFF * np.abs(y).max(initial=0)
        history.append(new)
        if np.array_equal(new, active):
            return ActiveSetResult(p, history, 0)
        if new.tobytes() in seen:
            return descend(Q, q, history) if is_symmetric(Q) else along_path(Q, q, history)
        seen.add(new.tobytes())
        active = new
    raise NotConverged(
        f"the active set still changed after {max_iterations} iterations (sizes {[int(a.sum()) for a in history[-5:]]}): allow more by max_iterations=..., or give a better start=..."
    )


def solve_balanced(
    Q: np.ndarray, q: np.ndarray, B: np.ndarray, pull: np.ndarray, start: np.ndarray | None = None, max_iterations: int = 100
) -> tuple[ActiveSetResult, np.ndarray]:
    """Solves p ≤ 0, w = Qp + q + Bα ≤ 0, p·w = 0, Bᵀp + pull = 0 for p and α: rigid motions that only contact holds.

    Parameters
    ----------
    B, pull
        (m, r), the w of the motions, and (r,), the work of the load on them.

    Notes
    -----
    The active set is that of an augmented Lagrangian, Q + BBᵀ/ρ with α += (Bᵀp + pull)/ρ; on it p and α are found exactly. Raises NotHeld where contact
    does not balance the load.
    """
    rho, alpha = np.linalg.norm(B, 2) ** 2 / (1e5 * np.diag(Q).max()), np.zeros(len(pull))
    history: list[np.ndarray] = []
    for _ in range(max_iterations):
        result = solve_active_set(Q + B @ B.T / rho, q + B @ (alpha + pull / rho), start, max_iterations)
        history, start = history + result.active, result.active[-1]
        p, exact, w = balanced_equalities(Q, q, B, pull, start)
        if is_admissible(p, w, Q):
            return ActiveSetResult(p, history, result.fallback), exact
        alpha = alpha + (B.T @ result.p + pull) / rho
    raise NotHeld("contact does not balance the load on parts of the body that only the faces hold: hold them by supports or by friction, or change the load")


def balanced_equalities(Q: np.ndarray, q: np.ndarray, B: np.ndarray, pull: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """p, α and w with w = 0 on the active set, p = 0 elsewhere and Bᵀp + pull = 0, of several the shortest; unknowns in units of their rows."""
    n, r = int(active.sum()), len(pull)
    scale = np.append(
        1 / np.sqrt(np.diag(Q)[active]), 1 / np.maximum(np.linalg.norm(B[active] / np.sqrt(np.diag(Q)[active])[:, None], axis=0), np.finfo(float).tiny)
    )
    matrix = np.block([[Q[np.ix_(active, active)], B[active]], [B[active].T, np.zeros((r, r))]]) * scale * scale[:, None]
    found = scale * np.linalg.lstsq(matrix, -scale * np.append(q[active], pull), rcond=1e-13)[0]
    p = np.zeros(len(q))
    p[active], alpha = found[:n], found[n:]
    w = Q @ p + q + B @ alpha
    return p, alpha, w


def is_admissible(p: np.ndarray, w: np.ndarray, Q: np.ndarray) -> bool:
    """Whether p ≤ 0 and w ≤ 0 but for round-off."""
    scale = np.sqrt(np.diag(Q))
    p, w = p * scale, w / scale
    return max(p.max(), w.max()) <= 1e-9 * max(np.abs(p).max(), np.abs(w).max())


def coarse_start(Q: np.ndarray, q: np.ndarray, neighbours: np.ndarray | None = None, smallest: float = 4) -> tuple[np.ndarray, int]:
    """A first active set from coarser problems, and the number of iterations on them.

    Parameters
    ----------
    neighbours
        Pairs (k, 2) of unknowns beside each other; default each and the next.

    Notes
    -----
    Two neighbours share one unknown, p = P p_c, which keeps p ≤ 0: solve with PᵀQP, Pᵀq, itself started from half as many unknowns.
    """
    m = len(q)
    if neighbours is None:
        neighbours = np.column_stack([np.arange(m - 1), np.arange(1, m)])
    if m <= smallest or len(neighbours) == 0:
        return np.zeros(m, dtype=bool), 0
    shared = pairing(m, neighbours)
    P = scipy.sparse.csr_matrix((np.ones(m), shared, np.arange(m + 1)))
    between = shared[neighbours]
    Qc, qc = P.T @ Q @ P, P.T @ q
    start, iterations = coarse_start(Qc, qc, between[between[:, 0] != between[:, 1]], smallest)
    result = solve_active_set(Qc, qc, start=start)
    return result.active[-1][shared], iterations + result.iterations


def pairing(m: int, neighbours: np.ndarray) -> np.ndarray:
    """Of each of m unknowns the number of the pair that it belongs to; one whose neighbours are all taken is alone."""
    first, taken = np.arange(m), np.zeros(m, dtype=bool)
    for i, j in neighbours:
        if not taken[i] and not taken[j]:
            first[j], taken[[i, j]] = i, True
    return np.unique(first, return_inverse=True)[1]


def solve_equalities(Q: np.ndarray, q: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """p and w with w = 0 on the active set and p = 0 elsewhere."""
    p = np.zeros(len(q))
    if active.any():
        p[active] = np.linalg.solve(Q[np.ix_(active, active)], -q[active])
    w = Q @ p + q
    w[active] = 0
    return p, w


def descend(Q: np.ndarray, q: np.ndarray, history: list[np.ndarray]) -> ActiveSetResult:
    """The active set of Lawson and Hanson (1974): ½pᵀQp + qᵀp falls at every step, so that no set comes back.

    One index enters at a time, that of the largest violation; indices leave where p would become positive. Ends for every
    symmetric positive definite Q, as a rule after about m steps. (Pivoting by the least violated index ends, too, but takes
    2^m steps on the matrices of Fathi, Math. Programming 17 (1979).)
    """
    p, active = np.zeros(len(q)), np.zeros(len(q), dtype=bool)
    scale = 1 / np.sqrt(np.diag(Q))
    for step in range(100 * len(q)):
        w = scale * (Q @ p + q)
        w[active] = 0
        if w.max() <= ROUND_OFF * np.abs(scale * q).max():
            return ActiveSetResult(p, history + [active.copy()], step)
        active[np.argmax(w)] = True
        p, active = move_to_equilibrium(Q, q, p, active)
    raise NotConverged(f"the active set cycles, and {100 * len(q)} steps of descent were not enough: refine or change the mesh where the crack is")


def is_symmetric(Q: np.ndarray) -> bool:
    """But for round-off, in any scaling."""
    scale = 1 / np.sqrt(np.diag(Q))
    return bool((np.abs(Q - Q.T) * scale * scale[:, None]).max() < 1e-10)


def along_path(Q: np.ndarray, q: np.ndarray, history: list[np.ndarray]) -> ActiveSetResult:
    """From the last set, for any positive definite Q."""
    p, states, changes = follow_path(Q, q, np.full(len(q), -np.inf), np.zeros(len(q)), np.where(history[-1], INSIDE, AT_UPPER))
    return ActiveSetResult(p, history + [states == INSIDE], changes)


def move_to_equilibrium(Q: np.ndarray, q: np.ndarray, p: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """To w = 0 on the active set, which gives up indices as long as p would not stay ≤ 0."""
    while True:
        target, _ = solve_equalities(Q, q, active)
        wrong = active & (target > 0)
        if not wrong.any():
            return target, active
        steps = p[wrong] / (p[wrong] - target[wrong])
        p = np.where(active, p + steps.min() * (target - p), 0)
        leaving = np.flatnonzero(wrong)[steps <= steps.min() * (1 + 1e-12)]
        active = active.copy()
        active[leaving] = False
        p[leaving] = 0
