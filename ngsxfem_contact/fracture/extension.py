"""Cracks that become longer: where a tip goes to, what it meets on its way, and whether it has room there."""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING

import numpy as np

from .._ngsxfem_contact import Crack, CrackedMesh
from ..arguments import crack_title
from .tip_fields import TipFrame, boundary_segments, distance_along

if TYPE_CHECKING:
    from ngsolve import Mesh

    from ..material import Isotropic

ENDS = ("start", "end")
ROOM = 2.5  # elements between a new tip and what is next


def arrival_of(
    mesh: Mesh, cracks: list[Crack], number: int, point: np.ndarray, direction: np.ndarray, advance: float, room: float
) -> tuple[np.ndarray, str] | None:
    """(where, what it does) of a crack that grows from a point: it meets ∂Ω or another crack within the advance and the room behind it, or comes so near to one.

    None if there is room for a tip.
    """
    outlines = {c: np.array(crack.Outline(0.01)) for c, crack in enumerate(cracks) if c != number}
    ways = [(distance_along(line[:-1], line[1:], point, direction), f"has joined {crack_title(cracks, c)}: it reached it") for c, line in outlines.items()]
    way, what = min([(distance_along(*boundary_segments(mesh), point, direction), "has cut the body: it reached the boundary"), *ways])
    if way <= advance + room:
        return point + way * direction, what
    tip = point + advance * direction
    nearest = [(cracks[c].Distance(tuple(tip)), c) for c in outlines]
    distance, other = min(nearest, default=(np.inf, -1))
    if distance > room:
        return None
    goal = np.array(cracks[other].PointAt(cracks[other].ArcLength(tuple(tip))))
    ahead = (goal - point) @ direction > 0.5 * np.linalg.norm(goal - point)
    return (goal, f"has joined {crack_title(cracks, other)}: it came near") if ahead else None


def turned(frame: TipFrame, angle: float) -> np.ndarray:
    """The direction at an angle in degrees from ahead of a tip."""
    ahead, turn = np.array(frame.tip.ahead), angle * pi / 180
    return cos(turn) * ahead + sin(turn) * np.array([-ahead[1], ahead[0]])


def with_crack(cracks: list[Crack], number: int, crack: Crack) -> list[Crack]:
    """The list with one crack replaced."""
    return [crack if i == number else other for i, other in enumerate(cracks)]


def extended(crack: Crack, end: str, tip: tuple[float, float]) -> Crack:
    """The crack with a straight new part from its start or end up to a tip; a last straight piece in the same direction is prolonged."""
    old, pieces = crack.points[0 if end == "start" else -1], crack.pieces
    kind, points = pieces[0 if end == "start" else -1]
    if kind == "segment":
        before = points[1 if end == "start" else 0]
        (a, b), (c, d) = np.subtract(old, before), np.subtract(tip, old)
        if a * c + b * d > 0 and abs(a * d - b * c) <= 1e-12 * np.hypot(a, b) * np.hypot(c, d):
            old, pieces = before, pieces[1:] if end == "start" else pieces[:-1]
    new = [("segment", [tip, old] if end == "start" else [old, tip])]
    return Crack.OfPieces(new + pieces if end == "start" else pieces + new, crack.name)


def tip_number(body: CrackedMesh, crack: int, end: str) -> int:
    """The place of a crack's end in body.tips. Raises ValueError if it is none."""
    for number, tip in enumerate(body.tips):
        if (tip.crack, ENDS[int(tip.s > 0)]) == (crack, end):
            return number
    raise ValueError(f"the {end} of {crack_title(body.cracks, crack)} would lie on the boundary, or on another crack")


def check_room(body: CrackedMesh, material: Isotropic, crack: int, end: str) -> None:
    """Raises ValueError unless this end of the crack is a tip with more than ROOM elements around it."""
    number = tip_number(body, crack, end)
    frame = TipFrame(body, number)
    room, limit = frame.Clearance(material)
    if room <= ROOM * frame.h:
        raise ValueError(f"the new tip {body.tips[number].point} would be {room:.4g} from {limit}, less than {ROOM} elements (h = {frame.h:.4g})")


def check_cracks(body: CrackedMesh, cracks: list[Crack]) -> None:
    """Raises ValueError if a body was made with other cracks than those that were asked for: their tips stay where they are."""
    size = max(np.ptp(crack.points, axis=0).max() for crack in cracks) if cracks else 0.0
    ends = [(number, crack.points[k]) for number, crack in enumerate(cracks) for k in (0, -1)]
    for tip in body.tips:
        if not any(number == tip.crack and np.hypot(*np.subtract(tip.point, end)) <= 1e-8 * size for number, end in ends):
            raise ValueError(
                f"CrackGrowth: make_problem returned a body with a tip at {tuple(round(float(c), 6) for c in tip.point)}, where none of the cracks that it was "
                "given ends: build the body of its argument, CrackedMesh(mesh, *cracks)"
            )
    if len(body.cracks) != len(cracks):
        raise ValueError(f"CrackGrowth: make_problem returned a body with {len(body.cracks)} crack(s), it was given {len(cracks)}: CrackedMesh(mesh, *cracks)")
