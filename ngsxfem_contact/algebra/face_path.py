"""The faces on a path of loads q + t q_1 whose factor t is unknown: each step says how far the faces give way, whatever the load has to be for that.

Where a structure snaps back, load and displacement both fall while the faces soften; the `Progress` of a relation grows all the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import NotConverged
from .face_newton import FaceProblem, Stuck

FAR = 5.0  # how many steps faces may go back while others go ahead, and the load beyond zero


@dataclass(frozen=True)
class PathPoint:
    """z and t of a solution."""

    z: np.ndarray
    t: float


@dataclass(frozen=True)
class FacePath:
    """F(y, t) = 0 and, over all nodes, max (progress(y) - progress(y of the last point)) = step; z = (y, α) as in FaceProblem.

    Parameters
    ----------
    problem
        The FaceProblem of t = 0.
    q_1
        (2 n + r,), of q and pull.
    last
        The point where the step begins.
    earlier
        The one before, or None.
    """

    problem: FaceProblem
    q_1: np.ndarray
    last: PathPoint
    earlier: PathPoint | None = None

    def At(self, t: float) -> FaceProblem:
        """The FaceProblem of a load factor."""
        number = len(self.problem.q)
        return replace(self.problem, q=self.problem.q + t * self.q_1[:number], pull=self.problem.pull + t * self.q_1[number:])

    def Growths(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,), the growth of the progress of each node, and its derivative by the trial tractions there, (2, n)."""
        relation, c, before = self.problem.relation, self.problem.c, self.problem.before
        progress, slope = relation.Progress(self.problem.Trial(z), c, before)
        return progress - relation.Progress(self.problem.Trial(self.last.z), c, before)[0], slope

    def Growth(self, z: np.ndarray, node: int | None = None) -> tuple[float, np.ndarray]:
        """The growth of the progress, the largest or that of a node, and its derivative by z."""
        growth, slope = self.Growths(z)
        first = int(np.argmax(growth)) if node is None else node
        derivative = np.zeros(len(z))
        derivative[[first, first + len(growth)]] = slope[:, first]
        return float(growth[first]), derivative

    def Ahead(self, step: float) -> PathPoint:
        """A point to begin with: as the last step went, or along the tangent, to the side where the faces give way more."""
        z, t = self.last.z, self.last.t
        if self.earlier is None:
            z_1, t_1 = np.linalg.solve(self.At(t).Matrix(z), -self.q_1), 1.0
        else:
            z_1, t_1 = z - self.earlier.z, t - self.earlier.t
        growth, sign = max((self.Growth(z + sign * z_1)[0], sign) for sign in (1, -1))
        part = sign * step / growth if growth > 0 else 0.0
        return PathPoint(z + part * z_1, t + part * t_1)

    def Newton(self, start: PathPoint, step: float, max_iterations: int, node: int | None = None, tolerance: float = 1e-12) -> tuple[PathPoint, int]:
        """The point a step away from the last one, that of a node or the largest, and the number of Newton steps.

        Raises
        ------
        Stuck
            With the nodes where the residual is largest at the end.
        """
        z, t, first = start.z, start.t, self.problem.Scale(start.z)
        for iteration in range(max_iterations):
            problem, (growth, derivative) = self.At(t), self.Growth(z, node)
            residual = problem.Residual(z)
            if (np.abs(residual) <= tolerance * np.maximum(first, problem.Scale(z))).all() and abs(growth - step) <= 1e-9 * step:
                return PathPoint(z, t), iteration
            matrix = np.block([[problem.Matrix(z), self.q_1[:, None]], [derivative, np.zeros(1)]])
            rows = 1 / np.maximum(np.abs(matrix).max(axis=1), np.finfo(float).tiny)  # lengths below, weighted jumps above
            try:
                change = np.linalg.solve(rows[:, None] * matrix, -rows * np.append(problem.units * residual, growth - step))
            except np.linalg.LinAlgError:
                raise Stuck("its matrix is singular") from None
            z, t = z + change[:-1], t + float(change[-1])
        worst = np.abs(problem.Trial(self.At(t).Residual(z))).max(axis=0)
        raise Stuck(f"{max_iterations} steps were not enough", np.argsort(-worst)[:3].tolist())

    def Led(self, start: PathPoint, step: float, max_iterations: int) -> tuple[PathPoint, int]:
        """The same; where it is stuck, a node at which it is stuck may go ahead while all others stay behind, even go back. Raises Stuck."""
        try:
            return self._near(*self.Newton(start, step, max_iterations), step)
        except Stuck as stuck:
            for node in stuck.nodes:
                try:
                    return self._near(*self.Newton(self.last, step, max_iterations, node), step)
                except Stuck:
                    continue
            raise

    def _near(self, point: PathPoint, iterations: int, step: float) -> tuple[PathPoint, int]:
        """The same; raises Stuck for a point on another path: where faces go back by much more than the step, those that are ahead turn round, or the load does."""
        growth, _ = self.Growths(point.z)
        if growth.max() > step * (1 + 1e-6) or growth.min() < -FAR * step or self._turns(point, growth > 0.5 * step, step):
            nodes = np.argsort(-self.problem.relation.Progress(self.problem.Trial(self.last.z), self.problem.c, self.problem.before)[0])
            raise Stuck("the point that it found is on another path", nodes[:3].tolist())
        return point, iterations

    def _turns(self, point: PathPoint, ahead: np.ndarray, step: float) -> bool:
        """Whether nodes go against their last step, or the load jumps to the other sign."""
        if self.earlier is None:
            return False
        before, now, after = (self.problem.Jump(at.z)[:, ahead] for at in (self.earlier, self.last, point))
        reverses = point.t * self.last.t < 0 and abs(point.t - self.last.t) > FAR * abs(self.last.t - self.earlier.t)
        return reverses or bool(((after - now) * (now - before)).sum() < -1e-3 * step**2)

    def Step(self, step: float, max_iterations: int, smallest: float = 1e-3) -> tuple[PathPoint, int]:
        """The same, in parts of the step where Newton's method does not take it at once. Raises NotConverged."""
        point, done, part, iterations = self.Ahead(step), 0.0, 1.0, 0
        while done < 1:
            try:
                point, number = self.Led(point, min(done + part, 1) * step, max_iterations)
            except Stuck as stuck:
                part *= 0.5
                if part < smallest:
                    raise NotConverged(f"PathSteps: Newton's method ended in no part of the step ({stuck}): take a smaller step") from None
            else:
                done, part, iterations = min(done + part, 1), 2 * part, iterations + number
        return point, iterations
