"""Cracks that start: at a stress limit in the body and on its boundary, and as wings from junctions."""

from functools import cache

import numpy as np
import pytest
from helpers import MATERIAL, rectangle
from netgen.geom2d import SplineGeometry
from ngsolve import CF, BilinearForm, Grad, GridFunction, InnerProduct, LinearForm, Mesh, Sym, VectorH1, ds, dx, x, y

from ngsxfem_contact import BarbosaHughes, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, Elasticity, LoadSteps, Nitsche, TraceSpace
from ngsxfem_contact.contact import Joint
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.exact import fracture_solutions as fs
from ngsxfem_contact.fracture import GivenIncrement, JunctionInitiation, StressInitiation, WingCracks
from ngsxfem_contact.fracture.initiation import stress_at
from ngsxfem_contact.fracture.junction_initiation import meeting_points
from ngsxfem_contact.plotting import plot_body

RADIUS = 0.1  # of the hole
STEEL = Elasticity.PlaneStress(100, 0.3)
SIDES = "left|right|top|bottom"


# On the boundary: a hole under tension


@cache
def plate(maxh, order=1):
    """A hole in the middle of a square; order of the elements at its rim."""
    geometry = SplineGeometry()
    geometry.AddRectangle((-0.5, -0.5), (0.5, 0.5), bcs=["bottom", "right", "top", "left"])
    geometry.AddCircle((0, 0), RADIUS, leftdomain=0, rightdomain=1, bc="hole")
    mesh = Mesh(geometry.GenerateMesh(maxh=maxh))
    mesh.Curve(order)
    return mesh


def kirsch():
    """u of the infinite plate under σ_yy = 1: 2μ u = κ φ - z conj φ' - conj ψ, 4φ = z - 2a²/z, 2ψ = z - a²/z - a⁴/z³."""
    a, r2 = RADIUS, x * x + y * y
    power = lambda n: (CF(1), CF(0)) if n == 0 else tuple(CF(c) for c in times(power(n - 1), (x / r2, -y / r2)))
    times = lambda p, q: (p[0] * q[0] - p[1] * q[1], p[0] * q[1] + p[1] * q[0])
    z, i1, i2, i3 = (x, y), power(1), power(2), power(3)
    phi = [0.25 * (z[k] - 2 * a**2 * i1[k]) for k in range(2)]
    d_phi = [0.25 * ((1, 0)[k] + 2 * a**2 * i2[k]) for k in range(2)]
    psi = [0.5 * (z[k] - a**2 * i1[k] - a**4 * i3[k]) for k in range(2)]
    middle = times(z, (d_phi[0], -1 * d_phi[1]))
    return CF(tuple((STEEL.kappa * phi[k] - middle[k] - (1, -1)[k] * psi[k]) / (2 * STEEL.mu) for k in range(2)))


def kirsch_mean(radius):
    """Of σ_yy over the part of a disk around (a, 0) that is outside of the hole, by a Gauss rule."""
    t, w = np.polynomial.legendre.leggauss(200)
    rho, angle = np.meshgrid(0.5 * radius * (t + 1), np.pi * t, indexing="ij")
    X, Y = RADIUS + rho * np.cos(angle), rho * np.sin(angle)
    r, theta, weight = np.hypot(X, Y), np.arctan2(Y, X), np.outer(w, w) * rho * (np.hypot(X, Y) > RADIUS)
    k, cos, sin = RADIUS / r, -np.cos(2 * theta), -np.sin(2 * theta)  # of twice the angle from the load
    rr = 0.5 * (1 - k**2) + 0.5 * (1 - 4 * k**2 + 3 * k**4) * cos
    tt = 0.5 * (1 + k**2) - 0.5 * (1 + 3 * k**4) * cos
    rt = -0.5 * (1 + 2 * k**2 - 3 * k**4) * sin
    yy = rr * np.sin(theta) ** 2 + tt * np.cos(theta) ** 2 + 2 * rt * np.sin(theta) * np.cos(theta)
    return (weight * yy).sum() / weight.sum()


