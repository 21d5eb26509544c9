"""The semi-smooth Newton method for contact with friction, on the crack's own unknowns.

With the displacements eliminated the problem is: find p = (p_n, p_t), w = Q p + q with, at each of m nodes,

    p_n ≤ 0,  w_n ≤ 0,  p_n w_n = 0,
    |p_t| ≤ s,  w_t = 0 where |p_t| < s,  w_t ≤ 0 where p_t = s,  w_t ≥ 0 where p_t = -s,

Q positive definite (symmetric except for Nitsche's method with θ ≠ 1). -w_n is a mean of the gap, -w_t of the slip, so p_t has the sign of the slip. Where s is
given (Tresca) there is one solution, for symmetric Q the minimum of ½p·Qp + q·p between bounds; where s = slope |p_n| (Coulomb) it is the solution
of a quasi-variational inequality, which need not be unique. In the projection form, y = p - r w with any r > 0,

    p_n = min(0, y_n),    p_t = min(s, max(-s, y_t)),    s = s(y_n),

each node is open or in contact and sticks, slips in one of two directions, or has no threshold. For given states the
problem is linear; Newton's method solves it and reads the next states from y, until they repeat.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..errors import NotConverged
from .active_set import ROUND_OFF
from .compliance import Compliance

if TYPE_CHECKING:
    from ngsolve.comp import SumOfIntegrals

FREE, SLIP_PLUS, SLIP_MINUS, STICK = 0, 1, -1, 2


@dataclass(frozen=True)
class Threshold:
    """s = base + slope |p_n| at each node, arrays ≥ 0; in_contact_only, at all nodes or (n,): zero where a node is not in contact."""

    base: np.ndarray
    slope: np.ndarray
    in_contact_only: bool | np.ndarray = False

    @property
    def is_fixed(self) -> bool:
        """Whether s does not depend on the solution."""
        return not np.any(self.in_contact_only) and not self.slope.any()

    def At(self, p_n: np.ndarray, contact: np.ndarray) -> np.ndarray:
        """s for normal values and nodes in contact."""
        base = np.where(contact | ~np.asarray(self.in_contact_only), self.base, 0)
        return base + self.slope * np.where(contact, np.maximum(-p_n, 0), 0)

    def Scaled(self, factor: float) -> Threshold:
        """For values p / factor."""
        return replace(self, base=self.base / factor)


@dataclass(frozen=True)
class States:
    """contact: (m,) bool.

    Parameters
    ----------
    tangential
        (m,) int: STICK, SLIP_PLUS (p_t = s), SLIP_MINUS (p_t = -s), FREE (s = 0).
    """

    contact: np.ndarray
    tangential: np.ndarray

    @property
    def key(self) -> bytes:
        """For comparison and sets."""
        return self.contact.tobytes() + self.tangential.tobytes()


@dataclass
class NodalResult:
    """The solution p, the states of each iteration, the steps of the safeguard, and what led to p, in words."""

    p: np.ndarray
    states: list[States]
    fallback: int = 0
    method: str = ""
    threshold_changes: list[float] = field(default_factory=list)

    @property
    def iterations(self) -> int:
        """Sets of states that were tried, the first one among them."""
        return len(self.states)


class Cycle(Exception):
    """Newton's method left its track: a set of states came back, or its matrix was singular."""

    def __init__(self, states: list[States], reason: str) -> None:
        super().__init__(reason)
        self.states = states


def solve_states(Q: Compliance, q: np.ndarray, threshold: Threshold, states: States) -> tuple[np.ndarray, np.ndarray]:
    """p and w for given states: w_n = 0 in contact, w_t = 0 where the node sticks, p_n = 0 and p_t = 0, s or -s elsewhere."""
    contact, m = states.contact, len(states.contact)
    stick = states.tangential == STICK
    sign = np.where(stick, 0, states.tangential)
    follows = np.where(contact, -sign * threshold.slope, 0)  # of p_t with p_n where the node slips
    unknown = np.concatenate([contact, stick])
    base = np.concatenate([np.zeros(m), sign * threshold.base])
    solve = _by_inverse if 2 * np.count_nonzero(unknown) > len(q) else _by_block
    p = solve(Q, q, base, follows, unknown)
    p[:m] = np.where(contact, p[:m], 0)
    p[m:] = np.where(stick, p[m:], base[m:] + follows * p[:m])
    w = Q.matrix @ p + q
    w[unknown] = 0
    return p, w


