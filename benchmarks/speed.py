"""What set-up, assembly, factorisation and the contact solve cost, beside plain NGSolve on the same mesh.

    python benchmarks/speed.py [--sizes 2000 10000 50000] [--pairs P1/P1 P2/P1] [--bodies interior edge] [--threads 1 2] [--json FILE]

Sizes are numbers of triangles. "edge" is the paper's body (crack of length 0.5 from a mouth, r1 = 0.49), "interior" a crack
with two tips and disks of radius 0.1 in the unit square. Each time is a median over repeats; plain NGSolve's VectorH1 of
the same order, form and solver is timed in turn with it in the same process, and a ratio is a median of ratios of such
pairs. Peak memory is that of a process of its own for each case. With GetFEM (python3-getfem) its assembly of linear
elasticity of the same order on the same mesh is timed by the Python that has it, else the reason is stated.
"""

import argparse
import json
import os
import platform
import resource
import subprocess
import sys
from itertools import product
from statistics import median
from tempfile import NamedTemporaryFile
from time import perf_counter

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import BilinearForm, Grad, InnerProduct, LinearForm, Mesh, SetNumThreads, Sym, TaskManager, VectorH1, dx, ngsglobals  # fmt: skip
from results import recorded

from ngsxfem_contact import BarbosaHughes, ContactProblem, Crack, CrackedMesh, CrackFESpace, TipEnrichment, TraceSpace
from ngsxfem_contact._ngsxfem_contact import CrackBilinearForm
from ngsxfem_contact.loads.face_traction import ComparedTraction
from ngsxfem_contact.operators import NORMAL
from ngsxfem_contact.spaces.incompressible import add_stress_power
from study.paper import BODY_FORCE, MATERIAL, PAIRS, TRACTION

BODIES = {"interior": (Crack([(0.3, 0.01), (0.7, 0.03)]), 0.1), "edge": (Crack([(0, 0), (0.5, 0)]), 0.49)}
GETFEM = """
import json, sys, time
import numpy as np
import getfem as gf
points, triangles, order, repeats = np.load(sys.argv[1])["points"], np.load(sys.argv[1])["triangles"], int(sys.argv[2]), int(sys.argv[3])
mesh = gf.Mesh("empty", 2)
mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), points[triangles].transpose(2, 1, 0))
mf = gf.MeshFem(mesh, 2)
mf.set_fem(gf.Fem("FEM_PK(2,%d)" % order))
mim = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(%d)" % max(1, 2 * order - 2)))
md = gf.Model("real")
md.add_fem_variable("u", mf)
md.add_initialized_data("lambda", 1.0)
md.add_initialized_data("mu", 1.0)
md.add_isotropic_linearized_elasticity_brick(mim, "u", "lambda", "mu")
times = []
for i in range(repeats):
    start = time.perf_counter()
    gf.asm_generic(mim, 2, "(lambda*Trace(Grad_u)*Id(2)+mu*(Grad_u+Grad_u')):Grad_Test_u", -1, md)
    times.append(time.perf_counter() - start)
print(json.dumps({"seconds": sorted(times)[len(times) // 2], "unknowns": int(mf.nbdof()), "triangles": int(mesh.nbcvs())}))
"""


def unit_square(triangles):
    """A mesh of ]0,1[ × ]-½,½[ of about so many triangles."""
    geometry = SplineGeometry()
    corners = [geometry.AppendPoint(*p) for p in ((0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5))]
    for i, name in enumerate(("bottom", "right", "top", "left")):
        geometry.Append(["line", corners[i], corners[(i + 1) % 4]], bc=name)
    return Mesh(geometry.GenerateMesh(maxh=float(np.sqrt(2 / triangles))))


def seconds(action):
    """Time of one call."""
    start = perf_counter()
    action()
    return perf_counter() - start


class Comparison:
    """Medians of actions and of their ratios to plain NGSolve's, measured in turn."""

    def __init__(self, repeats):
        self.repeats, self.figures = repeats, {}

    def Time(self, name, ours, plain=None):
        """Adds {name}: seconds, and with a plain action its seconds and the ratio."""
        pairs = [(seconds(ours), seconds(plain) if plain else None) for _ in range(self.repeats)]
        figure = {"seconds": median(a for a, _ in pairs)}
        if plain:
            figure |= {"plain": median(b for _, b in pairs), "ratio": median(a / b for a, b in pairs)}
        self.figures[name] = figure


