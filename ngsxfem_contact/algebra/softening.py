"""How the traction of a cohesive crack falls with its opening: f(κ), κ ≥ 0, at n nodes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np


class Softening(ABC):
    """f(κ), a stress: f(0) the strength, never growing."""

    strength: np.ndarray

    @property
    @abstractmethod
    def steepest(self) -> np.ndarray:
        """(n,): the largest -f', stress / length."""

    @abstractmethod
    def At(self, opening: np.ndarray) -> np.ndarray:
        """f."""

    @abstractmethod
    def Slope(self, opening: np.ndarray) -> np.ndarray:
        """f'."""

    @abstractmethod
    def Integral(self, opening: np.ndarray) -> np.ndarray:
        """∫f from 0, stress × length."""

    @abstractmethod
    def Opening(self, trial: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
        """The κ ≥ 0 with f(κ) + stiffness κ = trial, where the trial is above the strength; the stiffness is larger than `steepest`."""


@dataclass(frozen=True)
class LinearSoftening(Softening):
    """f = strength - slope κ until it is zero, arrays; slope 0: a constant traction."""

    strength: np.ndarray
    slope: np.ndarray

    @property
    def steepest(self) -> np.ndarray:
        """The slope."""
        return self.slope

    @property
    def last(self) -> np.ndarray:
        """The opening at which nothing is left, inf for a constant traction."""
        return np.where(self.strength > 0, np.divide(self.strength, self.slope, out=np.full_like(self.strength, np.inf), where=self.slope > 0), 0)

    def At(self, opening: np.ndarray) -> np.ndarray:
        """f."""
        return np.where(opening < self.last, self.strength - self.slope * opening, 0)

    def Slope(self, opening: np.ndarray) -> np.ndarray:
        """f'."""
        return np.where(opening < self.last, -self.slope, 0)

    def Integral(self, opening: np.ndarray) -> np.ndarray:
        """∫f from 0."""
        opening = np.minimum(opening, self.last)
        return (self.strength - 0.5 * self.slope * opening) * opening

    def Opening(self, trial: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
        """The κ with f(κ) + stiffness κ = trial."""
        return np.where(trial < stiffness * self.last, (trial - self.strength) / (stiffness - self.slope), trial / stiffness)


@dataclass(frozen=True)
class ExponentialSoftening(Softening):
    """f = strength exp(-rate κ), arrays; rate: 1 / length."""

    strength: np.ndarray
    rate: np.ndarray

    @property
    def steepest(self) -> np.ndarray:
        """At the beginning."""
        return self.strength * self.rate

    def At(self, opening: np.ndarray) -> np.ndarray:
        """f."""
        return self.strength * np.exp(-self.rate * opening)

    def Slope(self, opening: np.ndarray) -> np.ndarray:
        """f'."""
        return -self.rate * self.At(opening)

    def Integral(self, opening: np.ndarray) -> np.ndarray:
        """∫f from 0."""
        return np.divide(self.strength - self.At(opening), self.rate, out=self.strength * opening, where=self.rate > 0)

    def Opening(self, trial: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
        """The κ with f(κ) + stiffness κ = trial: Newton's method from above, where a convex function keeps it."""
        trial = np.maximum(trial, self.strength)
        opening = trial / stiffness
        for _ in range(60):
            step = (self.At(opening) + stiffness * opening - trial) / (self.Slope(opening) + stiffness)
            opening = opening - step
            if (np.abs(step) <= 1e-15 * np.abs(opening)).all():
                break
        return opening
