"""From a ContactProblem to a ContactSolution: elimination of U, the active set, and what was checked on the way."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import GridFunction
from pyngcore import SuspendTaskManager

from ..algebra.balance import Balance
from ..algebra.elimination import Elimination
from ..algebra.matrices import added, congruent, product
from ..errors import NotConverged
from ..loads.load import LoadTerms
from ..loads.reactions import SupportResidual
from ..operators import NORMAL
from ..protocols import Cone, Nodes
from ..spaces.exchange import exchange_of
from ..spaces.negligible import without_negligible
from ..spaces.unknowns import Unknowns
from .adjoint import adjoint
from .checks import check_coercive, check_energies, check_gap, check_load, check_multiplier, warn_of_brittle_faces
from .contact_system import ContactSystem
from .faces import FaceHistory, Faces, Scales
from .free_motions import PinnedMotions
from .friction import transformation
from .load_case import LoadCase, ReducedCase, SolvedCase
from .nodal_law import gives_way
from .options import StepOptions
from .profile import State
from .report import Report, stage
from .solid_solution import solution_in
from .solids import check_size
from .solution import ContactSolution
from .stabilisation import local_moduli

if TYPE_CHECKING:
    from ..algebra.matrices import Matrix
    from .problem import ContactProblem

TINY = np.finfo(float).tiny
CONVERGED = 1e-8  # residual and complementarity of an answer, relative


@dataclass
class NodalSolution:
    """What was found on the crack's own unknowns: L = T p, with G the right-hand side of the second row of (38), and rigid motions, for a case and faces."""

    case: ReducedCase
    faces: Faces
    T: "Matrix"
    p: np.ndarray
    G: np.ndarray
    alpha: np.ndarray

    @property
    def L(self) -> np.ndarray:
        """The multipliers."""
        return self.T @ self.p


