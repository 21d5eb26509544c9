"""Warnings where the mesh is too coarse for a crack, so that an answer would look right and be wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arguments import crack_title
from ..errors import warn
from ..points import place
from .tip_disk import largest_disk

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackedMesh, CrackedSolid, CrackFESpace, Tip, TipSpec
    from ..material import Isotropic

DEPTH, BLUNT = 1.5, 2  # longest edges between the front of a sheet and its innermost point: with modes, and without
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
