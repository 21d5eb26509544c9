"""Stress intensity factors and energy release rates: section 9 of docs/method.md.

All are values of one symmetric form of two equilibrated fields a, b at a tip with the direction e ahead, σ = σ(u) + σ⁰ with a given stress σ⁰,

    I(a,b) = -∫ ∇q·M - ∫ q (f_a·∂_e b + f_b·∂_e a + ∂_e σ⁰_a:∇b + ∂_e σ⁰_b:∇a) + ∫_{lips} q M·ν,
    M = (σ(a):∇b + σ⁰_a:∇b + σ⁰_b:∇a) e - σ_a ∂_e b - σ_b ∂_e a,

q = 1 at the tip, 0 outside of a disk, ν outward. On the lips σν is what acts there: contact and friction, λ n + λ_t t, and the
tractions that are given or that a joint exerts. λ_h is least accurate at a tip, where it counts most: at straight tips the mean
of λ_h and R_h(u_h) + r_0 is taken, and half of their difference is part of the reported error everywhere.
I(u, mode of unit K) = (κ+1)/(4μ) K, and I(u,u) = 2G.
"""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import CF, L2, BitArray, CoefficientFunction, GridFunction, IfPos, InnerProduct, Integrate, grad

from . import _ngsxfem_contact as core
from .arguments import check_item, check_number, check_whole
from .factor_error import reported_error
from .load import AppliedLoad
from .operators import NORMAL, Gradient, NormalGap, NormalStress, Slip
from .spaces import crack_points
from .split_mesh import mesh_arrays
from .tip_fields import SIDE, TipFrame

RADII = (1, 0.75, 0.5)  # of the disks that are compared, relative to the largest


@dataclass(eq=False)
class StressIntensityFactors:
    """K_I and K_II in stress × √length; K_I > 0 opens, K_II has the sign of the slip.  K_I, K_II = factors.

    error: what K_I or K_II may be off, see `factor_error`; nan for other methods than the interaction integral.    by_radius: (n, 2), the values at `radii`.
    modes: coefficients of the modes in the space (error O(h^{1/2}) for P1, O(h) for P2), or None.
    """

    K_I: float
    K_II: float
    error: float = float("nan")
    radii: tuple = ()
    by_radius: np.ndarray | None = field(default=None, repr=False)
    modes: tuple | None = None

    def __iter__(self):
        return iter((self.K_I, self.K_II))


@dataclass(eq=False)
class EnergyReleaseRate:
    """G in energy for each unit of new crack, at a growth straight ahead.  float(rate) is G.

    G: of the J-integral, ½ I(u,u).    irwin: (κ+1)/(8μ) (K_I² + K_II²).
    error: the largest change of G over by_radius, (n,), the values at `radii`, or the difference from irwin.
    """

    G: float
    irwin: float
    error: float
    radii: tuple
    by_radius: np.ndarray = field(repr=False)

    def __float__(self):
        return self.G


@dataclass
class GivenStress:
    """A stress σ⁰ and its derivative ahead, 2 × 2 CoefficientFunctions."""

    stress: CoefficientFunction
    ahead: CoefficientFunction


@dataclass
class TipField:
    """Gradients and stresses (key None: inside, "plus", "minus": on the lips), tractions on the lips, an AppliedLoad or None, and a GivenStress or None.

    stress: C:ε(u), without the given part.    traction: of the whole stress, σn.
    """

    gradient: dict
    stress: dict
    traction: dict
    load: AppliedLoad | None = None
    given: GivenStress | None = None

    def Whole(self, side):
        """The stress on a side, the given part included."""
        return self.stress[side] if self.given is None else self.stress[side] + self.given.stress

    def GivenWork(self, other):
        """σ⁰:∇b as a function of the side, b another field."""
        return lambda side: CF(0.0) if self.given is None else InnerProduct(self.given.stress, other.gradient[side])


@dataclass(eq=False)
class TStress:
    """The T-stress, the part of the stress along the crack that is constant at a tip.  float(t) is T.

    error: the largest change of T over by_radius, (n,), the values at `radii`.
    """

    T: float
    error: float
    radii: tuple
    by_radius: np.ndarray = field(repr=False)

    def __float__(self):
        return self.T


def material_at(solution, tip):
    """The Elasticity of the region that holds a tip."""
    return solution.problem.material.At(solution.body.mesh, solution.body.tips[tip].point)


def mode_fields(frame, material):
    """The auxiliary fields of unit K_I and K_II: no load, and no traction on lips that are straight."""
    gradients = {side: frame.ModeGradients(material, side) for side in (None, *SIDE)}
    for mode in range(2):
        yield auxiliary_field(frame, material, {side: gradients[side][mode] for side in gradients})


