"""Contact by conjugate gradients in the condensed form, against direct solvers; what there is no such form for."""

import sys
from functools import cache

import numpy as np
import pytest
from ngsolve import CF, IfPos, InnerProduct, z

from ngsxfem_contact import (
    BarbosaHughes,
    ContactProblem,
    Coulomb,
    CrackedMesh,
    CrackFESpace,
    Elasticity,
    LoadSteps,
    NotCoercive,
    NotConverged,
    TraceSpace,
    Tresca,
)
from ngsxfem_contact.algebra import conjugate_gradients, multigrid
from ngsxfem_contact.contact import strategy
from ngsxfem_contact.contact.condensed import CondensedProblem, NotCondensed
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.exact.pennies import bent_penny, closed_penny, partially_closed
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.spaces import FrontEnrichment
from tests.sheets.exact_sheets import cube_mesh

pytest.importorskip("pyamg")
pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE, RADIUS = (0.49, 0.51, 0.513), 0.3
DISK = Sheet.Disk(CENTRE, (0, 0, 1), RADIUS)
THROUGH = Sheet.Polygon([(a, b, CENTRE[2]) for a, b in ((-1, -1), (2, -1), (2, 2), (-1, 2))])
mesh_of = cache(cube_mesh)


def problem_of(form, maxh=0.16, sheet=DISK, order=1, dirichlet="outer", rollers=(), radius=0.0, **arguments):
    body = CrackedMesh(mesh_of(maxh), sheet)
    front = FrontEnrichment(radius=radius)
    problem = ContactProblem(
        CrackFESpace(body, order=order, dirichlet=dirichlet, material=MATERIAL, front=front, **dict(rollers)), TraceSpace(body), **arguments
    )
    if form is not None:
        problem.SetDirichlet(form.u, "outer")
    return problem


def lying():
    """A block on another one, which springs hold; springs hold the upper one sideways only."""
    problem = problem_of(None, 0.25, THROUGH, dirichlet="")
    u, v = problem.V.TnT()
    problem.a += IfPos(z - 0.9, 1, 0) * (u[0] * v[0] + u[1] * v[1]) * problem.body.ds("outer") + IfPos(z - 0.1, 0, 1) * u * v * problem.body.ds("outer")
    problem.f += CF((0, 0, -1)) * v * problem.body.dx
    return problem


def difference(a, b):
    return np.abs(a - b).max() / np.abs(b).max()


def displacement(solution):
    return solution.u.vec.FV().NumPy()


CASES = {
    "half closed": (bent_penny(MATERIAL, RADIUS), {}),
    "partially closed": (partially_closed(MATERIAL, 0.2), {"sheet": THROUGH}),
    "Tresca": (bent_penny(MATERIAL, RADIUS), {"law": Tresca(0.01)}),
    "Coulomb": (partially_closed(MATERIAL, 0.2), {"law": Coulomb(0.3)}),
    "Coulomb, slip everywhere": (closed_penny(MATERIAL, RADIUS, 1.0, 0.8), {"law": Coulomb(0.3)}),
    "order 2": (bent_penny(MATERIAL, RADIUS), {"order": 2, "maxh": 0.22}),
    "order 2, Coulomb": (bent_penny(MATERIAL, RADIUS), {"order": 2, "maxh": 0.22, "law": Coulomb(0.3)}),
    "an initial gap": (closed_penny(MATERIAL, RADIUS, 1.0, 0.8), {"gap": 0.2}),
}


@pytest.mark.parametrize("case", CASES)
def test_the_answer_is_that_of_a_direct_solver(case):
    """λ and u to 1e-7, the same nodes in contact, forces and energies."""
    form, arguments = CASES[case]
    problem = problem_of(form.At(CENTRE), **arguments)
    direct, found = problem.Solve(inverse="sparsecholesky"), problem.Solve(inverse="cg")
    assert difference(found.state.L, direct.state.L) < 1e-7 and difference(displacement(found), displacement(direct)) < 1e-7
    assert (found.report.active[-1] == direct.report.active[-1]).all() and found.report.states == pytest.approx(direct.report.states)
    assert found.report.inverse == "cg" and len(found.report.linear_iterations) == found.report.iterations == len(found.report.active)
    assert found.report.iterations <= (8 if problem.law.components[1:] == () else 20) and found.report.residual < 1e-9
    assert found.ContactForce() == pytest.approx(direct.ContactForce(), rel=1e-7) and found.Energy() == pytest.approx(direct.Energy(), rel=1e-7)
    assert np.allclose(found.Reaction("outer"), direct.Reaction("outer"), atol=1e-8)
    assert found.DissipatedEnergy() == pytest.approx(direct.DissipatedEnergy(), rel=1e-6)


