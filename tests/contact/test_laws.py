"""Laws of the faces: columns and blocks with closed forms, Dugdale's strip, limits of stiffness, energies, several laws in one body."""

import pickle
import re
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from helpers import MATERIAL, array, rectangle
from ngsolve import CF, IfPos, InnerProduct, Integrate, x, y

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, LoadSteps, Nitsche, TraceSpace, Tresca
from ngsxfem_contact.contact import BartonBandis, Dugdale, ExponentialCohesive, Joint, LinearCohesive, MohrCoulomb
from ngsxfem_contact.contact.friction import Frictionless
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.exact.fracture_solutions import dugdale_strip
from study.paper import add_loads, paper_problem, unstructured_mesh

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
from bodies import strip_mesh  # noqa: E402

INF = float("inf")
HEIGHT, E = 2.0, 10.0
MESH = rectangle(0.4, (0, 0), (1, HEIGHT))
CRACK = Crack([(0, 1.03), (1, 1.03)])  # from side to side


def column(law, *cracks, order=1, modulus=E, **options):
    """A bar of ν = 0 with cracks across, held below; u_y is given above."""
    body = CrackedMesh(MESH, *(cracks or (CRACK,)))
    V = CrackFESpace(body, order=order, dirichlet="bottom|top")
    return ContactProblem(V, TraceSpace(body, order=1), Elasticity.PlaneStrain(E=modulus, nu=0), law=law, **options)


def pulled(problem, u, **options):
    problem.SetDirichlet((0, u), "top")
    return problem.Solve(**options)


def assert_uniform(solution, stress, gap, tolerance=1e-12, crack=0):
    profile = solution.Profile(crack, n=9)
    assert np.abs(profile.sigma_n - stress).max() < tolerance and np.abs(profile.gap - gap).max() < tolerance


# The column: one spring after the other


METHODS = {"multiplier": {}, "weak cone": {"cone": "weak"}, "Nitsche": {"stabilisation": Nitsche(1)}, "Nitsche, -1": {"stabilisation": Nitsche(-1)}}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("k, k_closed", [(3.0, INF), (3.0, 5.0), (3e8, 2e-8), (0.0, 0.0), (INF, INF)])
def test_a_joint_in_a_column(k, k_closed, method):
    """λ = u / (H/E + 1/k) in tension and in compression."""
    for u, stiffness in ((0.3, k), (-0.3, k_closed)):
        stress = u / (HEIGHT / E + 1 / stiffness) if stiffness else 0.0
        solution = pulled(column(Joint(k, 1.0, k_closed), **METHODS[method]), u)
        gap = stress / stiffness if stiffness else u
        assert_uniform(solution, stress, gap)
        assert solution.FaceEnergy() == pytest.approx(0.5 * stress * gap, abs=1e-14) and solution.DissipatedEnergy() == 0
        assert solution.report.iterations <= 2


def test_fluid_in_a_joint():
    """σ = λ - p: the faces carry what the fluid leaves."""
    problem, k, p, u = column(Joint(3.0, 1.0)), 3.0, 0.4, 0.1
    problem.FacePressure(p)
    gap = (u * E / HEIGHT + p) / (k + E / HEIGHT)
    solution = pulled(problem, u)
    assert_uniform(solution, k * gap, gap)
    assert solution.stress[1, 1](MESH(0.4, 0.3)) == pytest.approx(k * gap - p)


def test_closure_of_a_rock_joint():
    """-u = p H/E + p / (k_n0 + p/v_m), a quadratic equation; open under tension."""
    k, v = 4.0, 0.05
    solution = pulled(column(BartonBandis(k, v)), -0.1)
    p = -solution.Profile(n=3).sigma_n[1]
    a, b = HEIGHT / E / v, k * HEIGHT / E + 1 - 0.1 / v
    exact = (-b + np.sqrt(b**2 + 4 * a * 0.1 * k)) / (2 * a)
    assert p == pytest.approx(exact, rel=1e-13)
    assert_uniform(solution, -exact, -exact / (k + exact / v))
    pressures = np.linspace(0, exact, 2001)
    closures = pressures / (k + pressures / v)
    assert solution.FaceEnergy() == pytest.approx(np.diff(closures) @ (pressures[1:] + pressures[:-1]) / 2, rel=1e-6)
    assert_uniform(pulled(column(BartonBandis(k, v)), 0.1), 0, 0.1)


