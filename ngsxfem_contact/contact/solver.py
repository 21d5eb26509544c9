"""From a ContactProblem to a ContactSolution: elimination of U, the active set, and what was checked on the way."""

from dataclasses import dataclass, fields

import numpy as np
from ngsolve import GridFunction
from scipy.spatial import cKDTree

from ..algebra.active_set import coarse_start
from ..algebra.elimination import Elimination, ReducedLoad
from ..arguments import check_type, check_whole
from ..errors import NotConverged
from ..loads.load import AppliedLoad
from ..loads.reactions import SupportResidual
from ..progress import doing
from ..spaces.negligible import without_negligible
from ..spaces.unknowns import tip_unknowns
from .checks import check_coercive, check_energies, check_gap, check_load, check_multiplier, check_rigid_motions
from .cones import CONES
from .contact_system import GivenTraction
from .friction import transformation
from .report import Report, stage
from .solution import ContactSolution, State

TINY = np.finfo(float).tiny
STEP_OPTIONS = ("cone", "r", "start", "max_iterations", "previous")


def solve(problem, inverse=None, **options):
    """Solves a ContactProblem and returns its ContactSolution.

    inverse: NGSolve's name of the direct solver for K - K_γ, see `Elimination`; default "sparsecholesky", and "pardiso" for
    large problems where MKL is installed.    As everywhere in NGSolve, more than one thread is used inside `with TaskManager():`.
    options: cone, r, start, max_iterations, previous as for ReducedProblem.Step.
    Raises SingularSystem, NotCoercive, NotConverged, and ValueError for data that are not finite.
    """
    with doing("solving"):
        return ReducedProblem(problem, inverse).Solve(**options)


@dataclass
class Load:
    """F and given displacements of one load case, eliminated: `load.reduced` is that of F + F_γ - A U_D.  g: E A⁻¹(F + F_γ - A U_D) + E U_D.
    jumps: given at mouths, see Supports.NormalJumps.

    given_traction: F_γ and G_γ, see `ContactSystem.Given`.    The load cases of a problem can be added and multiplied by numbers.
    """

    F: np.ndarray
    given: np.ndarray
    given_traction: GivenTraction
    reduced: ReducedLoad
    g: np.ndarray
    applied: AppliedLoad
    jumps: np.ndarray

    def __add__(self, other):
        return Load(*(getattr(self, part.name) + getattr(other, part.name) for part in fields(self)))

    def __rmul__(self, factor):
        return Load(*(factor * getattr(self, part.name) for part in fields(self)))

    @property
    def forces(self):
        """F + F_γ, the right-hand side of the first row of (38)."""
        return self.F + self.given_traction.F


