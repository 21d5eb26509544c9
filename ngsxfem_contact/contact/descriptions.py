"""What problems and solutions say of themselves."""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

from .. import _ngsxfem_contact as core
from ..description import joined, numbered

if TYPE_CHECKING:
    from ..description import Lines
    from .problem import ContactProblem
    from .solution import ContactSolution


def of_problem(problem: ContactProblem) -> Lines:
    """Body and spaces, material, law of the faces, stabilisation, loads and supports."""
    V, body = problem.V, problem.body
    boundaries = V.mesh.GetBoundaries()
    held = dict.fromkeys(boundaries[region] for region, _ in problem.supports.sides)
    supports = [*held, *([numbered(len(problem.pinned), "pinned component")] if problem.pinned else [])]
    loads = [numbered(len(problem.f.given), "term") + " in f"]
    loads += [numbered(len(problem.a.terms), "term") + " in a"] if problem.a.terms else []
    loads += ["given stresses"] if problem.initial.given else []
    return [
        ("body", ", ".join(parts_of(body))),
        ("spaces", f"order {V.order} with {V.ndof} unknowns, multiplier of order {problem.W.order} with {problem.W.ndof}"),
        ("material", str(problem.material)),
        ("law", str(problem.law)),
        ("stabilisation", str(problem.stabilisation)),
        ("loads", joined(loads)),
        ("supports", joined(supports)),
    ]


@singledispatch
def parts_of(body: Any) -> list[str]:
    """How many elements, cracks and tips a body has."""
    return [numbered(body.mesh.ne, "triangle"), numbered(len(body.cracks), "crack"), numbered(len(body.tips), "tip")]


@parts_of.register(core.CrackedSolid)
def parts_of_solid(body: core.CrackedSolid) -> list[str]:
    """In space elements, sheets and fronts."""
    return [numbered(body.mesh.ne, "tetrahedron", "tetrahedra"), numbered(len(body.cracks), "sheet"), numbered(len(body.fronts), "front")]


def of_solution(solution: ContactSolution) -> Lines:
    """The problem, and what was found on the cracks."""
    report = solution.report
    checked = {None: "converged, u not recovered yet", True: f"converged, residual {report.residual:.1e}", False: "not converged"}[report.converged]
    states = report.states or report.Counts()
    found = joined(f"{100 * value:.3g} % {name}" if report.states else f"{name} {value}" for name, value in states.items())
    found = found if report.states else f"{numbered(len(solution.state.nodes), 'node')}: {found}"
    return [*of_problem(solution.problem), ("solved", f"{checked}, {numbered(report.iterations, 'iteration')}"), ("faces", found)]
