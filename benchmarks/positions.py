"""Random and adversarial positions of cracks: does a solve ever fail, and does its accuracy depend on the position?

    python benchmarks/positions.py [--random 1000] [--closed 200] [--adversarial 40] [--pairs P2/P1 ...] [--first 0] [--json FILE]

--random N: N random cracks in random meshes with random loads, each solved with every pair of spaces.
--closed N: errors on the closed forms (c) and (d) at N random positions of one mesh.
--adversarial N: cracks through vertices, along edges, with tips and kinks on vertices and edges, each displaced by
    0, 1e-15, 1e-12, 1e-9, 1e-6 of h; N is rounded up to a multiple of the kinds.
"""

import argparse
import json
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from ngsolve import CF, Mesh, ngsglobals, sin, x, y

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import MATERIAL, PAIRS

sys.path.insert(0, str(Path(__file__).resolve().parent))
import adversarial  # noqa: E402
from bodies import boundary_segments, moved_square, random_crack, random_mesh, ray_to_boundary  # noqa: E402
from results import recorded  # noqa: E402


@dataclass
class Position:
    """One body with its crack, its material, its loads, and the singular functions at the tips."""

    mesh: Mesh
    crack: Crack
    material: Elasticity
    loads: dict
    functions: str | None
    label: str = ""
    closed: bool = field(default=False)

    def Problem(self, pair, order=None):
        """The contact problem of one pair of spaces; every boundary is given a displacement, or one boundary is held."""
        orders = PAIRS[pair]
        body = CrackedMesh(self.mesh, self.crack)
        tip = self.functions and TipEnrichment(material=self.material, functions=self.functions)
        V = CrackFESpace(body, order=order or orders.order, bubble=orders.bubble, tip=tip, dirichlet=self.loads["held"])
        problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), self.material)
        v = V.TestFunction()
        problem.f += CF(self.loads["force"]) * v * body.dx
        if self.loads["loaded"]:
            problem.f += CF(self.loads["traction"]) * v * body.ds(self.loads["loaded"])
        if "given" in self.loads:
            problem.SetDirichlet(self.loads["given"], self.loads["held"])
        return problem


def random_loads(rng, boundaries, through):
    """Displacements on the whole boundary, or one side held, tractions on the others; a body force."""
    vector = lambda scale: tuple(float(c) for c in rng.normal(0, scale, 2))
    if through or rng.random() < 0.5:
        A, k = rng.normal(0, 1e-2, (2, 2)), rng.uniform(1, 6, 2)
        given = CF(tuple(A[i, 0] * x + A[i, 1] * y + 2e-3 * rng.normal() * sin(float(k[i]) * (x - y)) for i in range(2)))
        return {"held": "|".join(boundaries), "loaded": "", "given": given, "force": vector(0.02)}
    held, *loaded = rng.permutation(boundaries)
    return {"held": str(held), "loaded": "|".join(loaded), "traction": vector(0.02), "force": vector(0.05)}


def random_position(seed):
    """The position number `seed`."""
    rng = np.random.default_rng(seed)
    mesh, kind = random_mesh(rng)
    crack, shape, ends = random_crack(rng, mesh)
    material = Elasticity.PlaneStrain(E=1, nu=float(rng.uniform(0, 0.45)))
    loads = random_loads(rng, sorted(set(mesh.GetBoundaries())), ends == "through")
    functions = str(rng.choice(["modes", "branch"])) if ends != "through" and rng.random() < 0.9 else None
    return Position(mesh, crack, material, loads, functions, f"{kind} {shape} {ends}")


def solve_random(seed, pair):
    """What happened, a dict."""
    start = time.perf_counter()
    record = {"seed": seed, "pair": pair}
    try:
        position = random_position(seed)
        record["label"] = f"{position.label} {position.functions}"
        solution = position.Problem(pair).Solve()
        report = solution.report
        record |= {"iterations": report.iterations, "fallback": report.fallback, "residual": report.residual, "complementarity": report.complementarity}
        record |= {
            "energy": solution.Energy(),
            "finite": bool(np.isfinite(solution.u.vec.FV().NumPy()).all()),
            "active": int(report.active[-1].sum()),
            "signs": len(report.active[-1]),
        }
    except Exception as error:  # every failure is reported
        record["error"] = f"{type(error).__name__}: {str(error).splitlines()[0]}"
    return record | {"seconds": time.perf_counter() - start}


