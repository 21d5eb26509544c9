"""Conjugate gradients in the plane beside direct solvers: laws, load steps, what is refused."""

import sys

import numpy as np
import pytest
from netgen.geom2d import unit_square
from ngsolve import CF, Mesh, x, y

from ngsxfem_contact import BarbosaHughes, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, LoadSteps, Nitsche, TraceSpace, Tresca
from ngsxfem_contact.algebra import conjugate_gradients, multigrid
from ngsxfem_contact.contact import LinearCohesive, PathSteps, iterative
from ngsxfem_contact.errors import NotCoercive, NotConverged

pytestmark = pytest.mark.skipif(not multigrid.is_available(), reason="without pyamg: pip install pyamg")

STEEL = Elasticity.PlaneStrain(E=210e3, nu=0.3)
EDGE, THROUGH, INCLINED = Crack([(0, 0.5), (0.5, 0.5)]), Crack([(0, 0.5), (1, 0.52)]), Crack([(0.3, 0.45), (0.7, 0.55)])


def problem(*cracks, order=2, maxh=0.1, material=STEEL, load=CF((20 * y, 100 * (x - 0.6))), dirichlet="bottom", **options):
    body = CrackedMesh(Mesh(unit_square.GenerateMesh(maxh=maxh)), *cracks)
    V = CrackFESpace(body, order=order, material=material, dirichlet=dirichlet)
    problem = ContactProblem(V, TraceSpace(body), **options)
    problem.f += load * V.TestFunction() * body.ds("top")
    return problem


def assert_same(direct, found):
    """Pressures, states, energies, displacement."""
    assert found.state.L == pytest.approx(direct.state.L, abs=1e-7 * np.abs(direct.state.L).max())
    assert (found.report.active[-1] == direct.report.active[-1]).all() and found.report.Counts() == direct.report.Counts()
    assert found.Energy() == pytest.approx(direct.Energy(), rel=1e-10)
    U = direct.u.vec.FV().NumPy()
    assert found.u.vec.FV().NumPy() == pytest.approx(U, abs=1e-8 * np.abs(U).max())


@pytest.mark.parametrize(
    "options",
    [
        {"law": None},
        {"law": Tresca(5)},
        {"law": Coulomb(0.1), "load": CF((30, -100))},
        {"law": LinearCohesive(strength=60, G_c=0.05), "load": CF((0, 100))},
        {"stabilisation": Nitsche(theta=-1)},
        {"stabilisation": None, "cone": "weak"},
    ],
    ids=["frictionless", "Tresca", "Coulomb", "cohesive", "Nitsche", "unstabilised"],
)
def test_laws_and_methods(options):
    """All that a direct solver does."""
    both = problem(INCLINED, **options)
    found = both.Solve(inverse="cg")
    assert_same(both.Solve(), found)
    assert found.report.inverse == "cg" and "conjugate gradients" in str(found.report)


def test_parts_that_only_friction_holds():
    """Their rigid motions are found with the pressures."""
    both = problem(THROUGH, law=Coulomb(0.6), load=CF((10, -100)))
    assert_same(both.Solve(), both.Solve(inverse="cg"))


@pytest.mark.parametrize("options", [{}, {"law": Coulomb(0.1), "load": CF((30, -100))}], ids=["frictionless", "Coulomb"])
def test_load_steps(options):
    """Forth and back; the history of the faces counts."""
    both = problem(INCLINED, **options)
    direct, found = LoadSteps(both), LoadSteps(both, inverse="cg")
    for t in (0.5, 1.0, 0.3):
        assert_same(direct.Solve(t), found.Solve(t))


def test_load_steps_learn():
    """What is known of S stays: the second step takes fewer displacements than the first one."""
    steps = LoadSteps(problem(EDGE, maxh=0.04), inverse="cg")
    first, second = (steps.Solve(t).report.linear_iterations for t in (0.5, 1.0))
    assert len(second) < len(first) - 1 and sum(second) < sum(first[1:])  # the first one solves for the load, too


def test_a_body_without_cracks():
    """Is an elastic problem."""
    both = problem()
    assert both.Solve(inverse="cg").Energy() == pytest.approx(both.Solve().Energy(), rel=1e-11)


def test_given_displacements_and_estimates():
    """The estimate of the error asks for further solutions."""
    both = problem(EDGE, dirichlet="bottom|top")
    both.SetDirichlet((0, -1e-4 * (1 + x)), "top")
    direct, found = both.Solve(), both.Solve(inverse="cg")
    assert_same(direct, found)
    assert found.ErrorEstimate().energy == pytest.approx(direct.ErrorEstimate().energy, rel=1e-6)


def test_what_is_not_there_is_refused(monkeypatch):
    """With what to do."""
    with pytest.raises(ValueError, match=r"nearly incompressible.*leave inverse= out"):
        problem(EDGE, material=Elasticity.PlaneStrain(E=1, nu=0.4999)).Solve(inverse="cg")
    with pytest.raises(ValueError, match=r"inverse='cg' is there for ContactProblem\.Solve and LoadSteps"):
        PathSteps(problem(EDGE, law=LinearCohesive(strength=60, G_c=0.05)), inverse="cg")
    with pytest.raises(NotCoercive, match=r"γ is too large"):
        problem(EDGE, stabilisation=BarbosaHughes(gamma0=10)).Solve(inverse="cg")
    with pytest.raises(ValueError, match="the error of a quantity needs a direct solver"):
        problem(EDGE).Solve(inverse="cg").reduced.Adjoint(None, np.zeros(0), [])
    monkeypatch.setitem(sys.modules, "pyamg", None)
    with pytest.raises(ImportError, match=r"inverse='cg' needs pyamg: pip install pyamg"):
        problem(EDGE).Solve(inverse="cg")


def test_what_does_not_converge_raises(monkeypatch):
    """Neither iteration ends with less than it should."""
    monkeypatch.setattr(iterative, "MOST_ROUNDS", 2)
    with pytest.raises(NotConverged, match="after 2 rounds of conjugate gradients"):
        problem(INCLINED).Solve(inverse="cg")
    monkeypatch.setattr(conjugate_gradients, "MOST", 3)
    with pytest.raises(NotConverged, match="after 3 steps: look for flat elements"):
        problem(INCLINED).Solve(inverse="cg")


def test_negative_stiffness_is_seen():
    """Of a spring that pushes."""
    pushing = problem(INCLINED)
    u, v = pushing.V.TnT()
    pushing.a += -1e6 * u * v * pushing.body.dx
    with pytest.raises(NotCoercive):
        pushing.Solve(inverse="cg")
