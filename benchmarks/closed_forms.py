"""Errors and rates on the closed forms (a) to (d) and on an open arc, means over rotated and shifted bodies.

python benchmarks/closed_forms.py [a b c d arc] [--realisations 10]
"""

import numpy as np
from ngsolve import TaskManager, ngsglobals
from results import cases_of, recorded
from scipy.optimize import brentq

from ngsxfem_contact import BarbosaHughes, ContactProblem, CrackedMesh, CrackFESpace, TipEnrichment, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.exact.arc_solution import OpenArc
from study.paper import MATERIAL, PAIRS


def solve(mesh, crack, exact, pair, tip=None, stabilisation=BarbosaHughes()):
    """The contact problem with the exact displacement on the whole boundary."""
    orders = PAIRS[pair]
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL, stabilisation=stabilisation)
    problem.SetDirichlet(exact.u, "outer")
    return problem.Solve()


def case_a(i, maxh, pair, stabilisation=BarbosaHughes(), tip=None):
    """A closed crack from a mouth to a tip under uniform stress: (error of u, of λ), relative."""
    angle, offset = cf.position(i)
    exact = cf.uniform_compression(MATERIAL)
    solution = solve(cf.rotated_square(angle, offset, maxh), cf.crack_on_axis(cf.mouths(angle, offset)[0], 0), exact, pair, tip, stabilisation)
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact)


def case_tip(exact, K, i, maxh, pair, r1=0.4):
    """An edge crack with its tip at the origin: (energy error, λ error, error of the K that is 1)."""
    angle, offset = cf.position(i)
    tip = TipEnrichment(r1=r1, material=MATERIAL)
    solution = solve(cf.rotated_square(angle, offset, maxh), cf.crack_on_axis(cf.mouths(angle, offset)[0], 0), exact, pair, tip)
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), getattr(solution.StressIntensity(method="modes"), K) - 1


ARC = OpenArc(MATERIAL, alpha=0.6, stress=(1, 0.5), beta=0.3)


def arc_body(i, maxh):
    """A body around the last tip of ARC, and the part of the crack in it."""
    angle, offset = cf.position(i)
    centre = np.add(offset, (ARC.tips[1].real, ARC.tips[1].imag))
    c, s = np.cos(angle), np.sin(angle)
    outside = lambda t: np.abs(np.array([[c, s], [-s, c]]) @ (np.array([np.cos(t), np.sin(t)]) - centre)).max() - 0.5
    mouth = brentq(outside, np.pi / 2 - ARC.alpha, np.pi / 2 + ARC.alpha, xtol=1e-15)
    return cf.rotated_square(angle, centre, maxh), ARC.Crack(mouth)


def case_arc(i, maxh, pair, r1=0.4):
    """An open edge crack on an arc: (energy error, λ error, errors of K_I by the modes and by the interaction integral), K relative to K_I."""
    mesh, crack = arc_body(i, maxh)
    exact, K = ARC.Solution(), ARC.StressIntensity(1)[0]
    solution = solve(mesh, crack, exact, pair, TipEnrichment(r1=r1, material=MATERIAL))
    factors = [solution.StressIntensity(method=method).K_I / K - 1 for method in ("modes", "interaction")]
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), *factors


def case_d(i, maxh, pair):
    """A crack through the body that opens on its right part: (energy error, λ error)."""
    angle, offset = cf.position(i)
    exact = cf.contact_transition(MATERIAL)
    solution = solve(cf.rotated_square(angle, offset, maxh), cf.crack_on_axis(*cf.mouths(angle, offset)), exact, pair)
    return cf.energy_error(solution, exact), cf.pressure_error(solution, exact)


def means(case, maxhs, pair, realisations):
    """Mean errors, (len(maxhs), quantities)."""
    return np.array([np.mean([np.abs(case(i, maxh, pair)) for i in range(realisations)], axis=0) for maxh in maxhs])


def rates(maxhs, errors):
    """Slopes fitted to the logarithms of the last three; nan for errors that are zero."""
    return [np.polyfit(np.log(maxhs[-3:]), np.log(e[-3:]), 1)[0] if e.all() else np.nan for e in errors.T]


def report(name, case, maxhs, pairs, realisations):
    """One line for each pair: rates and mean errors of energy norm, λ (and K)."""
    for pair in pairs:
        errors = means(case, maxhs, pair, realisations)
        print(
            f"({name}) {pair:7} rates "
            + " ".join(f"{r:5.2f}" for r in rates(maxhs, errors))
            + "   errors "
            + "  ".join("/".join(f"{e:.1e}" for e in row) for row in errors),
            flush=True,
        )


def main():
    arguments = cases_of(__doc__, ["a", "b", "c", "d", "arc"])
    ngsglobals.msg_level = 0
    n = arguments.realisations
    with TaskManager():
        if "a" in arguments.cases:
            for pair in PAIRS:
                errors = np.array([case_a(i, 0.1, pair) for i in range(n)])
                print(f"(a) {pair:7} worst of {n}: u {errors[:, 0].max():.1e}  λ {errors[:, 1].max():.1e}", flush=True)
        fine = [0.04, 0.02, 0.0141, 0.01]  # r1 / 20 = 0.02
        if "b" in arguments.cases:
            report("b", lambda *a: case_tip(cf.open_tip(MATERIAL), "K_I", *a), fine, ["P2/P1", "P1/P1"], n)
        if "c" in arguments.cases:
            report("c", lambda *a: case_tip(cf.slipping_tip(MATERIAL), "K_II", *a), fine, ["P2/P1", "P2/P0", "P1+/P1", "P1/P1", "P1/P0"], n)
        if "arc" in arguments.cases:
            report("arc", case_arc, fine, ["P2/P1", "P2/P0", "P1+/P1", "P1/P1", "P1/P0"], n)
        if "d" in arguments.cases:
            report("d", case_d, [0.1, 0.05, 0.025, 0.0125], list(PAIRS), n)


if __name__ == "__main__":
    recorded(main)
