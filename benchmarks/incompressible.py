"""Bodies under balanced tractions as ν → ½: K and λ must not depend on ν. Changes against ν = 0.3 on the same mesh.

python benchmarks/incompressible.py
"""

from math import hypot, pi, sqrt

import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh, SetNumThreads
from results import recorded

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, SolveError, TraceSpace

CASES = {"open": ((-0.4, -0.1), (0.4, 0.15), (0, 1)), "closed": ((-0.4, -0.1), (0.4, 0.15), (0, -1)), "steep, closed": ((-0.25, -0.31), (0.27, 0.3), (0.1, -1))}
RATIOS = (0.49, 0.499, 0.4999)


def answer(mesh, case, nu, order, bubble):
    start, end, traction = CASES[case]
    body = CrackedMesh(mesh, Crack([start, end]))
    V = CrackFESpace(body, order=order, material=Elasticity.PlaneStrain(E=1, nu=nu), bubble=bubble)
    problem, v = ContactProblem(V, TraceSpace(body, order=1)), V.TestFunction()
    problem.Pin((-1, -1), "xy"), problem.Pin((1, -1), "y")
    problem.f += CF(traction) * v * body.ds("top") - CF(traction) * v * body.ds("bottom")
    solution = problem.Solve()
    # by the integral over the largest disk, also where contact says that K_I = 0
    return np.array([solution.StressIntensity(tip).by_radius[0] for tip in (0, 1)]), solution.Profile(n=401).sigma_n


def change(mesh, case, nu, order, bubble):
    """K_I and K_II relative to σ√(πa), λ in L² relative to itself, in percent."""
    start, end, _ = CASES[case]
    unit = sqrt(pi * 0.5 * hypot(*np.subtract(end, start)))
    (K, pressure), (K0, pressure0) = answer(mesh, case, nu, order, bubble), answer(mesh, case, 0.3, order, bubble)
    size = np.linalg.norm(pressure0)
    return (*100 * np.abs(K - K0).max(axis=0) / unit, 100 * np.linalg.norm(pressure - pressure0) / size if size > 1e-9 else 0.0)


def main():
    SetNumThreads(1)
    geometry = SplineGeometry()
    geometry.AddRectangle((-1, -1), (1, 1), bcs=["bottom", "right", "top", "left"])
    mesh = Mesh(geometry.GenerateMesh(maxh=0.1))
    for case in CASES:
        for order, bubble in ((1, False), (2, False), (2, True), (3, True)):
            cells = []
            for nu in RATIOS:
                try:
                    cells.append("{:.2f} {:.2f} {:.1f}".format(*change(mesh, case, nu, order, bubble)))
                except SolveError as error:
                    cells.append(type(error).__name__)
            print(f"{case:14} P{order}{' + bubbles' if bubble else '          '}: " + " | ".join(cells), flush=True)


if __name__ == "__main__":
    recorded(main)
