"""The split mesh: conforming, sharp at the crack, equal to the fields that it shows."""

import numpy as np
import pytest
from netgen.geom2d import SplineGeometry
from ngsolve import CF, GridFunction, InnerProduct, Integrate, Mesh, ds, dx, x, y
from ngsolve.meshes import MakeStructured2DMesh

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, Strain, TipEnrichment
from ngsxfem_contact.plotting import split_mesh
from ngsxfem_contact.plotting.split_mesh import SplitMesh
from ngsxfem_contact.points import crack_points

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MATERIAL = Elasticity(1, 1)
SIDES = ["bottom", "right", "top", "left"]
ARC = [(0.4 - 0.2 * np.cos(t), 0.2 * np.sin(t) - 0.05) for t in np.linspace(0, 2.5, 40)]


def unstructured(maxh=0.15):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=SIDES)
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def structured(n=8, clockwise=False):
    return MakeStructured2DMesh(quads=False, nx=n, ny=n, mapping=lambda x, y: (x, 0.5 - y if clockwise else y - 0.5))


CASES = {
    "mouth and tip": (unstructured, [[(0, 0.013), (0.5, 0.013)]]),
    "mouth and tip backwards": (unstructured, [[(0.5, 0.013), (0, 0.013)]]),
    "two tips": (unstructured, [[(0.2, -0.1), (0.8, 0.17)]]),
    "through the body": (unstructured, [[(0, -0.1), (1, 0.17)]]),
    "kinked": (unstructured, [[(0, 0.02), (0.3, 0.1), (0.55, -0.07)]]),
    "sharp kink": (unstructured, [[(0, 0.02), (0.5, 0.06), (0.2, 0.3)]]),
    "many kinks in an element": (unstructured, [ARC]),
    "along edges": (structured, [[(0, 0), (0.5, 0)]]),
    "along edges backwards": (structured, [[(0.5, 0), (0, 0)]]),
    "along edges, tip inside an edge": (structured, [[(0.25, 0), (0.6, 0)]]),
    "along edges, then into an element": (structured, [[(0, 0), (0.3, 0), (0.55, 0.21)]]),
    "staircase of edges": (structured, [[(0, 0), (0.25, 0), (0.25, 0.25), (0.5, 0.25)]]),
    "along a diagonal": (structured, [[(0.25, -0.25), (0.625, 0.125)]]),
    "across diagonals, through vertices": (structured, [[(0.25, 0.25), (0.625, -0.125)]]),
    "tip on an edge": (structured, [[(0, 0.03), (0.375, 0.03)]]),
    "clockwise triangles": (lambda: structured(clockwise=True), [[(0, 0.03), (0.4, 0.03)]]),
    "beside another crack": (structured, [[(0.25, 0), (0.75, 0)], [(0.2, 0.06), (0.8, 0.06)]]),
    "two cracks": (unstructured, [[(0, 0.2), (0.45, 0.21)], [(0.55, -0.2), (0.9, -0.22)]]),
}


@pytest.fixture(params=CASES)
def body(request):
    make_mesh, cracks = CASES[request.param]
    return CrackedMesh(make_mesh(), *(Crack(points) for points in cracks))


def random_function(body, order, tip=TipEnrichment(material=MATERIAL)):
    """Any member of V_h: a wrong side or a smeared jump shows."""
    u = GridFunction(CrackFESpace(body, order=order, tip=tip))
    u.vec.FV().NumPy()[:] = np.random.default_rng(1).uniform(-1, 1, u.space.ndof)
    return u


def displacement(split, u):
    return split.Evaluate(Plus(u), Minus(u), u)


def pairs(split):
    """Numbers of the points on the plus and on the minus lip that lie at the same place, and the crack of each."""
    found = []
    for c in range(len(split.body.cracks)):
        lip = {side: np.unique(split.lips[(split.lip_side == side) & (split.lip_crack == c)]) for side in (1, -1)}
        lip = {side: points[split.point_side[points] == side] for side, points in lip.items()}
        arc = {side: [split.body.cracks[c].ArcLength(tuple(p)) for p in split.points[points]] for side, points in lip.items()}
        found.append((lip[1][np.argsort(arc[1])], lip[-1][np.argsort(arc[-1])], np.sort(arc[1])))
    return found


def areas(split):
    a, b, c = np.moveaxis(split.points[split.triangles], 1, 0)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


@pytest.mark.parametrize("subdivision", [0, 1])
def test_triangles_cover_the_body(body, subdivision):
    split = SplitMesh(body, subdivision)
    assert areas(split).min() > 0
    assert abs(areas(split).sum() - 1) < 1e-12
    assert abs(Integrate(CF(1), split.mesh) - 1) < 1e-12


def test_triangles_lie_in_their_elements(body):
    split = SplitMesh(body, 1)
    barycentric = np.concatenate([split.reference, 1 - split.reference.sum(axis=2, keepdims=True)], axis=2)
    assert barycentric.min() > -1e-8
    of_element = np.bincount(split.element, areas(split))
    assert np.allclose(of_element, Integrate(CF(1) * dx, body.mesh, element_wise=True), atol=1e-12)


