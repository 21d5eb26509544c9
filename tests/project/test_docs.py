"""What the documents claim about the package: names that exist, code that runs."""

import importlib
import inspect
import pkgutil
import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers import rotated_problem
from netgen.geom2d import SplineGeometry
from netgen.occ import unit_cube
from ngsolve import CF, IfPos, Mesh, specialcf, y

import ngsxfem_contact
from ngsxfem_contact import BarbosaHughes, Coulomb, Nitsche, TipEnrichment, Tresca, protocols
from ngsxfem_contact.algebra.elimination import BackSubstitution, PartialFactorisation
from ngsxfem_contact.algebra.pardiso import Pardiso
from ngsxfem_contact.contact import BothSides, Coercivity, Joint
from ngsxfem_contact.contact.cones import CONES
from ngsxfem_contact.contact.friction import Frictionless
from ngsxfem_contact.contact.nodal_law import LawByCrack
from ngsxfem_contact.contact.stabilisation import Unstabilised
from ngsxfem_contact.estimate import ContactEdge, ContactForce, ContactPressure, Displacement, StressIntensityFactor
from ngsxfem_contact.exact.closed_forms import crack_on_axis, mouths, open_tip, pressure_error, rotated_square, uniform_compression, uniform_stress
from ngsxfem_contact.operators import NORMAL
from ngsxfem_contact.share import Share
from study.paper import MATERIAL, PAIRS, paper_problem, unstructured_mesh

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PUBLIC = {name for name, value in vars(ngsxfem_contact).items() if not name.startswith("_") and not inspect.ismodule(value)}


def public_modules():
    """The sub-packages and modules with public names."""
    modules = [importlib.import_module(f"ngsxfem_contact.{module.name}") for module in pkgutil.iter_modules(ngsxfem_contact.__path__) if module.name[0] != "_"]
    return [module for module in modules if hasattr(module, "__all__")]


def test_the_reference_has_every_public_name_once():
    text = (DOCS / "api.md").read_text(encoding="utf-8")
    described = re.findall(r"::\s+ngsxfem_contact\.(\w+)\.(\w+)$", text, re.M)
    assert sorted(described) == sorted((module.__name__.partition(".")[2], name) for module in public_modules() for name in module.__all__)
    assert len({name for _, name in described}) == len(described)
    assert set(re.findall(r"`(\w+)`", text.partition("\n## ")[0])) - {"__all__"} == PUBLIC <= {name for _, name in described}


def test_every_page_is_in_the_contents():
    listed = re.findall(r"^[\w-]+$", (DOCS / "index.md").read_text(encoding="utf-8"), re.M)
    assert {page.stem for page in DOCS.glob("*.md")} - {"index"} <= set(listed)


def code_of(page):
    return re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def added(name):
    """What docs/extending.md adds under a name."""
    names = {}
    (block,) = (code for code in code_of("extending.md") if re.search(rf"^(class|def) {name}\b", code, re.M))
    exec(block, names)
    return names[name]


@pytest.mark.parametrize("role", ["Stabilisation", "CompleteStabilisation", "FaceLaw", "TipFunctions", "Goal", "Norm", "Cone", "DirectSolver"])
def test_the_members_of_roles_are_those_of_the_protocols(role):
    """Names and arguments; a complete stabilisation lists what it has beside."""
    text = (DOCS / "extending.md").read_text(encoding="utf-8")
    listed = re.search(rf"`protocols\.{role}`(?:.|\n)*?\n\n((?:- .*\n|  .*\n)+)", text)[1]
    described = dict(re.findall(r"^- `(\w+)(\(.*?\))?`:", listed, re.M))
    protocol = getattr(protocols, role)
    names = set(protocols.members(protocol)) - set(protocols.members(protocols.Stabilisation) if role == "CompleteStabilisation" else ())
    assert described.keys() == names and len(names) >= 2
    for name in names:
        arguments = list(inspect.signature(vars(protocol)[name]).parameters)[1:] if inspect.isfunction(vars(protocol).get(name)) else None
        assert described[name] == ("" if arguments is None else f"({', '.join(arguments)})")


