"""Two or three random cracks in random meshes as coarse as their distances: are they solved, or refused with the place?

python benchmarks/several.py [--bodies 400] [--first 0]
python benchmarks/several.py --ligaments       closed cracks side by side in the same elements
"""

import argparse
from collections import Counter

import numpy as np
from bodies import boundary_segments, random_crack, random_mesh, ray_to_boundary
from ngsolve import CF, ngsglobals, sin, x, y
from results import recorded

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import Coercivity
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import MATERIAL, PAIRS


def random_body(seed):
    """Of a random number; raises Exception for cracks that meet or come too close for the mesh."""
    rng = np.random.default_rng(seed)
    mesh, _ = random_mesh(rng)
    return CrackedMesh(mesh, *(random_crack(rng, mesh)[0] for _ in range(int(rng.integers(2, 4)))))


def problem(body, pair, seed):
    """Random displacements on the whole boundary."""
    V = CrackFESpace(body, order=PAIRS[pair].order, bubble=PAIRS[pair].bubble, tip=TipEnrichment(material=MATERIAL), dirichlet=".*")
    contact = ContactProblem(V, TraceSpace(body, order=PAIRS[pair].multiplier_order), MATERIAL)
    A = np.random.default_rng(seed).normal(0, 1e-2, (2, 2))
    contact.SetDirichlet(CF((A[0, 0] * x + A[0, 1] * y + 2e-3 * sin(3 * (x - y)), A[1, 0] * x + A[1, 1] * y)), ".*")
    return contact


def num_shared(body):
    """The number of elements that several cracks meet."""
    return sum(len(body.CracksOf(element)) > 1 for element in range(body.mesh.ne))


def ligament_error(distance, number, order):
    """Relative error of λ for uniform compression of parallel cracks through the body, their distance relative to the longest edge beside them."""
    mesh, exact = cf.rotated_square(0.3, (0.01, 0.02), 0.12), cf.uniform_compression(MATERIAL)
    segments = boundary_segments(mesh)
    mouth = lambda height, direction: tuple(map(float, ray_to_boundary(np.array([0.0, height]), np.array([direction, 0.0]), segments)))
    line = lambda height: Crack([mouth(height, -1.0), mouth(height, 1.0)])
    h = max(location.h for location in CrackedMesh(mesh, line(0.0)).Elements(0))
    body = CrackedMesh(mesh, *(line(i * distance * h) for i in range(number)))
    V = CrackFESpace(body, order=order, dirichlet="outer")
    contact = ContactProblem(V, TraceSpace(body, order=1), MATERIAL)
    contact.SetDirichlet(exact.u, "outer")
    return cf.pressure_error(contact.Solve(), exact)


def run_ligaments():
    print(f"{'distance/h':>10}{'cracks':>8}" + "".join(f"{f'P{k}/P1':>10}" for k in (1, 2, 3)))
    for distance in (0.2, 0.1, 0.06, 0.035):
        for number in (2, 3):
            print(f"{distance:10}{number:8}" + "".join(f"{ligament_error(distance, number, k):10.1e}" for k in (1, 2, 3)), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", type=int, default=400)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--ligaments", action="store_true")
    arguments = parser.parse_args()
    ngsglobals.msg_level = 0
    if arguments.ligaments:
        run_ligaments()
        return
    refused, solved, iterations, least = Counter(), Counter(), [], 1.0
    for seed in range(arguments.first, arguments.first + arguments.bodies):
        try:
            body = random_body(seed)
        except Exception as error:
            refused["meet" if "meet near" in str(error) else "too close for the mesh" if "meet the same element" in str(error) else str(error)] += 1
            continue
        contact = problem(body, list(PAIRS)[seed % len(PAIRS)], seed)
        iterations.append(contact.Solve().report.iterations)
        solved["with shared elements" if num_shared(body) else "apart"] += 1
        least = min(least, Coercivity(contact)) if num_shared(body) else least
    print(f"solved {dict(solved)}, refused {dict(refused)}; at most {max(iterations)} iterations, least coercivity beside shared elements {least:.2f}")


if __name__ == "__main__":
    recorded(main)