def softening(kind, strength, G_c):
    """f and its integral."""
    if kind is ExponentialCohesive:
        return lambda d: strength * np.exp(-strength * d / G_c), lambda d: G_c * (1 - np.exp(-strength * d / G_c))
    part = lambda d: min(strength * d / (2 * G_c), 1)
    return lambda d: strength * (1 - part(d)), lambda d: G_c * (2 - part(d)) * part(d)


@pytest.mark.parametrize("kind", [LinearCohesive, ExponentialCohesive])
def test_a_cohesive_column_unloads_to_the_origin_and_loads_again(kind):
    """Each step against u = σ H/E + d; what it dissipates against ∫f less the triangle."""
    strength, G_c, modulus = 1.0, 0.05, 100.0
    f, integral = softening(kind, strength, G_c)
    steps = LoadSteps(column(kind(strength, G_c), modulus=modulus))
    steps.reduced.problem.SetDirichlet((0, 1), "top")
    steps = LoadSteps(steps.reduced.problem)
    largest, lost = 0.0, 0.0
    for u in (0.01, 0.03, 0.06, 0.04, 0.0, -0.02, 0.0, 0.05, 0.07, 0.3):
        solution = steps.Solve(u)
        profile = solution.Profile(n=3)
        gap, stress = profile.gap[1], profile.sigma_n[1]
        assert u == pytest.approx(stress * HEIGHT / modulus + gap, abs=1e-14)
        if gap > largest + 1e-14:
            assert stress == pytest.approx(f(gap), abs=1e-12)
        elif largest and u > 0:
            assert stress == pytest.approx(f(largest) / largest * gap, abs=1e-12)
        else:
            assert abs(gap) < 1e-14 and stress == pytest.approx(u * modulus / HEIGHT, abs=1e-12)
        largest = max(largest, gap)
        lost += solution.DissipatedEnergy()
        assert lost == pytest.approx(integral(largest) - 0.5 * f(largest) * largest, abs=1e-14)
        assert solution.FaceEnergy() == pytest.approx(0.5 * stress * gap if u > 0 else 0, abs=1e-14)
    assert lost == pytest.approx(G_c, rel=0.01) and largest == pytest.approx(0.3, rel=1e-3)


# Homogeneous blocks: the exact displacement all around


def block(law, n=0.0, t=0.0, gap=0.0, slip=0.0, problem=None, nu=0.0, **options):
    """Stresses n and t on the crack of a square, and jumps there, given on its boundary; (problem, its solution)."""
    material = Elasticity.PlaneStrain(E=E, nu=nu)
    if problem is None:
        body = CrackedMesh(rectangle(0.3), Crack([(0, 0.52), (1, 0.52)]))
        V = CrackFESpace(body, order=2, dirichlet="bottom|top|left|right")
        problem = ContactProblem(V, TraceSpace(body, order=1), material, law=law)
    side = IfPos(y - 0.52, 1, 0)
    problem.SetDirichlet(CF((t / material.mu * y + side * slip, n / E * y + side * gap)), "bottom|top|left|right")
    return problem, problem.Solve(**options)


def assert_block(solution, n, t, gap, slip, tolerance=1e-11):
    assert_uniform(solution, n, gap, tolerance)
    profile = solution.Profile(n=9)
    assert np.abs(profile.sigma_t - t).max() < tolerance and np.abs(profile.slip - slip).max() < tolerance


def test_cohesion_and_dilation_in_a_sheared_block():
    """λ_t = c + μ p; it rises by tan ψ times the way, also on the way back; what is dissipated is (c + μ p - p tan ψ) × way."""
    c, mu, tangent, p = 0.2, 0.3, 0.25, 2.0
    law, s = MohrCoulomb(mu, c, tangent), c + mu * p
    problem, first = block(law, -p, s, tangent * 0.1, 0.1)
    assert_block(first, -p, s, tangent * 0.1, 0.1)
    assert first.DissipatedEnergy() == pytest.approx((s - p * tangent) * 0.1) and first.report.states["slips"] == 1
    _, held = block(law, -p, 0.5 * s, tangent * 0.1, 0.1, problem, previous=first)
    assert_block(held, -p, 0.5 * s, tangent * 0.1, 0.1)
    assert held.DissipatedEnergy() == 0 and held.report.states["sticks"] == 1
    _, back = block(law, -p, -s, tangent * 0.3, -0.1, problem, previous=held)
    assert_block(back, -p, -s, tangent * 0.3, -0.1)
    assert back.DissipatedEnergy() == pytest.approx((s - p * tangent) * 0.2)
    _, lifted = block(law, 0, 0, 0.3, 0.5, problem, previous=back)  # higher than tan ψ times the way
    assert_block(lifted, 0, 0, 0.3, 0.5)
    assert lifted.DissipatedEnergy() == pytest.approx(0, abs=1e-14) and lifted.report.states["open"] == 1


