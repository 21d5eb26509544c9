"""Cracks, the body that they cut, and what these answer with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _ngsxfem_contact as core
from . import curves, triangulated  # noqa: F401  give Crack its curves, and Sheet its triangulated surfaces
from ._ngsxfem_contact import Crack, ElementKind, EndKind, FrontDemand, HeightField, Sheet, Side
from .description import as_html, as_text, of_body
from .share import share_of
from .sheets import body_in_space

if TYPE_CHECKING:
    from ngsolve import Mesh

__all__ = ["Crack", "CrackedMesh", "ElementKind", "EndKind", "FrontDemand", "HeightField", "Sheet", "Side"]


class CrackedMesh(core.CrackedMesh):
    """A mesh with its cracks: CrackedMesh(mesh, crack, ...). The mesh need not know the cracks; they may also run along its edges.

    Of a mesh of tetrahedra with Sheets it is a CrackedSolid.

    Parameters
    ----------
    mesh
        Of NGSolve, plane, triangles, straight or curved. It must not be refined, curved or moved (SetDeformation) afterwards: all that is built on the
        body is refused then; build a new CrackedMesh. What is built on a body does not change it.
    *cracks
        The Cracks, one by one; without any it is the body as it was. An argument that asks for one of them takes its number, from 0, or its name.

    Raises
    ------
    Exception
        For two cracks of one name, a crack that leaves the body on its way, runs along its boundary or ends beside it, and for cracks that share a stretch
        or touch without crossing.
    NotImplementedError
        Under mpirun with several processes for a mesh that they do not share, see `processes.DistributedMesh`.

    Notes
    -----
    An end of a crack outside of the body is cut off at the boundary, one inside that is nearer to it than a tenth of the element there ends on it:
    `notes` and the report of a solve say so. Forms are integrated over its measures: dx the body without the cracks, ds its boundary, both sides at a
    mouth, dcrack the cracks, dlarger the larger part, of those directly beside a crack, of each element that it meets. Each may be restricted:
    body.ds("left|right").
    """

    def __new__(cls, mesh: Mesh | None = None, *cracks: Any) -> Any:  # without a mesh: to be filled by pickle
        return body_in_space(mesh, cracks) or super().__new__(cls)

    def __init__(self, mesh: Mesh, *cracks: Any) -> None:
        self.share = share_of(mesh, cracks)
        super().__init__(self.share.mesh, *cracks, is_part=self.share.several)

    def __setstate__(self, state: Any) -> None:
        super().__setstate__(state)  # type: ignore[misc]
        self.share = share_of(self.mesh, self.cracks)


def described(body: CrackedMesh) -> str:
    """Its mesh, and its cracks with their ends."""
    return as_text("CrackedMesh", of_body(body))


def described_in_notebooks(body: CrackedMesh) -> str:
    """The same as HTML."""
    return as_html("CrackedMesh", of_body(body))


core.CrackedMesh.__repr__ = described  # type: ignore
core.CrackedMesh._repr_html_ = described_in_notebooks  # type: ignore
