"""What a part is subject to: contact, laws of the faces, loads, supports."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from ngsolve import CF, CoefficientFunction

from ..algebra import FixedPoint, FullNewton
from ..arguments import INFINITY, crack_number, crack_title
from ..contact.cones import CONES
from ..contact.friction import Coulomb, Tresca
from ..contact.laws import BartonBandis, Dugdale, ExponentialCohesive, Joint, LinearCohesive, MohrCoulomb
from ..contact.nitsche import Nitsche
from ..contact.stabilisation import BarbosaHughes, BothSides
from ..operators import Jump
from .table import array, boolean, choice, formula, number, point, subtable, text, two_formulas, vector, which, whole

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ngsolve import Mesh

    from .._ngsxfem_contact import CrackedMesh
    from ..contact.problem import ContactProblem
    from ..material import Coefficient
    from ..protocols import FaceLaw, Stabilisation
    from .table import Kind, Table

    Choices: TypeAlias = Mapping[str, tuple[Callable[..., Any], dict[str, Kind]]]  # name → (class, kinds of its arguments)

# Contact


def contact_options(table: Table) -> dict[str, Any]:
    """cone=, gap= of ContactProblem, from [contact]."""
    return table.Take({"cone": choice(*CONES), "gap": formula})


STABILISATIONS: Choices = {
    "BarbosaHughes": (BarbosaHughes, {"gamma0": number, "theta": number}),
    "BothSides": (BothSides, {"gamma0": number, "weight": number}),
    "Nitsche": (Nitsche, {"theta": whole, "gamma0": number, "coercivity": number, "points": whole}),
    "none": (lambda: None, {}),
}


def stabilisation_of(table: Table) -> Stabilisation | None:
    """The object of [stabilisation], or None."""
    return chosen(table, "method", STABILISATIONS)


METHODS: Choices = {"FullNewton": (FullNewton, {}), "FixedPoint": (FixedPoint, {"tolerance": number, "max_iterations": whole})}


def laws_of(tables: list[Table], body: CrackedMesh) -> dict[int, FaceLaw] | FaceLaw | None:
    """The law of the faces from all [[law]]: of each crack its own where tables name cracks."""
    laws: dict[int | None, FaceLaw] = {}
    for table in tables:
        crack = None
        if "crack" in table.values:
            with table.Blamed():
                crack = crack_number(table.Convert("crack", which), body)
        if crack in laws:
            table.Refuse("another table gives " + ("the law of all cracks" if crack is None else f"the law of {crack_title(body.cracks, crack)}"), "crack")
        laws[crack] = law_of(table)
    if set(laws) <= {None}:
        return laws.get(None)
    everywhere = dict.fromkeys(range(len(body.cracks)), laws[None]) if None in laws else {}
    return everywhere | {crack: law for crack, law in laws.items() if crack is not None}


def law_of(table: Table) -> FaceLaw:
    """The object of one [[law]]."""

    def method(value: Any) -> Any:
        return chosen(type(table)(subtable(value), f"{table.name}, method", table.file), "name", METHODS)

    laws: Choices = {
        "Coulomb": (Coulomb, {"mu_f": formula, "method": method}),
        "Tresca": (Tresca, {"s": formula, "in_contact_only": boolean}),
        "MohrCoulomb": (MohrCoulomb, {"mu_f": formula, "cohesion": formula, "dilation": formula, "k_n": stiffness, "k_t": stiffness}),
        "BartonBandis": (BartonBandis, {"k_n0": formula, "v_m": formula, "mu_f": formula}),
        "Joint": (Joint, {"k_n": stiffness, "k_t": stiffness, "k_closed": stiffness}),
        "LinearCohesive": (LinearCohesive, {"strength": formula, "G_c": formula, "beta": formula}),
        "ExponentialCohesive": (ExponentialCohesive, {"strength": formula, "G_c": formula, "beta": formula}),
        "Dugdale": (Dugdale, {"strength": formula, "beta": formula}),
    }
    return chosen(table, "name", laws, {"crack": which})


def stiffness(value: Any) -> Coefficient:
    """A number, inf or a formula."""
    return INFINITY if value == INFINITY else formula(value)


def chosen(table: Table, key: str, classes: Choices, beside: Mapping[str, Kind] = {}) -> Any:
    """The object of one of some classes, name → (class, kinds of its arguments), named by a key; beside: keys that are no arguments."""
    if key not in table.values:
        table.Refuse(f"the key is missing; it is one of {', '.join(classes)}", key)
    name = choice(*classes)
    make, kinds = classes[table.Convert(key, name)]
    values = table.Take({key: name, **kinds, **beside})
    with table.Blamed():
        return make(**{argument: value for argument, value in values.items() if argument in kinds})


def initial_options(table: Table) -> dict[str, Any]:
    """initial_stress=, temperature= of ContactProblem, from [initial]."""
    rows = array(array(formula, MATRIX, 2, 2), MATRIX, 2, 2)
    values = table.Take({"stress": lambda value: CF(tuple(entry for row in rows(value) for entry in row), dims=(2, 2)), "temperature": formula})
    return {{"stress": "initial_stress"}.get(key, key): value for key, value in values.items()}


MATRIX = "a matrix [[xx, xy], [xy, yy]] of numbers or formulas"


# Loads


def add_load(table: Table, problem: ContactProblem) -> None:
    """Adds one [[load]] to a problem."""
    kind = table.OneOf(LOADS)
    with table.Blamed():
        LOADS[kind](table, problem)


def body_force(table: Table, problem: ContactProblem) -> None:
    """∫f·v over the body, or over a region of it."""
    values = table.Take({"body_force": vector, "region": text, "bonus_intorder": whole})
    force = values.pop("body_force")
    problem.f += force * problem.V.TestFunction() * problem.body.dx(**definedon(table, problem, "region", values))


def traction(table: Table, problem: ContactProblem) -> None:
    """∫t·v over a part of the boundary."""
    values = table.Take({"traction": vector, "boundary": text, "bonus_intorder": whole}, ["traction", "boundary"])
    force = values.pop("traction")
    problem.f += force * problem.V.TestFunction() * problem.body.ds(**definedon(table, problem, "boundary", values))


def pressure(table: Table, problem: ContactProblem) -> None:
    """∫-p n·v over a part of the boundary."""
    values = table.Take({"pressure": formula, "boundary": text, "bonus_intorder": whole}, ["pressure", "boundary"])
    matched(table, "boundary", problem.V.mesh)
    problem.Pressure(values.pop("pressure"), values.pop("boundary"), **values)


def point_force(table: Table, problem: ContactProblem) -> None:
    """F·v at a point."""
    values = table.Take({"point_force": array(number, "two numbers [x, y]", 2, 2), "at": point}, ["point_force", "at"])
    if not problem.V.mesh.Contains(*values["at"]):
        table.Refuse(f"{values['at']} is not in the body", "at")
    for k, component in enumerate(values["point_force"]):
        if component:
            problem.f += (component * problem.V.TestFunction()[k])(*values["at"])


def face_pressure(table: Table, problem: ContactProblem) -> None:
    """ContactProblem.FacePressure."""
    values = table.Take({"face_pressure": formula, "crack": which, "bonus_intorder": whole})
    problem.FacePressure(values.pop("face_pressure"), **values)


def face_traction(table: Table, problem: ContactProblem) -> None:
    """ContactProblem.FaceTraction."""
    values = table.Take({"face_traction": subtable, "crack": which, "bonus_intorder": whole})
    inner = type(table)(values.pop("face_traction"), f"{table.name}, face_traction", table.file)
    sides = inner.Take({"plus": two_formulas, "minus": two_formulas})
    if not sides:
        table.Refuse("it has neither plus nor minus; give one of them or both", "face_traction")
    problem.FaceTraction(**sides, **values)


def not_zero(value: Any) -> bool:
    """Whether a formula is a function, or another number than zero: NGSolve's forms do not survive terms that are zero."""
    return isinstance(value, CoefficientFunction) or value != 0


