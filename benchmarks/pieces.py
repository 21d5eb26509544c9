"""The half circle as an arc, as polylines and as a parametrised curve: processor seconds of set-up and solve, and the energy against the arc's.

python benchmarks/pieces.py
"""

import time
from math import cos, pi, sin

from netgen.geom2d import unit_square
from ngsolve import Mesh, SetNumThreads, x
from results import recorded

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace

MATERIAL = Elasticity.PlaneStrain(1e3, 0.3)


def point(angle):
    return 0.5 - 0.2 * cos(angle), 0.5 + 0.2 * sin(angle)


def polyline(n):
    return Crack([point(pi * i / (n - 1)) for i in range(n)])


def run(make, mesh):
    """(seconds, energy, pieces)."""
    start = time.process_time()
    crack = make()
    body = CrackedMesh(mesh, crack)
    V = CrackFESpace(body, order=2, tip=None, dirichlet="bottom", material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, nodes=body.MeshNodes(0, False)))
    problem.f += 100 * (x - 0.3) * V.TestFunction()[1] * body.ds("top")
    return problem.Solve().Energy(), time.process_time() - start, len(crack.pieces)


def main():
    SetNumThreads(1)
    mesh = Mesh(unit_square.GenerateMesh(maxh=0.06))
    shapes = {"arc": lambda: Crack.Arc((0.3, 0.5), (0.5, 0.7), (0.7, 0.5))}
    shapes |= {f"polyline of {n} points": lambda n=n: polyline(n) for n in (20, 200, 300, 10_000)}
    shapes |= {f"Curve, tolerance {t:g}": lambda t=t: Crack.Curve(point, 0, pi, tolerance=t) for t in (1e-5, 1e-7, 1e-9)}
    run(shapes["arc"], mesh)  # what is loaded once
    first = run(shapes["arc"], mesh)
    for name, make in shapes.items():
        energy, seconds, pieces = min((run(make, mesh) for _ in range(3)), key=lambda result: result[1])
        print(f"{name:26} {pieces:6} pieces  {seconds:6.3f} s ({seconds / first[1]:.1f} times the arc's)  energy {energy / first[0] - 1:+.1e}", flush=True)


if __name__ == "__main__":
    recorded(main)
