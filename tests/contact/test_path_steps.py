"""Load factors that are found: columns that snap back against closed forms, a specimen that is pulled apart, a block that slides."""

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import CF, x, y
from test_laws import HEIGHT, E, column, softening

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.contact import ExponentialCohesive, Joint, LinearCohesive, LoadCase, MohrCoulomb, PathSteps
from ngsxfem_contact.errors import NotConverged

G_C = 0.05  # at strength 1; H/E is 4 times what the softening could follow without a snap-back


def snapping(law):
    """u_y = t above."""
    problem = column(law, order=2)
    problem.SetDirichlet((0, 1), "top")
    return PathSteps(problem)


@pytest.mark.parametrize("kind", [LinearCohesive, ExponentialCohesive])
def test_a_column_that_snaps_back(kind):
    """Every point on u = f(d) H/E + d, while t falls and rises again; what is dissipated belongs to the opening."""
    f, integral = softening(kind, 1.0, G_C)
    steps, curve, lost = snapping(kind(1.0, G_C)), [], 0.0
    for _ in range(40):
        solution = steps.Solve(0.02)
        profile = solution.Profile(n=5)
        gap, stress = profile.gap[2], profile.sigma_n[2]
        assert np.ptp(profile.gap) < 1e-12 and steps.t == pytest.approx(stress * HEIGHT / E + gap, abs=1e-12)
        if gap > 1e-12:
            assert stress == pytest.approx(f(gap), abs=1e-11)
        curve.append((gap, steps.t))
        lost += solution.DissipatedEnergy()
    gaps, factors = np.array(curve).T
    turn = int(np.argmin(factors + (gaps < 1e-12)))
    assert factors.max() > 0.3 and factors[1] > factors[turn] and turn > 2  # it snaps back, and goes on
    assert lost == pytest.approx(integral(gap) - 0.5 * f(gap) * gap, rel=1e-10) and lost == pytest.approx(G_C, rel=1e-5)


def test_a_specimen_that_snaps_back_costs_its_work_of_separation():
    """Lifted and tilted; the work of the supports by the trapezoidal rule is what the faces dissipate and the body stores, at every step."""
    problem = column(ExponentialCohesive(1.0, G_C), order=2)
    problem.SetDirichlet((0, 0.5 + x), "top")
    steps, work, lost, power, before, factors = PathSteps(problem), 0.0, 0.0, 0.0, 0.0, []
    for _ in range(160):
        solution = steps.Solve(0.005)
        row = next(row for row in solution.Reactions() if row.name == "top")
        new = 0.5 * row.force[1] + row.moment + HEIGHT * row.force[0]  # the moment of the vertical forces alone
        work += 0.5 * (power + new) * (steps.t - before)
        power, before, lost = new, steps.t, lost + solution.DissipatedEnergy()
        factors.append(steps.t)
        assert work == pytest.approx(lost + solution.FaceEnergy() + solution.Energy(), abs=5e-3 * G_C)
    assert np.diff(factors).min() < 0 and lost == pytest.approx(G_C, rel=5e-3)


def test_a_block_that_slides_under_a_fixed_pressure():
    """The shear grows to c + μ p and stays; t is the way that the top has gone then."""
    p, limit = 2.0, 0.2 + 0.3 * 2.0
    body = CrackedMesh(rectangle(0.3), Crack([(0, 0.52), (1, 0.52)]))
    V = CrackFESpace(body, order=2, dirichletx="bottom|top", dirichlety="bottom|top|left|right")
    problem = ContactProblem(V, TraceSpace(body, order=1), Elasticity.PlaneStrain(E=E, nu=0), law=MohrCoulomb(0.3, 0.2))
    problem.SetDirichlet(CF((0, -p / E * y)), "bottom|top")
    problem.SetDirichlet((None, -p / E * y), "left|right")
    fixed = LoadCase(problem)
    problem.SetDirichlet(CF((y, 0)), "bottom|top")
    problem.SetDirichlet((None, 0), "left|right")
    steps, ways = PathSteps(problem, fixed), []
    for step in (0.01, *6 * [0.05]):
        solution = steps.Solve(step)
        profile = solution.Profile(n=3)
        assert steps.t == pytest.approx(profile.sigma_t[1] / (E / 2) + profile.slip[1], abs=1e-12) and profile.sigma_n[1] == pytest.approx(-p)
        ways.append(profile.slip[1])
    assert profile.sigma_t[1] == pytest.approx(limit, abs=1e-11) and ways[-1] - ways[-2] == pytest.approx(0.05) and ways[0] == pytest.approx(0, abs=1e-12)


def test_a_fixed_load_beside():
    """A pressure of a fluid that stays while the top moves: it adds p to the stress."""
    p, k = 0.4, 3.0
    problem = column(Joint(k, 1.0))
    problem.FacePressure(p)
    problem.SetDirichlet((0, 0), "top")
    fixed = LoadCase(problem)
    problem.f = type(problem.f)(problem.V)
    problem.SetDirichlet((0, 1), "top")
    steps = PathSteps(problem, fixed)
    for _ in range(3):
        profile = steps.Solve(0.01).Profile(n=3)
        assert steps.t == pytest.approx((k * profile.gap[1] - p) * HEIGHT / E + profile.gap[1], abs=1e-13)


def test_what_is_refused():
    with pytest.raises(TypeError, match="PathSteps: the law Coulomb.* does not hold node by node; take MohrCoulomb"):
        snapping(Coulomb(0.3))
    with pytest.raises(ValueError, match="PathSteps: step=0 must be positive"):
        snapping(LinearCohesive(1.0, G_C)).Solve(0)
    steps = snapping(ExponentialCohesive(1.0, G_C))
    steps.Solve(0.01)
    with pytest.raises(NotConverged, match="PathSteps: .*take a smaller step"):
        steps.Solve(0.05, max_iterations=1)
