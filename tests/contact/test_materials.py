"""Several materials in one body, and bodies with curved boundaries."""

import numpy as np
import pytest
from helpers import rectangle
from netgen.geom2d import SplineGeometry
from ngsolve import CF, VOL, ElementId, IfPos, Mesh, specialcf, x, y

from ngsxfem_contact import BarbosaHughes, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import PAIRS

STEEL, RUBBER = Elasticity(lam=1.5, mu=1), Elasticity(lam=0.2, mu=0.05)


def two_blocks(maxh, vertical=False):
    """The square of side 1 around the origin; "plus" is y > 0 (or x > 0), "minus" the rest; the interface is meshed."""
    geometry = SplineGeometry()
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0), (0.5, 0.5), (-0.5, 0.5), (-0.5, 0)]
    if vertical:
        corners = [(b, -a) for a, b in corners]
    points = [geometry.AppendPoint(*p) for p in corners]
    for i in range(6):
        geometry.Append(["line", points[i], points[(i + 1) % 6]], bc="outer", leftdomain=1 if i in (0, 1, 5) else 2, rightdomain=0)
    geometry.Append(["line", points[5], points[2]], bc="interface", leftdomain=2, rightdomain=1)
    geometry.SetMaterial(1, "minus")
    geometry.SetMaterial(2, "plus")
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def stacked(plus, minus, p=1, e=0.3):
    """σ_yy = -p everywhere, ε_xx = e: piecewise linear u with the interface y = 0."""
    c = {m: (-p - m.lam * e) / (m.lam + 2 * m.mu) for m in (plus, minus)}
    s = {m: (m.lam + 2 * m.mu) * e + m.lam * c[m] for m in (plus, minus)}
    sigma_xx = IfPos(y, s[plus], s[minus])
    stress = CF((sigma_xx, 0, 0, -p), dims=(2, 2))
    return cf.ClosedForm(CF((e * x, IfPos(y, c[plus], c[minus]) * y)), stress, CF(-p), CF(0))


def side_by_side(plus, minus, s=-0.1, e=-1):
    """σ_xx = s everywhere, ε_yy = e: the interface is x = 0, and the pressure on y = 0 jumps there."""
    c = {m: (s - m.lam * e) / (m.lam + 2 * m.mu) for m in (plus, minus)}
    pressure = {m: (m.lam + 2 * m.mu) * e + m.lam * c[m] for m in (plus, minus)}
    sigma_yy = IfPos(x, pressure[plus], pressure[minus])
    return cf.ClosedForm(CF((IfPos(x, c[plus], c[minus]) * x, e * y)), CF((s, 0, 0, sigma_yy), dims=(2, 2)), sigma_yy, CF(0))


def solve(mesh, crack, exact, pair, tip=None):
    """The exact displacement on the whole boundary."""
    material = Elasticity.ByRegion(mesh, {"plus": STEEL, "minus": RUBBER})
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=PAIRS[pair].order, bubble=PAIRS[pair].bubble, tip=tip, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=PAIRS[pair].multiplier_order), material)
    problem.SetDirichlet(exact.u, "outer")
    return problem.Solve()


def errors(solution, exact):
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact)


CRACKS = {
    "along the interface": [(-0.5, 0), (0.21, 0)],
    "along the whole interface": [(-0.5, 0), (0.5, 0)],
    "backwards": [(0.1, 0), (-0.23, 0)],
    "beside the interface": [(-0.5, 0.13), (0.2, 0.13)],
}


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("crack", CRACKS)
def test_piecewise_uniform_stress_is_exact(crack, pair):
    exact = stacked(STEEL, RUBBER)
    solution = solve(two_blocks(0.15), Crack(CRACKS[crack]), exact, pair)
    assert max(errors(solution, exact)) < 1e-10


@pytest.mark.parametrize("pair", ["P2/P0", "P1/P0"])
@pytest.mark.parametrize("ends", [(-0.5, 0.5), (-0.5, 0.17), (-0.5, 0)])
def test_a_crack_across_an_interface_or_up_to_it(pair, ends):
    exact = side_by_side(STEEL, RUBBER)
    solution = solve(two_blocks(0.15, vertical=True), cf.crack_on_axis(*ends), exact, pair)
    assert max(errors(solution, exact)) < 1e-10


def test_equal_materials_are_one_material():
    mesh, energies = two_blocks(0.15), []
    for material in (STEEL, Elasticity.ByRegion(mesh, {"plus|minus": STEEL})):
        body = CrackedMesh(mesh, Crack([(-0.5, 0.03), (0.1, 0.03)]))
        V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material), dirichlet="outer")
        problem = ContactProblem(V, TraceSpace(body), material)
        problem.SetDirichlet((0.01 * x * y, -0.01 * y), "outer")
        energies.append(problem.Solve().Energy())
    assert energies[0] == pytest.approx(energies[1], rel=1e-10)


