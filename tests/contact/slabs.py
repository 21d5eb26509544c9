"""A straight front through a slab between planes of symmetry, and the same crack in the plane, in plane strain."""

import numpy as np
from netgen.occ import OCCGeometry, Rectangle, Y
from ngsolve import CF, BSpline, Mesh, x
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.spaces import FrontEnrichment

E, NU, HEIGHT, LENGTH, THICKNESS = 1.0, 0.3, 0.61, 0.385, 0.25


def plane_solution(load, law, h=0.02, order=3):
    """The unit square with an edge crack, its bottom held, load on its top."""
    square = Rectangle(1, 1).Face()
    square.edges.Min(Y).name, square.edges.Max(Y).name = "bottom", "top"
    body = CrackedMesh(Mesh(OCCGeometry(square, dim=2).GenerateMesh(maxh=h)), Crack([(0, HEIGHT), (LENGTH, HEIGHT)]))
    V = CrackFESpace(body, order=order, material=Elasticity.PlaneStrain(E, NU), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.f += CF(load) * V.TestFunction() * body.ds("top")
    return problem.Solve()


def slab_solution(load, law, n, order=1, radius=0.0, multipliers=0):
    """In n x n x n/4 cubes of six tetrahedra; the front lies in about the same place of a cube for n = 12, 20, 28."""
    mesh = MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n // 4, mapping=lambda *p: (p[0], p[1], THICKNESS * p[2]))
    for i, name in enumerate(("side", "bottom", "side", "top", "symmetry", "symmetry")):
        mesh.ngmesh.SetBCName(i, name)
    sheet = Sheet.Polygon([(-1, HEIGHT, -1), (-1, HEIGHT, 2), (LENGTH, HEIGHT, 2), (LENGTH, HEIGHT, -1)])
    body = CrackedMesh(mesh, sheet)
    V = CrackFESpace(body, order=order, material=Elasticity.Solid(E, NU), dirichlet="bottom", dirichletz="symmetry", front=FrontEnrichment(radius=radius))
    problem = ContactProblem(V, TraceSpace(body, order=multipliers), law=law)
    problem.f += CF((*load, 0)) * V.TestFunction() * body.ds("top")
    return problem.Solve(inverse="sparsecholesky")


def deviations(slab, plane):
    """Of a slab from the cross-section, relative: K_I and K_II inside and at the ends, K_III, gap or λ in L², contact force (0 where both are open), energy."""
    flat, found, faces = np.array(tuple(plane.StressIntensity(0))), slab.StressIntensity(), slab.Profile()
    size, profile = np.linalg.norm(flat), plane.Profile(n=2000)
    name = "gap" if plane.ContactForce() == 0 else "sigma_n"
    along = BSpline(2, [0, *profile["s"], LENGTH], list(profile[name]))(x)  # linear between points
    polygons, _ = slab.state.nodes.polygons
    exact = polygons.Means(along)
    K = np.hypot(found.K_I - flat[0], found.K_II - flat[1]) / size
    force = abs(slab.ContactForce() / (THICKNESS * plane.ContactForce()) - 1) if plane.ContactForce() else abs(slab.ContactForce())
    on_faces = np.sqrt(np.sum(faces["area"] * (faces[name] - exact) ** 2) / np.sum(faces["area"] * exact**2))
    energy = abs(slab.Energy() / (THICKNESS * plane.Energy()) - 1)
    return np.array([K[1:-1].max(), K[[0, -1]].max(), np.abs(found.K_III).max() / size, on_faces, force, energy])
