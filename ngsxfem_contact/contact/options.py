"""The options of a solve on the crack's unknowns, each with its default."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ..arguments import check_type, check_whole
from ..protocols import Cone
from .cones import CONES
from .faces import FaceHistory
from .solution import ContactSolution

Start: TypeAlias = np.ndarray | ContactSolution | FaceHistory | None  # boolean, one for each nodal sign, a solution, or what its faces carry


@dataclass(frozen=True)
class StepOptions:
    """As ContactProblem.Solve documents them.

    Parameters
    ----------
    cone
        "nonpositive" or "weak", or one of CONES; default the problem's.
    start
        First active set: boolean, one for each nodal sign, or a ContactSolution on any mesh whose cracks have the same arc lengths; default: that of
        `previous`, or from coarser sets, see active_set.coarse_start.
    max_iterations
        Of the active set.
    previous
        The ContactSolution of the last load step, with the same cracks or shorter ones: what its faces have gone through counts; or a FaceHistory at the nodes of the problem.
    """

    cone: str | Cone | None = None
    start: Start = None
    max_iterations: int = 100
    previous: ContactSolution | FaceHistory | None = None

    def __post_init__(self) -> None:
        check_whole(self.max_iterations, "max_iterations", 1)
        check_type(self.previous, ContactSolution | FaceHistory | None, "previous", "the ContactSolution of the last load step, or its FaceHistory")

    def Cone(self, default: Cone) -> Cone:
        """The cone; raises ValueError for an unknown name."""
        if self.cone is None:
            return default
        if not isinstance(self.cone, str):
            return self.cone
        if self.cone not in CONES:
            raise ValueError(f"cone={self.cone!r} is not one of {sorted(CONES)}")
        return CONES[self.cone]
