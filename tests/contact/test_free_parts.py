"""Parts of a body that no support holds, only the faces of cracks: glued, pressed, stacked."""

import numpy as np
import pytest
from ngsolve import CF, IfPos, y
from test_laws import CRACK, HEIGHT, MESH, METHODS, E, assert_uniform

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, LoadSteps, TraceSpace
from ngsxfem_contact.contact import BartonBandis, ExponentialCohesive, Joint, LinearCohesive, LoadCase, MohrCoulomb, PathSteps
from ngsxfem_contact.errors import NotConverged, SingularSystem

HEIGHTS = (0.53, 1.03, 1.53)


def column(law, *cracks, **options):
    """Held below only, so that cracks across make free blocks."""
    body = CrackedMesh(MESH, *(cracks or (CRACK,)))
    V = CrackFESpace(body, order=2, dirichlet="bottom")
    return ContactProblem(V, TraceSpace(body, order=1), Elasticity.PlaneStrain(E=E, nu=0), law=law, **options)


def stack(law):
    """Four blocks one on the other, of weight 1 for each unit of area."""
    problem = column(law, *(Crack([(0, h), (1, h)]) for h in HEIGHTS))
    problem.f += CF((0, -1)) * problem.V.TestFunction() * problem.body.dx
    return problem


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("stress", [0.4, -0.4])
def test_a_block_on_a_joint(stress, method):
    """A given force: λ is that, in tension and in compression."""
    problem = column(Joint(3.0, 2.0, 5.0), **METHODS[method])
    problem.f += CF((0, stress)) * problem.V.TestFunction() * problem.body.ds("top")
    solution = problem.Solve()
    assert_uniform(solution, stress, stress / (3 if stress > 0 else 5))
    assert solution.Reaction("bottom") == pytest.approx([0, -stress], abs=1e-12) and solution.report.residual < 1e-12


@pytest.mark.parametrize(
    "law", [MohrCoulomb(0.5), MohrCoulomb(0.5, 0, 0.1, 50, 20), LinearCohesive(3.0, 0.5), {0: Joint(3.0, 2.0), 1: Coulomb(0.5), 2: BartonBandis(4.0, 0.5, 0.5)}]
)
def test_a_stack_of_blocks(law):
    """Each crack carries the weight above it, and what pushes the blocks above to the side, less than friction could."""
    problem = stack(law)
    problem.f += CF((0.2, 0)) * problem.V.TestFunction() * problem.body.ds("left")
    solution = problem.Solve()
    for crack, h in enumerate(HEIGHTS):
        assert solution.ContactForce(crack) == pytest.approx(h - HEIGHT, abs=1e-12)
        assert solution.TangentialForce(crack) == pytest.approx(
            0.2 * (HEIGHT - h), abs=1e-12
        )  # the sign of the slip: the upper block is pushed along the crack
    assert solution.Reaction("bottom") == pytest.approx([-0.2 * HEIGHT, HEIGHT], abs=1e-12)


def test_a_block_that_is_pushed_until_it_slides():
    """The push of the uppermost block grows to μ times its weight, and stays."""
    problem, mu, weight = stack(MohrCoulomb(0.5)), 0.5, HEIGHT - HEIGHTS[2]
    fixed = LoadCase(problem)
    problem.f = type(problem.f)(problem.V)
    problem.f += CF((IfPos(y - HEIGHTS[2], 1 / weight, 0), 0)) * problem.V.TestFunction() * problem.body.ds("left", bonus_intorder=20)
    steps = PathSteps(problem, fixed)
    pushes = []
    for _ in range(8):
        solution = steps.Solve(0.02)
        pushes.append(solution.TangentialForce(2))
    assert pushes[0] < pushes[1] <= mu * weight * (1 + 1e-12)
    assert pushes[-1] == pytest.approx(mu * weight, rel=1e-10) == pushes[-2] and solution.TangentialForce(1) == pytest.approx(pushes[-1], rel=1e-10)
    assert solution.report.states["slips"] > 0.2 and solution.DissipatedEnergy() == pytest.approx(mu * weight * 0.02, rel=1e-9)


def test_a_glued_block_that_a_growing_force_pulls_off():
    """t = f(d), rising and falling, on a block that nothing else holds; a larger one has no answer."""
    problem = column(ExponentialCohesive(1.0, 0.5))
    problem.f += CF((0, 1)) * problem.V.TestFunction() * problem.body.ds("top")
    steps = PathSteps(problem)
    for _ in range(8):
        profile = steps.Solve(0.1).Profile(n=3)
        gap = profile.gap[1]
        assert profile.sigma_n[1] == pytest.approx(steps.t, abs=1e-12) and (gap < 1e-12 or steps.t == pytest.approx(np.exp(-gap / 0.5), abs=1e-11))
    loads = LoadSteps(problem)
    assert_uniform(loads.Solve(0.9), 0.9, 0)
    with pytest.raises(NotConverged, match="3 rigid motions of parts of the body that only the faces hold"):
        loads.Solve(1.1)


@pytest.mark.parametrize("law", [MohrCoulomb(0.1), Joint(0.0, 0.0, 5.0)])
def test_a_stack_that_nothing_holds_sideways(law):
    problem = stack(law)
    problem.f += CF((0.2, 0)) * problem.V.TestFunction() * problem.body.ds("left")
    with pytest.raises(NotConverged, match="9 rigid motions of parts of the body that only the faces hold are not held by them"):
        problem.Solve()


def test_a_body_that_nothing_holds():
    """Glue holds two blocks together, and nothing holds both."""
    body = CrackedMesh(MESH, CRACK)
    V = CrackFESpace(body, order=1)
    with pytest.raises(SingularSystem, match="3 rigid motion.* are left free"):
        ContactProblem(V, TraceSpace(body), Elasticity.PlaneStrain(E=E, nu=0), law=Joint(1, 1)).Solve()


def test_a_stack_with_friction():
    """Coulomb's law holds what friction can hold, as a law at the nodes."""
    problem = stack(Coulomb(0.5))
    problem.f += CF((0.2, 0)) * problem.V.TestFunction() * problem.body.ds("left")
    solution = problem.Solve()
    for crack, h in enumerate(HEIGHTS):
        assert (solution.ContactForce(crack), solution.TangentialForce(crack)) == pytest.approx((h - HEIGHT, 0.2 * (HEIGHT - h)), abs=1e-12)
    assert sum("held by the faces of cracks alone" in note for note in solution.report.notes) == 3


def test_a_stack_without_friction():
    """Contact alone leaves each block free to slide."""
    with pytest.raises(SingularSystem, match="1 rigid motion.* of one of the 4 parts .* are left free"):
        stack(None).Solve()
