"""The whole of a mesh that several processes share, on the first of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .share import Part, names_of, serial_mesh

if TYPE_CHECKING:
    from typing import Any

    from ngsolve import Mesh

    from .share import Share


def whole_mesh(share: Share) -> tuple[Mesh | None, np.ndarray]:
    """The Mesh of all elements, None on other processes than the first; and the numbers, on which all agree, of its vertices, which increase."""
    if not share.several:
        return share.mesh, share.vertices
    part = Part(share.source, share)
    held = np.unique(part.corners)
    rows = share.AtFirst((part.corners, part.regions, held, part.PointsOf(held), part.facets, part.boundaries, part.curves.parameters))
    names = [max(share.Gather(list(names)), key=len) for names in (part.mesh.GetMaterials(), part.mesh.GetBoundaries())]
    mesh = share.Together(lambda: joined(part, rows, names) if share.is_first else None)
    return mesh, np.unique(np.concatenate([of_one[2] for of_one in rows])) if share.is_first else held


def joined(part: Part, rows: list[Any], names: list[Any]) -> Mesh:
    """The Mesh of the corners and regions of elements, the numbers and points of their vertices, and the vertices, regions and parameters of boundary elements of all."""
    corners, regions, held, points, facets, boundaries, parameters = (np.concatenate(column) for column in zip(*rows))
    vertices, first = np.unique(held, return_index=True)
    _, once = np.unique(names_of(facets), return_index=True)
    place_of = lambda numbers: np.searchsorted(vertices, numbers).astype(int)
    if part.curves.order > 1:
        return part.curves.Mesh(points[first], place_of(corners), regions, place_of(facets[once]), parameters[once])
    return serial_mesh(points[first], place_of(corners), regions, place_of(facets[once]), boundaries[once], *names)
