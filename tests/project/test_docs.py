"""What the documents claim about the package: names that exist, code that runs."""

import importlib
import inspect
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from netgen.geom2d import SplineGeometry
from ngsolve import CF, IfPos, Mesh, specialcf, y

import ngsxfem_contact
from ngsxfem_contact import BarbosaHughes, Coercivity, Coulomb, Tresca
from ngsxfem_contact.exact.closed_forms import crack_on_axis, mouths, pressure_error, rotated_square, uniform_compression, uniform_stress
from ngsxfem_contact.study.paper import MATERIAL, paper_problem, unstructured_mesh

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PUBLIC = {name for name, value in vars(ngsxfem_contact).items() if not name.startswith("_") and not inspect.ismodule(value)}


def test_the_reference_has_every_public_name():
    described = re.findall(r"::\s+ngsxfem_contact\.(\w+)$", (DOCS / "api.md").read_text(encoding="utf-8"), re.M)
    assert sorted(described) == sorted(PUBLIC)
    assert len(described) == len(set(described))


def test_every_page_is_in_the_contents():
    listed = re.findall(r"^[\w-]+$", (DOCS / "index.md").read_text(encoding="utf-8"), re.M)
    assert {page.stem for page in DOCS.glob("*.md")} - {"index"} <= set(listed)


def code_of(page):
    return re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def test_the_stabilisation_that_is_added_works():
    """Coercive as the one it is made from, exact for a linear displacement, close to it for the paper's test."""
    names = {}
    exec(code_of("extending.md")[0], names)
    added = names["CutLength"]()
    mesh = unstructured_mesh(0.088)
    problem, usual = (paper_problem(mesh, stabilisation=s) for s in (added, BarbosaHughes()))
    assert 1 > Coercivity(problem) >= Coercivity(usual) >= 0.5
    assert abs(problem.Solve().ContactForce() / usual.Solve().ContactForce() - 1) < 0.02

    exact, angle, offset = uniform_compression(MATERIAL), 0.3, (0.01, 0.02)
    body = ngsxfem_contact.CrackedMesh(rotated_square(angle, offset, 0.2), crack_on_axis(*mouths(angle, offset)))
    V = ngsxfem_contact.CrackFESpace(body, order=1, dirichlet="outer")
    patch = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), MATERIAL, stabilisation=added)
    patch.SetDirichlet(exact.u, "outer")
    assert pressure_error(patch.Solve(), exact) < 1e-10


def test_the_guide_names_what_exists():
    """Names in backticks and code of the guide that look like the package's."""
    words = set(re.findall(r"\b[A-Z][a-z]+[A-Z]\w+\b", (DOCS / "guide.md").read_text(encoding="utf-8")))
    other = {
        "GridFunctions",
        "LinearForm",
        "TaskManager",
        "CoefficientFunction",
        "NGSolve",
        "ParaView",
        "ValueError",
        "TypeError",
        "ImportError",
        "NgException",
        "InnerProduct",
        "MPa",
    }
    members = {name for value in PUBLIC for name in dir(getattr(ngsxfem_contact, value))}
    assert words - other <= PUBLIC | members


def test_the_law_of_friction_that_is_added_works():
    """A block that slides under pressure 1: λ_t = c + μ_f; and the laws that it contains."""
    names = {}
    exec(code_of("extending.md")[2], names)
    law, angle, offset = names["MohrCoulomb"], 0.41, (0.03, -0.02)
    exact = uniform_stress(MATERIAL, 0.3, 0.25, -1)
    body = ngsxfem_contact.CrackedMesh(rotated_square(angle, offset, 0.2), crack_on_axis(*mouths(angle, offset)))
    V = ngsxfem_contact.CrackFESpace(body, order=2, dirichlet="outer")
    block = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), MATERIAL, friction=law(c=0.1, mu_f=0.15))
    block.SetDirichlet(exact.u + CF((IfPos(y, 0.05, -0.05), 0)), "outer")
    solution = block.Solve()
    assert np.abs(solution.Profile().sigma_t - 0.25).max() < 1e-9 and np.abs(solution.Profile().slip - 0.1).max() < 1e-9

    mesh = unstructured_mesh(0.06)
    for added, known in ((law(0, 0.3), Coulomb(0.3)), (law(0.05, 0), Tresca(0.05, in_contact_only=True))):
        ours, theirs = (paper_problem(mesh, "C", friction=friction).Solve().Multipliers() for friction in (added, known))
        assert np.abs(ours - theirs).max() < 1e-10 * np.abs(theirs).max()
    both = paper_problem(mesh, "C", friction=law(0.01, 0.3)).Solve()
    p_n, p_t = np.split(both.Multipliers(), 2)
    assert (np.abs(p_t) <= np.where(p_n < 0, 0.01 - 0.3 * p_n, 0) + 1e-12).all() and (p_t[p_n < 0] < 0.3 * p_n[p_n < 0] - 0.009).any()


def test_the_crack_shape_that_is_added_works():
    """Length and curvature of the logarithmic spiral, and hydrostatic pressure on it."""
    names = {}
    exec(code_of("extending.md")[3], names)
    k, scale, centre = 0.3, 0.2, (0.5, 0.02)
    crack = names["spiral"](centre, scale, k, 0.2, 1.8)
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


def test_the_guide_runs(capsys):
    """All of its code, one block after the other; materials, friction and Nitsche's method build problems of their own, which are solved here."""
    names = {"mesh": layered_square(), "force": CF((0, -10)), "traction": CF((1, 0)), "pressure": 5.0, "crack": ngsxfem_contact.Crack([(0, 0.4), (0.4, 0.4)])}
    exec("import numpy as np\nfrom ngsolve import *\nfrom ngsxfem_contact import *\nsteel = Elasticity.PlaneStrain(E=210e3, nu=0.3)", names)

    def make_problem(cracks):
        body = ngsxfem_contact.CrackedMesh(names["mesh"], *cracks)
        V = ngsxfem_contact.CrackFESpace(body, order=2, tip=ngsxfem_contact.TipEnrichment(material=names["steel"]), dirichlet="bottom")
        problem = ngsxfem_contact.ContactProblem(V, ngsxfem_contact.TraceSpace(body, order=1), names["steel"])
        problem.f += CF((0, 100)) * V.TestFunction() * body.ds("top")
        return problem

    names["make_problem"] = make_problem
    blocks = code_of("guide.md")
    assert len(blocks) == 9
    for block in blocks:
        if "material=rock" in block or "friction=" in block or "stabilisation=" in block:
            own = dict(names)
            exec(block, own)
            own["problem"].f += CF((2, -5)) * own["V"].TestFunction() * own["body"].ds("top")
            assert own["problem"].Solve().report.converged
        else:
            exec(block, names)
    assert names["solution"].report.converged and names["growth"].table["state"][0] == "grows" and len(names["solutions"]) == 21


RESULTS = ROOT / "benchmarks" / "results"
COMMAND = re.compile(r"# (?:python )?(benchmarks/\w+\.py|tools/coverage\.sh) (?:.* )?--results (\w+)\n# measured with .* on \d{4}-\d{2}-\d{2}\b.*\n")


def test_every_table_of_what_was_measured_is_a_file():
    """None in the page, each file once."""
    page = (DOCS / "measured.md").read_text(encoding="utf-8")
    shown = re.findall(r"^```(.*)\n```$", page, re.M)
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
