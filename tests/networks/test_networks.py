"""Cracks that cross, end on each other, kink and close on themselves: parts and facets, contact, blocks, stress intensity factors, pictures."""

import numpy as np
import pytest
from helpers import rectangle, structured
from networks import blocks, cases, rings
from networks.random_networks import kink_placements, random_network
from networks.stars import star_problem
from ngsolve import CF, IfPos, Integrate, x, y

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Minus, Plus, TraceSpace
from ngsxfem_contact.contact import Coercivity
from ngsxfem_contact.errors import SingularSystem
from ngsxfem_contact.geometry import EndKind
from ngsxfem_contact.plotting.split_mesh import SplitMesh
from ngsxfem_contact.spaces.connectivity import VertexCopies
from study.paper import PAIRS

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MATERIAL = Elasticity.PlaneStrain(E=1, nu=0.3)
P = 0.7
MESHES = [rectangle(maxh) for maxh in (0.15, 0.1)]


def pressed(body, pair=(1, 1), tip=None, **options):
    """All of ∂Ω is moved as by a uniform pressure P."""
    V = CrackFESpace(body, order=pair[0], dirichlet=".*", tip=tip)
    problem = ContactProblem(V, TraceSpace(body, order=pair[1]), MATERIAL, **options)
    problem.SetDirichlet(-P / (2 * (MATERIAL.lam + MATERIAL.mu)) * CF((x, y)), ".*")
    return problem


def off(solution):
    """How far λ is from -P at the nodes of all cracks."""
    return np.abs(solution.multiplier(solution.state.nodes.points) + P).max()


SPECIAL = {
    "crossing": ([(0.1, 0.6), (0.7, 0.6)], [(0.3, 0.55), (0.3, 0.7)]),
    "crossing along edges": ([(0.25, 0.5), (0.75, 0.5)], [(0.5, 0.25), (0.5, 0.75)]),
    "crossing at a vertex": ([(0.25, 0.5), (0.75, 0.5)], [(0.25, 0.75), (0.75, 0.25)]),
    "branching at a vertex": ([(0.25, 0.5), (0.75, 0.5)], [(0.5, 0.5), (0.5, 0.75)]),
    "meeting end to end": ([(0, 0.5), (0.5, 0.5)], [(0.5, 0.5), (0.75, 0.75)]),
    "three at a point": ([(0.4, 0.4), (0.8, 0.4)], [(0.4, 0.4), (0.2, 0.8)], [(0.4, 0.4), (0.3, 0.1)]),
    "through a kink": ([(0.1, 0.3), (0.5, 0.45), (0.8, 0.2)], [(0.5, 0.1), (0.5, 0.9)]),
    "close to each other": ([(0, 0.44), (1, 0.44)], [(0, 0.444), (1, 0.444)]),
    "there and back again": ([(0.1, 0.1), (0.9, 0.11), (0.9, 0.13), (0.1, 0.12)],),
}


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("name", SPECIAL)
def test_special_positions(name, pair):
    order, multiplier = (int(part[1]) for part in pair.split("/"))
    cracks = [Crack(points) for points in SPECIAL[name]]
    body = CrackedMesh(structured(4), *cracks)
    for c, crack in enumerate(cracks):
        assert Integrate(CF(1) * body.dcrack(crack=c), body.mesh) == pytest.approx(crack.length, rel=1e-9)
    assert Integrate(CF(1) * body.dx, body.mesh) == pytest.approx(1, rel=1e-12)
    problem = pressed(body, (order, multiplier))
    assert off(problem.Solve()) < 1e-7 and Coercivity(problem) >= 0.5


@pytest.mark.parametrize("angle", [20, 45, 60, 90, 120, 150])
def test_kinks_at_random(angle):
    rng = np.random.default_rng(angle)
    for crack in kink_placements(rng, angle, 10):
        problem = pressed(CrackedMesh(MESHES[1], Crack(crack)), (2, 1))
        assert off(problem.Solve()) < 1e-9 and Coercivity(problem) >= 0.5


@pytest.mark.parametrize("seed", range(10))
def test_random_networks(seed):
    """Against exact facts: lengths, tips, the number of blocks; a uniform pressure on all arms, whatever holds the blocks."""
    rng = np.random.default_rng(seed)
    cracks, facts = random_network(rng, int(rng.integers(2, 13)), 0.02, 10)
    body = CrackedMesh(MESHES[seed % 2], *(Crack(points) for points in cracks))
    order, multiplier = (int(part[1]) for part in list(PAIRS)[seed % len(PAIRS)].split("/"))
    problem = pressed(body, (order, multiplier))
    if not body.notes:
        assert Integrate(CF(1) * body.dcrack, body.mesh) == pytest.approx(float(facts.length), rel=1e-10)
        assert len(body.tips) == facts.tips and VertexCopies(problem.V).parts == facts.blocks
    assert off(problem.Solve()) < 1e-7 and Coercivity(problem) >= 0.5


