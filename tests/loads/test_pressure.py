"""The outward normal of bodies whose boundary elements run either way, and pressures on their boundaries."""

import pickle

import netgen.csg as csg
import netgen.occ as occ
import numpy as np
import pytest
from helpers import rectangle
from netgen.geom2d import Circle, CSG2d, Rectangle, SplineGeometry
from ngsolve import CF, Integrate, Mesh, ds, dx, specialcf, x, y, z

from ngsxfem_contact import ContactProblem, ContactSolution, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.job.part import read_part
from ngsxfem_contact.operators import OutwardNormal

STEEL = Elasticity.PlaneStrain(E=1000, nu=0.3)


def with_spline_hole(maxh=0.3):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bc="outer")
    geometry.AddCircle((0.5, 0.5), 0.2, leftdomain=0, rightdomain=1, bc="hole")
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def subtracted_in_the_plane():
    geometry = CSG2d()
    geometry.Add(Rectangle((0, 0), (1, 1), bc="outer") - Circle((0.5, 0.5), 0.2, bc="hole"))
    return Mesh(geometry.GenerateMesh(maxh=0.3))


def of_cad():
    hole = occ.Circle((0.5, 0.5), 0.2).Face()
    return Mesh(occ.OCCGeometry(occ.Rectangle(1, 1).Face() - hole, dim=2).GenerateMesh(maxh=0.3))


def mirrored():
    return Mesh(occ.OCCGeometry(occ.Rectangle(1, 1).Face().Mirror(occ.Axis((0.5, 0.5, 0), occ.X)), dim=2).GenerateMesh(maxh=0.4))


def with_a_cavity():
    geometry = csg.CSGeometry()
    geometry.Add(csg.OrthoBrick(csg.Pnt(0, 0, 0), csg.Pnt(1, 1, 1)) - csg.Sphere(csg.Pnt(0.5, 0.5, 0.5), 0.2))
    return Mesh(geometry.GenerateMesh(maxh=0.4))


@pytest.mark.parametrize("make", [rectangle, with_spline_hole, subtracted_in_the_plane, of_cad, mirrored, with_a_cavity])
@pytest.mark.parametrize("order", [1, 3])
def test_the_divergence_theorem(make, order):
    mesh = make(0.3) if make is rectangle else make()
    mesh.Curve(order)
    position = CF((x, y, z)[: mesh.dim])
    flux = Integrate(OutwardNormal(mesh) * position * ds(bonus_intorder=6), mesh)
    assert flux == pytest.approx(mesh.dim * Integrate(CF(1) * dx(bonus_intorder=6), mesh), rel=1e-9)


def ring():
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 2, bc="outer")
    geometry.AddCircle((0, 0), 1, leftdomain=0, rightdomain=1, bc="hole")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.25))
    mesh.Curve(3)
    return mesh


HALVES = [Crack.Arc((1.5, 0), (0, 1.5), (-1.5, 0)), Crack.Arc((-1.5, 0), (0, -1.5), (1.5, 0))]


def pressed(mesh):
    body = CrackedMesh(mesh, Crack.Join(*HALVES))
    V = CrackFESpace(body, order=3, material=STEEL)
    problem = ContactProblem(V, TraceSpace(body, order=2))
    u, v = V.TnT()
    problem.a += 1e-3 * u * v * body.dx
    return problem


def lame(r, inner=10, outer=20):
    """σ_r of a ring from 1 to 2 under pressures inside and outside."""
    return (inner - 4 * outer) / 3 - (inner - outer) * 4 / 3 / r**2


