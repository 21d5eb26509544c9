"""Active-set iterations on the meshes of the study, load B, stabilised: cold, from an empty set, from the next coarser mesh.

    python benchmarks/active_sets.py --realisations 3

The first set counts as an iteration, as in `report.iterations`; iterations on coarser sets of nodes are in brackets.
"""

import argparse

import numpy as np
from ngsolve import ngsglobals
from results import recorded

from ngsxfem_contact import TipEnrichment
from ngsxfem_contact.contact.options import StepOptions
from ngsxfem_contact.contact.solver import ReducedProblem
from study.paper import MATERIAL, PAIRS, paper_problem
from study.study import SIZES, realisation_mesh


def counts(mesh, pair, coarser):
    """Iterations cold, on coarser sets before it, from an empty set, from a coarser solution or None; and the solution."""
    reduced = ReducedProblem(paper_problem(mesh, pair=pair, tip=TipEnrichment(material=MATERIAL, r1=0.25)))
    solution = reduced.Step()
    empty = reduced.Step(StepOptions(start=np.zeros(reduced.problem.W.ndof, dtype=bool))).report.iterations
    warm = reduced.Step(StepOptions(start=coarser)).report.iterations if coarser else 0
    return (solution.report.iterations, solution.report.coarse_iterations, empty, warm), solution


def main():
    """The largest counts over the realisations, for each pair and size."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--realisations", type=int, default=3)
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    for structured in (False, True):
        meshes = [[realisation_mesh(h, i, structured) for i in range(options.realisations)] for h in SIZES]
        for pair in PAIRS:
            coarser = [None] * options.realisations
            for h, row in zip(SIZES, meshes):
                found = [counts(mesh, pair, start) for mesh, start in zip(row, coarser)]
                coarser = [solution for _, solution in found]
                cold, before, empty, warm = np.max([numbers for numbers, _ in found], axis=0)
                kind = "structured" if structured else "unstructured"
                print(f"{kind:12} {pair:6} h {h:5}  cold {cold} ({before})  empty {empty:2}  from the coarser mesh {warm or '-'}", flush=True)


if __name__ == "__main__":
    recorded(main)
