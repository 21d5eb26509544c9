"""Cracks with names: who keeps them, and what they stand for."""

import pickle
import re

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import CF, Integrate, x, y

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.contact import Joint
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.plotting import plot_profile

MESH = rectangle(0.1)
FAULT, VEIN = Crack([(-0.1, 0.3), (0.5, 0.3)], name="fault"), Crack([(0.5, 0.7), (1.0, 0.72)], name="vein")
MADE = {
    "polyline": lambda name: Crack([(0, 0), (1, 0), (1, 1)], name=name),
    "arc": lambda name: Crack.Arc((0, 0), (0.5, 0.1), (1, 0), name=name),
    "spline": lambda name: Crack.Spline([(0, 0), (0.5, 0.1), (1, 0)], name=name),
    "two points": lambda name: Crack.Spline([(0, 0), (1, 0)], name=name),
    "curve": lambda name: Crack.Curve(lambda t: (t, t * t), 0, 1, name=name),
    "level set": lambda name: Crack.LevelSet(MESH, y - 0.5 - 0.1 * x * x, name=name),
    "straight level set": lambda name: Crack.LevelSet(MESH, y - 0.5, name=name),
    "join": lambda name: Crack.Join(Crack([(0, 0), (1, 0)], name="a"), Crack([(1, 0), (1, 1)]), name=name),
    "pieces": lambda name: Crack.OfPieces([("segment", [(0, 0), (1, 0)])], name=name),
}


def two(law=None, *others):
    body = CrackedMesh(MESH, FAULT, VEIN, *others)
    V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(E=100, nu=0.3), dirichlet="bottom")
    made = ContactProblem(V, TraceSpace(body, order=1), law=law)
    made.f += CF((0.1, -1)) * V.TestFunction() * body.ds("top")
    return made


@pytest.mark.parametrize("make", MADE.values(), ids=MADE)
def test_all_constructors_take_a_name(make):
    crack, nameless = make("fault"), make("")
    assert crack.name == "fault" == pickle.loads(pickle.dumps(crack)).name and nameless.name == ""
    assert repr(crack).endswith(", name='fault')") and repr(crack).replace(", name='fault'", "") == repr(nameless)


def test_a_name_stays_where_ends_are_fitted():
    """One is cut off at the boundary, one ends on the other; notes and tips call them by it."""
    body = CrackedMesh(MESH, FAULT, Crack([(0.3, 0.305), (0.3, 0.6)], name="branch"))
    assert [crack.name for crack in body.cracks] == ["fault", "branch"] and body.cracks[0].length == pytest.approx(0.5)
    assert "crack 0 'fault': its start" in body.notes[0] and "crack 1 'branch': its start" in body.notes[1]
    assert any("crack 0 'fault'" in what for _, what in body.tips[1].distances)
    assert [crack.name for crack in pickle.loads(pickle.dumps(body)).cracks] == ["fault", "branch"]


def test_a_crack_is_asked_for_by_its_name():
    """As by its number, everywhere."""
    problem = two()
    body, solution = problem.body, problem.Solve()
    assert body.CrackNumber("vein") == body.CrackNumber(1) == 1
    assert body.Ends("vein")[0].point == body.Ends(1)[0].point and len(body.Elements("vein")) == len(body.Elements(1))
    assert body.MeshNodes("vein", True) == body.MeshNodes(1, True) and body.OnCrack("vein", [0.1])[0] == body.OnCrack(1, [0.1])[0]
    assert body.CutBoundaryElements("vein") == body.CutBoundaryElements(1) and body.CutBoundaryPoints("vein") == body.CutBoundaryPoints(1)
    assert list(body.CrackElements("vein")) == list(body.CrackElements(1)) and body.Meetings("vein") == []
    assert Integrate(CF(1) * body.dcrack(crack="vein"), MESH) == pytest.approx(body.cracks[1].length)
    assert solution.ContactForce("vein") == solution.ContactForce(1) != solution.ContactForce(0)
    assert (solution.Profile("vein").sigma_n == solution.Profile(1).sigma_n).all()
    assert (solution.Transitions("vein") == solution.Transitions(1)).all() and len(solution.SlipTransitions("fault")) == 0
    assert plot_profile(solution, "vein")


def test_laws_and_loads_by_name():
    named, numbered = two({"vein": Joint(5.0, 5.0), "fault": Coulomb(0.2)}), two({1: Joint(5.0, 5.0), 0: Coulomb(0.2)})
    for problem, vein in ((named, "vein"), (numbered, 1)):
        problem.FacePressure(0.3, crack=vein)
    one, other = named.Solve(), numbered.Solve()
    assert np.abs(one.Multipliers() - other.Multipliers()).max() == 0 and one.FaceEnergy() > 0


def test_messages_have_names():
    with pytest.raises(ValueError, match=re.escape("Coulomb: mu_f is -")) as refused:
        two({"vein": Coulomb(y - 2)}).Solve()
    assert "of crack 1 'vein'" in str(refused.value)
    with pytest.warns(AccuracyWarning, match="crack 2 'scratch' at .* is 0.05 long"):
        two(None, Crack([(0.3, 0.5), (0.35, 0.5)], "scratch"))
    with pytest.raises(Exception, match="cracks 0 'fault' and 1 'other' coincide near"):
        CrackedMesh(MESH, FAULT, Crack([(0.2, 0.3), (0.7, 0.3)], "other"))


def test_names_that_make_no_sense():
    with pytest.raises(Exception, match="cracks 0 and 1 are both named 'fault'; give each a name of its own"):
        CrackedMesh(MESH, FAULT, Crack([(0.1, 0.8), (0.6, 0.8)], "fault"))
    CrackedMesh(MESH, Crack([(0.1, 0.8), (0.6, 0.8)]), Crack([(0.1, 0.2), (0.6, 0.2)]))  # both without
    body = two().body
    for ask in (body.CrackNumber, body.Ends, lambda name: body.dcrack(crack=name), lambda name: two({name: None}), two().Solve().Profile):
        with pytest.raises(ValueError, match="no crack is named 'valt'; there is 'fault', 'vein'"):
            ask("valt")
    with pytest.raises(ValueError, match="none has a name, see"):
        CrackedMesh(MESH, Crack([(0.1, 0.8), (0.6, 0.8)])).CrackNumber("fault")
    with pytest.raises(ValueError, match="law has two laws of crack 0 'fault', by its number and by its name"):
        two({0: None, "fault": Coulomb(0.1)})
    with pytest.raises(TypeError):
        Crack([(0, 0), (1, 1)], name=3)
