"""A plate with a hole and two cracks, from a STEP file to K over the length, as CSV and as a report: python examples/plate_study.py [folder]"""

from math import pi, sqrt
from pathlib import Path
from sys import argv

import matplotlib.pyplot as plt
from netgen.occ import OCCGeometry, Y, Z
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.plotting import plot_body
from ngsxfem_contact.tables import Table

folder, sigma, steel = Path(*argv[1:] or ["results/plate"]), 100, Elasticity.PlaneStress(E=210e3, nu=0.3)  # MPa
face = OCCGeometry(str(Path(__file__).with_name("plate.step"))).shape.Move((0, 0, -5)).faces.Max(Z)  # the body: a face of the solid
hole, face.edges.Max(Y).name, face.edges.Min(Y).name = face.edges.Nearest((10, 0, 0)), "top", "bottom"  # a point picks an edge
hole.maxh = 0.5
mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=20, grading=0.1)).Curve(3)


def solve(a):
    """Two cracks of length a start at the points of the hole at 0° and 180°; top and bottom are pulled."""
    cracks = [Crack([(p.x, p.y), (p.x * (1 + a / 10), p.y)]) for p in map(hole.Value, (0, pi))]
    V = CrackFESpace(CrackedMesh(mesh, *cracks), order=2, material=steel)
    problem, v = ContactProblem(V, TraceSpace(V.body, order=1)), V.TestFunction()
    problem.f += CF((0, sigma)) * v * V.body.ds("top") - CF((0, sigma)) * v * V.body.ds("bottom")
    problem.Pin((-200, -200), "xy"), problem.Pin((200, -200), "y")
    return problem.Solve()


folder.mkdir(parents=True, exist_ok=True)
solutions = {a: solve(a) for a in (4, 6, 8, 12, 16)}
factors = {a: solution.StressIntensity(tip=0) for a, solution in solutions.items()}
table = Table.OfRows([{"a": a, "K_I": K.K_I, "error": K.error, "F": K.K_I / (sigma * sqrt(pi * a))} for a, K in factors.items()])
table.SaveCSV(folder / "K.csv")
body, curve = plot_body(solutions[16], field=solutions[16].stress[1, 1], label="σ_yy [MPa]"), plt.subplots(layout="constrained")[1]
curve.errorbar(table.a, table.K_I, table.error, marker="o", capsize=3)
body.set(xlim=(-60, 60), ylim=(-40, 60)), curve.set(xlabel="a [mm]", ylabel="K_I [MPa √mm]", title=f"tension of {sigma} MPa")
body.figure.savefig(folder / "body.png", bbox_inches="tight"), curve.figure.savefig(folder / "K.png")
(folder / "report.html").write_text(f'<h1>Hole with two cracks</h1>{table._repr_html_()}<img src="K.png"> <img src="body.png">')
