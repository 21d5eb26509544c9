"""K along the front of a half-elliptical surface crack in a plate under tension, beside Newman and Raju's formula.

    python benchmarks/surface_crack.py [--order 2] [--per-depth 5 8]

A plate of thickness t = 1, width 2b = 4 and height 4 under σ = 1 at its ends; the crack has the depth a and the half length c at the surface. J. C. Newman and I. S. Raju (Eng. Fract. Mech. 15 (1981) 185-192)
fitted K = σ √(πa/Q) F(a/t, a/c, c/b, φ) to finite elements and say 5 %. φ is the parametric angle, 0 at the surface, 90° at the deepest point; where the front meets the surface K is not defined, and its
last nodes lie as far inside as discs normal to the front have room. "nodes" are those from 20° on; the mesh has edges of a / per-depth around the crack.
"""

import argparse
import warnings
from time import perf_counter

import numpy as np
from netgen.occ import Box, Glue, OCCGeometry, Pnt, Z
from ngsolve import CF, Mesh, SetNumThreads, ngsglobals
from results import recorded

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.geometry import Sheet

MATERIAL = Elasticity.Solid(E=2.5, nu=0.3)
WIDTH, HEIGHT = 2.0, 2.0  # halves; the thickness is 1
SHAPES = ((0.2, 0.2), (0.2, 0.4), (0.4, 0.4), (0.4, 0.8))


def newman_raju(a, c, phi):
    """K / σ in √length."""
    ratio, depth = a / c, a  # t = 1
    Q = 1 + 1.464 * ratio**1.65
    M1, M2 = 1.13 - 0.09 * ratio, -0.54 + 0.89 / (0.2 + ratio)
    M3 = 0.5 - 1 / (0.65 + ratio) + 14 * (1 - ratio) ** 24
    g = 1 + (0.1 + 0.35 * depth**2) * (1 - np.sin(phi)) ** 2
    f_phi = (ratio**2 * np.cos(phi) ** 2 + np.sin(phi) ** 2) ** 0.25
    f_w = np.cos(np.pi * c / (2 * WIDTH) * np.sqrt(depth)) ** -0.5
    return np.sqrt(np.pi * a / Q) * (M1 + M2 * depth**2 + M3 * depth**4) * f_phi * g * f_w


def plate(a, c, h):
    """Elements of h around the crack in z = 0 with its mouth on y = 0, 0.4 far away."""
    far = Box(Pnt(-WIDTH, 0, -HEIGHT), Pnt(WIDTH, 1, HEIGHT))
    for face in far.faces:
        face.name = "side"
    far.faces.Min(Z).name, far.faces.Max(Z).name = "bottom", "top"
    far.maxh = 0.4
    near = Box(Pnt(-c - 2 * h, 0, -2 * h), Pnt(c + 2 * h, a + 2 * h, 2 * h))
    near.maxh = h
    return Mesh(OCCGeometry(Glue([far - near, near])).GenerateMesh(maxh=0.4, grading=0.4))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--order", type=int, default=2)
    parser.add_argument("--per-depth", type=float, nargs="+", default=[5])
    options = parser.parse_args()
    ngsglobals.msg_level = 0
    SetNumThreads(1)
    warnings.simplefilter("ignore")
    print("   a/t   a/c  a/h       N    nodes  deviation: worst   mean  deepest  reported error   seconds")
    for a, c in SHAPES:
        for per_depth in options.per_depth:
            start = perf_counter()
            body = CrackedMesh(plate(a, c, a / per_depth), Sheet.Ellipse((0, 0, 0.0123 * a), (c, 0, 0), (0, a, 0)))
            V = CrackFESpace(body, order=options.order, material=MATERIAL, dirichletz="bottom")
            problem = ContactProblem(V, TraceSpace(body))
            problem.f += CF((0, 0, 1)) * V.TestFunction() * body.ds("top")
            problem.Pin((-WIDTH, 0, -HEIGHT), "xy")
            problem.Pin((WIDTH, 0, -HEIGHT), "y")
            found = problem.Solve().StressIntensity()
            phi = np.arctan2(found.points[:, 1] / a, np.abs(found.points[:, 0]) / c)
            inside = phi > np.radians(20)
            exact = newman_raju(a, c, phi)
            deviation = (found.K_I / exact - 1)[inside]
            deepest = (found.K_I / exact - 1)[np.argmax(phi)]
            print(
                f"{a:6}{a / c:6.2f}{per_depth:5.0f}{V.ndof:8}{inside.sum():9}{100 * np.abs(deviation).max():17.2f}%{100 * deviation.mean():6.2f}%{100 * deepest:8.2f}%"
                f"{100 * (found.errors[:, 0] / exact)[inside].max():15.2f}%{perf_counter() - start:10.0f}",
                flush=True,
            )


if __name__ == "__main__":
    recorded(main)
