"""Contact and K on curved sheets: uniform pressure to round-off, the open arc in plane strain, the plane package's own arc with friction."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from netgen.occ import Box, OCCGeometry, Pnt, Rectangle, Y, Z
from ngsolve import CF, Conj, Id, InnerProduct, Integrate, Mesh, Trace, sqrt, x, y, z

from ngsxfem_contact import ContactProblem, ContactSolution, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, TraceSpace
from ngsxfem_contact.exact.arc_solution import OpenArc
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.fracture.front_fields import FrontField
from ngsxfem_contact.fracture.front_stress_intensity import front_factors
from ngsxfem_contact.geometry import FrontDemand, Sheet
from ngsxfem_contact.plotting import plot_body, plot_front, plot_profile
from ngsxfem_contact.plotting.split_solid import SplitSolid
from ngsxfem_contact.spaces import FrontEnrichment
from tests.sheets.curved_surfaces import CENTRE, THROUGH, arc, circle
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL, STRAIN = Elasticity.Solid(E=2.5, nu=0.25), Elasticity.PlaneStrain(2.5, 0.25)
COARSE, MEDIUM = cube_mesh(0.25), cube_mesh(0.12)
HYDROSTATIC = uniform_stress(MATERIAL, stress_matrix(xx=-1, yy=-1, zz=-1))
FINE_RULES = FrontEnrichment(rules=FrontDemand(0, 6, 6, 5, 7, 0.35))
EDGE = Sheet.Extrude(arc(0.7, -0.1), (0, 0, 3), (0, 0, -1))
ON_CYLINDER = Sheet.Extrude(arc(), (0, 0, 1), loops=[circle((0.5, 0.5 * arc().length), 0.27)])


def pressed(mesh, sheet, front, order=1):
    V = CrackFESpace(body := CrackedMesh(mesh, sheet), order=order, dirichlet="outer", front=front, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body))
    problem.SetDirichlet(HYDROSTATIC.u, "outer")
    return problem.Solve()


@pytest.mark.parametrize("sheet", (THROUGH, EDGE, ON_CYLINDER))
def test_uniform_pressure(sheet):
    """Under -p I the facets, however they lie, carry λ = -p, and u is linear."""
    solution = pressed(COARSE, sheet, None)
    assert np.abs(solution.state.L + 1).max() < 1e-10
    assert Integrate(InnerProduct(solution.u - HYDROSTATIC.u, solution.u - HYDROSTATIC.u) * solution.body.dx, COARSE) < 1e-22
    assert solution.ContactForce() == pytest.approx(-Integrate(1 * solution.body.dcrack, COARSE), rel=1e-10)


def test_uniform_pressure_of_order_two():
    """The same in the mean; where a facet is tiny its λ has the round-off of the functions that live beside it alone."""
    solution = pressed(COARSE, THROUGH, None, 2)
    assert np.abs(solution.state.L + 1) @ solution.state.nodes.weights < 1e-7 and np.abs(solution.state.L + 1).max() < 1e-4
    assert Integrate(InnerProduct(solution.u - HYDROSTATIC.u, solution.u - HYDROSTATIC.u) * solution.body.dx, COARSE) < 1e-16


def test_uniform_pressure_with_modes():
    """To the defect of the rules around the front, which falls as they get finer."""
    worst = [np.abs(pressed(MEDIUM, ON_CYLINDER, front).state.L + 1).max() for front in (FrontEnrichment(), FINE_RULES)]
    assert worst[0] < 2e-3 and worst[1] < 3e-4 and worst[1] < 0.3 * worst[0]


ARC = OpenArc(STRAIN, alpha=0.6, stress=(1, 0.5), beta=0.3)
TIP, THICKNESS = (ARC.tips[1].real, ARC.tips[1].imag), 0.3
MOUTHED = Sheet.Extrude(ARC.Crack(np.pi / 2 + 0.55), (0, 0, 2 + THICKNESS), (0, 0, -1))


def slab(maxh):
    box = Box(Pnt(TIP[0] - 0.55, TIP[1] - 0.42, 0), Pnt(TIP[0] + 0.45, TIP[1] + 0.4, THICKNESS))
    for face in box.faces:
        face.name = "outer"
    box.faces.Min(Z).name = box.faces.Max(Z).name = "end"
    return Mesh(OCCGeometry(box).GenerateMesh(maxh=maxh))


def arc_gradient(at):
    """∇u of ARC in space at complex numbers, a CoefficientFunction."""
    mu, (_, first, second) = STRAIN.mu, ARC.Potential(at)
    omega = ARC.Potential(at / (at * Conj(at)), -1)[1]
    psi = (first - at * second - Conj(omega)) / at**2
    by_z, by_conjugate = (STRAIN.kappa * first - Conj(first)) / (2 * mu), -(at * Conj(second) + Conj(psi)) / (2 * mu)
    by_x, by_y = by_z + by_conjugate, 1j * (by_z - by_conjugate)
    return CF((by_x.real, by_y.real, 0, by_x.imag, by_y.imag, 0, 0, 0, 0), dims=(3, 3))


def test_exact_fields_around_an_arc():
    """K of the closed form to the accuracy of the rule, for each radius: no term of the curvature of the sheet is missing."""
    body = CrackedMesh(slab(0.12), MOUTHED)
    at = x + 1j * y
    faces = {side: arc_gradient(at * (1 + sign * 1e-9)) for side, sign in (("plus", 1), ("minus", -1))}
    found = front_factors(body, FrontField(arc_gradient(at), faces), MATERIAL)
    K = np.array([*ARC.StressIntensity(1), 0])
    assert np.abs(found.by_radius[:, :, :3] - K).max() < 3e-6 * K[0] and np.abs(found.G - found.irwin).max() < 1e-6 * found.G.max()


def smooth_field(normal):
    """Of polynomials of degree 3 with their body force, and their tractions on faces with a normal."""
    X, Y, Z_ = x - 0.5, y - 0.5, z - 0.4
    u = (0.3 * X * X + 0.2 * X * Y + 0.5 * Z_ * Y + 0.1 * X * X * Y, 0.4 * X * Z_ - 0.1 * Y * Y + 0.2 * Z_ * Z_ * X, 0.3 * X * Y + 0.2 * Z_ * Z_ + 0.1 * Y**3)
    gradient = CF(tuple(c.Diff(v) for c in u for v in (x, y, z)), dims=(3, 3))
    stress = MATERIAL.mu * (gradient + gradient.trans) + MATERIAL.lam * Trace(gradient) * Id(3)
    force = CF(tuple(-sum(stress[i, j].Diff(v) for j, v in enumerate((x, y, z))) for i in range(3)))
    return FrontField(gradient, traction=dict.fromkeys(("plus", "minus"), stress * normal), body_force=force)


def test_smooth_fields_have_no_factors():
    """With their body force and tractions, around a front that runs obliquely on a cylinder."""
    radius = sqrt((x - CENTRE[0]) ** 2 + (y - CENTRE[1]) ** 2)
    field = smooth_field(CF(((x - CENTRE[0]) / radius, (y - CENTRE[1]) / radius, 0)))
    found = front_factors(CrackedMesh(cube_mesh(0.1), ON_CYLINDER), field, MATERIAL, radius=0.19)
    assert np.abs([found.K_I, found.K_II, found.K_III, found.G]).max() < 1e-6


def open_arc(maxh):
    """ARC in a slab between planes of symmetry, order 2."""
    V = CrackFESpace(body := CrackedMesh(slab(maxh), MOUTHED), order=2, dirichlet="outer", dirichletz="end", material=MATERIAL)
    problem, (u1, u2) = ContactProblem(V, TraceSpace(body)), ARC.Solution().u
    problem.SetDirichlet((u1, u2, 0), "outer")
    problem.SetDirichlet((None, None, 0), "end")
    return problem.Solve()


def test_an_open_arc_between_planes_of_symmetry():
    """K of the closed form of plane strain, in every cross-section between the planes."""
    solution = open_arc(0.1)
    V = solution.problem.V
    found, (K_I, K_II) = solution.StressIntensity(), ARC.StressIntensity(1)
    assert V.num_left_out == 0 and solution.ContactArea() < 1e-3
    assert np.abs(found.K_I[1:-1] - K_I).max() < 0.03 * K_I and np.abs(found.K_II[1:-1] - K_II).max() < 0.03 * K_I
    assert np.abs(found.K_I - K_I).max() < 0.08 * K_I and (np.abs(found.K_I - K_I) <= found.errors[:, 0]).mean() >= 0.8
    plot_front(found)
    plt.close("all")


CROSSING = Crack.Arc(*((0.5 + 0.9 * float(np.sin(a)), -0.4 + 0.9 * float(np.cos(a))) for a in (-0.75, 0, 0.75)))


def plane_solution(law, crack=CROSSING, maxh=0.04):
    face = Rectangle(1, 1).Face()
    face.edges.name = "side"
    face.edges.Min(Y).name, face.edges.Max(Y).name = "bottom", "top"
    mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=maxh))
    V = CrackFESpace(body := CrackedMesh(mesh, crack), order=2, dirichlet="bottom|top", material=STRAIN)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet((0, 0), "bottom")
    problem.SetDirichlet((0.04, -0.03), "top")
    return problem.Solve()


def solid_solution(law, maxh, thickness=0.15, crack=CROSSING, order=1):
    box = Box(Pnt(0, 0, 0), Pnt(1, 1, thickness))
    box.faces.name = "side"
    box.faces.Min(Z).name = box.faces.Max(Z).name = "end"
    box.faces.Min(Y).name, box.faces.Max(Y).name = "bottom", "top"
    body = CrackedMesh(Mesh(OCCGeometry(box).GenerateMesh(maxh=maxh)), Sheet.Extrude(crack, (0, 0, 2), (0, 0, -1)))
    V = CrackFESpace(body, order=order, dirichlet="bottom|top", dirichletz="end|bottom|top", material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet((0, 0, 0), "bottom")
    problem.SetDirichlet((0.04, -0.03, 0), "top")
    problem.SetDirichlet((None, None, 0), "end")
    return problem.Solve()


def quantities(solution, thickness=1.0):
    """∫ -λ, the norm of the jump, the energy."""
    body, mesh = solution.body, solution.body.mesh
    jump = sqrt(Integrate(InnerProduct(Jump(solution.u), Jump(solution.u)) * body.dcrack, mesh) / thickness)
    return np.array([-Integrate(solution.multiplier * body.dcrack, mesh) / thickness, jump, solution.Energy() / thickness])


def test_an_arc_in_contact_is_that_of_the_plane():
    """Between planes of symmetry: pressure, jump and energy of the plane's solution, nearer as the mesh gets finer."""
    law = Coulomb(0.3)
    exact = quantities(plane_solution(law))
    errors = np.array([np.abs(quantities(solid_solution(law, h), 0.15) / exact - 1) for h in (0.15, 0.06)])
    assert (errors[1] < [0.015, 0.035, 0.015]).all() and (errors[1] < 0.8 * errors[0]).all()


