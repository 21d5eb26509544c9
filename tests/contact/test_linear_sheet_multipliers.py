"""Multipliers of order 1 on sheets in space: what their functions are, contact and friction against closed forms, and what reads them."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, IfPos, InnerProduct, Integrate, sqrt, x, y, z
from ngsolve.meshes import MakeStructured3DMesh
from saved_cases import same

from ngsxfem_contact import ContactProblem, ContactSolution, Coulomb, CrackedMesh, CrackFESpace, Elasticity, Jump, LoadCase, LoadSteps, TraceSpace, Tresca
from ngsxfem_contact.exact.pennies import closed_penny, partially_closed
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import FrontDemand, Sheet
from ngsxfem_contact.points import mesh_points
from ngsxfem_contact.spaces import FrontEnrichment, LinearSheetTraceSpace
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE = (0.49, 0.51, 0.513)
DISK = Sheet.Disk(CENTRE, (0, 0, 1), 0.3)
COARSE, MEDIUM, FINE = cube_mesh(0.25), cube_mesh(0.13), cube_mesh(0.1)


def plane(height=CENTRE[2], tilt=(0.0, 0.0)):
    """A sheet through the whole cube."""
    return Sheet.Polygon([(a, b, height + tilt[0] * (a - 0.5) + tilt[1] * (b - 0.5)) for a, b in ((-1, -1), (2, -1), (2, 2), (-1, 2))])


def problem_of(mesh, sheets, u, law=None, front=FrontEnrichment(), order=1, multipliers=1):
    V = CrackFESpace(body := CrackedMesh(mesh, *sheets), order=order, dirichlet="outer", front=front, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, order=multipliers), law=law)
    problem.SetDirichlet(u, "outer")
    return problem


def largest(function, body):
    """Of absolute values at the points of a rule on the sheets."""
    return np.abs(function(points_on(body))).max()


def points_on(body):
    element, xi, eta, zeta, *_ = body.dcrack.Points(4)
    return mesh_points(body.mesh, element, xi, eta, zeta)


SQUARE = Sheet.Polygon([(0.25, 0.25, 0.5), (0.75, 0.25, 0.5), (0.75, 0.75, 0.5), (0.25, 0.75, 0.5)])
CUBES = MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)


@pytest.mark.parametrize("mesh, sheets", ((COARSE, [plane(0.3), plane(0.72)]), (COARSE, [plane(0.47, (0.3, -0.2))]), (CUBES, [SQUARE])))
def test_the_functions(mesh, sheets):
    """Linear functions with the values at the nodes, also on faces of the mesh; their integrals, and how nodes hang together."""
    W = TraceSpace(body := CrackedMesh(mesh, *sheets), order=1)
    assert type(W) is LinearSheetTraceSpace and W.ndof == len(nodes := W.nodes) == len(nodes.positions)
    linear, at_nodes = 0.3 + x - 2 * y + 0.5 * z, nodes.positions @ (1, -2, 0.5) + 0.3
    function = GridFunction(W)
    function.vec.FV().NumPy()[:] = at_nodes
    assert largest(function - linear, body) < 1e-12
    assert np.allclose(nodes.Values(function), at_nodes, atol=1e-12) and np.allclose(nodes.Values(linear), at_nodes, atol=1e-12)
    assert nodes.weights.sum() == pytest.approx(Integrate(1 * body.dcrack, mesh)) and nodes.weights.min() > 0
    assert np.allclose(nodes.mass.sum(axis=1), nodes.weights) and np.linalg.eigvalsh(nodes.mass)[0] > 0
    assert set(nodes.cracks) == set(range(len(sheets))) and (nodes.cracks[nodes.neighbours[:, 0]] == nodes.cracks[nodes.neighbours[:, 1]]).all()
    assert np.unique(np.sort(nodes.neighbours, axis=1), axis=0).shape == nodes.neighbours.shape and set(nodes.neighbours.ravel()) == set(range(len(nodes)))
    polygons, means = nodes.polygons
    assert np.allclose(means @ at_nodes, polygons.Means(linear), atol=1e-10) and np.allclose(means.sum(axis=1), 1)
    assert "sheet 0" in nodes.Place(0)


def test_fronts():
    """Nodes are on the sheet; a linear function is exact where no front is near, the sum of all is 1, and values lie between those of nodes."""
    W = TraceSpace(body := CrackedMesh(MEDIUM, DISK), order=1)
    nodes, function = W.nodes, GridFunction(W)
    assert (np.linalg.norm(nodes.positions - CENTRE, axis=1) < 0.3).all() and np.allclose(nodes.positions[:, 2], CENTRE[2])
    assert nodes.weights.sum() == pytest.approx(0.09 * np.pi) and nodes.weights.min() > 1e-3 * nodes.weights.mean()
    values = function.vec.FV().NumPy()
    values[:] = nodes.positions[:, 0]
    points, cut = points_on(body), [cell.element for cell in body.Elements(0) if cell.kind.name == "Cut"]
    off = np.abs((function - x)(points)).ravel()
    assert off[np.isin(points["nr"], cut)].max() < 1e-12 and off.max() < 0.13
    assert function(points).max() <= values.max() + 1e-12 and function(points).min() >= values.min() - 1e-12
    values[:] = 1
    assert np.allclose(function(points), 1)


def test_a_sheet_narrower_than_the_elements():
    """Where no corner of a polygon is on the sheet there is one constant: the pressure is exact on a strip."""
    strip = Sheet.Polygon([(0.2, 0.5, 0.513), (0.8, 0.5, 0.513), (0.8, 0.53, 0.513), (0.2, 0.53, 0.513)])
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(CENTRE)
    solution = problem_of(COARSE, [strip], form.u, front=None).Solve()
    assert np.allclose(solution.state.L, -1, atol=1e-10) and solution.ContactArea() == pytest.approx(0.6 * 0.03)
    assert set(solution.Profile().state) == {"contact"}


def test_a_partially_closed_crack():
    """(3g): the pressure is of first order, more accurate than constants; its region ends within a third of an edge of where it should."""
    form, errors, h = partially_closed(MATERIAL, 0.3).At(CENTRE), {0: [], 1: []}, (0.22, 0.11)
    for maxh in h:
        for multipliers in (0, 1):
            problem = problem_of(cube_mesh(maxh), [plane()], form.u, front=None, multipliers=multipliers)
            solution, mesh = problem.Solve(), problem.body.mesh
            around = problem.body.dcrack(bonus_intorder=4)
            errors[multipliers].append(sqrt(Integrate((solution.multiplier - form.pressure) ** 2 * around, mesh) / Integrate(form.pressure**2 * around, mesh)))
        radius = np.sqrt((1 - Integrate(IfPos(-1e-12 - solution.multiplier, 1, 0) * around, mesh)) / np.pi)
        assert abs(radius - 0.3) < maxh / 3 and solution.report.iterations <= 8
        assert solution.state.L.max() <= 0 and solution.multiplier(points_on(problem.body)).max() <= 1e-14  # at nodes, so everywhere
    assert np.log(errors[1][0] / errors[1][1]) / np.log(2) > 0.8 and (np.array(errors[1]) < 0.8 * np.array(errors[0])).all()


@pytest.mark.parametrize("friction", (0.0, 0.3))
def test_a_closed_penny(friction):
    """(3d): all in contact, a more accurate pressure and the same slip as with constants; |λ_t| ≤ μ_f |λ| at each point."""
    form = closed_penny(MATERIAL, 0.3, p=1.0, tau=0.8, friction=friction).At(CENTRE)
    law, errors, slips = Coulomb(friction) if friction else None, [], []
    for multipliers in (0, 1):
        solution = problem_of(FINE, [DISK], form.u, law, front=FrontEnrichment(radius=0.15), multipliers=multipliers).Solve()
        body, measure = solution.body, solution.body.dcrack(bonus_intorder=2, fronts=FrontDemand())
        area, slip = Integrate(1 * measure, FINE), Jump(solution.u)
        assert solution.report.Counts().get("open", 0) == 0 and solution.report.iterations <= 8
        errors.append(sqrt(Integrate((solution.multiplier + 1) ** 2 * measure, FINE) / area))
        slips.append(Integrate(slip[0] * measure, FINE) / Integrate(form.opening[0] * measure, FINE))
    assert errors[1] < 0.9 * errors[0] < 0.11 and slips[1] == pytest.approx(slips[0], rel=0.01) and 0.75 < slips[1] < 1
    if friction:
        tangential, points = solution.tangential_multiplier, points_on(body)
        excess = np.linalg.norm(tangential(points), axis=1) + friction * solution.multiplier(points).ravel()
        assert excess.max() < 1e-10 and np.allclose(solution.TangentialForce(), (friction * area, 0, 0), atol=0.02 * area)
        assert solution.DissipatedEnergy() == pytest.approx(friction * Integrate(slip[0] * measure, FINE), rel=0.1)


def test_a_block_that_sticks():
    """A shear below the threshold: u is linear, λ_t is the shear, in the plane of a tilted sheet, too."""
    sheet = plane(0.47, (0.3, -0.2))
    stress = stress_matrix(zz=-1, xz=0.1)
    solution = problem_of(COARSE, [sheet], uniform_stress(MATERIAL, stress).At((0, 0, 0)).u, Tresca(0.5), front=None).Solve()
    axes = np.array([*sheet.axes, sheet.normal])
    traction = axes @ np.asarray(stress) @ axes[2]
    assert np.allclose(solution.state.L.reshape(3, -1).T, traction[[2, 0, 1]], atol=1e-9) and solution.report.states["stick"] == 1
    profile = solution.Profile()
    assert np.allclose(np.column_stack([profile.sigma_t_1, profile.sigma_t_2, profile.sigma_n]), traction, atol=1e-9) and set(profile.state) == {"stick"}
    assert Integrate(InnerProduct(Jump(solution.u), Jump(solution.u)) * solution.body.dcrack, COARSE) < 1e-20


def test_cones():
    """M₁*⁻ asks less: pressure may be positive at a node; both keep the mean gap from closing beyond contact."""
    form = partially_closed(MATERIAL, 0.3).At(CENTRE)
    problem = problem_of(MEDIUM, [plane()], form.u, front=None)
    pointwise = problem.Solve()
    weak = problem.Solve(cone="weak")
    mass = weak.state.nodes.mass
    assert (mass @ weak.state.L).max() < 1e-12 and weak.state.L.max() > pointwise.state.L.max() - 1e-15
    assert weak.ContactForce() == pytest.approx(pointwise.ContactForce(), rel=0.02)


def test_tables_edges_and_reactions():
    """Forces of polygons add up, the edge of contact is a closed line near the circle, and the body is in balance."""
    form = partially_closed(MATERIAL, 0.3).At(CENTRE)
    solution = problem_of(MEDIUM, [plane()], form.u, front=None).Solve()
    profile, edge = solution.Profile(), solution.Transitions()
    assert (profile.sigma_n * profile.area).sum() == pytest.approx(solution.ContactForce())
    assert profile.area[profile.state == "contact"].sum() == pytest.approx(solution.ContactArea(), rel=0.05)
    assert abs(np.linalg.norm(edge.mean(axis=1) - CENTRE, axis=1).mean() - 0.3) < 0.05
    _, count = np.unique(edge.reshape(-1, 3).round(9), axis=0, return_counts=True)
    assert set(count % 2) == {0}
    assert np.allclose(solution.Reactions().total.force, 0, atol=1e-10)


def test_two_sheets_with_laws_of_their_own():
    """Blocks that are pressed and sheared: the one without friction has no λ_t."""
    u = CF((0.01 * z, 0, -0.1 * z))
    solution = problem_of(COARSE, [plane(0.3), plane(0.72)], u, {0: Coulomb(0.3), 1: None}, front=None).Solve()
    size = np.hypot(*solution.state.L.reshape(3, -1)[1:])
    cracks = solution.state.nodes.cracks
    assert size[cracks == 0].max() > 0.01 and size[cracks == 1].max() < 1e-12


def test_steps_and_files(tmp_path):
    """A history goes on, here and from a file; pictures and VTK files are made."""
    problem = problem_of(COARSE, [plane()], CF((0.05 * z, 0, -0.1 * z)), Coulomb(0.2), front=None)
    steps = LoadSteps(problem, [LoadCase(problem)])
    first = steps.Solve(0.5)
    first.Save(tmp_path / "first")
    again = ContactSolution.Load(tmp_path / "first")
    assert type(again.problem.W) is LinearSheetTraceSpace
    same(first.state.L, again.state.L)
    direct = problem.Solve(previous=first)
    assert np.allclose(again.problem.Solve(previous=again).ContactForce(), direct.ContactForce(), rtol=1e-9)
    assert first.SaveVTK(str(tmp_path / "block.vtu")).endswith("block.vtu")


def test_what_is_refused():
    problem = problem_of(COARSE, [plane()], CF((0, 0, -0.1 * z)), front=None)
    with pytest.raises(ValueError, match="multipliers of order 1 are not eliminated node by node; take TraceSpace"):
        problem.Solve(inverse="cg")
    for order in (2, -1, 0.5):
        with pytest.raises(ValueError, match="is not there for bodies in space"):
            TraceSpace(problem.body, order=order)
    for arguments in ({"basis": "trace"}, {"nodes": [[0, 1]]}):
        with pytest.raises(ValueError, match="the mesh gives the nodes"):
            TraceSpace(problem.body, **arguments)
