"""Sheets of triangulated surfaces: the smooth surface, files, faces of OpenCASCADE, areas, modes, uniform pressure, and what is refused."""

import pickle

import numpy as np
import pytest
from curved_surfaces import CAP_MIDDLE, CAP_RADIUS, CAP_SPHERE, cap, turned
from exact_sheets import cube_mesh
from netgen.occ import Box, Cylinder, Pnt, Y
from ngsolve import Integrate
from test_curved_sheets import modes_by_differences

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.exact.pennies import penny
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.spaces import FrontEnrichment

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
RADIUS, SPHERE, MIDDLE = CAP_RADIUS, CAP_SPHERE, CAP_MIDDLE
CAP_AREA = 2 * np.pi * SPHERE * (SPHERE - np.sqrt(SPHERE**2 - RADIUS**2))
MESHES = {h: cube_mesh(h) for h in (0.25, 0.12, 0.05)}


TURN = turned((1, 2, 0.5), 0.6)
CAP = Sheet.FromTriangles(*cap(turn=TURN))


def sphere_errors(sheet):
    """The largest distances from the sphere and its normals, at places of the cap; and whether the coordinates are those of the heights over the plane."""
    worst, centre = np.zeros(2), MIDDLE - TURN[:, 2] * np.sqrt(SPHERE**2 - RADIUS**2)
    for r, angle in np.random.default_rng(0).uniform((0, 0), (0.95 * RADIUS, 7), (40, 2)):
        p = r * np.cos(angle), r * np.sin(angle)
        place, frame = np.array(sheet.PointAt(*p)), np.array(sheet.FrameAt(*p))
        assert np.allclose(frame @ frame.T, np.eye(3)) and np.linalg.det(frame[[1, 2, 0]]) > 0
        assert sheet.Flat(tuple(place + 0.1 * np.cross(*sheet.axes))) == pytest.approx((*p, 0.1))
        out = (place - centre) / np.linalg.norm(place - centre)
        worst = np.maximum(worst, (abs(np.linalg.norm(place - centre) - SPHERE), np.abs(frame[0] - out).max()))
    return worst


def test_the_smooth_surface():
    """Places and normals of a sphere through the corners of few triangles, and of more."""
    coarse, fine = (Sheet.FromTriangles(*cap(rings, turn=TURN)) for rings in (6, 24))
    assert np.allclose(np.cross(*coarse.axes), TURN[:, 2]) and len(coarse.loops) == 1 and coarse.area == pytest.approx(np.pi * RADIUS**2, rel=3e-3)
    assert (sphere_errors(coarse) < (5e-6, 3e-4)).all() and (sphere_errors(fine) < 0.7 * sphere_errors(coarse)).all()


def test_areas_converge():
    """Of the cap, which the smooth surface and its front follow: order two in h, in the mean of positions."""
    means, sizes = [], []
    for mesh in (MESHES[0.25], MESHES[0.05]):
        errors = []
        for k in range(4):
            body = CrackedMesh(mesh, Sheet.FromTriangles(*cap(turn=turned((1, 2, 0.5), 0.3 * k + 0.1), middle=MIDDLE + k * np.array([0.01, 0, -0.007]))))
            points = np.array([body.fronts[0].PointAt(s) for s in np.linspace(0, body.fronts[0].length, 9)])
            assert len(body.fronts) == 1 and body.fronts[0].closed and Integrate(1 * body.dx, mesh) == pytest.approx(1, rel=1e-12)
            assert np.abs(np.linalg.norm(points - MIDDLE - k * np.array([0.01, 0, -0.007]), axis=1) - RADIUS).max() < 3e-4
            errors.append(abs(Integrate(1 * body.dcrack, mesh) / CAP_AREA - 1))
        means.append(np.mean(errors))
        sizes.append(mesh.ne ** (-1 / 3))
    assert means[1] < 4e-4 and np.log(means[0] / means[1]) / np.log(sizes[0] / sizes[1]) > 1.7


def test_gradients_of_modes():
    """In elements around the front of the cap, against differences: the flat coordinates are not those of lengths there."""
    assert modes_by_differences(CrackedMesh(MESHES[0.12], CAP)) < 1e-6


def problem_of(mesh, sheet, form, front=FrontEnrichment()):
    V = CrackFESpace(body := CrackedMesh(mesh, sheet), order=1, dirichlet="outer", material=MATERIAL, front=front)
    problem = ContactProblem(V, TraceSpace(body))
    problem.SetDirichlet(form.u, "outer")
    return problem


