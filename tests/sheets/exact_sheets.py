"""Areas and volumes of planes and sheets in the unit cube, made without the package; random sheets and what they are compared with."""

from dataclasses import dataclass, field
from itertools import product

import numpy as np
from netgen.csg import CSGeometry, OrthoBrick, Pnt
from ngsolve import Mesh, cos, sin, sqrt
from scipy.spatial import ConvexHull

from ngsxfem_contact import Crack
from ngsxfem_contact.geometry import Sheet

CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
EDGES = [(a, b) for a in range(8) for b in range(a) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]


def cube_mesh(maxh, seed=None):
    """Of the unit cube; with a seed its inner points are moved at random, by less than a tenth of maxh."""
    geometry = CSGeometry()
    geometry.Add(OrthoBrick(Pnt(0, 0, 0), Pnt(1, 1, 1)).bc("outer"))
    ngmesh = geometry.GenerateMesh(maxh=maxh)
    if seed is not None:
        rng = np.random.default_rng(seed)
        for p in ngmesh.Points():
            if all(1e-9 < p[k] < 1 - 1e-9 for k in range(3)):
                for k in range(3):
                    p[k] += 0.05 * maxh * rng.uniform(-1, 1)
    return Mesh(ngmesh)


def axes_of(normal):
    """Two unit vectors with a1 × a2 = normal / |normal|."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first)])


def cut_of_cube(origin, normal):
    """The corners (n, 2) in which a plane cuts the unit cube, counter-clockwise, in the coordinates of axes_of(normal) from the origin."""
    d = (CORNERS - origin) @ normal
    points = [CORNERS[a] + (CORNERS[b] - CORNERS[a]) * d[a] / (d[a] - d[b]) for a, b in EDGES if d[a] * d[b] < 0]
    points += [CORNERS[i] for i in range(8) if d[i] == 0]
    if len(points) < 3:
        return np.zeros((0, 2))
    plane = (np.array(points) - origin) @ axes_of(normal).T
    return plane[ConvexHull(plane).vertices]


def volume_above(origin, normal):
    """Of the part of the unit cube on the side of the normal of a plane."""
    d = (CORNERS - origin) @ normal
    points = [CORNERS[a] + (CORNERS[b] - CORNERS[a]) * d[a] / (d[a] - d[b]) for a, b in EDGES if d[a] * d[b] < 0]
    points += [CORNERS[i] for i in range(8) if d[i] >= 0]
    return ConvexHull(np.array(points)).volume


def polygon_area(points):
    x, y = np.asarray(points).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def half(points, a, normal):
    """The part of a polygon (n, 2) on the side of the line through a to which the normal points."""
    d, kept = (points - a) @ normal, []
    for i in range(len(points)):
        j = (i + 1) % len(points)
        if d[i] >= 0:
            kept.append(points[i])
        if d[i] * d[j] < 0:
            kept.append(points[i] + d[i] / (d[i] - d[j]) * (points[j] - points[i]))
    return np.array(kept).reshape(-1, 2)


def clipped(points, convex):
    """The part of a polygon in a convex one, both counter-clockwise (Sutherland and Hodgman); of the right area if it falls apart."""
    for a, b in zip(convex, np.roll(convex, -1, axis=0)):
        points = half(points, a, np.array([a[1] - b[1], b[0] - a[0]]))
        if len(points) < 3:
            return np.zeros((0, 2))
    return points


def disk_area(polygon, centre, radius):
    """Of the part of a disk in a polygon, counter-clockwise: a sum over its sides of triangles and sectors seen from the centre."""
    total = 0.0
    for p, q in zip(polygon - centre, np.roll(polygon, -1, axis=0) - centre):
        d = q - p
        a, b, c = d @ d, p @ d, p @ p - radius**2
        cuts = [0.0, 1.0]
        if b * b > a * c:
            cuts += [t for t in ((-b - np.sqrt(b * b - a * c)) / a, (-b + np.sqrt(b * b - a * c)) / a) if 0 < t < 1]
        cuts.sort()
        for s, t in zip(cuts, cuts[1:]):
            u, v, middle = p + s * d, p + t * d, p + 0.5 * (s + t) * d
            cross = u[0] * v[1] - u[1] * v[0]
            total += 0.5 * cross if middle @ middle < radius**2 else 0.5 * radius**2 * np.arctan2(cross, u @ v)
    return total


@dataclass
class RandomSheet:
    """A sheet of a kind, and its exact area in the unit cube."""

    kind: str
    sheet: Sheet
    area: float
    polygon: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))


KINDS = ("disk", "ellipse", "polygon", "ring", "edge crack")


def random_sheet(rng, kind):
    """In a random plane through the unit cube; sizes from .08 to .45, an edge crack is a polygon that leaves the cube."""
    origin, normal = rng.uniform(0.2, 0.8, 3), rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    axes, cube = axes_of(normal), cut_of_cube(origin, normal)
    size, lists = rng.uniform(0.08, 0.45), axes.tolist()
    if kind == "disk":
        return RandomSheet(kind, Sheet.Disk(origin, normal, size), disk_area(cube, np.zeros(2), size))
    if kind == "ring":
        inner = size * rng.uniform(0.2, 0.8)
        return RandomSheet(kind, Sheet.Ring(origin, normal, inner, size), disk_area(cube, np.zeros(2), size) - disk_area(cube, np.zeros(2), inner))
    if kind == "ellipse":
        ratio, angle = rng.uniform(0.25, 1), rng.uniform(0, np.pi)
        c, s = np.cos(angle), np.sin(angle)
        a, b = size * (c * axes[0] + s * axes[1]), ratio * size * (c * axes[1] - s * axes[0])
        on_circle = cube @ np.array([[c, -s / ratio], [s, c / ratio]])
        return RandomSheet(kind, Sheet.Ellipse(origin, a, b), ratio * disk_area(on_circle, np.zeros(2), size))
    n = rng.integers(3, 8)
    angles = np.sort((np.arange(n) + rng.uniform(0.1, 0.9, n)) * 2 * np.pi / n)
    points = size * rng.uniform(0.5, 1, n)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    if kind == "edge crack":  # a strip from the middle out of the cube
        angle, width, end = rng.uniform(0, 2 * np.pi), rng.uniform(0.1, 0.5), rng.uniform(-0.1, 0.2)
        c, s = np.cos(angle), np.sin(angle)
        strip = np.array([(end, -width), (3, -width - rng.uniform(0, 1)), (3, width + rng.uniform(0, 1)), (end, width)])
        points = strip @ np.array([[c, s], [-s, c]])
    loop = [tuple(p) for p in [*points.tolist(), points[0].tolist()]]
    return RandomSheet(kind, Sheet([Crack(loop)], origin.tolist(), lists), polygon_area(clipped(points, cube)), points)


def circle_elements(mesh, origin, axes, radius, tolerance=1e-9):
    """Numbers of the tetrahedra that a circle enters, by its crossings with the planes of their faces; those it enters by less than a tolerance in a second set."""
    vertices = np.array([v.point for v in mesh.vertices])
    found, doubtful = set(), set()
    for number, element in enumerate(mesh.Elements()):
        t = vertices[[v.nr for v in element.vertices]]
        d = np.linalg.norm(t - origin, axis=1)
        h = max(np.linalg.norm(t[i] - t[j]) for i in range(4) for j in range(i))
        if d.min() > radius + h or d.max() < radius - h:
            continue
        barycentric = np.linalg.inv(np.vstack([t.T, np.ones(4)]))
        plane = lambda v: barycentric @ np.append(v, 0.0)
        constant, cosine, sine = barycentric @ np.append(origin, 1.0), radius * plane(axes[0]), radius * plane(axes[1])
        size, angles = np.hypot(cosine, sine), [0.0, 2 * np.pi]
        for i in range(4):
            if size[i] > abs(constant[i]):
                direction, width = np.arctan2(sine[i], cosine[i]), np.arccos(-constant[i] / size[i])
                angles += [(direction - width) % (2 * np.pi), (direction + width) % (2 * np.pi)]
        angles = np.sort(angles)
        middle = 0.5 * (angles[1:] + angles[:-1])
        depth = (constant[:, None] + cosine[:, None] * np.cos(middle) + sine[:, None] * np.sin(middle)).min(axis=0)
        if depth.max() > tolerance:
            found.add(number)
        elif depth.max() > 0:
            doubtful.add(number)
    return found, doubtful


def branch_energy(r, theta, r1):
    """Σ_j |∇(χ F_j)|² for r < r1, arrays or CoefficientFunctions: F_j = √r (sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ), χ the quintic cut-off from 1 at 0 to 0 at r1."""
    t = r / r1
    c, dc = 1 - t * t * t * (10 - 15 * t + 6 * t * t), -30 * t * t * (1 - t) * (1 - t) / r1
    s, sh, ch, sn, cn = sqrt(r), sin(theta / 2), cos(theta / 2), sin(theta), cos(theta)
    total = 0
    for a, da in ((sh, ch / 2), (ch, -sh / 2), (sh * sn, ch * sn / 2 + sh * cn), (ch * sn, -sh * sn / 2 + ch * cn)):
        radial, around = dc * s * a + c * a / (2 * s), c * da / s
        total = total + radial * radial + around * around
    return total


def tube_energy(r1, length, curvature=0.0):
    """∫ of branch_energy over the tube of radius r1 around a front of a length and a curvature, dV = (1 + κ r cos θ) ds dA."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    root, theta = 0.5 * np.sqrt(r1) * (1 + nodes)[:, None], np.pi * nodes[None]
    r = root**2
    values = branch_energy(r, theta, r1) * (1 + curvature * r * np.cos(theta)) * 2 * root * r
    return length * 0.5 * np.sqrt(r1) * np.pi * float(weights @ values @ weights)
