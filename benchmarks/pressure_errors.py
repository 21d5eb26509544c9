"""The error of λ in L²(Γ_C) that ErrorEstimate().Goal(ContactPressure()) says, beside the true one, and runs of SolveAdaptive to a tolerance of it at random positions of one mesh.

    python benchmarks/pressure_errors.py [--cases "(d)" ...] [--maxh 0.12 0.06 0.03] [--pairs P2/P1 ...] [--positions 100] [--tolerances 0.001]

Effectivity, said over true, from the least to the largest over meshes, uniform ones and those with elements of a sixth of maxh at tips, for (d) at the transition. Closed forms are those of
`error_estimate`; the truth of loads B and C of the paper, C with friction, and of two `shapes`, is P2/P1 on a mesh of maxh = 0.012 with elements of 0.001 where contact ends. The third shape is left out: contact ends at its kink, where λ is singular.
Positions: (d) on one mesh of maxh = 0.06, as in `transition_nodes`, which is refined until the bar is below the tolerance, relative to the norm of λ_h.
"""

import argparse
import warnings

import numpy as np
from error_estimate import FITTED, PLATES, closed, fitted, fitted_mesh, graded, span
from ngsolve import CF, ngsglobals
from positions import closed_position
from results import recorded
from transition_nodes import EXACT, Transition

from ngsxfem_contact.estimate import ContactPressure, SolveAdaptive
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.points import crack_points
from study.paper import PAIRS, REFERENCE
from study.shapes import SHAPES

CLOSED = ["(c)", "(d)", "(e)", "inclined, compression", "the same with friction"]


def of_closed(name, maxh, is_graded, pair):
    """(solution, true error)."""
    solution, exact = closed(name, maxh, is_graded, pair)
    pressure = CF(PLATES[name][0]) if name in PLATES else exact.pressure
    return solution, cf.error_on_crack(solution, solution.multiplier - pressure, 10)


def edges(name):
    """Where contact ends in a fitted case."""
    if name not in SHAPES:
        return [(REFERENCE[FITTED[name]]["transition"], 0)]
    return [crack.PointAt(s) for crack, transitions in zip(SHAPES[name].cracks, SHAPES[name].transitions) for s in transitions]


def distance(solution, reference, number=20_000):
    """‖λ_h - λ‖ of two solutions with the same cracks, by the midpoints of equal parts of each crack."""
    square = 0.0
    for c, crack in enumerate(solution.body.cracks):
        s = crack.length * (np.arange(number) + 0.5) / number
        values = [np.ravel(each.multiplier(crack_points(each.body, c, s))) for each in (solution, reference)]
        square += crack.length * np.mean((values[0] - values[1]) ** 2)
    return np.sqrt(square)


def effectivities(name, options):
    """{pair: said over true, of each mesh}."""
    reference = None
    if name in FITTED:
        reference = fitted(name, graded([(0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5)], 0.012, edges(name), 0.001), "P2/P1")
    found = {pair: [] for pair in options.pairs}
    for pair, ratios in found.items():
        for is_graded in (False, True):
            for maxh in options.maxh:
                if reference is None:
                    solution, true = of_closed(name, maxh, is_graded, pair)
                else:
                    solution = fitted(name, fitted_mesh(name, maxh, maxh / 6 if is_graded else maxh), pair)
                    true = distance(solution, reference)
                ratios.append(solution.ErrorEstimate().Goal(ContactPressure()).bar / true)
    return found


def refined(seed, tolerance, maxh=0.06):
    """(true error, said error, error in the energy norm, unknowns, levels) of (d) at one position."""
    mesh, *ends = closed_position(seed, maxh)
    found = SolveAdaptive(lambda mesh: Transition(mesh, *ends).Problem(), mesh, ContactPressure(), tolerance)
    solution = found.solution
    return cf.pressure_error(solution, EXACT), found.quantity.bar, cf.energy_error(solution, EXACT), solution.problem.V.ndof, len(found.levels)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maxh", type=float, nargs="+", default=[0.12, 0.06, 0.03])
    parser.add_argument("--pairs", nargs="+", default=list(PAIRS))
    parser.add_argument("--cases", nargs="*", default=[*CLOSED, *(name for name in FITTED if name not in ("load A", "kinked"))])
    parser.add_argument("--positions", type=int, default=100)
    parser.add_argument("--tolerances", type=float, nargs="+", default=[0.001])
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    warnings.simplefilter("ignore")  # of cracks that are short for a mesh
    print(f"{'':24}" + "".join(f"{pair:^15}" for pair in options.pairs), flush=True)
    ratios = []
    for name in options.cases:
        found = effectivities(name, options)
        ratios += [ratio for of_pair in found.values() for ratio in of_pair]
        print(f"{name:24}" + "".join(f"{span(of_pair):^15}" for of_pair in found.values()), flush=True)
    if ratios:
        print(f"{'all':24}{len(ratios)} solutions: effectivity {span(ratios)}, median {np.median(ratios):.2f}", flush=True)
    for tolerance in options.tolerances if options.positions else []:
        true, said, energy, unknowns, levels = np.array([refined(seed, tolerance) for seed in range(options.positions)]).T
        columns = "  ".join(
            f"{what}: median {np.median(e):.2e}  worst {e.max():.2e}  worst/median {e.max() / np.median(e):.2f}"
            for what, e in (("λ", true), ("energy", energy))
        )
        print(f"(d) to {tolerance:.1%}, {options.positions} positions   {columns}")
        print(
            f"{'':24}effectivity {span(said / true)}, unknowns {np.median(unknowns):.0f} ({unknowns.max():.0f} at most), {np.median(levels):.0f} levels",
            flush=True,
        )


if __name__ == "__main__":
    recorded(main)
