"""The forces of the supports: statics, balance with the loads, and what the stress says."""

import numpy as np
import pytest
from helpers import rectangle
from netgen.geom2d import SplineGeometry
from ngsolve import BND, CF, IfPos, Integrate, Mesh, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import BarbosaHughes, ContactProblem, Coulomb, LoadSteps, Nitsche
from ngsxfem_contact.errors import SingularSystem
from ngsxfem_contact.geometry import Sheet
from tests.sheets.exact_sheets import cube_mesh

MATERIAL = Elasticity.PlaneStrain(E=3, nu=0.3)
MESH = rectangle(0.3)
CRACK = Crack([(0, 0.47), (0.5, 0.52)])
METHODS = [dict(stabilisation=BarbosaHughes()), dict(stabilisation=Nitsche(theta=-1)), dict(law=Coulomb(0.3)), dict(stabilisation=Nitsche(), law=Coulomb(0.3))]


def loaded(order=1, mesh=MESH, crack=CRACK, tip=TipEnrichment(material=MATERIAL, r1=0.3), held=None, **options):
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=order, tip=tip, **(held or {}))
    problem = ContactProblem(V, TraceSpace(body, order=0), MATERIAL, **options)
    v = V.TestFunction()
    problem.f += CF((0.3 * y, 1 - 3 * x)) * v * body.ds("top", bonus_intorder=4) + CF((x * y, -0.2 * y)) * v * body.dx(bonus_intorder=4)
    return problem


def resultants(mesh, top="top"):
    """Force and moment about the origin of the loads above, by quadrature on the uncracked body."""
    on_top, inside = CF((0.3 * y, 1 - 3 * x)), CF((x * y, -0.2 * y))
    arm = CF((-y, x))
    ds = mesh.Boundaries(top)
    force = np.array(Integrate(on_top, mesh, BND, definedon=ds)) + np.array(Integrate(inside, mesh))
    return force, Integrate(on_top * arm, mesh, BND, definedon=ds) + Integrate(inside * arm, mesh)


def check_balance(solution, factor=1.0):
    total = solution.Reactions().total
    force, moment = resultants(solution.body.mesh)
    assert total.force == pytest.approx(-factor * force, abs=1e-10) and total.moment == pytest.approx(-factor * moment, abs=1e-10)


@pytest.mark.parametrize("method", METHODS, ids=lambda m: ", ".join(type(v).__name__ for v in m.values()))
@pytest.mark.parametrize(
    ("order", "held"), [(1, dict(dirichlet="left|bottom")), (2, dict(dirichlet="left")), (3, dict(dirichletx="left|right", dirichlety="bottom"))]
)
def test_reactions_and_loads_are_in_balance(order, held, method):
    """Also at a mouth on a held side, with common corners."""
    check_balance(loaded(order, held=held, **method).Solve())


def test_given_displacements_pins_and_steps():
    problem = loaded(2, held=dict(dirichlet="bottom", dirichletx="left"))
    problem.SetDirichlet((0.01 * x, 0.02 * x * (1 - x)), "bottom")
    problem.SetDirichlet((0.01 * y * (1 - y), None), "left")
    problem.Pin((1, 1), "y", 0.1)
    check_balance(problem.Solve())
    steps = LoadSteps(problem)
    solutions = [steps.Solve(t) for t in (0.5, 2)]
    for solution, t in zip(solutions, (0.5, 2)):
        check_balance(solution, t)


def test_supports_of_a_beam():
    """Three pins: statics alone gives their forces."""
    problem = loaded(2)
    for point, components in (((0, 0), "xy"), ((1, 0), "y")):
        problem.Pin(point, components)
    solution = problem.Solve()
    force, moment = resultants(MESH)
    assert solution.Reaction((1, 0)) == pytest.approx((0, -moment), abs=1e-10)
    assert solution.Reaction((0, 0)) == pytest.approx((-force[0], moment - force[1]), abs=1e-10)
    assert solution.Reaction("bottom|left") == pytest.approx((0, 0))