def _by_block(Q: Compliance, q: np.ndarray, base: np.ndarray, follows: np.ndarray, unknown: np.ndarray) -> np.ndarray:
    """p with w = 0 where it is unknown, p_n = 0 and p_t = base + follows p_n elsewhere: equations for the unknown."""
    m, p = len(follows), np.where(unknown, 0, base)
    contact, number = unknown[:m], np.count_nonzero(unknown[:m])
    matrix = Q.matrix[np.ix_(unknown, unknown)]
    matrix[:, :number] += Q.matrix[unknown, m:][:, contact] * follows[contact]
    p[unknown] = np.linalg.solve(matrix, -(q + Q.matrix @ p)[unknown])
    return p


def _by_inverse(Q: Compliance, q: np.ndarray, base: np.ndarray, follows: np.ndarray, unknown: np.ndarray) -> np.ndarray:
    """The same: equations for the w of the others."""
    m, known = len(follows), np.flatnonzero(~unknown)
    slides = known >= m
    partner = known[slides] - m  # whose normal part p_t follows
    factor = follows[partner]
    matrix = Q.inverse[np.ix_(known, known)]
    matrix[slides] -= factor[:, None] * Q.inverse[np.ix_(partner, known)]

    def solved(rest: np.ndarray, given: np.ndarray) -> np.ndarray:
        still = Q.inverse @ rest
        forces = given + still[known]
        forces[slides] -= factor * still[partner]
        w = np.zeros(len(rest))
        w[known] = np.linalg.solve(matrix, forces)
        return Q.inverse @ w - still

    p = solved(q, base[known])
    rest = np.where(unknown, Q.matrix @ p + q, 0)
    wrong = base[known] - p[known]
    wrong[slides] += factor * p[partner]
    return p + solved(rest, wrong)  # one step of refinement


def first_states(Q: Compliance, q: np.ndarray, threshold: Threshold, contact: np.ndarray) -> States:
    """States for given nodes in contact: all nodes with a threshold stick, if that exceeds no threshold; else all slip as without friction.

    Slip regions shrink in a few Newton steps, sticking ones from their ends only, a node or two in each step.
    """
    contact = np.array(contact, dtype=bool)
    m = len(contact)
    has_threshold = threshold.At(-np.ones(m), contact) > 0
    stick = States(contact, np.where(has_threshold, STICK, FREE))
    p, _ = solve_states(Q, q, threshold, stick)
    if (np.abs(p[m:]) <= threshold.At(p[:m], contact)).all():
        return stick
    _, w = solve_states(Q, q, threshold, States(contact, np.full(m, FREE)))
    return States(contact, np.where(has_threshold, np.where(w[m:] > 0, SLIP_MINUS, SLIP_PLUS), FREE))


def next_states(p: np.ndarray, w: np.ndarray, r: np.ndarray, threshold: Threshold, states: States) -> States:
    """The states that y = p - r w asks for; a node changes only by more than round-off."""
    m = len(states.contact)
    y = p - r * w
    tolerance = ROUND_OFF * np.abs(y).max()
    contact = y[:m] < np.where(states.contact, 1, -1) * tolerance
    s, y_t, old = threshold.At(y[:m], contact), y[m:], states.tangential
    plus = y_t - s > np.where(old == SLIP_PLUS, -tolerance, tolerance)
    minus = -y_t - s > np.where(old == SLIP_MINUS, -tolerance, tolerance)
    tangential = np.where(plus & ~(minus & (old == SLIP_MINUS)), SLIP_PLUS, np.where(minus, SLIP_MINUS, STICK))
    return States(contact, np.where(s > 0, tangential, FREE))


