"""A body does not change: what is built on it, refused or deleted leaves the rules of everything else as they are, and takes its own with it."""

import gc

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import Grad, InnerProduct

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, TipEnrichment, TraceSpace
from ngsxfem_contact import _ngsxfem_contact as core

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # disks are small on purpose
MEASURES = [("dx", 1), ("dx", 4), ("ds", 3), ("dcrack", 2), ("dlarger", 2)]


@pytest.fixture
def body():
    """A crack with two tips, in elements without another, and one that ends at a mouth."""
    return CrackedMesh(rectangle(0.15), Crack([(0.3, 0.32), (0.6, 0.35)]), Crack.Arc((0, 0.7), (0.3, 0.76), (0.6, 0.7)))


def tables(body, space=None):
    """All points and weights."""
    return [np.array(getattr(body, name).Points(order, space=space)) for name, order in MEASURES]


def facts(body):
    """What the body itself says."""
    places = [(place.element, place.kind, body.PartSizes(place.element), place.arclength) for c in range(len(body.cracks)) for place in body.Elements(c)]
    return places, [(tip.point, tip.ahead, tip.clearance, tip.limit) for tip in body.tips], body.notes


def make_other(body):
    """A space with other disks, whose rules are made and used."""
    V = space_with(body, 0.05)
    stiffness(V)
    return V


def make_refused(body):
    """Disks that reach beyond the clearance of the tips."""
    with pytest.raises(Exception, match="reaches"):
        space_with(body, 0.5)


def make_deleted(body):
    """Made, used and gone."""
    make_other(body)
    gc.collect()


def make_restricted(body):
    """Measures of other kinds."""
    return [body.dcrack(nodes=[[0.1], [0.2]]), body.dx(space=space_with(body, 0.04)), body.dlarger(crack=1)]


def make_multipliers(body):
    """Their rules are divided at their nodes."""
    W = TraceSpace(body, order=0)
    W.dcrack.Points(2)
    return W


def space_with(body, r1):
    """Functions at all tips."""
    return CrackFESpace(body, order=2, tip=TipEnrichment(r1=r1, functions="branch"))


def stiffness(V):
    """The entries of a matrix whose rules break at the radii of V's disks."""
    u, v = V.TnT()
    form = core.CrackBilinearForm(V)
    form += InnerProduct(Grad(u), Grad(v)) * V.body.dx
    return form.Assemble().mat.AsVector().FV().NumPy().copy()


@pytest.mark.parametrize("make", [make_other, make_refused, make_deleted, make_restricted, make_multipliers])
def test_what_is_made_on_a_body_changes_nothing_for_others(body, make):
    """The body, the rules of its measures, those of a space that lives, and its matrix, to the last bit."""
    V = space_with(body, 0.1)
    before = facts(body), tables(body), tables(body, V), stiffness(V)
    made = make(body)
    after = facts(body), tables(body), tables(body, V), stiffness(V)
    assert before[0] == after[0]
    for old, new in zip(before[1] + before[2] + [before[3]], after[1] + after[2] + [after[3]]):
        np.testing.assert_array_equal(old, new)
    del made


def test_rules_of_other_disks_are_others(body):
    """Or the test above could not fail."""
    sizes = {table.shape for V in (space_with(body, 0.1), space_with(body, 0.05)) for table in tables(body, V)[:2]}
    assert len(sizes) == 4


def test_equal_disks_share_their_rules(body):
    """They are made once, whoever asks."""
    start = core.NumKeptRules(body)
    first = space_with(body, 0.1)
    kept = core.NumKeptRules(body)
    assert kept > start == 0
    second = space_with(body, 0.1)
    assert core.NumKeptRules(body) == kept
    third = space_with(body, 0.09)
    assert core.NumKeptRules(body) == kept + 1
    del first, second, third


HOLDERS = {
    "a space": lambda V: V,
    "a measure": lambda V: V.body.dx(space=V),
    "a form": lambda V: InnerProduct(*V.TnT()) * V.body.dx,
    "a function": lambda V: Grad(V.TrialFunction()),
}


@pytest.mark.parametrize("holder", HOLDERS.values(), ids=list(HOLDERS))
def test_rules_go_with_their_last_holder(body, holder):
    """Whoever that is."""
    held = holder(space_with(body, 0.1))
    gc.collect()
    assert core.NumKeptRules(body) > 0
    del held
    gc.collect()
    assert core.NumKeptRules(body) == 0


def test_a_refused_space_leaves_no_rules(body):
    """Also one that is refused after its rules were looked up."""
    make_refused(body)
    with pytest.raises(Exception, match="give one for each"):
        core.CrackFESpace(body, [core.TipSpec(core.TipBasis.branch, core.CutOff.quintic, 0.01, 0.05, 0, 1)], 1e-5)
    gc.collect()
    assert core.NumKeptRules(body) == 0
