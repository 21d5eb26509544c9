"""Newton's method for any relation between traction and jump at the nodes, on the crack's own unknowns.

With the displacements eliminated, minus the weighted jumps are w = Q t + q. A relation gives the jump g and the traction t = y - c g as functions of
the trial traction y, so that

    F(y) = m g(y) + Q t(y) + q = 0,      F' = Q + (m - Q c) g'(y),

m the weights of the nodes. The law holds exactly in every iterate; what becomes small is the difference of the law's jump and that of the body.
F' is regular for rigid nodes (g' = 0), where it is Q, and for free ones (g' = 1/c), where it is m/c: no stiffness is too large or too small.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from ..errors import NotConverged
from .face_relations import Memory, Relation

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class FaceProblem:
    """F(y) at n nodes.

    Parameters
    ----------
    Q, q
        (2 n, 2 n) and (2 n,), normal components first: Q t + q are minus the weighted jumps for tractions t.
    weights
        (n,), m.
    relation
        Between t and g.
    c
        (2, n), its stiffness.
    before
        The variables of the last step.
    """

    Q: np.ndarray
    q: np.ndarray
    weights: np.ndarray
    relation: Relation
    c: np.ndarray
    before: Memory = field(default_factory=dict)

    @cached_property
    def m(self) -> np.ndarray:
        """(2 n,)."""
        return np.tile(self.weights, 2)

    @cached_property
    def _by_jump(self) -> np.ndarray:
        """m - Q c."""
        return np.diag(self.m) - self.Q * self.c.ravel()

    def Jump(self, y: np.ndarray) -> np.ndarray:
        """(2, n)."""
        return self.relation.Jump(y, self.c, self.before)[0]

    def Traction(self, y: np.ndarray) -> np.ndarray:
        """(2, n)."""
        return y - self.c * self.Jump(y)

    def Residual(self, y: np.ndarray) -> np.ndarray:
        """F/m, (2 n,), a length: the jump of the law less that of the body."""
        g = self.Jump(y)
        return g.ravel() + (self.Q @ (y - self.c * g).ravel() + self.q) / self.m

    def Matrix(self, y: np.ndarray) -> np.ndarray:
        """F'."""
        _, D = self.relation.Jump(y, self.c, self.before)
        normal, tangential = np.hsplit(self._by_jump, 2)
        return self.Q + np.hstack([normal * D[0, k] + tangential * D[1, k] for k in range(2)])

    def Scale(self, y: np.ndarray) -> float:
        """What a residual is compared with: the largest of the terms that cancel in it."""
        g = self.Jump(y)
        return float(max(np.abs(self.q / self.m).max(initial=0), np.abs(g).max(initial=0), np.abs(self.Q @ (self.c * g).ravel() / self.m).max(initial=0)))

    def Tied(self) -> np.ndarray:
        """y where no node moves: the tractions of a body without cracks."""
        return np.linalg.solve(self.Q, -self.q).reshape(2, -1)


@dataclass
class FaceResult:
    """y with F(y) = 0, how many Newton steps led to it, and how, in words."""

    y: np.ndarray
    iterations: int
    method: str


class Stuck(Exception):
    """Newton's method did not come to an end; nodes: where the residual is largest."""

    def __init__(self, reason: str, nodes: Sequence[int] = ()) -> None:
        super().__init__(reason)
        self.nodes = nodes


Advance: TypeAlias = Callable[[FaceProblem, np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def full(problem: FaceProblem, y: np.ndarray, step: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """y + step and its residual."""
    return y + step, problem.Residual(y + step)


def shortened(problem: FaceProblem, y: np.ndarray, step: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """y and its residual after a part of a step, the first half, quarter, ... after which Σ m F² is smaller."""
    merit = problem.m @ residual**2
    for part in 0.5 ** np.arange(12):
        new = problem.Residual(y + part * step)
        if problem.m @ new**2 < (1 - 1e-4 * part) * merit:
            return y + part * step, new
    raise Stuck("no part of a step makes the residual smaller")


def newton(problem: FaceProblem, y: np.ndarray, max_iterations: int, advance: Advance = full, tolerance: float = 1e-12) -> tuple[np.ndarray, int]:
    """y with F(y) = 0, and the number of steps that led to it.

    Parameters
    ----------
    advance
        How far a step goes: `full` or `shortened`.
    tolerance
        Of the residual, relative.

    Raises
    ------
    Stuck
    """
    residual, scale = problem.Residual(y), 0.0
    for iteration in range(max_iterations):
        scale = max(scale, problem.Scale(y))  # of the way, which may lead to zero
        if np.abs(residual).max(initial=0) <= tolerance * scale:
            return y, iteration
        try:
            step = np.linalg.solve(problem.Matrix(y), -problem.m * residual).reshape(y.shape)
        except np.linalg.LinAlgError:
            raise Stuck("its matrix is singular") from None
        y, residual = advance(problem, y, step, residual)
    raise Stuck(f"{max_iterations} steps were not enough")


def solve_faces(problem: FaceProblem, start: np.ndarray, max_iterations: int) -> FaceResult:
    """A FaceResult: full steps, then damped ones, then the load little by little.

    Raises
    ------
    NotConverged
        If none of them ends.
    """
    for method, advance in (("Newton", full), ("damped Newton", shortened)):
        try:
            return FaceResult(*newton(problem, start, max_iterations, advance), method)
        except Stuck as stuck:
            logger.debug("faces: %s stopped, %s", method, stuck)
    return continued(problem, start, max_iterations)


def continued(problem: FaceProblem, start: np.ndarray, max_iterations: int, smallest: float = 1e-4) -> FaceResult:
    """From the problem that `start` solves, q moved to where it does, back to q in steps as large as Newton's method takes them."""
    shift = problem.m * problem.Residual(start)
    at = lambda part: replace(problem, q=problem.q - (1 - part) * shift)
    y, done, step, iterations = start, 0.0, 0.5, 0
    while done < 1:
        try:
            y, number = newton(at(min(done + step, 1)), y, max_iterations)
        except Stuck as stuck:
            step *= 0.5
            if step < smallest:
                raise NotConverged(
                    f"the law of the faces: Newton's method ended neither at once nor in small steps of the load (the last at {done:.3g} of the way, {stuck}): "
                    "where faces soften the load may be beyond what they carry, or the load-displacement curve snaps back: take smaller load steps, or PathSteps"
                ) from None
        else:
            done, step, iterations = min(done + step, 1), 2 * step, iterations + number
    return FaceResult(y, iterations, "Newton along a path")
