"""Common cracks in space: Sheet.Disk, Sheet.Ellipse, Sheet.Polygon, Sheet.Ring, Sheet.Extrude; and the body that they crack."""

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from ngsolve import Mesh

from ._ngsxfem_contact import Crack, CrackedMesh, CrackedSolid, Sheet
from .arguments import check_number, check_positive, check_type
from .share import share_of

# Annotations are values here: tools/stubs.py reads them.
Vector: TypeAlias = Sequence[float]
Vectors: TypeAlias = Sequence[Vector] | np.ndarray

SLENDER = 300  # half axes of an ellipse: the arcs of one that is more slender come nearer to each other than the core can tell apart


def checked_vector(vector: Vector, name: str) -> np.ndarray:
    """An array (3,); raises ValueError for what is none, and for numbers that are not finite."""
    try:
        array = np.asarray(vector, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}={vector!r} is no vector (x, y, z)") from None
    if array.shape != (3,):
        raise ValueError(f"{name}={vector!r} has shape {array.shape}; it must have three components")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}={tuple(array.tolist())} must be finite")
    return array


def checked_direction(vector: Vector, name: str) -> np.ndarray:
    """A vector of unit length; raises ValueError for zero."""
    array = checked_vector(vector, name)
    if not np.abs(array).max() > 0:
        raise ValueError(f"{name}={tuple(array.tolist())} is zero and has no direction")
    array = array / np.abs(array).max()  # squares of its components neither overflow nor vanish
    return array / np.linalg.norm(array)


