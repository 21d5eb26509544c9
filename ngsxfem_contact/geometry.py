"""Cracks, the body that they cut, and what these answer with."""

from . import curves, sheets  # noqa: F401  gives Crack its curves, Sheet its shapes
from ._ngsxfem_contact import Crack, CrackedMesh, ElementKind, EndKind, FrontDemand, Sheet, Side

__all__ = ["Crack", "CrackedMesh", "ElementKind", "EndKind", "FrontDemand", "Sheet", "Side"]
