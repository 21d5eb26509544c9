"""From a ContactProblem to a ContactSolution: elimination of U, the active set, and what was checked on the way."""

from dataclasses import dataclass

import numpy as np
from ngsolve import GridFunction

from .active_set import solve_active_set
from .checks import check_coercive, check_data, check_multiplier, check_rigid_motions
from .elimination import Elimination, ReducedLoad
from .errors import NotConverged
from .report import Report, Stopwatch
from .solution import ContactSolution

TINY = np.finfo(float).tiny


def solve(problem, inverse=None, **options):
    """Solves a ContactProblem and returns its ContactSolution.

    inverse: NGSolve's name of the direct solver for K - K_γ, see `Elimination`; default "pardiso" where MKL is installed
    and "sparsecholesky" elsewhere.    As everywhere in NGSolve, more than one thread is used inside `with TaskManager():`.
    options: cone, r, start, max_iterations as for ReducedProblem.Solve.
    Raises SingularSystem, NotCoercive, NotConverged, and ValueError for data that are not finite.
    """
    return ReducedProblem(problem, inverse).Solve(**options)


@dataclass
class Load:
    """F and given displacements of one load case, eliminated: `load.reduced` is that of F - A U_D.  g: E A⁻¹(F - A U_D) + E U_D.

    The load cases of a problem can be added and multiplied by numbers.
    """

    F: np.ndarray
    given: np.ndarray
    reduced: ReducedLoad
    g: np.ndarray

    def __add__(self, other):
        return Load(self.F + other.F, self.given + other.given, self.reduced + other.reduced, self.g + other.g)

    def __rmul__(self, factor):
        return Load(factor * self.F, factor * self.given, factor * self.reduced, factor * self.g)


class ReducedProblem:
    """A ContactProblem with the displacements eliminated: S = E A⁻¹ Eᵀ + D_γ, g = E A⁻¹F - G, E = B - C_γ, A = K - K_γ.

    Solves for several cones, starts or loads without another factorisation.    check=False: for studies of what happens
    when K - K_γ is not coercive; the residual and the signs of a solution are checked all the same.
    """

    def __init__(self, problem, inverse=None, check=True):
        self.problem, self.timings, self.check = problem, {}, check
        watch = Stopwatch(self.timings)
        check_rigid_motions(problem)
        watch.Mark("check")
        self.system = system = problem.Assemble()
        check_data(system, problem)
        watch.Mark("assemble")
        self.elimination = Elimination(system.stiffness, problem.V, problem.free, system.E, inverse)
        if check:
            check_coercive(problem, self.elimination)
        self.S = self.elimination.S + system.D.toarray()
        watch.Mark("factor")
        self.load = self.Load(system.F, problem.given.vec.FV().NumPy().copy())
        watch.Mark("load")

    def Load(self, F, given):
        """The Load of a vector F and given displacements, arrays of length ndof: one back-substitution."""
        reduced = self.elimination.Reduce(F - self.system.Stiffness(given) if given.any() else F)
        return Load(F, given, reduced, reduced.crack + self.system.E @ given)

    def Displacement(self, L, load=None):
        """U for a multiplier L, refined where that is needed."""
        load = load or self.load
        return self.elimination.Recover(load.reduced, L) + load.given

    def Solve(self, cone=None, r=1.0, start=None, max_iterations=100, load=None):
        """The ContactSolution.

        cone: an object of `cones`; default the problem's.    r: the parameter of the projection (39), relative; the
        answer does not depend on it.    start: first active set (boolean, one for each nodal sign); default empty.
        load: a Load; default the problem's.
        """
        problem, load = self.problem, load or self.load
        report = Report((int(problem.V.ndof), int(problem.W.ndof)), self.elimination.name, dict(self.timings))
        watch = Stopwatch(report.timings)
        T = (cone or problem.cone).Transformation(problem.W)
        Q = T.T @ self.S @ T
        if self.check:
            check_multiplier(Q)
        result = solve_active_set(Q, T.T @ (load.g - self.system.G), r, start, max_iterations)
        report.iterations, report.active, report.fallback = result.iterations, result.active, result.fallback
        watch.Mark("active set")
        L = T @ result.p
        U = self.Displacement(L, load)
        self.Accept(report, load, U, L, result.p, T)
        watch.Mark("recover")
        return make_solution(problem, U, L, report, self.system.gamma)

    def Accept(self, report, load, U, L, p, T, tolerance=1e-8):
        """Measures the residual of (38) and the complementarity of a solution; raises NotConverged where they are not met."""
        system, EL = self.system, self.system.E.T @ L
        residual = self.elimination.Residual(load.F + EL, U)
        forces = max(np.abs(load.F).max(), np.abs(EL).max(), self.elimination.ForceScale(U), TINY)
        report.residual = float(np.abs(residual).max() / forces)
        report.complementarity = complementarity(system, self.problem, U, L, p, T)
        report.converged = report.residual < tolerance and report.complementarity < tolerance
        if not report.converged:
            raise NotConverged(f"the solution does not satisfy its own equations to {tolerance:g}:\n{report}")


def make_solution(problem, U, L, report, gamma):
    """The GridFunctions of a solution."""
    u, multiplier = GridFunction(problem.V, "u"), GridFunction(problem.W, "multiplier")
    u.vec.FV().NumPy()[:] = U
    multiplier.vec.FV().NumPy()[:] = L
    return ContactSolution(problem, u, multiplier, report, gamma)


def complementarity(system, problem, U, L, p, T):
    """The largest violation of p ≤ 0, w ≤ 0, p·w = 0: pressures relative to the largest, gaps to the largest displacement."""
    w = T.T @ system.Residual(U, L)
    displacement = np.abs(U[: 2 * (problem.V.scalar_space.ndof + problem.V.num_heaviside)]).max()
    p = p / max(np.abs(p).max(), TINY)
    w = w / np.maximum(np.abs(T.T) @ np.abs(system.weights) * displacement, TINY)
    return float(max(p.max(), w.max(), np.minimum(-p, -w).max(), 0))
