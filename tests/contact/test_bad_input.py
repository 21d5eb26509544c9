"""Bad input is refused with a message that says what to do."""

import subprocess
import sys

import numpy as np
import pytest
from helpers import rectangle, structured
from ngsolve import CF, Integrate
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

NAN, INF = float("nan"), float("inf")
MESH = rectangle(0.2)
BODY = CrackedMesh(MESH, Crack([(0, 0.51), (0.6, 0.53)]))
LENGTH = BODY.cracks[0].length


def refused(match, kind=Exception):
    return pytest.raises(kind, match=match)


@pytest.mark.parametrize(
    "points, message",
    [
        ([], "at least two points, got 0"),
        ([(0, 0)], "at least two points, got 1"),
        ([(0, 0), (NAN, 1)], r"point 1 is \(nan, 1\); coordinates must be finite"),
        ([(0, INF), (1, 1)], "point 0 .* finite"),
        ([(0, 0), (0, 0)], "zero length"),
        ([(0, 0), (1, 0), (1 + 1e-14, 0)], "points 1 and 2 coincide"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "pieces 0 and 2 meet .* cross itself"),
        ([(0, 0), (1, 0), (1, 1), (0.5, 0)], "pieces 0 and 2 meet .* touch"),
        ([(0, 0), (1, 0), (0.5, 0)], "pieces 0 and 1 meet"),
        ([(0, 0), (1, 0), (-1, 0)], "pieces 0 and 1 meet"),
    ],
)
def test_cracks(points, message):
    with refused(message):
        Crack(points)


@pytest.mark.parametrize("points", [[(0, 0, 0), (1, 0, 0)], [(0, 0), (1,)], "points", 3])
def test_points_that_are_not_of_the_plane(points):
    with refused(r"points are pairs \(x, y\), not .*; in space a crack is a surface: Sheet.Polygon", TypeError):
        Crack(points)


@pytest.mark.parametrize("points", [[(0, 0, 0), (1, 0, 0)], "ab", 3, [1, 2], [("a", "b"), ("c", "d")]])
def test_things_that_are_no_points(points):
    with pytest.raises((TypeError, RuntimeError)):
        Crack(points)


@pytest.mark.parametrize(
    "points, message",
    [
        ([(3, 0.6), (5, 0.6)], "lies outside the body"),
        ([(0, 0.6), (0.5, 1.2), (1, 0.6)], r"leaves the body at \(0.3333.*, 1\)"),
        ([(0, 0), (0.6, 0)], "along the boundary"),
    ],
)
def test_cracks_that_do_not_fit_the_mesh(points, message):
    with refused(message):
        CrackedMesh(structured(4), Crack(points))


def test_a_crack_that_leaves_through_a_notch():
    from netgen.geom2d import SplineGeometry
    from ngsolve import Mesh

    geometry = SplineGeometry()
    corners = [geometry.AppendPoint(*p) for p in [(0, 0), (1, 0), (1, 1), (0.55, 1), (0.5, 0.4), (0.45, 1), (0, 1)]]
    for i in range(7):
        geometry.Append(["line", corners[i], corners[(i + 1) % 7]])
    mesh = Mesh(geometry.GenerateMesh(maxh=0.2))
    with refused("leaves the body"):
        CrackedMesh(mesh, Crack([(0, 0.6), (1, 0.6)]))


@pytest.mark.parametrize(
    "mesh, message", [(MakeStructured2DMesh(quads=True, nx=3, ny=3), "is not a triangle; .*quad_dominated=False"), (MakeStructured3DMesh(nx=1), "dimension 3")]
)
def test_meshes_that_are_not_plane_triangles(mesh, message):
    with refused(message):
        CrackedMesh(mesh, Crack([(0, 0.4), (0.5, 0.4)]))


CALLS = ["body.Ends(5)", "body.Elements(5)", "body.CutBoundaryElements(5)", "body.MeshNodes(5, True)", "body.OnCrack(5, [0.1])",
         "body.CrackElements(5)", "body.dcrack(crack=5)", "V.Heaviside(10**6)", "V.HeavisideDof(10**6, 0)", "V.HeavisideDof(0, 2)",
         "V.TipDofs(5)", "body.OnCrack(0, [nan])", "body.OnCrack(0, [9.])"]  # fmt: skip