class ReducedProblem:
    """A ContactProblem with the displacements eliminated: S = E A⁻¹ Eᵀ + D_γ, g = E A⁻¹F - G, E = B - C_γ, A = K - K_γ.

    Solves for several cones, starts or loads without another factorisation.    check=False: for studies of what happens
    when K - K_γ is not coercive; the residual and the signs of a solution are checked all the same.
    """

    def __init__(self, problem, inverse=None, check=True):
        self.problem, self.timings, self.check, self.transformed = problem, {}, check, {}
        size = f"{problem.V.ndof} displacement unknowns"
        with stage(self.timings, "check", f"checking rigid motions, {size}"):
            check_rigid_motions(problem)
            problem.supports.Check()
            self.supports = problem.supports.Holders(), problem.supports.CornerEdges()
        with stage(self.timings, "assemble", f"assembling, {size}"):
            self.system = system = problem.Assemble()
            check_gap(system)
        with stage(self.timings, "factor", f"eliminating {size}"):
            free = without_negligible(system.stiffness, problem.V, problem.free)
            self.elimination = Elimination(system.stiffness, free, tip_unknowns(problem.V), system.C, inverse)
            if check:
                check_coercive(problem, self.elimination)
            m = system.E.shape[0]
            self.S = self.elimination.S[:m] @ system.Distribute(np.eye(m)) + system.D.toarray()
        with stage(self.timings, "load", f"eliminating {size} from the load"):
            self.initial = self._initial_load()
            self.load = self.PresentLoad()

    def PresentLoad(self):
        """The Load of what the problem holds now."""
        given, jumps = self.problem.given.vec.FV().NumPy().copy(), self.problem.supports.NormalJumps()
        return self.Load(self.problem.Loads(), given, AppliedLoad.Of(self.problem.f), jumps)

    def _initial_load(self):
        """That of initial stress and temperature, which load steps do not scale; None if there are none."""
        form, jumps = self.problem.initial, self.problem.supports.NormalJumps()
        if not form.given:
            return None
        return self.Load(form.Assemble().vec.FV().NumPy().copy(), np.zeros(self.problem.V.ndof), AppliedLoad.Of(form), 0 * jumps)

    def Load(self, F, given, applied, jumps):
        """The Load of a vector F and given displacements, arrays of length ndof, F the vector of `applied`: one back-substitution."""
        check_load(F, given)
        check_energies(F, given, self.system.stiffness)
        traction = self.system.Given(applied)
        forces = F + traction.F
        reduced = self.elimination.Reduce(forces - self.system.Stiffness(given) if given.any() else forces)
        return Load(F, given, traction, reduced, reduced.crack[: self.system.E.shape[0]] + self.system.E @ given, applied, jumps)

    def Displacement(self, L, load=None):
        """U for a multiplier L: one back-substitution."""
        load = load or self.load
        return self.elimination.Recover(load.reduced, self.system.Distribute(L)) + load.given

    def Solve(self, **options):
        """The ContactSolution, its equations checked; options as for Step."""
        solution = self.Step(**options)
        solution.u  # recovered and checked now
        return solution

    def Step(self, cone=None, r=1.0, start=None, max_iterations=100, load=None, previous=None):
        """A ContactSolution whose displacement is recovered, and whose residuals are checked, when it is first used.

        cone: "nonpositive" or "weak"; default the problem's.    r: the parameter of the projection (39), relative; the
        answer does not depend on it.    start: first active set: boolean, one for each nodal sign, or a ContactSolution
        on any mesh with the same cracks; default: that of `previous`, or from coarser sets, see
        active_set.coarse_start.    load: a Load; default what the problem held when it was reduced.
        previous: with friction the ContactSolution of the last load step, on the same spaces: slip is measured from there.
        """
        problem, load, cone = self.problem, load or self.load, problem_cone(self.problem, cone)
        self.system.CheckCone(cone)
        load = load if self.initial is None else self.initial + load
        check_whole(max_iterations, "max_iterations", 1)
        check_type(previous, ContactSolution | None, "previous", "the ContactSolution of the last load step")
        problem.supports.CheckOverlap(load.jumps, problem.gap, np.abs(load.given).max())
        report = Report(
            (int(problem.V.ndof), int(problem.W.ndof)), self.elimination.name, dict(self.timings), notes=list(problem.body.notes), projection=problem.projection
        )
        with stage(report.timings, "active set", f"contact on {len(self.system.nodes)} nodes of the crack"):
            T, Q = self._signs(cone)
            G = self._gaps(previous) + load.given_traction.G
            q = T.T @ (load.g - G)
            start = self._first_set(Q, q, start, previous, report)
            p = problem.friction.Solve(Q, q, self.system.nodes, cone, report, r, start, max_iterations)
        L = T @ p
        moments = load.g + self.S @ L
        recover = lambda: self._recover(report, load, L, G, p, T, cone)
        work = problem.friction.Work(p, T.T @ (moments - G), self.system.nodes, cone, None if previous is None else previous.state.p)
        state = State(self.system.nodes, L, moments - load.given_traction.G, moments - G, p, work)
        return ContactSolution(problem, recover, multipliers(problem, self.system, L), report, self.system.gamma, state, load)

    def _gaps(self, previous):
        """G of the second row of (38); its tangential part is (B - C_γ)_t U + D_γ L_t of the previous solution.

        Where a node sticks, the slip beyond the previous one is zero; measured with its stabilising part it is zero
        exactly for unchanged loads.
        """
        problem = self.problem
        if previous is None:
            return self.system.G
        if previous.problem.V is not problem.V or previous.problem.W is not problem.W:
            raise ValueError("previous is a solution on other spaces; load steps need one on the V and W of the problem")
        if len(previous.state.moments) != len(self.system.G):
            raise ValueError("previous is a solution with another number of multipliers; both load steps need friction")
        G = self.system.G.copy()
        G[len(self.system.nodes) :] = previous.state.moments[len(self.system.nodes) :]
        return G

    def _first_set(self, Q, q, start, previous, report):
        nodes = self.system.nodes
        if start is None and previous is not None:
            return previous.report.active[-1]
        if isinstance(start, ContactSolution):
            return active_on(nodes, start)
        if start is not None:
            return start
        n = len(nodes)
        active, report.coarse_iterations = coarse_start(Q[:n, :n], q[:n], nodes.neighbours)
        return active

    def _signs(self, cone):
        """T with L = T p, and Tᵀ S T; checked once for each cone."""
        if cone not in self.transformed:
            T = transformation(self.problem.friction, cone, self.system.nodes)
            Q = T.T @ self.S @ T
            if self.check:
                check_multiplier(Q, self.system.gamma is not None)
            self.transformed[cone] = T, Q
        return self.transformed[cone]

    def _recover(self, report, load, L, G, p, T, cone):
        with stage(report.timings, "recover", "recovering and checking the displacement"):
            u, U = GridFunction(self.problem.V, "u"), self.Displacement(L, load)
            self.Accept(report, load, U, L, G, p, T, cone)
            u.vec.FV().NumPy()[:] = U
        exerted = self.system.Stiffness(U) - load.forces - self.system.Forces(L)
        return u, SupportResidual(*self.supports, exerted, -self.problem.a.Forces(u))

    def Accept(self, report, load, U, L, G, p, T, cone, tolerance=1e-8):
        """Measures the residual of (38) and the complementarity of a solution; raises NotConverged where they are not met."""
        system, EL = self.system, self.system.Forces(L)
        report.residual = self.elimination.RelativeResidual((load.forces, EL), U)
        report.complementarity = complementarity(system, self.problem, U, L, G, load.g - G, p, T, cone)
        report.converged = report.residual < tolerance and report.complementarity < tolerance
        if not report.converged:
            raise NotConverged(
                f"the solution does not satisfy its own equations to {tolerance:g}: try another direct solver than inverse={self.elimination.name!r}, "
                f"and look for elements or materials that differ by many orders of magnitude\n{report}"
            )


