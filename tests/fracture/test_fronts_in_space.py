"""K and G along fronts in space, of exact fields, of what is added to them without a change of K, of fields on a mesh, and what is refused."""

import numpy as np
import pytest
from ngsolve import CF, Grad, GridFunction, Id, IfPos, Mesh, Trace, VectorL2, sqrt, x, y, z
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import Crack, CrackedMesh, Elasticity
from ngsxfem_contact.exact.pennies import bent_penny, closed_penny, ellipse, penny_in_tension, sheared_penny, twisted_penny
from ngsxfem_contact.exact.straight_fronts import straight_front
from ngsxfem_contact.fracture.front_fields import FrontField
from ngsxfem_contact.fracture.front_stress_intensity import front_factors
from ngsxfem_contact.fracture.front_tube import FrontCurve, Hats, TubeRule, points_on_sheet
from ngsxfem_contact.geometry import Sheet

MATERIAL = Elasticity.PlaneStrain(E=2.6, nu=0.3)
MESH = MakeStructured3DMesh(hexes=False, nx=14, ny=14, nz=14)
ORIGIN, A, B = np.array([0.5, 0.51, 0.49]), 0.28, 0.22
NORMAL = np.array([0.2, -0.1, 1.0]) / np.linalg.norm([0.2, -0.1, 1.0])
FIRST = np.cross([0.0, 1, 0], NORMAL) / np.linalg.norm(np.cross([0.0, 1, 0], NORMAL))
AXES = np.array([FIRST, np.cross(NORMAL, FIRST), NORMAL])
DISK = CrackedMesh(MESH, Sheet.Disk(ORIGIN, NORMAL, A))
FINE, COARSE = TubeRule(6, 5, 32), TubeRule(4, 4, 24)
FORMS = {
    "tension": penny_in_tension(MATERIAL, A),
    "bending": penny_in_tension(MATERIAL, A, 0.3) + bent_penny(MATERIAL, A, 1.6),
    "shear": sheared_penny(MATERIAL, A),
    "torsion": twisted_penny(MATERIAL, A),
    "closed": closed_penny(MATERIAL, A, 1, 1.5, 0.3),
    "ellipse": ellipse(MATERIAL, A, B),
}


def field_of(form, **more):
    faces = {side: form.Fields(side)[1] for side in ("plus", "minus")}
    return FrontField(form.gradient, faces, dict.fromkeys(faces, form.face_traction), **more)


def factors_of(found):
    return np.stack([found.K_I, found.K_II, found.K_III], axis=-1)


def error_of(found, form, part=slice(None)):
    """The largest, relative to the largest K."""
    exact = form.Factors(found.points[part])
    return np.abs(factors_of(found)[part] - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize("name", FORMS)
def test_K_and_G_of_closed_forms(name):
    """On curved fronts in a plane that is unrelated to the mesh, with traction on the faces."""
    form = FORMS[name].At(ORIGIN, AXES)
    body = CrackedMesh(MESH, Sheet.Ellipse(ORIGIN, A * AXES[0], B * AXES[1])) if name == "ellipse" else DISK
    found = front_factors(body, field_of(form), MATERIAL, nodes=16, rule=FINE)
    assert error_of(found, form) < (3e-3 if name == "ellipse" else 1e-3)
    exact = form.Factors(found.points)
    G = (exact[:, 0] ** 2 + exact[:, 1] ** 2) / MATERIAL.E_prime + exact[:, 2] ** 2 / (2 * MATERIAL.mu)
    assert np.abs(found.G - G).max() < 5e-3 * G.max() and np.abs(found.irwin - G).max() < 5e-3 * G.max()
    assert found.errors.max() < 0.02 * np.abs(exact).max()


def test_the_error_falls_with_the_rule():
    form = FORMS["tension"].At(ORIGIN, AXES)
    errors = [error_of(front_factors(DISK, field_of(form), MATERIAL, nodes=24, rule=rule), form) for rule in (TubeRule(2, 2, 12), COARSE, FINE)]
    assert errors[1] < 0.1 * errors[0] and errors[2] < 0.1 * errors[1] and errors[2] < 2e-5


@pytest.mark.parametrize("name", ["bending", "shear"])
def test_the_error_falls_with_the_fourth_power_of_the_spacing(name):
    form = FORMS[name].At(ORIGIN, AXES)
    coarse, fine = (error_of(front_factors(DISK, field_of(form), MATERIAL, nodes=nodes, rule=TubeRule(5, 5, 40)), form) for nodes in (8, 16))
    assert 12 < coarse / fine < 20


def straight(angle):
    """The half plane behind a front through the middle of the cube that has an angle with the y-axis, and the fields there."""
    c, s = np.cos(angle), np.sin(angle)
    axes, origin = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0, 1]]), np.array([0.47, 0.5, 0.53])
    corners = np.array([(-2, -2, 0), (0, -2, 0), (0, 2, 0), (-2, 2, 0)]) @ axes + origin
    return CrackedMesh(MESH, Sheet.Polygon(corners)), straight_front(MATERIAL, 1, 0.7, -0.4).At(origin, axes)