def plane_axes(normal: np.ndarray) -> list[list[float]]:
    """Two directions that span the plane with a unit normal, a1 × a2 = normal."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return [first.tolist(), np.cross(normal, first).tolist()]


def circle(radius: float) -> Crack:
    """Two arcs around the origin."""
    return Crack.Join(Crack.Arc((radius, 0), (0, radius), (-radius, 0)), Crack.Arc((-radius, 0), (0, -radius), (radius, 0)))


def disk(center: Vector, normal: Vector, radius: float) -> Sheet:
    """The disk of a radius around a center: a penny-shaped crack.

    Parameters
    ----------
    center : (x, y, z)
        Its middle.
    normal : (x, y, z)
        Of any length, from the minus to the plus side.
    radius : float
        In the user's unit of length.

    Raises
    ------
    ValueError, TypeError
        For vectors and numbers that are none, a normal that is zero, a radius that is not positive.
    """
    check_positive(radius, "Sheet.Disk: radius")
    origin = checked_vector(center, "Sheet.Disk: center").tolist()
    return Sheet([circle(radius)], origin, plane_axes(checked_direction(normal, "Sheet.Disk: normal")))


def ring(center: Vector, normal: Vector, inner: float, outer: float) -> Sheet:
    """What lies between two circles around a center: a ring-shaped crack with two fronts.

    Parameters
    ----------
    center : (x, y, z)
        Its middle.
    normal : (x, y, z)
        Of any length, from the minus to the plus side.
    inner : float
        The radius of the hole.
    outer : float
        The outer radius.

    Raises
    ------
    ValueError, TypeError
        Unless 0 < inner < outer < inf, and as Sheet.Disk.
    """
    check_positive(inner, "Sheet.Ring: inner")
    check_number(outer, "Sheet.Ring: outer", lambda outer: inner < outer < float("inf"), f"be finite and larger than inner={inner}")
    origin = checked_vector(center, "Sheet.Ring: center").tolist()
    return Sheet([circle(outer), circle(inner)], origin, plane_axes(checked_direction(normal, "Sheet.Ring: normal")))


def ellipse(center: Vector, a: Vector, b: Vector) -> Sheet:
    """The ellipse center + cos(t) a + sin(t) b; its normal is a × b.

    Parameters
    ----------
    center : (x, y, z)
        Its middle.
    a, b : (x, y, z)
        The half axes as vectors, perpendicular.

    Raises
    ------
    ValueError
        For vectors that are none, that are not perpendicular, or one more than 300 times as long as the other.
    """
    origin, first, second = (checked_vector(v, f"Sheet.Ellipse: {name}") for v, name in ((center, "center"), (a, "a"), (b, "b")))
    lengths = float(np.linalg.norm(first)), float(np.linalg.norm(second))
    if not min(lengths) > max(lengths) / SLENDER:
        raise ValueError(f"Sheet.Ellipse: the half axes have lengths {lengths[0]:g} and {lengths[1]:g}; they must be positive, with a ratio below {SLENDER}")
    if abs(first @ second) > 1e-8 * lengths[0] * lengths[1]:
        raise ValueError(f"Sheet.Ellipse: a={tuple(first.tolist())} and b={tuple(second.tolist())} are not perpendicular; give the half axes")
    loop = Crack.OfPieces([("ellipse", [(0, 0), (lengths[0], 0), (0, lengths[1]), (0, 2 * np.pi)])])
    return Sheet([loop], origin.tolist(), [first.tolist(), second.tolist()])


def polygon(points: Vectors) -> Sheet:
    """The polygon with given corners in a plane; its normal points to where they run counter-clockwise.

    Parameters
    ----------
    points : (n, 3)
        The corners (x, y, z), three or more, around it.

    Raises
    ------
    ValueError
        For points that are none, fewer than three, on a line, or farther from a plane than 1e-9 of their distances.
    Exception
        For corners that coincide, and for a polygon that meets itself.
    """
    if not isinstance(points, Sequence | np.ndarray):
        raise TypeError(f"Sheet.Polygon: points={points!r} are no list of corners (x, y, z)")
    corners = np.array([checked_vector(p, f"Sheet.Polygon: point {i}") for i, p in enumerate(points)])
    if len(corners) < 3:
        raise ValueError(f"Sheet.Polygon: {len(corners)} points span no polygon; give three or more")
    origin = corners.mean(axis=0)
    normal = 0.5 * np.cross(corners - origin, np.roll(corners, -1, axis=0) - origin).sum(axis=0)
    size = np.linalg.norm(corners - origin, axis=1).max()
    if not np.linalg.norm(normal) > 1e-9 * size**2:
        raise ValueError("Sheet.Polygon: the points lie on a line, or the polygon crosses itself; give the corners of a plane polygon in order around it")
    normal /= np.linalg.norm(normal)
    heights = (corners - origin) @ normal
    if (worst := int(np.argmax(np.abs(heights)))) >= 0 and abs(heights[worst]) > 1e-9 * size:
        raise ValueError(
            f"Sheet.Polygon: point {worst}, {tuple(corners[worst].tolist())}, lies {abs(heights[worst]):.3g} beside the plane of the others; a curved sheet is Sheet.Extrude or Sheet.FromTriangles"
        )
    axes = plane_axes(normal)
    plane = (corners - origin) @ np.array(axes).T
    closed = [tuple(p) for p in [*plane.tolist(), plane[0].tolist()]]
    return Sheet([Crack(closed)], origin.tolist(), axes)


def extrude(crack: Crack, direction: Vector, origin: Vector = (0, 0, 0), x_axis: Vector | None = None, loops: Sequence[Crack] | None = None) -> Sheet:
    """The surface that a crack of a plane sweeps along its normal: a curved crack, or one with kinks.

    The plane goes through the origin, normal to the direction; the crack's coordinates run along x_axis and direction × x_axis. The normal of the sheet is that of
    the crack, from its minus to its plus side. An element that a kink passes has one plane facet, which cuts its corner off (docs/method.md, section 21).

    Parameters
    ----------
    crack : Crack
        Open: a polyline, segments, arcs, splines. It goes on straight beyond its ends.
    direction : (x, y, z)
        By which it is moved: the sheet lies between the crack at the origin and the crack at origin + direction.
    origin : (x, y, z)
        The point of the plane with the crack's coordinates (0, 0).
    x_axis : (x, y, z)
        Perpendicular to the direction, of any length; default: (1, 0, 0) made perpendicular to it, along x directions (0, 1, 0).
    loops : sequence of Crack
        Closed curves in the coordinates (distance along the direction, arc length on the crack) that bound the sheet, the outer one first; default: all that is swept.

    Raises
    ------
    TypeError, ValueError
        For what is no crack, vectors that are none or zero, an x_axis that is not perpendicular to the direction.
    Exception
        For a crack that is closed, and for loops that Sheet refuses. A body refuses fronts that pass a kink, as they do where the sheet ends inside the body along the direction.
    """
    check_type(crack, Crack, "Sheet.Extrude: crack", "a Crack of the plane")
    unit = checked_direction(direction, "Sheet.Extrude: direction")
    if x_axis is None:
        x_axis = (1, 0, 0) if abs(unit[0]) < 0.9 else (0, 1, 0)
        first = np.array(x_axis) - unit * unit[np.argmax(x_axis)]
    elif abs((first := checked_direction(x_axis, "Sheet.Extrude: x_axis")) @ unit) > 1e-8:
        raise ValueError(
            f"Sheet.Extrude: x_axis={tuple(first.tolist())} is not perpendicular to the direction {tuple(unit.tolist())}; the crack's plane is normal to it"
        )
    height, length = float(np.linalg.norm(checked_vector(direction, "Sheet.Extrude: direction"))), crack.length
    loops = [Crack([(0, 0), (height, 0), (height, length), (0, length), (0, 0)])] if loops is None else list(loops)
    axes = [first.tolist(), np.cross(unit, first).tolist()]
    return Sheet(loops, checked_vector(origin, "Sheet.Extrude: origin").tolist(), axes, crack)


for name, constructor in (("Disk", disk), ("Ellipse", ellipse), ("Polygon", polygon), ("Ring", ring), ("Extrude", extrude)):
    setattr(Sheet, name, staticmethod(constructor))


def heights_over(sheet: Sheet, points: np.ndarray) -> np.ndarray:
    """(n,), positive on the plus side, of points (n, 3) over a sheet."""
    if sheet.planar:
        return (points - sheet.origin) @ np.array(sheet.normal)
    return np.array([sheet.Flat(point)[2] for point in points.tolist()])


def body_in_space(mesh: Any, cracks: Sequence[Any]) -> CrackedSolid | None:
    """The CrackedSolid of a mesh in space; None for a plane one. Raises TypeError for cracks of the other dimension, and for several processes."""
    if not isinstance(mesh, Mesh):
        return None
    if mesh.dim != 3:
        if any(isinstance(crack, Sheet) for crack in cracks):
            raise TypeError("CrackedMesh: a Sheet cracks a body in space, but the mesh is plane; give it Cracks")
        return None
    for sheet in cracks:
        check_type(sheet, Sheet, "CrackedMesh: crack", "a Sheet, but the mesh has dimension 3; give sheets one by one, a list as CrackedMesh(mesh, *sheets)")
    share = share_of(mesh, cracks)
    if not share.mesh.ne:
        raise ValueError("CrackedMesh: the mesh has no tetrahedra, its surface alone; let Netgen mesh the volume, too")
    body = CrackedSolid(share.mesh, list(cracks))
    body.share = share  # type: ignore[attr-defined]
    return body


def check_plane(body: Any, what: str, error: type[Exception] = ValueError) -> None:
    """Raises for what there is for plane bodies only, asked of one in space."""
    if isinstance(body, CrackedSolid):
        raise error(f"{what}: this is there for plane bodies only, and the body has three dimensions")


def check_plane_body(body: Any, name: str) -> None:
    """Raises TypeError for what is no CrackedMesh."""
    check_type(body, CrackedMesh, name, "a CrackedMesh; build one by CrackedMesh(mesh, crack, ...)")
