"""Sheets of triangulated surfaces: Sheet.FromTriangles, Sheet.FromSTL, Sheet.FromFace. They become smooth heights over a plane (docs/method.md, section 21)."""

from pathlib import Path
from typing import Any

import numpy as np
import scipy
from netgen.meshing import MeshingStep
from netgen.occ import Face, OCCGeometry

from . import curves
from ._ngsxfem_contact import Crack, HeightField, Sheet
from .arguments import check_positive
from .points import place
from .sheets import plane_axes

SAME = 1e-9  # of the size of the surface: nearer points are one
STEEPEST = 45  # degrees between a triangle and the plane below
CORNER = 30  # degrees by which the boundary turns at a corner that stays one
MARGIN = 0.25  # of the size, around the surface: there the heights go on smoothly, beyond it linearly
MOST_KNOTS = 120  # in a direction
SMOOTHING = 1e-7  # weight of third differences beside the squares of residuals
ROUGH = 0.02  # of the mean edge: farther from a corner the smooth surface is another one
NEAR = 0.002  # of the mean edge: so near is the boundary to the spline through its corners, with as few pieces as that takes


def from_triangles(points: Any, triangles: Any) -> Sheet:
    """The smooth surface through the corners of a triangulation, bounded by the smooth curve through its boundary.

    Parameters
    ----------
    points : (n, 3)
        Corners (x, y, z); those at the same place are one.
    triangles : (m, 3)
        Numbers of corners, all in the same sense: the normal points to where they run counter-clockwise.

    Raises
    ------
    ValueError
        For arrays of other shapes, triangles whose sense changes or that do not make one surface, with the place; for a closed surface; where a triangle is steeper than 45° over
        the plane through the middle with the mean normal, and where corners are too far from any smooth surface.
    Exception
        For a boundary that meets itself.

    Notes
    -----
    Heights over that plane are cubic B-splines at distances of a mean edge, the boundary is a cubic spline with corners where it turns by more than 30°.
    """
    points, triangles = merged(*checked_triangles(points, triangles))
    around = boundary_loops(triangles, points)
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    origin, mean = np.average((a + b + c) / 3, axis=0, weights=areas), normals.sum(axis=0)
    if not np.linalg.norm(mean) > 1e-6 * areas.sum():
        raise ValueError("Sheet.FromTriangles: the surface is closed, or its triangles have no common sense; a sheet is a surface with a boundary")
    mean /= np.linalg.norm(mean)
    cosines = normals @ mean / areas
    if (worst := int(np.argmin(cosines))) >= 0 and cosines[worst] < np.cos(np.radians(STEEPEST)):
        raise ValueError(
            f"Sheet.FromTriangles: triangle {worst} at {place(tuple((a + b + c)[worst] / 3))} is {np.degrees(np.arccos(cosines[worst])):.0f} degrees steep over the plane with the mean"
            f" normal {tuple(np.round(mean, 4).tolist())}; more than {STEEPEST} are not there: divide the surface into sheets"
        )
    axes = np.array(plane_axes(mean))
    flat, heights = (points - origin) @ axes.T, (points - origin) @ mean
    edge = float(np.mean([np.linalg.norm(q - p, axis=1).mean() for p, q in ((a, b), (b, c), (c, a))]))
    loops = sorted((boundary_curve(flat[loop], NEAR * edge) for loop in around), key=lambda loop: -float(np.ptp(loop.Outline(), axis=0).max()))
    return Sheet(loops, origin.tolist(), axes.tolist(), heights=fitted(flat, heights, edge, points))


def checked_triangles(points: Any, triangles: Any) -> tuple[np.ndarray, np.ndarray]:
    """As arrays; raises ValueError for what are none."""
    points, triangles = np.asarray(points, dtype=float), np.asarray(triangles)
    if points.ndim != 2 or points.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3 or len(triangles) == 0:
        raise ValueError(f"Sheet.FromTriangles: points have shape {points.shape} and triangles {triangles.shape}; give (n, 3) and (m, 3)")
    if not np.isfinite(points).all():
        raise ValueError(f"Sheet.FromTriangles: point {int(np.argmin(np.isfinite(points).all(axis=1)))} is not finite")
    if not np.issubdtype(triangles.dtype, np.integer) or triangles.min() < 0 or triangles.max() >= len(points):
        raise ValueError(f"Sheet.FromTriangles: the triangles must be numbers of the {len(points)} points, from 0")
    return points, triangles


