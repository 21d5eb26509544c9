"""CrackFESpace: tip functions, Heaviside functions, operators, reproduction, assembly, pickling."""

import pickle

import numpy as np
import pytest
from helpers import array, basis_function, left_normal, matrix, on_crack, random_function, rectangle, structured, threads, to_scipy, vector
from ngsolve import CF, H1, BilinearForm, Grad, GridFunction, IfPos, InnerProduct, Integrate, LinearForm, VoxelCoefficient, x, y  # fmt: skip

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, Strain, TipEnrichment
from ngsxfem_contact import _ngsxfem_contact as core
from ngsxfem_contact.operators import Gradient

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

R0, R1 = 0.06, 0.3
MESH = rectangle(0.2)


# Tip functions


def frame(points, at_end):
    """Tip, direction ahead, and the sign of θ on the plus side."""
    p, q = np.array(points[-2:]) if at_end else np.array(points[1::-1])
    return q, (q - p) / np.hypot(*(q - p)), 1 if at_end else -1


def polar(points, at_end, p):
    tip, ahead, _ = frame(points, at_end)
    z = complex(*(np.asarray(p) - tip)) / complex(*ahead)
    return abs(z), np.angle(z)


def chi(r, cutoff):
    t = np.clip((r - R0) / (R1 - R0), 0, 1)
    return {"cubic": 1 - t**2 * (3 - 2 * t), "quintic": 1 - t**3 * (10 - 15 * t + 6 * t**2), "septic": 1 - t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3)}[cutoff]


def branch(j, r, t):
    return np.sqrt(r) * [np.sin(t / 2), np.cos(t / 2), np.sin(t / 2) * np.sin(t), np.cos(t / 2) * np.sin(t)][j]


