"""Where a crack meets the boundary of the body: ends outside, ends that nearly reach it, curved boundaries, and inner boundaries in the disk of a tip."""

from math import cos, hypot, pi, radians, sin, sqrt

import numpy as np
import pytest
from helpers import rectangle, structured
from netgen.geom2d import SplineGeometry
from netgen.occ import Axis, Circle, Glue, MoveTo, OCCGeometry, Rectangle, X, Y, Z
from ngsolve import BND, CF, GridFunction, Integrate, LinearForm, Mesh, dx, specialcf, x, y

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.geometry import EndKind
from ngsxfem_contact.plotting.split_mesh import SplitMesh

MATERIAL = Elasticity.PlaneStrain(E=100, nu=0.3)
SQUARE = rectangle(0.13)


def kinds(body, crack=0):
    return [end.kind.name for end in body.Ends(crack)]


# Ends outside of the body

OUTSIDE = {
    "segment": (Crack([(-0.2, 0.4), (0.6, 0.5)]), (0, 0.425)),
    "by round-off": (Crack([(-1e-8, 0.4), (0.6, 0.5)]), (0, 0.4)),
    "joint on the boundary": (Crack([(-0.3, 0.3), (0, 0.42), (0.5, 0.45)]), (0, 0.42)),
    "joint just outside": (Crack([(-0.3, 0.3), (-1e-9, 0.42), (0.5, 0.42)]), (0, 0.42)),
    "arc": (Crack.Arc((-0.3, 0.5), (0, 0.8), (0.3, 0.5)), (0, 0.8)),
    "spline": (Crack.Spline([(-0.3, 0.3), (-0.1, 0.4), (0.1, 0.4), (0.5, 0.6)]), None),
    "through a corner": (Crack([(-0.1, -0.1), (0.4, 0.4)]), (0, 0)),
}


@pytest.mark.parametrize("crack, mouth", OUTSIDE.values(), ids=OUTSIDE.keys())
def test_a_crack_is_cut_off_at_the_boundary(crack, mouth):
    body = CrackedMesh(SQUARE, crack)
    start = body.cracks[0].points[0]
    assert kinds(body) == ["Mouth", "Tip"] and len(body.tips) == 1
    assert abs(start[0]) < 1e-14 and crack.Distance(start) < 1e-14
    assert mouth is None or start == pytest.approx(mouth, abs=2e-9)
    assert body.cracks[0].points[-1] == crack.points[-1]
    assert body.cracks[0].length == pytest.approx(crack.length - crack.ArcLength(start), abs=1e-8)
    assert Integrate(1 * body.dcrack, SQUARE) == pytest.approx(body.cracks[0].length, abs=1e-10)
    (note,) = body.notes
    assert "crack 0: its start" in note and "cut off at the boundary" in note


def test_both_ends_outside_and_the_direction_of_travel():
    body = CrackedMesh(SQUARE, Crack([(0.2, 0.9), (0.8, 0.9)]), Crack([(1.2, 0.3), (-0.1, 0.4)]))
    assert kinds(body) == ["Tip", "Tip"] and kinds(body, 1) == ["Mouth", "Mouth"]
    assert [p[0] for p in body.cracks[1].points] == pytest.approx([1, 0], abs=1e-14)
    assert [note[:17] for note in body.notes] == ["crack 1: its star", "crack 1: its end "]


def test_an_end_on_the_boundary_is_left_as_it_is():
    crack = Crack([(0, 0.4), (0.31, 0.47)])
    body = CrackedMesh(SQUARE, crack)
    assert body.notes == [] and body.cracks[0].points == crack.points


def square_with_hole(radius=0.2, maxh=0.08, curve=1):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
    geometry.AddCircle((0.5, 0.5), radius, leftdomain=0, rightdomain=1, bc="hole")
    return Mesh(geometry.GenerateMesh(maxh=maxh)).Curve(curve)


