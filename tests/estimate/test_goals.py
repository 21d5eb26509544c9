"""Quantities, their derivatives, and how far they are off."""

import numpy as np
import pytest
from helpers import MATERIAL, rectangle, rotated_problem
from ngsolve import CF, Integrate, LinearForm, x

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, LoadCase, LoadSteps, Nitsche, TipEnrichment, TraceSpace, Tresca
from ngsxfem_contact.algebra.matrices import mask
from ngsxfem_contact.contact import Joint
from ngsxfem_contact.estimate import ContactEdge, ContactForce, ContactPressure, Displacement, StressIntensityFactor
from ngsxfem_contact.estimate.contact_pressure import NEAR, over_disks
from ngsxfem_contact.estimate.goals import moments
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.fracture.tip_integral import elements_within
from study.paper import PAIRS
from study.shapes import SHAPES, body_mesh, shape_problem

TIP = TipEnrichment(material=MATERIAL)
GOALS = [StressIntensityFactor("K_I"), StressIntensityFactor("K_II"), ContactForce(), ContactEdge(), Displacement("top", "y"), Displacement("right", "x")]

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


def problem_of(law=None, stabilisation=None, load=0.0):
    """A crack that is pressed on the left, and opens near its tip; load: an additional pull."""
    body = CrackedMesh(rectangle(0.11), Crack([(0, 0.52), (0.53, 0.55)]))
    V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, order=1), law=law, **({} if stabilisation is None else {"stabilisation": stabilisation}))
    problem.f += CF((-0.01, 0.1 * (x - 0.5 + load))) * V.TestFunction() * body.ds("top")
    return problem


LAWS = {"frictionless": {}, "Coulomb": {"law": Coulomb(0.4)}, "Tresca": {"law": Tresca(0.003)}, "Nitsche": {"stabilisation": Nitsche(0)}}


@pytest.mark.parametrize("name", LAWS)
def test_the_adjoint_is_the_derivative_by_the_load(name):
    """d/dt of J for the load F + tG, G pressing on the right: z·G, beside differences with the same states."""
    problem, step = problem_of(**LAWS[name]), 1e-5
    first = LoadCase(problem)
    problem.f = LinearForm(problem.V)
    problem.f += CF((0.02, -0.03)) * problem.V.TestFunction() * problem.body.ds("right")
    second = LoadCase(problem)
    steps = LoadSteps(problem, [first, second])
    near = [steps.Solve(1.0, t, previous=None) for t in (-step, 0.0, step)]
    states = [tuple(solution.report.active[-1]) for solution in near]
    assert len(set(states)) == 1 and 0 < sum(states[0]) < len(states[0])
    for goal in GOALS:
        expected = (goal.Value(near[2]) - goal.Value(near[0])) / (2 * step)
        z, _ = near[1].reduced.Adjoint(near[1], goal.OfDisplacement(near[1], problem.V), goal.OfMultipliers(near[1]))
        assert z @ second.F == pytest.approx(expected, rel=2e-3, abs=1e-7) and (expected or str(goal).startswith("K_I "))


@pytest.mark.parametrize("pair", ["P2/P1", "P1/P1", "P2/P0"])
def test_k_on_closed_forms(pair):
    """The error with its sign: most of it, where contributions do not cancel."""
    for exact, name in ((cf.open_tip(MATERIAL), "K_I"), (cf.slipping_tip(MATERIAL), "K_II")):
        goal = rotated_problem(exact, PAIRS[pair], 0.08, tip=TIP).Solve().ErrorEstimate().Goal(StressIntensityFactor(name))
        assert abs(1 - goal.corrected) < 0.25 * (abs(1 - goal.value) + goal.bar)
        assert abs(1 - goal.value) < goal.bar < 0.05 and goal.elements.sum() > abs(goal.error)
        assert name in repr(goal)


def test_shapes():
    """Contact force and K of two cracks beside boundary-fitted solutions."""
    shape = SHAPES["two-cracks"]
    estimate = shape_problem("two-cracks", body_mesh(0.08)).Solve().ErrorEstimate()
    for tip, (_, K_II) in enumerate(shape.K):
        goal = estimate.Goal(StressIntensityFactor("K_II", tip))
        assert abs(K_II - goal.corrected) < 0.4 * abs(K_II - goal.value) < 0.4 * goal.bar < 0.01
        assert estimate.Goal(StressIntensityFactor("K_I", tip)).bar == 0  # the faces touch
        force = estimate.Goal(ContactForce(tip))
        assert abs(shape.contact_force[tip] - force.value) < force.bar < 0.1 * abs(force.value)


def test_the_edge_of_contact():
    """Of (d), whose pressure is a square root: nearer than the node, and the moments are exact for √t (c_0 + c_1 t)."""
    exact = cf.contact_transition(MATERIAL)
    for maxh in (0.1, 0.05):
        solution = rotated_problem(exact, PAIRS["P2/P1"], maxh, through=True).Solve()
        true = solution.body.cracks[0].ArcLength((0, 0))
        goal = solution.ErrorEstimate().Goal(ContactEdge())
        assert abs(goal.value - true) < 0.1 * maxh
    window = ContactEdge()._window(solution)
    t = np.linspace(0, 1, 400001)[:-1]
    lam = np.where(t < 0.93, np.sqrt(np.maximum(0.93 - t, 0)) * (2 - 0.7 * (0.93 - t)), 0)
    M = -np.array([(lam * t**k).mean() for k in range(3)])
    assert abs(window.Edge(M)[0] - window.start) == pytest.approx(0.93 * window.length, rel=1e-5)
    slope = window.Edge(M)[1]
    for k in range(3):
        step = 1e-6 * M[k] * np.eye(3)[k]
        assert (window.Edge(M + step)[0] - window.Edge(M - step)[0]) / (2e-6 * M[k]) == pytest.approx(slope[k], rel=1e-5)


