"""Extruded polylines with kinks, at random and in special positions, and what they are in the unit cube."""

import numpy as np
from exact_sheets import axes_of, half, polygon_area

from ngsxfem_contact import Crack
from ngsxfem_contact.geometry import Sheet

FAR = 4.0


def turned(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def kinked(at, towards, turn, length=FAR):
    """A polyline that comes to a point from a direction and goes on turned by an angle to the left, both parts of a length."""
    ends = at - length * turned(towards), at, at + length * turned(towards + turn)
    return Crack([tuple(float(c) for c in p) for p in ends])


def through(at, direction, towards, turn, length=FAR):
    """The sheet with the line of its kink through a point in space along a direction, from side to side of the unit cube."""
    direction = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    x_axis = axes_of(direction)[0]
    origin = np.asarray(at, dtype=float) - FAR * direction
    return Sheet.Extrude(kinked(np.zeros(2), towards, turn, length), tuple(2 * FAR * direction), tuple(origin), tuple(x_axis))


def along_z(crack, start=-1, end=2):
    return Sheet.Extrude(crack, (0, 0, end - start), (0, 0, start))


SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def area_and_volume(at, towards, turn):
    """Of kinked(...) with the kink inside of the unit square, extruded through the unit cube along an edge: its area, the volume on the plus side."""
    length, left = 0.0, [np.array([-d[1], d[0]]) for d in (turned(towards), turned(towards + turn))]
    for d in (-turned(towards), turned(towards + turn)):
        with np.errstate(divide="ignore"):
            length += min(max(a, b) for a, b in zip((0 - at) / d, (1 - at) / d))
    sign = 1 if turn > 0 else -1  # the side with the angle below 180°
    inner = half(half(SQUARE, at, sign * left[0]), at, sign * left[1])
    return length, polygon_area(inner) if turn > 0 else 1 - polygon_area(inner)


def special_sheets(rng, mesh, offset):
    """(kind, sheet): kinks through a vertex, along an edge, in a face of the mesh, moved by an offset; and with one plane on a face."""
    vertices = np.array([v.point for v in mesh.vertices])
    faces = [[v.nr for v in face.vertices] for face in mesh.faces]
    inner = [face for face in faces if np.all((0.15 < vertices[face]) & (vertices[face] < 0.85))] or faces
    a, b, c = vertices[inner[rng.integers(len(inner))]]
    turn, towards = np.radians(rng.uniform(20, 150)) * rng.choice([-1, 1]), rng.uniform(0, 2 * np.pi)
    moved = rng.normal(size=3)
    moved *= offset / np.linalg.norm(moved)
    yield "through a vertex", through(a + moved, rng.normal(size=3), towards, turn)
    yield "along an edge", through(a + moved, b - a, towards, turn)
    part = rng.uniform()
    yield "in a face", through(a + moved, part * (b - a) + (1 - part) * (c - a), towards, turn)
    direction = (b - a) / np.linalg.norm(b - a)
    first, second = axes_of(direction)[:2]
    across = (c - a) - ((c - a) @ direction) * direction
    yield "a plane on a face", through(a + moved, direction, np.arctan2(across @ second, across @ first) + np.pi, turn)
