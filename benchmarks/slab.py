"""A straight front through a slab between planes of symmetry beside the plane package in its cross-section, in plane strain.

    python benchmarks/slab.py

The slab 1 x 1 x 0.25 has an edge crack of length 0.385 in y = 0.61, u_z = 0 at z = 0 and z = 0.25, and its bottom held. The plane problem is solved with P3 and edges of 0.02, which leaves errors of 1e-4 and less.
K: the largest deviation of (K_I, K_II) at the nodes of the front between its ends, percent of the plane |K|; at ends: at the two on the planes of symmetry, where half hats see stress on these planes that the
exact solution has not; K_III: its largest value, which is zero in the plane. faces: in L², the gap where the crack is open, λ where it closes; force: of contact. "order in h" is that of
the best line through the logarithms, over all meshes.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
from ngsolve import SetNumThreads, ngsglobals
from results import recorded

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests" / "contact")]

from slabs import deviations, plane_solution, slab_solution  # noqa: E402

from ngsxfem_contact import Coulomb  # noqa: E402

LOADS = {"open": ((0, 1), None), "closes, frictionless": ((0.3, -1), None), "closes, Coulomb 0.3": ((0.5, -1), Coulomb(0.3))}
CASES = ((1, 0, 0, (12, 20, 28)), (1, 0.2, 0, (12, 20, 28)), (1, 0.2, 1, (12, 20, 28)), (2, 0, 0, (12, 20)), (2, 0.2, 0, (12, 20)))
NAMES = ("K", "at ends", "K_III", "faces", "force", "energy")


def row(values, digits):
    return "".join(f"{value:8.{digits}f}" if np.isfinite(value) and value else f"{'':8}" for value in values)


def main():
    ngsglobals.msg_level = 0
    SetNumThreads(1)
    warnings.simplefilter("ignore")
    print(f"{'crack':22}{'order':>6}{'of λ':>6}{'modes':>10}{'n':>4}{'N':>8}{'m':>6}" + "".join(f"{name:>8}" for name in NAMES) + "   percent")
    for name, (load, law) in LOADS.items():
        plane = plane_solution(load, law)
        for order, radius, multipliers, sizes in CASES:
            if multipliers and name == "open":
                continue
            modes, rows = "at front" if not radius else f"r < {radius}", []
            for n in sizes:
                slab = slab_solution(load, law, n, order, radius, multipliers)
                rows.append(deviations(slab, plane))
                print(f"{name:22}{order:6}{multipliers:6}{modes:>10}{n:4}{slab.problem.V.ndof:8}{len(slab.state.L):6}{row(100 * rows[-1], 3)}", flush=True)
            orders = [-np.polyfit(np.log(sizes), np.log(column), 1)[0] if min(column) > 0 else np.nan for column in np.array(rows).T]
            print(f"{'':48}{'order in h':>14}{row(orders, 2)}")


if __name__ == "__main__":
    recorded(main)
