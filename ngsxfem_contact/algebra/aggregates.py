"""Coarse functions in the plane by smoothed aggregation: groups of vertices times the rigid motions, smoothed by one step of Jacobi's method.

P. Vaněk, J. Mandel, M. Brezina, Computing 56 (1996) 179-196. Each process groups vertices of its own, by pyamg.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy

from .multigrid import pyamg

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from ..processes import Exchange

DEPENDENT = 1e-6  # of the largest product of a group's motions: with less a motion is a combination of others there
TINY = np.finfo(float).tiny


def motions_at(points: np.ndarray) -> np.ndarray:
    """(n, 2, 3): two translations and the turn about the origin at points (n, 2)."""
    motions = np.zeros((len(points), 2, 3))
    motions[:, [0, 1], [0, 1]] = 1
    motions[:, 0, 2], motions[:, 1, 2] = -points[:, 1], points[:, 0]
    return motions


def grouped(graph: csr_matrix) -> csr_matrix:
    """(n, g): 1 where one of n vertices is in one of g groups; those without an entry in the graph are in none."""
    chosen = np.flatnonzero(np.diff(graph.indptr))
    if not len(chosen):
        return scipy.sparse.csr_matrix(graph.shape)[:, :0]
    groups, _ = pyamg().aggregation.standard_aggregation(graph[chosen][:, chosen].tocsr())
    groups = groups.tocoo()
    return scipy.sparse.csr_matrix((np.ones(groups.nnz), (chosen[groups.row], groups.col)), shape=(graph.shape[0], groups.shape[1]))


def independent_motions(groups: csr_matrix, points: np.ndarray, free: np.ndarray) -> np.ndarray:
    """(g, 3, 3): for each group combinations of `motions_at`, as columns, that are orthogonal on components that are free, (n, 2) bool; zero in place of dependent ones."""
    at, number = groups.tocoo(), groups.shape[1]
    mean = lambda values: np.bincount(at.col, values, number) / np.maximum(np.bincount(at.col, minlength=number), 1)
    centre = np.stack([mean(points[at.row, k]) for k in range(2)], axis=1).reshape(-1, 2)
    radius = np.sqrt(mean(((points[at.row] - centre[at.col]) ** 2).sum(axis=1)))
    around = np.tile(np.eye(3), (number, 1, 1))  # a turn about the centre, as large as the translations
    around[:, 0, 2], around[:, 1, 2] = centre[:, 1], -centre[:, 0]
    around[:, :, 2] /= np.where(radius > 0, radius, 1)[:, None]
    here = (motions_at(points[at.row]) @ around[at.col]) * free[at.row][:, :, None]
    products = np.zeros((number, 3, 3))
    np.add.at(products, at.col, here.transpose(0, 2, 1) @ here)
    values, vectors = np.linalg.eigh(products)
    kept = values > DEPENDENT * np.maximum(values[:, -1:], TINY)
    return around @ (vectors * kept[:, None, :])


@dataclass(frozen=True)
class Vertices:
    """Those of the mesh of a process.

    Parameters
    ----------
    dofs
        (n, 2): the unknowns of the components of each.
    points
        (n, 2).
    """

    dofs: np.ndarray
    points: np.ndarray

    def CumulatedRows(self, additive: csr_matrix, size: int, exchange: Exchange) -> csr_matrix:
        """As that of Exchange for a matrix with a row for each vertex; size: the number of unknowns."""
        place = scipy.sparse.csr_matrix((np.ones(len(self.dofs)), (self.dofs[:, 0], np.arange(len(self.dofs)))), shape=(size, len(self.dofs)))
        return exchange.CumulatedRows((place @ additive).tocsr())[self.dofs[:, 0]]


def tentative(A: csr_matrix, vertices: Vertices, free: np.ndarray, grouping: np.ndarray, exchange: Exchange) -> csr_matrix:
    """The motions of groups as columns, consistent: not smoothed.

    Parameters
    ----------
    A
        Additive.
    free
        (N,) bool, of unknowns.
    grouping
        (n,) bool: vertices that are in groups. Their neighbours have the motions of these groups in equal parts, so that rigid motions of the whole are kept.
    """
    own = grouping & (exchange.Additive(np.ones(A.shape[0])) > 0)[vertices.dofs[:, 0]]
    graph = A[vertices.dofs[:, 0]][:, vertices.dofs[:, 0]]
    graph.data = np.ones(graph.nnz)
    of = lambda rows, matrix: scipy.sparse.diags(rows.astype(float)) @ matrix
    among = (of(own, graph) @ scipy.sparse.diags(own.astype(float))).tocsr()
    among.eliminate_zeros()
    groups = grouped(among)
    of_all = exchange.Gather(independent_motions(groups, vertices.points, free[vertices.dofs]))
    motions, numbers = np.concatenate(of_all), [len(some) for some in of_all]
    others = [scipy.sparse.csr_matrix((len(own), sum(some))) for some in (numbers[: exchange.rank], numbers[exchange.rank + 1 :])]
    weights = vertices.CumulatedRows(scipy.sparse.hstack([others[0], groups, others[1]]).tocsr(), A.shape[0], exchange)
    beside = vertices.CumulatedRows((of(~grouping, graph) @ weights).tocsr(), A.shape[0], exchange)
    at = (weights + of(1 / np.maximum(np.asarray(beside.sum(axis=1)).ravel(), 1), beside)).tocoo()
    values = at.data[:, None, None] * free[vertices.dofs[at.row]][:, :, None] * (motions_at(vertices.points[at.row]) @ motions[at.col])
    rows, columns = np.broadcast_arrays(vertices.dofs[at.row][:, :, None], 3 * at.col[:, None, None] + np.arange(3))
    columns_kept = np.flatnonzero(motions.any(axis=1).ravel())
    return scipy.sparse.csc_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(A.shape[0], 3 * len(motions)))[:, columns_kept].tocsr()