def test_factors_along_a_front():
    problem = problem_of(bent_penny(MATERIAL, RADIUS).At(CENTRE), 0.08)
    K = [np.column_stack([f.K_I, f.K_II, f.K_III]) for f in (problem.Solve(inverse=name).StressIntensity() for name in ("cg", "sparsecholesky"))]
    assert difference(*K) < 1e-7


def test_uniform_pressure():
    """(3a): λ = -p, to the accuracy of the iteration."""
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(CENTRE)
    solution = problem_of(form, 0.25, THROUGH).Solve(inverse="cg")
    assert np.abs(solution.state.L + 1).max() < 1e-8 and solution.ContactForce() == pytest.approx(-1, rel=1e-9)
    assert "solver           cg: " in str(solution.report)


def test_the_iterations_hardly_grow():
    """Those of one matrix: 25 on a mesh of 13,000 unknowns, and where a sheet leaves slivers of elements."""
    form = closed_penny(MATERIAL, RADIUS, 1.0, 0.8).At(CENTRE)
    (count,) = problem_of(form, 0.065).Solve(inverse="cg").report.linear_iterations
    assert count <= 25
    mesh_points = np.array([v.point for v in mesh_of(0.16).vertices])
    near = mesh_points[np.argmin(np.linalg.norm(mesh_points - CENTRE, axis=1))]
    sheet = Sheet.Polygon([(a, b, near[2] + 1e-7) for a, b in ((-1, -1), (2, -1), (2, 2), (-1, 2))])
    assert max(problem_of(form, 0.16, sheet).Solve(inverse="cg").report.linear_iterations) <= 25


def test_modes_far_from_the_sheet_do_not_cost_iterations():
    """Modes of nodes whose elements no sheet meets are nearly polynomials there: both are in the direct solver. 13; with the modes alone in it 64."""
    form = closed_penny(MATERIAL, RADIUS, 1.0, 0.8).At(CENTRE)
    (count,) = problem_of(form, 0.11, radius=0.2).Solve(inverse="cg").report.linear_iterations
    assert count <= 16


def test_load_steps_begin_where_the_last_one_ended():
    """Slip is counted from step to step, as by a direct solver; a load that is scaled costs no more than a look."""
    form = closed_penny(MATERIAL, RADIUS, 1.0, 0.8).At(CENTRE)
    problem = problem_of(form, law=Coulomb(0.3))
    direct, found = (LoadSteps(problem, inverse=name) for name in ("sparsecholesky", "cg"))
    for t in (0.5, 1.0, 0.7):
        a, b = direct.Solve(t), found.Solve(t)
        assert (
            difference(b.state.L, a.state.L) < 1e-7
            and b.report.states == pytest.approx(a.report.states)
            and b.DissipatedEnergy() == pytest.approx(a.DissipatedEnergy(), rel=1e-6, abs=1e-12)
        )
    steps = LoadSteps(problem_of(bent_penny(MATERIAL, RADIUS).At(CENTRE)), inverse="cg")
    first, second = steps.Solve(1.0), steps.Solve(2.0)
    assert sum(second.report.linear_iterations) <= 2 < sum(first.report.linear_iterations) and difference(second.state.L, 2 * first.state.L) < 1e-8


def test_starts():
    """From the solution's own nodes: one set; from those of another mesh; the answer does not depend on it."""
    problem = problem_of(bent_penny(MATERIAL, RADIUS).At(CENTRE))
    first = problem.Solve(inverse="cg")
    coarse = problem_of(bent_penny(MATERIAL, RADIUS).At(CENTRE), 0.22).Solve()
    for start in (first.report.active[-1], first, coarse, ~first.report.active[-1]):
        again = problem.Solve(inverse="cg", start=start)
        assert difference(again.state.L, first.state.L) < 1e-8
        assert again.report.iterations <= (1 if start is first else 8)
    with pytest.raises(ValueError, match="start has 3 entries"):
        problem.Solve(inverse="cg", start=np.ones(3, dtype=bool))


