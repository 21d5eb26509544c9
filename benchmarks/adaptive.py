"""Refinement where the estimate says, beside uniform meshes: rates in the energy norm, and the unknowns that K needs to be right to 0.1 %.

    python benchmarks/adaptive.py [load-B kinked two-cracks slanted] [--unknowns 20000] [--fractions 0.5 0.65 0.8]

load B of the paper, the kinked and the two cracks of `shapes`, whose K are known; and a slanted crack in the infinite plate whose length is a tenth of the first elements. "energy" is the slope of the
error in the energy norm over the unknowns, of the last five levels, estimated. "K" counts the unknowns of the first level (or uniform mesh) from which on the true error of K stays below 0.1 %,
and what the bar said there, relative; "tolerance" is a run that ends at a bar of 0.1 %: its unknowns, its true error, and its seconds over those of its last solve.
--fractions: such runs alone, by how much of the indicators is marked; processor seconds, those of the last solve with its problem.
"""

import argparse
import warnings
from time import process_time

import numpy as np
from ngsolve import ngsglobals
from results import recorded

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, TraceSpace
from ngsxfem_contact.estimate import SolveAdaptive, StressIntensityFactor
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.exact import fracture_solutions as fs
from study.paper import MATERIAL, PAIRS, REFERENCE, paper_problem
from study.shapes import SHAPES, body_mesh, shape_problem

HALF, SLANT = 0.0125, 0.6  # of the short crack: a tenth of an element of maxh = 0.25, and its angle


def slanted(mesh, pair):
    """A short crack in the infinite plate, in its own coordinates; the square is turned."""
    body, orders = CrackedMesh(mesh, cf.crack_on_axis(-HALF, HALF)), PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, material=MATERIAL, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order))
    problem.SetDirichlet(PLATE.u, "outer")
    return problem


PLATE = fs.infinite_plate(MATERIAL, HALF, *fs.inclined(1, np.pi / 2 - SLANT))
CASES = {
    "load-B": (lambda mesh, pair: paper_problem(mesh, "B", pair), body_mesh, "K_II", REFERENCE["B"]["K_II"]),
    "kinked": (lambda mesh, pair: shape_problem("kinked", mesh, pair), body_mesh, "K_II", SHAPES["kinked"].K[0][1]),
    "two-cracks": (lambda mesh, pair: shape_problem("two-cracks", mesh, pair), body_mesh, "K_II", SHAPES["two-cracks"].K[0][1]),
    "slanted": (slanted, lambda maxh: cf.rotated_square(SLANT, (0.02, 0.01), maxh), "K_I", PLATE.K_I),
}


def first_below(unknowns, errors, tolerance=1e-3):
    """The unknowns from which on the errors stay below the tolerance."""
    above = np.flatnonzero(~(np.array(errors) < tolerance))
    after = above[-1] + 1 if len(above) else 0
    return unknowns[after] if after < len(unknowns) else float("nan")


def uniform(make_problem, mesh_of, name, true, pair, most):
    """(unknowns, errors of K) on uniform meshes."""
    unknowns, errors = [], []
    for maxh in 0.1 / np.sqrt(2) ** np.arange(12):
        problem = make_problem(mesh_of(maxh), pair)
        if problem.V.ndof > most:
            break
        goal = StressIntensityFactor(name)
        try:
            errors.append(abs(goal.Value(problem.Solve()) / true - 1))
        except ValueError:  # too coarse
            continue
        unknowns.append(problem.V.ndof)
    return unknowns, errors


def fractions(names, some, most):
    """Runs to a bar of 0.1 % of K, by the fraction that is marked."""
    for name in names:
        make_problem, mesh_of, factor, true = CASES[name]
        on_mesh = lambda mesh: make_problem(mesh, "P2/P1")  # noqa: B023
        for fraction in some:
            start = process_time()
            found = SolveAdaptive(on_mesh, mesh_of(0.25), StressIntensityFactor(factor), 1e-3, most, fraction=fraction)
            end = process_time()
            on_mesh(found.solution.body.mesh).Solve().u  # noqa: B018
            last, unknowns = process_time() - end, found.table["unknowns"]
            print(
                f"{name:11}fraction {fraction:4}  {len(unknowns):2} levels  {unknowns[-1]:6} unknowns, sum over levels {unknowns.sum() / unknowns[-1]:.1f} ×"
                f"  true {abs(found.quantity.value / true - 1):.1e}  {end - start:.2f} s, {(end - start) / last:4.1f} × the last solve",
                flush=True,
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=list(CASES))
    parser.add_argument("--unknowns", type=int, default=20_000)
    parser.add_argument("--fractions", type=float, nargs="+")
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    warnings.simplefilter("ignore")  # of budgets that end a run
    if options.fractions:
        fractions(options.cases, options.fractions, options.unknowns)
        return
    for name in options.cases:
        make_problem, mesh_of, factor, true = CASES[name]
        for pair in ("P2/P1", "P1/P1"):
            on_mesh = lambda mesh: make_problem(mesh, pair)  # noqa: B023
            energy = SolveAdaptive(on_mesh, mesh_of(0.25), tolerance=1e-9, max_unknowns=options.unknowns).table[-5:]
            rate = np.polyfit(np.log(energy["unknowns"]), np.log(energy["energy"]), 1)[0]
            print(f"{name:11}{pair:6} energy N^{rate:5.2f}", end="", flush=True)
            if pair == "P2/P1":
                found = SolveAdaptive(on_mesh, mesh_of(0.25), StressIntensityFactor(factor), 1e-4, options.unknowns)
                table = found.table[np.isfinite(found.table["value"])]
                needed = first_below(table["unknowns"], np.abs(table["value"] / true - 1))
                said = (table["bar"] / np.abs(table["value"]))[table["unknowns"] == needed]
                plain = first_below(*uniform(make_problem, mesh_of, factor, true, pair, 8 * options.unknowns))
                found = SolveAdaptive(on_mesh, mesh_of(0.25), StressIntensityFactor(factor), 1e-3, options.unknowns)
                seconds = found.table["seconds"].sum() / sum(found.solution.report.timings.values())
                error = abs(found.quantity.value / true - 1)
                print(f"   K to 0.1 %: {needed:6.0f} unknowns (the bar says {said[0] if len(said) else np.nan:.1e}), uniform {plain:6.0f}", end="")
                print(f"   tolerance: {found.table['unknowns'][-1]:6} unknowns, true {error:.1e}, {seconds:.1f} × the last solve", end="")
            print(flush=True)


if __name__ == "__main__":
    recorded(main)
