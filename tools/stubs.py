"""Writes ngsxfem_contact/_ngsxfem_contact.pyi, the types of the extension, from the extension that is installed.

python tools/stubs.py [folder]         needs pybind11-stubgen and ruff, `make stubs` brings both
"""

import ast
import subprocess
import sys
import tempfile
from pathlib import Path

NAME = "_ngsxfem_contact"
TYPES = {
    "pyngcore.pyngcore.BitArray = None": "pyngcore.pyngcore.BitArray | None = None",
    "ngsolve.comp.FESpace = None": "ngsolve.comp.FESpace | None = None",
    "-> tuple:": "-> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:",  # OnCrack, BorderedMatrix
    "*args": "*cracks: Crack",  # of Crack.Join and CrackedMesh
    "**kwargs": "**flags: typing.Any",  # of NGSolve's spaces and forms
    "typing.SupportsInt | typing.SupportsIndex": "int",
    "typing.SupportsFloat | typing.SupportsIndex": "float",
}
LEFT_OUT = {"__getstate__", "__setstate__", "__flags_doc__", "__eq__", "__ne__", "__hash__", "__str__", "__repr__"}  # those of every object


ENUMERATION = ast.parse(
    '''
class _Enumeration:
    """What all enumerations have, for the reader of types: each derives from object."""
    __members__: typing.ClassVar[dict[str, typing.Any]]
    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
'''
).body[0]


class Shortened(ast.NodeTransformer):
    """Without what every Python object has, and what every enumeration has in one class."""

    def visit_FunctionDef(self, node):
        return None if node.name in LEFT_OUT else node

    def visit_ClassDef(self, node):
        named = lambda statement: getattr(statement, "name", None) or getattr(getattr(statement, "target", None), "id", None)
        shared = {named(statement) for statement in ENUMERATION.body if named(statement)}
        if "__members__" in map(named, node.body) and node.name != ENUMERATION.name:
            node.bases = [ast.Name(ENUMERATION.name)]
            node.body = [statement for statement in node.body if named(statement) not in shared]
        return self.generic_visit(node)

    def visit_Module(self, node):
        first = next(i for i, statement in enumerate(node.body) if isinstance(statement, ast.ClassDef))
        if node.body[first].name != ENUMERATION.name:
            node.body.insert(first, ENUMERATION)
        return self.generic_visit(node)


def generated():
    """What pybind11-stubgen writes."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pybind11_stubgen", f"ngsxfem_contact.{NAME}", "-o", folder]
        subprocess.run(command, check=True, capture_output=True)
        return Path(folder, "ngsxfem_contact", f"{NAME}.pyi").read_text(encoding="utf-8")


def shortened(text):
    for long, short in TYPES.items():
        text = text.replace(long, short)
    text = ast.unparse(Shortened().visit(ast.parse(text)))
    command = [sys.executable, "-m", "ruff", "format", "--isolated", "--line-length", "160", "--stdin-filename", "stub.pyi", "-"]
    return subprocess.run(command, input=text, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1] / "ngsxfem_contact"
    (folder / f"{NAME}.pyi").write_text("# By tools/stubs.py.\n\n" + shortened(generated()), encoding="utf-8")
