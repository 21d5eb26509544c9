"""Where wings start: where a hoop stress reaches the strength around a junction, a crossing or a kink. docs/method.md, section 9."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from ..arguments import check_positive, crack_title
from ..points import place
from .initiation import NewCrack, segment, size_at, stress_at, warn_of_small_radius
from .tip_fields import boundary_segments, distance_along

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .._ngsxfem_contact import CrackedMesh
    from ..contact.solution import ContactSolution

AROUND = 2  # elements between a junction and where its hoop stress is taken
BESIDE_ARM = 20  # degrees from a crack: nothing starts there
DIRECTIONS = 720  # around a junction
PATCH = (0.8, 1.0, 1.2), 5  # radii, relative, and degrees to both sides over which a hoop stress is the mean


@dataclass(frozen=True)
class JunctionInitiation:
    """A crack starts from a junction, a crossing or a kink where the largest hoop stress at a distance around it reaches the strength: in the direction of that.

    Parameters
    ----------
    strength
        A stress > 0.
    length
        Of the crack, a length > 0: some elements, so that its tip has room.
    radius
        The distance, a length > 0: two elements there or more.
    toughness
        K_c > 0, stress × √length, in place of radius = (K_c / strength)² / 2π, where the stress ahead of a tip with K_I = K_c is the strength.
    points
        Where, a list of points (x, y) on cracks; default wherever cracks meet or bend by a kink.

    Raises
    ------
    ValueError
        For numbers that make no sense, for both a radius and a toughness, and for points on no crack.

    Notes
    -----
    The hoop stress is a mean over ±20 % of the distance and ±5°. Directions within 20° of a crack, and those in which something else is nearer than the distance, are left out.

    References
    ----------
    Erdogan and Sih (1963): the direction; Williams, Onset of fracture at a blunt corner (1957) and Ritchie, Knott, Rice (1973): a stress at a distance.
    """

    strength: float
    length: float
    radius: float | None = None
    toughness: float | None = None
    points: Sequence[tuple[float, float]] | None = None

    def __post_init__(self) -> None:
        for name in ("strength", "length"):
            check_positive(getattr(self, name), f"JunctionInitiation: {name}")
        if (self.radius is None) == (self.toughness is None):
            raise ValueError("JunctionInitiation: give either radius= or toughness=, from which radius = (toughness / strength)² / 2π follows")
        name = "toughness" if self.radius is None else "radius"
        check_positive(getattr(self, name), f"JunctionInitiation: {name}")

    @property
    def distance(self) -> float:
        """At which the stress is taken."""
        return self.radius if self.toughness is None else (self.toughness / self.strength) ** 2 / (2 * pi)  # type: ignore[return-value]

    def Starts(self, solution: ContactSolution) -> list[NewCrack]:
        """One at each point where the strength is reached."""
        body = solution.body
        points = meeting_points(body) if self.points is None else [on_crack(body, point) for point in self.points]
        return [new for number, point in points if (new := self._at(solution, number, point)) is not None]

    def _at(self, solution: ContactSolution, number: int, point: np.ndarray) -> NewCrack | None:
        body, angles = solution.body, 2 * pi / DIRECTIONS * np.arange(DIRECTIONS)
        hoop = self.HoopStress(solution, point, angles)
        if np.isnan(hoop).all():
            return None
        i = int(np.nanargmax(hoop))
        if hoop[i] < self.strength:
            return None
        (x, y), direction = point.tolist(), np.array([np.cos(angles[i]), np.sin(angles[i])])
        warn_of_small_radius("JunctionInitiation", self.distance, (x, y), size_at(body, point + 1e-3 * self.distance * direction), AROUND)
        reason = f"the hoop stress {hoop[i]:.4g} at {self.distance:.3g} has reached {self.strength:.4g} on {crack_title(body.cracks, number)}"
        origin = body.cracks[number].name or f"crack {number}"
        return NewCrack(segment(point, point + self.length * direction), (x, y), float(hoop[i]), origin, reason)

    def HoopStress(self, solution: ContactSolution, point: np.ndarray, angles: np.ndarray) -> np.ndarray:
        """The mean of σ_θθ around a point, at the distance and in directions.

        Parameters
        ----------
        solution : ContactSolution
            Whose stress it is.
        point : (2,)
            On a crack.
        angles : (n,)
            Radians from the direction of x, equally spaced all around.

        Returns
        -------
        (n,)
            Stresses; nan in directions that do not count.
        """
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        free, around = free_ways(solution.body, point, ways, self.distance), np.column_stack([-ways[:, 1], ways[:, 0]])
        radii, half = PATCH
        hoop = np.zeros(len(angles))
        for radius in radii if free.any() else ():
            points = (point + radius * self.distance * ways)[free]
            xx, yy, xy = solution.problem.V.share.AtPoints(points, lambda here: stress_at(solution, here)).T
            a, b = around[free].T
            hoop[free] += (a * a * xx + b * b * yy + 2 * a * b * xy) / len(radii)
        width = int(half * len(angles) / 360)
        shifts = range(-width, width + 1)
        share = sum(np.roll(free, k).astype(float) for k in shifts)
        total = sum(np.roll(np.where(free, hoop, 0.0), k) for k in shifts)
        return np.where(free & ~beside_arms(solution.body, point, ways), np.divide(total, share, out=np.zeros_like(total), where=share > 0), np.nan)


def free_ways(body: CrackedMesh, point: np.ndarray, ways: np.ndarray, distance: float) -> np.ndarray:
    """(n,) boolean: the directions in which nothing is for a quarter more than the distance."""
    outlines = [np.array(crack.Outline(0.01)) for crack in body.cracks]
    a, b = (np.concatenate([part, *lines]) for part, lines in zip(boundary_segments(body.mesh), ([o[:-1] for o in outlines], [o[1:] for o in outlines])))
    start = 1e-3 * distance  # a curve that meets others there passes the point itself
    return np.array([distance_along(a, b, point + start * way, way) > 1.25 * distance for way in ways])


def beside_arms(body: CrackedMesh, point: np.ndarray, ways: np.ndarray) -> np.ndarray:
    """(n,) boolean: the directions within BESIDE_ARM degrees of a crack that leaves the point."""
    return np.array([ways @ arm > np.cos(np.radians(BESIDE_ARM)) for arm in arms(body, point)]).any(axis=0)


def arms(body: CrackedMesh, point: np.ndarray) -> Iterator[np.ndarray]:
    """The unit directions in which cracks leave a point."""
    for crack in body.cracks:
        tolerance = 1e-6 * crack.length
        if crack.Distance(tuple(point)) > tolerance:
            continue
        s = crack.ArcLength(tuple(point))
        if s > tolerance or crack.closed:
            yield -np.array(crack.TangentAt(s - tolerance if s > tolerance else crack.length - tolerance))
        if s < crack.length - tolerance or crack.closed:
            yield np.array(crack.TangentAt(s + tolerance if s < crack.length - tolerance else tolerance))


def meeting_points(body: CrackedMesh) -> list[tuple[int, np.ndarray]]:
    """(number of a crack, point) wherever cracks meet, or bend by a kink; each point once."""
    found: list[tuple[int, np.ndarray]] = []
    for number, crack in enumerate(body.cracks):
        for s in sorted([*body.Meetings(number), *crack.kinks]):
            point = np.array(crack.PointAt(s))
            if not any(np.linalg.norm(point - other) <= 1e-6 * crack.length for _, other in found):
                found.append((number, point))
    return found


def on_crack(body: CrackedMesh, point: tuple[float, float]) -> tuple[int, np.ndarray]:
    """(number of the crack, the point itself). Raises ValueError unless one passes through it."""
    if not body.cracks:
        raise ValueError(f"JunctionInitiation: no crack passes through {place(point)}; the body has none")
    distance, number = min((crack.Distance(point), number) for number, crack in enumerate(body.cracks))
    if distance > 1e-6 * body.cracks[number].length:
        raise ValueError(f"JunctionInitiation: no crack passes through {place(point)}; the nearest, {crack_title(body.cracks, number)}, is {distance:.4g} away")
    return number, np.array(body.cracks[number].PointAt(body.cracks[number].ArcLength(point)))
