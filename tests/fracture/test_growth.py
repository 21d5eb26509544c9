"""Growth of cracks: directions, cycles, several tips, and all that stops a tip."""

import csv
import warnings
from functools import cache

import numpy as np
import pytest
from helpers import pull, rectangle
from ngsolve import CF, x

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, TipEnrichment, TraceSpace
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.exact import fracture_solutions as fs
from ngsxfem_contact.fracture import GivenIncrement, MaximumHoopStress, Paris, WingCracks
from ngsxfem_contact.fracture.extension import extended
from ngsxfem_contact.fracture.stress_intensity import is_closed
from ngsxfem_contact.geometry import EndKind
from study.paper import MATERIAL

EDGE = [Crack([(0, 0), (0.3, 0)])]
INCLINED = [Crack([(0.38, -0.1), (0.62, 0.1)])]


@cache
def mesh(maxh=0.05):
    return rectangle(maxh, (0, -0.5), (1, 0.5))


def pulled(cracks, stress=1.0, maxh=0.05):
    """The square under σ_yy = stress."""
    body = CrackedMesh(mesh(maxh), *cracks)
    V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL))
    return pull(ContactProblem(V, TraceSpace(body, order=1), MATERIAL), (1, 0.5), stress)


def pressed(cracks):
    return pulled(cracks, -1.0)


def step(problem, cracks, law=GivenIncrement(0.15), **options):
    growth = CrackGrowth(problem, cracks, law, **options)
    return growth, growth.Step()


# The criterion


@pytest.mark.parametrize("K_I, K_II", [(1, 0), (1, 0.3), (1, -0.3), (0.2, 1), (0, 1), (0, -1)])
def test_the_hoop_stress_is_largest_at_the_angle(K_I, K_II):
    hoop = lambda theta: np.cos(theta / 2) ** 2 * (K_I * np.cos(theta / 2) - 3 * K_II * np.sin(theta / 2))
    theta = np.linspace(-np.pi, np.pi, 200001)
    criterion = MaximumHoopStress()
    assert criterion.Angle(K_I, K_II) == pytest.approx(theta[np.argmax(hoop(theta))], abs=1e-4)
    assert criterion.Driving(K_I, K_II) == pytest.approx(hoop(theta).max())


def test_pure_shear_turns_by_70_degrees():
    assert np.degrees(MaximumHoopStress().Angle(0, 1)) == pytest.approx(-70.5288, abs=1e-4)


# Directions


@pytest.mark.parametrize("flip", [1, -1])
def test_the_angled_crack_grows_as_the_infinite_plate_says(flip):
    """Both tips, either orientation; the exact far field on the boundary: the angle of the closed form within half a degree."""
    normal, shear, along = fs.inclined(1, 0.9)
    plate = fs.infinite_plate(MATERIAL, 0.2, normal, shear, along)

    def problem(cracks):
        body = CrackedMesh(rectangle(0.05, (-0.5, -0.5), (0.5, 0.5)), *cracks)
        V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL), dirichlet=".*")
        problem = ContactProblem(V, TraceSpace(body, order=1), MATERIAL)
        problem.SetDirichlet(plate.u, ".*")
        return problem

    _, rows = step(problem, [Crack([(-0.2 * flip, 0), (0.2 * flip, 0)])])
    exact = np.degrees(MaximumHoopStress().Angle(plate.K_I, plate.K_II))
    assert [row.angle for row in rows] == pytest.approx([exact, exact], abs=0.5)
    assert all(row.state == "grows" and row.advance == 0.15 for row in rows)


def test_an_edge_crack_grows_straight_and_faster():
    growth = CrackGrowth(pulled, EDGE, GivenIncrement(0.15))
    table = growth.Run(3)
    assert len(table) == 3 and (np.diff(table["K_I"]) > 0).all() and not table["angle"].any()
    assert table["x"] == pytest.approx([0.3, 0.45, 0.6]) and table["length"] == pytest.approx([0.3, 0.45, 0.6])
    assert table["K_I"][0] == pytest.approx(growth.solutions[0].StressIntensity().K_I)
    assert growth.cracks[0].points == [(0, 0), pytest.approx((0.6, 0))]  # that of the last row, in one piece