def test_the_table():
    problem = loaded(held=dict(dirichlet="bottom"))
    problem.Pin((1, 1), "x")
    table = problem.Solve().Reactions()
    assert [row.name for row in table] == ["bottom", "pin at (1, 1)"] and table[1].force[1] == 0 and table[1].moment == pytest.approx(-table[1].force[0])
    assert [line.split()[0] for line in str(table).splitlines()] == ["support", "bottom", "pin", "all"]


@pytest.mark.parametrize("order", [1, 2])
def test_a_corner_is_divided_as_the_tractions_are(order):
    """Under constant stress each side carries its own traction, whatever the elements at the corners."""
    strain = np.array([[-0.1, -0.02], [-0.02, -0.05]])
    body = CrackedMesh(MESH, Crack([(0.3, 0.5), (0.7, 0.5)]))
    problem = ContactProblem(CrackFESpace(body, order=order, tip=None, dirichlet=".*"), TraceSpace(body), MATERIAL, law=Coulomb(10))
    problem.SetDirichlet(CF((strain[0, 0] * x + strain[0, 1] * y, strain[1, 0] * x + strain[1, 1] * y)), ".*")
    solution, sigma = problem.Solve(), MATERIAL.lam * np.trace(strain) * np.eye(2) + 2 * MATERIAL.mu * strain
    for side, normal in (("left", (-1, 0)), ("top", (0, 1)), ("right|top", (1, 1)), (".*", (0, 0))):
        assert solution.Reaction(side) == pytest.approx(sigma @ normal, abs=1e-9)
    moments = {row.name: row.moment for row in solution.Reactions()}
    assert moments["top"] == pytest.approx(0.5 * sigma[1, 1] - sigma[0, 1], abs=1e-9)


def test_against_the_stress_on_a_roller():
    """Uniaxial tension: the roller below pulls with -σ, the one on the left with nothing."""
    body = CrackedMesh(MESH, Crack([(0.5, 0.2), (0.5, 0.6)]))  # along the tension
    V = CrackFESpace(body, order=2, tip=None, dirichlety="bottom", dirichletx="left")
    problem = ContactProblem(V, TraceSpace(body), MATERIAL)
    problem.f += CF((0, 0.7)) * V.TestFunction() * body.ds("top")
    table = problem.Solve().Reactions()
    assert [list(row.force) for row in table] == [pytest.approx([0, -0.7]), pytest.approx([0, 0], abs=1e-12)]
    assert table[0].moment == pytest.approx(-0.35)


def test_the_moment_on_a_curved_boundary():
    geometry = SplineGeometry()
    geometry.AddCircle((0.5, 0.2), 1, bc="outer")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.5))
    mesh.Curve(2)
    body = CrackedMesh(mesh, Crack([(0.2, 0.2), (0.8, 0.3)]))
    V = CrackFESpace(body, order=2, tip=None, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body), MATERIAL)
    problem.f += CF((1 + y, x * x)) * V.TestFunction() * body.dx(bonus_intorder=4)
    total = problem.Solve().Reactions().total
    load = CF((1 + y, x * x))
    assert total.force == pytest.approx(-np.array(Integrate(load, mesh, order=8)), abs=1e-9)
    assert total.moment == pytest.approx(-Integrate(load * CF((-y, x)), mesh, order=8), abs=1e-9)


def test_places_that_are_none():
    problem = loaded(held=dict(dirichlet="bottom"))
    problem.Pin((1, 1), "x")
    solution = problem.Solve()
    with pytest.raises(ValueError, match="Reaction: region='lid' matches no boundary"):
        solution.Reaction("lid")
    for place in ((0, 1), 3, None, (1, 1, 0)):
        with pytest.raises(ValueError, match=r"is neither the name of a boundary nor the point of a pin; there are \[\(1.0, 1.0\)\]"):
            solution.Reaction(place)


# Springs


def bed(u, v, body, stiffness=2.0):
    return stiffness * (1 + x) * u * v * body.ds("bottom", bonus_intorder=2)


