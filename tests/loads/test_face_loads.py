"""Tractions on the faces, given stresses, elastic joints: what λ is compared with, exact where the solution is in the spaces."""

from functools import cache

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import BND, CF, BilinearForm, Grad, GridFunction, IfPos, InnerProduct, Integrate, Parameter, Sym, VectorH1, ds, dx, exp, specialcf, sqrt, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import BarbosaHughes, BothSides, ContactProblem, Coulomb, LoadCase, LoadSteps, Nitsche
from ngsxfem_contact.exact import fracture_solutions as fs
from ngsxfem_contact.exact.closed_forms import open_tip
from ngsxfem_contact.operators import NormalGap
from study.paper import PAIRS

MATERIAL = Elasticity.PlaneStrain(E=1, nu=0.3)
THROUGH, INSIDE, ARC = Crack([(0, 0.47), (1, 0.52)]), Crack([(0.21, 0.47), (0.8, 0.52)]), Crack.Arc((0.2, 0.45), (0.5, 0.55), (0.8, 0.45))
METHODS = {"larger": BarbosaHughes(), "both sides": BothSides(1e-2, 0.5), "θ = 1": Nitsche(1), "θ = 0": Nitsche(0), "θ = -1": Nitsche(-1)}


@cache
def square(maxh=0.15):
    return rectangle(maxh)


def problem(crack=THROUGH, pair="P2/P1", held=".*", stabilisation=None, mesh=None, material=MATERIAL, tip=None, **options):
    body = CrackedMesh(mesh or square(), *(crack if isinstance(crack, tuple) else (crack,)))
    V = CrackFESpace(body, order=PAIRS[pair].order, bubble=PAIRS[pair].bubble, tip=tip, dirichlet=held)
    W = TraceSpace(body, order=PAIRS[pair].multiplier_order)
    return ContactProblem(V, W, material, stabilisation=stabilisation or BarbosaHughes(), **options)


def errors(solution, pressure, shear=None, n=41):
    """Of λ, λ_t and the gap along all cracks."""
    found = []
    for crack in range(len(solution.body.cracks)):
        profile = solution.Profile(crack=crack, n=n)
        at = lambda f: np.array([f(a, b) for a, b in zip(profile.x, profile.y)])
        found += [np.abs(profile.sigma_n - at(pressure)).max(), np.abs(profile.gap).max()]
        found += [np.abs(profile.sigma_t - at(shear)).max()] if shear else []
    return max(found)


# Patches: the exact solution is in all spaces


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("method", METHODS)
def test_pressure_in_a_closed_joint(pair, method):
    """A confining stress 1 against a pressure 0.6 in the joint: λ = -0.4 and no gap."""
    joint = problem(pair=pair, held="bottom|top", stabilisation=METHODS[method], material=Elasticity.PlaneStrain(E=1, nu=0))
    v = joint.V.TestFunction()
    joint.f += -v * specialcf.normal(2) * joint.body.ds("left|right")
    joint.SetDirichlet((-x, -y), "bottom|top")
    joint.FacePressure(0.6)
    assert errors(joint.Solve(), lambda a, b: -0.4) < 1e-10


@pytest.mark.parametrize("pair", [name for name, pair in PAIRS.items() if pair.multiplier_order == 1])
@pytest.mark.parametrize("method", METHODS)
def test_tractions_that_vary_along_a_joint_that_sticks(pair, method):
    """In a clamped body: u = 0, λ and λ_t are what is given, linear along the crack."""
    body = problem(pair=pair, stabilisation=METHODS[method], law=Coulomb(5))
    t, n = body.body.tangent, body.body.normal
    body.FaceTraction(plus=-(1 + x) * n - 0.3 * y * t, minus=(1 + x) * n + 0.3 * y * t)
    assert errors(body.Solve(), lambda a, b: -1 - a, lambda a, b: -0.3 * b) < 1e-10


