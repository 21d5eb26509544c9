"""Curved sheets: coordinates of the surface, volumes, areas, fronts, modes, and what is refused."""

import pickle

import numpy as np
import pytest
from curved_surfaces import ABOVE, AREA, THROUGH, arc, circle, on_circle
from exact_sheets import cube_mesh
from ngsolve import VOL, ElementId, Grad, GridFunction, Integrate

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity
from ngsxfem_contact.geometry import Sheet

MESHES = [cube_mesh(h) for h in (0.4, 0.2, 0.1)]


@pytest.mark.parametrize("direction, x_axis", [((0, 0, 2), None), ((0, 0, -2), None), ((1, 2, -0.5), None), ((2, 0, 0), (0, 0.6, 0.8))])
def test_coordinates(direction, x_axis):
    """x = X(p) + height n, with n the normal of the crack, and lengths on the surface those of the coordinates."""
    crack = Crack.Join(Crack([(-1, 0), (0, 0)]), Crack.Arc((0, 0), (np.sin(0.5), 1 - np.cos(0.5)), (np.sin(1), 1 - np.cos(1))))
    sheet, rng = Sheet.Extrude(crack, direction, (0.3, 0.2, -0.1), x_axis), np.random.default_rng(0)
    assert not sheet.planar and sheet.area == pytest.approx(crack.length * np.linalg.norm(direction))
    along = np.array(direction) / np.linalg.norm(direction)
    assert np.allclose(np.cross(*sheet.axes), along) and (x_axis is None or np.allclose(sheet.axes[0], x_axis))
    for p1, p2, height in rng.uniform((0, -0.5, -0.4), (2, 2.5, 0.4), (20, 3)):
        normal, first, second = np.array(sheet.FrameAt(p1, p2))
        place = np.array(sheet.PointAt(p1, p2)) + height * normal
        assert sheet.Flat(tuple(place)) == pytest.approx((p1, p2, height), abs=1e-12)
        assert np.allclose(first, along) and np.allclose(np.cross(first, second), normal)
        step = (np.array(sheet.PointAt(p1, p2 + 1e-6)) - np.array(sheet.PointAt(p1, p2 - 1e-6))) / 2e-6
        assert np.allclose(step, second, atol=1e-6)
    beside = np.array(sheet.PointAt(1, 0.5)) + 0.1 * np.array(sheet.FrameAt(1, 0.5)[0]) - sheet.origin
    assert crack.SideOf(tuple(np.array(sheet.axes) @ beside)).name == "Plus"


def test_a_planar_sheet_answers_the_same_questions():
    sheet = Sheet.Disk((0.1, 0.2, 0.3), (1, 2, 2), 0.5)
    assert sheet.planar and sheet.curve is None and sheet.heights is None
    for p1, p2, height in ((0.1, 0.2, 0.3), (-0.4, 0.3, -0.1)):
        place = np.array(sheet.origin) + np.array([p1, p2]) @ np.array(sheet.axes)
        assert sheet.PointAt(p1, p2) == pytest.approx(tuple(place)) and np.allclose(sheet.FrameAt(p1, p2), [sheet.normal, *sheet.axes])
        assert sheet.Flat(tuple(place + height * np.array(sheet.normal))) == pytest.approx((p1, p2, height))


def volume(corners):
    return abs(np.linalg.det(corners[1:] - corners[0])) / 6


def volume_above(body):
    """Of the plus side of the only sheet, whose elements are all cut."""
    parts = {cell.element: body.PartSizes(cell.element) for cell in body.Elements(0)}
    total = sum(sizes[0] for sizes in parts.values())
    for element in body.mesh.Elements():
        corners = np.array([body.mesh[v].point for v in element.vertices])
        if element.nr not in parts and body.cracks[0].Flat(tuple(corners.mean(axis=0)))[2] > 0:
            total += volume(corners)
    return total


def test_volumes_are_exact_and_areas_converge():
    """The facets are plane: parts and rules add up to round-off, the area and the volume on one side are off by O(h²)."""
    errors = []
    for mesh in MESHES:
        body = CrackedMesh(mesh, THROUGH)
        cells, area = body.Elements(0), Integrate(1 * body.dcrack, mesh)
        assert {cell.kind.name for cell in cells} == {"Cut"} and not body.fronts
        assert sum(body.FacetArea(cell.element) for cell in cells) == pytest.approx(area, rel=1e-12)
        assert Integrate(1 * body.dx, mesh) == pytest.approx(1, rel=1e-12) and Integrate(1 * body.ds, mesh) == pytest.approx(6, rel=1e-12)
        for cell in cells:
            corners = np.array([mesh[v].point for v in mesh[ElementId(VOL, cell.element)].vertices])
            assert sum(body.PartSizes(cell.element)) == pytest.approx(volume(corners), rel=1e-11)
            normals = np.cross(*(np.array(cell.points)[[1, 2]] - cell.points[0]))
            heights = (np.array(cell.points) - cell.points[0]) @ normals
            assert np.abs(heights).max() < 1e-13  # plane, and neighbours share corners
        errors.append((abs(area - AREA), abs(volume_above(body) - ABOVE)))
    rates = np.log2(np.array(errors)[0] / np.array(errors)[-1]) / 2
    assert (rates > 1.7).all() and errors[-1][0] < 3e-4 * AREA and errors[-1][1] < 1e-3