LOADS = {
    "body_force": body_force,
    "traction": traction,
    "pressure": pressure,
    "point_force": point_force,
    "face_pressure": face_pressure,
    "face_traction": face_traction,
}


def definedon(table: Table, problem: ContactProblem, key: str, values: dict[str, Any]) -> dict[str, Any]:
    """The options of a measure: values, with the name of a region or of a boundary under the name that measures have for it."""
    if key in values:
        part = matched(table, key, problem.V.mesh)
        values = {name: value for name, value in values.items() if name != key} | {"definedon": part}
    return values


def matched(table: Table, key: str, mesh: Mesh) -> Any:
    """The Region of a name or regular expression of the mesh. Refuses one that matches nothing."""
    find, names = {"region": (mesh.Materials, mesh.GetMaterials), "boundary": (mesh.Boundaries, mesh.GetBoundaries)}[key]
    part = find(table.values[key])
    if not part.Mask().NumSet():
        table.Refuse(f"{table.values[key]!r} matches no {key}; the mesh has {', '.join(sorted(set(names())))}", key)
    return part


# Supports


def held_by(entries: list[Table], mesh: Mesh) -> dict[str, str]:
    """dirichlet=, dirichletx=, dirichlety= of CrackFESpace, from the [[support]] tables of boundaries."""
    held, taken = {"dirichlet": [], "dirichletx": [], "dirichlety": []}, {}
    for table in entries:
        if kind_of_support(table) == "boundary":
            components = [key for key in "xy" if key in boundary_values(table)]
            for number in np.flatnonzero(list(matched(table, "boundary", mesh).Mask())):
                if taken.setdefault(number, table) is not table:
                    table.Refuse(
                        f"{mesh.GetBoundaries()[number]!r} is held by {taken[number].name} already; write x and y of a boundary in one table", "boundary"
                    )
            held["dirichlet" + ("" if len(components) == 2 else components[0])].append(table.values["boundary"])
    return {flag: "|".join(names) for flag, names in held.items() if names}


