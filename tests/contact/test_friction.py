"""Friction: the nodal Newton method by enumeration, closed forms, load steps, the fitted references, and bad input."""

from itertools import product

import numpy as np
import pytest
from helpers import MATERIAL, OFFSET, array, matrix, rotated_problem
from ngsolve import CF, BilinearForm, Id, IfPos, InnerProduct, Integrate, Parameter, Trace, sin, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Slip, Strain, TipEnrichment, TraceSpace
from ngsxfem_contact.algebra import FixedPoint, FullNewton
from ngsxfem_contact.algebra.compliance import Compliance
from ngsxfem_contact.algebra.matrices import to_scipy
from ngsxfem_contact.algebra.nodal_methods import safeguarded
from ngsxfem_contact.algebra.nodal_newton import (
    FREE,
    SLIP_MINUS,
    SLIP_PLUS,
    STICK,
    States,
    Threshold,
    _by_block,
    _by_inverse,
    first_states,
    solve_states,
    uniqueness_number,
    violation,
)  # fmt: skip
from ngsxfem_contact.contact import BarbosaHughes, Coercivity, ContactProblem, Coulomb, LoadSteps, Tresca
from ngsxfem_contact.contact.load_case import LoadCase
from ngsxfem_contact.contact.options import StepOptions
from ngsxfem_contact.contact.report import contraction
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.errors import NotCoercive, NotConverged
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import BODY_FORCE, FRICTION_REFERENCE, PAIRS, TRACTION, paper_problem, unstructured_mesh

MESH = unstructured_mesh(0.06)


def errors(solution, exact):
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), cf.shear_error(solution, exact)


def coarse(load="C", **options):
    return paper_problem(MESH, load, **options)


# The nodal Newton method against enumeration of all states


def random_problem(rng, m, coupling=1.0):
    A = rng.standard_normal((2 * m, 2 * m))
    A[m:, :m] *= coupling
    A[:m, m:] *= coupling
    return A @ A.T + 1e-2 * np.eye(2 * m), rng.standard_normal(2 * m)


def enumerated(Q, q, threshold):
    """All solutions, by trying all states."""
    m, found, compliance = len(q) // 2, [], Compliance(Q)
    for contact in product([False, True], repeat=m):
        for tangential in product([STICK, SLIP_PLUS, SLIP_MINUS], repeat=m):
            p, w = solve_states(compliance, q, threshold, States(np.array(contact), np.array(tangential)))
            scales = np.repeat([np.abs(p).max(), np.abs(w).max()], 1) + 1e-300
            if violation(p / scales[0], w / scales[1], threshold.Scaled(scales[0])) < 1e-10:
                if not any(np.allclose(p, other, atol=1e-8 * scales[0]) for other in found):
                    found.append(p)
    return found


def tresca_law(rng, m):
    return Threshold(rng.uniform(0, 1, m), np.zeros(m))


def coulomb_law(rng, m, mu_f):
    return Threshold(np.zeros(m), mu_f * rng.uniform(0.5, 1, m))


def solved(method, Q, q, threshold, start=None):
    m = len(q) // 2
    contact = np.zeros(m, dtype=bool) if start is None else start
    compliance = Compliance(Q)
    return method.Solve(compliance, q, threshold, 1 / np.diag(Q), first_states(compliance, q, threshold, contact), 100)


@pytest.mark.parametrize("m", [1, 2, 3])
def test_given_thresholds_have_one_solution_and_it_is_found(m):
    rng = np.random.default_rng(m)
    for _ in range(20):
        Q, q = random_problem(rng, m)
        law = tresca_law(rng, m)
        (exact,) = enumerated(Q, q, law)
        for start in (None, np.ones(m, dtype=bool)):
            assert solved(FullNewton(), Q, q, law, start).p == pytest.approx(exact, rel=1e-7, abs=1e-9)


