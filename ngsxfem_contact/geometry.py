"""Cracks, the body that they cut, and what these answer with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, CF, Integrate, Mesh, ds, dx

from . import _ngsxfem_contact as core
from . import curves, triangulated  # noqa: F401  give Crack its curves, and Sheet its triangulated surfaces
from ._ngsxfem_contact import Crack, ElementKind, EndKind, FrontDemand, HeightField, Sheet, Side
from .arguments import check_type
from .description import as_html, as_text, of_body, of_solid
from .share import share_of
from .sheets import body_in_space

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .description import Lines
    from .share import Share

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
        For a mesh that was refined after it was curved, two cracks of one name, a crack that leaves the body on its way, runs along its boundary or ends beside it, and for cracks that share a stretch
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
        check_type(mesh, Mesh, "CrackedMesh: mesh", "a Mesh of NGSolve; one of Netgen becomes it by Mesh(...)")
        self.share = share_of(mesh, cracks)
        check_curved(self.share.mesh)
        check_same(self.share, cracks)
        super().__init__(self.share.mesh, *cracks, is_part=self.share.several)

    def __setstate__(self, state: Any) -> None:
        super().__setstate__(state)  # type: ignore[misc]
        self.share = share_of(self.mesh, self.cracks)


def check_same(share: Share, cracks: Sequence[Any]) -> None:
    """Raises ValueError where processes were given different cracks: they would wait for each other for ever."""
    of_all = share.Gather([(crack.length, *crack.PointAt(0), *crack.PointAt(crack.length)) for crack in cracks if isinstance(crack, Crack)])
    if any(np.shape(others) != np.shape(of_all[0]) or not np.allclose(others, of_all[0], rtol=1e-9) for others in of_all):
        raise ValueError("CrackedMesh: processes were given different cracks; give the same to all")


def check_curved(mesh: Mesh) -> None:
    """Raises ValueError for a plane mesh that was refined after it was curved: NGSolve leaves its triangles straight and its boundary curved."""
    if mesh.dim != 2 or mesh.levels == 1 or mesh.GetCurveOrder() == 1:
        return
    corners = np.array(mesh.ngmesh.Coordinates())[:, :2]
    a, b, c = (corners[[element.vertices[k].nr for element in mesh.Elements()]] for k in range(3))
    (x1, y1), (x2, y2) = (b - a).T, (c - a).T
    edges = corners[[[vertex.nr for vertex in element.vertices] for element in mesh.Elements(BND)]]
    chords = np.hypot(*(edges[:, 1] - edges[:, 0]).T)
    areas = np.array(Integrate(CF(1) * dx, mesh, element_wise=True))
    if Integrate(CF(1) * ds, mesh) > (1 + 1e-12) * chords.sum() and np.allclose(areas, 0.5 * np.abs(x1 * y2 - x2 * y1), rtol=1e-10, atol=0):
        raise ValueError(
            f"CrackedMesh: the mesh was refined after mesh.Curve({mesh.GetCurveOrder()}), which leaves its triangles straight and its boundary curved; "
            f"call mesh.Curve({mesh.GetCurveOrder()}) again"
        )


def lines_of(body: Any) -> tuple[str, Lines]:
    """Its name, and what it says of itself: its mesh, and its cracks with their ends or fronts."""
    return ("CrackedSolid", of_solid(body)) if isinstance(body, core.CrackedSolid) else ("CrackedMesh", of_body(body))


def described(body: Any) -> str:
    """Its mesh, and its cracks with their ends or fronts."""
    return as_text(*lines_of(body))


def described_in_notebooks(body: Any) -> str:
    """The same as HTML."""
    return as_html(*lines_of(body))


for body_class in (core.CrackedMesh, core.CrackedSolid):
    body_class.__repr__ = described  # type: ignore
    body_class._repr_html_ = described_in_notebooks  # type: ignore
