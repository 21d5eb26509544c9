"""What the faces have gone through when cracks grow, meet, and are solved on other meshes."""

from dataclasses import dataclass

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import CF

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, LoadSteps, Nitsche, TraceSpace
from ngsxfem_contact.contact import ExponentialCohesive, Joint, MohrCoulomb
from ngsxfem_contact.contact.faces import FaceHistory
from ngsxfem_contact.fracture import GivenIncrement, WingCracks
from ngsxfem_contact.geometry import EndKind
from study.paper import MATERIAL

MESH = rectangle(0.05, (0, -0.5), (1, 0.5))
GLUE = ExponentialCohesive(0.6, 0.2)
STRAIGHT, INCLINED = Crack([(0, 0), (0.4, 0)], "glue"), Crack([(0, 0), (0.6, 0.1)], "fault")


def problem(cracks, law, stress, mesh=MESH, order=1, **options):
    """Held below, σn = stress above; law: of the faces, or one for each crack."""
    body = CrackedMesh(mesh, *cracks)
    V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet="bottom")
    made = ContactProblem(V, TraceSpace(body, order=order), law=law, **options)
    made.f += CF(stress) * V.TestFunction() * body.ds("top")
    return made


def under(law, *stresses, **options):
    """make_problem for CrackGrowth: each state has the next stress, the last one goes on."""
    left = list(stresses)
    return lambda cracks: problem(cracks, law, left.pop(0) if len(left) > 1 else left[0], **options)


def tractions(solution):
    return solution.state.history.traction


LAWS = {
    "glue": (GLUE, STRAIGHT, (0.0, 1.1), (0.0, 0.4)),
    "friction": (Coulomb(0.2), INCLINED, (0.5, -1.0), (0.1, -1.0)),
    "friction by nodes": ({"fault": Coulomb(0.2)}, INCLINED, (0.5, -1.0), (0.1, -1.0)),
    "dilation": (MohrCoulomb(0.2, dilation=0.1, k_n=50.0, k_t=50.0), INCLINED, (0.5, -1.0), (0.1, -1.0)),
}


@pytest.mark.parametrize("options", [{}, {"order": 0}, {"stabilisation": Nitsche(1)}], ids=["P1", "P0", "Nitsche"])
@pytest.mark.parametrize("law, crack, first, then", LAWS.values(), ids=LAWS)
def test_growth_is_load_steps_on_longer_cracks(law, crack, first, then, options):
    """A state under another load against the same by hand, its history carried to the longer crack's nodes; without a history it is another one."""
    growth = CrackGrowth(under(law, first, then, **options), [crack], GivenIncrement(0.15), WingCracks())
    growth.Run(2)
    short, long = growth.solutions
    made = problem(growth.cracks, law, then, **options)
    by_hand = made.Solve(previous=short.state.history.Carried(short.state.nodes, long.state.nodes))
    size = np.abs(tractions(long)).max()
    assert growth.cracks[0].name == crack.name and growth.cracks[0].length == pytest.approx(crack.length + 0.15)
    assert np.abs(tractions(long) - tractions(by_hand)).max() < 1e-9 * size
    assert long.DissipatedEnergy() == pytest.approx(by_hand.DissipatedEnergy(), rel=1e-6, abs=1e-12)
    assert np.abs(tractions(made.Solve()) - tractions(long)).max() > 0.02 * size


def test_growth_heals_no_damage():
    """Loaded, unloaded to a third as it grows: what was damaged pulls by the secant, and not as whole faces would."""
    growth = CrackGrowth(under(GLUE, (0, 1.0), (0, 0.3)), [STRAIGHT], GivenIncrement(0.15))
    growth.Run(2)
    (before, after), (old, new) = zip(*((s.state.history, s.state.nodes) for s in growth.solutions))
    here = new.positions[:, 0] < 0.4 - 0.05
    there = np.array([np.argmin(np.linalg.norm(old.positions - p, axis=1)) for p in new.positions[here]])
    assert np.abs(old.positions[there] - new.positions[here]).max() < 1e-12 and here.sum() > 10  # the mesh is the same
    largest = before.variables["opening"][there]
    assert after.variables["opening"][here][:-1] == pytest.approx(largest[:-1], rel=1e-12) and after.variables["opening"][here][-1] >= largest[-1]
    secant = before.traction[0][there] / before.jump[0][there]
    assert after.traction[0][here][:-1] == pytest.approx((secant * after.jump[0][here])[:-1], rel=1e-6)
    fresh = problem(growth.cracks, GLUE, (0, 0.3)).Solve().state.history
    assert (fresh.traction[0][here] > 1.5 * after.traction[0][here]).all() and (fresh.variables["opening"][here] < 0.5 * after.variables["opening"][here]).all()
    assert (new.weights @ after.variables["opening"]) >= (old.weights @ before.variables["opening"])


