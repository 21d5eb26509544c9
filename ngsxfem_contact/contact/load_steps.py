"""Many loads on one problem: everything sparse is done once, each step runs on the crack's own unknowns."""

import logging
from collections.abc import Sequence
from typing import Any, Literal

from ..arguments import check_number, check_type
from ..loads.changes import check_unchanged
from ..tables import Table
from .load_case import LoadCase
from .options import Start, StepOptions
from .problem import ContactProblem
from .profile import step_values
from .solution import ContactSolution

logger = logging.getLogger(__name__)


class LoadSteps:
    """Solves (38) for F(t) = Σ t_i F_i, with the displacements Σ t_i U_D,i given where the problem is held.

    Parameters
    ----------
    problem : ContactProblem
        What is loaded.
    cases
        LoadCases of the problem; default one, what it holds now, so that t scales all loads. The initial gap, the initial stress and the temperature
        stay. Coefficients, such as a Parameter, count with the values that they have when the case is made.
    inverse
        As for ContactProblem.Solve.

    Notes
    -----
    Stiffness matrix, multipliers, held parts, the gap and the given stresses are those of the problem when LoadSteps is built. One
    factorisation, one back-substitution for each case, then dense algebra of the size of the multiplier for each step;
    the displacement of a step costs a back-substitution when it is first used, and is checked then.
    With friction slip is measured from the step before (`previous=None` starts afresh), so the order of steps matters.

    Examples
    --------
    ::

        steps = LoadSteps(problem)
        solutions = [steps.Solve(t) for t in np.linspace(0, 1, 21)]

        problem.SetDirichlet((0, -1e-3), "top");  press = LoadCase(problem)
        problem.SetDirichlet((0, 0), "top");  problem.f += shear * v * body.ds("left");  push = LoadCase(problem)
        steps = LoadSteps(problem, [press, push]);  solution = steps.Solve(1, 0.3)
    """

    def __init__(self, problem: ContactProblem, cases: Sequence[LoadCase] | None = None, inverse: str | None = None) -> None:
        check_type(problem, ContactProblem, "LoadSteps: problem", "a ContactProblem")
        check_type(cases, list | tuple | None, "LoadSteps: cases", "a list of LoadCases, [LoadCase(problem), ...], or None for what the problem holds")
        for case in cases or ():
            check_type(case, LoadCase, "LoadSteps: a case", "a LoadCase(problem)")
            if case.held != frozenset(problem.supports.sides):
                raise ValueError("LoadSteps: SetDirichlet has freed or fixed components since a load case was made; all cases need the same ones")
            if case.load.acts_on_faces:
                check_unchanged(case.load, case.F, problem.V, "a LoadCase was made")
        self.reduced = problem.Reduced(inverse)
        self.cases = [self.reduced.case] if cases is None else [self.reduced.Reduce(case) for case in cases]
        if not self.cases:
            raise ValueError("LoadSteps: there is no load case; give LoadCase(problem) objects, or None for what the problem holds")
        self.last: ContactSolution | None = None
        self._rows: list[dict[str, Any]] = []

    @property
    def table(self) -> Table:
        """A Table of the steps so far: the factors t, or t_0, t_1, ... of several cases, and `step_values`."""
        return Table.OfRows(self._rows, ["t"])

    def Solve(
        self,
        *t: float,
        cone: str | None = None,
        start: Start = None,
        max_iterations: int = StepOptions.max_iterations,
        previous: ContactSolution | Literal["last"] | None = "last",
    ) -> ContactSolution:
        """The solution for the factors t.

        Parameters
        ----------
        *t : float
            One for each case.
        cone
            As for ContactProblem.Solve.
        start
            As for ContactProblem.Solve; default the active set of the step before.
        max_iterations
            As for ContactProblem.Solve.
        previous
            From which slip is measured; default the step before, None: the body without slip.


        Raises
        ------
        ValueError
            Unless there is one finite factor for each case.
        NotConverged
            For the displacement's own residual when `solution.u` is first used.
        """
        if len(t) != len(self.cases):
            raise ValueError(f"LoadSteps: {len(t)} factor(s) for {len(self.cases)} load case(s); give one factor for each")
        for i, factor in enumerate(t):
            check_number(factor, f"LoadSteps: the factor of load case {i}, t")
        logger.info("load step, factors %s", ", ".join(f"{factor:g}" for factor in t))
        case = t[0] * self.cases[0]
        for factor, other in zip(t[1:], self.cases[1:]):
            case = case + factor * other
        if previous == "last":
            previous = self.last if self.reduced.problem.law.depends_on_path else None
        options = StepOptions(cone, self.last if start is None else start, max_iterations, previous)
        self.last = self.reduced.Step(options, case)
        factors = {"t": t[0]} if len(t) == 1 else {f"t_{i}": factor for i, factor in enumerate(t)}
        self._rows.append(factors | step_values(self.last))
        return self.last
