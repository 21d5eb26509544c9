"""What is refused, where, and in which words."""

import numpy as np
import pytest
from exact_sheets import cube_mesh
from helpers import rectangle
from netgen.occ import Box, OCCGeometry, Pnt, Sphere
from ngsolve import VOL, ElementId, Mesh
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.geometry import FrontDemand, Sheet

MESH = cube_mesh(0.4)
CUBES = MakeStructured3DMesh(hexes=False, nx=3, ny=3, nz=3)
DISK = Sheet.Disk((0.5, 0.5, 0.5), (0, 0, 1), 0.3)
CIRCLE = DISK.loops[0]


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: Sheet.Disk((0, 0), (0, 0, 1), 1), ValueError, "center.*three components"),
        (lambda: Sheet.Disk((0, 0, np.nan), (0, 0, 1), 1), ValueError, "finite"),
        (lambda: Sheet.Disk((0, 0, 0), (0, 0, 0), 1), ValueError, "normal.*no direction"),
        (lambda: Sheet.Disk((0, 0, 0), (0, 0, 1), -1), ValueError, "radius=-1 must be positive"),
        (lambda: Sheet.Disk("here", (0, 0, 1), 1), ValueError, "no vector"),
        (lambda: Sheet.Ring((0, 0, 0), (0, 0, 1), 1, 0.5), ValueError, "larger than inner=1"),
        (lambda: Sheet.Ellipse((0, 0, 0), (1, 0, 0), (1, 1, 0)), ValueError, "not perpendicular"),
        (lambda: Sheet.Ellipse((0, 0, 0), (1, 0, 0), (0, 3e-3, 0)), ValueError, "ratio below 300"),
        (lambda: Sheet.Polygon([(0, 0, 0), (1, 0, 0)]), ValueError, "three or more"),
        (lambda: Sheet.Polygon([(0, 0, 0), (1, 0, 0), (2, 0, 0)]), ValueError, "on a line"),
        (lambda: Sheet.Polygon([(0, 0, 0), (1, 0, 0), (1, 1, 0.1), (0, 1, 0)]), ValueError, "a curved sheet is Sheet.Extrude"),
        (lambda: Sheet.Polygon([(0, 0, 0), (2, 2, 0), (2, 0, 0), (0.5, 1, 0)]), Exception, "meet near"),
        (lambda: Sheet([Crack([(0, 0), (1, 0), (1, 1)])]), Exception, "closed curves"),
        (lambda: Sheet([]), Exception, "give the closed curve"),
        (lambda: Sheet([CIRCLE], axes=((1, 0, 0), (2, 0, 0))), Exception, "parallel"),
        (lambda: Sheet([CIRCLE, Crack([(2, 2), (3, 2), (3, 3), (2, 2)])]), Exception, "outside of the outer one near"),
        (lambda: Sheet([CIRCLE, Crack([(0, 0), (3, 0), (0, 3), (0, 0)])]), Exception, "meets another one near"),
    ],
)
def test_sheets_that_make_no_sense(make, error, words):
    with pytest.raises(error, match=words):
        make()


def refused(mesh, *sheets):
    with pytest.raises(Exception) as info:
        CrackedMesh(mesh, *sheets)
    return str(info.value)


def test_a_sheet_along_the_boundary():
    said = refused(MESH, Sheet.Disk((0.5, 0.5, 0), (0, 0, 1), 0.3))
    assert "sheet 0 runs along the boundary" in said and "near (" in said


def test_a_front_that_grazes_the_boundary():
    said = refused(MESH, Sheet.Disk((0.5, 0.5, 0.29), (0, 1, 0), 0.3))
    assert "less than 20 degrees" in said and "near (" in said


def test_two_sheets_in_one_element():
    said = refused(MESH, DISK, Sheet.Disk((0.5, 0.5, 0.52), (0.1, 0, 1), 0.3))
    assert "sheets 0 and 1 meet the same element" in said and "near (" in said


