"""The rules on T∩Ω±, T∩Γ_C, on cut boundary edges and around tips, as users meet them: through integrals."""

from functools import cache

import mpmath as mp
import numpy as np
import pytest
from helpers import clip, left_normal, matrix, moment, random_function, rectangle, side_areas, structured, vector, vertices
from hypothesis import given, settings
from hypothesis import strategies as st
from ngsolve import CF, L2, VOL, ElementId, Grad, GridFunction, IfPos, InnerProduct, Integrate, LinearForm, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Strain, TipEnrichment
from ngsxfem_contact.geometry import Side

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

few = settings(max_examples=15, deadline=None, derandomize=True)
unit = st.floats(0, 1)
MESH = rectangle(0.3)
FINE = rectangle(0.06)


@cache
def mesh_of(maxh):
    return rectangle(maxh, (0, -0.5), (1, 0.5))


def distance(p, q):
    """Signed distance to the line through p and q, positive to its left."""
    n = left_normal(p, q)
    return n[0] * (x - p[0]) + n[1] * (y - p[1])


@given(a=unit, b=unit)
@few
def test_areas_and_lengths_of_a_through_crack(a, b):
    p, q = (0, 0.05 + 0.9 * a), (1, 0.05 + 0.9 * b)
    body = CrackedMesh(MESH, Crack([p, q]))
    length = Integrate(1 * body.dcrack, MESH, element_wise=True)
    total = 0
    for place in body.Elements(0):
        triangle = vertices(MESH, place.element)
        plus = moment(clip(triangle, p, left_normal(p, q)))
        minus = moment(clip(triangle, p, -left_normal(p, q)))
        assert side_areas(body, place) == pytest.approx((plus, minus), abs=1e-13)
        s0, s1 = place.arclength
        assert length[place.element] == pytest.approx(s1 - s0, abs=1e-13)
        total += s1 - s0
    assert total == pytest.approx(np.hypot(1, 0.9 * (b - a)), rel=1e-13)


@given(a=unit, b=unit, order=st.integers(0, 7))
@few
def test_moments_of_the_plus_side(a, b, order):
    p, q = (0, 0.05 + 0.9 * a), (1, 0.05 + 0.9 * b)
    body = CrackedMesh(MESH, Crack([p, q]))
    plus = clip([(0, 0), (1, 0), (1, 1), (0, 1)], p, left_normal(p, q))
    for i in range(order + 1):
        f = IfPos(distance(p, q), x**i * y ** (order - i), 0)
        value = Integrate(f * body.dx(bonus_intorder=order - 5), MESH)
        assert value == pytest.approx(moment(plus, i, order - i), abs=1e-13)


@given(s=st.lists(st.floats(0.3, 0.7), min_size=6, max_size=6))
@few
def test_kinked_cracks_divide_areas_without_loss(s):
    points = [(0.1 + 0.8 * k / 5, s[k]) for k in range(6)]
    mesh, crack = FINE, Crack(points)
    body = CrackedMesh(mesh, crack)
    assert Integrate(1 * body.dcrack, mesh) == pytest.approx(crack.length, rel=1e-13)
    assert Integrate(1 * body.dx, mesh) == pytest.approx(1, abs=1e-13)
    for place in body.Elements(0):
        assert sum(body.PartSizes(place.element)) == pytest.approx(moment(vertices(mesh, place.element)), abs=1e-15)


@given(left=unit, kink=st.tuples(unit, unit), right=unit, order=st.integers(0, 4))
@few
def test_moments_beside_a_kink(left, kink, right, order):
    """Exactly, although the line of one arm divides elements of the other."""
    p, k, q = (0, 0.3 + 0.4 * left), (0.4 + 0.2 * kink[0], 0.3 + 0.4 * kink[1]), (1, 0.3 + 0.4 * right)
    mesh = rectangle(0.15)
    body = CrackedMesh(mesh, Crack([p, k, q]))
    f = IfPos(k[0] - x, IfPos(distance(p, k), 1, 0), IfPos(distance(k, q), 1, 0)) * x**order
    uncut = [i for i in range(mesh.ne) if not body.CrackElements(0)[i]]
    values = Integrate(f * body.dx, mesh, element_wise=True)
    whole = moment([k, q, (1, 1), (0, 1), p], order)
    above = lambda part: body.cracks[0].SideOf(tuple(np.mean(part.triangle, axis=0))) == Side.Plus
    parts = sum(moment(oriented(c.triangle), order) for e in body.Elements(0) for c in body.Parts(e.element) if above(c))
    assert parts + sum(values[i] for i in uncut) == pytest.approx(whole, abs=1e-13)


