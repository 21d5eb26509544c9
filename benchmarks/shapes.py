"""Arc, two cracks and a kinked crack against boundary-fitted reference values: deviations and rates.

python benchmarks/shapes.py [--maxh 0.08 0.05 0.03] [--pairs P2/P1]
"""

import argparse

import numpy as np
from results import recorded

from study.shapes import KINK, SHAPES, body_mesh, deviations, shape_problem

COLUMNS = ("energy", "contact_force", "K")


def meshes(name, sizes):
    """(label, maxh, mesh): uniform ones, and for the kinked crack refined ones."""
    for maxh in sizes:
        yield "uniform", maxh, body_mesh(maxh)
    if name == "kinked":
        for maxh in sizes:
            yield "refined", maxh, body_mesh(maxh, refined_at=KINK, size=maxh**2 / 4)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maxh", type=float, nargs="+", default=[0.08, 0.05, 0.03])
    parser.add_argument("--pairs", nargs="+", default=["P2/P1", "P1/P0"])
    parser.add_argument("--shapes", nargs="+", default=list(SHAPES))
    arguments = parser.parse_args()
    print(f"{'shape':12}{'pair':8}{'mesh':9}{'maxh':>7}{'unknowns':>10}" + "".join(f"{c:>15}" for c in COLUMNS) + "  rates")
    for name in arguments.shapes:
        for pair in arguments.pairs:
            before = {}
            for label, maxh, mesh in meshes(name, arguments.maxh):
                problem = shape_problem(name, mesh, pair)
                row = deviations(name, problem.Solve())
                rates = ""
                if label in before:
                    h, old = before[label]
                    rates = " ".join(f"{np.log(old[c] / row[c]) / np.log(h / maxh):6.2f}" for c in COLUMNS)
                before[label] = maxh, row
                print(f"{name:12}{pair:8}{label:9}{maxh:7.3f}{problem.V.ndof:10d}" + "".join(f"{row[c]:15.2e}" for c in COLUMNS) + "  " + rates, flush=True)


if __name__ == "__main__":
    recorded(main)
