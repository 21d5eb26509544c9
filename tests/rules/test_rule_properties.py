"""Rules of random and adversarial cracks, point by point, against moments by Green's theorem, which know nothing of elements."""

import numpy as np
import pytest
from helpers import moment, rectangle, side_areas, structured, vertices
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.geometry import Side

some = settings(max_examples=15, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])  # no test asks for a time
MESHES = {"unstructured": rectangle(0.12), "structured": structured(6)}
meshes = pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES.keys())
ORDER = 4
GRID = 1 / 6  # of the structured mesh

displacements = st.sampled_from([0.0] + [sign * eps for eps in (1e-15, 1e-12, 1e-9, 1e-6) for sign in (1, -1)])
# anywhere, or on a vertex or an edge of the structured mesh and beside it
heights = st.floats(0.2, 0.8) | st.builds(lambda k, eps: k * GRID + eps, st.integers(2, 4), displacements)


def within(crack):
    """The crack, if it stays between x = 0 and x = 1: what leaves the body is cut off there, and the moments know nothing of it."""
    near_end = np.geomspace(1e-9, 0.5, 100)
    x = [crack.PointAt(s * crack.length)[0] for s in (*near_end, *(1 - near_end))]
    assume(min(x) >= 0 and max(x) <= 1)
    return crack


def polyline(h):
    return Crack(list(zip(np.linspace(0, 1, len(h)), h)))


def arc(h):
    assume(abs(h[1] - 0.5 * (h[0] + h[2])) > 1e-3)
    return within(Crack.Arc((0, h[0]), (0.5, h[1]), (1, h[2])))


def spline(h):
    return Crack.Spline(list(zip(np.linspace(0, 1, len(h)), h)))


def joined(h):
    """A segment and an arc: kinked in an element or on an edge, a straight and a curved chord in one element."""
    assume(abs(h[2] - 0.5 * (h[1] + h[3])) > 1e-3)
    return within(Crack.Join(Crack([(0, h[0]), (0.5, h[1])]), Crack.Arc((0.5, h[1]), (0.75, h[2]), (1, h[3]))))


def lists(least, most):
    return st.lists(heights, min_size=least, max_size=most)


through_cracks = st.builds(polyline, lists(2, 4)) | st.builds(arc, lists(3, 3)) | st.builds(spline, lists(4, 4)) | st.builds(joined, lists(4, 4))


def interior(crack, start, end):
    """Between two points of the unit square, by moving a crack from (0, ·) to (1, ·) there."""
    (x0, y0), (x1, y1) = start, end
    place = lambda p: (x0 + p[0] * (x1 - x0) - 0.3 * p[1] * (y1 - y0), y0 + p[0] * (y1 - y0) + 0.3 * p[1] * (x1 - x0))
    pieces = [("arc", [place(p) for p in points]) if kind == "arc" else (kind, points) for kind, points in crack.pieces]
    return Crack.OfPieces(pieces) if pieces[0][0] == "arc" else Crack([place(p) for p in crack.points])


corners = st.integers(1, 2) | st.floats(1, 2)
interior_cracks = st.builds(
    interior,
    st.builds(polyline, lists(2, 3)) | st.builds(arc, lists(3, 3)),
    st.builds(lambda i, j, eps: (i * GRID + eps, (j + 1) * GRID), corners, corners, displacements),
    st.builds(lambda i, j, eps: ((i + 2) * GRID + 0.1, (j + 2) * GRID + eps), corners, corners, displacements),
)


def body_of(mesh, crack):
    """A position that a mesh this coarse is refused for, with a reason, is no example."""
    try:
        return CrackedMesh(mesh, crack)
    except Exception as refused:
        assume(
            not any(
                reason in str(refused) for reason in ("refine", "touch or cross itself", "leaves the body", "lies outside the body", "touches the boundary")
            )
        )
        raise


def green(crack, i, j):
    """∫ over the curve of x^(i+1)/(i+1) y^j dy, by Gauss on its smooth pieces."""
    nodes, weights = np.polynomial.legendre.leggauss(30)
    ends = [0.0, *(crack.ArcLength(p) for p in crack.points[1:-1]), crack.length]
    total = 0.0
    for a, b in zip(ends, ends[1:]):
        for s, w in zip(0.5 * (a + b) + 0.5 * (b - a) * nodes, 0.5 * (b - a) * weights):
            (x, y), (_, ty) = crack.PointAt(s), crack.TangentAt(s)
            total += w * x ** (i + 1) * y**j * ty / (i + 1)
    return total