@pytest.mark.parametrize("pair", [name for name, pair in PAIRS.items() if pair.multiplier_order == 1])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("by_term", [False, True], ids=["initial_stress", "term in f"])
def test_a_clamped_body_with_an_initial_stress(pair, method, by_term):
    """σ⁰ in equilibrium, linear: u = 0, λ = n·σ⁰n and λ_t = t·σ⁰n on a crack that sticks."""
    given = CF((-2 + 0.3 * y, 0.1, 0.1, -1 + 0.3 * x), dims=(2, 2))
    clamped = problem(pair=pair, stabilisation=METHODS[method], law=Coulomb(5), initial_stress=None if by_term else given)
    if by_term:
        clamped.f += -InnerProduct(given, Grad(clamped.V.TestFunction())) * clamped.body.dx
    solution = clamped.Solve()
    tx, ty = clamped.body.cracks[0].TangentAt(0)
    at = lambda a, b: np.array([[-2 + 0.3 * b, 0.1], [0.1, -1 + 0.3 * a]])
    pressure, shear = (lambda a, b: np.array([-ty, tx]) @ at(a, b) @ [-ty, tx]), (lambda a, b: np.array([tx, ty]) @ at(a, b) @ [-ty, tx])
    assert errors(solution, pressure, shear) < 1e-10
    assert np.allclose(np.reshape(solution.stress(square()(0.3, 0.8)), (2, 2)), at(0.3, 0.8), atol=1e-10)


@pytest.mark.parametrize("make, factor", [(Elasticity.PlaneStrain, 1 / (1 - 0.6)), (Elasticity.PlaneStress, 1 / (1 - 0.3))])
def test_heating_of_a_clamped_plate(make, factor):
    heated = problem(INSIDE, material=make(E=200, nu=0.3, alpha=1e-3), temperature=7).Solve()
    right = -200 * 1e-3 * 7 * factor
    assert errors(heated, lambda a, b: right) < 1e-10 * abs(right)
    zz = right if make is Elasticity.PlaneStrain else 0  # hydrostatic in plane strain
    assert heated.VonMises()(square()(0.3, 0.8)) == pytest.approx(abs(right - zz), abs=1e-10)


def test_heating_of_one_region_only_counts_where_its_material_expands():
    with pytest.raises(ValueError, match="alpha"):
        problem(temperature=3)


def test_each_crack_has_its_own_pressure():
    two = problem((Crack([(0, 0.31), (1, 0.33)]), Crack([(0, 0.7), (1, 0.66)])))
    two.FacePressure(-1, crack=0)
    two.FacePressure(-2 - x, crack=1)
    solution = two.Solve()
    lower, upper = (solution.Profile(crack=c, n=31) for c in (0, 1))
    assert np.abs(lower.sigma_n + 1).max() < 1e-10 and np.abs(upper.sigma_n + 2 + upper.x).max() < 1e-10


def test_all_ways_to_write_a_pressure_are_one():
    v_, force = [], []
    for add in (
        lambda p, v: p.FacePressure(0.3),
        lambda p, v: p.FaceTraction(plus=0.3 * p.body.normal, minus=-0.3 * p.body.normal),
        lambda p, v: p.f.__iadd__(0.3 * InnerProduct(Jump(v), p.body.normal) * p.body.dcrack),
        lambda p, v: p.f.__iadd__(0.3 * InnerProduct(Plus(v) - Minus(v), p.body.normal) * p.body.dcrack),
    ):
        pressed = problem(INSIDE, held="bottom", tip=TipEnrichment(material=MATERIAL))
        v = pressed.V.TestFunction()
        pressed.f += CF((0.1, -1 + x)) * v * pressed.body.ds("top")
        add(pressed, v)
        solution = pressed.Solve()
        v_.append(solution.Energy())
        force.append(solution.ContactForce())
    assert np.ptp(v_) < 1e-12 * v_[0] and np.ptp(force) < 1e-10 * abs(force[0]) and force[0] < 0


# A fluid in an open crack


def sneddon(maxh, a=0.25, p=1.0):
    """The crack |x - ½| < a in the infinite body under a pressure p: that under tension p less the uniform tension."""
    mesh, crack = rectangle(maxh, (-1, -1), (1, 1)), Crack([(-a, 0), (a, 0)])
    under_tension, uniform = fs.infinite_plate(MATERIAL, a, p, 0), fs.infinite_plate(MATERIAL, a, -p, 0)
    exact = under_tension.u + uniform.u
    filled = problem(crack, mesh=mesh, tip=TipEnrichment(material=MATERIAL))
    filled.SetDirichlet(exact, ".*")
    filled.FacePressure(p)
    solution = filled.Solve()
    opening = 4 * p * (1 - 0.3**2) * sqrt(a**2 - x**2 + 1e-30)
    error = Integrate((NormalGap(solution.u, solution.body) - opening) ** 2 * filled.W.dcrack(bonus_intorder=8), mesh) ** 0.5
    return solution, error, under_tension.K_I


