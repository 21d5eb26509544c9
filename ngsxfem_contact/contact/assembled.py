"""From a ContactProblem to a ContactSolution: what all ways have in common, and what is checked on the way."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BitArray, GridFunction
from pyngcore import SuspendTaskManager

from ..algebra.elimination import ReducedVector
from ..algebra.symmetric_system import SymmetricSystem
from ..errors import NotConverged
from ..loads.load import LoadTerms
from ..loads.reactions import SupportResidual
from ..operators import NORMAL
from ..protocols import Cone, Nodes
from ..spaces.exchange import exchange_of
from ..spaces.negligible import without_negligible
from ..spaces.unknowns import Unknowns
from .checks import check_energies, check_gap, check_load, warn_of_brittle_faces
from .contact_system import ContactSystem
from .faces import FaceHistory, Faces, Scales
from .free_motions import PinnedMotions
from .load_case import LoadCase, ReducedCase, SolvedCase
from .nodal_law import gives_way
from .options import StepOptions
from .profile import State
from .report import Report, stage
from .solid_solution import solution_in
from .solution import ContactSolution

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


class AssembledProblem(ABC):
    """A ContactProblem with the matrices of (38), which it solves for several load cases, starts and histories.

    Parameters
    ----------
    inverse
        As for ContactProblem.Solve.

    Attributes
    ----------
    linear
        (K - K_γ) on the unknowns that are free, a SymmetricSystem.
    """

    linear: SymmetricSystem

    def __init__(self, problem: "ContactProblem", inverse: str | None = None) -> None:
        self.timings: dict[str, float] = {}
        self.exchange = exchange_of(problem.V)
        self.number = self.exchange.Count(problem.V.ndof)
        size = f"{self.number} displacement unknowns"
        self._admit(problem)
        with stage(self.timings, "check", f"checking rigid motions, {size}"):
            problem.supports.Update()
            self.motions = PinnedMotions(problem)
            problem.supports.Check()
            self.supports = problem.supports.Holders(), problem.supports.CornerEdges()
        slips_freely = problem.law.components == (NORMAL,)
        self.problem = problem = self._with_motions(problem) if len(self.motions) else problem
        with stage(self.timings, "assemble", f"assembling, {size}"):
            self.system = system = problem.Assemble()
            self.exchange.Together(lambda: check_gap(system))
            if slips_freely:
                self.motions.CheckFelt((system.E @ self.motions.R)[: len(system.nodes)], system.nodes.weights)
            warn_of_brittle_faces(problem, system.nodes)
        with stage(self.timings, "factor", f"{self.preparing} {size}"):
            self._prepare(without_negligible(system.stiffness, problem.V, self.motions.Without(problem.free, system.stiffness)), inverse)
        with stage(self.timings, "load", f"{self.preparing} {size} of the load"):
            self.initial = self._initial_case()
            self.case = self.Reduce(LoadCase(problem))

    preparing = "eliminating"

    @abstractmethod
    def _admit(self, problem: "ContactProblem") -> None:
        """Raises ValueError for a problem that is too large, or that there is no such solver for."""

    @abstractmethod
    def _with_motions(self, problem: "ContactProblem") -> "ContactProblem":
        """The problem where there are motions that only faces hold."""

    @abstractmethod
    def _prepare(self, free: BitArray, inverse: str | None) -> None:
        """Sets `linear`, and what else is done once."""

    @abstractmethod
    def _report(self) -> Report:
        """That of a step which begins."""

    @abstractmethod
    def _nodal_solution(self, options: StepOptions, case: ReducedCase, cone: Cone, report: Report) -> NodalSolution:
        """What is found on the nodes of the cracks."""

    @abstractmethod
    def _displacement(self, found: NodalSolution) -> np.ndarray:
        """U."""

    @abstractmethod
    def _reduced_load(self, forces: np.ndarray, given: np.ndarray) -> tuple[ReducedVector, np.ndarray]:
        """The ReducedVector of forces, less those of given displacements, and g of ReducedCase."""

    @abstractmethod
    def _residual(self, found: NodalSolution) -> np.ndarray:
        """(B - C_γ) U + D_γ L - G."""

    @abstractmethod
    def _free_jumps(self, found: NodalSolution, U: np.ndarray) -> np.ndarray:
        """Of (B - C_γ) U - G what counts as displacements, see `complementarity`."""

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
        reduced, g = self._reduced_load(forces, given)
        return ReducedCase(F, given, traction, reduced, g, load, jumps)

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
        report = self._report()
        with stage(report.timings, "active set", f"contact on {len(self.system.nodes)} nodes of the crack"), SuspendTaskManager():
            found = self._nodal_solution(options, case, cone, report)
        recover, state = lambda: self._recover(found, report), self._state(found)
        report.work = state.work
        return solution_in(problem.V)(
            problem, recover, multipliers(problem, self.system, found.L), report, self.system.gamma, state, SolvedCase(problem.V, case.F, case.load), self
        )

    def Whole(self, case: ReducedCase) -> ReducedCase:
        """A load with initial stress and temperature, which nothing scales."""
        return case if self.initial is None else self.initial + case

    def _gaps(self, case: ReducedCase) -> np.ndarray:
        """The right-hand side of the second row of (38)."""
        return self.system.G + case.given_traction.G

    def _state(self, found: NodalSolution) -> State:
        law, faces, p = self.problem.law, found.faces, found.p
        residual = self._residual(found)
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

    def _recover(self, found: NodalSolution, report: Report) -> tuple[GridFunction, SupportResidual]:
        with stage(report.timings, "recover", "recovering and checking the displacement"):
            u, U = GridFunction(self.problem.V, "u"), self._displacement(found)
            self._measure(found, U, report)
            check_converged(report)
            u.vec.FV().NumPy()[:] = U
        exerted, springs = self.system.Stiffness(U) - found.case.forces - self.system.Forces(found.L), -self.problem.a.Forces(u)
        return u, SupportResidual(self.problem.V, *self.supports, self.exchange.Cumulated(exerted), self.exchange.Cumulated(springs))

    def _measure(self, found: NodalSolution, U: np.ndarray, report: Report) -> None:
        """The residual of (38) and the complementarity of a solution, into the report."""
        forces = found.case.forces, self.system.Forces(found.L)
        report.residual = max(self.linear.RelativeResidual(forces, U), self.motions.Imbalance(*forces))
        report.complementarity = complementarity(self.system, self.problem, U, found, self._free_jumps(found, U))
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
    if (dim := theirs.positions.shape[1]) != nodes.positions.shape[1]:
        raise ValueError(f"start is a solution in {dim} dimensions, the problem has {nodes.positions.shape[1]}")
    number, ours = (len(np.unique(of.cracks)) for of in (theirs, nodes))
    if number != ours:
        raise ValueError(f"start is a solution with {number} cracks for a problem with {ours}; both need the same cracks")
    for crack in range(ours):
        there, here = np.flatnonzero(theirs.cracks == crack), nodes.cracks == crack
        _, nearest = scipy.spatial.cKDTree(theirs.positions[there]).query(nodes.positions[here])
        active[here] = solution.report.active[-1][there[nearest]]
    return active


def complementarity(system: ContactSystem, problem: "ContactProblem", U: np.ndarray, found: NodalSolution, free_jumps: np.ndarray) -> float:
    """The largest violation of the nodal conditions: pressures relative to the largest, gaps and slips to the largest displacement.

    Weighted jumps without multipliers, free_jumps, count as displacements, which may all be zero where contact carries the load.
    """
    T, p = found.T, found.p
    w = T.T @ (system.Moments(U, found.L) - found.G)
    lengths = np.maximum(abs(T.T) @ np.tile(system.nodes.weights, len(problem.law.components)), TINY)
    free_gap = np.abs(T.T @ free_jumps) / lengths
    history = found.faces.history
    before = 0.0 if history is None else np.abs(history.jump).max(initial=0)
    displacement = max(system.exchange.Max(np.abs(U[Unknowns(problem.V).regular]).max()), free_gap.max(initial=0), before)
    scale = max(np.abs(p).max(initial=0), TINY)
    return problem.law.Violation(p, w, found.faces, Scales(scale, np.maximum(lengths * displacement, TINY)))


def multipliers(problem: "ContactProblem", system: ContactSystem, L: np.ndarray) -> list[GridFunction]:
    """L as GridFunctions: λ, and λ_t with friction, in space along both tangents."""
    names = ("multiplier", "tangential_multiplier", "second_tangential_multiplier")[: len(problem.law.components)]
    return [system.Function(problem, values, name) for name, values in zip(names, np.split(L, len(names)))]