def test_arcs_that_cross_and_meet():
    arcs = [Crack.Arc((0.1, 0.35), (0.5, 0.62), (0.9, 0.35)), Crack.Arc((0.3, 0.15), (0.47, 0.5), (0.3, 0.85)), Crack([(0.5, 0.62), (0.72, 0.9)])]
    body = CrackedMesh(MESHES[0], *arcs)
    assert [end.kind for c in range(3) for end in body.Ends(c)] == [EndKind.Tip] * 4 + [EndKind.Junction, EndKind.Tip]
    for c, crack in enumerate(body.cracks):
        assert Integrate(CF(1) * body.dcrack(crack=c), body.mesh) == pytest.approx(crack.length, rel=1e-10)
    assert Integrate(x * y * body.dx, body.mesh) == pytest.approx(0.25, rel=1e-10)
    assert off(pressed(body, (2, 1)).Solve()) < 1e-8


def test_an_end_that_nearly_reaches_a_crack_ends_on_it():
    beam = Crack([(0, 0.5), (1, 0.5)])
    for end in (0.495, 0.505):  # of an element of 0.15
        body = CrackedMesh(MESHES[0], beam, Crack([(0.4, 0.1), (0.4, end)]))
        assert body.Ends(1)[1].kind == EndKind.Junction and body.cracks[1].length == pytest.approx(0.4, abs=1e-12)
        assert "crack 1: its end" in body.notes[0] and len(body.tips) == 1


# Closed cracks and blocks


def circle(radius, centre=(0.5, 0.5)):
    at = lambda k: (centre[0] + radius * np.cos(k * np.pi / 2), centre[1] + radius * np.sin(k * np.pi / 2))
    middle = lambda k: (centre[0] + radius * np.cos((k + 0.5) * np.pi / 2), centre[1] + radius * np.sin((k + 0.5) * np.pi / 2))
    return Crack.Join(*(Crack.Arc(at(k), middle(k), at(k + 1)) for k in range(4)))


def test_an_inclusion_that_contact_holds():
    problem = pressed(CrackedMesh(MESHES[1], Crack([(0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7), (0.3, 0.3)])))
    solution = problem.Solve()
    assert off(solution) < 1e-9 and solution.body.cracks[0].closed
    assert any("is held by the faces of cracks alone" in note for note in solution.report.notes)


def test_a_round_inclusion_turns_freely_without_friction():
    body = CrackedMesh(MESHES[1], circle(0.23))
    with pytest.raises(SingularSystem, match=r"1 rigid motion\(s\) of one of the 2 parts .* around \(0\.5"):
        pressed(body).Solve()
    assert off(pressed(body, law=Coulomb(0.3)).Solve()) < 1e-9
    assert Integrate(CF(1) * body.dcrack, body.mesh) == pytest.approx(0.46 * np.pi, rel=1e-12)


@pytest.mark.parametrize("pair, rate", [((1, 0), 0.9), ((1, 1), 0.9), ((2, 1), 1.5)])
def test_pressure_on_a_closed_interface(pair, rate):
    """A disk in a ring, p = 1 + 0.4 cos 2θ: the mean rate of λ in L² from h = 0.2 to 0.05, against the series."""
    ring = rings.with_pressure((MATERIAL.lam, MATERIAL.mu), (MATERIAL.lam, MATERIAL.mu), {0: 1.0, 2: 0.4}, a=0.5, b=2.0)
    exact, errors = -(1 + 0.4 * (x * x - y * y) / (x * x + y * y)), []
    for h in (0.2, 0.05):
        body = CrackedMesh(rectangle(h, (-1, -1), (1, 1)), circle(0.5, (0, 0)))
        V = CrackFESpace(body, order=pair[0], dirichlet=".*")
        problem = ContactProblem(V, TraceSpace(body, order=pair[1]), MATERIAL)
        problem.SetDirichlet(CF(tuple(ring.Fields(1, x, y)[0])), ".*")
        vertex = min((v.point for v in body.mesh.vertices), key=lambda p: np.hypot(p[0] - 0.2, p[1]))
        problem.Pin(vertex, "y", ring.Fields(0, *vertex)[0][1])  # the disk turns freely
        solution = problem.Solve()
        errors.append(Integrate((solution.multiplier - exact) ** 2 * solution.problem.W.dcrack(bonus_intorder=6), body.mesh) ** 0.5)
    assert np.log2(errors[0] / errors[1]) / 2 > rate


