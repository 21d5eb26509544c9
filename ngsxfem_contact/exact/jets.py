"""Functions with their gradients: forward differentiation of formulas in x, y, z whose values are arrays of numpy or CoefficientFunctions."""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import CoefficientFunction, IfPos, atan, sqrt


class Jet:
    """A value and its derivatives by x, y, z.  If these are Jets themselves it holds second derivatives, too.

    Parameters
    ----------
    value
        An array, a CoefficientFunction, or a Jet.
    slopes
        Three of these, or 0.0.
    """

    __array_ufunc__ = None  # array * jet is a Jet

    def __init__(self, value: Any, slopes: tuple[Any, ...]) -> None:
        self.value, self.slopes = value, slopes

    @staticmethod
    def Variables(X: Any, Y: Any, Z: Any, order: int = 1) -> list[Any]:
        """x, y, z with derivatives up to an order."""
        variables = [X, Y, Z]
        for _ in range(order):
            variables = [Jet(v, tuple(float(i == j) for j in range(3))) for i, v in enumerate(variables)]
        return variables

    def Chain(self, value: Any, derivative: Any) -> Jet:
        """f(self) of f and f' at the value."""
        return Jet(value, tuple(_times(derivative, slope) for slope in self.slopes))

    def __add__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.slopes)
        return Jet(self.value + other.value, tuple(_plus(a, b) for a, b in zip(self.slopes, other.slopes)))

    def __mul__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return self.Chain(self.value * other, other)
        pairs = zip(self.slopes, other.slopes)
        return Jet(self.value * other.value, tuple(_plus(_times(a, other.value), _times(self.value, b)) for a, b in pairs))

    def __rtruediv__(self, other: Any) -> Jet:
        inverse = 1 / self.value
        return other * self.Chain(inverse, -1 * inverse * inverse)

    def __truediv__(self, other: Any) -> Jet:
        return self * (1 / other)

    def __neg__(self) -> Jet:
        return self * -1.0

    def __sub__(self, other: Any) -> Jet:
        return self + -1.0 * other

    def __rsub__(self, other: Any) -> Jet:
        return -self + other

    __radd__, __rmul__ = __add__, __mul__


def _is_zero(a: Any) -> bool:
    return isinstance(a, float) and a == 0


def _plus(a: Any, b: Any) -> Any:
    return b if _is_zero(a) else a if _is_zero(b) else a + b


def _times(a: Any, b: Any) -> Any:
    return 0.0 if _is_zero(a) or _is_zero(b) else a * b


def root(f: Any) -> Any:
    """√f."""
    if not isinstance(f, Jet):
        return sqrt(f)
    value = root(f.value)
    return f.Chain(value, 0.5 / value)


def arccot(f: Any) -> Any:
    """arccot f in (0, π)."""
    if not isinstance(f, Jet):
        return 0.5 * np.pi - atan(f)
    return f.Chain(arccot(f.value), -1 / (1 + f.value * f.value))


def choose(condition: Any, positive: Any, other: Any) -> Any:
    """The one where a condition is > 0, else the other; no Jets."""
    pick = IfPos if any(isinstance(part, CoefficientFunction) for part in (condition, positive, other)) else lambda c, a, b: np.where(c > 0, a, b)
    return pick(condition, positive, other)