def merged(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """With one point for each place, and without triangles that have no area."""
    size = np.ptp(points, axis=0).max()
    _, first, number = np.unique(np.round((points - points.min(axis=0)) / (SAME * size)), axis=0, return_index=True, return_inverse=True)
    triangles = np.ravel(number)[triangles]
    points = points[first]
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    triangles = triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12 * size**2]
    if not len(triangles):
        raise ValueError("Sheet.FromTriangles: no triangle has an area")
    used, number = np.unique(triangles, return_inverse=True)
    return points[used], number.reshape(-1, 3)


def boundary_loops(triangles: np.ndarray, points: np.ndarray) -> list[list[int]]:
    """The corners around the surface, and around each hole; raises ValueError where it is no surface."""
    directed = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    found, count = np.unique(directed, axis=0, return_counts=True)
    if (count > 1).any():
        where = place(tuple(points[found[np.argmax(count)]].mean(axis=0)))
        raise ValueError(
            f"Sheet.FromTriangles: two triangles run along the edge at {where} in the same direction; the surface branches there, or the sense of its triangles changes"
        )
    edges = {tuple(edge) for edge in found.tolist()}
    following: dict[int, int] = {}
    for p, q in edges:
        if (q, p) not in edges:
            if p in following:
                raise ValueError(
                    f"Sheet.FromTriangles: the boundary meets itself at {place(tuple(points[p]))}; give parts that hang together by a point only as several sheets"
                )
            following[p] = q
    loops = []
    while following:
        start = min(following)
        loop = [start]
        while (point := following.pop(loop[-1])) != start:
            loop.append(point)
        loops.append(loop)
    if not loops:
        raise ValueError("Sheet.FromTriangles: the surface is closed; a sheet has a boundary")
    return loops


def boundary_curve(points: np.ndarray, tolerance: float) -> Crack:
    """The closed curve through points (n, 2): segments or cubic splines between corners, one periodic spline without."""
    sides = np.roll(points, -1, axis=0) - points
    before = np.roll(sides, 1, axis=0)
    turns = np.abs(np.arctan2(before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0], (before * sides).sum(axis=1)))
    corners = np.flatnonzero(turns > np.radians(CORNER))
    if not len(corners):
        return smooth_curve(np.concatenate([points, points[:1]]), "periodic", tolerance)
    points, corners = np.roll(points, -corners[0], axis=0), corners - corners[0]
    ends = [*corners.tolist(), len(points)]
    around = np.concatenate([points, points[:1]])
    stretches = [around[first : last + 1] for first, last in zip(ends[:-1], ends[1:])]
    return Crack.Join(*(straight(stretch) or smooth_curve(stretch, "not-a-knot", tolerance) for stretch in stretches))


def smooth_curve(points: np.ndarray, ends: str, tolerance: float) -> Crack:
    """The spline through points of the one through all points (n, 2), at equal distances, as few as keep it within a tolerance."""
    chords = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    whole = scipy.interpolate.CubicSpline(chords, points, bc_type=ends)
    samples = np.linspace(0, chords[-1], 16 * len(points))
    pieces = 6 if ends == "periodic" else 3
    while pieces < len(points) - 1:
        knots = np.linspace(0, chords[-1], pieces + 1)
        values = whole(knots)
        values[-1] = points[-1]
        few = scipy.interpolate.CubicSpline(knots, values, bc_type=ends)
        if np.linalg.norm(few(samples) - whole(samples), axis=1).max() <= tolerance:
            return curves.of_spline(few)
        pieces = int(np.ceil(1.25 * pieces))
    return curves.of_spline(whole)


def straight(points: np.ndarray) -> Crack | None:
    """The segment between the ends, if all points lie on it."""
    chord = points[-1] - points[0]
    off = np.abs(chord[0] * (points[:, 1] - points[0, 1]) - chord[1] * (points[:, 0] - points[0, 0])) / np.hypot(*chord) if np.hypot(*chord) > 0 else np.ones(1)
    return Crack([tuple(points[0].tolist()), tuple(points[-1].tolist())]) if off.max() <= 1e-7 * np.hypot(*chord) else None


