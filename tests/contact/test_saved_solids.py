"""solution.Save and ContactSolution.Load of bodies in space: what was solved goes on in another process as it would have here."""

import json
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from ngsolve import CF, H1, Interpolate, Mesh, Parameter, specialcf, x, z
from ngsolve.meshes import MakeStructured3DMesh
from saved_cases import same

from ngsxfem_contact import ContactProblem, ContactSolution, Coulomb, CrackedMesh, CrackFESpace, Elasticity, Jump, LoadSteps, TraceSpace, Tresca
from ngsxfem_contact.errors import NotSaved
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.plotting import plot_profile

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
DISK = Sheet.Disk((0.49, 0.51, 0.513), (0, 0.1, 1), 0.4)


def structured():
    return MakeStructured3DMesh(hexes=False, nx=3, ny=3, nz=3)


def half(height):
    return Sheet.Polygon([(-1, -1, height), (0.6, -1, height), (0.6, 2, height), (-1, 2, height)])


def refined():
    mesh = MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=3)
    for el in mesh.Elements():
        mesh.SetRefinementFlag(el, any(np.linalg.norm(np.subtract(mesh[v].point, 0.5)) < 0.3 for v in el.vertices))
    mesh.Refine()
    return mesh


def two_materials():
    from netgen.occ import Box, Glue, OCCGeometry

    low, high = Box((0, 0, 0), (1, 1, 0.3)), Box((0, 0, 0.3), (1, 1, 1))
    low.mat("soft"), high.mat("stiff")
    low.faces.Min((0, 0, 1)).name, high.faces.Max((0, 0, 1)).name = "bottom", "top"
    return Mesh(OCCGeometry(Glue([low, high])).GenerateMesh(maxh=0.5))


def push(problem, v, t):
    problem.f += CF((0.03 * t, 0.01 * x, -0.05 - 0.1 * x)) * v * problem.body.ds("top")


def everything(problem, v, t):
    """Each kind of load and support."""
    body, u = problem.body, problem.V.TrialFunction()
    problem.f += Parameter(0.02 * t) * v[0] * body.dx - 0.1 * specialcf.normal(3) * v * body.ds("top") + CF((0.02 * t, 0, -0.05)) * v * body.ds("right|top")
    problem.FacePressure(0.01 * (1 + x), crack=0)
    problem.FaceTraction(plus=(0.005, 0, 0))
    problem.a += 0.5 * u * v * body.ds("left") + 0.2 * Jump(u) * Jump(v) * body.dcrack
    problem.SetDirichlet((0.001 * x, 0, 0.001 * z), "bottom")


CASES = {
    "friction": ({}, {"law": Coulomb(0.3)}, push),
    "given threshold": ({"front": None}, {"law": Tresca(0.01 * (1 + x))}, push),
    "frictionless, gap": ({"front": None, "order": 2}, {"gap": 0.001 * x}, push),
    "everything": ({}, {"law": Coulomb(0.3)}, everything),
    "mouth": ({"sheets": [Sheet.Ellipse((0.5, 0, 0.52), (0.35, 0, 0), (0, 0.3, 0.05))], "front": None}, {"law": Coulomb(0.3)}, push),
    "two sheets": ({"sheets": [half(0.2), half(0.8)], "front": None}, {"law": Coulomb(0.3)}, push),
    "refined, order 2": ({"order": 2, "mesh": refined, "front": None}, {"law": Coulomb(0.3)}, everything),
    "regions": (
        {
            "mesh": two_materials,
            "front": None,
            "material": lambda mesh: Elasticity.ByRegion(mesh, {"soft": Elasticity.Solid(E=1, nu=0.3), "stiff": Elasticity.Solid(E=2.5, nu=0.25)}),
        },
        {"law": Coulomb(0.3)},
        push,
    ),
}


def spaces(name):
    options = {"mesh": structured, "sheets": [DISK], "material": MATERIAL, "order": 1} | CASES[name][0]
    mesh, material = options.pop("mesh")(), options.pop("material")
    body = CrackedMesh(mesh, *options.pop("sheets"))
    material = material(mesh) if callable(material) else material
    return CrackFESpace(body, material=material, dirichlet="bottom", **options), TraceSpace(body)


def problem_of(name, V, W, t):
    problem = ContactProblem(V, W, **CASES[name][1])
    CASES[name][2](problem, V.TestFunction(), t)
    return problem


