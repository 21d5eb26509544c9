"""How faces that touch come nearer under pressure: the normal part of `face_relations`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np


class Closure(ABC):
    """How far faces that are closed, y < 0, give way to the pressure: y = t + c g, t ≤ 0."""

    @property
    def gives_way(self) -> bool:
        """Whether it is not rigid."""
        return True

    @abstractmethod
    def Traction(self, y: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """t and its derivative; both zero where y ≥ 0."""

    @abstractmethod
    def Stored(self, t: np.ndarray) -> np.ndarray:
        """For each unit of length."""


@dataclass(frozen=True)
class LinearClosure(Closure):
    """t = k g, an array, 0 to inf: rigid."""

    k: np.ndarray

    @property
    def gives_way(self) -> bool:
        """Where k is finite."""
        return bool(np.isfinite(self.k).any())

    def Traction(self, y: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """y / (1 + c/k)."""
        slope = np.where(y < 0, 1 / (1 + c / self.k), 0)
        return slope * y, slope

    def Stored(self, t: np.ndarray) -> np.ndarray:
        """t²/(2 k)."""
        return 0.5 * t**2 / self.k


@dataclass(frozen=True)
class HyperbolicClosure(Closure):
    """-g = p / (k_n0 + p/v_m) under the pressure p = -t: of Bandis, Lumsden and Barton (1983).  Arrays: the first stiffness, the largest closure."""

    k_n0: np.ndarray
    v_m: np.ndarray

    def Traction(self, y: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """-p from p + c p / (k_n0 + p/v_m) = -y, a quadratic equation."""
        Y, half = np.maximum(-y, 0), self.k_n0 * self.v_m
        b = half + c * self.v_m - Y
        root = np.sqrt(b**2 + 4 * half * Y)
        p = np.where(b > 0, 2 * half * Y / (root + np.abs(b)), 0.5 * (root - b))
        compliance = half * self.v_m / (half + p) ** 2
        return -p, np.where(y < 0, 1 / (1 + c * compliance), 0)

    def Stored(self, t: np.ndarray) -> np.ndarray:
        """∫p dv from 0 to v: k_n0 v_m² (-ln(1 - v/v_m) - v/v_m), 1 - v/v_m = k_n0 v_m / (k_n0 v_m + p)."""
        ratio = -t / (self.k_n0 * self.v_m)
        return self.k_n0 * self.v_m**2 * (np.log1p(ratio) - ratio / (1 + ratio))
