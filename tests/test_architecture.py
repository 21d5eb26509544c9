"""The direction of dependencies, the size of the parts, and the public names: read from the sources."""

import ast
import inspect
import re
from functools import cache
from pathlib import Path

import ngsolve
import numpy as np
import pytest

import ngsxfem_contact
from ngsxfem_contact import _ngsxfem_contact as extension

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "ngsxfem_contact"
CPP_FILES = sorted((ROOT / "cpp").glob("*.?pp"))
BINDING_FILES = sorted((ROOT / "python").glob("*.?pp"))
PYTHON_FILES = sorted(PACKAGE.glob("*.py"))

GEOMETRY = {
    "box_tree",
    "curve_piece",
    "crack",
    "tip_curve",
    "element_division",
    "element_location",
    "cut_rule",
    "interpolant",
    "element_map",
    "element_clips",
    "body_boundary",
    "crack_ends",
    "curved_rule",
    "cracked_mesh",
    "body_rules",
}
SPACES = {"tip_functions", "crack_element", "diffops", "crack_fespace", "crack_bilinearform", "trace_space", "cut_integral"}
MATRICES = {"bordered_matrix", "schur_complement"}
FORMS = {"spaces", "operators", "elasticity", "tip_disk"}
SOLVING = {"problem", "solver", "solution", "stabilisation"}
RESULTS = {"solution", "plotting", "closed_forms", "paper"}
READING = {"fracture", "tip_fields"}


def cpp_includes(path):
    """The unit names of the quoted includes."""
    return {Path(name).stem for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', path.read_text(encoding="utf-8"), re.M)}


@cache
def cpp_graph():
    """Unit → units that its files include."""
    graph = {}
    for path in CPP_FILES:
        graph.setdefault(path.stem, set()).update(cpp_includes(path) - {path.stem})
    return graph


def imported(node):
    """The modules of this package that one statement imports, seen from inside the package."""
    if isinstance(node, ast.ImportFrom) and (node.level == 1 or (node.module or "").split(".")[0] == "ngsxfem_contact"):
        module = (node.module or "").removeprefix("ngsxfem_contact").strip(".")
        return {module.split(".")[0]} if module else {alias.name for alias in node.names}
    if isinstance(node, ast.Import):
        return {alias.name.split(".")[1] for alias in node.names if alias.name.startswith("ngsxfem_contact.")}
    return set()


def at_import(tree):
    """The statements that run when a module is imported: all that are not inside functions."""
    stack = [tree]
    while stack:
        node = stack.pop()
        yield node
        stack += [n for n in ast.iter_child_nodes(node) if not isinstance(n, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))]


@cache
def python_graph(lazy=False):
    """Module → modules of the package that it imports; lazy: inside functions, too."""
    graph = {}
    for path in PYTHON_FILES:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        nodes = ast.walk(tree) if lazy else at_import(tree)
        graph[path.stem] = set().union(*map(imported, nodes)) & {p.stem for p in PYTHON_FILES}
    return graph


def reachable(graph, start):
    found, stack = set(), [start]
    while stack:
        new = graph.get(stack.pop(), set()) - found
        found |= new
        stack += new
    return found


def cycles(graph):
    return {node for node in graph if node in reachable(graph, node)}


def test_the_sources_are_here():
    assert GEOMETRY | SPACES | MATRICES <= set(cpp_graph())
    assert FORMS | SOLVING | RESULTS <= set(python_graph())


def test_the_reader_sees_what_it_should():
    """The parsers are not blind."""
    assert "crack" in cpp_graph()["element_division"] and "elasticity" in python_graph()["spaces"]
    assert cycles({"a": {"b"}, "b": {"a"}, "c": {"a"}}) == {"a", "b"}
    assert imported(ast.parse("from .. import x").body[0]) == set()
    assert imported(ast.parse("from . import solver").body[0]) == {"solver"} == imported(ast.parse("import ngsxfem_contact.solver").body[0])


@pytest.mark.parametrize("unit", sorted(GEOMETRY))
def test_geometry_never_names_a_space(unit):
    assert not reachable(cpp_graph(), unit) & SPACES


@pytest.mark.parametrize("unit", sorted(MATRICES))
def test_linear_algebra_knows_matrices_only(unit):
    assert not reachable(cpp_graph(), unit) & (GEOMETRY | SPACES)


@pytest.mark.parametrize("unit", sorted(SPACES - {"cut_integral", "trace_space"}))
def test_a_space_never_names_a_form(unit):
    assert "cut_integral" not in reachable(cpp_graph(), unit)


def test_no_cycles():
    assert not cycles(cpp_graph())
    assert not cycles(python_graph())


@pytest.mark.parametrize("path", CPP_FILES, ids=lambda path: path.name)
def test_the_core_knows_no_python(path):
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"#\s*include\s*[<\"](pybind11|python_ngstd|python_comp|python_fem|Python\.h)", text)
    assert not re.search(r"\bpy::|\bpybind11::", text)
    assert not cpp_includes(path) & {p.stem for p in BINDING_FILES} - {p.stem for p in CPP_FILES}


@pytest.mark.parametrize("module", sorted(FORMS))
def test_a_form_never_names_a_solver(module):
    assert not reachable(python_graph(lazy=True), module) & SOLVING


@pytest.mark.parametrize("module", ["stabilisation", "cones", "active_set", "box_path", "nodal_newton", "friction", "elimination", "pardiso"])
def test_a_method_never_names_results(module):
    assert not reachable(python_graph(lazy=True), module) & (RESULTS | {"problem", "solver"})


