"""Answers without a unit do not depend on the units of length and stress."""

from itertools import product

import numpy as np
import pytest
from helpers import rectangle
from ngsolve import CF, Mesh, x

from ngsxfem_contact import BarbosaHughes, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Nitsche, TipEnrichment, TraceSpace, Tresca
from ngsxfem_contact.algebra import pardiso
from ngsxfem_contact.algebra.elimination import Elimination
from ngsxfem_contact.contact.checks import Coercivity
from ngsxfem_contact.contact.stabilisation import trace_constants
from ngsxfem_contact.spaces.unknowns import Unknowns

UNITS = [(E, length) for E, length in product((1e-12, 1, 1e12), (1e-6, 1, 1e6)) if (E, length) != (1, 1)]
CORNERS = [(E, length) for E, length in UNITS if E != 1 and length != 1]
METHODS = {
    "Barbosa, Hughes": dict(stabilisation=BarbosaHughes()), "Nitsche": dict(stabilisation=Nitsche(theta=0)),
    "Coulomb": dict(law=Coulomb(0.3)), "Tresca, Nitsche": dict(stabilisation=Nitsche(theta=-1)),
}  # fmt: skip


def plate(length, maxh=0.15):
    mesh = rectangle(maxh).ngmesh
    for point in mesh.Points():
        point[0], point[1] = length * point[0], length * point[1]
    return CrackedMesh(Mesh(mesh), Crack([(0, 0.52 * length), (0.45 * length, 0.52 * length)]))


def loaded(E, length, order, functions, method):
    """The plate is pressed on the left, pulled on the right, and sheared."""
    body, material = plate(length), Elasticity.PlaneStrain(E=E, nu=0.3)
    V = CrackFESpace(body, order=order, tip=TipEnrichment(material=material, functions=functions), dirichlet="bottom")
    options = METHODS[method] | (dict(law=Tresca(1e-5 * E)) if method.startswith("Tresca") else {})
    problem = ContactProblem(V, TraceSpace(body), material, **options)
    problem.f += E * CF((1e-5, 1e-3 * (x / length - 0.3))) * V.TestFunction() * body.ds("top")
    return problem


def answers(E, length, *options, inverse=None):
    """Energy, force, K with its error, and gap, slip and pressure along the crack, without units; the solve's report."""
    solution = loaded(E, length, *options).Solve(inverse=inverse)
    K, profile = solution.StressIntensity(), solution.Profile(n=9)
    numbers = [
        [solution.Energy() / (E * length**2)], [solution.ContactForce() / (E * length)], np.array([K.K_I, K.K_II, K.error]) / (E * length**0.5),
        profile.gap / length, profile.slip / length, profile.sigma_n / E, profile.sigma_t / E,
    ]  # fmt: skip
    return numbers, solution.report


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("order", "functions"), [(1, "modes"), (2, "branch")])
def test_answers_do_not_depend_on_units(order, functions, method):
    right, _ = answers(1, 1, order, functions, method)
    assert right[1][0] < -1e-5 and right[3].max() > 1e-5  # a part of the crack is closed, another open
    for E, length in UNITS if method == "Barbosa, Hughes" else CORNERS:
        numbers, report = answers(E, length, order, functions, method)
        for number, exact in zip(numbers, right):
            assert np.abs(np.subtract(number, exact)).max() <= 1e-9 * np.abs(exact).max(), (E, length)
        assert report.residual < 1e-12 and report.complementarity < 1e-12


@pytest.mark.skipif(not pardiso.is_available(), reason="needs MKL")
@pytest.mark.parametrize("functions", ["modes", "branch"])
def test_pivots_of_pardiso_do_not_depend_on_units(functions):
    right, _ = answers(1, 1, 2, functions, "Barbosa, Hughes")
    for E, length in [*UNITS, (1e-30, 1)]:
        numbers, _ = answers(E, length, 2, functions, "Barbosa, Hughes", inverse="pardiso")
        assert all(np.abs(np.subtract(number, exact)).max() <= 1e-9 * np.abs(exact).max() for number, exact in zip(numbers, right))


