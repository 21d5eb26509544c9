"""Elements that several cracks meet: their parts and rules, exact solutions, what is refused."""

import sys
from pathlib import Path

import numpy as np
import pytest
from helpers import on_crack, random_function, rectangle, structured
from ngsolve import CF, InnerProduct, Integrate, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import BarbosaHughes, Coercivity, ContactProblem, Coulomb, Nitsche
from ngsxfem_contact.plotting.split_mesh import SplitMesh
from study.paper import PAIRS

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
import several  # noqa: E402

MATERIAL = Elasticity(lam=1, mu=1)
MESH = rectangle(0.25)
COARSE = structured(4)
CRACKS = {
    "two through": (MESH, [Crack([(0, 0.41), (1, 0.47)]), Crack([(0, 0.45), (1, 0.54)])]),
    "two through, one backwards": (MESH, [Crack([(1, 0.47), (0, 0.41)]), Crack([(0, 0.45), (1, 0.54)])]),
    "three": (MESH, [Crack([(0, 0.41), (1, 0.47)]), Crack([(0, 0.45), (1, 0.54)]), Crack([(0.3, 0.53), (0.8, 0.59)])]),
    "a tip beside a crack": (MESH, [Crack([(0, 0.41), (1, 0.47)]), Crack([(0.2, 0.8), (0.52, 0.49)])]),
    "tips face each other": (MESH, [Crack([(0, 0.5), (0.48, 0.5)]), Crack([(0.53, 0.51), (1, 0.5)])]),
    "two arcs": (MESH, [Crack.Arc((0, 0.41), (0.5, 0.47), (1, 0.42)), Crack.Arc((0.1, 0.48), (0.5, 0.53), (0.9, 0.5))]),
    "an arc and a kinked crack": (MESH, [Crack.Arc((0, 0.31), (0.5, 0.47), (1, 0.36)), Crack([(0.2, 0.47), (0.5, 0.54), (0.8, 0.5)])]),
    "along edges, between two others": (COARSE, [Crack([(1, 0.5), (0, 0.5)]), Crack([(0, 0.43), (1, 0.45)]), Crack([(0, 0.56), (1, 0.55)])]),
    "both mouths on one edge": (COARSE, [Crack([(0, 0.32), (0.6, 0.32)]), Crack([(0, 0.41), (0.6, 0.44)])]),
}


@pytest.fixture(params=CRACKS)
def body(request):
    mesh, cracks = CRACKS[request.param]
    body = CrackedMesh(mesh, *cracks)
    assert any(len(body.CracksOf(element)) > 1 for element in range(mesh.ne))
    return body


def sides(body, point):
    return [crack.SideOf(point) for crack in body.cracks]


def test_rules_see_every_side(body):
    """∫ of a polynomial times any product of sides: the sum over all is that over the body, and the points lie where they say."""
    total = Integrate(x**3 * y**2 * body.dx, body.mesh)
    assert total == pytest.approx(1 / 12, rel=1e-12)
    if body.tips:
        return  # the straight extension beyond a tip, where the side changes, is not resolved
    H = [0.5 * (1 + crack.side) for crack in body.cracks[:2]]
    parts = [Integrate(a * b * x * y * body.dx, body.mesh) for a in (H[0], 1 - H[0]) for b in (H[1], 1 - H[1])]
    fine = body.mesh.__class__(body.mesh.ngmesh.Copy())
    for _ in range(2):
        fine.Refine()
    finer = CrackedMesh(fine, *body.cracks)
    for part, (a, b) in zip(parts, [(i, j) for i in (H[0], 1 - H[0]) for j in (H[1], 1 - H[1])]):
        assert part == pytest.approx(Integrate(a * b * x * y * finer.dx, fine), abs=1e-11)


def test_parts_lie_on_their_sides(body):
    for element in range(body.mesh.ne):
        for part in body.Parts(element):
            assert part.part < len(body.PartSizes(element))


