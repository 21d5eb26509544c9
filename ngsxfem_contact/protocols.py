"""The roles: what each part asks of objects that others may write. docs/extending.md has a minimal object for each that is meant for users.

An object has a role if it has the members; it need not inherit from anything here. `check_role` names those that are missing.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction

    from ._ngsxfem_contact import CrackedMesh, CrackFESpace, Tip, TipSpec
    from .algebra.face_relations import Relation
    from .contact.contact_system import ContactSystem
    from .contact.faces import Faces, FaceWork, Scales
    from .contact.problem import ContactProblem
    from .contact.report import Report
    from .contact.solution import ContactSolution
    from .estimate.error_estimate import ErrorEstimate
    from .fracture.initiation import NewCrack
    from .fracture.stress_intensity import StressIntensityFactors
    from .material import Isotropic
    from .operators import Component


class Points(Protocol):
    """What coefficients of laws ask: of n points of the cracks."""

    @property
    def cracks(self) -> np.ndarray:
        """(n,) int: of each the number of its crack."""

    @property
    def positions(self) -> np.ndarray:
        """(n, dimension): the points."""

    @property
    def weights(self) -> np.ndarray:
        """(n,): ∫ψ_i, how much of the cracks belongs to each of them."""

    def __len__(self) -> int: ...

    def Values(self, function: "CoefficientFunction") -> np.ndarray:
        """(n,): a scalar function there."""

    def Means(self, function: "CoefficientFunction") -> np.ndarray:
        """(n,): its means with the functions ψ_i, where there are such."""

    def Place(self, i: int) -> str:
        """Where the i-th one is, in words."""


class Nodes(Points, Protocol):
    """What cones, laws of the faces and active sets ask: of n nodes, one for each multiplier of a component. No arc lengths."""

    @property
    def neighbours(self) -> np.ndarray:
        """(k, 2) int: the numbers of two nodes beside each other on a crack, each two once."""

    @property
    def functions(self) -> np.ndarray:
        """(n, n): the coefficients of the nodal functions ψ_i, 1 at one node and 0 at the others, as columns."""

    @property
    def mass(self) -> np.ndarray:
        """(n, n): ∫ψ_i ψ_j."""


class Cone(Protocol):
    """A cone of multipliers, {L = T p, p ≤ 0}; the part of the condition that it leaves is p ≤ 0, Tᵀr ≤ 0, p·Tᵀr = 0."""

    def Transformation(self, nodes: Nodes) -> np.ndarray:
        """T, dense."""

    def Values(self, nodes: Nodes, nodal: np.ndarray) -> np.ndarray:
        """The p of a function with the given nodal values."""


class Stabilisation(Protocol):
    """How the multiplier is stabilised: γ and R_h of (12)."""

    @property
    def sides(self) -> Mapping[str, float]:
        """Which one-sided stresses take part in R_h, "plus", "minus" or "larger" (of the larger part of each element), with their weights."""

    def Gamma(self, V: "CrackFESpace", material: "Isotropic", components: "Sequence[Component]") -> "CoefficientFunction | None":
        """γ on the elements that the cracks meet, length over stress; None for none.

        Parameters
        ----------
        components
            Those of the traction that take part.
        """

    def IsSafe(self, V: "CrackFESpace", material: "Isotropic", components: "Sequence[Component]") -> bool:
        """Whether K - K_γ is known to be positive; if not, and if the direct solver does not see it, its smallest eigenvalue is computed."""


class CompleteStabilisation(Stabilisation, Protocol):
    """What the solver asks of a stabilisation beside; one without has those of `contact.stabilisation.Defaults`."""

    @property
    def needs_eigenvalue(self) -> bool:
        """Whether the factorised matrix may be positive although γ is too large: False where it is K - K_γ."""

    @property
    def frees_pressure(self) -> bool:
        """Whether parts of nearly incompressible material beside a crack have pressures of their own, which γ then leaves out."""

    def Remedy(self, smallest: float) -> str:
        """What to do about the smallest eigenvalue of K - K_γ against K, which is not positive: the end of the message of NotCoercive."""

    @property
    def System(self) -> "Callable[[ContactProblem], ContactSystem] | None":
        """What makes the matrices of a method of its own; None: those of (38)."""


class FaceLaw(Protocol):
    """The law of the faces: which components of the traction there are, and how p is found from w = Q p + q.

    p are the nodal values whose signs are checked, of all components one after the other; w minus the weighted gaps and slips, counted from the body
    without slip. `contact.faces.Faces` turns both into tractions and jumps.
    """

    @property
    def components(self) -> "Sequence[Component]":
        """Of the traction and the jump: operators.NORMAL, and TANGENTIAL with friction."""

    @property
    def depends_on_path(self) -> bool:
        """Whether load steps hand on what the faces have gone through."""

    def Solve(self, Q: np.ndarray, q: np.ndarray, faces: "Faces", start: np.ndarray | None, report: "Report", max_iterations: int) -> np.ndarray:
        """p, and after it the α of rigid motions that only the faces hold, where there are such; see `contact.faces.Faces`.

        Parameters
        ----------
        faces
            The nodes, and what the faces have gone through.
        start
            Nodes in contact at first, boolean; None: as the law likes.

        Notes
        -----
        The iterations, and the active set of each, go into the report.
        """

    def Variables(self, p: np.ndarray, w: np.ndarray, faces: "Faces") -> dict[str, np.ndarray]:
        """What the law has to remember of its way to p and w beside tractions and jumps: values at the nodes, by name."""

    def Work(self, p: np.ndarray, w: np.ndarray, faces: "Faces") -> "FaceWork":
        """What the step dissipates, and what the faces store."""

    def Violation(self, p: np.ndarray, w: np.ndarray, faces: "Faces", scales: "Scales") -> float:
        """The largest violation of the law, relative to the scales."""


class LawAtNodes(FaceLaw, Protocol):
    """A FaceLaw that holds node by node, and may be one of several in a body."""

    def At(self, nodes: Points) -> "Relation":
        """The Relation between traction and jump at nodes, all or those of a crack. Raises ValueError for coefficients that make no sense at one of them."""


class TipFunctions(Protocol):
    """The enrichment of a tip."""

    @property
    def tolerance(self) -> float | None:
        """Of the integration rules around the tip, relative to the integral over an element; None for what suits the order of the space."""

    def Spec(self, body: "CrackedMesh", tip: "Tip") -> "TipSpec":
        """Which functions with which cut-off there are at one tip of `body.tips`; raises ValueError for a disk that does not fit."""


class StressIntensityMethod(Protocol):
    """How K_I and K_II are read from a solution."""

    def Evaluate(self, solution: "ContactSolution", tip: int) -> "StressIntensityFactors":
        """Those of one tip of `body.tips`."""


class Goal(Protocol):
    """A quantity J(u, λ) whose error is sought, linear in both, or near enough to it."""

    def Value(self, solution: "ContactSolution") -> float:
        """J(u_h, λ_h)."""

    def OfDisplacement(self, solution: "ContactSolution", space: "CrackFESpace") -> np.ndarray:
        """(space.ndof,): ∂J/∂u for the functions of a space, V of the problem or that of the next order."""

    def OfMultipliers(self, solution: "ContactSolution") -> list[np.ndarray]:
        """(W.ndof,) for each component of the multipliers: ∂J/∂λ, and with friction ∂J/∂λ_t, for the functions of W."""


class Norm(Protocol):
    """A norm of the error, in place of a quantity."""

    def Value(self, solution: "ContactSolution") -> float:
        """The norm of the solution, to which its error is relative."""

    def Squares(self, estimate: "ErrorEstimate") -> np.ndarray:
        """(number of triangles,): what each adds to the square of the norm of the error."""


class GrowthCriterion(Protocol):
    """Where to a tip grows, and what drives it."""

    @property
    def grows_closed(self) -> bool:
        """Whether tips grow whose faces touch."""

    def Angle(self, K_I: float, K_II: float) -> float:
        """The direction, in radians from straight ahead, positive to the left."""

    def Driving(self, K_I: float, K_II: float) -> float:
        """What is compared with the toughness, a stress intensity factor."""


class GrowthLaw(Protocol):
    """How far tips grow in a step."""

    @property
    def da(self) -> float:
        """The advance of the tip that grows fastest, a length."""

    def Advances(self, driving: np.ndarray) -> tuple[np.ndarray, float]:
        """(lengths, cycles): how far each of the tips that grow advances, and in how many cycles; driving: their driving factors, (n,)."""


class CrackInitiation(Protocol):
    """Where cracks start in the course of growth."""

    def Starts(self, solution: "ContactSolution") -> "Sequence[NewCrack]":
        """What starts in a state, none or more."""


class DirectSolver(Protocol):
    """A factorised symmetric matrix A, and K A⁻¹Kᵀ for some rows K: what `algebra.elimination.factorise` returns."""

    @property
    def name(self) -> str:
        """As in Solve(inverse=...)."""

    @property
    def schur(self) -> np.ndarray:
        """K A⁻¹Kᵀ, dense."""

    @property
    def positive(self) -> bool | None:
        """Whether A is positive definite; None: the solver does not tell."""

    def Solve(self, rhs: np.ndarray) -> np.ndarray:
        """A⁻¹ rhs; zero where an unknown is not in the factorisation."""

    def Couple(self, rhs: np.ndarray) -> np.ndarray:
        """K A⁻¹ rhs."""


def members(role: type) -> list[str]:
    """The names of the members of a role, those that it inherits among them."""
    classes = [each for each in role.__mro__ if getattr(each, "_is_protocol", False) and each is not Protocol]
    return list(dict.fromkeys(name for each in reversed(classes) for name in (*each.__annotations__, *vars(each)) if not name.startswith("_")))


def check_role(value: object, role: type, name: str, otherwise: str) -> None:
    """Raises TypeError that says what value lacks of a role; otherwise: what it should have been, for one that has none of its members."""
    missing = [member for member in members(role) if not hasattr(value, member)]
    if isinstance(value, type) or len(missing) == len(members(role)):
        raise TypeError(f"{name}={value!r} is neither {otherwise} nor None")
    if missing:
        raise TypeError(f"{name}={value!r} has no {' and no '.join(missing)}; docs/extending.md says what they are")