@pytest.mark.parametrize(
    "role, things",
    [
        (protocols.CompleteStabilisation, [BarbosaHughes(), BothSides(1), Nitsche(), Unstabilised()]),
        (protocols.Stabilisation, [added("Constant")(1), added("CutLength")()]),
        (
            protocols.FaceLaw,
            [
                Frictionless(),
                Coulomb(0.3),
                Tresca(1),
                added("NoSeparation")(),
                added("Adhesion")(0, 0),
                added("Suction")(1.0),
                Joint(1, 1),
                LawByCrack({}, Frictionless()),
            ],
        ),
        (protocols.TipFunctions, [TipEnrichment(), added("HalfTheRoom")(MATERIAL)]),
        (protocols.Goal, [StressIntensityFactor("K_I"), ContactForce(), ContactEdge(), Displacement("top"), added("Opening")()]),
        (protocols.Norm, [ContactPressure(), added("EnergyNormIn")("")]),
        (protocols.Cone, [*CONES.values()]),
        (protocols.DirectSolver, [PartialFactorisation, BackSubstitution, Pardiso]),
    ],
)
def test_each_object_has_its_role(role, things):
    """Members, and the arguments of methods by name and order."""
    for thing in things:
        for name in protocols.members(role):
            owner = next((each for each in role.__mro__ if name in vars(each)), None)
            if owner is not None and inspect.isfunction(vars(owner)[name]):
                asked = list(inspect.signature(vars(owner)[name]).parameters)[1:]
                has = list(inspect.signature(getattr(thing, name)).parameters)
                assert [a for a in has if a != "self"][: len(asked)] == asked, (thing, name)
            elif not isinstance(thing, type):
                assert hasattr(thing, name), (thing, name)


def test_what_a_role_lacks_is_named():
    class Half:
        sides = {"larger": 1}
        components = (NORMAL,)
        tolerance = 1e-5

    problem = paper_problem(unstructured_mesh(0.2))
    for role in ({"stabilisation": Half()}, {"law": Half()}):
        (option,) = role
        missing = {"stabilisation": "has no Gamma and no IsSafe", "law": "has no depends_on_path and no Solve and no Variables and no Work and no Violation"}[
            option
        ]
        with pytest.raises(TypeError, match=f"ContactProblem: {option}=.* {missing}; docs/extending.md"):
            ngsxfem_contact.ContactProblem(problem.V, problem.W, MATERIAL, **role)
    with pytest.raises(TypeError, match="CrackFESpace: tip=.* has no Spec; docs/extending.md"):
        ngsxfem_contact.CrackFESpace(problem.body, tip=Half())


def test_the_minimal_objects_work():
    mesh = unstructured_mesh(0.088)
    usual = paper_problem(mesh).Solve()
    constant = paper_problem(mesh, stabilisation=added("Constant")(1e-3)).Solve()
    assert constant.ContactForce() == pytest.approx(usual.ContactForce(), rel=0.02)
    pressed, held = paper_problem(mesh, "C").Solve(), paper_problem(mesh, "C", law=added("NoSeparation")()).Solve()
    assert pressed.report.Counts()["contact"] < len(pressed.report.active[-1]) == held.report.Counts()["contact"]
    assert held.Profile().sigma_n.max() > 0 and np.abs(held.state.residual).max() < 1e-10
    problem = paper_problem(mesh)
    V = ngsxfem_contact.CrackFESpace(problem.body, order=2, tip=added("HalfTheRoom")(MATERIAL))
    assert V.tip_specs[0].r1 == 0.5 * problem.body.tips[0].clearance


def test_the_stabilisation_that_is_added_works():
    """Coercive as the one it is made from, exact for a linear displacement, close to it for the paper's test."""
    own = added("CutLength")()
    mesh = unstructured_mesh(0.088)
    problem, usual = (paper_problem(mesh, stabilisation=s) for s in (own, BarbosaHughes()))
    assert 1 > Coercivity(problem) >= Coercivity(usual) >= 0.5
    assert abs(problem.Solve().ContactForce() / usual.Solve().ContactForce() - 1) < 0.02

    exact, angle, offset = uniform_compression(MATERIAL), 0.3, (0.01, 0.02)
    body = ngsxfem_contact.CrackedMesh(rotated_square(angle, offset, 0.2), crack_on_axis(*mouths(angle, offset)))
    V = ngsxfem_contact.CrackFESpace(body, order=1, dirichlet="outer")
    patch = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), MATERIAL, stabilisation=own)
    patch.SetDirichlet(exact.u, "outer")
    assert pressure_error(patch.Solve(), exact) < 1e-10