def oriented(triangle):
    return triangle if moment(triangle) > 0 else triangle[::-1]


@pytest.mark.parametrize("points", [[(0, 0.31), (1, 0.67)], [(0, 0.31), (0.45, 0.4), (0.7, 0.61)], [(0.2, 0.5), (0.55, 0.52)]])
@pytest.mark.parametrize("order", [0, 1, 2, 3, 4, 5, 8])
def test_weights_are_positive_and_points_lie_inside(points, order):
    """With more functions than points the mass matrix has the signs of the weights as inertia."""
    mesh = structured(4)
    body = CrackedMesh(mesh, Crack(points))
    space = L2(mesh, order=10, all_dofs_together=True)
    u, v = space.TnT()
    mass = matrix(u * v * body.dx(bonus_intorder=order - 20))
    area = Integrate(1 * body.dx, mesh, element_wise=True)
    for place in body.Elements(0):
        dofs = list(space.GetDofNrs(ElementId(VOL, place.element)))
        values = np.linalg.eigvalsh(mass[dofs][:, dofs].toarray())
        assert values[0] > -1e-15 * values[-1]
        outside = sum(IfPos(1e-12 - d, 1, 0) for d in inner_distances(mesh, place.element))
        assert Integrate(outside * body.dx, mesh, element_wise=True)[place.element] == 0
        assert area[place.element] == pytest.approx(1 / 32, rel=1e-13)


def inner_distances(mesh, element):
    corners = vertices(mesh, element)
    return [distance(corners[i], corners[(i + 1) % 3]) for i in range(3)]


@pytest.mark.parametrize("order", range(13))
def test_points_lie_on_the_side_of_their_piece(order):
    """No point of a rule for the bulk lies on the crack, where the side of a point is arbitrary."""
    p, q = (0, 0.43), (1, 0.56)
    body = CrackedMesh(MESH, Crack([p, q]))
    near = IfPos(1e-10 - distance(p, q) ** 2 * 1e8, 1, 0)
    assert Integrate(near * body.dx(bonus_intorder=order - 5), MESH) == 0


@pytest.mark.parametrize("reverse", [False, True])
def test_boundary_integrals_see_both_sides_of_a_mouth(reverse):
    points = [(0, 0.37), (1, 0.58)]
    body = CrackedMesh(MESH, Crack(points[::-1] if reverse else points))
    above = IfPos(distance(*points), 1, 0)
    for name, mouth in (("left", 0.37), ("right", 0.58)):
        for k in range(5):
            value = Integrate(above * y**k * body.ds(name), MESH)
            assert value == pytest.approx((1 - mouth ** (k + 1)) / (k + 1), abs=1e-14)


def test_boundary_load_on_functions_that_jump_at_a_mouth():
    """∫_left v of a function with jump: against its one-sided values, which are linear on the cut edge."""
    body = CrackedMesh(MESH, Crack([(0, 0.37), (0.5, 0.41)]))
    V = CrackFESpace(body, order=1, tip=None)
    u = random_function(V)
    load = vector(CF((1, 0)) * V.TestFunction() * body.ds("left"))
    (edge,) = body.CutBoundaryElements(0)
    value = load @ u.vec.FV().NumPy()
    breaks = sorted({0.37} | {mesh_point[1] for mesh_point in left_points()})
    exact = sum(0.5 * (b - a) * sum(u(MESH(1e-13, a + t * (b - a)))[0] for t in (1e-12, 1 - 1e-12)) for a, b in zip(breaks, breaks[1:]))
    assert value == pytest.approx(exact, abs=1e-9)


def left_points():
    return [v.point for v in MESH.vertices if abs(v.point[0]) < 1e-12]


# Tips


