"""The condensed form: projections with their derivatives and energies, the eliminated block, multigrid, Newton's method against the dense active set."""

import numpy as np
import pytest
import scipy
from ngsolve import BilinearForm, Grad, InnerProduct, Sym, VectorH1, div, dx

from ngsxfem_contact.algebra.active_set import solve_active_set
from ngsxfem_contact.algebra.condensed import CondensedMatrix
from ngsxfem_contact.algebra.condensed_newton import CondensedNewton, FaceTerms
from ngsxfem_contact.algebra.conjugate_gradients import ConjugateGradients
from ngsxfem_contact.algebra.matrices import mask, to_scipy
from ngsxfem_contact.algebra.multigrid import Multigrid, rigid_motions
from ngsxfem_contact.algebra.nodal_newton import Threshold
from tests.sheets.exact_sheets import cube_mesh


def terms_of(m, k, rng, threshold=None):
    return FaceTerms(scipy.sparse.csr_matrix(rng.normal(size=(k * m, 5))), np.tile(rng.uniform(0.5, 2, m), k), rng.normal(size=k * m), threshold)


@pytest.mark.parametrize("k", (1, 3))
def test_projection_slope_and_energy(k):
    """The slope is the derivative of the projection, minus the projection that of the energy by E U: by central differences."""
    rng, m, step = np.random.default_rng(3), 40, 1e-6
    s = rng.uniform(0.2, 1.5, m)
    terms = terms_of(m, k, rng, Threshold(s, np.zeros(m)) if k == 3 else None)
    y, way = rng.normal(size=(k, m)), rng.normal(size=(k, m))
    law = terms.At(y, y[0] < 0)
    moved = [terms.Project(y + sign * step * way, s) for sign in (1, -1)]
    assert np.allclose(np.einsum("abm,bm->am", law.slope, way), (moved[0] - moved[1]) / (2 * step), atol=1e-7)
    assert np.allclose(law.slope, law.slope.swapaxes(0, 1)) and np.allclose(law.p, terms.Project(y, s))
    assert np.allclose((terms.Matrix(law.slope) @ way.ravel()).reshape(k, m) * terms.D.reshape(k, m), np.einsum("abm,bm->am", law.slope, way))
    change = [terms.Energy(y - sign * step * way / terms.D.reshape(k, m), s) for sign in (1, -1)]
    assert (change[0] - change[1]) / (2 * step) == pytest.approx(-(law.p * way).sum(), rel=1e-7)


def elastic(maxh, order):
    """(A, free, nodes, near kernel) of the unit cube, one component of which is held on all of its boundary, and all at order 2."""
    mesh = cube_mesh(maxh)
    V = VectorH1(mesh, order=order, dirichletx="outer", **({} if order == 1 else {"dirichlety": "outer", "dirichletz": "outer"}))
    u, v = V.TnT()
    form = BilinearForm((2 * InnerProduct(Sym(Grad(u)), Sym(Grad(v))) + div(u) * div(v) + 0.01 * u * v) * dx).Assemble()
    return to_scipy(form.mat), mask(V.FreeDofs()), np.arange(V.ndof).reshape(3, -1).T, rigid_motions(mesh.ngmesh.Coordinates())


def test_rigid_motions_have_no_energy():
    mesh = cube_mesh(0.4)
    V = VectorH1(mesh, order=1)
    u, v = V.TnT()
    A = to_scipy(BilinearForm(InnerProduct(Sym(Grad(u)), Sym(Grad(v))) * dx).Assemble().mat)
    motions = rigid_motions(mesh.ngmesh.Coordinates())
    order = np.arange(V.ndof).reshape(3, -1).T.ravel()
    assert np.abs(A[order][:, order] @ motions).max() < 1e-12 and np.linalg.matrix_rank(motions) == 6


@pytest.mark.parametrize("order", (1, 2))
def test_multigrid_and_the_eliminated_block(order):
    """The V-cycle is symmetric, positive, and not larger than the inverse; the block leaves the Schur complement."""
    pytest.importorskip("pyamg")
    A, free, nodes, motions = elastic(0.16, order)
    rng = np.random.default_rng(1)
    E = scipy.sparse.random_array((4, A.shape[0]), density=6 / A.shape[0], rng=rng).tocsr()
    matrix = CondensedMatrix(A, free, E, nodes, motions.reshape(-1, 3, 6))
    multigrid, n = matrix.multigrid, len(matrix.body)
    assert isinstance(multigrid, Multigrid) and len(multigrid.sizes) > 1
    a, b = rng.normal(size=(2, n))
    assert a @ multigrid.Apply(b) == pytest.approx(b @ multigrid.Apply(a), rel=1e-10) and a @ multigrid.Apply(a) > 0
    for _ in range(40):
        a = multigrid.Apply(multigrid.A @ (a / np.linalg.norm(a)))
    assert np.linalg.norm(a) < 1 + 1e-8
    H = scipy.sparse.diags(rng.uniform(1, 2, 4)).tocsr()
    matrix.Set(H)
    rhs = np.where(free, rng.normal(size=A.shape[0]), 0)
    found = ConjugateGradients(matrix.Apply, matrix.Precondition, matrix.Condense(rhs))
    first = found.size
    while found.size > 1e-12 * first:
        found.Step()
    x = matrix.Extend(found.x, rhs)
    left = rhs - (A + E.T @ H @ E) @ x
    assert len(found.gains) < (35 if order == 1 else 70) and np.abs(left[free]).max() < 1e-9 * np.abs(rhs).max() and not x[~free].any()


def test_newton_beside_the_dense_active_set():
    """Random obstacles for the cube: the set and p of the problem with the displacements eliminated, whatever the start."""
    pytest.importorskip("pyamg")
    A, free, nodes, motions = elastic(0.25, 2)
    rng, m = np.random.default_rng(7), 30
    E = scipy.sparse.random_array((m, A.shape[0]), density=5 / A.shape[0], rng=rng).tocsr()
    D, G, F = rng.uniform(0.05, 0.2, m), rng.normal(size=m), np.where(free, rng.normal(size=A.shape[0]), 0)
    E = (E @ scipy.sparse.diags(free.astype(float))).tocsr()
    inner = scipy.sparse.linalg.splu(A[free][:, free].tocsc())
    columns = inner.solve(E[:, free].T.toarray())
    dense = solve_active_set(E[:, free] @ columns + np.diag(D), columns.T @ F[free] - G)
    matrix = CondensedMatrix(A, free, E, nodes, motions.reshape(-1, 3, 6))
    for start in (np.ones(m, dtype=bool), np.zeros(m, dtype=bool), None):
        result = CondensedNewton(matrix, FaceTerms(E, D, G), F, np.zeros(A.shape[0]), start).Solve(30)
        assert np.abs(result.p[0] - dense.p).max() < 1e-8 * np.abs(dense.p).max() and (result.contact[-1] == dense.active[-1]).all()
        assert 0 < dense.active[-1].sum() < m


def test_conjugate_gradients_say_what_is_not_positive():
    for A, M in ((np.diag([1.0, -1.0]), np.eye(2)), (np.eye(2), np.diag([1.0, -2.0]))):
        found = ConjugateGradients(lambda x: A @ x, lambda r: M @ r, np.array([1.0, 2.0]))
        if found.positive:
            found.Step()
        assert not found.positive
