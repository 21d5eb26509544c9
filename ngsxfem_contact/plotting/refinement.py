"""Pictures of refinement."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..files import write_whole
from ..points import mesh_arrays
from .plots import pyplot

if TYPE_CHECKING:
    from ..estimate.adaptive import AdaptiveSolution


def plot_refinement(found: AdaptiveSolution, path: str | Path) -> Path:
    """The errors of the levels over the unknowns, and the last mesh with the error of each triangle, as a picture; see AdaptiveSolution.Plot."""
    plt = pyplot()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
    levels = [level for level in found.levels if level.relative == level.relative]
    unknowns = [level.unknowns for level in levels]
    left.loglog(unknowns, [level.energy for level in levels], "o-", color="tab:blue", label="energy norm, relative")
    if found.quantity is not None:
        left.loglog(unknowns, [level.relative for level in levels], "s-", color="tab:red", label=f"bar of {found.quantity.goal}, relative")
    left.set(xlabel="unknowns", ylabel="estimated error")
    left.grid(True, which="both", alpha=0.3)
    left.legend()
    body = found.solution.body
    vertices, triangles = mesh_arrays(body.mesh)
    shares = found.estimate.elements if found.quantity is None else found.quantity.elements
    shown = np.log10(np.maximum(shares, 1e-6 * shares.max(initial=1e-300)))
    colours = right.tripcolor(*vertices.T, triangles, facecolors=shown, cmap="viridis")
    right.triplot(*vertices.T, triangles, color="white", linewidth=0.2)
    for crack in body.cracks:
        right.plot(*np.array(crack.Outline()).T, color="tab:red", linewidth=1.5)
    figure.colorbar(colours, ax=right, label="log₁₀ of the error of each triangle")
    right.set(aspect="equal", xlabel="x", ylabel="y", title=f"{body.mesh.ne} triangles")
    try:
        return write_whole(Path(path), figure.savefig)
    finally:
        plt.close(figure)