def test_equations_by_block_and_by_inverse_are_the_same():
    """Of the unknown tractions, or of the jumps elsewhere; some nodes slip as Coulomb's law says."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        Q, q = random_problem(rng, 10)
        skew = rng.standard_normal((20, 20))
        contact, slips = rng.random(10) < 0.6, rng.random(10) < 0.5
        unknown = np.concatenate([contact, ~slips])
        base, follows = np.concatenate([np.zeros(10), slips * rng.standard_normal(10)]), slips * contact * rng.uniform(-0.5, 0.5, 10)
        arguments = Compliance(Q + skew - skew.T), q, base, follows, unknown
        expected = _by_block(*arguments)
        expected[10:] += follows * expected[:10]
        assert _by_inverse(*arguments) == pytest.approx(expected, rel=1e-7, abs=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("m", [1, 2, 3])
def test_the_path_finds_what_enumeration_finds(m):
    """The safeguard alone, for symmetric matrices and for others that are positive definite; some thresholds are zero."""
    rng = np.random.default_rng(20 + m)
    for i in range(20):
        Q, q = random_problem(rng, m)
        skew = rng.standard_normal((2 * m, 2 * m)) * (i % 2)
        law = Threshold(rng.uniform(0, 1, m) * (rng.random(m) < 0.8), np.zeros(m))
        (exact,) = enumerated(Q + skew - skew.T, q, law)
        start = States(rng.random(m) < 0.5, np.where(law.base > 0, STICK, FREE))
        result = safeguarded(Compliance(Q + skew - skew.T), q, law.base, start)
        assert result.p == pytest.approx(exact, rel=1e-7, abs=1e-9)


def test_a_cycle_is_left_by_the_safeguard():
    """The frictionless cycle of tests/contact/test_contact.py as the normal part, s = 0."""
    Q = np.eye(6)
    Q[:3, :3] = [[3.0, -4, -4], [-4, 14, 21], [-4, 21, 34]]
    q = np.array([-4.0, 5, 1, 0, 0, 0])
    result = solved(FullNewton(), Q, q, Threshold(np.zeros(3), np.zeros(3)))
    assert result.fallback > 0
    assert result.p == pytest.approx([0, -5 / 14, 0, 0, 0, 0])


def test_a_fixed_point_ends_where_only_round_off_is_left():
    """With a condition of 1e12 the thresholds repeat to 1e-12 by chance only; the law itself is met by the last Newton step."""
    rng, m = np.random.default_rng(5), 6
    law = coulomb_law(rng, m, 0.3)
    for _ in range(10):
        basis = np.linalg.qr(rng.standard_normal((2 * m, 2 * m)))[0]
        Q = basis * 10.0 ** rng.uniform(-12, 0, 2 * m) @ basis.T
        q = Q @ rng.uniform(0, 1, 2 * m)
        p = solved(FixedPoint(max_iterations=500), Q, q, law).p
        pressure, force = np.abs(p).max(), np.abs(q).max()
        assert violation(p / pressure, (Q @ p + q) / force, law.Scaled(pressure)) < 1e-9


@pytest.mark.parametrize("method", [FullNewton(), FixedPoint()])
@pytest.mark.parametrize("m", [1, 2, 3])
def test_coulomb_finds_a_solution_of_enumeration_or_says_so(method, m):
    rng = np.random.default_rng(10 + m)
    missed = 0
    for _ in range(20):
        Q, q = random_problem(rng, m)
        law = coulomb_law(rng, m, 0.5)
        exact = enumerated(Q, q, law)
        assert exact  # the discrete problem has a solution for every coefficient
        try:
            result = solved(method, Q, q, law)
            assert any(np.allclose(result.p, p, rtol=1e-7, atol=1e-9) for p in exact)
        except NotConverged:
            missed += 1
    assert missed <= 2


def test_number_below_one_means_one_solution():
    """And the number is not always below one: several solutions exist for some of these."""
    rng, proved, several = np.random.default_rng(0), 0, 0
    for i in range(60):
        Q, q = random_problem(rng, 2, coupling=(0.05, 1)[i % 2])
        law = coulomb_law(rng, 2, (0.3, 3)[(i // 2) % 2])
        number, count = uniqueness_number(Q, law.slope), len(enumerated(Q, q, law))
        if number < 1:
            proved += 1
            assert count == 1
        several += count > 1
    assert proved >= 10 and several >= 1


def test_states_of_a_report_are_those_of_the_solution():
    solution = paper_problem(unstructured_mesh(0.03), "C", law=Tresca(0.05)).Solve()
    p_n, p_t = np.split(solution.Multipliers(), 2)
    contact, states = solution.report.active[-1], solution.report.tangential[-1]
    assert (p_n[contact] < 0).all() and (p_n[~contact] == 0).all()
    assert (p_t[states == SLIP_MINUS] == -0.05).all() and (np.abs(p_t[states == STICK]) < 0.05).all()
    assert solution.report.Counts()["stick"] == (states == STICK).sum() > 0
    assert "slip-" in str(solution.report) and "method" in str(solution.report)


# Matrices and signs


def stress_by_hand(v):
    strain = Strain(v, "larger")
    return Trace(strain) * Id(2) + 2 * strain


def test_assembled_matrices_with_friction():
    """K - K_γ loses ∫γ σ(u)n·σ(v)n; the tangential rows are -∫γψ(g_t/γ + R_t)."""
    problem = coarse(law=Tresca(1), stabilisation=BarbosaHughes(gamma0=0.01))
    system, V, W, body = problem.Assemble(), problem.V, problem.W, problem.body
    plain = coarse(stabilisation=None).Assemble()
    (u, v), (lam, mu) = V.TnT(), W.TnT()
    K_gamma = matrix(system.gamma * InnerProduct(stress_by_hand(u) * body.normal, stress_by_hand(v) * body.normal) * body.dcrack)
    difference = to_scipy(plain.stiffness) - to_scipy(system.stiffness)
    assert abs(difference - K_gamma).max() < 1e-12 * abs(K_gamma).max()
    coupling = BilinearForm(trialspace=V, testspace=W)
    coupling += -mu * (InnerProduct(Jump(u), body.tangent) + system.gamma * InnerProduct(stress_by_hand(u) * body.normal, body.tangent)) * body.dcrack
    E_t, m = to_scipy(coupling.Assemble().mat), W.ndof
    assert abs(system.E[m:] - E_t).max() < 1e-13 * abs(E_t).max()
    mass = matrix(system.gamma * lam * mu * body.dcrack)
    assert abs(system.D[m:, m:] - mass).max() < 1e-14 * abs(mass).max() and abs(system.D[:m, m:]).max() == 0


@pytest.mark.parametrize("pair", ["P2/P1", "P1/P0"])
def test_automatic_gamma_is_coercive_with_friction(pair):
    for theta in (0.25, 0.9):
        coercivity = Coercivity(coarse(pair=pair, law=Coulomb(0.3), stabilisation=BarbosaHughes(theta=theta)))
        assert 1 - theta - 1e-3 <= coercivity < 1


def test_gamma0_is_refused_where_coercivity_ends_with_friction():
    largest = 1e-3 / (1 - Coercivity(coarse(law=Tresca(1), stabilisation=BarbosaHughes(1e-3))))
    with pytest.raises(NotCoercive, match="is too large"):
        coarse(law=Tresca(1), stabilisation=BarbosaHughes(1.01 * largest)).Solve()
    assert coarse(law=Tresca(1), stabilisation=BarbosaHughes(0.99 * largest)).Solve().report.converged


def test_solution_satisfies_equilibrium_of_each_part():
    """A crack through the body: the tractions on the upper part, λ_n and λ_t, balance its loads."""
    body = CrackedMesh(unstructured_mesh(0.1), Crack([(0, 0.013), (1, 0.013)]))
    V = CrackFESpace(body, order=2, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body), MATERIAL, law=Coulomb(0.5))
    v = V.TestFunction()
    problem.f += CF((0.03, -0.2)) * v * body.ds("top")
    problem.Pin((0, 0.5), "xy", (0.1, -0.05))
    problem.Pin((1, 0.5), "y", -0.05)
    solution, system = problem.Solve(), problem.Assemble()
    reactions = (system.Stiffness(array(solution.u.vec)) - system.E.T @ solution.Multipliers() - array(problem.f.Assemble().vec))[problem.pinned]
    assert 0 < solution.TangentialForce() <= -0.5 * solution.ContactForce() + 1e-12
    assert reactions[0] + 0.03 == pytest.approx(solution.TangentialForce(), rel=1e-8)
    assert reactions[1] + reactions[2] - 0.2 == pytest.approx(solution.ContactForce(), rel=1e-8)


# Closed forms


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("pair", PAIRS)
def test_a_sticking_crack_under_uniform_stress_is_the_uncracked_body(pair, sign):
    exact = cf.uniform_stress(MATERIAL, 0.3, 0.4 * sign, -1)
    for friction in (Coulomb(0.5), Tresca(0.5)):
        solution = rotated_problem(exact, PAIRS[pair], 0.2, law=friction).Solve()
        assert max(errors(solution, exact)) < 1e-10
        assert np.abs(solution.Profile().slip).max() < 1e-10
        assert (solution.report.tangential[-1] == STICK).all() and len(solution.SlipTransitions()) == 0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("law", [Tresca(0.25), Tresca(0.25, in_contact_only=True), Coulomb(0.25), Coulomb(0.25, FixedPoint()), Coulomb(0.25 + 0 * x)])
def test_a_crack_through_the_body_slides_at_its_threshold(sign, law):
    """Uniform compression 1 and shear 0.25 on both blocks, given displacements that shift them by 0.1: λ_t = ±0.25."""
    exact = cf.uniform_stress(MATERIAL, 0.3, 0.25 * sign, -1)
    shifted = cf.ClosedForm(exact.u + CF((0.05 * sign, 0)) * _side(), exact.stress, exact.pressure, exact.gap, exact.shear, CF(0.1 * sign))
    solution = rotated_problem(shifted, PAIRS["P2/P1"], 0.2, through=True, law=law).Solve()
    assert max(errors(solution, shifted)) < 1e-9 and cf.slip_error(solution, shifted) < 1e-9
    assert (solution.report.tangential[-1] == sign).all()
    start, end = cf.mouths(0.41, OFFSET)
    assert solution.DissipatedEnergy() == pytest.approx(0.25 * 0.1 * (end - start), rel=1e-8)
    assert solution.TangentialForce() == pytest.approx(0.25 * sign * (end - start), rel=1e-9)


def _side():
    return IfPos(y, 1, -1)


def test_slip_at_a_sliding_tip_converges():
    """A quick version of benchmarks/friction.py e."""
    exact, tip = cf.sliding_tip(MATERIAL, 0.3), TipEnrichment(r1=0.4, material=MATERIAL)
    found = []
    for maxh in (0.1, 0.04):
        solution = rotated_problem(exact, PAIRS["P2/P1"], maxh, tip=tip, law=Coulomb(0.3)).Solve()
        assert (solution.report.tangential[-1] == SLIP_PLUS).all() and solution.report.iterations <= 15
        found.append((*errors(solution, exact), cf.slip_error(solution, exact), abs(solution.StressIntensity().K_II - 1)))
    coarser, finer = np.array(found)
    assert (finer < np.array([0.4**1.2, 0.4, 0.4, 0.4**1.5, 0.4]) * coarser).all()


@pytest.mark.parametrize(("pair", "rates"), [("P2/P1", (1.8, 1.5, 1.5)), ("P1/P0", (0.9, 0.8, 0.8))])
def test_rates_of_a_sticking_crack(pair, rates):
    exact, maxhs = cf.sticking_crack(MATERIAL), [0.1, 0.05, 0.025]
    means = [np.mean([errors(rotated_problem(exact, PAIRS[pair], h, a, law=Coulomb(2)).Solve(), exact) for a in (0.41, 0.23)], axis=0) for h in maxhs]
    slopes = np.polyfit(np.log(maxhs), np.log(means), 1)[0]
    assert (slopes > rates).all()


# The fitted references


LAWS = {"Coulomb 0.3": Coulomb(0.3), "Tresca 0.05": Tresca(0.05)}


@pytest.mark.parametrize("name", FRICTION_REFERENCE)
def test_fitted_reference(name):
    """maxh = 0.03, P2/P1: energies to 5e-4, transitions within an element."""
    load, law = name.split(", ")
    exact = FRICTION_REFERENCE[name]
    solution = paper_problem(unstructured_mesh(0.015), load, law=LAWS[law]).Solve()
    assert abs(solution.Energy() - exact["energy"]) < 5e-4 * exact["energy"]
    assert abs(solution.DissipatedEnergy() - exact["friction_work"]) < 5e-4 * exact["energy"]
    assert solution.Transitions() == pytest.approx([exact["transition"]], abs=0.03)
    assert solution.SlipTransitions() == pytest.approx([exact["slip_transition"]] if exact["slip_transition"] else [], abs=0.03)
    assert solution.ContactForce() == pytest.approx(exact["contact_force"], rel=0.005)
    assert solution.TangentialForce() == pytest.approx(exact["tangential_force"], rel=0.005, abs=1e-5)
    assert solution.report.iterations <= 15
    profile = solution.Profile()
    assert (np.abs(profile.sigma_t) <= (0.05 if "Tresca" in law else 0.3 * np.abs(profile.sigma_n)) + 1e-12).all()


# Laws and methods against each other


def test_fixed_point_and_full_newton_agree():
    newton, fixed = (coarse(law=Coulomb(0.3, method)).Solve() for method in (FullNewton(), FixedPoint()))
    assert np.abs(newton.Multipliers() - fixed.Multipliers()).max() < 1e-9 * np.abs(newton.Multipliers()).max()
    changes = fixed.report.threshold_changes
    assert 1 < len(changes) < 20 and changes[-1] <= 1e-12
    assert f"last changes {' '.join(f'{c:.1e}' for c in changes[-3:])}, factor {contraction(changes):.2g}" in str(fixed.report)
    assert "fixed point" in fixed.report.method and "full" in newton.report.method and newton.report.uniqueness < 1


def test_contraction_is_the_mean_factor_above_round_off():
    assert contraction([5, 1, 0.1, 0.01, 1e-3, 1e-15]) == pytest.approx(0.1)
    assert contraction([1, 1e-14]) == 0


def test_no_friction_coefficient_is_frictionless():
    """The stabilisation of λ_t = 0 is what remains."""
    plain = coarse(stabilisation=None).Solve()
    for friction in (Coulomb(0), Tresca(0)):
        solution = coarse(stabilisation=None, law=friction).Solve()
        assert np.abs(array(solution.u.vec) - array(plain.u.vec)).max() < 1e-11 * np.abs(array(plain.u.vec)).max()
        assert solution.DissipatedEnergy() == 0 and not array(solution.tangential_multiplier.vec).any()


def test_a_large_threshold_sticks():
    stuck, glued = (coarse(law=Tresca(s), load="C").Solve() for s in (10, 100))
    assert (stuck.report.tangential[-1] == STICK).all()
    assert stuck.Energy() == pytest.approx(glued.Energy(), rel=1e-10) and abs(stuck.DissipatedEnergy()) < 1e-15


def test_threshold_in_contact_only():
    """Free where open; energy between that without friction and that with the threshold on the whole crack."""
    contact_only, whole, none = (coarse(law=law).Solve() for law in (Tresca(0.05, in_contact_only=True), Tresca(0.05), None))
    states, contact = contact_only.report.tangential[-1], contact_only.report.active[-1]
    assert (states[~contact] == FREE).all() and (states[contact] != FREE).all()
    assert whole.Energy() < contact_only.Energy() < none.Energy()
    assert contact_only.report.uniqueness is None and "not known" in str(contact_only.report)


@pytest.mark.parametrize("pair", ["P2/P0", "P2/P1"])
def test_weak_cone_with_friction(pair):
    """The same for constants; for P1 another discretisation of the same problem."""
    for law in LAWS.values():
        strong, weak = (coarse(pair=pair, cone=cone, law=law).Solve() for cone in ("nonpositive", "weak"))
        assert weak.Energy() == pytest.approx(strong.Energy(), rel=1e-10 if pair == "P2/P0" else 1e-3)
        assert weak.DissipatedEnergy() == pytest.approx(strong.DissipatedEnergy(), rel=1e-8 if pair == "P2/P0" else 0.03)


def test_functions_as_coefficients():
    """μ_f and s as functions; where they vanish the crack is free of shear."""
    law = Coulomb(0.3 + 0.2 * sin(20 * x))
    solution = coarse(law=law).Solve()
    p_n, p_t = np.split(solution.Multipliers(), 2)
    s = np.concatenate(solution.problem.W.NodalPositions())
    slips = np.abs(solution.report.tangential[-1]) == 1
    assert slips.any() and np.abs(p_t)[slips] == pytest.approx(np.abs(p_n)[slips] * (0.3 + 0.2 * np.sin(20 * s[slips])))


def test_orientation_of_the_crack_does_not_matter_with_friction():
    found = []
    for points in ([(0, 0), (0.5, 0)], [(0.5, 0), (0, 0)]):
        body = CrackedMesh(MESH, Crack(points))
        V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL))
        problem = ContactProblem(V, TraceSpace(body), MATERIAL, law=Tresca(0.05))
        v = V.TestFunction()
        problem.f += BODY_FORCE * v * body.dx(bonus_intorder=6) + TRACTION["C"] * v * body.ds("left|right", bonus_intorder=6)
        problem.Pin((1, -0.5), "xy")
        problem.Pin((1, 0.5), "x")
        found.append(problem.Solve())
    forwards, backwards = found
    for name in ("slip", "sigma_t", "sigma_n"):
        ours, theirs = getattr(forwards.Profile(), name), getattr(backwards.Profile(), name)[::-1]
        assert np.abs(ours - theirs).max() < 1e-8 * np.abs(theirs).max()


def test_answer_does_not_depend_on_start():
    problem = coarse(law=Coulomb(0.3))
    reference = problem.Solve().Multipliers()
    other = problem.Solve(start=np.ones(problem.W.ndof, dtype=bool)).Multipliers()
    assert np.abs(other - reference).max() < 1e-9 * np.abs(reference).max()


@pytest.mark.parametrize("factor", [1e-2, 1e2])
def test_answer_of_newton_does_not_depend_on_r(factor):
    """The parameter of the projection (39), which the nodal methods take."""
    reduced = ReducedProblem(problem := coarse(law=Coulomb(0.3)))
    T, balance = reduced.Signs(problem.cone)
    Q = balance.compliance
    q, threshold = T.T @ (reduced.case.g - reduced.system.G), problem.law.Threshold(problem.W.nodes, problem.cone)
    start = first_states(Q, q, threshold, np.zeros(problem.W.ndof, dtype=bool))
    usual, other = (FullNewton().Solve(Q, q, threshold, r / Q.diagonal, start, 100).p for r in (1, factor))
    assert np.abs(other - usual).max() < 1e-9 * np.abs(usual).max()


# Load steps


def sheared_blocks(friction):
    """Two blocks under pressure 1, their tops and bottoms displaced by ±shift/2: linear fields, one slip."""
    material = Elasticity(lam=0, mu=1)
    body = CrackedMesh(unstructured_mesh(0.1), Crack([(0, 0.013), (1, 0.013)]))
    V = CrackFESpace(body, order=1, dirichlet="top|bottom|left|right")
    return ContactProblem(V, TraceSpace(body), material, law=friction)


def shear(problem, shift, previous=None):
    """Boundary values of blocks with σ_xy = τ and a slip d: u_x = τ y/μ ± d/2; here d from the law, as a step of ideal plasticity."""
    tau, slip = shear.law(shift, shear.state if previous is not None else 0.0)
    shear.state = slip
    u = CF((tau * y + 0.5 * slip * IfPos(y - 0.013, 1, -1), -0.5 * y))
    problem.SetDirichlet(u, "top|bottom|left|right")
    return problem.Solve(previous=previous), tau, slip


def plastic(shift, slip, threshold=0.25):
    """A slider in series with a spring of stiffness 1."""
    trial = shift - slip
    return (trial, slip) if abs(trial) <= threshold else (threshold * np.sign(trial), shift - threshold * np.sign(trial))


def test_loading_and_unloading_differ():
    """A cycle of shear follows the slider: hysteresis, residual slip, the work of each step that of the slider."""
    shear.law = plastic
    for friction in (Coulomb(0.25), Tresca(0.25)):
        problem, previous, old = sheared_blocks(friction), None, 0.0
        for shift in (0.2, 0.5, 0.5, 0.3, 0.0, -0.4, 0.0):
            solution, tau, slip = shear(problem, shift, previous)
            profile = solution.Profile()
            assert profile.slip == pytest.approx(slip * np.ones(200), abs=1e-9)
            assert profile.sigma_t == pytest.approx(tau * np.ones(200), abs=1e-9)
            assert solution.DissipatedEnergy() == pytest.approx(abs(slip - old) * 0.25, abs=1e-9)
            previous, old = solution, slip
        assert slip == pytest.approx(-0.15)  # what is left where a single step would be free of slip


def scaled_problem(friction, scale):
    """Load C times a Parameter."""
    body = CrackedMesh(MESH, Crack([(0, 0), (0.5, 0)]))
    V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL))
    problem = ContactProblem(V, TraceSpace(body), MATERIAL, law=friction)
    v = V.TestFunction()
    problem.f += BODY_FORCE * v * body.dx(bonus_intorder=6) + scale * TRACTION["C"] * v * body.ds("left|right", bonus_intorder=6)
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    return problem


def test_an_unchanged_load_changes_nothing():
    problem = scaled_problem(Coulomb(0.3), Parameter(1))
    first = problem.Solve()
    second = problem.Solve(previous=first)
    assert np.abs(second.Multipliers() - first.Multipliers()).max() < 1e-9 * np.abs(first.Multipliers()).max()
    assert abs(second.DissipatedEnergy()) < 1e-10 * first.DissipatedEnergy()
    assert second.report.iterations <= 3


@pytest.mark.parametrize("n", [2, 3])
def test_the_work_of_growing_thresholds_is_that_of_the_trapezoidal_rule(n):
    """Under proportional loads λ_t and the slip grow together, W = ½ λ_t g_t; only the first step, whose path is not known, counts twice that, and says so."""
    problem = scaled_problem(Coulomb(0.3), Parameter(1))
    whole, steps = problem.Solve(), LoadSteps(problem)
    assert whole.DissipationError() == pytest.approx(0.5 * whole.DissipatedEnergy(), rel=1e-9) and whole.DissipatedEnergy() > 0
    history = [steps.Solve((i + 1) / n) for i in range(n)]
    end_points = lambda s: s.DissipatedEnergy() + s.DissipationError()
    assert sum(s.DissipatedEnergy() for s in history) == pytest.approx(0.5 * (1 + 1 / n**2) * whole.DissipatedEnergy(), rel=1e-6)
    assert sum(end_points(s) for s in history[1:]) == pytest.approx(sum(2 * (i + 1) / n**2 for i in range(1, n)) * 0.5 * whole.DissipatedEnergy(), rel=1e-6)


def test_unloading_leaves_slip_and_dissipates():
    """Each step's work is ≥ 0 and the steps' sum is the loads' work less the energy kept, by the trapezoidal rule of the path."""
    scale = Parameter(1)
    reduced = ReducedProblem(problem := scaled_problem(Coulomb(0.3), scale))
    loaded = solution = reduced.Solve()
    works = [solution.DissipatedEnergy()]
    for value in (0.8, 0.4, 0.0):
        scale.Set(value)
        solution = reduced.Solve(StepOptions(previous=solution), reduced.Reduce(LoadCase(problem)))
        works.append(solution.DissipatedEnergy())
    again = problem.Solve()  # in one step from zero: no slip by symmetry but for the mesh
    assert min(works) >= 0 and works[0] > 0 and max(works[1:]) > 0
    slip = lambda s: np.abs(s.Profile().slip).max()
    assert 0.01 * slip(loaded) < slip(solution) < 0.5 * slip(loaded) and slip(solution) > 5 * slip(again)


