"""Growth of cracks step by step, contact active throughout, on one mesh: docs/method.md, section 9."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import check_number, check_whole
from ..errors import NotHeld, SingularSystem
from ..geometry import Crack, CrackedMesh, Sheet
from ..protocols import CrackInitiation, GrowthCriterion, GrowthLaw, members
from ..share import share_in
from ..spaces.resolution import warn_of_short_increment
from ..tables import Table
from .extension import ENDS, ROOM, arrival_of, check_cracks, check_room, extended, tip_number, turned, with_crack
from .growth_laws import MaximumHoopStress
from .stress_intensity import is_closed
from .tip_fields import TipFrame

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..contact.solution import ContactSolution
    from .initiation import NewCrack

logger = logging.getLogger(__name__)

GROWS, WAITS, STARTS = "grows", "waits: it grows less than half an increment", "starts"


@dataclass
class TipStep:
    """One tip in one state of the cracks, or a crack that starts from it.

    Attributes
    ----------
    crack, name
        The number of the crack, in the order in which they came, and its name; -1 of one that does not fit.
    end
        "start" or "end" of the crack, where its tip is; "new" of one that starts.
    x, y
        Of the tip, or where the crack starts.
    length, K_I, K_II, error, driving
        Of this state.
    cycles
        That led to it; 0 at first.
    angle, advance
        Where the tip goes from here, in degrees from ahead and in length; of a crack that starts from the direction of x, and its length.
    state
        "grows", "starts" with the reason, or why it does not.
    stress
        That lets a crack start; nan at tips.
    """

    step: int
    crack: int
    end: str
    x: float
    y: float
    length: float
    K_I: float = float("nan")
    K_II: float = float("nan")
    error: float = float("nan")
    driving: float = float("nan")
    angle: float = 0.0
    advance: float = 0.0
    cycles: float = 0.0
    state: str = ""
    name: str = ""
    stress: float = float("nan")


class CrackGrowth:
    """Solves, evaluates K at every tip and lets the cracks grow, again and again; the mesh never changes.

    Parameters
    ----------
    make_problem
        Function of a list of cracks that returns the ContactProblem on the one mesh, loads included.
    cracks
        The first cracks, a list of Crack; with initiation it may be empty.
    law
        GivenIncrement(da) or Paris(C, m, da).
    criterion
        MaximumHoopStress() or WingCracks(), or an object with grows_closed, Angle and Driving.
    toughness
        Tips with less Driving stay as they are, in stress × √length; default 0.
    initiation
        Where further cracks start: StressInitiation(...), JunctionInitiation(...), an object with Starts(solution), or several of them; default nowhere.
    previous
        The ContactSolution whose history the faces have at first; default none.

    Attributes
    ----------
    cracks
        Those of the last rows.
    rows
        A TipStep for each tip of each state, for those that cut through, and for each crack that starts.
    solutions
        Of the states.
    cycles
        That led to the last one.

    Notes
    -----
    da should be three elements or more, AccuracyWarning says where it is less: behind a turn the tip's functions have room on the new part only. A turn
    that the error of K_II may have made is none: the tip goes straight on, without a kink. A tip that comes within 2.5 elements of ∂Ω, or of another crack, goes on to it
    and ends there; two tips that meet so become one crack's. Where that leaves a part of the body free to move, the growth ends.

    A law of the faces that depends on the path (friction, damage) goes on from the state before: slip counts from there, damage stays, new faces have gone through nothing. So the states are load steps,
    of the load that make_problem gives each. Cracks keep their names; one that starts is called by what it starts from, "fault/1".
    """

    def __init__(
        self,
        make_problem: Callable[..., Any],
        cracks: list[Crack],
        law: GrowthLaw,
        criterion: GrowthCriterion = MaximumHoopStress(),
        toughness: float = 0.0,
        initiation: CrackInitiation | Sequence[CrackInitiation] = (),
        previous: ContactSolution | None = None,
    ) -> None:
        check_number(toughness, "CrackGrowth: toughness", lambda toughness: 0 <= toughness < float("inf"), "be a finite number >= 0")
        if not callable(make_problem):
            raise TypeError(f"CrackGrowth: make_problem={make_problem!r} is not a function of a list of cracks that returns a ContactProblem")
        self.initiation = tuple(initiation) if isinstance(initiation, (list, tuple)) else (initiation,)
        if isinstance(cracks, (list, tuple)) and any(isinstance(crack, Sheet) for crack in cracks):
            raise TypeError("CrackGrowth: cracks of the plane grow here, and these are sheets; take SheetGrowth")
        if not isinstance(cracks, (list, tuple)) or not (cracks or self.initiation) or not all(isinstance(crack, Crack) for crack in cracks):
            raise TypeError(f"CrackGrowth: cracks={cracks!r} is not a list of one or more cracks, or of none with initiation=")
        roles = [("law", law, GrowthLaw), ("criterion", criterion, GrowthCriterion), *(("initiation", each, CrackInitiation) for each in self.initiation)]
        for name, value, role in roles:
            if lacks := [member for member in members(role) if not hasattr(value, member)]:
                raise TypeError(f"CrackGrowth: {name}={value!r} needs {' and '.join(lacks)}")
        self.make_problem, self.cracks, self.law, self.criterion, self.toughness = make_problem, list(cracks), law, criterion, toughness
        self.solutions, self.rows, self.previous = [], [], previous
        self.cycles = 0.0
        self._next = self.cracks, self.cycles  # of the next state
        self._ended, self._owed = {}, {}  # by (crack, end): why a tip stopped for good; advance not yet made
        self._cut = {}  # by (crack, end): where it went through ∂Ω
        self._warned, self._count = False, 0  # whether of short increments; the number of states so far

    def Run(self, steps: int) -> Table:
        """At most so many states, until no tip grows and nothing starts; returns the table. Raises what a solve raises; what was done before is kept.

        Parameters
        ----------
        steps : int
            The largest number of states.

        """
        check_whole(steps, "CrackGrowth: steps", 0)
        for number in range(steps):
            logger.info("crack growth, step %d of at most %d", number + 1, steps)
            if not any(row.state in (GROWS, WAITS) or row.state.startswith(STARTS) for row in self.Step()):
                break
        return self.table

    def Step(self) -> list[TipStep]:
        """The next state: growth as the last rows say, one solve; returns its TipSteps, one for each tip. A solve that fails raises, what was done is kept."""
        cracks, cycles = self._next
        rows = [
            TipStep(self._count, crack, end, x, y, cracks[crack].length, cycles=cycles, state=self._ended[crack, end], name=cracks[crack].name)
            for (crack, end), (x, y) in self._cut.items()
        ]
        try:
            rows = self._solved(cracks, cycles) + rows
        except (SingularSystem, NotHeld) as error:
            if not self._cut:
                raise  # otherwise a part of the body is cut off, and free
            if isinstance(error, NotHeld):
                for row in rows:
                    row.state += "; the faces do not hold what is cut off"
        self.cracks, self.cycles = cracks, cycles
        self.rows += rows
        self._count += 1
        return rows

    def _solved(self, cracks: list[Crack], cycles: float) -> list[TipStep]:
        """The rows of the tips of a state, and of the cracks that start there; plans the next one."""
        problem = self.make_problem(cracks)
        if not hasattr(problem, "Solve"):
            raise TypeError(f"CrackGrowth: make_problem returned {problem!r}; it must return a ContactProblem")
        check_cracks(problem.body, cracks)
        solution = problem.Solve(previous=self._history(problem))
        rows = [self._evaluate(solution, number) for number in range(len(solution.body.tips))]
        starting = [new for each in self.initiation for new in each.Starts(solution)]
        self._next = cracks, cycles
        growing = [row for row in rows if not row.state]
        if growing:
            advances, more = self.law.Advances(np.array([row.driving for row in growing]))
            self._next = cracks, cycles + more
            for row, advance in sorted(zip(growing, advances), key=lambda pair: -pair[0].driving):
                self._grow(solution, row, float(advance))
        rows += [self._start(solution, new) for new in starting]
        for row in rows:
            row.cycles = cycles
        solution.ReleaseFactors()  # there may be many states
        self.solutions.append(solution)
        return rows

    def _history(self, problem: Any) -> ContactSolution | None:
        """Of which the faces remember what they went through."""
        return (self.solutions[-1] if self.solutions else self.previous) if problem.law.depends_on_path else None

    def _start(self, solution: ContactSolution, new: NewCrack) -> TipStep:
        """The row of a crack that starts; it is one of the next state, unless it does not fit."""
        cracks, cycles = self._next
        names, n = {crack.name for crack in cracks}, 1
        while (name := f"{new.origin}/{n}") in names:
            n += 1
        x, y = new.point
        row = TipStep(self._count, -1, "new", x, y, 0.0, angle=new.angle, name=name, stress=new.stress)
        trial = [*cracks, Crack.OfPieces(new.crack.pieces, name)]
        try:
            body = CrackedMesh(share_in(solution.body).source, *trial)
            for tip in body.tips:
                if tip.crack == len(cracks):
                    check_room(body, solution.problem.material, tip.crack, ENDS[int(tip.s > 0)])
        except Exception as obstacle:  # of the core, as in _grow
            row.state = f"does not start: {obstacle}"
        else:
            self._next, row.crack, row.advance, row.state = (trial, cycles), len(cracks), new.crack.length, f"{STARTS}: {new.reason}"
        return row

    def _evaluate(self, solution: ContactSolution, number: int) -> TipStep:
        """Factors and driving force of a tip; a state if it does not grow."""
        tip = solution.body.tips[number]
        crack, end = key = tip.crack, ENDS[int(tip.s > 0)]
        x, y = tip.point
        row = TipStep(self._count, crack, end, x, y, solution.body.cracks[crack].length, state=self._ended.get(key, ""), name=solution.body.cracks[crack].name)
        try:
            factors = solution.StressIntensity(number)
        except ValueError as no_room:
            row.state = self._ended[key] = row.state or f"stopped: {no_room}"
            return row
        row.K_I, row.K_II, row.error = factors.K_I, factors.K_II, factors.error
        closed = row.K_I <= row.error or is_closed(solution, number)  # K_I < 0 is contact that the mesh does not resolve
        K = (0.0 if closed else row.K_I, row.K_II)
        row.driving = self.criterion.Driving(*K)
        if abs(row.K_II) > row.error:
            row.angle = degrees(self.criterion.Angle(*K))
        row.state = row.state or self._arrest(row, closed)
        return row

    def _arrest(self, row: TipStep, closed: bool) -> str:
        if closed and not self.criterion.grows_closed:
            return "arrested: the faces touch at the tip, K_I = 0"
        if row.driving <= max(self.toughness, row.error):
            return f"arrested: driving {row.driving:.3g} is not above {'the toughness' if self.toughness > row.error else 'its own error'}"
        return ""

    def _grow(self, solution: ContactSolution, row: TipStep, advance: float) -> None:
        """Extends the crack of the next state, unless the new tip would not fit; small advances wait until they add up to half of da."""
        key = (row.crack, row.end)
        advance += self._owed.pop(key, 0.0)
        if advance < 0.5 * self.law.da:
            self._owed[key] = advance
            row.state = WAITS
            return
        cracks, cycles = self._next
        frame = TipFrame(solution.body, tip_number(solution.body, *key))
        self._warned = self._warned or warn_of_short_increment(solution.body, frame.tip, advance)
        if self._arrives(solution, row, frame, advance):
            return
        tip = tuple(np.array(frame.tip.point) + advance * turned(frame, row.angle))
        trial = with_crack(cracks, row.crack, extended(cracks[row.crack], row.end, tip))
        try:
            check_room(CrackedMesh(share_in(solution.body).source, *trial), solution.problem.material, *key)
        except Exception as obstacle:  # of the core: the new part leaves the body, meets its own crack, or has no room
            row.state = self._ended[key] = f"stopped: {obstacle}"
        else:
            self._next, row.advance, row.state = (trial, cycles), advance, GROWS

    def _arrives(self, solution: ContactSolution, row: TipStep, frame: TipFrame, advance: float) -> bool:
        """Whether the way ahead ends at ∂Ω or on another crack before the advance, or so soon after it that no tip fits between; then the next state ends there."""
        (cracks, cycles), mesh, key = self._next, solution.body.mesh, (row.crack, row.end)
        arrival = arrival_of(mesh, cracks, row.crack, np.array(frame.tip.point), turned(frame, row.angle), advance, ROOM * frame.h)
        if arrival is None:
            return False
        goal, what = arrival
        try:
            longer = with_crack(cracks, row.crack, extended(cracks[row.crack], row.end, tuple(goal)))
            fitted = CrackedMesh(share_in(solution.body).source, *longer)
        except Exception:  # of the core, as in _grow
            return False
        if any((tip.crack, ENDS[int(tip.s > 0)]) == key for tip in fitted.tips):
            return False
        end = fitted.cracks[row.crack].points[0 if row.end == "start" else -1]  # on the curve of ∂Ω
        self._next, row.advance, row.state = (fitted.cracks, cycles), float(np.hypot(*np.subtract(end, frame.tip.point))), GROWS
        self._cut[key] = end
        self._ended[key] = f"{what} at ({end[0]:.6g}, {end[1]:.6g})"
        return True

    @property
    def table(self) -> Table:
        """A Table with the fields of TipStep, one row for each state and tip, and for each crack that starts."""
        return Table.OfRows(map(vars, self.rows), TipStep.__dataclass_fields__)

    def __str__(self) -> str:
        called = [r.name or str(r.crack) for r in self.rows]
        width = max(map(len, [*called, "crack"]))
        lines = [f"step {'crack':>{width}} end          x         y   length       K_I      K_II   angle  advance     cycles  state"]
        for name, r in zip(called, self.rows):
            lines.append(
                f"{r.step:4} {name:>{width}} {r.end:5} {r.x:9.5f} {r.y:9.5f} {r.length:8.5f} {r.K_I:9.4g} {r.K_II:9.3g} {r.angle:7.2f} {r.advance:8.4g} {r.cycles:10.4g}  {r.state}"
            )
        return "\n".join(lines)

    __repr__ = __str__

    def SaveTable(self, path: str | Path) -> Path:
        """Writes the table as CSV; returns the path. The file appears when it is complete.

        Parameters
        ----------
        path : str
            The file.
        """
        return self.table.SaveCSV(path)

    def Animate(self, path: str | Path, scale: float | None = None, seconds: float = 0.5) -> str:
        """Writes the opened body of every state as an animated GIF (needs matplotlib with pillow); returns the path.

        Parameters
        ----------
        path : str
            The file, .gif.
        scale : float
            Of the displacement; default: the largest is 5 % of the body.
        seconds : float
            For each state.
        """
        from ..plotting.plots import animate

        if not self.solutions:
            raise ValueError("CrackGrowth: there is no step to show; call Run(steps) first")
        titles = [
            f"step {i}, " + ", ".join(f"K_I {r.K_I:.3g}  K_II {r.K_II:.2g}" for r in self.rows if r.step == i and r.K_I == r.K_I)
            for i in range(len(self.solutions))
        ]
        return animate(self.solutions, path, titles, scale, seconds)
