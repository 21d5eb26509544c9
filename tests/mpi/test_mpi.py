"""The cases of cases.py, each under mpirun with 1, 3 and 4 processes: of n > 1 processes n - 1 hold elements."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CASES = Path(__file__).with_name("cases.py")
NAMES = re.findall(r"^CASES = \[(.*)\]$", CASES.read_text(encoding="utf-8"), re.M)[0].split(", ")
missing = [name for name, found in (("mpirun", shutil.which("mpirun")), ("mpi4py", importlib.util.find_spec("mpi4py"))) if not found]
needs_mpi = pytest.mark.skipif(bool(missing), reason=f"without {' and '.join(missing)}: apt-get install openmpi-bin; pip install mpi4py")

OPEN_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
}  # fmt: skip


def run(number, *arguments, seconds=120):
    """The CompletedProcess of `mpirun -n number python arguments`; a process that waits for ever ends it after some seconds."""
    command = ["timeout", str(seconds), "mpirun", "-n", str(number), sys.executable, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=os.environ | OPEN_MPI)


@needs_mpi
@pytest.mark.parametrize("number", [1, 3, 4])
@pytest.mark.parametrize("name", NAMES)
def test_case(name, number):
    done = run(number, CASES, name)
    assert (done.returncode, done.stdout.count("passed")) == (0, number), done.stdout + done.stderr


SERIAL = """
from netgen.geom2d import unit_square
from ngsolve import Mesh
from ngsxfem_contact import Crack, CrackedMesh
CrackedMesh(Mesh(unit_square.GenerateMesh(maxh=0.3)), Crack([(0.3, 0.5), (0.7, 0.5)]))
print("made")
"""


@pytest.mark.skipif(not shutil.which("mpirun"), reason="without mpirun: apt-get install openmpi-bin")
@pytest.mark.parametrize("number", [1, 3])
def test_a_script_under_several_processes_is_refused(number):
    """Also one that imports neither MPI nor mpi4py: it would solve everything three times."""
    done = run(number, "-c", SERIAL)
    if number == 1:
        assert done.returncode == 0 and done.stdout.split() == ["made"]
    else:
        assert done.returncode != 0 and "made" not in done.stdout
        assert "one of 3 processes" in done.stderr and "without mpirun" in done.stderr


def test_one_process_needs_no_mpi():
    """Nothing of it is imported, and DistributedMesh is Mesh(make())."""
    script = SERIAL + (
        "from ngsxfem_contact.processes import DistributedMesh\nimport sys\n"
        "assert DistributedMesh(lambda: unit_square.GenerateMesh(maxh=0.3)).nv == Mesh(unit_square.GenerateMesh(maxh=0.3)).nv\n"
        "assert not {'mpi4py', 'petsc4py', 'ngspetsc'} & {name.partition('.')[0] for name in sys.modules}\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True, timeout=120)
