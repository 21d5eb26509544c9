"""Contact without friction on sheets in space, against closed forms."""

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, Integrate, sqrt
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import BarbosaHughes, ContactProblem, CrackedMesh, CrackFESpace, Elasticity, Jump, LoadCase, LoadSteps, Nitsche, SolveError, TraceSpace
from ngsxfem_contact.contact.checks import Coercivity
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.contact.stabilisation import trace_constants
from ngsxfem_contact.errors import SingularSystem
from ngsxfem_contact.exact.pennies import closed_penny, partially_closed, penny, penny_in_tension
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import FrontDemand, Sheet
from ngsxfem_contact.spaces import FrontEnrichment, Interpolant, SheetTraceSpace, SolidFESpace
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE = (0.49, 0.51, 0.513)
DISK = Sheet.Disk(CENTRE, (0, 0, 1), 0.3)
COARSE, MEDIUM = cube_mesh(0.25), cube_mesh(0.1)
FINE_RULES = FrontEnrichment(rules=FrontDemand(0, 6, 6, 5, 7, 0.35))


def plane(height=CENTRE[2], tilt=(0.0, 0.0)):
    """A sheet through the whole cube."""
    return Sheet.Polygon([(a, b, height + tilt[0] * (a - 0.5) + tilt[1] * (b - 0.5)) for a, b in ((-1, -1), (2, -1), (2, 2), (-1, 2))])


def problem_of(mesh, sheet, front=FrontEnrichment(), form=None, dirichlet="outer", order=1, **arguments):
    V = CrackFESpace(body := CrackedMesh(mesh, sheet), order=order, dirichlet=dirichlet, front=front, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, order=0), **arguments)
    if form is not None:
        problem.SetDirichlet(form.u, "outer")
    return problem


def relative_error(function, exact, measure, mesh):
    return sqrt(Integrate((function - exact) ** 2 * measure, mesh) / Integrate(exact**2 * measure, mesh))


def pressure_error(solution, form):
    return relative_error(solution.multiplier, form.pressure, solution.body.dcrack(bonus_intorder=2), solution.body.mesh)


@pytest.mark.parametrize("sheet", (DISK, plane(), plane(0.47, (0.3, -0.2)), Sheet.Disk((0.5, 0.5, 0.5), (0.2, -0.3, 1), 0.33)))
def test_uniform_pressure_without_modes(sheet):
    """(3a): λ = -p and linear displacements to round-off, where the sheet cuts as it likes."""
    axes = np.array([*sheet.axes, sheet.normal])
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(sheet.origin, axes)
    solution = problem_of(COARSE, sheet, None, form).Solve()
    assert np.abs(solution.state.L + 1).max() < 1e-10 and solution.report.iterations <= 3
    assert Integrate(InnerProduct(solution.u - form.u, solution.u - form.u) * solution.body.dx, COARSE) < 1e-24
    assert solution.ContactArea() == pytest.approx(Integrate(1 * solution.body.dcrack, COARSE)) == pytest.approx(-solution.ContactForce(), rel=1e-10)
    assert np.abs(solution.state.nodes.Values(solution.gap)).max() < 1e-10


SQUARE = Sheet.Polygon([(0.25, 0.25, 0.5), (0.75, 0.25, 0.5), (0.75, 0.75, 0.5), (0.25, 0.75, 0.5)])
HALF = Sheet.Polygon([(-1, -1, 0.5), (0.5, -1, 0.5), (0.5, 2, 0.5), (-1, 2, 0.5)])


@pytest.mark.parametrize("sheet", (plane(0.5), SQUARE, HALF, Sheet.Disk((0.5, 0.5, 0.5), (0, 0, 1), 0.3)))
def test_sheets_along_faces_of_the_mesh(sheet):
    """(3a) on faces, with fronts along edges or through faces: to round-off without modes, to the rules' defect with them."""
    mesh = MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)
    for i in range(6):
        mesh.ngmesh.SetBCName(i, "outer")
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1))
    for front, bound in ((None, 1e-10), (FrontEnrichment(), 2e-3)):
        solution = problem_of(mesh, sheet, front, form).Solve()
        kinds = {cell.kind.name for cell in solution.body.Elements(0)}
        assert "Aligned" in kinds and kinds <= {"Aligned", "Tip"} and np.abs(solution.state.L + 1).max() < bound


