"""Solve, estimate, refine, stop."""

import numpy as np
import pytest
from helpers import MATERIAL, rectangle
from netgen.csg import unit_cube
from netgen.geom2d import SplineGeometry, unit_square
from ngsolve import CF, Integrate, Mesh, dx

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, SolveError, TraceSpace
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.estimate import ContactPressure, Displacement, SolveAdaptive, StressIntensityFactor
from ngsxfem_contact.estimate.adaptive import worst
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.exact.fracture_solutions import infinite_plate
from ngsxfem_contact.points import mesh_arrays
from study.shapes import SHAPES, body_mesh, shape_problem


def plate_with(a):
    """A crack of length 2a in the infinite plate, on a square of size 1."""
    plate = infinite_plate(MATERIAL, a, 1, 0.4)

    def make_problem(mesh):
        body = CrackedMesh(mesh, cf.crack_on_axis(-a, a))
        problem = ContactProblem(CrackFESpace(body, order=2, material=MATERIAL, dirichlet="outer"), TraceSpace(body, order=1))
        problem.SetDirichlet(plate.u, "outer")
        return problem

    return make_problem, plate


def loaded(crack, order=2, traction=(0, 1)):
    def make_problem(mesh):
        body = CrackedMesh(mesh, crack)
        V = CrackFESpace(body, order=order, material=MATERIAL, dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body, order=1))
        problem.f += CF(traction) * V.TestFunction() * body.ds("top")
        return problem

    return make_problem


def refusing(mesh):
    raise ValueError("of my own")


def test_a_crack_shorter_than_a_triangle(tmp_path):
    """An eighth of an edge at first: K within the tolerance and the bar, no warning; the mesh that was given stays as it is."""
    make_problem, plate = plate_with(0.02)
    mesh = cf.rotated_square(*cf.position(0), 0.3)
    triangles = mesh.ne
    found = SolveAdaptive(make_problem, mesh, StressIntensityFactor("K_I"), tolerance=1e-2)
    assert found.reached and mesh.ne == triangles and "tolerance is reached" in repr(found)
    assert abs(plate.K_I - found.quantity.value) < found.quantity.bar < 1e-2 * abs(found.quantity.value)
    assert "around the cracks" in found.table["state"][0] and np.isnan(found.table["relative"][0])
    assert found.table["unknowns"][-1] == found.solution.problem.V.ndof < 8000
    picture = found.Plot(tmp_path / "levels.png")
    assert picture.stat().st_size > 20_000


def test_the_energy_falls_like_one_over_the_unknowns():
    """P2 on a kinked crack in contact, whose kink and transition limit uniform meshes: N⁻¹ within a tenth."""
    with pytest.warns(AccuracyWarning, match="max_levels=9 is reached; the error is"):
        found = SolveAdaptive(lambda mesh: shape_problem("kinked", mesh), body_mesh(0.3), tolerance=1e-6, max_levels=9)
    levels = found.table[3:]
    rate = np.polyfit(np.log(levels["unknowns"]), np.log(levels["energy"]), 1)[0]
    assert -1.3 < rate < -0.9 and not found.reached
    assert abs(found.solution.Energy() / SHAPES["kinked"].energy - 1) < 2 * levels["energy"][-1] ** 2 + 1e-3


def test_the_pressure_to_a_tolerance():
    """(d) to half a percent of λ: triangles become small where contact ends, not where λ is smooth, and the true error is within the bar."""
    exact = cf.contact_transition(MATERIAL)
    angle, offset = cf.position(3)
    crack = cf.crack_on_axis(*cf.mouths(angle, offset))

    def make_problem(mesh):
        body = CrackedMesh(mesh, crack)
        problem = ContactProblem(CrackFESpace(body, order=2, material=MATERIAL, tip=None, dirichlet="outer"), TraceSpace(body, order=1))
        problem.SetDirichlet(exact.u, "outer")
        return problem

    found = SolveAdaptive(make_problem, cf.rotated_square(angle, offset, 0.12), ContactPressure(), tolerance=5e-3)
    assert found.reached and np.isnan(found.table["error"]).all() and found.quantity.goal == ContactPressure()
    assert cf.pressure_error(found.solution, exact) < 1.5 * found.quantity.bar < 1.5 * 5e-3 * found.quantity.value
    vertices, triangles = mesh_arrays(found.solution.body.mesh)
    centres = vertices[triangles].mean(axis=1)
    sizes = np.linalg.norm(vertices[triangles[:, 0]] - vertices[triangles[:, 1]], axis=1)
    at = lambda point: sizes[np.linalg.norm(centres - point, axis=1).argmin()]
    assert 3 * at((0, 0)) < min(at((-0.3, 0)), at((0.3, 0)))