class ReducedProblem:
    """A ContactProblem with the displacements eliminated: S = E A⁻¹ Eᵀ + D_γ, g = E A⁻¹F - G, E = B - C_γ, A = K - K_γ.

    Solves for several cones, starts or loads without another factorisation.

    Parameters
    ----------
    inverse
        As for ContactProblem.Solve.
    check
        False is for studies of what happens when K - K_γ is not coercive; the residual and the signs of a solution are checked all the same.
    """

    def __init__(self, problem: "ContactProblem", inverse: str | None = None, check: bool = True) -> None:
        self.check = check
        self.timings: dict[str, float] = {}
        self.transformed: dict[Cone, tuple[Matrix, Balance]] = {}
        self.exchange = exchange_of(problem.V)
        self.number = self.exchange.Count(problem.V.ndof)
        size = f"{self.number} displacement unknowns"
        check_size(problem.V, problem.W, problem.law)
        with stage(self.timings, "check", f"checking rigid motions, {size}"):
            self.motions = PinnedMotions(problem)
            problem.supports.Check()
            self.supports = problem.supports.Holders(), problem.supports.CornerEdges()
        slips_freely = problem.law.components == (NORMAL,)
        self.problem = problem = problem.AtNodes() if len(self.motions) else problem
        with stage(self.timings, "assemble", f"assembling, {size}"):
            self.system = system = problem.Assemble()
            check_gap(system)
            if slips_freely:
                self.motions.CheckFelt((system.E @ self.motions.R)[: len(system.nodes)], system.nodes.weights)
            warn_of_brittle_faces(problem, system.nodes)
        with stage(self.timings, "factor", f"eliminating {size}"):
            free = without_negligible(system.stiffness, problem.V, self.motions.Without(problem.free, system.stiffness))
            self.elimination = Elimination(system.stiffness, free, Unknowns(problem.V).tips, system.C, inverse, self.exchange)
            if check:
                check_coercive(problem, self.elimination)
            m = system.E.shape[0]
            self.S = added(product(self.elimination.S[:m], system.distribution), system.D)
        with stage(self.timings, "load", f"eliminating {size} from the load"):
            self.initial = self._initial_case()
            self.case = self.Reduce(LoadCase(problem))

    def _initial_case(self) -> ReducedCase | None:
        """That of initial stress and temperature, which load steps do not scale; None if there are none."""
        form = self.problem.initial
        if not form.given:
            return None
        return self._reduced(form.Vector(), np.zeros(self.problem.V.ndof), LoadTerms.Of(form), 0 * self.problem.supports.NormalJumps())

    def Reduce(self, case: LoadCase) -> ReducedCase:
        """A LoadCase of the problem with the displacements eliminated: one back-substitution."""
        return self._reduced(case.F, case.given, case.load, case.jumps)

    def _reduced(self, F: np.ndarray, given: np.ndarray, load: LoadTerms, jumps: np.ndarray) -> ReducedCase:
        self.exchange.Together(lambda: check_load(F, given))
        check_energies(F, given, self.system.stiffness, self.exchange)
        traction = self.system.Given(load)
        forces = F + traction.F
        reduced = self.elimination.Reduce(forces - self.system.Stiffness(given) if given.any() else forces)
        return ReducedCase(F, given, traction, reduced, reduced.crack[: self.system.E.shape[0]] + self.system.E @ given, load, jumps)

    def Adjoint(self, solution: ContactSolution, J_u: np.ndarray, J_L: list[np.ndarray]) -> tuple[np.ndarray, list[GridFunction]]:
        """z and ζ as functions of W, see `adjoint`, for the derivatives of a quantity by the functions of V and, for each component, of W."""
        z, zeta = adjoint(self, solution, J_u, np.concatenate([self.system.OfFunction(moments) for moments in J_L]))
        return z, multipliers(self.problem, self.system, zeta)

    def Displacement(self, L: np.ndarray, case: ReducedCase | None = None, alpha: np.ndarray | None = None) -> np.ndarray:
        """U for a multiplier L and rigid motions: one back-substitution."""
        case = case or self.case
        U = self.elimination.Recover(case.reduced, self.system.distribution @ L) + case.given
        return U if alpha is None else U + self.motions.R @ alpha

    def Solve(self, options: StepOptions = StepOptions(), case: ReducedCase | None = None) -> ContactSolution:
        """The ContactSolution, its equations checked; as Step."""
        solution = self.Step(options, case)
        solution.u  # recovered and checked now
        return solution

    def Step(self, options: StepOptions = StepOptions(), case: ReducedCase | None = None) -> ContactSolution:
        """A ContactSolution whose displacement is recovered, and whose residuals are checked, when it is first used.

        Parameters
        ----------
        case
            Default what the problem held when it was reduced.
        """
        problem, case, cone = self.problem, case or self.case, options.Cone(self.problem.cone)
        self.system.CheckCone(cone)
        case = self.Whole(case)
        if not gives_way(problem.law, self.system.nodes):
            problem.supports.CheckOverlap(case.jumps, problem.gap, self.exchange.Max(np.abs(case.given).max()))
        report = Report(
            (self.number, int(problem.W.ndof)),
            self.elimination.name,
            dict(self.timings),
            notes=[*problem.body.notes, *self.motions.notes],
            projection=problem.projection,
        )
        with stage(report.timings, "active set", f"contact on {len(self.system.nodes)} nodes of the crack"), SuspendTaskManager():
            found = self._nodal_solution(options, case, cone, report)
        recover, state = lambda: self._recover(found, report), self._state(found)
        report.work = state.work
        return solution_in(problem.V)(
            problem, recover, multipliers(problem, self.system, found.L), report, self.system.gamma, state, SolvedCase(problem.V, case.F, case.load), self
        )

    def _nodal_solution(self, options: StepOptions, case: ReducedCase, cone: Cone, report: Report) -> NodalSolution:
        T, balance = self.Signs(cone)
        faces = self.Faces(cone, self._history(options.previous, cone), case)
        arguments = self.RightSide(case, cone), faces, self._first_set(options), report, options.max_iterations
        found = self.exchange.Together(lambda: self.problem.law.Solve(balance.compliance.matrix, *arguments))
        found, reported = self.exchange.FromFirst((found, vars(report)))
        vars(report).update({name: value for name, value in reported.items() if name != "timings"})
        p, alpha = np.split(found, [len(balance.Q)])
        G = self._gaps(case)
        return NodalSolution(case, faces, T, p, G, balance.Motions(p, alpha, T.T @ (case.g - G), faces.pull))

    def Faces(self, cone: Cone, history: FaceHistory | None, case: ReducedCase) -> Faces:
        """What the law is asked about."""
        _, balance = self.Signs(cone)
        return Faces(self.system.nodes, cone, balance.compliance, np.diag(balance.Q), history, balance.B, self.motions.Forces(case.forces))

    def RightSide(self, case: ReducedCase, cone: Cone) -> np.ndarray:
        """q of w = Q p + q, see Balance."""
        T, balance = self.Signs(cone)
        return balance.RightSide(T.T @ (case.g - self._gaps(case)), self.motions.Forces(case.forces))

    def Whole(self, case: ReducedCase) -> ReducedCase:
        """A load with initial stress and temperature, which nothing scales."""
        return case if self.initial is None else self.initial + case

    def _gaps(self, case: ReducedCase) -> np.ndarray:
        """The right-hand side of the second row of (38)."""
        return self.system.G + case.given_traction.G

    def _state(self, found: NodalSolution) -> State:
        law, faces, p = self.problem.law, found.faces, found.p
        residual = found.case.g + self.S @ found.L - found.G + self.system.E @ (self.motions.R @ found.alpha)
        w = found.T.T @ residual
        return State(faces.nodes, faces.cone, found.L, residual, faces.After(p, w, law.Variables(p, w, faces)), law.Work(p, w, faces))

    def _history(self, previous: ContactSolution | FaceHistory | None, cone: Cone) -> FaceHistory | None:
        """What the faces have gone through; slip with its stabilising part, so that it is zero exactly where a node sticks and the load is unchanged."""
        problem, size = self.problem, (len(self.problem.law.components), len(self.system.nodes))
        if previous is None or (isinstance(previous, ContactSolution) and not previous.body.cracks):
            return None
        if isinstance(previous, FaceHistory):
            if previous.jump.shape != size:
                raise ValueError(f"previous is a history of {previous.jump.shape} components and nodes, the problem has {size}; see FaceHistory.Carried")
            return previous
        if problem.law.depends_on_path and previous.state.cone != cone:
            raise ValueError(f"previous is a solution with the cone {previous.state.cone}, this one has {cone}; all load steps need the same")
        if len(previous.problem.law.components) != len(problem.law.components):
            raise ValueError("previous is a solution with another number of multipliers; both load steps need friction")
        history = previous.state.history
        return history if history is None or is_on(problem, previous) else history.Carried(previous.state.nodes, self.system.nodes)

    def _first_set(self, options: StepOptions) -> Any:
        if options.start is None and isinstance(options.previous, ContactSolution) and is_on(self.problem, options.previous):
            return options.previous.report.active[-1]
        if isinstance(options.start, ContactSolution):
            return active_on(self.system.nodes, options.start)
        return options.start

    def Signs(self, cone: Cone) -> tuple["Matrix", Balance]:
        """T with L = T p, and the Balance of Tᵀ S T; checked once for each cone."""
        if cone not in self.transformed:
            T = transformation(self.problem.law, cone, self.system.nodes)
            weights = np.tile(self.system.nodes.weights, len(self.problem.law.components))
            balance = Balance(congruent(T, self.S), T.T @ (self.system.E @ self.motions.R), weights)
            if self.check:
                check_multiplier(balance.compliance, weights, local_moduli(self.problem.V, self.problem.material).max(initial=0), self.system.gamma is not None)
            self.transformed[cone] = T, balance
        return self.transformed[cone]

    def _recover(self, found: NodalSolution, report: Report) -> tuple[GridFunction, SupportResidual]:
        with stage(report.timings, "recover", "recovering and checking the displacement"):
            u, U = GridFunction(self.problem.V, "u"), self.Displacement(found.L, found.case, found.alpha)
            self._measure(found, U, report)
            check_converged(report)
            u.vec.FV().NumPy()[:] = U
        exerted, springs = self.system.Stiffness(U) - found.case.forces - self.system.Forces(found.L), -self.problem.a.Forces(u)
        return u, SupportResidual(self.problem.V, *self.supports, self.exchange.Cumulated(exerted), self.exchange.Cumulated(springs))

    def _measure(self, found: NodalSolution, U: np.ndarray, report: Report) -> None:
        """The residual of (38) and the complementarity of a solution, into the report."""
        forces = found.case.forces, self.system.Forces(found.L)
        report.residual = max(self.elimination.RelativeResidual(forces, U), self.motions.Imbalance(*forces))
        report.complementarity = complementarity(self.system, self.problem, U, found)
        report.converged = max(report.residual, report.complementarity) < CONVERGED


