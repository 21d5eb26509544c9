"""How large the disk of a tip's singular functions may be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..points import place
from ..share import share_in

if TYPE_CHECKING:
    from ngsolve import Mesh

    from .._ngsxfem_contact import CrackedMesh, Tip
    from ..material import Isotropic


ON_INTERFACE = 1e-9  # of a tip's clearance: nearer to another material is on it


def largest_disk(body: CrackedMesh, tip: Tip, material: Isotropic | None = None) -> tuple[float, str]:
    """(radius, what limits it): the tip's clearance, and the distance to elements in which its functions would be wrong.

    Those are curved elements, whose rules around a tip are made for straight triangles, and for the modes of a material
    (material given) elements of another one. Zero if the tip itself lies on such an element.
    """
    limits = [(tip.clearance, tip.limit)]
    share = share_in(body)
    if body.mesh.GetCurveOrder() > 1:
        curved = body.mesh.ngmesh.Elements2D().NumPy()["curved"]
        limits.append((distance(body.mesh, np.flatnonzero(curved), tip.point), "a curved element"))
    to_others = -share.Max(-distance_to_others(body.mesh, tip.point, material))
    check_off_interface(tip, to_others)
    limits.append((to_others, "another material, for which the modes are wrong"))
    return min(limits, key=lambda limit: limit[0])


def check_off_interface(tip: Tip, to_others: float) -> None:
    """Raises ValueError for a tip at no distance from another material."""
    if to_others <= ON_INTERFACE * tip.clearance:
        raise ValueError(
            f"the tip at {place(tip.point)} lies on the interface of two materials, where stresses do not grow like 1/√r and K_I, K_II are not defined: end the crack "
            "inside one material, or solve without tip functions (tip=None) and without K"
        )


def check_disk(who: str, body: CrackedMesh, tip: Tip, r1: float, material: Isotropic | None, remedy: str) -> None:
    """Raises ValueError if a disk that fits the tip's clearance, which the space checks, reaches elements in which its functions would be wrong."""
    radius, limit = largest_disk(body, tip, material)
    if radius < tip.clearance and not 0 < r1 <= (1 + 1e-10) * radius:
        raise ValueError(
            f"{who}: the disk r1 = {r1:g} of the tip at {place(tip.point)} reaches {limit}, at {radius:g}; choose 0 < r1 < {radius:g}, or {remedy}"
        )


def distance_to_others(mesh: Mesh, point: tuple[float, float], material: Isotropic | None) -> float:
    """Of a point from the elements of another material than that at the point; inf if there are none."""
    if material is None or len(material.regions) < 2:
        return np.inf
    here = material.At(mesh, point)
    foreign = np.array([region != here for region in material.regions])
    regions = mesh.ngmesh.Elements2D().NumPy()["index"] - 1
    return distance(mesh, np.flatnonzero(foreign[regions]), point)


def distance(mesh: Mesh, elements: np.ndarray, point: tuple[float, float]) -> float:
    """Of a point from some straight triangles; inf if there are none, 0 inside of one."""
    if len(elements) == 0:
        return np.inf
    nodes = mesh.ngmesh.Elements2D().NumPy()["nodes"][elements, :3] - 1
    corners = mesh.ngmesh.Coordinates()[nodes, :2] - np.asarray(point)
    edges = np.roll(corners, -1, axis=1) - corners
    t = np.clip(-(corners * edges).sum(axis=2) / (edges * edges).sum(axis=2), 0, 1)
    to_edges = np.hypot(*np.moveaxis(corners + t[..., None] * edges, 2, 0)).min(axis=1)
    turns = corners[..., 0] * edges[..., 1] - corners[..., 1] * edges[..., 0]
    inside = (turns >= 0).all(axis=1) | (turns <= 0).all(axis=1)
    return float(np.where(inside, 0, to_edges).min())