@pytest.mark.parametrize("pair", [(1, 0), (1, 1), (2, 1)])
@pytest.mark.parametrize("state", [
    blocks.sticking(MATERIAL.lam, MATERIAL.mu, tau=0.2, junction=(0.47, 0.56)),
    blocks.row_slides(MATERIAL.lam, MATERIAL.mu, 0.3, p=(1.2, 1.4), slide=2.0, junction=(0.47, 0.56)),
], ids=["stick", "a row slides"])  # fmt: skip
def test_four_blocks(state, pair):
    """Uniform stresses in each of four blocks that friction holds: forces on the four arms by statics."""
    friction = {0: 0.3, 1: 0.6}
    body = CrackedMesh(MESHES[1], *(Crack(points) for points in state.cracks))
    V = CrackFESpace(body, order=pair[0], dirichlet=".*")
    problem = ContactProblem(V, TraceSpace(body, order=pair[1]), MATERIAL, law={c: Coulomb(mu) for c, mu in friction.items()})
    given = displacement(state, body)
    problem.SetDirichlet(given, ".*")
    solution = problem.Solve()
    for arm in blocks.ARMS:
        normal, shear, _ = state.Forces(arm)
        assert forces_on(solution, arm, state.junction) == pytest.approx((normal, shear), abs=1e-8)


def displacement(state, body):
    """u of the four blocks, by position."""
    cx, cy = state.junction
    u = CF((0, 0))
    for row in (0, 1):
        for column in (0, 1):
            c, G = state.Displacement(row, column)
            here = IfPos((2 * column - 1) * (x - cx), 1, 0) * IfPos((2 * row - 1) * (y - cy), 1, 0)
            u = u + here * (CF(tuple(map(float, c))) + CF(tuple(map(float, G.ravel())), dims=(2, 2)) * CF((x - cx, y - cy)))
    return u


def forces_on(solution, arm, junction):
    """(∫λ, ∫λ_t) over an arm."""
    (dx, dy), (cx, cy) = blocks.ARMS[arm], junction
    here = IfPos(dx * (x - cx) + dy * (y - cy), 1, 0)
    measure = solution.problem.W.dcrack(crack=0 if dy == 0 else 1)
    return [Integrate(here * f * measure, solution.body.mesh) for f in (solution.multiplier, solution.tangential_multiplier)]


# Stress intensity factors


@pytest.mark.parametrize("name", ["cross, pressure", "Y, tension in x", "T, tension in y", "Y, two arms closed", "T, straight crack closed, friction 0.2"])
def test_stress_intensity_factors_of_stars(name):
    """Against boundary-fitted meshes, relative to the largest factor of the case."""
    problem, arm_of = star_problem(name, 0.02)
    solution, reference = problem.Solve(), cases.reference(name)
    scale = max(abs(value) for key, (value, _) in reference.items() if key.startswith("K_"))
    for tip, arm in enumerate(arm_of):
        factors = solution.StressIntensity(tip)
        for kind, value in (("K_I", factors.K_I), ("K_II", factors.K_II)):
            if f"{kind}, arm {arm}" in reference:
                assert value == pytest.approx(reference[f"{kind}, arm {arm}"][0], abs=0.01 * scale)


# Pictures


@pytest.mark.parametrize("name", ["crossing", "branching at a vertex", "three at a point", "through a kink"])
def test_pictures_show_every_arm_open(name):
    """Both lips of each crack, along all of it, and one point for each sector where cracks meet."""
    body = CrackedMesh(structured(4), *(Crack(points) for points in SPECIAL[name]))
    split = SplitMesh(body)
    for c, crack in enumerate(body.cracks):
        for side in (1, -1):
            lips = split.points[split.lips[(split.lip_crack == c) & (split.lip_side == side)]]
            assert np.hypot(*(lips[:, 1] - lips[:, 0]).T).sum() == pytest.approx(crack.length, rel=1e-9)
    problem = pressed(body)
    problem.FacePressure(2 * P)
    u = problem.Solve().u
    shown, centres = split.Evaluate(Plus(u), Minus(u), u), split.points[split.triangles].mean(axis=1)
    assert shown[split.triangles].mean(axis=1) == pytest.approx(u(body.mesh(*centres.T)), abs=1e-9)
