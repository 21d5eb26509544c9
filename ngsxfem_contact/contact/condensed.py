"""Contact problems of large bodies in space: multipliers are eliminated node by node, and displacements found by conjugate gradients (docs/method.md, section 19)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from ..algebra.condensed import CondensedMatrix
from ..algebra.condensed_newton import CondensedNewton, FaceTerms
from ..algebra.elimination import CG, ReducedVector
from ..algebra.matrices import csr_view
from ..algebra.multigrid import REMEDY, is_available, rigid_motions
from ..algebra.symmetric_system import SymmetricSystem
from ..spaces.unknowns import Unknowns
from .assembled import AssembledProblem, NodalSolution, is_on
from .cones import Nonpositive
from .disk_friction import DiskFriction, fractions, slip_since
from .faces import Faces
from .friction import Frictionless
from .report import Report
from .solution import ContactSolution

if TYPE_CHECKING:
    from ngsolve import BitArray
    from scipy.sparse import csr_matrix

    from ..algebra.nodal_newton import Threshold
    from ..protocols import Cone, FaceLaw, Nodes
    from .load_case import ReducedCase
    from .options import StepOptions
    from .problem import ContactProblem

NONE = np.zeros(0)


class NotCondensed(ValueError):
    """A problem that conjugate gradients are not there for; the message says what to do."""

    def __init__(self, what: str) -> None:
        super().__init__(f"inverse={CG!r}: {what}")


@dataclass
class CondensedSolution(NodalSolution):
    """A NodalSolution with its displacement U."""

    U: np.ndarray


class CondensedProblem(AssembledProblem):
    """A ContactProblem whose multipliers are eliminated: A U - Eᵀ P(D⁻¹(G - E U)) = F, P the law of the faces at each node.

    Parameters
    ----------
    choice
        Why, for the report.

    Raises
    ------
    NotCondensed
        For problems that have no such form: parts that only faces hold, no stabilisation, a gamma0 that may be too large, laws without a projection.
    ImportError
        Without pyamg.
    """

    preparing = "preparing conjugate gradients on"

    def __init__(self, problem: ContactProblem, choice: str = "") -> None:
        self.choice = choice
        super().__init__(problem)

    def _admit(self, problem: ContactProblem) -> None:
        if not is_available():
            raise ImportError(f"inverse={CG!r} needs pyamg: {REMEDY}")
        self.exchange.Refuse(f"inverse={CG!r}")
        if problem.W.order:
            raise NotCondensed(f"multipliers of order {problem.W.order} are not eliminated node by node; take TraceSpace(body, order=0), or leave inverse= out")
        if problem.body.cracks and not problem.stabilisation.IsSafe(problem.V, problem.material, problem.law.components):
            raise NotCondensed(
                f"{problem.stabilisation}: γ is not proved to be small enough, and conjugate gradients cannot tell; take BarbosaHughes(), which chooses γ itself"
            )

    def _with_motions(self, problem: ContactProblem) -> ContactProblem:
        raise NotCondensed(
            f"{self.motions.notes[0]}, and conjugate gradients need a body that is held: hold it by dirichlet=, Pin or springs in problem.a, or leave inverse= out"
        )

    def _prepare(self, free: BitArray, inverse: str | None) -> None:
        system, V = self.system, self.problem.V
        self.linear = SymmetricSystem(system.stiffness, free, self.exchange)
        self.D = diagonal_of(system.D)
        threshold_of(self.problem.law, system.nodes, self.problem.cone)
        unknowns = Unknowns(V)
        nodes = np.arange(unknowns.polynomial.stop).reshape(unknowns.components, -1).T
        motions = rigid_motions(V.mesh.ngmesh.Coordinates()).reshape(-1, 3, 6)
        self.matrix = CondensedMatrix(csr_view(system.stiffness), ~self.linear.fixed, system.E, nodes, motions)

    def _report(self) -> Report:
        return Report((self.number, int(self.problem.W.ndof)), CG, dict(self.timings), notes=list(self.problem.body.notes), choice=self.choice)

    def _reduced_load(self, forces: np.ndarray, given: np.ndarray) -> tuple[ReducedVector, np.ndarray]:
        """Nothing is eliminated: g is that of the given displacements alone."""
        return ReducedVector(forces, NONE, NONE), self.system.E @ given

    def _nodal_solution(self, options: StepOptions, case: ReducedCase, cone: Cone, report: Report) -> NodalSolution:
        problem, nodes = self.problem, self.system.nodes
        if not isinstance(cone, Nonpositive):
            raise NotCondensed('the cone must be "nonpositive"; of constants "weak" is the same')
        faces = Faces(nodes, cone, history=self._history(options.previous, cone))
        G, threshold = self._gaps(case), threshold_of(problem.law, nodes, cone)
        terms = FaceTerms(self.system.E, self.D, -slip_since(-G, faces) if threshold is not None else G, threshold)
        known = next((each for each in (options.start, options.previous) if isinstance(each, ContactSolution) and is_on(problem, each)), None)
        newton = CondensedNewton(self.matrix, terms, case.forces, *self._begin(options, case, terms, known))
        result = newton.Solve(options.max_iterations)
        report.iterations, report.active, report.linear_iterations = len(result.contact), result.contact, result.linear_iterations
        report.method = "Newton on displacements"
        if threshold is not None:
            report.method += ", thresholds follow the pressure from step to step" if terms.follows_pressure else " with projections onto disks"
            report.slipping = result.contact[-1] & result.slip
            report.states = fractions(result.contact[-1], result.slip)
        identity = scipy.sparse.identity(len(G), format="csr")
        return CondensedSolution(case, faces, identity, result.p.ravel(), G, NONE, result.U)

    def _begin(self, options: StepOptions, case: ReducedCase, terms: FaceTerms, known: ContactSolution | None) -> tuple[np.ndarray, np.ndarray | None]:
        """Displacements, and nodes in contact, to begin with: of a solution that is known the multiple with the least energy; None: what the displacements say."""
        start = self._first_set(options)
        contact = np.ones(len(self.system.nodes), dtype=bool) if start is None else np.array(start, dtype=bool)
        if contact.shape != (len(self.system.nodes),):
            raise ValueError(
                f"start has {contact.size} entries, there are {len(self.system.nodes)} nodal signs; give one boolean for each, or a ContactSolution"
            )
        if known is None:
            return case.given.copy(), contact
        free = np.where(self.linear.fixed, 0, known.u.vec.FV().NumPy())
        return case.given + self._multiple(free, case, terms, contact) * free, contact if isinstance(options.start, np.ndarray) else None

    def _multiple(self, free: np.ndarray, case: ReducedCase, terms: FaceTerms, contact: np.ndarray) -> float:
        """That of displacements which are zero where they are given, with the least energy where nodes in contact are tied."""
        n = len(contact)
        stiffness = np.where(contact, 1 / terms.D[:n], 0)
        jump, rest = (terms.E @ free)[:n], (terms.G - case.g)[:n]
        pull = free @ (case.forces - self.system.Stiffness(case.given)) + jump @ (stiffness * rest)
        energy = free @ self.system.Stiffness(free) + jump @ (stiffness * jump)
        return float(pull / energy) if energy > 0 else 0.0

    def _displacement(self, found: NodalSolution) -> np.ndarray:
        assert isinstance(found, CondensedSolution)
        return found.U

    def _residual(self, found: NodalSolution) -> np.ndarray:
        return self.system.Moments(self._displacement(found), found.L) - found.G

    def _free_jumps(self, found: NodalSolution, U: np.ndarray) -> np.ndarray:
        """Those with multipliers: others are not known."""
        return self.system.E @ U - found.G


@singledispatch
def threshold_of(law: FaceLaw, nodes: Nodes, cone: Cone) -> Threshold | None:
    """That of friction, None without. Raises NotCondensed for laws without a projection at each node."""
    raise NotCondensed(f"conjugate gradients are there for contact without friction, Tresca and Coulomb, not for {law}; leave inverse= out")


@threshold_of.register(Frictionless)
def no_threshold(law: Frictionless, nodes: Any, cone: Any) -> None:
    """Nothing resists slip."""


@threshold_of.register(DiskFriction)
def threshold_of_disks(law: DiskFriction, nodes: Any, cone: Any) -> Any:
    """That of Tresca or Coulomb."""
    return law.law.Threshold(nodes, cone)


def diagonal_of(D: csr_matrix) -> np.ndarray:
    """Of D_γ. Raises NotCondensed unless it is a positive diagonal matrix."""
    diagonal = D.diagonal()
    if D.shape[0] and (D.count_nonzero() > len(diagonal) or not (diagonal > 0).all()):
        raise NotCondensed("conjugate gradients need one multiplier for each element and γ > 0: take stabilisation=BarbosaHughes(), or leave inverse= out")
    return diagonal
