"""Displacements that are given where a sheet has its mouth: they may open it, and are refused where they push the faces through each other."""

import pytest
from netgen.csg import unit_cube
from ngsolve import CF, IfPos, Integrate, Mesh, x, y, z
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, Elasticity, LoadCase, LoadSteps, TraceSpace
from ngsxfem_contact.geometry import Sheet

pytestmark = [pytest.mark.filterwarnings("ignore:sheet 0 reaches"), pytest.mark.parametrize("order", (1, 2))]

MATERIAL = Elasticity.Solid(3, 0.3)
THROUGH = r"push the faces of crack 0 through each other by {} at its mouth \((0|\S+e-\d+), 0\.\d+, {}\)"
CUT, ALONG = (0.52, Mesh(unit_cube.GenerateMesh(maxh=0.4))), (0.5, MakeStructured3DMesh(hexes=False, nx=2))
BOTH = pytest.mark.parametrize(("height", "mesh"), (CUT, ALONG), ids=("cut", "along faces"))


def held(mesh, height, given, order, turn=1, **arguments):
    """A cube with a horizontal sheet that ends on x = 0, where u is given."""
    (name,) = (name for name in set(mesh.GetBoundaries()) if abs(Integrate(x, mesh, definedon=mesh.Boundaries(name))) < 1e-12)
    body = CrackedMesh(mesh, Sheet.Polygon([(-1, -1, height), (0.6, -1, height), (0.6, 2, height), (-1, 2, height)][::turn]))
    problem = ContactProblem(CrackFESpace(body, order=order, dirichlet=name, front=None, material=MATERIAL), TraceSpace(body), **arguments)
    problem.SetDirichlet(given, name)
    return problem


@BOTH
@pytest.mark.parametrize("turn", (1, -1))
def test_faces_are_not_pushed_through_each_other(height, mesh, order, turn):
    jump = IfPos(z - height, 0.01, -0.01)
    assert held(mesh, height, (0, 0, jump), order, turn).Solve().Profile().gap.max() > 0.01
    held(mesh, height, (jump, jump, -0.3 * z), order, turn).Solve()  # along the sheet, and continuous
    closing = held(mesh, height, (0, 0, -jump), order, turn)
    with pytest.raises(ValueError, match=THROUGH.format(0.02, height)):
        closing.Solve()
    steps = LoadSteps(closing, [LoadCase(closing)])
    steps.Solve(-0.5)
    with pytest.raises(ValueError, match=THROUGH.format(0.01, height)):
        steps.Solve(0.5)


@BOTH
def test_an_initial_gap_gives_room(height, mesh, order):
    jump = IfPos(z - height, 0.01, -0.01)
    held(mesh, height, (0, 0, -jump), order, gap=0.03).Solve()
    held(mesh, height, (0, 0, -jump), order, gap=CF(0.05 * y + 0.021)).Solve()
    with pytest.raises(ValueError, match=THROUGH.format(0.02, height)):
        held(mesh, height, (0, 0, -jump), order, gap=CF(0.005 * y)).Solve()


def test_only_where_the_sheet_is(order):
    """A given displacement may jump where the sheet does not reach."""
    height, mesh = CUT
    (name,) = (name for name in set(mesh.GetBoundaries()) if abs(Integrate(x - 1, mesh, definedon=mesh.Boundaries(name))) < 1e-12)
    body = CrackedMesh(mesh, Sheet.Polygon([(-1, -1, height), (0.6, -1, height), (0.6, 2, height), (-1, 2, height)]))
    problem = ContactProblem(CrackFESpace(body, order=order, dirichlet=name, front=None, material=MATERIAL), TraceSpace(body))
    problem.SetDirichlet((0, 0, IfPos(z - height, -0.01, 0.01)), name)
    problem.Solve()
