"""Friction on sheets in space: Tresca's and Coulomb's laws, by sheet, with the tangential multiplier in a disk (docs/method.md, section 15)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..algebra.active_set import solve_equalities
from ..algebra.disk_newton import DiskProblem, DiskResult, fixed_point, solve_disks
from ..algebra.nodal_methods import FixedPoint, FullNewton, NodalMethod
from ..algebra.nodal_newton import Threshold
from ..operators import FIRST_TANGENTIAL, NORMAL, SECOND_TANGENTIAL
from .faces import FaceWork
from .friction import Frictionless, first_contact

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..protocols import Cone, Nodes
    from .faces import Faces, Scales
    from .friction import Friction
    from .report import Report


@dataclass(frozen=True)
class DiskFriction:
    """|λ_t| ≤ s, λ_t ∈ R², the slip in the direction of λ_t where they are equal; s is that of a law of the plane.

    Parameters
    ----------
    law
        Tresca or Coulomb, or a FrictionByCrack.
    """

    law: Friction | FrictionByCrack

    components = (NORMAL, FIRST_TANGENTIAL, SECOND_TANGENTIAL)
    depends_on_path = True

    def __repr__(self) -> str:
        return repr(self.law)

    @property
    def follows_pressure(self) -> bool:
        """Whether the threshold does."""
        return getattr(self.law, "follows_pressure", False)

    def Solve(self, Q: np.ndarray, q: np.ndarray, faces: Faces, start: np.ndarray | None, report: Report, max_iterations: int) -> np.ndarray:
        """p = (p_n, p_1, p_2); books its iterations in the report."""
        n, threshold = len(faces.nodes), self.law.Threshold(faces.nodes, faces.cone)
        contact = np.array(first_contact(Q, q, faces, start, report), dtype=bool)
        if contact.shape != (n,):
            raise ValueError(f"start has {contact.size} entries, there are {n} nodal signs; give one boolean for each, or a ContactSolution")
        q = slip_since(q, faces)
        p = np.zeros((3, n))
        p[0] = np.minimum(solve_equalities(Q[:n, :n], q[:n], contact)[0], 0)
        result = self._solve(DiskProblem(Q, q, threshold), p, max_iterations)
        report.iterations, report.active, report.method = len(result.contact), result.contact, result.method
        report.threshold_changes = result.threshold_changes
        report.slipping = result.contact[-1] & result.slip
        report.states = fractions(result.contact[-1], result.slip)
        return result.p.ravel()

    def _solve(self, problem: DiskProblem, p: np.ndarray, max_iterations: int) -> DiskResult:
        """By the method of the law."""
        method = self.law.method
        if isinstance(method, FixedPoint):
            return fixed_point(problem, p, max_iterations, max(method.tolerance, 1e-10), method.max_iterations)
        return solve_disks(problem, p, max_iterations)

    def Variables(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> dict[str, np.ndarray]:
        """None."""
        return {}

    def Work(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> FaceWork:
        """∫λ_t·Δg_t of a step is dissipated, see Friction.Work."""
        traction, moved = p.reshape(3, -1), slip_since(w, faces).reshape(3, -1)
        threshold, before = self.law.Threshold(faces.nodes, faces.cone), faces.history
        p_before = np.zeros_like(traction[0]) if before is None else before.traction[0] * faces.traction_weights
        s = threshold.At(traction[0], traction[0] < 0)
        s_before = threshold.At(p_before, traction[0] < 0 if before is None else p_before < 0)
        end = -(traction[1:] * moved[1:]).sum(axis=0)
        change = 0.5 * end * (np.divide(s_before, s, out=np.ones_like(s), where=s > 0) - 1)
        return FaceWork(float(end.sum() + (0 if before is None else change.sum())), float(np.abs(change).sum()))

    def Violation(self, p: np.ndarray, w: np.ndarray, faces: Faces, scales: Scales) -> float:
        """The largest residual of the projections, for p and w in units of their scales."""
        traction, moved = (p / scales.traction).reshape(3, -1), (slip_since(w, faces) / scales.moments).reshape(3, -1)
        s = self.law.Threshold(faces.nodes, faces.cone).Scaled(scales.traction).At(traction[0], traction[0] < 0)
        y = traction - moved
        projected = s / np.maximum(np.maximum(s, np.linalg.norm(y[1:], axis=0)), np.finfo(float).tiny) * y[1:]
        return float(max(np.abs(traction[0] - np.minimum(0, y[0])).max(initial=0), np.abs(traction[1:] - projected).max(initial=0)))


class FrictionByCrack:
    """Each sheet its threshold.

    Parameters
    ----------
    laws
        Tresca, Coulomb or Frictionless by the number of the sheet; on all others there is no friction.

    Raises
    ------
    ValueError
        For laws that are solved by different methods.
    """

    def __init__(self, laws: Mapping[int, Friction | Frictionless]) -> None:
        self.laws = {crack: law for crack, law in laws.items() if not isinstance(law, Frictionless)}
        methods = {repr(law.method): law.method for law in self.laws.values()}
        if len(methods) > 1:
            raise ValueError(f"ContactProblem: the laws {laws} are solved by different methods, {' and '.join(methods)}; give all the same method=")
        self.method: NodalMethod = next(iter(methods.values()), FullNewton())

    def __repr__(self) -> str:
        return f"{self.laws}, on others Frictionless()"

    @property
    def follows_pressure(self) -> bool:
        """Whether all thresholds do."""
        return all(getattr(law, "follows_pressure", False) for law in self.laws.values())

    def Threshold(self, nodes: Nodes, cone: Cone) -> Threshold:
        """At each node that of its sheet."""
        base, slope, in_contact_only = np.zeros(len(nodes)), np.zeros(len(nodes)), np.zeros(len(nodes), dtype=bool)
        for crack, law in self.laws.items():
            here, own = nodes.cracks == crack, law.Threshold(nodes, cone)
            base[here], slope[here], in_contact_only[here] = own.base[here], own.slope[here], own.in_contact_only
        return Threshold(base, slope, in_contact_only)


def fractions(contact: np.ndarray, slip: np.ndarray) -> dict[str, float]:
    """How much of the nodes is open, sticks and slips; contact, slip: (n,) bool."""
    nodes = {"open": ~contact, "stick": contact & ~slip, "slip": contact & slip}
    return {name: float(those.mean()) if len(those) else 0.0 for name, those in nodes.items()}


def slip_since(w: np.ndarray, faces: Faces) -> np.ndarray:
    """w with the slip since the last load step in place of the whole slip; of q the same."""
    if faces.history is None:
        return w
    w = w.copy()
    w[len(faces.nodes) :] += (faces.jump_weights * faces.history.jump[1:]).ravel()
    return w
