"""Many processes: what each of them holds, computes and sends, beside a model that goes on to 10⁸ unknowns.

python benchmarks/processes.py --sizes 0.04 0.02 0.01 --numbers 1 2 3 4 5 8

Needs mpirun and mpi4py. An inclined crack in a unit square, P2, for meshes of some sizes and some numbers of processes, of which n - 1 hold elements. "own s" are
processor seconds of assembly and factorisation without what was spent waiting for others, of the process that has most. The model of seconds has three terms, for what is proportional to the unknowns that a process holds, for its own sparse factors (n^{3/2}), and for the dense matrix of the
interface (n³), fitted to "own s".
"""

import argparse
import json
import os
import pickle
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import scipy.optimize
from results import recorded

OPEN_MPI = {
    "OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
}  # fmt: skip
FIGURE = Path(__file__).resolve().parents[1] / "docs" / "images" / "processes.png"
DENSE = 20_000  # unknowns of an interface whose matrix, 3.2 GB, a process may hold


class Counted:
    """A communicator of mpi4py that counts calls and what this process sends, and keeps the processor time that waiting took."""

    def __init__(self, comm):
        self.comm, self.rank, self.size = comm, comm.rank, comm.size
        self.calls, self.sent, self.waited = 0, 0, 0.0

    def __getattr__(self, name):
        call = getattr(self.comm, name)

        def counted(value=None, *more):
            self.calls += 1
            self.sent += value.nbytes if isinstance(value, np.ndarray) else len(pickle.dumps(value))
            began = time.process_time()
            result = call(value, *more)
            self.waited += time.process_time() - began
            return result

        return counted


