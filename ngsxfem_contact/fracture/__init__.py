"""Stress intensity factors, energy release rates, growth: read from functions in V_h and their stresses, however they were found."""

from .front_fields import FrontField
from .front_growth import SheetGrowth, grown_sheet
from .front_stress_intensity import front_factors
from .front_tube import TubeRule
from .growth import CrackGrowth
from .growth_laws import GivenIncrement, MaximumHoopStress, Paris, WingCracks
from .initiation import NewCrack, StressInitiation
from .junction_initiation import JunctionInitiation
from .stress_intensity import InteractionIntegral, JumpExtrapolation, ModeCoefficients

__all__ = [
    "CrackGrowth",
    "FrontField",
    "GivenIncrement",
    "InteractionIntegral",
    "JumpExtrapolation",
    "JunctionInitiation",
    "MaximumHoopStress",
    "ModeCoefficients",
    "NewCrack",
    "Paris",
    "SheetGrowth",
    "StressInitiation",
    "TubeRule",
    "WingCracks",
    "front_factors",
    "grown_sheet",
]