@pytest.mark.parametrize("angle", [0, 0.5])
def test_straight_fronts_that_end_on_the_boundary(angle):
    """Where ∂Ω is normal to the front up to the ends, else as far as discs have room: to round-off, the field has no other terms."""
    body, form = straight(angle)
    found = front_factors(body, field_of(form), MATERIAL, radius=0.3, rule=FINE)
    assert error_of(found, form) < 1e-10
    assert np.abs(found.G - 1.49 / MATERIAL.E_prime - 0.16 / (2 * MATERIAL.mu)).max() < 1e-10
    missing = [found.s.min(), body.fronts[0].length - found.s.max()]
    expected = 0.3 * np.tan(angle)
    assert missing == pytest.approx([expected, expected], abs=0.3 * FrontCurve(body, 0).h)


def test_fronts_with_corners_have_parts():
    """Three sides of a square away from its corners; the fields are those of the first side."""
    body = CrackedMesh(MESH, Sheet.Polygon([(0.52, 0.2, 0.52), (0.52, 0.8, 0.52), (-0.1, 0.8, 0.52), (-0.1, 0.2, 0.52)]))
    form = straight_front(MATERIAL, 1, 0.7, -0.4).At((0.52, 0, 0.52))
    found = front_factors(body, field_of(form), MATERIAL, radius=0.14, rule=FINE)
    on_side = np.abs(found.points[:, 0] - 0.52) < 1e-12
    assert 5 <= on_side.sum() < len(found.s) and error_of(found, form, on_side) < 1e-10
    assert found.points[on_side, 1].min() > 0.2 + 0.13 and found.points[on_side, 1].max() < 0.8 - 0.13  # tubes of two sides overlap behind a corner


STRETCH = CF((0.3 * x * y + 0.2 * z * z, x * x - 0.4 * y * z, 0.5 * x * z + 0.3 * y * y))


def gradient_of(u):
    return CF(tuple(u[i].Diff(v) for i in range(3) for v in (x, y, z)), dims=(3, 3))


def stress_of(gradient):
    return MATERIAL.mu * (gradient + gradient.trans) + MATERIAL.lam * Trace(gradient) * Id(3)


def divergence(stress):
    return CF(tuple(sum(stress[i, j].Diff(v) for j, v in enumerate((x, y, z))) for i in range(3)))


@pytest.mark.parametrize("sign", [1, -1], ids=["body force", "given stress"])
def test_what_leaves_K_alone(sign):
    """A smooth displacement under its body force and tractions; or taken away, where its stress is given."""
    form, gradient = FORMS["closed"].At(ORIGIN, AXES), gradient_of(STRETCH)
    stress, normal = stress_of(gradient), CF(tuple(NORMAL))
    field = field_of(form)
    field.gradient = field.gradient + sign * gradient
    field.faces = {side: face + sign * gradient for side, face in field.faces.items()}
    if sign == 1:
        field.body_force = -divergence(stress)
        field.traction = {side: traction + stress * normal for side, traction in field.traction.items()}
    else:
        field.given, field.given_change = stress, tuple(stress.Diff(v) for v in (x, y, z))
    found = front_factors(DISK, field, MATERIAL, nodes=16, rule=FINE)
    assert error_of(found, form) < 2e-3
    assert found.G == pytest.approx(found.irwin, rel=0.02)


