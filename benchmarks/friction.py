"""Friction: the closed form (e), all-stick, and boundary-fitted reference solutions with Tresca's and Coulomb's law.

python benchmarks/friction.py [e stick reference] [--realisations 10]
"""

import numpy as np
from closed_forms import report
from ngsolve import TaskManager, ngsglobals
from results import cases_of, recorded

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Nitsche, TipEnrichment, TraceSpace, Tresca
from ngsxfem_contact.algebra import FixedPoint
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import FRICTION_REFERENCE, MATERIAL, PAIRS, paper_problem, unstructured_mesh

LAWS = {"Coulomb 0.3": Coulomb(0.3), "Tresca 0.05": Tresca(0.05)}
FINE = [0.04, 0.02, 0.0141, 0.01]


def problem_with(exact_u, i, maxh, pair, friction, tip):
    """An edge crack with its tip at the origin, displacements given on the whole boundary."""
    angle, offset = cf.position(i)
    body = CrackedMesh(cf.rotated_square(angle, offset, maxh), cf.crack_on_axis(cf.mouths(angle, offset)[0], 0))
    orders = PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL, law=friction)
    problem.SetDirichlet(exact_u, "outer")
    return problem


def case_e(i, maxh, pair, mu_f=0.3):
    """(energy error, λ_n error, error of K_II = 1, λ_t error, slip error)."""
    exact = cf.sliding_tip(MATERIAL, mu_f)
    solution = problem_with(exact.u, i, maxh, pair, Coulomb(mu_f), TipEnrichment(r1=0.4, material=MATERIAL)).Solve()
    K_II = solution.StressIntensity().K_II
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), K_II - 1, cf.shear_error(solution, exact), cf.slip_error(solution, exact)


def case_uniform_stick(i, maxh, pair, tip=None):
    """Uniform stress on a crack that sticks: errors of energy norm, λ_n, λ_t."""
    exact = cf.uniform_stress(MATERIAL, 0.3, 0.4, -1)
    solution = problem_with(exact.u, i, maxh, pair, Coulomb(0.5), tip).Solve()
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), cf.shear_error(solution, exact)


def case_smooth_stick(i, maxh, pair):
    """The uncracked body's smooth field under a crack that sticks."""
    exact = cf.sticking_crack(MATERIAL)
    solution = problem_with(exact.u, i, maxh, pair, Coulomb(2), None).Solve()
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), cf.shear_error(solution, exact)


def reference_case(name, maxh=0.03, pair="P2/P1", **options):
    """A case of paper.FRICTION_REFERENCE solved: (solution, its reference)."""
    load, kind = name.split(", ")
    law = options.pop("law", LAWS[kind])
    return paper_problem(unstructured_mesh(maxh / 2), load, pair, law=law, **options).Solve(), FRICTION_REFERENCE[name]


def print_reference(name, **options):
    solution, exact = reference_case(name, **options)
    counts = solution.report
    work = (solution.DissipatedEnergy() - exact["friction_work"]) / exact["energy"]
    print(
        f"{name:17} energy {solution.Energy() / exact['energy'] - 1:+.1e}  work {work:+.1e}  "
        f"contact from {solution.Transitions()} ({exact['transition']:.4f})  slip to {solution.SlipTransitions()} ({exact['slip_transition']})  "
        f"K_II {solution.StressIntensity().K_II:+.5f} ({exact['K_II']:+.5f})  {counts.iterations} iterations, {counts.method}, uniqueness {counts.uniqueness:.2g}",
        flush=True,
    )


def main():
    arguments = cases_of(__doc__, ["e", "stick", "reference"])
    ngsglobals.msg_level = 0
    n = arguments.realisations
    with TaskManager():
        if "reference" in arguments.cases:
            for name in FRICTION_REFERENCE:
                print_reference(name)
            print_reference("C, Coulomb 0.3", law=Coulomb(0.3, FixedPoint()))
            for theta in (1, 0, -1):
                for name in list(FRICTION_REFERENCE)[:2]:
                    print(f"Nitsche {theta:2}", end=" ")
                    print_reference(name, stabilisation=Nitsche(theta))
        if "stick" in arguments.cases:
            for pair in PAIRS:
                for tip, name in ((None, "no tip functions"), (TipEnrichment(r1=0.3, material=MATERIAL), "modes")):
                    worst = np.max([case_uniform_stick(i, 0.1, pair, tip) for i in range(n)], axis=0)
                    print(f"(stick, uniform) {pair:7} {name:16} worst of {n}: u {worst[0]:.1e}  λ_n {worst[1]:.1e}  λ_t {worst[2]:.1e}", flush=True)
            report("stick, smooth", case_smooth_stick, [0.1, 0.05, 0.025, 0.0125], PAIRS, n)
        if "e" in arguments.cases:
            report("e", case_e, FINE, PAIRS, n)


if __name__ == "__main__":
    recorded(main)