def test_rollers_springs_and_tractions():
    """Nodes of which some components are held; a load that is a traction."""
    problem = problem_of(None, 0.25, THROUGH, dirichlet="")
    u, v = problem.V.TnT()
    problem.a += 100 * InnerProduct(u, v) * problem.body.ds("outer")
    problem.f += CF((0, 0.1, -1)) * v * problem.body.dx
    rollers = problem_of(None, 0.25, THROUGH, dirichlet="", rollers={"dirichletx": "outer", "dirichletz": "outer"})
    rollers.f += CF((0, 0, -1)) * rollers.V.TestFunction() * rollers.body.dx
    a, b = rollers.V.TnT()
    rollers.a += 0.5 * a[1] * b[1] * rollers.body.ds("outer")
    for each in (problem, rollers):
        direct, found = each.Solve(inverse="sparsecholesky"), each.Solve(inverse="cg")
        assert difference(displacement(found), displacement(direct)) < 1e-7 and difference(found.state.L, direct.state.L) < 1e-6


def test_the_choice(monkeypatch):
    """Direct for small problems; for large ones conjugate gradients, which say why, and, if pyamg is missing, how to get it."""
    problem = problem_of(closed_penny(MATERIAL, RADIUS).At(CENTRE), 0.25)
    assert type(problem.Reduced()) is ReducedProblem
    monkeypatch.setattr(strategy, "CG_PAYS", 100)
    report = problem.Solve().report
    assert report.inverse == "cg" and f"cg ({problem.V.ndof} unknowns, " in str(report) and type(problem.Reduced("sparsecholesky")) is ReducedProblem
    assert type(problem.Reduced()) is CondensedProblem and type(lying().Reduced()) is ReducedProblem
    monkeypatch.setitem(sys.modules, "pyamg", None)
    assert not multigrid.is_available() and type(problem.Reduced()) is ReducedProblem
    with pytest.raises(ImportError, match="needs pyamg: pip install pyamg"):
        problem.Solve(inverse="cg")
    monkeypatch.setattr(strategy, "MOST_UNKNOWNS", 100)
    with pytest.raises(ImportError, match="pip install"):
        problem.Solve()


def test_refusals(monkeypatch):
    form = closed_penny(MATERIAL, RADIUS).At(CENTRE)
    with pytest.raises(NotCondensed, match="stabilisation=BarbosaHughes"):
        problem_of(form, 0.25, stabilisation=None).Solve(inverse="cg")
    with pytest.raises(NotCondensed, match="gamma0=50.* take BarbosaHughes"):
        problem_of(form, 0.25, stabilisation=BarbosaHughes(gamma0=50)).Solve(inverse="cg")
    with pytest.raises(NotCondensed, match='"weak" is the same'):
        problem_of(form, 0.25).Solve(inverse="cg", cone="weak")
    with pytest.raises(NotCondensed, match="held by the faces of cracks alone.* hold it by dirichlet"):
        lying().Solve(inverse="cg")
    problem = problem_of(form, 0.25)
    monkeypatch.setattr(conjugate_gradients, "MOST", 3)
    with pytest.raises(NotConverged, match="after 3 steps: look for flat elements"):
        problem.Solve(inverse="cg")
    with pytest.raises(NotConverged, match="still changed after 1 iterations"):
        problem_of(bent_penny(MATERIAL, RADIUS).At(CENTRE), 0.25).Solve(inverse="cg", max_iterations=1)


def test_a_matrix_that_is_not_positive():
    """Near the cracks the factors say so, far from them conjugate gradients do."""
    problem = problem_of(closed_penny(MATERIAL, RADIUS).At(CENTRE), 0.2)
    problem.stabilisation = type("Trusted", (BarbosaHughes,), {"IsSafe": lambda *_: True})(gamma0=30.0)
    with pytest.raises(NotCoercive, match="a pivot around the cracks is negative"):
        problem.Solve(inverse="cg")
    problem = problem_of(closed_penny(MATERIAL, RADIUS).At(CENTRE), 0.2)
    u, v = problem.V.TnT()
    problem.a += -80 * u * v * problem.body.dx
    with pytest.raises(NotCoercive, match="negative energy"):
        problem.Solve(inverse="cg")