@pytest.mark.parametrize("method", METHODS[:2], ids=["BarbosaHughes", "Nitsche"])
def test_a_body_on_springs_alone(method):
    problem = loaded(2, **method)
    u, v = problem.V.TnT()
    problem.a += bed(u, v, problem.body)
    solution = problem.Solve()
    (row,) = solution.Reactions()
    assert row.name == "springs and joints"
    forces = [-Integrate(2 * (1 + x) * solution.u[k] * problem.body.ds("bottom", bonus_intorder=4), MESH) for k in range(2)]
    assert row.force == pytest.approx(forces, rel=1e-9)
    check_balance(solution)


def test_springs_and_supports():
    problem = loaded(2, held=dict(dirichlet="left"))
    u, v = problem.V.TnT()
    problem.a += bed(u, v, problem.body) + 0.5 * u * v * problem.body.dx
    problem.a += 3 * Jump(u) * Jump(v) * problem.body.dcrack  # holds nothing
    solution = problem.Solve()
    assert [row.name for row in solution.Reactions()] == ["left", "springs and joints"]
    check_balance(solution)


def test_springs_that_leave_a_motion_free():
    problem = loaded(1)
    u, v = problem.V.TnT()
    problem.a += u[1] * v[1] * problem.body.ds("bottom")
    with pytest.raises(SingularSystem, match="1 rigid motion"):
        problem.Solve()
    problem.a += 1e-3 * u[0] * v[0] * problem.body.ds("top")
    check_balance(problem.Solve())


def test_a_joint_holds_a_part_that_a_crack_cuts_off():
    body = CrackedMesh(MESH, Crack([(0, 0.47), (1, 0.52)]))
    V = CrackFESpace(body, order=1, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, order=0), MATERIAL)
    u, v = V.TnT()
    problem.f += CF((0.1, 1)) * v * body.ds("top")
    with pytest.raises(SingularSystem, match="1 rigid motion"):
        problem.Solve()
    problem.a += 0.5 * Jump(u) * Jump(v) * body.dcrack
    assert problem.Solve().Reactions().total.force == pytest.approx((-0.1, -1))


@pytest.mark.parametrize("height", [0.3, 0.7])
@pytest.mark.parametrize("turn", [1, -1])
def test_springs_hold_one_side_of_a_crack_only(height, turn):
    """On the left, above the crack; the part below is free, whichever is larger and wherever the normal points."""
    body = CrackedMesh(MESH, Crack([(0, height), (1, height + 0.02)][::turn]))
    V = CrackFESpace(body, order=1)
    problem = ContactProblem(V, TraceSpace(body, order=0), MATERIAL)
    u, v = V.TnT()
    problem.a += IfPos(y - height, 1, 0) * u * v * body.ds("left|top")
    with pytest.raises(SingularSystem, match=r"1 rigid motion\(s\) of one of the 2 parts .* around \(0.5, 0.[123456]"):
        problem.Solve()


def test_springs_that_resist_by_round_off_only():
    problem = loaded(1)
    u, v = problem.V.TnT()
    n = CF((1e-17, 1))
    problem.a += (u * n) * (v * n) * problem.body.ds("bottom|top")
    with pytest.raises(SingularSystem, match="1 rigid motion"):
        problem.Solve()


def test_pins_one_above_the_other():
    """In space: three pins that statics alone loads, of which two differ in z only."""
    body = CrackedMesh(cube_mesh(0.4), Sheet.Disk((0.5, 0.5, 0.5), (0, 0, 1), 0.3))
    V = CrackFESpace(body, order=1, front=None, material=Elasticity.Solid(1, 0.3))
    problem = ContactProblem(V, TraceSpace(body))
    pins = {(0, 0, 0): "xyz", (0, 0, 1): "xy", (1, 0, 0): "y"}
    for point, components in pins.items():
        problem.Pin(point, components)
    problem.f += CF((1, 0, 0)) * V.TestFunction() * body.dx
    solution = problem.Solve()
    exact = [(-0.5, -0.5, 0), (-0.5, 0, 0), (0, 0.5, 0)]
    for point, force in zip(pins, exact):
        assert solution.Reaction(point) == pytest.approx(force, abs=1e-10)
    assert [row.name for row in solution.Reactions()] == ["pin at (0, 0, 0)", "pin at (0, 0, 1)", "pin at (1, 0, 0)"]