def test_displacements_of_a_body_without_contact_against_a_finer_order():
    estimate = problem_of(load=2).Solve().ErrorEstimate()
    fine = problem_of(load=2)
    body = fine.body
    V = CrackFESpace(body, order=4, material=MATERIAL, dirichlet="bottom")
    fine = ContactProblem(V, TraceSpace(body, order=1))
    fine.f += CF((-0.01, 0.1 * (x - 0.5 + 2))) * V.TestFunction() * body.ds("top")
    reference = fine.Solve()
    for goal in (Displacement("top", "y"), Displacement("right", "x")):
        found = estimate.Goal(goal)
        true = goal.Value(reference)
        assert abs(true - found.corrected) < 0.4 * abs(true - found.value) and abs(true - found.value) < found.bar


@pytest.mark.parametrize("name", LAWS)
def test_the_response_of_the_multipliers_to_gaps(name):
    """d/dt of λ for an initial gap t f, beside differences with the same states."""
    step, found = 1e-8, []
    for t in (-step, 0, step):
        problem = problem_of(**LAWS[name])
        problem.gap = 1e-4 + t * (1 + x)
        found.append(problem.Solve())
    assert len({tuple(solution.report.active[-1]) for solution in found}) == 1
    slopes = (found[2].multiplier.vec.FV().NumPy() - found[0].multiplier.vec.FV().NumPy()) / (2 * step)
    gaps = [moments(found[1], 1 + x), *[np.zeros(found[1].problem.W.ndof)] * (len(found[1].problem.law.components) - 1)]
    response = found[1].reduced.Response(found[1], gaps)[0].vec.FV().NumPy()
    assert np.abs(slopes).max() > 0.1
    tolerance = 0.1 if name == "Nitsche" else 1e-4  # whose gaps at points are those of their projection onto W
    assert np.abs(response - slopes).max() < tolerance * np.abs(slopes).max()


@pytest.mark.parametrize("pair", ["P2/P1", "P1/P1", "P2/P0"])
def test_the_error_of_the_pressure(pair):
    """Beside the true one, at a transition, where it is that of λ_h alone, and at a closed tip; parts of the cracks add up."""
    for exact, through, most in ((cf.contact_transition(MATERIAL), True, 3), (cf.slipping_tip(MATERIAL), False, 4)):
        solution = rotated_problem(exact, PAIRS[pair], 0.08, tip=None if through else TIP, through=through).Solve()
        estimate = solution.ErrorEstimate()
        found = estimate.Goal(ContactPressure())
        true = cf.pressure_error(solution, exact)
        assert 0.7 * true < found.bar < most * true
        assert found.value == pytest.approx(np.sqrt(Integrate(solution.multiplier**2 * solution.body.dcrack, solution.body.mesh)))
        assert found.elements.min() >= 0 and np.sqrt(found.elements.sum()) == found.bar == estimate.Goal(ContactPressure(0)).bar
        assert "contact pressure" in repr(found)


def test_what_a_tip_has_of_the_error_of_the_pressure_is_spread_over_its_disk():
    solution = rotated_problem(cf.slipping_tip(MATERIAL), PAIRS["P2/P1"], 0.08, tip=TIP).Solve()
    estimate, (tip,), (spec,) = solution.ErrorEstimate(), solution.body.tips, solution.problem.V.tip_specs
    near, disk = (mask(elements_within(solution.body.mesh, tip.point, radius)) for radius in (NEAR * spec.r1, spec.r1))
    squares = np.where(near, 1.0, 2.0)
    spread = over_disks(squares, estimate)
    assert spread.sum() == pytest.approx(squares.sum()) and np.all(spread[~disk] == 2)
    added = spread[disk] - np.where(near, 0, 2)[disk]
    assert added == pytest.approx(near.sum() * estimate.squares[disk] / estimate.squares[disk].sum())


def test_the_pressure_of_open_and_of_single_cracks():
    """Each of two cracks has its own error; where faces are open λ_h = 0 is right."""
    two = shape_problem("two-cracks", body_mesh(0.1)).Solve().ErrorEstimate()
    each, both = [two.Goal(ContactPressure(crack)) for crack in (0, 1)], two.Goal(ContactPressure())
    assert both.bar == pytest.approx(np.hypot(each[0].bar, each[1].bar)) and each[0].bar > 0 < each[1].bar
    open_crack = problem_of(load=2).Solve().ErrorEstimate().Goal(ContactPressure())
    assert open_crack.value == 0 and open_crack.bar < 0.01 * 0.2  # of the traction, what is left at the tip


def test_refusals():
    with pytest.raises(ValueError, match="is not one of"):
        StressIntensityFactor("K")
    with pytest.raises(ValueError, match="neither 'x' nor 'y'"):
        Displacement("top", "z")
    joint = problem_of(law=Joint(1, 1)).Solve().ErrorEstimate()
    for goal in (ContactForce(), ContactPressure()):
        with pytest.raises(ValueError, match="is not linearised"):
            found = joint.Goal(goal)
            found.bar
    with pytest.raises(ValueError, match="no crack 3"):
        joint.Goal(ContactPressure(3))
    estimate = problem_of().Solve().ErrorEstimate()
    with pytest.raises(TypeError, match="neither an object such as"):
        estimate.Goal("K_I")
    with pytest.raises(ValueError, match="begins or ends at"):
        estimate.Goal(ContactEdge(number=7))
    with pytest.raises((ValueError, IndexError)):
        estimate.Goal(StressIntensityFactor("K_I", tip=3))
    with pytest.raises(ValueError, match="nowhere"):
        estimate.Goal(Displacement("nowhere"))
