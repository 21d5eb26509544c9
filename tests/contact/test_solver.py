"""Elimination of the displacements by several direct solvers, first active sets, load steps.

1e-9: round-off times the condition of the matrices, 1e-12 measured.
"""

import numpy as np
import pytest
from helpers import array
from ngsolve import CF, BilinearForm, BitArray, Grad, InnerProduct, LinearForm, VectorH1, dx
from scipy.sparse import random_array, vstack

from ngsxfem_contact import BarbosaHughes, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, LoadCase, LoadSteps, TipEnrichment, TraceSpace
from ngsxfem_contact.algebra import pardiso
from ngsxfem_contact.algebra.active_set import coarse_start, solve_active_set
from ngsxfem_contact.algebra.elimination import BackSubstitution, Elimination, PartialFactorisation, default_inverse
from ngsxfem_contact.algebra.matrices import to_scipy
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.errors import NotCoercive, NotConverged, SingularSystem
from ngsxfem_contact.spaces.unknowns import Unknowns
from study.paper import PAIRS, paper_problem, unstructured_mesh

MATERIAL = Elasticity(lam=1, mu=1)
MESH = unstructured_mesh(0.06)
FINER = unstructured_mesh(0.03)
needs_mkl = pytest.mark.skipif(not pardiso.is_available(), reason="MKL is not installed (pip install mkl)")
INVERSES = ["sparsecholesky", "umfpack", pytest.param("pardiso", marks=needs_mkl)]
TIPS = {"modes": TipEnrichment(material=MATERIAL, r1=0.3), "branch": TipEnrichment(r1=0.3), "none": None}


def close(ours, theirs, tolerance=1e-9):
    return np.shape(ours) == np.shape(theirs) and np.abs(np.asarray(ours) - theirs).max(initial=0) <= tolerance * np.abs(theirs).max(initial=0)


def problem_on(mesh=MESH, **options):
    return paper_problem(mesh, **{"tip": TIPS["modes"]} | options)


# Elimination


def dense_elimination(problem, system):
    """A⁻¹ on the free unknowns, and E A⁻¹ Eᵀ, by numpy."""
    free = np.array(problem.free, dtype=bool)
    A = to_scipy(system.stiffness).toarray()
    inverse = np.zeros_like(A)
    inverse[np.ix_(free, free)] = np.linalg.inv(A[np.ix_(free, free)])
    return inverse, system.E @ inverse @ system.E.T.toarray()


@pytest.mark.parametrize("tip", TIPS)
@pytest.mark.parametrize("inverse", INVERSES)
def test_elimination_is_that_of_dense_algebra(inverse, tip):
    problem = problem_on(pair="P1/P1", tip=TIPS[tip])
    system = problem.Assemble()
    elimination = Elimination(system.stiffness, problem.free, Unknowns(problem.V).tips, system.E, inverse)
    A_inverse, S = dense_elimination(problem, system)
    rng = np.random.default_rng(0)
    rhs, L = rng.standard_normal(problem.V.ndof), rng.standard_normal(problem.W.ndof)
    load = elimination.Reduce(rhs)
    assert elimination.name == inverse
    assert close(elimination.S, S)
    assert close(load.crack, system.E @ A_inverse @ rhs)
    assert close(elimination.Recover(load, L), A_inverse @ (rhs + system.E.T @ L))
    assert close(elimination.Solve(rhs), A_inverse @ rhs)


