"""What is read on a sheet in space: a table of its polygons, and where their states change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ..operators import FIRST_TANGENTIAL, SECOND_TANGENTIAL, NormalGap
from ..plotting.sheet_trace import SheetTrace
from ..tables import Table

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..spaces.sheet_trace_space import SheetNodes
    from .solution import ContactSolution

TANGENTIAL = (FIRST_TANGENTIAL, SECOND_TANGENTIAL)


class SheetProfile(Table):
    """A Table with a row for each polygon in which a sheet cuts an element, in the user's units; its columns are arrays (n,).

    Attributes
    ----------
    element
        Its number in the mesh.
    x, y, z, p_1, p_2
        The centroid of the polygon, also in the coordinates of `Sheet.axes`.
    area
        Of the polygon.
    gap
        The mean of g_n = jump(u)·n over it, without the initial gap g_0 of the problem.
    slip, slip_1, slip_2
        The mean of the jump along the sheet: its size, and its components along `Sheet.axes`.
    sigma_n
        λ ≤ 0: its mean.
    sigma_t, sigma_t_1, sigma_t_2
        λ_t with friction, its size and components; without, the mean of the tangential traction of the larger part of the element, which exact frictionless contact
        makes zero.
    state
        "open" or "contact"; with friction "open", "stick" or "slip": with multipliers of order 1 that of the nodes to which the larger part of the polygon belongs.
    """

    def RowsOf(self, elements: np.ndarray) -> SheetProfile:
        """The rows of elements of the mesh that carry the sheet; an element that holds no more than round-off of it has none, and gets the first."""
        row = {int(element): i for i, element in enumerate(self.element)}
        return cast("SheetProfile", self[[row.get(int(element), 0) for element in elements]])


def sheet_profile(solution: ContactSolution, crack: int) -> SheetProfile:
    """That of a sheet of a solution."""
    (nodes, means), body = cast("SheetNodes", solution.state.nodes).polygons, cast("Any", solution.body)
    on = np.flatnonzero(nodes.cracks == crack)
    sheet = body.cracks[crack]
    plane = (nodes.positions[on] - np.array(sheet.origin)) @ np.array(sheet.axes).T
    components = (means @ solution.state.L.reshape(-1, means.shape[1]).T).T[:, on]
    slip = [nodes.Means(component.jump(solution.u, body))[on] for component in TANGENTIAL]
    if len(components) > 1:
        sigma_t = list(components[1:])
    else:
        sigma_t = [nodes.Means(solution.Traction(component, "larger"))[on] for component in TANGENTIAL]
    columns = {"element": nodes.elements[on], **dict(zip("xyz", nodes.positions[on].T)), "p_1": plane[:, 0], "p_2": plane[:, 1], "area": nodes.weights[on]}
    columns |= {"gap": nodes.Means(NormalGap(solution.u, body))[on], "slip": np.hypot(*slip), "slip_1": slip[0], "slip_2": slip[1], "sigma_n": components[0]}
    columns |= {"sigma_t": np.hypot(*sigma_t), "sigma_t_1": sigma_t[0], "sigma_t_2": sigma_t[1], "state": polygon_states(solution)[on]}
    return SheetProfile.Of(columns)


def polygon_states(solution: ContactSolution) -> np.ndarray:
    """Those of all polygons, by name: of the nodes to which the larger part of each belongs."""
    (_, means), slipping = cast("SheetNodes", solution.state.nodes).polygons, solution.report.slipping
    contact = means @ np.array(solution.report.active[-1], dtype=float)
    closed = "contact" if slipping is None else np.where(means @ slipping.astype(float) > 0.5 * contact, "slip", "stick")
    return np.where(contact > 0.5, closed, "open")


def borders(solution: ContactSolution, crack: int, differ: Callable[[str, str], bool]) -> np.ndarray:
    """(k, 2, 3): the ends of the sides between two polygons of a sheet whose states differ."""
    trace, (nodes, _) = SheetTrace(cast("Any", solution.body), crack), cast("SheetNodes", solution.state.nodes).polygons
    state_of = dict(zip(nodes.elements.tolist(), polygon_states(solution).tolist()))
    beside: dict[tuple[int, int], list[str]] = {}
    for loop, element, inside in zip(trace.loops, trace.element.tolist(), trace.inside):
        for p, q in zip(loop, [*loop[1:], loop[0]]):
            if inside and element in state_of:
                beside.setdefault((min(p, q), max(p, q)), []).append(state_of[element])
    sides = [side for side, found in beside.items() if len(found) == 2 and differ(*found)]
    return trace.Places(trace.points[np.array(sides, dtype=int).reshape(-1, 2)])
