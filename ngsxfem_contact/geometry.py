"""Cracks, the body that they cut, and what these answer with."""

from . import curves  # noqa: F401  gives Crack its curves
from ._ngsxfem_contact import Crack, CrackedMesh, ElementKind, EndKind, Side

__all__ = ["Crack", "CrackedMesh", "ElementKind", "EndKind", "Side"]
