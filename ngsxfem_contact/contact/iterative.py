"""Contact problems in the plane without factors of the whole body, for one process or many: displacements by conjugate gradients (docs/method.md, section 20).

The law of the faces is solved with an approximation of S, as `ReducedProblem` does with S, and a right-hand side that makes it exact for the last pressures. Each round costs one
displacement, which the approximation learns from.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..algebra.aggregates import Vertices
from ..algebra.approximate_elimination import ApproximateElimination
from ..algebra.conjugate_gradients import ACCURACY, NOT_POSITIVE
from ..algebra.elimination import CG
from ..algebra.matrices import added, product
from ..algebra.multigrid import REMEDY, is_available
from ..errors import NotCoercive, NotConverged
from ..spaces.unknowns import Unknowns
from .assembled import NodalSolution
from .checks import check_coercive
from .condensed import NotCondensed
from .report import Report
from .solver import ReducedProblem

if TYPE_CHECKING:
    from ngsolve import BitArray, GridFunction

    from ..protocols import Cone
    from .load_case import ReducedCase
    from .options import StepOptions
    from .problem import ContactProblem
    from .solution import ContactSolution

ROUND = 1e-4  # accuracy of a round's displacement, relative to what it changes
SETTLED = 1e-8  # relative change of the pressures with which the rounds end; so they do where the displacement is as accurate as it can be
LEARNT = 1e-5  # with a smaller relative change a round tells more of what the last one left than of S
MOST_ROUNDS = 60


@dataclass
class IterativeSolution(NodalSolution):
    """A NodalSolution with its displacement U, but for rigid motions."""

    U: np.ndarray


class IterativeProblem(ReducedProblem):
    """A ReducedProblem whose displacements are found by conjugate gradients; S is approximate, and becomes better with each round.

    Parameters
    ----------
    choice
        Why, for the report.

    Attributes
    ----------
    L, U
        The last pressures, and what they do to the displacement: the next solve begins there.

    Raises
    ------
    NotCondensed
        For nearly incompressible materials.
    ImportError
        Without pyamg.
    """

    preparing = "preparing conjugate gradients on"
    elimination: Any

    def __init__(self, problem: ContactProblem, choice: str = "") -> None:
        self.choice = choice
        super().__init__(problem)

    def _admit(self, problem: ContactProblem) -> None:
        if problem.projection is not None:
            raise NotCondensed(f"{problem.material} is nearly incompressible, which takes too many iterations; leave inverse= out")
        if not is_available():
            raise ImportError(f"inverse={CG!r} needs pyamg: {REMEDY}")

    def _prepare(self, free: BitArray, inverse: str | None) -> None:
        system, unknowns, mesh = self.system, Unknowns(self.problem.V), self.problem.V.mesh
        dofs = np.arange(mesh.nv)[:, None] + [unknowns.Polynomial(component).start for component in range(unknowns.components)]
        vertices = Vertices(dofs, mesh.ngmesh.Coordinates()[: mesh.nv, :2])
        self.linear = self.elimination = ApproximateElimination(system.stiffness, free, unknowns.tips, system.C, vertices, self.exchange)
        check_coercive(self.problem, self.elimination)
        if self.elimination.positive is False:
            raise NotCoercive(f"{NOT_POSITIVE} (a pivot around the cracks or of the aggregates is negative)")
        self._set_compliance()
        self.L, self.U = np.zeros(len(self.S)), np.zeros(self.problem.V.ndof)

    def _set_compliance(self) -> None:
        """S of what is known of C A⁻¹Cᵀ."""
        self.S = added(product(self.elimination.S[: self.system.E.shape[0]], self.system.distribution), self.system.D)
        self.transformed.clear()

    def _report(self) -> Report:
        return replace(super()._report(), choice=self.choice)

    def Adjoint(self, solution: ContactSolution, J_u: np.ndarray, J_L: list[np.ndarray]) -> tuple[np.ndarray, list[GridFunction]]:
        """Raises NotCondensed."""
        raise NotCondensed("the error of a quantity needs a direct solver; leave inverse= out")

    def _nodal_solution(self, options: StepOptions, case: ReducedCase, cone: Cone, report: Report) -> NodalSolution:
        G, L, unloaded, rounds = self._gaps(case), self.L, case.given + case.reduced.partial, Rounds()
        U, size = unloaded + self.U, self.elimination.Size(case.reduced.partial)
        w = self.system.Moments(U, L) - G
        while True:
            found = super()._nodal_solution(options, replace(case, g=w + G - self.S @ L), cone, report)
            rounds.Add(report)
            change, largest = np.abs(found.L - L).max(initial=0), np.abs(found.L).max(initial=0)
            more = self.elimination.Solve(case.forces + self.system.Forces(found.L) - self.system.Stiffness(U), ROUND, ACCURACY * size)
            U += more
            if change <= SETTLED * largest or not self.elimination.iterations[-1]:
                break
            if len(rounds.of_each) == MOST_ROUNDS:
                raise NotConverged(
                    f"pressures still changed by {change / largest:.1e} of the largest after {MOST_ROUNDS} rounds of conjugate gradients; "
                    "a direct solver, without inverse=, does not mind"
                )
            if change > LEARNT * largest:
                self._learn(found.L - L, more)
            L, size = found.L, max(size, self.elimination.Size(U))
            w = self.system.Moments(U, L) - G
            options = replace(options, start=report.active[-1])
        rounds.Put(report)
        if report.uniqueness:  # an approximate S proves nothing; 0 is that of convex problems
            report.uniqueness = None
        self.L, self.U = found.L, U - unloaded
        report.linear_iterations, self.elimination.iterations = self.elimination.iterations, []
        return IterativeSolution(case, found.faces, found.T, found.p, G, found.alpha, U)

    def _learn(self, change: np.ndarray, displacement: np.ndarray) -> None:
        """What a change of the pressures does to the displacement, for S."""
        self.elimination.Learn(self.system.distribution @ change, self.elimination.Felt(displacement))
        self._set_compliance()

    def _displacement(self, found: NodalSolution) -> np.ndarray:
        assert isinstance(found, IterativeSolution)
        return found.U + self.motions.R @ found.alpha

    def _residual(self, found: NodalSolution) -> np.ndarray:
        assert isinstance(found, IterativeSolution)
        return self.system.Moments(found.U, found.L) - found.G + self.system.E @ (self.motions.R @ found.alpha)


class Rounds:
    """What the solves of a law did, one after the other."""

    def __init__(self) -> None:
        self.of_each: list[dict[str, Any]] = []

    def Add(self, report: Report) -> None:
        """A solve, from its report."""
        self.of_each.append({name: getattr(report, name) for name in ("active", "tangential", "iterations", "coarse_iterations", "fallback")})
        report.coarse_iterations = 0

    def Put(self, report: Report) -> None:
        """All of them into a report."""
        for name, value in self.of_each[0].items():
            setattr(report, name, sum((each[name] for each in self.of_each), type(value)()))