def fitted(flat: np.ndarray, heights: np.ndarray, edge: float, points: np.ndarray) -> HeightField:
    """Cubic B-splines with knots at distances of an edge, or more, that are nearest to the heights (n,) at flat (n, 2); third differences are small where there are no corners."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = MARGIN * (high - low).max()
    low, width = low - margin, high - low + 2 * margin
    intervals = np.clip(np.ceil(width / edge), 8, MOST_KNOTS).astype(int)
    spacing = width / intervals
    bases = [splines(flat[:, k], low[k], spacing[k], intervals[k]) for k in range(2)]
    rows = scipy.sparse.csr_matrix(scipy.sparse.vstack([scipy.sparse.kron(bases[0][i], bases[1][i]) for i in range(len(flat))]))
    differences = [scipy.sparse.diags([-1.0, 3.0, -3.0, 1.0], [0, 1, 2, 3], shape=(n, n + 3)) for n in intervals]
    ones = [scipy.sparse.eye(n + 3) for n in intervals]
    rough = scipy.sparse.vstack([scipy.sparse.kron(differences[0], ones[1]), scipy.sparse.kron(ones[0], differences[1])])
    matrix = scipy.sparse.csc_matrix(rows.T @ rows + SMOOTHING * (rough.T @ rough) + 1e-13 * scipy.sparse.eye(rows.shape[1]))
    coefficients = scipy.sparse.linalg.spsolve(matrix, rows.T @ heights)
    off = np.abs(rows @ coefficients - heights)
    if (worst := int(np.argmax(off))) >= 0 and off[worst] > ROUGH * edge:
        raise ValueError(
            f"Sheet.FromTriangles: the smooth surface is {off[worst]:.3g} from the corner at {place(tuple(points[worst]))}, more than {ROUGH:g} of the mean edge {edge:.3g}; a sheet is smooth:"
            " divide it along creases, or give finer triangles where it bends"
        )
    return HeightField(tuple(low.tolist()), tuple(spacing.tolist()), coefficients.reshape(intervals + 3))


def splines(at: np.ndarray, low: float, spacing: float, intervals: int) -> "scipy.sparse.csr_matrix":
    """(n, intervals + 3): values of the B-splines."""
    return scipy.sparse.csr_matrix(scipy.interpolate.BSpline.design_matrix(at, low + spacing * np.arange(-3, intervals + 4), 3))


def from_stl(path: str | Path) -> Sheet:
    """The surface of a file in STL format, text or binary: see Sheet.FromTriangles.

    Parameters
    ----------
    path
        Of the file, in the user's unit of length.

    Raises
    ------
    OSError, ValueError
        For a file that is not there or no STL file, and as Sheet.FromTriangles.
    """
    corners = read_stl(Path(path))
    return from_triangles(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def read_stl(path: Path) -> np.ndarray:
    """(m, 3, 3): the corners of the triangles."""
    content = path.read_bytes()
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    if len(content) >= 84 and len(content) == 84 + record.itemsize * int.from_bytes(content[80:84], "little"):
        return np.frombuffer(content, record, offset=84)["corners"].astype(float)
    try:
        words = content.decode("ascii").split()
        found = [words[i + 1 : i + 4] for i, word in enumerate(words) if word == "vertex"]
        corners = np.array(found, dtype=float).reshape(-1, 3, 3)
    except ValueError:
        corners = np.zeros((0, 3, 3))
    if not len(corners):
        raise ValueError(f"Sheet.FromSTL: {str(path)!r} has no triangles, or is no STL file")
    return corners


def from_face(face: Face, maxh: float) -> Sheet:
    """A face of an OpenCASCADE shape as a sheet: it is triangulated, see Sheet.FromTriangles.

    Parameters
    ----------
    face : netgen.occ.Face
    maxh : float
        Of the triangles: some for each radius of curvature; the error of the surface falls with its fourth power.

    Raises
    ------
    TypeError, ValueError
        For what is no face, and as Sheet.FromTriangles.
    """
    if not isinstance(face, Face):
        raise TypeError(f"Sheet.FromFace: face={face!r} is no face of netgen.occ; take shape.faces[...]")
    check_positive(maxh, "Sheet.FromFace: maxh")
    mesh = OCCGeometry(face).GenerateMesh(maxh=maxh, perfstepsend=MeshingStep.MESHSURFACE)
    triangles = np.array([[v.nr - 1 for v in element.vertices] for element in mesh.Elements2D()])
    return from_triangles(np.array(mesh.Coordinates()), triangles)


for name, constructor in (("FromTriangles", from_triangles), ("FromSTL", from_stl), ("FromFace", from_face)):
    setattr(Sheet, name, staticmethod(constructor))
