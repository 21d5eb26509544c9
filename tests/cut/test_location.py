"""CrackedMesh: tips and mouths, kinds of elements, degenerate positions."""

from collections import Counter

import numpy as np
import pytest
from helpers import moment, rectangle, structured, vertices
from ngsolve import Integrate, Mesh

from ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.geometry import ElementKind, EndKind

FLAGS = ("through_vertex", "along_edge", "tip_on_edge", "tip_on_vertex", "kink_inside")


def kinds(body, crack=0):
    return Counter(place.kind.name for place in body.Elements(crack))


def flags(body):
    """How many elements carry each mark."""
    return Counter(flag for place in body.Elements(0) for flag in FLAGS if getattr(place.degeneracy, flag))


def ends(body, crack=0):
    return [end.kind.name for end in body.Ends(crack)]


# On structured(4) the grid lines are multiples of 1/4, the diagonals x + y = k/4.
PLACES = {
    "generic, edge crack": ([(0, 0.4), (0.6, 0.45)], ["Mouth", "Tip"], dict(Cut=5, Tip=1), dict(), 1),
    "through the body": ([(0, 0.4), (1, 0.3)], ["Mouth", "Mouth"], dict(Cut=8), dict(), 2),
    "interior": ([(0.1, 0.6), (0.7, 0.6)], ["Tip", "Tip"], dict(Cut=4, Tip=2), dict(), 0),
    "within one element": ([(0.05, 0.1), (0.12, 0.12)], ["Tip", "Tip"], dict(Tip=1), dict(), 0),
    "through a vertex": ([(0, 0.4), (1, 0.6)], ["Mouth", "Mouth"], dict(Cut=8), dict(through_vertex=2), 2),
    "along edges": ([(0, 0.5), (1, 0.5)], ["Mouth", "Mouth"], dict(Aligned=4), dict(along_edge=4, through_vertex=4), 0),
    "along a diagonal": ([(0, 1), (1, 0)], ["Mouth", "Mouth"], dict(Aligned=4), dict(along_edge=4, through_vertex=4), 0),
    "tip on an edge": ([(0, 0.4), (0.5, 0.4)], ["Mouth", "Tip"], dict(Cut=4), dict(tip_on_edge=1), 1),
    "tip in an aligned edge": ([(0, 0.5), (0.6, 0.5)], ["Mouth", "Tip"], dict(Aligned=3), dict(along_edge=3, through_vertex=3, tip_on_edge=1), 0),
    "tip on a vertex": ([(0, 0.4), (0.5, 0.5)], ["Mouth", "Tip"], dict(Cut=4), dict(through_vertex=1, tip_on_vertex=1), 1),
    "kink inside": ([(0, 0.4), (0.3, 0.43), (0.6, 0.3)], ["Mouth", "Tip"], dict(Cut=4, Tip=1), dict(kink_inside=1), 1),
    "mouth at a vertex": ([(0, 0.25), (0.6, 0.4)], ["Mouth", "Tip"], dict(Cut=5), dict(through_vertex=1, tip_on_edge=1), 0),
}


@pytest.mark.parametrize("points, end_kinds, kind_count, marks, cut_edges", PLACES.values(), ids=PLACES.keys())
def test_positions_known_by_hand(points, end_kinds, kind_count, marks, cut_edges):
    body = CrackedMesh(structured(4), Crack(points))
    assert ends(body) == end_kinds
    assert kinds(body) == kind_count
    assert flags(body) == marks
    assert len(body.CutBoundaryElements(0)) == cut_edges
    assert [tip.point for tip in body.tips] == [e.point for e in body.Ends(0) if e.kind == EndKind.Tip]


def moved(points, eps):
    """Inner points of the body move up; x stays, so that mouths stay on the left and right edges."""
    return [(x, y + eps) for x, y in points]


@pytest.mark.parametrize("eps", [1e-15, -1e-15, 1e-12, -1e-12])
@pytest.mark.parametrize("name", ["through a vertex", "along edges", "tip on a vertex", "tip in an aligned edge", "mouth at a vertex"])
def test_displacements_below_the_tolerance_are_snapped(name, eps):
    points, end_kinds, kind_count, marks, _ = PLACES[name]
    body = CrackedMesh(structured(4), Crack(moved(points, eps)))
    assert (ends(body), kinds(body), flags(body)) == (end_kinds, kind_count, marks)


