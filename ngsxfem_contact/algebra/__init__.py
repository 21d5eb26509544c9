"""Linear algebra and the nonlinear methods on the unknowns of cracks: matrices and vectors, no body and no space."""

from .nodal_newton import FixedPoint, FullNewton

__all__ = ["FixedPoint", "FullNewton"]
