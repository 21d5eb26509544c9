"""How far a solution is off, and where: in the energy norm, and for quantities; and what to refine until it is near enough."""

from .adaptive import AdaptiveSolution, SolveAdaptive
from .contact_edge import ContactEdge
from .contact_pressure import ContactPressure
from .error_estimate import ErrorEstimate
from .goal_estimate import GoalEstimate
from .goals import ContactForce, Displacement, StressIntensityFactor
from .norm_estimate import NormEstimate

__all__ = [
    "SolveAdaptive",
    "AdaptiveSolution",
    "ErrorEstimate",
    "GoalEstimate",
    "NormEstimate",
    "StressIntensityFactor",
    "ContactForce",
    "ContactEdge",
    "ContactPressure",
    "Displacement",
]