def test_gamma_in_a_soft_part_does_not_depend_on_a_stiff_one():
    """The floor of C_T, for elements on which R_h nearly vanishes, is one of their own material."""
    limits = []
    for stiff in (RUBBER, Elasticity(lam=1e9, mu=1e9)):
        mesh = two_blocks(0.15, vertical=True)
        material = Elasticity.ByRegion(mesh, {"plus": stiff, "minus": RUBBER})
        body = CrackedMesh(mesh, cf.crack_on_axis(-0.5, 0.5))
        soft = [mesh[ElementId(VOL, location.element)].mat == "minus" for location in body.Elements(0)]
        limits.append(BarbosaHughes().Limits(CrackFESpace(body, order=2, tip=None), material)[soft])
    assert len(limits[0]) > 3 and np.allclose(*limits, rtol=1e-10, atol=0)


def space(mesh, crack, **tip):
    material = Elasticity.ByRegion(mesh, {"plus": STEEL, "minus": RUBBER})
    return CrackFESpace(CrackedMesh(mesh, Crack(crack)), order=1, tip=TipEnrichment(material=material, **tip))


def test_modes_take_the_material_at_their_tip_and_keep_clear_of_others():
    V = space(two_blocks(0.1), [(-0.2, 0.25), (0.1, 0.25)])
    assert (V.tip_specs[0].kappa, V.tip_specs[0].mu) == (STEEL.kappa, STEEL.mu)
    assert [spec.r1 for spec in V.tip_specs] == pytest.approx([0.9 * 0.15] * 2)  # half the way between the tips
    V = space(two_blocks(0.1), [(-0.5, -0.1), (0.1, -0.1)])
    assert V.tip_specs[0].kappa == RUBBER.kappa
    assert V.tip_specs[0].r1 == pytest.approx(0.9 * 0.1)


@pytest.mark.parametrize(("y0", "r1"), [(-0.1, 0.2), (0.1, 0.11)])
def test_a_disk_in_two_materials_is_refused(y0, r1):
    with pytest.raises(ValueError, match=r"the disk r1 = .* of the tip at \(0.1, .*\) reaches another material.*tip=None"):
        space(two_blocks(0.1), [(-0.5, y0), (0.1, y0)], r1=r1)


def test_the_functions_of_the_paper_need_no_material():
    assert space(two_blocks(0.1), [(-0.5, 0), (0.1, 0)], functions="branch", r1=0.2).tip_specs[0].r1 == 0.2


@pytest.mark.parametrize(
    ("materials", "message"),
    [
        ({"plus": STEEL}, "region 'minus' of the mesh is matched by no name"),
        ({".*": STEEL, "plus": RUBBER}, "region 'plus' of the mesh is matched by"),
        ({".*": STEEL, "copper": RUBBER}, r"\['copper'\] match no region; the mesh has \['minus', 'plus'\]"),
    ],
)
def test_regions_without_a_unique_material_are_refused(materials, message):
    with pytest.raises(ValueError, match=message):
        Elasticity.ByRegion(two_blocks(0.4), materials)


def test_a_material_that_is_none_is_refused():
    with pytest.raises(TypeError, match="'plus' has the material 3, which is not an Elasticity"):
        Elasticity.ByRegion(two_blocks(0.4), {"plus": 3, "minus": STEEL})


# The form of the law out of the plane


def in_space(stress, sigma_zz):
    """√(3/2) |dev σ| of the 3 × 3 stress: the von Mises stress without its formula in components."""
    sigma = np.zeros((3, 3))
    sigma[:2, :2], sigma[2, 2] = stress, sigma_zz
    return np.sqrt(1.5) * np.linalg.norm(sigma - np.trace(sigma) / 3 * np.eye(3))


PLATE, LONG = Elasticity.PlaneStress(E=70, nu=0.33), Elasticity.PlaneStrain(E=70, nu=0.33)
STRESS = np.array([[3.0, 0.7], [0.7, -1.2]])


@pytest.mark.parametrize(("material", "sigma_zz"), [(PLATE, 0), (LONG, 0.33 * 1.8)], ids=["plane stress", "plane strain"])
def test_the_material_knows_its_form(material, sigma_zz):
    mesh = rectangle(0.5)
    at = mesh(0.3, 0.2)  # holds no reference to the mesh
    stress = CF(tuple(STRESS.ravel()), dims=(2, 2))
    assert (material.E, material.nu) == pytest.approx((70, 0.33), rel=1e-14)
    assert material.VonMises(stress)(at) == pytest.approx(in_space(STRESS, sigma_zz), rel=1e-14)
    in_plane = ((1 + 0.33) * STRESS - 0.33 * (np.trace(STRESS) + sigma_zz) * np.eye(2)) / 70  # Hooke's law in space
    assert np.allclose(material.Strain(stress)(at), in_plane.ravel(), rtol=0, atol=1e-14)
    assert np.allclose(material.Stress(material.Strain(stress))(at), STRESS.ravel(), rtol=0, atol=1e-13)


