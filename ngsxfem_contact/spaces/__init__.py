"""The spaces V_h and W_h, what they must be told of tips and meshes, and functions in them."""

from .._ngsxfem_contact import CrackBilinearForm
from .crack_fespace import CrackFESpace, TipEnrichment
from .interpolation import Interpolant, Projection
from .linear_sheet_trace_space import LinearSheetTraceSpace
from .sheet_trace_space import SheetTraceSpace
from .solid_fespace import FrontEnrichment, SolidFESpace
from .trace_space import TraceSpace

__all__ = [
    "CrackBilinearForm",
    "CrackFESpace",
    "FrontEnrichment",
    "Interpolant",
    "LinearSheetTraceSpace",
    "Projection",
    "SheetTraceSpace",
    "SolidFESpace",
    "TipEnrichment",
    "TraceSpace",
]
