"""How often the error that StressIntensity reports covers the true one, and by how much it exceeds it.

    python benchmarks/k_errors.py [--maxh 0.085 0.055] [--pairs P2/P1 P1/P1 P2/P0] [--tip modes|branch|none] [--verbose]

Cracks that are too short or too near for the mesh warn. Closed forms: (b), (c), (e), the open arc, cracks in the infinite plate in tension and compression, with and without friction.
Fitted: `shapes`, the loads A, B, C of the paper, C with friction, and a single edge crack. "True" is the larger of the errors of K_I and K_II.
"""

import argparse

import numpy as np
from closed_forms import ARC, arc_body
from fracture import PLATES, rectangle
from ngsolve import CF, ngsglobals
from results import recorded

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, TipEnrichment, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.exact import fracture_solutions as fs
from study.paper import FRICTION_REFERENCE, MATERIAL, PAIRS, REFERENCE, paper_problem, unstructured_mesh
from study.shapes import SHAPES, body_mesh, shape_problem

TIPS = {"modes": TipEnrichment(material=MATERIAL), "branch": TipEnrichment(functions="branch"), "none": None}
EDGE_CRACK = (8.05643, -0.02659)  # of `edge_crack`, by P4 and by P2 on fine meshes


def solved(mesh, crack, exact, pair, tip, law=None):
    """With the exact displacement on the boundary."""
    body, orders = CrackedMesh(mesh, crack), PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip, dirichlet="outer")
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL, law=law)
    problem.SetDirichlet(exact, "outer")
    return problem.Solve()


def closed(maxh, pair, tip, position=0):
    """(name, solution, tip number, K)."""
    angle, offset = cf.position(position)
    mesh, edge = cf.rotated_square(angle, offset, maxh), cf.crack_on_axis(cf.mouths(angle, offset)[0], 0)
    yield "(b)", solved(mesh, edge, cf.open_tip(MATERIAL).u, pair, tip), 0, (1, 0)
    yield "(c)", solved(mesh, edge, cf.slipping_tip(MATERIAL).u, pair, tip), 0, (0, 1)
    yield "(e)", solved(mesh, edge, cf.sliding_tip(MATERIAL, 0.3).u, pair, tip, Coulomb(0.3)), 0, (0, 1)
    yield "open arc", solved(*arc_body(position, maxh), ARC.Solution().u, pair, tip), 0, ARC.StressIntensity(1)
    for name, (*stresses, friction) in PLATES.items():
        plate = fs.infinite_plate(MATERIAL, 0.2, *stresses, friction)
        solution = solved(mesh, cf.crack_on_axis(-0.2, 0.2), plate.u, pair, tip, Coulomb(friction) if friction else None)
        for number in range(2):
            yield name, solution, number, (plate.K_I, plate.K_II)


def fitted(maxh, pair, tip):
    """The same."""
    for name, shape in SHAPES.items():
        solution = shape_problem(name, body_mesh(maxh), pair, tip=tip).Solve()
        for number, K in enumerate(shape.K):
            yield name, solution, number, K
    mesh = unstructured_mesh(maxh / 2)
    for load in "ABC":
        yield f"load {load}", paper_problem(mesh, load, pair, tip=tip).Solve(), 0, (REFERENCE[load]["K_I"], REFERENCE[load]["K_II"])
    yield "load C, friction", paper_problem(mesh, "C", pair, tip=tip, law=Coulomb(0.3)).Solve(), 0, (0, FRICTION_REFERENCE["C, Coulomb 0.3"]["K_II"])
    yield "edge crack", edge_crack(maxh, pair, tip), 0, EDGE_CRACK


def edge_crack(maxh, pair, tip):
    """A square of size 2 under σ_yy = 1."""
    body, orders = CrackedMesh(rectangle((-1, -1), (1, 1), maxh), Crack([(-1, 0.013), (0.2, 0.013)])), PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip)
    problem, v = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL), V.TestFunction()
    problem.f += CF((0, 1)) * v * body.ds("top") + CF((0, -1)) * v * body.ds("bottom")
    problem.Pin((1, -1), "xy")
    problem.Pin((1, 1), "x")
    return problem.Solve()


def summary(name, ratios):
    """ratios: said / true."""
    ratios = np.array(ratios)
    print(
        f"{name:22}{len(ratios):5} tips   covered {np.mean(ratios >= 1):6.1%}   median of said/true {np.median(ratios):5.2f}   worst true/said {1 / ratios.min():5.2f}",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maxh", type=float, nargs="+", default=[0.085, 0.055])
    parser.add_argument("--pairs", nargs="+", default=["P2/P1", "P1/P1", "P2/P0"])
    parser.add_argument("--tip", choices=TIPS, default="modes")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    ratios = {}
    for maxh in options.maxh:
        for pair in options.pairs:
            for kind, cases in (("closed forms", closed), ("fitted", fitted)):
                for name, solution, number, K in cases(maxh, pair, TIPS[options.tip]):
                    factors = solution.StressIntensity(number)
                    true = np.abs(np.subtract(tuple(factors), K)).max()
                    for group in (kind, pair, "all"):
                        ratios.setdefault(group, []).append(factors.error / true)
                    if options.verbose:
                        print(f"{name:24}{pair:7}{maxh:7}  tip {number}  true {true:.1e}  said {factors.error:.1e}", flush=True)
    for group, values in ratios.items():
        summary(group, values)


if __name__ == "__main__":
    recorded(main)