def auxiliary_field(frame, material, gradient):
    """A TipField without load."""
    stress = {side: material.Stress(_symmetric(gradient[side])) for side in gradient}
    return TipField(gradient, stress, {side: stress[side] * frame.body.normal for side in SIDE})


def solution_field(solution, frame):
    """u with its load, its given stress, and what acts on the lips: the contact pressure from λ_h and R_h(u_h), λ_t, given tractions, joints."""
    body, applied = solution.body, solution.applied
    gradient = {side: Gradient(solution.u, side) for side in (None, *SIDE)}
    stress = {side: solution.ElasticStress(side) for side in gradient}
    multiplier, mean = pressures(solution)
    # the lips of a bent tip function are not free of traction: σ_n(u_h) is the worse one there
    straight = frame.crack.CurvatureAt(frame.tip.s) == 0
    contact = (0.5 * (multiplier + mean) if straight else multiplier) * body.normal
    if solution.tangential_multiplier is not None:
        contact = contact + solution.tangential_multiplier * body.tangent
    own = solution.FaceTractions()
    return TipField(gradient, stress, {"plus": contact - own.plus, "minus": contact + own.minus}, applied, given_stress(solution, frame))


def given_stress(solution, frame):
    """The GivenStress of a solution, or None; its derivative is that of its projection onto polynomials on each element of the disk."""
    given = solution.applied.stress
    if given is None:
        return None
    space = L2(solution.body.mesh, order=solution.problem.V.order + 2)
    parts = []
    for component in given.Reshape((4,)):
        projected = GridFunction(space)
        projected.Set(component)
        parts.append(InnerProduct(grad(projected), frame.ahead))
    return GivenStress(given, CF(tuple(parts), dims=(2, 2)))


def pressures(solution):
    """λ_h, and instead of it, where the faces touch, the mean of R_h(u_h) + r_0 from both sides: both ≤ 0 in exact contact."""
    mean = sum(0.5 * solution.Traction(NORMAL, side) for side in SIDE)
    threshold = 1e-10 * np.abs(solution.multiplier.vec.FV().NumPy()).max()
    return solution.multiplier, IfPos(-solution.multiplier - threshold, mean, solution.multiplier)


def _symmetric(gradient):
    return 0.5 * (gradient + gradient.trans)


class TipIntegral:
    """I(a,b) at one tip, q = 0 for r ≥ radius."""

    def __init__(self, problem, frame, radius, bonus_intorder=4):
        self.frame, self.body, self.mesh = frame, problem.body, problem.body.mesh
        self.q, self.grad_q = frame.Weight(radius), frame.WeightGradient(radius)
        self.elements = elements_within(self.mesh, frame.tip.point, radius)
        self.disk = self.body.dx(definedonelements=self.elements, bonus_intorder=bonus_intorder, space=problem.V)
        self.points, self.weights = crack_rule(problem.W, frame.tip, radius)

    def __call__(self, a, b):
        return self._volume(a, b) + self._loads(a, b) + self._lips(a, b)

    def _volume(self, a, b):
        e = self.frame.ahead
        energy = InnerProduct(a.stress[None], b.gradient[None]) + a.GivenWork(b)(None) + b.GivenWork(a)(None)
        M = energy * e - a.Whole(None) * (b.gradient[None] * e) - b.Whole(None) * (a.gradient[None] * e)
        return -Integrate(InnerProduct(M, self.grad_q).Compile() * self.disk, self.mesh)

    def _loads(self, a, b):
        return -sum(self._load(one, other) for one, other in ((a, b), (b, a)))

    def _load(self, one, other):
        """∫ q (f·∂_e + ∂_e σ⁰:∇) of the other field, f and σ⁰ of the one."""
        moved = lambda: (self.q * (other.gradient[None] * self.frame.ahead)).Compile()
        work = one.load.BodyForce(moved(), self.elements) if one.load is not None else 0.0
        if one.given is not None:
            work += Integrate((self.q * InnerProduct(one.given.ahead, other.gradient[None])).Compile() * self.disk, self.mesh)
        return work

    def _lips(self, a, b):
        """ν = -n on the plus lip, n on the minus lip."""
        e, n, flow = self.frame.ahead, self.body.normal, 0
        for side, sign in SIDE.items():
            energy = InnerProduct(a.stress[side], b.gradient[side]) + a.GivenWork(b)(side) + b.GivenWork(a)(side)
            along_n = energy * InnerProduct(e, n)
            along_n -= InnerProduct(a.traction[side], b.gradient[side] * e) + InnerProduct(b.traction[side], a.gradient[side] * e)
            flow -= sign * along_n
        return self._along(flow)

    def OfPressure(self, pressure, b):
        """What a pressure p n on the lips of a can do to I(a,b): ∫ q |p n·∂_e jump(b)|."""
        density = pressure * InnerProduct((b.gradient["plus"] - b.gradient["minus"]) * self.frame.ahead, self.body.normal)
        return self._along(IfPos(density, density, -density))

    def _along(self, f):
        """∫ q f over the crack."""
        return float(self.weights @ (self.q * f).Compile()(self.points).ravel())


