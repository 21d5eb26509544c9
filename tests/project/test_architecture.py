"""Folders are layers: arrows between them run down only. The size of the parts, and the public names. All is read from the sources."""

import ast
import html
import importlib
import inspect
import pkgutil
import re
import runpy
from pathlib import Path

import ngsolve
import numpy as np
import pytest

import ngsxfem_contact
from ngsxfem_contact import _ngsxfem_contact as extension

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "ngsxfem_contact"
CPP_FILES = sorted((ROOT / "cpp").glob("*/*.?pp"))
BINDING_FILES = sorted((ROOT / "python").glob("*.?pp"))
PYTHON_FILES = sorted(path for path in PACKAGE.rglob("*.py") if path.name != "_build_info.py")
STUDY_FILES = sorted((ROOT / "study").glob("*.py"))
TOOL = runpy.run_path(str(ROOT / "tools" / "architecture.py"))
LAYERS = {title: (list(units), uses) for title, units, uses in TOOL["layers"]()}


def name_of(path):
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("half, layer", [(half, layer) for half, (order, _) in LAYERS.items() for layer in order])
def test_arrows_run_down(half, layer):
    """A layer knows those below it only: in the order of CMakeLists.txt, and of ngsxfem_contact/__init__.py."""
    order, uses = LAYERS[half]
    assert uses[layer] <= set(order[: order.index(layer)])


def test_every_file_is_in_a_layer():
    core, package = set(LAYERS["core"][0]), set(LAYERS["package"][0])
    assert {path.parent.name for path in CPP_FILES} == core == {path.name for path in (ROOT / "cpp").iterdir() if path.is_dir()}
    assert {path.parent.name for path in PYTHON_FILES if path.parent != PACKAGE} == package - {TOOL["BASE"]}
    assert not list((ROOT / "cpp").glob("*.?pp"))


def test_tests_mirror_the_layers():
    folders = {path.parent.name for path in (ROOT / "tests").glob("*/test_*.py")}
    layers = {layer for order, _ in LAYERS.values() for layer in order} - {TOOL["BASE"]}
    assert layers - folders <= {"exact"} and folders - layers == {"mpi", "networks", "project", "sheets", "study"}


PLANE_ONLY = {"trace_space.cpp", "trace_space.hpp", "curve_nodes.cpp", "curve_nodes.hpp"}  # multipliers on curves


@pytest.mark.parametrize("path", [path for path in CPP_FILES if path.parent.name in ("forms", "spaces") and path.name not in PLANE_ONLY], ids=name_of)
def test_spaces_and_forms_ask_for_geometry_by_the_interface(path):
    """What cpp/cut/cut_geometry.hpp offers, and the tips: neither curves nor where they lie in elements."""
    inside = re.compile(r"\b(GetCrack|Cracks|Location|CrackLocation|ElementLocation|location|chords|BoundaryEdges)\b")
    assert inside.search((ROOT / "cpp/spaces/trace_space.cpp").read_text(encoding="utf-8"))
    assert not inside.findall(path.read_text(encoding="utf-8"))


def graph_within(files, uses):
    """File → files of the same layer that it uses."""
    return {name_of(path): {name_of(path.parent / f"{name}{path.suffix}") for name in uses(path)} for path in files}


def cycles(graph):
    def reachable(start):
        found, stack = set(), [start]
        while stack:
            new = graph.get(stack.pop(), set()) - found
            found |= new
            stack += new
        return found

    return {node for node in graph if node in reachable(node)}


def test_no_cycles_within_a_layer():
    modules = {
        path: [module for layer, module in TOOL["imports"](path) if layer == (TOOL["BASE"] if path.parent == PACKAGE else path.parent.name)]
        for path in PYTHON_FILES
    }
    assert cycles({"a": {"b"}, "b": {"a"}, "c": {"a"}}) == {"a", "b"}
    assert not cycles(graph_within([path for path in PYTHON_FILES if path.name not in ("__init__.py", "__main__.py")], modules.get))
    units = {}
    for path in CPP_FILES:
        units.setdefault(path.stem, set()).update(set(re.findall(r'#\s*include\s*"\w+/(\w+)', path.read_text(encoding="utf-8"))) - {path.stem})
    assert not cycles(units)