def test_next_step_is_the_step_of_a_new_problem():
    scale = Parameter(1)
    problem = scaled_problem(Tresca(0.03), scale)
    reduced = ReducedProblem(problem)
    first = reduced.Solve()
    scale.Set(0.2)
    ours = reduced.Solve(StepOptions(previous=first), reduced.Reduce(LoadCase(problem))).Multipliers()
    theirs = problem.Solve(previous=first).Multipliers()
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_energy_balance_of_a_step():
    """F·U = 2 ½a(u,u) + ∫λ_t g_t + ∫λ g_n, the last zero: exact without stabilisation."""
    problem = coarse(law=Coulomb(0.3), stabilisation=None)
    solution = problem.Solve()
    system, U, F = problem.Assemble(), array(solution.u.vec), array(problem.f.Assemble().vec)
    assert F @ U == pytest.approx(U @ system.Stiffness(U) + solution.DissipatedEnergy(), rel=1e-12)
    assert F @ U == pytest.approx(2 * solution.Energy() + solution.DissipatedEnergy(), rel=1e-6)  # rules of different order
    direct = Integrate(solution.tangential_multiplier * Slip(solution.u, solution.body) * solution.problem.W.dcrack, solution.body.mesh)
    assert solution.DissipatedEnergy() == pytest.approx(direct, rel=1e-10)


