"""V_h of bodies in space: copies across sheets, modes at fronts; against closed forms and finite differences."""

import pickle

import numpy as np
import pytest
from netgen.occ import Box, OCCGeometry, Pnt, Y, Z
from ngsolve import BND, CF, BilinearForm, Grad, GridFunction, InnerProduct, Integrate, Mesh, sqrt, x, y, z
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, NormalGap, Plus, Strain, TraceSpace
from ngsxfem_contact._ngsxfem_contact import StressPower
from ngsxfem_contact.algebra.matrices import mask, to_scipy
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.exact.pennies import penny_in_tension, sheared_penny
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.exact.straight_fronts import straight_front
from ngsxfem_contact.geometry import FrontDemand, Sheet
from ngsxfem_contact.loads.supports import Supports
from ngsxfem_contact.spaces import FrontEnrichment, Interpolant, Projection, SolidFESpace
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
COARSE = cube_mesh(0.25)
EDGE = Sheet.Polygon([(-1, -1, 0.513), (0.47, -1, 0.513), (0.47, 2, 0.513), (-1, 2, 0.513)])
DISK = Sheet.Disk((0.48, 0.5, 0.513), (0.1, 0.2, 1), 0.3)
RING = Sheet.Ring((0.5, 0.49, 0.513), (0, 0, 1), 0.12, 0.38)


def grid(n):
    """n × n × n cubes of tetrahedra, all of the boundary with one name."""
    mesh = MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n)
    for i in range(6):
        mesh.ngmesh.SetBCName(i, "outer")
    return mesh


def random_function(V, seed=0):
    u = GridFunction(V)
    u.vec.FV().NumPy()[:] = np.random.default_rng(seed).standard_normal(V.ndof)
    return u


def solved(V, form):
    """The solution without contact for the exact displacement on the held boundary, and for no load but this."""
    supports, A = Supports(V), BilinearForm(V, symmetric=True)
    supports.SetDirichlet(form.u, "outer")
    A += StressPower(V, CF(MATERIAL.lam), CF(MATERIAL.mu), V.body.dx)
    A.Assemble()
    u = GridFunction(V)
    u.vec.data = supports.given.vec
    u.vec.data -= A.mat.Inverse(supports.free, inverse="sparsecholesky") * (A.mat * supports.given.vec).Evaluate()
    return u


def relative(error, whole, measure, mesh):
    return sqrt(Integrate(InnerProduct(error, error) * measure, mesh) / Integrate(InnerProduct(whole, whole) * measure, mesh))


def gradient_error(V, form):
    around = V.body.dx(bonus_intorder=2, fronts=FrontDemand())
    return relative(Grad(solved(V, form)) - form.gradient, form.gradient, around, V.mesh)


@pytest.mark.parametrize("order", (1, 2))
@pytest.mark.parametrize("sheet", (EDGE, DISK, RING))
def test_gradients_are_derivatives(sheet, order):
    """Of a random function, by central differences in elements, off the sheet's plane."""
    V = CrackFESpace(CrackedMesh(COARSE, sheet), order=order, material=MATERIAL)
    u, rng, h = random_function(V), np.random.default_rng(order), 1e-6
    checked = 0
    for p in rng.uniform(0.05, 0.95, (150, 3)):
        here = COARSE(*p)
        beside = [(COARSE(*(p + step)), COARSE(*(p - step))) for step in h * np.eye(3)]
        if abs(np.dot(p - sheet.origin, sheet.normal)) < 2 * h or any(at.nr != here.nr for both in beside for at in both):
            continue
        slopes = np.array([(np.array(u(a)) - np.array(u(b))) / (2 * h) for a, b in beside]).T
        gradient = np.array(Grad(u)(here)).reshape(3, 3)
        assert np.abs(slopes - gradient).max() < 1e-6 * max(1, np.abs(gradient).max())
        checked += 1
    assert checked > 100 and len(V.front_nodes) > 5


