"""Growth of cracks step by step, contact active throughout, on one mesh: docs/method.md, section 9."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from math import cos, degrees, pi, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._ngsxfem_contact import Crack, CrackedMesh
from ..arguments import check_number, check_whole
from ..errors import SingularSystem
from ..protocols import GrowthCriterion, GrowthLaw, members
from ..spaces.resolution import warn_of_short_increment
from ..tables import Table
from .growth_laws import MaximumHoopStress
from .stress_intensity import is_closed
from .tip_fields import TipFrame, boundary_segments, distance_along

if TYPE_CHECKING:
    from collections.abc import Callable

    from ngsolve import Mesh

    from ..contact.solution import ContactSolution
    from ..material import Isotropic

logger = logging.getLogger(__name__)

ENDS = ("start", "end")
GROWS, WAITS = "grows", "waits: it grows less than half an increment"
ROOM = 2.5  # elements between a new tip and what is next


@dataclass
class TipStep:
    """One tip in one state of the cracks.

    Attributes
    ----------
    length, K_I, K_II, error, driving
        Of this state.
    cycles
        That led to it; 0 at first.
    angle, advance
        Where the tip goes from here, in degrees from ahead and in length.
    state
        "grows", or why it does not.
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


class CrackGrowth:
    """Solves, evaluates K at every tip and lets the cracks grow, again and again; the mesh never changes.

    Parameters
    ----------
    make_problem
        Function of a list of cracks that returns the ContactProblem on the one mesh, loads included.
    cracks
        The first cracks, a list of Crack.
    law
        GivenIncrement(da) or Paris(C, m, da).
    criterion
        MaximumHoopStress() or WingCracks(), or an object with grows_closed, Angle and Driving.
    toughness
        Tips with less Driving stay as they are, in stress × √length; default 0.

    Attributes
    ----------
    cracks
        Those of the last rows.
    rows
        A TipStep for each tip of each state, at the end of those that cut through.
    solutions
        Of the states.
    cycles
        That led to the last one.

    Notes
    -----
    da should be three elements or more, AccuracyWarning says where it is less: behind a turn the tip's functions have room on the new part only. A turn
    that the error of K_II may have made is none: the tip goes straight on, without a kink. A tip that comes within 2.5 elements of ∂Ω, or of another crack, goes on to it
    and ends there; two tips that meet so become one crack's. Where that leaves a part of the body free to move, the growth ends. Every state is solved from the unloaded body: friction has no memory of the states
    before.
    """

    def __init__(
        self, make_problem: Callable[..., Any], cracks: list[Crack], law: GrowthLaw, criterion: GrowthCriterion = MaximumHoopStress(), toughness: float = 0.0
    ) -> None:
        check_number(toughness, "CrackGrowth: toughness", lambda toughness: 0 <= toughness < float("inf"), "be a finite number >= 0")
        if not callable(make_problem):
            raise TypeError(f"CrackGrowth: make_problem={make_problem!r} is not a function of a list of cracks that returns a ContactProblem")
        if not isinstance(cracks, (list, tuple)) or not cracks or not all(isinstance(crack, Crack) for crack in cracks):
            raise TypeError(f"CrackGrowth: cracks={cracks!r} is not a list of one or more cracks")
        for name, value, role in (("law", law, GrowthLaw), ("criterion", criterion, GrowthCriterion)):
            if lacks := [member for member in members(role) if not hasattr(value, member)]:
                raise TypeError(f"CrackGrowth: {name}={value!r} needs {' and '.join(lacks)}")
        self.make_problem, self.cracks, self.law, self.criterion, self.toughness = make_problem, list(cracks), law, criterion, toughness
        self.solutions, self.rows = [], []
        self.cycles = 0.0
        self._next = self.cracks, self.cycles  # of the next state
        self._ended, self._owed = {}, {}  # by (crack, end): why a tip stopped for good; advance not yet made
        self._cut = {}  # by (crack, end): where it went through ∂Ω
        self._warned = False

    def Run(self, steps: int) -> Table:
        """At most so many states, until no tip grows; returns the table. Raises what a solve raises; what was done before is kept.

        Parameters
        ----------
        steps : int
            The largest number of states.

        """
        check_whole(steps, "CrackGrowth: steps", 0)
        for number in range(steps):
            logger.info("crack growth, step %d of at most %d", number + 1, steps)
            if not any(row.state == GROWS or row.state == WAITS for row in self.Step()):
                break
        return self.table

    def Step(self) -> list[TipStep]:
        """The next state: growth as the last rows say, one solve; returns its TipSteps, one for each tip. A solve that fails raises, what was done is kept."""
        cracks, cycles = self._next
        rows = [
            TipStep(self._count, crack, end, x, y, cracks[crack].length, cycles=cycles, state=self._ended[crack, end])
            for (crack, end), (x, y) in self._cut.items()
        ]
        try:
            rows = self._solved(cracks, cycles) + rows
        except SingularSystem:
            if not self._cut:
                raise  # otherwise a part of the body is cut off, and free
        self.cracks, self.cycles = cracks, cycles
        self.rows += rows
        return rows

    @property
    def _count(self) -> int:
        """The number of states so far."""
        return self.rows[-1].step + 1 if self.rows else 0

    def _solved(self, cracks: list[Crack], cycles: float) -> list[TipStep]:
        """The rows of the tips of a state; plans the next one."""
        problem = self.make_problem(cracks)
        if not hasattr(problem, "Solve"):
            raise TypeError(f"CrackGrowth: make_problem returned {problem!r}; it must return a ContactProblem")
        solution = problem.Solve()
        rows = [self._evaluate(solution, number) for number in range(len(solution.body.tips))]
        self._next = cracks, cycles
        growing = [row for row in rows if not row.state]
        if growing:
            advances, more = self.law.Advances(np.array([row.driving for row in growing]))
            self._next = cracks, cycles + more
            for row, advance in sorted(zip(growing, advances), key=lambda pair: -pair[0].driving):
                self._grow(solution, row, float(advance))
        for row in rows:
            row.cycles = cycles
        self.solutions.append(solution)
        return rows

    def _evaluate(self, solution: ContactSolution, number: int) -> TipStep:
        """Factors and driving force of a tip; a state if it does not grow."""
        tip = solution.body.tips[number]
        crack, end = key = tip.crack, ENDS[int(tip.s > 0)]
        x, y = tip.point
        row = TipStep(self._count, crack, end, x, y, solution.body.cracks[crack].length, state=self._ended.get(key, ""))
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
            check_room(CrackedMesh(solution.body.mesh, *trial), solution.problem.material, *key)
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
            fitted = CrackedMesh(mesh, *longer)
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
        """A Table with the fields of TipStep, one row for each state and tip."""
        return Table.OfRows(map(vars, self.rows), TipStep.__dataclass_fields__)

    def __str__(self) -> str:
        lines = ["step crack end          x         y   length       K_I      K_II   angle  advance     cycles  state"]
        for r in self.rows:
            lines.append(
                f"{r.step:4} {r.crack:5} {r.end:5} {r.x:9.5f} {r.y:9.5f} {r.length:8.5f} {r.K_I:9.4g} {r.K_II:9.3g} {r.angle:7.2f} {r.advance:8.4g} {r.cycles:10.4g}  {r.state}"
            )
        return "\n".join(lines)

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


