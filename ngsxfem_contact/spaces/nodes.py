"""The nodes of multipliers in the plane: points of curves. protocols.Nodes is what is asked of nodes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from ngsolve import CoefficientFunction

from .. import _ngsxfem_contact as core
from ..arguments import crack_title
from ..points import crack_points


class OwnCoefficients:
    """The part of nodes whose values are coefficients themselves: of n nodes with `weights` ∫ψ_i, (n,)."""

    weights: Any
    __len__: Any

    @property
    def functions(self) -> np.ndarray:
        """The identity."""
        return np.eye(len(self))

    @property
    def mass(self) -> np.ndarray:
        """∫ψ_i ψ_j, diagonal."""
        return np.diag(self.weights)


class CurveNodes(OwnCoefficients, core.CurveNodes):
    """Nodes of the plane's cracks, in the order of `arclengths`. Values at them are coefficients, sums over them with `weights` integrals."""

    @cached_property
    def points(self) -> np.ndarray:
        """For NGSolve's functions."""
        points = [crack_points(self.body, c, self.arclengths[self.cracks == c]) for c in range(len(self.body.cracks))]
        return np.concatenate(points).astype(points[0].dtype)  # concatenate drops the padding of NGSolve's mesh points

    def Values(self, function: CoefficientFunction) -> np.ndarray:
        """Of a scalar CoefficientFunction, (n,)."""
        return function(self.points).ravel()

    def Means(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): of points, its values."""
        return self.Values(function)

    def Place(self, i: int) -> str:
        """Its arc length."""
        return f"arc length {self.arclengths[i]:.6g} of {crack_title(self.body.cracks, int(self.cracks[i]))}"
