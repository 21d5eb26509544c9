"""The compact tension specimen beside ASTM E399: K over a/W, and the opening of the mouth. python examples/compact_tension.py [folder]"""

from math import sqrt
from pathlib import Path
from sys import argv

import numpy as np
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.tables import Table

W, force, steel = 50, 1000, Elasticity.PlaneStrain(E=210e3, nu=0.3)  # mm, N/mm, MPa
RADIUS, HEIGHT = 0.125 * W, 0.275 * W  # of the holes, whose centres are on x = 0, the load line


def specimen():
    """1.25 W × 1.2 W with two holes; the ligament is on y = 0, the back at x = W."""
    outline = WorkPlane().MoveTo(-0.25 * W, -0.6 * W).Rectangle(1.25 * W, 1.2 * W).Face()
    for name, y_hole in (("upper", HEIGHT), ("lower", -HEIGHT)):
        hole = WorkPlane().Circle(0, y_hole, RADIUS).Face()
        hole.edges.name = name
        outline -= hole
    return Mesh(OCCGeometry(outline, dim=2).GenerateMesh(maxh=W / 40)).Curve(2)


def solve(mesh, a):
    """A crack from the notched side to x = a. The bolts press on the outer half of their holes, as the cosine of the angle to the load."""
    body = CrackedMesh(mesh, Crack([(-0.25 * W, 0), (a, 0)], name="crack"))
    V = CrackFESpace(body, order=2, material=steel)
    problem, v = ContactProblem(V, TraceSpace(body, order=1)), V.TestFunction()
    for name, sign in (("upper", 1), ("lower", -1)):
        cosine = sign * (y - sign * HEIGHT) / RADIUS
        pressure = IfPos(cosine, cosine, 0) * force / (RADIUS * pi / 2)
        problem.f += pressure * CF((x, y - sign * HEIGHT)) / RADIUS * v * body.ds(name, bonus_intorder=6)
    problem.Pin((W, -0.6 * W), "xy")
    problem.Pin((W, 0.6 * W), "x")
    return problem.Solve()


def astm(ratio):
    """K √W / P of ASTM E399, within 0.5 % for a/W ≥ 0.2, P the force per thickness."""
    return (2 + ratio) * np.polyval([-5.6, 14.72, -13.32, 4.64, 0.886], ratio) / (1 - ratio) ** 1.5


folder, mesh, rows = Path(*argv[1:] or ["results/compact_tension"]), specimen(), []
for ratio in (0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7):
    solution = solve(mesh, ratio * W)
    K, opening = solution.StressIntensity(tip=0), solution.Profile("crack").gap[0]
    rows.append({"a/W": ratio, "K_I": K.K_I, "error": K.error, "ASTM": force / sqrt(W) * astm(ratio), "opening": opening})
table = Table.OfRows(rows)
folder.mkdir(parents=True, exist_ok=True)
table.SaveCSV(folder / "compact_tension.csv")
print(table)
