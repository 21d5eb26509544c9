"""W_h, the multipliers on the cracks: section 4 of docs/method.md."""

import numpy as np
from ngsolve import BilinearForm, GridFunction
from scipy.sparse.linalg import eigsh

from .. import _ngsxfem_contact as core
from ..algebra.matrices import to_scipy
from ..arguments import check_type, check_whole
from ..points import crack_points


class TraceSpace(core.TraceSpace):
    """W_h on the cracks: order 0 one constant for each interval, order ≥ 1 continuous.

    Parameters
    ----------
    body : CrackedMesh
        The body of the cracks.
    order : int
        Of the functions, 0 or more.
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

    def __init__(self, body, order=1, basis="nodal", nodes=None):
        check_type(body, core.CrackedMesh, "TraceSpace: body", "a CrackedMesh; build one by CrackedMesh(mesh, crack, ...)")
        check_whole(order, "TraceSpace: order", 0)
        if nodes is None:
            nodes = [body.MeshNodes(c, order > 0) for c in range(len(body.cracks))]
        elif np.ndim(nodes) == 1 and len(nodes) and np.ndim(nodes[0]) == 0:
            nodes = [nodes]
        try:
            core.NodalTraceBasis(body, order, nodes)  # refuses nodes that do not fit
        except TypeError:
            raise TypeError(f"TraceSpace: nodes={nodes!r} are no arc lengths, one list of numbers for each crack") from None
        if basis == "nodal" or (basis == "trace" and order == 0):
            functions: core.TraceBasis = core.NodalTraceBasis(body, order, nodes)
        elif basis == "trace":
            functions = core.MeshTraceBasis(body, order, nodes, redundant_functions(body, order, nodes))
        else:
            raise ValueError(f"TraceSpace: basis={basis!r} is not 'nodal' or 'trace'")
        super().__init__(body, functions, order)

    def NodalPositions(self):
        """For each crack the arc lengths of the nodes at which signs are taken (for order 0: the intervals' midpoints)."""
        nodal = core.NodalTraceBasis(self.body, self.order, self.basis.nodes)
        return [nodal.DofPositions(c) for c in range(len(self.body.cracks))]

    def NodalValues(self):
        """The matrix of the functions' values at the nodes, or None where it is the identity."""
        if isinstance(self.basis, core.NodalTraceBasis):
            return None
        points = np.concatenate([crack_points(self.body, c, s) for c, s in enumerate(self.NodalPositions())])
        values = np.empty((len(points), self.ndof))
        function = GridFunction(self)
        for j in range(self.ndof):
            function.vec[:] = 0
            function.vec[j] = 1
            values[:, j] = function(points).ravel()
        if values.shape[0] != values.shape[1]:
            raise ValueError(f"TraceSpace: {values.shape[1]} independent traces for {values.shape[0]} nodes, so nodal signs do not fit; use basis='nodal'")
        return values


def mass_matrix(W):
    """∫ψ_i ψ_j over the cracks, scipy CSR."""
    lam, mu = W.TnT()
    return to_scipy(BilinearForm(lam * mu * W.dcrack).Assemble().mat)


def redundant_functions(body, order, nodes, tolerance=1e-7):
    """Which traces of mesh functions depend on others: the two steps of section 4 of [AHLMR12].

    First a Gram-Schmidt elimination among functions that overlap, then a Lanczos search for what is left of the kernel
    of the mass matrix, one function (that of the largest component) for each kernel vector.
    """
    mass = mass_matrix(core.TraceSpace(body, core.MeshTraceBasis(body, order, nodes, set()), order))
    diagonal = mass.diagonal()
    traced = np.flatnonzero(diagonal > 1e-14 * diagonal.max())
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
    while True:
        value, vector = smallest_eigenpair(mass[kept][:, kept])
        if value > tolerance:
            return set(range(mass.shape[0])) - set(kept)
        kept.pop(int(np.argmax(np.abs(vector))))


def smallest_eigenpair(matrix):
    """Of a symmetric positive semi-definite scipy matrix with unit diagonal: Lanczos on the shifted matrix."""
    if matrix.shape[0] < 20:
        values, vectors = np.linalg.eigh(matrix.toarray())
        return values[0], vectors[:, 0]
    values, vectors = eigsh(matrix, k=1, sigma=-1e-8, v0=np.ones(matrix.shape[0]))
    return values[0], vectors[:, 0]
