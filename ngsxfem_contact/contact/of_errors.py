"""What a solution says of its own error."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ..estimate.error_estimate import ErrorEstimate

if TYPE_CHECKING:
    from .assembled import AssembledProblem
    from .solution import ContactSolution
    from .solver import ReducedProblem


class OfErrors:
    """The part of a ContactSolution that estimates its error, and the factors that this takes."""

    _reduced: AssembledProblem | None = None

    @property
    def reduced(self) -> ReducedProblem:
        """The ReducedProblem of the solve, with its factors; made again where they are gone."""
        if self._reduced is None:
            self._reduced = self._whole.problem.Reduced()
        return cast("ReducedProblem", self._reduced)

    @property
    def _whole(self) -> ContactSolution:
        return cast("ContactSolution", self)

    def ReleaseFactors(self) -> None:
        """Lets go of the factors of the solve, which are most of its memory; an ErrorEstimate makes them again."""
        self._reduced = None

    def ErrorEstimate(self) -> ErrorEstimate:
        """How far the solution is off in the energy norm, and where: an ErrorEstimate. It needs no factorisation, and takes about as long as the solve.

        Raises
        ------
        ValueError
            For a coefficient of the load that has changed since the solve.
        """
        return ErrorEstimate(self._whole)