@pytest.mark.parametrize("sheet", (EDGE, DISK, RING))
def test_functions_jump_on_the_sheet_only(sheet):
    """At the middles of faces from both sides; on the sheet the jump is the difference of the limits."""
    V = CrackFESpace(body := CrackedMesh(COARSE, sheet), material=MATERIAL)
    u = random_function(V)
    for face in COARSE.faces:
        middle = np.mean([COARSE[v].point for v in face.vertices], axis=0)
        if len(face.elements) == 2:
            beside = [middle + 1e-9 * (np.mean([COARSE[v].point for v in COARSE[el].vertices], axis=0) - middle) for el in face.elements]
            assert np.abs(np.subtract(u(COARSE(*beside[0])), u(COARSE(*beside[1])))).max() < 1e-7
    difference = Jump(u) - (Plus(u) - Minus(u))
    assert Integrate(InnerProduct(difference, difference) * body.dcrack, COARSE) < 1e-28
    assert Integrate(InnerProduct(Jump(u), Jump(u)) * body.dcrack, COARSE) > 1e-5


def test_modes_of_one_sheet_do_not_jump_on_another():
    """Where an element of one sheet has nodes at the front of another, limits on its sheet are the other's modes by their position."""
    mesh = cube_mesh(0.15)
    body = CrackedMesh(mesh, Sheet.Disk((0.5, 0.5, 0.3), (0, 0.3, 1), 0.3), Sheet.Disk((0.5, 0.5, 0.75), (0, 0, 1), 0.3))
    V = CrackFESpace(body, material=MATERIAL)
    u, largest = GridFunction(V), 0.0
    for own, other in ((0, 1), (1, 0)):
        modes = [V.FrontDof(j, mode) for j, (_, front) in enumerate(V.front_nodes) if body.fronts[front].sheet == own for mode in range(3)]
        u.vec.FV().NumPy()[:] = 0
        u.vec.FV().NumPy()[modes] = np.random.default_rng(0).standard_normal(len(modes))
        on_other = body.dcrack(crack=other)
        largest = max(largest, Integrate(InnerProduct(Plus(u), Plus(u)) * on_other, mesh))
        for side in (Plus, Minus):
            assert Integrate(InnerProduct(side(u) - u, side(u) - u) * on_other, mesh) < 1e-20
        assert Integrate(InnerProduct(Jump(u), Jump(u)) * body.dcrack(crack=own), mesh) > 1e-6
    assert largest > 1e-6


def test_the_stress_power_is_that_of_the_symbolic_form():
    V = CrackFESpace(CrackedMesh(COARSE, DISK), material=MATERIAL)
    (u, v), A, B = V.TnT(), BilinearForm(V), BilinearForm(V)
    A += StressPower(V, CF(MATERIAL.lam), 1 + x * CF(MATERIAL.mu), V.body.dx)
    B += InnerProduct(MATERIAL.lam * sum(Strain(u)[i, i] for i in range(3)) * CF((1, 0, 0, 0, 1, 0, 0, 0, 1), dims=(3, 3)), Strain(v)) * V.body.dx
    B += 2 * (1 + x * CF(MATERIAL.mu)) * InnerProduct(Strain(u), Strain(v)) * V.body.dx
    A, B = (to_scipy(form.Assemble().mat) for form in (A, B))
    assert abs(A - B).max() < 1e-13 * abs(A).max()


