"""Cracks, the body that they cut, and what these answer with."""

from . import curves, sheets  # noqa: F401  gives Crack its curves, Sheet its shapes
from ._ngsxfem_contact import Crack, CrackedMesh, ElementKind, EndKind, FrontDemand, Sheet, Side
from .description import as_html, as_text, of_body


def described(body: CrackedMesh) -> str:
    """Its mesh, and its cracks with their ends."""
    return as_text("CrackedMesh", of_body(body))


def described_in_notebooks(body: CrackedMesh) -> str:
    """The same as HTML."""
    return as_html("CrackedMesh", of_body(body))


CrackedMesh.__repr__ = described  # type: ignore
CrackedMesh._repr_html_ = described_in_notebooks  # type: ignore

__all__ = ["Crack", "CrackedMesh", "ElementKind", "EndKind", "FrontDemand", "Sheet", "Side"]
