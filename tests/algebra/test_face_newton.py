"""Relations between traction and jump: derivatives by differences, laws at single nodes by hand, and Newton's method against enumeration."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from ngsxfem_contact.algebra.closures import HyperbolicClosure, LinearClosure
from ngsxfem_contact.algebra.compliance import Compliance
from ngsxfem_contact.algebra.face_newton import FaceProblem, Stuck, continued, newton, solve_faces
from ngsxfem_contact.algebra.face_relations import CohesiveRelation, DividedRelation, ElasticRelation, SlidingRelation  # fmt: skip
from ngsxfem_contact.algebra.nodal_methods import FullNewton
from ngsxfem_contact.algebra.nodal_newton import Threshold, first_states
from ngsxfem_contact.algebra.softening import ExponentialSoftening, LinearSoftening
from ngsxfem_contact.errors import NotConverged

N = 300
ONE, ZERO, RIGID = np.ones(N), np.zeros(N), np.full(N, np.inf)
RELATIONS = {
    "joint": ElasticRelation(2 * ONE, ONE, RIGID),
    "linear": CohesiveRelation(LinearSoftening(ONE, 0.3 * ONE), 0.7 * ONE),
    "exponential": CohesiveRelation(ExponentialSoftening(ONE, 0.3 * ONE), 0.7 * ONE),
    "plastic": CohesiveRelation(LinearSoftening(ONE, ZERO), ONE),
    "Coulomb": SlidingRelation(LinearClosure(RIGID), Threshold(ZERO, 0.3 * ONE), RIGID, ZERO),
    "rock": SlidingRelation(LinearClosure(3 * ONE), Threshold(0.2 * ONE, 0.3 * ONE, True), 2 * ONE, 0.1 * ONE),
    "hyperbolic": SlidingRelation(HyperbolicClosure(2 * ONE, 0.5 * ONE), Threshold(ZERO, 0.3 * ONE), RIGID, 0.2 * ONE),
}
RELATIONS["divided"] = DividedRelation([(np.arange(0, N, 2), RELATIONS["joint"]), (np.arange(1, N, 2), RELATIONS["exponential"])])


def first(thing, n):
    """A relation at its first n nodes."""
    if is_dataclass(thing):
        return replace(thing, **{each.name: first(getattr(thing, each.name), n) for each in fields(thing)})
    return thing[:n] if isinstance(thing, np.ndarray) else thing


def divided(relation):
    """Its parts have as many coefficients as nodes."""
    return DividedRelation([(here, first(part, len(here))) for here, part in relation.parts])


RELATIONS["divided"] = divided(RELATIONS["divided"])


def random_state(relation, seed=0):
    rng = np.random.default_rng(seed)
    before = {"opening": np.where(rng.random(N) < 0.5, 0, rng.random(N)), "slip": 0.3 * rng.standard_normal(N), "slid": 0.3 * rng.random(N)}
    return 1.5 * rng.standard_normal((2, N)), relation.Stiffness(np.stack([1.3 * ONE, 0.9 * ONE])), before


def differences(function, y, h=1e-6):
    """∂function_i/∂y_j by central differences, (..., 2, N) with j before the nodes."""
    steps = [np.array([[h], [0]]), np.array([[0], [h]])]
    return np.stack([(function(y + step) - function(y - step)) / (2 * h) for step in steps], axis=-2)


@pytest.mark.parametrize("name", RELATIONS)
def test_derivatives(name):
    """At nodes without a kink within the difference, which all but a few are."""
    relation = RELATIONS[name]
    y, c, before = random_state(relation)
    for value, derivative in (
        (lambda y: relation.Jump(y, c, before)[0], relation.Jump(y, c, before)[1]),
        (lambda y: relation.Progress(y, c, before)[0], relation.Progress(y, c, before)[1]),
    ):
        error = np.abs(differences(value, y) - derivative).reshape(-1, N).max(axis=0)
        assert np.sort(error)[-5] < 1e-7


@pytest.mark.parametrize("name", RELATIONS)
def test_the_answer_does_not_depend_on_the_stiffness(name):
    """t and g that belong together do so with any c."""
    relation = RELATIONS[name]
    y, c, before = random_state(relation)
    g, _ = relation.Jump(y, c, before)
    t = y - c * g
    other = relation.Stiffness(7 * c)
    assert np.abs(relation.Jump(t + other * g, other, before)[0] - g).max() < 1e-13
    for one, two in zip(relation.Work(y, c, before), relation.Work(t + other * g, other, before)):
        assert np.abs(one - two).max() < 1e-13


@pytest.mark.parametrize("softening", [LinearSoftening(ONE, 0.3 * ONE), ExponentialSoftening(ONE, 0.3 * ONE)])
def test_softening(softening):
    """Slope and integral by differences, and the opening that belongs to a trial."""
    d, h = np.linspace(0.01, 9, N), 1e-6
    assert np.abs((softening.At(d + h) - softening.At(d - h)) / (2 * h) - softening.Slope(d))[np.abs(d - 1 / 0.3) > 1e-3].max() < 1e-8
    assert np.abs((softening.Integral(d + h) - softening.Integral(d - h)) / (2 * h) - softening.At(d)).max() < 1e-6
    assert np.abs(softening.Opening(softening.At(d) + 0.5 * d, 0.5 * ONE) - d).max() < 1e-12
    assert (-softening.Slope(d) <= softening.steepest).all()


def test_a_cohesive_node_by_hand():
    """Rigid below the strength; softening; the secant back; closed under pressure."""
    relation = CohesiveRelation(LinearSoftening(np.array([2.0]), np.array([0.5])), np.array([1.0]))
    c, node = np.full((2, 1), 4.0), lambda n, t: np.array([[n], [t]])
    jump = lambda n, t=0.0, **before: relation.Jump(node(n, t), c, {name: np.array([value]) for name, value in before.items()})[0].ravel()
    assert (jump(1.9) == 0).all() and (jump(-5.0) == 0).all()
    assert jump(2 - 0.5 + 4) == pytest.approx([1, 0])  # t = 1.5 at g = 1
    assert jump(0.75 + 2, opening=1.0) == pytest.approx([0.5, 0])  # t = 0.75 at g = 0.5
    assert jump(4 * 7.0) == pytest.approx([7, 0])  # nothing left beyond 4
    assert jump(-3, 1.5 + 4) == pytest.approx([0, 1])  # pressed, and sheared


def test_a_sliding_node_by_hand():
    """Pressure 2 - dilation 0.5 × slide 1 × stiffness 4 more, and the threshold that belongs to it."""
    relation = SlidingRelation(LinearClosure(np.array([np.inf])), Threshold(np.array([0.1]), np.array([0.3]), True), np.array([np.inf]), np.array([0.5]))
    c, t = np.full((2, 1), 4.0), np.array([[-2.0], [0.7]])
    g = np.array([[0.5], [1.0]])
    assert relation.Jump(t + c * g, c, {})[0] == pytest.approx(g)
    after = relation.Variables(t + c * g, c, {})
    assert [after[name][0] for name in ("slip", "slid", "threshold")] == pytest.approx([1, 1, 0.7])
    back = np.array([[1.0], [0.0]])  # slides back by 1, and opens further
    assert relation.Jump(t * [[1], [-1]] + c * back, c, after)[0] == pytest.approx(back)


def random_problem(relation, seed, n=12):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((2 * n, 2 * n))
    Q, q, weights = A @ A.T / (2 * n) + 1e-2 * np.eye(2 * n), 2 * rng.standard_normal(2 * n), rng.uniform(0.5, 1.5, n)
    return FaceProblem(Compliance(Q), q, weights, relation, relation.Stiffness(weights / np.diag(Q).reshape(2, -1)))


@pytest.mark.parametrize("motions", [0, 2])
@pytest.mark.parametrize("name", [name for name in RELATIONS if name != "divided"])
def test_a_step_by_the_inverse_solves_newtons_equations(name, motions):
    """Some nodes rigid, some sliding, some free; also where parts of the body are held by the faces alone."""
    rng = np.random.default_rng(7)
    problem = random_problem(first(RELATIONS[name], 12), 3)
    problem = replace(problem, motions=rng.standard_normal((24, motions)), pull=rng.standard_normal(motions))
    z = np.append(2 * rng.standard_normal(24), rng.standard_normal(motions))
    residual = problem.Residual(z)
    step = np.linalg.solve(problem.Matrix(z), -problem.units * residual)
    assert problem.Step(z, residual) == pytest.approx(step, rel=1e-8, abs=1e-9 * np.abs(step).max())


@pytest.mark.parametrize("name", ["joint", "linear", "exponential", "plastic", "Coulomb", "hyperbolic"])
def test_newton_ends(name):
    """On random problems, in few steps; what it returns satisfies both sides."""
    for seed in range(20):
        problem = random_problem(first(RELATIONS[name], 12), seed)
        result = solve_faces(problem, problem.Tied(), 60)
        assert (np.abs(problem.Residual(result.z)) < 1e-11 * problem.Scale(result.z)).all() and result.iterations <= 30


def test_newton_agrees_with_the_states_of_coulomb():
    for seed in range(10):
        problem = random_problem(first(RELATIONS["Coulomb"], 12), seed)
        threshold = problem.relation.threshold
        start = first_states(problem.Q, problem.q, threshold, np.zeros(12, dtype=bool))
        p = FullNewton().Solve(problem.Q, problem.q, threshold, 1 / problem.Q.diagonal, start, 100).p
        assert np.abs(problem.Traction(solve_faces(problem, problem.Tied(), 60).z).ravel() - p).max() < 1e-10 * np.abs(p).max()


def test_newton_that_does_not_end_says_so():
    """One step is not enough, neither at once nor for small parts of the load."""
    problem = random_problem(first(RELATIONS["exponential"], 12), 0)
    with pytest.raises(Stuck, match="1 steps were not enough"):
        newton(problem, problem.Tied(), 1)
    with pytest.raises(NotConverged, match="law of the faces.*PathSteps"):
        solve_faces(problem, problem.Tied(), 1)


def test_the_load_little_by_little():
    """From the problem that a start solves, to the one that is asked for: the same answer."""
    problem = random_problem(first(RELATIONS["hyperbolic"], 12), 1)
    result = continued(problem, problem.Tied(), 60)
    assert np.abs(result.z - solve_faces(problem, problem.Tied(), 60).z).max() < 1e-10 and result.method == "Newton along a path"
