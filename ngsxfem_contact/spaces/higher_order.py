"""The space of the next order on the same body, and how a space lies in it: NGSolve's functions φ_i are hierarchical."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CELL, EDGE, NodeId

from .. import _ngsxfem_contact as core
from .unknowns import Unknowns

if TYPE_CHECKING:
    from ngsolve import FESpace

ENOUGH = 1e-3  # of the rules around tips, relative: what is sought in the space are a few digits of an error


class HigherOrder:
    """V_h of order k + 1, in which V of order k lies: same parts, same tips, same held boundaries.

    Parameters
    ----------
    V : CrackFESpace

    Attributes
    ----------
    space
        The core's CrackFESpace of order k + 1; bubbles are one degree higher, too.
    numbers
        (V.ndof,) of each function of V its number in `space`.
    surplus
        (space.ndof,) boolean: the functions that V does not have. They belong to edges and triangles, not to vertices or tips.
    """

    def __init__(self, V: core.CrackFESpace) -> None:
        body, specs, tolerance, flags = core.CrackFESpace.__getstate__(V)
        options = flags.ToDict()
        raised = {name: options[name] + 1 for name in ("order", "orderinner") if name in options}
        self.V, self.space = V, core.CrackFESpace(body, specs, max(tolerance, ENOUGH), **(options | raised))
        self.numbers = self._numbers()
        self.surplus = np.ones(self.space.ndof, dtype=bool)
        self.surplus[self.numbers] = False

    def Prolonged(self, U: np.ndarray) -> np.ndarray:
        """The coefficients in the space of a function of V."""
        values = np.zeros(self.space.ndof)
        values[self.numbers] = U
        return values

    def Restricted(self, r: np.ndarray) -> np.ndarray:
        """A linear form on the space as one on V."""
        return r[self.numbers]

    def _numbers(self) -> np.ndarray:
        of_scalar = polynomial_numbers(self.V.scalar_space, self.space.scalar_space)
        ours, theirs = Unknowns(self.V), Unknowns(self.space)
        numbers = np.empty(self.V.ndof, dtype=int)
        of_copies = copy_numbers(of_scalar[ours.enriched], theirs.enriched)
        for component in range(2):
            numbers[ours.Polynomial(component)] = theirs.Polynomial(component).start + of_scalar
            numbers[ours.Heaviside(component)] = theirs.Heaviside(component).start + of_copies
        numbers[ours.tips] = theirs.tips
        return numbers


def copy_numbers(wanted: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Where copies of the functions φ_i, given by their i, stand among those of another space, which has as many of each, in the same order."""
    order, theirs = np.argsort(wanted, kind="stable"), np.argsort(there, kind="stable")
    numbers = np.empty(len(wanted), dtype=int)
    numbers[order] = theirs[np.isin(there[theirs], wanted)]
    return numbers


def polynomial_numbers(S: FESpace, T: FESpace) -> np.ndarray:
    """(S.ndof,): the φ_i of a space H1 among those of one of higher order on the same mesh: of vertices, then those of each edge and triangle by their degrees."""
    mesh = S.mesh
    numbers = np.full(S.ndof, -1)
    numbers[: mesh.nv] = np.arange(mesh.nv)
    for kind, count in ((EDGE, mesh.nedge), (CELL, mesh.ne)):
        ours, theirs = (blocks(space, kind, count) for space in (S, T))
        if not ours.size:
            continue
        both = range(ours.shape[1]) if kind == EDGE else among_cell_functions(ours.shape[1], theirs.shape[1])
        numbers[ours] = theirs[:, list(both)]
    return numbers


def blocks(space: FESpace, kind: Any, count: int) -> np.ndarray:
    """(m, n): the numbers of the n functions of each of the m edges or triangles of a space H1 of one order that have some.

    Edges that a refined mesh has of its coarser levels have none. Without such the functions of one edge follow those of the last.
    """
    first, last = (list(space.GetDofNrs(NodeId(kind, i))) for i in (0, count - 1))
    n = len(last)
    numbers = (first[0] if first else 0) + np.arange(count * n).reshape(count, n)
    if len(first) == n and list(numbers[-1]) == last:
        return numbers
    return np.array([dofs for i in range(count) if len(dofs := space.GetDofNrs(NodeId(kind, i)))], dtype=int).reshape(-1, n)


def among_cell_functions(few: int, many: int) -> list[int]:
    """Of the functions of a triangle, numbered by i, then j with i + j < degree, those of a lower degree."""
    degrees = [next(n for n in range(count + 1) if n * (n + 1) // 2 == count) for count in (few, many)]
    pairs = [(i, j) for i in range(degrees[1]) for j in range(degrees[1] - i)]
    return [number for number, (i, j) in enumerate(pairs) if i + j < degrees[0]]
