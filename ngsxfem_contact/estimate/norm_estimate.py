"""Norms of the error: what is asked of the whole of the pressure, not of one number."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..description import Described
from ..protocols import Goal, Norm, check_role

if TYPE_CHECKING:
    from typing_extensions import TypeIs

    from ..description import Lines
    from .error_estimate import ErrorEstimate


class NormEstimate(Described):
    """How large a norm of the error is, as `ErrorEstimate.Goal` finds it.

    Parameters
    ----------
    estimate : ErrorEstimate
        Of the solution.
    goal
        The norm, an object with the role Norm.

    Attributes
    ----------
    value
        The norm of the solution.
    """

    def __init__(self, estimate: ErrorEstimate, goal: Norm) -> None:
        self.estimate, self.goal = estimate, goal
        self.value = goal.Value(estimate.solution)

    @cached_property
    def elements(self) -> np.ndarray:
        """(number of triangles,): what each adds to the square of `bar`."""
        return self.goal.Squares(self.estimate)

    @property
    def bar(self) -> float:
        """The norm of the error."""
        return float(np.sqrt(self.elements.sum()))

    def Description(self) -> Lines:
        """The norm, of the solution and of its error."""
        relative = f", {100 * self.bar / self.value:.2g} %" if self.value else ""
        return [("goal", str(self.goal)), ("value", f"{self.value:.6g}"), ("error", f"{self.bar:.2g}{relative}")]


def is_norm(goal: Goal | Norm, name: str) -> TypeIs[Norm]:
    """Whether an argument has the role Norm, not Goal. Raises TypeError for one that has neither."""
    norm = hasattr(goal, "Squares")
    check_role(goal, Norm if norm else Goal, name, "an object such as StressIntensityFactor('K_I')")
    return norm