def test_growth_carries_slip():
    """Sheared, then pressed only: the slip of the first state is locked in, as a load step on the crack that did not grow says; a fresh solve has next to none."""
    growth = CrackGrowth(under(Coulomb(0.2), (0.5, -1.0), (0.0, -1.0)), [INCLINED], GivenIncrement(0.15), WingCracks())
    growth.Run(2)
    slip = [s.state.nodes.weights @ s.state.history.jump[1] for s in growth.solutions]
    fresh = problem(growth.cracks, Coulomb(0.2), (0.0, -1.0)).Solve()
    alone = problem(growth.cracks, Coulomb(0.2), (0.0, -1.0)).Solve(previous=growth.solutions[0])
    assert abs(slip[1]) > 0.2 * abs(slip[0]) and slip[1] == pytest.approx(alone.state.nodes.weights @ alone.state.history.jump[1], rel=1e-9)
    assert abs(slip[1] - fresh.state.nodes.weights @ fresh.state.history.jump[1]) > 0.1 * abs(slip[0])


def test_an_unchanged_crack_on_new_spaces_changes_nothing():
    """The history of each node comes back to it: no traction changes, nothing is dissipated."""
    for law, crack, stress, _ in LAWS.values():
        first = problem([crack], law, stress).Solve()
        again = problem([crack], law, stress).Solve(previous=first)
        assert np.abs(tractions(again) - tractions(first)).max() < 1e-9 * np.abs(tractions(first)).max()
        assert abs(again.DissipatedEnergy()) < 1e-9 * first.DissipatedEnergy()


def test_a_tip_that_waits_changes_nothing():
    """One crack grows far from another one, whose glue is as it was but for what the growth does to it."""
    cracks = [Crack([(0, -0.25), (0.4, -0.25)], "growing"), Crack([(1, 0.25), (0.8, 0.25)], "waiting")]
    growth = CrackGrowth(under({"growing": GLUE, "waiting": GLUE}, (0, 1.0)), cracks, GivenIncrement(0.15), toughness=1.5)
    first = growth.Step()
    assert [row.name for row in first] == ["growing", "waiting"] and [row.state == "grows" for row in first] == [True, False]
    growth.Step()
    old, new = ((s.state.nodes, s.state.history.variables["opening"]) for s in growth.solutions)
    assert (new[1][new[0].cracks == 1] >= old[1][old[0].cracks == 1] - 1e-15).all() and (new[0].cracks == 1).sum() == (old[0].cracks == 1).sum()


def test_growth_after_load_steps_and_load_steps_after_growth():
    steps = LoadSteps(problem([STRAIGHT], GLUE, (0, 1.0)))
    last = [steps.Solve(t) for t in (0.5, 1.0, 0.2)][-1]
    growth = CrackGrowth(under(GLUE, (0, 0.2)), [STRAIGHT], GivenIncrement(0.15), previous=last)
    growth.Run(2)
    first, second = growth.solutions
    assert np.abs(tractions(first) - tractions(last)).max() < 1e-9 and abs(first.DissipatedEnergy()) < 1e-12
    after = LoadSteps(problem(growth.cracks, GLUE, (0, 1.0)))
    reloaded = after.Solve(0.2, previous=second)
    assert np.abs(tractions(reloaded) - tractions(second)).max() < 1e-9
    assert after.Solve(0.1).DissipatedEnergy() == pytest.approx(0, abs=1e-12)


# Cracks that meet


def marked(nodes, value):
    """A history whose opening is a function of crack and place."""
    opening = np.array([value(crack, p) for crack, p in zip(nodes.cracks, nodes.positions)])
    return FaceHistory(np.stack([opening, -opening]), np.stack([opening, 2 * opening]), {"opening": opening})


def nodes_of(mesh, *cracks, order=1):
    return TraceSpace(CrackedMesh(mesh, *cracks), order=order).nodes


@pytest.mark.parametrize("order", [0, 1, 2])
def test_arms_that_meet_keep_their_own_histories(order):
    """A crossing, and nodes of another mesh: each arm has its value up to the crossing, where four nodes lie at one place."""
    cracks = Crack([(0.1, 0.01), (0.9, 0.03)]), Crack([(0.52, -0.4), (0.47, 0.4)])
    coarse, fine = nodes_of(MESH, *cracks, order=order), nodes_of(rectangle(0.03, (0, -0.5), (1, 0.5)), *cracks, order=order)
    for old, new in ((coarse, fine), (fine, coarse), (coarse, coarse)):
        values = arm_values(old)
        carried = FaceHistory(np.stack([values, -values]), np.stack([values, -values]), {}).Carried(old, new)
        assert carried.jump[0] == pytest.approx(arm_values(new), abs=1e-14)
    assert len(set(arm_values(coarse))) == 4


def arm_values(nodes):
    """A number for each arm, from 1: what neighbours connect."""
    arm = np.arange(len(nodes))
    for a, b in np.sort(nodes.neighbours, axis=1).tolist():
        arm[arm == arm[b]] = arm[a]
    return np.unique(arm, return_inverse=True)[1] + 1.0