def pulled_plate(maxh, stress=1.0, order=1):
    def make(cracks):
        body = CrackedMesh(plate(maxh, order), *cracks)
        V = CrackFESpace(body, order=2, material=STEEL, dirichlet=SIDES)
        problem = ContactProblem(V, TraceSpace(body, order=1))
        problem.SetDirichlet(stress * kirsch(), SIDES)
        return problem

    return make


def test_the_mean_of_kirsch_tends_to_three():
    """So that a crack starts at σ_c / 3 for a small radius."""
    assert kirsch_mean(1e-4 * RADIUS) == pytest.approx(3, rel=1e-3) and kirsch_mean(0.3 * RADIUS) < 2.4


@pytest.mark.parametrize("radius", [0.04, 0.06])
def test_the_rim_of_a_hole(radius):
    """The stress is that of the closed form on every mesh, the place at the side of the hole, the crack across the rim."""
    for maxh in (0.03, 0.02):
        (new,) = StressInitiation(strength=1.5, radius=radius, length=0.1).Starts(pulled_plate(maxh)([]).Solve())
        X, Y = new.point
        assert new.stress == pytest.approx(kirsch_mean(radius), rel=0.01) and new.origin == "hole"
        assert np.hypot(X, Y) == pytest.approx(RADIUS, rel=0.03) and abs(Y) < 0.11 * RADIUS  # 6 degrees; the maximum is flat
        assert np.array(new.crack.points[1]) == pytest.approx((X + 0.1 * np.sign(X), Y), abs=0.01) and new.crack.length == pytest.approx(0.1)


@pytest.mark.parametrize("order", [2, 3])
def test_the_rim_of_a_round_hole(order):
    """On curved elements a crack starts on the circle; chords lie in the hole, up to 1 % of its radius."""
    (new,) = StressInitiation(strength=1.5, radius=0.04, length=0.1).Starts(pulled_plate(0.03, order=order)([]).Solve())
    assert np.hypot(*new.point) == pytest.approx(RADIUS, rel=3e-4) and abs(new.point[1]) < 0.13 * RADIUS  # 7 degrees; the maximum is flat
    assert new.stress == pytest.approx(kirsch_mean(0.04), rel=0.01) and new.origin == "hole"


def test_cracks_start_from_both_sides_of_a_hole_and_grow():
    """At the load at which the mean reaches the strength, within 1.5 %; the table says what, where and at which stress."""
    start = StressInitiation(strength=3, radius=0.04, length=0.12)
    below, above = (
        CrackGrowth(pulled_plate(0.03, factor * 3 / kirsch_mean(0.04)), [], GivenIncrement(0.1), toughness=9.0, initiation=start) for factor in (0.985, 1.015)
    )
    assert len(below.Run(3)) == 0 and len(below.solutions) == 1
    table = above.Run(3)
    begins = table[table["end"] == "new"]
    assert list(begins["name"]) == ["hole/1", "hole/2"] and list(begins["crack"]) == [0, 1] and list(begins["step"]) == [0, 1]
    assert (begins["stress"] >= 3).all() and begins["x"][0] == pytest.approx(-begins["x"][1], rel=0.05) and (begins["advance"] == pytest.approx(0.12))
    assert all(row.startswith("starts: the principal stress 3.") and row.endswith("has reached 3 on the boundary 'hole'") for row in begins["state"])
    assert [crack.name for crack in above.cracks] == ["hole/1", "hole/2"] and len(above.solutions) == 3 and "hole/2 new" in str(above)
    tips = table[table["end"] == "end"]
    assert np.isnan(tips["stress"]).all() and list(tips["name"]) == ["hole/1", "hole/1", "hole/2"] and (tips["K_I"] > 0.5).all()


def test_what_starts_is_a_crack_as_any_other():
    """Its K is that of the same crack given at first, and converges."""
    K = []
    for maxh in (0.05, 0.03):
        growth = CrackGrowth(pulled_plate(maxh), [], GivenIncrement(0.1), toughness=9.0, initiation=StressInitiation(1.5, 0.05, 0.2))
        growth.Run(2)
        again = pulled_plate(maxh)(growth.cracks).Solve()
        assert growth.rows[1].K_I == pytest.approx(again.StressIntensity().K_I, rel=1e-10)
        K.append(growth.rows[1].driving)
    assert K[1] == pytest.approx(K[0], rel=0.02)


