"""How far quantities are off, as ErrorEstimate().Goal says, beside the truth: the signed error, and how often the bar covers it.

    python benchmarks/goal_errors.py [--maxh 0.085 0.055] [--pairs P2/P1 P1/P1 P2/P0] [--random 100] [--verbose]

Closed forms and fitted solutions are those of `k_errors`, with K_I and K_II at each tip, and the contact forces of `shapes`. Random problems: a straight or kinked edge crack in a
square under random tractions, closed or open, with and without friction, on meshes of maxh = 0.085; their truth is P2/P1 on a mesh of maxh = 0.045 with elements of 0.006 at the tip and the kink.
"ratio" is estimated over true error of those that are above 1e-4 of the largest K, medians; "covered" counts bars that hold the truth, "said/true" is the bar over the true error.
"""

import argparse
import sys

import numpy as np
from error_estimate import graded
from k_errors import TIPS, closed, fitted
from ngsolve import CF, ngsglobals, x, y
from results import recorded

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, TraceSpace
from ngsxfem_contact.estimate import ContactForce, StressIntensityFactor
from study.paper import MATERIAL, PAIRS
from study.shapes import SHAPES, body_mesh, shape_problem

FACTORS = ("K_I", "K_II")


def random_problem(seed, mesh_of, pair):
    """(solution, of a problem that depends on the seed)."""
    draw = np.random.default_rng(seed)
    mouth, length, angle = draw.uniform(-0.2, 0.2), draw.uniform(0.35, 0.6), draw.uniform(-0.5, 0.5)
    kink = None if draw.random() < 0.5 else (draw.uniform(0.4, 0.6), draw.uniform(-0.7, 0.7))
    points = [(0.0, mouth)]
    for share, turn in [(1, 0)] if kink is None else [(kink[0], 0), (1 - kink[0], kink[1])]:
        points.append(tuple(np.add(points[-1], share * length * np.array([np.cos(angle + turn), np.sin(angle + turn)]))))
    tractions = draw.normal(size=(2, 3))
    law = Coulomb(draw.uniform(0.1, 0.5)) if draw.random() < 0.3 else None
    body, orders = CrackedMesh(mesh_of(points[1:]), Crack(points)), PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, material=MATERIAL, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), law=law)
    v = V.TestFunction()
    for side, parts in (("top", tractions[:, 0] + (0, draw.uniform(-2, 1))), ("right", tractions[:, 1])):
        problem.f += CF((float(parts[0]), float(parts[1]))) * v * body.ds(side)
    problem.f += CF((float(tractions[0, 2]) * y, float(tractions[1, 2]) * (x - 0.5))) * v * body.ds("top|right")
    return problem.Solve()


def square(maxh, size=None):
    corners = [(0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5)]
    return lambda points: body_mesh(maxh) if size is None else graded(corners, maxh, points, size)


class Found:
    """What was said and what is true, by kinds of problems."""

    def __init__(self, verbose):
        self.rows, self.verbose = {}, verbose

    def Add(self, kinds, name, estimate, goal, true, scale):
        found = estimate.Goal(goal)
        error = true - found.value
        for kind in kinds:
            self.rows.setdefault(kind, []).append((error, found.error, found.bar, scale))
        if self.verbose:
            print(f"{name:26}{goal!s:28} true {error:+.1e}  said {found.error:+.1e}  bar {found.bar:.1e}", file=sys.stderr, flush=True)

    def Print(self):
        for kind, rows in self.rows.items():
            error, said, bar, scale = np.abs(np.array(rows)).T
            counts = error > 1e-4 * scale
            signed = np.array([row[1] / row[0] for row, count in zip(rows, counts) if count])
            ratios = np.maximum(bar, 1e-300) / np.maximum(error, 1e-12 * scale)
            print(
                f"{kind:16}{len(rows):5}   ratio {np.median(signed):5.2f}, quartiles {np.quantile(signed, 0.25):5.2f} {np.quantile(signed, 0.75):5.2f}"
                f"   covered {np.mean(ratios >= 1):6.1%}   median of said/true {np.median(ratios):5.2f}   worst true/said {1 / ratios.min():5.2f}",
                flush=True,
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maxh", type=float, nargs="+", default=[0.085, 0.055])
    parser.add_argument("--pairs", nargs="+", default=["P2/P1", "P1/P1", "P2/P0"])
    parser.add_argument("--random", type=int, default=100)
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    found = Found(options.verbose)
    for pair in options.pairs:
        for maxh in options.maxh:
            for kind, cases in (("closed forms", closed), ("fitted", fitted)):
                for name, solution, tip, K in cases(maxh, pair, TIPS["modes"]):
                    estimate = solution.ErrorEstimate()
                    for factor, true in zip(FACTORS, K):
                        if solution.StressIntensity(tip).K_I or factor == "K_II":
                            found.Add((kind, pair, "all"), f"{name} {pair} {maxh}", estimate, StressIntensityFactor(factor, tip), true, np.abs(K).max())
            for name, shape in SHAPES.items():
                estimate = shape_problem(name, body_mesh(maxh), pair).Solve().ErrorEstimate()
                for crack, force in enumerate(shape.contact_force):
                    found.Add(("contact forces",), f"{name} {pair} {maxh}", estimate, ContactForce(crack), force, abs(force))
    for seed in range(options.random):
        pair = options.pairs[seed % len(options.pairs)]
        try:
            reference, solution = random_problem(seed, square(0.045, 0.006), "P2/P1"), random_problem(seed, square(0.085), pair)
            truth, estimate = reference.StressIntensity(0), solution.ErrorEstimate()
            scale = max(abs(truth.K_I), abs(truth.K_II))
            for factor in FACTORS:
                if solution.StressIntensity(0).K_I or factor == "K_II":
                    found.Add(("random",), f"random {seed} {pair}", estimate, StressIntensityFactor(factor), getattr(truth, factor), scale)
            if reference.ContactForce():
                found.Add(("random, forces",), f"random {seed} {pair}", estimate, ContactForce(), reference.ContactForce(), abs(reference.ContactForce()))
        except Exception as error:
            print(f"random {seed}: {type(error).__name__}: {str(error).splitlines()[0][:150]}", flush=True)
    found.Print()


if __name__ == "__main__":
    recorded(main)
