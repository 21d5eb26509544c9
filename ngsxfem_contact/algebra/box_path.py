"""The complementarity problem between bounds, along a path: what takes over where Newton's method cycles.

Find lower ≤ p ≤ upper and w = Q p + q with w_i = 0 inside, w_i ≤ 0 where p_i = upper_i, w_i ≥ 0 where p_i = lower_i. For every
P-matrix Q, all positive definite ones among them, symmetric or not, there is one solution for each q. q is replaced by one whose
solution has given states, and moves back on a line, 0 ≤ t ≤ 1. The solution is linear in t as long as the states hold. They change
where a bound is met: each set of states holds on one interval of t, so that none comes back and the path ends.
"""

import numpy as np

from ..errors import NotConverged

INSIDE, AT_UPPER, AT_LOWER = 0, 1, -1


def follow_path(Q, q, lower, upper, states):
    """p, its states and the number of changes on the way; raises NotConverged after 100 changes for each unknown.

    Parameters
    ----------
    Q
        (n, n), any scaling.
    lower, upper
        May be infinite, or equal, where w is free.
    states
        (n,) INSIDE, AT_UPPER or AT_LOWER.
    """
    scale = 1 / np.sqrt(np.diag(Q))
    path = Path(Q * scale * scale[:, None], scale * q, lower / scale, upper / scale, np.array(states))
    for changes in range(100 * len(q)):
        if path.Advance():
            p, _ = path.At(path.q)
            return np.where(path.states == INSIDE, scale * p, np.where(path.states == AT_UPPER, upper, lower)), path.states, changes
    raise NotConverged(
        f"the nodal states still changed after {100 * len(q)} changes of single nodes: the matrix of the crack's unknowns is not positive definite "
        "to round-off; change the mesh where the crack is"
    )


class Path:
    """The solutions for q(t) = q + (1 - t) shift, from t on; Q has a diagonal of 1."""

    def __init__(self, Q, q, lower, upper, states):
        self.Q, self.q, self.lower, self.upper, self.states, self.t = Q, q, lower, upper, states, 0.0
        self.shift = self._shift()

    def At(self, q):
        """p and w for some q and the present states."""
        inside = self.states == INSIDE
        p = np.where(inside, 0, np.where(self.states == AT_UPPER, self.upper, self.lower))
        return self._complete(p, q, inside)

    def _complete(self, p, q, inside):
        p[inside] = np.linalg.solve(self.Q[np.ix_(inside, inside)], -(q + self.Q @ p)[inside])
        w = self.Q @ p + q
        w[inside] = 0
        return p, w

    def _shift(self):
        """What q needs to be added for the states to hold: violated ones by generic margins, so that bounds are met one at a time."""
        p, w = self.At(self.q)
        size = max(np.abs(p).max(), np.abs(w).max())
        margin = size * np.random.default_rng(0).uniform(0.1, 1, len(p))
        room = np.minimum(margin, 0.3 * (self.upper - self.lower))
        held = self.states == INSIDE
        right = np.where(held & (p > self.upper), self.upper - room, np.where(held & (p < self.lower), self.lower + room, p))
        violated = self._is_free_to_move() & (self.states * w > 0)
        wanted = np.where(violated, -self.states * margin, w)
        return wanted - self.Q @ right - self.q

    def _is_free_to_move(self):
        return (self.states != INSIDE) & (self.lower < self.upper)

    def Advance(self, last=1 - 1e-13):
        """Changes the state whose bound is met next; True if none is before t = 1."""
        inside, movable = self.states == INSIDE, self._is_free_to_move()
        p, w = self.At(self.q + self.shift)
        dp, dw = self._complete(np.zeros(len(p)), -self.shift, inside)
        meets = np.stack([
            first_zero(self.upper - p, -dp, inside), first_zero(p - self.lower, dp, inside), first_zero(-self.states * w, -self.states * dw, movable)
        ])  # fmt: skip
        kind, i = np.unravel_index(np.argmin(np.maximum(meets, self.t)), meets.shape)
        self.t = max(self.t, meets[kind, i])
        if self.t >= last:
            return True
        self.states[i] = (AT_UPPER, AT_LOWER, INSIDE)[kind]
        return False


def first_zero(value, rate, where):
    """The t at which value + t rate falls to zero; infinite where it does not, or need not be looked at."""
    falls = where & np.isfinite(value) & (rate < 0)
    return np.where(falls, value / np.where(falls, -rate, 1), np.inf)
