"""From a ContactProblem to a ContactSolution: elimination of U, the active set, and what was checked on the way."""

import numpy as np
from ngsolve import GridFunction

from .active_set import solve_active_set
from .checks import check_coercive, check_data, check_multiplier, check_rigid_motions
from .elimination import StiffnessInverse, schur_complement
from .errors import NotConverged
from .report import Report, Stopwatch
from .solution import ContactSolution
from .spaces import to_scipy

TINY = np.finfo(float).tiny


def solve(problem, inverse="sparsecholesky", **options):
    """Solves a ContactProblem and returns its ContactSolution.

    inverse: NGSolve's direct solver for K - K_γ, which is symmetric positive definite.    As everywhere in NGSolve, more
    than one thread is used inside `with TaskManager():`.
    options: cone, r, start, max_iterations as for ReducedProblem.Solve.
    Raises SingularSystem, NotCoercive, NotConverged, and ValueError for data that are not finite.
    """
    return ReducedProblem(problem, inverse).Solve(**options)


class ReducedProblem:
    """A ContactProblem with the displacements eliminated: S = E A⁻¹ Eᵀ + D_γ, g = E A⁻¹F - G, E = B - C_γ, A = K - K_γ.

    Solves for several cones or starts without another factorisation.    check=False: for studies of what happens when
    K - K_γ is not coercive; the residual and the signs of a solution are checked all the same.
    """

    def __init__(self, problem, inverse="sparsecholesky", check=True):
        self.problem, self.timings, self.check = problem, {}, check
        watch = Stopwatch(self.timings)
        check_rigid_motions(problem)
        watch.Mark("check")
        self.system = system = problem.Assemble()
        check_data(system, problem)
        watch.Mark("assemble")
        if check:
            check_coercive(problem)
        self.factors = StiffnessInverse(system.stiffness, problem.V, problem.free, inverse)
        watch.Mark("factor")
        self.given = problem.given.vec.FV().NumPy().copy()
        self.load = system.F - system.Stiffness(self.given)
        self.S = schur_complement(system.E, self.factors) + system.D.toarray()
        self.g = system.Residual(self.Displacement(np.zeros(len(self.S))), np.zeros(len(self.S)))
        watch.Mark("reduce")

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
        T = (cone or problem.cone).Transformation(problem.W)
        Q = T.T @ self.S @ T
        if self.check:
            check_multiplier(Q)
        result = solve_active_set(Q, T.T @ self.g, r, start, max_iterations)
        report.iterations, report.active, report.fallback = result.iterations, result.active, result.fallback
        watch.Mark("active set")
        L = T @ result.p
        U = self.Displacement(L)
        accept(report, system, problem, U, L, T)
        watch.Mark("recover")
        return make_solution(problem, U, L, report, system.gamma)


def make_solution(problem, U, L, report, gamma):
    """The GridFunctions of a solution."""
    u, multiplier = GridFunction(problem.V, "u"), GridFunction(problem.W, "multiplier")
    u.vec.FV().NumPy()[:] = U
    multiplier.vec.FV().NumPy()[:] = L
    return ContactSolution(problem, u, multiplier, report, gamma)


def accept(report, system, problem, U, L, T, tolerance=1e-8):
    """Measures the residual of (38) and the complementarity of a solution; raises NotConverged where they are not met."""
    free = np.array(problem.free, dtype=bool)
    EL, stiffest = system.E.T @ L, to_scipy(system.stiffness).diagonal()
    forces = max(np.abs(system.F).max(), np.abs(EL).max(), np.abs(stiffest * U).max(), TINY)
    report.residual = float(np.abs(system.Stiffness(U) - EL - system.F)[free].max() / forces)
    report.complementarity = complementarity(system, problem, U, L, T)
    report.converged = report.residual < tolerance and report.complementarity < tolerance
    if not report.converged:
        raise NotConverged(f"the solution does not satisfy its own equations to {tolerance:g}:\n{report}")


def complementarity(system, problem, U, L, T):
    """The largest violation of p ≤ 0, w ≤ 0, p·w = 0: pressures relative to the largest, gaps to the largest displacement."""
    p, w = np.linalg.solve(T, L), T.T @ system.Residual(U, L)
    displacement = np.abs(U[: 2 * (problem.V.scalar_space.ndof + problem.V.num_heaviside)]).max()
    p = p / max(np.abs(p).max(), TINY)
    w = w / np.maximum(np.abs(T.T) @ np.abs(system.weights) * displacement, TINY)
    return float(max(p.max(), w.max(), np.minimum(-p, -w).max(), 0))