def test_a_sheared_block_that_cannot_rise():
    """p grows by E tan ψ × way where the height is held, and λ_t with it."""
    c, mu, tangent, slip = 0.2, 0.3, 0.25, 0.1
    p = E * tangent * slip
    _, solution = block(MohrCoulomb(mu, c, tangent), -p, c + mu * p, tangent * slip, slip)
    profile = solution.Profile(n=3)
    assert profile.sigma_n[1] == pytest.approx(-p) and profile.sigma_t[1] == pytest.approx(c + mu * p)
    assert solution.u(solution.body.mesh(0.5, 1 - 1e-12))[1] == pytest.approx(0, abs=1e-9)  # held


def test_a_rock_joint_with_stiffness():
    """Elastic until it slips: what it stores, and slip that stays."""
    law, p, k = MohrCoulomb(0.3, k_n=8.0, k_t=4.0), 2.0, 4.0
    problem, elastic = block(law, -p, 0.5, -p / 8, 0.5 / k)
    assert_block(elastic, -p, 0.5, -p / 8, 0.5 / k)
    assert elastic.FaceEnergy() == pytest.approx(0.5 * (p**2 / 8 + 0.5**2 / k)) and elastic.DissipatedEnergy() == 0
    _, slipped = block(law, -p, 0.6, -p / 8, 0.6 / k + 0.1, problem, previous=elastic)
    assert_block(slipped, -p, 0.6, -p / 8, 0.6 / k + 0.1)
    _, unloaded = block(law, -p, 0.0, -p / 8, 0.1, problem, previous=slipped)
    assert_block(unloaded, -p, 0.0, -p / 8, 0.1)


@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi / 2])
def test_mixed_mode_has_one_work_of_separation(angle):
    """Opening and slip in proportion: tractions S (g_n, β² g_t), and ∫f of the effective opening less the triangle."""
    strength, G_c, beta = 1.0, 0.5, 0.6
    f, integral = softening(ExponentialCohesive, strength, G_c)
    law, problem, previous, lost = ExponentialCohesive(strength, G_c, beta), None, None, 0.0
    for size in (0.1, 0.4, 0.2, 2.0, 8.0):
        gap, slip = size * np.cos(angle), size * np.sin(angle)
        d = np.hypot(gap, beta * slip)
        largest = d if size != 0.2 else 2 * d
        S = f(largest) / largest
        problem, previous = block(law, S * gap, beta**2 * S * slip, gap, slip, problem, previous=previous)
        assert_block(previous, S * gap, beta**2 * S * slip, gap, slip, 1e-10)
        lost += previous.DissipatedEnergy()
        assert lost == pytest.approx(integral(largest) - 0.5 * f(largest) * largest, rel=1e-10)
    assert previous.report.states["damaged" if f(largest) > 1e-6 else "broken"] == 1 and lost < G_c


def test_cracks_with_laws_of_their_own():
    """In one body under uniform pressure: a joint that gives way, a rock joint, and a crack that just touches."""
    p, k, v = 0.8, 4.0, 0.3
    closures, heights = (p / 5, p / (k + p / v), 0.0), (0.27, 0.52, 0.77)
    body = CrackedMesh(rectangle(0.2), *(Crack([(0, h), (1, h)]) for h in heights))
    V = CrackFESpace(body, order=2, dirichlet="bottom|top|left|right")
    problem = ContactProblem(V, TraceSpace(body, order=1), Elasticity.PlaneStrain(E=E, nu=0), law={0: Joint(1.0, 1.0, 5.0), 1: BartonBandis(k, v)})
    problem.SetDirichlet(CF((0, -p / E * y - sum(IfPos(y - h, closure, 0) for h, closure in zip(heights, closures)))), "bottom|top|left|right")
    solution = problem.Solve()
    for crack, closure in enumerate(closures):
        assert_uniform(solution, -p, -closure, 1e-11, crack)
    assert set(solution.report.states) == {"open", "closed", "sticks", "slips"}


# Fields that vary