@pytest.mark.parametrize("points, reason", [
    ([(0.1, 0.45), (0.9, 0.45)], r"leaves the body at \(0.30.* and enters it again at \(0.69.*give two cracks"),
    ([(0.4, 0.5), (0.6, 0.5)], "lies outside the body"),
    ([(1.2, 0.5), (1.7, 0.5)], "lies outside the body"),
])  # fmt: skip
def test_what_is_not_one_crack_in_the_body(points, reason):
    with pytest.raises(Exception, match=reason):
        CrackedMesh(square_with_hole(), Crack(points))


def test_a_crack_that_touches_a_reentrant_corner():
    shape = Rectangle(1, 1).Face() - MoveTo(0.5, 0.5).Rectangle(0.5, 0.5).Face()
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.15))
    with pytest.raises(Exception, match=r"touches the boundary of the body at \(0.5, 0.5\)"):
        CrackedMesh(mesh, Crack([(0.3, 0.7), (0.7, 0.3)]))


# Ends inside, beside the boundary


@pytest.mark.parametrize("eps", [1e-12, 1e-9, 1e-6, 1e-3, 0.008])
def test_an_end_beside_the_boundary_is_a_mouth(eps):
    body = CrackedMesh(SQUARE, Crack([(eps, 0.41), (0.6, 0.41 + 0.1 * (0.6 - eps))]))
    assert kinds(body) == ["Mouth", "Tip"]
    assert body.cracks[0].points[0] == pytest.approx((0, 0.41 - 0.1 * eps), abs=1e-11)
    if eps > 1e-10:
        assert "less than a tenth of the element" in body.notes[0] and "refine to elements below" in body.notes[0]


def test_beyond_a_tenth_of_the_element_it_is_a_tip():
    body = CrackedMesh(SQUARE, Crack([(0.04, 0.41), (0.6, 0.43)]))
    assert kinds(body) == ["Tip", "Tip"] and body.notes == []


@pytest.mark.parametrize("crack", [
    Crack.Arc((0.7, 0.3), (0.5, 0.45), (0.003, 0.5)), Crack.Spline([(0.6, 0.5), (0.4, 0.45), (0.2, 0.5), (1e-5, 0.43)]), Crack([(0.5, 0.5), (1e-7, 1e-7)]),
    Crack([(0.5, 0.5), (1e-9, 3e-7)])
])  # fmt: skip
def test_curves_and_corners(crack):
    body = CrackedMesh(SQUARE, crack)
    end = body.cracks[0].points[-1]
    assert kinds(body) == ["Tip", "Mouth"] and min(end) < 1e-13
    assert hypot(*np.subtract(end, crack.points[-1])) < 0.005
    assert Integrate(1 * body.dx, SQUARE) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("points", [[(0.3, 0.005), (0.8, 0.005)], [(0.3, 0.3), (0.6, 0.004), (0.8, 0.004)], [(0.5, 0), (0.5, 0.005)]])
def test_an_end_beside_the_boundary_that_does_not_run_into_it(points):
    with pytest.raises(Exception, match="either end the crack on the boundary, at .*, or refine there to elements below 0.0"):
        CrackedMesh(SQUARE, Crack(points))


def two_regions(maxh=0.09):
    shape = Glue([Rectangle(1, 0.6).Face(), MoveTo(0, 0.6).Rectangle(1, 0.4).Face()])
    for edge in shape.edges:
        edge.name = "seam" if abs(edge.center.y - 0.6) < 1e-9 else "bottom" if edge.center.y < 1e-9 else "outer"
    return Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=maxh))


def test_an_end_beside_an_inner_boundary_stays_a_tip():
    body = CrackedMesh(two_regions(), Crack([(0.5, 0.1), (0.52, 0.5999)]))
    assert kinds(body) == ["Tip", "Tip"] and body.notes == []


def test_the_report_says_it():
    body = CrackedMesh(SQUARE, Crack([(-0.1, 0.41), (1.1, 0.43)]))
    V = CrackFESpace(body, order=1, dirichlet="bottom|top")
    problem = ContactProblem(V, TraceSpace(body, order=1), MATERIAL)
    problem.SetDirichlet((0, -0.01), "top")
    report = problem.Solve().report
    assert report.notes == body.notes and str(report).count("note  ") == 2 and "cut off at the boundary" in str(report)


