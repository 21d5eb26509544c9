"""Relations between traction t and jump g at nodes, each (2, n), the normal component first.

A law of the faces may be rigid (g = 0 whatever t is), perfectly plastic (t = s whatever g is), or soften. So neither is a function of the
other; but both are functions of y = t + c g, the *trial traction*, if only the stiffness c > 0 exceeds the slope of the softening:

    contact:  g_n = max(0, y_n) / c,        joint:  g = y / (k + c),        friction:  t_t = min(s, max(-s, y_t)).

A relation is this function g(y), with its derivative; t = y - c g. What has happened before is in variables
with names, (n,) each.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from .closures import Closure, LinearClosure
from .nodal_newton import Threshold
from .softening import Softening

Memory: TypeAlias = Mapping[str, np.ndarray]


def remembered(before: Memory, name: str, n: int) -> np.ndarray:
    """A variable, zeros at first."""
    return before.get(name, np.zeros(n))


class Relation(ABC):
    """What a law says at n nodes, once its coefficients are evaluated."""

    states: tuple[str, ...]

    @property
    def gives_way(self) -> bool:
        """Whether faces that touch may come nearer under pressure."""
        return False

    @property
    def steepest(self) -> np.ndarray | float:
        """(n,) or 0: by how much the tractions fall with the jump, stress / length."""
        return 0.0

    def Stiffness(self, natural: np.ndarray) -> np.ndarray:
        """c, (2, n), stress / length: the natural one, of the body at each node, or a larger one where the relation needs it."""
        return natural

    @abstractmethod
    def Jump(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """g (2, n) and its derivative ∂g_i/∂y_j (2, 2, n)."""

    def Progress(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """(n,), a length that grows as the faces give way, and its derivative (2, n): the norm of max(y_n, 0)/c_n and y_t/c_t, jumps, or tractions that would be."""
        return length_and_derivative(c, np.maximum(y[0], 0) / c[0], y[1] / c[1])

    def Variables(self, y: np.ndarray, c: np.ndarray, before: Memory) -> dict[str, np.ndarray]:
        """After a step."""
        return {}

    @abstractmethod
    def Work(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(n,) each, for each unit of length: what is dissipated in a step, how far that may be off, what is stored after it."""

    @abstractmethod
    def States(self, y: np.ndarray, c: np.ndarray, before: Memory) -> np.ndarray:
        """(n,) int: the place of each node's state in `states`."""


