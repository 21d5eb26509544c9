"""K along fronts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .plots import pyplot
from .sheet_trace import SheetTrace
from .solid_files import along, between_nodes, check_factors
from .solid_plots import SheetView

if TYPE_CHECKING:
    from ..fracture.front_stress_intensity import FrontFactors

NAMES = {"K_I": "tab:blue", "K_II": "tab:orange", "K_III": "tab:green"}
QUANTITIES = (*NAMES, "G")


def plot_front(factors: FrontFactors, ax: Any = None, quantity: str = "K_I") -> list[Any]:
    """A front coloured by K or G, and K_I, K_II, K_III over its arc length with their errors as bars; returns both axes.

    Parameters
    ----------
    factors : FrontFactors
        Of `solution.StressIntensity(front)`.
    ax : Axes
        Two of matplotlib; default new ones.
    quantity : str
        "K_I", "K_II", "K_III" or "G", which colours the front.

    Raises
    ------
    TypeError, ValueError
        For what are no FrontFactors, and for another quantity.
    """
    from matplotlib.collections import LineCollection

    check_factors(factors, "plot_front: factors")
    if quantity not in QUANTITIES:
        raise ValueError(f"plot_front: quantity={quantity!r} is not one of {QUANTITIES}")
    if ax is None:
        ax = pyplot().subplots(1, 2, figsize=(10.5, 4.4), layout="constrained", width_ratios=(1, 1.15))[1]
    left, right = axes = list(np.ravel(ax))
    front = factors.body.fronts[factors.front]
    view, s = SheetView(SheetTrace(factors.body, front.sheet)), along(front, factors)
    line = view.Of(np.array([front.PointAt(float(si)) for si in s]))
    values = between_nodes(front, factors, quantity, s)
    middle = 0.5 * (values[1:] + values[:-1])
    known = np.isfinite(middle)
    left.add_collection(LineCollection(list(view.outline), colors="0.75", linewidths=1.0))
    segments = np.stack([line[:-1], line[1:]], axis=1)[known]
    coloured = left.add_collection(LineCollection(list(segments), array=middle[known], cmap="viridis", linewidths=4, capstyle="round"))
    coloured.set_clim(min(0, middle[known].min()), max(0, middle[known].max()))
    view.Bar(left, coloured, label_of(quantity))
    left.plot(*line[0], "o", color="tab:red", markersize=6)
    left.annotate("s = 0", line[0], textcoords="offset points", xytext=(7, -14), color="tab:red")
    view.Name(left)
    around = np.append(np.arange(len(factors.s)), 0) if front.closed else np.arange(len(factors.s))
    at = np.append(factors.s, front.length + factors.s[0]) if front.closed else factors.s
    for (name, colour), error in zip(NAMES.items(), factors.errors.T):
        right.errorbar(
            at, getattr(factors, name)[around], yerr=error[around], color=colour, marker="o", markersize=3, capsize=2, linewidth=1.2, label=label_of(name)
        )
    right.axhline(0, color="0.5", linewidth=0.6)
    margin = 0.02 * front.length
    right.set(xlabel="arc length s along the front", ylabel="stress intensity factor", xlim=(-margin, front.length + margin))
    right.legend(loc="best")
    return axes


def label_of(quantity: str) -> str:
    """In TeX."""
    return f"$K_{{\\mathrm{{{quantity[2:]}}}}}$" if quantity in NAMES else "$G$"
