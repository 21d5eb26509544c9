"""Fronts: where they are, the coordinates around them, the rules for what is singular there, and mouths."""

import numpy as np
import pytest
from exact_sheets import KINDS, axes_of, circle_elements, cube_mesh, polygon_area, random_sheet
from ngsolve import Integrate, x, y
from ngsolve.meshes import MakeStructured3DMesh
from sheet_checks import DEMANDS, energies, tube_case

from ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.geometry import FrontDemand, Sheet

MESHES = [cube_mesh(0.4), cube_mesh(0.3, 1)]
GRID = MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)
DISK = Sheet.Disk((0.513, 0.479, 0.517), (0.2, -0.1, 1), 0.3)


@pytest.mark.parametrize("seed", range(8))
def test_no_element_with_a_front_is_missed(seed):
    rng, mesh = np.random.default_rng(seed), MESHES[seed % 2]
    normal, radius = rng.normal(size=3), rng.uniform(0.12, 0.4)
    origin = rng.uniform(radius, 1 - radius, 3)
    body = CrackedMesh(mesh, Sheet.Disk(origin, normal, radius))
    found = {cell.element for cell in body.Elements(0) if cell.kind.name == "Tip"}
    expected, doubtful = circle_elements(mesh, origin, axes_of(normal), radius)
    assert expected <= found <= expected | doubtful and len(found) > 2
    assert set(body.FrontElements(0)) == found


def test_an_arc_that_enters_and_leaves_through_one_edge():
    """A disk of which a cap of 1e-3 lies beyond the face x = 1/2 of cubes: the elements behind it have a front, too."""
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2)
    body = CrackedMesh(mesh, Sheet.Disk((0.301, 0.27, 0.23), (0, 0, 1), 0.2))
    beyond = [cell for cell in body.Elements(0) if min(p[0] for p in cell.polygon) > 0.5 - 0.301 - 1e-9]
    origin = np.array([0.301, 0.27, 0.23])
    expected, _ = circle_elements(mesh, origin, np.array([(1, 0, 0), (0, 1, 0)]), 0.2)
    assert {cell.element for cell in body.Elements(0) if cell.kind.name == "Tip"} == expected
    assert beyond == [] or all(cell.element in expected for cell in beyond)
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(0.04 * np.pi, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_areas_of_random_sheets(kind, seed):
    random = random_sheet(np.random.default_rng(100 + seed), kind)
    try:
        body = CrackedMesh(MESHES[seed % 2], random.sheet)
    except Exception as error:
        assert "20 degrees" in str(error)
        return
    assert Integrate(1 * body.dcrack, body.mesh) == pytest.approx(random.area, abs=1e-12)
    assert Integrate(1 * body.dx, body.mesh) == pytest.approx(1, abs=1e-12)
    assert sum(body.FacetArea(cell.element) for cell in body.Elements(0)) == pytest.approx(random.area, abs=1e-12)


def test_a_front_has_a_frame_and_coordinates():
    body = CrackedMesh(MESHES[0], DISK)
    (front,) = body.fronts
    assert front.closed and front.corners == [] and front.length == pytest.approx(0.6 * np.pi, rel=1e-14)
    for s in (0, 0.3, 1.4):
        e1, e2, e3 = np.array(front.FrameAt(s))
        c = np.array(front.PointAt(s))
        assert np.allclose(np.cross(e1, e2), e3, atol=1e-14) and np.allclose(e2, DISK.normal, atol=1e-15)
        assert np.allclose(c + 0.3 * np.array(-e1), DISK.origin, atol=1e-14)  # ahead is out of the disk
        assert np.allclose((np.array(front.PointAt(s + 1e-6)) - c) / 1e-6, e3, atol=1e-5)
        assert front.CurvatureAt(s) == pytest.approx(1 / 0.3, rel=1e-12)
        assert front.Tube(c + 0.05 * e1 - 0.02 * e2) == pytest.approx((0.05, -0.02, s), abs=1e-13)
        x1, x2, _ = front.Tube(c - 0.07 * e1)
        assert x1 == pytest.approx(-0.07, abs=1e-14) and x2 == 0


def test_x2_is_zero_on_the_sheet():
    body = CrackedMesh(MESHES[1], DISK)
    *_, px, py, pz = body.dcrack.Points(4)
    assert {body.fronts[0].Tube(p)[1] for p in zip(px, py, pz)} == {0.0}


def test_the_frame_of_a_hole_points_into_it():
    body = CrackedMesh(cube_mesh(0.2), Sheet.Ring((0.5, 0.5, 0.48), (0, 0, 1), 0.2, 0.4))
    outer, inner = body.fronts
    assert [front.loop for front in body.fronts] == [0, 1] and inner.CurvatureAt(0) == pytest.approx(-5, rel=1e-12)
    middle = np.array((0.5, 0.5, 0.48))
    ahead = [np.dot(front.FrameAt(0.1)[0], np.array(front.PointAt(0.1)) - middle) for front in (outer, inner)]
    assert ahead == pytest.approx([0.4, -0.2], abs=1e-13)


def test_an_edge_crack_has_a_front_between_its_mouths():
    sheet = Sheet.Polygon([(-1, -1, 0.52), (0.45, -1, 0.52), (0.45, 2, 0.52), (-1, 2, 0.52)])
    body = CrackedMesh(MESHES[1], sheet)
    (front,) = body.fronts
    assert not front.closed and front.length == pytest.approx(1, abs=1e-13)
    assert sorted(front.PointAt(s)[1] for s in (0, front.length)) == pytest.approx([0, 1], abs=1e-13)
    assert Integrate(1 * body.dcrack, body.mesh) == pytest.approx(0.45, abs=1e-13)
    mouths = body.CutBoundaryElements(0)
    assert mouths and all(min(body.BoundaryPartSizes(i)) > 0 for i in mouths)
    assert Integrate(1 * body.ds, body.mesh) == pytest.approx(6, abs=1e-12)


def test_a_sheet_may_end_exactly_on_the_boundary():
    """Its edges on ∂Ω are mouths, not fronts."""
    sheet = Sheet.Polygon([(0, 0, 0.52), (0.45, 0, 0.52), (0.45, 1, 0.52), (0, 1, 0.52)])
    body = CrackedMesh(MESHES[1], sheet)
    assert [front.length for front in body.fronts] == pytest.approx([1], abs=1e-12)
    assert Integrate(1 * body.dcrack, body.mesh) == pytest.approx(0.45, abs=1e-12)


def test_a_front_along_faces_of_the_mesh():
    """No open element has it, all around it do in their closure."""
    mesh = MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)
    body = CrackedMesh(mesh, Sheet.Polygon([(0.25, 0.25, 0.4), (0.75, 0.25, 0.4), (0.75, 0.75, 0.4), (0.25, 0.75, 0.4)]))
    (front,) = body.fronts
    assert front.closed and front.length == pytest.approx(2, rel=1e-13) and len(front.corners) == 4
    assert {cell.kind.name for cell in body.Elements(0)} == {"Cut"}
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(0.25, abs=1e-14)
    centres = {el.nr: np.mean([mesh[v].point for v in el.vertices], axis=0) for el in mesh.Elements()}
    assert body.FrontElements(0) and all(front.Distance(centres[nr]) < 0.2 for nr in body.FrontElements(0))
    demand = FrontDemand(0.1)
    assert Integrate(1 * body.dx(fronts=demand), mesh) == pytest.approx(1, abs=2e-4)
    assert Integrate(1 * body.dcrack(fronts=demand), mesh) == pytest.approx(0.25, abs=1e-6)