def test_the_guide_names_what_exists():
    """Names in backticks and code of the guide that look like the package's."""
    words = set(re.findall(r"\b[A-Z][a-z]+[A-Z]\w+\b", (DOCS / "guide.md").read_text(encoding="utf-8")))
    other = {
        "GridFunction",
        "GridFunctions",
        "MakeStructured3DMesh",
        "DataFrame",
        "OpenMPI",
        "LinearForm",
        "TaskManager",
        "CoefficientFunction",
        "NGSolve",
        "ParaView",
        "ValueError",
        "TypeError",
        "ImportError",
        "GenerateMesh",
        "NgException",
        "InnerProduct",
        "IfPos",
        "MPa",
    }
    public = {name: getattr(module, name) for module in public_modules() for name in module.__all__}
    assert words - other <= public.keys() | {member for value in (*public.values(), Share) for member in dir(value)}


def test_the_goal_that_is_added_works():
    """Its derivative is the quantity itself, which is linear in u; its error beside a finer order."""
    goal, solution = added("Opening")(), rotated_problem(open_tip(MATERIAL), PAIRS["P2/P1"], 0.1, tip=TipEnrichment(material=MATERIAL)).Solve()
    found = solution.ErrorEstimate().Goal(goal)
    assert goal.OfDisplacement(solution, solution.problem.V) @ solution.u.vec.FV().NumPy() == pytest.approx(found.value, rel=1e-9)
    true = 16 / (3 * MATERIAL.E_prime * np.sqrt(2 * np.pi)) * solution.body.cracks[0].length ** 1.5
    assert abs(true - found.value) < found.bar < 1e-2 * found.value


def test_the_norm_that_is_added_works():
    """Over the whole mesh it is the energy norm, over no region 0."""
    estimate = rotated_problem(open_tip(MATERIAL), PAIRS["P2/P1"], 0.1, tip=TipEnrichment(material=MATERIAL)).Solve().ErrorEstimate()
    (region,) = set(estimate.solution.body.mesh.GetMaterials())
    found = estimate.Goal(added("EnergyNormIn")(region))
    assert found.bar == pytest.approx(estimate.energy) and found.bar / found.value == pytest.approx(estimate.relative)
    assert estimate.Goal(added("EnergyNormIn")("elsewhere")).bar == 0


def test_the_law_at_the_nodes_that_is_added_works():
    """Its derivative, other stiffnesses, and a column: λ = s, and what is left of the displacement opens it; with another law in the body, too."""
    law, rng = added("Suction")(0.5), np.random.default_rng(0)
    relation, trial, c = law.At(range(50)), rng.standard_normal((2, 50)), np.full((2, 50), 3.0)
    (g, D), h = relation.Jump(trial, c, {}), 1e-7
    assert np.abs((relation.Jump(trial + h, c, {})[0] - g) / h - D.sum(axis=1)).max() < 1e-6
    assert np.abs(relation.Jump(trial + 4 * g, c + 4, {})[0] - g).max() < 1e-14
    body = ngsxfem_contact.CrackedMesh(rotated_square(0, (0, 0), 0.4), crack_on_axis(-0.5, 0.5))
    V = ngsxfem_contact.CrackFESpace(body, order=1, dirichlet="outer")
    for mapping in (law, {0: law}):
        problem = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body), ngsxfem_contact.Elasticity.PlaneStrain(E=10, nu=0), law=mapping)
        problem.SetDirichlet(CF((0, 0.05 * y + IfPos(y, 0.2, 0))), "outer")
        solution = problem.Solve()
        assert np.abs(solution.Profile().sigma_n - 0.5).max() < 1e-12 and np.abs(solution.Profile().gap - 0.2).max() < 1e-12
        assert solution.FaceEnergy() == pytest.approx(0.1) and solution.report.states["open"] == 1


