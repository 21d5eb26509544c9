"""From a ContactProblem to a ContactSolution: elimination of U, and the active set on what is left."""

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BitArray, GridFunction

from ..algebra.balance import Balance
from ..algebra.elimination import Elimination, ReducedVector, check_inverse
from ..algebra.matrices import added, congruent, product
from ..protocols import Cone
from ..spaces.unknowns import Unknowns
from .adjoint import adjoint, response
from .assembled import AssembledProblem, NodalSolution, multipliers
from .checks import check_coercive, check_multiplier
from .faces import FaceHistory, Faces
from .friction import transformation
from .load_case import ReducedCase
from .options import StepOptions
from .report import Report
from .solids import check_size
from .solution import ContactSolution
from .stabilisation import local_moduli

if TYPE_CHECKING:
    from ..algebra.matrices import Matrix
    from .problem import ContactProblem


class ReducedProblem(AssembledProblem):
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
        self.transformed: dict[Cone, tuple[Matrix, Balance]] = {}
        check_inverse(inverse)
        super().__init__(problem, inverse)

    def _admit(self, problem: "ContactProblem") -> None:
        check_size(problem.V, problem.W, problem.law)

    def _with_motions(self, problem: "ContactProblem") -> "ContactProblem":
        return problem.AtNodes()

    def _prepare(self, free: BitArray, inverse: str | None) -> None:
        system = self.system
        self.linear = self.elimination = Elimination(system.stiffness, free, Unknowns(self.problem.V).tips, system.C, inverse, self.exchange)
        if self.check:
            check_coercive(self.problem, self.elimination)
        m = system.E.shape[0]
        self.S = added(product(self.elimination.S[:m], system.distribution), system.D)

    def _reduced_load(self, forces: np.ndarray, given: np.ndarray) -> tuple[ReducedVector, np.ndarray]:
        reduced = self.elimination.Reduce(forces - self.system.Stiffness(given) if given.any() else forces)
        return reduced, reduced.crack[: self.system.E.shape[0]] + self.system.E @ given

    def _report(self) -> Report:
        problem = self.problem
        return Report(
            (self.number, int(problem.W.ndof)),
            self.elimination.name,
            dict(self.timings),
            notes=[*problem.body.notes, *self.motions.notes],
            projection=problem.projection,
        )

    def Adjoint(self, solution: ContactSolution, J_u: np.ndarray, J_L: list[np.ndarray]) -> tuple[np.ndarray, list[GridFunction]]:
        """z and ζ as functions of W, see `adjoint`, for the derivatives of a quantity by the functions of V and, for each component, of W."""
        z, zeta = adjoint(self, solution, J_u, np.concatenate([self.system.OfFunction(moments) for moments in J_L]))
        return z, multipliers(self.problem, self.system, zeta)

    def Response(self, solution: ContactSolution, gaps: list[np.ndarray]) -> list[GridFunction]:
        """What the multipliers change, as functions of W, where gaps and slips grow by others: `response`, gaps for each component ∫ψ_i times that."""
        return multipliers(self.problem, self.system, response(self, solution, np.concatenate([self.system.OfFunction(moments) for moments in gaps])))

    def Displacement(self, L: np.ndarray, case: ReducedCase | None = None, alpha: np.ndarray | None = None) -> np.ndarray:
        """U for a multiplier L and rigid motions: one back-substitution."""
        case = case or self.case
        U = self.elimination.Recover(case.reduced, self.system.distribution @ L) + case.given
        return U if alpha is None else U + self.motions.R @ alpha

    def _displacement(self, found: NodalSolution) -> np.ndarray:
        return self.Displacement(found.L, found.case, found.alpha)

    def _residual(self, found: NodalSolution) -> np.ndarray:
        return found.case.g + self.S @ found.L - found.G + self.system.E @ (self.motions.R @ found.alpha)

    def _free_jumps(self, found: NodalSolution, U: np.ndarray) -> np.ndarray:
        """Those without multipliers."""
        return found.case.g - found.G

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
