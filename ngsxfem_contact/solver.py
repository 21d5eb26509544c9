"""From a ContactProblem to a ContactSolution: elimination of U, the active set, and what was checked on the way."""

import numpy as np
from ngsolve import GridFunction

from .checks import check_coercive, check_data, check_multiplier, check_rigid_motions
from .elimination import StiffnessInverse, schur_complement
from .errors import NotConverged
from .friction import transformation
from .report import Report, Stopwatch
from .solution import ContactSolution
from .spaces import to_scipy

TINY = np.finfo(float).tiny


def solve(problem, inverse="sparsecholesky", previous=None, **options):
    """Solves a ContactProblem and returns its ContactSolution.

    inverse: NGSolve's direct solver for K - K_γ, which is symmetric positive definite.    As everywhere in NGSolve, more
    than one thread is used inside `with TaskManager():`.
    previous: with friction the ContactSolution of the last load step, on the same spaces: slip is measured from there.
    options: cone, r, start, max_iterations as for ReducedProblem.Solve.
    Raises SingularSystem, NotCoercive, NotConverged, and ValueError for data that are not finite.
    """
    return ReducedProblem(problem, inverse, previous=previous).Solve(**options)


def check_previous(problem, previous):
    """Raises ValueError for a previous solution on other spaces."""
    if previous is not None and (previous.problem.V is not problem.V or previous.problem.W is not problem.W):
        raise ValueError("previous: a solution on other spaces; load steps need the V and W of the problem")


class ReducedProblem:
    """A ContactProblem with the displacements eliminated: S = E A⁻¹ Eᵀ + D_γ, g = E A⁻¹F - G, E = B - C_γ, A = K - K_γ.

    Solves for several cones or starts without another factorisation.    check=False: for studies of what happens when
    K - K_γ is not coercive; the residual and the signs of a solution are checked all the same.
    """

    def __init__(self, problem, inverse="sparsecholesky", check=True, previous=None):
        self.problem, self.timings, self.check, self.previous = problem, {}, check, previous
        watch = Stopwatch(self.timings)
        check_previous(problem, previous)
        check_rigid_motions(problem)
        watch.Mark("check")
        self.system = system = problem.Assemble(previous)
        check_data(system, problem)
        watch.Mark("assemble")
        if check:
            check_coercive(problem)
        self.factors = StiffnessInverse(system.stiffness, problem.V, problem.free, inverse)
        watch.Mark("factor")
        self.S = schur_complement(system.E, self.factors) + system.D.toarray()
        self._reduce_loads()
        watch.Mark("reduce")

    def _reduce_loads(self):
        self.given = self.problem.given.vec.FV().NumPy().copy()
        self.load = self.system.F - self.system.Stiffness(self.given)
        self.g = self.system.Residual(self.Displacement(np.zeros(len(self.S))), np.zeros(len(self.S)))

    def NextStep(self, previous):
        """Takes the problem's present loads and given displacements, slip measured from a previous solution; no factorisation."""
        check_previous(self.problem, previous)
        self.previous = previous
        self.system.SetLoads(self.problem, previous)
        check_data(self.system, self.problem)
        self._reduce_loads()

    def Displacement(self, L):
        """U for a multiplier L."""
        return self.factors.SolveRefined(self.load + self.system.E.T @ L) + self.given

    def Solve(self, cone=None, r=1.0, start=None, max_iterations=100):
        """The ContactSolution.

        cone: an object of `cones`; default the problem's.    r: the parameter of the projection (39), relative; the
        answer does not depend on it.    start: first active set (boolean, one for each nodal sign); default empty.
        """
        problem, system = self.problem, self.system
        report = Report((int(problem.V.ndof), int(problem.W.ndof)), dict(self.timings))
        watch = Stopwatch(report.timings)
        cone = cone or problem.cone
        T = transformation(problem.friction, cone, problem.W)
        Q = T.T @ self.S @ T
        if self.check:
            check_multiplier(Q)
        first = self.previous.report if self.previous is not None else None
        p = problem.friction.Solve(Q, T.T @ self.g, problem.W, cone, report, r, start, max_iterations, first)
        watch.Mark("active set")
        L = T @ p
        U = self.Displacement(L)
        accept(report, system, problem, U, L, T, cone)
        watch.Mark("recover")
        slip = -system.Residual(U, L)[problem.W.ndof :]
        return make_solution(problem, U, L, report, system.gamma, slip)


def make_solution(problem, U, L, report, gamma, slip):
    """The GridFunctions of a solution; slip: the increments' moments ∫ψ_i g_t, with the stabilisation's part."""
    u = GridFunction(problem.V, "u")
    u.vec.FV().NumPy()[:] = U
    multipliers = [GridFunction(problem.W, name) for name in ("multiplier", "tangential_multiplier")[: len(problem.friction.components)]]
    for multiplier, values in zip(multipliers, np.split(L, len(multipliers))):
        multiplier.vec.FV().NumPy()[:] = values
    friction_work = float(L[problem.W.ndof :] @ slip)
    return ContactSolution(problem, u, multipliers[0], report, gamma, *multipliers[1:], friction_work=friction_work)


def accept(report, system, problem, U, L, T, cone, tolerance=1e-8):
    """Measures the residual of (38) and the complementarity of a solution; raises NotConverged where they are not met."""
    free = np.array(problem.free, dtype=bool)
    EL, stiffest = system.E.T @ L, to_scipy(system.stiffness).diagonal()
    forces = max(np.abs(system.F).max(), np.abs(EL).max(), np.abs(stiffest * U).max(), TINY)
    report.residual = float(np.abs(system.Stiffness(U) - EL - system.F)[free].max() / forces)
    report.complementarity = complementarity(system, problem, U, L, T, cone)
    report.converged = report.residual < tolerance and report.complementarity < tolerance
    if not report.converged:
        raise NotConverged(f"the solution does not satisfy its own equations to {tolerance:g}:\n{report}")


def complementarity(system, problem, U, L, T, cone):
    """The largest violation of the nodal conditions: pressures relative to the largest, gaps and slips to the largest displacement."""
    p, w = np.linalg.solve(T, L), T.T @ system.Residual(U, L)
    displacement = np.abs(U[: 2 * (problem.V.scalar_space.ndof + problem.V.num_heaviside)]).max()
    scale = max(np.abs(p).max(), TINY)
    w = w / np.maximum(np.abs(T.T) @ np.abs(system.weights) * displacement, TINY)
    return problem.friction.Violation(p / scale, w, scale, problem.W, cone)
