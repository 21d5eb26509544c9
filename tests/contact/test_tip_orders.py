"""The powers of r at a tip: Williams' expansion in closed form, and what the modes of each order make of it."""

import numpy as np
import pytest
from helpers import MATERIAL, OFFSET, rotated_problem
from ngsolve import Grad, GridFunction

from ngsxfem_contact import CrackedMesh, CrackFESpace, Elasticity, TipEnrichment
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import Pair

OPEN, CLOSED = {"opening": [1, -1, 1]}, {"sliding": [1, 1, 1], "p": 1}


def differences(function, mesh, point, step=1e-5):
    """Of a function's components by x and by y, (2, n)."""
    at = lambda p: np.array(function(mesh(*p)))
    return np.array([(at(point + e) - at(point - e)) / (2 * step) for e in step * np.eye(2)])


@pytest.mark.parametrize("m", range(4))
@pytest.mark.parametrize("kind", ["opening", "sliding"])
def test_williams_expansion_solves_the_problem_of_a_tip(kind, m):
    """By differences: Hooke's law and equilibrium; no traction on the lips, and the jumps that it says."""
    exact, mesh = cf.williams_tip(MATERIAL, **{kind: [0] * m + [1]}), cf.rotated_square(0.3, (0, 0), 0.5)
    at = lambda f, p: np.array(f(mesh(*p)))
    for p in np.array([(0.2, 0.1), (-0.15, 0.2), (-0.2, -0.05), (0.1, -0.3)]):
        strain = differences(exact.u, mesh, p)
        strain = 0.5 * (strain + strain.T)
        stress, slope = MATERIAL.lam * np.trace(strain) * np.eye(2) + 2 * MATERIAL.mu * strain, differences(exact.stress, mesh, p)
        assert at(exact.stress, p) == pytest.approx(stress.ravel(), abs=1e-8)
        assert slope[0, :2] + slope[1, 2:] == pytest.approx([0, 0], abs=1e-7)
    for x in (-0.3, -0.1):
        above, below = (x, 1e-12), (x, -1e-12)
        assert at(exact.stress, above)[2:] == pytest.approx([0, 0], abs=1e-8) and at(exact.stress, below)[2:] == pytest.approx([0, 0], abs=1e-8)
        assert at(exact.u, above) - at(exact.u, below) == pytest.approx([exact.slip(mesh(*above)), exact.gap(mesh(*above))], abs=1e-9)
    ahead = at(exact.stress, (0.1, 0))[3 if kind == "opening" else 1]
    assert ahead == pytest.approx(0.1 ** (m - 0.5) * (2 * m + 1) / np.sqrt(2 * np.pi), rel=1e-12)


def errors(field, order, modes, maxh, angle):
    """(energy, λ, K as a coefficient)."""
    exact = cf.williams_tip(MATERIAL, **field)
    solution = rotated_problem(exact, Pair(order, order - 1), maxh, angle, TipEnrichment(r1=0.4, material=MATERIAL, order=modes)).Solve()
    K = solution.StressIntensity(method="modes")
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), np.abs(np.subtract(tuple(K), (1, 0) if "opening" in field else (0, 1))).max()


def means(field, order, modes, maxhs, angles):
    return np.mean([[errors(field, order, modes, h, angle) for h in maxhs] for angle in angles], axis=0)


@pytest.mark.parametrize("field", [OPEN, CLOSED], ids=["open", "closed"])
def test_P3_keeps_its_order(field):
    """The error of √r alone is a half of what it was to a twelfth, by where the tip lies in its element."""
    angles = 0.1, 0.53
    (coarse, fine), (alone,) = means(field, 3, None, (0.05, 0.025), angles), means(field, 3, 1, (0.025,), angles)
    assert np.log2(coarse[0] / fine[0]) > 2.8
    assert fine[0] < 0.5 * alone[0] and fine[2] < 0.1 * alone[2] and fine[2] < 1e-3


def test_P2_keeps_its_order_at_a_closed_tip():
    angles = 0.1, 0.53
    (coarse, fine), (alone,) = means(CLOSED, 2, None, (0.05, 0.0125), angles), means(CLOSED, 2, 1, (0.0125,), angles)
    assert np.log2(coarse[0] / fine[0]) / 2 > 1.9
    assert (fine < alone * (1, 0.75, 0.9)).all()


def test_the_order_of_the_modes_is_that_of_the_space():
    body = rotated_problem(cf.open_tip(MATERIAL), Pair(1, 0), 0.2).body
    for order, cutoff in ((1, "quintic"), (2, "quintic"), (3, "septic"), (4, "septic"), (5, "septic")):
        spec = CrackFESpace(body, order=order, material=MATERIAL, tip=TipEnrichment(r1=0.4)).tip_specs[0]
        assert (spec.order, spec.cutoff.name) == (min(order, 4), cutoff)
    branch = CrackFESpace(body, order=3, tip=TipEnrichment(r1=0.4, functions="branch"))
    assert len(branch.TipDofs(0)) == 8 and branch.tip_specs[0].cutoff.name == "septic"


def test_the_singular_divergence_is_that_of_the_modes():
    """Where χ = 1: Π (div u - s) + s = s."""
    material = Elasticity.PlaneStrain(E=1, nu=0.49)
    mesh = cf.rotated_square(0.41, OFFSET, 0.08)
    V = CrackFESpace(CrackedMesh(mesh, cf.crack_on_axis(cf.mouths(0.41, OFFSET)[0], 0)), order=2, material=material, tip=TipEnrichment(r0=0.3, r1=0.4, order=4))
    u = GridFunction(V)
    for dof in V.TipDofs(0):
        u.vec[:] = 0
        u.vec[dof] = 1
        for point in ((0.1, 0.12), (-0.13, 0.1), (-0.2, -0.06)):
            at = mesh(*point)
            divergence = Grad(u)(at)[0] + Grad(u)(at)[3]
            assert abs(divergence) > 1e-3 and u.Operator("dilatation")(at) == pytest.approx(divergence, rel=1e-9)
