"""Three-point bending of a notched concrete beam, down the softening branch: load over deflection. python examples/load_displacement.py [folder]"""

from pathlib import Path
from sys import argv

import matplotlib.pyplot as plt
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.contact import ExponentialCohesive, PathSteps
from ngsxfem_contact.tables import Table

SPAN, DEPTH, NOTCH, SAW, PLATE = 400, 100, 30, 4, 20  # mm; the saw's width, and the length over which the load acts
folder, concrete = Path(*argv[1:] or ["results/beam"]), Elasticity.PlaneStress(E=30e3, nu=0.2)  # MPa
beam = WorkPlane().MoveTo(-SPAN / 2, 0).LineTo(-SAW / 2, 0).LineTo(-SAW / 2, NOTCH).LineTo(SAW / 2, NOTCH).LineTo(SAW / 2, 0).LineTo(SPAN / 2, 0)
beam = beam.LineTo(SPAN / 2, DEPTH).LineTo(PLATE / 2, DEPTH).LineTo(-PLATE / 2, DEPTH, name="plate").LineTo(-SPAN / 2, DEPTH).Close().Face()
mesh = Mesh(OCCGeometry(beam, dim=2).GenerateMesh(maxh=5))

body = CrackedMesh(mesh, Crack([(0.7, NOTCH), (0.7, DEPTH)], name="ligament"))  # from the root of the notch to the top
V = CrackFESpace(body, order=2, material=concrete)
law = ExponentialCohesive(strength=3, G_c=0.08)  # MPa, N/mm
problem, v = ContactProblem(V, TraceSpace(body, order=0), law=law), V.TestFunction()
problem.f += CF((0, -1 / PLATE)) * v * body.ds("plate")  # a force of 1 N/mm
problem.Pin((-SPAN / 2, 0), "xy")
problem.Pin((SPAN / 2, 0), "y")

steps, rows = PathSteps(problem), []
for _ in range(60):
    solution = steps.Solve(0.005)  # the faces give way by 0.005 mm more
    deflection = -Integrate(solution.u[1] * body.ds("plate"), mesh) / PLATE
    rows.append({"deflection": deflection, "force": steps.t, "opening": solution.Profile("ligament").gap[0], "dissipated": solution.DissipatedEnergy()})
    if steps.t < 0.1 * max(row["force"] for row in rows):
        break
table = Table.OfRows(rows)
folder.mkdir(parents=True, exist_ok=True)
table.SaveCSV(folder / "beam.csv")
axes = plt.subplots(layout="constrained")[1]
axes.plot([0, *table.deflection], [0, *table.force], marker=".")
axes.set(xlabel="deflection [mm]", ylabel="force / thickness [N/mm]")
axes.figure.savefig(folder / "beam.png")
print(table)
