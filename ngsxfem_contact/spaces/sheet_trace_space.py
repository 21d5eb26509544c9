"""W_h on sheets in space: one constant for each element that carries a part of a sheet (docs/method.md, section 15)."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import L2, BitArray, CoefficientFunction, Compress

from .. import _ngsxfem_contact as core
from ..arguments import check_type
from ..description import Described, numbered
from ..points import mesh_points, place
from .nodes import OwnCoefficients

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedSolid, CutDifferentialSymbol
    from ..description import Lines

MEANS = 5  # the order of the rules for means of functions
LEAST_AREA = 1e-15  # of S in an element with a multiplier, relative to the square of its longest edge: less is round-off, where a front runs along a face


def carrying_elements(body: CrackedSolid) -> np.ndarray:
    """The numbers of the elements that hold more of the sheets than round-off, increasing."""
    cells = (cell for crack in range(len(body.cracks)) for cell in body.Elements(crack))
    return np.array(sorted(cell.element for cell in cells if body.FacetArea(cell.element) > LEAST_AREA * cell.h**2), dtype=int)


class OnSheets(Described):
    """What multipliers of all orders have on the sheets of a body in space."""

    body: Any
    order: int
    ndof: int

    def Description(self) -> Lines:
        """Order and unknowns."""
        return [("order", str(self.order)), ("unknowns", f"{self.ndof} on {numbered(len(self.body.cracks), 'sheet')}")]

    @property
    def dcrack(self) -> CutDifferentialSymbol:
        """The measure on the sheets."""
        return self.body.dcrack


def check_solid(body: Any) -> None:
    """Raises TypeError for what is no body in space."""
    check_type(body, core.CrackedSolid, "TraceSpace: body", "a CrackedMesh of a mesh in space")


class SheetTraceSpace(OnSheets, Compress):
    """W_h on the sheets of a body in space: constants on the polygons in which they cut the elements.

    Parameters
    ----------
    body : CrackedSolid
        What CrackedMesh(mesh, sheet, ...) gives.

    Raises
    ------
    TypeError
        For another body.
    """

    order = 0

    def __init__(self, body: CrackedSolid) -> None:
        check_solid(body)
        active = BitArray(body.mesh.ne)
        active.Clear()
        for element in carrying_elements(body):
            active.Set(int(element))
        super().__init__(L2(body.mesh, order=0), active_dofs=active)
        self.body = body

    def __reduce__(self) -> Any:
        return SheetTraceSpace, (self.body,)

    @property
    def nodes(self) -> SheetNodes:
        """Where signs are taken, the SheetNodes: the centroids of the polygons."""
        return SheetNodes(self)


class PointsOnSheets(OwnCoefficients):
    """The part of nodes whose values are those at points of sheets: `points`, of NGSolve, and `positions`, (n, 3), on the sheets with numbers `cracks`, (n,)."""

    points: Any
    positions: Any
    cracks: Any

    def Values(self, function: CoefficientFunction) -> np.ndarray:
        """Of a scalar CoefficientFunction, (n,), at the points."""
        return function(self.points).ravel()

    def Place(self, i: int) -> str:
        """The point, and the sheet."""
        return f"{place(self.positions[i])} of sheet {self.cracks[i]}"


class SheetNodes(PointsOnSheets):
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
        self.elements = carrying_elements(W.body)
        self.cracks = np.array([W.body.CracksOf(int(element))[0] for element in self.elements], dtype=int)
        found = W.dcrack.Points(MEANS)
        here = np.isin(found[0], self.elements)
        element, xi, eta, zeta, weights, *places = (np.asarray(values)[here] for values in found)
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

    @property
    def polygons(self) -> tuple[SheetNodes, csr_matrix]:
        """Themselves, and the mean of each function on each polygon."""
        return self, scipy.sparse.identity(len(self), format="csr")

    @cached_property
    def points(self) -> np.ndarray:
        """For NGSolve's functions."""
        return mesh_points(self.W.mesh, self.elements, *self._reference)

    def Means(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): ∫ψ_i f / ∫ψ_i."""
        return self._sums(self._number, self._parts * function(self._points).ravel())