def test_modes_of_constant_factors_are_the_closed_form():
    """In elements whose nodes all have modes, for K_I, K_II, K_III constant along a straight front."""
    form = straight_front(MATERIAL, 1.0, 0.7, -0.4).At((0.47, 0.5, 0.513))
    V = CrackFESpace(CrackedMesh(COARSE, EDGE), material=MATERIAL)
    u, nodes = Interpolant(V, CF((0, 0, 0)), fronts=[CF((1.0, 0.7, -0.4))]), {vertex for vertex, _ in V.front_nodes}
    inside = [el for el in COARSE.Elements() if nodes.issuperset(v.nr for v in el.vertices)]
    for el in inside:
        at = COARSE(*np.average([COARSE[v].point for v in el.vertices], axis=0, weights=(1, 2, 3, 4)))
        assert np.allclose(u(at), form.u(at), rtol=1e-12, atol=1e-13) and np.allclose(Grad(u)(at), form.gradient(at), rtol=1e-11, atol=1e-12)
    assert len(inside) > 5


def test_modes_turn_with_a_curved_front():
    """The jump of K_I φ v_I + ... on a disk: along n, e1 and e3, by the distance from the front."""
    V = CrackFESpace(body := CrackedMesh(COARSE, DISK), front=FrontEnrichment(radius=0.2), material=MATERIAL)
    u, nodes = Interpolant(V, CF((0, 0, 0)), fronts=[CF((1.0, 2.0, 3.0))]), {vertex for vertex, _ in V.front_nodes}
    inside = {el.nr for el in COARSE.Elements() if nodes.issuperset(v.nr for v in el.vertices)}
    elements, xi, eta, zeta, _, *places = body.dcrack.Points(1)
    kappa, mu = 2.0, MATERIAL.mu
    q, checked = 1 / (2 * mu * np.sqrt(2 * np.pi)), 0
    for i in np.flatnonzero(np.isin(elements, list(inside))):
        p = np.array([coordinate[i] for coordinate in places])
        x1, _, s = body.fronts[0].Tube(p)
        e1, e2, e3 = np.array(body.fronts[0].FrameAt(s))
        at = COARSE(*p)
        if at.nr == elements[i]:
            expected = q * np.sqrt(-x1) * (2 * (kappa + 1) * (1.0 * e2 + 2.0 * e1) + 8 * 3.0 * e3)
            assert np.allclose(Jump(u)(at), expected, rtol=1e-9)
            checked += 1
    assert checked > 3


@pytest.mark.parametrize("front", (None, FrontEnrichment()))
def test_tension_along_a_sheet_is_exact(front):
    """σ_xx alone, without traction on z = const: to round-off without modes, to the rules' defect with them."""
    V = CrackFESpace(CrackedMesh(COARSE, Sheet.Disk((0.48, 0.5, 0.513), (0, 0, 1), 0.3)), front=front, dirichlet="outer", material=MATERIAL)
    exact = CF((x / MATERIAL.E, -MATERIAL.nu * y / MATERIAL.E, -MATERIAL.nu * z / MATERIAL.E))

    class Tension:
        u = exact

    u = solved(V, Tension)
    error = relative(Grad(u) - CF(tuple(np.diag([1, -MATERIAL.nu, -MATERIAL.nu]).ravel() / MATERIAL.E), dims=(3, 3)), Grad(u), V.body.dx, V.mesh)
    assert error < 1e-12 if front is None else error < 1e-3