# Curved boundaries


def check_divergence_theorem(mesh, body):
    """∫ H div F over the body = ∫ H F·n over ∂Ω - 2 ∫ F·n over the crack: volumes, sides, ∂Ω beside mouths, lengths and normals at once."""
    F, div = CF((x * x * y + 0.3 * y, x * y * y - 0.7 * x + 1)), 4 * x * y
    for crack in body.cracks:
        on = body.dcrack(bonus_intorder=15)
        inside = Integrate(crack.side * div * body.dx(bonus_intorder=8), mesh)
        outside = Integrate(crack.side * (F * specialcf.normal(2)) * body.ds(bonus_intorder=8), mesh)
        assert inside == pytest.approx(outside - 2 * Integrate(F * body.normal * on, mesh), abs=1e-8)
        assert Integrate(1 * on, mesh) == pytest.approx(crack.length, abs=1e-10)
    assert Integrate(1 * body.dx(bonus_intorder=4), mesh) == pytest.approx(Integrate(CF(1), mesh, order=8), abs=1e-11)


def disk(maxh, curve):
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1, bc="rim")
    return Mesh(geometry.GenerateMesh(maxh=maxh)).Curve(curve)


def curved_elements(mesh):
    return set(np.flatnonzero(mesh.ngmesh.Elements2D().NumPy()["curved"]).tolist())


CHORDS = {
    "straight": Crack([(-1.2, 0.31), (1.3, 0.17)]),
    "arc": Crack.Arc((-1.2, 0.1), (0, -0.3), (1.1, 0.4)),
    "spline": Crack.Spline([(-1.2, 0.2), (-0.5, 0.5), (0.4, 0.4), (1.2, 0.8)]),
    "kink in a curved element": Crack([(-1.2, 0.31), (-0.93, 0.3), (1.3, 0.6)]),
    "beside the centre": Crack([(0.001, -1.1), (0.002, 1.1)]),
}


@pytest.mark.parametrize("curve", [2, 3, 5])
@pytest.mark.parametrize("crack", CHORDS.values(), ids=CHORDS.keys())
def test_measures_on_curved_elements(crack, curve):
    mesh = disk(0.45, curve)
    body = CrackedMesh(mesh, crack)
    assert kinds(body) == ["Mouth", "Mouth"] and any(place.element in curved_elements(mesh) for place in body.Elements(0))
    assert len(body.CutBoundaryElements(0)) == 2
    check_divergence_theorem(mesh, body)


@pytest.mark.parametrize("angle", [3, 77, 141, 260])
def test_uniform_pressure_on_a_crack_from_a_curved_hole(angle):
    """σ = -p I: u is linear, λ = -p up to the mouth, on ∂Ω of curved elements, too."""
    mesh = square_with_hole(maxh=0.12, curve=2)
    c, s = cos(radians(angle)), sin(radians(angle))
    crack = Crack([(0.5 + 0.1 * c, 0.5 + 0.1 * s), (0.5 + 0.36 * c, 0.5 + 0.36 * s)])
    body = CrackedMesh(mesh, crack)
    V, W = CrackFESpace(body, order=2, tip=None, dirichlet="hole|left|right|top|bottom"), TraceSpace(body, order=1)
    problem = ContactProblem(V, W, MATERIAL)
    problem.SetDirichlet(CF((-x, -y)) / (2 * MATERIAL.lam + 2 * MATERIAL.mu), ".*")
    solution = problem.Solve()
    pressure = solution.multiplier.vec.FV().NumPy()
    assert pressure == pytest.approx(np.full(len(pressure), -1.0), abs=1e-8)