def test_the_law_of_friction_that_is_added_works():
    """A block that slides under pressure 1: λ_t = c + μ_f; and the laws that it contains."""
    law, angle, offset = added("Adhesion"), 0.41, (0.03, -0.02)
    exact = uniform_stress(MATERIAL, 0.3, 0.25, -1)
    body = ngsxfem_contact.CrackedMesh(rotated_square(angle, offset, 0.2), crack_on_axis(*mouths(angle, offset)))
    V = ngsxfem_contact.CrackFESpace(body, order=2, dirichlet="outer")
    block = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), MATERIAL, law=law(c=0.1, mu_f=0.15))
    block.SetDirichlet(exact.u + CF((IfPos(y, 0.05, -0.05), 0)), "outer")
    solution = block.Solve()
    assert np.abs(solution.Profile().sigma_t - 0.25).max() < 1e-9 and np.abs(solution.Profile().slip - 0.1).max() < 1e-9

    mesh = unstructured_mesh(0.06)
    for own, known in ((law(0, 0.3), Coulomb(0.3)), (law(0.05, 0), Tresca(0.05, in_contact_only=True))):
        ours, theirs = (paper_problem(mesh, "C", law=friction).Solve().Multipliers() for friction in (own, known))
        assert np.abs(ours - theirs).max() < 1e-10 * np.abs(theirs).max()
    both = paper_problem(mesh, "C", law=law(0.01, 0.3)).Solve()
    p_n, p_t = np.split(both.Multipliers(), 2)
    assert (np.abs(p_t) <= np.where(p_n < 0, 0.01 - 0.3 * p_n, 0) + 1e-12).all() and (p_t[p_n < 0] < 0.3 * p_n[p_n < 0] - 0.009).any()


def test_the_crack_shape_that_is_added_works():
    """Length and curvature of the logarithmic spiral, and hydrostatic pressure on it."""
    k, scale, centre = 0.3, 0.2, (0.5, 0.02)
    crack = added("spiral")(centre, scale, k, 0.2, 1.8)
    r = [scale * np.exp(k * t) for t in (0.2, 1.8)]
    assert abs(crack.length - np.sqrt(1 + k * k) / k * (r[1] - r[0])) < 1e-8
    for s in np.linspace(0, crack.length, 7):
        radius = np.hypot(*np.subtract(crack.PointAt(s), centre))
        assert abs(crack.CurvatureAt(s) * radius * np.sqrt(1 + k * k) - 1) < 1e-3
    body = ngsxfem_contact.CrackedMesh(unstructured_mesh(0.06), crack)
    V = ngsxfem_contact.CrackFESpace(body, order=2, tip=None)
    problem = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), MATERIAL)
    problem.f += -specialcf.normal(2) * V.TestFunction() * body.ds
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    assert np.abs(problem.Solve().Profile().sigma_n + 1).max() < 1e-6


def layered_square():
    """Regions "matrix" below and "layer" above y = 0.8; boundaries "bottom", "right", "top", "left"."""
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*p) for p in ((0, 0), (1, 0), (1, 0.8), (1, 1), (0, 1), (0, 0.8))]
    sides = ((0, 1, "bottom", 1, 0), (1, 2, "right", 1, 0), (2, 3, "right", 2, 0), (3, 4, "top", 2, 0), (4, 5, "left", 2, 0), (5, 0, "left", 1, 0))
    for a, b, name, left, right in (*sides, (2, 5, "inner", 1, 2)):
        geometry.Append(["line", points[a], points[b]], bc=name, leftdomain=left, rightdomain=right)
    for number, name in ((1, "matrix"), (2, "layer")):
        geometry.SetMaterial(number, name)
    return Mesh(geometry.GenerateMesh(maxh=0.08))


