"""Stress intensity factors, energy release rates and T-stresses: section 9 of docs/method.md.

All are values of the form I of `tip_integral`. On the lips σν is what acts there: contact and friction, λ n + λ_t t, and the
tractions that are given or that a joint exerts. λ_h is least accurate at a tip, where it counts most: at straight tips the mean
of λ_h and R_h(u_h) + r_0 is taken, and half of their difference is part of the reported error everywhere.
I(u, mode of unit K) = (κ+1)/(4μ) K, and I(u,u) = 2G.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import IfPos, InnerProduct

from .. import _ngsxfem_contact as core
from ..arguments import check_item, check_number, check_whole
from ..errors import TooCoarse
from ..operators import NORMAL, TANGENTIAL, Gradient, NormalGap, NormalStress, Slip
from ..points import crack_points
from ..spaces.unknowns import Unknowns
from .factor_error import reported_error
from .given_stress import stress_derivatives
from .tip_fields import SIDE, TipFrame
from .tip_integral import GivenStress, TipField, TipIntegral, auxiliary_field, elements_within, mode_fields

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ngsolve import CoefficientFunction, GridFunction

    from ..contact.solution import ContactSolution
    from ..material import Elasticity, Isotropic

RADII = (1, 0.75, 0.5)  # of the disks that are compared, relative to the largest


@dataclass(eq=False)
class StressIntensityFactors:
    """K_I and K_II in stress × √length; K_I > 0 opens, K_II has the sign of the slip.  K_I, K_II = factors, as a sequence.

    Attributes
    ----------
    error
        What K_I or K_II may be off, see `factor_error`; nan for other methods than the interaction integral.
    by_radius
        (n, 2), the values at `radii`.
    modes
        Coefficients of the first two modes in the space (error O(h^{k-1/2}) for order k, see ModeCoefficients), or None.
    """

    K_I: float
    K_II: float
    error: float = float("nan")
    radii: tuple[float, ...] = ()
    by_radius: np.ndarray | None = field(default=None, repr=False)
    modes: tuple[float, ...] | None = None

    def __iter__(self) -> Iterator[float]:
        return iter((self.K_I, self.K_II))

    def __len__(self) -> int:
        return 2

    def __getitem__(self, mode: int) -> float:
        return (self.K_I, self.K_II)[mode]


@dataclass(eq=False)
class EnergyReleaseRate:
    """G in energy for each unit of new crack, at a growth straight ahead.  float(rate) is G.

    Attributes
    ----------
    G
        Of the J-integral, ½ I(u,u).
    irwin
        (κ+1)/(8μ) (K_I² + K_II²).
    error
        The largest change of G over by_radius, (n,), the values at `radii`, or the difference from irwin.
    """

    G: float
    irwin: float
    error: float
    radii: tuple[float, ...]
    by_radius: np.ndarray = field(repr=False)

    def __float__(self) -> float:
        return self.G


@dataclass(eq=False)
class TStress:
    """The T-stress, the part of the stress along the crack that is constant at a tip.  float(t) is T.

    Attributes
    ----------
    error
        The largest change of T over by_radius, (n,), the values at `radii`.
    """

    T: float
    error: float
    radii: tuple[float, ...]
    by_radius: np.ndarray = field(repr=False)

    def __float__(self) -> float:
        return self.T


def material_at(solution: ContactSolution, tip: int) -> Elasticity:
    """The Elasticity of the region that holds a tip."""
    return solution.problem.material.At(solution.body.mesh, solution.body.tips[tip].point)


def solution_field(solution: ContactSolution, frame: TipFrame) -> TipField:
    """u with its load, its given stress, and what acts on the lips: the contact pressure from λ_h and R_h(u_h), λ_t, given tractions, joints."""
    body, load = solution.body, solution.load
    gradient = {side: Gradient(solution.u, side) for side in (None, *SIDE)}
    stress = {side: solution.ElasticStress(side) for side in gradient}
    multiplier, mean = pressures(solution)
    # the lips of a bent tip function are not free of traction: σ_n(u_h) is the worse one there
    straight = frame.crack.CurvatureAt(frame.tip.s) == 0
    pressure = 0.5 * (multiplier + mean) if straight else multiplier
    contact = pressure * body.normal
    if solution.tangential_multiplier is not None:
        factor = IfPos(-multiplier, pressure / multiplier, 1) if follows_pressure(solution) else 1
        contact = contact + factor * solution.tangential_multiplier * body.tangent
    elif solution.a.joint is not None:  # shear that a joint carries: the mean of what it says and of σ(u_h), as for λ
        contact = contact + 0.5 * sum(0.5 * solution.Traction(TANGENTIAL, side) for side in SIDE) * body.tangent
    own = solution.FaceTractions()
    body_force = lambda field, elements: load.BodyForce(field, elements) + solution.a.BodyForce(solution.u, field, elements)
    return TipField(gradient, stress, {"plus": contact - own.plus, "minus": contact + own.minus}, body_force, given_stress(solution, frame))


def given_stress(solution: ContactSolution, frame: TipFrame) -> GivenStress | None:
    """The GivenStress of a solution, or None; its derivative is that of its projection onto polynomials on each element.

    Raises
    ------
    ValueError
        For a stress that jumps near the tip, whose derivative is no function.
    """
    given = solution.load.stress
    if given is None:
        return None
    near = elements_within(solution.body.mesh, frame.tip.point, 3 * frame.h)
    derivatives = stress_derivatives(given, solution.problem.V, near, f"the tip {frame.tip.point}")
    return GivenStress(given, frame.tip.ahead[0] * derivatives[0] + frame.tip.ahead[1] * derivatives[1])


def pressures(solution: ContactSolution) -> tuple[GridFunction, CoefficientFunction]:
    """λ_h, and instead of it, where the faces touch, the mean of R_h(u_h) + r_0 from both sides: both ≤ 0 in exact contact."""
    mean = sum(0.5 * solution.Traction(NORMAL, side) for side in SIDE)
    if solution.a.joint is not None:
        return solution.multiplier, mean  # a joint carries what λ does not
    threshold = 1e-10 * np.abs(solution.multiplier.vec.FV().NumPy()).max()
    return solution.multiplier, IfPos(-solution.multiplier - threshold, mean, solution.multiplier)


def follows_pressure(solution: ContactSolution) -> bool:
    """Whether the friction is at most a multiple of the pressure, so that an error of the one is an error of the other."""
    return solution.tangential_multiplier is not None and getattr(solution.problem.law, "follows_pressure", False)


def doubtful_traction(solution: ContactSolution) -> CoefficientFunction:
    """By how much λ_h differs from the mean of R_h(u_h) + r_0 from both sides where the faces touch, a vector on the cracks; with Coulomb's law friction goes with it."""
    body, (multiplier, mean) = solution.body, pressures(solution)
    direction = body.normal
    if follows_pressure(solution):
        direction = direction + IfPos(-multiplier, solution.tangential_multiplier / multiplier, 0) * body.tangent
    return (multiplier - mean) * direction


