"""What of a mesh of tetrahedra lies on one side of a plane: its faces, and the section."""

from __future__ import annotations

from itertools import combinations

import numpy as np


def between(d: np.ndarray, i: int, j: int) -> np.ndarray:
    """Weights (n, corners) of the points of edges from corner i to j where d (n, corners) is 0."""
    weights = np.zeros_like(d)
    weights[:, i] = d[:, j] / (d[:, j] - d[:, i])
    weights[:, j] = 1 - weights[:, i]
    return weights


def corner(d: np.ndarray, i: int) -> np.ndarray:
    """Weights (n, corners) of corner i."""
    return np.tile(np.eye(d.shape[1])[i], (len(d), 1))


def below(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of triangles with distances d (n, 3) of their corners from a plane those (m,) that have something below it, d < 0, and it: weights (m, 3, 3) of corners of triangles."""
    rows, found = [], []

    def add(chosen: np.ndarray, *points: np.ndarray) -> None:
        rows.append(np.flatnonzero(chosen))
        found.append(np.stack(points, axis=1).reshape(-1, 3, 3))

    is_below = d < 0
    add(is_below.all(axis=1), *(corner(d[is_below.all(axis=1)], i) for i in range(3)))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        alone = is_below[:, i] & ~is_below[:, j] & ~is_below[:, k]
        add(alone, corner(d[alone], i), between(d[alone], i, j), between(d[alone], i, k))
        two = ~is_below[:, i] & is_below[:, j] & is_below[:, k]
        add(two, corner(d[two], j), corner(d[two], k), between(d[two], k, i))
        add(two, corner(d[two], j), between(d[two], k, i), between(d[two], j, i))
    return np.concatenate(rows), np.concatenate(found)


def section(d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of tetrahedra with distances d (n, 4) those (m,) that a plane cuts, and triangles of the cut: weights (m, 3, 4) of corners."""
    rows, found = [], []

    def add(chosen: np.ndarray, *points: np.ndarray) -> None:
        rows.append(np.flatnonzero(chosen))
        found.append(np.stack(points, axis=1))

    is_below = d < 0
    count = is_below.sum(axis=1)
    for i in range(4):
        others = [j for j in range(4) if j != i]
        alone = ((count == 1) & is_below[:, i]) | ((count == 3) & ~is_below[:, i])
        add(alone, *(between(d[alone], i, j) for j in others))
    for i, j in list(combinations(range(4), 2))[:3]:
        k, m = (n for n in range(4) if n not in (i, j))
        two = (count == 2) & (is_below[:, i] == is_below[:, j])
        corners = [between(d[two], a, b) for a, b in ((i, k), (j, k), (j, m), (i, m))]
        add(two, *corners[:3])
        add(two, corners[0], *corners[2:])
    return np.concatenate(rows), np.concatenate(found)