def test_two_sheets_on_both_sides_of_an_element():
    """One along a face that its neighbour carries."""
    plane = Sheet.Polygon([(-1, -1, 1 / 3), (2, -1, 1 / 3), (2, 2, 1 / 3), (-1, 2, 1 / 3)])
    assert "meet the same element" in refused(CUBES, plane, Sheet.Disk((0.5, 0.5, 0.4), (0, 0.01, 1), 0.3))
    assert "meet the same element" in refused(CUBES, plane, Sheet.Disk((0.5, 0.5, 0.3), (0, 0.01, 1), 0.3))


def test_sheets_smaller_than_an_element():
    assert "smaller than an element" in refused(
        MESH, Sheet.Disk(tuple(np.mean([MESH[v].point for v in MESH[ElementId(VOL, 0)].vertices], axis=0)), (1, 2, 3), 1e-3)
    )
    hole = refused(cube_mesh(0.2), Sheet.Ring((0.51, 0.53, 0.47), (0.1, 0.2, 1), 1e-3, 0.3))
    assert "has a hole that lies inside of one element" in hole


def test_a_sheet_beside_the_body():
    assert "lies outside of the body" in refused(MESH, Sheet.Disk((3, 0, 0), (0, 0, 1), 0.3))
    assert "lies outside of the body" in refused(MESH, Sheet.Disk((0.5, 0.5, 1.2), (0, 0.1, 1), 0.3))


def test_meshes_that_sheets_do_not_cut():
    assert "not a tetrahedron" in refused(MakeStructured3DMesh(hexes=True, nx=2, ny=2, nz=2), DISK)
    ball = Mesh(OCCGeometry(Sphere(Pnt(0.5, 0.5, 0.5), 0.4)).GenerateMesh(maxh=0.3))
    assert "on the boundary" not in str(CrackedMesh(ball, Sheet.Disk((0.5, 0.5, 0.5), (0, 0, 1), 0.2)))
    ball.Curve(2)
    assert "curved" in refused(ball, DISK)


def test_a_sheet_in_the_plane_and_a_crack_in_space():
    with pytest.raises(TypeError, match="the mesh is plane"):
        CrackedMesh(rectangle(0.5), DISK)
    with pytest.raises(TypeError, match="is not a Sheet, but the mesh"):
        CrackedMesh(MESH, CIRCLE)
    with pytest.raises(TypeError, match=r"\*sheets"):
        CrackedMesh(MESH, [DISK])
    assert "give at least one sheet" in refused(MESH)


def test_measures_refuse_what_belongs_to_the_other_dimension():
    plane = CrackedMesh(rectangle(0.3), Crack([(0.2, 0.5), (0.7, 0.5)]))
    with pytest.raises(Exception, match="tips and no fronts"):
        plane.dx(fronts=FrontDemand(0.1))
    body = CrackedMesh(MESH, DISK)
    with pytest.raises(Exception, match="arc lengths"):
        body.dcrack(nodes=[[0.1]])
    with pytest.raises(Exception, match="there is no crack 1"):
        body.dcrack(crack=1)
    with pytest.raises(Exception, match="FrontDemand: radius"):
        body.dx(fronts=FrontDemand(-1.0))
    with pytest.raises(Exception, match="FrontDemand: beta"):
        body.dx(fronts=FrontDemand(0.1, beta=3))


def test_a_mesh_that_changed_is_refused():
    mesh = Mesh(OCCGeometry(Box(Pnt(0, 0, 0), Pnt(1, 1, 1))).GenerateMesh(maxh=0.5))
    body = CrackedMesh(mesh, DISK)
    mesh.Refine()
    with pytest.raises(Exception, match="refined"):
        body.dx.Points(2)


def test_what_is_given_stays_as_it_is():
    normal = np.array([0.2, -0.1, 1.0])
    Sheet.Disk((0.5, 0.5, 0.5), normal, 0.3)
    assert normal.tolist() == [0.2, -0.1, 1.0]