def problem_cone(problem, cone):
    """The cone of a name, by default the problem's; raises ValueError for an unknown one."""
    if cone is None:
        return problem.cone
    if isinstance(cone, str) and cone not in CONES:
        raise ValueError(f"cone={cone!r} is not one of {sorted(CONES)}")
    return CONES[cone] if isinstance(cone, str) else cone


def active_on(nodes, solution):
    """The active set of a solution at nodes: that of the nearest of its own nodes on the same crack."""
    theirs, active = solution.state.nodes, np.empty(len(nodes), dtype=bool)
    number, ours = (int(of.cracks.max()) + 1 for of in (theirs, nodes))
    if number != ours:
        raise ValueError(f"start is a solution with {number} cracks for a problem with {ours}; both need the same cracks")
    for crack in range(ours):
        there, here = np.flatnonzero(theirs.cracks == crack), nodes.cracks == crack
        _, nearest = cKDTree(theirs.positions[there]).query(nodes.positions[here])
        active[here] = solution.report.active[-1][there[nearest]]
    return active


def complementarity(system, problem, U, L, G, free_gap, p, T, cone):
    """The largest violation of the nodal conditions: pressures relative to the largest, gaps and slips to the largest displacement.

    free_gap: the second row of (38) without multipliers; its jumps count as displacements, which may all be zero where contact carries the load.
    """
    w = T.T @ (system.Moments(U, L) - G)
    lengths = np.maximum(np.abs(T.T) @ np.tile(system.nodes.weights, len(problem.friction.components)), TINY)
    displacement = max(np.abs(U[: 2 * (problem.V.scalar_space.ndof + problem.V.num_heaviside)]).max(), (np.abs(T.T @ free_gap) / lengths).max())
    scale = max(np.abs(p).max(), TINY)
    return problem.friction.Violation(p / scale, w / np.maximum(lengths * displacement, TINY), scale, system.nodes, cone)


def multipliers(problem, system, L):
    """L as GridFunctions: λ, and λ_t with friction."""
    names = ("multiplier", "tangential_multiplier")[: len(problem.friction.components)]
    return [system.Function(problem, values, name) for name, values in zip(names, np.split(L, len(names)))]
