"""body.dx, ds, dcrack and dlarger in forms, integrals and variations."""

import ngsolve
import numpy as np
import pytest
from helpers import array, matrix, random_function, rectangle, side_areas, structured, threads, vector
from ngsolve import CF, H1, BilinearForm, BitArray, Grad, InnerProduct, Integrate, LinearForm, Mesh, ds, dx, sin, x, y  # fmt: skip

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Jump, TipEnrichment, TraceSpace, Variation
from ngsxfem_contact.geometry import Side

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = rectangle(0.2)
BODY = CrackedMesh(MESH, Crack([(0, 0.32), (0.6, 0.35)]), Crack([(1, 0.71), (0.3, 0.73)]))
V = CrackFESpace(BODY, order=2, tip=TipEnrichment(r0=0.02, r1=0.12, tolerance=1e-10))
LENGTHS = [crack.length for crack in BODY.cracks]


def test_without_jumps_they_are_the_measures_of_the_body():
    f = sin(x) * y**2
    assert Integrate(f * BODY.dx, MESH) == pytest.approx(Integrate(f * dx, MESH), rel=1e-7)
    assert Integrate(f * BODY.ds, MESH) == pytest.approx(Integrate(f * ds, MESH), rel=1e-7)


def test_regions_of_the_boundary():
    for name, length in (("left", 1), ("left|right", 2), (".*", 4)):
        assert Integrate(1 * BODY.ds(name), MESH) == pytest.approx(length, rel=1e-14)
        assert Integrate(1 * BODY.ds(MESH.Boundaries(name)), MESH) == pytest.approx(length, rel=1e-14)


def test_regions_of_the_volume():
    assert Integrate(1 * BODY.dx(MESH.GetMaterials()[0]), MESH) == pytest.approx(1, rel=1e-13)
    assert Integrate(1 * BODY.dx(MESH.Materials(".*")), MESH) == pytest.approx(1, rel=1e-13)


def test_each_crack_and_all():
    assert Integrate(1 * BODY.dcrack, MESH) == pytest.approx(sum(LENGTHS), rel=1e-13)
    for i, length in enumerate(LENGTHS):
        assert Integrate(1 * BODY.dcrack(crack=i), MESH) == pytest.approx(length, rel=1e-13)
        assert Integrate(y * BODY.dcrack(crack=i), MESH) == pytest.approx(length * (0.335, 0.72)[i], rel=1e-13)


@pytest.mark.parametrize("name", ["dx", "ds", "dcrack", "dlarger"])
def test_calls_keep_the_cut_rule(name):
    """NGSolve's own __call__ would return a symbol without it."""
    symbol = getattr(BODY, name)
    for restricted in (symbol(bonus_intorder=2), symbol(definedonelements=None), *([symbol("left")] if name == "ds" else [])):
        assert type(restricted) is type(symbol)
    assert Integrate(1 * symbol(bonus_intorder=3), MESH) == pytest.approx(Integrate(1 * symbol, MESH), rel=1e-12)


@pytest.mark.parametrize("name", ["dx", "ds", "dcrack", "dlarger"])
def test_scaling(name):
    symbol = getattr(BODY, name)
    assert Integrate(2 * symbol, MESH) == pytest.approx(2 * Integrate(CF(1) * symbol, MESH), rel=1e-14)
    v = V.TestFunction()
    assert vector(3 * (v[0] * symbol)) == pytest.approx(3 * vector(v[0] * symbol), abs=1e-14)


@pytest.mark.parametrize("name", ["dx", "dcrack", "dlarger"])
def test_restriction_to_elements_only_ever_takes_away(name):
    symbol, everywhere = getattr(BODY, name), BitArray(MESH.ne)
    everywhere.Set()
    assert Integrate(1 * symbol(definedonelements=everywhere), MESH) == pytest.approx(Integrate(1 * symbol, MESH), rel=1e-13)
    some = BitArray(MESH.ne)
    some.Clear()
    for place in BODY.Elements(1):
        some.Set(place.element)
    parts = Integrate(1 * symbol, MESH, element_wise=True)
    expected = sum(parts[i] for i in range(MESH.ne) if some[i])
    assert Integrate(1 * symbol(definedonelements=some), MESH) == pytest.approx(expected, rel=1e-13)
    v = V.TestFunction()
    assert vector(v[0] * symbol(definedonelements=everywhere)) == pytest.approx(vector(v[0] * symbol), abs=1e-14)


def test_crack_and_elements_together():
    everywhere = BitArray(MESH.ne)
    everywhere.Set()
    for i, length in enumerate(LENGTHS):
        assert Integrate(1 * BODY.dcrack(crack=i, definedonelements=everywhere), MESH) == pytest.approx(length, rel=1e-13)


def test_element_wise_integrals_are_parts_of_the_whole():
    for symbol in (BODY.dx, BODY.dcrack, BODY.ds("left")):
        values = Integrate((1 + x * y) * symbol, MESH, element_wise=True)
        assert sum(values) == pytest.approx(Integrate((1 + x * y) * symbol, MESH), rel=1e-13)
    lengths = Integrate(1 * BODY.dcrack(crack=0), MESH, element_wise=True)
    carrying = {place.element for place in BODY.Elements(0)}
    assert {i for i in range(MESH.ne) if lengths[i] > 0} == carrying


