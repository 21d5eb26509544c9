"""Blocks against equilibrium and Coulomb's law; brickwork against its plan; disk and ring against the equations, by differences of 40 digits."""

import mpmath
import numpy as np
import pytest
from networks.blocks import ARMS, Brickwork, FourBlocks, SmoothWall, all_slide, blocks_beside, equilibrium_residuals, pushed_row, row_slides, sticking
from networks.planar import facts
from networks.rings import RingContact, with_pressure

LAME = (1.3, 0.8)
STATES = {
    "sticking": (sticking(*LAME, junction=(0.4, 0.3)), (0.25, 0.3)),
    "row slides": (row_slides(*LAME, 0.3, p=(1.0, 1.5), q=0.9, junction=(0.4, 0.3)), (0.3, 0.5)),
    "row slides back": (row_slides(*LAME, 0.3, p=(1.0, 1.5), q=0.9, slide=-1.0), (0.3, 0.5)),
    "all slide": (all_slide(*LAME, (0.3, 0.4), junction=(0.4, 0.3)), (0.3, 0.4)),
}


@pytest.mark.parametrize("state, friction", STATES.values(), ids=STATES)
def test_states_of_four_blocks(state, friction):
    """Each block is in equilibrium, the law holds and would not with less friction, normal gaps are zero along the arms, strains are Hooke's."""
    state.Check(friction)
    with pytest.raises(ValueError, match="Coulomb"):
        FourBlocks(*LAME, state.p, state.q, 4 * state.tau, state.slide, state.junction).Check(friction)
    for residual in equilibrium_residuals({arm: state.Forces(arm) for arm in ARMS}, state.Loads()).values():
        assert np.allclose(residual, 0, atol=1e-14)
    for arm, direction in ARMS.items():
        normal = 1 if direction[1] == 0 else 0
        for s in (0, 0.2):
            u = [c + G @ (s * np.array(direction)) for c, G in (state.Displacement(*block) for block in blocks_beside(arm))]
            assert np.isclose(u[0][normal], u[1][normal], atol=1e-15)
    G = state.Displacement(1, 0)[1]
    assert np.allclose(LAME[0] * np.trace(G) * np.eye(2) + LAME[1] * (G + G.T), state.Stress(1, 0))


def test_equilibrium_notices():
    """A force too much on an arm appears on both of its blocks, with opposite signs."""
    state = STATES["row slides"][0]
    forces = {arm: np.array(state.Forces(arm)) for arm in ARMS}
    forces["top"] = forces["top"] + (0.1, 0, 0.02)
    residual = equilibrium_residuals(forces, state.Loads())
    assert np.allclose(residual[1, 0], (0.1, 0, -0.02)) and np.allclose(residual[1, 1], (-0.1, 0, 0.02)) and np.allclose(residual[0, 0], 0)


def test_pushed_row():
    """Both blocks of the row are in equilibrium in x; the lower row bears the weight."""
    arms, push = pushed_row(q=2, widths=(0.4, 0.6), friction=0.3)
    forces = {arm: (*pair, 0.0) for arm, pair in arms.items()}
    residual = equilibrium_residuals(forces, {(1, 0): (push, -0.8, 0), (1, 1): (0, -1.2, 0), (0, 0): (0, 0, 0), (0, 1): (0, 0, 0)})
    assert np.allclose([residual[1, 0][:2], residual[1, 1][:2]], 0) and np.isclose(push, 0.6)
    assert np.allclose([residual[0, 0][:2], residual[0, 1][:2]], [(0.24, -0.8), (0.36, -1.2)])


def test_brickwork():
    wall = Brickwork(courses=5, bricks=3)
    found = facts(wall.beds + wall.heads)
    assert np.allclose([float(a) for a in found.areas], sorted(wall.areas)) and found.blocks == 3 * 3 + 2 * 4
    assert found.tips == found.crossings == 0 and found.mouths == 2 * 4 + 2 + 2 and found.t_ends == 2 * len(wall.heads) - 4


def test_smooth_wall():
    """σ_yy' = weight, σ_yy(1) = -pressure, σ = C ε of u_y alone."""
    wall, y, h = SmoothWall(*LAME, pressure=0.7, weight=0.4), 0.3, 1e-3
    slope = (wall.Displacement(y + h) - wall.Displacement(y - h)) / (2 * h)  # exact for quadratics
    assert np.allclose(wall.Stress(y), (LAME[0] * slope, (LAME[0] + 2 * LAME[1]) * slope), atol=1e-12)
    assert np.isclose((wall.Stress(y + h)[1] - wall.Stress(y - h)[1]) / (2 * h), 0.4) and wall.Stress(1)[1] == -0.7 and wall.Displacement(0) == 0


