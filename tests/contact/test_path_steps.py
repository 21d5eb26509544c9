"""Load factors that are found: columns that snap back against closed forms, a specimen that is pulled apart, a block that slides."""

import numpy as np
import pytest
from helpers import array, rectangle
from netgen.geom2d import SplineGeometry
from netgen.meshing import MeshingParameters
from ngsolve import CF, IfPos, Mesh, x, y
from test_laws import HEIGHT, E, column, softening

from ngsxfem_contact import BarbosaHughes, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Nitsche, TraceSpace
from ngsxfem_contact.contact import ExponentialCohesive, Joint, LinearCohesive, LoadCase, MohrCoulomb, PathSteps
from ngsxfem_contact.errors import NotConverged

G_C = 0.05  # at strength 1; H/E is 4 times what the softening could follow without a snap-back


def snapping(law, **options):
    """u_y = t above."""
    problem = column(law, order=2, **options)
    problem.SetDirichlet((0, 1), "top")
    return PathSteps(problem)


@pytest.mark.parametrize("kind, method", [(LinearCohesive, BarbosaHughes()), (ExponentialCohesive, BarbosaHughes()), (ExponentialCohesive, Nitsche(-1))])
def test_a_column_that_snaps_back(kind, method):
    """Every point on u = f(d) H/E + d, while t falls and rises again; what is dissipated belongs to the opening."""
    f, integral = softening(kind, 1.0, G_C)
    steps, curve, lost = snapping(kind(1.0, G_C), stabilisation=method), [], 0.0
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


def notched_beam():
    """Three-point bending: a notch of 0.2, and a cohesive ligament above it up to the load; supports at (0, 0) and (4, 0), force 1 at the top."""
    geometry = SplineGeometry()
    corners = ((0, 0), (4, 0), (4, 1), (2.1, 1), (1.9, 1), (0, 1))
    points = [geometry.AppendPoint(*corner) for corner in corners]
    for i in range(6):
        geometry.Append(["line", points[i], points[(i + 1) % 6]], bc="load" if i == 3 else "free")
    sizes = MeshingParameters(maxh=0.25, grading=0.2)
    for height in np.arange(0, 1.01, 0.04):
        sizes.RestrictH(x=2.013, y=float(height), z=0, h=0.04)
    body = CrackedMesh(Mesh(geometry.GenerateMesh(mp=sizes)), Crack([(2.013, 0), (2.013, 0.97)]))
    V = CrackFESpace(body, order=2, tip=None)
    law = LinearCohesive(IfPos(y - 0.2, 1.0, 0.0), 4e-4)
    problem = ContactProblem(V, TraceSpace(body, order=0), Elasticity.PlaneStress(1000, 0.2), law=law)
    problem.Pin((0, 0), "xy")
    problem.Pin((4, 0), "y")
    problem.f += CF((0, -5)) * V.TestFunction() * body.ds("load")
    return problem


@pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # a tip without functions, which stays closed until the end
def test_a_notched_beam_in_bending():
    """Node after node breaks, the load rises and falls: at every step its work is what the beam stores and its faces have cost."""
    steps, work, lost, last, loads = PathSteps(notched_beam()), 0.0, 0.0, (0.0, 0.0), []
    for _ in range(130):
        solution = steps.Solve(5e-5)
        way = float(array(solution.u.vec) @ solution.case.F) / steps.t
        work += 0.5 * (steps.t + last[0]) * (way - last[1])
        last, lost = (steps.t, way), lost + solution.DissipatedEnergy()
        loads.append(steps.t)
        assert work == pytest.approx(lost + solution.FaceEnergy() + solution.Energy(), abs=5e-7)
    assert loads[-1] < 0.2 * max(loads) < 0.2 * 0.8**2 / 2 / 0.975  # less than if the whole ligament pulled at its strength
    broken = solution.report.states["broken"]  # of the nodes, 0.21 of which belong to the notch
    assert 0.5 < broken and lost < 4e-4 * 0.77


@pytest.mark.parametrize("law, cohesion", [(MohrCoulomb(0.3, 0.2), 0.2), (Coulomb(0.3), 0.0)])
def test_a_block_that_slides_under_a_fixed_pressure(law, cohesion):
    """The shear grows to c + μ p and stays; t is the way that the top has gone then."""
    p, limit = 2.0, cohesion + 0.3 * 2.0
    body = CrackedMesh(rectangle(0.3), Crack([(0, 0.52), (1, 0.52)]))
    V = CrackFESpace(body, order=2, dirichletx="bottom|top", dirichlety="bottom|top|left|right")
    problem = ContactProblem(V, TraceSpace(body, order=1), Elasticity.PlaneStrain(E=E, nu=0), law=law)
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


def test_a_path_goes_on_from_damage():
    """Damaged by steps, then along the path on spaces made anew: by the secant to the largest opening so far, and on the softening branch after it."""
    law = ExponentialCohesive(1.0, G_C)
    f, _ = softening(ExponentialCohesive, 1.0, G_C)
    before = snapping(law)
    damaged = [before.Solve(0.02) for _ in range(8)][-1]
    largest = damaged.Profile(n=5).gap[2]
    steps, seen = PathSteps(snapping(law).reduced.problem, previous=damaged), set()
    for _ in range(10):
        profile = steps.Solve(0.25 * largest).Profile(n=5)
        gap, stress = profile.gap[2], profile.sigma_n[2]
        seen.add(bool(gap > largest))
        assert stress == pytest.approx(f(max(gap, largest)) * min(gap / largest, 1), abs=1e-11)
        assert steps.t == pytest.approx(stress * HEIGHT / E + gap, abs=1e-12)
    assert largest > 0.02 and seen == {False, True}


def test_what_is_refused():
    with pytest.raises(TypeError, match="PathSteps: faces that only touch, Frictionless.*, hold nothing that could give way; take friction"):
        snapping(None)
    with pytest.raises(ValueError, match="PathSteps: step=0 must be positive"):
        snapping(LinearCohesive(1.0, G_C)).Solve(0)
    steps = snapping(ExponentialCohesive(1.0, G_C))
    steps.Solve(0.01)
    with pytest.raises(NotConverged, match="PathSteps: .*take a smaller step"):
        steps.Solve(0.05, max_iterations=1)
    with pytest.raises(ValueError, match="PathSteps: the problem holds no load and no displacement whose factor could be found"):
        PathSteps(column(ExponentialCohesive(1.0, G_C)))
