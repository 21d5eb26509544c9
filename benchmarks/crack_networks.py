"""Cracks that cross, end on each other, kink and close: how many of many random ones are solved, and stress intensity factors of stars.

    python benchmarks/crack_networks.py [kinks] [networks] [stars] [N]

`kinks`: N (default 200) two-segment cracks with kinks of 20 to 150 degrees anywhere; `networks`: N random networks of 2 to 12 cracks, closest distance
0.01 and sharpest angle 5 degrees, five pairs and three meshes; both under a uniform pressure, which λ has to be, with the coercivity of K - K_γ. `stars`: the cases of
`tests/networks/cases.py` against boundary-fitted meshes.
"""

import sys
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from netgen.geom2d import unit_square
from ngsolve import CF, Integrate, Mesh, SetNumThreads, x, y
from results import recorded

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests")]

from networks import cases  # noqa: E402
from networks.random_networks import kink_placements, random_network  # noqa: E402
from networks.stars import star_problem  # noqa: E402

from ngsxfem_contact import AccuracyWarning, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace  # noqa: E402
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
    if "stars" in chosen:
        for fine in (0.04, 0.02, 0.01):
            stars(fine)


if __name__ == "__main__":
    recorded(main)
