"""The nodes of multipliers: where the signs of pressures and gaps are taken, and what belongs to each."""

from functools import cached_property
from typing import Protocol

import numpy as np
from ngsolve import CoefficientFunction

from .. import _ngsxfem_contact as core
from ..points import crack_points


class Nodes(Protocol):
    """What cones, laws of friction and active sets ask: of n nodes, one for each multiplier of a component. No arc lengths."""

    @property
    def cracks(self) -> np.ndarray:
        """(n,) int: of each node the number of its crack."""

    @property
    def positions(self) -> np.ndarray:
        """(n, dimension): the points."""

    @property
    def weights(self) -> np.ndarray:
        """(n,): ∫ψ_i, how much of the cracks belongs to each node."""

    @property
    def neighbours(self) -> np.ndarray:
        """(k, 2) int: the numbers of two nodes beside each other on a crack, each two once."""

    @property
    def functions(self) -> np.ndarray:
        """(n, n): the coefficients of the nodal functions ψ_i, 1 at one node and 0 at the others, as columns."""

    @property
    def mass(self) -> np.ndarray:
        """(n, n): ∫ψ_i ψ_j."""

    def __len__(self) -> int: ...

    def Values(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): a scalar function at the nodes."""

    def Place(self, i: int) -> str:
        """Where the i-th node is, in words."""


class CurveNodes(core.CurveNodes):
    """Nodes of the plane's cracks, in the order of `arclengths`. Values at them are coefficients, sums over them with `weights` integrals."""

    @property
    def functions(self):
        """The identity."""
        return np.eye(len(self))

    @property
    def mass(self):
        """That of the sums, diagonal."""
        return np.diag(self.weights)

    @cached_property
    def points(self):
        """For NGSolve's functions."""
        points = [crack_points(self.body, c, self.arclengths[self.cracks == c]) for c in range(len(self.body.cracks))]
        return np.concatenate(points).astype(points[0].dtype)  # concatenate drops the padding of NGSolve's mesh points

    def Values(self, function):
        """Of a scalar CoefficientFunction, (n,)."""
        return function(self.points).ravel()

    def Place(self, i):
        """Its arc length."""
        return f"arc length {self.arclengths[i]:.6g} of crack {self.cracks[i]}"
