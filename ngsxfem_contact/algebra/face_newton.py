"""Newton's method for any relation between traction and jump at the nodes, on the crack's own unknowns.

With the displacements eliminated, minus the weighted jumps are w = Q t + q. A relation gives the jump g and the traction t = y - c g as functions of
the trial traction y, so that

    F(y) = m g(y) + Q t(y) + q = 0,      F' = Q + (m - Q c) g'(y),

m the weights of the nodes. The law holds exactly in every iterate; what becomes small is the difference of the law's jump and that of the body.
F' is regular for rigid nodes (g' = 0), where it is Q, and for free ones (g' = 1/c), where it is m/c: no stiffness is too large or too small.
A step dy is found from dg = g' dy at the nodes that are not rigid, with Q⁻¹ = P:

    (1 - g' (c - P m)) dg = -g' P F,      dy = -P F + (c - P m) dg.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from ..errors import NotConverged, NotHeld
from .compliance import Compliance
from .face_relations import Memory, Relation

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class FaceProblem:
    """F(y) at n nodes, and the balance of parts of the body that only the faces hold; z = (y, α), α their motions.

    Parameters
    ----------
    Q, q
        The Compliance, and (2 n,), normal components first: Q t + q are minus the weighted jumps for tractions t.
    weights
        (n,), m.
    relation
        Between t and g.
    c
        (2, n), its stiffness.
    before
        The variables of the last step.
    motions, pull
        (2 n, r), minus the weighted jumps of r rigid motions, and (r,), the work of the load on them: F = m g + Q t + q + motions α, motionsᵀ t + pull = 0.
    """

    Q: Compliance
    q: np.ndarray
    weights: np.ndarray
    relation: Relation
    c: np.ndarray
    before: Memory = field(default_factory=dict)
    motions: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    pull: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def m(self) -> np.ndarray:
        """(2 n,)."""
        return np.tile(self.weights, 2)

    @cached_property
    def units(self) -> np.ndarray:
        """(2 n + r,): what makes lengths of the equations."""
        return np.append(self.m, np.full(len(self.pull), self.m @ self.c.ravel()))

    @cached_property
    def B(self) -> np.ndarray:
        """The motions, (2 n, r)."""
        return self.motions.reshape(len(self.q), len(self.pull))

    @cached_property
    def _by_jump(self) -> np.ndarray:
        """m - Q c, and below it what the parts feel, -Bᵀ c."""
        return np.concatenate([np.diag(self.m) - self.Q.matrix * self.c.ravel(), -self.B.T * self.c.ravel()])

    def Trial(self, z: np.ndarray) -> np.ndarray:
        """y, (2, n)."""
        return z[: len(self.q)].reshape(2, -1)

    def Jump(self, z: np.ndarray) -> np.ndarray:
        """(2, n)."""
        return self.relation.Jump(self.Trial(z), self.c, self.before)[0]

    def Traction(self, z: np.ndarray) -> np.ndarray:
        """(2, n)."""
        return self.Trial(z) - self.c * self.Jump(z)

    def Residual(self, z: np.ndarray) -> np.ndarray:
        """(2 n + r,), lengths: the jump of the law less that of the body, and what the parts lack of balance."""
        g = self.Jump(z)
        t = (self.Trial(z) - self.c * g).ravel()
        return np.append(self.m * g.ravel() + self.Q.matrix @ t + self.q + self.B @ z[len(self.q) :], self.B.T @ t + self.pull) / self.units

    def Matrix(self, z: np.ndarray) -> np.ndarray:
        """The derivative of units × Residual."""
        _, D = self.relation.Jump(self.Trial(z), self.c, self.before)
        normal, tangential = np.hsplit(self._by_jump, 2)
        by_y = np.concatenate([self.Q.matrix, self.B.T]) + np.hstack([normal * D[0, k] + tangential * D[1, k] for k in range(2)])
        return np.hstack([by_y, np.concatenate([self.B, np.zeros((len(self.pull),) * 2)])])

    def Scale(self, z: np.ndarray) -> np.ndarray:
        """(2 n + r,): what a residual is compared with, the largest of the terms that cancel in it, for jumps and for the balance of parts."""
        g, number = self.Jump(z), len(self.q)
        jumps = (self.q, self.m * g.ravel(), self.Q.matrix @ (self.c * g).ravel(), self.B @ z[number:])
        forces = (self.pull, np.abs(self.B.T) @ np.abs(self.Traction(z).ravel()))
        largest = [max(np.abs(term / units).max(initial=0) for term in terms) for terms, units in ((jumps, self.m), (forces, self.units[number:]))]
        return np.repeat(largest, (number, len(self.pull)))

    def Tied(self) -> np.ndarray:
        """z where no node moves: the tractions of a body without cracks."""
        return self._step(np.zeros((2, 2, len(self.weights))), -np.append(self.q, self.pull))

    def Step(self, z: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """Of Newton's method. Raises numpy.linalg.LinAlgError."""
        return self._step(self.relation.Jump(self.Trial(z), self.c, self.before)[1], -self.units * residual)

    def _step(self, D: np.ndarray, rhs: np.ndarray) -> np.ndarray:
        """x of Matrix x = rhs for g' = D, with one step of refinement."""
        size, n = len(self.q), len(self.weights)
        P, (W, S), c, m = self.Q.inverse, self._by_motion, self.c.ravel(), self.m
        moves = np.flatnonzero(D.any(axis=1).ravel())  # rows of g' that are not zero
        there = moves % n
        by_y = D.reshape(2, 2, n)[moves // n, :, there].T  # of each moving row by the two components of y there
        matrix, by_motion = np.eye(len(moves)), np.linalg.solve(S, W[moves].T)
        for k in range(2):
            rows = there + k * n
            column = P[np.ix_(rows, moves)] - W[rows] @ by_motion
            matrix += by_y[k][:, None] * (column * m[moves] - np.where(rows[:, None] == moves, c[moves], 0))

        def tied(f: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            alpha = np.linalg.solve(S, W.T @ f - h)
            return P @ f - W @ alpha, alpha

        def solved(rhs: np.ndarray) -> np.ndarray:
            (y, alpha), g = tied(rhs[:size], rhs[size:]), np.zeros(size)
            g[moves] = np.linalg.solve(matrix, sum(by_y[k] * y[there + k * n] for k in range(2)))
            still, back = tied(m * g, np.zeros(len(self.pull)))
            return np.append(y + c * g - still, alpha - back)

        x = solved(rhs)
        g = np.einsum("ikn,kn->in", D, self.Trial(x))
        t = (self.Trial(x) - self.c * g).ravel()
        done = np.append(m * g.ravel() + self.Q.matrix @ t + self.B @ x[size:], self.B.T @ t)
        return x + solved(rhs - done)

    @cached_property
    def _by_motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Q⁻¹ B, and Bᵀ Q⁻¹ B."""
        W = self.Q.inverse @ self.B
        return W, self.B.T @ W

    def With(self, t: np.ndarray, g: np.ndarray) -> np.ndarray:
        """z of tractions and jumps that are known."""
        known = self.m * g.ravel() + self.Q.matrix @ t.ravel() + self.q
        return np.append(t + self.c * g, np.linalg.lstsq(self.B, -known)[0])


@dataclass
class FaceResult:
    """z with F(y) = 0, how many Newton steps led to it, and how, in words."""

    z: np.ndarray
    iterations: int
    method: str


class Stuck(Exception):
    """Newton's method did not come to an end; nodes: where the residual is largest."""

    def __init__(self, reason: str, nodes: Sequence[int] = ()) -> None:
        super().__init__(reason)
        self.nodes = nodes


Advance: TypeAlias = Callable[[FaceProblem, np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def full(problem: FaceProblem, z: np.ndarray, step: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """z + step and its residual."""
    return z + step, problem.Residual(z + step)


def shortened(problem: FaceProblem, z: np.ndarray, step: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """z and its residual after a part of a step, the first half, quarter, ... after which Σ m F² is smaller."""
    weights = np.append(problem.m, np.full(len(problem.pull), problem.m.sum()))
    for part in 0.5 ** np.arange(12):
        new = problem.Residual(z + part * step)
        if weights @ new**2 < (1 - 1e-4 * part) * (weights @ residual**2):
            return z + part * step, new
    raise Stuck("no part of a step makes the residual smaller")


def newton(problem: FaceProblem, z: np.ndarray, max_iterations: int, advance: Advance = full, tolerance: float = 1e-12) -> tuple[np.ndarray, int]:
    """z with F(y) = 0, and the number of steps that led to it.

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
    residual, first = problem.Residual(z), problem.Scale(z)
    for iteration in range(max_iterations):
        if (np.abs(residual) <= tolerance * np.maximum(first, problem.Scale(z))).all():  # the way may lead to zero
            return z, iteration
        try:
            step = problem.Step(z, residual)
        except np.linalg.LinAlgError:
            raise Stuck("its matrix is singular") from None
        z, residual = advance(problem, z, step, residual)
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
    shift, number = problem.units * problem.Residual(start), len(problem.q)
    at = lambda part: replace(problem, q=problem.q - (1 - part) * shift[:number], pull=problem.pull - (1 - part) * shift[number:])
    z, done, step, iterations = start, 0.0, 0.5, 0
    while done < 1:
        try:
            z, more = newton(at(min(done + step, 1)), z, max_iterations)
        except Stuck as stuck:
            step *= 0.5
            if step < smallest:
                parts = (
                    f", or {len(problem.pull)} rigid motions of parts of the body that only the faces hold are not held by them: fix these"
                    if len(problem.pull)
                    else ""
                )
                raise (NotHeld if len(problem.pull) else NotConverged)(
                    f"the law of the faces: Newton's method ended neither at once nor in small steps of the load (the last at {done:.3g} of the way, {stuck}): "
                    f"where faces soften the load may be beyond what they carry, or the load-displacement curve snaps back: take smaller load steps, or PathSteps{parts}"
                ) from None
        else:
            done, step, iterations = min(done + step, 1), 2 * step, iterations + more
    return FaceResult(z, iterations, "Newton along a path")
