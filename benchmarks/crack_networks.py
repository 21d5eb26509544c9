"""Cracks that cross, end on each other, kink and close: how many of many random ones are solved, and stress intensity factors of stars.

    python benchmarks/crack_networks.py [kinks] [networks] [stars] [N]
    python benchmarks/crack_networks.py faults

`kinks`: N (default 200) two-segment cracks with kinks of 20 to 150 degrees anywhere; `networks`: N random networks of 2 to 12 cracks, closest distance
0.01 and sharpest angle 5 degrees, five pairs and three meshes; both under a uniform pressure, which λ has to be, with the coercivity of K - K_γ. `stars`: the cases of
`tests/networks/cases.py` against boundary-fitted meshes. `faults`: 50 faults with Coulomb's law and 200,000 unknowns, beside one solve of the body without cracks.
"""

import sys
import warnings
from collections import Counter
from pathlib import Path
from time import perf_counter

import numpy as np
from netgen.geom2d import unit_square
from ngsolve import CF, BilinearForm, Grad, GridFunction, InnerProduct, Integrate, Mesh, SetNumThreads, Sym, TaskManager, VectorH1, dx, x, y
from results import recorded

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests")]

from networks import cases  # noqa: E402
from networks.random_networks import kink_placements, random_network  # noqa: E402
from networks.stars import star_problem  # noqa: E402

from ngsxfem_contact import AccuracyWarning, ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace  # noqa: E402
from ngsxfem_contact.contact import Coercivity  # noqa: E402

PAIRS = [(1, 0), (1, 1), (2, 1), (2, 0), (3, 2)]
MATERIAL = Elasticity.PlaneStrain(E=1, nu=0.3)
P = 0.7


def under_pressure(mesh, cracks, pair):
    """(largest deviation of λ from -P at the nodes, coercivity, loss of length and area)."""
    body = CrackedMesh(mesh, *map(Crack, cracks))
    V = CrackFESpace(body, order=pair[0], dirichlet=".*", tip=None)
    problem = ContactProblem(V, TraceSpace(body, order=pair[1]), MATERIAL)
    problem.SetDirichlet(-P / (2 * (MATERIAL.lam + MATERIAL.mu)) * CF((x, y)), ".*")
    solution = problem.Solve()
    length = sum(crack.length for crack in body.cracks)
    loss = max(abs(Integrate(CF(1) * body.dcrack, mesh) / length - 1), abs(Integrate(CF(1) * body.dx, mesh) - 1))
    return np.abs(solution.multiplier(solution.state.nodes.points) + P).max() / P, Coercivity(problem), loss


def summary(name, tasks):
    """Solves (mesh, cracks, pair) one after the other and prints what came out."""
    rows, failures = [], Counter()
    for mesh, cracks, pair in tasks:
        try:
            rows.append(under_pressure(mesh, cracks, pair))
        except Exception as failure:
            failures[f"{type(failure).__name__}: {str(failure)[:70]}"] += 1
    errors, coercivities, losses = np.array(rows).T
    quantiles = " ".join(f"{q:.0%} {np.quantile(errors, q):.1e}" for q in (0.5, 0.9, 0.99, 1))
    print(
        f"{name}: {len(rows)} solved, {sum(failures.values())} not {dict(failures) or ''}; λ {quantiles}; coercivity ≥ {coercivities.min():.3f}; loss {losses.max():.0e}"
    )


