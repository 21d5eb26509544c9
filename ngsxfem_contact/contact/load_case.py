"""What acts on a body and is given at its supports, at one moment; and the same with the displacements eliminated."""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ..algebra.elimination import ReducedVector
from ..loads.load import LoadTerms
from ..pickling import packed, unpacked
from .checks import check_load
from .contact_system import GivenTraction

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackFESpace
    from .problem import ContactProblem


class LoadCase:
    """The load F and the given displacements U_D that a problem holds now, copied: what is added to it later is another case.

    Parameters
    ----------
    problem : ContactProblem

    Raises
    ------
    ValueError
        For a load or a given displacement that is not finite, and for given displacements that contradict each other.
    """

    def __init__(self, problem: "ContactProblem") -> None:
        problem.supports.Update()
        problem.supports.Check()
        self.jumps, self.held = problem.supports.NormalJumps(), frozenset(problem.supports.sides)
        self.F, self.load = problem.f.Vector(), LoadTerms.Of(problem.f)
        self.given = problem.given.vec.FV().NumPy().copy()
        problem.V.share.Together(lambda: check_load(self.F, self.given))


@dataclass(frozen=True)
class SolvedCase:
    """What a solution on V keeps of its load: F of (38), and the terms that it came from."""

    V: "CrackFESpace"
    F: np.ndarray
    load: LoadTerms

    def __reduce__(self) -> Any:
        return solved_case, (self.V, packed(self.V, self.F), self.load)


def solved_case(V: "CrackFESpace", F: np.ndarray, load: LoadTerms) -> SolvedCase:
    """The SolvedCase that was saved."""
    return SolvedCase(V, unpacked(V, F), load)


@dataclass
class ReducedCase:
    """A load case eliminated: `reduced` is F + F_γ - A U_D as the crack feels it, g = E A⁻¹(F + F_γ - A U_D) + E U_D.

    Parameters
    ----------
    F, given, load, jumps
        As in LoadCase; `given` is U_D.
    given_traction
        F_γ and G_γ, see `ContactSystem.Given`.

    Notes
    -----
    The reduced cases of a problem can be added and multiplied by numbers.
    """

    F: np.ndarray
    given: np.ndarray
    given_traction: GivenTraction
    reduced: ReducedVector
    g: np.ndarray
    load: LoadTerms
    jumps: np.ndarray

    def __add__(self, other: "ReducedCase") -> "ReducedCase":
        return ReducedCase(*(getattr(self, part.name) + getattr(other, part.name) for part in fields(self)))

    def __rmul__(self, factor: float) -> "ReducedCase":
        return ReducedCase(*(factor * getattr(self, part.name) for part in fields(self)))

    @property
    def forces(self) -> np.ndarray:
        """F + F_γ, the right-hand side of the first row of (38)."""
        return self.F + self.given_traction.F
