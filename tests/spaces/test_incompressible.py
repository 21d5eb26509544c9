"""Materials with ν → ½: the projected divergence D, pressures of their own beside the cracks, and that the answer does not depend on ν."""

import numpy as np
import pytest
from helpers import random_function, rectangle
from ngsolve import CF, Grad, Integrate, Trace, x, y

from ngsxfem_contact import BarbosaHughes, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Nitsche, TraceSpace
from ngsxfem_contact.contact.nitsche import CrackPoints, component_rows
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.operators import NORMAL
from ngsxfem_contact.spaces.incompressible import stress
from ngsxfem_contact.spaces.interpolation import Interpolant

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = rectangle(0.2, (-1, -1), (1, 1))
CRACK = [(-0.4, -0.1), (0.4, 0.15)]
RUBBER = Elasticity.PlaneStrain(E=1, nu=0.4999)


def space(material=RUBBER, crack=CRACK, mesh=MESH, **options):
    return CrackFESpace(CrackedMesh(mesh, Crack(crack)), **({"order": 2, "material": material} | options))


def problem(nu, traction, **options):
    """A square with an inclined crack under tractions on its top and bottom."""
    material = Elasticity.PlaneStrain(E=1, nu=nu)
    V = space(material, bubble=True)
    P, v = ContactProblem(V, TraceSpace(V.body), **options), V.TestFunction()
    P.Pin((-1, -1), "xy"), P.Pin((1, -1), "y")
    P.f += CF(traction) * v * V.body.ds("top") - CF(traction) * v * V.body.ds("bottom")
    return P


@pytest.mark.parametrize("order", [2, 3])
def test_the_dilatation_of_polynomials_is_their_divergence_on_either_side(order):
    V = CrackFESpace(CrackedMesh(MESH, Crack([(-1, -0.13), (1, 0.17)])), order=order, tip=None, bubble=True)
    u = Interpolant(V, CF((x**order - x * y, y**2)), CF((y**order, x * y + x**2)))
    difference = u.Operator("dilatation") - Trace(Grad(u))
    assert Integrate(difference**2 * V.body.dx, MESH) < 1e-20 * Integrate(Trace(Grad(u)) ** 2 * V.body.dx, MESH)


def test_the_dilatation_has_the_moments_of_the_divergence_on_each_part():
    V = space()
    u = random_function(V)
    s, D, H = u.Operator("singular"), u.Operator("dilatation"), V.body.cracks[0].side
    cut = V.body.CrackElements(0)
    for q in (1 + H, 1 - H):
        moments = [Integrate(q * f * V.body.dx(bonus_intorder=0, definedonelements=cut), MESH, element_wise=True).NumPy() for f in (D, Trace(Grad(u)))]
        elements = [T.element for T in V.body.Elements(0) if str(T.kind).endswith("Cut")]
        assert moments[0][elements] == pytest.approx(moments[1][elements], abs=1e-4 * np.abs(moments[1]).max())
    assert Integrate(s**2 * V.body.dx, MESH) > 0


def relative(a, b):
    return np.linalg.norm(np.subtract(a, b)) / np.linalg.norm(a)


def test_open_cracks_under_balanced_tractions_have_the_k_of_any_nu():
    factors = []
    for nu in (0.3, 0.49999):
        solution = problem(nu, (0.2, 1)).Solve()
        factors.append([*solution.StressIntensity(0), *solution.StressIntensity(1)])
    assert relative(*factors) < 0.01


def test_closed_cracks_under_balanced_tractions_have_the_pressure_of_any_nu():
    profiles, factors = [], []
    for nu in (0.3, 0.49999):
        solution = problem(nu, (0, -1)).Solve()
        profiles.append(solution.Profile(n=201).sigma_n)
        factors.append([solution.StressIntensity(tip).K_II for tip in (0, 1)])
    assert relative(*factors) < 0.01
    assert relative(*profiles) < 0.05


@pytest.mark.parametrize("friction", [None, Coulomb(0.1)])
def test_uniform_stress_is_exact_at_a_closed_crack(friction):
    """σ = -I under u = -c (x, y), given on the boundary: div u is as small as 1/λ_L."""
    V = space(dirichlet="left|right|bottom|top")
    P = ContactProblem(V, TraceSpace(V.body), law=friction)
    P.SetDirichlet(-1 / (2 * (RUBBER.lam + RUBBER.mu)) * CF((x, y)), "left|right|bottom|top")
    solution = P.Solve()
    assert solution.Profile(n=51).sigma_n == pytest.approx(-1, abs=1e-8)
    assert solution.Traction(NORMAL, "larger")(CrackPoints(V.body, 3).points).ravel() == pytest.approx(-1, abs=1e-7)