def test_the_larger_part():
    areas = Integrate(1 * BODY.dlarger, MESH, element_wise=True)
    for crack in range(2):
        for place in BODY.Elements(crack):
            plus, minus = side_areas(BODY, place, crack)
            assert areas[place.element] == pytest.approx(max(plus, minus), rel=1e-12)
            assert {facet.larger for facet in BODY.Facets(place.element)} == {Side.Plus if plus >= minus else Side.Minus}


def test_other_spaces_of_ngsolve_may_use_the_measures():
    """∫φ_iφ_j of H1 with the cut rules is NGSolve's, and traces of H1 on a crack are polynomials."""
    u, v = H1(MESH, order=3).TnT()
    assert abs(matrix(u * v * BODY.dx) - matrix(u * v * dx)).max() < 1e-14
    assert matrix(u * v * BODY.dcrack).sum() == pytest.approx(matrix(u * v * BODY.dcrack(bonus_intorder=4)).sum(), rel=1e-13)


def test_products_of_spaces():
    """A form on V × W has the blocks that the forms on V and W have."""
    W = TraceSpace(BODY, order=1)
    (u, lam), (v, mu) = (V * W).TnT()
    whole = matrix(InnerProduct(Grad(u), Grad(v)) * BODY.dx + lam * mu * BODY.dcrack)
    a, b = V.TnT()
    l, m = W.TnT()
    assert abs(whole[: V.ndof, : V.ndof] - matrix(InnerProduct(Grad(a), Grad(b)) * BODY.dx)).max() < 1e-10
    assert abs(whole[V.ndof :, V.ndof :] - matrix(l * m * BODY.dcrack)).max() < 1e-15


def energies(u):
    yield 0.25 * InnerProduct(u, u) ** 2 * BODY.dx(bonus_intorder=6)
    yield 0.5 * InnerProduct(Grad(u), Grad(u)) * BODY.dx
    yield 0.25 * InnerProduct(Jump(u), Jump(u)) ** 2 * BODY.dcrack(bonus_intorder=6)
    yield 0.5 * InnerProduct(u, u) * BODY.ds("left")


@pytest.mark.parametrize("number", range(4))
def test_variation(number):
    """The energy, its derivative and its second derivative against integrals and central differences."""
    w, direction = random_function(V, 1), random_function(V, 2)
    energy = lambda f: Integrate(list(energies(f))[number], MESH)
    form = BilinearForm(V)
    form += Variation(list(energies(V.TrialFunction()))[number])
    assert form.Energy(w.vec) == pytest.approx(energy(w), rel=1e-7)
    step, gradients = 1e-4, []
    for sign in (1, -1):
        moved = random_function(V, 1)
        moved.vec.data += sign * step * direction.vec
        gradients.append((energy(moved), array_of_application(form, moved)))
    slope = (gradients[0][0] - gradients[1][0]) / (2 * step)
    assert array_of_application(form, w) @ array(direction.vec) == pytest.approx(slope, rel=1e-5)
    form.AssembleLinearization(w.vec)
    second = (gradients[0][1] - gradients[1][1]) / (2 * step)
    assert array((form.mat * direction.vec).Evaluate()) == pytest.approx(second, abs=1e-5 * np.abs(second).max())


def array_of_application(form, w):
    result = w.vec.CreateVector()
    form.Apply(w.vec, result)
    return array(result)


def test_nonlinear_forms():
    """Apply and linearisation of ∫|u|² u·v by central differences."""
    u, v = V.TnT()
    form = BilinearForm(InnerProduct(u, u) * InnerProduct(u, v) * BODY.dx(bonus_intorder=4), symmetric=False)
    w, direction, step = random_function(V, 1), random_function(V, 2), 1e-5
    form.AssembleLinearization(w.vec)
    applied = []
    for sign in (1, -1):
        moved = random_function(V, 1)
        moved.vec.data += sign * step * direction.vec
        applied.append(array_of_application(form, moved))
    expected = (applied[0] - applied[1]) / (2 * step)
    assert array((form.mat * direction.vec).Evaluate()) == pytest.approx(expected, abs=1e-8 * np.abs(expected).max() + 1e-9)


def test_threads_integrate_alike():
    alone = Integrate(sin(9 * x) * y * BODY.dx, MESH), Integrate(sin(9 * x) * BODY.dcrack, MESH)
    with threads():
        assert Integrate(sin(9 * x) * y * BODY.dx, MESH) == pytest.approx(alone[0], rel=1e-13)
        assert Integrate(sin(9 * x) * BODY.dcrack, MESH) == pytest.approx(alone[1], rel=1e-13)