def arrival_of(
    mesh: Mesh, cracks: list[Crack], number: int, point: np.ndarray, direction: np.ndarray, advance: float, room: float
) -> tuple[np.ndarray, str] | None:
    """(where, what it does) of a crack that grows from a point: it meets ∂Ω or another crack within the advance and the room behind it, or comes so near to one.

    None if there is room for a tip.
    """
    outlines = {c: np.array(crack.Outline(0.01)) for c, crack in enumerate(cracks) if c != number}
    ways = [(distance_along(line[:-1], line[1:], point, direction), f"has joined crack {c}: it reached it") for c, line in outlines.items()]
    way, what = min([(distance_along(*boundary_segments(mesh), point, direction), "has cut the body: it reached the boundary"), *ways])
    if way <= advance + room:
        return point + way * direction, what
    tip = point + advance * direction
    nearest = [(cracks[c].Distance(tuple(tip)), c) for c in outlines]
    distance, other = min(nearest, default=(np.inf, -1))
    if distance > room:
        return None
    goal = np.array(cracks[other].PointAt(cracks[other].ArcLength(tuple(tip))))
    ahead = (goal - point) @ direction > 0.5 * np.linalg.norm(goal - point)
    return (goal, f"has joined crack {other}: it came near") if ahead else None


def turned(frame: TipFrame, angle: float) -> np.ndarray:
    """The direction at an angle in degrees from ahead of a tip."""
    ahead, turn = np.array(frame.tip.ahead), angle * pi / 180
    return cos(turn) * ahead + sin(turn) * np.array([-ahead[1], ahead[0]])


def with_crack(cracks: list[Crack], number: int, crack: Crack) -> list[Crack]:
    """The list with one crack replaced."""
    return [crack if i == number else other for i, other in enumerate(cracks)]


def extended(crack: Crack, end: str, tip: tuple[float, float]) -> Crack:
    """The crack with a straight new part from its start or end up to a tip; a last straight piece in the same direction is prolonged."""
    old, pieces = crack.points[0 if end == "start" else -1], crack.pieces
    kind, points = pieces[0 if end == "start" else -1]
    if kind == "segment":
        before = points[1 if end == "start" else 0]
        (a, b), (c, d) = np.subtract(old, before), np.subtract(tip, old)
        if a * c + b * d > 0 and abs(a * d - b * c) <= 1e-12 * np.hypot(a, b) * np.hypot(c, d):
            old, pieces = before, pieces[1:] if end == "start" else pieces[:-1]
    new = [("segment", [tip, old] if end == "start" else [old, tip])]
    return Crack.OfPieces(new + pieces if end == "start" else pieces + new)


def tip_number(body: CrackedMesh, crack: int, end: str) -> int:
    """The place of a crack's end in body.tips. Raises ValueError if it is none."""
    for number, tip in enumerate(body.tips):
        if (tip.crack, ENDS[int(tip.s > 0)]) == (crack, end):
            return number
    raise ValueError(f"the {end} of crack {crack} would lie on the boundary")


def check_room(body: CrackedMesh, material: Isotropic, crack: int, end: str) -> None:
    """Raises ValueError unless this end of the crack is a tip with more than ROOM elements around it."""
    number = tip_number(body, crack, end)
    frame = TipFrame(body, number)
    room, limit = frame.Clearance(material)
    if room <= ROOM * frame.h:
        raise ValueError(f"the new tip {body.tips[number].point} would be {room:.4g} from {limit}, less than {ROOM} elements (h = {frame.h:.4g})")