def newton(Q: Compliance, q: np.ndarray, threshold: Threshold, r: np.ndarray, start: States, max_iterations: int) -> NodalResult:
    """A NodalResult; raises Cycle, and NotConverged after max_iterations.

    Parameters
    ----------
    r
        (2m,), positive.
    """
    states, history, seen = start, [start], {start.key}
    for _ in range(max_iterations):
        try:
            p, w = solve_states(Q, q, threshold, states)
        except np.linalg.LinAlgError:
            raise Cycle(history, "the Newton matrix is singular") from None
        new = next_states(p, w, r, threshold, states)
        history.append(new)
        if new.key == states.key:
            return NodalResult(p, history)
        if new.key in seen:
            raise Cycle(history, "a set of states came back")
        seen.add(new.key)
        states = new
    sizes = [int(s.contact.sum()) for s in history[-5:]]
    raise NotConverged(
        f"the nodal states still changed after {max_iterations} iterations (in contact {sizes}): allow more by max_iterations=..., or give a better start=..."
    )


def violation(p: np.ndarray, w: np.ndarray, threshold: Threshold) -> float:
    """The largest violation of the conditions at the nodes, for p and w scaled to 1."""
    m = len(p) // 2
    p_n, p_t, w_n, w_t = p[:m], p[m:], w[:m], w[m:]
    s = threshold.At(p_n, p_n < 0)
    normal = np.concatenate([p_n, w_n, np.minimum(-p_n, -w_n)])
    tangential = np.concatenate([np.abs(p_t) - s, np.minimum(s - p_t, -w_t), np.minimum(s + p_t, w_t)])
    return float(max(normal.max(), tangential.max(), 0))


def uniqueness_number(Q: np.ndarray, slope: np.ndarray) -> float:
    """A number below 1 proves that Coulomb's law has one solution, for all loads: see docs/method.md, section 7.

    The difference of two solutions satisfies δp_n δw_n ≤ 0 and δp_t δw_t ≤ slope |δp_n| |δw_t| at each node, δw = Qδp, so
    that for any α > 0, α δp_n·δw_n + δp_t·δw_t ≤ Σ slope |δp_n| |δw_t|. The number is the largest ratio of
    ½ (τ ‖M slope δp_n‖² + ‖M⁻¹δw_t‖²/τ), which is not less than the right side, to the left side; M² = diag Q_tt, τ
    balances both terms. For symmetric Q the left side is positive for α < ((1 + √(1 - c²))/c)², c the largest correlation of normal and
    tangential parts; a third of that, and 1, are tried. Where they are coupled weakly the number is small whatever the slope is.
    """
    m = len(slope)
    if not slope.any():
        return 0.0
    symmetric = 0.5 * (Q + Q.T)
    correlation = np.sqrt(max(_largest(symmetric[:m, m:] @ np.linalg.solve(symmetric[m:, m:], symmetric[m:, :m]), symmetric[:m, :m]), 0))
    alpha = max(1, ((1 + np.sqrt(max(1 - correlation**2, 0))) / max(correlation, 1e-8)) ** 2 / 3)
    M2 = np.diag(Q)[m:]
    normal = np.diag(np.concatenate([M2 * slope**2, np.zeros(m)]))
    tangential = Q[m:].T / M2 @ Q[m:]
    numbers = [_balanced_ratio(normal, tangential, Q * np.repeat([weight, 1], m)[:, None]) for weight in {1, alpha}]
    return min(numbers)


def _balanced_ratio(normal: np.ndarray, tangential: np.ndarray, form: SumOfIntegrals) -> float:
    """The largest ratio of ½ (τ normal + tangential/τ) to form, or inf where form is not positive."""
    form = 0.5 * (form + form.T)
    try:
        tau = np.sqrt(_largest(tangential, form) / _largest(normal, form))
        return _largest(0.5 * (tau * normal + tangential / tau), form)
    except np.linalg.LinAlgError:
        return np.inf


def _largest(A: np.ndarray, form: SumOfIntegrals) -> float:
    """The largest eigenvalue of A x = θ form x."""
    return float(scipy.linalg.eigvalsh(A, form, subset_by_index=[len(A) - 1, len(A) - 1])[0])
