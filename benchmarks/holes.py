"""Two cracks from a circular hole in a wide plate, mouths on the circle: F = K_I/(σ√(πa)) at eight angles of the pair.

python benchmarks/holes.py

R = 10, a = 6, plate 400 × 400, unit tension across the cracks. Reference: F = 1.7476, boundary-fitted, order 7, graded.
"""

from math import cos, hypot, pi, radians, sin, sqrt

from netgen.occ import Axis, Circle, OCCGeometry, Rectangle, X, Y, Z
from ngsolve import CF, Mesh, SetNumThreads, specialcf
from results import recorded

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace

R, L, A, REFERENCE = 10, 200, 6, 1.7476
STEEL = Elasticity.PlaneStress(E=210e3, nu=0.3)


def plate(h, grading, curved):
    """With elements of size h on the hole, whose edges are chords, or curves of degree 2."""
    shape = Rectangle(2 * L, 2 * L).Face().Move((-L, -L, 0)) - Circle((0, 0), R).Face().Rotate(Axis((0, 0, 0), Z), 37)
    shape.edges.name = "hole"
    for edge, name in ((shape.edges.Min(X), "left"), (shape.edges.Max(X), "right"), (shape.edges.Min(Y), "bottom"), (shape.edges.Max(Y), "top")):
        edge.name = name
    for edge in shape.edges:
        if edge.name == "hole":
            edge.maxh = h
    mesh = Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=15, grading=grading))
    return mesh.Curve(2) if curved else mesh


def deviations(mesh, degrees, order):
    """F / 1.7476 - 1 at the two tips."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    body = CrackedMesh(mesh, *(Crack([(sign * R * c, sign * R * s), (sign * (R + A) * c, sign * (R + A) * s)]) for sign in (1, -1)))
    V = CrackFESpace(body, order=order, material=STEEL)
    problem = ContactProblem(V, TraceSpace(body, order=1))
    stress = CF((s * s, -s * c, -s * c, c * c), dims=(2, 2))
    problem.f += stress * specialcf.normal(2) * V.TestFunction() * body.ds("left|right|top|bottom")
    problem.Pin((-L, -L), "xy"), problem.Pin((L, -L), "y")
    solution = problem.Solve()
    ends = [i for i, tip in enumerate(body.tips) if hypot(*tip.point) > R + A - 1e-6]
    return [solution.StressIntensity(i).K_I / sqrt(pi * A) / REFERENCE - 1 for i in ends]


def main():
    SetNumThreads(1)
    for order, h, grading in ((2, 1, 0.15), (2, 1, 0.05), (2, 0.6, 0.05), (3, 1, 0.15)):
        for curved in (False, True):
            mesh = plate(h, grading, curved)
            off = [100 * d for k in range(8) for d in deviations(mesh, 11 + 22.5 * k, order)]
            print(
                f"P{order}, h = {h}, grading {grading}, {'curved' if curved else 'chords'}, {mesh.ne} triangles: {min(off):.2f} to {max(off):.2f} %", flush=True
            )


if __name__ == "__main__":
    recorded(main)