def pull_apart(n):
    """Work of the supports by the trapezoidal rule over n load steps that lift and tilt the top, energies of the faces and of the body at the end."""
    problem = column(ExponentialCohesive(1.0, 0.05), modulus=200.0, order=2)
    problem.SetDirichlet((0, 0.5 + x), "top")
    steps, work, before = LoadSteps(problem), 0.0, 0.0
    balance = []
    lost = 0.0
    for t in np.linspace(0, 1, n + 1)[1:] ** 2:
        solution = steps.Solve(t)
        row = next(row for row in solution.Reactions() if row.name == "top")
        power = 0.5 * row.force[1] + row.moment + HEIGHT * row.force[0]  # the moment of the vertical forces alone
        work += 0.5 * (power + before[0] if before else power) * (t - (before[1] if before else 0))
        before = (power, t)
        lost += solution.DissipatedEnergy()
        balance.append(work - lost - solution.FaceEnergy() - solution.Energy())
    return work, lost, np.abs(balance).max()


def test_a_specimen_that_is_pulled_apart_costs_its_work_of_separation():
    work, lost, unbalanced = pull_apart(150)
    assert lost == pytest.approx(0.05, rel=1e-3) and work == pytest.approx(0.05, rel=5e-3)
    assert unbalanced < 2e-3 * 0.05


@pytest.mark.parametrize("order, a", [(0, 1.0), (1, 1.01)])
def test_the_strip_of_dugdale(order, a):
    """Zone to a sec(π σ / 2 σ_y), opening of the tip 8 σ_y a / (π E′) ln of that, both within 1 %; the tip is a node, or anywhere between two."""
    (mesh, corner), sigma, modulus = strip_mesh(0.025, end=2), 0.5, 100.0
    body = CrackedMesh(mesh, Crack([(0, 0), (2, 0)]))
    V = CrackFESpace(body, order=2, dirichletx="left", tip=None)
    problem = ContactProblem(V, TraceSpace(body, order=order), Elasticity.PlaneStress(modulus, 0.3), law=Dugdale(IfPos(x - a, 1.0, 0.0)))
    v = V.TestFunction()
    problem.f += CF((0, sigma)) * v * body.ds("top") + CF((0, -sigma)) * v * body.ds("bottom")
    problem.Pin(corner, "y")
    solution = problem.Solve()
    exact = dugdale_strip(a, sigma, 1.0, modulus)
    profile = solution.Profile(n=2001)
    assert np.interp(a, profile.s, profile.gap) == pytest.approx(exact.opening, rel=0.01)
    s, gap = solution.state.nodes.arclengths, solution.state.history.jump[0]
    last = s[gap > 1e-9 * gap.max()].max()
    near = (s > last - 0.15) & (s < last - 0.0375)  # the gap ends as the distance to 3/2
    roots = np.roots(np.polyfit(s[near], gap[near] ** (2 / 3), 2))
    assert roots[np.argmin(np.abs(roots - last))] - a == pytest.approx(exact.end - a, rel=0.01)


def energy_error(solution, exact):
    """Of the stress."""
    gradient = CF((exact[0].Diff(x), exact[0].Diff(y), exact[1].Diff(x), exact[1].Diff(y)), dims=(2, 2))
    difference = solution.stress - solution.problem.material.Stress(0.5 * (gradient + gradient.trans))
    return np.sqrt(Integrate(InnerProduct(difference, difference) * solution.body.dx(bonus_intorder=4), solution.body.mesh))


def boxed(law, exact, n, orders, **options):
    """The exact displacement on the boundary of a square with a crack along y = 0.02."""
    body = CrackedMesh(rectangle(1 / n, (0, -0.5), (1, 0.5)), Crack([(0, 0.02), (1, 0.02)]))
    V = CrackFESpace(body, order=orders[0], dirichlet="bottom|top|left|right")
    problem = ContactProblem(V, TraceSpace(body, order=orders[1]), Elasticity.PlaneStress(E, 0.25), law=law, **options)
    problem.SetDirichlet(exact, "bottom|top|left|right")
    return problem.Solve()


@pytest.mark.parametrize("orders, rate", [((1, 1), 1), ((2, 1), 2)])
@pytest.mark.parametrize("k", [1e6, INF])
def test_stiff_joints_tend_to_the_uncracked_body(orders, rate, k):
    """Rates of the energy for 2μ u = κ z³ - 3 z z̄², smooth across the crack."""
    kappa = (3 - 0.25) / (1 + 0.25)
    exact = CF((kappa * (x**3 - 3 * x * y**2) - 3 * x * (x**2 + y**2), kappa * (3 * x**2 * y - y**3) + 3 * y * (x**2 + y**2)))
    errors = [energy_error(boxed(Joint(k, k, k), exact, n, orders), exact) for n in (6, 24)]
    assert np.log(errors[0] / errors[1]) / np.log(4) > rate - 0.15


