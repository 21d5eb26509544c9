"""The error that is reported with K_I, K_II: docs/method.md, section 9; benchmarks/k_errors.py measures how often it covers the true one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .._ngsxfem_contact import TipSpec

SPREAD, ROOM = 3, 0.3  # found by benchmarks/k_errors.py
BRANCH, NONE = 1.5, 3  # where there are no modes to compare with: at tips with the functions (8), and without functions


def reported_error(K: np.ndarray, doubt: list[float], modes: tuple[float, ...] | None, h: float, spec: TipSpec | None) -> float:
    """The largest of three indications, in the unit of K.

    Parameters
    ----------
    K
        (n, 2), of n disks, the largest first.
    doubt
        Change of K with the pressure, in absolute values along the lips.
    modes
        The coefficients of the modes in the space, or None.
    h
        Of the element at the tip.
    spec
        The TipSpec, or None.
    """
    error = max(SPREAD * np.ptp(K, axis=0).max(), *doubt)
    if modes is None or spec is None:
        return float(error * (NONE if spec is None else BRANCH))
    # O(h) or O(√h), times h/r1: large where the functions have no room
    return float(max(error, ROOM * np.abs(np.subtract(modes, K[0])).max() * h / spec.r1))