def run_random(arguments, write):
    records = [
        record
        for seed in range(arguments.first, arguments.first + arguments.random)
        for pair in arguments.pairs
        for record in [write(solve_random(seed, pair))]
    ]
    print_random(records)


def print_random(records):
    """One line for each pair."""
    print(
        f"{'pair':8}{'solves':>7}{'failed':>7}{'not finite':>11}{'fallbacks':>10}{'iterations: median, 99 %, most':>32}{'residual':>10}{'complementarity':>17}{'seconds':>9}"
    )
    for pair in dict.fromkeys(r["pair"] for r in records):
        mine = [r for r in records if r["pair"] == pair]
        done = [r for r in mine if "error" not in r]
        column = lambda name, done=done: np.array([r[name] for r in done])
        iterations = column("iterations")
        print(
            f"{pair:8}{len(mine):7}{len(mine) - len(done):7}{int((~column('finite')).sum()):11}{int((column('fallback') > 0).sum()):10}"
            f"{np.median(iterations):18.0f}{np.percentile(iterations, 99):7.0f}{iterations.max():7}"
            f"{column('residual').max():10.1e}{column('complementarity').max():17.1e}{np.median([r['seconds'] for r in mine]):9.2f}"
        )
    for message, number in Counter((r["error"][:110]) for r in records if "error" in r).most_common():
        print(f"{number:6} × {message}")


# Closed forms


def closed_position(seed, maxh=0.06):
    """One mesh of the unit square, turned by any angle and shifted: (mesh, x of the left mouth, x of the right one), crack on y = 0."""
    rng = np.random.default_rng(seed)
    mesh = moved_square(rng.uniform(0, 2 * np.pi), rng.uniform(-0.1, 0.1, 2), maxh)
    segments = boundary_segments(mesh)
    return mesh, *(float(ray_to_boundary(np.zeros(2), np.array([s, 0.0]), segments)[0]) for s in (-1, 1))


def solve_closed(case, seed, pair):
    """Errors of (c), a slipping tip at the origin, or (d), a contact transition there on a crack through the body."""
    mesh, left, right = closed_position(seed)
    exact = cf.slipping_tip(MATERIAL) if case == "c" else cf.contact_transition(MATERIAL)
    body = CrackedMesh(mesh, cf.crack_on_axis(left, 0 if case == "c" else right))
    tip = TipEnrichment(r1=0.35, material=MATERIAL) if case == "c" else None
    boundary = "|".join(sorted(set(mesh.GetBoundaries())))
    V = CrackFESpace(body, order=PAIRS[pair].order, bubble=PAIRS[pair].bubble, tip=tip, dirichlet=boundary)
    problem = ContactProblem(V, TraceSpace(body, order=PAIRS[pair].multiplier_order), MATERIAL)
    problem.SetDirichlet(exact.u, boundary)
    solution = problem.Solve()
    return {"case": case, "seed": seed, "pair": pair, "energy": float(cf.energy_error(solution, exact)), "pressure": float(cf.pressure_error(solution, exact))}


def run_closed(arguments, write):
    print(f"{'case':6}{'pair':8}{'energy: median':>15}{'worst/median':>14}{'(position)':>12}{'λ: median':>12}{'worst/median':>14}{'(position)':>12}")
    for case in "cd":
        for pair in arguments.pairs:
            records = [write(solve_closed(case, seed, pair)) for seed in range(arguments.closed)]
            columns = ""
            for name, width in (("energy", 15), ("pressure", 12)):
                errors = np.array([r[name] for r in records])
                columns += f"{np.median(errors):{width}.2e}{errors.max() / np.median(errors):14.2f}{int(errors.argmax()):12}"
            print(f"{case:6}{pair:8}{columns}", flush=True)


# Adversarial positions