def test_a_picture_of_a_cut_curved_element():
    mesh, crack = disk(0.5, 3), CHORDS["arc"]
    body = CrackedMesh(mesh, crack)
    for subdivision in (0, 2):
        split = SplitMesh(body, subdivision)
        a, b, c = np.moveaxis(split.points[split.triangles], 1, 0)
        area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        assert (area > 0).all()
        on_lips = split.points[np.unique(split.lips)]
        assert max(crack.Distance(tuple(p)) for p in on_lips) < 1e-9
        ends = split.points[split.lips[split.lip_side == 1]]
        assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(body.cracks[0].length, rel=2e-3)
    assert area.sum() == pytest.approx(pi, rel=4e-3)


def test_two_cracks_in_one_curved_element():
    body = CrackedMesh(disk(0.6, 2), Crack([(0.5, 0.11), (1.1, 0.11)]), Crack([(0.5, 0.02), (1.1, 0.02)]))
    assert any(len(body.CracksOf(element)) == 2 for element in curved_elements(body.mesh))
    for c, crack in enumerate(body.cracks):
        assert Integrate(1 * body.dcrack(crack=c), body.mesh) == pytest.approx(crack.length, rel=1e-9)
    areas = [Integrate(CF(1) * measure, body.mesh, element_wise=True).NumPy() for measure in (body.dx(bonus_intorder=4), dx(bonus_intorder=4))]
    assert areas[0] == pytest.approx(areas[1], rel=1e-9)
    V = CrackFESpace(body, order=2, tip=None, dirichlet=".*")
    problem = ContactProblem(V, TraceSpace(body), Elasticity(lam=1, mu=1))
    problem.SetDirichlet(-0.25 * CF((x, y)), ".*")
    solution = problem.Solve()
    for c in range(2):
        assert solution.Profile(crack=c, n=30).sigma_n == pytest.approx(np.full(30, -1), abs=1e-7)


def edge_cracks_from_a_hole(curve, angle):
    """K_I/(s √(πa)) of two cracks of length a = 6 from a hole of radius 10 in a wide plate under tension across them."""
    R, L, a = 10, 200, 6
    shape = Rectangle(2 * L, 2 * L).Face().Move((-L, -L, 0)) - Circle((0, 0), R).Face().Rotate(Axis((0, 0, 0), Z), 37)
    shape.edges.name = "hole"
    for edge in (shape.edges.Min(X), shape.edges.Max(X), shape.edges.Min(Y), shape.edges.Max(Y)):
        edge.name = "outer"
    for edge in shape.edges:
        if edge.name == "hole":
            edge.maxh = 1
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=25, grading=0.15)).Curve(curve)
    c, s = cos(radians(angle)), sin(radians(angle))
    body = CrackedMesh(mesh, *(Crack([(d * R * c, d * R * s), (d * (R + a) * c, d * (R + a) * s)]) for d in (1, -1)))
    assert len(body.tips) == 2
    V = CrackFESpace(body, order=3, tip=TipEnrichment(material=MATERIAL))
    problem = ContactProblem(V, TraceSpace(body, order=1), MATERIAL)
    tension = CF((s * s, -s * c, -s * c, c * c), dims=(2, 2))
    problem.f += tension * specialcf.normal(2) * V.TestFunction() * body.ds("outer")
    problem.Pin((-L, -L), "xy")
    problem.Pin((L, -L), "y")
    solution = problem.Solve()
    return [solution.StressIntensity(i).K_I / sqrt(pi * a) for i in range(2)]


@pytest.mark.parametrize("curve", [1, 2])
def test_edge_cracks_from_a_hole(curve):
    """1.7476: a boundary-fitted mesh of order 7, graded to the tips."""
    assert edge_cracks_from_a_hole(curve, 11) == pytest.approx([1.7476] * 2, rel=3e-3)


# Inner boundaries in the disk of a tip