def disks(frame: TipFrame, solution: ContactSolution, radius: float | None) -> tuple[float, ...]:
    """The radii of the domains of integration: that given, or eight elements if there is room, and parts of it.

    Raises
    ------
    ValueError
        If a disk leaves the body or the material of the tip, meets another crack, a point load or a loaded inner interface, or has less than two elements
        in its radius.
    """
    room, limit = frame.Clearance(solution.problem.material, solution.load.Obstacles(frame.tip.point) + solution.a.Obstacles(frame.tip.point))
    if radius is None:
        radius = min(0.9 * room, 8 * frame.h)
    check_number(radius, f"the domain at the tip {frame.tip.point}: radius", lambda radius: radius > 0, "be positive")
    if not radius < room:
        raise ValueError(f"the domain of radius {radius:.4g} at the tip {frame.tip.point} meets {limit} at the distance {room:.4g}; choose a smaller radius")
    if radius < 2 * frame.h:
        raise TooCoarse(
            f"the domain of radius {radius:.4g} at the tip {frame.tip.point} has less than two elements (h = {frame.h:.4g}) in its radius; "
            f"{limit} is at the distance {room:.4g}: refine the mesh there",
            frame.tip.point,
            0.5 * radius,
        )
    return tuple(part * radius for part in RADII)