def assert_drawn_and_kept(solution, profile, path):
    """Both lips in pictures have the area of the sheet; pictures, VTK files and a file of the solution are made."""
    split = SplitSolid(solution.body)
    lips = split.points[split.lips]
    areas = 0.5 * np.linalg.norm(np.cross(lips[:, 1] - lips[:, 0], lips[:, 2] - lips[:, 0]), axis=1)
    assert areas[split.lip_side > 0].sum() == pytest.approx(profile.area.sum()) == pytest.approx(areas[split.lip_side < 0].sum())
    for plot in (plot_body, plot_profile):
        plot(solution)
        plt.close("all")
    solution.SaveVTK(path)
    solution.Save(path.with_suffix(".solution"))


def test_what_is_read_and_kept(tmp_path):
    """A table along the sheet, pictures open along it, VTK files, and a file of the solution."""
    solution = solid_solution(Coulomb(0.3), 0.12)
    profile = solution.Profile(0)
    length = CROSSING.length
    radii = np.hypot(profile.x - 0.5, profile.y + 0.4)
    assert np.abs(radii - 0.9).max() < 5e-3 and (0 < profile.p_2).all() and (profile.p_2 < length).all() and np.allclose(profile.p_1, profile.z + 1)
    assert profile.area.sum() == pytest.approx(Integrate(1 * solution.body.dcrack, solution.body.mesh)) and set(profile.state) <= {"open", "stick", "slip"}
    assert np.abs(profile.slip_1).max() < 0.2 * np.abs(profile.slip_2).max()  # along the crack, but for errors of P1
    assert_drawn_and_kept(solution, profile, tmp_path / "arc")
    again = ContactSolution.Load(tmp_path / "arc.solution")
    assert np.array_equal(again.state.L, solution.state.L) and again.Energy() == pytest.approx(solution.Energy(), rel=1e-12)
