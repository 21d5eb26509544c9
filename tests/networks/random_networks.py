"""Random cracks in the unit square that cross, end on each other, kink, reach the sides and close on themselves; lists of points only.

Points are on a grid of 2⁻²⁰, ends on another crack at multiples of 2⁻⁸ of a segment, so that they lie on it exactly: `planar.facts` says what a network is.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from .planar import SCALE, SQUARE, meeting, whole
from .planar import facts as facts_of

GRID = 2.0**20
MARGIN = 0.03  # of free points from the sides
KINKS = (20, 150)  # degrees, of the direction


def on_grid(point):
    return tuple(float(c) for c in np.round(np.asarray(point) * GRID) / GRID)


def kinks(crack):
    """Changes of direction in degrees, of a closed crack also where it closes."""
    d = np.diff(crack, axis=0)
    d = np.vstack([d, d[:1]]) if crack[0] == crack[-1] else d
    angles = np.degrees(np.arctan2(d[:, 1], d[:, 0]))
    return np.abs((np.diff(angles) + 180) % 360 - 180)


def valid(crack):
    """Inside the square, with kinks in KINKS, and without meeting itself."""
    points, segments = np.array(crack), list(zip(map(whole, crack), map(whole, crack[1:])))
    if not ((points >= 0) & (points <= 1)).all() or not ((KINKS[0] <= kinks(crack)) & (kinks(crack) <= KINKS[1])).all():
        return False
    if not ((points[1:-1] > MARGIN) & (points[1:-1] < 1 - MARGIN)).all():
        return False
    closes = lambda i, j: j == i + 1 or (i == 0 and j == len(segments) - 1 and crack[0] == crack[-1])
    return not any(meeting(segments[i], segments[j]) for j in range(len(segments)) for i in range(j) if not closes(i, j))


def free_end(rng, cracks):
    return on_grid(rng.uniform(MARGIN, 1 - MARGIN, 2))


def mouth(rng, cracks):
    side, place = rng.integers(4), rng.uniform(0.1, 0.9)
    return on_grid(np.array(SQUARE[side]) + place * np.subtract(SQUARE[side + 1], SQUARE[side]))


def end_on_crack(rng, cracks):
    """On a segment, or, once in six, at a kink; free if there is no crack yet, or where a float cannot be exactly on it."""
    if not cracks:
        return free_end(rng, cracks)
    crack = cracks[rng.integers(len(cracks))]
    if len(crack) > 2 and rng.random() < 1 / 6:
        return crack[rng.integers(1, len(crack) - 1)]
    piece, k = rng.integers(len(crack) - 1), int(rng.integers(8, 249))
    p, q = (whole(point) for point in crack[piece : piece + 2])
    exact = [Fraction(256 * a + k * (b - a), 256 * SCALE) for a, b in zip(p, q)]
    place = tuple(map(float, exact))
    return place if [Fraction(c) for c in place] == exact else free_end(rng, cracks)


def open_crack(rng, cracks):
    """One to four segments between two ends, of any kind each."""
    start, end = (rng.choice([free_end, mouth, end_on_crack], p=[0.45, 0.2, 0.35])(rng, cracks) for _ in range(2))
    n, points, angle = int(rng.integers(1, 5)), [start], rng.uniform(0, 360)
    for _ in range(n - 1):
        step = rng.uniform(0.1, 0.35) * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        points.append(on_grid(points[-1] + step))
        angle += rng.choice([-1, 1]) * rng.uniform(*KINKS)
    return [*points, end]


def loop(rng, cracks):
    """Three to six corners around a point, counterclockwise."""
    n, centre = int(rng.integers(3, 7)), rng.uniform(0.2, 0.8, 2)
    angles = np.sort(rng.uniform(0, 2 * np.pi, n))
    radii = rng.uniform(0.08, 0.25, n)
    corners = [on_grid(centre + r * np.array([np.cos(t), np.sin(t)])) for r, t in zip(radii, angles)]
    return [*corners, corners[0]]


def fits(cracks, separation, angle):
    """Whether no segments overlap, and features keep the separation and the angle."""
    try:
        found = facts_of(cracks)
    except ValueError:
        return False
    return found.closest >= separation and found.sharpest >= angle


def random_network(rng, n, separation=0.0, angle=0.0):
    """(cracks, Facts) of n cracks in the unit square.

    Parameters
    ----------
    rng
        numpy.random.Generator.
    n
        Number of cracks, 2 to 12.
    separation
        Smallest distance between what does not meet: ends, kinks, crossings from cracks and sides. More than 0.02 does not go with many cracks.
        Without it one network in ten has a distance below 3e-4.
    angle
        Smallest angle at which cracks and sides meet, degrees; without it one network in ten has an angle below 2.
    """
    cracks = []
    while len(cracks) < n:
        crack = rng.choice([open_crack, loop], p=[0.9, 0.1])(rng, cracks)
        if len(crack) > 1 and crack[0] != crack[1] and valid(crack) and fits([*cracks, crack], separation, angle):
            cracks.append(crack)
    return cracks, facts_of(cracks)


def kink_placements(rng, angle, n, length=0.3):
    """n cracks of two segments of this length each, whose direction changes by angle (degrees), anywhere in the unit square, either way round."""
    cracks = []
    while len(cracks) < n:
        first, kink = rng.uniform(0, 2 * np.pi), rng.uniform(MARGIN, 1 - MARGIN, 2)
        second = first + rng.choice([-1, 1]) * np.radians(angle)
        crack = [kink - length * np.array([np.cos(first), np.sin(first)]), kink, kink + length * np.array([np.cos(second), np.sin(second)])]
        if all((MARGIN < p).all() and (p < 1 - MARGIN).all() for p in crack):
            cracks.append([tuple(map(float, p)) for p in crack])
    return cracks
