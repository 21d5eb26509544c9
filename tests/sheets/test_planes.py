"""Planes through tetrahedra: exact volumes and areas, special positions, parts, neighbours that agree."""

import pickle

import numpy as np
import pytest
from exact_sheets import cube_mesh, cut_of_cube, polygon_area
from ngsolve import CF, H1, VOL, ElementId, GridFunction, IfPos, InnerProduct, Integrate, Mesh, TaskManager, x, y, z
from ngsolve.meshes import MakeStructured3DMesh
from sheet_checks import OFFSETS, degenerate_planes, plane_errors, whole_plane

from ngsxfem_contact import CrackedMesh
from ngsxfem_contact.geometry import Sheet

MESHES = [cube_mesh(0.5), cube_mesh(0.35, 1), MakeStructured3DMesh(hexes=False, nx=3, ny=3, nz=3)]


def random_plane(seed):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=3)
    return rng.uniform(0.1, 0.9, 3), normal / np.linalg.norm(normal)


@pytest.mark.parametrize("seed", range(12))
def test_volumes_and_areas_of_random_planes_are_exact(seed):
    assert max(plane_errors(MESHES[seed % 3], *random_plane(seed))) < 1e-12


@pytest.mark.parametrize("which", range(3))
def test_planes_through_vertices_edges_and_faces(which):
    """A plane that is nearer to a vertex than 1e-10 of its shortest edge goes through it: one side and the area are off by as much then."""
    for kind, point, normal in degenerate_planes(np.random.default_rng(which), MESHES[which]):
        for offset in OFFSETS:
            volume, above, area = plane_errors(MESHES[which], point + offset * normal, normal)
            moved = abs(offset) if abs(offset) < 1e-10 else 0
            assert volume < 1e-12 and above < 1e-12 + 2 * moved and area < 1e-12 + 5 * moved, (kind, offset)


def one_tet(points):
    from netgen.meshing import Element2D, Element3D, FaceDescriptor, MeshPoint, Pnt
    from netgen.meshing import Mesh as NetgenMesh

    ngmesh = NetgenMesh(dim=3)
    ngmesh.Add(FaceDescriptor(surfnr=1, domin=1, bc=1))
    ngmesh.SetMaterial(1, "body")
    p = [ngmesh.Add(MeshPoint(Pnt(*point))) for point in points]
    ngmesh.Add(Element3D(1, p))
    for face in ((0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)):
        ngmesh.Add(Element2D(1, [p[i] for i in face]))
    ngmesh.Update()
    return Mesh(ngmesh)


REFERENCE = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
# heights of the corners over the plane → (corners of the polygon, parts), and the volume of the plus side
SIGNS = {
    "1:3": ([1, -1, -1, -1], 3, 1 / 8),
    "3:1": ([1, 1, 1, -1], 3, 7 / 8),
    "2:2": ([1, 1, -1, -1], 4, 1 / 2),
    "0 | 1:2": ([0, 1, -1, -1], 3, 1 / 4),
    "0 | 2:1": ([0, 1, 1, -1], 3, 3 / 4),
    "00 | 1:1": ([0, 0, 1, -1], 3, 1 / 2),
    "within the tolerance": ([1e-11, -1e-11, 1, -1], 3, 1 / 2),
    "beyond it": ([1e-9, 1e-9, 1, -1], 3, 1 / 2),
    "two beyond it": ([1e-9, -1e-9, 1, -1], 4, 1 / 2),
}