def test_where_the_curvature_jumps():
    """Around a stadium of segments and arcs a smooth displacement has no K, to the accuracy of the rule: the modes need forces where they meet."""
    arcs = [Crack.Arc((0.1, -0.2), (0.3, 0), (0.1, 0.2)), Crack.Arc((-0.1, 0.2), (-0.3, 0), (-0.1, -0.2))]
    stadium = Crack.Join(Crack([(-0.1, -0.2), (0.1, -0.2)]), arcs[0], Crack([(0.1, 0.2), (-0.1, 0.2)]), arcs[1])
    gradient = gradient_of(STRETCH)
    stress = stress_of(gradient)
    traction = stress * CF((0, 0, 1))
    field = FrontField(gradient, traction={"plus": traction, "minus": traction}, body_force=-divergence(stress))
    body = CrackedMesh(MESH, Sheet([stadium], (0.5, 0.5, 0.51)))
    found = front_factors(body, field, MATERIAL, nodes=16, radius=0.15, rule=TubeRule(8, 6, 40))
    assert np.abs(factors_of(found)).max() < 1e-6 and np.abs(found.G).max() < 1e-6  # of some units


def test_a_hole_in_a_sheet_with_K_that_varies():
    """At the inner front of a ring (κ < 0): modes times functions of the angle, with the body force and tractions that they need, found by symbolic derivatives."""
    inner, place = 0.22, (0.5, 0.51, 0.49)
    X, Y, Z = x - place[0], y - place[1], z - place[2]
    rho = sqrt(X * X + Y * Y)
    ahead = inner - rho
    r = sqrt(ahead * ahead + Z * Z)
    weight, mu, nu = 1 + 0.5 * X / rho, MATERIAL.mu, MATERIAL.nu

    def parts(side):
        """u, its gradient and stress; on a face cos(θ/2) = 0."""
        large = sqrt(0.5 * (r + IfPos(ahead, ahead, -ahead)))
        small = 0.5 * IfPos(Z, Z, -Z) / large
        sign = IfPos(Z, 1, -1) if side is None else CF(side)
        c, s = (IfPos(ahead, large, small), sign * IfPos(ahead, small, large)) if side is None else (0.5 * sign * Z / large, sign * large)
        scale = weight / (2 * mu * np.sqrt(2 * np.pi))
        kappa, cc, ss = 3 - 4 * nu, c * c / r, s * s / r
        out, up = scale * s * (kappa + 1 + 2 * cc), -scale * c * (kappa - 1 - 2 * ss)  # mode II
        turn = 4 * scale * s  # mode III; e₁ = -e_ρ, e₃ = e₁ × e_z = e_φ
        u = CF(((-out * X - turn * Y) / rho, (-out * Y + turn * X) / rho, up))
        gradient = gradient_of(u)
        return gradient, stress_of(gradient)

    body = CrackedMesh(MESH, Sheet.Ring(place, (0, 0, 1), inner, 0.46))
    gradient, stress = parts(None)
    faces = {side: parts(sign) for side, sign in (("plus", 1), ("minus", -1))}
    traction = {side: stress * CF((0, 0, 1)) for side, (_, stress) in faces.items()}
    field = FrontField(gradient.Compile(), {side: f[0].Compile() for side, f in faces.items()}, traction, body_force=-divergence(stress).Compile())
    found = front_factors(body, field, MATERIAL, front=1, nodes=12, radius=0.17, rule=TubeRule(3, 4, 32))
    angle = np.arctan2(*(found.points - place).T[[1, 0]])
    exact = (1 + 0.5 * np.cos(angle))[:, None] * [0, 1, 1]
    assert np.abs(factors_of(found) - exact).max() < 2e-3


