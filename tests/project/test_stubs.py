"""The stub of the extension says what the extension has."""

import ast
import inspect
import re
from pathlib import Path

import pytest

import ngsxfem_contact
from ngsxfem_contact import _ngsxfem_contact as extension

STUB = Path(ngsxfem_contact.__file__).with_name("_ngsxfem_contact.pyi")
TREE = ast.parse(STUB.read_text(encoding="utf-8"))
CLASSES = {node.name: node for node in TREE.body if isinstance(node, ast.ClassDef) and node.name != "_Enumeration"}
OF_EVERY_OBJECT = re.compile(
    r"__(getstate|setstate|flags_doc|eq|ne|hash|str|repr|module|doc|reduce(_ex)?|pybind11\w*|dict|weakref)__|__entries|_pybind11_conduit_v1_"
)


def arguments(function):
    return [argument.arg for argument in function.args.posonlyargs + function.args.args]


def documented(function):
    """Argument names that pybind11 writes on the first line of a docstring: name(self: Type, order: int = 0) -> Type."""
    signature = inspect.getdoc(function).splitlines()[0]
    signature = re.sub(r'"[^"]*"', "", signature)
    inside = signature[signature.index("(") + 1 : signature.rindex(")")]
    while re.search(r"[\[(][^\[\]()]*[\])]", inside):  # types have commas inside brackets
        inside = re.sub(r"[\[(][^\[\]()]*[\])]", "", inside)
    return [part.split(":")[0].strip() for part in inside.split(",") if not part.strip().startswith("*")]


def test_ships_with_the_package():
    assert STUB.with_name("py.typed").exists()


def test_names():
    exported = {name for name in vars(extension) if not name.startswith("_")}
    functions = {node.name for node in TREE.body if isinstance(node, ast.FunctionDef)}
    assert exported == set(CLASSES) | functions


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_members(name):
    """`make stubs` writes the stub anew."""
    members = {member for member in vars(getattr(extension, name)) if not OF_EVERY_OBJECT.fullmatch(member)}
    described = {node.name for node in CLASSES[name].body if isinstance(node, ast.FunctionDef)}
    described |= {node.target.id for node in CLASSES[name].body if isinstance(node, ast.AnnAssign)}
    if [base.id for base in CLASSES[name].bases if isinstance(base, ast.Name)] == ["_Enumeration"]:
        described |= {"__index__", "__init__", "__int__", "name", "value"}
    assert described == members - ({"__init__"} - described)


def words(text):
    return (text or "").split()


def below_signatures(text, name):
    """A docstring without the lines that pybind11 writes itself."""
    return re.sub(rf"^(\d+\. )?{name}\(.*$|^Overloaded function\.$", "", text or "", flags=re.M)


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_docstrings(name):
    """Those of the stub are the first paragraphs of those of the extension, below the signatures that pybind11 writes."""
    things = {node.name: (node, vars(getattr(extension, name))[node.name]) for node in CLASSES[name].body if isinstance(node, ast.FunctionDef)}
    for node, thing in [(CLASSES[name], getattr(extension, name)), *things.values()]:
        described = words(ast.get_docstring(node))
        found = words(below_signatures(getattr(thing, "__func__", thing).__doc__, node.name))
        assert bool(described) is bool(found) and " ".join(described) in " ".join(found), node.name


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_arguments(name):
    for node in CLASSES[name].body:
        function = vars(getattr(extension, name)).get(getattr(node, "name", None))
        if isinstance(node, ast.FunctionDef) and not node.decorator_list and not node.name.startswith("__"):
            assert arguments(node) == documented(function), node.name
