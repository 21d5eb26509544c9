"""Sheets that are small against their elements open too little: where that is so, a warning says it, and where none does they open as they should."""

import warnings

import pytest
from netgen.csg import unit_cube
from netgen.geom2d import unit_square
from ngsolve import CF, Integrate, Mesh
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.exact.pennies import penny_in_tension
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.spaces import FrontEnrichment

MATERIAL = Elasticity.Solid(E=2, nu=0.3)
CENTRE, RADIUS, SIDE = (0.02, 0.01, 0.03), 1.0, 3.2


def opened(n, order, front):
    """The volume between the faces of a penny under tension over its closed form, and what was warned of its sheet."""
    mesh = MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n, mapping=lambda *x: tuple(SIDE * (xi - 0.5) for xi in x))
    form = penny_in_tension(MATERIAL, RADIUS, 1).At(CENTRE)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", AccuracyWarning)
        body = CrackedMesh(mesh, Sheet.Disk(CENTRE, (0, 0, 1), RADIUS))
        V = CrackFESpace(body, order=order, material=MATERIAL, dirichlet=".*", front=front)
    problem = ContactProblem(V, TraceSpace(body))
    problem.SetDirichlet(form.u, ".*")
    exact = 16 * (1 - MATERIAL.nu**2) * RADIUS**3 / (3 * MATERIAL.E)
    return Integrate(problem.Solve().gap * body.dcrack, mesh) / exact, [str(one.message) for one in caught if str(one.message).startswith("sheet")]


@pytest.mark.parametrize("n, order, front, most", [(4, 1, FrontEnrichment(), 0.5), (4, 2, FrontEnrichment(), 0.8), (6, 1, None, 0.3), (6, 2, None, 0.7)])
def test_small_sheets_warn(n, order, front, most):
    ratio, (warning,) = opened(n, order, front)
    assert ratio < most and "sheet 0 reaches " in warning and "opens and slides too little" in warning
    reach, edges = (float(warning.split(word)[1].split()[0].strip(",;")) for word in ("reaches", "front,"))
    assert 0.8 * RADIUS < reach <= RADIUS and edges == pytest.approx(reach * n / SIDE / 3**0.5, abs=0.06)


def test_others_do_not():
    ratio, said = opened(9, 2, FrontEnrichment())
    assert not said and ratio == pytest.approx(1, abs=0.03)


def test_a_sheet_through_the_body_has_no_front():
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2)
    body = CrackedMesh(mesh, Sheet.Polygon([(-1, -1, 0.4), (2, -1, 0.4), (2, 2, 0.4), (-1, 2, 0.4)]))
    with warnings.catch_warnings():
        warnings.simplefilter("error", AccuracyWarning)
        CrackFESpace(body, order=1, material=MATERIAL, front=None)


HEIGHT = 0.513


def space(mesh, cracks, order, material, **arguments):
    """V of a body, and what was warned of its boundary."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", AccuracyWarning)
        V = CrackFESpace(CrackedMesh(mesh, *cracks), order=order, material=material, dirichlet="bottom", **arguments)
    return V, [str(one.message) for one in caught if "the boundary of the body" in str(one.message)]


def torn(V):
    """The potential energy of a square or cube that is held below and pulled above."""
    problem = ContactProblem(V, TraceSpace(V.body))
    problem.f += CF((0,) * (V.mesh.dim - 1) + (1,)) * V.TestFunction() * V.body.ds("top")
    return problem.Solve().PotentialEnergy()


@pytest.mark.parametrize("ligament, order, least, most", [(0.06, 1, 0, 0.3), (0.06, 2, 0, 0.8), (0.1, 1, 0, 0.5), (0.4, 2, 0.95, 1.01)])
def test_fronts_beside_the_boundary_warn(ligament, order, least, most):
    """Beside the plane problem with smaller elements."""
    mesh = Mesh(unit_cube.GenerateMesh(maxh=0.25))
    end = 1 - ligament
    sheet = Sheet.Polygon([(-1, -1, HEIGHT), (end, -1, HEIGHT), (end, 2, HEIGHT), (-1, 2, HEIGHT)])
    V, said = space(mesh, [sheet], order, MATERIAL, dirichlety="left|right")
    plane = Mesh(unit_square.GenerateMesh(maxh=0.03))
    of_plane, _ = space(plane, [Crack([(0, HEIGHT), (end, HEIGHT)])], 3, Elasticity.PlaneStrain(E=2, nu=0.3))
    assert least < torn(V) / torn(of_plane) < most
    if ligament > 0.25:
        assert not said
    else:
        (warning,) = said
        assert warning.startswith("the front of sheet 0 passes the boundary of the body") and "near (1, " in warning


@pytest.mark.parametrize("maxh", (0.2, 0.12))
@pytest.mark.parametrize(
    "sheet",
    [
        Sheet.Disk((0.5, 0.5, 0.52), (0, 0.2, 1), 0.25),
        Sheet.Disk((0, 0.5, 0.52), (0, 0.2, 1), 0.3),
        Sheet.Disk((0, 0, 0.52), (0, 0, 1), 0.3),
        Sheet.Polygon([(-1, -2.9, 0.52), (2, 2.3, 0.52), (2, -2.9, 0.52)]),  # at 60 degrees
    ],
)
def test_fronts_that_end_on_the_boundary_do_not(maxh, sheet):
    assert not space(Mesh(unit_cube.GenerateMesh(maxh=maxh)), [sheet], 1, MATERIAL)[1]