def test_faces_that_press_on_each_other():
    form = FORMS["closed"].At(ORIGIN, AXES)
    plain = front_factors(DISK, field_of(form), MATERIAL, rule=COARSE)
    pressed = front_factors(DISK, field_of(form, pressure=form.pressure, doubt=0.1 * form.face_traction), MATERIAL, rule=COARSE)
    assert np.abs(plain.K_I).max() > 0 == np.abs(pressed.K_I).max() and (pressed.errors[:, 0] == 0).all()
    assert (pressed.by_radius[..., 0] == plain.by_radius[..., 0]).all() and (pressed.K_II == plain.K_II).all()
    off = field_of(form)
    off.traction = {side: 1.1 * traction for side, traction in off.traction.items()}
    change = np.abs(factors_of(front_factors(DISK, off, MATERIAL, rule=COARSE)) - factors_of(plain))[:, 1:]
    assert (change <= pressed.errors[:, 1:] * (1 + 1e-9) + 1e-3).all() and change.max() > 0.01


@pytest.mark.parametrize("order, bound", [(1, 0.06), (2, 0.02)])
def test_fields_on_a_mesh(order, bound):
    """The projection onto polynomials on each element, the sheet along faces of the mesh: errors of some percent near the front."""
    mesh = MakeStructured3DMesh(hexes=False, nx=16, ny=16, nz=16)
    place = (0.503, 0.497, 0.5)
    form = (penny_in_tension(MATERIAL, 0.3) + sheared_penny(MATERIAL, 0.3)).At(place)
    field, u = field_of(form), GridFunction(VectorL2(mesh, order=order))
    u.Set(form.u)
    field.gradient = Grad(u)
    found = front_factors(CrackedMesh(mesh, Sheet.Disk(place, (0, 0, 1), 0.3)), field, MATERIAL)
    exact = form.Factors(found.points)
    error = np.abs(factors_of(found) - exact)
    assert 1e-3 < error.max() / exact.max() < bound
    assert (error <= found.errors).mean() > 0.6 and found.errors.max() < 10 * bound * exact.max()


def test_hats_give_back_parabolas():
    for closed in (False, True):
        hats = Hats(0.2, 1.4, 7, closed)
        x, w = np.polynomial.legendre.leggauss(3)
        s = (0.2 + hats.width * (np.arange(7)[:, None] + 0.5 * (1 + x))).ravel()
        ds = np.tile(0.5 * hats.width * w, 7)
        f = (lambda s: np.full_like(s, 2.5)) if closed else (lambda s: 1 - 2 * s + 3 * s * s)
        moments = hats.Sum(s, (ds * f(s))[:, None])
        for window in (3, 5):
            assert hats.Values(moments, window)[:, 0] == pytest.approx(f(hats.nodes), rel=1e-12)
        assert hats.weights.sum() == pytest.approx(1.2, rel=1e-14) == hats.Sum(s, ds[:, None]).sum()
        slopes = hats.Sum(s, 0 * ds[:, None], (ds * f(s))[:, None])  # ∫ N' f
        assert slopes.sum() == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize("height", [0.5, 0.53])
def test_points_on_a_sheet(height):
    """In the elements that carry it, also where it lies along faces of the mesh; and where they were."""
    body = CrackedMesh(MESH, Sheet.Disk((0.5, 0.51, height), (0, 0, 1), 0.3))
    rng = np.random.default_rng(1)
    points = np.stack([*rng.uniform(0.31, 0.69, (2, 300)), np.full(300, height)], axis=-1)
    at = points_on_sheet(body, 0, points)
    assert set(at["nr"]) <= {cell.element for cell in body.Elements(0)}
    assert np.abs(CF((x, y, z))(at) - points).max() < 1e-13


def test_the_table(tmp_path):
    body, form = straight(0)
    found = front_factors(body, field_of(form), MATERIAL, nodes=5, rule=FINE)
    table = found.table
    assert len(table) == 6 and table.K_III == pytest.approx(-0.4) and (table.s == found.s).all() and table.G == pytest.approx(table.irwin)
    lines = table.SaveCSV(tmp_path / "front.csv").read_text().splitlines()
    assert lines[0] == "front,s,x,y,z,K_I,K_II,K_III,K_I_error,K_II_error,K_III_error,G,G_error,irwin" and len(lines) == 7


