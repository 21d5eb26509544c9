"""What is built on a body does not change it, integrals find their rules, numbering decides nothing, and a mesh that has changed is refused."""

import numpy as np
import pytest
from helpers import matrix, random_function, rectangle
from netgen.geom2d import SplineGeometry
from netgen.meshing import Element1D, Element2D, FaceDescriptor, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import CF, BilinearForm, Grad, GridFunction, InnerProduct, Integrate, LinearForm, Mesh, VectorH1, ds, sqrt, x, y

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, Strain, TipEnrichment, TraceSpace
from ngsxfem_contact.spaces import Interpolant

MATERIAL = Elasticity.PlaneStrain(E=1e3, nu=0.3)
TIP = (0.53, 0.41)


def edge_crack_body(maxh=0.2):
    return CrackedMesh(rectangle(maxh), Crack([(0, 0.4), TIP]))


def space(body, **options):
    return CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL, **options))


def entries(V):
    u, v = V.TnT()
    return matrix(InnerProduct(MATERIAL.Stress(Strain(u)), Strain(v)) * V.body.dx).data


# Rules


def test_spaces_do_not_change_what_was_there():
    body = edge_crack_body()
    V, f = space(body), 1 / sqrt(sqrt((x - TIP[0]) ** 2 + (y - TIP[1]) ** 2))
    state = lambda: (entries(V), Integrate(f * body.dx, body.mesh), [np.array(p) for p in (*body.dx.Points(4), *body.dcrack.Points(4), *body.dx.Points(4, V))])
    matrix, integral, points = state()
    others = [space(body, r1=r1, tolerance=tolerance) for r1, tolerance in ((0.1, 1e-12), (0.3, 1e-3))] + [CrackFESpace(body, order=1, tip=None)]
    for other in others:
        entries(other)
    with pytest.raises(Exception, match="r1"):
        space(body, r1=0.9)
    del others, other
    matrix2, integral2, points2 = state()
    assert np.array_equal(matrix, matrix2) and integral == integral2
    assert all(np.array_equal(a, b) for a, b in zip(points, points2))


def test_a_space_gives_the_same_on_a_body_that_others_used():
    fresh, used = edge_crack_body(), edge_crack_body()
    entries(space(used, r1=0.15, tolerance=1e-12))
    assert np.array_equal(entries(space(fresh)), entries(space(used)))


@pytest.mark.parametrize("integrand", [
    lambda u: InnerProduct(Grad(u), Grad(u)), lambda u: InnerProduct(MATERIAL.Stress(Strain(u)), Strain(u)).Compile(), lambda u: u[0] * u.Operator("larger")[1],
])  # fmt: skip
@pytest.mark.parametrize("measure", ["dx", "dcrack", "dlarger"])
def test_an_integral_takes_the_rules_of_the_functions_in_it(measure, integrand):
    """It is the sum over the points for their space, and not that over those for none."""
    body = edge_crack_body()
    u = random_function(space(body, r1=0.3))
    f = integrand(u)
    u.vec.FV().NumPy()[list(u.space.TipDofs(0))] = 50
    symbol = getattr(body, measure)
    sums = []
    for V in (u.space, None):
        element, xi, eta, weight, *_ = symbol.Points(5, space=V)
        points = np.repeat(body.mesh(np.array([0.2]), np.array([0.2])), len(element))
        points["nr"], points["x"], points["y"] = element, xi, eta
        sums.append(float(weight @ f(points).ravel()))
    found = Integrate(f * symbol, body.mesh)
    assert found == pytest.approx(sums[0], rel=1e-11)
    assert abs(found / sums[1] - 1) > 1e-8


