"""The contact solve beside one linear-elastic solve of the uncracked body: same mesh, order, direct solver and threads.

    python benchmarks/solve.py --h 0.03 0.016 0.008 0.0052 --inverse sparsecholesky pardiso

Each (h, inverse) runs in a process of its own, so that the peak of memory is that of one solve; medians over repeats.
One line of a table for each; --json keeps all figures. maxh = 2h; load B of the paper. --clock cpu --threads 1 measures linear,
contact, step in processor seconds, for a machine that has other work; the phases (assemble, factor, other) are wall-clock seconds.
"""

import argparse
import json
import resource
import subprocess
import sys
from statistics import median
from time import perf_counter, process_time

from ngsolve import BilinearForm, Grad, InnerProduct, LinearForm, SetNumThreads, Sym, TaskManager, VectorH1, dx, ngsglobals
from results import recorded

from ngsxfem_contact import LoadSteps, TipEnrichment
from study.paper import BODY_FORCE, MATERIAL, PAIRS, paper_problem, unstructured_mesh

COLUMNS = "h inverse unknowns multipliers linear contact ratio set-up assemble factor other step step_ratio iterations memory_GB linear_GB".split()

CLOCKS = {"wall": perf_counter, "cpu": process_time}


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def linear(mesh, order, inverse, clock):
    """Seconds of one solve of the uncracked body: space, assembly, factorisation, solution."""
    start = clock()
    V = VectorH1(mesh, order=order, dirichlet="right")
    u, v = V.TnT()
    a = BilinearForm(V, symmetric=True)
    a += InnerProduct(MATERIAL.Stress(Sym(Grad(u))), Sym(Grad(v))) * dx
    f = LinearForm(BODY_FORCE * v * dx).Assemble()
    factors = a.Assemble().mat.Inverse(V.FreeDofs(), inverse=inverse)
    (factors * f.vec).Evaluate()
    return clock() - start


def contact(mesh, pair, inverse, r1, clock):
    """The record of one contact solve, from the mesh on."""
    start = clock()
    problem = paper_problem(mesh, pair=pair, tip=TipEnrichment(material=MATERIAL, r1=r1))
    setup = clock() - start
    report = problem.Solve(inverse=inverse).report
    seconds = clock() - start
    phases = {name: report.timings[name] for name in ("assemble", "factor")}
    phases["other"] = sum(report.timings.values()) - sum(phases.values())
    return problem, {"contact": seconds, "set-up": setup} | phases, report


def step_seconds(problem, inverse, clock, count=20):
    """Of one further load step, the load growing from 0.8 to 1.2 times itself."""
    steps = LoadSteps(problem, inverse=inverse)
    steps.Solve(0.8)
    start = clock()
    for i in range(count):
        steps.Solve(0.8 + 0.4 * (i + 1) / count)
    return (clock() - start) / count


def record(h, inverse, pair, r1, repeats, threads, clock):
    """Medians for one mesh and one direct solver."""
    ngsglobals.msg_level = 0
    SetNumThreads(threads)
    with TaskManager():
        mesh = unstructured_mesh(h)
        uncracked = median(linear(mesh, PAIRS[pair].order, inverse, CLOCKS[clock]) for _ in range(repeats))
        memory = peak()
        runs = [contact(mesh, pair, inverse, r1, CLOCKS[clock]) for _ in range(repeats)]
        problem, _, report = runs[-1]
        times = {name: median(run[1][name] for run in runs) for name in runs[0][1]}
        del runs
        contact_memory = peak()
        step = step_seconds(problem, inverse, CLOCKS[clock])
    sizes = {"unknowns": report.unknowns[0], "multipliers": report.unknowns[1], "iterations": report.iterations, "coarse": report.coarse_iterations}
    ratios = {"ratio": times["contact"] / uncracked, "step": step, "step_ratio": step / uncracked}
    return {"h": h, "inverse": inverse, "pair": pair, "linear": uncracked, "memory_GB": contact_memory, "linear_GB": memory} | sizes | times | ratios


def main():
    """Starts one process for each line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--h", type=float, nargs="+", default=[0.03, 0.016, 0.008])
    parser.add_argument("--inverse", nargs="+", default=["sparsecholesky"])
    parser.add_argument("--pair", default="P2/P1", choices=PAIRS)
    parser.add_argument("--r1", type=float, default=0.1, help="radius of the tip functions; the paper's is 0.49")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--clock", default="wall", choices=CLOCKS)
    parser.add_argument("--json", help="file that each record is added to, one line each")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(record(options.h[0], options.inverse[0], options.pair, options.r1, options.repeats, options.threads, options.clock)))
        return
    print(" ".join(f"{name:>11}" for name in COLUMNS))
    for h in options.h:
        for inverse in options.inverse:
            names = ("pair", "r1", "repeats", "threads", "clock")
            shared = [word for name in names for word in (f"--{name}", str(getattr(options, name)))]
            command = [sys.executable, __file__, "--one", "--h", str(h), "--inverse", inverse, *shared]
            line = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()[-1])
            if options.json:
                with open(options.json, "a", encoding="utf-8") as file:
                    file.write(json.dumps(line) + "\n")
            cells = (line[name] for name in COLUMNS)
            print(" ".join(f"{cell:11.3g}" if isinstance(cell, float) else f"{cell!s:>11}" for cell in cells), flush=True)


if __name__ == "__main__":
    recorded(main)
