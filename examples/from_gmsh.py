"""A mesh of gmsh, or of another mesher by meshio: two materials, a crack that friction holds. python examples/from_gmsh.py [mesh [folder]]"""

from pathlib import Path
from sys import argv

from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.job.gmsh import read_gmsh

source, folder = (*map(Path, argv[1:]), *[Path(__file__).parents[1] / "tests/data/gmsh/layered-4.1.msh", Path("results/gmsh")][len(argv) - 1 :])
folder.mkdir(parents=True, exist_ok=True)
if source.suffix != ".msh":
    import meshio  # it knows forty formats; names stay where they are groups of gmsh

    meshio.read(source).write(folder / "converted.msh", file_format="gmsh22", binary=False)
    source = folder / "converted.msh"
mesh = Mesh(read_gmsh(source))  # text of format 2.2 or 4.1
print("regions:", mesh.GetMaterials(), "boundaries:", mesh.GetBoundaries())

materials = {"matrix": Elasticity.PlaneStrain(E=30e3, nu=0.2), "layer": Elasticity.PlaneStrain(E=60e3, nu=0.25)}
body = CrackedMesh(mesh, Crack([(0, 0.41), (0.4, 0.43)], name="joint"))
V = CrackFESpace(body, order=2, material=Elasticity.ByRegion(mesh, materials), dirichlet="bottom")
problem, v = ContactProblem(V, TraceSpace(body, order=1), law=Coulomb(0.3)), V.TestFunction()
problem.f += CF((5, -20)) * v * body.ds("top")
solution = problem.Solve()
solution.Profile("joint").SaveCSV(folder / "joint.csv")
solution.SaveVTK(folder / "joint.vtu")
print(solution.Table())
