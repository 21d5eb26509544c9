"""Writes ngsxfem_contact/_ngsxfem_contact.pyi, the types of the extension, from the extension that is installed.

python tools/stubs.py [folder]         needs pybind11-stubgen and ruff, `make stubs` brings both
"""

import ast
import re
import subprocess
import sys
import tempfile
from pathlib import Path

NAME = "_ngsxfem_contact"
TYPES = {
    "pyngcore.pyngcore.BitArray = None": "pyngcore.pyngcore.BitArray | None = None",
    "ngsolve.comp.FESpace = None": "ngsolve.comp.FESpace | None = None",
    "-> tuple:": "-> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:",  # OnCrack, BorderedMatrix
    "-> list:": "-> list[tuple[numpy.ndarray, numpy.ndarray]]:",  # BoundaryDofs
    "body: ...)": "body: CrackedMesh)",  # of NumKeptRules, exported before its class
    "*args": "*cracks: Crack",  # of Crack.Join and CrackedMesh
    "mesh: ngsolve.comp.Mesh, *cracks: Crack)": "mesh: ngsolve.comp.Mesh, *cracks: Crack | Sheet)",
    " -> BaseMatrix:": " -> ngsolve.la.BaseMatrix:",
    "def body(self) -> object": "def body(self) -> CrackedMesh",  # of FormTerm
    "**kwargs": "**flags: typing.Any",  # of NGSolve's spaces and forms
    "typing.SupportsInt | typing.SupportsIndex": "int",
    "typing.SupportsFloat | typing.SupportsIndex": "float",
    "def Points(self, order: int, space: ngsolve.comp.FESpace | None = None) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:": "def Points(self, order: int, space: ngsolve.comp.FESpace | None = None) -> tuple[numpy.ndarray, ...]:",
    "def Parts(self, element: int) -> list[tuple[numpy.ndarray, numpy.ndarray]]:": "def Parts(self, element: int) -> list[PartTriangle]:",
}
LEFT_OUT = {"__getstate__", "__setstate__", "__flags_doc__", "__eq__", "__ne__", "__hash__", "__str__", "__repr__"}  # those of every object


OF_ENUMERATIONS = {"__index__", "__init__", "__int__", "name", "value"}


def is_enumeration(node):
    return isinstance(node, ast.ClassDef) and any(isinstance(s, ast.AnnAssign) and s.target.id == "__members__" for s in node.body)


def summary(docstring):
    """Its first paragraph below the signatures that pybind11 writes: the rest is in the extension itself."""
    return re.split(r"\n\s*\n", docstring.strip())[0]


class Shortened(ast.NodeTransformer):
    """With the first paragraphs of docstrings, and without what every Python object has; what every enumeration has in one class, for the reader of types: each derives from object."""

    def visit_FunctionDef(self, node):
        return None if node.name in LEFT_OUT else self.generic_visit(node)

    def visit_Constant(self, node):
        return ast.Constant(summary(node.value)) if isinstance(node.value, str) and "\n" in node.value else node

    def visit_ClassDef(self, node):
        if is_enumeration(node):
            node.bases, node.body = [ast.Name("_Enumeration")], [s for s in node.body if getattr(s, "name", None) not in OF_ENUMERATIONS]
        return self.generic_visit(node)

    def visit_Module(self, node):
        first = next(statement for statement in node.body if is_enumeration(statement))
        shared = [statement for statement in first.body if getattr(statement, "name", None) in OF_ENUMERATIONS]
        node = self.generic_visit(node)
        node.body.insert(node.body.index(first), ast.ClassDef("_Enumeration", [], [], shared, []))
        return node


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