def test_lengths(body):
    for c, crack in enumerate(body.cracks):
        assert Integrate(CF(1) * body.dcrack(crack=c), body.mesh) == pytest.approx(crack.length, rel=1e-10)
    assert Integrate(CF(1) * body.dcrack, body.mesh) == pytest.approx(sum(crack.length for crack in body.cracks), rel=1e-10)


@pytest.mark.parametrize("order", [1, 2])
def test_limits_are_those_of_the_own_crack(body, order):
    """Plus and Minus are limits of the function itself, from either side of the crack that the point lies on."""
    u = random_function(CrackFESpace(body, order=order, tip=None))
    for c, crack in enumerate(body.cracks):
        s = np.linspace(0.03, 0.97, 23) * crack.length
        points = on_crack(body, s, c)
        for limit, sign in ((Plus(u), 1), (Minus(u), -1)):
            t = np.array([crack.TangentAt(a) for a in s])
            beside = lambda d: u(body.mesh(*(np.array([crack.PointAt(a) for a in s]) + sign * d * np.column_stack([-t[:, 1], t[:, 0]])).T))
            d = 5e-6  # NGSolve finds points in elements to 1e-6
            assert limit(points) == pytest.approx(2 * beside(d) - beside(2 * d), abs=2e-5)
        assert Jump(u)(points) == pytest.approx(Plus(u)(points) - Minus(u)(points), abs=1e-13)


