"""Docstrings in numpydoc's sections: what users call has Parameters for each argument, with the names of the signature."""

import ast
import importlib
import inspect
import re
from pathlib import Path

import pytest

import ngsxfem_contact
from ngsxfem_contact import _ngsxfem_contact as extension
from ngsxfem_contact import protocols

PACKAGE = Path(ngsxfem_contact.__file__).parent
SECTIONS = ["Parameters", "Attributes", "Returns", "Other Parameters", "Raises", "Warns", "Notes", "References", "Examples"]
STUB = ast.parse((PACKAGE / "_ngsxfem_contact.pyi").read_text(encoding="utf-8"))
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}


def sections(docstring):
    """Name of a section → its lines; "" the text above the first."""
    parts = re.split(r"^(\w[\w ]*)\n-+$", docstring, flags=re.M)
    return {"": parts[0], **{name: text.strip("\n").splitlines() for name, text in zip(parts[1::2], parts[2::2])}}


def described(docstring, section="Parameters"):
    """The names in a section, stars left out, in order."""
    heads = [line.split(" : ")[0] for line in sections(docstring).get(section, []) if not line.startswith(" ")]
    return [name.lstrip("*") for head in heads for name in head.split(", ") if name]


def modules():
    """(module, names that users import from it): the package, the folders that have an __all__."""
    yield ngsxfem_contact, ngsxfem_contact.__all__
    for folder in sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py")):
        module = importlib.import_module(f"ngsxfem_contact.{folder}")
        if hasattr(module, "__all__"):
            yield module, module.__all__


def public():
    """(name, object) of what users import, and of the public methods of its classes, those of the extension left out."""
    for module, names in modules():
        for name in names:
            thing = getattr(module, name)
            if name.startswith("_") or not callable(thing) or isinstance(thing, type) and issubclass(thing, (BaseException, ast.AST)):
                continue
            if getattr(thing, "__module__", "").startswith("ngsxfem_contact.") and not thing.__module__.endswith("_ngsxfem_contact"):
                yield name, thing
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                value = getattr(value, "__func__", value)
                if not member.startswith("_") and inspect.isfunction(value):
                    yield f"{name}.{member}", value


PUBLIC = dict(public())


def arguments(thing):
    """Of a function, or of the constructor of a class."""
    return [name for name in inspect.signature(thing).parameters if name not in ("self", "cls")]


def described_once(thing):
    """Names that stand once for several functions: in Other Parameters of the class, or of the module."""
    module = importlib.import_module(thing.__module__)
    owner, _, member = thing.__qualname__.partition(".")
    holder = getattr(module, owner) if member and hasattr(module, owner) else module
    return described(inspect.getdoc(holder) or "", "Other Parameters")


ROLES = [role for role in vars(protocols).values() if getattr(role, "_is_protocol", False) and role is not protocols.Protocol]


def in_a_role(name):
    """Whether a method has its contract in a protocol, all members of which its class has."""
    owner, _, member = name.partition(".")
    has = {*dir(PUBLIC.get(owner)), *getattr(PUBLIC.get(owner), "__dataclass_fields__", ())}
    return any(member in protocols.members(role) and has >= set(protocols.members(role)) for role in ROLES)


def inherited(name):
    """Whether a method has its contract in a class above."""
    owner, _, member = name.partition(".")
    return bool(member) and any(member in vars(base) for base in getattr(PUBLIC.get(owner), "__mro__", ())[1:])


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_every_argument_of_what_users_call_is_described(name):
    """In its own docstring, or once for several functions, in the protocol of the role, or in the class above."""
    thing = PUBLIC[name]
    names, docstring = described(inspect.getdoc(thing)), inspect.getdoc(thing)
    if getattr(thing, "_is_protocol", False):
        return
    elsewhere = in_a_role(name) or inherited(name)
    assert len(set(names)) == len(names) and set(names) <= set(arguments(thing))
    assert elsewhere or set(names) | set(described_once(thing)) >= set(arguments(thing))
    assert names == [argument for argument in arguments(thing) if argument in names]
    headings = [heading for heading in sections(docstring) if heading]
    assert headings == [heading for heading in SECTIONS if heading in headings]
    assert all(len(lines) > 0 for lines in sections(docstring).values())


def extension_callables():
    """(class, name, arguments, docstring) of the methods of the classes that users import from the extension, and of what they receive."""
    for name, node in CLASSES.items():
        for method in node.body:
            if isinstance(method, ast.FunctionDef) and not method.decorator_list and (not method.name.startswith("_") or method.name == "__call__"):
                found = [a.arg for a in method.args.posonlyargs + method.args.args if a.arg != "self"]
                yield f"{name}.{method.name}", found, inspect.getdoc(getattr(getattr(extension, name), method.name)) or ""


def test_arguments_of_the_extension_are_described():
    """In a section, or in the one sentence there is."""
    missing = []
    for name, names, docstring in extension_callables():
        text = re.sub(r"\A.*$", "", docstring, count=1, flags=re.M)  # the signature that pybind11 writes
        if "Parameters\n---" in text:
            assert described(text) == names, name
        else:
            said = re.sub(r"[ _]", "", text.lower())
            missing += [f"{name}: {argument}" for argument in names if not re.search(re.escape(argument.replace("_", "").lower()), said)]
    assert missing == []


def test_the_classes_of_the_extension_that_users_make_are_described():
    assert described(ngsxfem_contact.Crack.__doc__) == ["points", "name"]


def written_docstrings():
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
                yield f"{path.relative_to(PACKAGE)}:{node.name}", ast.get_docstring(node)


def test_sections_have_the_names_and_the_order_of_numpydoc():
    """And no argument is described in the lines above them, as "name: what it is.    other: ..."."""
    wrong = {}
    for name, docstring in written_docstrings():
        headings = [heading for heading in sections(docstring) if heading]
        if headings != [heading for heading in SECTIONS if heading in headings] or re.search(r"\S {4,}\w+: ", docstring):
            wrong[name] = headings
    assert wrong == {}


def test_the_reader_of_sections_is_not_blind():
    docstring = "Does it.\n\nParameters\n----------\nx, y : float\n    Where.\n*more\n    Others.\n\nRaises\n------\nValueError\n    For z."
    assert described(docstring) == ["x", "y", "more"] and described(docstring, "Raises") == ["ValueError"]
    assert list(sections(docstring)) == ["", "Parameters", "Raises"] and len(PUBLIC) > 60
    assert {"ContactProblem", "ContactProblem.Pin", "Jump", "Crack.Spline"} <= PUBLIC.keys() and "Crack" not in PUBLIC
    assert len(list(extension_callables())) >= 30