# In the body


def domed(cracks, maxh=0.12, strength=None):
    """u_y = y - y³/3 - x² y and ν = 0: σ_yy = 1 - x² - y² is largest in the middle, 1 - r²/2 in the mean of a disk."""
    body = CrackedMesh(rectangle(maxh, (-0.9, -0.9), (0.9, 0.9)), *cracks)
    V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(1, 0), dirichlet=".*")
    problem = ContactProblem(V, TraceSpace(body, order=1))
    problem.f += CF((x, 3 * y)) * V.TestFunction() * body.dx
    problem.SetDirichlet(CF((0, y - y**3 / 3 - x * x * y)), ".*")
    return problem


def test_a_crack_starts_in_the_body():
    """In the middle, across the tension; not if it may not, and not beside a crack."""
    solution = domed([]).Solve()
    (new,) = StressInitiation(0.9, 0.2, 0.5).Starts(solution)
    assert new.stress == pytest.approx(1 - 0.2**2 / 2, rel=2e-3) and np.hypot(*new.point) < 0.03 and abs(np.sin(np.radians(new.angle))) < 0.03
    assert np.mean(new.crack.points, axis=0) == pytest.approx(new.point) and new.reason.endswith("in 'default'")
    assert StressInitiation(0.99, 0.2, 0.5).Starts(solution) == [] == StressInitiation(0.9, 0.2, 0.5, region=None).Starts(solution)
    growth = CrackGrowth(domed, [], GivenIncrement(0.4), toughness=9.0, initiation=StressInitiation(0.9, 0.2, 0.6))
    table = growth.Run(3)
    assert list(table["end"]) == ["new", "start", "end"] and table["K_I"][1] == pytest.approx(table["K_I"][2], rel=0.02)


def test_a_body_without_cracks_is_that_of_ngsolve():
    """Whatever law and method are asked for; steps and pictures go with it."""
    pytest.importorskip("matplotlib").use("Agg")
    mesh = rectangle(0.2)
    V = VectorH1(mesh, order=2, dirichlet="bottom")
    (u, v), found = V.TnT(), GridFunction(V)
    f = LinearForm(CF((0.1, -1)) * v * ds("top")).Assemble()
    found.vec.data = BilinearForm(InnerProduct(STEEL.Stress(Sym(Grad(u))), Sym(Grad(v))) * dx).Assemble().mat.Inverse(V.FreeDofs()) * f.vec
    body = CrackedMesh(mesh)
    for law, method, order, basis in ((None, BarbosaHughes(), 1, "nodal"), (Coulomb(0.2), Nitsche(1), 0, "nodal"), (Joint(1, 1), None, 1, "trace")):
        V = CrackFESpace(body, order=2, material=STEEL, dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body, order=order, basis=basis), law=law, stabilisation=method)
        problem.f += CF((0.1, -1)) * V.TestFunction() * body.ds("top")
        solution = problem.Solve()
        assert solution.Energy() == pytest.approx(0.5 * InnerProduct(f.vec, found.vec), rel=1e-12) and len(solution.Multipliers()) == 0
        assert LoadSteps(problem).Solve(0.5, previous=solution).Energy() == pytest.approx(0.25 * solution.Energy())
    plot_body(solution)


# Around junctions


@cache
def sliding(maxh, tied=True):
    """A crack that slides under pressure, in the infinite plate, and ends on another one, which is tied: around the T the stresses are those of the plate."""
    plate = fs.infinite_plate(MATERIAL, 0.2, *fs.inclined(-1, 0.9))

    def make(cracks):
        body = CrackedMesh(rectangle(maxh, (-0.5, -0.5), (0.5, 0.5)), *cracks)
        V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet=".*")
        law = {crack.name: Joint(float("inf"), float("inf")) for crack in cracks if crack.name == "bedding"}
        problem = ContactProblem(V, TraceSpace(body, order=1), law=law)
        problem.SetDirichlet(plate.u, ".*")
        return problem

    return make, plate


