"""Where to a tip grows and how far: section 9 of docs/method.md."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, sin, sqrt

import numpy as np

from ..arguments import check_number, check_positive


@dataclass(frozen=True)
class MaximumHoopStress:
    """Erdogan and Sih (1963): growth at the angle θ where σ_θθ √(2πr) = K_I cos³(θ/2) - 3 K_II cos²(θ/2) sin(θ/2) is largest.

    A tip whose faces touch does not grow: contact makes K_I = 0 there. WingCracks lets it kink.

    Other Parameters
    ----------------
    K_I : float
        Stress × √length.
    K_II : float
        Stress × √length.

    Examples
    --------
    >>> from math import degrees
    >>> round(degrees(MaximumHoopStress().Angle(K_I=0, K_II=1)), 2)
    -70.53
    """

    grows_closed = False

    def Angle(self, K_I: float, K_II: float) -> float:
        """θ in radians from the direction ahead, counter-clockwise: K_I sin θ + K_II (3 cos θ - 1) = 0, |θ| ≤ 70.53°."""
        if K_II == 0:
            return 0.0
        return 2 * atan2(-2 * K_II, K_I + sqrt(K_I**2 + 8 * K_II**2))

    def Driving(self, K_I: float, K_II: float) -> float:
        """The largest σ_θθ √(2πr): for K_II = 0 it is K_I."""
        half = 0.5 * self.Angle(K_I, K_II)
        return cos(half) ** 2 * (K_I * cos(half) - 3 * K_II * sin(half))


@dataclass(frozen=True)
class WingCracks(MaximumHoopStress):
    """MaximumHoopStress also at closed tips that slide, with K_I = 0 there: a kink of 70.53° that opens."""

    grows_closed = True


@dataclass(frozen=True)
class GivenIncrement:
    """Every tip that grows advances by da, a length > 0.

    Parameters
    ----------
    da : float
        The advance of each tip that grows, a length > 0.

    Raises
    ------
    ValueError
        For others.
    """

    da: float

    def __post_init__(self) -> None:
        check_positive(self.da, "GivenIncrement: da")

    def Advances(self, driving: np.ndarray) -> tuple[np.ndarray, float]:
        """(advances, cycles) for the driving factors of the tips that grow; no cycles are counted."""
        return np.full(len(driving), self.da), 0.0


@dataclass(frozen=True)
class Paris:
    """da/dN = C (ΔK)^m, ΔK = (1 - ratio) K for loads between ratio and 1 times the given one.

    The tip with the largest ΔK advances by da, in da / (C ΔK^m) cycles, the others by what they grow meanwhile.

    Parameters
    ----------
    C
        > 0, in length / cycle / (stress × √length)^m.
    m
        > 0.
    da
        A length > 0.
    ratio
        Of the least to the largest load, 0 ≤ ratio < 1.

    Raises
    ------
    ValueError
        For others.

    References
    ----------
    Paris and Erdogan (1963).
    """

    C: float
    m: float
    da: float
    ratio: float = 0.0

    def __post_init__(self) -> None:
        for name in ("C", "m", "da"):
            check_positive(getattr(self, name), f"Paris: {name}")
        check_number(self.ratio, "Paris: ratio", lambda ratio: 0 <= ratio < 1, "be at least 0 and less than 1")

    def Advances(self, driving: np.ndarray) -> tuple[np.ndarray, float]:
        """(advances, cycles) for the driving factors of the tips that grow: lengths, and the number of cycles that they take."""
        rates = self.C * ((1 - self.ratio) * np.asarray(driving)) ** self.m
        cycles = self.da / rates.max()
        return rates * cycles, float(cycles)
