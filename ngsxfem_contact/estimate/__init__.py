"""How far a solution is off, and where."""

from .error_estimate import ErrorEstimate

__all__ = ["ErrorEstimate"]