def test_points_on_the_crack_are_doubled(body):
    split = SplitMesh(body)
    for c, (plus, minus, arclengths) in enumerate(pairs(split)):
        ends = [end.s for end in body.Ends(c) if end.kind.name == "Tip"]
        expected = [s for s in body.MeshNodes(c, True) if min((abs(s - e) for e in ends), default=1) > 1e-9]
        on_lines = [s for s in arclengths if min(abs(s - e) for e in expected) < 1e-9]
        assert len(on_lines) == len(arclengths) == len(expected)
        assert np.abs(split.points[plus] - split.points[minus]).max() == 0
    assert np.count_nonzero(split.point_side) == sum(2 * len(plus) for plus, _, _ in pairs(split))


def test_tips_are_not_doubled(body):
    split = SplitMesh(body, 1)
    for tip in body.tips:
        here = np.linalg.norm(split.points - tip.point, axis=1) < 1e-12
        assert here.sum() == 1 and split.point_side[here] == 0


@pytest.mark.parametrize("subdivision", [0, 1])
def test_only_lips_and_the_boundary_are_open(body, subdivision):
    split = SplitMesh(body, subdivision)
    length = sum(crack.length for crack in body.cracks)
    lip = np.linalg.norm(np.diff(split.points[split.lips], axis=1), axis=2).ravel()
    for side in (1, -1):
        assert abs(lip[split.lip_side == side].sum() - length) < 1e-10
    edges = np.sort(np.concatenate([split.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    assert count.max() == 2
    single = edges[count == 1]
    assert abs(np.linalg.norm(np.diff(split.points[single], axis=1), axis=2).sum() - 4 - 2 * length) < 1e-10


def test_boundary_names(body):
    split = SplitMesh(body)
    assert set(split.mesh.GetBoundaries()) == {*SIDES, "crack"}
    for name in set(SIDES):
        assert abs(Integrate(CF(1) * ds(name), split.mesh) - 1) < 1e-12
        for f in (x, y):
            assert abs(Integrate(f * ds(name), split.mesh) - Integrate(f * ds(name), body.mesh)) < 1e-12
    assert abs(Integrate(CF(1) * ds("crack"), split.mesh) - 2 * sum(crack.length for crack in body.cracks)) < 1e-10


@pytest.mark.parametrize("order", [1, 2])
def test_jump_at_doubled_points(body, order):
    split, u = SplitMesh(body, order - 1), random_function(body, order)
    values = displacement(split, u)
    for c, (plus, minus, arclengths) in enumerate(pairs(split)):
        jump = Jump(u)(crack_points(body, c, arclengths))
        assert np.abs(jump).max() > 0.1
        assert np.abs(values[plus] - values[minus] - jump).max() < 1e-10


def test_values_are_limits_from_inside_each_triangle(body, monkeypatch):
    """u by the position of points near the corners, in every triangle around a point: both lips, and no jump elsewhere."""
    split, u = SplitMesh(body, 1), random_function(body, 2)
    monkeypatch.setattr(split_mesh, "PULL", 1e-9)
    assert np.abs(split.EvaluateInside(u) - displacement(split, u)[split.triangles]).max() < 1e-3


def test_linear_functions_are_shown_exactly(body):
    """P1 without tip functions is linear on each triangle of the split mesh, so integrals agree."""
    split, u = SplitMesh(body), random_function(body, 1, tip=None)
    shown = split.GridFunction(displacement(split, u))
    exact = [Integrate(u[i] * body.dx, body.mesh) for i in (0, 1)]
    assert np.allclose(Integrate(shown, split.mesh), exact, atol=1e-12)
    assert Integrate(InnerProduct(shown, shown), split.mesh) == pytest.approx(Integrate(InnerProduct(u, u) * body.dx, body.mesh), rel=1e-10)
    strain = split.GridFunction(split.EvaluateInside(Strain(u)))
    weight = 1 + x
    exact = [Integrate(weight * Strain(u)[i, j] * body.dx(bonus_intorder=2), body.mesh) for i in (0, 1) for j in (0, 1)]
    assert np.allclose(Integrate(weight * strain, split.mesh), exact, atol=1e-10)


def test_side_of_triangles(body):
    split = SplitMesh(body)
    for t in np.flatnonzero(split.side):
        centre = tuple(split.points[split.triangles[t]].mean(axis=0))
        here = body.CracksOf(int(split.element[t])) or range(len(body.cracks))
        nearest = min((body.cracks[c] for c in here), key=lambda crack: crack.Distance(centre))
        assert int(nearest.SideOf(centre)) == split.side[t]
    assert np.all(split.point_side[split.triangles[split.side == 0]] == 0)


def test_curved_elements_keep_their_place():
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1, bc="rim")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.5))
    mesh.Curve(3)
    split = SplitMesh(CrackedMesh(mesh, Crack([(-0.3, 0.01), (0.3, 0.02)])), 2)
    rim = np.unique(boundary_points(split))
    assert np.abs(np.linalg.norm(split.points[rim], axis=1) - 1).max() < 1e-3


def boundary_points(split):
    edges, names, _ = split_mesh.boundary_edges(split)
    return edges[names == "rim"]