@dataclass(frozen=True)
class InteractionIntegral:
    """K_I, K_II from I(u, mode): the domain integral with body force and tractions of the lips.

    Where the faces press on each other at the tip (and there is no initial gap) K_I is 0; what the integral says of it is in `by_radius`.

    Parameters
    ----------
    radius
        Of the largest domain; default eight elements at the tip, less where there is no room.
    """

    radius: float | None = None

    def Evaluate(self, solution: ContactSolution, tip: int) -> StressIntensityFactors:
        """StressIntensityFactors of the largest domain, with their change over three and with the pressure."""
        frame, material = TipFrame(solution.body, tip), material_at(solution, tip)
        solution.CheckLoad()
        u, modes, radii = solution_field(solution, frame), list(mode_fields(frame, material)), disks(frame, solution, self.radius)
        integrals = [TipIntegral(solution.problem, frame, radius) for radius in radii]
        scale = 0.5 * material.E_prime
        K = scale * np.array([[I(u, mode) for mode in modes] for I in integrals])
        doubt = [0.5 * scale * integrals[0].OfTraction(doubtful_traction(solution), mode) for mode in modes]
        own = mode_coefficients(solution, tip)
        closed = stays_closed(solution, tip)
        sought = slice(1 if closed else 0, 2)
        error = reported_error(K[:, sought], doubt[sought], own and own[sought], frame.h, solution.problem.V.tip_specs[tip])
        return StressIntensityFactors(0.0 if closed else float(K[0, 0]), float(K[0, 1]), error, radii, K, own)


@dataclass(frozen=True)
class ModeCoefficients:
    """K_I, K_II as coefficients of the modes in the space: needs TipEnrichment(material=...).

    The error is O(h^{k-1/2}) for order k at tips of straight cracks whose modes have that order, O(h) for k ≥ 2 with √r alone; h is the element at the tip. Do
    not grade the mesh to the tip, where the polynomials would take over √r.
    """

    def Evaluate(self, solution: ContactSolution, tip: int) -> StressIntensityFactors:
        """Raises ValueError if the space has no modes at the tip."""
        modes = mode_coefficients(solution, tip)
        if modes is None:
            raise ValueError(f"StressIntensity: the space has no modes at tip {tip}; build it with tip=TipEnrichment(material=material, functions='modes')")
        K_I, K_II = modes
        return StressIntensityFactors(K_I, K_II, modes=modes)


@dataclass(frozen=True)
class JumpExtrapolation:
    """K_I, K_II from jump/√r = A + B r, least squares from half an element to eight elements behind the tip.

    Parameters
    ----------
    points : int
        At which the jump is taken.
    """

    points: int = 40

    def __post_init__(self) -> None:
        check_whole(self.points, "JumpExtrapolation: points", 2)

    def Evaluate(self, solution: ContactSolution, tip: int) -> StressIntensityFactors:
        """Raises ValueError if the space has no singular functions there: the jump would be wrong by tens of percent."""
        if solution.problem.V.tip_specs[tip] is None:
            raise ValueError(f"StressIntensity: the space has no functions at tip {tip}, so the jump there is wrong; use method='interaction'")
        frame, body, material = TipFrame(solution.body, tip), solution.body, material_at(solution, tip)
        r = np.linspace(0.5 * frame.h, min(8 * frame.h, 0.5 * frame.crack.length), self.points)
        points = crack_points(body, frame.tip.crack, np.abs(frame.tip.s - r))
        jumps = np.column_stack([f(points).ravel() for f in (NormalGap(solution.u, body), Slip(solution.u, body))])
        A = np.linalg.lstsq(np.column_stack([np.ones_like(r), r]), jumps / np.sqrt(r)[:, None], rcond=None)[0][0]
        K = 0.125 * material.E_prime * np.sqrt(2 * np.pi) * A
        return StressIntensityFactors(float(K[0]), float(K[1]), modes=mode_coefficients(solution, tip))


METHODS = {"interaction": InteractionIntegral, "modes": ModeCoefficients, "jump": JumpExtrapolation}


def mode_coefficients(solution: ContactSolution, tip: int) -> tuple[float, ...] | None:
    """The coefficients of the modes at a tip, or None if the space has none there."""
    V = solution.problem.V
    spec = V.tip_specs[tip]
    if spec is None or spec.basis != core.TipBasis.modes:
        return None
    return tuple(float(solution.u.vec[dof]) for dof in Unknowns(V).Tip(tip)[:2])


def stress_intensity(solution: ContactSolution, tip: int, method: Any, radius: float | None) -> StressIntensityFactors:
    """What ContactSolution.StressIntensity documents."""
    check_item(tip, solution.body.tips, "tip", "body.tips")
    if isinstance(method, str):
        if method not in METHODS:
            raise ValueError(f"StressIntensity: method={method!r} is not one of {list(METHODS)}")
        method = METHODS[method]()
    elif not hasattr(method, "Evaluate") or isinstance(method, type):
        raise TypeError(f"StressIntensity: method={method!r} is neither one of {list(METHODS)} nor an object such as InteractionIntegral()")
    if radius is not None:
        if not isinstance(method, InteractionIntegral):
            raise ValueError(f"StressIntensity: radius={radius} goes with method='interaction' only")
        method = InteractionIntegral(radius)
    return method.Evaluate(solution, tip)