def test_forms_by_region():
    mesh = two_blocks(0.4)
    mixed, stress = Elasticity.ByRegion(mesh, {"plus": PLATE, "minus": LONG}), CF(tuple(STRESS.ravel()), dims=(2, 2))
    for material, at in ((PLATE, mesh(0.1, 0.2)), (LONG, mesh(0.1, -0.2))):
        for of_mixed, right in (
            (mixed.VonMises(stress), material.VonMises(stress)),
            (mixed.Strain(stress), material.Strain(stress)),
            (mixed.E, CF(material.E)),
        ):
            assert np.allclose(of_mixed(at), right(at), rtol=1e-14, atol=0)


def test_another_form_is_refused():
    with pytest.raises(ValueError, match=r"form='membrane' is not one of \['plane strain', 'plane stress', 'solid'\]"):
        Elasticity(1, 1, form="membrane")


# Curved boundaries

INNER, OUTER = 0.4, 1.0


def annulus(maxh, curve):
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), OUTER, leftdomain=1, rightdomain=0, bc="outer")
    geometry.AddCircle((0, 0), INNER, leftdomain=0, rightdomain=1, bc="inner")
    return Mesh(geometry.GenerateMesh(maxh=maxh)).Curve(curve)


def lame(material, p=1):
    """Pressure p on the outer circle: σ_rr, σ_θθ = A ∓ B/r², u_r = (A r/(λ+μ) + B/r/μ)/2; a radial crack stays closed."""
    A = -p / (1 - INNER**2 / OUTER**2)
    B = A * INNER**2
    r2 = x * x + y * y
    factor = 0.5 * (A / (material.lam + material.mu) + B / r2 / material.mu)
    rr, tt = A - B / r2, A + B / r2
    stress = CF((rr * x * x + tt * y * y, (rr - tt) * x * y, (rr - tt) * x * y, rr * y * y + tt * x * x), dims=(2, 2)) / r2
    return cf.ClosedForm(factor * CF((x, y)), stress, tt, CF(0))


def annulus_solution(maxh, curve, tip=None):
    """P2/P1 with a closed radial crack; the outer circle is loaded, three unknowns are pinned to their exact values."""
    exact = lame(STEEL)
    mesh = annulus(maxh, curve)
    body = CrackedMesh(mesh, Crack([(0.55, 0.01), (0.77, 0.014)]))
    V = CrackFESpace(body, order=2, tip=tip)
    problem = ContactProblem(V, TraceSpace(body, order=1), STEEL)
    problem.f += -specialcf.normal(2) * V.TestFunction() * body.ds("outer")
    for point, components in (((OUTER, 0), "xy"), ((-OUTER, 0), "y")):
        u = [float(value) for value in exact.u(mesh(*np.multiply(point, 1 - 1e-12)))]
        problem.Pin(point, components, value=u if components == "xy" else u[1])
    return problem.Solve(), exact


def energy_defect(maxh, curve):
    """|½a(u_h, u_h) - exact| / exact; the exact energy is half the work of the pressure."""
    solution, exact = annulus_solution(maxh, curve)
    work = -np.pi * OUTER * exact.u(solution.body.mesh(OUTER - 1e-12, 0))[0]
    return abs(solution.Energy() / work - 1)


def test_a_curved_boundary_keeps_the_order_of_P2():
    coarse, fine = (np.array(errors(*annulus_solution(h, 3))) for h in (0.2, 0.1))
    assert (np.log2(coarse / fine) > (1.7, 1.3)).all()
    assert energy_defect(0.1, 1) > 10 * energy_defect(0.1, 3)  # the polygon is smaller than the body


def test_disks_keep_clear_of_curved_elements():
    with_tips, without = (errors(*annulus_solution(0.1, 3, tip))[0] for tip in (TipEnrichment(material=STEEL), None))
    assert with_tips < 1.1 * without
    with pytest.raises(ValueError, match="reaches a curved element, at 0.*; choose 0 < r1 <"):
        annulus_solution(0.1, 3, TipEnrichment(r1=0.1))


@pytest.mark.parametrize("crack", [[(0.02, -0.31), (0.02, 0)], [(-0.21, 0), (0.31, 0)]], ids=["that ends on it", "along it"])
def test_a_tip_on_an_interface_is_refused(crack):
    """By tip functions, and by K; without both the crack is solved."""
    mesh, crack = two_blocks(0.12), Crack(crack)
    body, material = CrackedMesh(mesh, crack), Elasticity.ByRegion(mesh, {"plus": STEEL, "minus": RUBBER})
    with pytest.raises(ValueError, match="lies on the interface of two materials.*tip=None"):
        CrackFESpace(body, order=2, material=material, dirichlet="outer")
    solution = solve(mesh, crack, stacked(STEEL, RUBBER), "P2/P1")
    on_it = next(i for i, tip in enumerate(body.tips) if abs(tip.point[1]) < 1e-12)
    with pytest.raises(ValueError, match="K_I, K_II are not defined"):
        solution.StressIntensity(on_it)
