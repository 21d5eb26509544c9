"""What the error of is sought: quantities J(u, λ), with their derivatives by the displacement and by the multipliers. protocols.Goal is what is asked of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import CF, CacheCF, IfPos, InnerProduct, Integrate, LinearForm

from ..arguments import check_item, check_regions, crack_number
from ..fracture.stress_intensity import disks, follows_pressure, material_at, pressures, solution_field, stays_closed
from ..fracture.tip_fields import SIDE, TipFrame
from ..fracture.tip_integral import TipField, TipIntegral, auxiliary_field, mode_fields, symmetric
from ..loads.terms import unit_matrices
from ..operators import NORMAL, Gradient

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any

    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackFESpace
    from ..contact.solution import ContactSolution

FACTORS = ("K_I", "K_II")
BONUS = 6  # orders of integration beside those of the functions


def moments(solution: ContactSolution, density: CoefficientFunction, crack: int | None = None, **options: Any) -> np.ndarray:
    """∫ density ψ_i over a crack, or all, for the functions of W; options: of the measure."""
    W = solution.problem.W
    return LinearForm(density * W.TestFunction() * W.dcrack(crack=crack, bonus_intorder=BONUS, **options)).Assemble().vec.FV().NumPy().copy()


@dataclass(frozen=True)
class StressIntensityFactor:
    """K_I or K_II at a tip, by the interaction integral.

    Parameters
    ----------
    name : str
        "K_I" or "K_II".
    tip : int
        A number in `body.tips`.
    radius : float
        Of the domain of the interaction integral, a length; default as large as there is room, whatever the mesh.
    """

    name: str
    tip: int = 0
    radius: float | None = None

    def __post_init__(self) -> None:
        if self.name not in FACTORS:
            raise ValueError(f"StressIntensityFactor: name={self.name!r} is not one of {list(FACTORS)}")

    def __str__(self) -> str:
        return f"{self.name} at tip {self.tip}"

    def Value(self, solution: ContactSolution) -> float:
        """K in stress × √length."""
        check_item(self.tip, solution.body.tips, "tip", "body.tips")
        solution.CheckLoad()
        integral, mode, scale = self._integral(solution)
        return 0.0 if self._is_zero(solution) else scale * integral(solution_field(solution, integral.frame), mode)

    def _radius(self, solution: ContactSolution) -> float:
        obstacles = solution.load.Obstacles(solution.body.tips[self.tip].point) + solution.a.Obstacles(solution.body.tips[self.tip].point)
        return self.radius or 0.9 * TipFrame(solution.body, self.tip).Clearance(solution.problem.material, obstacles)[0]

    def _integral(self, solution: ContactSolution) -> tuple[TipIntegral, TipField, float]:
        frame, material = TipFrame(solution.body, self.tip), material_at(solution, self.tip)
        mode = list(mode_fields(frame, material))[FACTORS.index(self.name)]
        mode = auxiliary_field(
            frame, material, {side: gradient.Compile() for side, gradient in mode.gradient.items()}
        )  # evaluated for each function of a space
        integral = TipIntegral(solution.problem, frame, disks(frame, solution, self._radius(solution))[0])
        integral.q, integral.grad_q = integral.q.Compile(), integral.grad_q.Compile()
        return integral, mode, 0.5 * material.E_prime

    def _is_zero(self, solution: ContactSolution) -> bool:
        """K_I where the faces touch at the tip."""
        return self.name == "K_I" and stays_closed(solution, self.tip)

    def OfDisplacement(self, solution: ContactSolution, space: CrackFESpace) -> np.ndarray:
        """∂K/∂u for the functions of a space."""
        if self._is_zero(solution):
            return np.zeros(space.ndof)
        integral, mode, scale = self._integral(solution)
        v, body = space.TestFunction(), solution.body
        matrix = lambda densities: CacheCF(CF(tuple(densities), dims=(2, 2)).Compile())  # once at a point, not for each component of ∇v
        inside = matrix(integral.VolumeDensity(self._unit(solution, integral, unit, SIDE), mode) for unit in unit_matrices(2))
        disk = body.dx(definedonelements=integral.elements, space=space)  # of twice the order of the space
        form = LinearForm(InnerProduct(inside, Gradient(v)) * disk)
        for side in SIDE:
            lip = matrix(integral.q * integral.LipDensity(self._unit(solution, integral, unit, [side]), mode) for unit in unit_matrices(2))
            form += InnerProduct(lip, Gradient(v, side)) * self._lips(solution, space)
        return scale * form.Assemble().vec.FV().NumPy()

    def _unit(self, solution: ContactSolution, integral: TipIntegral, gradient: CoefficientFunction, sides: Iterable[str]) -> TipField:
        """The field of a constant gradient, on the lips on some sides only, with what it changes of the traction of closed lips: half of its mean, and friction with it."""
        gradients: dict[str | None, CoefficientFunction] = {None: gradient, **{side: gradient if side in sides else 0 * gradient for side in SIDE}}
        stresses = {side: solution.problem.material.Stress(symmetric(g)) for side, g in gradients.items()}
        mean = sum(0.5 * NORMAL.traction(stresses[side], solution.body) for side in SIDE)
        share = 0.5 * self._touching(solution) * (integral.frame.crack.CurvatureAt(integral.frame.tip.s) == 0)
        direction = solution.body.normal
        if follows_pressure(solution):
            direction = direction + ratio(solution) * solution.body.tangent
        return TipField(gradients, stresses, dict.fromkeys(SIDE, share * mean * direction))

    def _lips(self, solution: ContactSolution, space: CrackFESpace) -> object:
        return solution.problem.W.dcrack(crack=solution.body.tips[self.tip].crack, bonus_intorder=BONUS, space=space)

    @staticmethod
    def _touching(solution: ContactSolution) -> CoefficientFunction:
        return IfPos(-solution.multiplier - 1e-10 * np.abs(solution.multiplier.vec.FV().NumPy()).max(), 1, 0)

    def OfMultipliers(self, solution: ContactSolution) -> list[np.ndarray]:
        """∂K/∂λ for the functions of W, and with friction ∂K/∂λ_t."""
        components = solution.problem.law.components
        if self._is_zero(solution):
            return [np.zeros(solution.problem.W.ndof) for _ in components]
        integral, mode, scale = self._integral(solution)
        body, crack = solution.body, solution.body.tips[self.tip].crack
        straight = integral.frame.crack.CurvatureAt(integral.frame.tip.s) == 0
        share = 1 - 0.5 * straight * self._touching(solution)
        jump = (mode.gradient["plus"] - mode.gradient["minus"]) * integral.frame.ahead
        along = lambda direction: scale * integral.q * sum(d * j for d, j in zip(direction, jump))
        normal, tangent = along(body.normal), along(body.tangent)
        if not follows_pressure(solution):
            return [moments(solution, density, crack) for density in (share * normal, tangent)[: len(components)]]
        multiplier, mean = pressures(solution)
        part = IfPos(-multiplier, (0.5 * (multiplier + mean) if straight else multiplier) / multiplier, 1)
        return [moments(solution, density, crack) for density in (share * normal + ratio(solution) * (share - part) * tangent, part * tangent)]


def ratio(solution: ContactSolution) -> CoefficientFunction:
    """λ_t/λ where the faces touch, else 0."""
    return IfPos(-solution.multiplier, solution.tangential_multiplier / solution.multiplier, 0)


@dataclass(frozen=True)
class ContactForce:
    """∫λ over a crack.

    Parameters
    ----------
    crack : int or str
        Number or name.
    """

    crack: int | str = 0

    def __str__(self) -> str:
        return f"contact force on crack {self.crack}"

    def Value(self, solution: ContactSolution) -> float:
        """Stress × length, ≤ 0."""
        return solution.ContactForce(self.crack)

    def OfDisplacement(self, solution: ContactSolution, space: CrackFESpace) -> np.ndarray:
        """0."""
        return np.zeros(space.ndof)

    def OfMultipliers(self, solution: ContactSolution) -> list[np.ndarray]:
        """∫ψ_i over the crack, and 0."""
        normal = moments(solution, 1, crack_number(self.crack, solution.body))
        return [normal, 0 * normal][: len(solution.problem.law.components)]


@dataclass(frozen=True)
class Displacement:
    """A component of u, in the mean over a part of the boundary.

    Parameters
    ----------
    region : str
        Names of boundaries, a regular expression.
    component : str
        "x" or "y".
    """

    region: str
    component: str = "y"

    def __post_init__(self) -> None:
        if self.component not in ("x", "y"):
            raise ValueError(f"Displacement: component={self.component!r} is neither 'x' nor 'y'")

    def __str__(self) -> str:
        return f"u_{self.component} on {self.region}"

    def _mean(self, solution: ContactSolution) -> tuple[CoefficientFunction, int]:
        check_regions(solution.body.mesh, self.region, "Displacement: region")
        return solution.body.ds(self.region), "xy".index(self.component)

    def Value(self, solution: ContactSolution) -> float:
        """A length."""
        measure, k = self._mean(solution)
        return Integrate(solution.u[k] * measure(bonus_intorder=solution.problem.V.order), solution.body.mesh) / Integrate(1 * measure, solution.body.mesh)

    def OfDisplacement(self, solution: ContactSolution, space: CrackFESpace) -> np.ndarray:
        """The mean of each function of a space."""
        measure, k = self._mean(solution)
        length = Integrate(1 * measure, solution.body.mesh)
        return LinearForm(1 / length * space.TestFunction()[k] * measure).Assemble().vec.FV().NumPy().copy()

    def OfMultipliers(self, solution: ContactSolution) -> list[np.ndarray]:
        """0."""
        return [np.zeros(solution.problem.W.ndof) for _ in solution.problem.law.components]
