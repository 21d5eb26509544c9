"""The error that is reported with K_I, K_II: docs/method.md, section 9; benchmarks/k_errors.py measures how often it covers the true one."""

import numpy as np

SPREAD, ROOM = 4, 0.3  # found by benchmarks/k_errors.py


def reported_error(K, doubt, distance):
    """The largest of three indications, in the unit of K.

    K: (n, 2), of n disks.    doubt: change of K with the pressure, in absolute values along the lips.    distance: see `from_modes`.
    """
    return float(max(SPREAD * np.ptp(K, axis=0).max(), *doubt, ROOM * distance))


def from_modes(K, modes, h, spec):
    """Between K and the coefficients of the modes, O(h) or O(√h) off, times h/r1: large where the functions have no room; 0 without modes."""
    return 0.0 if modes is None else np.abs(np.subtract(modes, K)).max() * h / spec.r1