@pytest.mark.parametrize("kind", ("straight", "circle"))
def test_tube_integrals(kind):
    """∫ Σ_j |∇(χ F_j)|² over the whole tube."""
    body, r1, exact = tube_case(kind, 0.25)
    default, fine = (energies(body, r1, FrontDemand(r1, **DEMANDS[name])) for name in ("default", "fine"))
    assert default.sum() == pytest.approx(exact, rel=5e-3) and fine.sum() == pytest.approx(exact, rel=1e-3)
    assert np.abs(default - fine).sum() < 5e-3 * exact
    assert np.abs(energies(body, r1, None) - fine).sum() > 0.02 * exact  # plain rules are no match for the singularity


@pytest.mark.parametrize(
    "sheet", [DISK, Sheet.Polygon([(0.2, 0.3, 0.4), (0.7, 0.2, 0.5), (0.6, 0.8, 0.45)]), Sheet.Ring((0.5, 0.5, 0.5), (1, 2, 0.3), 0.15, 0.35)]
)
def test_rules_around_fronts_are_positive_and_inside(sheet):
    body = CrackedMesh(MESHES[0] if sheet is DISK else MESHES[1], sheet)
    area = Integrate(1 * body.dcrack, body.mesh)
    for options, bound in zip(DEMANDS.values(), (3e-3, 1e-3)):
        demand = FrontDemand(0.02, **options)
        _, xi, eta, zeta, w, *_ = body.dx(fronts=demand).Points(2)
        assert w.min() > 0 and min(xi.min(), eta.min(), zeta.min(), (1 - xi - eta - zeta).min()) > -1e-12
        assert w.sum() == pytest.approx(1, abs=bound)
        on = body.dcrack(fronts=demand).Points(2)
        assert on[4].min() > 0 and on[4].sum() == pytest.approx(area, rel=bound)
        assert Integrate(1 * body.dlarger(fronts=demand), body.mesh) == pytest.approx(Integrate(1 * body.dlarger, body.mesh), rel=bound)
        assert Integrate(x * y * body.ds(fronts=demand), body.mesh) == pytest.approx(Integrate(x * y * body.ds, body.mesh), abs=1e-12)


def test_opening_and_its_integral_on_the_disk():
    """∫ √(a² - ρ²) = 2π a³/3: √r at the front."""
    body = CrackedMesh(MESHES[1], Sheet.Disk((0.5, 0.47, 0.52), (0, 0, 1), 0.3))
    *_, w, px, py, _ = body.dcrack(fronts=FrontDemand(0.4, **DEMANDS["fine"])).Points(2)
    value = w @ np.sqrt(np.maximum(0, 0.09 - (px - 0.5) ** 2 - (py - 0.47) ** 2))
    assert value == pytest.approx(2 * np.pi * 0.027 / 3, rel=1e-4)


