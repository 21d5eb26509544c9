"""Contact on random and special sheets in random meshes under uniform compression, whose solution every space has: λ = -1.

    python benchmarks/sheet_contact.py [random] [adversarial] [random_order_1] [adversarial_order_1] [--realisations 1000]

random: sheets of five kinds, ten in each mesh of the unit cube, whose inner points are moved at random, with edges between 0.25 and 0.45. adversarial: a tenth of the number, planes and
disks through vertices, edges and faces, disks and squares whose front goes through vertices and along edges, moved by 0, ±1e-12 and ±1e-9. The multipliers are of order 0, or 1. Each problem is solved without modes;
one in 49 also with modes and default rules around the front, of order 0 one in 196 with finer rules: those around ellipses take seconds. "λ": the largest |λ + 1| of all nodes,
and the largest error in L² of a problem, relative; with modes they are what the rules leave. S: the multipliers' Schur complement with unit diagonal.
Refused are sheets that CrackedMesh refuses, with the reason; all others have to be solved.
"""

import sys
import warnings
from collections import Counter, defaultdict
from itertools import count
from pathlib import Path

import numpy as np
from ngsolve.meshes import MakeStructured3DMesh
from results import recorded, run_cases

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests" / "sheets")]

from exact_sheets import KINDS, cube_mesh, random_sheet  # noqa: E402
from patch_problems import REASONS, patch, special_sheets  # noqa: E402

from ngsxfem_contact import CrackedMesh  # noqa: E402
from ngsxfem_contact.geometry import FrontDemand  # noqa: E402
from ngsxfem_contact.spaces import FrontEnrichment  # noqa: E402

FINE = FrontEnrichment(rules=FrontDemand(0, 6, 6, 5, 7, 0.35))
SPACES = (  # by the order of the multipliers: the modes, and each how many sheets are solved for so
    {"no modes": (None, 1), "modes": (FrontEnrichment(), 49), "modes, fine": (FINE, 196)},
    {"no modes": (None, 1), "modes": (FrontEnrichment(), 49)},
)
OFFSETS = (0, 1e-12, -1e-12, 1e-9, -1e-9)


class Outcomes:
    """Of all problems by their kind: what was refused, failed, and found."""

    def __init__(self, multipliers):
        self.multipliers, self.spaces = multipliers, SPACES[multipliers]
        self.refused, self.failed, self.found, self.number = defaultdict(Counter), [], defaultdict(list), 0

    def Add(self, kind, name, mesh, sheet):
        self.number += 1
        try:
            body = CrackedMesh(mesh, sheet)
        except Exception as error:
            reason = next((word for word in REASONS if word in str(error)), None)
            if reason:
                self.refused[kind][reason] += 1
            else:
                self.failed.append(f"{name}: {error}")
            return
        for space, (front, every) in self.spaces.items():
            if self.number % every:
                continue
            try:
                self.found[kind, space].append(patch(body, front, self.multipliers))
            except Exception as error:
                self.failed.append(f"{name}, {space}: {type(error).__name__}: {error}")

    def Print(self, kinds):
        print(f"{'sheet':26}{'space':13}{'solved':>7}{'λ worst':>9}{'λ L2':>9}{'least eig. S':>14}{'cond S':>8}{'steps':>7}")
        for kind in kinds:
            for space in self.spaces:
                found = np.array(self.found[kind, space])
                if len(found):
                    worst = found.max(axis=0)
                    print(f"{kind:26}{space:13}{len(found):7}{worst[0]:9.1e}{worst[1]:9.1e}{found[:, 2].min():14.3f}{worst[3]:8.1f}{worst[4]:7.0f}")
            if self.refused[kind]:
                print(f"{kind:26}refused: {dict(self.refused[kind])}")
        print(f"{self.number} sheets, failed: {len(self.failed)}")
        for failure in self.failed:
            print(f"  {failure}")


def random(number, multipliers=0):
    rng, outcomes = np.random.default_rng(11), Outcomes(multipliers)
    for i in range(number):
        if i % 10 == 0:
            mesh = cube_mesh(rng.uniform(0.25, 0.45), seed=i)
        kind = KINDS[i % 5]
        outcomes.Add(kind, f"random {i}", mesh, random_sheet(rng, kind).sheet)
    outcomes.Print(KINDS)


def adversarial(number, multipliers=0):
    rng, outcomes, kinds = np.random.default_rng(12), Outcomes(multipliers), {}
    meshes = [cube_mesh(0.35, 3), cube_mesh(0.3), MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4)]
    for i in range(6):
        meshes[2].ngmesh.SetBCName(i, "outer")
    for turn in count():
        mesh, offset = meshes[turn % 3], OFFSETS[turn % 5]
        for kind, sheet in special_sheets(rng, mesh, offset):
            kinds[kind] = True
            outcomes.Add(kind, f"adversarial {outcomes.number}, {kind}, offset {offset}", mesh, sheet)
        if outcomes.number >= number // 10:
            break
    outcomes.Print(kinds)


def random_order_1(number):
    random(number, 1)


def adversarial_order_1(number):
    adversarial(number, 1)


def main():
    warnings.simplefilter("ignore")
    run_cases(__doc__, (random, adversarial, random_order_1, adversarial_order_1), 1000)


if __name__ == "__main__":
    recorded(main)
