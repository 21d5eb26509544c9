"""Solutions in files: written whole or not at all, and read only where what was saved comes back.

A file is a line that says what it is, one with versions and the size and digest of the rest, and a pickle. Spaces, rules and supports are made again from mesh, cracks
and arguments; coefficients are saved in an order that does not depend on numbers (`pickling.numbering`), and values of u at some points say whether they mean the same.
"""

from __future__ import annotations

import hashlib
import io
import json
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CoefficientFunction, FESpace, GridFunction, Mesh
from ngsolve import __version__ as NGSOLVE

from .. import _ngsxfem_contact as core
from .._version_check import VERSION
from ..errors import NotSaved
from ..files import UnreadableFile, write_whole
from ..loads.load import PointLoad, StiffnessForm, form_of
from ..pickling import numbering, packed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .problem import ContactProblem
    from .solution import ContactSolution

KIND = b"ngsxfem_contact solution\n"
FORMAT = 2  # raise it where the classes in a file change
SAME, AGAIN = 1e-12, 1e-9  # relative: what was read again is what was saved, on the same spaces, and on those that were made again
SAMPLES = 500  # elements in which u is looked at


def save(solution: ContactSolution, path: str | Path) -> Path:
    """See ContactSolution.Save."""
    solution.u  # recovered and checked before anything else
    check_numbers(solution.problem)
    for name, part in parts(solution.problem):
        check_part(name, part, solution)
    content = pickled(solution)
    head = {"format": FORMAT, "ngsxfem_contact": VERSION, "ngsolve": NGSOLVE, "bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    whole = KIND + json.dumps(head).encode() + b"\n" + content
    return write_whole(Path(path), lambda temporary: temporary.write_bytes(whole))


def pickled(solution: ContactSolution) -> bytes:
    """The solution, and what `probe` finds."""
    try:
        return pickle.dumps((solution, probe(solution)), protocol=5)
    except Exception as error:  # of NGSolve, of pickle, of an own object
        raise NotSaved(f"Save: the solution cannot be saved: {reason(error)}") from error


def load(path: str | Path) -> ContactSolution:
    """See ContactSolution.Load."""
    content = checked_content(path)
    try:
        solution, values = pickle.loads(content)
    except Exception as error:
        raise UnreadableFile(
            f"{path} cannot be read: {reason(error)}; classes and functions of your own in the problem must have the names and modules here that they had where it was saved"
        ) from error
    for (name, before), (_, after) in zip(values, probe(solution), strict=True):
        if not agree(before, after, AGAIN):
            raise UnreadableFile(f"{path}: {name} is another one than that which was saved, on the spaces that were made again; solve the problem again")
    return solution


def checked_content(path: str | Path) -> bytes:
    """The pickle of a file; raises UnreadableFile unless the file is one of ours, of this format, complete, and of this NGSolve."""
    with open(path, "rb") as file:
        if file.read(len(KIND)) != KIND:
            raise UnreadableFile(f"{path} is no saved solution; solution.Save(path) writes one")
        line, content = file.readline(), file.read()
    try:
        head = json.loads(line)
        made = "{ngsxfem_contact} and NGSolve {ngsolve}".format(**head)
    except (ValueError, KeyError, TypeError):
        raise UnreadableFile(f"{path} breaks off in its first lines, or was changed; save the solution again") from None
    if head["format"] != FORMAT:
        raise UnreadableFile(f"{path} has the format {head['format']}, this version reads {FORMAT}; read it with ngsxfem_contact {made}, which wrote it")
    if head["ngsolve"] != NGSOLVE:
        raise UnreadableFile(
            f"{path} was written with ngsxfem_contact {made}, this is NGSolve {NGSOLVE}, which may number meshes in another way; read it there"
        )
    if len(content) != head["bytes"]:
        raise UnreadableFile(f"{path} has {len(content)} bytes of the {head['bytes']} that were saved: it is not complete; copy it, or save the solution again")
    if hashlib.sha256(content).hexdigest() != head["sha256"]:
        raise UnreadableFile(f"{path} is damaged: its content is not what was saved; copy it, or save the solution again")
    return content


def reason(error: Exception) -> str:
    """An exception in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def agree(before: np.ndarray, after: np.ndarray, tolerance: float) -> bool:
    """Whether values are the same, relative to the largest."""
    return before.shape == after.shape and np.allclose(before, after, rtol=tolerance, atol=tolerance * np.abs(before).max(initial=0), equal_nan=True)


def probe(solution: ContactSolution) -> list[tuple[str, np.ndarray]]:
    """Names and values: of u in some elements, those that cracks meet among them, and of what the problem was given."""
    body = solution.body
    numbers = np.unique(np.linspace(0, body.mesh.ne - 1, SAMPLES).astype(int))
    beside = np.array([location.element for c in range(len(body.cracks)) for location in body.Elements(c)], dtype=int)
    numbers = np.union1d(numbers, beside[:: max(1, len(beside) // SAMPLES)])
    points = body.mesh(np.full(len(numbers), 0.5), np.full(len(numbers), 0.5))
    points["nr"], points["x"], points["y"] = numbers, 0.21, 0.34
    of_parts = [(name, values) for name, part in parts(solution.problem) for values in values_of(part, solution)]
    return [("u", np.ravel(solution.u(points))), *of_parts]


# What is refused before anything is written


def check_numbers(problem: ContactProblem) -> None:
    """Raises NotSaved for multipliers that are numbered by the edges of a refined mesh, which are other ones when it is read."""
    W = problem.W
    if isinstance(W.basis, core.MeshTraceBasis) and W.order > 1 and W.mesh.levels > 1:
        raise NotSaved("Save: TraceSpace(basis='trace') of order 2 or more on a refined mesh cannot be saved; take basis='nodal'")


def parts(problem: ContactProblem) -> Iterator[tuple[str, Any]]:
    """What a user gave to a problem, with names for it."""
    yield "material", problem.material
    yield "stabilisation", problem.stabilisation
    yield "law", problem.law
    yield "gap", problem.gap
    yield "temperature", problem.temperature
    for number, given in enumerate(problem.initial.given):
        yield f"stress {number} of initial_stress and temperature", OneTerm(given)
    for number, given in enumerate(problem.f.given):
        yield f"term {number} of problem.f", OneTerm(given)
    for number, term in enumerate(problem.a.terms):
        yield f"term {number} of problem.a", OneSpring(term)


@dataclass(frozen=True)
class OneTerm:
    """One term of a load, compared by its vector."""

    given: Any

    def Values(self, solution: ContactSolution) -> np.ndarray:
        """Moments of F of this term alone."""
        V = solution.problem.V
        return moments(V, form_of(V, [self.given.form if isinstance(self.given, PointLoad) else self.given.term]).Vector())


@dataclass(frozen=True)
class OneSpring:
    """One term of problem.a, compared by what it exerts on the solution and on a function that is none."""

    term: Any

    def Values(self, solution: ContactSolution) -> np.ndarray:
        """Moments of what it exerts."""
        V = solution.problem.V
        form, function = StiffnessForm(V), GridFunction(V)
        form.terms = [self.term]
        order = numbering(V)
        function.vec.FV().NumPy()[order] = np.cos(np.arange(len(order)))
        return moments(V, form.Forces(function))


def moments(V: FESpace, vector: np.ndarray) -> np.ndarray:
    """Some sums over a vector that do not depend on the numbers of its unknowns, the last that of its absolute values."""
    values = packed(V, vector)
    return np.array([*np.cos(np.outer(np.arange(1, 9), np.arange(len(values)))) @ values, np.abs(values).sum()])


def check_part(name: str, part: Any, solution: ContactSolution) -> None:
    """Raises NotSaved unless a part comes back from pickle with the values that it has; mesh, body, spaces and GridFunctions, which all parts share, are left in place."""
    try:
        copy = through_pickle(part)
    except Exception as error:
        raise NotSaved(
            f"Save: {name} cannot be saved ({reason(error)}); functions of Python must have a name in a module, and functions of NGSolve that it does not save "
            "can be interpolated by a GridFunction"
        ) from error
    for before, after in zip(values_of(part, solution), values_of(copy, solution), strict=True):
        if not agree(before, after, SAME):
            raise NotSaved(f"Save: {name} cannot be saved: NGSolve reads it back as another function; interpolate it by a GridFunction")


def through_pickle(part: Any) -> Any:
    """A part, written and read."""
    kept: dict[str, Any] = {}

    class Writer(pickle.Pickler):
        def persistent_id(self, obj: Any) -> str | None:
            if not isinstance(obj, (Mesh, core.CrackedMesh, FESpace, GridFunction)):
                return None
            kept[str(id(obj))] = obj
            return str(id(obj))

    class Reader(pickle.Unpickler):
        def persistent_load(self, name: str) -> Any:
            return kept[name]

    buffer = io.BytesIO()
    Writer(buffer, protocol=5).dump(part)
    return Reader(io.BytesIO(buffer.getvalue())).load()


def values_of(part: Any, solution: ContactSolution, seen: tuple[int, ...] = ()) -> Iterator[np.ndarray]:
    """What a part is compared by: the vectors of forms, and the values on the cracks of the functions in it; seen: objects that it is part of."""
    if isinstance(part, (OneTerm, OneSpring)):
        yield part.Values(solution)
    elif isinstance(part, CoefficientFunction):
        yield solution.state.nodes.Values(part)
    elif id(part) not in seen and not isinstance(part, type):
        inside = part.values() if isinstance(part, dict) else part if isinstance(part, (list, tuple)) else getattr(part, "__dict__", {}).values()
        for value in inside:
            yield from values_of(value, solution, (*seen, id(part)))
