"""Load steps whose load factor is found: where the load-displacement curve falls, or snaps back."""

import logging
from typing import Any

import numpy as np

from ..algebra.face_newton import FaceProblem
from ..algebra.face_path import FacePath, PathPoint
from ..arguments import check_positive, check_type
from ..sheets import check_plane
from ..tables import Table
from .faces import FaceHistory
from .load_case import LoadCase, ReducedCase
from .nodal_law import NodalLaw
from .options import StepOptions
from .problem import ContactProblem
from .profile import State, step_values
from .solution import ContactSolution
from .solver import ReducedProblem

logger = logging.getLogger(__name__)


class PathSteps:
    """Solves (38) for F(t) = F_0 + t F_1, t unknown: each step says how far the faces give way.

    Parameters
    ----------
    problem : ContactProblem
        Whose law holds node by node, or at the points of Nitsche's method: all but contact without friction. What it holds now is F_1, given displacements included.
    fixed
        A LoadCase of the problem, F_0; default nothing.
    inverse
        As for ContactProblem.Solve.
    previous
        As for ContactProblem.Solve: whose history the faces have at first; default none. A ContactSolution of another PathSteps on the same spaces, of a file for
        example, is where the steps go on from.

    Attributes
    ----------
    t : float
        The factor of the last step, 0 at first.

    Raises
    ------
    TypeError
        For contact without friction, and for a law without At(nodes).
    ValueError
        For a problem without a load and without a displacement that is given.

    Notes
    -----
    As LoadSteps, one factorisation serves all steps. A step is the largest growth, over the nodes, of a length that increases as the faces give way: for
    cohesive laws the opening plus traction / c, c twice the steepest slope of the softening or more, so that it grows before they open, too, and by at least
    half of what the opening does.

    Examples
    --------
    ::

        steps = PathSteps(problem)
        solutions = [steps.Solve(0.01) for _ in range(50)]
    """

    def __init__(
        self, problem: ContactProblem, fixed: LoadCase | None = None, inverse: str | None = None, previous: ContactSolution | FaceHistory | None = None
    ) -> None:
        check_plane(problem.body, "PathSteps")
        problem = problem.AtNodes()
        if not isinstance(problem.law, NodalLaw):
            raise TypeError(
                f"PathSteps: faces that only touch, {problem.law!r}, hold nothing that could give way; take friction, MohrCoulomb, Joint, or another NodalLaw"
            )
        check_type(fixed, LoadCase | None, "PathSteps: fixed", "a LoadCase(problem)")
        self.law, self.reduced = problem.law, ReducedProblem(problem, inverse)
        self.case = self.reduced.case
        if not self.reduced.exchange.Max(max(np.abs(values).max(initial=0) for values in (self.case.F, self.case.given))):
            raise ValueError("PathSteps: the problem holds no load and no displacement whose factor could be found; give it some before PathSteps(problem)")
        self.fixed = 0 * self.case if fixed is None else self.reduced.Reduce(fixed)
        self.first, self._rows = StepOptions(previous=previous), list[dict[str, Any]]()
        self.t, self._earlier, self.last = 0.0, None, None
        if isinstance(previous, ContactSolution) and previous.state.path is not None and previous.problem.V is problem.V:
            (self.t, self._earlier), self.last = previous.state.path, previous

    @property
    def table(self) -> Table:
        """A Table of the steps so far: the factor t that was found, and `step_values`."""
        return Table.OfRows(self._rows, ["t"])

    def Solve(self, step: float, max_iterations: int = StepOptions.max_iterations) -> ContactSolution:
        """The next solution; its load factor is in t.

        Parameters
        ----------
        step : float
            A length.
        max_iterations
            Of Newton's method.

        Raises
        ------
        NotConverged
            Where Newton's method does not end.
        """
        check_positive(step, "PathSteps: step")
        begin = self.last or self.reduced.Step(self.first, self.fixed)
        path = self._path(begin.state)
        exchange = self.reduced.exchange
        point, iterations = exchange.FromFirst(exchange.Together(lambda: path.Step(step, max_iterations)))
        logger.info("step of the faces by %g, load factor %g", step, point.t)
        found = FaceHistory(path.problem.Traction(point.z), path.problem.Jump(point.z))
        self.last = self.reduced.Step(StepOptions(None, found, max_iterations, begin), self.fixed + point.t * self.case)
        self.last.report.iterations += iterations
        self.t, self._earlier = point.t, path.last
        self.last.state.path = point.t, path.last
        self._rows.append({"t": point.t} | step_values(self.last))
        return self.last

    def _path(self, state: State) -> FacePath:
        problem, loaded = self._problem(state, self.fixed), self._problem(state, self.fixed + self.case)
        q_1 = np.append(loaded.q - problem.q, loaded.pull - problem.pull)
        now = self.law.Start(self._problem(state, self.fixed + self.t * self.case), state.history)
        return FacePath(problem, q_1, PathPoint(now, self.t), self._earlier)

    def _problem(self, state: State, case: ReducedCase) -> FaceProblem:
        whole, cone = self.reduced.Whole(case), state.cone
        return self.law.Problem(self.reduced.RightSide(whole, cone), self.reduced.Faces(cone, state.history, whole))