def test_noise_makes_no_kinks():
    """A crack beside the line of symmetry has a K_II that is smaller than its error: it goes straight on. An inclined one turns."""
    growth = CrackGrowth(pulled, [Crack([(0, 1e-4), (0.3, 1e-4)])], GivenIncrement(0.15))
    first = growth.Run(2)[0]
    assert 0 < abs(first["K_II"]) < first["error"] and len(growth.cracks[0].points) == 2
    assert growth.cracks[0].points[-1] == pytest.approx((0.45, 1e-4), abs=1e-14)
    inclined = CrackGrowth(pulled, [Crack([(0, 0), (0.3, 0.03)])], GivenIncrement(0.15))
    assert inclined.Run(2)["angle"][0] < -3 and len(inclined.cracks[0].points) == 3


def test_wing_cracks_open_under_compression():
    """The closed crack slides and does not grow; where closed tips may kink, wings open at 70.5° and turn to the load's axis."""
    _, arrested = step(pressed, INCLINED)
    assert all("faces touch" in row.state and row.advance == 0 for row in arrested)
    growth = CrackGrowth(pressed, INCLINED, GivenIncrement(0.15), WingCracks())
    kink, wing = growth.Step(), growth.Step()
    assert [row.angle for row in kink] == pytest.approx([70.53, 70.53], abs=0.01)
    assert all(row.K_I > 0.1 for row in wing) and not is_closed(growth.solutions[1], 0)
    assert growth.solutions[1].ContactForce() < -0.1
    tips = np.array([[row.x, row.y] for row in wing])
    assert tips[0] + tips[1] == pytest.approx([1, 0], abs=0.01)  # symmetric about the centre


def test_round_off_does_not_close_a_tip():
    """A law's method may leave 1e-16 of a pressure where nothing presses; a pressure does close it."""
    solution = pulled(EDGE).Solve()
    for pressure, closed in ((-1e-16, False), (-1.0, True)):
        solution.multiplier.vec[:] = pressure
        assert is_closed(solution, 0) == closed


# Laws


def test_paris_counts_cycles():
    """An edge crack: Σ da / (C K^m) over the states before, 0 at first; the load ratio reduces ΔK."""
    whole, half = (CrackGrowth(pulled, EDGE, Paris(C=1e-3, m=3, da=0.15, ratio=ratio)) for ratio in (0, 0.5))
    table = whole.Run(3)
    assert table["cycles"] == pytest.approx([0, *np.cumsum(0.15 / (1e-3 * table["driving"][:-1] ** 3))]) and whole.cycles == table["cycles"][-1]
    assert half.Run(2)["cycles"][1] == pytest.approx(8 * table["cycles"][1])


def test_paris_with_two_cracks():
    """Advances go with K^m; the slower one waits until its own add up to half an increment."""
    for m, waits in ((2, False), (8, True)):
        cracks = [Crack([(0, -0.15), (0.35, -0.15)]), Crack([(1, 0.25), (0.75, 0.25)])]
        growth = CrackGrowth(pulled, cracks, Paris(C=1, m=m, da=0.1))
        fast, slow = growth.Step()
        ratio = (slow.driving / fast.driving) ** m
        assert fast.advance == pytest.approx(0.1) and ("waits" in slow.state) == waits == (ratio < 0.5)
        assert slow.advance == (0 if waits else pytest.approx(0.1 * ratio))
        assert growth.cracks == cracks and growth.Step()[1].length == pytest.approx(0.25 + slow.advance)


# What stops a tip


def test_compression_stops_a_tip():
    growth = CrackGrowth(pressed, EDGE, GivenIncrement(0.15))
    table = growth.Run(5)
    assert len(table) == 1 and table["state"][0] == "arrested: the faces touch at the tip, K_I = 0"
    assert table["advance"][0] == 0 and growth.cracks == EDGE


def test_a_tip_that_grows_into_compression_stops():
    """Held ends turn: pulled at the mouth, pressed at the far side. The tip grows while K_I falls, then its faces touch."""

    def turned(cracks):
        body = CrackedMesh(mesh(), *cracks)
        V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL), dirichlet="top|bottom")
        problem = ContactProblem(V, TraceSpace(body, order=1), MATERIAL)
        for side, sign in (("top", 1), ("bottom", -1)):
            problem.SetDirichlet(CF((0, sign * (0.42 - x))), side)
        return problem

    growth = CrackGrowth(turned, EDGE, GivenIncrement(0.15))
    table = growth.Run(6)
    assert table["state"][0] == "grows" and table["state"][-1] == "arrested: the faces touch at the tip, K_I = 0"
    assert (np.diff(table["K_I"]) < 0).all() and table["x"][-1] < 0.9
    assert growth.solutions[-1].ContactForce() < 0 and growth.solutions[0].ContactForce() == 0


