"""The error that is reported with K_I, K_II: docs/method.md, section 9; benchmarks/k_errors.py measures how often it covers the true one."""

import numpy as np

SPREAD, ROOM = 3, 0.5  # found by benchmarks/k_errors.py


def reported_error(K, scale, integrals, u, doubt, distance):
    """The largest of four indications, in the unit of K.

    K: (n, 2), of the disks of `integrals`, the largest first.    scale: I(u, mode) × scale is K.    u: the TipField.
    doubt: change of K with the pressure, in absolute values along the lips.    distance: see `from_modes`.
    """
    energetic = (from_energy(factors, scale * I(u, u)) for factors, I in zip(K, integrals))
    return float(max(SPREAD * np.ptp(K, axis=0).max(), *energetic, *doubt, ROOM * distance))


def from_energy(K, squared):
    """Between |K| and what the J-integral, scale × I(u, u) = |K|², says: quadratic in the stress, it sees errors on which the mode is orthogonal."""
    return abs(np.sqrt(abs(squared)) - np.hypot(*K))


def from_modes(K, modes, h, spec):
    """Between K and the coefficients of the modes, O(h) or O(√h) off, times h/r1: large where the functions have no room; 0 without modes."""
    return 0.0 if modes is None else np.abs(np.subtract(modes, K)).max() * h / spec.r1
