"""Nitsche's method: its equations and tangent by evaluation at points, closed forms, the references, and bad input."""

import numpy as np
import pytest
from helpers import MATERIAL, array, random_function, rotated_problem
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, NormalGap, Slip, Strain, TipEnrichment, TraceSpace
from ngsxfem_contact.algebra.matrices import to_scipy
from ngsxfem_contact.contact import BarbosaHughes, ContactProblem, Coulomb, Nitsche, Tresca
from ngsxfem_contact.contact.contact_system import stiffness_form
from ngsxfem_contact.contact.nitsche import CrackPoints, add_to, rule
from ngsxfem_contact.errors import NotCoercive
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.operators import NormalStress, TangentialStress
from study.paper import FRICTION_REFERENCE, PAIRS, REFERENCE, paper_problem, unstructured_mesh

MESH = unstructured_mesh(0.06)
THETAS = [1, 0, -1]


def coarse(load="C", **options):
    return paper_problem(MESH, load, **options)


# The equations, evaluated by NGSolve at the points, without the matrices of the system


class AtPoints:
    """R_n, R_t, g_n, g_t of functions of V at the points, and the virtual work of contact."""

    def __init__(self, problem):
        self.problem, self.points = problem, CrackPoints(problem.body, problem.V.order + 3)
        self.omega, self.gamma = self.points.weights, self.points.Values(problem.Gamma())

    def Of(self, u):
        body, stress = self.problem.body, self.problem.material.Stress(Strain(u, "larger"))
        functions = NormalStress(stress, body), TangentialStress(stress, body), NormalGap(u, body), Slip(u, body)
        return [self.points.Values(f) for f in functions]

    def Law(self, u, s):
        """λ, λ_t of a displacement, Tresca's threshold s."""
        R_n, R_t, g_n, g_t = self.Of(u)
        return np.minimum(0, R_n + g_n / self.gamma), np.clip(R_t + g_t / self.gamma, -s, s)

    def Work(self, u, v, theta, s):
        """-θ ∫γ R(u)R(v) + ∫λ(u) (g(v) + θγR(v)), both components."""
        (R_n, R_t, _, _), (S_n, S_t, h_n, h_t) = self.Of(u), self.Of(v)
        pressure, shear = self.Law(u, s)
        stabilised = -theta * self.gamma * (R_n * S_n + R_t * S_t)
        return self.omega @ (stabilised + pressure * (h_n + theta * self.gamma * S_n) + shear * (h_t + theta * self.gamma * S_t))


@pytest.mark.parametrize("theta", THETAS)
def test_solution_satisfies_the_variational_equation(theta):
    problem = coarse(stabilisation=Nitsche(theta), law=Tresca(0.05))
    solution, work = problem.Solve(), AtPoints(problem)
    K, F = to_scipy(stiffness_form(problem).Assemble().mat), array(problem.f.Assemble().vec)
    v = random_function(problem.V)
    values = v.vec.FV().NumPy()
    values[~np.array(problem.free)] = 0
    parts = [values @ (K @ array(solution.u.vec)), work.Work(solution.u, v, theta, 0.05), -values @ F]
    assert abs(sum(parts)) < 1e-11 * max(map(abs, parts))
    assert abs(parts[1]) > 1e-4 * abs(parts[0])
    pressure, shear = work.Law(solution.u, 0.05)
    assert np.concatenate([pressure, shear]) == pytest.approx(solution.Multipliers(), abs=1e-10)


@pytest.mark.parametrize("theta", THETAS)
def test_tangent_by_finite_differences(theta):
    """Of the contact work at a random displacement; in the system's matrices: A + Σ E_θᵀ D⁻¹ E over points in contact or sticking."""
    problem, s = coarse(stabilisation=Nitsche(theta), law=Tresca(0.5)), 0.5
    system, work = problem.Assemble(), AtPoints(problem)
    u, d, v = (random_function(problem.V, seed) for seed in range(3))
    u.vec.data *= 0.003
    step = 1e-7
    derivative = []
    for sign in (1, -1):
        moved = random_function(problem.V)
        moved.vec.data = u.vec + sign * step * d.vec
        derivative.append(work.Work(moved, v, theta, s))
    R_n, R_t, g_n, g_t = work.Of(u)
    moving = np.concatenate([R_n + g_n / work.gamma < 0, np.abs(R_t + g_t / work.gamma) < s])
    assert 0.05 < moving[: len(R_n)].mean() < 0.95 and 0.02 < moving[len(R_n) :].mean() < 0.98
    D, dv = system.D.diagonal(), array(d.vec)
    L = np.where(moving, -(system.E @ dv) / D, 0)
    stabilised = to_scipy(system.stiffness) - to_scipy(stiffness_form(problem).Assemble().mat)
    ours = array(v.vec) @ (stabilised @ dv - system.Forces(L))
    assert (derivative[0] - derivative[1]) / (2 * step) == pytest.approx(ours, rel=1e-5)