@pytest.mark.parametrize("inverse", ["sparsecholesky", pytest.param("pardiso", marks=needs_mkl)])
@pytest.mark.parametrize("rows", [0, 1, 7, 40])
def test_partial_factorisation_of_any_rows(inverse, rows):
    """Rows that are far from a crack, that share unknowns, that are dense or empty, and unknowns outside of the factorisation."""
    V = VectorH1(FINER, order=2, dirichlet="left")
    u, v = V.TnT()
    A = BilinearForm((InnerProduct(Grad(u), Grad(v)) + u * v) * dx, symmetric=True).Assemble().mat
    inner = BitArray(V.FreeDofs())
    inner[100:120] = False
    sparse = [random_array((rows, V.ndof), density=density, rng=np.random.default_rng(1)) for density in (0.002, 1, 0)]
    K = vstack(sparse).tocsc()
    strategy = PartialFactorisation if inverse == "sparsecholesky" else pardiso.Pardiso
    ours, reference = strategy(A, inner, K), BackSubstitution(A, inner, K, "umfpack")
    rhs = np.random.default_rng(2).standard_normal(V.ndof)
    assert close(ours.schur, reference.schur) and ours.positive
    assert close(ours.Solve(rhs), reference.Solve(rhs)) and close(ours.Couple(rhs), reference.Couple(rhs))


@pytest.mark.parametrize("inverse", INVERSES)
@pytest.mark.parametrize("pair", PAIRS)
def test_answer_does_not_depend_on_the_direct_solver(pair, inverse):
    ours, reference = (problem_on(pair=pair).Solve(inverse=i) for i in (inverse, "umfpack"))
    assert close(array(ours.u.vec), array(reference.u.vec)) and close(array(ours.multiplier.vec), array(reference.multiplier.vec))
    assert ours.report.inverse == inverse and inverse in str(ours.report)


@pytest.mark.parametrize("inverse", INVERSES)
def test_a_singular_pair_is_named(inverse):
    with pytest.raises(SingularSystem, match="act on no displacement"):
        problem_on(pair="P1/P1", stabilisation=None, mesh=FINER).Solve(inverse=inverse)


@pytest.mark.parametrize("inverse", INVERSES)
def test_a_matrix_that_is_not_positive_is_named(inverse):
    with pytest.raises(NotCoercive, match="too large"):
        problem_on(stabilisation=BarbosaHughes(gamma0=1)).Solve(inverse=inverse)


def test_pardiso_without_mkl_says_what_to_install(monkeypatch):
    monkeypatch.setattr(pardiso, "is_available", lambda: False)
    with pytest.raises(ImportError, match=r"pip install mkl.*ngsxfem_contact\[fast\]"):
        problem_on().Solve(inverse="pardiso")
    assert problem_on().Solve().report.inverse == "sparsecholesky"


@pytest.mark.parametrize(("size", "installed", "chosen"), [(10**6, True, "pardiso"), (10**6, False, "sparsecholesky"), (100, True, "sparsecholesky")])
def test_pardiso_is_chosen_for_large_problems(monkeypatch, size, installed, chosen):
    monkeypatch.setattr(pardiso, "is_available", lambda: installed)
    assert default_inverse(size) == chosen


# First active sets


@pytest.mark.parametrize("pair", PAIRS)
def test_few_iterations_from_a_cold_start(pair):
    problem = problem_on(FINER, pair=pair)
    cold, empty = problem.Solve().report, problem.Solve(start=np.zeros(problem.W.ndof, dtype=bool)).report
    assert np.array_equal(cold.active[-1], empty.active[-1])
    assert cold.iterations <= 4 and cold.fallback == 0


@pytest.mark.parametrize("pair", PAIRS)
def test_few_iterations_from_a_coarser_mesh(pair):
    coarser = problem_on(pair=pair).Solve()
    report = problem_on(FINER, pair=pair).Solve(start=coarser).report
    assert report.iterations <= 4 and report.coarse_iterations == 0


@pytest.mark.parametrize("m", [1, 4, 5, 31, 64])
def test_coarse_sets_do_not_change_the_answer(m):
    rng = np.random.default_rng(m)
    A = rng.standard_normal((m, m))
    Q, q = A @ A.T + 0.1 * np.eye(m), rng.standard_normal(m)
    start, iterations = coarse_start(Q, q)
    assert start.shape == (m,) and (iterations > 0) == (m > 4)
    assert solve_active_set(Q, q, start=start).p == pytest.approx(solve_active_set(Q, q).p, rel=1e-7, abs=1e-9)


