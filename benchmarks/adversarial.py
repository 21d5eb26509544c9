"""Positions of a crack that coincide with vertices, edges and edge midpoints of a mesh, or nearly so."""

import numpy as np
from bodies import boundary_segments, distance_to_segments, polygon_mesh, ray_to_boundary, unit
from ngsolve.meshes import MakeStructured2DMesh

from ngsxfem_contact import Crack

KINDS = (
    "through vertices",
    "along edges",
    "tip on a vertex",
    "tip on an edge",
    "two tips on vertices",
    "kink on a vertex",
    "kink on an edge",
    "from mouth to mouth",
)
DISPLACEMENTS = (0, 1e-15, 1e-12, 1e-9, 1e-6)
GENERIC = 0.27  # a displacement that nothing is special about


def mesh_of(sample, refined):
    """A structured and an unstructured square in turn; refined: each triangle divided into 16."""
    if sample % 2:
        mesh = polygon_mesh([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)], 0.11 + 0.002 * sample)
    else:
        mesh = MakeStructured2DMesh(quads=False, nx=8 + sample % 3, ny=8, mapping=lambda s, t: (s - 0.5, t - 0.5))
    if refined:
        mesh.Refine()
        mesh.Refine()
    return mesh


def position(kind, sample, displacement, refined=False):
    """(mesh, crack, whether it has a tip). The crack is shifted by displacement × h; its mouths stay on the boundary."""
    mesh = mesh_of(sample, False)
    rng = np.random.default_rng([sample, KINDS.index(kind)])
    vertices, segments = np.array([v.point for v in mesh.vertices]), boundary_segments(mesh)
    edges = np.array([[v.nr for v in e.vertices] for e in mesh.edges])
    inner = np.array([distance_to_segments(p, segments) > 0.12 for p in vertices])
    points, mouths = places(kind, rng, vertices[inner], vertices[edges[inner[edges].all(axis=1)]])
    h = np.hypot(*(vertices[edges[:, 0]] - vertices[edges[:, 1]]).T).max()
    angle = rng.uniform(0, 2 * np.pi)
    points = np.asarray(points) + displacement * h * np.array([np.cos(angle), np.sin(angle)])
    points = [np.array(p) for p in points]
    if mouths > 0:
        points.insert(0, ray_to_boundary(points[0], unit(points[0] - points[1]), segments))
    if mouths > 1:
        points.append(ray_to_boundary(points[-1], unit(points[-1] - points[-2]), segments))
    return mesh_of(sample, True) if refined else mesh, Crack([tuple(map(float, p)) for p in points]), mouths < 2


def places(kind, rng, vertices, edges):
    """(points, number of mouths that the ends are prolonged to)."""
    vertex = lambda: vertices[rng.integers(len(vertices))]
    edge = lambda: edges[rng.integers(len(edges))]
    inside = lambda p: np.abs(p).max() < 0.4
    while True:
        p, q, (a, b), turn = vertex(), vertex(), edge(), rng.uniform(-1, 1)
        angle = rng.uniform(0, 2 * np.pi)
        away = lambda t, length: length * np.array([np.cos(t), np.sin(t)])
        far = 0.15 < np.hypot(*(p - q)) < 0.5
        middle, onward = 0.5 * (a + b), away(angle + turn, 0.25)
        match kind:
            case "through vertices":
                points, mouths, fits = [p, q, q + 0.37 * unit(q - p) * 0.15], 1, far
            case "along edges":
                points, mouths, fits = [a, b], 1, True
            case "tip on a vertex":
                points, mouths, fits = [p - away(angle, 0.1), p], 1, True
            case "tip on an edge":
                points, mouths, fits = [middle - away(angle, 0.1), middle], 1, True
            case "two tips on vertices":
                points, mouths, fits = [p, q], 0, far
            case "kink on a vertex":
                points, mouths, fits = [p - away(angle, 0.1), p, p + onward], 1, True
            case "kink on an edge":
                points, mouths, fits = [middle - away(angle, 0.1), middle, middle + onward], 1, True
            case "from mouth to mouth":
                points, mouths, fits = [p, q], 2, far
        if fits and all(inside(point) for point in points):
            return points, mouths