@pytest.mark.parametrize("factors", ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
def test_rates_at_a_straight_front(factors):
    """H¹ error of each mode: first order with modes within a fixed radius, half an order without; with those at corners alone the error is smaller."""
    form = straight_front(MATERIAL, *factors).At((0.385, 0.5, 0.61))
    sheet = Sheet.Polygon([(-1, -1, 0.61), (0.385, -1, 0.61), (0.385, 2, 0.61), (-1, 2, 0.61)])
    bodies = [CrackedMesh(grid(n), sheet) for n in (4, 12)]  # the front lies in about the same place of a cell
    kinds = {"radius": FrontEnrichment(radius=0.35), "corners": FrontEnrichment(), "none": None}
    errors = {
        kind: [gradient_error(CrackFESpace(body, front=front, dirichlet="outer", material=MATERIAL), form) for body in bodies] for kind, front in kinds.items()
    }
    rates = {kind: np.log(coarse / fine) / np.log(3) for kind, (coarse, fine) in errors.items()}
    assert 0.85 < rates["radius"] < 1.15 and 0.3 < rates["none"] < 0.65
    assert errors["radius"][1] < errors["corners"][1] < 0.5 * errors["none"][1]


SHEARED = sheared_penny(MATERIAL, 0.3) + uniform_stress(MATERIAL, stress_matrix(xz=1))


@pytest.mark.parametrize("form", (penny_in_tension(MATERIAL, 0.3), SHEARED), ids=("tension", "shear"))
def test_a_penny(form):
    """The jump on the disk falls with h, and is better than without modes."""
    form, errors = form.At((0.49, 0.51, 0.513)), []
    for maxh, front in ((0.13, FrontEnrichment()), (0.1, FrontEnrichment()), (0.1, None)):
        V = CrackFESpace(
            body := CrackedMesh(cube_mesh(maxh), Sheet.Disk((0.49, 0.51, 0.513), (0, 0, 1), 0.3)), front=front, dirichlet="outer", material=MATERIAL
        )
        on = body.dcrack(bonus_intorder=2, fronts=FrontDemand())
        errors.append(relative(Jump(solved(V, form)) - form.opening, form.opening, on, V.mesh))
    assert errors[1] < 0.25 and errors[1] < 0.5 * errors[0] and errors[1] < 0.5 * errors[2]


def test_interpolation_of_jumps():
    """A piecewise linear function that jumps at a sheet through the body is in the space; interpolant and projection find it."""
    body = CrackedMesh(COARSE, Sheet.Polygon([(-1, -1, 0.3), (2, -1, 0.4), (2, 2, 0.6), (-1, 2, 0.5)]))
    plus, minus = CF((x + y, 2 * z, 1 - x)), CF((y - z, x, 3 * y))
    V = CrackFESpace(body, material=MATERIAL)
    assert V.front_nodes == [] and V.front_spec is None
    u = Interpolant(V, plus, minus)
    for side, exact in ((Plus, plus), (Minus, minus)):
        assert Integrate((side(u) - exact) ** 2 * body.dcrack, COARSE) < 1e-26
    again = Projection(V, u)
    assert np.abs(again.vec.FV().NumPy() - u.vec.FV().NumPy()).max() < 1e-8
    assert Integrate(NormalGap(u, body) * body.dcrack, COARSE) == pytest.approx(Integrate((plus - minus) * body.normal * body.dcrack, COARSE), abs=1e-12)


def corners_of(mesh, numbers):
    elements = list(mesh.Elements())
    return {v.nr for number in numbers for v in elements[number].vertices}


def test_which_nodes_have_modes():
    """Those of the elements around a front and within the radius, not where u is held, beside corners, or between two fronts."""
    body = CrackedMesh(mesh := cube_mesh(0.12), DISK)
    nodes = lambda **arguments: {vertex for vertex, _ in CrackFESpace(body, material=MATERIAL, **arguments).front_nodes}
    around = corners_of(mesh, body.FrontElements(0))
    near = {v.nr for v in mesh.vertices if body.fronts[0].Distance(v.point) < 0.12}
    alone = nodes(front=FrontEnrichment(radius=0.12))
    assert nodes(front=FrontEnrichment(radius=0)) == nodes(order=2) == around and nodes(front=None) == set()
    assert around < alone <= around | near and around < nodes()
    square = Sheet.Polygon([(0.2, 0.2, 0.51), (0.8, 0.2, 0.51), (0.8, 0.8, 0.51), (0.2, 0.8, 0.51)])
    V = CrackFESpace(CrackedMesh(grid(9), square), material=MATERIAL)
    places = np.array([V.mesh.vertices[vertex].point for vertex, _ in V.front_nodes])
    corners = np.array([(a, b, 0.51) for a in (0.2, 0.8) for b in (0.2, 0.8)])
    assert V.num_left_out > 4 and len(places) > 20 and np.linalg.norm(places[:, None] - corners, axis=2).min() > 0.05
    with pytest.warns(AccuracyWarning, match="nodes around fronts have no modes, and the crack is held together there"):
        V = CrackFESpace(CrackedMesh(COARSE, RING), material=MATERIAL)
    assert V.num_left_out > 0 and {front for _, front in CrackFESpace(CrackedMesh(cube_mesh(0.08), RING), material=MATERIAL).front_nodes} == {0, 1}


def test_nodes_where_u_is_held():
    """Modes are fixed with the rest where all components are held; where some are held there are none."""
    body, mesh = CrackedMesh(mesh := grid(4), EDGE), mesh
    of_front = lambda V: {vertex for vertex, _ in V.front_nodes}
    outer = {v.nr for el in mesh.Elements(BND) for v in el.vertices}
    free, held, roller = (CrackFESpace(body, material=MATERIAL, **where) for where in ({}, dict(dirichlet="outer"), dict(dirichletz="outer")))
    assert of_front(free) == of_front(held) and of_front(held) & outer and of_front(roller) == of_front(free) - outer
    fixed = {vertex for j, (vertex, _) in enumerate(held.front_nodes) if not mask(held.FreeDofs())[held.FrontDof(j, 1)]}
    assert fixed == of_front(held) & outer


def test_supports_of_sheets():
    """A sheet through the body gives each function that it cuts one copy in each component; held boundaries fix both sides."""
    body = CrackedMesh(COARSE, Sheet.Polygon([(-1, -1, 0.52), (2, -1, 0.52), (2, 2, 0.52), (-1, 2, 0.52)]))
    V = CrackFESpace(body, dirichletz="outer", material=MATERIAL)
    cut = corners_of(COARSE, [cell.element for cell in body.Elements(0)])
    assert {V.Heaviside(j)[0] for j in range(V.num_heaviside)} == cut and V.ndof == 3 * (COARSE.nv + len(cut))
    fixed = ~mask(V.FreeDofs())
    assert not fixed[: 2 * COARSE.nv].any() and fixed[V.HeavisideDof(0, 2) :].any() and not V.HeldRegions(0)[0] and V.HeldRegions(2)[0]


def test_order_two():
    """Quadratic functions that jump are in the space."""
    body = CrackedMesh(COARSE, Sheet.Polygon([(-1, -1, 0.52), (2, -1, 0.52), (2, 2, 0.52), (-1, 2, 0.52)]))
    V = CrackFESpace(body, order=2, material=MATERIAL)
    plus, minus = CF((x * y, z * z, x)), CF((y * z, x * x, y))
    u = Interpolant(V, plus, minus)
    assert Integrate((Plus(u) - plus) ** 2 * body.dcrack, COARSE) < 1e-26 and Integrate((Minus(u) - minus) ** 2 * body.dcrack, COARSE) < 1e-26


def test_a_space_is_saved():
    V = CrackFESpace(CrackedMesh(COARSE, DISK), dirichlet="outer", material=MATERIAL)
    again = pickle.loads(pickle.dumps(V))
    assert type(V) is type(again) is SolidFESpace and again.ndof == V.ndof and again.front_nodes == V.front_nodes and again.material == MATERIAL
    assert again.front_spec.materials == V.front_spec.materials == [(2.0, 1.0)] and "around 1 front" in repr(V)


def test_the_material_of_the_modes():
    with pytest.warns(AccuracyWarning, match="no material is given"):
        V = CrackFESpace(CrackedMesh(COARSE, DISK))
    V.Decide(MATERIAL)
    assert V.front_spec.materials == [(2.0, 1.0)] and V.undecided == []
    with pytest.raises(ValueError, match="modes of front 0 belong to another material"):
        V.CheckModes(Elasticity.Solid(E=1, nu=0.3))


@pytest.mark.parametrize(
    "arguments, error, message",
    [
        (dict(order=3), ValueError, "order=3 is not there for bodies in space; take 1 or 2"),
        (dict(order=0), ValueError, "order=0 must be 1 or more"),
        (dict(material=Elasticity.PlaneStrain(E=1, nu=0.3)), ValueError, "is a material of the plane, and the mesh has dimension 3; take Elasticity.Solid"),
        (dict(front="modes"), TypeError, "is not a FrontEnrichment, or None for no modes"),
        (dict(tip=None), TypeError, "there is no argument 'tip'"),
        (dict(dirichlet="nowhere"), ValueError, "'nowhere' matches no boundary"),
        (dict(complex=True), ValueError, "the space is real"),
    ],
)
def test_refused_spaces(arguments, error, message):
    with pytest.raises(error, match=message):
        CrackFESpace(CrackedMesh(COARSE, DISK), **{"material": MATERIAL} | arguments)


def test_refused_enrichments():
    for radius in (-0.1, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="FrontEnrichment: radius"):
            FrontEnrichment(radius=radius)
    with pytest.raises(TypeError, match="FrontEnrichment: material"):
        FrontEnrichment(material=3)
    V = CrackFESpace(CrackedMesh(COARSE, DISK), material=MATERIAL)
    with pytest.raises(ValueError, match="2 entries for 1 fronts"):
        Interpolant(V, CF((0, 0, 0)), fronts=[CF((1, 0, 0))] * 2)
    with pytest.raises(Exception, match="there is no component 3"):
        V.HeldRegions(3)


def slab(maxh, held=None):
    """Of a third of a unit thickness between planes of symmetry, with an edge crack normal to them; held by the space, or by stiff springs."""
    box = Box(Pnt(0, 0, 0), Pnt(1, 1, 0.3))
    for face in box.faces:
        face.name = "free"
    box.faces.Min(Y).name, box.faces.Max(Y).name, box.faces.Min(Z).name, box.faces.Max(Z).name = "bottom", "top", "end", "end"
    mesh = Mesh(OCCGeometry(box).GenerateMesh(maxh=maxh))
    body = CrackedMesh(mesh, Sheet.Polygon([(-1, 0.513, -1), (-1, 0.513, 2), (0.47, 0.513, 2), (0.47, 0.513, -1)]))
    V = CrackFESpace(body, order=1, material=Elasticity.Solid(E=1, nu=0.3), dirichlet="bottom", **({"dirichletz": "end"} if held is None else {}))
    problem = ContactProblem(V, TraceSpace(body))
    u, v = V.TnT()
    if held:
        problem.a += held * u[2] * v[2] * body.ds("end")
    return problem


def test_a_front_that_ends_on_a_plane_of_symmetry():
    """Modes I and II have no component along the front there, and mode III is held: u_z = 0, as with stiff springs, and translations stay exact."""
    problem, sprung = slab(0.1), slab(0.1, 1e5)
    assert problem.V.num_left_out == sprung.V.num_left_out == 0 and len(problem.V.front_nodes) == len(sprung.V.front_nodes)
    for each in (problem, sprung):
        each.f += CF((0.2, 1, 0)) * each.V.TestFunction() * each.body.ds("top")
    held, soft = problem.Solve(), sprung.Solve()
    assert sqrt(Integrate(held.u[2] ** 2 * problem.body.ds("end"), problem.body.mesh)) < 1e-14
    assert held.Energy() == pytest.approx(soft.Energy(), rel=1e-4)
    moved = slab(0.1)
    moved.SetDirichlet((0, 0, 0.1), "bottom")
    moved.SetDirichlet((None, None, 0.1), "end")
    u = moved.Solve().u - CF((0, 0, 0.1))
    assert Integrate(InnerProduct(u, u) * moved.body.dx, moved.body.mesh) < 1e-24