def plane_with_heights(heights):
    """(a point, the normal) of the plane over which the corners of the reference tetrahedron have these heights, but for a factor."""
    gradient = np.array([heights[i] - heights[0] for i in (1, 2, 3)], float)
    size = np.linalg.norm(gradient)
    return -heights[0] * gradient / size**2, gradient / size


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("name", SIGNS)
def test_the_table_of_signs(name, turn):
    heights, corners, share = SIGNS[name]
    mesh = one_tet(np.roll(REFERENCE, turn, axis=0))
    body = CrackedMesh(mesh, whole_plane(*plane_with_heights(heights)))
    (cell,) = body.Elements(0)
    assert cell.kind.name == "Cut" and len(cell.polygon) == corners
    assert body.PartSizes(0) == pytest.approx([share / 6, (1 - share) / 6], abs=1e-9)
    assert sum(body.PartSizes(0)) == pytest.approx(1 / 6, rel=1e-14)
    assert [body.FacetArea(0), Integrate(1 * body.dcrack, mesh)] == pytest.approx(2 * [polygon_area(cell.polygon)], rel=1e-13)
    assert body.fronts == []


@pytest.mark.parametrize("heights", [[0, 1, 1, 1], [0, 0, 1, 1], [0, 0, -1, -1], [1, 2, 3, 1]])
def test_a_plane_that_touches_a_corner_or_an_edge_cuts_nothing(heights):
    with pytest.raises(Exception, match="no element is cut"):
        CrackedMesh(one_tet(REFERENCE), whole_plane(*plane_with_heights(heights)))


def test_a_face_on_the_plane_belongs_to_one_element():
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2)
    body = CrackedMesh(mesh, whole_plane((0.3, 0.4, 0.5), np.array([0.0, 0.0, 1.0])))
    cells = body.Elements(0)
    assert {cell.kind.name for cell in cells} == {"Aligned"} and len(cells) == 8
    owners, neighbours = {cell.element for cell in cells}, {cell.neighbour for cell in cells}
    assert not owners & neighbours
    assert [body.PartSizes(cell.element) for cell in cells] == [[pytest.approx(1 / 48)]] * 8
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(1, abs=1e-14)
    assert Integrate(body.larger_side * body.dcrack, mesh) == pytest.approx(1, abs=1e-14)  # of equals the plus side
    open_faces = [face.nr for face in mesh.faces if body.Links(face.nr) == []]
    assert len(open_faces) == 8 and all(abs(mesh[v].point[2] - 0.5) < 1e-14 for nr in open_faces for v in list(mesh.faces)[nr].vertices)


@pytest.mark.parametrize("seed", range(3))
def test_parts_of_neighbours_hang_together_on_one_side(seed):
    """What hangs together across faces are the two halves of the cube."""
    mesh, (origin, normal) = MESHES[1], random_plane(seed)
    body = CrackedMesh(mesh, whole_plane(origin, normal))
    parts = {(el.nr, k): None for el in mesh.Elements() for k in range(len(body.PartSizes(el.nr)))}
    beside = {}
    for face in mesh.faces:
        for a, b in body.Links(face.nr) if len(face.elements) == 2 else ():
            first, second = ((face.elements[i].nr, k) for i, k in ((0, a), (1, b)))
            beside.setdefault(first, []).append(second)
            beside.setdefault(second, []).append(first)
    halves = []
    while rest := [part for part, half in parts.items() if half is None]:
        stack = [rest[0]]
        while stack:
            if parts[part := stack.pop()] is None:
                parts[part] = len(halves)
                stack += beside.get(part, [])
        halves.append(sum(body.PartSizes(el)[k] if body.CracksOf(el) else element_volume(mesh, el) for (el, k), half in parts.items() if half == len(halves)))
    assert len(halves) == 2 and sum(halves) == pytest.approx(1, abs=1e-13)


def element_volume(mesh, number):
    t = np.array([mesh[v].point for v in mesh[ElementId(VOL, number)].vertices])
    return abs(np.linalg.det(t[1:] - t[0])) / 6


@pytest.mark.parametrize("order", (0, 1, 2, 3, 5, 8))
def test_rules_have_positive_weights_inside_their_parts(order):
    origin, normal = random_plane(5)
    body = CrackedMesh(MESHES[1], whole_plane(origin, normal))
    for measure, least in ((body.dx, -1e-14), (body.dcrack, -1e-12)):
        _, xi, eta, zeta, w, *_ = measure.Points(order)
        assert w.min() > 0 and min(xi.min(), eta.min(), zeta.min(), (1 - xi - eta - zeta).min()) > least