def test_order_two():
    """(3a) to round-off without modes; (3d) with them: pressure and slip are several times better than with order 1."""
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(CENTRE)
    assert np.abs(problem_of(COARSE, DISK, None, form, order=2).Solve().state.L + 1).max() < 1e-10
    form = closed_penny(MATERIAL, 0.3, p=1.0, tau=0.5).At(CENTRE)
    solution = problem_of(MEDIUM, DISK, form=form, order=2).Solve()
    around = solution.body.dcrack(bonus_intorder=2, fronts=FrontDemand())
    assert pressure_error(solution, form) < 0.03 and relative_error(Jump(solution.u)[0], form.opening[0], around, MEDIUM) < 0.03
    assert np.allclose(solution.Reactions().total.force, 0, atol=1e-10)


def test_uniform_pressure_with_modes():
    """(3a): to the defect of the rules around the front, which falls as they get finer."""
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(CENTRE)
    worst = [np.abs(problem_of(MEDIUM, DISK, front, form).Solve().state.L + 1).max() for front in (FrontEnrichment(), FINE_RULES)]
    assert worst[0] < 2e-3 and worst[1] < 3e-4 and worst[1] < 0.3 * worst[0]


def test_an_open_penny():
    """(3b) by a pressure on the faces: no contact, the gap, and no reaction."""
    form = penny(MATERIAL, 0.3, 1.0).At(CENTRE)
    problem = problem_of(MEDIUM, DISK, form=form)
    problem.FacePressure(1.0)
    solution = problem.Solve()
    assert solution.ContactArea() < 1e-3 * 0.09 * np.pi and abs(solution.ContactForce()) < 1e-3 * 0.09 * np.pi  # none but for slivers at the front
    around = solution.body.dcrack(bonus_intorder=2, fronts=FrontDemand())
    assert relative_error(solution.gap, form.gap, around, MEDIUM) < 0.17
    loaded = problem_of(MEDIUM, DISK, form=penny_in_tension(MATERIAL, 0.3).At(CENTRE)).Solve()
    assert loaded.ContactArea() == solution.ContactArea() and relative_error(loaded.gap, form.gap, around, MEDIUM) < 0.17


def test_a_closed_penny_that_slides():
    """(3d): everywhere in contact, the slip of the shear alone."""
    form = closed_penny(MATERIAL, 0.3, p=1.0, tau=0.5).At(CENTRE)
    errors = []
    for mesh in (cube_mesh(0.13), MEDIUM):
        solution = problem_of(mesh, DISK, form=form).Solve()
        around = solution.body.dcrack(bonus_intorder=2, fronts=FrontDemand())
        assert solution.state.L.max() < 0 and solution.report.iterations <= 4 and solution.report.Counts() == {"contact": len(solution.state.nodes)}
        slip = relative_error(Jump(solution.u)[0], form.opening[0], around, mesh)
        errors.append((pressure_error(solution, form), slip))
    assert errors[1][0] < 0.12 and errors[1][1] < 0.3 and errors[1][1] < errors[0][1]


def test_a_partially_closed_crack():
    """(3g): the pressure and the radius of the open part on two meshes; few steps of the active set."""
    form, errors, radii = partially_closed(MATERIAL, 0.3).At(CENTRE), [], []
    meshes = [cube_mesh(0.22), cube_mesh(0.11)]
    for mesh in meshes:
        solution = problem_of(mesh, plane(), form=form).Solve()
        assert solution.report.iterations <= 8 and solution.state.L.max() <= 0
        errors.append(pressure_error(solution, form))
        radii.append(np.sqrt((1 - solution.ContactArea()) / np.pi))
    h = [(1.6 / mesh.nv) ** (1 / 3) for mesh in meshes]
    assert np.log(errors[0] / errors[1]) / np.log(h[0] / h[1]) > 0.7 and errors[1] < 0.2
    assert abs(radii[1] - 0.3) < 0.05 and abs(radii[1] - 0.3) < abs(radii[0] - 0.3)