def crack_rule(W, tip, radius, n=10):
    """Mesh points and weights on the crack of a tip inside a disk, for integrands like 1/√s at the tip; divided at W's nodes."""
    body, crack = W.body, W.body.cracks[tip.crack]
    nodes = {abs(tip.s - s) for s in (*W.basis.nodes[tip.crack], *body.MeshNodes(tip.crack, True))}
    reach = _reach(crack, tip, radius)
    cuts = np.sqrt([*sorted(s for s in nodes if s < reach), reach])
    x, w = np.polynomial.legendre.leggauss(n)
    half = 0.5 * np.diff(cuts)[:, None]
    root = cuts[:-1, None] + half * (1 + x)  # ds = 2 √s d√s
    s = np.abs(tip.s - (root**2).ravel())
    return crack_points(body, tip.crack, np.clip(s, 0, crack.length)), (2 * root * half * w).ravel()


def _reach(crack, tip, radius, n=2000):
    """The arc length from the tip after which the crack stays outside of the disk."""
    s = np.linspace(0, crack.length, n)
    distance = np.hypot(*(np.array([crack.PointAt(abs(tip.s - si)) for si in s]) - tip.point).T)
    return s[min(np.flatnonzero(distance < radius)[-1] + 1, n - 1)]


def elements_within(mesh, point, radius):
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


def disks(frame, solution, radius):
    """The radii of the domains of integration: that given, or eight elements if there is room, and parts of it.

    Raises ValueError if a disk leaves the body or the material of the tip, meets another crack, a point load or a loaded inner interface, or
    has less than two elements in its radius.
    """
    room, limit = frame.Clearance(solution.problem.material, solution.applied)
    if radius is None:
        radius = min(0.9 * room, 8 * frame.h)
    check_number(radius, f"the domain at the tip {frame.tip.point}: radius", lambda radius: radius > 0, "be positive")
    if not radius < room:
        raise ValueError(f"the domain of radius {radius:.4g} at the tip {frame.tip.point} meets {limit} at the distance {room:.4g}; choose a smaller radius")
    if radius < 2 * frame.h:
        raise ValueError(
            f"the domain of radius {radius:.4g} at the tip {frame.tip.point} has less than two elements (h = {frame.h:.4g}) in its radius; "
            f"{limit} is at the distance {room:.4g}: refine the mesh there"
        )
    return tuple(part * radius for part in RADII)


@dataclass(frozen=True)
class InteractionIntegral:
    """K_I, K_II from I(u, mode): the domain integral with body force and tractions of the lips.

    radius: of the largest domain; default eight elements at the tip, less where there is no room.
    """

    radius: float | None = None

    def Evaluate(self, solution, tip):
        """StressIntensityFactors of the largest domain, with their change over three and with the pressure."""
        frame, material = TipFrame(solution.body, tip), material_at(solution, tip)
        u, modes, radii = solution_field(solution, frame), list(mode_fields(frame, material)), disks(frame, solution, self.radius)
        integrals = [TipIntegral(solution.problem, frame, radius) for radius in radii]
        scale = 4 * material.mu / (material.kappa + 1)
        K = scale * np.array([[I(u, mode) for mode in modes] for I in integrals])
        first, second = pressures(solution)
        doubt = [0.5 * scale * integrals[0].OfPressure(first - second, mode) for mode in modes]
        own = mode_coefficients(solution, tip)
        error = reported_error(K, doubt, own, frame.h, solution.problem.V.tip_specs[tip])
        return StressIntensityFactors(float(K[0, 0]), float(K[0, 1]), error, radii, K, own)


@dataclass(frozen=True)
class ModeCoefficients:
    """K_I, K_II as coefficients of the modes in the space: needs TipEnrichment(material=...).

    The error is O(h^{1/2}) for P1 and O(h) for P2, h the element at the tip; do not grade the mesh to the tip, where the
    polynomials would take over √r.
    """

    def Evaluate(self, solution, tip):
        """Raises ValueError if the space has no modes at the tip."""
        modes = mode_coefficients(solution, tip)
        if modes is None:
            raise ValueError(f"StressIntensity: the space has no modes at tip {tip}; build it with tip=TipEnrichment(material=material, functions='modes')")
        K_I, K_II = modes
        return StressIntensityFactors(K_I, K_II, modes=modes)