FAULT, BEDDING = Crack([(-0.2, 0), (0.2, 0)], "fault"), Crack([(0.2, -0.15), (0.2, 0.15)], "bedding")


def test_hoop_stress_around_a_t():
    """Against the closed form, in size and direction, where it counts."""
    make, plate = sliding(0.025)
    solution, angles, radius = make([FAULT, BEDDING]).Solve(), np.linspace(-np.pi, np.pi, 721)[:-1], 0.05
    ((number, point),) = meeting_points(solution.body)
    hoop = JunctionInitiation(1, 0.1, radius).HoopStress(solution, point, angles)
    gradient = [[plate.u[i].Diff(v) for v in (x, y)] for i in range(2)]
    strain = CF((gradient[0][0], 0.5 * (gradient[0][1] + gradient[1][0]), 0.5 * (gradient[0][1] + gradient[1][0]), gradient[1][1]), dims=(2, 2))
    places = solution.body.mesh(*(point[:, None] + radius * np.array([np.cos(angles), np.sin(angles)])))
    xx, yy, xy = MATERIAL.Stress(strain)(places)[:, [0, 3, 1]].T
    exact = np.sin(angles) ** 2 * xx + np.cos(angles) ** 2 * yy - 2 * np.sin(angles) * np.cos(angles) * xy
    counts = ~np.isnan(hoop)
    assert (number, *point) == (0, pytest.approx(0.2), 0) and 0.6 < counts.mean() < 0.7  # 20 degrees to both sides of three arms
    assert np.abs(hoop - exact)[counts].max() < 0.06 * np.abs(exact[counts]).max()
    best, wanted = np.nanargmax(hoop), np.nanargmax(np.where(counts, exact, np.nan))
    assert hoop[best] == pytest.approx(exact[wanted], rel=0.03) and np.degrees(abs(angles[best] - angles[wanted])) < 3


def test_a_wing_starts_from_a_t():
    """Where the hoop stress reaches the strength, and only then; in the next state it is open, and K is that of the crack given at first."""
    make, _ = sliding(0.025)
    none, growth = (
        CrackGrowth(make, [FAULT, BEDDING], GivenIncrement(0.1), WingCracks(), 9.0, JunctionInitiation(strength, 0.16, radius=0.05)) for strength in (0.4, 0.3)
    )
    none.Run(2)
    assert len(none.solutions) == 1 and not (none.table["end"] == "new").any()
    table = growth.Run(2)
    (wing,) = table[table["end"] == "new"]
    assert (wing["step"], wing["crack"], wing["name"]) == (0, 2, "fault/1") and (wing["x"], wing["y"]) == (pytest.approx(0.2), pytest.approx(0, abs=1e-12))
    assert wing["stress"] == pytest.approx(0.352, rel=0.03) and wing["angle"] == pytest.approx(60, abs=4)
    assert wing["state"].startswith("starts: the hoop stress 0.35") and wing["state"].endswith("at 0.05 has reached 0.3 on crack 0 'fault'")
    (tip,) = table[(table["step"] == 1) & (table["crack"] == 2)]
    assert tip["K_I"] > 1.5 * abs(tip["K_II"]) and growth.solutions[1].body.Ends("fault/1")[0].kind.name == "Junction"
    again = make(growth.cracks).Solve()
    number = [tip.crack for tip in again.body.tips].index(2)
    assert again.StressIntensity(number).K_I == pytest.approx(tip["K_I"], rel=1e-9)


def test_where_junctions_are():
    """Ends on others, crossings and kinks, each once."""
    mesh = rectangle(0.1)
    body = CrackedMesh(mesh, Crack([(0.1, 0.5), (0.9, 0.52)]), Crack([(0.5, 0.1), (0.48, 0.9)]), Crack([(0.3, 0.505), (0.3, 0.8), (0.2, 0.9)]))
    places = [tuple(point.round(6)) for _, point in meeting_points(body)]
    assert len(places) == 3 and (0.3, 0.505) in places and (0.3, 0.8) in places
    assert all(min(crack.Distance(place) for crack in body.cracks) < 1e-6 for place in places)