def boundary_values(table: Table) -> dict[str, Any]:
    """The values of a [[support]] of a boundary."""
    values = table.Take({"boundary": text, "x": formula, "y": formula}, ["boundary"])
    if len(values) == 1:
        table.Refuse("it holds nothing; give x, y or both, the displacements there")
    return values


def add_support(table: Table, problem: ContactProblem) -> None:
    """Adds one [[support]] to a problem."""
    with table.Blamed():
        SUPPORTS[kind_of_support(table)](table, problem)


def kind_of_support(table: Table) -> str:
    """The key that says what a [[support]] is."""
    others = [key for key in SUPPORTS if key in table.values and key != "boundary"]
    return others[0] if len(others) == 1 else table.OneOf(SUPPORTS)


def boundary(table: Table, problem: ContactProblem) -> None:
    """SetDirichlet, where something else than zero is given, which the space holds."""
    values = boundary_values(table)
    components = tuple(values.get(key) for key in "xy")
    if any(value not in (None, 0) for value in components):
        problem.SetDirichlet(components, values["boundary"])


def pin(table: Table, problem: ContactProblem) -> None:
    """ContactProblem.Pin."""
    values = table.Take({"pin": point, "x": number, "y": number}, ["pin"])
    components = "".join(key for key in "xy" if key in values)
    if not components:
        table.Refuse("it holds nothing; give x, y or both, the displacements there")
    problem.Pin(tuple(values["pin"]), components, [values[key] for key in components])


def springs(table: Table, problem: ContactProblem) -> None:
    """Springs on a part of the boundary, in x and in y."""
    values = table.Take({"springs": two_formulas, "boundary": text, "bonus_intorder": whole}, ["springs", "boundary"])
    _add_springs(problem, values.pop("springs"), problem.body.ds(**definedon(table, problem, "boundary", values)))


def foundation(table: Table, problem: ContactProblem) -> None:
    """Springs in the body, or in a region of it."""
    values = table.Take({"foundation": two_formulas, "region": text, "bonus_intorder": whole})
    _add_springs(problem, values.pop("foundation"), problem.body.dx(**definedon(table, problem, "region", values)))


def _add_springs(problem: ContactProblem, stiffness: Any, measure: Any) -> None:
    u, v = problem.V.TnT()
    for k, value in enumerate(stiffness):
        if not_zero(value):
            problem.a += value * u[k] * v[k] * measure


def joint(table: Table, problem: ContactProblem) -> None:
    """An elastic joint on one crack or on all."""
    values = table.Take({"joint": formula, "crack": which, "bonus_intorder": whole})
    if "crack" in values:
        values["crack"] = crack_number(values["crack"], problem.body)
    u, v = problem.V.TnT()
    stiffness = values.pop("joint")
    if not_zero(stiffness):
        problem.a += stiffness * Jump(u) * Jump(v) * problem.body.dcrack(**values)


SUPPORTS = {"boundary": boundary, "pin": pin, "springs": springs, "foundation": foundation, "joint": joint}
