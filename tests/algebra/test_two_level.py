"""Two levels: the polynomial, the coarse functions, S, conjugate gradients whose number does not grow."""

import numpy as np
import pytest
import scipy
from netgen.geom2d import unit_square
from ngsolve import CF, Mesh

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.algebra.aggregates import Vertices, independent_motions, motions_at, tentative
from ngsxfem_contact.algebra.matrices import csr_view
from ngsxfem_contact.algebra.multigrid import is_available
from ngsxfem_contact.algebra.two_level import DEGREE, RATIO, SAFETY, Chebyshev
from ngsxfem_contact.contact.iterative import IterativeProblem
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.processes import Exchange
from ngsxfem_contact.spaces.unknowns import Unknowns

needs_pyamg = pytest.mark.skipif(not is_available(), reason="without pyamg: pip install pyamg")


def problem(maxh, order=2, crack=None):
    body = CrackedMesh(Mesh(unit_square.GenerateMesh(maxh=maxh)), crack or Crack([(0, 0.5), (0.5, 0.5)]))
    V = CrackFESpace(body, order=order, material=Elasticity.PlaneStrain(E=210e3, nu=0.3), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body))
    problem.f += CF((20, -100)) * V.TestFunction() * body.ds("top")
    return problem


def test_the_polynomial_is_chebyshevs():
    """Of what it leaves of an eigenvector with the eigenvalue x: T_k((c - x)/d)/T_k(c/d), c and d the middle and half of the interval."""
    x = np.linspace(0.01, 3.0, 50)
    A = scipy.sparse.diags(x).tocsr()
    smoother = Chebyshev(A, np.ones(50, dtype=bool), Exchange())
    smoother.D_inverse = np.ones(50)
    smoother.largest = 3.0
    applied, left = smoother.Apply(np.ones(50))
    c, d = 1.5 * (1 + 1 / RATIO), 1.5 * (1 - 1 / RATIO)
    T = np.polynomial.chebyshev.Chebyshev.basis(DEGREE)
    assert left == pytest.approx(T((c - x) / d) / T(c / d), abs=1e-12)
    assert left == pytest.approx(1 - A @ applied, abs=1e-12)


def test_the_largest_eigenvalue():
    """Of D⁻¹A, with the margin of safety."""
    rng = np.random.default_rng(1)
    B = rng.standard_normal((30, 30))
    A = B @ B.T + 30 * np.eye(30)
    exact = scipy.linalg.eigh(A, np.diag(np.diag(A)), eigvals_only=True)[-1]
    assert exact < Chebyshev(scipy.sparse.csr_matrix(A), np.ones(30, dtype=bool), Exchange()).largest < 1.2 * exact


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("maxh", [0.12, 0.06])
def test_the_largest_eigenvalue_of_a_cracked_body(order, maxh):
    """To a per cent: where a tenth is missing the polynomial, and the preconditioner, are not positive."""
    assembled = problem(maxh, order).Assemble()
    A, on = csr_view(assembled.stiffness), np.ones(assembled.problem.V.ndof, dtype=bool)
    on[Unknowns(assembled.problem.V).tips] = False
    inner = scipy.sparse.csr_matrix(A)[on][:, on]
    root = scipy.sparse.diags(1 / np.sqrt(inner.diagonal()))
    exact = scipy.sparse.linalg.eigsh(root @ inner @ root, k=1, which="LA", return_eigenvectors=False)[0]
    assert Chebyshev(A, on, Exchange()).largest / SAFETY == pytest.approx(exact, rel=0.01)


def test_motions_of_groups_are_independent():
    """One vertex has two, with one component held one; two vertices three; the motions of many are orthonormal but for their size, and span the rigid ones."""
    points = np.array([(10, 1), (3.0, 4), (3.5, 4.2), *np.random.default_rng(0).uniform(100, 101, (6, 2)), (7, 7)])
    free = np.ones((10, 2), dtype=bool)
    free[9, 0] = False
    groups = scipy.sparse.csr_matrix((np.ones(10), (np.arange(10), [0, 1, 1, *[2] * 6, 3])))
    motions = independent_motions(groups, points, free)
    assert motions.any(axis=1).sum(axis=1).tolist() == [2, 3, 3, 1]
    values = (motions_at(points[3:9]) @ motions[2]).reshape(12, 3)
    products = values.T @ values
    assert products == pytest.approx(np.diag(np.diag(products)), abs=1e-8)
    assert np.linalg.lstsq(values, motions_at(points[3:9]).reshape(12, 3), rcond=None)[1] == pytest.approx(0, abs=1e-12)


@needs_pyamg
@pytest.mark.parametrize("order", [1, 2, 3])
def test_approximate_complement(order):
    """S is at most the true one, and nearly that."""
    exact, approximate = ReducedProblem(problem(0.06, order), "sparsecholesky"), IterativeProblem(problem(0.06, order))
    S, known = exact.elimination.S, approximate.elimination.S
    ratios = scipy.linalg.eigh(S, known, eigvals_only=True)
    assert 1 - 1e-6 < ratios[0] and ratios[-1] < 1.5
    d = np.random.default_rng(0).standard_normal(len(S))
    approximate.elimination.Learn(d, S @ d)
    learnt = approximate.elimination.S
    assert learnt @ d == pytest.approx(S @ d, rel=1e-9) and (scipy.linalg.eigh(S, learnt, eigvals_only=True) > 1 - 1e-6).all()


@needs_pyamg
def test_rigid_motions_are_kept():
    """Of vertices in groups and of their neighbours, so that A times them is zero where vertices are smoothed, next to the crack, too."""
    assembled = problem(0.08, 1).Assemble()
    space, mesh = assembled.problem.V, assembled.problem.V.mesh
    points, functions = mesh.ngmesh.Coordinates()[: mesh.nv, :2], space.scalar_space.ndof
    dofs, grouping = np.arange(mesh.nv)[:, None] + [0, functions], np.abs(points[:, 1] - 0.5) > 0.2
    A = csr_view(assembled.stiffness)
    T = tentative(A, Vertices(dofs, points), np.ones(space.ndof, dtype=bool), grouping, Exchange())
    rigid = motions_at(points)
    there = T[dofs[grouping].ravel()].toarray()
    coefficients, *_ = np.linalg.lstsq(there, rigid[grouping].reshape(-1, 3), rcond=None)
    whole = T @ coefficients
    assert whole[dofs[grouping].ravel()] == pytest.approx(rigid[grouping].reshape(-1, 3), abs=1e-11)
    assert np.abs((A @ whole)[dofs[grouping].ravel()]).max() < 1e-8 * np.abs(A.data).max()
    assert 0 < T.shape[1] < 0.6 * 2 * grouping.sum()


@needs_pyamg
@pytest.mark.parametrize("order", [1, 2, 3])
def test_iterations_do_not_grow(order):
    """With sixteen times as many elements there are as many, but for a few."""
    iterations = [IterativeProblem(problem(maxh, order)).elimination.iterations[0] for maxh in (0.12, 0.03)]
    assert iterations[1] <= iterations[0] + 8 and iterations[1] < 45
