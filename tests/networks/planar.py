"""What polygonal cracks make of the unit square, in exact arithmetic: blocks and their areas, tips, crossings, ends on other cracks.

Coordinates are multiples of 2⁻⁶⁰, as all floats from 2⁻⁸ to 1 are; whole numbers decide what lies where, crossing points are fractions.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key
from itertools import combinations

import numpy as np

SCALE = 2**60
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)]


@dataclass(frozen=True)
class Facts:
    """Of a network in the unit square.

    Attributes
    ----------
    areas
        Of the blocks, the connected parts of the square without the cracks, in ascending order; fractions.
    blocks
        Their number by Euler's formula V - E + F = 1 + C.
    tips, mouths, t_ends
        Ends of cracks that are free, on the square's sides, on a crack.
    crossings
        Points inside of two cracks or more.
    length
        Of all cracks.
    closest
        The smallest distance of a vertex (ends, kinks, meeting points, corners of the square) from an edge that does not end there.
    sharpest
        The smallest angle between two edges at a vertex, degrees.
    """

    areas: tuple[Fraction, ...]
    blocks: int
    tips: int
    mouths: int
    t_ends: int
    crossings: int
    length: float
    closest: float
    sharpest: float


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def minus(a, b):
    return a[0] - b[0], a[1] - b[1]


def whole(point):
    """Coordinates times SCALE; refuses what is no multiple of 1/SCALE."""
    scaled = [Fraction(c) * SCALE for c in point]
    if any(c.denominator > 1 for c in scaled):
        raise ValueError(f"{point}: coordinates must be multiples of 2⁻⁶⁰")
    return tuple(int(c) for c in scaled)


def segments_of(cracks):
    """(crack, start, end) of all segments; the sides of the square have crack -1."""
    return [(c, p, q) for c, crack in enumerate([SQUARE, *cracks], -1) for p, q in zip(map(whole, crack), map(whole, crack[1:]))]


def meeting(first, second):
    """The point that two closed segments share, or None; ValueError if they share more."""
    (p, q), (r, s) = first, second
    if any(max(a[i] for a in first) < min(b[i] for b in second) or max(b[i] for b in second) < min(a[i] for a in first) for i in (0, 1)):
        return None
    along, other, between = minus(q, p), minus(s, r), minus(r, p)
    d = cross(along, other)
    if d == 0:
        if cross(along, between) != 0:
            return None
        shared = {a for a in first if inside(a, second)} | {b for b in second if inside(b, first)}
        if len(shared) > 1:
            raise ValueError("two segments overlap")
        return shared.pop() if shared else None
    t, u = cross(between, other), cross(between, along)
    if not (0 <= min(t * d, u * d) and max(abs(t), abs(u)) <= abs(d)):
        return None
    return p[0] + Fraction(t * along[0], d), p[1] + Fraction(t * along[1], d)


def inside(point, segment):
    """Whether a point of the line of a segment is in the segment."""
    return all(min(p) <= c <= max(p) for c, p in zip(point, zip(*segment)))


class Subdivision:
    """Vertices and edges of the plane divided by cracks and the sides of the square.

    Attributes
    ----------
    edges : dict
        (vertex, vertex), in both directions, → direction of the segment, whole numbers.
    passes : dict
        Vertex → set of the cracks through it; -1 stands for the square.
    """

    def __init__(self, cracks):
        segments, self.passes = segments_of(cracks), defaultdict(set)
        on = [{p, q} for _, p, q in segments]
        for i, j in combinations(range(len(segments)), 2):
            point = meeting(segments[i][1:], segments[j][1:])
            if point is not None:
                on[i].add(point), on[j].add(point)
        self.edges = {}
        for (crack, p, q), points in zip(segments, on):
            direction = minus(q, p)
            chain = sorted(points, key=lambda v: v[0] * direction[0] + v[1] * direction[1])
            for v in chain:
                self.passes[v].add(crack)
            for v, w in zip(chain, chain[1:]):
                self.edges[v, w], self.edges[w, v] = direction, minus((0, 0), direction)
        self.around = self._Around()

    def _Around(self):
        """Vertex → neighbours, counterclockwise."""
        around = defaultdict(list)
        for v, w in self.edges:
            around[v].append(w)
        half = lambda d: d[1] < 0 or d[1] == 0 and d[0] < 0
        compare = lambda d, e: half(d) - half(e) or (cross(e, d) > 0) - (cross(e, d) < 0)
        return {v: sorted(ws, key=lambda w: cmp_to_key(compare)(self.edges[v, w])) for v, ws in around.items()}

    def Cycles(self):
        """The boundaries of the faces as lists of vertices, each face on the left."""
        before = {(w, v): ws[i - 1] for w, ws in self.around.items() for i, v in enumerate(ws)}  # clockwise from where one comes
        left, cycles = dict.fromkeys(self.edges), []
        while left:
            cycle = [next(iter(left))]
            left.pop(cycle[0])
            while (follower := (cycle[-1][1], before[cycle[-1][::-1]])) != cycle[0]:
                cycle.append(follower)
                left.pop(follower)
            cycles.append([v for v, _ in cycle])
        return cycles

    def Components(self):
        """Vertex → number of its connected component."""
        component = {}
        for start in self.around:
            stack = [] if start in component else [start]
            while stack:
                v = stack.pop()
                if v not in component:
                    component[v] = start
                    stack += self.around[v]
        number = {start: i for i, start in enumerate(dict.fromkeys(component.values()))}
        return {v: number[start] for v, start in component.items()}

    def BlocksByEuler(self):
        """F - 1 of V - E + F = 1 + C."""
        return len(set(self.Components().values())) - len(self.around) + len(self.edges) // 2

    def Areas(self):
        """Of the blocks: cycles that run counterclockwise, without the components that lie in them."""
        component, cycles = self.Components(), self.Cycles()
        area = [Fraction(sum(cross(v, w) for v, w in zip(c, c[1:] + c[:1]))) / (2 * SCALE**2) for c in cycles]
        blocks = {i: a for i, a in enumerate(area) if a > 0}
        for cycle, a in zip(cycles, area):
            if a < 0:  # the outside of a component
                holders = [i for i in blocks if component[cycles[i][0]] != component[cycle[0]] and encloses(cycles[i], cycle[0])]
                if holders:
                    blocks[min(holders, key=area.__getitem__)] += a
        return tuple(sorted(blocks.values()))

    def Closest(self):
        """See Facts.closest."""
        points = np.array([[float(c) for c in v] for v in self.around]) / SCALE
        number = {v: i for i, v in enumerate(self.around)}
        ends = np.array([(number[v], number[w]) for v, w in self.edges])
        p, along = points[ends[:, 0]], points[ends[:, 1]] - points[ends[:, 0]]
        away = points[:, None] - p
        t = np.clip((away * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
        distance = np.linalg.norm(away - t[..., None] * along, axis=2)
        distance[ends.T, np.arange(len(ends))] = np.inf
        return float(distance.min())

    def Sharpest(self):
        """See Facts.sharpest."""
        turns = []
        for v, ws in self.around.items():
            angles = np.array([np.arctan2(*map(float, self.edges[v, w][::-1])) for w in ws])
            turns += list((np.roll(angles, -1) - angles) % (2 * np.pi)) if len(ws) > 1 else []
        return float(np.degrees(min(turns)))


def encloses(cycle, point):
    """Whether a polygon has a point in it that is on none of its edges."""
    odd = False
    for p, q in zip(cycle, cycle[1:] + cycle[:1]):
        if (p[1] > point[1]) != (q[1] > point[1]):
            odd ^= (cross(minus(q, p), minus(point, p)) > 0) == (q[1] > p[1])
    return odd


def facts(cracks):
    """The Facts of cracks, lists of points; the last point of a closed one is its first.

    Raises
    ------
    ValueError
        Where segments overlap.
    """
    division = Subdivision(cracks)
    ends = Counter(whole(p) for crack in cracks if crack[0] != crack[-1] for p in (crack[0], crack[-1]))
    mouths = sum(n for v, n in ends.items() if -1 in division.passes[v])
    tips = sum(v in ends and len(ws) == 1 for v, ws in division.around.items())
    crossings = sum(v not in ends and -1 not in through and len(through) > 1 for v, through in division.passes.items())
    length = sum(float(np.hypot(*np.subtract(q, p))) for crack in cracks for p, q in zip(crack, crack[1:]))
    counts = dict(tips=tips, mouths=mouths, t_ends=ends.total() - tips - mouths, crossings=crossings)
    return Facts(division.Areas(), division.BlocksByEuler(), **counts, length=length, closest=division.Closest(), sharpest=division.Sharpest())
