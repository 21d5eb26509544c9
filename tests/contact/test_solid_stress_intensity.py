"""K and G along the fronts of solutions in space, against closed forms."""

import numpy as np
import pytest
from ngsolve import CF, Parameter, x, z

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.exact.pennies import bent_penny, closed_penny, penny, penny_in_tension
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import Sheet
from tests.sheets.exact_sheets import cube_mesh

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE, RADIUS = (0.49, 0.51, 0.513), 0.3
MESH = cube_mesh(0.1)


def problem_of(form, order=1, law=None):
    body = CrackedMesh(MESH, Sheet.Disk(CENTRE, (0, 0, 1), RADIUS))
    problem = ContactProblem(CrackFESpace(body, order=order, dirichlet="outer", material=MATERIAL), TraceSpace(body, order=0), law=law)
    problem.SetDirichlet(form.u, "outer")
    return problem


def errors(found, form):
    """Of K_I, K_II, K_III at the nodes, relative to the largest of them."""
    exact = form.Factors(found.points)
    return np.abs(np.column_stack([found.K_I, found.K_II, found.K_III]) - exact).max(axis=0) / np.abs(exact).max()


@pytest.mark.parametrize(("order", "accuracy"), ((1, 0.08), (2, 0.04)))
def test_tension_and_bending(order, accuracy):
    """K_I that varies along the front; what is reported covers the error at nine nodes of ten, and G is Irwin's."""
    form = (penny_in_tension(MATERIAL, RADIUS, 1.0) + bent_penny(MATERIAL, RADIUS, 2.0)).At(CENTRE)
    problem = problem_of(form, order)
    problem.FacePressure(2.0 * (x - CENTRE[0]))
    found = problem.Solve().StressIntensity(0)
    assert errors(found, form).max() < accuracy
    assert np.mean(np.abs(found.K_I - form.Factors(found.points)[:, 0]) <= found.errors[:, 0]) >= 0.9
    assert np.abs(found.G - found.irwin).max() < 0.15 * found.G.max()


def test_a_pressure_on_the_faces_is_a_tension_at_infinity():
    """Two loads with one K."""
    forms = penny(MATERIAL, RADIUS, 1.0).At(CENTRE), penny_in_tension(MATERIAL, RADIUS, 1.0).At(CENTRE)
    problem = problem_of(forms[0])
    problem.FacePressure(1.0)
    pressed, pulled = problem.Solve().StressIntensity(), problem_of(forms[1]).Solve().StressIntensity()
    assert pressed.K_I == pytest.approx(pulled.K_I, rel=2e-3)


def test_a_closed_penny_with_friction():
    """(3d): K_I = 0; K_II and K_III of what friction leaves."""
    form = closed_penny(MATERIAL, RADIUS, p=1.0, tau=0.8, friction=0.4).At(CENTRE)
    solution = problem_of(form, law=Coulomb(0.4)).Solve()
    found = solution.StressIntensity()
    assert np.all(found.K_I == 0) and errors(found, form).max() < 0.1
    table = solution.Table()
    assert len(table) == len(found.s) and table["K_II"] == pytest.approx(found.K_II)


def test_a_body_force():
    """A field without K whose force fills the body: u = (0, 0, z²) beside the uniform stress of a closed crack."""
    smooth, origin = uniform_stress(MATERIAL, stress_matrix(zz=-5.0)).At(CENTRE), CENTRE[2]
    problem = problem_of(smooth)
    problem.SetDirichlet(smooth.u + CF((0, 0, (z - origin) ** 2)), "outer")
    factor = Parameter(1.0)
    problem.f += factor * CF((0, 0, -2 * (MATERIAL.lam + 2 * MATERIAL.mu))) * problem.V.TestFunction() * problem.body.dx
    solution = problem.Solve()
    found = solution.StressIntensity()
    unit = 5.0 * np.sqrt(RADIUS)
    assert np.abs([found.K_II, found.K_III]).max() < 0.01 * unit and np.all(found.K_I == 0)
    assert solution.load.BodyForces()(MESH(0.2, 0.3, 0.4))[2] == pytest.approx(-2 * (MATERIAL.lam + 2 * MATERIAL.mu))
    factor.Set(2.0)
    with pytest.raises(ValueError, match="has changed since the solve"):
        solution.StressIntensity()


def test_what_tips_have_is_refused():
    solution = problem_of(penny_in_tension(MATERIAL, RADIUS).At(CENTRE)).Solve()
    for action in (solution.EnergyReleaseRate, solution.TStress, solution.ErrorEstimate):
        with pytest.raises(ValueError, match="plane bodies only"):
            action()
    with pytest.raises(ValueError, match="front"):
        solution.StressIntensity(3)