def joint_field(k, side):
    """σ_yy = k (1 + 0.6 x) and a joint of that stiffness that opens by 1 + 0.6 x: blocks that turn against each other."""
    s, yy = 1 + 0.6 * x, y - 0.02
    u_x = -0.25 * k * (x + 0.3 * x**2) / E - 0.3 * k * yy**2 / E - side * 0.3 * yy
    return CF((u_x, k * s * yy / E + 0.5 * side * s))


@pytest.mark.parametrize("orders, options", [((2, 2), {}), ((2, 1), {"stabilisation": Nitsche(1)})])
def test_a_joint_that_opens_linearly_is_exact(orders, options):
    """With weights that are exact for it: Simpson's of quadratic multipliers, or Gauss points."""
    solution = boxed(Joint(20.0, 3.0), joint_field(20.0, IfPos(y - 0.02, 1, -1)), 8, orders, **options)
    profile = solution.Profile(n=21)
    assert np.abs(profile.gap - (1 + 0.6 * profile.x)).max() < 1e-11 and np.abs(profile.sigma_n - 20 * (1 + 0.6 * profile.x)).max() < 1e-9


def test_weak_joints_tend_to_the_free_crack():
    """Linearly in k, on the paper's body; k = 0 is the free crack."""
    mesh = unstructured_mesh(0.1)
    free = array(paper_problem(mesh, law=Coulomb(0.0)).Solve().u.vec)
    off = [np.abs(array(paper_problem(mesh, law=Joint(k, k)).Solve().u.vec) - free).max() for k in (1e-3, 1e-5, 0.0)]
    assert off[0] == pytest.approx(100 * off[1], rel=0.05) and off[2] < 1e-12 * np.abs(free).max()


# Laws that are known, by the method for all


@pytest.mark.parametrize("law", [Coulomb(0.0), Coulomb(0.3), Tresca(0.05), Tresca(0.05, in_contact_only=True)])
def test_one_law_in_a_mapping_is_the_law(law):
    """States of nodes and Newton's method for any relation agree on the paper's body."""
    mesh = unstructured_mesh(0.06)
    one, two = paper_problem(mesh, "C", law=law).Solve(), paper_problem(mesh, "C", law={0: law}).Solve()
    assert np.abs(one.Multipliers() - two.Multipliers()).max() < 1e-10 * np.abs(one.Multipliers()).max()
    assert two.DissipatedEnergy() == pytest.approx(one.DissipatedEnergy(), rel=1e-10, abs=1e-15)


def test_a_history_of_coulomb_in_both_ways():
    """Three load steps that turn back: the same tractions and the same dissipation."""
    mesh = unstructured_mesh(0.06)
    one, two = (LoadSteps(paper_problem(mesh, "C", law=law)) for law in (Coulomb(0.3), {0: Coulomb(0.3)}))
    for t in (1, 0.4, 0.7):
        ours, theirs = two.Solve(t), one.Solve(t)
        assert np.abs(ours.Multipliers() - theirs.Multipliers()).max() < 1e-9 * np.abs(theirs.Multipliers()).max()
        assert ours.DissipatedEnergy() == pytest.approx(theirs.DissipatedEnergy(), rel=1e-8, abs=1e-15)


@pytest.mark.parametrize("before, after", [(Coulomb(0.3), {0: Coulomb(0.3)}), ({0: Coulomb(0.3)}, Coulomb(0.3))])
def test_slip_stays_when_another_method_goes_on(before, after):
    """An unchanged load changes nothing and dissipates nothing."""
    problem = paper_problem(unstructured_mesh(0.1), "C", law=before)
    first = problem.Solve()
    other = ContactProblem(problem.V, problem.W, problem.material, law=after)
    add_loads(other, "C")
    second = other.Solve(previous=first)
    assert np.abs(second.Multipliers() - first.Multipliers()).max() < 1e-10 and first.DissipatedEnergy() > 1e-6
    assert abs(second.DissipatedEnergy()) < 1e-10 * first.DissipatedEnergy()


def test_load_steps_have_one_cone():
    steps = LoadSteps(column(MohrCoulomb(0.3)))
    steps.Solve(1)
    with pytest.raises(ValueError, match="previous is a solution with the cone Nonpositive.*all load steps need the same"):
        steps.Solve(2, cone="weak")