def test_start_from_a_body_with_other_cracks():
    body = CrackedMesh(MESH, Crack([(0.2, 0.2), (0.4, 0.3)]), Crack([(0.5, -0.2), (0.7, -0.2)]))
    V = CrackFESpace(body, tip=None, dirichlet="right")
    problem = ContactProblem(V, TraceSpace(body), MATERIAL)
    with pytest.raises(ValueError, match="a solution with 1 cracks for a problem with 2"):
        problem.Solve(start=problem_on().Solve())


# Load steps


def pressed():
    """Held below, given displacement above, traction on the left."""
    body = CrackedMesh(MESH, Crack([(0, 0.03), (0.6, 0.03)]))
    V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL, r1=0.2), dirichlet="top|bottom")
    return ContactProblem(V, TraceSpace(body, order=1), MATERIAL, gap=1e-4)


def load(problem, press, shear):
    v = problem.V.TestFunction()
    problem.SetDirichlet((0, -press), "top")
    problem.f = LinearForm(problem.V)
    problem.f += CF((0, shear)) * v * problem.body.ds("left")
    return problem


def test_load_steps_are_separate_solves():
    problem = pressed()
    cases = [LoadCase(load(problem, *amounts)) for amounts in ((1e-3, 0), (0, 1e-3))]
    steps = LoadSteps(problem, cases)
    for t in ((1, 0), (1, 0.3), (1, 1), (0.2, 1), (0, 0)):
        step, alone = steps.Solve(*t), load(pressed(), 1e-3 * t[0], 1e-3 * t[1]).Solve()
        assert np.isnan(step.report.residual)  # nothing of the size of u was touched
        scale = max(np.abs(array(alone.multiplier.vec)).max(), 1e-12)
        assert np.abs(array(step.multiplier.vec) - array(alone.multiplier.vec)).max() < 1e-9 * scale
        assert np.abs(array(step.u.vec) - array(alone.u.vec)).max() <= 1e-9 * np.abs(array(alone.u.vec)).max()
        assert step.report.residual < 1e-10 and step.report.complementarity < 1e-10
        assert np.array_equal(step.report.active[-1], alone.report.active[-1])


def test_proportional_load_steps_start_where_the_last_one_ended():
    steps = LoadSteps(load(pressed(), 1e-3, 3e-4))
    reports = [steps.Solve(t).report for t in np.linspace(0.1, 1, 10)]
    assert all(np.array_equal(after.active[0], before.active[-1]) for before, after in zip(reports, reports[1:]))
    assert reports[0].active[-1].sum() < reports[-1].active[-1].sum()  # the gap closes
    assert all(report.coarse_iterations == 0 for report in reports[1:])


@pytest.mark.parametrize("t", [(), (1, 2)])
def test_one_factor_for_each_load_case(t):
    with pytest.raises(ValueError, match=r"factor\(s\) for 1 load case"):
        LoadSteps(problem_on(pair="P1/P0")).Solve(*t)


def test_load_cases_are_finite():
    problem = problem_on(pair="P1/P0")
    problem.f += CF((0, float("nan"))) * problem.V.TestFunction() * problem.body.dx
    with pytest.raises(ValueError, match="not finite"):
        LoadCase(problem)


def test_a_displacement_that_does_not_solve_raises_when_it_is_used():
    reduced = ReducedProblem(problem_on(pair="P1/P0"))
    solution = reduced.Step()
    reduced.case.reduced.rhs[:] = 2 * reduced.case.reduced.rhs
    with pytest.raises(NotConverged, match="does not satisfy its own equations"):
        solution.u


def test_load_steps_want_a_factor_for_each_case():
    problem = load(pressed(), 1e-3, 0)
    with pytest.raises(ValueError, match="no load case"):
        LoadSteps(problem, [])
    with pytest.raises(ValueError, match="2 factor.* 1 load case"):
        LoadSteps(problem).Solve(1, 0.5)
