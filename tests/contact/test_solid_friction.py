"""Friction on sheets in space: Tresca's and Coulomb's laws with disks, against closed forms."""

import numpy as np
import pytest
from ngsolve import CF, InnerProduct, Integrate, sqrt
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, Jump, LoadSteps, TraceSpace, Tresca
from ngsxfem_contact.algebra.nodal_methods import FixedPoint
from ngsxfem_contact.exact.pennies import closed_penny
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import FrontDemand, Sheet
from tests.sheets.exact_sheets import cube_mesh

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE = (0.49, 0.51, 0.513)
DISK = Sheet.Disk(CENTRE, (0, 0, 1), 0.3)


def problem_of(mesh, sheet, form, law, **arguments):
    V = CrackFESpace(body := CrackedMesh(mesh, sheet), dirichlet="outer", material=MATERIAL, **arguments)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet(form.u, "outer")
    return problem


def plane(height=0.513):
    return Sheet.Polygon([(-1, -1, height), (2, -1, height), (2, 2, height), (-1, 2, height)])


def test_a_penny_that_slides_against_friction():
    """(3d) with Coulomb's law: all nodes slip along x, λ = -p, |λ_t| = μ_f p, and what is dissipated is μ_f p times the slip."""
    mesh, friction = cube_mesh(0.1), 0.3
    form, area = closed_penny(MATERIAL, 0.3, p=1.0, tau=0.8, friction=friction).At(CENTRE), 0.09 * np.pi
    solution = problem_of(mesh, DISK, form, Coulomb(friction)).Solve()
    assert solution.report.states == {"open": 0, "stick": 0, "slip": 1} and solution.report.iterations <= 8
    assert solution.ContactForce() == pytest.approx(-area, rel=5e-3)
    assert np.allclose(solution.TangentialForce(), (friction * area, 0, 0), atol=5e-3 * area)
    tangential = solution.tangential_multiplier
    difference = tangential - CF((friction, 0, 0))
    measure = solution.body.dcrack
    assert sqrt(Integrate((solution.multiplier + 1) ** 2 * measure, mesh) / area) < 0.1
    assert sqrt(Integrate(InnerProduct(difference, difference) * measure, mesh) / area) < 0.1 * friction
    size = np.hypot(*solution.state.L.reshape(3, -1)[1:])
    assert np.allclose(size, -friction * solution.state.L[: len(size)], rtol=1e-9)
    around = solution.body.dcrack(bonus_intorder=2, fronts=FrontDemand())
    slip = Jump(solution.u)
    error = sqrt(
        Integrate(InnerProduct(slip - form.opening, slip - form.opening) * around, mesh) / Integrate(InnerProduct(form.opening, form.opening) * around, mesh)
    )
    assert error < 0.27
    assert solution.DissipatedEnergy() == pytest.approx(friction * Integrate(slip[0] * around, mesh), rel=0.05)  # the jump that γ sees


@pytest.mark.parametrize("direction", (0.0, 0.6, 2.5))
def test_a_block_that_sticks_and_slips(direction):
    """A sheet through the body under σ_zz = -1 and a shear: below the threshold it sticks, u is linear; the shear in any direction of the plane."""
    c, s = np.cos(direction), np.sin(direction)
    mesh = cube_mesh(0.3)
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1, xz=0.25 * c, yz=0.25 * s)).At(CENTRE)
    for law in (Coulomb(0.3), Tresca(0.26)):
        stuck = problem_of(mesh, plane(), form, law).Solve()
        assert stuck.report.states["stick"] == 1 and np.allclose(stuck.TangentialForce(), (0.25 * c, 0.25 * s, 0), atol=1e-9)
        assert Integrate(InnerProduct(Jump(stuck.u), Jump(stuck.u)) * stuck.body.dcrack, mesh) < 1e-20 and abs(stuck.DissipatedEnergy()) < 1e-12