@pytest.mark.parametrize("end", [(0.45, 0.47), (0.45, 0.6), (0.45, 0.73)])
@pytest.mark.parametrize("material", [None, MATERIAL])
def test_a_load_on_an_inner_boundary_acts_on_tip_functions(end, material):
    """On every function of V_h: against its limits from inside the elements, at many points."""
    mesh = two_regions()
    body = CrackedMesh(mesh, Crack([(0, 0.4), end]))
    V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material, r1=0.25, r0=0.06, tolerance=1e-9))
    load = LinearForm(CF((1 + x, x * x)) * V.TestFunction() * body.ds("seam", bonus_intorder=4)).Assemble().vec.FV().NumPy()
    u = GridFunction(V)
    dofs = list(V.TipDofs(0))
    breaks = [0, 1] + [end[0] + sign * sqrt(max(r * r - (end[1] - 0.6) ** 2, 0)) for r in (0.06, 0.25) for sign in (1, -1)] + [end[0]]
    breaks += [0.4, 0.9] if end[1] < 0.6 else [0.45 * 0.2 / (end[1] - 0.4)]
    points, weights = graded_rule(sorted(breaks))
    for dof in dofs:
        u.vec[:] = 0
        u.vec[dof] = 1
        values = u(mesh(points, np.full(len(points), 0.6 + 1e-12)))
        f = np.stack([1 + points, points**2], axis=1)
        assert load[dof] == pytest.approx((weights[:, None] * f * values).sum(), abs=2e-7 * np.abs(load).max())


def graded_rule(breaks):
    """Gauss points between breaks, in intervals that shrink towards both ends."""
    s, w = np.polynomial.legendre.leggauss(12)
    points, weights = [], []
    for a, b in zip(breaks, breaks[1:]):
        if b - a > 1e-12:
            cuts = np.concatenate([[0], 0.5 ** np.arange(24, 0, -1), 1 - 0.5 ** np.arange(2, 25), [1]])
            for p, q in zip(a + (b - a) * cuts, a + (b - a) * cuts[1:]):
                points.append(0.5 * (p + q) + 0.5 * (q - p) * s)
                weights.append(0.5 * (q - p) * w)
    return np.concatenate(points), np.concatenate(weights)


def test_traces_on_an_inner_boundary():
    """Values on the seam are those of the triangles beside it, for all functions at once."""
    mesh = two_regions()
    body = CrackedMesh(mesh, Crack([(0, 0.4), (0.45, 0.73)]))
    V = CrackFESpace(body, order=2, tip=TipEnrichment(r1=0.2))
    u = GridFunction(V)
    u.vec.FV().NumPy()[:] = np.random.default_rng(1).standard_normal(V.ndof)
    at = np.linspace(0.013, 0.987, 41)
    beside = u(mesh(at, np.full(41, 0.6 + 1e-10)))
    assert u(mesh(at, np.full(41, 0.6), VOL_or_BND=BND)) == pytest.approx(beside, abs=1e-5)


def test_a_fixed_inner_boundary_in_a_disk_is_refused():
    body = CrackedMesh(two_regions(), Crack([(0, 0.4), (0.45, 0.47)]))
    with pytest.raises(Exception, match="fixed inner boundary 'seam' runs through the disk .*choose r1 below its distance 0.13"):
        CrackFESpace(body, order=2, tip=TipEnrichment(r1=0.25), dirichlet="seam")
    CrackFESpace(body, order=2, tip=TipEnrichment(r1=0.12), dirichlet="seam")


def test_a_mouth_on_a_structured_grid_stays_where_it_is():
    body = CrackedMesh(structured(4), Crack([(0, 0.25 + 1e-13), (0.6, 0.4)]))
    assert body.Ends(0)[0].kind == EndKind.Mouth and body.notes == []


@pytest.mark.parametrize("start", [0.0, -1e-9, -0.01])
def test_a_start_on_the_boundary_from_which_the_crack_leaves_the_body(start):
    """What lies outside is cut off, wherever it begins."""
    body = CrackedMesh(rectangle(0.1), Crack([(start, 0.45), (-0.05, 0.5), (0.4, 0.55)]))
    assert body.cracks[0].points[0] == pytest.approx((0, 0.5 + 0.05 / 9), abs=1e-12) and len(body.notes) == 1
