"""The first active set from pairs of neighbours: which share an unknown, and that numbers of unknowns do not matter."""

import numpy as np
import pytest

from ngsxfem_contact.algebra.active_set import coarse_start, pairing, solve_active_set


def chain(m):
    return np.column_stack([np.arange(m - 1), np.arange(1, m)])


def on_a_line(m, seed=0):
    """Q, q of pressures that act on each other less the farther they are, and a load that opens the middle."""
    s = np.linspace(0, 1, m)
    Q = np.exp(-np.abs(np.subtract.outer(s, s)) * 5) + 0.3 * np.eye(m)
    return Q, np.cos(7 * s) + 0.1 * np.random.default_rng(seed).standard_normal(m)


def test_pairs_along_a_chain():
    assert pairing(5, chain(5)).tolist() == [0, 0, 1, 1, 2]


def test_pairs_stay_on_their_crack():
    """An odd number of nodes on the first one: its last node is alone."""
    assert pairing(7, np.vstack([chain(3), 3 + chain(4)])).tolist() == [0, 0, 1, 2, 2, 3, 3]


def test_pairs_in_a_plane():
    """A triangulated grid: every pair consists of neighbours, and two that are left alone are none."""
    number = np.arange(20).reshape(4, 5)
    edges = np.vstack(
        [np.column_stack([a.ravel(), b.ravel()]) for a, b in ((number[:, 1:], number[:, :-1]), (number[1:], number[:-1]), (number[1:, 1:], number[:-1, :-1]))]
    )
    pairs, beside = pairing(20, edges), {frozenset(edge) for edge in edges.tolist()}
    groups = [np.flatnonzero(pairs == k) for k in range(pairs.max() + 1)]
    assert all(len(group) == 1 or frozenset(group.tolist()) in beside for group in groups)
    alone = [int(group[0]) for group in groups if len(group) == 1]
    assert len(alone) < 10 and not any(frozenset((a, b)) in beside for a in alone for b in alone if a != b)


@pytest.mark.parametrize("m", [5, 8, 31, 64])
def test_neighbours_in_another_numbering_give_the_same_set(m):
    (Q, q), order = on_a_line(m), np.random.default_rng(m).permutation(m)
    start, iterations = coarse_start(Q, q)
    number = np.argsort(order)
    other, others = coarse_start(Q[np.ix_(order, order)], q[order], number[chain(m)])
    assert np.array_equal(other, start[order]) and others == iterations


@pytest.mark.parametrize("m", [31, 64])
def test_sets_of_a_chain_are_those_of_halved_sums(m):
    """Written out: sums over pairs of rows and columns, solved, and each value for both."""

    def halved(Q, q):
        if len(q) <= 4:
            return np.zeros(len(q), dtype=bool)
        first = np.arange(0, len(q), 2)
        Qc, qc = np.add.reduceat(np.add.reduceat(Q, first, axis=0), first, axis=1), np.add.reduceat(q, first)
        return np.repeat(solve_active_set(Qc, qc, start=halved(Qc, qc)).active[-1], 2)[: len(q)]

    Q, q = on_a_line(m)
    start, _ = coarse_start(Q, q)
    assert np.array_equal(start, halved(Q, q)) and 0 < start.sum() < m


def test_cracks_of_single_nodes_begin_without_contact():
    Q, q = on_a_line(9)
    start, iterations = coarse_start(Q, q, np.zeros((0, 2), dtype=int))
    assert not start.any() and iterations == 0