def adversarial_position(kind, sample, displacement, refined=False):
    """A Position with given displacements on the whole boundary; displacement relative to h."""
    rng = np.random.default_rng(sample)
    mesh, crack, singular = adversarial.position(kind, sample, displacement, refined)
    A, k = rng.normal(0, 1e-2, (2, 2)), rng.uniform(1, 4)
    given = CF((A[0, 0] * x + A[0, 1] * y + 2e-3 * sin(float(k) * y), A[1, 0] * x - abs(A[1, 1]) * y))
    loads = {"held": "|".join(sorted(set(mesh.GetBoundaries()))), "loaded": "", "given": given, "force": (0, 0)}
    return Position(mesh, crack, MATERIAL, loads, "modes" if singular else None)


def solve_adversarial(kind, sample, displacement, pair, refined=False):
    """Energy and contact force."""
    record = {"kind": kind, "sample": sample, "displacement": displacement, "pair": pair}
    try:
        solution = adversarial_position(kind, sample, displacement, refined).Problem(pair).Solve()
        report = solution.report
        record |= {
            "energy": solution.Energy(),
            "force": solution.ContactForce(),
            "residual": report.residual,
            "complementarity": report.complementarity,
            "fallback": report.fallback,
        }
    except Exception as error:  # every failure is reported
        record["error"] = f"{type(error).__name__}: {str(error).splitlines()[0]}"
    return record


def run_adversarial(arguments, write):
    places = [(kind, sample) for sample in range(-(-arguments.adversarial // len(adversarial.KINDS))) for kind in adversarial.KINDS]
    fine = {(*place, d): solve_adversarial(*place, d, "P2/P1", refined=True) for place in places for d in (0, adversarial.GENERIC)}
    displacements = [*adversarial.DISPLACEMENTS, adversarial.GENERIC]
    for pair in arguments.pairs:
        print_adversarial(pair, [write(solve_adversarial(*place, d, pair)) for d in displacements for place in places], fine)


def print_adversarial(pair, records, fine):
    """Errors of the energy are relative to P2/P1 on the mesh refined twice; changes to the undisplaced position."""
    failed = [r for r in [*records, *fine.values()] if "error" in r]
    good = {(r["kind"], r["sample"], r["displacement"]): r for r in records if "error" not in r}
    print(
        f"{pair:8}{len(records)} solves, {len(failed)} failed; worst residual {max(r['residual'] for r in good.values()):.1e}, complementarity {max(r['complementarity'] for r in good.values()):.1e}"
    )
    print(f"        {'displaced by':>12}{'error of the energy: median':>29}{'worst':>9}{'change of the energy: median':>30}{'worst':>9}{'of ∫λ: worst':>14}")
    for d in dict.fromkeys(key[2] for key in good):
        mine = {key[:2]: r for key, r in good.items() if key[2] == d}
        exact = {place: fine[(*place, d if d == adversarial.GENERIC else 0)]["energy"] for place in mine}
        error = np.array([abs(r["energy"] / exact[place] - 1) for place, r in mine.items()])
        line = f"        {d:10.0e} h{np.median(error):29.1e}{error.max():9.1e}"
        if 0 < d < adversarial.GENERIC:
            start = {place: good[(*place, 0)] for place in mine if (*place, 0) in good}
            change = np.array([abs(mine[place]["energy"] / r["energy"] - 1) for place, r in start.items()])
            forces = [abs(mine[place]["force"] / r["force"] - 1) for place, r in start.items() if r["force"]]
            line += f"{np.median(change):30.1e}{change.max():9.1e}{max(forces):14.1e}"
        print(line, flush=True)
    for r in failed:
        print(f"        {r['kind']}, {r['sample']}, {r['displacement']:.0e}: {r['error'][:140]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("random", "closed", "adversarial"):
        parser.add_argument(f"--{name}", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="the first random number")
    parser.add_argument("--pairs", nargs="+", default=list(PAIRS), choices=list(PAIRS))
    parser.add_argument("--json", type=Path, help="one record a line")
    arguments = parser.parse_args()
    ngsglobals.msg_level = 0

    def write(record):
        if arguments.json:
            with arguments.json.open("a") as file:
                file.write(json.dumps(record) + "\n")
        return record

    for name, run in {"random": run_random, "closed": run_closed, "adversarial": run_adversarial}.items():
        if getattr(arguments, name):
            run(arguments, write)


if __name__ == "__main__":
    recorded(main)
