"""The spaces V_h and W_h, what they must be told of tips and meshes, and functions in them."""

from .._ngsxfem_contact import CrackBilinearForm
from .crack_fespace import CrackFESpace, TipEnrichment
from .interpolation import Interpolant, Projection
from .trace_space import TraceSpace

__all__ = ["CrackBilinearForm", "CrackFESpace", "Interpolant", "Projection", "TipEnrichment", "TraceSpace"]