def mode(j, r, t, material):
    """docs/method.md, section 3, in the frame of the tip: the fields of unit K_I and K_II by their formulas, the others by Kolosov's."""
    c, s, k = np.cos(t / 2), np.sin(t / 2), material.kappa
    scale = np.sqrt(r / (2 * np.pi)) / (2 * material.mu)
    if j == 0:
        return scale * c * (k - 1 + 2 * s**2), scale * s * (k + 1 - 2 * c**2)
    if j == 1:
        return scale * s * (k + 1 + 2 * c**2), -scale * c * (k - 1 - 2 * s**2)
    z, power, a = r * np.exp(1j * t), j // 2 + 0.5, -1j if j % 2 else 1
    phi, slope, psi = a * z**power, a * power * z ** (power - 1), (np.conj(a) - power * a) * z**power
    field = (k * phi - z * np.conj(slope) - np.conj(psi)) / (2 * material.mu * np.sqrt(2 * np.pi) * R1 ** (j // 2))
    return field.real, field.imag


def tip_space(points, at_end, **options):
    body = CrackedMesh(MESH, Crack(points))
    tip = [None] * len(body.tips)
    tip[-1 if at_end else 0] = TipEnrichment(r0=R0, r1=R1, functions=None if "material" in options else "branch", **options)
    V = CrackFESpace(body, order=1, tip=tip)
    return V, list(V.TipDofs(len(tip) - 1 if at_end else 0))


def disk_points(center, n=40):
    rng = np.random.default_rng(1)
    r, t = 1.05 * R1 * rng.uniform(0.01, 1, n), rng.uniform(-np.pi, np.pi, n)
    return np.column_stack([center[0] + r * np.cos(t), center[1] + r * np.sin(t)])


CRACKS = {
    "end": ([(0, 0.42), (0.5, 0.48)], True), "start": ([(0.5, 0.48), (0, 0.42)], False),
    "end, from the right": ([(1, 0.55), (0.5, 0.48)], True), "start, from above": ([(0.52, 0.48), (0.6, 1)], False),
}  # fmt: skip
ends = pytest.mark.parametrize("points, at_end", CRACKS.values(), ids=CRACKS.keys())


@ends
@pytest.mark.parametrize("cutoff", ["cubic", "quintic", "septic"])
def test_branch_functions_against_closed_form(points, at_end, cutoff):
    V, dofs = tip_space(points, at_end, cutoff=cutoff)
    for m, dof in enumerate(dofs):
        u = basis_function(V, dof)
        for p in disk_points(frame(points, at_end)[0]):
            r, t = polar(points, at_end, p)
            expected = np.zeros(2)
            expected[m % 2] = chi(r, cutoff) * branch(m // 2, r, t)
            assert u(MESH(*p)) == pytest.approx(expected, abs=1e-13)


@ends
def test_modes_against_closed_form(points, at_end):
    material = Elasticity(lam=1.3, mu=0.7)
    V, dofs = tip_space(points, at_end, material=material, order=4)
    assert len(dofs) == 8
    ahead = complex(*frame(points, at_end)[1])
    for m, dof in enumerate(dofs):
        u = basis_function(V, dof)
        for p in disk_points(frame(points, at_end)[0]):
            r, t = polar(points, at_end, p)
            rotated = ahead * complex(*mode(m, r, t, material)) * chi(r, "quintic")
            assert u(MESH(*p)) == pytest.approx((rotated.real, rotated.imag), abs=1e-13)


def central_differences(u, p, step=1e-5):
    columns = [(np.array(u(MESH(*(p + e)))) - np.array(u(MESH(*(p - e))))) / (2 * step) for e in step * np.eye(2)]
    return np.array(columns).T.ravel()


@ends
@pytest.mark.parametrize("options", [dict(), dict(cutoff="cubic"), dict(material=Elasticity(1, 2), order=4, cutoff="septic")], ids=["branch", "cubic", "modes"])
def test_gradients_of_tip_functions_by_differences(points, at_end, options):
    V, dofs = tip_space(points, at_end, **options)
    tip, ahead, _ = frame(points, at_end)
    for dof in dofs:
        u = basis_function(V, dof)
        for p in disk_points(tip, 12):
            if polar(points, at_end, p)[0] > 0.05 and abs(np.pi - abs(polar(points, at_end, p)[1])) > 0.01:
                assert Grad(u)(MESH(*p)) == pytest.approx(central_differences(u, p), abs=2e-6)


@ends
@pytest.mark.parametrize("options", [dict(), dict(material=Elasticity(1, 2), order=4)], ids=["branch", "modes"])
def test_one_sided_values_are_limits(points, at_end, options):
    V, dofs = tip_space(points, at_end, **options)
    crack, eps = V.body.cracks[0], 1e-9
    n = left_normal(*points)
    for dof in dofs:
        u = basis_function(V, dof)
        for s in np.linspace(0.02, 0.98, 9) * crack.length:
            p, (on,) = np.array(crack.PointAt(s)), [on_crack(V.body, [s])]
            above, below = u(MESH(*(p + eps * n))), u(MESH(*(p - eps * n)))
            assert Plus(u)(on)[0] == pytest.approx(above, abs=1e-7)
            assert Minus(u)(on)[0] == pytest.approx(below, abs=1e-7)
            assert Jump(u)(on)[0] == pytest.approx(Plus(u)(on)[0] - Minus(u)(on)[0], abs=1e-14)
            for side, sign in (("plus", 1), ("minus", -1)):
                limit = Grad(u)(MESH(*(p + sign * eps * n)))
                assert Gradient(u, side)(on)[0] == pytest.approx(limit, abs=1e-5)


@ends
def test_modes_are_unit_stress_intensities(points, at_end):
    """Inside r0: no traction on the lips, K_I opens, the slip of K_II is positive; both of size K √(r/2π) (κ+1)/μ, of the next pairs times -r/r1 each."""
    material = Elasticity(lam=1.3, mu=0.7)
    V, dofs = tip_space(points, at_end, material=material, order=4)
    body, length = V.body, V.body.cracks[0].length
    r = np.array([0.1, 0.4, 0.9]) * R0
    on = on_crack(body, length - r if at_end else r)
    opening = np.sqrt(r / (2 * np.pi)) * (material.kappa + 1) / material.mu
    n = left_normal(*points)
    t = np.array([n[1], -n[0]])
    for m, dof in enumerate(dofs):
        u = basis_function(V, dof)
        assert Jump(u)(on) == pytest.approx(np.outer(opening * (-r / R1) ** (m // 2), (n, t)[m % 2]), abs=1e-13)
        for side in ("plus", "minus", "larger"):
            stress = material.Stress(Strain(u, side))(on).reshape(-1, 2, 2)
            assert stress @ n == pytest.approx(np.zeros((3, 2)), abs=1e-12 / np.sqrt(2 * np.pi * r[0]))


def test_modes_are_in_equilibrium():
    """div σ = 0 inside r0 by central differences of the stress."""
    material = Elasticity(lam=1.3, mu=0.7)
    V, dofs = tip_space(*CRACKS["end"], material=material, order=4)
    tip, step = frame(*CRACKS["end"])[0], 1e-6
    for dof in dofs:
        stress = material.Stress(Strain(basis_function(V, dof)))
        at = lambda p: np.array(stress(MESH(*p))).reshape(2, 2)
        for angle in (-2.5, -1, 0.3, 2):
            p = tip + 0.6 * R0 * np.array([np.cos(angle), np.sin(angle)])
            divergence = sum((at(p + step * e) - at(p - step * e))[:, k] / (2 * step) for k, e in enumerate(np.eye(2)))
            assert np.abs(divergence).max() < 1e-6 * np.abs(at(p)).max() / R0 * 10


# Heaviside functions

THROUGH = [(0, 0.43), (1, 0.56)]
KINKED = [(0, 0.43), (0.37, 0.52), (0.72, 0.47)]
PLACES = {
    "edge crack": (MESH, [(0, 0.43), (0.58, 0.53)]), "through": (MESH, THROUGH), "interior": (MESH, [(0.22, 0.43), (0.71, 0.53)]),
    "kinked": (MESH, KINKED), "aligned": (structured(6), [(0, 0.5), (0.6, 0.5)]), "through vertices": (structured(6), [(0, 1 / 3), (1, 2 / 3)]),
    "tip on a vertex": (structured(6), [(0, 0.45), (0.5, 0.5)]), "tip on an edge": (structured(6), [(0, 0.45), (0.5, 0.45)]),
}  # fmt: skip
places = pytest.mark.parametrize("mesh, points", PLACES.values(), ids=PLACES.keys())


def pairs(points):
    return list(zip(points, points[1:]))


def meets_interior(points, polygon, samples=4001):
    """Points of the crack inside a counter-clockwise convex polygon."""
    found = []
    for p, q in pairs(points):
        line = np.asarray(p) + np.linspace(0, 1, samples)[:, None] * np.subtract(q, p)
        distances = [(line - polygon[i - 1]) @ left_normal(polygon[i - 1], polygon[i]) for i in range(len(polygon))]
        found.append(line[np.min(distances, axis=0) > 1e-9])
    return np.concatenate(found)


def star_is_cut(mesh, vertex, points, tips):
    """Whether the crack divides the open star of a vertex: it passes inside and does not end there.

    Inside: in the open triangles, on the open edges that meet in the vertex, or through the vertex.
    """
    crossed = False
    line = np.concatenate([np.asarray(p) + np.linspace(0, 1, 2001)[:, None] * np.subtract(q, p) for p, q in pairs(points)])
    for element in mesh.vertices[vertex].elements:
        corners = [mesh[v].point for v in mesh[element].vertices]
        numbers = [v.nr for v in mesh[element].vertices]
        i = numbers.index(vertex)
        opposite = (corners[(i + 1) % 3], corners[(i + 2) % 3])
        normal = left_normal(*opposite)
        others = [left_normal(corners[i], opposite[0]), left_normal(opposite[1], corners[i])]

        def meets(places):
            """Whether one of the places, an array (n, 2), lies inside."""
            beside = [(places - np.asarray(corners[i])) @ n > -1e-9 for n in others]
            return bool(np.all([(places - np.asarray(opposite[0])) @ normal > 1e-9, *beside], axis=0).any())

        if tips and meets(np.array(tips)):
            return False
        crossed |= meets(line)
    return crossed


@places
def test_the_enriched_vertices_are_those_with_divided_support(mesh, points):
    body = CrackedMesh(mesh, Crack(points))
    V = CrackFESpace(body, order=1, tip=None)
    enriched = {V.Heaviside(j)[0] for j in range(V.num_heaviside)}
    tips = [tip.point for tip in body.tips]
    assert enriched == {v.nr for v in mesh.vertices if star_is_cut(mesh, v.nr, points, tips)}


@pytest.mark.parametrize("order, bubble", [(2, False), (3, False), (4, False), (1, True)])
def test_enriched_edges_and_cells(order, bubble):
    """A cell function where the cell is Cut, an edge function where a neighbour is and none holds the tip."""
    body = CrackedMesh(MESH, Crack(PLACES["edge crack"][1]))
    V = CrackFESpace(body, order=order, tip=None, bubble=bubble)
    enriched = {V.Heaviside(j)[0] for j in range(V.num_heaviside)}
    kind = {place.element: place.kind.name for place in body.Elements(0)}
    for element in MESH.Elements():
        cell = cell_dofs(V.scalar_space, element)
        assert cell <= enriched if kind.get(element.nr) == "Cut" else not cell & enriched
    for edge in MESH.edges:
        kinds = {kind.get(element.nr) for element in edge.elements}
        expected = "Cut" in kinds and "Tip" not in kinds
        dofs = set(V.scalar_space.GetDofNrs(edge))
        assert dofs <= enriched if expected else not dofs & enriched


def cell_dofs(space, element):
    shared = {d for v in element.vertices for d in space.GetDofNrs(v)} | {d for e in element.edges for d in space.GetDofNrs(e)}
    return set(space.GetDofNrs(element)) - shared


@places
def test_heaviside_functions_are_continuous_off_the_crack(mesh, points):
    """Across every edge, at points off the crack, from both neighbours; and they vanish with φ_i."""
    body = CrackedMesh(mesh, Crack(points))
    u = random_function(CrackFESpace(body, order=2, tip=None))
    crack = body.cracks[0]
    for edge in mesh.edges:
        a, b = (np.array(mesh[v].point) for v in edge.vertices)
        n = 1e-10 * left_normal(a, b)
        for t in (0.21, 0.77):
            p = a + t * (b - a)
            nearest = np.array(crack.PointAt(crack.ArcLength(tuple(p))))
            if len(edge.elements) == 2 and np.hypot(*(p - nearest)) > 1e-3:
                assert u(mesh(*(p + n))) == pytest.approx(u(mesh(*(p - n))), abs=1e-7)


@places
def test_jumps_on_the_crack(mesh, points):
    """Jump = Plus - Minus, the limits from either side, and Σ b_i φ_i."""
    body = CrackedMesh(mesh, Crack(points))
    V = CrackFESpace(body, order=3, tip=None)
    u, nodal = random_function(V), GridFunction(H1(mesh, order=3))
    for j in range(V.num_heaviside):
        nodal.vec[V.Heaviside(j)[0]] += u.vec[V.HeavisideDof(j, 1)]
    crack = body.cracks[0]
    for s in np.random.default_rng(3).uniform(0.01, 0.99, 20) * crack.length:
        on, p = on_crack(body, [s]), np.array(crack.PointAt(s))
        q = crack.PointAt(s + 1e-6)
        n = 2e-6 * left_normal(p, q)  # NGSolve finds elements to 1e-7 only
        beside = lambda sign: 2 * np.array(u(mesh(*(p + sign * n)))) - np.array(u(mesh(*(p + 2 * sign * n))))
        jump = Jump(u)(on)[0]
        assert jump == pytest.approx(Plus(u)(on)[0] - Minus(u)(on)[0], abs=1e-14)
        assert jump[1] == pytest.approx(nodal(on).item(), abs=1e-13)
        assert jump == pytest.approx(beside(1) - beside(-1), abs=1e-6)


def test_a_mouth_at_a_reentrant_corner_divides_only_along_the_crack():
    """Where the straight extension of the crack beyond its mouth runs through the body again."""
    from netgen.geom2d import SplineGeometry
    from ngsolve import Mesh

    geometry = SplineGeometry()
    corners = [geometry.AppendPoint(*p) for p in [(-1, -1), (0, -1), (0, 0), (1, 0), (1, 1), (-1, 1)]]
    for i in range(6):
        geometry.Append(["line", corners[i], corners[(i + 1) % 6]])
    mesh = Mesh(geometry.GenerateMesh(maxh=0.3))
    V = CrackFESpace(CrackedMesh(mesh, Crack([(0, 0), (0.5, 0.4)])), order=1, tip=None)
    u = random_function(V)
    angles = np.radians(np.arange(45, 268, 0.5))  # between the crack and the lower side of the corner
    values = np.array([u(mesh(0.03 * np.cos(a), 0.03 * np.sin(a))) for a in angles])
    assert np.abs(np.diff(values, axis=0)).max() < 0.05


# Operators

OPERATORS = {
    "value": (lambda w: w, "dx"), "grad": (Grad, "dx"), "plus": (Plus, "dcrack"), "minus": (Minus, "dcrack"), "jump": (Jump, "dcrack"),
    **{f"grad {s}": (lambda w, s=s: Gradient(w, s), "dcrack") for s in ("plus", "minus", "larger")},
    "grad jump": (lambda w: w.Operator("gradjump"), "dcrack"),
}  # fmt: skip
operators = pytest.mark.parametrize("operator, measure", OPERATORS.values(), ids=OPERATORS.keys())
SPACES = {
    "P1": dict(order=1, tip=None), "P2, branch": dict(order=2, tip=TipEnrichment(r1=0.25, functions="branch")),
    "P3, modes": dict(order=3, tip=TipEnrichment(r1=0.25, material=Elasticity(1, 1))), "P1+": dict(order=1, bubble=True, tip=None),
}  # fmt: skip
spaces = pytest.mark.parametrize("options", SPACES.values(), ids=SPACES.keys())
BODY = CrackedMesh(MESH, Crack(PLACES["edge crack"][1]))


def scalar_one():
    """1, evaluated point by point: it has no SIMD version, which makes NGSolve leave SIMD in the forms that it is in."""
    return VoxelCoefficient((-9, -9), (9, 9), np.ones((2, 2)), linear=False)


def without_simd(integral, space):
    integrator = integral[0].MakeBFI()
    integrator.simd_evaluate = False
    form = BilinearForm(space)
    form += integrator
    return to_scipy(form.Assemble().mat)


@operators
@spaces
def test_simd_and_scalar_evaluation_agree(operator, measure, options):
    V = CrackFESpace(BODY, **options)
    u, v = V.TnT()
    form, dw = InnerProduct(operator(u), operator(v)), getattr(BODY, measure)
    simd = matrix(form * dw)
    for scalar in (without_simd(form * dw, V), matrix(scalar_one() * form * dw)):
        assert abs(simd - scalar).max() <= 1e-13 * abs(simd).max()


@operators
@spaces
def test_apply_linearise_and_energy_agree_with_the_matrix(operator, measure, options):
    V = CrackFESpace(BODY, **options)
    u, v = V.TnT()
    dw, w = getattr(BODY, measure), random_function(V)
    form = BilinearForm(InnerProduct(operator(u), operator(v)) * dw).Assemble()
    expected = array((form.mat * w.vec).Evaluate())
    tolerance = 1e-12 * np.abs(expected).max()
    result = w.vec.CreateVector()
    for one in (1, scalar_one()):
        other = BilinearForm(one * InnerProduct(operator(u), operator(v)) * dw)
        other.Apply(w.vec, result)
        assert array(result) == pytest.approx(expected, abs=tolerance)
        other.AssembleLinearization(w.vec)
        assert array((other.mat * w.vec).Evaluate()) == pytest.approx(expected, abs=tolerance)
    assert form.Energy(w.vec) == pytest.approx(0.5 * expected @ array(w.vec), rel=1e-11)


@operators
@spaces
def test_linear_forms_agree_with_matrices(operator, measure, options):
    """∫ op(w):op(v) with a GridFunction w is row by row the matrix times w; with SIMD and without."""
    V = CrackFESpace(BODY, **options)
    (u, v), w = V.TnT(), random_function(V)
    measure = getattr(BODY, measure)
    # of the same order: NGSolve lowers that of matrices by the derivatives, and products of gradients at a tip depend on the rule
    dw, dw_vector = measure(bonus_intorder=2), measure(bonus_intorder=0 if operator(u).dim == 4 else 2)
    expected = matrix(InnerProduct(operator(u), operator(v)) * dw) @ array(w.vec)
    loads = [vector(one * InnerProduct(operator(w), operator(v)) * dw_vector) for one in (1, scalar_one())]
    assert np.abs(np.subtract(loads, expected)).max() < 1e-12 * np.abs(expected).max()
    if operator(u).dim == 2:
        energy = Integrate(InnerProduct(operator(w), operator(w)) * measure(bonus_intorder=8), MESH)
        assert energy == pytest.approx(expected @ array(w.vec), rel=1e-9)


@spaces
def test_gradients_by_differences(options):
    u = random_function(CrackFESpace(BODY, **options))
    for p in np.random.default_rng(5).uniform(0.05, 0.95, (30, 2)):
        step = 1e-6 * np.eye(2)
        if len({MESH(*(p + e)).nr for e in (*step, *-step)}) == 1 and abs(p[1] - 0.43 - p[0] * 0.1 / 0.58) > 1e-3:
            assert Grad(u)(MESH(*p)) == pytest.approx(central_differences(u, p, 1e-6), abs=1e-5)


@pytest.mark.parametrize("points", [THROUGH, [(0, 0.47), (0.5, 0.52), (1, 0.44)]], ids=["straight", "kinked"])
@pytest.mark.parametrize("order, bubble", [(1, False), (1, True), (2, False), (3, False), (4, False)])
def test_polynomials_on_either_side_are_reproduced(order, bubble, points):
    body = CrackedMesh(MESH, Crack(points))
    V = CrackFESpace(body, order=order, bubble=bubble)
    u, v = V.TnT()
    line = [p[1] + (x - p[0]) * (q[1] - p[1]) / (q[0] - p[0]) for p, q in pairs(points)]
    side = IfPos(y - (line[0] if len(line) == 1 else IfPos(0.5 - x, *line)), 1, 0)
    f = CF((side * (1 + x - y) ** order + (1 - side) * (x - 2 * y) ** order, side * (x + y) ** order - (1 - side) * y**order))
    mass = matrix(InnerProduct(u, v) * body.dx).toarray()
    load = vector(InnerProduct(f, v) * body.dx)
    scale = 1 / np.sqrt(mass.diagonal())
    w = GridFunction(V)
    w.vec.FV().NumPy()[:] = scale * np.linalg.lstsq(mass * np.outer(scale, scale), scale * load, rcond=1e-13)[0]
    error = Integrate(InnerProduct(w - f, w - f) * body.dx(bonus_intorder=4), MESH)
    assert np.sqrt(error) < (1e-11 if order < 4 else 1e-9)  # thin parts: the scaled mass matrix of P4 has condition 1e12


@pytest.mark.parametrize("order", [1, 2, 3])
def test_stiffness_is_exact_on_cut_elements(order):
    """A higher order of the rule changes nothing: no point lies on the crack, no degree is missed."""
    V = CrackFESpace(CrackedMesh(MESH, Crack(THROUGH)), order=order)
    u, v = V.TnT()
    usual, higher = (matrix(InnerProduct(Grad(u), Grad(v)) * V.body.dx(bonus_intorder=b)) for b in (0, 5))
    assert abs(usual - higher).max() < 1e-13 * abs(higher).max() * 100


def test_two_threads_assemble_the_same_matrix():
    V = CrackFESpace(BODY, order=2, tip=TipEnrichment(r1=0.25, functions="branch"))
    u, v = V.TnT()
    form = InnerProduct(Strain(u), Strain(v)) * BODY.dx + Jump(u) * Jump(v) * BODY.dcrack
    alone = matrix(form)
    with threads():
        together = matrix(form)
        load = vector(CF((x, y)) * v * BODY.dx)
    assert abs(alone - together).max() < 1e-14 * abs(alone).max()
    assert load == pytest.approx(vector(CF((x, y)) * v * BODY.dx), abs=1e-15)


CRACKS_WITH_TIPS = {
    "one tip": ([(0, 0.43), (0.58, 0.53)], TipEnrichment(r1=0.25, functions="branch")), "disks that touch": ([(0.44, 0.43), (0.58, 0.53)], TipEnrichment(functions="branch")),
    "modes": ([(0.3, 0.43), (0.7, 0.53)], [TipEnrichment(material=Elasticity(1, 1), order=order) for order in (3, 1)]), "no tip functions": ([(0.3, 0.43), (0.7, 0.53)], None),
}  # fmt: skip


@pytest.mark.parametrize("points, tip", CRACKS_WITH_TIPS.values(), ids=CRACKS_WITH_TIPS.keys())
@pytest.mark.parametrize("flags", [dict(), dict(symmetric=True), dict(condense=True)], ids=["", "symmetric", "condense"])
def test_crack_bilinear_form_has_the_matrix_of_the_bilinear_form(points, tip, flags):
    """Not symmetric, with threads, twice."""
    body = CrackedMesh(MESH, Crack(points))
    V = CrackFESpace(body, order=3, tip=tip)
    u, v = V.TnT()
    for integrand in (InnerProduct(Strain(u), Strain(v)), InnerProduct(Strain(u), Grad(v)) + x * Grad(u)[0, 1] * v[0] + u * v):
        forms = [F(V, **flags) for F in (BilinearForm, core.CrackBilinearForm)]
        for form in forms:
            form += integrand * body.dx + Jump(u) * Jump(v) * body.dcrack
            with threads():
                form.Assemble()
            form.Assemble()
        plain, crack = (to_scipy(form.mat) for form in forms)
        assert abs(plain - crack).max() < 1e-14 * abs(plain).max()


@pytest.mark.parametrize("order, bubble", [(3, False), (1, True)])
def test_static_condensation_changes_no_solution(order, bubble):
    V = CrackFESpace(BODY, order=order, bubble=bubble, dirichlet="left|right", tip=None)
    u, v = V.TnT()
    load = LinearForm(CF((1, x)) * v * BODY.dx).Assemble()
    solutions = []
    for condense in (False, True):
        form = BilinearForm(InnerProduct(Grad(u), Grad(v)) * BODY.dx, condense=condense).Assemble()
        w, rhs = GridFunction(V), load.vec.Copy()
        if condense:
            rhs.data += form.harmonic_extension_trans * rhs
        w.vec.data = form.mat.Inverse(V.FreeDofs(condense), inverse="umfpack") * rhs
        if condense:
            w.vec.data += form.harmonic_extension * w.vec
            w.vec.data += form.inner_solve * rhs
        solutions.append(array(w.vec))
    assert solutions[1] == pytest.approx(solutions[0], abs=1e-8 * np.abs(solutions[0]).max())


def test_dirichlet_dofs_are_those_with_a_trace_on_the_boundary():
    """Including the Heaviside functions at a mouth: with all of them zero a function vanishes there on both sides."""
    V = CrackFESpace(BODY, order=2, dirichlet="left")
    u, free = random_function(V), V.FreeDofs()
    for i in range(V.ndof):
        if not free[i]:
            u.vec[i] = 0
    assert Integrate(InnerProduct(u, u) * BODY.ds("left"), MESH) == 0
    for i in range(V.ndof):
        if not free[i]:
            assert Integrate(InnerProduct(basis_function(V, i), basis_function(V, i)) * BODY.ds("left"), MESH) > 0


@pytest.mark.parametrize(
    "options", [dict(cutoff="cubic", functions="branch"), dict(cutoff="septic", material=Elasticity(1, 1), order=3)], ids=["branch", "modes"]
)
def test_pickled_spaces_share_their_body(options):
    V = CrackFESpace(BODY, order=2, dirichlet="left", tip=TipEnrichment(r1=0.25, **options))
    u = random_function(V)
    V2, body, u2 = pickle.loads(pickle.dumps((V, BODY, u)))
    assert V2.body is body and u2.space.body is body and V2.mesh is body.mesh
    assert type(V2) is CrackFESpace and V2.ndof == V.ndof and str(V2.FreeDofs()) == str(V.FreeDofs())
    assert V2.tip_specs[0].r1 == 0.25 and V2.tip_specs[0].cutoff == V.tip_specs[0].cutoff and V2.tip_specs[0].order == V.tip_specs[0].order
    assert array(u2.vec) == pytest.approx(array(u.vec), abs=0)
    for p in ((0.1, 0.3), (0.55, 0.5), (0.6, 0.6)):
        assert u2(body.mesh(*p)) == pytest.approx(u(MESH(*p)), abs=1e-15)
    energy = Integrate(InnerProduct(Grad(u2), Grad(u2)) * body.dx, body.mesh)
    assert energy == pytest.approx(Integrate(InnerProduct(Grad(u), Grad(u)) * BODY.dx, MESH), rel=1e-14)