def test_a_crack_that_crosses_an_interface_cuts_it():
    """∫ over an inner boundary of a function that jumps, against its values on a fine grid."""
    from netgen.occ import Glue, MoveTo, OCCGeometry, Rectangle

    shape = Glue([Rectangle(0.5, 1).Face(), MoveTo(0.5, 0).Rectangle(0.5, 1).Face()])
    for edge in shape.edges:
        edge.name = "interface" if abs(edge.center.x - 0.5) < 1e-9 else "outer"
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.25))
    body = CrackedMesh(mesh, Crack([(0.1, 0.42), (0.8, 0.46)]))
    space = CrackFESpace(body, order=1, tip=None)
    u = random_function(space)
    fine = (np.arange(2000) + 0.5) / 2000
    expected = np.mean([u(mesh(0.5 - 1e-10, s)) for s in fine], axis=0)  # error ½ |jump| / 2000 at most
    assert Integrate(u[0] * body.ds("interface"), mesh) == pytest.approx(expected[0], abs=1e-3)
    load = LinearForm(CF((1, 0)) * space.TestFunction() * body.ds("interface")).Assemble()
    assert array(load.vec) @ array(u.vec) == pytest.approx(expected[0], abs=1e-3)


@pytest.mark.parametrize("n", [2, 5])
def test_aligned_cracks_have_their_length_once(n):
    mesh = structured(2 * n)
    body = CrackedMesh(mesh, Crack([(0, 0.5), (1, 0.5)]))
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(1, rel=1e-13)
    assert Integrate(1 * body.dx, mesh) == pytest.approx(1, rel=1e-13)


def test_names_of_this_package_do_not_hide_those_of_ngsolve():
    import ngsxfem_contact

    public = {name for name in vars(ngsxfem_contact) if not name.startswith("_")}
    assert "dx" not in public and ngsolve.dx is dx


def voxels():
    """1 + 2x + 3y from values at points, which NGSolve evaluates at single points only."""
    ramp = [[1 + 2 * a + 3 * b for a in np.linspace(0, 1, 3)] for b in np.linspace(0, 1, 3)]
    return ngsolve.VoxelCoefficient((0, 0), (1, 1), np.array(ramp), linear=True)


def test_coefficients_without_simd():
    """In integrals, linear and bilinear forms over every measure, as the same function in closed form."""
    u, v = V.TnT()
    p, q = TraceSpace(BODY, order=1).TnT()
    for measure in (BODY.dx, BODY.ds, BODY.dcrack, BODY.dlarger):
        found, expected = (Integrate(f * measure, MESH) for f in (voxels(), 1 + 2 * x + 3 * y))
        assert found == pytest.approx(expected, rel=1e-12)
    for make in (
        lambda f: LinearForm(f * v[1] * BODY.dx),
        lambda f: LinearForm(f * Jump(v)[0] * BODY.dcrack),
        lambda f: LinearForm(f * q * BODY.dcrack),
        lambda f: BilinearForm(f * InnerProduct(Grad(u), Grad(v)) * BODY.dx),
        lambda f: BilinearForm(f * p * q * BODY.dcrack),
        lambda f: BilinearForm(f * Jump(u)[1] * q * BODY.dcrack),
    ):
        found, expected = (make(f).Assemble() for f in (voxels(), 1 + 2 * x + 3 * y))
        found, expected = (np.array(a.vec if isinstance(a, LinearForm) else a.mat.AsVector()) for a in (found, expected))
        assert np.abs(expected).max() > 1e-3
        assert found == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


def test_rules_of_many_points_in_linear_forms():
    """50,000 points in an element, and a function of 80 steps: as the integral, and as from values at points."""
    mesh = rectangle(0.5)
    body = CrackedMesh(mesh, Crack([(0, 0.52), (0.51, 0.52)]))
    measure = body.dx(space=CrackFESpace(body, order=1, tip=TipEnrichment(r1=0.3, tolerance=1e-12, functions="branch")), bonus_intorder=60)
    assert np.bincount(measure.Points(62)[0]).max() > 40_000
    f = x
    for _ in range(80):
        f = x + y * f
    test = ngsolve.L2(mesh, order=0).TestFunction()
    assert vector(f * test * measure).sum() == pytest.approx(Integrate(f * measure, mesh), rel=1e-11)
    assert vector(voxels() * test * measure).sum() == pytest.approx(3.5, rel=1e-11)


def test_frame_at_points():
    """In an element of a crack that crack's, elsewhere that of the nearest crack."""
    for crack, d in ((0, 0.05), (1, -0.05)):
        t = np.subtract(*BODY.cracks[crack].points[::-1]) / LENGTHS[crack]
        for s in (0.2, 0.5):
            here = MESH(*(np.array(BODY.cracks[crack].PointAt(s * LENGTHS[crack])) + (0, d)))
            assert BODY.tangent(here) == pytest.approx(t, abs=1e-12)
            assert BODY.normal(here) == pytest.approx((-t[1], t[0]), abs=1e-12)
    assert BODY.normal(MESH(0.1, 0.02))[1] > 0.99 and BODY.normal(MESH(0.9, 0.98))[1] < -0.99