def test_loops_of_the_curves_of_the_plane():
    """A stadium of segments and arcs, and a closed spline."""
    stadium = Crack.Join(
        Crack([(-0.1, -0.15), (0.1, -0.15)]),
        Crack.Arc((0.1, -0.15), (0.25, 0), (0.1, 0.15)),
        Crack([(0.1, 0.15), (-0.1, 0.15)]),
        Crack.Arc((-0.1, 0.15), (-0.25, 0), (-0.1, -0.15)),
    )
    t = np.linspace(0, 2 * np.pi, 25)
    flower = Crack.Spline([((0.3 + 0.04 * np.cos(3 * a)) * np.cos(a), (0.3 + 0.04 * np.cos(3 * a)) * np.sin(a)) for a in t[:-1]] + [(0.34, 0.0)])
    for loop in (stadium, flower):
        sheet = Sheet([loop], (0.5, 0.48, 0.51), ((1, 0.2, 0.1), (0, 1, 0.3)))
        body = CrackedMesh(MESHES[1], sheet)
        assert Integrate(1 * body.dcrack, body.mesh) == pytest.approx(sheet.area, abs=1e-12)
        assert body.fronts[0].length == pytest.approx(loop.length, rel=1e-12)
        assert Integrate(1 * body.dx(fronts=FrontDemand(0.05)), body.mesh) == pytest.approx(1, abs=2e-3)
    assert CrackedMesh(MESHES[1], Sheet([stadium], (0.5, 0.5, 0.5))).fronts[0].corners == []
    assert stadium.length == pytest.approx(0.4 + 0.3 * np.pi) and Sheet([stadium]).area == pytest.approx(0.06 + np.pi * 0.0225, rel=1e-14)


def test_the_ellipse():
    sheet = Sheet.Ellipse((0.5, 0.5, 0.51), (0.35, 0, 0), (0, 0.12, 0))
    body = CrackedMesh(MESHES[1], sheet)
    (front,) = body.fronts
    from scipy.special import ellipe

    assert front.length == pytest.approx(4 * 0.35 * ellipe(1 - (0.12 / 0.35) ** 2), rel=1e-13) and front.corners == []
    assert Integrate(1 * body.dcrack, body.mesh) == pytest.approx(np.pi * 0.35 * 0.12, abs=1e-12)
    s = front.Tube((0.85, 0.5, 0.51))[2]
    assert front.CurvatureAt(s) == pytest.approx(0.35 / 0.12**2, rel=1e-9)


def test_several_sheets_have_numbers():
    body = CrackedMesh(cube_mesh(0.2), Sheet.Disk((0.5, 0.5, 0.25), (0, 0.1, 1), 0.3), Sheet.Disk((0.5, 0.5, 0.75), (0.1, 0, -1), 0.2))
    assert [front.sheet for front in body.fronts] == [0, 1]
    areas = [Integrate(1 * body.dcrack(crack=i), body.mesh) for i in (0, 1)]
    assert areas == pytest.approx([0.09 * np.pi, 0.04 * np.pi], abs=1e-12)
    assert Integrate(body.crack_number * body.dcrack, body.mesh) == pytest.approx(areas[1], abs=1e-12)
    assert Integrate(body.normal[2] * body.dcrack(crack=1), body.mesh) == pytest.approx(-areas[1] / np.sqrt(1.01), abs=1e-12)


@pytest.mark.parametrize("offset", [0, 1e-13, 1e-12, -1e-11, 9e-11, 1.1e-10, -1e-9, 1e-7])
@pytest.mark.parametrize("normal, origin", [((1, 1, 1), (0.25, 0.5, 0.5)), ((1, 0, 1), (0.75, 0.25, 0.5)), ((0, 0, -1), (0.5, 0.25, 0.5))])
def test_sheets_with_corners_on_vertices_and_edges_along_the_mesh(normal, origin, offset):
    """Triangles between vertices of the mesh on a plane through them, moved in the plane by offsets."""
    rng, axes = np.random.default_rng(6), axes_of(normal)
    grid = np.stack(np.meshgrid(*3 * [np.arange(1, 4) / 4], indexing="ij"), axis=-1).reshape(-1, 3) - origin
    on_plane = grid[np.abs(grid @ np.array(normal)) < 1e-9] @ axes.T
    cut = 0
    for _ in range(6):
        corners = on_plane[rng.choice(len(on_plane), 3, replace=False)] + offset
        if abs(area := polygon_area(corners)) < 1e-3:
            continue
        body = CrackedMesh(GRID, Sheet([Crack([tuple(p) for p in [*corners.tolist(), corners[0].tolist()]])], origin, axes.tolist()))
        assert Integrate(1 * body.dcrack, GRID) == pytest.approx(abs(area), abs=2e-10)
        assert [front.closed for front in body.fronts] == [True] and body.FrontElements(0)
        cut += 1
    assert cut > 1