@pytest.mark.parametrize("order", [1, 2])
def test_the_constants_behind_gamma_are_stresses(order):
    """Scaled by powers of 4 all roots and products are exact: the same bits come out."""

    def constants(E, length):
        body, material = plate(length), Elasticity.PlaneStrain(E=E, nu=0.25)
        V = CrackFESpace(body, order=order, tip=TipEnrichment(material=material))
        return trace_constants(V, material) / E

    right = constants(1.0, 1.0)
    for E, length in ((4.0**25, 1.0), (4.0**-25, 4.0**10), (4.0**25, 4.0**-10)):
        assert np.array_equal(constants(E, length), right)


def test_coercivity_does_not_depend_on_units():
    values = [Coercivity(loaded(E, length, 2, "modes", "Barbosa, Hughes")) for E, length in ((1, 1), (1e12, 1e-6), (1e-12, 1e6))]
    assert values == pytest.approx([values[0]] * 3, rel=1e-7)


@pytest.mark.parametrize("kinds", [("modes", "branch"), ("branch", "modes")])
def test_tips_with_different_functions_are_eliminated_together(kinds):
    """Their unknowns have units that differ by the square of the modulus: a positive matrix must be seen as one."""
    signs, residuals = [], []
    for E in (1.0, 1e12, 1e-12):
        material = Elasticity.PlaneStrain(E=E, nu=0.3)
        body = CrackedMesh(rectangle(0.12), Crack([(0.25, 0.45), (0.75, 0.55)]))
        V = CrackFESpace(body, order=1, tip=[TipEnrichment(material=material, functions=kind) for kind in kinds], dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body), material)
        problem.f += E * CF((0, x - 0.4)) * V.TestFunction() * body.ds("top")
        signs.append(Elimination(problem.Assemble().stiffness, problem.free, Unknowns(V).tips).positive)
        residuals.append(problem.Solve().report.residual)
    assert all(signs) and max(residuals) < 1e-12


def test_the_residual_sees_an_error_in_unknowns_of_any_unit():
    """An error of 1e-6 in the polynomials, and one in the tip's unknowns, whatever the modulus."""
    for E in (1e-12, 1.0, 1e12):
        problem = loaded(E, 1, 1, "modes", "Barbosa, Hughes")
        V, matrix = problem.V, problem.Assemble().stiffness
        elimination, F = Elimination(matrix, problem.free, Unknowns(V).tips), problem.f.Assemble().vec.FV().NumPy().copy()
        U = elimination.Solve(F)
        assert elimination.RelativeResidual([F], U) < 1e-13
        for part in (slice(0, 2 * V.scalar_space.ndof), V.TipDofs(0)):
            wrong = U.copy()
            wrong[part] *= 1 + 1e-6
            assert 1e-8 < elimination.RelativeResidual([F], wrong) < 1e-4


@pytest.mark.parametrize(
    ("E", "message"), [(1e-120, "E=1e-120 must lie between 1e-100 and 1e\\+100, take another unit"), (1e300, r"E=1e\+300 must lie between")]
)
def test_moduli_beyond_double_precision_are_refused(E, message):
    with pytest.raises(ValueError, match=message):
        Elasticity.PlaneStress(E=E, nu=0.3)


@pytest.mark.parametrize(("factor", "size"), [(1e-200, "small"), (1e-310, "small"), (1e200, "large")])
def test_loads_beyond_double_precision_are_refused(factor, size):
    problem = loaded(1, 1, 1, "modes", "Barbosa, Hughes")
    problem.f = type(problem.f)(problem.V)
    problem.f += factor * CF((0, 1)) * problem.V.TestFunction() * problem.body.ds("top")
    with pytest.raises(ValueError, match=f"the load `f` is too {size}: its energy is about .* take other units"):
        problem.Solve()
