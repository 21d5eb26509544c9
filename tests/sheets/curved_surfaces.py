"""Arcs and circles that curved sheets are made of, and the area and volume of an arc through the unit cube."""

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