@cache
def branch_energies(r0, r1, cutoff):
    """∫|∇(χ F_j)|² over the disk: F = √r g(θ), so products of integrals over r and over θ."""

    def chi(r):
        if r <= r0:
            return mp.mpf(1), mp.mpf(0)
        t = (r - r0) / (mp.mpf(r1) - r0)
        if cutoff == "cubic":
            return 1 - t**2 * (3 - 2 * t), -6 * t * (1 - t) / (mp.mpf(r1) - r0)
        return 1 - t**3 * (10 - 15 * t + 6 * t**2), -30 * t**2 * (1 - t) ** 2 / (mp.mpf(r1) - r0)

    radii = [0, r0, r1] if r0 else [0, r1]
    radial = mp.quad(lambda r: (chi(r)[1] * r + chi(r)[0] / 2) ** 2, radii)
    angular = mp.quad(lambda r: chi(r)[0] ** 2, radii)
    g = [
        (lambda t: mp.sin(t / 2), lambda t: mp.cos(t / 2) / 2),
        (lambda t: mp.cos(t / 2), lambda t: -mp.sin(t / 2) / 2),
        (lambda t: mp.sin(t / 2) * mp.sin(t), lambda t: mp.cos(t / 2) * mp.sin(t) / 2 + mp.sin(t / 2) * mp.cos(t)),
        (lambda t: mp.cos(t / 2) * mp.sin(t), lambda t: -mp.sin(t / 2) * mp.sin(t) / 2 + mp.cos(t / 2) * mp.cos(t)),
    ]
    circle = [-mp.pi, 0, mp.pi]
    return np.array([float(radial * mp.quad(lambda t: f(t) ** 2, circle) + angular * mp.quad(lambda t: d(t) ** 2, circle)) for f, d in g])


def positions(mesh):
    """Tips at special places in an element near the middle of [0, 1] × [-½, ½]."""
    points = np.array([v.point for v in mesh.vertices])
    corner = np.argmin(np.linalg.norm(points - [0.5, 0], axis=1))
    element = next(e for e in mesh.Elements() if corner in [v.nr for v in e.vertices])
    t = np.array([points[corner], *(points[v.nr] for v in element.vertices if v.nr != corner)])
    center, h = t.mean(axis=0), max(np.linalg.norm(t[i] - t[i - 1]) for i in range(3))
    inward, along = (center - t[0]) / np.linalg.norm(center - t[0]), t[1] - t[0]
    normal = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    normal *= np.sign(normal @ inward)
    return {
        "generic": center, "edge": t[0] + 0.5 * along, "edge near a vertex": t[0] + 0.1 * along, "vertex": t[0],
        "1e-6 h from a vertex": t[0] + 1e-6 * h * inward, "1e-9 h from a vertex": t[0] + 1e-9 * h * inward,
        "1e-6 h from an edge": t[0] + 0.3 * along + 1e-6 * h * normal, "1e-12 h from an edge": t[0] + 0.3 * along + 1e-12 * h * normal,
        "in a corner": t[0] + 0.03 * (center - t[0]), "in a corner by an edge": t[0] + 1e-3 * along + 1e-5 * h * normal,
    }  # fmt: skip


def edge_crack(tip):
    """From a mouth on x = 0 that no vertex of the meshes lies on."""
    return Crack([(0, 0.013), tuple(map(float, tip))])


def tip_energies(mesh, crack, **options):
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=1, tip=TipEnrichment(functions=None if "material" in options else "branch", **{"tolerance": 1e-10} | options))
    u, v = V.TnT()
    energy = matrix(InnerProduct(Grad(u), Grad(v)) * body.dx).diagonal()
    return [energy[list(V.TipDofs(i))] for i in range(len(body.tips))]


@pytest.mark.parametrize("maxh", [0.2, 0.05])
@pytest.mark.parametrize("place", list(positions(mesh_of(0.2))))
def test_energies_of_branch_functions(maxh, place):
    """To 1e-8: the rules aim at 1e-10, the snapping of a tip to a corner costs up to 1e-9 h / r1."""
    mesh = mesh_of(maxh)
    tip = positions(mesh)[place]
    for cutoff in ("cubic", "quintic"):
        for r0, r1 in ((0.01, 0.35), (0, 0.35), (0.25, 0.35), (0.006, 0.05)):
            (energy,) = tip_energies(mesh, edge_crack(tip), r0=r0, r1=r1, cutoff=cutoff)
            exact = np.repeat(branch_energies(r0, r1, cutoff), 2)
            assert energy == pytest.approx(exact, rel=2e-8), (cutoff, r0, r1)


