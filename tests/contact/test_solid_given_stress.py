"""Given stresses and temperature in space: closed forms, and loads that mean the same."""

import numpy as np
import pytest
from ngsolve import CF, L2, Grad, GridFunction, Id, IfPos, InnerProduct, Integrate, exp, x, y, z

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.exact.pennies import penny_in_tension
from ngsxfem_contact.geometry import Sheet
from tests.sheets.exact_sheets import cube_mesh

NU = 0.25
MATERIAL = Elasticity.Solid(E=2.5, nu=NU, alpha=0.01)
CENTRE, RADIUS, NORMAL = (0.49, 0.51, 0.513), 0.3, (0.2, -0.1, 1.0)
MESH = cube_mesh(0.11)


def problem(normal=NORMAL, front=True, **given):
    body = CrackedMesh(MESH, Sheet.Disk(CENTRE, normal, RADIUS))
    options = {} if front else {"front": None}
    V = CrackFESpace(body, order=1, dirichlet="outer", material=MATERIAL, **options)
    return ContactProblem(V, TraceSpace(body, order=0), **given)


def matrix(*entries):
    xx, xy, xz, yy, yz, zz = entries
    return CF((xx, xy, xz, xy, yy, yz, xz, yz, zz), dims=(3, 3))


def pressure(solution):
    return solution.multiplier.vec.FV().NumPy()


def test_a_held_body_that_is_heated():
    """u = 0, and σ = -E α ΔT / (1 - 2ν) I is the pressure on the sheet."""
    solution = problem(front=False, temperature=30.0).Solve()
    stress = -2.5 * 0.01 * 30 / (1 - 2 * NU)
    assert pressure(solution) == pytest.approx(stress, rel=1e-11)
    assert np.abs(solution.u.vec.FV().NumPy()).max() < 1e-12
    assert Integrate(InnerProduct(solution.stress - stress * Id(3), solution.stress - stress * Id(3)), MESH) < 1e-20


def test_an_initial_stress_that_the_faces_bear():
    """u = 0 and λ = n·σ⁰n, with friction that bears the shear."""
    stress = np.array([[-1.0, 0.1, 0.2], [0.1, -2.0, 0.0], [0.2, 0.0, -3.0]])
    solution = problem(front=False, law=Coulomb(0.5), initial_stress=CF(tuple(stress.ravel()), dims=(3, 3))).Solve()
    n = np.array(NORMAL) / np.linalg.norm(NORMAL)
    assert pressure(solution) == pytest.approx(n @ stress @ n, rel=1e-11)
    assert np.abs(solution.u.vec.FV().NumPy()).max() < 1e-12


def test_an_initial_stress_is_a_traction_of_the_faces():
    """Of a stress in equilibrium only what the cut releases acts: the same as a traction on the faces, in u, the pressure and K."""
    n = CF(tuple(np.array(NORMAL) / np.linalg.norm(NORMAL)))
    stress = matrix(0.3 + 0.5 * y, 0.1, 0.2 * x, 0.4, -0.1, 1.0 - 0.2 * z)  # div σ⁰ = 0
    given, pressed = problem(initial_stress=stress), problem()
    pressed.FaceTraction(stress * n, -stress * n)
    solutions = [one.Solve() for one in (given, pressed)]
    displacements = [one.u.vec.FV().NumPy() for one in solutions]
    assert displacements[0] == pytest.approx(displacements[1], abs=2e-3 * np.abs(displacements[1]).max())
    K = [one.StressIntensity() for one in solutions]
    for name in ("K_I", "K_II", "K_III"):
        first, second = (getattr(one, name) for one in K)
        assert first == pytest.approx(second, abs=5e-3 * np.abs(K[1].K_I).max())


def test_a_stress_that_only_the_gradient_sees():
    """Terms in Grad(v) are given stresses, too: the same displacement and stress as by initial_stress=."""
    stress = matrix(0.3, 0.1, 0.2, 0.4, -0.1, 1.0 + 0.1 * x)
    by_argument, by_term = problem(initial_stress=stress), problem()
    by_term.f += -InnerProduct(stress, Grad(by_term.V.TestFunction())) * by_term.body.dx
    first, second = by_argument.Solve(), by_term.Solve()
    assert first.u.vec.FV().NumPy() == pytest.approx(second.u.vec.FV().NumPy(), abs=1e-12)
    difference = first.stress - second.stress
    assert Integrate(InnerProduct(difference, difference), MESH) < 1e-20


def test_tension_as_an_initial_stress():
    """The penny in tension: the displacement of the disk alone is given on the boundary, the uniform part is σ⁰."""
    form = penny_in_tension(MATERIAL, RADIUS, 1.0).At(CENTRE)
    uniform = matrix(0, 0, 0, 0, 0, 1.0)
    stretched = CF((-NU / 2.5 * (x - CENTRE[0]), -NU / 2.5 * (y - CENTRE[1]), (z - CENTRE[2]) / 2.5))
    one = problem((0, 0, 1), initial_stress=uniform)
    one.SetDirichlet(form.u - stretched, "outer")
    other = problem((0, 0, 1))
    other.SetDirichlet(form.u, "outer")
    first, second = one.Solve().StressIntensity(), other.Solve().StressIntensity()
    assert first.K_I == pytest.approx(second.K_I, rel=2e-3)


def test_stresses_that_vary_and_jump():
    """A smooth one has derivatives that K needs; one that jumps at a front is refused, with what to do."""
    smooth = problem(temperature=-exp(x) * (1 + y)).Solve().StressIntensity()
    assert np.all(smooth.K_I > 0) and np.all(smooth.errors[:, 0] < 0.5 * smooth.K_I.max())
    jumping = problem(temperature=IfPos(x - 0.5, -1.0, -2.0)).Solve()
    with pytest.raises(ValueError, match="given stress jumps near a front"):
        jumping.StressIntensity()


def test_limits_on_a_sheet():
    """Of functions that jump there, linear ones are exact."""
    body = CrackedMesh(MESH, Sheet.Disk(CENTRE, (0, 0, 1), RADIUS))
    above = IfPos(z - CENTRE[2], 1, -1)
    for side in (1, -1):
        limit = body.LimitOnCrack(above * (2 + 3 * x - y + z), side)
        assert Integrate((limit - side * (2 + 3 * x - y + CENTRE[2])) ** 2 * body.dcrack, MESH) < 1e-16


def test_what_is_refused():
    V = problem().V
    W = TraceSpace(V.body, order=0)
    with pytest.raises(ValueError, match="3 × 3 matrix"):
        ContactProblem(V, W, initial_stress=CF(tuple(range(9))))
    with pytest.raises(ValueError, match="not symmetric"):
        ContactProblem(V, W, initial_stress=CF((1, 2, 0, 0, 1, 0, 0, 0, 1), dims=(3, 3)))
    constant = GridFunction(L2(MESH, order=0))
    assert ContactProblem(V, W, temperature=constant).initial.given
