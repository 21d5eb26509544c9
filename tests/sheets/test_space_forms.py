"""Closed forms with cracks in space: equilibrium, tractions of the faces, jumps and K, by differences; arrays against CoefficientFunctions."""

import numpy as np
import pytest
from exact_sheets import axes_of, cube_mesh
from ngsolve import CF, InnerProduct, Integrate
from scipy.special import elliprd

from ngsxfem_contact import Crack, CrackedMesh, Elasticity
from ngsxfem_contact.exact.pennies import (
    bent_penny,
    carlson_rd,
    closed_penny,
    confocal,
    ellipse,
    partially_closed,
    penny,
    penny_in_tension,
    sheared_penny,
    twisted_penny,
)
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.exact.straight_fronts import straight_front
from ngsxfem_contact.geometry import Sheet

MATERIAL = Elasticity.PlaneStrain(E=2.6, nu=0.3)
A, B = 0.8, 0.5
FORMS = {
    "compression": uniform_stress(MATERIAL, stress_matrix(zz=-1, xx=0.4)),
    "penny": penny_in_tension(MATERIAL, A, 0.7),
    "shear": sheared_penny(MATERIAL, A, 1.3),
    "closed": closed_penny(MATERIAL, A, 2, 1.3, 0.25),
    "torsion": twisted_penny(MATERIAL, A),
    "bending": bent_penny(MATERIAL, A, 1.5),
    "partial": partially_closed(MATERIAL, 0.5, 0.9),
    "ellipse": ellipse(MATERIAL, A, B, 1.1),
    "straight": straight_front(MATERIAL, 1, 0.7, -0.4),
}
WITH_FRONT = {
    name: "straight" if name == "straight" else "ellipse" if name == "ellipse" else "circle" for name in FORMS if name not in ("compression", "partial")
}
EACH = pytest.mark.parametrize("name", FORMS)


def points_on(name, number=25):
    """On the crack, away from its front; of the partially closed one on both sides of the circle of contact."""
    rng = np.random.default_rng(3)
    r, t = np.sqrt(rng.uniform(0, 0.9, number)), rng.uniform(0, 2 * np.pi, number)
    X, Y = (A * r * np.cos(t), (B if name == "ellipse" else A) * r * np.sin(t))
    return np.stack([X - (A if name == "straight" else 0), Y, 0 * X], axis=-1)


@EACH
def test_equilibrium(name):
    """div σ = 0, and the gradient is that of u, by differences of order 4."""
    form, points, h = FORMS[name], np.random.default_rng(0).uniform(-1.3, 1.3, (30, 3)), 1e-3
    points[:, 2] += 0.2 * np.sign(points[:, 2])
    derivative = lambda f, j: sum(w * f(points + k * h * np.eye(3)[j]) for k, w in ((1, 8), (-1, -8), (2, -1), (-2, 1))) / (12 * h)
    gradient = form.DisplacementGradient(points)
    size = np.abs(gradient).max()
    assert np.abs(np.stack([derivative(form.Displacement, j) for j in range(3)], axis=-1) - gradient).max() < 1e-7 * size
    assert np.abs(sum(derivative(form.Stress, j)[:, :, j] for j in range(3))).max() < 1e-6 * size


@EACH
@pytest.mark.parametrize("side, sign", [("plus", 1), ("minus", -1)])
def test_tractions_of_the_faces(name, side, sign):
    form, points = FORMS[name], points_on(name)
    given = np.stack([t + 0 * points[:, 0] for t in form.traction(points[:, 0], points[:, 1])], axis=-1)
    assert np.abs(form.Stress(points, side)[:, :, 2] - given).max() < 1e-13
    assert np.abs(form.Stress(points + [0, 0, sign * 1e-10])[:, :, 2] - given).max() < 1e-8  # as one comes to the face
    assert np.abs(form.Displacement(points + [0, 0, sign * 1e-12]) - form.Displacement(points, side)).max() < 1e-10


@EACH
def test_jumps(name):
    form, points = FORMS[name], points_on(name)
    jump = form.Displacement(points, "plus") - form.Displacement(points, "minus")
    assert np.abs(jump - form.Jump(points)).max() < 1e-14
    assert np.abs(jump).max() > 0.1 or name == "compression"


def test_the_partially_closed_crack_is_in_contact():
    form, points = FORMS["partial"], points_on("partial")
    rho, pressure, gap = np.hypot(*points.T[:2]), form.traction(*points.T[:2])[2], form.Jump(points)[:, 2]
    assert ((pressure < 0) == (rho > 0.5)).all() and ((gap > 0) == (rho < 0.5)).all() and np.abs(pressure * gap).max() == 0
    at = 0.5 + 1e-4
    assert form.traction(at, 0.0)[2] == pytest.approx(-8 * 0.9 / np.pi * np.sqrt(1e-4), rel=1e-3)  # (8 p₀/π) √((ρ-c)/(2c))


