"""The split mesh of bodies in space: conforming, sharp at the sheets, equal to the fields that it shows."""

import numpy as np
import pytest
from ngsolve import CF, GridFunction, InnerProduct, Integrate, ds
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, Strain
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.plotting import split_solid
from ngsxfem_contact.plotting.polygons import ear_triangles, twice_area
from ngsxfem_contact.plotting.sheet_trace import SheetTrace
from ngsxfem_contact.plotting.split_solid import SplitSolid
from ngsxfem_contact.points import reference_coordinates
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
COARSE, MEDIUM = cube_mesh(0.25), cube_mesh(0.2)


def structured():
    return MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)


def plane(height, width=2.0):
    return Sheet.Polygon([(-1, -1, height), (width, -1, height), (width, 2, height), (-1, 2, height)])


CASES = {
    "disk": (COARSE, [Sheet.Disk((0.49, 0.51, 0.513), (0, 0, 1), 0.3)]),
    "tilted disk": (MEDIUM, [Sheet.Disk((0.5, 0.5, 0.5), (0.2, -0.3, 1), 0.33)]),
    "through the body": (COARSE, [plane(0.513)]),
    "along faces, through the body": (structured(), [plane(0.5)]),
    "along faces, disk": (structured(), [Sheet.Disk((0.5, 0.5, 0.5), (0, 0, 1), 0.3)]),
    "along faces and edges": (structured(), [Sheet.Polygon([(0.25, 0.25, 0.5), (0.75, 0.25, 0.5), (0.75, 0.75, 0.5), (0.25, 0.75, 0.5)])]),
    "mouth along faces": (structured(), [plane(0.5, 0.5)]),
    "corners": (MEDIUM, [Sheet.Polygon([(0.1, 0.1, 0.5), (0.9, 0.1, 0.5), (0.9, 0.4, 0.5), (0.5, 0.4, 0.5), (0.5, 0.8, 0.5), (0.1, 0.8, 0.5)])]),
    "ring": (MEDIUM, [Sheet.Ring((0.49, 0.51, 0.513), (0.1, 0, 1), 0.2, 0.42)]),
    "mouth": (MEDIUM, [Sheet.Ellipse((0.5, 0, 0.5), (0.3, 0, 0), (0, 0.25, 0.05))]),
    "two": (MEDIUM, [Sheet.Disk((0.5, 0.5, 0.22), (0, 0.3, 1), 0.25), Sheet.Disk((0.5, 0.5, 0.75), (0, 0, 1), 0.25)]),
}


@pytest.fixture(scope="module", params=CASES)
def split(request):
    mesh, sheets = CASES[request.param]
    return SplitSolid(CrackedMesh(mesh, *sheets))


def random_function(body, order, **arguments):
    """Any member of V_h: a wrong side or a smeared jump shows."""
    u = GridFunction(CrackFESpace(body, order=order, material=MATERIAL, **arguments))
    u.vec.FV().NumPy()[:] = np.random.default_rng(1).uniform(-1, 1, u.space.ndof)
    return u


