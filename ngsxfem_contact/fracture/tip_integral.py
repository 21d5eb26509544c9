"""The symmetric form I(a,b) of two equilibrated fields at a tip, as an integral over a disk and the lips in it: section 9 of docs/method.md.

With the direction e ahead, and σ = σ(u) + σ⁰ with a given stress σ⁰,

    I(a,b) = -∫ ∇q·M - ∫ q (f_a·∂_e b + f_b·∂_e a + ∂_e σ⁰_a:∇b + ∂_e σ⁰_b:∇a) + ∫_{lips} q M·ν,
    M = (σ(a):∇b + σ⁰_a:∇b + σ⁰_b:∇a) e - σ_a ∂_e b - σ_b ∂_e a,

q = 1 at the tip, 0 outside of a disk, ν outward.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF, BitArray, CoefficientFunction, IfPos, InnerProduct, Integrate

from ..points import crack_points, mesh_arrays
from .tip_fields import SIDE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ngsolve import Mesh

    from .._ngsxfem_contact import Crack, Tip, TraceSpace
    from ..contact.problem import ContactProblem
    from ..material import Isotropic
    from .tip_fields import TipFrame


@dataclass
class GivenStress:
    """A stress σ⁰ and its derivative ahead, 2 × 2 CoefficientFunctions."""

    stress: CoefficientFunction
    ahead: CoefficientFunction


@dataclass
class TipField:
    """Gradients and stresses (key None: inside, "plus", "minus": on the lips), tractions on the lips, ∫ f·field as a
    function of a field and elements or None, and a GivenStress or None.

    Parameters
    ----------
    stress
        C:ε(u), without the given part.
    traction
        Of the whole stress, σn.
    """

    gradient: dict[str | None, CoefficientFunction]
    stress: dict[str | None, CoefficientFunction]
    traction: dict[str, CoefficientFunction]
    body_force: Callable[[CoefficientFunction, BitArray], float] | None = None
    given: GivenStress | None = None

    def Whole(self, side: str | None) -> CoefficientFunction:
        """The stress on a side, the given part included."""
        return self.stress[side] if self.given is None else self.stress[side] + self.given.stress

    def GivenWork(self, other: TipField) -> Callable[..., Any]:
        """σ⁰:∇b as a function of the side, b another field."""
        return lambda side: CF(0.0) if self.given is None else InnerProduct(self.given.stress, other.gradient[side])


def mode_fields(frame: TipFrame, material: Isotropic) -> Iterator[TipField]:
    """The auxiliary fields of unit K_I and K_II: no load, and no traction on lips that are straight."""
    gradients = {side: frame.ModeGradients(material, side) for side in (None, *SIDE)}
    for mode in range(2):
        yield auxiliary_field(frame, material, {side: gradients[side][mode] for side in gradients})


def auxiliary_field(frame: TipFrame, material: Isotropic, gradient: dict[str | None, CoefficientFunction]) -> TipField:
    """A TipField without load."""
    stress = {side: material.Stress(symmetric(gradient[side])) for side in gradient}
    return TipField(gradient, stress, {side: stress[side] * frame.body.normal for side in SIDE})


def symmetric(gradient: CoefficientFunction) -> CoefficientFunction:
    """½(∇u + ∇uᵀ)."""
    return 0.5 * (gradient + gradient.trans)


class TipIntegral:
    """I(a,b) at one tip, q = 0 for r ≥ radius."""

    def __init__(self, problem: ContactProblem, frame: TipFrame, radius: float, bonus_intorder: int = 4) -> None:
        self.frame, self.body, self.mesh = frame, problem.body, problem.body.mesh
        self.q, self.grad_q = frame.Weight(radius), frame.WeightGradient(radius)
        self.share = problem.V.share
        self.elements = self.share.OwnOf(elements_within(self.mesh, frame.tip.point, radius))
        self.disk = self.body.dx(definedonelements=self.elements, bonus_intorder=bonus_intorder, space=problem.V)
        self.points, self.weights = crack_rule(problem.W, frame.tip, radius)

    def __call__(self, a: TipField, b: TipField) -> float:
        return self.share.Sum(self._volume(a, b) + self._loads(a, b)) + self._lips(a, b)

    def _volume(self, a: TipField, b: TipField) -> float:
        return Integrate(self.VolumeDensity(a, b).Compile() * self.disk, self.mesh)

    def VolumeDensity(self, a: TipField, b: TipField) -> CoefficientFunction:
        """-∇q·M."""
        e = self.frame.ahead
        energy = InnerProduct(a.stress[None], b.gradient[None]) + a.GivenWork(b)(None) + b.GivenWork(a)(None)
        M = energy * e - a.Whole(None) * (b.gradient[None] * e) - b.Whole(None) * (a.gradient[None] * e)
        return -InnerProduct(M, self.grad_q)

    def _loads(self, a: TipField, b: TipField) -> float:
        return -sum(self._load(one, other) for one, other in ((a, b), (b, a)))

    def _load(self, one: TipField, other: TipField) -> float:
        """∫ q (f·∂_e + ∂_e σ⁰:∇) of the other field, f and σ⁰ of the one."""
        moved = lambda: (self.q * (other.gradient[None] * self.frame.ahead)).Compile()
        work = one.body_force(moved(), self.elements) if one.body_force is not None else 0.0
        if one.given is not None:
            work += Integrate((self.q * InnerProduct(one.given.ahead, other.gradient[None])).Compile() * self.disk, self.mesh)
        return work

    def _lips(self, a: TipField, b: TipField) -> float:
        return self._along(self.LipDensity(a, b))

    def LipDensity(self, a: TipField, b: TipField) -> CoefficientFunction:
        """M·ν of both lips, for each length of the crack: ν = -n on the plus lip, n on the minus lip."""
        e, n, flow = self.frame.ahead, self.body.normal, 0
        for side, sign in SIDE.items():
            energy = InnerProduct(a.stress[side], b.gradient[side]) + a.GivenWork(b)(side) + b.GivenWork(a)(side)
            along_n = energy * InnerProduct(e, n)
            along_n -= InnerProduct(a.traction[side], b.gradient[side] * e) + InnerProduct(b.traction[side], a.gradient[side] * e)
            flow -= sign * along_n
        return flow

    def OfTraction(self, traction: CoefficientFunction, b: TipField) -> float:
        """What a traction on the lips of a can do to I(a,b): ∫ q |traction·∂_e jump(b)|."""
        density = InnerProduct((b.gradient["plus"] - b.gradient["minus"]) * self.frame.ahead, traction)
        return self._along(IfPos(density, density, -density))

    def _along(self, f: CoefficientFunction) -> float:
        """∫ q f over the crack."""
        return float(self.weights @ (self.q * f).Compile()(self.points).ravel())


def crack_rule(W: TraceSpace, tip: Tip, radius: float, n: int = 10) -> tuple[np.ndarray, np.ndarray]:
    """Mesh points and weights on the crack of a tip inside a disk, for integrands like 1/√s at the tip; divided as W's functions are."""
    body, crack = W.body, W.body.cracks[tip.crack]
    division = {abs(tip.s - s) for s in (*W.basis.division[tip.crack], *body.MeshNodes(tip.crack, True))}
    reach = _reach(crack, tip, radius)
    cuts = np.sqrt([*sorted(s for s in division if s < reach), reach])
    x, w = np.polynomial.legendre.leggauss(n)
    half = 0.5 * np.diff(cuts)[:, None]
    root = cuts[:-1, None] + half * (1 + x)  # ds = 2 √s d√s
    s = np.abs(tip.s - (root**2).ravel())
    return crack_points(body, tip.crack, np.clip(s, 0, crack.length)), (2 * root * half * w).ravel()


def _reach(crack: Crack, tip: Tip, radius: float, n: int = 2000) -> float:
    """The arc length from the tip after which the crack stays outside of the disk."""
    s = np.linspace(0, crack.length, n)
    distance = np.hypot(*(np.array([crack.PointAt(abs(tip.s - si)) for si in s]) - tip.point).T)
    return s[min(np.flatnonzero(distance < radius)[-1] + 1, n - 1)]


def elements_within(mesh: Mesh, point: tuple[float, float], radius: float) -> BitArray:
    """BitArray of the triangles that may meet a disk."""
    vertices, triangles = mesh_arrays(mesh)
    corners = vertices[triangles]
    size = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    near = np.linalg.norm(corners - np.asarray(point), axis=2).min(axis=1) < radius + size
    elements = BitArray(len(corners))
    elements.Clear()
    for i in np.flatnonzero(near):
        elements.Set(int(i))
    return elements