def measure(maxh):
    """Solves on the processes that mpirun has started; the first one prints a JSON line of what each found."""
    from mpi4py import MPI
    from netgen.geom2d import unit_square
    from ngsolve import CF

    from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
    from ngsxfem_contact.contact.solver import ReducedProblem
    from ngsxfem_contact.processes import DistributedMesh, Processes
    from ngsxfem_contact.spaces.exchange import exchange_of

    counted, several, of = Counted(MPI.COMM_WORLD), MPI.COMM_WORLD.size > 1, Processes.Of
    Processes.Of = staticmethod(lambda mesh, what: Processes(counted if of(mesh, what).several else None))
    body = CrackedMesh(DistributedMesh(lambda: unit_square.GenerateMesh(maxh=maxh)), Crack([(0.3, 0.45), (0.7, 0.55)]))
    V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(E=210e3, nu=0.3), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body))
    problem.f += CF((20, -100)) * V.TestFunction() * body.ds("top")
    before = counted.calls, counted.sent, counted.waited
    began, steps = time.process_time(), []
    solved = ReducedProblem(problem)
    seconds = time.process_time() - began - (counted.waited - before[2])
    for action in (lambda: solved.Solve(), lambda: solved.Solve()):
        start = counted.calls, counted.sent
        action()
        steps.append((counted.calls - start[0], counted.sent - start[1]))
    factors, exchange = solved.elimination.factors, exchange_of(V)
    here = {
        "unknowns": exchange.Count(V.ndof), "held": V.ndof, "own": int(exchange.owned.sum()) if several else V.ndof,
        "strip": int(body.share.everywhere.sum()) if several else 0, "interface": getattr(factors, "size", 0), "rows": factors.K.shape[0],
        "own_s": seconds, "made": before[:2], "solved": [steps[0][k] for k in range(2)], "factored": [counted.calls - before[0] - sum(s[0] for s in steps), counted.sent - before[1] - sum(s[1] for s in steps)],
        "MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }  # fmt: skip
    of_all = MPI.COMM_WORLD.gather(here)
    if of_all:
        sys.stdout.write(json.dumps(of_all) + "\n")


def measured(script, number, *arguments, seconds=900):
    """What a script prints, as JSON, with --measure and arguments on a number of processes: what each found, a dictionary for each."""
    start = ["mpirun", "-n", str(number)] if number > 1 else []
    command = ["timeout", str(seconds), *start, sys.executable, "-W", "ignore", script, "--measure", *map(str, arguments)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, env=os.environ | OPEN_MPI)
    if done.returncode:
        raise RuntimeError(done.stdout + done.stderr)
    return json.loads(done.stdout.strip().splitlines()[-1])


class Model:
    """What a process has with N unknowns on w processes that hold elements: coefficients fitted to counters, exponents from the geometry of the plane."""

    def __init__(self, runs):
        several = [(number - 1, rows) for number, rows in runs if number > 1]
        size = lambda rows: np.sqrt(rows[0]["unknowns"])
        worst = lambda rows, key: max(row[key] for row in rows)
        fit = lambda pairs: float(np.exp(np.mean([np.log(value / shape) for value, shape in pairs if value > 0 and shape > 0])))
        self.strip = fit([(rows[0]["strip"], size(rows)) for _, rows in several])
        self.edge = fit([(rows[0]["interface"], size(rows) * (np.sqrt(w) - 1)) for w, rows in several if w > 1])
        self.held = fit([(worst(rows, "held") - worst(rows, "own"), size(rows)) for w, rows in several if w > 1])
        self.rows = fit([(rows[0]["rows"], size(rows)) for _, rows in several])
        own_s = np.array([worst(rows, "own_s") for _, rows in runs])
        terms = np.array([self.Terms(rows[0]["unknowns"], max(number - 1, 1)) for number, rows in runs])
        self.costs = scipy.optimize.nnls(terms / own_s[:, None], np.ones(len(runs)))[0]  # relative errors count

    def Interface(self, N, w):
        """n_Γ, unknowns between processes."""
        return self.edge * np.sqrt(N) * (np.sqrt(w) - 1)

    def Rows(self, N):
        """Rows of tips and multipliers."""
        return self.rows * np.sqrt(N)

    def Held(self, N, w):
        """Unknowns that a process holds."""
        return N / w + self.held * np.sqrt(N) * (w > 1)

    def Bytes(self, N, w):
        """Of the largest sum: the dense matrix of the interface and the rows."""
        return 8 * (self.Interface(N, w) + self.Rows(N)) ** 2 * (w > 1)

    def Terms(self, N, w):
        """Unknowns that are held, n^{3/2} of own ones, and operations of the Cholesky factors of the interface with all rows; a constant for what does not grow."""
        n = self.Interface(N, w)
        return 1 + 0 * N, self.Held(N, w), (N / w) ** 1.5, n**3 / 3 + n**2 * self.Rows(N)

    def Seconds(self, N, w):
        """Of assembly and factorisation."""
        return sum(cost * term for cost, term in zip(self.costs, self.Terms(N, w)))


def draw(model, runs, path):
    """The model up to 10⁸ unknowns, and what was counted."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    N = np.logspace(3.5, 8, 100)
    for w, colour in zip((1, 2, 4, 7, 16, 64), ["black", *plt.rcParams["axes.prop_cycle"].by_key()["color"]]):
        for ax, values in zip(axes, (model.Interface(N, w), model.Bytes(N, w), model.Seconds(N, w))):
            ax.loglog(N, np.where(values > 0, values, np.nan), color=colour, label=f"{w} with elements")
        for rows in (rows for number, rows in runs if max(number - 1, 1) == w and number != 2):
            counted = rows[0]["interface"], max(row["factored"][1] for row in rows), max(row["own_s"] for row in rows)
            for ax, value in zip(axes, counted):
                ax.plot(rows[0]["unknowns"], value or np.nan, "o", color=colour, markersize=4)
    axes[0].axhline(DENSE, color="0.5", linestyle=":")
    axes[0].annotate("a matrix of 3.2 GB", (5e3, 1.15 * DENSE), fontsize=8)
    for ax, title in zip(axes, ("unknowns of the interface", "bytes that a process sends to factorise", "own seconds of assembly and factorisation")):
        ax.set(title=title, xlabel="unknowns")
    axes[2].legend(fontsize=8)
    figure.savefig(path, dpi=110)


def line(model, number, rows):
    """One run in the table: the largest values of its processes beside the model's."""
    w, N, interface = max(number - 1, 1), rows[0]["unknowns"], rows[0]["interface"]
    largest = lambda key, k=None: max(row[key] if k is None else row[key][k] for row in rows)
    calls = f"{largest('made', 0):12} {largest('factored', 0):7} {largest('solved', 0):6}"
    sent = f"{largest('made', 1):14.2e} {largest('factored', 1):9.2e} {model.Bytes(N, w):8.1e} {largest('solved', 1):7.1e}"
    memory = f"{rows[0]['MB']:12.0f} {max(row['MB'] for row in rows[-w:]):7.0f}"
    held = f"{number:9} {N:9} {largest('held'):12} {interface:7} {model.Interface(N, w):6.0f} {rows[0]['rows']:5}"
    return f"{held} {largest('own_s'):7.2f} {model.Seconds(N, w):6.2f} {calls} {sent} {memory}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=float, nargs="+", default=[0.04, 0.02, 0.01])
    parser.add_argument("--numbers", type=int, nargs="+", default=[1, 2, 3, 4, 5, 8])
    parser.add_argument("--measure", type=float)
    parser.add_argument("--figure", type=Path, default=FIGURE)
    chosen = parser.parse_args()
    if chosen.measure is not None:
        return measure(chosen.measure)
    runs = [(number, measured(__file__, number, maxh)) for maxh in chosen.sizes for number in chosen.numbers]
    model = Model(runs)
    print(
        "processes  unknowns  held by one     n_Γ  model  rows   own s  model  calls: made  factor  solve    bytes: made    factor    model   solve   MB: first  others"
    )
    for number, rows in runs:
        print(line(model, number, rows))
    print(
        f"\nmodel: n_Γ = {model.edge:.2f} √N (√w - 1), rows {model.rows:.2f} √N, held N/w + {model.held:.1f} √N, elements that all hold {model.strip:.1f} √N, w = n - 1"
    )
    for w in (4, 16, 64):
        largest = (DENSE / (model.edge * (np.sqrt(w) - 1))) ** 2
        print(
            f"w = {w:2}: n_Γ = {DENSE} at {largest:.1e} unknowns; at 1e8 n_Γ = {model.Interface(1e8, w):.1e}, {8e-9 * model.Interface(1e8, w) ** 2:.0f} GB on each"
        )
    constant, held, sparse, dense = model.costs
    print(f"own s = {constant:.2f} + {1e6 * held:.1f} (held / 1e6) + {1e9 * sparse:.2f} (own^1.5 / 1e9) + {1e9 * dense:.3f} (dense operations / 1e9)")
    draw(model, runs, chosen.figure)


if __name__ == "__main__":
    recorded(main)