def test_two_spaces_in_one_integral():
    """The rules serve the tips of both, in either order."""
    body = CrackedMesh(rectangle(0.2), Crack([(0.3, 0.5), (0.7, 0.52)]))
    enrichment = TipEnrichment(material=MATERIAL, r1=0.15)
    left, right = (CrackFESpace(body, order=1, tip=[enrichment if i == k else None for i in (0, 1)]) for k in (0, 1))
    u, w, both = random_function(left), random_function(right), CrackFESpace(body, order=1, tip=enrichment)
    found = [Integrate(InnerProduct(a, b) * body.dx, body.mesh) for a, b in ((u, w), (w, u))]
    assert found[0] == found[1] == Integrate(InnerProduct(u, w) * body.dx(space=both), body.mesh)
    assert found[0] != Integrate(InnerProduct(u, u) * body.dx, body.mesh)


def test_a_measure_for_a_space_integrates_a_given_singular_function():
    """∫1/r by its closed form: the tip divides the square into four rectangles."""
    body = edge_crack_body()
    exact = sum(a * np.arcsinh(b / a) + b * np.arcsinh(a / b) for a in (TIP[0], 1 - TIP[0]) for b in (TIP[1], 1 - TIP[1]))
    inverse_r = 1 / sqrt((x - TIP[0]) ** 2 + (y - TIP[1]) ** 2)
    assert Integrate(inverse_r * body.dx(space=space(body), bonus_intorder=10), body.mesh) == pytest.approx(exact, rel=1e-8)
    assert abs(Integrate(inverse_r * body.dx(bonus_intorder=10), body.mesh) / exact - 1) > 1e-4


# Numbering


def renumbered(n, seed=None):
    """The unit square in n × n squares, each cut along the same diagonal; points, elements and their corners in random order."""
    rng = np.random.default_rng(seed)
    order = (lambda m: np.arange(m)) if seed is None else rng.permutation
    places, mesh = order((n + 1) ** 2), NetgenMesh(dim=2)
    ids = [None] * (n + 1) ** 2
    for place in places:
        ids[place] = mesh.Add(MeshPoint(Pnt(place % (n + 1) / n, place // (n + 1) / n, 0)))
    mesh.SetMaterial(mesh.Add(FaceDescriptor(bc=1, domin=1, surfnr=1)), "body")
    at = lambda i, j: ids[j * (n + 1) + i]
    triangles = [t for i in range(n) for j in range(n) for t in ((at(i, j), at(i + 1, j), at(i, j + 1)), (at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))]
    for k in order(len(triangles)):
        turn = 0 if seed is None else int(rng.integers(3))
        mesh.Add(Element2D(1, [*triangles[k][turn:], *triangles[k][:turn]]))
    sides = {
        "bottom": lambda k: (at(k, 0), at(k + 1, 0)), "right": lambda k: (at(n, k), at(n, k + 1)),
        "top": lambda k: (at(k + 1, n), at(k, n)), "left": lambda k: (at(0, k + 1), at(0, k)),
    }  # fmt: skip
    for index, (name, ends) in enumerate(sides.items(), 1):
        for k in order(n):
            mesh.Add(Element1D(list(ends(k)), index=index))
        mesh.SetBCName(index - 1, name)
    return Mesh(mesh)


@pytest.mark.parametrize("points", [
    [(0, 0.5), (0.5, 0.5)], [(0.5, 0.5), (0, 0.5)], [(0, 0.5), (0.25, 0.5), (0.5, 0.25)], [(0, 1 / 16), (9 / 16, 10 / 16)],
], ids=["on edges", "backwards", "kinked", "through the middle of edges"])  # fmt: skip
def test_numbers_decide_nothing(points):
    """Energy and multiplier on meshes that differ in the order of points, elements and corners only."""
    results = []
    for seed in (None, 1, 2):
        body = CrackedMesh(renumbered(8, seed), Crack(points))
        V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL), dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body, order=1), MATERIAL)
        problem.f += CF((0, 100 * (x - 0.3))) * V.TestFunction() * body.ds("top")
        solution = problem.Solve()
        results.append((solution.Energy(), solution.multiplier.vec.FV().NumPy().copy(), solution.Profile(n=9).sigma_n))
    for energy, multiplier, pressure in results[1:]:
        assert energy == pytest.approx(results[0][0], rel=1e-10)
        assert np.abs(multiplier - results[0][1]).max() < 1e-9 * np.abs(multiplier).max()
        assert np.abs(pressure - results[0][2]).max() < 1e-9 * np.abs(multiplier).max()