SCRIPT = """
from netgen.geom2d import unit_square
from ngsolve import Mesh
from ngsxfem_contact import *
nan = float("nan")
mesh = Mesh(unit_square.GenerateMesh(maxh=0.3))
body = CrackedMesh(mesh, Crack([(0, 0.51), (0.6, 0.53)]))
V = CrackFESpace(body, order=1)
for call in {calls!r}:
    try:
        eval(call)
    except Exception as e:
        print(call, "refused", flush=True)
"""


def test_numbers_out_of_range(tmp_path):
    """In a process of its own, which a wild index would end."""
    done = subprocess.run([sys.executable, "-c", SCRIPT.format(calls=CALLS)], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.splitlines() == [f"{call} refused" for call in CALLS]


def test_regions():
    with refused("restricted to 'nowhere', which matches no boundary"):
        BODY.ds("nowhere")
    with refused("restricted to 'nowhere', which matches no material"):
        BODY.dx("nowhere")
    with refused("another dimension"):
        BODY.dx(MESH.Boundaries("left"))
    with refused("matches no boundary; the mesh has .*'left'", ValueError):
        CrackFESpace(BODY, dirichlet="nowhere")


@pytest.mark.parametrize(
    "options, message",
    [
        (dict(order=0), "order=0 must be 1 or more"),
        (dict(tip=[]), "0 tip enrichments for 1 tips"),
        (dict(tip=[None, None]), "2 tip enrichments for 1 tips"),
        (dict(tip=TipEnrichment(r1=0.41)), r"the disk r1 = 0.41 of the tip at \(0.6, 0.53\) reaches the boundary of the body, at 0.4; choose r1 below"),
        (dict(tip=TipEnrichment(r0=0.4)), "needs 0 <= r0 < r1, got r0 = 0.4, r1 = 0.36"),  # r1 is chosen from the tip's clearance
        (dict(order=1.5), "order=1.5 is not a whole number"),
        (dict(order=NAN), "order=nan is not a whole number"),
        (dict(tip=0.1), "tip=0.1 is neither a TipEnrichment nor None"),
        (dict(tip=[Elasticity(1, 1)]), "is neither a TipEnrichment nor None"),
        (dict(dirichlet=3), "dirichlet=3 is not the name of a boundary"),
        (dict(complex=True), "complex=True is not supported"),
    ],
)
def test_spaces(options, message):
    with refused(message):
        CrackFESpace(BODY, **options)


@pytest.mark.parametrize(
    "options, message",
    [
        (dict(cutoff="linear"), "cutoff='linear' is not one of"),
        (dict(functions="all"), "functions='all' is not"),
        (dict(functions="modes"), "needs material=Elasticity"),
        (dict(order=0), "order=0 must be 1 or more"),
        (dict(order=5), "order=5 is more than 4"),
        (dict(functions="branch", order=2), "order=2 is more than 1, what the functions 'branch' have"),
        (dict(tolerance=0), "tolerance"),
        (dict(tolerance=-1e-9), "tolerance"),
        (dict(tolerance=NAN), "tolerance"),
        (dict(r1=NAN), "r1=nan must be positive and finite"),
        (dict(r1=INF), "r1=inf must be positive and finite"),
        (dict(r1=-0.2), "r1=-0.2 must be positive"),
        (dict(r0=NAN), "r0=nan must be .* 0 <= r0 < r1"),
        (dict(r0=-0.1, r1=0.2), "r0=-0.1 must be less than r1=0.2: the cut-off needs 0 <= r0 < r1"),
        (dict(r0=0.2, r1=0.2), "needs 0 <= r0 < r1"),
    ],
)
def test_tip_enrichments(options, message):
    with refused(message, ValueError):
        TipEnrichment(**options)


@pytest.mark.parametrize("options", [dict(r1="far"), dict(r0=[0.1]), dict(material=1.0), dict(tolerance="fine"), dict(order=1.5)])
def test_tip_enrichments_of_other_things(options):
    with refused(f"TipEnrichment: {next(iter(options))}=", TypeError):
        TipEnrichment(**options)


@pytest.mark.parametrize("space", [CrackFESpace, TraceSpace])
def test_spaces_need_a_cracked_mesh(space):
    with refused(r"is not a CrackedMesh; build one by CrackedMesh\(mesh, crack", TypeError):
        space(MESH)


def test_disks_of_two_tips_of_one_crack_must_not_overlap():
    body = CrackedMesh(MESH, Crack([(0.4, 0.5), (0.6, 0.5)]))
    with refused(r"half the way to the tip at \(0.6, 0.5\)"):
        CrackFESpace(body, tip=TipEnrichment(r1=0.11))


@pytest.mark.parametrize("lam, mu", [(1, 0), (1, -1), (-2, 1), (NAN, 1), (1, INF)])
def test_materials(lam, mu):
    with refused("Elasticity", ValueError):
        Elasticity(lam, mu)


@pytest.mark.parametrize("basis", ["nodal", "trace"])
@pytest.mark.parametrize(
    "nodes", [[0, 0.3], [0.1, LENGTH], [0, 0.3, 0.2, LENGTH], [0, 0.3, 0.3, LENGTH], [0, NAN, LENGTH], [LENGTH, 0], [0], [], [[0, LENGTH], [0, LENGTH]]]
)
def test_nodes_of_multipliers(nodes, basis):
    with refused("nodes"):
        TraceSpace(BODY, order=1, nodes=nodes, basis=basis)


def test_messages_about_nodes_name_numbers():
    with refused("nodes on crack 0 must be arc lengths that increase from 0 to its length 0.6003"):
        TraceSpace(BODY, order=1, nodes=[0, 0.3])


@pytest.mark.parametrize("nodes", [5, "all", [["start", "end"]]])
def test_things_that_are_no_nodes(nodes):
    with refused("nodes=.* are no arc lengths, one list of numbers for each crack", TypeError):
        TraceSpace(BODY, nodes=nodes)


@pytest.mark.parametrize("order", [1.5, NAN, "1"])
def test_orders_that_are_no_whole_numbers(order):
    with refused("order=.* is not a whole number", TypeError):
        TraceSpace(BODY, order=order)


@pytest.mark.parametrize("options, message", [(dict(order=-1), "order=-1"), (dict(basis="dual"), "basis='dual' is not 'nodal' or 'trace'")])
def test_multipliers(options, message):
    with refused(message, ValueError):
        TraceSpace(BODY, **options)


def test_a_mesh_of_netgen():
    with pytest.raises(TypeError, match=r"CrackedMesh: mesh=.* is not a Mesh of NGSolve; one of Netgen becomes it by Mesh\(...\)"):
        CrackedMesh(rectangle(0.4).ngmesh, Crack([(0, 0.51), (0.6, 0.53)]))


def test_integrands():
    with refused("scalar"):
        Integrate(CF((1, 2)) * BODY.dx, MESH)
    with refused("belongs to another mesh"):
        Integrate(1 * BODY.dx, rectangle(0.4))


def test_a_mesh_refined_after_it_was_cracked():
    """The table of cut elements belongs to the old mesh."""
    mesh = rectangle(0.4)
    body = CrackedMesh(mesh, Crack([(0, 0.51), (0.6, 0.53)]))
    V = CrackFESpace(body, order=1, tip=None)
    mesh.Refine()
    with refused("refine|changed"):
        Integrate(1 * body.dx, mesh)
    with refused("refine|changed"):
        V.Update()
        CrackFESpace(body, order=1)


def test_what_a_solution_says_on_a_mesh_that_was_refined_since():
    """NGSolve's functions are zero on the finer mesh."""
    mesh = rectangle(0.4)
    body = CrackedMesh(mesh, Crack([(0, 0.51), (0.6, 0.53)]))
    V = CrackFESpace(body, order=1, tip=None, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body), Elasticity.PlaneStrain(E=1, nu=0.3))
    problem.f += CF((0, 1)) * V.TestFunction() * body.ds("top")
    solution = problem.Solve()
    assert np.allclose(solution.Reaction("bottom"), (0, -1))
    mesh.Refine()
    for ask in (lambda: solution.u, solution.Reactions, lambda: solution.Reaction("bottom"), solution.Energy, lambda: solution.stress):
        with refused("it was refined"):
            ask()