def test_a_fluid_opens_a_crack_at_the_rate_of_the_space():
    (_, first, _), (fine, second, K) = sneddon(0.2), sneddon(0.1)
    assert fine.ContactForce() == 0 and np.log2(first / second) > 1.5
    assert fine.StressIntensity(0).K_I == pytest.approx(K, rel=2e-3)
    assert float(fine.EnergyReleaseRate(1)) == pytest.approx((1 - 0.3**2) * K**2, rel=0.02)
    assert float(fine.TStress(1)) == pytest.approx(-1, abs=0.02)  # -p across, none along, so -p and not 0


def test_K_at_a_closed_tip_under_pressure():
    """σ = -I everywhere: K_I = K_II = 0, whatever the pressure in the crack, and T = -1."""
    for crack in (Crack([(0.31, 0.47), (0.7, 0.52)]), Crack.Arc((0.3, 0.45), (0.5, 0.5), (0.7, 0.45))):
        closed = problem(crack, mesh=square(0.06), held="bottom", tip=TipEnrichment(material=MATERIAL), material=MATERIAL)
        strain = -(1 + 0.3) * (1 - 0.6)
        closed.SetDirichlet((strain * x, strain * y), "bottom")
        closed.f += -closed.V.TestFunction() * specialcf.normal(2) * closed.body.ds("left|right|top")
        closed.FacePressure(0.7)
        solution = closed.Solve()
        assert max(map(abs, solution.StressIntensity(0))) < 2e-3
        assert float(solution.TStress(0)) == pytest.approx(-1, abs=5e-3)


def test_a_given_stress_has_the_K_of_the_load_that_it_replaces():
    """Uniform and thermal stresses: K, G and T of the whole stress, which does not depend on where it comes from."""
    stress, given = np.array([[0.3, 0.1], [0.1, 0.8]]), []
    for initial in (None, CF(tuple((0.6 * stress).ravel()), dims=(2, 2))):
        pulled = problem(Crack([(0.31, 0.47), (0.7, 0.52)]), mesh=square(0.06), held="bottom", tip=TipEnrichment(material=MATERIAL), initial_stress=initial)
        share = stress if initial is None else 0.4 * stress
        strain = MATERIAL.Strain(CF(tuple(share.ravel()), dims=(2, 2)))
        pulled.SetDirichlet(strain * CF((x, y)), "bottom")
        pulled.f += CF(tuple(stress.ravel()), dims=(2, 2)) * specialcf.normal(2) * pulled.V.TestFunction() * pulled.body.ds("left|right|top")
        solution = pulled.Solve()
        given.append([*solution.StressIntensity(1), float(solution.EnergyReleaseRate(1)), float(solution.TStress(1))])
    assert np.abs(np.subtract(*given)).max() < 1e-5 * np.abs(given[0]).max()


def test_a_temperature_that_varies_has_its_own_part_in_K():
    """T = ΔT ~ y² has no compatible strain: K does not depend on the domain of integration only with the term ∂_e σ⁰."""
    heated = problem(
        Crack([(0, 0.49), (0.45, 0.52)]),
        held="bottom",
        tip=TipEnrichment(material=MATERIAL),
        material=Elasticity.PlaneStrain(1, 0.3, 0.1),
        temperature=40 * x * x,
        mesh=square(0.08),
    )
    K = [tuple(heated.Solve().StressIntensity(0, radius=radius)) for radius in (0.2, 0.3, 0.42)]
    assert np.abs(np.ptp(K, axis=0)).max() < 0.01 * np.hypot(*K[0])


# Springs and joints


@pytest.mark.parametrize("method", ["larger", "θ = 1", "θ = 0", "θ = -1"])
@pytest.mark.parametrize("k", [0.5, 50])
def test_an_elastic_joint_carries_tension_and_compression(method, k):
    """A column of two parts with ν = 0: the gap is s/k under tension; under compression contact carries the load."""
    for s in (0.1, -0.1):
        column = problem(Crack([(0, 0.5), (1, 0.5)]), held="bottom", stabilisation=METHODS[method], material=Elasticity.PlaneStrain(E=1, nu=0))
        u, v = column.V.TnT()
        column.a += k * Jump(u) * Jump(v) * column.body.dcrack
        column.f += CF((0, s)) * v * column.body.ds("top")
        profile = column.Solve().Profile(n=21)
        assert np.abs(profile.gap - max(s, 0) / k).max() < 1e-9 and np.abs(profile.sigma_n - min(s, 0)).max() < 1e-9