def test_multipliers_are_stable_for_planes_in_any_position():
    """S positive definite, and K - K_γ as coercive as promised, for random planes; condition numbers of S that do not depend on slivers."""
    rng, conditions = np.random.default_rng(5), []
    mesh = cube_mesh(0.35)
    for _ in range(25):
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        origin = rng.uniform(0.3, 0.7, 3)
        axes = np.linalg.svd(normal[None])[2][1:]
        problem = problem_of(mesh, Sheet.Polygon([origin + 3 * (a * axes[0] + b * axes[1]) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]), None)
        S = ReducedProblem(problem).S
        scale = 1 / np.sqrt(np.diag(S))
        values = np.linalg.eigvalsh(S * scale * scale[:, None])
        conditions.append(values[-1] / values[0])
        assert values[0] > 1e-3
    assert max(conditions) < 500
    assert Coercivity(problem_of(COARSE, plane())) >= 0.5 - 1e-8


def test_trace_constants_of_linear_functions():
    """Without modes C_T = (λ_L + 2μ) h_T |S_T| / |larger part|."""
    problem = problem_of(COARSE, plane(0.47, (0.3, -0.2)), None)
    cells = problem.body.Elements(0)
    expected = [(MATERIAL.lam + 2 * MATERIAL.mu) * cell.h * problem.body.FacetArea(cell.element) / max(problem.body.PartSizes(cell.element)) for cell in cells]
    assert np.allclose(trace_constants(problem.V, MATERIAL), expected, rtol=1e-9)
    with_modes = trace_constants(problem_of(COARSE, DISK).V, MATERIAL)
    assert np.isfinite(with_modes).all() and with_modes.max() < 200 * (MATERIAL.lam + 2 * MATERIAL.mu)


def test_loads_supports_gaps_and_reactions():
    """A block on another one: rollers, a traction, the initial gap, springs below; forces and moments balance."""
    mesh = MakeStructured3DMesh(hexes=False, nx=3, ny=3, nz=4)
    body = CrackedMesh(mesh, plane(0.55))
    V = CrackFESpace(body, dirichletx="back", dirichlety="left", dirichletz="top|bottom", front=None, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body), gap=0.01)
    problem.SetDirichlet((None, None, -0.02), "top")
    solution = problem.Solve()
    lateral_free = MATERIAL.E * -0.01  # 0.02 minus the gap, over the height 1
    assert np.allclose(solution.state.L, lateral_free, rtol=1e-10)
    assert np.allclose(solution.state.nodes.Values(solution.gap), 0, atol=1e-12)
    assert np.allclose(solution.Reaction("bottom"), (0, 0, -lateral_free), atol=1e-12) and np.allclose(
        solution.Reaction("top"), (0, 0, lateral_free), atol=1e-12
    )
    assert np.allclose(solution.Reactions().total.force, 0, atol=1e-12) and np.allclose(solution.Reactions().total.moment, 0, atol=1e-12)
    assert solution.Energy() == pytest.approx(0.5 * MATERIAL.E * 0.01**2, rel=1e-9)
    assert solution.Reactions().table.dtype.names == ("support", "F_x", "F_y", "F_z", "M_x", "M_y", "M_z")
    stress = np.array(solution.stress(mesh(0.3, 0.4, 0.2))).reshape(3, 3)
    assert np.allclose(stress, stress_matrix(zz=lateral_free), atol=1e-12)
    assert solution.VonMises()(mesh(0.3, 0.4, 0.2)) == pytest.approx(-lateral_free, rel=1e-10)


def test_tractions_springs_and_pins():
    """A traction on top, springs at the bottom: the pressure is that of the load; reactions with moments."""
    mesh = MakeStructured3DMesh(hexes=False, nx=3, ny=3, nz=4)
    body = CrackedMesh(mesh, plane(0.55))
    V = CrackFESpace(body, front=None, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body))
    u, v = V.TnT()
    problem.a += 100 * u * v * body.ds("bottom")
    problem.a += 100 * (u[0] * v[0] + u[1] * v[1]) * body.ds("top")
    problem.f += CF((0, 0, -0.3)) * v * body.ds("top")
    solution = problem.Solve()
    assert solution.ContactForce() == pytest.approx(-0.3, rel=1e-9) and "held by the faces of cracks alone" in str(solution.report)
    total = solution.Reactions().total
    assert np.allclose(total.force, (0, 0, 0.3), atol=1e-9) and np.allclose(total.moment, (0.15, -0.15, 0), atol=1e-9)
    pinned = ContactProblem(CrackFESpace(body, dirichlet="bottom|top", front=None, material=MATERIAL), TraceSpace(body))
    pinned.Pin((0, 0, 0), "xyz")
    with pytest.raises(ValueError, match="give \\(x, y, z\\)"):
        pinned.Pin((0, 0), "x")


