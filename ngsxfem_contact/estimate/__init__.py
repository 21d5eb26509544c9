"""How far a solution is off, and where: in the energy norm, and for quantities."""

from .contact_edge import ContactEdge
from .error_estimate import ErrorEstimate
from .goal_estimate import GoalEstimate
from .goals import ContactForce, Displacement, StressIntensityFactor

__all__ = ["ErrorEstimate", "GoalEstimate", "StressIntensityFactor", "ContactForce", "ContactEdge", "Displacement"]
