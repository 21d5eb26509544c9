"""What cannot be saved or read, and is said so by name."""

import hashlib
import json
import sys
from dataclasses import fields

import numpy as np
import pytest
from ngsolve import H1, Interpolate, x, y
from saved_cases import CASES, Case, push, refined, solved

from ngsxfem_contact import BarbosaHughes, ContactProblem, ContactSolution, Coulomb, pickling
from ngsxfem_contact.contact import saved
from ngsxfem_contact.contact.faces import FaceHistory, FaceWork
from ngsxfem_contact.contact.load_case import SolvedCase
from ngsxfem_contact.contact.profile import State
from ngsxfem_contact.contact.report import Report
from ngsxfem_contact.contact.saved import FORMAT, KIND
from ngsxfem_contact.errors import NotSaved
from ngsxfem_contact.files import UnreadableFile
from ngsxfem_contact.loads.reactions import SupportResidual
from ngsxfem_contact.loads.supports import HeldSide
from ngsxfem_contact.pickling import unpacked

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "step.solution"


def refuse(problem, match, path):
    """By name, before anything is written: what was there is left as it is."""
    path.write_bytes(b"older")
    with pytest.raises(NotSaved, match=match):
        problem.Solve().Save(path)
    assert path.read_bytes() == b"older" and [p.name for p in path.parent.iterdir()] == [path.name]


class WithFunction(Coulomb):
    """A law that holds a function without a name."""

    function = None


def test_functions_of_python_are_refused_by_name(path):
    V, W = CASES["friction"].Spaces()
    law = WithFunction(0.3)
    object.__setattr__(law, "function", lambda s: s)
    problem = ContactProblem(V, W, law=law)
    push(problem, V.TestFunction(), 6)
    refuse(problem, "law cannot be saved .*lambda", path)


def test_functions_that_are_not_saved_are_refused_by_name(path):
    V, W = CASES["friction"].Spaces()
    problem = ContactProblem(V, W)
    push(problem, V.TestFunction(), 6)
    problem.f += 0.01 * Interpolate(x * y, H1(V.mesh, order=1)) * V.TestFunction()[0] * V.body.dx
    refuse(problem, "term 1 of problem.f cannot be saved .*Interpolation", path)


def test_functions_that_come_back_as_others_are_refused_by_name(path, monkeypatch):
    """Each part is read again before it is written, and compared by value."""
    V, W = CASES["friction"].Spaces()
    problem = ContactProblem(V, W, gap=0.001 * x)
    push(problem, V.TestFunction(), 6)
    monkeypatch.setattr(saved, "through_pickle", lambda part: 0.002 * x if part is problem.gap else part)
    refuse(problem, "gap cannot be saved: NGSolve reads it back as another", path)


def test_traces_of_order_2_on_refined_meshes_are_refused(path):
    V, W = Case(refined, order=2, multiplier=2, trace={"basis": "trace"}).Spaces()
    problem = ContactProblem(V, W, stabilisation=BarbosaHughes())
    with pytest.raises(NotSaved, match="basis='trace'"):
        saved.check_numbers(problem)


def test_where_there_is_no_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match="no folder"):
        solved().Save(tmp_path / "none" / "step")
    with pytest.raises(FileNotFoundError):
        ContactSolution.Load(tmp_path / "none")


def changed(head):
    """The file with another first line of numbers."""

    def change(content):
        kind, line, rest = content.split(b"\n", 2)
        return b"\n".join([kind, json.dumps(json.loads(line) | head).encode(), rest])

    return change


DAMAGES = {
    "is no saved solution": lambda content: b"PK" + content,
    "is no saved solution; solution": lambda content: b"",
    "breaks off in its first lines": lambda content: content[: len(KIND) + 5],
    "is not complete": lambda content: content[:-1000],
    "is damaged": lambda content: content[:-1000] + bytes(999) + b"!",
    f"has the format {FORMAT + 1}, this version reads {FORMAT}": changed({"format": FORMAT + 1}),
    "was written with .* NGSolve 6.2.2000, this is NGSolve": changed({"ngsolve": "6.2.2000"}),
}


@pytest.mark.parametrize("match", DAMAGES)
def test_other_files_are_refused_in_words(match, path):
    solved("frictionless, P1, P0").Save(path)
    path.write_bytes(DAMAGES[match](path.read_bytes()))
    with pytest.raises(UnreadableFile, match=match):
        ContactSolution.Load(path)


def test_classes_that_are_not_there_are_refused_in_words(path, monkeypatch):
    problem = solved().problem
    problem.law = WithFunction(0.3)
    problem.Solve().Save(path)
    monkeypatch.delattr(sys.modules[__name__], "WithFunction")
    with pytest.raises(UnreadableFile, match="WithFunction.*classes and functions of your own"):
        ContactSolution.Load(path)


def test_spaces_that_are_others_are_refused(path, monkeypatch):
    """Values of u say so where the spaces were made in another way."""
    solved("refined").Save(path)
    monkeypatch.setattr(pickling, "unpacked", lambda space, values: np.roll(unpacked(space, values), 1))
    with pytest.raises(UnreadableFile, match="u is another one"):
        ContactSolution.Load(path)


def test_the_format_is_that_of_the_classes():
    """Where the fields of what is in a file change, its format does."""
    here = [sorted(f.name for f in fields(kind)) for kind in (State, FaceHistory, FaceWork, Report, SolvedCase, SupportResidual, HeldSide)]
    assert FORMAT == 2 and hashlib.sha256(repr(here).encode()).hexdigest()[:8] == "e5377120", f"raise FORMAT of contact/saved.py: {here}"
