"""Bodies in space: what makes no sense there, and what is there in the plane only, is refused where it is given, and named."""

from math import pi

import pytest
from netgen.csg import unit_cube
from netgen.geom2d import unit_square
from netgen.meshing import MeshingStep
from ngsolve import CF, Mesh, specialcf

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, Elasticity, LoadCase, LoadSteps, SheetGrowth, TraceSpace
from ngsxfem_contact.contact import PathSteps
from ngsxfem_contact.fracture import GivenIncrement
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.plotting import plot_body, plot_front
from ngsxfem_contact.spaces import Interpolant, Projection

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = Mesh(unit_cube.GenerateMesh(maxh=0.3))
DISK = Sheet.Disk((0.5, 0.5, 0.52), (0, 0.3, 1), 0.3)


def loaded(body, material, **arguments):
    V = CrackFESpace(body, order=1, material=material, **arguments)
    problem = ContactProblem(V, TraceSpace(body), law=Coulomb(0.2))
    problem.f += -specialcf.normal(body.mesh.dim) * V.TestFunction() * body.ds  # pressure all around
    return problem


def solid():
    return loaded(CrackedMesh(MESH, DISK), Elasticity.Solid(200, 0.3), front=None, dirichlet="bottom")


def plane():
    mesh = Mesh(unit_square.GenerateMesh(maxh=0.3))
    return loaded(CrackedMesh(mesh, Crack([(0.2, 0.5), (0.8, 0.52)])), Elasticity.PlaneStrain(200, 0.3), tip=None, dirichlet="bottom")


PROBLEM = solid()
SOLUTION, OF_PLANE = PROBLEM.Solve(), plane().Solve()
V = PROBLEM.V


def surface():
    return Mesh(unit_cube.GenerateMesh(maxh=0.5, perfstepsend=MeshingStep.MESHSURFACE))


def grown_by(found):
    return SheetGrowth(lambda sheets: found, [DISK], GivenIncrement(0.1)).Step()


@pytest.mark.parametrize(
    "call, error, words",
    [
        (lambda: CrackedMesh(MESH.ngmesh, DISK), TypeError, r"is not a Mesh of NGSolve; .* Mesh\(...\)"),
        (lambda: CrackedMesh(surface(), DISK), ValueError, "has no tetrahedra, its surface alone"),
        (lambda: CrackedMesh(None, DISK), TypeError, "mesh=None is not a Mesh"),
        (lambda: Sheet.Polygon(None), TypeError, "points=None are no list of corners"),
        (lambda: PROBLEM.Solve(inverse="cholesky"), ValueError, "inverse='cholesky' names no solver; take one of .*'sparsecholesky'.*'cg'"),
        (lambda: PROBLEM.Solve(inverse=1), TypeError, "inverse=1 is not the name of a solver"),
        (lambda: PROBLEM.Solve(start=OF_PLANE), ValueError, "start is a solution in 2 dimensions, the problem has 3"),
        (lambda: PathSteps(PROBLEM), ValueError, "PathSteps: this is there for plane bodies only"),
        (lambda: LoadSteps(LoadCase(PROBLEM)), TypeError, "LoadSteps: problem=.* is not a ContactProblem"),
        (lambda: LoadSteps(PROBLEM, LoadCase(PROBLEM)), TypeError, "LoadSteps: cases=.* is not a list of LoadCases"),
        (lambda: CrackGrowth(lambda cracks: PROBLEM, [DISK], GivenIncrement(0.1)), TypeError, "these are sheets; take SheetGrowth"),
        (lambda: grown_by(None), TypeError, r"evaluate returned None, .* return \[solution.StressIntensity\(front\)\]"),
        (lambda: grown_by([]), TypeError, "list of one or more FrontFactors"),
        (lambda: grown_by([SOLUTION]), TypeError, "list of one or more FrontFactors"),
        (lambda: SOLUTION.SaveVTK("part", factors=SOLUTION), TypeError, r"factors=SolidSolution is not a list .* \[solution.StressIntensity\(front\)\]"),
        (lambda: SOLUTION.SaveVTK("part", factors=[3]), TypeError, "an entry=3 is not what StressIntensity"),
        (lambda: plot_front(SOLUTION), TypeError, "plot_front: factors=SolidSolution is not what StressIntensity"),
        (lambda: plot_front(OF_PLANE), TypeError, "plot_front: factors=ContactSolution is not"),
        (lambda: plot_body(SOLUTION, cut=((0, 0, -1), (0, 0, 1))), ValueError, "leaves nothing of the body"),
        (lambda: Interpolant(CF((1, 0, 0)), V), TypeError, "Interpolant: V=.* is not a CrackFESpace"),
        (lambda: Projection(CF((1, 0, 0)), V), TypeError, "Projection: V=.* is not a CrackFESpace"),
        (lambda: SOLUTION.StressIntensity(0), ValueError, r"meets its own centre of curvature .*; a tube needs 0\.\d+, an element: refine the mesh there"),
    ],
)
def test_refused(call, error, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=words):
        call()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("size", (1e-200, 1e200))
def test_a_normal_of_any_length(size):
    assert Sheet.Disk((0, 0, 0), (0, 0, size), 1).normal == (0, 0, 1)


@pytest.mark.parametrize("ratio", (3.3, 30, 170, 299.9))
@pytest.mark.parametrize("turned", (False, True))
def test_slender_ellipses(ratio, turned):
    axes = [(0.4, 0, 0), (0, 0.4 / ratio, 0)]
    assert Sheet.Ellipse((0, 0, 0), *axes[:: -1 if turned else 1]).area == pytest.approx(pi * 0.16 / ratio, rel=1e-12)


def test_multipliers_have_three_components():
    """With friction and without."""
    n = PROBLEM.W.ndof
    without = ContactProblem(V, PROBLEM.W)
    without.f += -specialcf.normal(3) * V.TestFunction() * V.body.ds
    p = without.Solve().Multipliers()
    assert p.shape == SOLUTION.Multipliers().shape == (3 * n,) and (p[:n] <= 0).all() and p[:n].min() < 0 and (p[n:] == 0).all()


def test_a_body_says_what_it_is():
    lines = repr(PROBLEM.body).splitlines()
    assert lines[0] == "CrackedSolid" and lines[1].split() == ["mesh", str(MESH.ne), "tetrahedra"]
    assert "area 0.282743 in" in lines[2] and lines[3].endswith("of sheet 0, length 1.88496, closed") and "sheet 0" in PROBLEM.body._repr_html_()