# Bad input


@pytest.mark.parametrize("law", [Tresca, Coulomb])
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_numbers_that_are_no_threshold(law, value):
    with pytest.raises(ValueError, match="must be a finite number >= 0"):
        law(value)


@pytest.mark.parametrize("law", [Tresca, Coulomb])
def test_functions_that_are_no_threshold(law):
    with pytest.raises(TypeError, match="neither a number nor a CoefficientFunction"):
        law("rough")
    with pytest.raises(ValueError, match="must be a scalar"):
        law(CF((x, y)))
    with pytest.raises(ValueError, match=r"at arc length .* must be finite and >= 0 on the whole crack"):
        coarse(law=law(0.25 - x)).Solve()


def test_other_objects_are_refused():
    with pytest.raises(TypeError, match="neither a law such as Coulomb"):
        coarse(law=0.3)
    with pytest.raises(TypeError, match="neither FullNewton"):
        Coulomb(0.3, method="newton")
    with pytest.raises(ValueError, match="another number of multipliers"):
        coarse(law=Coulomb(0.3)).Solve(previous=coarse(law=None).Solve())


def test_too_few_iterations_raise():
    with pytest.raises(NotConverged, match="still changed after 1 iterations"):
        coarse(law=Coulomb(0.3)).Solve(max_iterations=1)
    with pytest.raises(NotConverged, match="does not contract|no or several"):
        coarse(law=Coulomb(0.3, FixedPoint(max_iterations=2))).Solve()


def test_friction_is_another_name_of_law():
    problem = coarse(law=Coulomb(0.3))
    named = ContactProblem(problem.V, problem.W, problem.material, friction=Coulomb(0.3))
    assert named.law == problem.law
    with pytest.raises(TypeError, match="friction= and law= both"):
        ContactProblem(problem.V, problem.W, problem.material, law=Coulomb(0.3), friction=Coulomb(0.3))
