"""Stress intensity factors, energy release rates, growth: read from functions in V_h and their stresses, however they were found."""

from .growth import CrackGrowth
from .growth_laws import GivenIncrement, MaximumHoopStress, Paris, WingCracks
from .initiation import NewCrack, StressInitiation
from .junction_initiation import JunctionInitiation
from .stress_intensity import InteractionIntegral, JumpExtrapolation, ModeCoefficients

__all__ = [
    "CrackGrowth",
    "GivenIncrement",
    "InteractionIntegral",
    "JumpExtrapolation",
    "JunctionInitiation",
    "MaximumHoopStress",
    "ModeCoefficients",
    "NewCrack",
    "Paris",
    "StressInitiation",
    "WingCracks",
]