class Case:
    """One mesh, body and pair of spaces."""

    def __init__(self, mesh, body, pair):
        self.crack, self.r1 = BODIES[body]
        self.mesh, self.orders = mesh, PAIRS[pair]
        self.body = CrackedMesh(mesh, self.crack)
        self.gamma = None

    def Space(self):
        """A new V_h on a body of its own, on which no rules were made."""
        tip = TipEnrichment(r1=self.r1, material=MATERIAL)
        return CrackFESpace(CrackedMesh(self.mesh, self.crack), order=self.orders.order, bubble=self.orders.bubble, tip=tip)

    def PlainSpace(self):
        """The space of the uncracked body."""
        return VectorH1(self.mesh, order=self.orders.order, dirichlet="bottom")

    def Problem(self, V=None):
        """The contact problem under load B, held at the right side."""
        V = V or self.Space()
        W = TraceSpace(V.body, order=self.orders.multiplier_order)
        problem = ContactProblem(V, W, MATERIAL, stabilisation=BarbosaHughes(gamma0=0.01))
        v = V.TestFunction()
        problem.f += BODY_FORCE * v * V.body.dx(bonus_intorder=6) + TRACTION["B"] * v * V.body.ds("left|right", bonus_intorder=6)
        problem.Pin((1, -0.5), "xy")
        problem.Pin((1, 0.5), "x")
        return problem

    def Stiffness(self, V, W, gamma):
        """K - K_γ, as ContactProblem assembles it."""
        u, v = V.TnT()
        form = CrackBilinearForm(V, symmetric=True)
        add_stress_power(form, MATERIAL, V.body.dx)
        form += -gamma * ComparedTraction(V.body, MATERIAL, BarbosaHughes.sides).Squared(u, v, [NORMAL]) * W.dcrack
        return form.Assemble().mat

    def PlainStiffness(self, X):
        """K of the uncracked body."""
        u, v = X.TnT()
        form = BilinearForm(X, symmetric=True)
        form += InnerProduct(MATERIAL.Stress(Sym(Grad(u))), Sym(Grad(v))) * dx
        return form.Assemble().mat

    def PlainSolve(self, inverse):
        """Set-up, assembly, factorisation and solution of the uncracked body."""
        X = self.PlainSpace()
        v = X.TestFunction()
        load = LinearForm(BODY_FORCE * v * dx(bonus_intorder=6)).Assemble().vec
        matrix = self.PlainStiffness(X)
        return (matrix.Inverse(X.FreeDofs(), inverse=inverse) * load).Evaluate()


def measure_set_up(case, comparison):
    """Location of the cracks, spaces, rules; how many elements have which rules."""
    comparison.Time("crack location", lambda: CrackedMesh(case.mesh, case.crack))
    comparison.Time("space", case.Space, case.PlainSpace)
    order = 2 * case.orders.order - 2
    spaces = [case.Space() for _ in range(comparison.repeats)]
    comparison.Time("rules", lambda: (V := spaces.pop()).body.dx.PrepareRules(order, V))
    without = [CrackedMesh(case.mesh, case.crack) for _ in range(comparison.repeats)]
    comparison.Time("rules of cut elements", lambda: without.pop().dx.PrepareRules(order))
    return case.body.CrackElements(None).NumSet()


def measure_assembly(case, comparison):
    """K - K_γ; rules exist."""
    V, X = case.Space(), case.PlainSpace()
    W = TraceSpace(V.body, order=case.orders.multiplier_order)
    gamma = BarbosaHughes(gamma0=0.01).Gamma(V, MATERIAL)
    case.Stiffness(V, W, gamma)
    comparison.Time("assembly", lambda: case.Stiffness(V, W, gamma), lambda: case.PlainStiffness(X))
    return V, X


def measure_solve(case, comparison, inverse):
    """The whole solve beside one linear-elastic solve, and its parts as the report names them."""
    plain = case.PlainStiffness(X := case.PlainSpace())
    comparison.Time("plain factorisation", lambda: plain.Inverse(X.FreeDofs(), inverse=inverse))
    reports = []
    comparison.Time("whole solve", lambda: reports.append(case.Problem().Solve(inverse=inverse).report), lambda: case.PlainSolve(inverse))
    for name in reports[0].timings:
        comparison.figures[f"solve: {name}"] = {"seconds": median(report.timings[name] for report in reports)}
    steps = [sum(report.timings.get(name, 0) for name in ("active set", "recover")) for report in reports]
    comparison.figures["one load step"] = {"seconds": median(steps)}
    return {"iterations": int(reports[0].iterations), "multipliers": int(reports[0].unknowns[1])}


def measure(size, body, pair, threads, repeats, inverse):
    """One row of the results."""
    SetNumThreads(threads)
    with TaskManager():
        case, comparison = Case(unit_square(size), body, pair), Comparison(repeats)
        cut = measure_set_up(case, comparison)
        V, X = measure_assembly(case, comparison)
        solved = measure_solve(case, comparison, inverse)
    figures = comparison.figures
    figures["rules of cut elements"]["microseconds each"] = 1e6 * figures["rules of cut elements"]["seconds"] / cut
    share = (figures["space"]["seconds"] + figures["rules"]["seconds"]) / figures["assembly"]["seconds"]
    return {
        "triangles": case.mesh.ne, "cut elements": cut, "body": body, "pair": pair, "threads": threads, "inverse": inverse,
        "unknowns": V.ndof, "plain unknowns": X.ndof, "set-up / assembly": share, **solved, "times": figures,
    }  # fmt: skip


