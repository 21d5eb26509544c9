"""Simple polygons in a plane, with few corners: triangles that they fall into, and lines that divide them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

Triangle = tuple[int, int, int]


def twice_area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Of a triangle, positive if its corners (2,) run counter-clockwise."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def ear_triangles(points: np.ndarray, loop: Sequence[int]) -> list[Triangle]:
    """A polygon, numbers of points (n, 2) counter-clockwise, as triangles without further points; corners may lie inside of straight sides.

    One ear after the other is cut off, of those that hold no other corner the one that is the least thin.
    """
    loop, triangles = list(loop), []
    while len(loop) > 3:
        ears = [(loop[k - 1], loop[k], loop[(k + 1) % len(loop)]) for k in range(len(loop))]
        best = max(range(len(loop)), key=lambda k: _quality(points, ears[k], loop))
        triangles.append(ears[best])
        del loop[best]
    return [*triangles, (loop[0], loop[1], loop[2])]


def _quality(points: np.ndarray, ear: Triangle, loop: list[int]) -> tuple[bool, float]:
    """Whether no other corner is in an ear, and its area over the square of its longest side."""
    a, b, c = (points[k] for k in ear)
    double, longest = twice_area(a, b, c), max(float(np.sum((q - p) ** 2)) for p, q in ((a, b), (b, c), (c, a)))
    least = -1e-12 * longest
    others = [points[k] for k in loop if k not in ear]
    empty = not any(min(twice_area(a, b, p), twice_area(b, c, p), twice_area(c, a, p)) >= least for p in others)
    return empty and double > 0, double / longest


def holds(points: np.ndarray, loop: Sequence[int], place: np.ndarray) -> bool:
    """Whether a place lies in a polygon; by the crossings of a ray."""
    corners = points[list(loop)]
    inside = False
    for a, b in zip(corners, np.roll(corners, -1, axis=0)):
        if (a[1] > place[1]) != (b[1] > place[1]) and place[0] < a[0] + (place[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]):
            inside = not inside
    return inside


def divided(loop: list[int], line: list[int]) -> list[list[int]]:
    """The two polygons that a line, numbers of points from corner to corner, makes of one; the polygon alone where the line is a side of it."""
    start, end = loop.index(line[0]), loop.index(line[-1])
    loop, end = loop[start:] + loop[:start], (end - start) % len(loop)
    halves = [loop[: end + 1] + line[-2:0:-1], [loop[0], *line[1:-1], *loop[end:]]]
    return halves if min(map(len, halves)) > 2 else [loop]


def inner_point(points: np.ndarray, loop: Sequence[int]) -> np.ndarray:
    """A point inside a polygon: the centre of the largest of its triangles."""
    corners = [points[list(triangle)] for triangle in ear_triangles(points, loop)]
    return max(corners, key=lambda c: twice_area(*c)).mean(axis=0)
