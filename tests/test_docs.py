"""What the documents claim about the package: names that exist, code that runs."""

import inspect
import re
from pathlib import Path

import ngsxfem_contact
from ngsxfem_contact import BarbosaHughes, Coercivity
from ngsxfem_contact.closed_forms import crack_on_axis, mouths, pressure_error, rotated_square, uniform_compression
from ngsxfem_contact.paper import MATERIAL, paper_problem, unstructured_mesh

DOCS = Path(__file__).resolve().parents[1] / "docs"
PUBLIC = {name for name, value in vars(ngsxfem_contact).items() if not name.startswith("_") and not inspect.ismodule(value)}


def test_the_reference_has_every_public_name():
    described = re.findall(r"::\s+ngsxfem_contact\.(\w+)$", (DOCS / "api.md").read_text(encoding="utf-8"), re.M)
    assert sorted(set(described) - {"plotting"}) == sorted(PUBLIC)
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
    other = {"GridFunctions", "TaskManager", "CoefficientFunction", "NGSolve", "ParaView", "ValueError", "MPa"}
    members = {name for value in PUBLIC for name in dir(getattr(ngsxfem_contact, value))}
    assert words - other <= PUBLIC | members
