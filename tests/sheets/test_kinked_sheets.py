"""Extruded cracks with kinks: coordinates, volumes, areas, special positions, and what is refused."""

import numpy as np
import pytest
from curved_surfaces import circle
from exact_sheets import cube_mesh
from kinked_surfaces import along_z, area_and_volume, kinked, special_sheets, through
from netgen.csg import CSGeometry, OrthoBrick, Pnt
from ngsolve import VOL, ElementId, Integrate, Mesh
from ngsolve.meshes import MakeStructured3DMesh
from test_curved_sheets import volume_above

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import Sheet

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
HYDROSTATIC = uniform_stress(MATERIAL, stress_matrix(xx=-1, yy=-1, zz=-1))
SIZES = (0.4, 0.2, 0.1)
MESHES = [cube_mesh(h) for h in SIZES]
WING = Crack([(0.2, 0.55), (0.6, 0.45), (0.8, 0.75)])


def check_parts(body, tolerance=1e-12):
    """Rules add up to the body, its boundary and the facets."""
    mesh = body.mesh
    facets = sum(body.FacetArea(cell.element) for cell in body.Elements(0))
    assert Integrate(1 * body.dx, mesh) == pytest.approx(1, rel=tolerance) and Integrate(1 * body.ds, mesh) == pytest.approx(6, rel=tolerance)
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(facets, rel=tolerance)


def pressed(body):
    """(largest |λ + 1| under the stress -1, smallest eigenvalue of S with unit diagonal)."""
    problem = ContactProblem(CrackFESpace(body, dirichlet="outer", front=None, material=MATERIAL), TraceSpace(body))
    problem.SetDirichlet(HYDROSTATIC.u, "outer")
    reduced = ReducedProblem(problem)
    scale = 1 / np.sqrt(np.diag(reduced.S))
    return np.abs(reduced.Solve().state.L + 1).max(), np.linalg.eigvalsh(reduced.S * scale * scale[:, None])[0]


@pytest.mark.parametrize("turn", (20, 90, 150, -60))
def test_heights_and_coordinates(turn):
    """Heights are those over the plane on whose side of the bisector a point lies, continuous and of the side of the crack; on the sheet p2 is the arc length."""
    crack = kinked(np.array([0.3, 0.2]), 0.4, np.radians(turn), 2.0)
    sheet, rng, step = along_z(crack), np.random.default_rng(1), 1e-7
    kink, before, after = np.array(crack.PointAt(2.0)), np.array(crack.TangentAt(1)), np.array(crack.TangentAt(3))
    for q in kink + rng.uniform(-0.5, 0.5, (200, 2)):
        p1, p2, height = sheet.Flat((*q, 0.25))
        tangent = after if (q - kink) @ (before + after) > 0 else before
        assert p1 == pytest.approx(1.25) and height == pytest.approx(tangent[0] * (q - kink)[1] - tangent[1] * (q - kink)[0], abs=1e-14)
        assert (height > 0) == (crack.SideOf(tuple(q)).name == "Plus")
    across = np.array([-(before + after)[1], (before + after)[0]]) / np.linalg.norm(before + after)
    for r in (-0.3, 0.2):
        there = [np.array(sheet.Flat((*(kink + r * across + sign * step * (before + after)), 0))) for sign in (1, -1)]
        assert np.abs(there[0] - there[1]).max() < 40 * step
    for s in (0.3, 1.9, 2.1, 3.5):
        assert sheet.Flat(sheet.PointAt(0.5, s)) == pytest.approx((0.5, s, 0), abs=1e-14)


@pytest.mark.parametrize("turn", (20, 60, 110, 150, -40, -120))
def test_parts_add_up_and_the_corner_is_cut_off(turn):
    """Volumes and areas add up to round-off; a kink is cut off within the elements that it passes: of the area O(h), of the volume O(h²)."""
    at, towards, turn = np.array([0.513, 0.487]), 0.3, np.radians(turn)
    area, volume = area_and_volume(at, towards, turn)
    errors = []
    for mesh in MESHES:
        body = CrackedMesh(mesh, along_z(kinked(at, towards, turn)))
        assert {cell.kind.name for cell in body.Elements(0)} == {"Cut"} and not body.fronts
        check_parts(body)
        for cell in body.Elements(0):
            points = np.array(cell.points)
            assert np.abs((points - points[0]) @ np.cross(points[1] - points[0], points[2] - points[0])).max() < 1e-13
        errors.append((abs(Integrate(1 * body.dcrack, mesh) - area), abs(volume_above(body) - volume)))
    h, errors = np.array(SIZES), np.array(errors)
    assert (errors[:, 0] < 0.7 * h * abs(np.tan(turn / 2))).all() and (errors[:, 1] < 0.6 * h**2).all()
    if abs(turn) < 1.6:  # of sharper ones meshes as coarse as the first one show little
        assert (np.log2(errors[0] / errors[-1]) / 2 > [0.7, 1.3]).all()


