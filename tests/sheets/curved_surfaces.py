"""Arcs, circles and triangulated caps that curved sheets are made of, and the area and volume of an arc through the unit cube."""

import numpy as np
from scipy.integrate import quad

from ngsxfem_contact import Crack
from ngsxfem_contact.geometry import Sheet

RADIUS, CENTRE = 1.2, np.array([0.47, -0.6])


def on_circle(angle, radius=RADIUS):
    return tuple(float(c) for c in CENTRE + radius * np.array([np.cos(angle), np.sin(angle)]))


def arc(start=0.7, end=-0.7, radius=RADIUS):
    """From an angle to another one, measured from the y-axis."""
    return Crack.Arc(*(on_circle(np.pi / 2 + angle, radius) for angle in (start, 0.5 * (start + end), end)))


def circle(centre, radius):
    at = [tuple(float(c) for c in np.add(centre, radius * np.array([np.cos(a), np.sin(a)]))) for a in 0.5 * np.pi * np.arange(4)]
    return Crack.Join(Crack.Arc(*at[:3]), Crack.Arc(at[2], at[3], at[0]))


THROUGH = Sheet.Extrude(arc(), (0, 0, 3), (0, 0, -1))
_ends = np.arccos((np.array([1.0, 0.0]) - CENTRE[0]) / RADIUS)  # where the arc leaves the unit cube, on the right and on the left
AREA = RADIUS * (_ends[1] - _ends[0])
ABOVE = 1 - quad(lambda s: CENTRE[1] + np.sqrt(RADIUS**2 - (s - CENTRE[0]) ** 2), 0, 1)[0]
CAP_RADIUS, CAP_SPHERE, CAP_MIDDLE = 0.3, 0.75, np.array([0.49, 0.51, 0.48])


def cap(rings=12, sphere=CAP_SPHERE, middle=CAP_MIDDLE, turn=np.eye(3)):
    """Points and triangles of a cap of a sphere above a circle, or of the disk (sphere = inf)."""
    points, triangles = [(0.0, 0.0)], []
    for ring in range(1, rings + 1):
        angles = 2 * np.pi * np.arange(6 * ring) / (6 * ring)
        points += list(zip(CAP_RADIUS * ring / rings * np.cos(angles), CAP_RADIUS * ring / rings * np.sin(angles)))
    start = lambda ring: 0 if ring == 0 else 1 + 3 * ring * (ring - 1)
    at = lambda ring, k: start(ring) + (k % (6 * ring) if ring else 0)
    for ring in range(1, rings + 1):
        for side in range(6):
            for k in range(ring):
                outer, inner = side * ring + k, side * (ring - 1) + k
                triangles.append((at(ring, outer), at(ring, outer + 1), at(ring - 1, inner)))
                if k < ring - 1:
                    triangles.append((at(ring, outer + 1), at(ring - 1, inner + 1), at(ring - 1, inner)))
    flat = np.array(points)
    rise = np.zeros(len(flat)) if np.isinf(sphere) else np.sqrt(sphere**2 - (flat**2).sum(axis=1)) - np.sqrt(sphere**2 - CAP_RADIUS**2)
    return np.column_stack([flat, rise]) @ turn.T + middle, np.array(triangles)


def turned(axis, angle):
    axis = np.array(axis) / np.linalg.norm(axis)
    cross = np.cross(np.eye(3), axis)
    return np.eye(3) - np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