def test_fronts_on_a_cylinder():
    """A disk in the coordinates of a cylinder: its front is a closed curve in space, of the length and the geodesic curvature of the circle."""
    centre, radius = (0.5, 0.5 * arc().length), 0.27
    sheet = Sheet.Extrude(arc(), (0, 0, 1), loops=[circle(centre, radius)])
    body = CrackedMesh(MESHES[2], sheet)
    (front,) = body.fronts
    assert (
        front.closed
        and front.length == pytest.approx(2 * np.pi * radius)
        and Integrate(1 * body.dcrack, MESHES[2]) == pytest.approx(np.pi * radius**2, rel=1e-3)
    )
    for s in np.linspace(0.1, front.length - 0.1, 7):
        (ahead, normal, along), place = np.array(front.FrameAt(s)), np.array(front.PointAt(s))
        step = (np.array(front.PointAt(s + 1e-5)) - np.array(front.PointAt(s - 1e-5))) / 2e-5
        turn = (np.array(front.FrameAt(s + 1e-5)[0]) - np.array(front.FrameAt(s - 1e-5)[0])) / 2e-5
        assert np.allclose(step, along, atol=1e-9) and turn @ along == pytest.approx(1 / radius, rel=1e-6) == front.CurvatureAt(s)
        assert np.allclose(np.cross(ahead, normal), along) and np.hypot(*(place[:2] - np.array(on_circle(0, 0)))) == pytest.approx(1.2)
        for x1, x2 in ((0.05, 0.02), (-0.1, -0.03)):
            p = np.array(sheet.Flat(tuple(place))[:2])
            p = p + x1 * (p - centre) / radius
            beside = np.array(sheet.PointAt(*p)) + x2 * np.array(sheet.FrameAt(*p)[0])
            assert front.Tube(tuple(beside)) == pytest.approx((x1, x2, s)) and front.Distance(tuple(beside)) == pytest.approx(np.hypot(x1, x2))


def modes_by_differences(body, offsets=(0.02, 0.03)):
    """The largest difference between gradients of functions of V_h with modes and difference quotients, relative, at points of elements around the front."""
    V = CrackFESpace(body, order=1, material=Elasticity.Solid(E=1, nu=0.3))
    u, rng, worst = GridFunction(V), np.random.default_rng(1), 0.0
    first = V.FrontDof(0, 0)
    u.vec.FV().NumPy()[first:] = rng.normal(size=V.ndof - first)
    grad, mesh, step = Grad(u), body.mesh, 1e-6
    for vertex, _ in V.front_nodes[::7]:
        element = next(iter(mesh.vertices[vertex].elements))
        corners = np.array([mesh[v].point for v in mesh[element].vertices])
        place = rng.dirichlet(np.ones(4) * 5) @ corners
        if abs(body.cracks[0].Flat(tuple(place))[2]) < 1e-3 or body.fronts[0].Distance(tuple(place)) < 1e-2:
            continue
        by = [(np.array(u(mesh(*(place + step * e)))) - np.array(u(mesh(*(place - step * e))))) / (2 * step) for e in np.eye(3)]
        exact = np.array(grad(mesh(*place))).reshape(3, 3)
        worst = max(worst, np.abs(exact - np.array(by).T).max() / np.abs(exact).max())
    return worst


def test_gradients_of_modes():
    """Of functions with modes around a front that runs obliquely on a cylinder, against differences."""
    sheet = Sheet.Extrude(arc(), (0, 0, 1), loops=[circle((0.5, 0.5 * arc().length), 0.27)])
    assert modes_by_differences(CrackedMesh(MESHES[2], sheet)) < 1e-6


def test_pickle_and_repr():
    for sheet in (THROUGH, Sheet.Extrude(arc(), (0, 0, 1), loops=[circle((0.5, 0.8), 0.2)])):
        again = pickle.loads(pickle.dumps(sheet))
        assert repr(again) == repr(sheet) == repr(eval(repr(sheet), {"Sheet": Sheet, "Crack": Crack}))
        assert again.Flat((0.3, 0.7, 0.2)) == sheet.Flat((0.3, 0.7, 0.2))


HALF_TURN = Crack.Arc((-0.1, 0), (0, 0.1), (0.1, 0))


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: Sheet.Extrude(circle((0, 0), 1), (0, 0, 1)), Exception, "is closed"),
        (lambda: Sheet.Extrude(arc(), (0, 0, 0)), ValueError, "no direction"),
        (lambda: Sheet.Extrude(arc(), (0, 0, 1), x_axis=(0, 1, 1)), ValueError, "not perpendicular"),
        (lambda: Sheet.Extrude("arc", (0, 0, 1)), TypeError, "a Crack of the plane"),
        (lambda: Sheet.Extrude(arc(), (0, 0, 1), loops=[Crack([(0, 0), (1, 1)])]), Exception, "closed curves"),
        (lambda: THROUGH.normal, Exception, "no normal of its own"),
        (lambda: CrackedMesh(MESHES[1], Sheet.Extrude(HALF_TURN, (0, 0, 3), (0.5, 0.5, -1))), Exception, "bends too sharply.*near"),
        (lambda: CrackedMesh(MESHES[1], Sheet.Extrude(arc(), (0, 0, 3), (0, 3, -1))), Exception, "outside of the body"),
        (lambda: CrackedMesh(MESHES[1], THROUGH, Sheet.Extrude(arc(radius=1.21), (0, 0, 3), (0, 0, -1))), Exception, "meet the same element"),
    ],
)
def test_what_is_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()
