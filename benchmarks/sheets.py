"""Planar sheets in tetrahedra: exact volumes and areas, no front missed, rules around fronts, and what is refused.

    python benchmarks/sheets.py [planes] [degenerate] [circles] [tubes] [random] [--realisations 1000]

planes: random planes through the unit cube. degenerate: planes through vertices, edges and faces of meshes, moved by offsets, a tenth of
the number for each kind. circles: the elements with a front of random
disks against the crossings of the circle with all faces. tubes: ∫ Σ_j |∇(χ F_j)|² over a tube around a straight and a circular front. random: sheets of five kinds.
"""

import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
from ngsolve import Integrate
from ngsolve.meshes import MakeStructured3DMesh
from results import recorded, run_cases

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests" / "sheets")]

from exact_sheets import KINDS, axes_of, circle_elements, cube_mesh, random_sheet  # noqa: E402
from sheet_checks import DEMANDS, OFFSETS, degenerate_planes, energies, plane_errors, tube_case  # noqa: E402

from ngsxfem_contact import CrackedMesh  # noqa: E402
from ngsxfem_contact.geometry import FrontDemand, Sheet  # noqa: E402


def planes(number):
    meshes = [cube_mesh(h, seed) for h, seed in ((0.5, None), (0.35, 1), (0.25, 2), (0.2, None))]
    rng, worst = np.random.default_rng(1), np.zeros(3)
    for i in range(number):
        normal = rng.normal(size=3)
        worst = np.maximum(worst, plane_errors(meshes[i % 4], rng.uniform(0.1, 0.9, 3), normal / np.linalg.norm(normal)))
    print(f"{number} random planes: largest error of the volume {worst[0]:.1e}, of that on the plus side {worst[1]:.1e}, of the area {worst[2]:.1e}")


def degenerate(number):
    rng, worst = np.random.default_rng(2), {}
    meshes = [cube_mesh(0.3, 3), cube_mesh(0.25), MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)]
    for i in range(number // 10):
        mesh = meshes[i % 3]
        for kind, point, normal in degenerate_planes(rng, mesh):
            for offset in OFFSETS:
                errors = plane_errors(mesh, point + offset * normal, normal)
                worst.setdefault((kind, abs(offset)), []).append(errors)
    print(f"{'through a':10}{'offset':>8}{'planes':>8}{'volume':>10}{'plus side':>11}{'area':>10}")
    for (kind, offset), errors in worst.items():
        e = np.max(errors, axis=0)
        print(f"{kind:10}{offset:8.0e}{len(errors):8}{e[0]:10.1e}{e[1]:11.1e}{e[2]:10.1e}")


def circles(number):
    meshes, rng = [cube_mesh(h, s) for h, s in ((0.4, None), (0.3, 1), (0.25, 2))], np.random.default_rng(3)
    counts, missed, extra, doubt = 0, 0, 0, 0
    for i in range(number):
        normal, radius = rng.normal(size=3), rng.uniform(0.12, 0.4)
        origin = rng.uniform(radius, 1 - radius, 3)
        body = CrackedMesh(meshes[i % 3], Sheet.Disk(origin, normal, radius))
        found = {cell.element for cell in body.Elements(0) if cell.kind.name == "Tip"}
        expected, doubtful = circle_elements(meshes[i % 3], origin, axes_of(normal), radius)
        counts, doubt = counts + len(expected), doubt + len(doubtful)
        missed += len(expected - found)
        extra += len(found - expected - doubtful)
    print(f"{number} random circles, {counts} elements with a front: {missed} missed, {extra} too many; {doubt} that the circle enters by less than 1e-9")


def tubes(number):
    print(f"{'front':10}{'h':>6}{'rules':>9}{'points':>9}{'seconds':>9}{'error':>10}{'sum |.|':>10}{'in front elements':>19}")
    for kind, maxh in (("straight", 0.25), ("straight", 0.18), ("circle", 0.25), ("circle", 0.2)):
        body, r1, exact = tube_case(kind, maxh)
        reference = energies(body, r1, FrontDemand(r1, 14, 12, 12, 11, 0.5))
        front = list(body.FrontElements(0))
        print(f"{kind:10}{maxh:6}{'reference':>9}{'':9}{'':9}{reference.sum() / exact - 1:10.1e}")
        for name, options in DEMANDS.items():
            demand = FrontDemand(r1, **options)
            start = time.process_time()
            points = len(body.dx(fronts=demand).Points(5)[0])
            seconds, value = time.process_time() - start, energies(body, r1, demand)
            off = np.abs(value - reference)
            print(
                f"{kind:10}{maxh:6}{name:>9}{points:9}{seconds:9.2f}{value.sum() / exact - 1:10.1e}{off.sum() / exact:10.1e}{off[front].sum() / exact:19.1e}",
                flush=True,
            )


def random(number):
    meshes = [cube_mesh(h, s) for h, s in ((0.45, None), (0.35, 1), (0.28, 2), (0.22, 3), (0.2, None))]
    rng, results, worst, volume = np.random.default_rng(4), {}, Counter(), 0.0
    for i in range(number):
        kind, mesh = KINDS[i % 5], meshes[rng.integers(5)]
        random = random_sheet(rng, kind)
        try:
            body = CrackedMesh(mesh, random.sheet)
            worst[kind] = max(worst[kind], abs(Integrate(1 * body.dcrack, mesh) - random.area))
            volume = max(volume, abs(Integrate(1 * body.dx, mesh) - 1))
            outcome = "solved"
        except Exception as error:
            text = str(error)
            outcome = next((word for word in ("20 degrees", "smaller than an element", "along the boundary", "same element") if word in text), text)
        results.setdefault(kind, Counter())[outcome] += 1
    for kind, outcomes in results.items():
        print(f"{kind:12} cut {outcomes.pop('solved', 0):4}, largest error of the area {worst[kind]:.1e}; refused: {dict(outcomes)}")
    print(f"largest error of the volume {volume:.1e}")


def main():
    run_cases(__doc__, (planes, degenerate, circles, tubes, random), 1000)


if __name__ == "__main__":
    recorded(main)