def kinks(number, meshes):
    for angle in (20, 45, 60, 70, 90, 120, 150):
        placements = kink_placements(np.random.default_rng(angle), angle, max(number // 7, 1))
        summary(f"kinks of {angle} degrees", [(meshes[i % 3], [crack], PAIRS[i % 5]) for i, crack in enumerate(placements)])


def networks(number, meshes):
    tasks = []
    for seed in range(number):
        rng = np.random.default_rng(seed)
        tasks.append((meshes[seed % 3], random_network(rng, int(rng.integers(2, 13)), 0.01, 5)[0], PAIRS[seed % 5]))
    summary("networks", tasks)


def stars(fine):
    for name in cases.CASES:
        problem, arm_of = star_problem(name, fine)
        solution, reference = problem.Solve(), cases.reference(name)
        scale = max(abs(value) for key, (value, _) in reference.items() if key.startswith("K_"))
        off = []
        for tip, arm in enumerate(arm_of):
            for kind, value in zip(("K_I", "K_II"), solution.StressIntensity(tip)):
                if f"{kind}, arm {arm}" in reference:
                    off.append(abs(value - reference[f"{kind}, arm {arm}"][0]) / scale)
        print(f"{name:45} h = {fine}: K off by {100 * max(off):.2f} % of the largest, {problem.V.ndof} unknowns", flush=True)


def fault_network(length, seed=0, number=50):
    """Faults of two sets of directions anywhere in the unit square, of a total length."""
    rng, cracks = np.random.default_rng(seed), []
    while len(cracks) < number:
        middle, angle = rng.uniform(0.08, 0.92, 2), np.radians(rng.choice([35, 100]) + rng.normal(0, 8))
        half = length / number * rng.uniform(0.25, 0.75) * np.array([np.cos(angle), np.sin(angle)])
        if np.abs(np.array([middle - half, middle + half]) - 0.5).max() < 0.47:
            cracks.append([tuple(map(float, middle - half)), tuple(map(float, middle + half))])
    return cracks


def without_cracks(mesh, order, u_0):
    """Seconds of one linear solve of the body without cracks."""
    start = perf_counter()
    V = VectorH1(mesh, order=order, dirichlet=".*")
    u, v = V.TnT()
    form = BilinearForm(InnerProduct(MATERIAL.Stress(Sym(Grad(u))), Sym(Grad(v))) * dx, symmetric=True).Assemble()
    gfu = GridFunction(V)
    gfu.Set(u_0, definedon=mesh.Boundaries(".*"))
    gfu.vec.data -= form.mat.Inverse(V.FreeDofs(), inverse="sparsecholesky") * (form.mat * gfu.vec).Evaluate()
    return perf_counter() - start


def faults():
    """Compression and shear by given displacements, under which about half of the nodes slip."""
    u_0 = CF((-0.004 * x + 0.012 * y, -0.01 * y))
    for order, maxh in ((1, 0.0034), (2, 0.0068)):
        mesh = Mesh(unit_square.GenerateMesh(maxh=maxh))
        for length in (1.5, 3, 6):
            with TaskManager():
                plain = sorted(without_cracks(mesh, order, u_0) for _ in range(3))[1]
                start = perf_counter()
                body = CrackedMesh(mesh, *map(Crack, fault_network(length)))
                V = CrackFESpace(body, order=order, dirichlet=".*", material=MATERIAL)
                problem = ContactProblem(V, TraceSpace(body, order=1), law=Coulomb(0.3))
                problem.SetDirichlet(u_0, ".*")
                report = problem.Solve().report
                whole = perf_counter() - start
            print(
                f"50 faults of length {length} in all, P{order}/P1: {V.ndof} unknowns, {problem.W.ndof} nodes; {whole:.1f} s, {whole / plain:.1f} times {plain:.2f} s "
                f"without cracks; {report.iterations} iterations; {' '.join(f'{name} {seconds:.2f}' for name, seconds in report.timings.items())}",
                flush=True,
            )


def main():
    SetNumThreads(1)
    warnings.simplefilter("ignore", AccuracyWarning)
    number = next((int(arg) for arg in sys.argv[1:] if arg.isdigit()), 200)
    chosen = [arg for arg in sys.argv[1:] if not arg.isdigit()] or ["kinks", "networks", "stars"]
    meshes = [Mesh(unit_square.GenerateMesh(maxh=maxh)) for maxh in (0.15, 0.1, 0.06)]
    if "kinks" in chosen:
        kinks(number, meshes)
    if "networks" in chosen:
        networks(number, meshes)
    if "faults" in chosen:
        SetNumThreads(2)
        faults()
    if "stars" in chosen:
        for fine in (0.02, 0.01, 0.005):
            stars(fine)


if __name__ == "__main__":
    recorded(main)
