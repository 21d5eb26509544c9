"""The path through the solutions of a complementarity problem between bounds, against enumeration."""

from itertools import product

import numpy as np
import pytest

from ngsxfem_contact.algebra.active_set import ActiveSetResult, along_path, is_symmetric
from ngsxfem_contact.algebra.box_path import AT_LOWER, AT_UPPER, INSIDE, follow_path


def skew(rng, n, size=5):
    A = size * rng.standard_normal((n, n))
    return A - A.T


def positive_definite(rng, n):
    A = rng.standard_normal((n, n))
    return A @ A.T + 0.05 * np.eye(n) + skew(rng, n)


def badly_scaled(rng, n):
    scale = 10.0 ** rng.uniform(-6, 6, n)
    return positive_definite(rng, n) * scale * scale[:, None]


def triangular(rng, n):
    """A P-matrix, all principal minors of which are products of its diagonal, and as a rule not positive definite."""
    return np.tril(10 * rng.standard_normal((n, n)), -1) + np.diag(rng.uniform(0.1, 1, n))


MATRICES = {"positive definite": positive_definite, "badly scaled": badly_scaled, "P": triangular}


def bounds(rng, n):
    """Some infinite, some equal."""
    lower, upper = -rng.uniform(0, 2, n), rng.uniform(0, 2, n)
    lower[rng.random(n) < 0.3] = -np.inf
    upper[rng.random(n) < 0.2] = np.inf
    equal = rng.random(n) < 0.15
    lower[equal] = upper[equal] = 0.3
    return lower, upper


def start(rng, lower, upper):
    states = rng.choice([INSIDE, AT_UPPER, AT_LOWER], len(lower))
    states[(states == AT_UPPER) & np.isinf(upper)] = INSIDE
    states[(states == AT_LOWER) & np.isinf(lower)] = INSIDE
    return np.where(lower == upper, AT_UPPER, states)


def violation(Q, q, lower, upper, p):
    """Distance of p to the projection of p - w/diag onto the bounds, in the energies' scale: zero for solutions only."""
    scale = np.sqrt(np.diag(Q))
    return np.abs(scale * (p - np.clip(p - (Q @ p + q) / np.diag(Q), lower, upper))).max()


def enumerated(Q, q, lower, upper):
    found = []
    for states in product([INSIDE, AT_UPPER, AT_LOWER], repeat=len(q)):
        states = np.array(states)
        p = np.where(states == AT_UPPER, upper, np.where(states == AT_LOWER, lower, 0))
        inside = states == INSIDE
        if not np.isfinite(p).all():
            continue
        p[inside] = np.linalg.solve(Q[np.ix_(inside, inside)], -(q + Q @ p)[inside])
        if violation(Q, q, lower, upper, p) < 1e-9 * (1 + np.abs(np.sqrt(np.diag(Q)) * p).max()):
            if not any(np.allclose(np.sqrt(np.diag(Q)) * (p - other), 0, atol=1e-6) for other in found):
                found.append(p)
    return found


@pytest.mark.parametrize("kind", MATRICES)
def test_the_path_ends_at_the_one_solution(kind):
    rng = np.random.default_rng(1)
    for n in (1, 2, 3, 4, 5) * 6:
        Q = MATRICES[kind](rng, n)
        scale = np.sqrt(np.diag(Q))
        q, (lower, upper) = scale * rng.standard_normal(n), (bound / scale for bound in bounds(rng, n))
        (exact,) = enumerated(Q, q, lower, upper)
        p, states, _ = follow_path(Q, q, lower, upper, start(rng, lower, upper))
        assert np.allclose(scale * p, scale * exact, rtol=1e-7, atol=1e-7)
        assert np.array_equal(p[states == AT_UPPER], upper[states == AT_UPPER]) and np.array_equal(p[states == AT_LOWER], lower[states == AT_LOWER])


@pytest.mark.parametrize("kind", ["positive definite", "badly scaled"])
def test_long_paths_are_short_enough(kind):
    """As a rule an index or two changes for each unknown."""
    rng, n = np.random.default_rng(2), 80
    for _ in range(5):
        Q = MATRICES[kind](rng, n)
        scale = np.sqrt(np.diag(Q))
        q, (lower, upper) = scale * rng.standard_normal(n), (bound / scale for bound in bounds(rng, n))
        p, _, changes = follow_path(Q, q, lower, upper, start(rng, lower, upper))
        assert violation(Q, q, lower, upper, p) < 1e-9 * np.abs(scale * p).max() and changes <= 5 * n


def test_degenerate_solutions_are_reached():
    """q = 0, and one for which p and w vanish together at half of the indices."""
    rng, n = np.random.default_rng(3), 8
    Q, lower, upper = positive_definite(rng, n), np.full(n, -np.inf), np.zeros(n)
    p, _, _ = follow_path(Q, np.zeros(n), lower, upper, np.full(n, AT_UPPER))
    assert not p.any()
    exact = np.where(np.arange(n) % 2, -1.0, 0)
    p, _, _ = follow_path(Q, -Q @ exact, lower, upper, start(rng, lower, upper))
    assert np.allclose(p, exact, atol=1e-9)


def test_contact_without_symmetry_takes_the_path():
    rng = np.random.default_rng(4)
    Q, q = positive_definite(rng, 6), rng.standard_normal(6)
    result = along_path(Q, q, [np.zeros(6, dtype=bool)])
    assert isinstance(result, ActiveSetResult) and violation(Q, q, np.full(6, -np.inf), np.zeros(6), result.p) < 1e-9
    assert np.array_equal(result.active[-1], result.p < 0) and not is_symmetric(Q) and is_symmetric(Q + Q.T)