def is_on(problem: "ContactProblem", solution: ContactSolution) -> bool:
    """Whether a solution has the spaces of a problem, so that its nodes are those of the problem."""
    return solution.problem.V is problem.V and solution.problem.W is problem.W


def check_converged(report: Report) -> None:
    """Raises NotConverged where a solution does not satisfy its own equations."""
    if not report.converged:
        raise NotConverged(
            f"the solution does not satisfy its own equations to {CONVERGED:g}: try another direct solver than inverse={report.inverse!r}, "
            f"and look for elements or materials that differ by many orders of magnitude\n{report}"
        )


def active_on(nodes: Nodes, solution: ContactSolution) -> np.ndarray:
    """The active set of a solution at nodes: that of the nearest of its own nodes on the same crack."""
    theirs, active = solution.state.nodes, np.empty(len(nodes), dtype=bool)
    number, ours = (len(np.unique(of.cracks)) for of in (theirs, nodes))
    if number != ours:
        raise ValueError(f"start is a solution with {number} cracks for a problem with {ours}; both need the same cracks")
    for crack in range(ours):
        there, here = np.flatnonzero(theirs.cracks == crack), nodes.cracks == crack
        _, nearest = scipy.spatial.cKDTree(theirs.positions[there]).query(nodes.positions[here])
        active[here] = solution.report.active[-1][there[nearest]]
    return active