def test_away_from_the_kink_nothing_is_lost():
    """On elements whose corners see one plane facets are on that plane."""
    at, turn = np.array([0.513, 0.487]), np.radians(70)
    body = CrackedMesh(MESHES[1], along_z(kinked(at, 0.3, turn)))
    exact = 0
    for cell in body.Elements(0):
        corners = np.array([v.point for v in MESHES[1].vertices])[[v.nr for v in MESHES[1][ElementId(VOL, cell.element)].vertices]]
        ahead = (corners[:, :2] - at) @ (np.array([np.cos(0.3), np.sin(0.3)]) + np.array([np.cos(0.3 + turn), np.sin(0.3 + turn)]))
        if (ahead > 0).all() or (ahead < 0).all():
            heights = [body.cracks[0].Flat(tuple(p))[2] for p in cell.points]
            assert np.abs(heights).max() < 1e-13
            exact += 1
    assert exact > 0.5 * len(body.Elements(0))


@pytest.mark.parametrize("number", range(12))
def test_uniform_pressure_on_random_sheets(number):
    """Of any angle and direction, in meshes whose inner points are moved: λ = -p to round-off, S positive definite."""
    rng = np.random.default_rng(number)
    turn = np.radians(rng.uniform(20, 150)) * rng.choice([-1, 1])
    body = CrackedMesh(cube_mesh(rng.uniform(0.22, 0.4), number), through(rng.uniform(0.3, 0.7, 3), rng.normal(size=3), rng.uniform(0, 2 * np.pi), turn))
    check_parts(body, 1e-10)
    off, least = pressed(body)
    assert off < 1e-10 and least > 1e-10


@pytest.mark.parametrize("offset", (0, 1e-12, -1e-12, 1e-11, 1e-9, -1e-9))
def test_special_positions(offset):
    """A kink through a vertex, along an edge, in a face, a plane on a face, and beside them by less and more than what counts as on them."""
    mesh = cube_mesh(0.3, 1)
    for kind, sheet in special_sheets(np.random.default_rng(5), mesh, offset):
        body = CrackedMesh(mesh, sheet)
        check_parts(body, 1e-9)
        off, least = pressed(body)
        assert off < 1e-9 and least > 1e-10, (kind, off, least)


STEP = Crack([(-1, 0.5), (0.5, 0.5), (0.5, 2)])


@pytest.mark.parametrize("crack", (STEP, Crack([(-1, 0.5), (0.5, 0.5), (2, 2)]), Crack([(-1, -1), (0.5, 0.5), (2, -1)])))
@pytest.mark.parametrize("n", (2, 4))
def test_along_faces_of_equal_cubes(crack, n):
    """Where faces of the mesh lie on both planes the sheet runs along them, and its area is exact."""
    body = CrackedMesh(MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n), along_z(crack))
    length = sum(np.linalg.norm(np.clip(q, 0, 1) - np.clip(p, 0, 1)) for p, q in zip(np.array(crack.points)[:-1], np.array(crack.points)[1:]))
    check_parts(body)
    assert Integrate(1 * body.dcrack, body.mesh) == pytest.approx(length, rel=1e-12)


def test_fronts_end_before_the_kinks():
    """A wing crack in a slab: two straight fronts, at the ends."""
    slab = CSGeometry()
    slab.Add(OrthoBrick(Pnt(0, 0, 0), Pnt(1, 1, 0.3)))
    body = CrackedMesh(Mesh(slab.GenerateMesh(maxh=0.08)), along_z(WING))
    assert len(body.fronts) == 2 and all(front.length == pytest.approx(0.3, abs=1e-12) for front in body.fronts)
    ends = sorted(front.PointAt(0.1)[:2] for front in body.fronts)
    assert ends[0] == pytest.approx(WING.points[0]) and ends[1] == pytest.approx(WING.points[-1])
    area = Integrate(1 * body.dcrack, body.mesh)
    assert abs(area / (0.3 * WING.length) - 1) < 0.03


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: Sheet.Extrude(circle((0, 0), 1), (0, 0, 1)), "is closed"),
        (lambda: CrackedMesh(MESHES[2], along_z(WING, 0.3, 0.7)), "front that passes a kink.*p2 = 0.41.*near"),
        (lambda: CrackedMesh(MESHES[2], Sheet.Extrude(WING, (0, 0, 1), loops=[circle((0.5, 0.4), 0.2)])), "front that passes a kink"),
        (
            lambda: CrackedMesh(MESHES[0], along_z(Crack([(0.2, 0.5), (0.5, 0.5), (0.55, 0.55)]))),
            "nearer to a kink than an element|bends or has kinks too sharply",
        ),
        (lambda: CrackedMesh(MESHES[1], along_z(Crack([(-1, 0.5), (0.5, 0.5), (0.53, 0.55), (0.55, 0.5), (2, 0.5)]))), "has kinks too sharply.*refine"),
    ],
)
def test_what_is_refused(make, words):
    with pytest.raises(Exception, match=words):
        make()