@pytest.mark.parametrize("maxh", [0.4, 0.2])
@pytest.mark.parametrize("half", [0.05, 0.15])
def test_energies_of_two_tips_whose_disks_meet_the_same_elements(maxh, half):
    crack = Crack([(0.5 - half, 0.03), (0.5 + half, 0.05)])
    r1 = 0.9 * crack.length / 2
    exact = np.repeat(branch_energies(r1 / 50, r1, "quintic"), 2)
    for energy in tip_energies(mesh_of(maxh), crack):
        assert energy == pytest.approx(exact, rel=2e-8)


def divergence_defect(place, **options):
    """∫_Ω ∂_l v_k + ∫_{Γ_C} jump(v_k) n_l for all functions v at a tip: 0, as χ vanishes on ∂Ω."""
    mesh = mesh_of(0.1)
    crack = edge_crack(positions(mesh)[place])
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=1, tip=TipEnrichment(functions=None if "material" in options else "branch", **{"tolerance": 1e-10} | options))
    v = V.TestFunction()
    defect = 0
    for k in range(2):
        for m in range(2):
            form = LinearForm(Grad(v)[k, m] * body.dx)
            form += Jump(v)[k] * body.normal[m] * body.dcrack
            defect = max(defect, np.abs(form.Assemble().vec.FV().NumPy()[list(V.TipDofs(0))]).max())
    return defect


@pytest.mark.parametrize("place", ["generic", "edge", "vertex", "1e-6 h from a vertex", "in a corner"])
@pytest.mark.parametrize("cutoff", ["cubic", "quintic"])
def test_divergence_theorem_for_tip_functions(place, cutoff):
    assert divergence_defect(place, r0=0.01, r1=0.4, cutoff=cutoff) < 1e-9
    assert divergence_defect(place, r0=0.01, r1=0.4, cutoff=cutoff, tolerance=1e-13) < 1e-11


def test_the_tolerance_steers_the_defect():
    rough, fine = (divergence_defect("generic", r1=0.4, tolerance=tolerance) for tolerance in (1e-4, 1e-12))
    assert fine < 1e-3 * rough


def tip_rows(tolerance, place, order):
    mesh = mesh_of(0.15)
    body = CrackedMesh(mesh, edge_crack(positions(mesh)[place]))
    V = CrackFESpace(body, order=order, tip=TipEnrichment(r1=0.3, tolerance=tolerance, functions="branch"))
    u, v = V.TnT()
    return matrix(InnerProduct(Grad(u), Grad(v)) * body.dx)[list(V.TipDofs(0))].toarray()


