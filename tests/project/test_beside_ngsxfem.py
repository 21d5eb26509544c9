"""ngsxfem (`import xfem`), which this package is no part of, in one script with it."""

import subprocess
import sys
import tempfile

import pytest

SCRIPT = """
from netgen.geom2d import unit_square
from ngsolve import *
{imports}

mesh = Mesh(unit_square.GenerateMesh(maxh=0.1))


def area():
    level_set = GridFunction(H1(mesh, order=1))
    InterpolateToP1(sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2) - 0.3, level_set)
    return Integrate(levelset_domain={{"levelset": level_set, "domain_type": NEG}}, cf=CF(1), mesh=mesh, order=2)


def force():
    body = CrackedMesh(mesh, Crack([(0, 0.5), (0.5, 0.5)]))
    V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(E=210e3, nu=0.3), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, order=1))
    problem.f += CF((0, 100 * (x - 0.3))) * V.TestFunction() * body.ds("top")
    solution = problem.Solve()
    return [solution.ContactForce(), *solution.StressIntensity(tip=0), Integrate(solution.u[1] * body.dx, mesh)]


print({what})
"""
OURS, THEIRS = "from ngsxfem_contact import *", "from xfem import *"


def printed(imports, what):
    """The last line of a run of SCRIPT."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", SCRIPT.format(imports=imports, what=what)], capture_output=True, text=True, cwd=tempfile.gettempdir()
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]


@pytest.fixture(scope="module")
def alone():
    pytest.importorskip("xfem", reason="ngsxfem (`pip install xfem`), of the extra `test`, is not installed")
    return float(printed(THEIRS, "area()")), eval(printed(OURS, "force()"))


@pytest.mark.parametrize("imports", [f"{OURS}\n{THEIRS}", f"{THEIRS}\n{OURS}"], ids=["xfem last", "xfem first"])
def test_both_in_one_script(imports, alone):
    """Neither's star import hides a name of the other; each gives what it gives alone, before and after the other's work."""
    area, force = alone
    found = eval(printed(imports, "(area(), force(), area(), force())"))
    assert found == (area, pytest.approx(force, rel=1e-12), area, pytest.approx(force, rel=1e-12))


def test_no_name_is_in_both():
    xfem = pytest.importorskip("xfem", reason="ngsxfem (`pip install xfem`), of the extra `test`, is not installed")
    import ngsxfem_contact

    assert not set(ngsxfem_contact.__all__) & set(getattr(xfem, "__all__", dir(xfem)))
