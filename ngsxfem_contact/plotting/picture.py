"""What the first process draws of a body that several share; of a single process all of it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .split_mesh import boundary_edges, boundary_mesh, linear_function

if TYPE_CHECKING:
    from ngsolve import GridFunction, Mesh

    from ..share import Share
    from .split_mesh import SplitMesh


class Picture:
    """The own triangles of the SplitMeshes of all processes, one after the other; points between processes are there once for each of them.

    Parameters
    ----------
    split : SplitMesh
        Of this process.
    share
        Its Share.

    Attributes
    ----------
    points, triangles, lips, lip_side
        As of a SplitMesh; empty on other processes.
    edges, names
        (n, 2) and (n,): boundary edges, the lips among them, and the names of their boundaries.
    """

    def __init__(self, split: SplitMesh, share: Share) -> None:
        self.share, self.own = share, share.IsOwn(split.element)
        self.used, corners = np.unique(split.triangles[self.own], return_inverse=True)
        place = np.full(len(split.points), -1)
        place[self.used] = np.arange(len(self.used))
        on_lip = self.own[split.lip_edges // 3]
        edges, names, of = boundary_edges(split)
        on_edge = self.own[of] & (names != "")
        mine = split.points[self.used], corners.reshape(-1, 3), place[split.lips[on_lip]], place[edges[on_edge]], split.lip_side[on_lip], names[on_edge]
        of_all = share.AtFirst(mine) or [tuple(column[:0] for column in mine)]
        first = np.cumsum([0, *(len(rows[0]) for rows in of_all)])
        self.points, self.lip_side, self.names = (np.concatenate([rows[k] for rows in of_all]) for k in (0, 4, 5))
        self.triangles, self.lips, self.edges = (np.concatenate([rows[k] + start for rows, start in zip(of_all, first)]) for k in (1, 2, 3))

    @cached_property
    def mesh(self) -> Mesh:
        """An ngsolve.Mesh of the picture."""
        return boundary_mesh(self.points, self.triangles, self.edges, self.names)

    def Whole(self, values: np.ndarray) -> np.ndarray:
        """The values at all points or corners, from those that each process has of its SplitMesh."""
        of_all = self.share.AtFirst(values[self.used if values.ndim == 2 else self.own])
        return np.concatenate(of_all) if of_all else values[:0]

    def GridFunction(self, values: np.ndarray) -> GridFunction:
        """On `mesh`, from values of Whole."""
        return linear_function(self.mesh, values)
