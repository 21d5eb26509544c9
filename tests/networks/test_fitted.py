"""The boundary-fitted solutions against closed forms, against the energy, and the stored figures against a coarse mesh."""

from functools import cache

import numpy as np
import pytest
from networks.cases import CASES, A, Y, figures, kind, reference, star
from networks.fitted import NU, E, FittedBody

COARSE = dict(order=3, maxh=0.08, tip_h=1e-4)
ROOT = np.sqrt(np.pi * A)  # K of a straight crack under unit stress in the infinite plane
STRAIGHT = [((-A, 0), (A, 0))]


@cache
def coarse(name):
    arms, load = CASES[name]
    return figures(arms, COARSE, **load)


@cache
def wide():
    """A straight crack in a square of 40 times its half length: K is larger by 0.1 %."""
    return FittedBody(STRAIGHT, 40 * A, **COARSE)


def test_a_straight_crack_under_pressure():
    """K_I = p√(πa), opening 4(1 - ν²) p √(a² - x²) / E."""
    solution = wide().Solve(pressure=1, contact=False)
    for tip in wide().tips:
        assert np.allclose(np.array(solution.StressIntensity(tip, 0.9 * A)) / ROOT, (1, 0), atol=2e-3)
    for fraction in (0.1, 0.5, 0.8):
        assert np.isclose(solution.Jump(0, fraction)[0], 8 * (1 - NU**2) * A * np.sqrt(fraction * (1 - fraction)), rtol=3e-3)


def test_a_straight_crack_closed_under_shear():
    """K_II = τ√(πa) at both tips, contact force -σ_yy 2a, although σ_xx is there."""
    solution = wide().Solve(sigma=((0.4, 0.3), (0.3, -1)))
    assert solution.ClosedPart(0) == 1 and np.allclose(solution.ContactForce(0), (2 * A, 0), rtol=3e-3)
    for tip in wide().tips:
        K = solution.StressIntensity(tip, 0.9 * A)
        assert np.isnan(K[0]) and np.isclose(K[1] / ROOT, 0.3, atol=1e-3)


@pytest.mark.parametrize("friction, K_II", [(0.2, 0.1), (0.4, 0)])
def test_a_straight_crack_with_friction(friction, K_II):
    """K_II = (τ - μp)√(πa) where it slides; with μp > τ it sticks, and the stress is uniform."""
    solution = wide().Solve(sigma=((0.4, 0.3), (0.3, -1)), friction=friction)
    for tip in wide().tips:
        assert np.isclose(solution.StressIntensityFromJumps(tip, 0.02 * A)[1] / ROOT, K_II, atol=5e-4)
    assert np.allclose(solution.ContactForce(0), (2 * A, -2 * A * min(friction, 0.3)), rtol=3e-3)


def test_two_ways_to_the_stress_intensity():
    """The interaction integral over a disk, and the jumps near the tip, where the elements resolve √r to some 1e-3."""
    body = FittedBody(Y, **COARSE)
    solution = body.Solve(**CASES["Y, two arms closed"][1])
    for tip, modes in zip(body.tips, ((0, 1), (1,), (1,))):
        ways = solution.StressIntensity(tip, 0.2), solution.StressIntensityFromJumps(tip, 0.02 * A)
        assert np.allclose(*np.array(ways)[:, modes], atol=2e-3)


def test_pressure_is_tension_from_all_sides():
    """They differ by a uniform stress."""
    body = FittedBody(Y, **COARSE)
    first, second = body.Solve(pressure=1), body.Solve(sigma=((1, 0), (0, 1)))
    for tip in body.tips:
        assert np.allclose(first.StressIntensity(tip, 0.2), second.StressIntensity(tip, 0.2), atol=2e-4)
        assert np.allclose(first.Jump(tip[0], 0.4), second.Jump(tip[0], 0.4), atol=1e-8)


def test_the_energy_release_rate_with_contact():
    """d(½ f·u)/da = Σ (K_I² + K_II²) (1 - ν²) / E, K_I = 0 at closed tips."""
    name, step = "Y, two arms closed", 0.01
    energy = [FittedBody(star(90, 210, 330, length=A + s), **COARSE).Solve(**CASES[name][1]).energy for s in (step, -step)]
    K = [value for key, value in coarse(name).items() if kind(key) == "K_I"]
    assert len(K) == 4 and np.isclose((energy[0] - energy[1]) / (2 * step), (1 - NU**2) / E * np.square(K).sum(), rtol=3e-3)


@pytest.mark.parametrize("name", ["cross, pressure", "T, tension in x", "Y, two arms closed", "T, straight crack closed, friction 0.2"])
def test_the_stored_figures(name):
    """A coarse mesh is within 0.1 % of the largest figure of a kind; the stored errors are far below that."""
    stored, found = reference(name), coarse(name)
    largest = {kind(key): max(abs(v) for k, (v, _) in stored.items() if kind(k) == kind(key)) for key in stored}
    assert stored.keys() == found.keys() and {"K_I, arm 0", "K_II, arm 0"} & stored.keys()
    for key, (value, error) in stored.items():
        if kind(key) != "closed":
            assert abs(found[key] - value) <= 1e-3 * largest[kind(key)] and error <= 1e-4 * max(largest[kind(key)], 0.1), key


def test_the_file_has_the_cases():
    for name in CASES:
        stored = reference(name)
        assert all(error <= 5e-4 * max(1, abs(value)) for key, (value, error) in stored.items() if kind(key) != "closed"), name
        assert any(kind(key) == "K_I" for key in stored)


def test_the_cross_in_the_infinite_plane():
    """K_I = 0.8636 p√(πa) (D. P. Rooke, I. N. Sneddon, Int. J. Engng Sci. 7 (1969) 1079); the finite body adds a multiple of (a/w)²."""
    K = {ratio: reference(f"cross, pressure, half-width {ratio} A")["K_I, arm 0"][0] / ROOT for ratio in (10, 20, 40)}
    assert abs(K[40] - 0.8636) < 1e-3 and abs((4 * K[40] - K[20]) / 3 - 0.8636) < 1e-4
    assert np.isclose((K[10] - K[20]) / (K[20] - K[40]), 4, rtol=0.05)
