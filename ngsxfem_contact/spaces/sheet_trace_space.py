"""W_h on sheets in space: one constant for each element that carries a part of a sheet (docs/method.md, section 15)."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import L2, CoefficientFunction, Compress

from .. import _ngsxfem_contact as core
from ..algebra.matrices import mask
from ..arguments import check_type
from ..description import Described, numbered
from ..points import mesh_points, place
from .nodes import OwnCoefficients

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackedSolid, CutDifferentialSymbol
    from ..description import Lines

MEANS = 5  # the order of the rules for means of functions


class SheetTraceSpace(Described, Compress):
    """W_h on the sheets of a body in space: constants on the polygons in which they cut the elements.

    Parameters
    ----------
    body : CrackedSolid
        What CrackedMesh(mesh, sheet, ...) gives.
    order : int
        0: there are no others in space.

    Raises
    ------
    TypeError, ValueError
        For another body and another order.
    """

    order = 0

    def __init__(self, body: CrackedSolid, order: int = 0) -> None:
        check_type(body, core.CrackedSolid, "TraceSpace: body", "a CrackedMesh of a mesh in space")
        if order != 0:
            raise ValueError(f"TraceSpace: order={order!r} is not there for bodies in space; take 0, one constant for each element that a sheet cuts")
        super().__init__(L2(body.mesh, order=0), active_dofs=body.CrackElements(None))
        self.body = body

    def __reduce__(self) -> Any:
        return SheetTraceSpace, (self.body,)

    def Description(self) -> Lines:
        """Order and unknowns."""
        return [("order", "0"), ("unknowns", f"{self.ndof} on {numbered(len(self.body.cracks), 'sheet')}")]

    @property
    def dcrack(self) -> CutDifferentialSymbol:
        """The measure on the sheets."""
        return self.body.dcrack

    @property
    def nodes(self) -> SheetNodes:
        """Where signs are taken, the SheetNodes: the centroids of the polygons."""
        return SheetNodes(self)


class SheetNodes(OwnCoefficients):
    """One node for each function of a SheetTraceSpace, in their order.

    Attributes
    ----------
    elements
        (n,): the elements.
    cracks, positions, weights
        Of each the number of its sheet, the centroid of the part of the sheet, (n, 3), and its area.
    """

    def __init__(self, W: SheetTraceSpace) -> None:
        self.W, self.body = W, W.body
        self.elements = np.flatnonzero(mask(W.body.CrackElements(None)))
        self.cracks = np.array([W.body.CracksOf(int(element))[0] for element in self.elements], dtype=int)
        element, xi, eta, zeta, weights, *places = W.dcrack.Points(MEANS)
        number = np.asarray(np.searchsorted(self.elements, element))
        self._points, self._parts = mesh_points(W.mesh, element, xi, eta, zeta), weights / self._sums(number, weights)[number]
        self._number = number
        means = [self._sums(number, self._parts * values) for values in (xi, eta, zeta, *places)]
        self._reference, self.positions = means[:3], np.column_stack(means[3:])
        self.weights = np.array([W.body.FacetArea(int(element)) for element in self.elements])

    def __reduce__(self) -> Any:
        return SheetNodes, (self.W,)

    def _sums(self, number: np.ndarray, values: np.ndarray) -> np.ndarray:
        return np.bincount(number, values, minlength=len(self.elements))

    def __len__(self) -> int:
        return len(self.elements)

    @cached_property
    def neighbours(self) -> np.ndarray:
        """(k, 2): the numbers of two nodes whose elements share a face, each two once."""
        at, pairs = {int(element): i for i, element in enumerate(self.elements)}, set()
        for element in self.W.mesh.Elements():
            if (i := at.get(element.nr)) is not None:
                beside = {other.nr for face in element.faces for other in self.W.mesh[face].elements}
                pairs |= {(i, at[other]) for other in beside if at.get(other, -1) > i and self.cracks[at[other]] == self.cracks[i]}
        return np.array(sorted(pairs), dtype=int).reshape(-1, 2)

    @cached_property
    def points(self) -> np.ndarray:
        """For NGSolve's functions."""
        return mesh_points(self.W.mesh, self.elements, *self._reference)

    def Values(self, function: CoefficientFunction) -> np.ndarray:
        """Of a scalar CoefficientFunction, (n,), at the centroids."""
        return function(self.points).ravel()

    def Means(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): ∫ψ_i f / ∫ψ_i."""
        return self._sums(self._number, self._parts * function(self._points).ravel())

    def Place(self, i: int) -> str:
        """The centroid, and the sheet."""
        return f"{place(self.positions[i])} of sheet {self.cracks[i]}"