# A mesh that changes


def deform(mesh):
    shift = GridFunction(VectorH1(mesh, order=1))
    shift.Set((0.2 * x, 0))
    mesh.SetDeformation(shift)


CHANGES = {"refined": lambda mesh: mesh.Refine(), "curved": lambda mesh: mesh.Curve(2), "SetDeformation": deform}


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_mesh_is_refused_by_all_that_was_built(change):
    mesh = rectangle(0.3)
    body = CrackedMesh(mesh, Crack([(0, 0.4), TIP]))
    V, W = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL), dirichlet="bottom"), TraceSpace(body, order=1)
    problem, (u, v) = ContactProblem(V, W, MATERIAL), V.TnT()
    problem.f += CF((0, 100)) * v * body.ds("top")
    solution = problem.Solve()
    stiffness, load = BilinearForm(u * v * body.dx), LinearForm(CF((0, 1)) * v * body.ds)
    CHANGES[change](mesh)
    uses = [
        stiffness.Assemble, load.Assemble, V.Update, W.Update, solution.Energy, solution.ContactForce, solution.StressIntensity, problem.Solve,
        lambda: solution.Profile(n=5), lambda: problem.SetDirichlet((0, 0), "bottom"), lambda: Interpolant(V, CF((x, y))),
        lambda: Integrate(1 * body.dx, mesh), lambda: Integrate(1 * body.ds("top"), mesh), lambda: Integrate(solution.u[0] * body.dcrack, mesh),
        lambda: body.Elements(0), lambda: body.OnCrack(0, [0.1]), lambda: CrackFESpace(body, order=1, tip=None), lambda: TraceSpace(body), lambda: space(body),
    ]  # fmt: skip
    if change != "refined":  # NGSolve itself makes a GridFunction zero that was not updated after a refinement
        uses += [lambda: solution.u(mesh(0.2, 0.3)), lambda: solution.multiplier(mesh(0.2, 0.404)), lambda: Integrate(solution.u[0] * ds, mesh)]
    for use in uses:
        with pytest.raises(Exception, match=f"the mesh has changed .*{change}.*build a new CrackedMesh"):
            use()


def test_a_moved_mesh_is_refused_and_fine_again_without_its_deformation():
    mesh = rectangle(0.4)
    body = CrackedMesh(mesh, Crack([(0, 0.4), TIP]))
    before = Integrate(1 * body.dcrack, mesh)
    deform(mesh)
    with pytest.raises(Exception, match="CrackedMesh: the mesh is moved by SetDeformation"):
        CrackedMesh(mesh, Crack([(0, 0.4), TIP]))
    mesh.UnsetDeformation()
    assert Integrate(1 * body.dcrack, mesh) == before


def curved_square(*steps):
    """A square with a round hole; "refine", or the order of curved elements, one after the other."""
    geometry = SplineGeometry()
    geometry.AddRectangle((-1, -1), (1, 1), bcs=["bottom", "right", "top", "left"])
    geometry.AddCircle((0, 0), 0.3, leftdomain=0, rightdomain=1, bc="hole")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4))
    for step in steps:
        mesh.Refine() if step == "refine" else mesh.Curve(step)
    return mesh


def test_a_mesh_that_was_refined_after_it_was_curved():
    """NGSolve: the area is that of a polygon, the boundary round; curved again, both are round."""
    crack = Crack([(0.2, 0), (0.7, 0)])
    with pytest.raises(ValueError, match=r"refined after mesh.Curve\(2\), which leaves its triangles straight.*call mesh.Curve\(2\) again"):
        CrackedMesh(curved_square(2, "refine"), crack)
    for steps in ((2, "refine", 2), ("refine", 3), ("refine",), (3,), (2, "refine", 1)):
        CrackedMesh(curved_square(*steps), crack)
