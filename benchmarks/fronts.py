"""K and G along fronts in space: closed forms against the rule and the number of nodes, fields on meshes, and how often the reported errors cover the true ones.

    python benchmarks/fronts.py [rules] [nodes] [meshes] [--realisations 10]

rules, nodes: exact fields of a penny, a = 0.28, and an ellipse, in a plane that is unrelated to a mesh of 14 × 14 × 14 cubes: the integrals alone. meshes: projections of the exact
displacement onto polynomials on each element, the sheet along faces of the mesh, at random positions: what the integrals make of errors near the front.
"""

import sys
import time
from pathlib import Path

import numpy as np
from ngsolve import Grad, GridFunction, VectorL2
from ngsolve.meshes import MakeStructured3DMesh
from results import recorded, run_cases

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests" / "fracture")]

from test_fronts_in_space import AXES, DISK, FORMS, MATERIAL, MESH, ORIGIN, A, B, error_of, factors_of, field_of  # noqa: E402

from ngsxfem_contact import CrackedMesh  # noqa: E402
from ngsxfem_contact.exact.pennies import bent_penny, closed_penny, penny_in_tension, sheared_penny  # noqa: E402
from ngsxfem_contact.fracture.front_stress_intensity import front_factors  # noqa: E402
from ngsxfem_contact.fracture.front_tube import TubeRule  # noqa: E402
from ngsxfem_contact.geometry import Sheet  # noqa: E402

ELLIPSE = CrackedMesh(MESH, Sheet.Ellipse(ORIGIN, A * AXES[0], B * AXES[1]))


def placed(name):
    return (ELLIPSE if name == "ellipse" else DISK), FORMS[name].At(ORIGIN, AXES)


def G_error(found):
    return np.abs(found.G - found.irwin).max() / found.irwin.max()


def rules(_):
    print(f"{'largest error of K / largest K, 24 nodes':42}{'points':>9}{'seconds':>9}" + "".join(f"{name:>10}" for name in FORMS))
    for rule in (TubeRule(2, 2, 12), TubeRule(4, 4, 24), TubeRule(6, 5, 32), TubeRule(), TubeRule(12, 8, 48)):
        start, errors = time.process_time(), []
        for name in FORMS:
            body, form = placed(name)
            errors.append(error_of(front_factors(body, field_of(form), MATERIAL, nodes=24, rule=rule), form))
        seconds = (time.process_time() - start) / len(FORMS)
        print(f"{rule!s:42}{24 * rule.along * 3 * rule.radial * rule.angular:9}{seconds:9.2f}" + "".join(f"{e:10.1e}" for e in errors), flush=True)


def nodes(_):
    print(f"{'nodes: largest error of K / largest K':42}" + "".join(f"{name:>10}" for name in FORMS) + "   and of G, against irwin")
    for number in (8, 12, 16, 24, 32):
        found = [(front_factors(placed(name)[0], field_of(placed(name)[1]), MATERIAL, nodes=number), placed(name)[1]) for name in FORMS]
        print(
            f"{number:<42}" + "".join(f"{error_of(f, form):10.1e}" for f, form in found) + "   " + "".join(f"{G_error(f):10.1e}" for f, _ in found), flush=True
        )


def meshes(realisations):
    rng = np.random.default_rng(5)
    print(f"{'field':22}{'degree':>7}{'h/a':>7}{'radius/h':>9}{'nodes':>6}{'K_I':>8}{'K_II':>8}{'K_III':>8}{'rms':>8}{'reported':>10}{'covered':>9}")
    forms = {
        "tension and shear": penny_in_tension(MATERIAL, 0.3) + sheared_penny(MATERIAL, 0.3),
        "tension and bending": penny_in_tension(MATERIAL, 0.3) + bent_penny(MATERIAL, 0.3, 2),
        "closed, friction": closed_penny(MATERIAL, 0.3, 1, 1.5, 0.3),
    }
    for n in (12, 16, 24):
        mesh = MakeStructured3DMesh(hexes=False, nx=n, ny=n, nz=n)
        for name, unplaced in forms.items():
            for degree in (1, 2):
                errors, reported, sizes = [], [], []
                for _ in range(realisations):
                    place = (*rng.uniform(0.48, 0.52, 2), 0.5)
                    form = unplaced.At(place)
                    field, u = field_of(form), GridFunction(VectorL2(mesh, order=degree))
                    u.Set(form.u)
                    field.gradient = Grad(u)
                    body = CrackedMesh(mesh, Sheet.Disk(place, (0, 0, 1), 0.3))
                    found = front_factors(body, field, MATERIAL)
                    exact = form.Factors(found.points)
                    errors.append((factors_of(found) - exact) / np.abs(exact).max())
                    reported.append(found.errors / np.abs(exact).max())
                    sizes.append((found.radii[0], len(found.s)))
                e, r = np.abs(np.concatenate(errors)), np.concatenate(reported)
                h, (radius, number) = np.sqrt(3) / n, sizes[0]
                print(
                    f"{name:22}{degree:7}{h / 0.3:7.2f}{radius / h:9.2f}{number:6}"
                    + "".join(f"{m:8.1%}" for m in e.max(axis=0))
                    + f"{np.sqrt((e**2).mean()):8.1%}{r.mean():10.1%}{(e <= r + 1e-12).mean():9.0%}",
                    flush=True,
                )


def main():
    run_cases(__doc__, (rules, nodes, meshes))


if __name__ == "__main__":
    recorded(main)
