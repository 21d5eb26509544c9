"""Curved sheets in space: geometry, contact beside the plane package, K beside a closed form, uniform pressure on random arcs.

    python benchmarks/curved_sheets.py [geometry] [contact] [factors] [kinks] [pressure] [--realisations 100]

geometry: an arc of radius 1.2 that is extruded through the unit cube, errors of its area and of the volume on one side. contact: a slab of thickness 0.15 between planes of symmetry, cracked by an
extruded arc, order 1, beside the plane package with order 2 and edges of 0.04: pressure, jump in L² and energy, percent. factors: an open arc in a slab, order 2, beside the closed form of plane strain:
the largest error of K_I and K_II, percent of K_I, at nodes between the ends, and at the ends. kinks: extruded cracks with one kink through the unit cube, by the angle by which they turn: relative errors
of the area, errors of the volume on one side. pressure: arcs through the cube at random places, angles and radii, in meshes with edges
between 0.2 and 0.4 whose inner points are moved, under the stress -1: the largest |λ + 1|.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
from ngsolve import Integrate
from results import recorded, run_cases

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "sheets")]

from exact_sheets import cube_mesh  # noqa: E402
from kinked_surfaces import along_z, area_and_volume, kinked  # noqa: E402
from test_curved_sheets import volume_above  # noqa: E402

from ngsxfem_contact import Coulomb, Crack, CrackedMesh  # noqa: E402
from ngsxfem_contact.geometry import Sheet  # noqa: E402
from tests.contact.test_curved_contact import ARC, open_arc, plane_solution, pressed, quantities, solid_solution  # noqa: E402
from tests.sheets.curved_surfaces import ABOVE, AREA, THROUGH  # noqa: E402

THICKNESS = 0.15


def order_of(sizes, errors):
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def geometry(_):
    print(f"{'maxh':>6}{'tets':>8}{'area':>10}{'volume':>10}")
    sizes, errors = (0.4, 0.28, 0.2, 0.14, 0.1), []
    for maxh in sizes:
        body = CrackedMesh(cube_mesh(maxh), THROUGH)
        errors.append((abs(Integrate(1 * body.dcrack, body.mesh) / AREA - 1), abs(volume_above(body) / ABOVE - 1)))
        print(f"{maxh:6.2f}{body.mesh.ne:8}{errors[-1][0]:10.1e}{errors[-1][1]:10.1e}", flush=True)
    print(f"{'order':>14}" + "".join(f"{order_of(sizes, column):10.2f}" for column in np.transpose(errors)))


def contact(_):
    print(f"{'law':>14}{'maxh':>6}{'N':>8}{'m':>6}{'pressure':>10}{'jump':>8}{'energy':>8}   percent")
    for name, law in (("frictionless", None), ("Coulomb 0.3", Coulomb(0.3))):
        exact, sizes, errors = quantities(plane_solution(law)), (0.15, 0.1, 0.07, 0.05), []
        for maxh in sizes:
            solution = solid_solution(law, maxh, THICKNESS)
            errors.append(100 * np.abs(quantities(solution, THICKNESS) / exact - 1))
            numbers = solution.problem.V.ndof, len(solution.state.nodes)
            print(f"{name:>14}{maxh:6.2f}{numbers[0]:8}{numbers[1]:6}{errors[-1][0]:10.2f}{errors[-1][1]:8.2f}{errors[-1][2]:8.2f}", flush=True)
        print(f"{'order':>34}" + "".join(f"{order_of(sizes, column):{width}.2f}" for column, width in zip(np.transpose(errors), (10, 8, 8))))


def factors(_):
    print(f"{'maxh':>6}{'N':>8}{'nodes':>7}{'K_I':>8}{'K_II':>8}{'at ends':>9}{'':>8}   percent of K_I")
    exact = np.array(ARC.StressIntensity(1))
    for maxh in (0.16, 0.12, 0.1, 0.08):
        solution = open_arc(maxh)
        found = solution.StressIntensity()
        off = 100 * np.abs(np.column_stack([found.K_I, found.K_II]) - exact) / exact[0]
        inside, ends = off[1:-1].max(axis=0), off[[0, -1]].max(axis=0)
        print(f"{maxh:6.2f}{solution.problem.V.ndof:8}{len(found.s):7}{inside[0]:8.2f}{inside[1]:8.2f}{ends[0]:9.2f}{ends[1]:8.2f}", flush=True)


def kinks(_):
    sizes, at, towards = (0.4, 0.28, 0.2, 0.14, 0.1), np.array([0.513, 0.487]), 0.3
    print(f"{'turn':>6}{'':>9}" + "".join(f"{f'maxh={maxh}':>11}" for maxh in sizes) + f"{'order':>8}")
    for degrees in (30, 60, 90, 120, 150):
        area, volume = area_and_volume(at, towards, np.radians(degrees))
        bodies = [CrackedMesh(cube_mesh(maxh), along_z(kinked(at, towards, np.radians(degrees)))) for maxh in sizes]
        errors = {
            "area": [abs(Integrate(1 * body.dcrack, body.mesh) / area - 1) for body in bodies],
            "volume": [abs(volume_above(body) - volume) for body in bodies],
        }
        for name, values in errors.items():
            print(f"{degrees:6}{name:>9}" + "".join(f"{value:11.1e}" for value in values) + f"{order_of(sizes, values):8.2f}", flush=True)


def pressure(realisations):
    worst, refused, rng = [], 0, np.random.default_rng(1)
    for number in range(realisations):
        radius, angle, (r, height) = rng.uniform(1, 4), rng.uniform(0, 2 * np.pi), rng.uniform(-0.15, 0.15, 2)
        middle = np.array([0.5 + r, 0.5 + height])
        centre = middle - radius * np.array([np.cos(angle), np.sin(angle)])
        half = min(1.2 / radius, 1.4)
        ends = [tuple(float(c) for c in centre + radius * np.array([np.cos(angle + a), np.sin(angle + a)])) for a in (half, 0, -half)]
        try:
            sheet = Sheet.Extrude(Crack.Arc(*ends), (0, 0, 3), (0, 0, -1))
            worst.append(np.abs(pressed(cube_mesh(rng.uniform(0.2, 0.4), number), sheet, None).state.L + 1).max())
        except Exception as error:
            refused += 1
            print(f"{number}: {type(error).__name__}: {error}", flush=True)
    print(f"{realisations} arcs, {refused} refused: |λ + 1| at most {max(worst):.1e}, in the median {np.median(worst):.1e}")


def main():
    warnings.simplefilter("ignore")
    run_cases(__doc__, (geometry, contact, factors, kinks, pressure), 100)


if __name__ == "__main__":
    recorded(main)