MOVED = CrackedMesh(MESH, Sheet.Disk(ORIGIN + [0.15, 0, 0], NORMAL, A))
TWO = CrackedMesh(MESH, Sheet.Disk((0.5, 0.5, 0.34), (0, 0, 1), 0.4), Sheet.Disk((0.5, 0.5, 0.52), (0, 0, 1), A))
SMALL = CrackedMesh(MESH, Sheet.Disk(ORIGIN, NORMAL, 0.13))


@pytest.mark.parametrize(
    "match, body, options",
    [
        ("there is no front 1", DISK, dict(front=1)),
        ("front 0 meets the boundary of the body at", MOVED, dict(radius=0.2)),
        ("meets its own centre of curvature at", DISK, dict(radius=0.24)),
        ("meets another sheet at", TWO, dict(radius=0.2, front=1)),
        ("narrower than an element", DISK, dict(radius=0.1)),
        ("its own centre of curvature at .* refine", SMALL, dict()),
        ("must be 5 or more", DISK, dict(nodes=4)),
        ("must be positive", DISK, dict(radius=-1.0)),
        ("plane stress", DISK, dict(material=Elasticity.PlaneStress(E=1, nu=0.3))),
    ],
)
def test_what_is_refused(match, body, options):
    field = field_of(FORMS["tension"].At(ORIGIN, AXES))
    with pytest.raises(ValueError, match=match):
        front_factors(body, field, **{"material": MATERIAL, **options})


def test_another_material_in_the_tube():
    ngmesh = MakeStructured3DMesh(hexes=False, nx=14, ny=14, nz=14).ngmesh
    for element in ngmesh.Elements3D():
        element.index = 1 + (np.mean([ngmesh[v][2] for v in element.vertices]) > 9 / 14)
    ngmesh.SetMaterial(1, "lower")
    ngmesh.SetMaterial(2, "upper")
    mesh = Mesh(ngmesh)
    material = Elasticity.ByRegion(mesh, {"lower": MATERIAL, "upper": Elasticity.PlaneStrain(E=1, nu=0.2)})
    body, form = CrackedMesh(mesh, Sheet.Disk((0.5, 0.5, 0.49), (0, 0, 1), A)), FORMS["tension"].At((0.5, 0.5, 0.49))
    with pytest.raises(ValueError, match="meets another material at"):
        front_factors(body, field_of(form), material, radius=0.2)
    assert error_of(front_factors(body, field_of(form), material, nodes=12, radius=0.14, rule=FINE), form) < 1e-4


def test_arguments_that_make_no_sense():
    gradient, field = CF(tuple(9 * [x]), dims=(3, 3)), FrontField(CF(tuple(9 * [x]), dims=(3, 3)))
    for make, error, match in (
        (lambda: front_factors(DISK, field, MATERIAL, rule=3), TypeError, "not a TubeRule"),
        (lambda: front_factors(DISK, gradient, MATERIAL), TypeError, "not a FrontField"),
        (lambda: front_factors(MESH, field, MATERIAL), TypeError, "not a body in space"),
        (lambda: front_factors(DISK, FrontField(gradient / (x - x)), MATERIAL, rule=COARSE), ValueError, "not finite"),
        (lambda: FrontField(CF((x, y))), ValueError, "gradient"),
        (lambda: FrontField(gradient, traction={"plus": CF((0, 0, 1))}), ValueError, "give both sides"),
        (lambda: FrontField(gradient, faces={"Plus": gradient, "minus": gradient}), ValueError, "give both sides"),
        (lambda: FrontField(gradient, traction={"plus": 1, "minus": 1}), ValueError, "traction"),
        (lambda: FrontField(gradient, given=gradient, given_change=(gradient,)), ValueError, "given_change has 1 parts"),
    ):
        with pytest.raises(error, match=match):
            make()
