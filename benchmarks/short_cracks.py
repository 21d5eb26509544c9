"""The largest opening of cracks of three elements and less under tension, relative to that of P2/P1 on 71 × 71 squares.

python benchmarks/short_cracks.py
"""

import warnings

from ngsolve import SetNumThreads, x, y
from ngsolve.meshes import MakeStructured2DMesh
from results import recorded

from ngsxfem_contact import AccuracyWarning, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace

MATERIAL = Elasticity(lam=1, mu=1)
SHAPES = {"segment": Crack([(0.4, 0.44), (0.48, 0.44)]), "arc": Crack.Arc((0.4, 0.44), (0.44, 0.455), (0.48, 0.44))}
PAIRS = {"P1/P0": (1, 0), "P1/P1": (1, 1), "P2/P1": (2, 1)}
SQUARES, FINE = (3, 6, 9, 12, 18, 24, 36), 71


def opening(crack, n, order, multiplier_order):
    """Of the unit square with n × n squares of two triangles, stretched by a tenth."""
    body = CrackedMesh(MakeStructured2DMesh(quads=False, nx=n, ny=n), crack)
    V = CrackFESpace(body, order=order, tip=TipEnrichment(material=MATERIAL), dirichlet=".*")
    problem = ContactProblem(V, TraceSpace(body, order=multiplier_order), MATERIAL)
    problem.SetDirichlet((0.1 * x, 0.1 * y), ".*")
    return problem.Solve().Profile(n=401).gap.max()


def main():
    SetNumThreads(1)
    warnings.simplefilter("ignore", AccuracyWarning)
    print(f"{'shape':10}{'length / edge':>13}" + "".join(f"{pair:>8}" for pair in PAIRS))
    for name, crack in SHAPES.items():
        exact = opening(crack, FINE, *PAIRS["P2/P1"])
        for n in SQUARES:
            cells = "".join(f"{opening(crack, n, *orders) / exact:8.2f}" for pair, orders in PAIRS.items())
            print(f"{name:10}{crack.length * n:13.2f}{cells}", flush=True)


if __name__ == "__main__":
    recorded(main)