def test_functions_that_jump_are_integrated_exactly():
    """Polynomials on either side and on the plane against each other by Gauss' theorem: ∫ div (H F) = ∮ H F·ν - ∫_S 2 F·n."""
    origin, normal = random_plane(7)
    mesh = MESHES[1]
    body = CrackedMesh(mesh, whole_plane(origin, normal))
    H = IfPos(InnerProduct(CF((x - origin[0], y - origin[1], z - origin[2])), CF(tuple(normal))), 1, -1)
    F, divergence = CF((x * x * y, y * z, x * z * z)), 2 * x * y + z + 2 * x * z
    nu = CF((IfPos(x - 0.5, 1, -1), IfPos(y - 0.5, 1, -1), IfPos(z - 0.5, 1, -1)))
    distance = lambda c: IfPos(1e-9 - c, 1, 0) + IfPos(c - 1 + 1e-9, 1, 0)
    outward = CF(tuple(nu[i] * distance(c) for i, c in enumerate((x, y, z))))
    volume, boundary = Integrate(H * divergence * body.dx, mesh), Integrate(H * InnerProduct(F, outward) * body.ds, mesh)
    assert boundary - 2 * Integrate(InnerProduct(F, body.normal) * body.dcrack, mesh) == pytest.approx(volume, abs=1e-13)
    assert len(body.CutBoundaryElements(0)) > 4
    assert all(len(body.BoundaryPartSizes(i)) == 2 for i in body.CutBoundaryElements(0))
    with TaskManager():
        assert Integrate(H * divergence * body.dx, mesh) == pytest.approx(volume, abs=1e-14)


def test_grid_functions_and_forms_take_the_measures():
    from ngsolve import BilinearForm, LinearForm, dx

    mesh = MESHES[1]
    body = CrackedMesh(mesh, whole_plane(*random_plane(3)))
    V = H1(mesh, order=1)
    u, v = V.TnT()
    cut, plain = BilinearForm(u * v * body.dx).Assemble().mat, BilinearForm(u * v * dx).Assemble().mat
    assert np.abs(cut.AsVector().FV().NumPy() - plain.AsVector().FV().NumPy()).max() < 1e-15
    f = LinearForm(v * body.dcrack).Assemble().vec
    one = GridFunction(V)
    one.Set(1)
    assert InnerProduct(f, one.vec) == pytest.approx(Integrate(1 * body.dcrack, mesh), rel=1e-13)


def test_the_larger_part():
    origin, normal = np.array([0.5, 0.5, 0.52]), np.array([0.0, 0.0, 1.0])
    mesh = MESHES[1]
    body = CrackedMesh(mesh, whole_plane(origin, normal))
    larger = sum(max(body.PartSizes(cell.element)) for cell in body.Elements(0))
    assert Integrate(1 * body.dlarger, mesh) == pytest.approx(larger, rel=1e-13)
    assert body.CrackElements(None).NumSet() == body.CrackElements(0).NumSet() == len(body.Elements(0))


def test_a_body_survives_pickling():
    body = CrackedMesh(MESHES[1], Sheet.Ellipse((0.5, 0.5, 0.5), (0.3, 0, 0.1), (0, 0.2, 0)))
    copy = pickle.loads(pickle.dumps(body))
    assert Integrate(1 * copy.dcrack, copy.mesh) == Integrate(1 * body.dcrack, body.mesh)
    assert [front.length for front in copy.fronts] == [front.length for front in body.fronts]


def test_area_of_the_cut_of_a_cube():
    """The reference itself: three known cuts."""
    cuts = [polygon_area(cut_of_cube(np.full(3, 0.5), np.array(n) / np.linalg.norm(n))) for n in ((0, 0, 1), (1, 1, 0), (1, 1, 1))]
    assert cuts == pytest.approx([1, np.sqrt(2), 3 * np.sqrt(3) / 4], rel=1e-14)
