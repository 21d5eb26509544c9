"""W_h on sheets in space, of order 1: hats of the points where sheets cut edges of the mesh (docs/method.md, section 15)."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import VOL, BilinearForm, CoefficientFunction, ElementId

from .. import _ngsxfem_contact as core
from ..algebra.matrices import assembled, to_scipy
from ..points import mesh_points, reference_coordinates
from .sheet_trace_space import OnSheets, PointsOnSheets, SheetNodes, SheetTraceSpace, carrying_elements, check_solid

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedSolid


class LinearSheetTraceSpace(OnSheets, core.LinearSheetTraceSpace):
    """W_h on the sheets of a body in space: functions that are linear on triangles of the polygons in which the sheets cut the elements.

    Nodes are the points in which the sheets cut edges of the mesh; there functions are continuous. In an element with a front they have at the corners of the polygon beyond it the value of
    the nearest corner before it; where there is none, a sheet that is narrower than the element, they have one constant of their own. So a nodal sign is a pointwise sign everywhere.

    Parameters
    ----------
    body : CrackedSolid
        What CrackedMesh(mesh, sheet, ...) gives.

    Raises
    ------
    TypeError
        For another body.
    """

    order = 1
    has_kinks = True  # inside the triangles of the rules, in elements with a front

    def __init__(self, body: CrackedSolid) -> None:
        check_solid(body)
        super().__init__(body)

    @property
    def nodes(self) -> LinearSheetNodes:
        """Where signs are taken, the LinearSheetNodes: the points on the edges."""
        return LinearSheetNodes(self)


class LinearSheetNodes(PointsOnSheets):
    """One node for each function of a LinearSheetTraceSpace, in their order.

    Attributes
    ----------
    cracks, positions, weights, neighbours
        Of each the number of its sheet, the point, (n, 3), and ∫ψ_i, an area; (k, 2), the numbers of two nodes that a side of a polygon joins, each two once.
    """

    def __init__(self, W: LinearSheetTraceSpace) -> None:
        self.W, self.body = W, W.body
        self.cracks, self.positions = np.array(W.sheets, dtype=int), np.array(W.positions).reshape(-1, 3)
        self.neighbours = np.array(W.neighbours, dtype=int).reshape(-1, 2)
        self.weights = self._moments(CoefficientFunction(1))

    def __reduce__(self) -> Any:
        return LinearSheetNodes, (self.W,)

    def __len__(self) -> int:
        return len(self.cracks)

    def _moments(self, function: CoefficientFunction) -> np.ndarray:
        """∫ψ_i f, (n,)."""
        return np.asarray(self._integrals(function).sum(axis=0)).ravel()

    def _integrals(self, function: CoefficientFunction) -> csr_matrix:
        """∫ψ_i f on each polygon, a row, in the order of SheetNodes."""
        constants = SheetTraceSpace(self.body)
        form = BilinearForm(trialspace=self.W, testspace=constants)
        form += function * self.W.TrialFunction() * constants.TestFunction() * self.W.dcrack(bonus_intorder=1)
        return assembled(form, carrying_elements(self.body))

    @cached_property
    def mass(self) -> np.ndarray:
        """∫ψ_i ψ_j."""
        lam, mu = self.W.TnT()
        return to_scipy(BilinearForm(lam * mu * self.W.dcrack).Assemble().mat).toarray()

    @cached_property
    def points(self) -> np.ndarray:
        """For NGSolve's functions, in elements that the sheets cut through, where a node has one."""
        element = np.empty(len(self), dtype=int)
        for with_front in (True, False):
            for c in range(len(self.body.cracks)):
                for cell in self.body.Elements(c):
                    if (cell.kind == core.ElementKind.Tip) == with_front:
                        element[list(self.W.GetDofNrs(ElementId(VOL, cell.element)))] = cell.element
        return mesh_points(self.W.mesh, element, *reference_coordinates(self.W.mesh, element, self.positions).T)

    def Means(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): ∫ψ_i f / ∫ψ_i."""
        return self._moments(function) / self.weights

    @cached_property
    def polygons(self) -> tuple[SheetNodes, csr_matrix]:
        """The SheetNodes of the polygons, and the mean of each function on each of them."""
        integrals = self._integrals(CoefficientFunction(1))
        return SheetTraceSpace(self.body).nodes, scipy.sparse.diags(1 / np.asarray(integrals.sum(axis=1)).ravel()) @ integrals
