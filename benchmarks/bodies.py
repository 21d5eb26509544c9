"""Random meshes and cracks for benchmarks/positions.py, each determined by its random generator; a graded strip for benchmarks/laws.py."""

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import BND, Mesh
from ngsolve.meshes import MakeStructured2DMesh

from ngsxfem_contact import Crack

MARGIN = 0.12  # of tips and kinks from the boundary; the bodies have a diameter of about 1.2


def polygon_mesh(corners, maxh):
    """Unstructured; boundaries "side0", "side1", ..."""
    return Mesh(polygon_geometry(corners).GenerateMesh(maxh=maxh))


def polygon_geometry(corners):
    """Of polygon_mesh."""
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*map(float, p)) for p in corners]
    for i in range(len(points)):
        geometry.Append(["line", points[i], points[(i + 1) % len(points)]], bc=f"side{i}")
    return geometry


def refine_towards(mesh, point, levels=2):
    """Bisects the elements within 0.25, then 0.125, ... of a point."""
    for level in range(levels):
        vertices = np.array([v.point for v in mesh.vertices])
        for element in mesh.Elements():
            centre = vertices[[v.nr for v in element.vertices]].mean(axis=0)
            mesh.SetRefinementFlag(element, bool(np.hypot(*(centre - point)) < 0.25 * 0.5**level))
        mesh.Refine()
    return mesh


def random_mesh(rng):
    """(mesh, kind): a convex polygon with 4 to 6 corners, unstructured or refined towards a point; or a sheared structured square."""
    kind = str(rng.choice(["unstructured", "graded", "structured"], p=[0.6, 0.2, 0.2]))
    if kind == "structured":
        n, shear = int(rng.integers(7, 11)), float(rng.uniform(-0.3, 0.3))
        return MakeStructured2DMesh(quads=False, nx=n, ny=n, mapping=lambda s, t: (s + shear * t - 0.5, t - 0.5)), kind
    corners = int(rng.integers(4, 7))
    angle = 2 * np.pi * (np.arange(corners) + rng.uniform(-0.15, 0.15, corners)) / corners + rng.uniform(0, 6)
    mesh = polygon_mesh(0.65 * np.column_stack([np.cos(angle), np.sin(angle)]), float(rng.uniform(0.1, 0.15)))
    return (refine_towards(mesh, rng.uniform(-0.2, 0.2, 2)) if kind == "graded" else mesh), kind


def boundary_segments(mesh):
    """(n, 2, 2): the end points of the boundary edges."""
    points = np.array([v.point for v in mesh.vertices])
    return np.array([points[[v.nr for v in element.vertices]] for element in mesh.Elements(BND)])


def distance_to_segments(point, segments):
    """The least distance."""
    a, d = segments[:, 0], segments[:, 1] - segments[:, 0]
    t = np.clip(((point - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0, 1)
    return np.hypot(*(point - a - t[:, None] * d).T).min()


def ray_to_boundary(point, direction, segments):
    """The first point of the boundary in a direction."""
    a, d = segments[:, 0], segments[:, 1] - segments[:, 0]
    cross = lambda u, v: u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = cross(a - point, d) / cross(direction, d)
        s = cross(a - point, direction) / cross(direction, d)
    hits = t[(t > 1e-12) & (s >= -1e-12) & (s <= 1 + 1e-12)]
    return point + hits.min() * direction


def random_polyline(rng, segments, inside):
    """Points with `segments` segments of length 0.15 to 0.35 and turns up to 60°, all of them inside; None if they are not."""
    points, angle = [rng.uniform(-0.45, 0.45, 2)], rng.uniform(0, 2 * np.pi)
    for _ in range(segments):
        points.append(points[-1] + rng.uniform(0.15, 0.35) * np.array([np.cos(angle), np.sin(angle)]))
        angle += rng.uniform(-1, 1)
    return points if all(inside(p) for p in points) else None


def random_crack(rng, mesh):
    """(crack, shape, ends): straight, kinked or an arc; with two tips, one tip, or none ("through": from mouth to mouth)."""
    segments = boundary_segments(mesh)
    inside = lambda p: abs(p[0]) < 0.6 and abs(p[1]) < 0.6 and is_inside(p, segments) and distance_to_segments(p, segments) > MARGIN
    shape = str(rng.choice(["straight", "kinked", "arc"]))
    ends = str(rng.choice(["two tips", "one tip", "through"]))
    while True:
        points = random_polyline(rng, {"straight": 1, "kinked": int(rng.integers(2, 4)), "arc": 2}[shape], inside)
        if points is None:
            continue
        if ends != "two tips":
            points[0] = ray_to_boundary(points[0], unit(points[0] - points[1]), segments)
        if ends == "through":
            points[-1] = ray_to_boundary(points[-1], unit(points[-1] - points[-2]), segments)
        points = [tuple(map(float, p)) for p in points]
        crack = Crack.Arc(*points) if shape == "arc" else Crack(points)
        if all(is_inside(crack.PointAt(s * crack.length), segments) for s in np.linspace(0.02, 0.98, 49)):
            return crack, shape, ends


def unit(v):
    return v / max(np.hypot(*v), 1e-300)


def is_inside(point, segments):
    """Whether a ray to the right meets the boundary an odd number of times."""
    (ax, ay), (bx, by) = segments[:, 0].T, segments[:, 1].T
    crosses = (ay > point[1]) != (by > point[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = ax + (point[1] - ay) / (by - ay) * (bx - ax)
    return bool((crosses & (at > point[0])).sum() % 2)


def moved_square(angle, offset, maxh):
    """The same mesh of the unit square around the origin each time, turned and shifted, and its geometry, onto which a refinement puts points of the boundary."""
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    ngmesh = polygon_mesh(corners, maxh).ngmesh
    c, s = np.cos(angle), np.sin(angle)
    moved = lambda x, y: (c * x - s * y + offset[0], s * x + c * y + offset[1])
    for p in ngmesh.Points():
        p[0], p[1] = moved(p[0], p[1])
    ngmesh.SetGeometry(polygon_geometry([moved(*corner) for corner in corners]))
    return Mesh(ngmesh)


def graded(inner, h, outer):
    """Numbers from 0 to `outer` or beyond, at distances h up to `inner`, which then grow by 1.3."""
    way = np.cumsum(h * 1.3 ** np.arange(1, 60))
    return np.append(np.arange(0, inner + h / 2, h), inner + way[: np.searchsorted(way, outer - inner) + 1])


def strip_mesh(h, end, width=40.0):
    """The right half of a wide plate, fine around 0 < x < end, with a row of elements along the x axis; (mesh, its lower right corner)."""
    xs, half = graded(end + 0.2, h, width), graded(0, h, width)[1:] - 0.8 * h
    ys = np.concatenate([-half[::-1], half])
    nx, ny = len(xs) - 1, len(ys) - 1
    place = lambda u, v: (float(np.interp(u * nx, np.arange(nx + 1), xs)), float(np.interp(v * ny, np.arange(ny + 1), ys)))
    return MakeStructured2DMesh(quads=False, nx=nx, ny=ny, mapping=place), (xs[-1], ys[0])
