"""Points of cracks, and distances in the plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import VOL, ElementId

if TYPE_CHECKING:
    from ngsolve import Mesh

    from ._ngsxfem_contact import CrackedMesh


def distance_to_segments(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> float:
    """Of a point from the nearest of the segments from a to b, (n, 2) each; inf if there are none."""
    if len(a) == 0:
        return np.inf
    t = np.clip(np.einsum("ij,ij->i", point - a, b - a) / np.einsum("ij,ij->i", b - a, b - a), 0, 1)
    return float(np.hypot(*(a + t[:, None] * (b - a) - point).T).min())


def place(point: tuple[float, float]) -> str:
    """A point in a message."""
    return f"({point[0]:.4g}, {point[1]:.4g})"


def crack_points(body: CrackedMesh, crack: int, arclengths: list[float] | np.ndarray) -> np.ndarray:
    """NGSolve's mesh points at arc lengths of a crack, each in an element that carries that part of it."""
    return mesh_points(body.mesh, *body.OnCrack(crack, list(arclengths)))


def mesh_points(mesh: Mesh, elements: np.ndarray, xi: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """NGSolve's mesh points at reference coordinates in elements, (n,) each."""
    inside = np.mean([mesh[v].point for v in mesh[ElementId(VOL, 0)].vertices], axis=0)
    points = np.repeat(mesh(*inside[:, None]), len(elements))
    points["nr"], points["x"], points["y"] = elements, xi, eta
    return points


def mesh_arrays(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n,2) and triangles (m,3) of an NGSolve mesh, in its numbering."""
    return mesh.ngmesh.Coordinates()[:, :2].copy(), mesh.ngmesh.Elements2D().NumPy()["nodes"][:, :3].astype(int) - 1
