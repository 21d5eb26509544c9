"""Tip functions compared on load B of the paper's test: largest admissible γ_0, errors, unknowns.

python benchmarks/tips.py [--h 0.088 0.057 0.03 0.016 0.008]
"""

import argparse

from ngsolve import TaskManager, ngsglobals
from results import recorded

from ngsxfem_contact import BarbosaHughes, TipEnrichment
from ngsxfem_contact.contact import Coercivity
from study.paper import MATERIAL, REFERENCE, paper_problem, unstructured_mesh

TIPS = {"modes": TipEnrichment(material=MATERIAL, order=1), "branch": TipEnrichment(functions="branch"), "none": None}


def largest_gamma0(mesh, pair, tip, probe=1e-3):
    """∫γ R_h² is linear in γ_0, so one Coercivity gives the value at which it vanishes."""
    return probe / (1 - Coercivity(paper_problem(mesh, pair=pair, stabilisation=BarbosaHughes(gamma0=probe), tip=tip)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--h", type=float, nargs="+", default=[0.088, 0.057, 0.03, 0.016, 0.008])
    sizes = parser.parse_args().h
    ngsglobals.msg_level = 0
    reference = REFERENCE["B"]
    print(f"{'tip':7}{'pair':8}{'h':>7}{'γ0 max':>9}{'energy error':>14}{'force error':>13}{'K_II error':>12}{'unknowns':>10}")
    with TaskManager():
        for name, tip in TIPS.items():
            for pair in ("P1/P1", "P2/P1"):
                for h in sizes:
                    mesh = unstructured_mesh(h)
                    solution = paper_problem(mesh, pair=pair, tip=tip).Solve()
                    error = solution.StressIntensity(method="modes").K_II / reference["K_II"] - 1 if name == "modes" else None
                    K = f"{'-':>12}" if error is None else f"{error:12.1e}"
                    print(
                        f"{name:7}{pair:8}{h:7}{largest_gamma0(mesh, pair, tip):9.4f}{solution.Energy() / reference['energy'] - 1:14.1e}"
                        f"{solution.ContactForce() / reference['contact_force'] - 1:13.1e}{K}{solution.problem.V.ndof:10}",
                        flush=True,
                    )


if __name__ == "__main__":
    recorded(main)