def sheared_block(law, shear):
    """Two blocks, pressed, the upper one moved along a direction of the plane: everything slips, the force is the threshold."""
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=3)
    body = CrackedMesh(mesh, plane(0.55))
    V = CrackFESpace(body, dirichlet="bottom|top", front=None, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet((*shear, -0.1), "top")
    return problem


def test_slip_has_the_direction_of_the_traction():
    problem = sheared_block(Coulomb(0.2), (0.3, 0.4))
    solution = problem.Solve()
    states, L = solution.report.states, solution.state.L.reshape(3, -1)
    jump, weights = solution.state.history.jump, solution.state.nodes.weights
    assert states["slip"] == 1 and solution.state.L[: L.shape[1]].max() < 0
    assert np.allclose(np.hypot(*L[1:]), -0.2 * L[0], rtol=1e-9)
    assert np.abs(L[1] * jump[2] - L[2] * jump[1]).max() < 1e-9 and (L[1] * jump[1] + L[2] * jump[2]).min() > 0
    force = solution.TangentialForce()
    assert force[1] / force[0] == pytest.approx(4 / 3, rel=0.05) and np.hypot(*force[:2]) == pytest.approx(-0.2 * solution.ContactForce(), rel=0.02)
    assert solution.DissipatedEnergy() == pytest.approx(float((L[1] * jump[1] + L[2] * jump[2]) @ weights), rel=1e-9)
    assert np.allclose(solution.Reaction("top")[:2], force[:2], rtol=1e-6)


def test_a_fixed_point_gives_the_same():
    newton, fixed = (sheared_block(Coulomb(0.2, **method), (0.3, 0.4)).Solve() for method in ({}, {"method": FixedPoint()}))
    assert "fixed point" in fixed.report.method and "Newton" in newton.report.method and len(fixed.report.threshold_changes) > 1
    assert np.allclose(fixed.state.L, newton.state.L, atol=1e-8 * np.abs(newton.state.L).max())


def test_load_steps_remember_slip():
    """Pressed, then sheared, then back: slip is counted from the step before."""
    problem = sheared_block(Tresca(0.05), (0.3, 0.0))
    steps = LoadSteps(problem)
    forward = steps.Solve(1.0)
    again = steps.Solve(1.0)
    back = steps.Solve(0.5)
    assert forward.DissipatedEnergy() > 0 and abs(again.DissipatedEnergy()) < 1e-10 * forward.DissipatedEnergy() and again.report.states["slip"] < 1
    assert back.DissipatedEnergy() > 0 and back.TangentialForce()[0] < 0 < forward.TangentialForce()[0]
    assert forward.TangentialForce()[0] == pytest.approx(0.05, rel=1e-2) and len(steps.table) == 3


def two_pennies(law):
    """Pressed and sheared, one above the other."""
    body = CrackedMesh(cube_mesh(0.15), *(Sheet.Disk((0.5, 0.5, height), (0, 0, 1), 0.25) for height in (0.283, 0.717)))
    problem = ContactProblem(CrackFESpace(body, dirichlet="outer", front=None, material=MATERIAL), TraceSpace(body), law=law)
    problem.SetDirichlet(uniform_stress(MATERIAL, stress_matrix(zz=-1, xz=0.5)).At((0.5, 0.5, 0.5)).u, "outer")
    return problem


def test_each_sheet_its_law():
    """Two sheets with the same law are one law; a law of one sheet acts there, and the other one slides freely or by its own."""
    same, one = two_pennies({0: Coulomb(0.2), 1: Coulomb(0.2)}).Solve(), two_pennies(Coulomb(0.2)).Solve()
    assert np.allclose(same.state.L, one.state.L, rtol=1e-10, atol=1e-12)
    solution = two_pennies({0: Coulomb(0.3), 1: Tresca(0.01)}).Solve()
    L, sheets = solution.state.L.reshape(3, -1), solution.state.nodes.cracks
    size = np.hypot(*L[1:])
    assert np.allclose(size[sheets == 1], 0.01, rtol=1e-9) and np.allclose(size[sheets == 0], -0.3 * L[0, sheets == 0], rtol=1e-9)
    free = two_pennies({0: Coulomb(0.9)}).Solve()
    L = free.state.L.reshape(3, -1)
    assert not L[1:, sheets == 1].any() and np.allclose(np.hypot(*L[1:, sheets == 0]), 0.5, atol=0.05) and abs(free.DissipatedEnergy()) < 1e-9
    assert "Coulomb" in str(free.problem.law)


def test_a_block_that_only_friction_holds():
    """Refused by name."""
    body = CrackedMesh(MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=4), plane(0.3), plane(0.8))
    problem = ContactProblem(CrackFESpace(body, dirichlet="bottom|top", front=None, material=MATERIAL), TraceSpace(body), law=Coulomb(0.2))
    with pytest.raises(ValueError, match="in space a part of the body that only friction holds is not solved for: hold it"):
        problem.Solve()


def test_refused_laws():
    from ngsxfem_contact.contact import LinearCohesive, MohrCoulomb

    body = CrackedMesh(cube_mesh(0.3), plane())
    V, W = CrackFESpace(body, dirichlet="outer", material=MATERIAL), TraceSpace(body)
    for law in (MohrCoulomb(0.3, 0.1), LinearCohesive(1.0, 1.0), {0: LinearCohesive(1.0, 1.0)}):
        with pytest.raises(ValueError, match="there for plane bodies only; in space take None, Tresca"):
            ContactProblem(V, W, law=law)
    with pytest.raises(ValueError, match="no crack 1|the body has 1|1 crack"):
        ContactProblem(V, W, law={1: Coulomb(0.3)})
    problem = ContactProblem(V, W, law=Coulomb(0.3))
    assert str(problem.law) == str(Coulomb(0.3))
    other = problem.Solve()
    again = ContactProblem(CrackFESpace(body, dirichlet="outer", material=MATERIAL), W, law=Coulomb(0.3))
    with pytest.raises(ValueError, match="a history in space stays on its spaces"):
        again.Solve(previous=other)
