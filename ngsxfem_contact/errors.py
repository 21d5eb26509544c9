"""What a solve can refuse, and what it warns of."""

from __future__ import annotations

import sys
import warnings

__all__ = ["AccuracyWarning", "NotCoercive", "NotConverged", "NotHeld", "NotSaved", "SingularSystem", "SolveError", "TooCoarse"]


class SolveError(RuntimeError):
    """There is no answer that can be trusted: what all exceptions of a solve have in common."""


class NotConverged(SolveError):
    """An iteration stopped before its goal, or its result does not satisfy the equations; the message says which and what may help.

    With Coulomb friction there may be no solution at all, see `Coulomb`.
    """


class NotHeld(NotConverged):
    """Parts of the body that only the faces hold are not held by them: the load pulls them off, or pushes them along."""


class SingularSystem(SolveError):
    """The system has no unique solution.

    Either rigid motions of the body, or of a part that cracks cut off, are free (hold it by dirichlet=... or Pin), or there are
    multipliers that no displacement feels (stabilise, or take another pair of orders).
    """


class NotCoercive(SolveError):
    """K - K_γ, (13) of [AHLMR12], is not positive: gamma0 is too large. The message names a bound; BarbosaHughes() chooses γ itself."""


class NotSaved(TypeError):
    """A part of a problem cannot be saved; the message says which, and why. Nothing was written."""


class TooCoarse(ValueError):
    """The mesh is too coarse around a point for what is asked.

    Parameters
    ----------
    message : str
        What is asked, and where.
    point : (x, y)
        The place.
    radius : float
        How far around it.
    """

    def __init__(self, message: str, point: tuple[float, float], radius: float) -> None:
        super().__init__(message)
        self.point, self.radius = point, radius


class AccuracyWarning(UserWarning):
    """The answer is less accurate than it looks: the message says where, why and what to do about it."""


def warn(message: str) -> None:
    """An AccuracyWarning that points to the line outside of this package that led here."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(message, AccuracyWarning, stacklevel=level)