def test_the_guide_runs(capsys, tmp_path, monkeypatch):
    """All of its code, one block after the other; materials, friction and Nitsche's method build problems of their own, which are solved here."""
    names = {
        "mesh": layered_square(),
        "force": CF((0, -10)),
        "traction": CF((1, 0)),
        "pressure": 5.0,
        "crack": ngsxfem_contact.Crack([(0, 0.4), (0.4, 0.4)]),
        "cube": Mesh(unit_cube.GenerateMesh(maxh=0.12)),
    }
    exec("import numpy as np\nfrom ngsolve import *\nfrom ngsxfem_contact import *\nsteel = Elasticity.PlaneStrain(E=210e3, nu=0.3)", names)

    def make_problem(cracks):
        body = ngsxfem_contact.CrackedMesh(names["mesh"], *cracks)
        V = ngsxfem_contact.CrackFESpace(body, order=2, tip=ngsxfem_contact.TipEnrichment(material=names["steel"]), dirichlet="bottom")
        problem = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), names["steel"])
        problem.f += CF((0, 100)) * V.TestFunction() * body.ds("top")
        return problem

    names["make_problem"] = make_problem
    monkeypatch.chdir(tmp_path)  # it saves a file
    blocks = code_of("guide.md")
    assert len(blocks) == 18
    for block in blocks:
        if "material=rock" in block or "law=" in block or "stabilisation=" in block:
            own = dict(names)
            exec(block, own)
            own["problem"].f += CF((2, -5)) * own["V"].TestFunction() * own["body"].ds("top")
            assert own["problem"].Solve().report.converged
        else:
            exec(block, names)
    assert (
        names["solution"].report.converged
        and names["growth"].table["state"][0] == "grows"
        and len(names["solutions"]) == 21
        and names["steps"].last is names["solutions"][-1]
    )
    assert names["along"].K_I == pytest.approx(200 * np.sqrt(0.3 / np.pi), rel=1e-4)


RESULTS = ROOT / "benchmarks" / "results"
COMMAND = re.compile(r"# (?:python )?(benchmarks/\w+\.py|tools/coverage\.sh) (?:.* )?--results (\w+)\n# measured with .* on \d{4}-\d{2}-\d{2}\b.*\n")


def test_every_table_of_what_was_measured_is_a_file():
    """None in the page, each file once."""
    page = (DOCS / "measured.md").read_text(encoding="utf-8")
    shown = re.findall(r"^```(.*)\n(?::class: wide\n)?```$", page, re.M)
    assert not re.search(r"^(\||    )", page, re.M) and page.count("```") == 2 * len(shown)
    assert sorted(shown) == sorted(f"{{literalinclude}} ../benchmarks/results/{file.name}" for file in RESULTS.iterdir())


@pytest.mark.parametrize("file", sorted(RESULTS.iterdir()), ids=lambda file: file.stem)
def test_a_result_names_the_command_that_writes_it(file):
    text = file.read_text(encoding="utf-8")
    script, name = COMMAND.match(text).groups()
    assert name == file.stem and len(text.splitlines()) > 2
    source = (ROOT / script).read_text(encoding="utf-8")
    assert source.endswith('if __name__ == "__main__":\n    recorded(main)\n') or '"${1-}" = --results' in source


def test_a_script_keeps_what_it_prints(tmp_path, monkeypatch, capsys):
    """Below the command; its own options are what is left, and nothing is written if it fails."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    recorded = importlib.import_module("results").recorded
    seen = []
    monkeypatch.setattr(sys, "argv", ["/somewhere/tips.py", "--h", "0.1", "--results", "tips"])
    recorded(lambda: seen.extend(sys.argv[1:]) or print("γ  1.0"), tmp_path)
    text = (tmp_path / "tips.txt").read_text(encoding="utf-8")
    assert seen == ["--h", "0.1"] and capsys.readouterr().out == "γ  1.0\n"
    assert COMMAND.match(text).groups() == ("benchmarks/tips.py", "tips") and text.startswith("# python benchmarks/tips.py --h 0.1 --results tips\n")
    assert text.splitlines()[2:] == ["γ  1.0"]
    monkeypatch.setattr(sys, "argv", ["tips.py", "--results", "other"])
    with pytest.raises(ZeroDivisionError):
        recorded(lambda: print(1 / 0), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["tips.txt"]


def test_every_benchmark_is_listed_and_keeps_results():
    listed = re.findall(r"^\| `(\w+\.py)` \|", (ROOT / "benchmarks" / "README.md").read_text(encoding="utf-8"), re.M)
    scripts = {path.name for path in (ROOT / "benchmarks").glob("*.py") if "recorded(main)" in path.read_text(encoding="utf-8")} - {"results.py"}
    assert sorted(listed) == sorted(scripts)
    assert {path.name for path in (ROOT / "benchmarks").glob("*.py")} - scripts == {"adversarial.py", "bodies.py", "results.py"}


@pytest.mark.parametrize("script", sorted(path.name for path in (ROOT / "benchmarks").glob("*.py")))
def test_every_benchmark_starts(script, monkeypatch):
    """What it imports is there."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    runpy.run_path(str(ROOT / "benchmarks" / script), run_name="imported")
