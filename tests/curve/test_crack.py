"""Crack: orientation, side of a point, arc length."""

import pickle

import numpy as np
import pytest

from ngsxfem_contact import Crack
from ngsxfem_contact.geometry import Side


def test_the_plus_side_lies_to_the_left_of_the_direction_of_travel():
    crack = Crack([(0, 0), (2, 1)])
    assert crack.SideOf((0, 1)) == Side.Plus
    assert crack.SideOf((1, 0)) == Side.Minus


@pytest.mark.parametrize("point", [(0.3, 0.4), (0.9, -0.2), (-3, 0.1), (5, 0.3)])
def test_reversal_exchanges_the_sides(point):
    points = [(0, 0), (1, 0.1), (2, -0.1)]
    assert Crack(points).SideOf(point) != Crack(points[::-1]).SideOf(point)


def test_beyond_its_ends_a_crack_continues_straight():
    crack = Crack([(0, 0), (1, 0), (1, 1)])
    assert crack.SideOf((-5, 1e-6)) == Side.Plus
    assert crack.SideOf((-5, -1e-6)) == Side.Minus
    assert crack.SideOf((1 - 1e-6, 7)) == Side.Plus
    assert crack.SideOf((1 + 1e-6, 7)) == Side.Minus


@pytest.mark.parametrize("before", [0, 0.3, 7])
@pytest.mark.parametrize("turn", np.radians([30, 100, 150, 175]))
def test_side_all_around_a_kink(turn, before):
    """Left of the kink is what lies between the two arms on the left: angles from turn to π, seen from the kink."""
    points = [(-1, 0), (0, 0), (np.cos(turn), np.sin(turn))]
    crack = Crack([(-1 - before, 0), *points] if before else points)
    for angle in np.linspace(-np.pi, np.pi, 101)[1:-1]:
        if abs(angle - turn) > 1e-6:
            inside = turn < angle < np.pi
            point = (0.1 * np.cos(angle), 0.1 * np.sin(angle))
            assert crack.SideOf(point) == (Side.Plus if inside else Side.Minus), angle


def test_arc_length():
    crack = Crack([(0, 0), (3, 4), (3, 6)])
    assert crack.length == pytest.approx(7, rel=1e-15)
    assert crack.PointAt(5) == pytest.approx((3, 4))
    assert crack.PointAt(6) == pytest.approx((3, 5))
    assert crack.ArcLength((2.5, 5.5)) == pytest.approx(6.5)
    assert crack.ArcLength((-1, -9)) == 0


@pytest.mark.parametrize("s", [0, 0.1, 1.3, 2.1])
def test_arc_length_and_point_are_inverse(s):
    crack = Crack([(0, 0), (1, 0.5), (1.2, 1.4)])
    assert crack.ArcLength(crack.PointAt(min(s, crack.length))) == pytest.approx(min(s, crack.length), rel=1e-14)


def test_points_survive_pickling_and_numpy():
    crack = Crack(np.array([(0, 0.1), (1, 1 / 3)]))
    assert pickle.loads(pickle.dumps(crack)).points == crack.points == [(0, 0.1), (1, 1 / 3)]


def test_segments_on_one_line_do_not_meet():
    """Orientations of collinear points are round-off; both cracks were refused as if their first and third segment met."""
    for angle in np.linspace(0, 3, 50):
        direction = np.array([np.cos(angle), np.sin(angle)])
        assert Crack([tuple(0.1 + s * direction) for s in (0, 0.31, 0.47, 0.93)]).length == pytest.approx(0.93, rel=1e-14)


def test_outline_of_a_curve():
    """From end to end through points of the curve; a chord is off by an eighth of its length times its turn."""
    arc = Crack.Arc((0, 0), (0.5, 0.5), (1, 0))
    for turn in (0.5, 0.05):
        outline = np.array(arc.Outline(turn))
        assert tuple(outline[0]) == (0, 0) and tuple(outline[-1]) == (1, 0) and len(outline) >= np.pi / turn
        assert np.hypot(*(outline - (0.5, 0)).T) == pytest.approx(0.5, abs=1e-14)
        middles = 0.5 * (outline[1:] + outline[:-1])
        assert 0.5 - np.hypot(*(middles - (0.5, 0)).T).min() <= 0.5 * turn**2 / 8 * 1.001
    joined = Crack.Join(Crack([(-1, 0.2), (0, 0)]), arc)
    assert joined.Outline()[:2] == [(-1, 0.2), (0, 0)] and joined.Outline()[1:] == arc.Outline()