def test_the_distance_of_a_toughness():
    assert (
        JunctionInitiation(2.0, 0.1, toughness=0.5).distance == pytest.approx((0.5 / 2) ** 2 / (2 * np.pi))
        and JunctionInitiation(2.0, 0.1, 0.3).distance == 0.3
    )


def test_stresses_are_symmetric_matrices():
    solution = domed([]).Solve()
    assert stress_at(solution, solution.body.mesh(np.array([0.3]), np.array([0.2])))[0] == pytest.approx([0, 1 - 0.13, -0.06], abs=0.01)


# What is refused, and what is said


def test_a_crack_that_has_no_room_does_not_start():
    """The table says so, and the growth ends; the stress is there."""
    growth = CrackGrowth(pulled_plate(0.04), [], GivenIncrement(0.1), initiation=StressInitiation(2, 0.04, 0.05))
    (row,) = growth.Run(3)
    assert (
        row["state"].startswith("does not start: the new tip (")
        and "less than 2.5 elements" in row["state"]
        and row["stress"] > 2
        and row["crack"] == -1
        and growth.cracks == []
    )


def test_small_radii_warn():
    with pytest.warns(
        AccuracyWarning,
        match=r"StressInitiation: radius=0.01 at .* is 0\..* elements: with less than 1 the stress depends on the mesh; refine to h <= 0.01 there",
    ):
        StressInitiation(2, 0.01, 0.1).Starts(pulled_plate(0.05)([]).Solve())
    make, _ = sliding(0.025)
    with pytest.warns(AccuracyWarning, match="JunctionInitiation: radius=0.02 at .* with less than 2"):
        JunctionInitiation(0.1, 0.1, 0.02).Starts(make([FAULT, BEDDING]).Solve())


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: StressInitiation(0, 0.1, 0.1), "StressInitiation: strength=0 must be positive"),
        (lambda: StressInitiation(1, 0.1, -1), "StressInitiation: length=-1 must be positive"),
        (lambda: JunctionInitiation(float("nan"), 0.1, 0.1), "JunctionInitiation: strength=nan must be positive"),
        (lambda: JunctionInitiation(1, 0.1), "give either radius= or toughness="),
        (lambda: JunctionInitiation(1, 0.1, 0.1, 0.1), "give either radius= or toughness="),
        (lambda: JunctionInitiation(1, 0.1, toughness=0), "JunctionInitiation: toughness=0 must be positive"),
        (lambda: StressInitiation(1, 0.2, 0.1, boundary="rim").Starts(domed([]).Solve()), "boundary='rim' matches no boundary; the mesh has"),
        (lambda: StressInitiation(1, 0.2, 0.1, region="rock").Starts(domed([]).Solve()), "region='rock' matches no region; the mesh has"),
        (lambda: JunctionInitiation(1, 0.1, 0.1, points=[(0.4, 0.4)]).Starts(domed([]).Solve()), "no crack passes through .*; the body has none"),
        (
            lambda: JunctionInitiation(1, 0.1, 0.1, points=[(0.4, 0.4)]).Starts(domed([FAULT]).Solve()),
            "no crack passes through .*; the nearest, crack 0 'fault', is",
        ),
    ],
)
def test_arguments_that_make_no_sense(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_initiations_are_objects():
    with pytest.raises(TypeError, match="initiation=0.3 needs Starts"):
        CrackGrowth(domed, [FAULT], GivenIncrement(0.1), initiation=0.3)
    with pytest.raises(TypeError, match="is not a list of one or more cracks, or of none with initiation="):
        CrackGrowth(domed, [], GivenIncrement(0.1))
    with pytest.raises(TypeError, match="StressInitiation: region=3 is not a name"):
        StressInitiation(1, 1, 1, region=3)