def test_points_and_weights():
    """Polynomials in s, and in √r at tips; the length of the crack."""
    nodes = [0, 0.1, 0.35, 0.8, 1]
    s, w = rule(nodes, [], 3)
    assert w @ s**5 == pytest.approx(1 / 6)
    for tips in ([1.0], [0.0]):
        s, w = rule(nodes, tips, 3)
        r = np.abs(s - tips[0])
        assert w.sum() == pytest.approx(1) and w @ np.sqrt(r) == pytest.approx(2 / 3) and w @ r == pytest.approx(1 / 2)
        assert (np.diff(s) > 0).all() if tips == [0.0] else len(s) == 12
    s, w = rule(nodes, [0.0, 1.0], 4)
    assert w.sum() == pytest.approx(1) and (w > 0).all() and w @ np.sqrt(np.minimum(s, 1 - s)) == pytest.approx(4 / 3 * 0.5**1.5)


def test_adding_to_a_matrix_of_ngsolve():
    problem = coarse()
    K = stiffness_form(problem).Assemble().mat
    before = to_scipy(K)
    part = before[:40, :40].copy()
    part.resize(before.shape)
    add_to(K, part)
    assert abs(to_scipy(K) - before - part).max() == 0


# Closed forms and references


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("theta", THETAS)
def test_uniform_stress_is_exact(theta, pair):
    exact = cf.uniform_compression(MATERIAL)
    solution = rotated_problem(exact, PAIRS[pair], 0.2, stabilisation=Nitsche(theta)).Solve()
    assert max(cf.energy_error(solution, exact), cf.pressure_error(solution, exact)) < 1e-10
    stick = cf.uniform_stress(MATERIAL, 0.3, 0.4, -1)
    solution = rotated_problem(stick, PAIRS[pair], 0.2, stabilisation=Nitsche(theta), law=Coulomb(0.5)).Solve()
    assert max(cf.energy_error(solution, stick), cf.pressure_error(solution, stick), cf.shear_error(solution, stick)) < 1e-10


@pytest.mark.parametrize("theta", [1, -1])
def test_sliding_tip(theta):
    exact, tip = cf.sliding_tip(MATERIAL, 0.3), TipEnrichment(r1=0.4, material=MATERIAL)
    errors = []
    for maxh in (0.1, 0.05):
        solution = rotated_problem(exact, PAIRS["P2/P1"], maxh, tip=tip, stabilisation=Nitsche(theta), law=Coulomb(0.3)).Solve()
        errors.append([cf.energy_error(solution, exact), cf.pressure_error(solution, exact), cf.shear_error(solution, exact)])
    assert (np.array(errors[1]) < 0.5 * np.array(errors[0])).all()


@pytest.mark.parametrize(("theta", "load", "friction"), [(1, "B", None), (0, "B", None), (-1, "B", None), (1, "C", Coulomb(0.3)), (0, "C", Tresca(0.05))])
def test_references(theta, load, friction):
    """maxh = 0.06, as the multiplier's: energy to 2e-4, forces to 0.5 %."""
    exact = REFERENCE["B"] if friction is None else FRICTION_REFERENCE["C, Coulomb 0.3" if isinstance(friction, Coulomb) else "C, Tresca 0.05"]
    solution = paper_problem(unstructured_mesh(0.03), load, stabilisation=Nitsche(theta), law=friction).Solve()
    assert abs(solution.Energy() / exact["energy"] - 1) < 2e-4
    assert solution.ContactForce() == pytest.approx(exact["contact_force"], rel=0.005)
    assert solution.Transitions()[[0, -1]] == pytest.approx(exact["transition"], abs=0.03)
    assert solution.report.converged and solution.report.iterations <= 15
    if friction is not None:
        assert solution.TangentialForce() == pytest.approx(exact["tangential_force"], rel=0.005)
        assert abs(solution.DissipatedEnergy() - exact["friction_work"]) < 5e-4 * exact["energy"]


def test_symmetric_method_is_barbosa_hughes_to_the_discretisation_error():
    """Load B: the two energies differ by less than either from the exact one."""
    exact = REFERENCE["B"]["energy"]
    nitsche, multiplier = (coarse("B", stabilisation=s).Solve().Energy() for s in (Nitsche(1), BarbosaHughes()))
    assert abs(nitsche - multiplier) < 0.2 * abs(multiplier - exact)


def test_total_pressure_is_that_of_the_points():
    solution = coarse(stabilisation=Nitsche(1)).Solve()
    points = CrackPoints(solution.body, solution.problem.V.order + 3)
    assert solution.ContactForce() == pytest.approx(points.weights @ np.split(solution.Multipliers(), 2)[0], rel=1e-11)


