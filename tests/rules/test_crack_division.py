"""Rules on cracks that are divided at given points: exact for what is smooth between these, and kept apart for different ones."""

import numpy as np
import pytest
from helpers import rectangle

from ngsxfem_contact import Crack, CrackedMesh

BODY = CrackedMesh(rectangle(0.3), Crack([(0, 0.43), (0.7, 0.53)]), Crack([(0.3, 0.7), (1, 0.74)]))


def bent(division, measure):
    """For each crack ∫ |s - a|, a the point that divides it."""
    _, _, _, w, x, y = measure.Points(2)
    values = []
    for crack, (a,) in zip(BODY.cracks, division):
        near = np.array([np.hypot(*np.subtract(crack.PointAt(crack.ArcLength(point)), point)) < 1e-9 for point in zip(x, y)])
        s = np.array([crack.ArcLength(point) for point in zip(x[near], y[near])])
        values.append(w[near] @ np.abs(s - a))
    return values


def exact(division):
    lengths = [crack.length for crack in BODY.cracks]
    return [(a**2 + (length - a) ** 2) / 2 for (a,), length in zip(division, lengths)]


def test_rules_are_exact_between_the_points():
    """In turns, so that the rules of one division would be seen in another."""
    for _ in range(2):
        for division in ([[0.2], [0.4]], [[0.2], [0.401]], [[0.4], [0.2]]):
            assert bent(division, BODY.dcrack(nodes=division)) == pytest.approx(exact(division), rel=1e-13)
    assert np.abs(np.subtract(bent(division, BODY.dcrack), exact(division))).max() > 1e-5


def test_points_may_come_in_any_order():
    one, other = (BODY.dcrack(nodes=[[0.1, 0.3, 0.2], order]).Points(3) for order in ([0.5, 0.25], [0.25, 0.5]))
    assert all(np.array_equal(a, b) for a, b in zip(one, other))


def test_a_crack_without_a_list_is_not_divided():
    divided, whole = BODY.dcrack(nodes=[[0.2]]).Points(2), BODY.dcrack.Points(2)
    assert len(divided[0]) == len(whole[0]) + 2
