# %% [markdown]
# # 9. Many processes
#
# Where a mesh is too large for one process, or the factorisation takes too long, `mpirun` starts the same script several times, and each process holds a part of the mesh. This tutorial writes such a script,
# runs it here in one process, and in three processes where OpenMPI and mpi4py are installed:
#
#     sudo apt-get install openmpi-bin
#     pip install "ngsxfem_contact[mpi,space]"   # space: pyamg, for conjugate gradients
#
# ## The script
#
# One line differs from the scripts of the other tutorials: the mesh is made by `DistributedMesh(make)` in the place of `Mesh(make())`. One process calls `make`; each gets its part.

# %%
from pathlib import Path

script = Path("many.py")
_ = script.write_text('''
import sys

from netgen.geom2d import unit_square
from ngsolve import CF, Integrate
from ngsxfem_contact import *
from ngsxfem_contact.plotting import plot_body
from ngsxfem_contact.processes import DistributedMesh

mesh = DistributedMesh(lambda: unit_square.GenerateMesh(maxh=0.04))
body = CrackedMesh(mesh, Crack([(0.3, 0.45), (0.7, 0.55)]))
V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(E=210e3, nu=0.3), dirichlet="bottom")
problem = ContactProblem(V, TraceSpace(body, order=1), law=Coulomb(0.1))
problem.f += CF((30, -100)) * V.TestFunction() * body.ds("top")
solution = problem.Solve(inverse=sys.argv[1] if len(sys.argv) > 1 else None)

factors, force, energy = solution.StressIntensity(tip=1), solution.ContactForce(), solution.Energy()
figure = plot_body(solution, label="von Mises [MPa]")
solution.SaveVTK("many.vtu")
share = body.share
area = share.Sum(Integrate(share.Own(CF(1) * body.dx), body.mesh))
held = share.Gather(int(share.own.sum()) if share.several else body.mesh.ne)
if share.is_first:
    figure.figure.savefig("many.png", dpi=110)
    print(solution.report.inverse, "on", len(held), "process(es) with", held, "elements of their own, area", round(area, 12))
    print(f"force {force:.10e}, energy {energy:.10e}, K_II {factors.K_II:.8e}")
''', encoding="utf-8")  # fmt: skip

# %% [markdown]
# All methods are called on all processes and return the same everywhere; pictures are drawn and files written by the first process, so that `plot_body` returns None on others. What a process may not do alone is
# to call a method that the others do not call: they wait for each other.
#
# `body.mesh` is the mesh of one process: its own elements, and those beside cracks and boundary, which all hold. Integrals of yours over the body are sums of own parts, `share.Sum(Integrate(share.Own(f * body.dx), body.mesh))`.
#
# ## One process, and three

# %%
import importlib.util
import os
import shutil
import subprocess
import sys


def run(*command):
    """What a command prints."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg", "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}
    environment |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"} if os.getuid() == 0 else {}  # in a container
    done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


found = [run(sys.executable, str(script))]
print("python many.py\n" + found[0])
if shutil.which("mpirun") and importlib.util.find_spec("mpi4py"):
    found.append(run("mpirun", "-n", "3", sys.executable, str(script)))
    print("mpirun -n 3 python many.py\n" + found[1])
    if importlib.util.find_spec("pyamg"):
        found.append(run("mpirun", "-n", "3", sys.executable, str(script), "cg"))
        print("mpirun -n 3 python many.py cg\n" + found[2])
else:
    print("mpirun -n 3 python many.py needs OpenMPI and mpi4py, which are not installed here")

# %% [markdown]
# NGSolve leaves the first process without elements: three processes are two that work. Each eliminates the unknowns that it shares with nobody; what is left between processes is a dense matrix, which all factorise. So this
# is for some ten processes and some million unknowns: the [figures](../measured) have a model of what each does, holds and sends. `Solve(inverse="cg")` does without that matrix, by conjugate gradients; it is chosen where the matrix would be too large.
#
# The picture that the first process drew:

# %%
import matplotlib.pyplot as plt

plt.figure(figsize=(6, 5), layout="constrained")
plt.imshow(plt.imread("many.png"))
plt.axis("off")
plt.show()

# %% [markdown]
# ## Check
#
# The number of processes changes nothing but round-off.

# %%
import re

numbers = [[float(value) for value in re.findall(r"(?:force|energy|K_II) (\S+?)(?:,|\s)", text)] for text in found]
difference = max(abs(a - b) / abs(b) for values in numbers for a, b in zip(values, numbers[0], strict=True))
print(f"{len(found)} run(s), largest relative difference {difference:.0e}")
assert all(len(values) == 3 for values in numbers) and difference < 1e-8 and numbers[0][0] < 0