def test_a_given_stress_is_compared_with_the_multiplier():
    """A closed crack in a body that is held everywhere and has σ⁰ = -I: u = 0, λ = -1."""
    V = space(dirichlet="left|right|bottom|top")
    solution = ContactProblem(V, TraceSpace(V.body), initial_stress=CF((-1, 0, 0, -1), dims=(2, 2))).Solve()
    assert solution.Profile(n=51).sigma_n == pytest.approx(-1, abs=1e-8)


def test_the_pressures_of_their_own_make_the_multiplier_the_traction():
    """On elements away from the tips λ and σ_n(u) + π differ by what they are wrong."""
    solution = problem(0.4999, (0, -1)).Solve()
    assert "projected onto P1" in str(solution.report)
    points = CrackPoints(solution.body, 3).points[12:-12]
    values = [f(points).ravel() for f in (solution.multiplier, solution.Traction(NORMAL, "larger"))]
    assert relative(*values) < 0.05


def test_the_energy_is_that_of_the_pressures():
    """Half the work of the loads where they alone act: L(u) = a(u, u), up to what the contact's stabilisation holds."""
    solution = problem(0.4999, (0, -1)).Solve()
    work = float(solution.case.F @ solution.u.vec.FV().NumPy())
    assert solution.Energy() == pytest.approx(0.5 * work, rel=0.01)


def test_each_region_has_its_own_form():
    mesh = rectangle(0.4, (-1, -1), (1, 1))
    mesh.ngmesh.SetMaterial(1, "rubber")
    one, other = (Elasticity.ByRegion(mesh, {"rubber": material}) for material in (RUBBER, Elasticity.PlaneStrain(E=1, nu=0.3)))
    V = space(mesh=mesh)
    u = random_function(V)
    for by_region, material in ((one, RUBBER), (other, Elasticity.PlaneStrain(E=1, nu=0.3))):
        difference = stress(by_region, u) - stress(material, u)
        assert Integrate(CF(sum(difference[i] ** 2 for i in range(4))) * V.body.dx, mesh) < 1e-20
    assert not other.nearly_incompressible


def test_the_rows_of_nitsche_are_the_projected_traction():
    with pytest.warns(AccuracyWarning, match="Nitsche"):
        P = problem(0.4999, (0, -1), stabilisation=Nitsche(1))
    nodes, u = CrackPoints(P.body, 4), random_function(P.V)
    rows = component_rows(P, nodes)[1][0] @ u.vec.FV().NumPy()
    assert rows == pytest.approx(nodes.Values(P.ComparedTraction().Of(u, NORMAL, "larger")), rel=1e-9)


def test_spaces_that_lock_or_lose_an_order_are_named():
    V = space(order=1)
    with pytest.warns(AccuracyWarning, match=r"nu = 0.4999 .*order=1 locks.*order=2, material="):
        ContactProblem(V, TraceSpace(V.body), RUBBER)
    V = space(bubble=False)
    with pytest.warns(AccuracyWarning, match=r"without bubbles.*order=2, material="):
        ContactProblem(V, TraceSpace(V.body), RUBBER)


def test_what_round_off_spoils_is_named():
    V = space(Elasticity.PlaneStrain(E=1, nu=0.499999))
    with pytest.warns(AccuracyWarning, match=r"nu = 0.499999 .*round-off.*0.49999"):
        ContactProblem(V, TraceSpace(V.body))


def test_the_bubbles_come_with_the_material():
    assert space().ndof == space(bubble=True).ndof > space(bubble=False).ndof
    ordinary = Elasticity.PlaneStrain(E=1, nu=0.45 - 1e-9)
    assert space(ordinary).ndof == space(ordinary, bubble=False).ndof
    thin = Elasticity.PlaneStress(E=1, nu=0.4999)
    assert space(thin).ndof == space(thin, bubble=False).ndof


@pytest.mark.parametrize("crack", [[(-1, -0.13), (0.31, 0.1)], [(-0.43, 0.2), (0.1, -0.2), (0.5, 0)]])
def test_k_minus_k_gamma_is_positive(crack):
    from ngsxfem_contact.contact.checks import Coercivity

    V = space(crack=crack, dirichlet="left|right|bottom|top")
    assert 0 < Coercivity(ContactProblem(V, TraceSpace(V.body), RUBBER, stabilisation=BarbosaHughes())) < 1
