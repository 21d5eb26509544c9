"""Warnings where the mesh is too coarse for a crack, so that an answer would look right and be wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import VOL, ElementId

from ..arguments import crack_title
from ..errors import warn
from ..points import place
from .tip_disk import largest_disk

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .._ngsxfem_contact import CrackedMesh, CrackedSolid, CrackFESpace, Front, Tip, TipSpec
    from ..material import Isotropic

DEPTH, BLUNT = 1.5, 2  # longest edges between the front of a sheet and its innermost point: with modes, and without
LIGAMENT = 0.75  # of the longest edge of a face: a front that is nearer to it warns
SMOOTH = 0.8  # the cosine of the angle between faces of one smooth surface
CRACK, DISK, ROOM, INCREMENT = 2, 2, 1, 3  # elements: in a crack for each of its tips, in r1, between a tip without functions and what is next, in a new part


def element_sizes(body: CrackedMesh, elements: np.ndarray | list[int]) -> np.ndarray:
    """The edges of equilateral triangles of the same areas."""
    nodes = body.mesh.ngmesh.Elements2D().NumPy()["nodes"][list(elements), :3] - 1
    a, b, c = np.moveaxis(body.mesh.ngmesh.Coordinates()[nodes, :2], 1, 0)
    twice = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return np.sqrt(2 / np.sqrt(3) * twice)


def size_at(body: CrackedMesh, tip: Tip) -> float:
    """Of the largest element that carries a tip of body.tips."""
    close = 1e-9 * body.cracks[tip.crack].length
    return element_sizes(body, [at.element for at in body.Elements(tip.crack) if min(abs(s - tip.s) for s in at.arclength) <= close]).max()


def size_at_front(body: CrackedSolid, number: int) -> float:
    """The longest edge of the elements that hold a front, their mean."""
    front, ngmesh = body.fronts[number], body.mesh.ngmesh
    corners = ngmesh.Coordinates()[ngmesh.Elements3D().NumPy()["nodes"][sorted(body.FrontElements(front.sheet)), :4] - 1]
    longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=-1).max(axis=(1, 2))
    distances = np.array([front.Distance(tuple(centre)) for centre in corners.mean(axis=1).tolist()])
    return float(longest[distances < longest].mean())


def warn_of_coarse(body: CrackedMesh, specs: list[TipSpec | None], material: Isotropic | None) -> None:
    """Cracks of less than CRACK elements for each tip; at others tips whose functions reach less than DISK, and tips without functions less than ROOM elements from what is next."""
    short = [number for number in range(len(body.cracks)) if warn_of_short_crack(body, number)]
    for tip, spec in zip(body.tips, specs):
        if tip.crack not in short:
            warn_of_small_disk(body, tip, spec, material)


def warn_of_short_crack(body: CrackedMesh, number: int) -> bool:
    """Returns whether it warned."""
    crack, least = body.cracks[number], CRACK * sum(tip.crack == number for tip in body.tips)
    size = np.median(element_sizes(body, [at.element for at in body.Elements(number)]))
    if crack.length >= least * size:
        return False
    warn(
        f"{crack_title(body.cracks, number)} at {place(crack.PointAt(0.5 * crack.length))} is {crack.length:.3g} long, {crack.length / size:.1f} elements: with less than {least} "
        f"it opens too little, by up to 85 %; refine to h <= {crack.length / least:.2g} there"
    )
    return True


def warn_of_small_disk(body: CrackedMesh, tip: Tip, spec: TipSpec | None, material: Isotropic | None) -> None:
    """The room may be there, and r1 chosen smaller."""
    size, (room, limit) = size_at(body, tip), largest_disk(body, tip, material if spec else None)
    radius, least = (spec.r1, DISK) if spec else (room, ROOM)
    if radius >= least * size:
        return
    chosen = radius < 0.5 * room
    why = f"r1 = {radius:.3g}" if chosen else f"{limit}, at {room:.3g},"
    remedy = f"choose r1 >= {min(least * size, 0.9 * room):.2g}" if chosen else f"refine to h <= {radius / least:.2g} there, or move what is in the way"
    warn(
        f"the tip at {place(tip.point)}: {why} leaves it {radius / size:.2g} elements of room; with less than {least} "
        f"the fields at the tip and K are wrong by several percent or more, and reported errors may not show it; {remedy}"
    )


def coarse_elements(V: CrackFESpace) -> np.ndarray:
    """The triangles that are larger than what a space is not warned of: those of short cracks, and those at tips whose functions have little room."""
    body, found = V.body, [np.zeros(0, dtype=int)]
    for number, crack in enumerate(body.cracks):
        tips, elements = sum(tip.crack == number for tip in body.tips), np.array([at.element for at in body.Elements(number)])
        sizes = element_sizes(body, elements)
        if crack.length < CRACK * tips * np.median(sizes):
            found.append(elements[sizes > crack.length / (CRACK * tips + 1)])
    for tip, spec in zip(body.tips, V.tip_specs):
        if spec is not None and spec.r1 < DISK * size_at(body, tip):
            elements = np.array([at.element for at in body.Elements(tip.crack)])
            found.append(elements[element_sizes(body, elements) > spec.r1 / DISK])
    return np.unique(np.concatenate(found))


def warn_of_coarse_sheets(body: CrackedSolid, has_modes: bool) -> None:
    """Sheets of which no point is as far as DEPTH, without modes BLUNT, longest edges of their elements from the nearest front."""
    least, (element, *_, x, y, z) = DEPTH if has_modes else BLUNT, body.dcrack.Points(4)
    sheet_of = {cell.element: number for number in range(len(body.cracks)) for cell in body.Elements(number)}
    of, points = np.array([sheet_of[int(number)] for number in element]), np.column_stack([x, y, z])
    for number in sorted({front.sheet for front in body.fronts}):
        fronts, size = [front for front in body.fronts if front.sheet == number], np.median([cell.h for cell in body.Elements(number)])
        depth = 0.0
        for point in points[of == number]:
            depth = max(depth, min(front.Distance(point) for front in fronts))
            if depth >= least * size:
                break
        else:
            warn(
                f"sheet {number} reaches {depth:.3g} from its front, {depth / size:.1f} of the longest edges there: with less than {least} it opens and slides too little, by "
                f"{'20 % and more, with order 2 by some percent and more' if has_modes else '30 % and more, as its front has no modes'}; refine to edges <= {depth / least:.2g} there"
            )


def warn_of_thin_ligaments(body: CrackedSolid) -> None:
    """Sheets with a front that passes a face of the boundary without an element between; the faces that it ends on do not count."""
    for number in sorted({front.sheet for front in body.fronts}):
        fronts = [front for front in body.fronts if front.sheet == number]
        ends = [np.array(front.PointAt(s)) for front in fronts if not front.closed for s in (0, front.length)]
        faces = boundary_faces(body, body.FrontElements(number))
        left = [next((face for face in faces if face.Holds(end)), None) for end in ends]  # through these the front leaves the body
        beside = [face for face in faces if not any(through and face.Continues(through, end) for through, end in zip(left, ends))]
        rooms = [(room, *face.middle) for face in beside if (room := face.Distance(fronts)) < LIGAMENT * face.size]
        if rooms:
            room, x, y, z = min(rooms)
            warn(
                f"the front of sheet {number} passes the boundary of the body at {room:.3g}, near {place((x, y, z))}, with no element between: what holds there is too stiff, "
                f"by half and more; refine to edges <= {0.5 * room:.2g} there, or let the sheet end on the boundary"
            )


@dataclass
class BoundaryFace:
    """A triangle of the boundary, its corners (3, 3), their middle, the unit normal and the longest edge."""

    corners: np.ndarray

    def __post_init__(self) -> None:
        a, b, c = self.corners
        normal = np.cross(b - a, c - a)
        self.middle, self.normal = self.corners.mean(axis=0), normal / np.linalg.norm(normal)
        self.size = max(np.linalg.norm(edge) for edge in (b - a, c - a, c - b))

    def Holds(self, point: np.ndarray) -> bool:
        """Whether a point lies in the plane of the triangle and beside its middle."""
        return bool(abs((point - self.middle) @ self.normal) < 1e-6 * self.size and np.linalg.norm(point - self.middle) < self.size)

    def Distance(self, fronts: list[Front]) -> float:
        """The least distance of its corners and its middle from fronts."""
        return min(front.Distance(tuple(point)) for front in fronts for point in (*self.corners, self.middle))

    def Continues(self, other: BoundaryFace, end: np.ndarray) -> bool:
        """Whether it goes on with the surface of another triangle, in its plane or, near a point, smoothly."""
        in_plane = np.abs((self.corners - other.middle) @ other.normal).max() < 1e-6 * self.size
        return bool(in_plane or (abs(self.normal @ other.normal) > SMOOTH and np.linalg.norm(self.middle - end) < 3 * self.size))


def boundary_faces(body: CrackedSolid, elements: Iterable[int]) -> list[BoundaryFace]:
    """The faces of some elements that no other element shares."""
    mesh = body.mesh
    faces = [face for number in sorted(elements) for face in mesh[ElementId(VOL, number)].faces if len(mesh[face].elements) == 1]
    return [BoundaryFace(np.array([mesh[vertex].point for vertex in mesh[face].vertices])) for face in faces]


def warn_of_short_increment(body: CrackedMesh, tip: Tip, advance: float) -> bool:
    """Growth by less than INCREMENT elements; returns whether it warned."""
    size = size_at(body, tip)
    if advance >= 0.9 * INCREMENT * size:  # triangles of one mesh differ by as much
        return False
    warn(
        f"CrackGrowth: an increment of {advance:.3g} at the tip {place(tip.point)} is {advance / size:.1f} elements: where the crack turns, a new part of less than {INCREMENT} "
        f"leaves the tip's functions little room, and K is wrong by several percent; choose da >= {INCREMENT * size:.2g}, or refine to h <= {advance / INCREMENT:.2g} there"
    )
    return True