def test_the_reader_sees_what_it_should():
    """The parsers are not blind."""
    assert {"curve"} <= LAYERS["core"][1]["cut"] and {"spaces", "loads"} <= LAYERS["package"][1]["contact"]
    assert ("contact", "solution") in TOOL["imports"](PACKAGE / "contact" / "solver.py") and ("base", "errors") in TOOL["imports"](
        PACKAGE / "spaces" / "resolution.py"
    )


@pytest.mark.parametrize("path", CPP_FILES, ids=name_of)
def test_the_core_knows_no_python(path):
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"#\s*include\s*[<\"](pybind11|python_ngstd|python_comp|python_fem|Python\.h)", text)
    assert not re.search(r"\bpy::|\bpybind11::", text)


def test_reading_solves_nothing():
    """Stress intensity factors and pictures are read from functions, however these were found."""
    order, uses = LAYERS["package"]
    assert order.index("fracture") < order.index("contact") and order.index("plotting") < order.index("contact")


def test_the_picture_is_that_of_the_sources():
    """docs/images/architecture.svg: `python tools/architecture.py` draws it again."""
    drawn = re.search(r"<dc:description>(.*?)</dc:description>", (ROOT / "docs" / "images" / "architecture.svg").read_text(encoding="utf-8"), re.DOTALL)
    said = list(TOOL["description"]())
    assert len(said) > 12 and html.unescape(drawn[1]) == "; ".join(said)


def test_the_page_has_every_layer_in_order():
    """docs/structure.md, from the bottom."""
    rows = re.findall(r"^\| `(cpp|ngsxfem_contact)/(\w*)`([^|]*) \|", (ROOT / "docs" / "structure.md").read_text(encoding="utf-8"), re.M)
    layers = [(half, layer or TOOL["BASE"]) for half, layer, _ in rows]
    assert layers == [*(("cpp", layer) for layer in LAYERS["core"][0]), *(("ngsxfem_contact", layer) for layer in LAYERS["package"][0])]


# Size


def python_functions():
    for path in PYTHON_FILES + STUDY_FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                yield f"{name_of(path)}:{node.name}", node.end_lineno - node.lineno + 1


def test_functions_are_short():
    lengths = dict(python_functions())
    assert len(lengths) > 100
    assert {name: n for name, n in lengths.items() if n > 60} == {}
    assert sorted(lengths.values())[len(lengths) // 2] <= 10


@pytest.mark.parametrize("path", CPP_FILES + BINDING_FILES + PYTHON_FILES, ids=name_of)
def test_files_are_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


# Public names


PUBLIC = {name: value for name, value in vars(ngsxfem_contact).items() if not name.startswith("_") and not inspect.ismodule(value)}
REPLACED = {"Variation"}  # of NGSolve's names: ours varies over NGSolve's measures, too
EXPECTED = """
    BarbosaHughes ContactProblem ContactSolution Coulomb Crack CrackFESpace CrackedMesh Elasticity Jump LoadSteps Minus Nitsche NormalGap Plus Slip SolveError Strain
    TipEnrichment TraceSpace Tresca
""".split()


def test_public_names_stand_on_one_screen():
    assert set(EXPECTED) <= set(PUBLIC) and len(PUBLIC) <= 25


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


@pytest.mark.parametrize("path", PYTHON_FILES + STUDY_FILES, ids=name_of)
def test_python_has_docstrings(path):
    assert list(undocumented(ast.parse(path.read_text(encoding="utf-8")), path.stem)) == []


def test_the_extension_has_docstrings():
    assert [name for name, thing in exported() if len(written(thing, name.rpartition(".")[2])) <= 10] == []


MODULES = [importlib.import_module(f"ngsxfem_contact.{module.name}") for module in pkgutil.iter_modules(ngsxfem_contact.__path__) if module.name[0] != "_"]
EVERYWHERE = {name: getattr(module, name) for module in MODULES for name in getattr(module, "__all__", ())}


def test_names_of_the_package_are_those_of_its_parts():
    assert len(EVERYWHERE) > 50 and {name: EVERYWHERE[name] for name in PUBLIC} == PUBLIC


@pytest.mark.parametrize("name", sorted(EVERYWHERE))
def test_public_names_have_docstrings(name):
    """Beside the signature that dataclass puts where nothing was written."""
    assert len(written(EVERYWHERE[name], name)) > 10
