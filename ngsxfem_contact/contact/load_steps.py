"""Many loads on one problem: everything sparse is done once, each step runs on the crack's own unknowns."""

from ..arguments import check_number, check_options, check_type
from ..loads.load import AppliedLoad, check_unchanged
from ..progress import doing
from .checks import check_load
from .solver import STEP_OPTIONS, ReducedProblem


class LoadCase:
    """The load F and the given displacements U_D that a problem holds now, copied: what is added to it later is another case.

    Parameters
    ----------
    problem : ContactProblem

    Raises
    ------
    ValueError
        For a load or a given displacement that is not finite, and for given displacements that contradict each other.
    """

    def __init__(self, problem):
        problem.supports.Check()
        self.jumps, self.held = problem.supports.NormalJumps(), frozenset(problem.supports.sides)
        self.F = problem.f.Assemble().vec.FV().NumPy().copy()
        self.applied = AppliedLoad.Of(problem.f)
        self.given = problem.given.vec.FV().NumPy().copy()
        check_load(self.F, self.given, "LoadCase: ")


class LoadSteps:
    """Solves (38) for F(t) = Σ t_i F_i, with the displacements Σ t_i U_D,i given where the problem is held.

    Parameters
    ----------
    problem : ContactProblem
        What is loaded.
    cases
        LoadCases of the problem; default one, what it holds now, so that t scales all loads. The initial gap, the initial stress and the temperature
        stay.
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

    def __init__(self, problem, cases=None, inverse=None):
        for case in cases or ():
            check_type(case, LoadCase, "LoadSteps: a case", "a LoadCase(problem)")
            if case.held != frozenset(problem.supports.sides):
                raise ValueError("LoadSteps: SetDirichlet has freed or fixed components since a load case was made; all cases need the same ones")
            if case.applied.acts_on_faces:
                check_unchanged(case.applied, case.F, problem.V, "a LoadCase was made")
        with doing("load steps"):
            self.reduced = ReducedProblem(problem, inverse)
        self.loads = [self.reduced.load] if cases is None else [self.reduced.Load(case.F, case.given, case.applied, case.jumps) for case in cases]
        if not self.loads:
            raise ValueError("LoadSteps: there is no load case; give LoadCase(problem) objects, or None for what the problem holds")
        self.last = None

    def Solve(self, *t, start=None, **options):
        """The solution for the factors t.

        Parameters
        ----------
        *t : float
            One for each case.
        start
            As for ContactProblem.Solve; default the active set of the step before.
        **options
            cone, r, max_iterations, previous.

        Returns
        -------
        ContactSolution

        Raises
        ------
        TypeError
            For another option.
        ValueError
            Unless there is one finite factor for each case.
        NotConverged
            For the displacement's own residual when `solution.u` is first used.
        """
        check_options(options, STEP_OPTIONS, "LoadSteps.Solve")
        if len(t) != len(self.loads):
            raise ValueError(f"LoadSteps: {len(t)} factor(s) for {len(self.loads)} load case(s); give one factor for each")
        for i, factor in enumerate(t):
            check_number(factor, f"LoadSteps: the factor of load case {i}, t")
        load = t[0] * self.loads[0]
        for factor, case in zip(t[1:], self.loads[1:]):
            load = load + factor * case
        if self.last is not None and self.reduced.problem.friction.depends_on_path:
            options = {"previous": self.last} | options
        self.last = self.reduced.Step(start=self.last if start is None else start, load=load, **options)
        return self.last