def t_stress(solution: ContactSolution, tip: int, radius: float | None) -> TStress:
    """What ContactSolution.TStress documents.

    For a constant stress σ = C:ε + σ⁰ at the tip, I with the field of a unit force is ε_ee - σ_nn (κ-1)/(4μ): the second part, since that field
    turns the lips against each other. So E' I = σ_ee - σ_nn - (σ⁰_ee - ν' σ⁰_nn), E' and ν' those of plane strain or stress.
    """
    check_item(tip, solution.body.tips, "tip", "body.tips")
    frame, material = TipFrame(solution.body, tip), material_at(solution, tip)
    solution.CheckLoad()
    u, radii = solution_field(solution, frame), disks(frame, solution, radius)
    force = auxiliary_field(frame, material, dict.fromkeys((None, *SIDE), frame.PointForceGradient(material)))
    strain = np.array([TipIntegral(solution.problem, frame, r)(u, force) for r in radii])
    constant, doubt = constant_at_tip(solution, frame, material)
    T = material.E_prime * strain + constant
    return TStress(float(T[0]), float(np.ptp(T)) + doubt, radii, T)


def before_tip(solution: ContactSolution, frame: TipFrame, function: CoefficientFunction) -> np.ndarray:
    """Values of a function over the last element before a tip, an array."""
    s = np.clip(np.abs(frame.tip.s - frame.h * np.linspace(0.05, 1, 20)), 0, frame.crack.length)
    return function(crack_points(solution.body, frame.tip.crack, s)).ravel()


def is_closed(solution: ContactSolution, tip: int) -> bool:
    """Whether the faces press on each other over most of the last element before a tip, by more than round-off of the pressures and of what the jumps stand for."""
    frame, history = TipFrame(solution.body, tip), solution.state.history
    jump = 0.0 if history is None else np.abs(history.jump).max(initial=0)
    size = max(np.abs(solution.Multipliers()).max(initial=0), material_at(solution, tip).E_prime * jump / frame.crack.length)
    return bool(np.median(before_tip(solution, frame, solution.multiplier)) < -1e-10 * size)


def stays_closed(solution: ContactSolution, tip: int) -> bool:
    """Whether K_I is 0: the faces press on each other before a tip, and had no gap there at first."""
    return is_closed(solution, tip) and not before_tip(solution, TipFrame(solution.body, tip), solution.problem.gap).any()


def constant_at_tip(solution: ContactSolution, frame: TipFrame, material: Isotropic) -> tuple[float, float]:
    """(σ_nn + σ⁰_ee - ν' σ⁰_nn at a tip, its doubt): what the lips carry, and the given stress, as a line through the last element says, and half of what bends it."""
    given, normal, tractions = solution.load.stress, solution.body.normal, solution.FaceTractions()
    constant = solution.multiplier - 0.5 * InnerProduct(tractions.plus - tractions.minus, normal)
    if given is not None:
        constant = constant + InnerProduct(given * frame.ahead, frame.ahead) - material.nu_prime * NormalStress(given, solution.body)
    values, along = before_tip(solution, frame, constant), np.linspace(0.05, 1, 20)
    line, parabola = (np.polyval(np.polyfit(along, values, degree), 0.0) for degree in (1, 2))
    return float(line), 0.5 * abs(float(line - parabola))


def energy_release_rate(solution: ContactSolution, tip: int, radius: float | None) -> EnergyReleaseRate:
    """What ContactSolution.EnergyReleaseRate documents."""
    check_item(tip, solution.body.tips, "tip", "body.tips")
    material, frame = material_at(solution, tip), TipFrame(solution.body, tip)
    K_I, K_II = InteractionIntegral(radius).Evaluate(solution, tip)
    irwin = (K_I**2 + K_II**2) / material.E_prime
    u, radii = solution_field(solution, frame), disks(frame, solution, radius)
    G = np.array([0.5 * TipIntegral(solution.problem, frame, r)(u, u) for r in radii])
    return EnergyReleaseRate(float(G[0]), irwin, float(max(np.ptp(G), abs(G[0] - irwin))), radii, G)