def test_toughness():
    growth, (row,) = step(pulled, EDGE, toughness=100.0)
    assert "not above the toughness" in row.state and row.advance == 0


@pytest.mark.parametrize("da", [0.15, 0.3])  # ends an element before ∂Ω, and beyond it
def test_a_crack_that_reaches_the_boundary_has_cut_the_body(da):
    """Here the upper part is free then: the last row says where, and has the length and the cycles of the cut."""
    growth = CrackGrowth(pulled, [Crack([(0, 0), (0.8, 0)])], Paris(C=1, m=2, da=da))
    table = growth.Run(5)
    assert len(table) == 2 and table["state"][0] == "grows" and table["advance"][0] == pytest.approx(0.2)
    assert table["state"][1] == "has cut the body: it reached the boundary at (1, 0)" and np.isnan(table["K_I"][1])
    assert table["length"][1] == growth.cracks[0].length == pytest.approx(1) and table["cycles"][1] == growth.cycles > 0
    assert len(growth.solutions) == 1


def test_a_cut_body_that_is_held_is_solved():
    """Both halves are clamped, so that there is a state after the cut."""

    def held(cracks):
        body = CrackedMesh(mesh(), *cracks)
        V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet="top|bottom")
        problem = ContactProblem(V, TraceSpace(body, order=1))
        problem.SetDirichlet(CF((0, 0.01)), "top")
        return problem

    growth = CrackGrowth(held, [Crack([(0, 0.2), (0.8, 0.2)]), Crack([(0, -0.2), (0.3, -0.2)])], GivenIncrement(0.15))
    before, _, after, cut = growth.Run(2)
    assert before["crack"] == cut["crack"] == 0 and before["advance"] == pytest.approx(0.2, rel=0.1) and cut["state"].startswith("has cut the body")
    assert len(growth.solutions) == 2 and abs(after["K_I"]) < 1e-9  # nothing pulls the lower part any more


def test_a_tip_that_reaches_another_crack_joins_it():
    growth = CrackGrowth(pulled, [Crack([(0, 0), (0.3, 0)]), Crack([(0.5, -0.1), (0.5, 0.1)])], GivenIncrement(0.15))
    first, *_ = growth.Step()
    assert first.advance == pytest.approx(0.2, abs=0.01) and first.state == "grows"
    rows = growth.Step()
    (joined,) = [row for row in rows if row.crack == 0]
    assert joined.state.startswith("has joined crack 1: it reached it at (0.5, ") and joined.x == pytest.approx(0.5, abs=1e-12)
    assert len(growth.solutions[-1].body.tips) == 2 and growth.solutions[-1].body.Ends(0)[1].kind == EndKind.Junction


def test_two_tips_that_meet_become_one_crack():
    """Both cracks end where they meet; nothing is left of the ligament."""
    growth = CrackGrowth(pulled, [Crack([(0, 0), (0.25, 0)]), Crack([(0.42, 0.03), (0.62, 0.03)])], GivenIncrement(0.15))
    growth.Step()
    rows = growth.Step()
    (joined,) = [row for row in rows if row.state.startswith("has joined")]
    body = growth.solutions[-1].body
    assert len(body.tips) == 1 and joined.crack in (0, 1)
    assert sum(end.kind == EndKind.Junction for c in range(2) for end in body.Ends(c)) == 2


def test_a_crack_beside_the_way_stops_a_tip():
    _, rows = step(pulled, [Crack([(0, 0), (0.3, 0)]), Crack([(0.1, 0.1), (0.7, 0.1)])], GivenIncrement(0.15))
    assert rows[0].state.startswith("stopped: ") and "crack" in rows[0].state


