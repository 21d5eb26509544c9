"""Laws of contact and friction on the crack: section 7 of docs/method.md.

The tangential multiplier λ_t approximates σ_t = t·σn. It has the sign of the slip g_t = jump(u)·t: the plus side is
pulled by -σn, against its motion relative to the minus side.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CoefficientFunction

from ..algebra import nodal_newton
from ..algebra.active_set import coarse_start, solve_active_set, solve_balanced
from ..algebra.face_relations import SlidingRelation, rigid
from ..algebra.nodal_methods import FullNewton, NodalMethod
from ..algebra.nodal_newton import Threshold, first_states, uniqueness_number, violation
from ..arguments import INFINITY, check_function, check_number
from ..operators import NORMAL, TANGENTIAL
from .faces import FaceWork

UNIQUENESS_PAYS = 1000  # nodes; beyond, the eigenvalue problems of the proof cost more than the solution

if TYPE_CHECKING:
    from ..algebra.matrices import Matrix
    from ..material import Coefficient
    from ..protocols import Cone, FaceLaw, Nodes, Points
    from .faces import Faces, Scales
    from .report import Report


@dataclass(frozen=True)
class Frictionless:
    """σ_t = 0: only the normal multiplier."""

    components = (NORMAL,)
    depends_on_path = False
    follows_pressure = True

    def Solve(self, Q: np.ndarray, q: np.ndarray, faces: Faces, start: np.ndarray | None, report: Report, max_iterations: int) -> np.ndarray:
        """p, and α; books its iterations in the report."""
        if len(faces.pull):
            result, alpha = solve_balanced(Q, q, faces.motions, faces.pull, np.ones(len(q), dtype=bool) if start is None else start, max_iterations)
        else:
            result, alpha = solve_active_set(Q, q, first_contact(Q, q, faces, start, report), max_iterations), faces.pull
        report.iterations, report.active, report.fallback = result.iterations, result.active, result.fallback
        return np.append(result.p, alpha)

    def Variables(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> dict[str, np.ndarray]:
        """None."""
        return {}

    def Work(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> FaceWork:
        """Nothing is dissipated or stored."""
        return FaceWork()

    def Violation(self, p: np.ndarray, w: np.ndarray, faces: Faces, scales: Scales) -> float:
        """The largest violation of p ≤ 0, w ≤ 0, p·w = 0, relative."""
        p, w = p / scales.traction, w / scales.moments
        return float(max(values.max(initial=0) for values in (p, w, np.minimum(-p, -w))))

    def At(self, nodes: Points) -> SlidingRelation:
        """Beside other laws: nothing resists slip."""
        return rigid(Threshold(np.zeros(len(nodes)), np.zeros(len(nodes))))


def first_contact(Q: np.ndarray, q: np.ndarray, faces: Faces, start: np.ndarray | None, report: Report) -> np.ndarray:
    """The nodes in contact at first, boolean: those that are given, else from coarser sets of nodes, whose iterations go into the report."""
    if start is not None:
        return start
    n = len(faces.nodes)
    contact, report.coarse_iterations = coarse_start(Q[:n, :n], q[:n], faces.nodes.neighbours)
    return contact


class Friction(ABC):
    """What Tresca and Coulomb share: a normal and a tangential multiplier, and nodal states."""

    method: NodalMethod

    components = (NORMAL, TANGENTIAL)
    depends_on_path = True

    def Solve(self, Q: np.ndarray, q: np.ndarray, faces: Faces, start: np.ndarray | None, report: Report, max_iterations: int) -> np.ndarray:
        """p = (p_n, p_t); books its iterations in the report."""
        threshold = self.Threshold(faces.nodes, faces.cone)
        contact = np.array(first_contact(Q, q, faces, start, report), dtype=bool)
        if contact.shape != (len(q) // 2,):
            raise ValueError(f"start has {contact.size} entries, there are {len(q) // 2} nodal signs; give one boolean for each, or a ContactSolution")
        q = slip_since(q, faces)
        compliance = faces.compliance
        result = self.method.Solve(compliance, q, threshold, 1 / compliance.diagonal, first_states(compliance, q, threshold, contact), max_iterations)
        report.iterations, report.fallback, report.method = result.iterations, result.fallback, result.method
        report.active = [states.contact for states in result.states]
        report.tangential = [states.tangential for states in result.states]
        report.threshold_changes = result.threshold_changes
        report.uniqueness = self.Uniqueness(Q, threshold) if len(contact) <= UNIQUENESS_PAYS else None
        return result.p

    def Variables(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> dict[str, np.ndarray]:
        """Where the next slip begins, for other laws that may follow."""
        return {"slip": faces.Jumps(w)[1]}

    def Work(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> FaceWork:
        """∫λ_t Δg_t of a step is dissipated.

        Notes
        -----
        What slips does so at |λ_t| = s. While s changes, the trapezoidal rule takes the mean of s before and after; without a step before
        the end-point rule takes s after. The error is the difference of the two, s = 0 before a first step where it depends on the pressure.
        """
        (p_n, p_t), w_t, threshold = np.split(p, 2), np.split(slip_since(w, faces), 2)[1], self.Threshold(faces.nodes, faces.cone)
        before = faces.history
        p_before = np.zeros_like(p_n) if before is None else before.traction[0] * faces.traction_weights
        s, s_before = threshold.At(p_n, p_n < 0), threshold.At(p_before, p_n < 0 if before is None else p_before < 0)
        end = -p_t * w_t
        change = 0.5 * end * (np.divide(s_before, s, out=np.ones_like(s), where=s > 0) - 1)
        return FaceWork(float(end.sum() + (0 if before is None else change.sum())), float(np.abs(change).sum()))

    @abstractmethod
    def Threshold(self, nodes: Nodes, cone: Cone) -> nodal_newton.Threshold:
        """The `nodal_newton.Threshold` of the tangential multiplier at the nodes."""

    @abstractmethod
    def Uniqueness(self, Q: np.ndarray, threshold: nodal_newton.Threshold) -> float | None:
        """A number below 1 proves that there is one solution; None: not known."""

    def Violation(self, p: np.ndarray, w: np.ndarray, faces: Faces, scales: Scales) -> float:
        """The largest violation of the nodal conditions, relative."""
        return violation(p / scales.traction, slip_since(w, faces) / scales.moments, self.Threshold(faces.nodes, faces.cone).Scaled(scales.traction))


def slip_since(w: np.ndarray, faces: Faces) -> np.ndarray:
    """w with the slip since the last load step in place of the whole slip; of q the same."""
    if faces.history is None:
        return w
    w = w.copy()
    w[len(faces.nodes) :] += faces.jump_weights * faces.history.jump[1]
    return w


@dataclass(frozen=True)
class Tresca(Friction):
    """|λ_t| ≤ s, the slip in the direction of λ_t where |λ_t| = s.

    Parameters
    ----------
    s
        Number or CoefficientFunction ≥ 0, a stress.
    in_contact_only
        False (default): on the whole crack, the classical functional ∫ s |g_t|; True: s = 0 where the crack is open.

    Raises
    ------
    ValueError
        For an s that is negative or not finite, at the latest when it is evaluated at the multiplier's nodes.
    """

    s: float | CoefficientFunction
    in_contact_only: bool = False

    method = FullNewton()

    def __post_init__(self) -> None:
        check_threshold(self.s, "Tresca: s")

    def Threshold(self, nodes: Nodes, cone: Cone) -> nodal_newton.Threshold:
        """s at the nodes, or ∫sψ_i for the weak cone."""
        return Threshold(cone.Values(nodes, checked_values(nodes, self.s, "Tresca: s")), np.zeros(len(nodes)), self.in_contact_only)

    def At(self, nodes: Points) -> SlidingRelation:
        """Beside other laws."""
        return rigid(Threshold(checked_values(nodes, self.s, "Tresca: s"), np.zeros(len(nodes)), self.in_contact_only))

    def Uniqueness(self, Q: np.ndarray, threshold: nodal_newton.Threshold) -> float | None:
        """0 for a threshold on the whole crack, whose problem is convex; None (unknown) otherwise."""
        return 0.0 if threshold.is_fixed else None


@dataclass(frozen=True)
class Coulomb(Friction):
    """|λ_t| ≤ μ_f |λ_n|, the slip in the direction of λ_t where they are equal.

    Parameters
    ----------
    mu_f
        Number or CoefficientFunction ≥ 0, evaluated at the multiplier's nodes.
    method
        FullNewton() (default; goes on with FixedPoint if it cycles) or FixedPoint(tolerance, max_iterations).

    Raises
    ------
    ValueError
        As Tresca.

    Notes
    -----
    The law may have several solutions for a large mu_f. `report.uniqueness` below 1 proves that there is one (None on more than 1,000 nodes, where the proof would cost more than the solution). NotConverged is raised where none is found.
    """

    mu_f: float | CoefficientFunction
    method: NodalMethod = FullNewton()

    follows_pressure = True

    def __post_init__(self) -> None:
        check_threshold(self.mu_f, "Coulomb: mu_f")
        if not hasattr(self.method, "Solve") or isinstance(self.method, type):
            raise TypeError(f"Coulomb: method={self.method!r} is neither FullNewton() nor FixedPoint()")

    def Threshold(self, nodes: Nodes, cone: Cone) -> nodal_newton.Threshold:
        """s = μ_f |p_n| at the nodes."""
        return Threshold(np.zeros(len(nodes)), checked_values(nodes, self.mu_f, "Coulomb: mu_f"))

    def At(self, nodes: Points) -> SlidingRelation:
        """Beside other laws."""
        return rigid(Threshold(np.zeros(len(nodes)), checked_values(nodes, self.mu_f, "Coulomb: mu_f")))

    def Uniqueness(self, Q: np.ndarray, threshold: nodal_newton.Threshold) -> float:
        """See nodal_newton.uniqueness_number."""
        return uniqueness_number(Q, threshold.slope)


def check_threshold(value: Coefficient, name: str) -> None:
    """Raises for a number that is negative or not finite, and for what is neither a number nor a scalar function."""
    check_function(value, name, 1)
    if not isinstance(value, CoefficientFunction):
        check_number(value, name, lambda number: 0 <= number < INFINITY, "be a finite number >= 0")


def checked_values(nodes: Points, function: Coefficient, name: str) -> np.ndarray:
    """Values at the multiplier's nodes, (len(nodes),); raises ValueError for values that are negative or not finite."""
    if not isinstance(function, CoefficientFunction):
        return np.full(len(nodes), float(function))
    values = nodes.Values(function)
    wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0)))
    if len(wrong):
        raise ValueError(f"{name} is {values[wrong[0]]} at {nodes.Place(int(wrong[0]))}: it must be finite and >= 0 on the whole crack")
    return values


def transformation(law: FaceLaw, cone: Cone, nodes: Nodes) -> Matrix:
    """L = T p for all components of the multiplier; sparse where most of it is zero."""
    T, number = cone.Transformation(nodes), len(law.components)
    if np.count_nonzero(T) < 0.1 * T.size:
        return scipy.sparse.block_diag([scipy.sparse.csr_matrix(T)] * number, format="csr")
    return scipy.linalg.block_diag(*[T] * number)
