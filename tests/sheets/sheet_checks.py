"""Bodies with sheets, and how far their measures are from exact values."""

import numpy as np
from exact_sheets import axes_of, branch_energy, cube_mesh, cut_of_cube, polygon_area, tube_energy, volume_above
from ngsolve import CF, IfPos, InnerProduct, Integrate, atan2, sqrt, x, y, z

from ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.geometry import Sheet

DEMANDS = {"default": dict(), "fine": dict(along=6, angular=6, radial=5, order=9, beta=0.5)}


def whole_plane(origin, normal):
    """A square that covers the cut of a plane with the unit cube."""
    square = [(-4, -4), (4, -4), (4, 4), (-4, 4), (-4, -4)]
    return Sheet([Crack(square)], tuple(float(c) for c in origin), axes_of(normal).tolist())


def plane_errors(mesh, origin, normal):
    """(of the whole volume, of the volume on the plus side, of the area), measured by the rules and by the sizes of parts."""
    body = CrackedMesh(mesh, whole_plane(origin, normal))
    side = InnerProduct(CF((x - origin[0], y - origin[1], z - origin[2])), CF(tuple(normal)))
    above, whole, area = (Integrate(f * dx, mesh) for f, dx in ((IfPos(side, 1, 0), body.dx), (1, body.dx), (1, body.dcrack)))
    return abs(whole - 1), abs(above - volume_above(origin, normal)), abs(area - polygon_area(cut_of_cube(origin, normal)))


def degenerate_planes(rng, mesh):
    """(kind, point, normal) of planes through a vertex, through two, through a face, and through a face of equal cubes."""
    vertices = np.array([v.point for v in mesh.vertices])
    inner = [i for i, v in enumerate(vertices) if 0.01 < v.min() and v.max() < 0.99]
    unit = lambda n: n / np.linalg.norm(n)
    yield "vertex", vertices[rng.choice(inner)], unit(rng.normal(size=3))
    edges = [[v.nr for v in edge.vertices] for edge in mesh.edges if any(v.nr in inner for v in edge.vertices)]
    a, b = vertices[edges[rng.integers(len(edges))]]
    yield "edge", a, unit(np.cross(b - a, rng.normal(size=3)))
    faces = [[v.nr for v in face.vertices] for face in mesh.faces if all(v.nr in inner for v in face.vertices)]
    if faces:
        a, b, c = vertices[faces[rng.integers(len(faces))]]
        yield "face", a, unit(np.cross(b - a, c - a))


OFFSETS = (0, 1e-12, -1e-12, 1e-11, -1e-11, 1e-9, -1e-9)


def tube_case(kind, maxh):
    """(body, r1, exact value) of a straight front and of a circle away from the symmetries of an unrelated mesh."""
    mesh = cube_mesh(maxh)
    if kind == "straight":
        points = [(-1, -1, 0.53), (2, -1, 0.53), (2, 0.47, 0.53), (-1, 0.47, 0.53)]
        return CrackedMesh(mesh, Sheet.Polygon(points)), 0.28, tube_energy(0.28, 1.0)
    return CrackedMesh(mesh, Sheet.Disk((0.513, 0.479, 0.517), (0, 0, 1), 0.3)), 0.19, tube_energy(0.19, 2 * np.pi * 0.3, 1 / 0.3)


def energies(body, r1, demand):
    """∫ of branch_energy around the first front of a body over each element, by number."""
    x1, x2, _ = body.fronts[0].tube
    r = sqrt(x1 * x1 + x2 * x2)
    energy = IfPos(r1 - r, branch_energy(r, atan2(x2, x1), r1), 0).Compile()
    return Integrate(energy * body.dx(fronts=demand), body.mesh, element_wise=True).NumPy()
