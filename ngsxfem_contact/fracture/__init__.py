"""Stress intensity factors, energy release rates, growth: read from functions in V_h and their stresses, however they were found."""

from .growth import CrackGrowth
from .growth_laws import GivenIncrement, MaximumHoopStress, Paris, WingCracks
from .stress_intensity import InteractionIntegral, JumpExtrapolation, ModeCoefficients

__all__ = ["CrackGrowth", "GivenIncrement", "InteractionIntegral", "JumpExtrapolation", "MaximumHoopStress", "ModeCoefficients", "Paris", "WingCracks"]
