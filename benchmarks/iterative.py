"""Conjugate gradients in the plane: iterations, processor seconds, memory and what processes send, beside a model that goes on to 10⁸ unknowns.

python benchmarks/iterative.py --sizes 0.04 0.02 0.01 0.006 --numbers 1 3 4 --orders 1 2 3

Needs pyamg, and for several processes mpirun and mpi4py. The problem of processes.py. "tips" are iterations for the tips' functions, on the average, "load" for the load, "rounds" those of each round with other pressures, together. "own s"
are processor seconds, from the checks to the preconditioner and for the solve, without what was spent waiting for others, of the process with elements that has most; "first" those of the first one, which has the subspace X of n_X functions. "bytes" are those that a
process sends in a solve beside those of the model: 8 (k n_s + n_X) for each iteration and to begin each round, and 8 (n_s + n_X) for each round, n_s unknowns that several processes hold, k the degree of the polynomial.
"""

import argparse
import json
import resource
import sys
import time

import numpy as np
from processes import Counted, measured
from results import recorded


def measure(maxh, order):
    """Solves on the processes that mpirun has started, or one; the first one prints a JSON line of what each found."""
    from netgen.geom2d import unit_square
    from ngsolve import CF

    from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
    from ngsxfem_contact.contact.options import StepOptions
    from ngsxfem_contact.processes import DistributedMesh, Processes, world
    from ngsxfem_contact.spaces.exchange import exchange_of

    comm, of = world(), Processes.Of
    counted = None if comm is None else Counted(comm)
    if counted:
        Processes.Of = staticmethod(lambda mesh, what: Processes(counted if of(mesh, what).several else None))
    body = CrackedMesh(DistributedMesh(lambda: unit_square.GenerateMesh(maxh=maxh)), Crack([(0.3, 0.45), (0.7, 0.55)]))
    V = CrackFESpace(body, order=order, material=Elasticity.PlaneStrain(E=210e3, nu=0.3), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body))
    problem.f += CF((20, -100)) * V.TestFunction() * body.ds("top")
    now = lambda: (time.process_time() - (counted.waited if counted else 0), counted.sent if counted else 0, counted.calls if counted else 0)
    began = now()
    solved = problem.Reduced("cg")
    prepared = now()
    report = solved.Solve(StepOptions()).report
    done, preconditioner, exchange = now(), solved.elimination.preconditioner, exchange_of(V)
    load, *rounds = report.linear_iterations
    here = {
        "unknowns": exchange.Count(V.ndof), "held": V.ndof, "shared": exchange.total, "X": preconditioner.size, "tips": float(np.mean(preconditioner.tip_iterations)), "load": load,
        "rounds": rounds, "prepare": prepared[0] - began[0], "solve": done[0] - prepared[0], "sent": done[1] - prepared[1],
        "calls": (done[2] - prepared[2]) / max(sum(rounds), 1), "MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, "iterations": sum(preconditioner.tip_iterations) + load + sum(rounds),
    }  # fmt: skip
    of_all = exchange.AtFirst(here)
    if of_all:
        sys.stdout.write(json.dumps(of_all) + "\n")


def line(number, order, rows, degree):
    """One run in the table."""
    workers = rows[1:] or rows
    largest = lambda key: max(row[key] for row in workers)
    first = rows[0]
    n_s, n_X, rounds = first["shared"], first["X"], len(first["rounds"])
    model = 8 * ((sum(first["rounds"]) + rounds) * (degree * n_s + n_X) + rounds * (n_s + n_X)) if number > 1 else 0
    return (
        f"{number:9} P{order} {first['unknowns']:9} {largest('held'):9} {first['X']:7} {first['tips']:6.1f} {first['load']:6} {sum(first['rounds']):7} in {len(first['rounds']):2}"
        f" {largest('prepare'):10.2f} {largest('solve'):7.2f} {first['prepare'] + first['solve']:7.2f} {largest('sent'):11.2e} {model:9.2e} {largest('calls'):6.0f} {first['MB']:9.0f} {largest('MB'):7.0f}"
    )


def print_model(runs, degree):
    """What grows with the number of unknowns N, with coefficients of the runs of order 2, and what that means for 10⁸."""
    runs = [(number, rows) for number, order, rows in runs if order == 2]
    if not any(number > 2 for number, _ in runs):
        return
    fit = lambda pairs: float(np.exp(np.mean([np.log(value / shape) for value, shape in pairs])))
    X = fit([(rows[0]["X"], rows[0]["unknowns"]) for _, rows in runs if rows[0]["unknowns"] > 5e4])
    several = [(number - 1, rows) for number, rows in runs if number > 2]
    shared = fit([(rows[0]["shared"], np.sqrt(rows[0]["unknowns"])) for _, rows in several])
    seconds = fit([(row["prepare"] + row["solve"], row["held"] * row["iterations"]) for _, rows in runs for row in (rows[1:] or rows) if row["unknowns"] > 5e4])
    print(
        f"\nmodel, P2: n_X = {X:.3f} N, n_s = {shared:.1f} √N, own s = {1e6 * seconds:.2f} per million unknowns held and iteration; held N/w + n_s, w = n - 1"
    )
    for w in (4, 16, 64):
        for N in (1e6, 1e7, 1e8):
            n_s, n_X = shared * np.sqrt(N), X * N
            print(
                f"w = {w:2}, N = {N:.0e}: {seconds * (N / w + n_s):7.2f} own s and {8 * (degree * n_s + n_X):.1e} bytes for each iteration, {n_X:.1e} unknowns of X on the first process"
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=float, nargs="+", default=[0.04, 0.02, 0.01])
    parser.add_argument("--numbers", type=int, nargs="+", default=[1, 3, 4])
    parser.add_argument("--orders", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--largest", type=float, help="one more size, for order 2 on one and on three processes")
    parser.add_argument("--measure", nargs=2)
    chosen = parser.parse_args()
    if chosen.measure is not None:
        return measure(float(chosen.measure[0]), int(chosen.measure[1]))
    from ngsxfem_contact.algebra.two_level import DEGREE

    print(
        "processes      unknowns  held by one    n_X   tips   load     rounds  own s: prepare   solve   first   bytes: sent     model  calls   MB: first  others"
    )
    runs, cases = [], [(number, maxh, order) for order in chosen.orders for maxh in chosen.sizes for number in chosen.numbers]
    for number, maxh, order in cases + [(number, chosen.largest, 2) for number in (1, 3) if chosen.largest]:
        runs.append((number, order, measured(__file__, number, maxh, order, seconds=2400)))
        print(line(*runs[-1], DEGREE), flush=True)
    print_model(runs, DEGREE)


if __name__ == "__main__":
    recorded(main)