def complementarity(system: ContactSystem, problem: "ContactProblem", U: np.ndarray, found: NodalSolution) -> float:
    """The largest violation of the nodal conditions: pressures relative to the largest, gaps and slips to the largest displacement.

    The jumps of the second row of (38) without multipliers count as displacements, which may all be zero where contact carries the load.
    """
    T, p = found.T, found.p
    w = T.T @ (system.Moments(U, found.L) - found.G)
    lengths = np.maximum(abs(T.T) @ np.tile(system.nodes.weights, len(problem.law.components)), TINY)
    free_gap = np.abs(T.T @ (found.case.g - found.G)) / lengths
    history = found.faces.history
    before = 0.0 if history is None else np.abs(history.jump).max(initial=0)
    displacement = max(system.exchange.Max(np.abs(U[Unknowns(problem.V).regular]).max()), free_gap.max(initial=0), before)
    scale = max(np.abs(p).max(initial=0), TINY)
    return problem.law.Violation(p, w, found.faces, Scales(scale, np.maximum(lengths * displacement, TINY)))


def multipliers(problem: "ContactProblem", system: ContactSystem, L: np.ndarray) -> list[GridFunction]:
    """L as GridFunctions: λ, and λ_t with friction, in space along both tangents."""
    names = ("multiplier", "tangential_multiplier", "second_tangential_multiplier")[: len(problem.law.components)]
    return [system.Function(problem, values, name) for name, values in zip(names, np.split(L, len(names)))]