def test_a_crack_that_joins_another_leaves_both_histories_where_they_were():
    """Crack 0 reaches the middle of crack 1, which has two arms from then on; what was constant or linear along each still is, the ligament is whole."""
    before = nodes_of(MESH, Crack([(0, 0), (0.3, 0)]), Crack([(0.5, -0.2), (0.5, 0.2)]))
    joined = nodes_of(MESH, Crack([(0, 0), (0.3, 0), (0.5, 0.003)]), Crack([(0.5, -0.2), (0.5, 0.2)]))
    value = lambda crack, p: 2 - p[0] if crack == 0 else 5 + p[1]
    carried = marked(before, value).Carried(before, joined)
    new = (joined.cracks == 0) & (joined.positions[:, 0] > 0.3 + 1e-9)
    exact = np.array([value(crack, p) for crack, p in zip(joined.cracks, joined.positions)])
    assert new.sum() >= 3 and (joined.cracks == 1).sum() == (before.cracks == 1).sum() + 1 + (np.abs(before.positions[:, 1] - 0.003).min() > 1e-9)
    assert carried.variables["opening"][~new] == pytest.approx(exact[~new], abs=1e-12)
    assert (carried.variables["opening"][new & (joined.positions[:, 0] > 0.34)] == 0).all()


def test_growth_through_a_junction():
    """The glue of both cracks survives the step in which one joins the other."""
    cracks = [Crack([(0, 0), (0.3, 0)], "a"), Crack([(0.5, -0.1), (0.5, 0.15)], "b")]
    growth = CrackGrowth(under(GLUE, (0.3, 1.0)), cracks, GivenIncrement(0.2))
    growth.Run(2)
    first, second = growth.solutions
    assert second.body.Ends("a")[1].kind == EndKind.Junction and any("joined crack 1 'b'" in row.state for row in growth.rows)
    for crack in (0, 1):
        old, new = ((s.state.nodes, s.state.history.variables["opening"]) for s in growth.solutions)
        for p, opening in zip(old[0].positions[old[0].cracks == crack], old[1][old[0].cracks == crack]):
            here = new[1][(new[0].cracks == crack) & (np.linalg.norm(new[0].positions - p, axis=1) < 1e-9)]
            assert (here >= opening - 1e-14).all()


def test_what_is_carried_is_conserved():
    """∫ of a slip that ends at the tip like √r, before and after growth straight on: nothing is lost, and what the last interval adds falls faster than h."""
    for maxh in (0.1, 0.05, 0.025):
        mesh = rectangle(maxh, (0, -0.5), (1, 0.5))
        old, new = nodes_of(mesh, Crack([(0, 0.01), (0.5, 0.01)])), nodes_of(mesh, Crack([(0, 0.01), (0.7, 0.01)]))
        history = marked(old, lambda crack, p: np.sqrt(max(0.25 - p[0] ** 2, 0)))
        carried = history.Carried(old, new)
        assert 0 <= new.weights @ carried.jump[1] / (old.weights @ history.jump[1]) - 1 < maxh**1.5


def test_a_node_alone_has_the_length_of_its_weight():
    """A crack with one node that becomes longer: what is beyond is new. A second crack with as many nodes as before is not touched."""

    @dataclass
    class Line:
        cracks: np.ndarray
        positions: np.ndarray
        weights: np.ndarray
        neighbours: np.ndarray

        def __len__(self):
            return len(self.cracks)

    at = lambda *xs: np.array([(x, 0.0) for x in xs])
    old = Line(np.array([0, 1, 1]), at(0.1, 0.5, 0.6), np.array([0.2, 0.1, 0.1]), np.array([[1, 2]]))
    new = Line(np.array([0, 0, 0, 1, 1]), at(0.05, 0.15, 0.4, 0.5, 0.6), np.array([0.1, 0.1, 0.1, 0.1, 0.1]), np.array([[0, 1], [1, 2], [3, 4]]))
    carried = FaceHistory(np.ones((1, 3)), np.array([[2.0, 3.0, 4.0]])).Carried(old, new)
    assert carried.jump[0] == pytest.approx([2, 2, 0, 3, 4])


# What is refused


def test_histories_of_other_cracks_are_refused():
    first = problem([STRAIGHT], GLUE, (0, 1.0)).Solve()
    with pytest.raises(ValueError, match=r"the history of crack 0 at \(.*\) is not on that crack now; each may be longer"):
        problem([Crack([(0, 0.2), (0.5, 0.2)])], GLUE, (0, 1.0)).Solve(previous=first)
    two = problem([STRAIGHT, Crack([(0.5, 0.2), (0.8, 0.2)])], GLUE, (0, 1.0)).Solve()
    with pytest.raises(ValueError, match="the history of crack 1 has no place: there is none of that number now"):
        problem([STRAIGHT], GLUE, (0, 1.0)).Solve(previous=two)


def test_laws_that_remember_nothing_begin_anew():
    """A joint and contact without friction have no history, whatever came before."""
    for law in (None, Joint(5.0, 5.0)):
        growth = CrackGrowth(under(law, (0, 1.0)), [STRAIGHT], GivenIncrement(0.15))
        growth.Run(2)
        alone = problem(growth.cracks, law, (0, 1.0)).Solve()
        assert np.abs(alone.Multipliers() - growth.solutions[1].Multipliers()).max() < 1e-10
