"""Planar sheets that grow in their plane: each point of a closed front moves ahead as a law says of its K_I."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

import numpy as np
import scipy

from .._ngsxfem_contact import Sheet
from ..arguments import check_number, check_whole
from ..curves import of_spline
from ..protocols import GrowthLaw, check_role
from ..tables import Table
from .front_stress_intensity import FrontFactors
from .front_tube import FrontCurve

logger = logging.getLogger(__name__)

POINTS = 64  # of the new curve, at least


def grown_sheet(factors: FrontFactors, advances: np.ndarray) -> Sheet:
    """The sheet whose closed front has moved ahead, along e₁.

    Parameters
    ----------
    factors
        At the front before, whose nodes are at equal distances.
    advances
        (n,), lengths at the nodes. Between them, and instead of them, is the trigonometric polynomial with a fourth as many harmonics as there are nodes that
        is nearest: what one node has alone is an error, not a shape.

    Raises
    ------
    ValueError
        For a front with corners, one that ends on ∂Ω, or of a curved sheet.
    Exception
        For a new curve that meets itself.
    """
    body, count = factors.body, len(advances)
    curve = FrontCurve(body, factors.front)
    if not curve.closed:
        raise ValueError(f"front {factors.front} has corners or ends on the boundary; so far only smooth closed fronts grow")
    number = max(POINTS, 4 * count)
    harmonics = np.fft.rfft(advances)[: count // 4 + 1] / count
    s = curve.length * np.arange(number) / number
    moved = np.fft.irfft(np.pad(harmonics, (0, number // 2 + 1 - len(harmonics))), number) * number
    sheet = body.cracks[curve.front.sheet]
    if not sheet.planar:
        raise ValueError(f"front {factors.front} is that of a curved sheet; so far only fronts in a plane grow")
    points = curve.Points(s) + moved[:, None] * curve.Frames(s)[:, 0]
    plane = (points - sheet.origin) @ np.array(sheet.axes).T
    plane = np.concatenate([plane, plane[:1]])
    chords = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(plane, axis=0).T))])
    loops = list(sheet.loops)
    loops[curve.front.loop] = of_spline(scipy.interpolate.CubicSpline(chords, plane, bc_type="periodic"))
    return Sheet(loops, sheet.origin, sheet.axes)


class SheetGrowth:
    """Evaluates K along fronts and lets them grow in the plane of their sheets, again and again.

    Parameters
    ----------
    evaluate
        Function of a list of sheets that solves a problem with them and returns the FrontFactors of the fronts that may grow, a list.
    sheets
        The first ones, a list.
    law
        GivenIncrement(da) or Paris(C, m, da), of K_I: the point with the largest one advances by da.
    toughness
        Points with less K_I, or with no more than its error, stay, in stress × √length; default 0.

    Attributes
    ----------
    sheets
        Those of the next state.
    factors
        Of each state so far, a list of FrontFactors.
    cycles
        That lead to the next state.

    Notes
    -----
    One explicit step for each state: the error of cycles and shapes is of the order of da. K_II and K_III, which would turn the front out of its plane, are
    not asked.
    """

    def __init__(self, evaluate: Callable[[list[Sheet]], Sequence[FrontFactors]], sheets: Sequence[Sheet], law: GrowthLaw, toughness: float = 0.0) -> None:
        check_number(toughness, "SheetGrowth: toughness", lambda toughness: 0 <= toughness < float("inf"), "be a finite number >= 0")
        if not callable(evaluate):
            raise TypeError(f"SheetGrowth: evaluate={evaluate!r} is not a function of a list of sheets that returns a list of FrontFactors")
        if not isinstance(sheets, (list, tuple)) or not sheets or not all(isinstance(sheet, Sheet) for sheet in sheets):
            raise TypeError(f"SheetGrowth: sheets={sheets!r} is not a list of one or more sheets")
        check_role(law, GrowthLaw, "SheetGrowth: law", "GivenIncrement(da) or Paris(C, m, da)")
        self.evaluate, self.sheets, self.law, self.toughness = evaluate, list(sheets), law, toughness
        self.factors: list[list[FrontFactors]] = []
        self.cycles = 0.0
        self._rows: list[Table] = []

    def Step(self) -> bool:
        """The next state: K along the fronts, and the sheets of the one after it; returns whether any point grows. What raises leaves what was done."""
        found = self.evaluate(self.sheets)
        if not isinstance(found, (list, tuple)) or not found or not all(isinstance(f, FrontFactors) for f in found):
            raise TypeError(
                f"SheetGrowth: evaluate returned {found!r}, which is not a list of one or more FrontFactors; return [solution.StressIntensity(front)]"
            )
        found = list(found)
        driving = np.concatenate([np.where(f.K_I > np.maximum(self.toughness, f.errors[:, 0]), f.K_I, 0.0) for f in found])
        grows = bool((driving > 0).any())
        advances, cycles = self.law.Advances(driving) if grows else (np.zeros(len(driving)), 0.0)
        advances = np.where(driving > 0, advances, 0.0)
        sheets, rows, first = list(self.sheets), [], 0
        for f in found:
            here, first = advances[first : first + len(f.s)], first + len(f.s)
            number = f.body.fronts[f.front].sheet
            if here.any():
                if sheets[number] is not self.sheets[number]:
                    raise ValueError(f"SheetGrowth: two fronts of sheet {number} grow; so far one of each sheet can")
                sheets[number] = grown_sheet(f, here)
            state = {"step": np.full(len(f.s), len(self.factors)), "cycles": np.full(len(f.s), self.cycles)}
            rows.append(Table.Of(state | f.columns | {"advance": here}))
        logger.info("growth of sheets, state %d: K_I up to %.4g", len(self.factors), driving.max())
        self._rows += rows
        self.factors.append(found)
        self.sheets, self.cycles = sheets, self.cycles + cycles
        return grows

    def Run(self, steps: int) -> Table:
        """At most so many states, until nothing grows; returns the table.

        Parameters
        ----------
        steps : int
            The largest number of states.
        """
        check_whole(steps, "SheetGrowth: steps", 0)
        for _ in range(steps):
            if not self.Step():
                break
        return self.table

    @property
    def table(self) -> Table:
        """A Table with a row for each node in each state: step, cycles, the columns of FrontFactors.table, and how far the node advances from there."""
        return np.concatenate(self._rows).view(Table) if self._rows else Table.Of({"step": [], "cycles": []})