def numbers(solution):
    """What a user reads."""
    at = solution.body.mesh(0.83, 0.21, 0.7)
    rows = [*solution.u(at), solution.VonMises()(at), solution.Energy(), solution.PotentialEnergy(), solution.DissipatedEnergy(), *solution.Reaction("bottom")]
    for crack in range(len(solution.body.cracks)):
        profile = solution.Profile(crack)
        rows += [solution.ContactForce(crack), solution.ContactArea(crack), *np.ravel(solution.TangentialForce(crack))]
        rows += [value for name in ("area", "gap", "slip_1", "slip_2", "sigma_n", "sigma_t_1", "sigma_t_2") for value in profile[name]]
        rows += [len(solution.Transitions(crack)), *(profile.state == "slip")]
    return np.array(rows, dtype=float)


@pytest.mark.parametrize("name", CASES)
def test_what_is_read_is_what_was_saved_and_goes_on(name, tmp_path):
    V, W = spaces(name)
    solution = problem_of(name, V, W, 1).Solve()
    path = tmp_path / "step.solution"
    assert solution.Save(path) == path and [p.name for p in tmp_path.iterdir()] == [path.name]
    read = ContactSolution.Load(path)
    assert type(read) is type(solution) and read.body is read.problem.V.body is read.problem.W.body is not solution.body and read.u.space is read.problem.V
    same(numbers(read), numbers(solution))
    assert str(read.report) == str(solution.report)
    read.CheckLoad()
    here, there = problem_of(name, V, W, -1).Solve(previous=solution), problem_of(name, read.problem.V, read.problem.W, -1).Solve(previous=read)
    same(numbers(there), numbers(here), 1e-12 if name.startswith("refined") else 1e-14)  # other numbers, other round-off of the factorisation


def test_a_solution_is_read_in_another_process(tmp_path):
    """The history of friction: further steps there are those of this process to the last digits."""
    V, W = spaces("everything")
    solution, path = problem_of("everything", V, W, 1).Solve(), tmp_path / "step.solution"
    solution.Save(path)
    code = f"""if True:
        import json, sys
        sys.path.append({str(Path(__file__).parent)!r})
        from ngsolve import SetNumThreads
        from ngsxfem_contact import ContactSolution
        from test_saved_solids import numbers, problem_of
        SetNumThreads(1)
        read = ContactSolution.Load({str(path)!r})
        further = problem_of("everything", read.problem.V, read.problem.W, -1).Solve(previous=read)
        print(json.dumps([numbers(read).tolist(), numbers(further).tolist()]))"""
    run = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    there = [np.array(row) for row in json.loads(run.stdout)]
    same(there[0], numbers(solution))
    same(there[1], numbers(problem_of("everything", V, W, -1).Solve(previous=solution)))


def test_load_steps_pictures_and_files_go_on(tmp_path):
    V, W = spaces("friction")
    steps = LoadSteps(problem_of("friction", V, W, 1))
    first = steps.Solve(0.5)
    first.Save(tmp_path / "step.solution")
    read = ContactSolution.Load(tmp_path / "step.solution")
    further = LoadSteps(read.problem)
    further.last = read
    same(numbers(further.Solve(1)), numbers(steps.Solve(1)))
    assert (Path(read.SaveVTK(tmp_path / "read")).read_bytes()) == Path(first.SaveVTK(tmp_path / "first")).read_bytes()
    pytest.importorskip("matplotlib").use("Agg")
    drawn = [plot_profile(solution)[0].collections[0].get_array() for solution in (read, first)]
    assert np.array_equal(*drawn)


def test_bodies_and_spaces_are_pickled():
    """A sheet, a body, both spaces, a problem: with shared parts, which stay shared."""
    V, W = spaces("mouth")
    problem = problem_of("mouth", V, W, 1)
    again = pickle.loads(pickle.dumps(problem))
    assert again.V.body is again.W.body is again.body and again.V.ndof == V.ndof and again.W.ndof == W.ndof
    same(numbers(again.Solve()), numbers(problem.Solve()))
    sheet, body = pickle.loads(pickle.dumps((V.body.cracks[0], V.body)))
    assert sheet.area == V.body.cracks[0].area and body.fronts[0].length == V.body.fronts[0].length


def test_what_cannot_be_saved_is_named(tmp_path):
    V, W = spaces("friction")
    problem = ContactProblem(V, W, gap=Interpolate(0.001 * x, H1(V.mesh)))
    push(problem, V.TestFunction(), 1)
    with pytest.raises(NotSaved, match="gap cannot be saved"):
        problem.Solve().Save(tmp_path / "x")
    assert list(tmp_path.iterdir()) == []
