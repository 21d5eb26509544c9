"""Cracks of many pieces: found by trees, they divide elements into parts in proportion to their number, and give what few long pieces give."""

import numpy as np
import pytest
from helpers import rectangle, side_areas, structured
from ngsolve import CF, Integrate, x, y

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.geometry import Side

MATERIAL = Elasticity.PlaneStrain(E=1e3, nu=0.3)


def half_circle(n):
    return Crack([(0.5 - 0.2 * np.cos(t), 0.5 + 0.2 * np.sin(t)) for t in np.linspace(0, np.pi, n)])


def zigzag(n, height):
    """From (0, 0.41) to the right, up and down with teeth of random height, low ones where it crosses a diagonal of the unit square."""
    rng, t = np.random.default_rng(n), np.linspace(0, 1, n)
    teeth = np.where(np.arange(n) % 2, 1, -1) * rng.uniform(0.3, 1, n) * np.minimum(1, 40 * np.abs((t - 0.41) * (t - 0.59)))
    return Crack(list(zip(t, 0.41 + height * teeth)))


def brute_force(points, p):
    """Distance and arc length of the nearest point of a polyline."""
    a, d = points[:-1], np.diff(points, axis=0)
    lengths = np.hypot(*d.T)
    t = np.clip(((p - a) * d).sum(axis=1) / lengths**2, 0, 1)
    distances = np.hypot(*(p - a - t[:, None] * d).T)
    i = int(np.argmin(distances))
    return distances[i], lengths[:i].sum() + t[i] * lengths[i]


@pytest.mark.parametrize("crack", [half_circle(300), zigzag(501, 0.03), Crack([(0, 0), (1, 0)])], ids=["arc", "zigzag", "one"])
def test_nearest_points(crack):
    """By the tree as by looking at every segment; near the crack and far from it, on axes, too."""
    points, rng = np.array(crack.points), np.random.default_rng(1)
    near = points[rng.integers(len(points), size=60)] + rng.normal(size=(60, 2)) * np.repeat([1e-9, 1e-3, 0.1], 20)[:, None]
    for p in [*near, *rng.uniform(-3, 3, (20, 2)), (0.5, 0.0), (0.25, 0.0)]:
        distance, s = brute_force(points, np.array(p))
        assert crack.Distance(tuple(p)) == pytest.approx(distance, rel=1e-12, abs=1e-15)
        assert np.hypot(*(np.array(crack.PointAt(crack.ArcLength(tuple(p)))) - crack.PointAt(s))) < 1e-12 + 1e-9 * distance or distance > 0.05


def test_a_long_crack_that_meets_itself_is_refused():
    spiral = lambda turns, n: [((0.1 + 0.02 * t) * np.cos(t), (0.1 + 0.02 * t) * np.sin(t)) for t in np.linspace(0, 2 * np.pi * turns, n)]
    Crack(spiral(3, 2000))
    with pytest.raises(Exception, match=r"pieces \d+ and 1999 meet near .* must not touch or cross itself"):
        Crack([*spiral(3, 2000), (0.05, 0.0)])


@pytest.mark.parametrize("n, height", [(41, 0.08), (400, 0.02), (400, 0.002), (1500, 1e-4)])
def test_a_jagged_crack_divides_few_elements(n, height):
    """Areas and moments above it by the trapezoids below each segment, and parts in proportion to the segments."""
    mesh, crack = structured(1), zigzag(n, height)
    body = CrackedMesh(mesh, crack)
    a, b = np.array(crack.points[:-1]), np.array(crack.points[1:])
    width = b[:, 0] - a[:, 0]
    area = 1 - (width * 0.5 * (a[:, 1] + b[:, 1])).sum()
    moment = 0.5 - (width / 6 * (a[:, 1] ** 2 + a[:, 1] * b[:, 1] + b[:, 1] ** 2)).sum()
    above = 0.5 * (1 + crack.side)
    assert Integrate(above * body.dx, mesh) == pytest.approx(area, abs=1e-12)
    assert Integrate(above * y * body.dx, mesh) == pytest.approx(moment, abs=1e-12)
    assert Integrate(1 * body.dx, mesh) == pytest.approx(1, abs=1e-12)
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(crack.length, rel=1e-10)
    assert sum(side_areas(body, place)[0] for place in body.Elements(0)) == pytest.approx(area - sum_above(body), abs=1e-12)
    assert sum(len(body.Parts(place.element)) for place in body.Elements(0)) < 12 * n


def sum_above(body):
    """The area of the uncut elements above the crack."""
    cut = {place.element for place in body.Elements(0)}
    areas = Integrate(0.5 * (1 + body.cracks[0].side) * body.dx, body.mesh, element_wise=True)
    return sum(area for element, area in enumerate(areas) if element not in cut)


def solve(crack, mesh):
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=2, tip=None, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, nodes=body.MeshNodes(0, False)), MATERIAL)
    problem.f += CF((0, 100 * (x - 0.3))) * V.TestFunction() * body.ds("top")
    return problem.Solve()


def test_a_polyline_of_many_points_is_the_arc():
    """Its energy converges to that of the arc, and its rules have some points for each segment."""
    mesh = rectangle(0.09)
    arc = solve(Crack.Arc((0.3, 0.5), (0.5, 0.7), (0.7, 0.5)), mesh)
    fine, finer = (solve(half_circle(n), mesh) for n in (51, 601))
    off = [solution.Energy() / arc.Energy() - 1 for solution in (fine, finer)]
    assert abs(off[0]) < 5e-5 and abs(off[1]) < abs(off[0]) / 12
    points = [len(solution.body.dx.Points(4)[0]) for solution in (arc, finer)]
    assert points[1] < points[0] + 25 * 600
    curve = solve(Crack.Curve(lambda t: (0.5 - 0.2 * np.cos(t), 0.5 + 0.2 * np.sin(t)), 0, np.pi), mesh)
    assert curve.Energy() == pytest.approx(arc.Energy(), rel=1e-7)


def test_several_cracks_of_many_pieces_share_elements():
    """Two wavy cracks through the same elements, of 300 points each: areas on either side."""
    mesh, t = rectangle(0.25), np.linspace(0, 1, 301)
    waves = [Crack(list(zip(t, height + 0.01 * np.sin(9 * t)))) for height in (0.45, 0.5)]
    body = CrackedMesh(mesh, *waves)
    assert any(len(body.CracksOf(element)) == 2 for element in range(mesh.ne))
    between = 0.25 * (1 + waves[0].side) * (1 - waves[1].side)
    assert Integrate(between * body.dx, mesh) == pytest.approx(0.05, abs=1e-12)


def test_points_on_a_crack_lie_in_elements_that_carry_them():
    body = CrackedMesh(rectangle(0.2), half_circle(200))
    crack, s = body.cracks[0], np.linspace(0, 1, 101) * body.cracks[0].length
    elements, xi, eta = (np.array(part) for part in body.OnCrack(0, list(s)))
    places = {place.element: place for place in body.Elements(0)}
    for element, a, b, arc in zip(elements, xi, eta, s):
        triangle = np.array(places[element].triangle)
        assert a * triangle[0] + b * triangle[1] + (1 - a - b) * triangle[2] == pytest.approx(np.array(crack.PointAt(arc)), abs=1e-12)
        assert min(max(s0 - arc, arc - s1) for s0, s1 in places[element].chords) < 1e-9
    assert crack.SideOf((0.5, 0.5)) == Side.Minus