def test_vectorised_and_scalar_evaluation_agree(body):
    """Integrals over the cracks (SIMD) against sums over the points of their rules (one by one)."""
    u = random_function(CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL)))
    for c in range(len(body.cracks)):
        dcrack = body.dcrack(crack=c)
        element, xi, eta, weight, px, py = dcrack.Points(5, u.space)
        points = np.repeat(body.mesh(0.5 + 0 * px[:1], 0.5 + 0 * px[:1]), len(px))
        points["nr"], points["x"], points["y"] = element, xi, eta
        for f in (InnerProduct(Jump(u), body.normal), InnerProduct(Plus(u), body.tangent), u.Operator("gradlarger")[0, 1]):
            assert Integrate(f * dcrack, body.mesh) == pytest.approx(float(weight @ f(points).ravel()), rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("pair", [(1, 0), (1, 1), (2, 1)], ids=["P1/P0", "P1/P1", "P2/P1"])
@pytest.mark.parametrize("stabilisation", [BarbosaHughes(), Nitsche()], ids=["multiplier", "Nitsche"])
def test_uniform_pressure(body, pair, stabilisation):
    """σ = -p I: u is linear, λ = -p on every crack and no gap, to round-off.

    Tip functions take part where their rules are exact to that: not at Nitsche's few points, nor beside the curve of another crack.
    """
    p = 0.7
    curved = any(kind != "segment" for crack in body.cracks for kind, _ in crack.pieces)
    tip = None if curved or isinstance(stabilisation, Nitsche) else TipEnrichment(material=MATERIAL, tolerance=1e-10)
    V = CrackFESpace(body, order=pair[0], tip=tip, dirichlet=".*")
    problem = ContactProblem(V, TraceSpace(body, order=pair[1]), MATERIAL, stabilisation=stabilisation)
    problem.SetDirichlet(-p / (2 * (MATERIAL.lam + MATERIAL.mu)) * CF((x, y)), ".*")
    solution = problem.Solve()
    for c in range(len(body.cracks)):
        profile = solution.Profile(crack=c, n=40)
        assert profile.sigma_n == pytest.approx(np.full(40, -p), abs=1e-7)
        assert np.abs(profile.gap).max() < 1e-9 and np.abs(profile.slip).max() < 1e-8


@pytest.mark.parametrize("order", [1, 2])
def test_the_stabilised_form_is_coercive(body, order):
    """Larger parts that two cracks share are used by halves."""
    V = CrackFESpace(body, order=order, tip=TipEnrichment(material=MATERIAL), dirichlet=".*")
    assert Coercivity(ContactProblem(V, TraceSpace(body, order=1), MATERIAL)) >= 0.5


def pressed(mesh, cracks, pair, **options):
    """A block between two plates; the upper one is tilted, so that the cracks slip and open in parts."""
    body = CrackedMesh(mesh, *cracks)
    V = CrackFESpace(body, order=pair[0], tip=TipEnrichment(material=MATERIAL), dirichlet="bottom|top|left|right")
    problem = ContactProblem(V, TraceSpace(body, order=pair[1]), MATERIAL, **options)
    problem.SetDirichlet(CF((0.02 * y * (1 - y), -0.01 * y + 0.03 * y * x * (1 - x) * (x - 0.3))), "bottom|top|left|right")
    return problem.Solve()


@pytest.mark.parametrize("options", [{}, {"law": Coulomb(0.3)}, {"stabilisation": Nitsche(0)}], ids=["contact", "friction", "Nitsche"])
def test_the_answer_is_that_of_a_mesh_that_keeps_the_cracks_apart(options):
    """Energy and forces against a mesh whose elements are smaller than the distance of the cracks."""
    cracks = [Crack([(0, 0.43), (0.7, 0.46)]), Crack([(0.2, 0.505), (1, 0.53)])]
    coarse, fine = (pressed(rectangle(maxh), cracks, (2, 1), **options) for maxh in (0.12, 0.025))
    shared = lambda body: sum(len(body.CracksOf(element)) > 1 for element in range(body.mesh.ne))
    assert shared(coarse.body) >= 5 and shared(fine.body) == 0
    assert coarse.Energy() == pytest.approx(fine.Energy(), rel=2e-3)
    for c in range(2):
        assert coarse.ContactForce(c) == pytest.approx(fine.ContactForce(c), rel=0.03)


@pytest.mark.parametrize("seed", [6, 18, 22, 28, 38, 51])
def test_random_cracks_in_shared_elements(seed):
    body = several.random_body(seed)
    assert several.num_shared(body)
    contact = several.problem(body, list(PAIRS)[seed % len(PAIRS)], seed)
    assert contact.Solve().report.converged and Coercivity(contact) >= 0.5


def test_both_bases_of_traces_give_the_same_answer():
    cracks = [Crack([(0, 0.43), (0.7, 0.46)]), Crack([(0.2, 0.505), (1, 0.53)])]
    body = CrackedMesh(rectangle(0.12), *cracks)
    bases = [TraceSpace(body, order=1, basis=basis) for basis in ("nodal", "trace")]
    assert bases[0].ndof == bases[1].ndof
    V = CrackFESpace(body, order=2, tip=None, dirichlet=".*")
    forces = []
    for W in bases:
        problem = ContactProblem(V, W, MATERIAL)
        problem.SetDirichlet(CF((0, -0.01 * y)), ".*")
        forces.append([problem.Solve().ContactForce(c) for c in range(2)])
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)


def test_pictures_show_every_crack_open(body):
    """Both lips of each crack, along all of it, with the limits of a function that opens each by its own amount."""
    split = SplitMesh(body)
    for c, crack in enumerate(body.cracks):
        for side in (1, -1):
            lips = split.points[split.lips[(split.lip_crack == c) & (split.lip_side == side)]]
            length = np.hypot(*(lips[:, 1] - lips[:, 0]).T).sum()
            assert length == pytest.approx(crack.length, rel=1e-3)
    u = random_function(CrackFESpace(body, order=1, tip=None))
    shown = split.Evaluate(Plus(u), Minus(u), u)
    centres = split.points[split.triangles].mean(axis=1)
    assert shown[split.triangles].mean(axis=1) == pytest.approx(u(body.mesh(*centres.T)), abs=1e-3)