def test_initial_gap():
    material = Elasticity(lam=0, mu=1)
    body = CrackedMesh(unstructured_mesh(0.1), Crack([(0, 0.03), (1, 0.03)]))
    V = CrackFESpace(body, order=1, dirichlet="top|bottom")
    for theta in THETAS:
        problem = ContactProblem(V, TraceSpace(body), material, stabilisation=Nitsche(theta), gap=0.004)
        problem.SetDirichlet((0, -0.01), "top")
        profile = problem.Solve().Profile()
        assert profile.sigma_n == pytest.approx(-2 * 0.006 * np.ones(200), abs=1e-10)
        assert profile.gap == pytest.approx(-0.004 * np.ones(200), abs=1e-10)


def test_an_unchanged_load_changes_nothing():
    problem = coarse(stabilisation=Nitsche(0), law=Coulomb(0.3))
    first = problem.Solve()
    second = problem.Solve(previous=first)
    assert np.abs(second.Multipliers() - first.Multipliers()).max() < 1e-9 * np.abs(first.Multipliers()).max()
    assert abs(second.DissipatedEnergy()) < 1e-10 * first.DissipatedEnergy()


# γ and bad input


def test_a_large_gamma_is_refused_but_for_the_skew_method():
    with pytest.raises(NotCoercive):
        coarse(stabilisation=Nitsche(1, gamma0=1)).Solve()
    assert coarse(stabilisation=Nitsche(-1, gamma0=1)).Solve().report.converged


def test_wrong_input():
    with pytest.raises(ValueError, match="theta=2 is not one of"):
        Nitsche(2)
    with pytest.raises(ValueError, match="must be positive"):
        Nitsche(1, gamma0=-1)
    with pytest.raises(ValueError, match="must be 1 or more"):
        Nitsche(1, points=0)
    with pytest.raises(ValueError, match="belongs to a multiplier"):
        coarse(stabilisation=Nitsche(1), cone="weak").Solve()


FLAT_PLATES = {  # half axes of a polygon around the origin, number of corners, largest element, crack behind its mouth, order, functions of the tip
    "round": ((0.62, 0.6), 5, 0.2, [(0.14, 0.12), (0.25, 0.05)], 2, "modes"),
    "flat": ((0.7, 0.04), 7, 0.18, [(-0.05, 0.004), (0.3, -0.01)], 1, "branch"),
    "flat, straight": ((0.7, 0.045), 7, 0.16, [(0.25, -0.006)], 1, "modes"),
}


def flat_plate(name, stabilisation, friction):
    """A polygon, flattened with its mesh, held on one side; a body force and tractions that vary from side to side."""
    (a, b), corners, maxh, crack, order, functions = FLAT_PLATES[name]
    angles = 2 * np.pi * (np.arange(corners) + 0.5) / corners + 0.13
    geometry = SplineGeometry()
    places = [(a * np.cos(angle), a * np.sin(angle)) for angle in angles]
    points = [geometry.AppendPoint(*place) for place in places]
    for i in range(corners):
        geometry.Append(["line", points[i], points[(i + 1) % corners]], bc=f"s{i}")
    mesh = geometry.GenerateMesh(maxh=maxh)
    for point in mesh.Points():
        point[1] = point[1] * b / a
    mouth = min((0.5 * np.add(p, q) for p, q in zip(places, places[1:])), key=lambda middle: middle[0])
    material = Elasticity.PlaneStrain(E=1, nu=0.49)
    body = CrackedMesh(Mesh(mesh), Crack([(mouth[0], mouth[1] * b / a), *crack]))
    V = CrackFESpace(body, order=order, tip=TipEnrichment(material=material, functions=functions), dirichlet=f"s{corners - 1}")
    problem, v = ContactProblem(V, TraceSpace(body), material, stabilisation=stabilisation, law=friction), V.TestFunction()
    problem.f += CF((0.004, 0.011)) * v * body.dx
    for i in range(corners - 1):
        problem.f += 0.03 * CF((np.cos(2.7 * i), np.sin(1.9 * i))) * v * body.ds(f"s{i}")
    return problem


@pytest.mark.parametrize("threshold", [0.003, 0.03, 0.1])
@pytest.mark.parametrize("name", FLAT_PLATES)
def test_given_thresholds_are_solved_for_every_theta(name, threshold):
    """The problem is convex (θ = 1) or monotone: it has one solution, whose energies agree but for the discretisation."""
    multiplier = flat_plate(name, BarbosaHughes(), Tresca(threshold)).Solve().Energy()
    for theta in (1, 0, -1):
        solution = flat_plate(name, Nitsche(theta), Tresca(threshold)).Solve()
        assert solution.report.complementarity < 1e-8
        assert solution.Energy() == pytest.approx(multiplier, rel=0.1 if name == "round" else 0.8)
