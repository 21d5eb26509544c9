"""Where contact ends, as a smooth quantity of the pressure: at a transition λ = -√t (c_0 + c_1 t), t the distance from it into the contact zone."""

from __future__ import annotations

from dataclasses import dataclass
from math import gamma
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import GridFunction, IfPos, Integrate

from ..arguments import crack_number
from ..errors import TooCoarse
from ..points import place
from ..spaces.trace_space import TraceSpace
from .goals import BONUS, moments

if TYPE_CHECKING:
    from typing import Any

    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackFESpace
    from ..contact.solution import ContactSolution

INTERVALS = 6  # of the multiplier, from which the pressure is taken
BEYOND = 3  # intervals of the gap in which λ may still oscillate


def beta(a: float, b: float) -> float:
    """∫ x^{a-1} (1 - x)^{b-1} from 0 to 1."""
    return gamma(a) * gamma(b) / gamma(a + b)


# ∫ (σ/t)^k √(t - σ) dσ and ∫ (σ/t)^k (t - σ)^{3/2} dσ from 0 to t, over t^{3/2} and t^{5/2}: the vector that is orthogonal to both
ORTHOGONAL = np.cross(*(np.array([gamma(k + 1) * gamma(power) / gamma(k + 1 + power) for k in range(3)]) for power in (1.5, 2.5)))


@dataclass
class Window:
    """The end of a contact zone: s = start + direction σ, 0 ≤ σ ≤ end; w are the weights (σ/length)^k of the moments M_k."""

    start: float
    direction: int
    length: float
    weights: list[CoefficientFunction]
    crack: int
    point: tuple[float, float]

    def Edge(self, M: np.ndarray) -> tuple[float, np.ndarray]:
        """(s, ∂s/∂M): n_0 M_0 τ² + n_1 M_1 τ + n_2 M_2 = 0 with τ = t/length, the root next to 1."""
        a, b, c = ORTHOGONAL * M
        roots = np.roots([a, b, c])
        real = roots[np.abs(roots.imag) < 1e-9 * np.abs(roots)].real
        if not len(real):
            raise TooCoarse(
                f"ContactEdge: the pressure does not fall like a square root towards the end of contact at {place(self.point)}; refine there",
                self.point,
                self.length,
            )
        tau = float(real[np.argmin(np.abs(real - 1))])
        slope = -ORTHOGONAL * np.array([tau**2, tau, 1]) / (2 * a * tau + b)
        return self.start + self.direction * self.length * tau, self.direction * self.length * slope


@dataclass(frozen=True)
class ContactEdge:
    """The arc length at which contact ends or begins: from three moments of the pressure over the last six intervals of contact.

    Parameters
    ----------
    crack : int or str
        Number or name.
    number : int
        Of the transition, in the order of `solution.Transitions(crack)`.
    """

    crack: int | str = 0
    number: int = 0

    def __str__(self) -> str:
        return f"contact edge {self.number} of crack {self.crack}"

    def _window(self, solution: ContactSolution) -> Window:
        body, crack = solution.body, crack_number(self.crack, solution.body)
        transitions = np.sort(solution.Transitions(crack))
        if not 0 <= self.number < len(transitions):
            raise ValueError(f"ContactEdge: number={self.number}, but contact on crack {self.crack} begins or ends at {len(transitions)} places")
        linear = TraceSpace(body, order=1)
        arclength, nodes = GridFunction(linear), linear.nodes
        arclength.vec.FV().NumPy()[:] = nodes.arclengths
        s, edge = np.unique(nodes.arclengths[nodes.cracks == crack]), transitions[self.number]
        state: Any = solution.state.nodes  # the plane's, which have arc lengths
        places, contact = state.arclengths[state.cracks == crack], solution.report.active[-1][state.cracks == crack]
        direction = 1 if contact[np.argmin(np.where(places < edge, edge - places, np.inf))] else -1
        behind, ahead = ([*(edge - s)[::-1]], [*(s - edge)]) if direction > 0 else ([*(s - edge)], [*(edge - s)[::-1]])
        others = [abs(other - edge) for other in np.delete(transitions, self.number) if (edge - other) * direction > 0]
        room = min([max(behind), *others])
        lengths = sorted(d for d in behind if 0 < d <= room * (1 + 1e-9))
        length = lengths[min(INTERVALS, len(lengths)) - 1]
        further = sorted(d for d in ahead if d > 0)[:BEYOND]
        sigma = direction * (arclength - (edge - direction * length))
        inside = IfPos(sigma, IfPos(length + (further[-1] if further else 0) * (1 + 1e-9) - sigma, 1, 0), 0)
        return Window(
            edge - direction * length,
            direction,
            length,
            [inside * (sigma / length) ** k if k else inside for k in range(3)],
            crack,
            body.cracks[crack].PointAt(edge),
        )

    def _moments(self, solution: ContactSolution, window: Window) -> np.ndarray:
        measure = solution.problem.W.dcrack(crack=window.crack, bonus_intorder=BONUS)
        return np.array([Integrate(solution.multiplier * weight * measure, solution.body.mesh) for weight in window.weights])

    def Value(self, solution: ContactSolution) -> float:
        """The arc length."""
        window = self._window(solution)
        return window.Edge(self._moments(solution, window))[0]

    def OfDisplacement(self, solution: ContactSolution, space: CrackFESpace) -> np.ndarray:
        """0."""
        return np.zeros(space.ndof)

    def OfMultipliers(self, solution: ContactSolution) -> list[np.ndarray]:
        """By the moments."""
        window = self._window(solution)
        slope = window.Edge(self._moments(solution, window))[1]
        normal = moments(solution, sum(float(factor) * weight for factor, weight in zip(slope, window.weights)), window.crack)
        return [normal, 0 * normal][: len(solution.problem.law.components)]