@pytest.mark.parametrize("name", WITH_FRONT)
def test_K_is_what_the_stress_ahead_says(name):
    """√(2πd) σ at the distance d ahead, extrapolated from two."""
    form, t = FORMS[name], np.linspace(0.1, 6, 7)
    points, ahead = np.stack([A * np.cos(t), A * np.sin(t), 0 * t], axis=-1), np.stack([np.cos(t), np.sin(t), 0 * t], axis=-1)
    if WITH_FRONT[name] == "ellipse":
        points = points * [1, B / A, 1]
        ahead = points / [A**2, B**2, 1]
        ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    if WITH_FRONT[name] == "straight":
        points, ahead = points * [0, 1, 0], np.tile([1.0, 0, 0], (7, 1))
    normal = np.array([0.0, 0, 1])
    frame = np.stack([np.tile(normal, (7, 1)), ahead, np.cross(ahead, normal)], axis=1)

    def at(d):
        traction = form.Stress(points + d * ahead)[:, :, 2]
        return np.sqrt(2 * np.pi * d) * np.einsum("nij,nj->ni", frame, traction)

    d = 1e-8
    K = (np.sqrt(10) * at(d / 10) - at(d)) / (np.sqrt(10) - 1)
    assert np.abs(K - form.Factors(points)).max() < 1e-6


def test_the_circle_is_an_ellipse():
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (40, 3))
    first, second = penny(MATERIAL, A, 0.6), ellipse(MATERIAL, A, A, 0.6)
    assert np.abs(first.DisplacementGradient(points) - second.DisplacementGradient(points)).max() < 1e-13


@pytest.mark.parametrize("a, b", [(1.1, 0.7), (1, 0.05), (1, 0.999), (0.8, 0.8)])
def test_confocal_coordinates(a, b):
    """Also near the front and near the plane."""
    rng, t = np.random.default_rng(2), np.linspace(0, 6, 200)
    front = np.stack([a * np.cos(t), b * np.sin(t), 0 * t], axis=-1) + 10 ** rng.uniform(-8, -1, (200, 1)) * rng.normal(size=(200, 3))
    x, y, z = np.concatenate([rng.uniform(-2, 2, (200, 3)), rng.uniform(-2, 2, (200, 3)) * [1, 1, 1e-7], front]).T
    zeta, w = confocal(x, y, z, a, b)
    assert np.abs(x**2 / (a * a + zeta**2) + y**2 / (b * b + zeta**2) + w**2 - 1).max() < 1e-12
    assert np.abs(zeta * w - z).max() < 1e-15 and zeta.min() >= 0


def test_the_elliptic_integral():
    x, y, z = np.random.default_rng(4).uniform(0.01, 5, (3, 50))
    assert carlson_rd(x, y, z) == pytest.approx(elliprd(x, y, z), rel=1e-14)
    assert carlson_rd(x, 0 * x, z) == pytest.approx(elliprd(x, 0 * x, z), rel=1e-14)


ORIGIN, NORMAL = np.array([0.45, 0.52, 0.47]), np.array([0.3, -0.2, 1])
PLACE = (ORIGIN, [*axes_of(NORMAL), NORMAL / np.linalg.norm(NORMAL)])
SMALL = {
    "ellipse": ellipse(MATERIAL, 0.3, 0.2),
    "closed": closed_penny(MATERIAL, 0.3, 1, 1.5, 0.2),
    "bending": bent_penny(MATERIAL, 0.3, 2),
    "partial": partially_closed(MATERIAL, 0.2),
    "straight": straight_front(MATERIAL, 1, 0.7, -0.4),
}


@pytest.mark.parametrize("name", SMALL)
def test_coefficient_functions_of_placed_forms(name):
    """They are the same numbers as the arrays, on the faces, too."""
    form, mesh = SMALL[name].At(*PLACE), cube_mesh(0.5)
    points = np.random.default_rng(5).uniform(0.1, 0.9, (40, 3))
    at = mesh(*points.T)
    assert np.abs(form.u(at) - form.Displacement(points)).max() < 1e-13
    assert np.abs(form.gradient(at).reshape(-1, 3, 3) - form.DisplacementGradient(points)).max() < 1e-11
    assert np.abs(form.stress(at).reshape(-1, 3, 3) - form.Stress(points)).max() < 1e-11
    body = CrackedMesh(mesh, Sheet([Crack([(-0.2, -0.1), (0, -0.1), (0, 0.1), (-0.2, 0.1), (-0.2, -0.1)])], ORIGIN.tolist(), axes_of(NORMAL).tolist()))
    fields = {side: form.Fields(side)[0] for side in ("plus", "minus")}
    off = fields["plus"] - fields["minus"] - form.opening
    size = Integrate(InnerProduct(form.opening, form.opening) * body.dcrack, mesh)
    assert size > 1e-5 and Integrate(InnerProduct(off, off) * body.dcrack, mesh) < 1e-24
    normal = CF(tuple(PLACE[1][2]))
    along = InnerProduct(form.face_traction, normal) - form.pressure, InnerProduct(form.opening, normal) - form.gap
    assert Integrate(sum(f * f for f in along) * body.dcrack, mesh) < 1e-24


def test_what_cannot_be_added():
    with pytest.raises(ValueError, match="one material, one origin"):
        penny(MATERIAL, A) + penny(MATERIAL, A).At((1, 0, 0))
    with pytest.raises(ValueError, match="the faces stick"):
        closed_penny(MATERIAL, A, 2, 0.3, 0.25)
    with pytest.raises(ValueError, match="turn the ellipse"):
        ellipse(MATERIAL, B, A)