@pytest.mark.parametrize("module", sorted(READING))
def test_what_reads_solutions_solves_nothing(module):
    assert not reachable(python_graph(lazy=True), module) & {"problem", "solver", "solution"}


def test_a_problem_names_no_results_but_what_its_solver_returns():
    assert not python_graph(lazy=True)["problem"] & RESULTS
    assert not reachable(python_graph(), "problem") & (RESULTS - {"solution"})


def test_only_the_extension_is_compiled():
    """pybind11 exports without logic are in python/, one file a subject."""
    assert all("pybind" not in path.read_text(encoding="utf-8") or path.parent.name == "python" for path in CPP_FILES + BINDING_FILES)


# Size


def python_functions():
    for path in PYTHON_FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                yield f"{path.name}:{node.name}", node.end_lineno - node.lineno + 1


def test_functions_are_short():
    lengths = dict(python_functions())
    assert len(lengths) > 100
    assert {name: n for name, n in lengths.items() if n > 60} == {}
    assert sorted(lengths.values())[len(lengths) // 2] <= 10


@pytest.mark.parametrize("path", CPP_FILES + BINDING_FILES + PYTHON_FILES, ids=lambda path: path.name)
def test_files_are_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


# Public names


PUBLIC = {name: value for name, value in vars(ngsxfem_contact).items() if not name.startswith("_") and not inspect.ismodule(value)}
REPLACED = {"Variation"}  # of NGSolve's names: ours varies over NGSolve's measures, too
EXPECTED = """
    BarbosaHughes Coercivity ContactProblem ContactSolution Coulomb Crack CrackFESpace CrackedMesh Elasticity FixedPoint FullNewton
    Gradient InfSup Jump LoadCase LoadSteps Minus Nitsche NormalGap NormalStress NotCoercive NotConverged Plus SingularSystem Slip SolveError Strain
    TangentialStress TipEnrichment TraceSpace Tresca
""".split()


def test_public_names_exist():
    assert set(EXPECTED) <= set(PUBLIC)


def test_a_star_import_brings_the_public_names_only():
    names = {}
    exec("from ngsxfem_contact import *", names)
    assert names.keys() - {"__builtins__"} == set(ngsxfem_contact.__all__) == set(PUBLIC)
    assert len(ngsxfem_contact.__all__) == len(PUBLIC)


def test_a_star_import_hides_nothing_of_ngsolve():
    names = {}
    exec("from ngsolve import *; from netgen.geom2d import *; from netgen.occ import *", names)
    assert set(PUBLIC) & names.keys() == REPLACED


def test_variation_replaces_that_of_ngsolve():
    """The same matrix over NGSolve's measures."""
    V = ngsolve.H1(ngsolve.Mesh(ngsolve.unit_square.GenerateMesh(maxh=0.5)), order=2)
    point = ngsolve.GridFunction(V)
    point.Set(ngsolve.x * ngsolve.y + 1)
    values = []
    for variation in (ngsolve.Variation, ngsxfem_contact.Variation):
        u = V.TrialFunction()
        form = ngsolve.BilinearForm(V)
        form += variation((u**4 + ngsolve.InnerProduct(ngsolve.grad(u), ngsolve.grad(u))) * ngsolve.dx + u**3 * ngsolve.ds)
        form.AssembleLinearization(point.vec)
        values.append(np.array(form.mat.AsVector()))
    assert np.abs(values[0]).max() > 1 and values[1] == pytest.approx(values[0], rel=1e-12, abs=1e-14)


# Docstrings


def undocumented(node, prefix):
    """Modules, classes and functions without a docstring that have public names, those inside functions left out."""
    if not ast.get_docstring(node):
        yield prefix
    for child in node.body if not isinstance(node, ast.FunctionDef) else ():
        if isinstance(child, (ast.ClassDef, ast.FunctionDef)) and not child.name.startswith("_"):
            yield from undocumented(child, f"{prefix}.{child.name}")


def written(thing, name):
    """What was written in a docstring of the extension, beside the signatures and member lists that pybind11 puts there."""
    return re.sub(rf"^{name}\(.*$|^Members:[\s\w]*|^\(self: .*$", "", thing.__doc__ or "", flags=re.M).strip()


def exported():
    """(name, object) of the classes, functions, methods and properties of the extension, enumerations without their values."""
    for name, value in vars(extension).items():
        if not name.startswith("_"):
            yield name, value
            of_enumeration = {"name", "value", *getattr(value, "__members__", ())} if hasattr(value, "__members__") else set()
            for member, thing in vars(value).items() if inspect.isclass(value) else ():
                if not member.startswith("_") and member not in of_enumeration:
                    yield f"{name}.{member}", getattr(thing, "__func__", thing)


def test_the_reader_of_docstrings_is_not_blind():
    tree = ast.parse('class A:\n  """A."""\n  def f(self): pass\n  def _g(self): pass\n\ndef h(): pass')
    assert list(undocumented(tree, "m")) == ["m", "m.A.f", "m.h"]
    assert not written(extension.Side.__index__, "__index__") and "Crack.PointAt" in dict(exported()) and "Side.Plus" not in dict(exported())


@pytest.mark.parametrize("path", [path for path in PYTHON_FILES if path.name != "_build_info.py"], ids=lambda path: path.name)
def test_python_has_docstrings(path):
    assert list(undocumented(ast.parse(path.read_text(encoding="utf-8")), path.stem)) == []


def test_the_extension_has_docstrings():
    assert [name for name, thing in exported() if len(written(thing, name.rpartition(".")[2])) <= 10] == []


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_public_names_have_docstrings(name):
    """Beside the signature that dataclass puts where nothing was written."""
    assert len(written(PUBLIC[name], name)) > 10