def areas(split, triangles):
    a, b, c = np.moveaxis(split.points[triangles], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def test_tetrahedra_cover_the_body(split):
    corners = split.points[split.tets]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volumes.min() > 0 and abs(volumes.sum() - 1) < 1e-12 and abs(Integrate(CF(1), split.mesh) - 1) < 1e-12
    assert np.allclose(np.bincount(split.element, volumes), Integrate(CF(1), split.body.mesh, element_wise=True).NumPy(), rtol=1e-9)
    reference = reference_coordinates(split.body.mesh, np.repeat(split.element, 4), corners.reshape(-1, 3))
    assert min(reference.min(), (1 - reference.sum(axis=1)).min()) > -1e-9


def test_only_lips_and_the_boundary_are_open(split):
    """Both lips are the polygons of the sheets, polylines in the place of curves; the other faces of one tetrahedron lie on the surface of the cube."""
    polygons = 0.0
    for crack in range(len(split.body.cracks)):
        trace = SheetTrace(split.body, crack)
        for loop, inside in zip(trace.loops, trace.inside):
            x, y = trace.points[loop].T
            polygons += inside * 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    exact = Integrate(CF(1) * split.body.dcrack, split.body.mesh)
    triangles, names = split.boundary
    for side in (1, -1):
        assert areas(split, split.lips[split.lip_side == side]).sum() == pytest.approx(polygons, rel=1e-10) == pytest.approx(exact, rel=3e-3)
    outer = triangles[names != "crack"]
    assert abs(areas(split, outer).sum() - 6) < 1e-10 and "" not in names
    on_surface = np.isclose(split.points[outer], 0, atol=1e-12) | np.isclose(split.points[outer], 1, atol=1e-12)
    assert on_surface.all(axis=1).any(axis=1).all()
    assert Integrate(CF(1) * ds("crack"), split.mesh) == pytest.approx(2 * polygons, rel=1e-10)
    of_body = {name: Integrate(CF(1) * ds(name), split.body.mesh) for name in set(split.body.mesh.GetBoundaries())}
    assert all(Integrate(CF(1) * ds(name), split.mesh) == pytest.approx(area, rel=1e-10) for name, area in of_body.items())


def test_points_on_sheets_are_doubled_but_those_on_fronts(split):
    fronts = split.body.fronts
    doubled, lips = split.point_side != 0, np.unique(split.lips)
    assert not doubled[np.setdiff1d(np.arange(len(split.points)), lips)].any()
    single = lips[~doubled[lips]]
    off = [min((front.Distance(tuple(p)) for front in fronts), default=np.inf) for p in split.points[single]]
    assert max(off, default=0) < 1e-9
    places = {side: {tuple(p) for p in split.points[split.point_side == side]} for side in (1, -1)}
    assert places[1] == places[-1] and len(places[1]) == (split.point_side == 1).sum()


@pytest.mark.parametrize("order", [1, 2])
def test_values_are_limits_from_inside_each_tetrahedron(split, order, monkeypatch):
    """u by the position of points near the corners, in every tetrahedron around a point: both lips, and no jump elsewhere; √r at fronts."""
    u = random_function(split.body, order)
    values = split.Evaluate(Plus(u), Minus(u), u)
    monkeypatch.setattr(split_solid, "PULL", 1e-10)
    off = np.abs(split.EvaluateInside(u) - values[split.tets]).max(axis=2)
    at_front = (split.on_sheet & (split.point_side == 0))[split.tets]
    assert off[~at_front].max() < 1e-7 and off.max() < 1e-4
    jump, side = split.Evaluate(Jump(u), Jump(u), 0 * u), split.point_side
    by_place = [np.flatnonzero(side == s)[np.lexsort(split.points[side == s].T)] for s in (1, -1)]
    assert np.allclose(values[by_place[0]] - values[by_place[1]], jump[by_place[0]], atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_polynomials_are_shown_exactly(split, order):
    """Without modes u is a polynomial on each tetrahedron, so that integrals agree; but on edges of the mesh between two points of a front the lips have one value."""
    body, u = split.body, random_function(split.body, order, front=None)
    limits = Plus(u), Minus(u), u
    shown = split.GridFunction(split.Evaluate(*limits), split.EvaluateEdges(*limits) if order == 2 else None)
    exact = Integrate(InnerProduct(u, u) * body.dx(bonus_intorder=2), body.mesh)
    on_front = order == 2 and len(split.body.fronts) and {cell.kind.name for cell in split.body.Elements(0)} == {"Aligned"}
    assert Integrate(InnerProduct(shown, shown), split.mesh) == pytest.approx(exact, rel=1e-3 if on_front else 1e-10)
    strain = split.GridFunction(split.EvaluateInside(Strain(u)))
    exact = Integrate(Strain(u)[0, 2] * body.dx(bonus_intorder=2), body.mesh)
    assert Integrate(strain[2], split.mesh) == pytest.approx(exact, abs=1e-10)


def test_two_sheets_in_neighbouring_elements_are_refused():
    """Their planes would divide the same faces: said with the place, nothing is drawn wrong."""
    mesh = cube_mesh(0.3)
    body = lambda height: CrackedMesh(mesh, Sheet.Disk((0.5, 0.5, height), (0, 0, 1), 0.3), Sheet.Disk((0.5, 0.5, 0.77), (0, 0, 1), 0.3))
    assert abs(Integrate(CF(1), SplitSolid(body(0.6)).mesh) - 1) < 1e-12
    with pytest.raises(ValueError, match=r"divide neighbouring elements near \(0, 0.5385, 0.77\); refine the mesh between them"):
        SplitSolid(body(0.67))


def test_ears():
    """A polygon that is not convex, with corners inside of sides."""
    points = np.array([(0, 0), (1, 0), (2, 0), (2, 2), (1.5, 2), (1.5, 1), (0.5, 1), (0.5, 2), (0, 2), (0, 1)], dtype=float)
    triangles = ear_triangles(points, range(len(points)))
    sizes = [twice_area(*points[list(t)]) for t in triangles]
    assert len(triangles) == len(points) - 2 and min(sizes) > 0 and sum(sizes) == pytest.approx(2 * 3.0)