def test_load_steps_and_cases():
    """Linear where contact does not change."""
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(CENTRE)
    problem = problem_of(COARSE, plane(), None, form)
    steps = LoadSteps(problem, [LoadCase(problem)])
    assert steps.Solve(2.0).ContactForce() == pytest.approx(-2, rel=1e-9) and steps.Solve(-1.0).ContactArea() == 0


def test_rigid_motions_are_found():
    body = CrackedMesh(COARSE, plane())
    problem = ContactProblem(CrackFESpace(body, dirichletz="outer", front=None, material=MATERIAL), TraceSpace(body))
    with pytest.raises(SingularSystem, match=r"rigid motion\(s\) of one of the 2 parts into which the cracks divide the body, around \(0.5, 0.5, "):
        problem.Solve()


def test_too_large_a_gamma_is_refused():
    with pytest.raises(SolveError, match="gamma0 = 50"):
        problem_of(COARSE, DISK, stabilisation=BarbosaHughes(gamma0=50)).Solve()


def test_given_displacements_that_contradict():
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2)
    body = CrackedMesh(mesh, plane())
    problem = ContactProblem(CrackFESpace(body, dirichlet="top|left", front=None, material=MATERIAL), TraceSpace(body))
    problem.SetDirichlet((0, 0, 1), "top")
    with pytest.raises(ValueError, match="contradict each other at .*: u_z = "):
        problem.Solve()


def test_the_material_is_given_to_the_problem():
    with pytest.warns(UserWarning, match="no material is given"):
        V = CrackFESpace(body := CrackedMesh(COARSE, DISK), dirichlet="outer")
    ContactProblem(V, TraceSpace(body), MATERIAL)
    assert V.front_spec.materials == [(2.0, 1.0)]


def test_what_is_not_there_in_space():
    """Refused by name before any work."""
    problem = problem_of(COARSE, DISK)
    V, W, body = problem.V, problem.W, problem.body
    assert type(V) is SolidFESpace and type(W) is SheetTraceSpace
    v, refusals = (
        V.TestFunction(),
        [
            (lambda: TraceSpace(body, order=2), ValueError, "take 0, one constant for each element"),
            (lambda: TraceSpace(body, degree=1), TypeError, "there is no argument 'degree'; it takes body and order"),
            (lambda: Interpolant(V, CF((0, 0, 0)), tips=[(1, 0)]), ValueError, "Interpolant: tips= .*plane bodies only"),
            (lambda: problem.f.__iadd__(v[2](0.5, 0.5, 0.9)), ValueError, "distribute the force over a part of the body or of its boundary"),
            (lambda: ContactProblem(V, W, stabilisation=Nitsche()), ValueError, "there for plane bodies only; take BarbosaHughes"),
            (lambda: ContactProblem(V, W, Elasticity.PlaneStrain(E=1, nu=0.3)), ValueError, "is another one than|is a material of the plane"),
            (lambda: ContactProblem(CrackFESpace(body, front=None), W, Elasticity.Solid(E=1, nu=0.49)), ValueError, "nearly incompressible"),
            (lambda: ContactProblem(V, W, initial_stress=CF((1, 0, 0, 1), dims=(2, 2))), ValueError, "initial_stress"),
            (lambda: problem.f.__iadd__(CF((1, 0)) * v * body.dx), Exception, "dim"),
            (lambda: problem.SetDirichlet((0, 0), "outer"), ValueError, "3"),
            (lambda: problem.FacePressure((1, 2, 3)), ValueError, "must be a scalar"),
        ],
    )
    for call, error, message in refusals:
        with pytest.raises(error, match=message):
            call()
    solution = problem.Solve()
    with pytest.raises(ValueError, match="the tube of radius .* meets its own centre of curvature"):
        solution.StressIntensity()  # the mesh is too coarse for it


def test_sizes_beyond_direct_solvers_are_refused(monkeypatch):
    from ngsxfem_contact.contact import solids

    monkeypatch.setattr(solids, "MOST_MULTIPLIERS", 10)
    with pytest.raises(ValueError, match='multipliers are too many for direct solvers.* take inverse="cg"'):
        problem_of(COARSE, DISK).Solve(inverse="sparsecholesky")
