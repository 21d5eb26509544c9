"""`import ngsxfem_contact` stays light beside NGSolve: what is heavy is loaded by what needs it."""

import json
import subprocess
import sys
import tempfile

HEAVY = ["scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse", "scipy.spatial", "scipy.special"]
NOT_OURS = ["matplotlib", "tqdm", "IPython", "ipywidgets", "pandas", "mpmath", "ngsolve.webgui", "mpi4py", "petsc4py"]


def loaded_by(*statements):
    """The modules that Python has loaded after each of the statements, in a process of its own."""
    script = "import json, sys\n" + "\n".join(f"{statement}\nprint(json.dumps(sorted(sys.modules)))" for statement in statements)
    lines = subprocess.run(
        [sys.executable, "-c", script], check=True, capture_output=True, text=True, timeout=120, cwd=tempfile.gettempdir()
    ).stdout.splitlines()
    return [set(json.loads(line)) for line in lines if line.startswith("[")]


def test_nothing_heavy_is_imported():
    ngsolve, package, spline = loaded_by("import ngsolve", "import ngsxfem_contact", "ngsxfem_contact.Crack.Spline([(0, 0), (1, 0.1), (2, 0)])")
    assert "ngsxfem_contact._ngsxfem_contact" in package
    assert set(HEAVY + NOT_OURS) & (package - ngsolve) == set()
    assert set(HEAVY) & spline >= {"scipy.interpolate", "scipy.linalg"}  # what is loaded is seen here
