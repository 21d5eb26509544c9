"""The cases of cases.py as problems of the package, on meshes that ignore the arms."""

import numpy as np
from netgen.geom2d import SplineGeometry
from netgen.meshing import MeshingParameters
from ngsolve import CF, Mesh, specialcf

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace

from . import cases

MATERIAL = Elasticity.PlaneStrain(E=1, nu=0.3)


def star_problem(name, fine):
    """A case of cases.py on a mesh with elements of size `fine` beside the arms, a tenth of it where they meet: a corner of more than 180 degrees is singular there."""
    arms, load = cases.CASES[name]
    w = load.get("half_width", 1.0)
    geometry = SplineGeometry()
    geometry.AddRectangle((-w, -w), (w, w))
    parameters = MeshingParameters(maxh=0.25, grading=0.25)
    for a, b in arms:
        for t in np.linspace(0, 1, 40):
            parameters.RestrictH(a[0] + t * (b[0] - a[0]) + 0.0031, a[1] + t * (b[1] - a[1]) + 0.0017, 0, fine)
    parameters.RestrictH(0.0003, 0.0002, 0, fine / 10)
    ends = [end for _, end in arms]
    straight = len(arms) in (4, 6)
    cracks = [Crack([ends[k + len(arms) // 2], ends[k]]) for k in range(len(arms) // 2)] if straight else [Crack(list(arm)) for arm in arms]
    body = CrackedMesh(Mesh(geometry.GenerateMesh(mp=parameters)), *cracks)
    law = Coulomb(load["friction"]) if "friction" in load else None
    V = CrackFESpace(body, order=2, material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body, order=1), law=law)
    if "pressure" in load:
        problem.FacePressure(load["pressure"])
    else:
        stress = CF(tuple(np.ravel(load["sigma"]).astype(float)), dims=(2, 2))
        problem.f += (stress * specialcf.normal(2)) * V.TestFunction() * body.ds(".*")
    problem.Pin((-w, -w), "xy")
    problem.Pin((w, -w), "y")
    return problem, [int(np.argmin([np.hypot(*np.subtract(end, tip.point)) for end in ends])) for tip in body.tips]
