"""The estimated error beside the true one, and what goes into it."""

import numpy as np
import pytest
from helpers import MATERIAL, rectangle, rotated_problem
from ngsolve import CF, LinearForm, Parameter, x, y

from ngsxfem_contact import ContactProblem, ContactSolution, Coulomb, Crack, CrackedMesh, CrackFESpace, Jump, LoadSteps, Nitsche, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import Joint
from ngsxfem_contact.estimate.next_order import NextOrder
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import PAIRS

TIP = TipEnrichment(material=MATERIAL)
FORMS = {
    "open tip": (cf.open_tip(MATERIAL), {}),
    "slipping tip": (cf.slipping_tip(MATERIAL), {}),
    "transition": (cf.contact_transition(MATERIAL), {"through": True}),
    "friction": (cf.sliding_tip(MATERIAL, 0.3), {"law": Coulomb(0.3)}),
}

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


def solved(name, pair, maxh, **options):
    exact, more = FORMS[name]
    tip = None if "through" in more else TIP
    return rotated_problem(exact, PAIRS[pair], maxh, tip=tip, **(more | options)).Solve(), exact


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("name", FORMS)
def test_effectivity_on_closed_forms(name, pair):
    solution, exact = solved(name, pair, 0.1)
    estimate = solution.ErrorEstimate()
    assert 0.9 < estimate.energy / cf.energy_error(solution, exact) < 1.7
    assert np.sqrt((estimate.elements**2).sum()) == pytest.approx(estimate.energy, rel=1e-12)


@pytest.mark.parametrize("options", [{"stabilisation": Nitsche(1)}, {"stabilisation": Nitsche(0)}, {"stabilisation": None}, {"cone": "weak"}], ids=str)
@pytest.mark.parametrize("name", ["slipping tip", "transition"])
def test_other_methods(name, options):
    pair = "P2/P0" if "stabilisation" in options and options["stabilisation"] is None else "P2/P1"
    solution, exact = solved(name, pair, 0.08, **options)
    assert 0.9 < solution.ErrorEstimate().energy / cf.energy_error(solution, exact) < 2


def test_elements_say_where_the_error_is():
    """By the true error of each element: the worst tenth holds as much of it as it says, within a fifth."""
    from ngsolve import L2, InnerProduct

    solution, exact = solved("open tip", "P2/P1", 0.06)
    difference = solution.stress - exact.stress
    density = InnerProduct(difference, MATERIAL.Strain(difference)) * L2(solution.body.mesh, order=0).TestFunction()
    true = LinearForm(density * solution.body.dx(space=solution.problem.V, bonus_intorder=10)).Assemble().vec.FV().NumPy()
    elements = solution.ErrorEstimate().elements
    worst = np.argsort(-elements)[: len(elements) // 10]
    said, held = ((values[worst] / values.sum()).sum() for values in (elements**2, true))
    assert said == pytest.approx(held, rel=0.2) and said > 0.3


def test_an_exact_solution_has_no_error():
    exact = cf.uniform_compression(MATERIAL)
    for pair in ("P2/P1", "P1/P0"):
        solution = rotated_problem(exact, PAIRS[pair], 0.1, tip=TIP).Solve()
        assert solution.ErrorEstimate().relative < 1e-6


def test_given_displacements_count():
    """Without a crack, u = 0 but for a given displacement that P1 does not have: its loss on the boundary is most of the error."""
    body = CrackedMesh(rectangle(0.2))
    V = CrackFESpace(body, order=1, dirichlet="bottom|top", material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, order=1))
    problem.SetDirichlet(CF((0, x * (1 - x))), "top")
    solution = problem.Solve()
    fine = ContactProblem(CrackFESpace(body, order=6, dirichlet="bottom|top", material=MATERIAL), TraceSpace(body, order=1))
    fine.SetDirichlet(CF((0, x * (1 - x))), "top")
    reference = fine.Solve()
    true = cf.energy_error(solution, cf.ClosedForm(None, reference.stress, CF(0), CF(0)))
    assert 0.9 < solution.ErrorEstimate().energy / true < 1.3
    given, nothing = NextOrder(solution), NextOrder(solution)
    nothing.__dict__["given"] = 0 * given.given
    assert given.Error()[1].energy != nothing.Error()[1].energy