def test_a_joint_between_none_and_glue():
    """k → 0: the crack that is free; k → ∞: the body without it, but for what the space can do better beside the line."""

    def energy(k, crack=THROUGH):
        glued = problem(crack, held="bottom|top")
        u, v = glued.V.TnT()
        if k:
            glued.a += k * (Plus(u) - Minus(u)) * Jump(v) * glued.body.dcrack
        glued.SetDirichlet((0.1 * y, 0.3 * y), "top")
        return glued.Solve().Energy()

    V = VectorH1(square(), order=2, dirichlet="bottom|top")
    u, v = V.TnT()
    whole = GridFunction(V)
    whole.Set((0.1 * y, 0.3 * y), BND)
    a = BilinearForm(InnerProduct(MATERIAL.Stress(Sym(Grad(u))), Sym(Grad(v))) * dx).Assemble()
    whole.vec.data -= a.mat.Inverse(V.FreeDofs()) * (a.mat * whole.vec)
    uncracked = 0.5 * InnerProduct(a.mat * whole.vec, whole.vec)
    assert energy(1e-8) == pytest.approx(energy(0), abs=1e-6 * uncracked)
    assert energy(1e7) == pytest.approx(uncracked, rel=2e-3) and energy(0) < 0.1 * energy(1) < 0.1 * uncracked


def test_springs_hold_a_body():
    """On a bed of springs under σ_yy = -s, ν = 0: u = (0, -s/k - s y/E), the joint closed."""
    bed = problem(Crack([(0, 0.47), (0.55, 0.47)]), held="", material=Elasticity.PlaneStrain(E=1, nu=0))
    u, v = bed.V.TnT()
    bed.a += 5 * u * v * bed.body.ds("bottom")
    bed.f += CF((0, -0.1)) * v * bed.body.ds("top")
    solution = bed.Solve()
    assert Integrate((solution.u - CF((0, -0.02 - 0.1 * y))) ** 2 * bed.body.dx, square()) < 1e-20
    assert np.abs(solution.Profile(n=11).sigma_n[:-1] + 0.1).max() < 1e-9
    assert solution.PotentialEnergy() == pytest.approx(-0.5 * 0.1 * (0.02 + 0.1), rel=1e-9)


# Load steps


def test_an_initial_stress_stays_while_loads_are_scaled():
    clamped = problem(initial_stress=CF((-1, 0, 0, -1), dims=(2, 2)))
    clamped.FacePressure(0.8)
    steps = LoadSteps(clamped)
    assert [round(steps.Solve(t).ContactForce() / THROUGH.length, 10) for t in (0, 0.5, 1)] == [-1, -0.6, -0.2]


# What is refused


