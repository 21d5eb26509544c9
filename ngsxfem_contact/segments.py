"""Distances in the plane."""

import numpy as np


def distance_to_segments(a, b, point):
    """Of a point from the nearest of the segments from a to b, (n, 2) each; inf if there are none."""
    if len(a) == 0:
        return np.inf
    t = np.clip(np.einsum("ij,ij->i", point - a, b - a) / np.einsum("ij,ij->i", b - a, b - a), 0, 1)
    return float(np.hypot(*(a + t[:, None] * (b - a) - point).T).min())
