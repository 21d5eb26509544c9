"""Stabilisations as docs/extending.md describes them, the remedies of messages, and options of Solve."""

import inspect
from dataclasses import fields
from math import isnan

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import CF, x

from ngsxfem_contact import BarbosaHughes, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, LoadSteps, Nitsche, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import BothSides
from ngsxfem_contact.contact.options import StepOptions
from ngsxfem_contact.errors import NotCoercive, SingularSystem

MATERIAL = Elasticity.PlaneStrain(E=7, nu=0.3)


class Constant:
    """γ the same everywhere, on both sides, with nothing but what is required."""

    sides = {"plus": 0.5, "minus": 0.5}

    def __init__(self, gamma, safe):
        self.gamma, self.safe = gamma, safe

    def Gamma(self, V, material, components):
        return CF(self.gamma)

    def IsSafe(self, V, material, components):
        return self.safe


def problem(stabilisation, order=2, multiplier_order=1, **options):
    body = CrackedMesh(rectangle(0.2), Crack([(0, 0.5), (0.5, 0.52)]))
    V = CrackFESpace(body, order=order, tip=TipEnrichment(material=MATERIAL), dirichlet="bottom")
    result = ContactProblem(V, TraceSpace(body, order=multiplier_order), MATERIAL, stabilisation=stabilisation, **options)
    result.f += CF((0, x - 0.7)) * V.TestFunction() * body.ds("top")
    return result


def test_three_attributes_are_enough():
    own, right = (problem(method).Solve() for method in (Constant(1e-4, False), BarbosaHughes()))
    assert own.ContactForce() == pytest.approx(right.ContactForce(), rel=0.02)


def test_a_missing_one_is_named():
    class Half:
        sides = {"larger": 1}

        def Gamma(self, V, material, components):
            return CF(1e-3)

    with pytest.raises(TypeError, match="has no IsSafe; docs/extending.md"):
        problem(Half())


@pytest.mark.parametrize(
    ("stabilisation", "remedy"),
    [
        (Constant(3.0, False), "make what Gamma returns at least .* times smaller"),
        (BarbosaHughes(gamma0=3), "take gamma0 = 3 below .*, or gamma0=None"),
        (BothSides(gamma0=3), r"take gamma0 = 3 below .*, or BarbosaHughes\(\)"),
        (Nitsche(theta=1, gamma0=3), "take gamma0 = 3 below .*, or gamma0=None, .* or theta=-1"),
    ],
)
def test_not_coercive_names_a_remedy_that_is_not_in_force(stabilisation, remedy):
    with pytest.raises(NotCoercive, match=f"γ is too large: the smallest eigenvalue .* is -.*; {remedy}"):
        problem(stabilisation).Solve()


def test_the_bound_for_gamma0_is_one():
    """Just below it K - K_γ is positive, just above it is not: for the eigenvalue 1 - γ θ is linear in γ."""
    with pytest.raises(NotCoercive) as refused:
        problem(BarbosaHughes(gamma0=3)).Solve()
    bound = float(str(refused.value).split(" below ")[1].split(",")[0])
    problem(BarbosaHughes(gamma0=0.95 * bound)).Solve()
    with pytest.raises(NotCoercive):
        problem(BarbosaHughes(gamma0=1.05 * bound)).Solve()


def test_a_singular_pair_is_told_what_is_missing():
    for stabilisation, remedy in ((None, r"needs stabilisation=BarbosaHughes\(\), or"), (BarbosaHughes(gamma0=1e-14), "needs a larger γ, .* or a richer")):
        with pytest.raises(SingularSystem, match=remedy):
            problem(stabilisation, order=1, multiplier_order=3).Solve()


def test_the_weak_cone_is_refused_wherever_it_is_given():
    for refused in (lambda: problem(Nitsche()).Solve(cone="weak"), lambda: LoadSteps(problem(Nitsche())).Solve(1.0, cone="weak")):
        with pytest.raises(ValueError, match="Nitsche: the law holds at points; cone='weak' belongs to a multiplier"):
            refused()


def test_unknown_options_are_named():
    contact = problem(BarbosaHughes())
    with pytest.raises(TypeError, match="Solve.. got an unexpected keyword argument 'max_iteration'"):
        contact.Solve(max_iteration=3)
    with pytest.raises(TypeError, match="Solve.. got an unexpected keyword argument 'load'"):
        LoadSteps(contact).Solve(1.0, load=None)
    contact.Solve(inverse="sparsecholesky", cone="nonpositive", start=None, max_iterations=50, previous=None)


def test_each_default_is_that_of_the_options():
    for solve in (ContactProblem.Solve, LoadSteps.Solve):
        given = {name: argument.default for name, argument in inspect.signature(solve).parameters.items() if argument.kind is argument.KEYWORD_ONLY}
        assert given.keys() - {"inverse"} == {option.name for option in fields(StepOptions)}
        assert {name: value for name, value in given.items() if name not in ("inverse", "previous")}.items() <= vars(StepOptions()).items()


def test_converged_is_said_when_it_is_known():
    solution = LoadSteps(problem(BarbosaHughes())).Solve(0.5)
    assert solution.report.converged is None and isnan(solution.report.residual) and "not checked yet" in str(solution.report)
    assert np.isfinite(solution.u.vec.FV().NumPy()).all()
    assert solution.report.converged is True and solution.report.residual < 1e-10
