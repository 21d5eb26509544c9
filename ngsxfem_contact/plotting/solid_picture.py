"""The displacement of a body in space on the mesh of its pictures."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..operators import Minus, Plus
from .split_solid import SplitSolid

if TYPE_CHECKING:
    from ngsolve import GridFunction


class SolidPicture:
    """The SplitSolid of a solution, and its displacement there.

    Parameters
    ----------
    solution
        A SolidSolution.

    Attributes
    ----------
    split : SplitSolid
    order
        Of the displacement: 1, or 2.
    u (N, 3)
        At the points.
    """

    def __init__(self, solution: Any) -> None:
        u = solution.u
        self.split, self.order, self._limits = SplitSolid(solution.body), min(2, u.space.order), (Plus(u), Minus(u), u)
        self.u = self.split.Evaluate(*self._limits)

    @cached_property
    def at_edges(self) -> np.ndarray | None:
        """(E, 3): u at the middles of `split.edges`; None for order 1."""
        return self.split.EvaluateEdges(*self._limits) if self.order == 2 else None

    def Displacement(self, scale: float = 1.0) -> GridFunction:
        """On `split.mesh`, with the order of u."""
        return self.split.GridFunction(scale * self.u, None if self.at_edges is None else scale * self.at_edges)