REFUSED = {
    "measure of NGSolve": lambda p, u, v: p.f.__iadd__(CF((0, 1)) * v * dx),
    "boundary of NGSolve": lambda p, u, v: p.f.__iadd__(CF((0, 1)) * v * ds("top")),
    "trial function": lambda p, u, v: p.f.__iadd__(u * v * p.body.dx),
    "other space": lambda p, u, v: p.f.__iadd__(p.W.TestFunction() * p.body.dcrack),
    "jump in the bulk": lambda p, u, v: p.f.__iadd__(Jump(v)[1] * p.body.dx),
    "value on the crack": lambda p, u, v: p.f.__iadd__(v[1] * p.body.dcrack),
    "normal of NGSolve": lambda p, u, v: p.f.__iadd__(Jump(v) * specialcf.normal(2) * p.body.dcrack),
    "no trial function": lambda p, u, v: p.a.__iadd__(v[0] * p.body.ds("top")),
    "not symmetric": lambda p, u, v: p.a.__iadd__(u[0] * v[1] * p.body.ds("top")),
    "one-sided": lambda p, u, v: p.a.__iadd__(Plus(u) * Minus(v) * exp(x) * p.body.dcrack),
    "gradients": lambda p, u, v: p.a.__iadd__(InnerProduct(Grad(u), Grad(v)) * p.body.dx),
    "other body": lambda p, u, v: p.f.__iadd__(v[1] * CrackedMesh(square(), THROUGH).dx),
}
WORDS = {
    "measure of NGSolve": "body.dx", "boundary of NGSolve": "body.ds", "trial function": "problem.a", "other space": "another space", "jump in the bulk": "body.dcrack",
    "value on the crack": "FacePressure", "normal of NGSolve": "body.normal", "no trial function": "problem.f", "not symmetric": "symmetric", "one-sided": "symmetric",
    "gradients": "material", "other body": "another CrackedMesh",
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_terms_without_a_meaning_are_refused(name):
    p = problem(held="bottom")
    with pytest.raises(ValueError, match=WORDS[name]):
        REFUSED[name](p, *p.V.TnT())
    assert p.f.given == [] and p.a.terms == []


def test_bad_arguments_are_refused():
    p = problem(held="bottom")
    for call, error in (
        (lambda: p.FacePressure((1, 2)), ValueError),
        (lambda: p.FacePressure("high"), TypeError),
        (lambda: p.FaceTraction(plus=3), ValueError),
        (lambda: p.FacePressure(1, crack=1), ValueError),
        (lambda: problem(initial_stress=CF((1, 0, 0, 1))), ValueError),
        (lambda: problem(initial_stress=1), ValueError),
    ):
        with pytest.raises(error):
            call()


# Point loads and loaded interfaces leave K available


def test_a_point_load_outside_of_the_disk_leaves_K_available():
    """The same force spread over a small disk around the point gives the same K; inside of the disk the point is named."""
    K = []
    for point in (True, False):
        pushed = problem(Crack([(0, 0.5), (0.4, 0.5)]), held="right", mesh=square(0.06), tip=TipEnrichment(material=MATERIAL, r1=0.15))
        v = pushed.V.TestFunction()
        bell = exp(-((x - 0.2) ** 2 + (y - 0.8) ** 2) / 0.03**2)
        if point:
            pushed.f += v[1](0.2, 0.8)
        else:
            pushed.f += bell / Integrate(bell * pushed.body.dx(bonus_intorder=20), square(0.06)) * v[1] * pushed.body.dx(bonus_intorder=20)
        K.append(tuple(pushed.Solve().StressIntensity(0)))
        if point:
            with pytest.raises(ValueError, match="point load"):
                pushed.Solve().StressIntensity(0, radius=0.38)
    assert np.abs(np.subtract(*K)).max() < 0.02 * np.hypot(*K[0])


def test_a_point_load_on_a_crack_is_refused():
    """There u is two."""
    pushed = problem(Crack([(0, 0.5), (0.4, 0.5)]), held="right")
    v = pushed.V.TestFunction()
    with pytest.raises(ValueError, match="is on crack 0"):
        pushed.f += v[1](0.2, 0.5)
    pushed.f += v[1](0.2, 0.6)


# What is given may jump across a crack, change later, or not be linear


@pytest.mark.parametrize("method", ["larger", "θ = 1", "θ = -1"])
@pytest.mark.parametrize("heated", [1, -1], ids=["above", "below"])
def test_a_temperature_that_jumps_across_the_crack(method, heated):
    """A bar on rollers, ν = 0, one half of it heated: λ = -E α ΔT (1 - y_0) or -E α ΔT y_0, and no gap."""
    y0 = 0.43
    body = CrackedMesh(square(), Crack([(0, y0), (1, y0)]))
    V = CrackFESpace(body, order=2, dirichletx="left|right", dirichlety="bottom|top", material=Elasticity.PlaneStrain(E=1, nu=0, alpha=0.1))
    bar = ContactProblem(V, TraceSpace(body), stabilisation=METHODS[method], temperature=10 * IfPos(heated * (y - y0), 1, 0))
    profile = bar.Solve().Profile(n=31)
    right = -((1 - y0) if heated > 0 else y0)
    assert np.abs(profile.sigma_n - right).max() < 1e-9 and np.abs(profile.gap).max() < 1e-10


def test_limits_on_a_crack_are_one_sided():
    body = CrackedMesh(square(), THROUGH)
    jumping = (2 + 3 * x - y) * IfPos(THROUGH.side, 1, -1)
    for side, sign in ((1, 1), (-1, -1)):
        assert Integrate((body.LimitOnCrack(jumping, side) - sign * (2 + 3 * x - y)) ** 2 * body.dcrack, square()) < 1e-18


def test_a_load_case_keeps_its_parameters():
    p = Parameter(0.6)
    pressed = problem()
    pressed.FacePressure(-1 * p)
    case = LoadCase(pressed)
    assert LoadSteps(pressed, [case]).Solve(2).ContactForce() == pytest.approx(-1.2 * THROUGH.length, rel=1e-9)
    solution = pressed.Solve()
    p.Set(0.3)
    with pytest.raises(ValueError, match="has changed since a LoadCase"):
        LoadSteps(pressed, [case])
    with pytest.raises(ValueError, match="has changed since the solve"):
        solution.CheckLoad()


def test_the_T_stress_of_a_bent_crack_without_stress():
    """An initial stress in a body that nothing holds: the whole stress is zero."""
    given = CF((0.3, 0.1, 0.1, 0.8), dims=(2, 2))
    free = problem(
        Crack.Arc((0.3, 0.45), (0.5, 0.55), (0.7, 0.45)), mesh=square(0.06), held="", initial_stress=given, tip=TipEnrichment(material=MATERIAL), gap=10
    )
    free.Pin((0, 0), "xy"), free.Pin((1, 0), "y")
    assert abs(float(free.Solve().TStress(1))) < 2e-3


@pytest.mark.parametrize("k", [1, 20])
def test_a_foundation_is_a_body_force_in_K(k):
    """The field of K_I = 1 with the load that balances springs in the body: K, G and T do not depend on k."""
    exact = open_tip(MATERIAL, tip=0.5).u
    shifted = problem(Crack([(0, 0), (0.5, 0)]), mesh=rectangle(0.07, (0, -0.5), (1, 0.5)), tip=TipEnrichment(material=MATERIAL))
    u, v = shifted.V.TnT()
    shifted.SetDirichlet(exact, ".*")
    shifted.a += k * u * v * shifted.body.dx
    shifted.f += k * exact * v * shifted.body.dx(bonus_intorder=4)
    solution = shifted.Solve()
    assert solution.StressIntensity(0).K_I == pytest.approx(1, abs=2e-3)
    assert float(solution.EnergyReleaseRate(0)) == pytest.approx(1 - 0.3**2, rel=3e-3) and abs(float(solution.TStress(0))) < 2e-3


def test_the_error_of_K_covers_what_a_joint_hides():
    """A stiff joint under pressure: the jump is p/k inside, so G = p²/2k, which the J-integral finds."""
    filled = problem(Crack([(-0.4, 0), (0.4, 0)]), mesh=rectangle(0.1, (-1, -1), (1, 1)), held="bottom|top", tip=TipEnrichment(material=MATERIAL))
    u, v = filled.V.TnT()
    filled.a += 100 * Jump(u) * Jump(v) * filled.body.dcrack
    filled.FacePressure(1)
    K = filled.Solve().StressIntensity(1)
    assert abs(K.K_I - np.sqrt(0.005 / (1 - 0.3**2))) < K.error


def test_a_given_stress_that_jumps_at_a_tip_is_refused():
    stepped = problem(
        Crack([(0, 0.5), (0.5, 0.503)]),
        mesh=square(0.08),
        tip=TipEnrichment(material=MATERIAL),
        initial_stress=CF((0, 0, 0, IfPos(x - 0.55, 5, 0)), dims=(2, 2)),
    )
    with pytest.raises(ValueError, match="jumps near the tip"):
        stepped.Solve().StressIntensity(0)


NOT_LINEAR = {
    "square": lambda p, u, v: p.f.__iadd__(v * v * p.body.dx),
    "shifted": lambda p, u, v: p.f.__iadd__((v[0] + 1) * p.body.dx),
    "root": lambda p, u, v: p.f.__iadd__(sqrt(1 + v[0] ** 2) * p.body.ds("top")),
    "no test function": lambda p, u, v: p.f.__iadd__(5 * p.body.dx),
    "pushes only": lambda p, u, v: p.a.__iadd__(IfPos(-u[1], 1, 0) * u[1] * v[1] * p.body.ds("bottom")),
    "cubic": lambda p, u, v: p.a.__iadd__(u[1] ** 3 * v[1] * p.body.ds("bottom")),
    "initial stress": lambda p, u, v: problem(initial_stress=CF((0, 0.5, 0, 0), dims=(2, 2))),
    "test function in it": lambda p, u, v: problem(initial_stress=Grad(v)),
}


@pytest.mark.parametrize("name", NOT_LINEAR)
def test_forms_that_are_not_linear_are_refused(name):
    p = problem(held="top")
    with pytest.raises(ValueError, match="linear|no test function|symmetric|holds a trial or test"):
        NOT_LINEAR[name](p, *p.V.TnT())


def test_no_pressure_is_no_load():
    """A zero that NGSolve simplifies away is a load all the same."""
    body = CrackedMesh(rectangle(0.3), Crack([(0, 0.5), (0.5, 0.5)]))
    V = CrackFESpace(body, tip=None, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body), Elasticity(lam=1, mu=1))
    problem.FacePressure(0)
    problem.FaceTraction()
    assert np.abs(problem.Solve().u.vec.FV().NumPy()).max() == 0
