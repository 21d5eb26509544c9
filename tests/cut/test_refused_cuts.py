"""What the core refuses with a reason: curves that are no crack, cracks that a mesh cannot carry, numbers that do not exist."""

import pytest
from helpers import rectangle, structured
from netgen.csg import unit_cube
from ngsolve import BilinearForm, Integrate, Mesh, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, TraceSpace
from ngsxfem_contact.spaces.nodes import CurveNodes

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = rectangle(0.3)
CRACK = Crack([(0, 0.43), (0.6, 0.5)])
BODY = CrackedMesh(MESH, CRACK)


@pytest.mark.parametrize("make, reason", [
    (lambda: Crack.OfPieces([]), "at least one piece"),
    (lambda: Crack.OfPieces([("circle", [(0, 0), (1, 0)])]), "circle"),
    (lambda: Crack.OfPieces([("arc", [(0, 0), (1, 0)])]), "2 points"),
    (lambda: Crack.OfPieces([("segment", [(0, 0), (1, 0)]), ("segment", [(1, 0.5), (2, 0)])]), r"piece 0 ends at \(1, 0\)"),
    (lambda: Crack.OfPieces([("cubic", [(0, 0), (3, 3), (1, 0), (3, -3)])]), "cusp"),
    (lambda: Crack([(0, 0), (0.5, 0.5), (0.5, 0.5), (1, 1)]), "points 1 and 2 coincide"),
    (lambda: Crack.Arc((0, 0), (float("nan"), 1), (1, 0)), r"point \(nan, 1\) is not finite"),
    (lambda: Crack.Join(CRACK, [(0.6, 0.5), (1, 1)]), "Crack.Join: .* is not a Crack"),
    (lambda: Crack([(0, 0), (1, 0), (1, 1), (0.5, -0.5)]), r"pieces 0 and 2 meet near \(0.6"),
])  # fmt: skip
def test_curves_that_are_no_crack(make, reason):
    with pytest.raises(Exception, match=reason):
        make()


def test_a_body_of_three_dimensions():
    with pytest.raises(Exception, match="dimension 3"):
        CrackedMesh(Mesh(unit_cube.GenerateMesh(maxh=1)), CRACK)


@pytest.mark.parametrize("cracks, reason", [
    ([[(0, 0.3), (1, 0.7)], [(0.2, 0.38), (0.5, 0.5)]], r"cracks 0 and 1 coincide near"),
    ([[(0, 0.25), (1, 0.25)], [(0.2, 0.25), (0.5, 0.25)]], r"cracks 0 and 1 coincide near"),
    ([[(0.2, 0), (0.7, 0)]], "along the boundary"),
    ([[(1.1, 0.5), (1.2, 0.5)]], "outside the body"),
])  # fmt: skip
def test_cracks_that_a_mesh_cannot_carry(cracks, reason):
    with pytest.raises(Exception, match=reason):
        CrackedMesh(structured(2), *(Crack(points) for points in cracks))


def test_curves_that_touch():
    """Named where they do, which is not on the segments between their ends."""
    with pytest.raises(Exception, match=r"cracks 0 and 1 touch near \(0.5, 0.7"):
        CrackedMesh(MESH, Crack.Arc((0.1, 0.4), (0.5, 0.7), (0.9, 0.4)), Crack([(0.2, 0.7), (0.8, 0.7)]))
    CrackedMesh(rectangle(0.05), Crack.Arc((0.1, 0.4), (0.5, 0.7), (0.9, 0.4)), Crack.Arc((0.1, 0.6), (0.5, 0.9), (0.9, 0.6)))


def test_a_mesh_that_changed():
    mesh = structured(3)
    body = CrackedMesh(mesh, CRACK)
    mesh.Refine()
    with pytest.raises(Exception, match="new CrackedMesh"):
        Integrate(1 * body.dx, mesh)


def test_numbers_that_do_not_exist():
    V = CrackFESpace(BODY, order=1, tip=None)
    far = next(i for i in range(MESH.ne) if not BODY.CrackElements(0)[i])
    for call, reason in [
        (lambda: BODY.Elements(1), "no crack 1"), (lambda: V.Heaviside(V.num_heaviside), f"no Heaviside function {V.num_heaviside}"),
        (lambda: V.HeavisideDof(0, 2), "component 2"), (lambda: V.HeavisideFactors(0, far), f"element {far}"),
        (lambda: TraceSpace(BODY, nodes=[[0, CRACK.length], [0, 1]]), "2 cracks"),
        (lambda: CurveNodes(BODY, [[0.1], [0.1]], [[1.0], [1.0]]), "no crack 1"), (lambda: V.TipDofs(9), "no tip 9"),
        (lambda: CRACK.PointAt(float("nan")), "arc length nan is outside"), (lambda: CRACK.TangentAt(99), "arc length 99.* is outside"),
        (lambda: CRACK.SideOf((float("inf"), 0)), "not finite"), (lambda: CrackedMesh(MESH, [CRACK]), "is not a Crack; give cracks one by one"),
    ]:  # fmt: skip
        with pytest.raises(Exception, match=reason):
            call()


def test_what_the_measures_refuse():
    with pytest.raises(Exception, match="real"):
        Integrate((1 + 2j) * x * y * BODY.dx, MESH)
    with pytest.raises(Exception, match="empty region|nowhere"):
        BilinearForm(CrackFESpace(BODY, order=1, tip=None).TrialFunction() * 1 * BODY.dx("nowhere"))
