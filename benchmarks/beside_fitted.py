"""K to 0.1 %: refinement from a coarse mesh, beside what one would write in plain NGSolve: a mesh along the crack with doubled edges, P2, graded to the tips.

    python benchmarks/beside_fitted.py [slanted-open slanted-closed kinked-open kinked-closed] [--tolerance 1e-3]

The square [-1,1]², E = 1, ν = 0.3, tractions of a uniform stress on its sides; the crack is straight or kinked, in tension or under pressure and shear. The fitted program is that of
tests/networks/fitted.py, with contact by pairs of unknowns. Its meshes are h at the crack, 2.5 h far away, h·g at the tips, for h = 0.1/√2ⁿ and g = 1, 1/10, 1/100, 1/1000; for each g the first h
counts from which on the true errors of K_I and K_II at the first tip stay below the tolerance times the larger of both, and of these the one with the fewest unknowns and the one that is fastest. A user who does not
know the truth has to solve on several. `SolveAdaptive` begins with elements of 0.5, and ends where its own bar of both says so; seconds are of the whole run, and of the last mesh.
Truth: the fitted program with elements of order 6.
"""

import argparse
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh, SetNumThreads, ngsglobals
from results import recorded

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
from networks.fitted import NU, E, FittedBody

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.estimate import SolveAdaptive, StressIntensityFactor

MATERIAL = Elasticity.PlaneStrain(E, NU)
TENSION, COMPRESSION = ((0.2, 0.1), (0.1, 1.0)), ((-0.2, 0.6), (0.6, -1.0))
STRAIGHT, KINKED = [(-0.26, -0.13), (0.28, 0.17)], [(-0.31, -0.07), (0.02, 0.0), (0.26, 0.17)]
CASES = {
    "slanted-open": (STRAIGHT, TENSION),
    "slanted-closed": (STRAIGHT, COMPRESSION),
    "kinked-open": (KINKED, TENSION),
    "kinked-closed": (KINKED, COMPRESSION),
}
RADIUS = 0.2
FACTORS = ("K_I", "K_II")


@dataclass
class Run:
    """Unknowns, seconds and the factors of one mesh."""

    unknowns: int
    seconds: float
    K: tuple[float, float]


def fitted(points, sigma, **level):
    """The program of doubled edges on a mesh; K_I is 0 where faces touch."""
    start = perf_counter()
    body = FittedBody(list(zip(points, points[1:])), 1.0, **level)
    solution = body.Solve(sigma=sigma, contact=True)
    K = np.nan_to_num(solution.StressIntensity(body.tips[0], RADIUS))
    return Run(body.space.ndof, perf_counter() - start, tuple(K))


def square(maxh):
    """[-1,1]²."""
    geometry = SplineGeometry()
    geometry.AddRectangle((-1, -1), (1, 1), bcs=("bottom", "right", "top", "left"))
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def problem_on(mesh, points, sigma):
    """The same problem for the package."""
    body = CrackedMesh(mesh, Crack(points))
    V = CrackFESpace(body, order=2, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, order=1))
    v = V.TestFunction()
    for side, normal in (("bottom", (0, -1)), ("right", (1, 0)), ("top", (0, 1)), ("left", (-1, 0))):
        problem.f += CF(tuple(np.array(sigma) @ normal)) * v * body.ds(side)
    problem.Pin((-1, -1), "xy")
    problem.Pin((1, -1), "y")
    return problem


def error(K, truth):
    """Of the size of the worse factor, relative to the larger one."""
    return max(abs(np.abs(K) - np.abs(truth.K))) / max(np.abs(truth.K))


def best_fitted(points, sigma, truth, tolerance):
    """The Runs of the first mesh below the tolerance, for each grading that gets there."""
    found = {}
    for grading in (1, 0.1, 0.01, 0.001):
        runs = [fitted(points, sigma, order=2, maxh=h, tip_h=grading * h, far=2.5 * h) for h in 0.1 / np.sqrt(2) ** np.arange(9)]
        above = [k for k, run in enumerate(runs) if not error(run.K, truth) < tolerance]
        first = above[-1] + 1 if above else 0
        if first < len(runs):
            found[grading] = runs[first]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=list(CASES))
    parser.add_argument("--tolerance", type=float, default=1e-3)
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    SetNumThreads(1)
    warnings.simplefilter("ignore")
    for name in options.cases:
        points, sigma = CASES[name]
        truth, check = (fitted(points, sigma, order=order, maxh=0.04, tip_h=1e-6) for order in (6, 5))
        larger = int(np.argmax(np.abs(truth.K)))
        print(f"{name}: K = {truth.K[0]:.6f}, {truth.K[1]:.6f} (order 5 differs by {error(check.K, truth):.0e})", flush=True)
        for grading, run in best_fitted(points, sigma, truth, options.tolerance).items():
            print(f"   fitted, tips {grading:5} h   {run.unknowns:6} unknowns {run.seconds:6.2f} s   true error {error(run.K, truth):.1e}", flush=True)
        problem_on(square(0.1), points, sigma).Solve()  # what is loaded or compiled once
        tip = int(np.argmin([np.hypot(*np.subtract(tip.point, points[0])) for tip in CrackedMesh(square(0.1), Crack(points)).tips]))
        goal, size, start = StressIntensityFactor(FACTORS[larger], tip), abs(truth.K[larger]), perf_counter()
        found = SolveAdaptive(lambda mesh: problem_on(mesh, points, sigma), square(0.5), goal, options.tolerance, scale=size)  # noqa: B023
        seconds, last = perf_counter() - start, found.levels[-1]
        print(
            f"   adaptive, {FACTORS[larger]}        {last.unknowns:6} unknowns {seconds:6.2f} s   true error of it {abs(abs(found.quantity.value) - size) / size:.1e}, "
            f"of both {error(tuple(found.solution.StressIntensity(tip)), truth):.1e}; {len(found.levels)} meshes, the last {last.seconds:.2f} s",
            flush=True,
        )


if __name__ == "__main__":
    recorded(main)