INNER, OUTER = (1.0, 1.0), (2.0, 3.0)
RINGS = {
    "disk": with_pressure(INNER, OUTER, {0: 1.0, 2: 0.4, 3: 0.1}),
    "ring": with_pressure(INNER, OUTER, {0: 1.0, 2: 0.4}, hole=0.2, a=0.6),
    "given displacement": RingContact(INNER, OUTER, {0: (-0.1, 0.0), 2: (0.01, 0.02)}, given="displacement"),
    "given tractions": RingContact(OUTER, INNER, {0: (-1.0, 0.0), 2: (0.2, -0.3)}, b=2.0),
}


@pytest.mark.parametrize("case", RINGS.values(), ids=RINGS)
@pytest.mark.parametrize("part, x, y", [(0, 0.3, 0.2), (0, -0.1, 0.35), (1, 0.5, -0.6)])
def test_equilibrium_and_hooke(case, part, x, y):
    lam, mu = (case.inner, case.outer)[part]
    with mpmath.workdps(40):
        place = mpmath.mpf(x), mpmath.mpf(y)
        derivative = lambda kind, i, j: mpmath.diff(lambda *p: case.Fields(part, *p)[kind][i], place, ((1, 0), (0, 1))[j])
        G = [[derivative(0, i, j) for j in (0, 1)] for i in (0, 1)]
        trace = lam * (G[0][0] + G[1][1])
        expected = trace + 2 * mu * G[0][0], mu * (G[0][1] + G[1][0]), trace + 2 * mu * G[1][1]
        assert max(abs(s - e) for s, e in zip(case.Fields(part, *place)[1], expected)) < 1e-14
        assert max(abs(derivative(1, i, 0) + derivative(1, i + 1, 1)) for i in (0, 1)) < 1e-14


def polar(case, part, r, angle):
    """u_r, u_θ, σ_rr, σ_rθ from the fields in x and y."""
    e, t = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    u, (xx, xy, yy) = case.Fields(part, *(r * e))
    S = np.array([[xx, xy], [xy, yy]])
    return np.array([u @ e, u @ t, e @ S @ e, e @ S @ t])


@pytest.mark.parametrize("name", RINGS)
@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0, 4.4])
def test_conditions_on_the_circles(name, angle):
    case = RINGS[name]
    inner, outer = (polar(case, part, case.a, angle) for part in (0, 1))
    pressure = sum(p * np.cos(n * angle) for n, p in case.pressure.items())
    assert np.allclose(inner[[0, 2]], outer[[0, 2]], atol=1e-13) and np.isclose(inner[2], -pressure, atol=1e-13)
    assert abs(inner[3]) < 1e-13 and abs(outer[3]) < 1e-13
    given = [sum(amplitude[i] * f(n * angle) for n, amplitude in case.load.items()) for i, f in enumerate((np.cos, np.sin))]
    assert np.allclose(polar(case, 1, case.b, angle)[:2] if case.given == "displacement" else polar(case, 1, case.b, angle)[2:], given, atol=1e-13)
    assert not case.hole or np.allclose(polar(case, 0, case.hole, angle)[2:], 0, atol=1e-12)


def test_pressures():
    assert np.allclose(list(RINGS["disk"].pressure.values()), (1, 0.4, 0.1), atol=1e-14)
    with pytest.raises(ValueError, match="do not press"):
        with_pressure(INNER, OUTER, {0: 1.0, 2: 1.1}).pressure
    with pytest.raises(ValueError, match="n = 1"):
        RingContact(INNER, OUTER, {1: (1.0, 0.0)}).coefficients


def test_a_press_fit_has_lames_solution():
    """Equal materials without shear at the interface: under uniform pressure the interface does nothing."""
    case = RingContact(INNER, INNER, {0: (-1.0, 0.0)})
    for part, x in ((0, 0.2), (1, 0.9)):
        assert np.allclose(case.Fields(part, x, 0.1)[1], (-1, 0, -1), atol=1e-14)
    assert case.pressure == pytest.approx({0: 1})
