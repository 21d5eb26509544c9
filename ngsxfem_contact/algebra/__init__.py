"""Linear algebra and the nonlinear methods on the unknowns of cracks: matrices and vectors, no body and no space."""

from .nodal_methods import FixedPoint, FullNewton

__all__ = ["FixedPoint", "FullNewton"]