def test_uniform_pressure():
    """-p I: λ = -p to round-off without modes, to the defect of the rules with them."""
    form = uniform_stress(MATERIAL, stress_matrix(xx=-1, yy=-1, zz=-1))
    assert np.abs(problem_of(MESHES[0.25], CAP, form, None).Solve().state.L + 1).max() < 1e-10
    solution = problem_of(MESHES[0.12], CAP, form).Solve()
    areas = solution.state.nodes.weights
    assert np.sqrt((solution.state.L + 1) ** 2 @ areas / areas.sum()) < 5e-4 and np.abs(solution.state.L + 1).max() < 2e-3


def test_a_flat_triangulation_is_a_disk():
    """The opening of a penny under pressure, as of Sheet.Disk; and the table along it."""
    middle = (0.49, 0.51, 0.513)
    sheets = Sheet.Disk(middle, (0, 0, 1), RADIUS), Sheet.FromTriangles(*cap(sphere=np.inf, middle=middle))
    found = []
    for sheet in sheets:
        problem = problem_of(MESHES[0.12], sheet, penny(MATERIAL, RADIUS, 1.0).At(middle), FrontEnrichment(radius=0))
        problem.FacePressure(1.0)
        solution = problem.Solve()
        found.append((Integrate(solution.gap * solution.body.dcrack, solution.body.mesh), solution.Energy(), len(solution.Profile())))
    assert found[1][:2] == pytest.approx(found[0][:2], rel=1e-3) and found[0][2] == found[1][2]


def written(tmp_path, text):
    points, triangles = cap(8)
    corners = points[triangles]
    path = tmp_path / "cap.stl"
    if text:
        lines = ["solid cap"]
        for triangle in corners:
            lines += ["facet normal 0 0 1", "outer loop", *(f"vertex {p[0]:.9g} {p[1]:.9g} {p[2]:.9g}" for p in triangle), "endloop", "endfacet"]
        path.write_text("\n".join([*lines, "endsolid cap"]))
    else:
        record = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]))
        record["corners"] = corners
        path.write_bytes(b"solid in bytes".ljust(80) + len(corners).to_bytes(4, "little") + record.tobytes())
    return path


@pytest.mark.parametrize("text", (True, False))
def test_files(tmp_path, text):
    sheet, same = Sheet.FromSTL(written(tmp_path, text)), Sheet.FromTriangles(*cap(8))
    assert sheet.PointAt(0.1, 0.05) == pytest.approx(same.PointAt(0.1, 0.05), abs=1e-6) and sheet.area == pytest.approx(same.area, rel=1e-5)
    again = pickle.loads(pickle.dumps(sheet))
    assert again.PointAt(0.1, 0.05) == sheet.PointAt(0.1, 0.05) and repr(again) == repr(sheet)


def test_faces_of_solids():
    """A piece of a cylinder: its area, and the four straight sides of its projection."""
    block = Cylinder(Pnt(0.5, -1, -0.5), Y, 1, 3) * Box(Pnt(0.52, 0.3, 0), Pnt(0.92, 0.8, 1))
    sheet = Sheet.FromFace(max(block.faces, key=lambda face: face.center.z), 0.08)
    assert len(sheet.loops[0].points) == 5
    body = CrackedMesh(MESHES[0.12], sheet)
    assert Integrate(1 * body.dcrack, MESHES[0.12]) == pytest.approx(0.5 * (np.arcsin(0.42) - np.arcsin(0.02)), rel=5e-3)
    assert len(body.fronts[0].corners) == 4


TETRAHEDRON = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: Sheet.FromTriangles(TETRAHEDRON, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]), ValueError, "closed"),
        (lambda: Sheet.FromTriangles(TETRAHEDRON, [(0, 1, 2), (0, 1, 3)]), ValueError, "same direction"),
        (lambda: Sheet.FromTriangles(TETRAHEDRON, [(0, 1, 5)]), ValueError, "numbers of the 4 points"),
        (lambda: Sheet.FromTriangles(TETRAHEDRON[:, :2], [(0, 1, 2)]), ValueError, "give .n, 3. and .m, 3."),
        (lambda: Sheet.FromTriangles(TETRAHEDRON, [(0, 0, 1)]), ValueError, "no triangle has an area"),
        (lambda: Sheet.FromTriangles(TETRAHEDRON, [(0, 1, 2), (1, 0, 3)]), ValueError, "45 degrees|45 are not there"),
        (lambda: Sheet.FromTriangles(*creased()), ValueError, "a sheet is smooth"),
        (lambda: Sheet.FromFace("face", 0.1), TypeError, "no face"),
    ],
)
def test_what_is_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()


def creased():
    """Two halves of a disk with a ridge between them."""
    points, triangles = cap(sphere=np.inf)
    points[:, 2] += 0.4 * np.abs(points[:, 0] - 0.49)
    return points, triangles


def test_no_stl(tmp_path):
    (tmp_path / "not.stl").write_text("nothing here")
    with pytest.raises(ValueError, match="no STL file"):
        Sheet.FromSTL(tmp_path / "not.stl")