def loaded_problem(maxh=0.12, order=2, law=None, springs=False):
    body = CrackedMesh(rectangle(maxh), Crack([(0, 0.52), (0.53, 0.52)]))
    V = CrackFESpace(body, order=order, material=MATERIAL, dirichlet="bottom", tip=TipEnrichment(tolerance=1e-8))
    problem = ContactProblem(V, TraceSpace(body, order=1), law=law)
    u, v = V.TnT()
    problem.f += CF((0, x - 0.3)) * v * body.ds("top")
    if springs:
        problem.a += 0.3 * u * v * body.ds("right") + 0.5 * Jump(u) * Jump(v) * body.dcrack
        problem.f += CF((y, -2)) * v * body.dx
        problem.FacePressure(-0.02)
        if springs == "and a point load":
            problem.f += v[0](0.8, 0.7)
    return problem


@pytest.mark.parametrize("options", [{}, {"springs": "and a point load"}, {"law": Joint(0.4, 0.2)}], ids=["load", "springs", "joint"])
def test_the_residual_on_the_space_itself_is_that_of_the_system(options):
    """On V_h: what stabilises, ∫γ (λ_h - R_h(u_h) - r_0) R_h(v), by the matrices of (38)."""
    solution = loaded_problem(**options).Solve()
    next_order, system = NextOrder(solution), solution.reduced.system
    U, L = solution.u.vec.FV().NumPy(), solution.state.L
    free = np.array([bool(bit) for bit in solution.problem.free])
    left = next_order.higher.Restricted(next_order.residual)
    v, components = solution.problem.V.TestFunction(), solution.problem.law.components
    multipliers = [m for m in (solution.multiplier, solution.tangential_multiplier) if m is not None]
    terms = sum(solution.gamma * (m - solution.Traction(c, "larger")) * system.traction.Summed(v, c) for m, c in zip(multipliers, components))
    right = LinearForm(terms * system.dcrack).Assemble().vec.FV().NumPy()
    size = np.abs(system.Stiffness(U)).max()
    assert np.abs((left - right)[free]).max() < 1e-9 * size and np.abs(right).max() > 1e-6 * size and L.any()


def test_a_body_with_springs_and_loads_against_a_finer_order():
    """The energy norm of the difference from order 4."""
    solution, fine = loaded_problem(springs=True).Solve(), loaded_problem(order=4, springs=True).Solve()
    true = cf.energy_error(solution, cf.ClosedForm(None, fine.stress, CF(0), CF(0)))
    assert 0.8 < solution.ErrorEstimate().energy / true < 1.7


def test_load_steps_and_factors_that_were_released():
    problem = loaded_problem()
    steps, whole = LoadSteps(problem), problem.Solve()
    for t in (0.5, 1.0):
        assert steps.Solve(t).ErrorEstimate().energy == pytest.approx(t * whole.ErrorEstimate().energy, rel=1e-6)
    said = whole.ErrorEstimate().energy
    whole.ReleaseFactors()
    assert whole._reduced is None and whole.ErrorEstimate().energy == pytest.approx(said, rel=1e-12)


def test_a_solution_that_was_saved(tmp_path):
    """Loads come with the file, given displacements do not, and the estimate says so."""
    solution = loaded_problem().Solve()
    read = ContactSolution.Load(solution.Save(tmp_path / "a"))
    assert read.ErrorEstimate().energy == pytest.approx(solution.ErrorEstimate().energy, rel=1e-9) and not read.ErrorEstimate().notes
    held, exact = solved("open tip", "P2/P1", 0.12)
    again = ContactSolution.Load(held.Save(tmp_path / "b")).ErrorEstimate()
    assert "read from a file" in again.notes[0] and 0.5 < again.energy / held.ErrorEstimate().energy < 1.2


def test_notes_and_refusals():
    load = Parameter(1.0)
    problem = loaded_problem()
    problem.f += load * CF((0, 0.1)) * problem.V.TestFunction() * problem.body.ds("top")
    solution = problem.Solve()
    load.Set(2)
    with pytest.raises(ValueError, match="has changed since the solve"):
        solution.ErrorEstimate()
    assert "law of the faces" in loaded_problem(law=Joint(1, 1)).Solve().ErrorEstimate().notes[0]
    exact, _ = FORMS["open tip"]
    bare = rotated_problem(exact, PAIRS["P2/P1"], 0.12).Solve().ErrorEstimate()
    assert "no functions at the tip" in bare.notes[0] and bare.saturation > 1.7 and "note" in repr(bare)
    held = solved("open tip", "P2/P1", 0.12)[0]
    held.problem.SetDirichlet(CF((x, y)), "outer")
    assert "are other ones now" in held.ErrorEstimate().notes[0]