def test_a_ring_under_pressure_inside_and_outside(tmp_path):
    problem = pressed(ring())
    problem.Pressure(10, "hole")
    problem.Pressure(CF(20), "out.*", bonus_intorder=2)
    solution = problem.Solve()
    assert np.abs(solution.Profile().sigma_n / lame(1.5) - 1).max() < 2e-3
    force = solution.ContactForce()
    assert force == pytest.approx(lame(1.5) * 3 * np.pi, rel=1e-4)
    assert pickle.loads(pickle.dumps(problem)).Solve().ContactForce() == pytest.approx(force, rel=1e-12)
    solution.Save(tmp_path / "ring.solution")
    assert ContactSolution.Load(tmp_path / "ring.solution").problem.Solve().ContactForce() == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_a_pressure_on_a_refined_mesh_is_saved(tmp_path, order):
    """NGSolve reads what was refined and then curved back straight: 0.1 % of the area here."""
    mesh = with_spline_hole(0.4)
    mesh.Refine()
    mesh.Curve(order)
    body = CrackedMesh(mesh, Crack([(0, 0.5), (0.2, 0.5)]))
    V = CrackFESpace(body, order=1, material=STEEL, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body))
    problem.Pressure(1 + x, "hole")
    solution = problem.Solve()
    solution.Save(tmp_path / "plate.solution")
    again = ContactSolution.Load(tmp_path / "plate.solution").problem.Solve()
    assert Integrate(CF(1) * dx, again.body.mesh) == pytest.approx(Integrate(CF(1) * dx, mesh), rel=1e-14)
    assert again.Energy() == pytest.approx(solution.Energy(), rel=1e-12) and solution.Energy() > 0


def test_a_ring_in_one_file(tmp_path):
    geometry = occ.OCCGeometry(occ.Circle((0, 0), 2).Face() - occ.Circle((0, 0), 1).Face(), dim=2)
    mesh = geometry.GenerateMesh(maxh=0.3)
    mesh.SetBCName(0, "outer")
    mesh.SetBCName(1, "hole")
    mesh.Save(str(tmp_path / "ring.vol"))
    (tmp_path / "part.toml").write_text("""
        mesh = {file = "ring.vol", curve = 3}
        material = [{E = 1000, nu = 0.3, form = "plane strain"}]
        crack = [{join = [{arc = [[1.5, 0], [0, 1.5], [-1.5, 0]]}, {arc = [[-1.5, 0], [0, -1.5], [1.5, 0]]}]}]
        load = [{pressure = 10, boundary = "hole"}, {pressure = 20, boundary = "outer"}]
        support = [{foundation = [1e-3, 1e-3]}]
        [displacement]
        order = 3
    """)
    (solution,) = read_part(tmp_path / "part.toml").Solve()
    names = solution.body.mesh.GetBoundaries()
    sizes = {name: Integrate(CF(1) * ds(name), solution.body.mesh) for name in names}
    assert sizes["hole"] < sizes["outer"]
    assert solution.ContactForce() == pytest.approx(lame(1.5) * 3 * np.pi, rel=1e-3)


def test_a_normal_of_ngsolve_that_points_into_the_body_is_refused():
    problem = pressed(ring())
    v, n = problem.V.TestFunction(), specialcf.normal(2)
    problem.f += -20 * n * v * problem.body.ds("outer")
    with pytest.raises(ValueError, match=r"NGSolve's normal points into the body on 'hole'.*problem.Pressure, or OutwardNormal\(mesh\)"):
        problem.f += -10 * n * v * problem.body.ds("hole")
    with pytest.raises(ValueError, match="on 'hole'"):
        problem.f += -10 * n * v * problem.body.ds
    problem.f += -10 * OutwardNormal(problem.body.mesh) * v * problem.body.ds("hole")
    assert problem.Solve().ContactForce() == pytest.approx(lame(1.5) * 3 * np.pi, rel=1e-4)


@pytest.mark.parametrize("arguments, kind, message", [
    ((1, "roof"), ValueError, "Pressure: region='roof' matches no boundary"),
    ((1, 3), TypeError, "Pressure: region=3 is not the name of a boundary"),
    ((CF((1, 2)), "hole"), ValueError, "Pressure: p has 2 component"),
])  # fmt: skip
def test_pressures_that_are_refused(arguments, kind, message):
    problem = pressed(ring())
    with pytest.raises(kind, match=message):
        problem.Pressure(*arguments)


def test_an_integrand_that_is_a_vector_is_refused_in_words():
    problem = pressed(ring())
    with pytest.raises(ValueError, match=r"problem.f: an integrand has 2 components; write vector\*v"):
        problem.f += 5 * problem.V.TestFunction() * problem.body.dx