def length_and_derivative(c: np.ndarray, normal: np.ndarray, tangential: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The norm of two lengths, and its derivative by the trial tractions that are c times them; zero where both are."""
    size = np.hypot(normal, tangential)
    return size, np.divide(np.stack([normal, tangential]), size * c, out=np.zeros_like(c), where=size > 0)


def stored_in_springs(y: np.ndarray, c: np.ndarray, g: np.ndarray) -> np.ndarray:
    """½ t·g."""
    return 0.5 * ((y - c * g) * g).sum(axis=0)


@dataclass(frozen=True)
class ElasticRelation(Relation):
    """t_n = k_n g_n where it is open, k_closed g_n where it is closed, t_t = k_t g_t; arrays, 0 to inf."""

    k_n: np.ndarray
    k_t: np.ndarray
    k_closed: np.ndarray
    states = ("open", "closed")

    @property
    def gives_way(self) -> bool:
        """Where k_closed is finite."""
        return bool(np.isfinite(self.k_closed).any())

    def Jump(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """g = y / (k + c)."""
        k = np.stack([np.where(y[0] < 0, self.k_closed, self.k_n), self.k_t])
        D = np.zeros((2, *y.shape))
        D[0, 0], D[1, 1] = 1 / (k + c)
        return y / (k + c), D

    def Work(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nothing is dissipated."""
        nothing = np.zeros(y.shape[1])
        return nothing, nothing, stored_in_springs(y, c, self.Jump(y, c, before)[0])

    def States(self, y: np.ndarray, c: np.ndarray, before: Memory) -> np.ndarray:
        """Closed where it presses."""
        return (y[0] < 0).astype(int)


@dataclass(frozen=True)
class CohesiveRelation(Relation):
    """Rigid until the strength, softening with the effective opening d² = max(g_n, 0)² + β² g_t², unloading to the origin; contact where it closes.

    With κ the largest d so far, "opening", t_n = S g_n and t_t = β² S g_t, S = f(κ)/κ. With c_t = β² c_n the effective trial e² = max(y_n, 0)² + y_t²/β²
    is f(d) + c_n d, so that d is found first.
    """

    softening: Softening
    beta: np.ndarray
    states = ("intact", "damaged", "broken")

    @property
    def steepest(self) -> np.ndarray:
        """That of the softening."""
        return self.softening.steepest

    def Stiffness(self, natural: np.ndarray) -> np.ndarray:
        """c_n at least twice the steepest slope."""
        normal = np.maximum(natural[0], 2 * self.steepest)
        return np.stack([normal, self.beta**2 * normal])

    def Trial(self, y: np.ndarray) -> np.ndarray:
        """e."""
        return np.hypot(np.maximum(y[0], 0), y[1] / self.beta)

    def Opening(self, e: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """d and its derivative by e."""
        largest = remembered(before, "opening", len(e))
        limit = self.softening.At(largest) + c * largest
        grows = (e > limit) | (largest + limit == 0)
        secant = np.divide(largest, limit, out=np.zeros_like(limit), where=~grows)
        d = np.where(grows, self.softening.Opening(e, c), e * secant)
        return d, np.where(grows, 1 / (self.softening.Slope(d) + c), secant)

    def Jump(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """g = (d/e) (max(y_n, 0), y_t/β²)."""
        e = self.Trial(y)
        d, slope = self.Opening(e, c[0], before)
        ratio = np.divide(d, e, out=slope.copy(), where=e > 0)
        metric = np.stack([np.where(y[0] > 0, 1, 0), 1 / self.beta**2])
        direction = np.divide(metric * y, e, out=np.zeros_like(y), where=e > 0)
        D = (slope - ratio) * direction[:, None] * direction[None, :]
        D[0, 0] += ratio * metric[0]
        D[1, 1] += ratio * metric[1]
        return ratio * metric * y, D

    def Progress(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """e / c_n: d, and before there is an opening the effective traction."""
        return length_and_derivative(np.stack([c[0], self.beta * c[0]]), np.maximum(y[0], 0) / c[0], y[1] / (self.beta * c[0]))

    def Variables(self, y: np.ndarray, c: np.ndarray, before: Memory) -> dict[str, np.ndarray]:
        """The largest effective opening so far."""
        d, _ = self.Opening(self.Trial(y), c[0], before)
        return {"opening": np.maximum(remembered(before, "opening", len(d)), d)}

    def Dissipated(self, largest: np.ndarray) -> np.ndarray:
        """All that has been: ∫f less what the secant gives back."""
        return self.softening.Integral(largest) - 0.5 * self.softening.At(largest) * largest

    def Work(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A difference of two states: it does not depend on the way between them."""
        old, new = remembered(before, "opening", y.shape[1]), self.Variables(y, c, before)["opening"]
        return self.Dissipated(new) - self.Dissipated(old), np.zeros(y.shape[1]), stored_in_springs(y, c, self.Jump(y, c, before)[0])

    def States(self, y: np.ndarray, c: np.ndarray, before: Memory) -> np.ndarray:
        """Broken where a millionth of the strength is left, or less."""
        largest = self.Variables(y, c, before)["opening"]
        return np.where(largest > 0, np.where(self.softening.At(largest) > 1e-6 * self.softening.strength, 1, 2), 0)


@dataclass(frozen=True)
class SlidingRelation(Relation):
    """Closed faces that slide at |t_t| = s, and open by the tangent of the angle of dilation times the way that they slid, "slid".

    t_n = closure of g_n - tan ψ "slid"; t_t = k_t (g_t - "slip"), |t_t| ≤ s(t_n).  Variables: "slip", and "threshold", the last s.
    """

    closure: Closure
    threshold: Threshold
    k_t: np.ndarray
    tangent: np.ndarray
    states = ("open", "sticks", "slips")

    @property
    def gives_way(self) -> bool:
        """As the closure says."""
        return self.closure.gives_way

    def _trial(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """y_n and y_t from where the faces have slid to, and whether they are closed."""
        slip, slid = (remembered(before, name, y.shape[1]) for name in ("slip", "slid"))
        y_n, y_t = y[0] - c[0] * self.tangent * slid, y[1] - c[1] * slip
        return y_n, y_t, y_n < c[0] * self.tangent * np.abs(y_t) / c[1]

    def _slide(self, y_n: np.ndarray, y_t: np.ndarray, closed: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """How far they slide, and the derivatives by y_n and |y_t|: the zero of h = |y_t| - (1 + c_t/k_t) s - c_t slide, which falls."""
        factor, push = 1 + c[1] / self.k_t, c[0] * self.tangent
        slide = np.where(self._excess(y_n, y_t, closed, c, np.zeros_like(y_n)) > 0, np.abs(y_t) / c[1], 0)
        moves = slide > 0
        for _ in range(60):
            _, slope = self.closure.Traction(y_n - push * slide, c[0])
            fall = c[1] + factor * self.threshold.slope * slope * push
            step = np.where(moves, self._excess(y_n, y_t, closed, c, slide) / fall, 0)
            slide = slide + step
            if (np.abs(step) <= 1e-15 * slide).all():
                break
        return slide, np.where(moves, factor * self.threshold.slope * slope / fall, 0), np.where(moves, 1 / fall, 0)

    def _excess(self, y_n: np.ndarray, y_t: np.ndarray, closed: np.ndarray, c: np.ndarray, slide: np.ndarray) -> np.ndarray:
        t_n, _ = self.closure.Traction(y_n - c[0] * self.tangent * slide, c[0])
        return np.abs(y_t) - (1 + c[1] / self.k_t) * self.threshold.At(t_n, closed & (t_n < 0)) - c[1] * slide

    def Progress(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """Slip from where the faces have slid to, and opening."""
        return length_and_derivative(c, np.maximum(y[0], 0) / c[0], y[1] / c[1] - remembered(before, "slip", y.shape[1]))

    def Jump(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """(y - t) / c."""
        y_n, y_t, closed = self._trial(y, c, before)
        slide, by_n, by_t = self._slide(y_n, y_t, closed, c)
        push, factor, sign = c[0] * self.tangent, 1 + c[1] / self.k_t, np.sign(y_t)
        t_n, slope = self.closure.Traction(y_n - push * slide, c[0])
        t = np.stack([t_n, (y_t - sign * c[1] * slide) / factor])
        T = np.array([[slope * (1 - push * by_n), -slope * push * by_t * sign], [-sign * c[1] * by_n / factor, (1 - c[1] * by_t) / factor]])
        return (y - t) / c, (np.eye(2)[:, :, None] - T) / c[:, None]

    def Variables(self, y: np.ndarray, c: np.ndarray, before: Memory) -> dict[str, np.ndarray]:
        """Where the faces have slid to, how long the way was, and the threshold."""
        y_n, y_t, closed = self._trial(y, c, before)
        slide, _, _ = self._slide(y_n, y_t, closed, c)
        slip, slid = (remembered(before, name, y.shape[1]) for name in ("slip", "slid"))
        t_n, _ = self.closure.Traction(y_n - c[0] * self.tangent * slide, c[0])
        return {"slip": slip + np.sign(y_t) * slide, "slid": slid + slide, "threshold": self.threshold.At(t_n, t_n < 0)}

    def Work(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """s times the way, less what lifts the faces; by the trapezoidal rule for s, whose difference to the end-point rule is the error."""
        after = self.Variables(y, c, before)
        t = y - c * self.Jump(y, c, before)[0]
        way = after["slid"] - remembered(before, "slid", y.shape[1])
        change = np.where(after["threshold"] > 0, 0.5 * (remembered(before, "threshold", y.shape[1]) - after["threshold"]) * way, 0)
        dissipated = (after["threshold"] + self.tangent * t[0]) * way + (change if "threshold" in before else 0)
        return dissipated, np.abs(change), self.closure.Stored(t[0]) + 0.5 * t[1] ** 2 / self.k_t

    def States(self, y: np.ndarray, c: np.ndarray, before: Memory) -> np.ndarray:
        """Open, or closed and with or without slip."""
        y_n, y_t, closed = self._trial(y, c, before)
        return np.where(closed, np.where(self._slide(y_n, y_t, closed, c)[0] > 0, 2, 1), 0)


def rigid(threshold: Threshold) -> SlidingRelation:
    """Faces that touch without giving way, and slide at a threshold."""
    n = len(threshold.base)
    return SlidingRelation(LinearClosure(np.full(n, np.inf)), threshold, np.full(n, np.inf), np.zeros(n))


@dataclass(frozen=True)
class DividedRelation(Relation):
    """Each node has the relation of its part: parts are arrays of node numbers, together all nodes, with their relations."""

    parts: Sequence[tuple[np.ndarray, Relation]]

    @property
    def states(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those of all parts, each once."""
        return tuple(dict.fromkeys(name for _, relation in self.parts for name in relation.states))

    @property
    def gives_way(self) -> bool:
        """Whether one of them does."""
        return any(relation.gives_way for _, relation in self.parts)

    @property
    def steepest(self) -> np.ndarray:
        """Of each part."""
        slopes = np.zeros(sum(len(here) for here, _ in self.parts))
        for here, relation in self.parts:
            slopes[here] = relation.steepest
        return slopes

    def Stiffness(self, natural: np.ndarray) -> np.ndarray:
        """Of each part."""
        c = natural.copy()
        for here, relation in self.parts:
            c[:, here] = relation.Stiffness(natural[:, here])
        return c

    def Jump(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """Of each part."""
        g, D = np.empty_like(y), np.empty((2, *y.shape))
        for here, relation in self.parts:
            g[:, here], D[:, :, here] = relation.Jump(y[:, here], c[:, here], of_part(before, here))
        return g, D

    def Progress(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray]:
        """Of each part."""
        value, derivative = np.empty(y.shape[1]), np.empty_like(y)
        for here, relation in self.parts:
            value[here], derivative[:, here] = relation.Progress(y[:, here], c[:, here], of_part(before, here))
        return value, derivative

    def Variables(self, y: np.ndarray, c: np.ndarray, before: Memory) -> dict[str, np.ndarray]:
        """Of each part, zero on the others."""
        after: dict[str, np.ndarray] = {}
        for here, relation in self.parts:
            for name, values in relation.Variables(y[:, here], c[:, here], of_part(before, here)).items():
                after.setdefault(name, np.zeros(y.shape[1]))[here] = values
        return after

    def Work(self, y: np.ndarray, c: np.ndarray, before: Memory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of each part."""
        work = np.empty((3, y.shape[1]))
        for here, relation in self.parts:
            work[:, here] = relation.Work(y[:, here], c[:, here], of_part(before, here))
        return work[0], work[1], work[2]

    def States(self, y: np.ndarray, c: np.ndarray, before: Memory) -> np.ndarray:
        """Of each part."""
        codes = np.empty(y.shape[1], dtype=int)
        for here, relation in self.parts:
            own = relation.States(y[:, here], c[:, here], of_part(before, here))
            codes[here] = np.array([self.states.index(name) for name in relation.states])[own]
        return codes


def of_part(before: Memory, here: np.ndarray) -> dict[str, np.ndarray]:
    """The variables at some nodes."""
    return {name: values[here] for name, values in before.items()}