def test_a_solve_that_fails_raises_and_keeps_the_table():
    def problem(cracks):
        if cracks[0].length > 0.4:
            raise RuntimeError("no problem for this crack")
        return pulled(cracks)

    growth = CrackGrowth(problem, EDGE, GivenIncrement(0.15))
    with pytest.raises(RuntimeError, match="no problem"):
        growth.Run(3)
    assert len(growth.table) == 1


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: GivenIncrement(0), "da=0 must be positive"),
        (lambda: Paris(C=-1, m=3, da=0.1), "C=-1 must be positive"),
        (lambda: Paris(C=1, m=3, da=0.1, ratio=1), "ratio=1 must be at least 0 and less than 1"),
        (lambda: CrackGrowth(pulled, EDGE, GivenIncrement(0.1), toughness=-1), "toughness=-1 must be"),
    ],
)
def test_bad_arguments(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_short_increments_warn_once():
    """One and a half elements, which leave the functions of a new part no room; four of them are silent."""
    with pytest.warns(AccuracyWarning, match=r"an increment of 0.07 at the tip .* choose da >= 0\.1") as said:
        CrackGrowth(pulled, EDGE, GivenIncrement(0.07)).Run(2)
    assert len([warning for warning in said if "increment" in str(warning.message)]) == 1 and said[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        CrackGrowth(pulled, EDGE, GivenIncrement(0.2)).Run(1)


def test_laws_and_criteria_are_objects():
    with pytest.raises(TypeError, match="needs da and Advances"):
        CrackGrowth(pulled, EDGE, 0.1)


# Results


def test_the_crack_keeps_its_orientation():
    crack = Crack([(0.2, 0), (0.5, 0)])
    assert extended(crack, "start", (0.1, 0.1)).points == [(0.1, 0.1), (0.2, 0), (0.5, 0)]
    assert extended(crack, "end", (0.6, 0.1)).points == [(0.2, 0), (0.5, 0), (0.6, 0.1)]
    assert extended(crack, "end", (0.6, 0)).points == [(0.2, 0), (0.6, 0)] == extended(Crack([(0.3, 0), (0.6, 0)]), "start", (0.2, 0)).points


@pytest.mark.parametrize("end", ["start", "end"])
def test_a_curve_is_extended_from_its_end(end):
    """Straight, with a kink where it ended."""
    arc = Crack.Arc((0.2, 0), (0.35, 0.08), (0.5, 0))
    tip = np.array(arc.PointAt(0 if end == "start" else arc.length))
    new = tuple(tip + (0.05, -0.2))
    longer = extended(arc, end, new)
    assert longer.length == pytest.approx(arc.length + np.hypot(0.05, 0.2)) and len(longer.kinks) == 1
    assert longer.points[0 if end == "start" else -1] == pytest.approx(new)
    assert longer.TangentAt(0.5 * longer.length)[0] > 0  # orientation


def test_table_and_animation(tmp_path):
    """One row for each step and tip in the CSV, one picture for each step in the GIF, and they differ."""
    image = pytest.importorskip("PIL.Image")
    growth = CrackGrowth(pulled, EDGE, GivenIncrement(0.15))
    growth.Run(2)
    with open(growth.SaveTable(tmp_path / "growth.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    assert (
        [row["state"] for row in rows] == ["grows", "grows"]
        and float(rows[1]["length"]) == pytest.approx(0.45)
        and float(rows[1]["K_I"]) == growth.table["K_I"][1]
    )
    assert "grows" in str(growth) and len(str(growth).splitlines()) == 3
    with image.open(growth.Animate(tmp_path / "growth.gif")) as animation:
        assert animation.n_frames == 2
        first = np.array(animation.convert("RGB"), dtype=int)
        animation.seek(1)
        assert np.abs(first - np.array(animation.convert("RGB"), dtype=int)).max() > 50


@pytest.mark.parametrize("law", [None, Coulomb(0.3)])
def test_what_is_cut_off_and_pulled_away_ends_the_growth(law):
    """The faces are no straight line, so that contact feels all motions of the upper part; tension pulls it off. Two cracks meet in the middle, or one goes through."""

    def under_tension(cracks):
        body = CrackedMesh(mesh(), *cracks)
        V = CrackFESpace(body, order=1, material=MATERIAL, dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body, order=1), law=law)
        problem.f += CF((0, 1)) * V.TestFunction() * body.ds("top")
        return problem

    growth = CrackGrowth(under_tension, [Crack([(0, 0.05), (0.6, -0.1)])], GivenIncrement(0.25))
    table = growth.Run(6)
    assert table["state"][-1].startswith("has cut the body: it reached the boundary at (1, ")
    assert table["state"][-1].endswith("; the faces do not hold what is cut off") and np.isnan(table["K_I"][-1])
    assert len(growth.solutions) == len(table) - 1


def test_a_problem_with_other_cracks_than_those_that_it_was_given():
    with pytest.raises(ValueError, match=r"make_problem returned a body with a tip at \(0.3, 0.0\).*build the body of its argument"):
        CrackGrowth(lambda cracks: pulled(EDGE), EDGE, GivenIncrement(0.15)).Run(2)
    with pytest.raises(ValueError, match=r"a body with 0 crack\(s\), it was given 1"):
        CrackGrowth(lambda cracks: pulled([]), EDGE, GivenIncrement(0.15)).Run(2)