def test_curved_boundaries_stay_curved():
    geometry = SplineGeometry()
    geometry.AddRectangle((-1, -1), (1, 1), bcs=["bottom", "right", "top", "left"])
    geometry.AddCircle((0, 0), 0.2, leftdomain=0, rightdomain=1, bc="hole")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4))
    mesh.Curve(3)
    area = Integrate(CF(1) * dx, mesh)
    found = SolveAdaptive(loaded(Crack([(0.3, 0), (0.45, 0.05)])), mesh, StressIntensityFactor("K_I", 1), tolerance=0.03)
    last = found.solution.body.mesh
    assert found.reached and last.GetCurveOrder() == 3 and last.ne > 2 * mesh.ne
    assert abs(Integrate(CF(1) * dx, last) - (4 - 0.04 * np.pi)) <= abs(area - (4 - 0.04 * np.pi)) * (1 + 1e-6) < 1e-4


def test_a_mesh_that_the_core_refuses_is_refined_everywhere():
    """The tip is a fiftieth from the boundary, along which the crack runs: the first mesh does not separate them."""
    found = SolveAdaptive(loaded(Crack([(0, 0.41), (0.02, 0.43)])), Mesh(unit_square.GenerateMesh(maxh=0.3)), Displacement("top", "y"), tolerance=0.02)
    assert "everywhere" in found.table["state"][0] and found.reached and len(found.solution.body.tips) == 1


def test_what_ends_it():
    mesh, make_problem = rectangle(0.3), loaded(Crack([(0, 0.52), (0.5, 0.52)]))
    with pytest.warns(AccuracyWarning, match="max_unknowns=500 is reached"):
        found = SolveAdaptive(make_problem, mesh, tolerance=1e-5, max_unknowns=500)
    assert not found.reached and found.solution.problem.V.ndof > 500
    with pytest.raises(SolveError, match="before the mesh was fine enough"):
        SolveAdaptive(plate_with(0.003)[0], cf.rotated_square(*cf.position(0), 0.4), max_levels=3)
    for arguments, error in (
        ({"tolerance": 0}, ValueError),
        ({"max_levels": 0}, ValueError),
        ({"fraction": 1.5}, ValueError),
        ({"goal": "K_I"}, TypeError),
        ({"scale": -1.0}, ValueError),
    ):
        with pytest.raises(error, match="SolveAdaptive"):
            SolveAdaptive(make_problem, mesh, **arguments)
    with pytest.raises(ValueError, match="of my own"):
        SolveAdaptive(refusing, mesh)
    with pytest.raises(ValueError, match="no estimate of errors in space"):
        SolveAdaptive(make_problem, Mesh(unit_cube.GenerateMesh(maxh=0.9)))
    with pytest.raises(TypeError, match="not a function of a mesh"):
        SolveAdaptive(None, mesh)
    with pytest.raises(TypeError, match="must return a ContactProblem"):
        SolveAdaptive(lambda mesh: mesh, mesh)


def test_marking():
    assert worst(np.array([1.0, 5, 2, 4]), 0.5).tolist() == [False, True, False, True]
    assert worst(np.array([1.0, 5, 2, 4]), 0.4).tolist() == [False, True, False, False]
    assert worst(np.ones(4), 1.0).all() and worst(np.zeros(3), 0.5).sum() == 1
