"""A crack at the fillet of a bracket, from a STEP file; it grows under the load on the leg. python examples/bracket_growth.py [folder]"""

from pathlib import Path
from sys import argv

import numpy as np
from netgen.occ import OCCGeometry, X, Y, Z
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.plotting import plot_body

folder, steel = Path(*argv[1:] or ["results/bracket"]), Elasticity.PlaneStress(E=210e3, nu=0.3)  # mm, MPa
solid = OCCGeometry(str(Path(__file__).with_name("bracket.step"))).shape
face = solid.Move((0, 0, -8)).faces.Max(Z)  # the upper face of the solid, brought to z = 0, is the body
fillet = face.edges.Nearest((23, 23, 0))  # a point beside an edge picks it
face.edges.Max(Y).name, face.edges.Max(X).name = "top", "end"
mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.9)).Curve(2)


def mouth_on(edge, part=0.5):
    """A point of an edge of the CAD part, after this part of it, and the unit normal that leads into the body there."""
    begin, end = edge.parameter_interval
    point, tangent = (np.array([p.x, p.y]) for p in (f(begin + part * (end - begin)) for f in (edge.Value, edge.Tangent)))
    normal = np.array([-tangent[1], tangent[0]]) / np.linalg.norm(tangent)
    return point, normal if mesh.Contains(*(point + 0.1 * normal)) else -normal


def bent(cracks):
    """The bracket hangs on its upper end; the free end is pulled down with 3 MPa."""
    body = CrackedMesh(mesh, *cracks)
    V = CrackFESpace(body, order=2, material=steel, dirichlet="top")
    problem, v = ContactProblem(V, TraceSpace(body, order=1)), V.TestFunction()
    problem.f += CF((0, -3)) * v * body.ds("end")
    return problem


point, inward = mouth_on(fillet)
start = Crack([tuple(point - 0.5 * inward), tuple(point + 5 * inward)], name="fillet")  # a little too long: what is outside is cut off
growth = CrackGrowth(bent, [start], GivenIncrement(4))
growth.Run(steps=4)
folder.mkdir(parents=True, exist_ok=True)
growth.table.SaveCSV(folder / "growth.csv")
plot_body(growth.solutions[-1], label="von Mises [MPa]").figure.savefig(folder / "bracket.png", dpi=150)
print(growth)
