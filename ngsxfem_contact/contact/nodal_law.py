"""Laws of the faces that hold node by node, whatever they say there: a Relation of `algebra.face_relations`, and Newton's method for all of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CoefficientFunction

from ..algebra.face_newton import FaceProblem, solve_faces
from ..algebra.face_relations import DividedRelation, Memory, Relation
from ..operators import NORMAL, TANGENTIAL
from ..protocols import LawAtNodes, check_role
from .faces import FaceHistory, FaceWork

if TYPE_CHECKING:
    from ..material import Coefficient
    from ..protocols import FaceLaw, Nodes, Points
    from .faces import Faces, Scales
    from .report import Report


class NodalLaw(ABC):
    """A FaceLaw that has At(nodes), the Relation between traction and jump there, and inherits all else."""

    components = (NORMAL, TANGENTIAL)
    depends_on_path = True

    @property
    def softening(self) -> Coefficient | None:
        """A bound of the slope by which the tractions fall with the jump, stress / length; None: they do not."""
        return None

    @abstractmethod
    def At(self, nodes: Points) -> Relation:
        """The Relation, its coefficients evaluated. Raises ValueError for coefficients that make no sense somewhere."""

    def Problem(self, q: np.ndarray, faces: Faces) -> FaceProblem:
        """The FaceProblem of w = Q p + q."""
        a = np.tile(faces.traction_weights, 2)
        relation = self.At(faces.nodes)
        c, B = relation.Stiffness(faces.stiffness), a[:, None] * faces.motions.reshape(len(q), -1)
        return FaceProblem(faces.compliance.Scaled(a), a * q, faces.nodes.weights, relation, c, before(faces), B, faces.pull)

    def Start(self, problem: FaceProblem, known: FaceHistory | None) -> np.ndarray:
        """The z of the problem to begin with: that of tractions and jumps that are known; else that of faces that do not move, whatever touched in another solution.

        Faces that soften may have several solutions; from there Newton's method finds the one in which they still hold.
        """
        return problem.Tied() if known is None else problem.With(known.traction, known.jump)

    def Solve(self, Q: np.ndarray, q: np.ndarray, faces: Faces, start: np.ndarray | FaceHistory | None, report: Report, max_iterations: int) -> np.ndarray:
        """p = (p_n, p_t), and α; raises NotConverged."""
        problem = self.Problem(q, faces)
        known = start if isinstance(start, FaceHistory) else faces.history
        result = solve_faces(problem, self.Start(problem, known), max_iterations)
        report.iterations, report.method = result.iterations, result.method
        self._book(problem, problem.Trial(result.z), report)
        return np.append(np.tile(faces.traction_weights, 2) * problem.Traction(result.z).ravel(), result.z[len(q) :])

    def _book(self, problem: FaceProblem, y: np.ndarray, report: Report) -> None:
        """The states of the nodes."""
        relation = problem.relation
        report.active = [y[0] < 0]
        counts = np.bincount(relation.States(y, problem.c, problem.before), minlength=len(relation.states))
        report.states = dict(zip(relation.states, (counts / max(counts.sum(), 1)).tolist()))

    def Variables(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> dict[str, np.ndarray]:
        """Those of the Relation."""
        relation, y, c = self._trial(p, w, faces)
        return relation.Variables(y, c, before(faces))

    def Work(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> FaceWork:
        """That of the Relation, summed over the nodes."""
        relation, y, c = self._trial(p, w, faces)
        return FaceWork(*(float(faces.nodes.weights @ values) for values in relation.Work(y, c, before(faces))))

    def Violation(self, p: np.ndarray, w: np.ndarray, faces: Faces, scales: Scales) -> float:
        """The largest difference of the jump from that of the law."""
        relation, y, c = self._trial(p, w, faces)
        difference = relation.Jump(y, c, before(faces))[0] - faces.Jumps(w)
        return float(np.abs((difference * faces.jump_weights).ravel() / scales.moments).max(initial=0))

    def _trial(self, p: np.ndarray, w: np.ndarray, faces: Faces) -> tuple[Relation, np.ndarray, np.ndarray]:
        relation = self.At(faces.nodes)
        c = relation.Stiffness(faces.stiffness)
        return relation, faces.Tractions(p) + c * faces.Jumps(w), c


def gives_way(law: FaceLaw, nodes: Nodes) -> bool:
    """Whether faces that touch may come nearer under pressure."""
    return isinstance(law, NodalLaw) and law.At(nodes).gives_way


def before(faces: Faces) -> Memory:
    """What a Relation remembers."""
    return {} if faces.history is None else faces.history.variables


@dataclass(frozen=True)
class PartOfPoints:
    """Some Points, by their numbers."""

    nodes: Points
    here: np.ndarray

    def __len__(self) -> int:
        return len(self.here)

    @property
    def cracks(self) -> np.ndarray:
        """(n,): the numbers of their cracks."""
        return self.nodes.cracks[self.here]

    @property
    def positions(self) -> np.ndarray:
        """(n, dimension): the points."""
        return self.nodes.positions[self.here]

    @property
    def weights(self) -> np.ndarray:
        """(n,): ∫ψ_i."""
        return self.nodes.weights[self.here]

    def Values(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): a scalar function there."""
        return self.nodes.Values(function)[self.here]

    def Means(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): its means with the functions ψ_i."""
        return self.nodes.Means(function)[self.here]

    def Place(self, i: int) -> str:
        """Where the i-th of them is, in words."""
        return self.nodes.Place(int(self.here[i]))


class LawByCrack(NodalLaw):
    """Each crack its law.

    Parameters
    ----------
    laws
        By the number of the crack.
    otherwise
        On all other cracks.

    Raises
    ------
    TypeError
        For what is no law, and for one that has no At(nodes).
    """

    def __init__(self, laws: Mapping[int, LawAtNodes], otherwise: LawAtNodes) -> None:
        self.laws, self.otherwise = dict(laws), otherwise
        for crack, law in self.laws.items():
            check_role(law, LawAtNodes, f"the law of crack {crack}: law", "a law that holds node by node, such as Joint(k_n, k_t)")
        self.depends_on_path = any(law.depends_on_path for law in (*self.laws.values(), otherwise))

    def __repr__(self) -> str:
        return f"{self.laws}, on others {self.otherwise}"

    @property
    def follows_pressure(self) -> bool:
        """Whether all tangential tractions are at most a multiple of the pressure."""
        return all(getattr(law, "follows_pressure", False) for law in (*self.laws.values(), self.otherwise))

    @property
    def softening(self) -> Coefficient | None:
        """The sum of all."""
        slopes = [slope for law in (*self.laws.values(), self.otherwise) if (slope := getattr(law, "softening", None)) is not None]
        return sum(slopes[1:], slopes[0]) if slopes else None

    def At(self, nodes: Points) -> DividedRelation:
        """That of its crack at each node."""
        cracks = np.unique(nodes.cracks)
        parts = [np.flatnonzero(nodes.cracks == crack) for crack in cracks]
        return DividedRelation([(here, self.laws.get(int(crack), self.otherwise).At(PartOfPoints(nodes, here))) for crack, here in zip(cracks, parts)])