@dataclass(frozen=True)
class JumpExtrapolation:
    """K_I, K_II from jump/√r = A + B r, least squares from half an element to eight elements behind the tip."""

    points: int = 40

    def __post_init__(self):
        check_whole(self.points, "JumpExtrapolation: points", 2)

    def Evaluate(self, solution, tip):
        """Raises ValueError if the space has no singular functions there: the jump would be wrong by tens of percent."""
        if solution.problem.V.tip_specs[tip] is None:
            raise ValueError(f"StressIntensity: the space has no functions at tip {tip}, so the jump there is wrong; use method='interaction'")
        frame, body, material = TipFrame(solution.body, tip), solution.body, material_at(solution, tip)
        r = np.linspace(0.5 * frame.h, min(8 * frame.h, 0.5 * frame.crack.length), self.points)
        points = crack_points(body, frame.tip.crack, np.abs(frame.tip.s - r))
        jumps = np.column_stack([f(points).ravel() for f in (NormalGap(solution.u, body), Slip(solution.u, body))])
        A = np.linalg.lstsq(np.column_stack([np.ones_like(r), r]), jumps / np.sqrt(r)[:, None], rcond=None)[0][0]
        K = A * np.sqrt(2 * np.pi) * material.mu / (material.kappa + 1)
        return StressIntensityFactors(float(K[0]), float(K[1]), modes=mode_coefficients(solution, tip))


METHODS = {"interaction": InteractionIntegral, "modes": ModeCoefficients, "jump": JumpExtrapolation}


def mode_coefficients(solution, tip):
    """The coefficients of the modes at a tip, or None if the space has none there."""
    V = solution.problem.V
    spec = V.tip_specs[tip]
    if spec is None or spec.basis != core.TipBasis.modes:
        return None
    return tuple(float(solution.u.vec[dof]) for dof in V.TipDofs(tip))


def stress_intensity(solution, tip, method, radius):
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


def t_stress(solution, tip, radius):
    """What ContactSolution.TStress documents.

    For a constant stress σ = C:ε + σ⁰ at the tip, I with the field of a unit force is ε_ee - σ_nn (κ-1)/(4μ): the second part, since that field
    turns the lips against each other. So E' I = σ_ee - σ_nn - (σ⁰_ee - ν' σ⁰_nn), E' and ν' those of plane strain or stress.
    """
    check_item(tip, solution.body.tips, "tip", "body.tips")
    frame, material = TipFrame(solution.body, tip), material_at(solution, tip)
    u, radii = solution_field(solution, frame), disks(frame, solution, radius)
    force = auxiliary_field(frame, material, dict.fromkeys((None, *SIDE), frame.PointForceGradient(material)))
    strain = np.array([TipIntegral(solution.problem, frame, r)(u, force) for r in radii])
    T = 8 * material.mu / (material.kappa + 1) * strain + constant_at_tip(solution, frame, material)
    return TStress(float(T[0]), float(np.ptp(T)), radii, T)


def constant_at_tip(solution, frame, material):
    """σ_nn + σ⁰_ee - ν' σ⁰_nn in the mean over the last element before a tip: what the lips carry, and the given stress."""
    s = np.clip(np.abs(frame.tip.s - frame.h * np.linspace(0.05, 1, 20)), 0, frame.crack.length)
    points = crack_points(solution.body, frame.tip.crack, s)
    given, normal, tractions = solution.applied.stress, solution.body.normal, solution.FaceTractions()
    constant = solution.multiplier - 0.5 * InnerProduct(tractions.plus - tractions.minus, normal)
    if given is not None:
        ratio = (3 - material.kappa) / (1 + material.kappa)
        constant = constant + InnerProduct(given * frame.ahead, frame.ahead) - ratio * NormalStress(given, solution.body)
    return float(np.mean(constant(points)))


def energy_release_rate(solution, tip, radius):
    """What ContactSolution.EnergyReleaseRate documents."""
    check_item(tip, solution.body.tips, "tip", "body.tips")
    material, frame = material_at(solution, tip), TipFrame(solution.body, tip)
    K_I, K_II = InteractionIntegral(radius).Evaluate(solution, tip)
    irwin = (material.kappa + 1) / (8 * material.mu) * (K_I**2 + K_II**2)
    u, radii = solution_field(solution, frame), disks(frame, solution, radius)
    G = np.array([0.5 * TipIntegral(solution.problem, frame, r)(u, u) for r in radii])
    return EnergyReleaseRate(float(G[0]), irwin, float(max(np.ptp(G), abs(G[0] - irwin))), radii, G)
