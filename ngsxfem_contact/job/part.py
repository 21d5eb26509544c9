"""A part: the problem that a TOML file describes, and the load steps that it asks for. docs/job.md is the grammar."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..contact.load_steps import LoadSteps
from ..contact.problem import ContactProblem
from ..contact.solution import ContactSolution
from ..geometry import CrackedMesh
from . import body, conditions
from .table import RefusedPart, Table, array, boolean, number, subtable, tables, text, whole

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

EXAMPLE = Path(__file__).parents[1] / "examples" / "paper.toml"
ONE, MANY = (
    ("mesh", "displacement", "multiplier", "contact", "stabilisation", "initial", "solve", "output", "reference"),
    ("material", "crack", "law", "load", "support"),
)


@dataclass
class Part:
    """What a file describes.

    Parameters
    ----------
    title
        Of the part.
    problem
        The ContactProblem, its loads and supports included.
    factors
        Of the loads, one for each step; None: one solve with all of them.
    inverse
        The direct solver, or None.
    output, reference
        The tables of the file.
    """

    file: Path
    title: str
    problem: ContactProblem
    factors: list[float] | None
    inverse: str | None
    output: dict[str, Any]
    reference: dict[str, Any]

    def Solve(self) -> list[ContactSolution]:
        """The solution of each step. Raises as ContactProblem.Solve, RefusedPart where that raises ValueError: what is given cannot be meant."""
        with Table({}, "[solve]", self.file).Blamed():
            if self.factors is None:
                return [self.problem.Solve(inverse=self.inverse)]
            steps = LoadSteps(self.problem, inverse=self.inverse)
            return [steps.Solve(factor) for factor in self.factors]


def read_part(path: str | Path, maxh: float | None = None) -> Part:
    """The Part of a TOML file.

    Parameters
    ----------
    maxh
        In place of that of the file, whose mesh is a rectangle.

    Raises
    ------
    FileNotFoundError
        If there is none.
    """
    path = Path(path)
    top = Table(read_toml(path), "the file", path)
    values = top.Take({"title": text, **dict.fromkeys(ONE, subtable), **dict.fromkeys(MANY, tables), "friction": subtable}, ("mesh", "material", "crack"))
    one = {name: Table(values.get(name, {}), f"[{name}]", path) for name in ONE}
    many = {name: [Table(entry, f"[[{name}]] {i + 1}", path) for i, entry in enumerate(values.get(name, []))] for name in MANY}
    if "friction" in values:
        renamed = {"name" if key == "law" else key: value for key, value in values["friction"].items()}
        many["law"].append(Table(renamed, "[friction]", path))
    if maxh is not None:
        if "rectangle" not in one["mesh"].values:
            one["mesh"].Refuse("another size is asked for, but the mesh is read from a file, which has its size")
        one["mesh"].values["maxh"] = maxh
    solve = one["solve"].Take({"factors": array(number, "a list of numbers"), "inverse": text})
    output, reference = output_of(one["output"]), reference_of(one["reference"])
    problem = problem_of(one, many, values)
    for key, things in (("contact_force", "cracks"), ("transitions", "cracks"), ("K", "tips")):
        known, there = len(reference.get(key, [])), len(getattr(problem.body, things))
        if known > there:
            one["reference"].Refuse(f"it has {known} entries, one for each of the {things}, of which there are {there}", key)
    return Part(path, values.get("title", path.stem), problem, solve.get("factors"), solve.get("inverse"), output, reference)


def read_toml(path: Path) -> dict[str, Any]:
    """The file as a dictionary."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError as error:
        raise RefusedPart(f"{path} is no TOML file, whose text is in UTF-8: {error}; save it as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise RefusedPart(f"{path} is no TOML file: {error}") from None


def problem_of(one: dict[str, Table], many: dict[str, list[Table]], values: dict[str, Any]) -> ContactProblem:
    """The ContactProblem of the tables."""
    for name in ("material", "crack"):
        if not many[name]:
            raise RefusedPart(f"{one['mesh'].file}: [[{name}]]: there is none")
    mesh = body.mesh_of(one["mesh"])
    material = body.material_of(many["material"], mesh)
    cracks = [body.crack_of(table, mesh) for table in many["crack"]]
    with Table({}, "[[crack]]", one["mesh"].file).Blamed():
        cracked = CrackedMesh(mesh, *cracks)
    V = body.displacements(one["displacement"], cracked, material, conditions.held_by(many["support"], mesh))
    W = body.multipliers(one["multiplier"], cracked)
    options = conditions.contact_options(one["contact"]) | conditions.initial_options(one["initial"])
    if "stabilisation" in values:
        options["stabilisation"] = conditions.stabilisation_of(one["stabilisation"])
    options["law"] = conditions.laws_of(many["law"], cracked)
    with Table({}, "[contact], [initial], [[law]]", one["mesh"].file).Blamed():
        problem = ContactProblem(V, W, **options)
    for table in many["load"]:
        conditions.add_load(table, problem)
    for table in many["support"]:
        conditions.add_support(table, problem)
    return problem


def output_of(table: Table) -> dict[str, Any]:
    """[output]."""
    values = table.Take({"folder": text, "points": whole, "vtk": boolean, "pictures": boolean})
    if not 2 <= values.get("points", 2) <= 1_000_000:
        table.Refuse(f"{values['points']} must lie between 2 and 1000000", "points")
    return values


def reference_of(table: Table) -> dict[str, Any]:
    """[reference]."""
    rows = array(array(number, ROWS, 0), ROWS)
    return table.Take({"from": text, "energy": number, "contact_force": array(number, "a list of numbers, one for each crack"), "transitions": rows, "K": rows})


ROWS = "a list of lists of numbers"