def peak_memory(size, body, pair, inverse):
    """Peak of a process that solves once, and by how much the solve raised it, in bytes; contact and plain."""
    memory = {}
    for which in ("contact", "plain"):
        command = [sys.executable, os.path.abspath(__file__), "--one-solve", which, "--sizes", str(size), "--bodies", body, "--pairs", pair]
        run = subprocess.run([*command, "--inverse", inverse], capture_output=True, text=True, check=True)
        memory[which] = dict(zip(("peak", "growth"), map(int, run.stdout.split()[-2:])))
    return memory


def one_solve(which, size, body, pair, inverse):
    """Prints the peak memory after a solve and its growth by the solve."""
    case = Case(unit_square(size), body, pair)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with TaskManager():
        case.Problem().Solve(inverse=inverse) if which == "contact" else case.PlainSolve(inverse)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(peak * 1024, (peak - before) * 1024)


def getfem(mesh, order, repeats, python="/usr/bin/python3"):
    """GetFEM's assembly of linear elasticity on the mesh, or why there is none."""
    if subprocess.run([python, "-c", "import getfem"], capture_output=True).returncode:
        return {"absent": f"{python} has no module getfem (Debian: apt-get install python3-getfem)"}
    with NamedTemporaryFile(suffix=".npz") as file:
        triangles = np.array([[v.nr for v in element.vertices] for element in mesh.Elements()])
        np.savez(file, points=np.array([v.point for v in mesh.vertices]), triangles=triangles)
        file.flush()
        run = subprocess.run([python, "-c", GETFEM, file.name, str(order), str(repeats)], capture_output=True, text=True)
    return json.loads(run.stdout.splitlines()[-1]) if run.returncode == 0 else {"failed": run.stderr[-500:]}


def machine():
    """What the figures belong to."""
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.processor())
    import ngsolve

    return {"processor": model, "cores": os.cpu_count(), "load": os.getloadavg()[0], "python": platform.python_version(), "ngsolve": ngsolve.__version__}


def show(row):
    """One line for each time of a row."""
    print(f"\n{row['body']} {row['pair']}: {row['triangles']} triangles, {row['unknowns']} unknowns, {row['threads']} thread(s)")
    for name, figure in row["times"].items():
        plain = f"   NGSolve {figure['plain'] * 1e3:9.1f} ms   ratio {figure['ratio']:6.2f}" if "ratio" in figure else ""
        print(f"    {name:22}{figure['seconds'] * 1e3:10.1f} ms{plain}")
    print(f"    space and rules / assembly {row['set-up / assembly']:.2f}   iterations {row['iterations']}", flush=True)


SUMMARY = f"{'body':9}{'pair':7}{'threads':>8}{'triangles':>11}{'assembly of K':>17}{'whole contact solve':>21}{'space + rules / assembly':>26}"


def summary(row):
    """One line for a row: milliseconds, and in brackets the ratio to plain NGSolve."""
    cells = [f"{1e3 * figure['seconds']:.0f} ({figure['ratio']:.2f})" for figure in (row["times"]["assembly"], row["times"]["whole solve"])]
    return f"{row['body']:9}{row['pair']:7}{row['threads']:8}{row['triangles']:11}{cells[0]:>17}{cells[1]:>21}{row['set-up / assembly']:26.2f}"


def arguments():
    """Of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[2000, 10000, 50000])
    parser.add_argument("--pairs", nargs="+", default=["P1/P1", "P2/P1"], choices=list(PAIRS))
    parser.add_argument("--bodies", nargs="+", default=list(BODIES), choices=list(BODIES))
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--inverse", default="sparsecholesky")
    parser.add_argument("--json")
    parser.add_argument("--summary", action="store_true", help="one line for each case, no memory, no GetFEM")
    parser.add_argument("--one-solve", choices=["contact", "plain"], help=argparse.SUPPRESS)
    return parser.parse_args()


def summaries(args):
    """A line for each case."""
    print(SUMMARY)
    for pair, body, threads in product(args.pairs, args.bodies, args.threads):
        for size in args.sizes:
            print(summary(measure(size, body, pair, threads, args.repeats, args.inverse)), flush=True)


def main():
    args = arguments()
    ngsglobals.msg_level = 0
    if args.one_solve:
        return one_solve(args.one_solve, args.sizes[0], args.bodies[0], args.pairs[0], args.inverse)
    if args.summary:
        return summaries(args)
    result = {"machine": machine(), "cases": [], "memory": [], "getfem": []}
    for size in args.sizes:
        for pair in args.pairs:
            for body in args.bodies:
                for threads in args.threads:
                    result["cases"].append(measure(size, body, pair, threads, args.repeats, args.inverse))
                    show(result["cases"][-1])
                result["memory"].append({"size": size, "body": body, "pair": pair, **peak_memory(size, body, pair, args.inverse)})
                print("    memory", result["memory"][-1], flush=True)
            mesh = unit_square(size)
            result["getfem"].append({"size": size, "pair": pair, **getfem(mesh, PAIRS[pair].order, args.repeats)})
            print("    GetFEM", result["getfem"][-1], flush=True)
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(result, file, indent=1)
    return None


if __name__ == "__main__":
    recorded(main)