# What travels


def test_a_history_travels_to_other_nodes():
    """Damage on a longer crack and another mesh: what was linear along the crack still is, and the new part is whole."""
    law, crack = ExponentialCohesive(1.0, 0.05), lambda end: Crack([(0, 0.5), (end, 0.5)])

    def problem(end, maxh):
        body = CrackedMesh(rectangle(maxh), crack(end))
        V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet="bottom")
        made = ContactProblem(V, TraceSpace(body, order=1), law=law)
        made.f += CF((0, 2 * (1 - x))) * V.TestFunction() * body.ds("top")
        return made

    short = problem(0.6, 0.2).Solve()
    state = pickle.loads(pickle.dumps(short.state.history))
    assert (state.jump == short.state.history.jump).all() and state.variables["opening"].max() > 0
    longer = problem(0.8, 0.15)
    nodes = longer.W.nodes
    carried = state.Carried(short.state.nodes, nodes)
    theirs, ours = short.state.nodes.arclengths, nodes.arclengths
    old = ours <= 0.6
    assert carried.variables["opening"][old] == pytest.approx(np.interp(ours[old], theirs, state.variables["opening"]), abs=1e-14)
    assert (carried.variables["opening"][ours > 0.7] == 0).all() and (carried.jump[:, ours > 0.7] == 0).all()
    solution = longer.Solve(previous=carried)
    assert (solution.state.history.variables["opening"] >= carried.variables["opening"] - 1e-15).all()
    with pytest.raises(ValueError, match="history of .* components and nodes"):
        longer.Solve(previous=state)


# What is refused


def test_coefficients_that_make_no_sense():
    for make, message in (
        (lambda: Joint(-1, 1), "Joint: k_n=-1 must be >= 0"),
        (lambda: Joint(1, float("nan")), "Joint: k_t=nan must be >= 0"),
        (lambda: LinearCohesive(1, 0), "LinearCohesive: G_c=0 must be finite and > 0"),
        (lambda: ExponentialCohesive(INF, 1), "ExponentialCohesive: strength=inf must be finite and >= 0"),
        (lambda: Dugdale(1, beta=0), "Dugdale: beta=0 must be finite and > 0"),
        (lambda: MohrCoulomb(0.3, k_n=0), "MohrCoulomb: k_n=0 must be > 0"),
        (lambda: BartonBandis(1, INF), "BartonBandis: v_m=inf must be finite and > 0"),
        (lambda: pulled(column(Dugdale(0.5 - x)), 1), "Dugdale: strength is -.* at arc length .* finite and >= 0"),
        (lambda: column({1: Joint(1, 1)}), "there is no crack 1"),
    ):
        with pytest.raises(ValueError, match=message):
            make()
    with pytest.raises(TypeError, match="neither a number nor a CoefficientFunction"):
        Joint("stiff", 1)


def test_a_law_without_relation_does_not_go_with_others():
    class Own(Frictionless):
        At = property()

    with pytest.raises(TypeError, match="the law of crack 0: law=.* has no At; docs/extending.md"):
        column({0: Own()})
    with pytest.raises(TypeError, match="the law of crack 0: law=0.3 is neither a law that holds node by node"):
        column({0: 0.3})


def test_a_process_zone_that_the_mesh_does_not_resolve_warns():
    """E G_c / strength² against the elements: by how much to refine; the mesh that is asked for does not warn."""

    def solved(maxh):
        body = CrackedMesh(rectangle(maxh), Crack([(0, 0.5), (1, 0.5)]))
        V = CrackFESpace(body, order=1, dirichlet="bottom|top")
        problem = ContactProblem(V, TraceSpace(body, order=0), Elasticity.PlaneStrain(E=E, nu=0), law=LinearCohesive(1.0, 0.01))
        problem.SetDirichlet((0, 0.01), "top")
        return problem.Solve()

    with pytest.warns(AccuracyWarning, match="soften within 0.2, less than an element .* at arc length .* nodes break one by one") as warned:
        solved(0.4)
    h = float(re.search(r"refine to h <= ([\d.]+) along", str(warned[0].message))[1])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solved(h)


def test_the_report_has_the_states_of_the_faces():
    problem = column(LinearCohesive(1.0, 0.05), modulus=100.0)
    text = str(pulled(problem, 0.05).report)
    assert "0 % intact, 100 % damaged, 0 % broken" in text and "dissipated in this step" in text and "Newton iterations" in text
