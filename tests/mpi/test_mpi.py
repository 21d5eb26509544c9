"""Several processes under mpirun: of n > 1 processes n - 1 hold elements. What they find is compared with what one process finds."""

import ast
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
missing = [name for name, found in (("mpirun", shutil.which("mpirun")), ("mpi4py", importlib.util.find_spec("mpi4py"))) if not found]
needs_mpi = pytest.mark.skipif(bool(missing), reason=f"without {' and '.join(missing)}: apt-get install openmpi-bin; pip install mpi4py")

OPEN_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
}  # fmt: skip


def run(number, *arguments, seconds=120):
    """The CompletedProcess of `mpirun -n number python arguments`; processes that wait for ever are ended after some seconds."""
    command = ["timeout", str(seconds), "mpirun", "-n", str(number), sys.executable, "-W", "ignore", *map(str, arguments)]
    # with an input mpirun is stopped in the background; the folder of the sources holds a package that is not compiled
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, env=os.environ | OPEN_MPI, cwd=HERE)


def names_in(path):
    """The names in CASES = [...] of a script."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [name.id for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "CASES" for name in node.value.elts]


@needs_mpi
@pytest.mark.parametrize("number", [1, 3, 4])
@pytest.mark.parametrize("name", names_in(HERE / "cases.py"))
def test_case(name, number):
    done = run(number, HERE / "cases.py", name)
    assert (done.returncode, done.stdout.count("passed")) == (0, number), done.stdout + done.stderr


@needs_mpi
def test_an_error_of_one_process_ends_all():
    """At once: the others would wait until the timeout, whose return code is 124."""
    done = run(3, HERE / "cases.py", "an_error_of_one_process_ends_all", seconds=60)
    assert done.returncode not in (0, 124) and "of one process" in done.stderr


def solved(number, folder, script="solutions.py"):
    """{name: what this number of processes found} of the problems of a script, in one run."""
    done = run(number, HERE / script, folder, seconds=1200)
    assert done.returncode == 0, done.stdout + done.stderr
    return {path.stem: np.load(path) for path in sorted(folder.glob("*.npz"))}


EXACT = ("unknowns", "negligible", "counts", "active")
TOLERANCES = {
    "forms": 1e-13,
    "EE": 1e-13,
    "D": 1e-12,
    "S": 1e-11,
    "g": 1e-11,
    "energies": 1e-11,
    "tips": 1e-14,
    "reactions": 1e-10,
    "coercivity": 1e-7,
}  # others: 1e-9


# How much more than round-off of well-conditioned problems: of rubber another numbering of the mesh changes what one process finds by up to 4e-8 (S), 7e-7 (L) and
# 4e-5 (gap); with slivers S has a condition number of 2e6, and one ulp in each of its entries moves L by 1e-10; with P3
# the modes r^{5/2} are nearly polynomials in an element at a tip, so that its local eigenproblem knows γ, that is D, to 8e-12 only.
ROUND_OFF = {"incompressible_P2": 1e5, "slivers_P2": 10, "edge_P3": 10, "several_P3": 10}


def differences(one, many, factor=1.0):
    """What differs by more than it may, factor times more but for forms; each relative to its largest value, forms and energies one by one."""
    assert set(one) == set(many)
    for key in one:
        if key.startswith("cg "):
            continue  # beside direct solvers, below
        tolerance = TOLERANCES.get(key, 1e-9) * (1 if key == "forms" else factor)
        if key in (*EXACT, "supports", "words"):
            same = np.array_equal(one[key], many[key])
        elif key in ("forms", "energies"):
            same = many[key] == pytest.approx(one[key], rel=tolerance)
        else:
            same = np.abs(many[key] - one[key]).max(initial=0) <= tolerance * np.abs(one[key]).max(initial=0)
        if not same:
            yield key, one[key], many[key]


ITERATIVE = {"energies": 1e-10, "K": 1e-7, "L": 1e-7}


def inaccuracies(direct, found):
    """What conjugate gradients found otherwise than a direct solver of one process."""
    for key in (key for key in found if key.startswith("cg ")):
        exact, approximate = direct[key.removeprefix("cg ")], found[key]
        if key == "cg active":
            same = np.array_equal(exact[-1], approximate)
        elif key == "cg K":
            same = np.abs(approximate.ravel() - exact[..., :2].ravel()).max(initial=0) <= ITERATIVE["K"] * np.abs(exact).max(initial=0)
        else:
            same = np.abs(approximate - exact).max(initial=0) <= ITERATIVE.get(key.removeprefix("cg "), ITERATIVE["L"]) * np.abs(exact).max(initial=0)
        if not same:
            yield key, exact, approximate


def picture(path):
    """(points, displacements) of a .vtu file, in an order that does not depend on that of its cells."""
    content = path.read_bytes()
    head, data = content.split(b"<AppendedData", 1)
    number, data = int(re.search(rb'NumberOfPoints="(\d+)"', head)[1]), data[data.index(b"_") + 1 :]
    of = lambda name: int(re.search(rb'Name="%s" NumberOfComponents="3"[^>]*offset="(\d+)"' % name, head)[1])
    points, u = (np.frombuffer(data, "<f8", 3 * number, of(name) + 4).reshape(-1, 3) for name in (b"Points", b"displacement"))
    order = np.lexsort([*np.round(u, 12).T, *np.round(points, 12).T])
    return points[order], u[order]


@needs_mpi
def test_as_one_process(tmp_path):
    """Forms, active sets, negligible functions, pressures, energies, K, reactions and pictures of 3 and 4 processes are those of one."""
    folders = {number: tmp_path / str(number) for number in (1, 3, 4)}
    for folder in folders.values():
        folder.mkdir()
    found = {number: solved(number, folder) for number, folder in folders.items()}
    one = found[1]
    assert all({"L", "K", "released", "gap", *EXACT, *TOLERANCES} - {"coercivity"} <= set(facts) for name, facts in one.items() if "_P" in name)
    assert len(one) > 15 and one["slivers_P2"]["negligible"] > 0
    contact, _, right, left = one["slip_P2"]["counts"]
    assert contact > 3 and right + left > 3
    assert all(0 < one[name]["active"][-1].sum() for name in ("edge_P1", "several_P3", "crossing_P2", "arc_P2", "through_P2", "regions_P2"))
    assert [what for name in one for what in inaccuracies(one[name], one[name])] == [] and sum("cg L" in facts for facts in one.values()) > (
        20 if importlib.util.find_spec("pyamg") else -1
    )
    for number in (3, 4):
        assert found[number].keys() == one.keys()
        assert [(number, name, *what) for name in one for what in differences(one[name], found[number][name], ROUND_OFF.get(name, 1.0))] == []
        assert [(number, name, *what) for name in one for what in inaccuracies(one[name], found[number][name])] == []
        (points, u), (points_too, u_too) = picture(folders[1] / "body.vtu"), picture(folders[number] / "body.vtu")
        assert points_too == pytest.approx(points, abs=1e-14) and u_too == pytest.approx(u, abs=1e-9 * np.abs(u).max())


GO_ON = 1e-9  # relative: what is solved for again, by another number of processes


def off(before, after):
    """The largest difference, relative to the largest value; of forces of supports and K each with all others."""
    return {key: np.abs(after[key] - before[key]).max(initial=0) / np.abs(before[key]).max(initial=1e-300) for key in before}


@needs_mpi
def test_saved_solutions_are_read_by_other_numbers_of_processes(tmp_path):
    """What is read is what was saved, and load steps, paths and growth go on: a file of three processes is read by one and four, that of one by three."""
    for number, readers in ((3, (1, 4)), (1, (3,))):
        folder = tmp_path / str(number)
        folder.mkdir()
        done = run(number, HERE / "saved.py", "save", folder)
        assert done.returncode == 0, done.stdout + done.stderr
        assert {path.suffix for path in folder.iterdir()} == {".npz", ".solution"}
        for reader in readers:
            done = run(reader, HERE / "saved.py", "load", folder, reader)
            assert done.returncode == 0, done.stdout + done.stderr
            for case in names_in(HERE / "saved.py"):
                before, after = np.load(folder / f"{case}.npz"), np.load(folder / f"{case}.{reader}.npz")
                assert set(before) == set(after) and np.abs(before["energies"]).max() > 0
                worst = {
                    (number, reader, case, key): value
                    for key, value in off(before, after).items()
                    if not value <= (GO_ON if " " in key or key == "grown" else 2e-12)
                }
                assert worst == {}


@needs_mpi
def test_bodies_in_space_as_one_process(tmp_path):
    """The same in space, and the number of tetrahedra of the file."""
    folders = {number: tmp_path / str(number) for number in (1, 3, 4)}
    for folder in folders.values():
        folder.mkdir()
    found = {number: solved(number, folder, "solids.py") for number, folder in folders.items()}
    one = found[1]
    assert len(one) == 11 and "K" in one["edge"]
    assert all(0 < one[name]["active"].sum() < len(one[name]["active"]) for name in ("bent", "slip", "along_faces", "regions", "curved"))
    assert {"stick", "slip"} <= set(one["slip"]["words"])
    cells = {number: re.search(rb'NumberOfCells="(\d+)"', (folder / "solid.vtu").read_bytes())[1] for number, folder in folders.items()}
    assert len(set(cells.values())) == 1
    for number in (3, 4):
        assert found[number].keys() == one.keys()
        assert [(number, name, *what) for name in one for what in differences(one[name], found[number][name])] == []


SERIAL = """
from netgen.geom2d import unit_square
from ngsolve import Mesh
from ngsxfem_contact import Crack, CrackedMesh
CrackedMesh(Mesh(unit_square.GenerateMesh(maxh=0.3)), Crack([(0.3, 0.5), (0.7, 0.5)]))
print("made")
"""


@pytest.mark.skipif(not shutil.which("mpirun"), reason="without mpirun: apt-get install openmpi-bin")
@pytest.mark.parametrize("number", [1, 3])
def test_a_script_that_shares_no_mesh_is_refused(number):
    """Also one that imports neither MPI nor mpi4py: it would solve everything three times."""
    done = run(number, "-c", SERIAL)
    if number == 1:
        assert done.returncode == 0 and done.stdout.split() == ["made"]
    else:
        assert done.returncode != 0 and "made" not in done.stdout
        assert "one of 3 processes" in done.stderr and "DistributedMesh" in done.stderr


def test_one_process_needs_no_mpi():
    """Nothing of it is imported, and DistributedMesh is Mesh(make())."""
    script = SERIAL + (
        "from ngsxfem_contact.processes import DistributedMesh\nimport sys\n"
        "assert DistributedMesh(lambda: unit_square.GenerateMesh(maxh=0.3)).nv == Mesh(unit_square.GenerateMesh(maxh=0.3)).nv\n"
        "assert not {'mpi4py', 'petsc4py', 'ngspetsc'} & {name.partition('.')[0] for name in sys.modules}\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True, timeout=120, cwd=HERE)