def moment_above(crack, i, j):
    """∫ x^i y^j over the part of the unit square to the left of a crack from x = 0 to x = 1."""
    h = crack.points[-1][1]
    return green(crack, i, j) + (1 - h ** (j + 1)) / (j + 1) / (i + 1)


def barycentric(mesh, element, p):
    triangle = vertices(mesh, element)
    system = np.vstack([triangle.T, np.ones(3)])
    return np.linalg.solve(system, np.append(p, 1))


def parts(body):
    """Elements that carry the crack: the points of their rules, weights, and whether they lie on the plus side."""
    element, _, _, w, x, y = body.dx.Points(ORDER)
    crack = body.cracks[0]
    for place in body.Elements(0):
        own = element == place.element
        points = np.column_stack([x[own], y[own]])
        yield place, points, w[own], np.array([crack.SideOf(tuple(p)) == Side.Plus for p in points])


@meshes
@given(crack=through_cracks)
@some
def test_moments_on_both_sides(mesh, crack):
    body = body_of(mesh, crack)
    element, _, _, w, x, y = body.dx.Points(ORDER)
    plus = np.array([crack.SideOf(p) == Side.Plus for p in zip(x, y)])
    for i in range(ORDER + 1):
        f = w * x**i * y ** (ORDER - i)
        above, whole = moment_above(crack, i, ORDER - i), 1 / (i + 1) / (ORDER - i + 1)
        assert f[plus].sum() == pytest.approx(above, abs=1e-10)
        assert f[~plus].sum() == pytest.approx(whole - above, abs=1e-10)


@meshes
@given(crack=through_cracks | interior_cracks)
@some
def test_moments_of_every_element(mesh, crack):
    """The two parts of a triangle together, whatever the crack does in it."""
    for place, p, w, _ in parts(body_of(mesh, crack)):
        for i in range(ORDER + 1):
            exact = moment(vertices(mesh, place.element), i, ORDER - i)
            assert w @ (p[:, 0] ** i * p[:, 1] ** (ORDER - i)) == pytest.approx(exact, abs=1e-13)


@meshes
@given(crack=through_cracks | interior_cracks)
@some
def test_weights_are_positive_and_points_inside(mesh, crack):
    for place, points, w, _ in parts(body_of(mesh, crack)):
        assert (w > 0).all()
        assert min(barycentric(mesh, place.element, p).min() for p in points) > -1e-9


@meshes
@given(crack=through_cracks)
@some
def test_points_lie_on_the_side_that_their_weight_counts_for(mesh, crack):
    body = body_of(mesh, crack)
    for place, _, w, plus in parts(body):
        areas = side_areas(body, place)
        assert sum(areas) == pytest.approx(moment(vertices(mesh, place.element)), rel=1e-12)
        assert (w[plus].sum(), w[~plus].sum()) == pytest.approx(areas, abs=1e-10 * place.h)


@meshes
@given(crack=through_cracks | interior_cracks)
@some
def test_rules_on_the_crack(mesh, crack):
    """Points on the crack and in their elements, whose chords follow each other; powers of the arc length."""
    body = body_of(mesh, crack)
    (crack,) = body.cracks  # as fitted to the body
    element, _, _, w, x, y = body.dcrack.Points(ORDER)
    s = np.array([crack.ArcLength(p) for p in zip(x, y)])
    assert (w > 0).all()
    assert max(crack.Distance(p) for p in zip(x, y)) < 1e-9
    assert min(barycentric(mesh, e, p).min() for e, p in zip(element, zip(x, y))) > -1e-8
    chords = sorted((c[0], c[1]) for place in body.Elements(0) if place.element in set(element) for c in place.chords)
    tolerance = 1e-10 * max(place.h for place in body.Elements(0))  # within which a position counts as exact
    assert (chords[0][0], chords[-1][1]) == pytest.approx((0, crack.length), abs=tolerance)
    assert [b for _, b in chords[:-1]] == pytest.approx([a for a, _ in chords[1:]], abs=tolerance)
    for k in range(ORDER + 1):
        assert w @ s**k == pytest.approx(crack.length ** (k + 1) / (k + 1), rel=1e-8)