@pytest.mark.parametrize("eps", [0, 1e-15, 1e-12, 1e-9, -1e-9, 1e-6, -1e-6])
@pytest.mark.parametrize("name", ["through a vertex", "along edges", "tip on a vertex", "tip in an aligned edge", "mouth at a vertex"])
def test_lengths_and_areas_whatever_the_displacement(name, eps):
    """To round-off, and to the snapping distance 1e-10 h in the split of an area."""
    mesh, crack = structured(4), Crack(moved(PLACES[name][0], eps))
    body = CrackedMesh(mesh, crack)
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(crack.length, abs=1e-10)
    assert Integrate(1 * body.dx, mesh) == pytest.approx(1, abs=1e-13)
    for place in body.Elements(0):
        assert sum(body.PartSizes(place.element)) == pytest.approx(abs(moment(place.triangle)), rel=1e-12)


def test_beyond_the_tolerance_an_aligned_crack_cuts_slivers():
    body = CrackedMesh(structured(4), Crack([(0, 0.5 + 1e-6), (1, 0.5 + 1e-6)]))
    assert kinds(body) == dict(Cut=8)
    assert min(min(body.PartSizes(p.element)) for p in body.Elements(0)) < 1e-6


def test_a_tip_between_edge_and_cell():
    def tip(eps):
        return kinds(CrackedMesh(structured(4), Crack([(0, 0.4), (0.5 + eps, 0.4)])))

    assert tip(1e-12) == tip(-1e-12) == dict(Cut=4)
    assert tip(1e-6) == dict(Cut=4, Tip=1)
    assert tip(-1e-6) == dict(Cut=3, Tip=1)


def test_several_cracks_and_their_clearances():
    mesh = rectangle(0.1)
    body = CrackedMesh(mesh, Crack([(0, 0.3), (0.5, 0.3)]), Crack([(0.4, 0.7), (0.6, 0.7)]))
    assert [(tip.crack, tip.point) for tip in body.tips] == [(0, (0.5, 0.3)), (1, (0.4, 0.7)), (1, (0.6, 0.7))]
    assert body.tips[0].clearance == pytest.approx(0.5 * np.hypot(0.1, 0.4))
    assert body.tips[1].clearance == body.tips[2].clearance == pytest.approx(0.1)
    assert body.tips[0].ahead == pytest.approx((1, 0)) and body.tips[1].ahead == pytest.approx((-1, 0))
    for crack in range(2):
        numbers = {place.element for place in body.Elements(crack)}
        bits = body.CrackElements(crack)
        assert numbers == {i for i in range(mesh.ne) if bits[i]}


def test_clearance_ends_at_the_next_kink():
    body = CrackedMesh(rectangle(0.1), Crack([(0, 0.5), (0.5, 0.5), (0.6, 0.6)]))
    assert body.tips[0].clearance == pytest.approx(np.hypot(0.1, 0.1))


def two_materials():
    from netgen.occ import Glue, MoveTo, OCCGeometry, Rectangle

    parts = [Rectangle(0.5, 1).Face(), MoveTo(0.5, 0).Rectangle(0.5, 1).Face()]
    shape = Glue(parts)
    for edge in shape.edges:
        edge.name = "interface" if abs(edge.center.x - 0.5) < 1e-9 else "outer"
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.25))


def test_an_interface_of_materials_is_no_boundary_of_the_body():
    body = CrackedMesh(two_materials(), Crack([(0, 0.4), (0.45, 0.42)]))
    assert ends(body) == ["Mouth", "Tip"]
    tip = body.tips[0]
    assert tip.clearance == pytest.approx(0.42) and tip.limit == "the boundary of the body"


def test_every_crossed_element_is_found():
    """Against the sign of the distance at the corners: a straight crack through the body."""
    mesh = rectangle(0.1)
    crack = Crack([(0, 0.41), (1, 0.57)])
    body = CrackedMesh(mesh, crack)
    for i in range(mesh.ne):
        d = vertices(mesh, i)[:, 1] - 0.41 - 0.16 * vertices(mesh, i)[:, 0]
        assert body.CrackElements(0)[i] == bool(d.min() < 0 < d.max())
    assert all(place.kind == ElementKind.Cut for place in body.Elements(0))
