"""W_h, the multipliers on the cracks: section 4 of docs/method.md."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, singledispatch, wraps
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import BilinearForm, CoefficientFunction, GridFunction, LinearForm

from .. import _ngsxfem_contact as core
from ..algebra.matrices import to_scipy
from ..arguments import check_whole
from ..description import Described, numbered
from ..share import share_in
from ..sheets import check_plane_body
from .linear_sheet_trace_space import LinearSheetNodes, LinearSheetTraceSpace
from .nodes import CurveNodes
from .sheet_trace_space import SheetNodes, SheetTraceSpace

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedMesh, CrackedSolid
    from ..description import Lines


class TraceSpace(Described, core.TraceSpace):
    """W_h on the cracks: order 0 one constant for each interval, order ≥ 1 continuous.

    Parameters
    ----------
    body : CrackedMesh
        The body of the cracks. Of a mesh in space gives a SheetTraceSpace, one constant for each element that a sheet cuts (order 0, the default there), or a
        LinearSheetTraceSpace (order 1).
    order : int
        Of the functions, 0 or more; in space 0 or 1.
    basis : "nodal" or "trace"
        "nodal" (default): Lagrange functions between the points where the crack meets mesh edges, its kinks and ends; a nodal sign is a pointwise sign
        for order 1. "trace": restrictions of mesh functions, redundant ones removed in the paper's two steps.
    nodes
        Arc lengths from 0 to the crack's length, one list for each crack (one list, if there is one crack): a multiplier on nodes of its own (H ≠ h).
        Integrate over `dcrack` of this space, which respects them.

    Raises
    ------
    TypeError, ValueError
        For an order that is no whole number ≥ 0 and another basis.
    Exception
        For nodes that do not increase from 0 to the length of their crack.

    References
    ----------
    Section 4 of [AHLMR12].
    """

    def __init__(self, body: CrackedMesh, order: int = 1, basis: str = "nodal", nodes: Any = None) -> None:
        check_plane_body(body, "TraceSpace: body")
        check_whole(order, "TraceSpace: order", 0)
        if nodes is None:
            nodes = [body.MeshNodes(c, order > 0) for c in range(len(body.cracks))]
        elif isinstance(nodes, Sequence | np.ndarray) and len(nodes) and np.ndim(nodes[0]) == 0:
            nodes = [nodes]
        try:
            functions: core.TraceBasis = core.NodalTraceBasis(body, order, nodes)
        except TypeError:
            raise TypeError(f"TraceSpace: nodes={nodes!r} are no arc lengths, one list of numbers for each crack") from None
        if basis not in ("nodal", "trace"):
            raise ValueError(f"TraceSpace: basis={basis!r} is not 'nodal' or 'trace'")
        share_in(body).Refuse("TraceSpace(basis='trace') of order 2 or more", basis == "trace" and order > 1)
        if basis == "trace" and order > 0:
            functions = core.MeshTraceBasis(body, order, nodes, redundant_functions(body, order, nodes))
        super().__init__(body, functions, order)

    @wraps(__init__, assigned=(), updated=())  # type: ignore[misc]  # the signature is that of __init__
    def __new__(cls, *arguments: Any, **named: Any) -> Any:
        """Of a body in space its own space of multipliers."""
        body = arguments[0] if arguments else named.get("body")
        return on_sheets(*arguments, **named) if isinstance(body, core.CrackedSolid) else super().__new__(cls)

    @property
    def nodes(self) -> TraceNodes:
        """Where signs are taken, the TraceNodes: of order 0 the middles of the intervals. Raises ValueError as these do."""
        return TraceNodes(self)

    def Description(self) -> Lines:
        """Order, basis, and unknowns."""
        basis = "nodal" if isinstance(self.basis, core.NodalTraceBasis) else "traces of functions of the mesh"
        return [("order", str(self.order)), ("basis", basis), ("unknowns", f"{self.ndof} on {numbered(len(self.body.cracks), 'crack')}")]

    def NodalPositions(self) -> list[np.ndarray]:
        """For each crack the arc lengths of the nodes."""
        nodes = self.basis.Nodes()
        return [nodes.arclengths[nodes.cracks == c] for c in range(len(self.body.cracks))]


def on_sheets(body: CrackedSolid, order: int = 0, basis: str = "nodal", nodes: Any = None, **others: Any) -> SheetTraceSpace | LinearSheetTraceSpace:
    """The multipliers of a body in space. Raises ValueError for an order other than 0 and 1, another basis, and nodes; TypeError for other arguments."""
    if others:
        raise TypeError(f"TraceSpace: there is no argument {next(iter(others))!r}; it takes body and order, in the plane also basis and nodes")
    if basis != "nodal" or nodes is not None:
        raise ValueError("TraceSpace: basis= and nodes= are there for bodies in the plane; in space the mesh gives the nodes")
    if order == 0:
        return SheetTraceSpace(body)
    if order == 1:
        return LinearSheetTraceSpace(body)
    raise ValueError(f"TraceSpace: order={order!r} is not there for bodies in space; take 0, one constant for each element that a sheet cuts, or 1")


class TraceNodes(CurveNodes):
    """Where the signs of functions of a TraceSpace are taken. Raises ValueError unless there are as many functions as nodes."""

    def __init__(self, W: TraceSpace) -> None:
        super().__init__(W.basis.Nodes())
        self.W = W
        if W.ndof != len(self):
            raise ValueError(f"TraceSpace: {W.ndof} independent traces for {len(self)} nodes, so nodal signs do not fit; use basis='nodal'")

    def __reduce__(self) -> Any:
        return TraceNodes, (self.W,)

    @cached_property
    def functions(self) -> np.ndarray:
        """The identity for nodal functions, and for others the inverse of their values at the nodes."""
        if isinstance(self.W.basis, core.NodalTraceBasis):
            return super().functions
        values, function = np.empty((len(self), len(self))), GridFunction(self.W)
        for j in range(len(self)):
            function.vec[:] = 0
            function.vec[j] = 1
            values[:, j] = self.Values(function)
        return np.linalg.inv(values)

    def Means(self, function: CoefficientFunction) -> np.ndarray:
        """(n,): ∫ψ_i f / ∫ψ_i, within the range of the values at the nodes; a jump between nodes counts where it is."""
        moments = LinearForm(function * self.W.TestFunction() * self.W.dcrack(bonus_intorder=10)).Assemble().vec.FV().NumPy()
        values = self.Values(function)
        return np.clip(self.functions.T @ moments / self.weights, values.min(), values.max())

    @cached_property
    def mass(self) -> np.ndarray:
        """∫ψ_i ψ_j."""
        return self.functions.T @ mass_matrix(self.W) @ self.functions


@singledispatch
def trace_nodes(W: core.TraceSpace) -> TraceNodes | SheetNodes | LinearSheetNodes:
    """Where the signs of the functions of a space of multipliers are taken."""
    return TraceNodes(W)


trace_nodes.register(SheetTraceSpace, SheetNodes)
trace_nodes.register(LinearSheetTraceSpace, LinearSheetNodes)


def mass_matrix(W: TraceSpace) -> csr_matrix:
    """∫ψ_i ψ_j over the cracks, scipy CSR."""
    lam, mu = W.TnT()
    return to_scipy(BilinearForm(lam * mu * W.dcrack).Assemble().mat)


def redundant_functions(body: CrackedMesh, order: int, nodes: list[list[float]], tolerance: float = 1e-7) -> set[int]:
    """Which traces of mesh functions depend on others: the two steps of section 4 of [AHLMR12].

    First a Gram-Schmidt elimination among functions that overlap, then a Lanczos search for what is left of the kernel
    of the mass matrix, one function (that of the largest component) for each kernel vector.
    """
    mass = mass_matrix(core.TraceSpace(body, core.MeshTraceBasis(body, order, nodes, set()), order))
    diagonal = mass.diagonal()
    traced = np.flatnonzero(diagonal > 1e-14 * diagonal.max(initial=0))
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1))
    mass = (mass.multiply(scale).T.multiply(scale)).tocsr()
    kept = []
    for i in traced:
        overlapping = np.intersect1d(mass[i].indices, kept)
        block = mass[overlapping][:, overlapping].toarray()
        coupling = mass[overlapping][:, [i]].toarray().ravel()
        projection = np.linalg.lstsq(block, coupling, rcond=tolerance)[0] if len(overlapping) else np.zeros(0)
        if 1 - coupling @ projection > tolerance:
            kept.append(i)
    while kept:
        value, vector = smallest_eigenpair(mass[kept][:, kept])
        if value > tolerance:
            break
        kept.pop(int(np.argmax(np.abs(vector))))
    return set(range(mass.shape[0])) - set(kept)


def smallest_eigenpair(matrix: csr_matrix) -> tuple[float, np.ndarray]:
    """Of a symmetric positive semi-definite scipy matrix with unit diagonal: Lanczos on the shifted matrix."""
    if matrix.shape[0] < 20:
        values, vectors = np.linalg.eigh(matrix.toarray())
        return values[0], vectors[:, 0]
    values, vectors = scipy.sparse.linalg.eigsh(matrix, k=1, sigma=-1e-8, v0=np.ones(matrix.shape[0]))
    return values[0], vectors[:, 0]
