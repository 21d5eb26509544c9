"""The powers of r at a tip: errors and rates on Williams' expansion, and at the tip of an open arc, means over rotated and shifted bodies, by the orders of the space and of its modes.

python benchmarks/tip_orders.py [--fields "open, all" ... "open arc"] [--realisations 3]
"""

import argparse

import numpy as np
from closed_forms import ARC, arc_body, means, rates
from ngsolve import ngsglobals
from results import recorded

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, TipEnrichment, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import MATERIAL

FIELDS = {  # of r^{1/2}, r^{3/2}, r^{5/2}; K, and the orders of the spaces
    "open, all": (cf.williams_tip(MATERIAL, opening=[1, -1, 1]), (1, 0), (2, 3)),
    "closed, all": (cf.williams_tip(MATERIAL, sliding=[1, 1, 1], p=1), (0, 1), (2, 3)),
    "open, 3/2": (cf.williams_tip(MATERIAL, opening=[0, -1]), (0, 0), (2,)),
    "closed, 3/2": (cf.williams_tip(MATERIAL, sliding=[0, 1], p=1), (0, 0), (2,)),
    "open arc": (ARC.Solution(), ARC.StressIntensity(1), (2, 3)),
}


def straight_body(i, maxh):
    """A body with its tip at the origin: (mesh, crack)."""
    angle, offset = cf.position(i)
    return cf.rotated_square(angle, offset, maxh), cf.crack_on_axis(cf.mouths(angle, offset)[0], 0)


def case_of(body_of, exact, K, order, modes):
    """case(i, maxh, pair): (energy error, λ error, the larger error of K_I and K_II as coefficients) with modes of an order."""

    def case(i, maxh, pair):
        body = CrackedMesh(*body_of(i, maxh))
        V = CrackFESpace(body, order=order, tip=TipEnrichment(r1=0.4, order=modes), material=MATERIAL, dirichlet="outer")
        problem = ContactProblem(V, TraceSpace(body, order=order - 1))
        problem.SetDirichlet(exact.u, "outer")
        solution = problem.Solve()
        factors = np.subtract(tuple(solution.StressIntensity(method="modes")), K)
        return cf.energy_error(solution, exact), cf.pressure_error(solution, exact), np.abs(factors).max()

    return case


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fields", nargs="+", default=[name for name in FIELDS if name != "open arc"], choices=FIELDS)
    parser.add_argument("--realisations", type=int, default=3)
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    maxhs = [0.05, 0.025, 0.0125]
    print(f"{'field':12} {'pair':6}{'modes':>6}   rates of energy, λ, K   errors of them at h = 0.05, 0.025, 0.0125")
    for name in options.fields:
        exact, K, orders = FIELDS[name]
        for order in orders:
            for modes in range(1, order + 1):
                errors = means(case_of(arc_body if name == "open arc" else straight_body, exact, K, order, modes), maxhs, None, options.realisations)
                slopes = " ".join(f"{rate:6.2f}" for rate in rates(maxhs, errors))
                print(f"{name:12} P{order}/P{order - 1} {modes:6}   {slopes}   " + "  ".join("/".join(f"{e:.1e}" for e in row) for row in errors), flush=True)


if __name__ == "__main__":
    recorded(main)