@pytest.mark.parametrize("place", ["generic", "edge", "1e-6 h from a vertex"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_coupling_of_tip_functions_and_polynomials(place, order):
    """Rows of the matrix with rules of tolerance 1e-10 and 1e-13, relative to the largest entry."""
    usual, fine = tip_rows(1e-10, place, order), tip_rows(1e-13, place, order)
    assert np.abs(usual - fine).max() < 3e-8 * np.abs(fine).max()


@pytest.mark.parametrize("maxh", [0.1, 0.02])
@pytest.mark.parametrize("options", [dict(r1=0.3), dict(r1=0.3, cutoff="cubic"), dict(r1=0.3, r0=0.2)], ids=["", "cubic", "narrow"])
def test_default_rules_against_fine_ones(maxh, options):
    """The coupling by plain Gauss rules far from the tip and across the kinks of χ: the default tolerance is 1e-5."""
    rows = []
    for tolerance in ({}, {"tolerance": 1e-12}):
        body = CrackedMesh(mesh_of(maxh), edge_crack((0.53, 0.05)))
        V = CrackFESpace(body, order=1, tip=TipEnrichment(functions="branch", **options, **tolerance))
        u, v = V.TnT()
        K = matrix(InnerProduct(Strain(u), Strain(v)) * body.dx)
        rows.append((K[list(V.TipDofs(0))].toarray(), len(body.dx.Points(0, V)[0])))
    (usual, points), (fine, many) = rows
    assert np.abs(usual - fine).max() < 1e-5 * np.abs(fine).max() and points < 0.8 * many


def mode_in_polar_components(mode, power, lam, mu, t):
    """f, g with F_r = r^p f(θ), F_θ = r^p g(θ) of the coefficient 1 (docs/method.md, section 3): of p = 1/2 those of unit K, of the others Kolosov's formula."""
    kappa = (lam + 3 * mu) / (lam + mu)
    c, s, scale = mp.cos(t / 2), mp.sin(t / 2), 1 / (2 * mu * mp.sqrt(2 * mp.pi))
    if power == 0.5:
        ux, uy = ((c * (kappa - 1 + 2 * s**2), s * (kappa + 1 - 2 * c**2)), (s * (kappa + 1 + 2 * c**2), -c * (kappa - 1 - 2 * s**2)))[mode - 1]
    else:
        a = (1, -1j)[mode - 1]
        u = kappa * a * mp.expj(power * t) - power * mp.conj(a) * mp.expj((2 - power) * t) - (a - power * mp.conj(a)) * mp.expj(-power * t)
        ux, uy = mp.re(u), mp.im(u)
    return scale * (ux * mp.cos(t) + uy * mp.sin(t)), scale * (-ux * mp.sin(t) + uy * mp.cos(t))


def mode_energy(mode, power, lam, mu, r0, r1):
    """∫σ(χF):ε(χF) with quintic χ: ε_rr = A f, ε_θθ = B (f + g'), 2 ε_rθ = B f' + (A - B) g, A = (χ r^p)', B = χ r^{p-1}, over r1^{2p-1}."""

    def radial(i, j):
        def integrand(r):
            t = max((r - r0) / (mp.mpf(r1) - r0), 0)
            chi, slope = 1 - t**3 * (10 - 15 * t + 6 * t**2), -30 * t**2 * (1 - t) ** 2 / (mp.mpf(r1) - r0)
            factors = slope * r + power * chi, chi  # A, B over r^{p-1}
            return factors[i] * factors[j] * (r / r1) ** (2 * power - 1)

        return mp.quad(integrand, [0, r0, r1])

    def angular(form):
        def integrand(t):
            f, g = mode_in_polar_components(mode, power, lam, mu, t)
            slopes = (mp.diff(lambda s, i=i: mode_in_polar_components(mode, power, lam, mu, s)[i], t) for i in range(2))
            return form(f, g, *slopes)

        return mp.quad(integrand, [-mp.pi, 0, mp.pi])

    total = radial(0, 0) * angular(lambda f, g, df, dg: (lam + 2 * mu) * f**2 + mu * g**2)
    total += radial(1, 1) * angular(lambda f, g, df, dg: (lam + 2 * mu) * (f + dg) ** 2 + mu * (df - g) ** 2)
    total += radial(0, 1) * angular(lambda f, g, df, dg: 2 * lam * f * (f + dg) + 2 * mu * g * (df - g))
    return float(total)


@pytest.mark.parametrize("place", ["generic", "edge", "vertex"])
def test_energies_of_modes(place):
    mesh, material = mesh_of(0.2), Elasticity(lam=1.7, mu=0.9)
    body = CrackedMesh(mesh, edge_crack(positions(mesh)[place]))
    V = CrackFESpace(body, order=1, tip=TipEnrichment(r0=0.05, r1=0.35, material=material, tolerance=1e-10, order=3))
    u, v = V.TnT()
    energy = matrix(InnerProduct(material.Stress(Strain(u)), Strain(v)) * body.dx)
    assert len(V.TipDofs(0)) == 6
    for number, dof in enumerate(V.TipDofs(0)):
        assert energy[dof, dof] == pytest.approx(mode_energy(number % 2 + 1, number // 2 + 0.5, 1.7, 0.9, 0.05, 0.35), rel=2e-8)


def test_tip_functions_on_the_crack_are_integrated_to_the_tip():
    """jump(χ√r sin(θ/2)) = 2χ√r on the crack: ∫ with χ = 1 is 4/3 r0^{3/2}, the rest a polynomial in √r."""
    body = CrackedMesh(mesh_of(0.2), Crack([(0, 0.013), (0.53, 0.013)]))
    V = CrackFESpace(body, order=1, tip=TipEnrichment(r0=0.1, r1=0.4, functions="branch"))
    jump = GridFunction(V)
    jump.vec[V.TipDofs(0)[0]] = 1
    t = lambda r: (r - 0.1) / 0.3
    chi = lambda r: 1 - t(r) ** 3 * (10 - 15 * t(r) + 6 * t(r) ** 2)
    exact = 4 / 3 * 0.1**1.5 + float(mp.quad(lambda r: 2 * chi(r) * mp.sqrt(r), [0.1, 0.4]))
    assert Integrate(Jump(jump)[0] * body.dcrack, body.mesh) == pytest.approx(exact, rel=1e-12)
