"""Newton's method with projections onto disks: random problems, its matrix by differences, the limit of one tangent."""

import numpy as np
import pytest

from ngsxfem_contact.algebra.disk_newton import DiskProblem, fixed_point, newton, solve_disks
from ngsxfem_contact.algebra.nodal_newton import Threshold
from ngsxfem_contact.errors import NotConverged


def random_problem(seed, threshold):
    """Like the compliance of a sheet: smooth in the distance of the nodes, components coupled."""
    rng = np.random.default_rng(seed)
    m = int(rng.integers(3, 40))
    places = rng.uniform(size=(m, 2))
    kernel = np.exp(-8 * np.linalg.norm(places[:, None] - places[None], axis=2))
    A = rng.standard_normal((3 * m, 3 * m))
    q = np.concatenate([rng.standard_normal(m) + 0.5, rng.standard_normal(2 * m)])
    return DiskProblem(np.kron(np.eye(3), kernel) + 0.02 * A @ A.T / (3 * m), q, threshold(m))


def tresca(m):
    return Threshold(np.full(m, 0.5), np.zeros(m))


def coulomb(m):
    return Threshold(np.zeros(m), np.full(m, 0.4))


@pytest.mark.parametrize("threshold", (tresca, coulomb))
@pytest.mark.parametrize("seed", range(20))
def test_the_conditions_hold(seed, threshold):
    problem = random_problem(seed, threshold)
    m = len(problem.q) // 3
    result = solve_disks(problem, np.zeros((3, m)), 60)
    p, w = result.p, (problem.Q @ result.p.ravel() + problem.q).reshape(3, m)
    s, size = problem.threshold.At(p[0], p[0] < 0), np.linalg.norm(p[1:], axis=0)
    assert max(p[0].max(), w[0].max(), np.abs(p[0] * w[0]).max(), (size - s).max()) < 1e-9
    assert np.abs(w[1] * p[2] - w[2] * p[1]).max() < 1e-9 and (w[1:] * p[1:]).sum(axis=0).max() < 1e-9
    inside = size < s * (1 - 1e-6)
    assert np.linalg.norm(w[1:], axis=0)[inside].max(initial=0) < 1e-9 and len(result.contact) <= 12


@pytest.mark.parametrize("threshold", (tresca, coulomb))
def test_the_newton_matrix_is_the_derivative(threshold):
    """Step solves J step = -residual: by differences at a point at which nothing changes its state."""
    problem = random_problem(3, threshold)
    m, rng = len(problem.q) // 3, np.random.default_rng(1)
    p = rng.standard_normal((3, m))
    p[0] = -np.abs(p[0])
    step, h = problem.Step(p), 1e-7
    J = np.array([(problem.Residual(p + h * e) - problem.Residual(p - h * e)).ravel() / (2 * h) for e in np.eye(3 * m).reshape(-1, 3, m)]).T
    assert np.allclose(J @ step.ravel(), -problem.Residual(p).ravel(), atol=1e-5)


def test_a_fixed_point_finds_the_same():
    problem = random_problem(4, coulomb)
    start = np.zeros((3, len(problem.q) // 3))
    assert np.allclose(fixed_point(problem, start, 60).p, newton(problem, start, 60).p, atol=1e-8)


def test_steps_that_are_not_enough_are_said():
    problem = random_problem(4, tresca)
    with pytest.raises(NotConverged, match="friction: Newton's method left a residual"):
        newton(problem, np.zeros((3, len(problem.q) // 3)), 1)


@pytest.mark.parametrize("seed", range(5))
def test_nodes_that_all_stick(seed):
    """Exactly: an affine problem whose solution is a constant traction inside of the disks, with rows of very different size, as slivers make them; Newton's method alone may cycle."""
    problem = random_problem(seed, coulomb)
    m = len(problem.q) // 3
    size = np.tile(10.0 ** np.random.default_rng(seed).uniform(-4, 0, m), 3)
    Q, p = problem.Q * size * size[:, None], np.repeat([-3.0, -0.5, 0.1], m) / size
    result = solve_disks(DiskProblem(Q, -Q @ p, problem.threshold), np.zeros((3, m)), 60)
    assert np.allclose(result.p.ravel() * size, p * size, rtol=1e-8) and not result.slip.any()
