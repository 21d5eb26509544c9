"""The Barbosa-Hughes stabilisation of the multiplier: (12), (13) and (38) of [AHLMR12].

R_h(v) is σ_n of the polynomial of the larger part of each cut element, and γ = γ_0 h_T on each. The tip functions
take part in R_h. The vector modes have σ_n = 0 on the lips; single functions of (8) have σ_n ~ r^{-1/2} there, so
that ∫γ R_h(v)² diverges: with them γ falls linearly to zero within h_T of the tip (docs/method.md, section 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import L2, BilinearForm, CoefficientFunction, GridFunction, IfPos, sqrt, x, y

from .. import _ngsxfem_contact as core
from ..arguments import check_number, check_positive
from ..loads.face_traction import ComparedTraction
from ..operators import NORMAL
from ..points import element_regions
from ..protocols import Stabilisation
from ..spaces.incompressible import WithoutPressure, add_stress_power, is_projected
from ..spaces.unknowns import Unknowns

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace, ElementLocation
    from ..material import Coefficient, Isotropic
    from ..operators import Component


class Defaults:
    """What a stabilisation need not say: see protocols.CompleteStabilisation."""

    System: Any = None

    @property
    def needs_eigenvalue(self) -> bool:
        """False: the factorised matrix is K - K_γ."""
        return False

    @property
    def frees_pressure(self) -> bool:
        """False: the pressure of nearly incompressible parts is that of u."""
        return False

    def Remedy(self, smallest: float) -> str:
        """A smaller γ."""
        return f"make what Gamma returns at least {1 - smallest:.3g} times smaller"


def trait(stabilisation: Stabilisation, name: str) -> Any:
    """A member of CompleteStabilisation; that of Defaults where a stabilisation has none."""
    return getattr(stabilisation, name, getattr(Defaults(), name))


def smaller_gamma0(gamma0: float, smallest: float, otherwise: str) -> str:
    """The Remedy for a number gamma0."""
    return f"take gamma0 = {gamma0:g} below {gamma0 / (1 - smallest):.3g}, or {otherwise}"


@dataclass(frozen=True)
class Unstabilised(Defaults):
    """K_γ = C_γ = D_γ = 0."""

    sides = {}

    def Gamma(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> CoefficientFunction | None:
        """None: there is no γ."""
        return None

    def IsSafe(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> bool:
        """True: K is positive."""
        return True


@dataclass(frozen=True)
class BarbosaHughes(Defaults):
    """γ on the cracks.

    Parameters
    ----------
    gamma0
        γ = gamma0 h_T with h_T the longest edge of each element; gamma has the unit of length over stress. None (default): γ_T = theta h_T / C_T on each
        element, C_T the largest value of ∫_{T∩Γ} h_T R_h(v)² / a_T(v,v), a_T over the larger part: K - K_γ is coercive with 1 - theta.
    theta
        Between 0 and 1.

    Other Parameters
    ----------------
    V : CrackFESpace
        The displacements.
    material : Elasticity
        Of the body.

    Notes
    -----
    With friction the tangential multiplier is stabilised in the same way, R_h(v)² becoming |σ(v)n|².
    """

    gamma0: float | None = None
    theta: float = 0.5

    sides = {"larger": 1}

    def __post_init__(self) -> None:
        if self.gamma0 is not None:
            check_positive(self.gamma0, "BarbosaHughes: gamma0", "; stabilisation=None switches it off")
        check_number(self.theta, "BarbosaHughes: theta", lambda theta: 0 < theta < 1, "lie between 0 and 1")

    def Gamma(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> CoefficientFunction:
        """γ as a CoefficientFunction on the elements that the cracks meet."""
        return element_gamma(V, self.Limits(V, material, components))

    @property
    def frees_pressure(self) -> bool:
        """True: γ ~ h/μ, whatever λ_L is."""
        return True

    def Limits(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> np.ndarray:
        """γ_T / h_T for each of crack_elements.

        Parameters
        ----------
        components : Component
            Of the traction that take part: normal, and with friction tangential.

        Returns
        -------
        array
            γ_T / h_T for each of crack_elements.
        """
        if self.gamma0 is not None:
            return np.full(len(crack_elements(V.body)), self.gamma0)
        law, moduli = self.Law(V, material), local_moduli(V, material)
        constants = trace_constants(V, law, components)
        # an element on which R_h vanishes needs no bound of its own
        limits = self.theta / np.maximum(constants, 1e-3 * (constants / moduli).max() * moduli)
        return np.where(lacks_pressure(V, law), 0, limits)

    def Law(self, V: CrackFESpace, material: Isotropic) -> Isotropic | WithoutPressure:
        """The material, or the part of it that γ has to do with: where it is nearly incompressible, pressures of their own take the rest."""
        return WithoutPressure(material) if is_projected(V, material) else material

    def IsSafe(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> bool:
        """Whether the local eigenproblems prove K - K_γ positive."""
        return self.gamma0 is None or self.gamma0 * trace_constants(V, self.Law(V, material), components).max() < 1

    def Remedy(self, smallest: float) -> str:
        """A smaller γ."""
        if self.gamma0 is None:
            return f"γ was chosen element by element for a coercivity of {1 - self.theta:g}: take a smaller theta"
        return smaller_gamma0(self.gamma0, smallest, "gamma0=None, which chooses γ itself")


@dataclass(frozen=True)
class BothSides(Defaults):
    """R_h(v)² replaced by weight (σ_n(v⁺)² + σ_n(v⁻)²), R_h(v) by weight (σ_n(v⁺) + σ_n(v⁻)), γ = gamma0 h_T.

    weight=1 is what the authors' program does: against one ∫γλμ it is not consistent and imposes gap = γ|λ| in contact
    (docs/both-sides.md). weight=½ is consistent. Both depend on slivers: the smaller part has no trace inequality.

    Parameters
    ----------
    gamma0 : float
        γ / h_T, of the unit length over stress.
    weight : float
        Of both sides, > 0.
    """

    gamma0: float
    weight: float = 1

    def __post_init__(self) -> None:
        check_positive(self.gamma0, "BothSides: gamma0")
        check_positive(self.weight, "BothSides: weight")

    @property
    def sides(self) -> dict[str, float]:
        """The traces that take part, with their weights."""
        return {"plus": self.weight, "minus": self.weight}

    def Gamma(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> CoefficientFunction:
        """γ as a CoefficientFunction on the elements that the cracks meet."""
        return element_gamma(V, np.full(len(crack_elements(V.body)), self.gamma0))

    def IsSafe(self, V: CrackFESpace, material: Isotropic, components: Sequence[Component] = (NORMAL,)) -> bool:
        """False: no local bound is known, the eigenvalue has to be computed."""
        return False

    def Remedy(self, smallest: float) -> str:
        """A smaller γ."""
        return smaller_gamma0(self.gamma0, smallest, "BarbosaHughes(), which chooses γ itself")


def element_gamma(V: CrackFESpace, limits: np.ndarray) -> CoefficientFunction:
    """γ = limit h_T, weighted at the tips, for one limit on each of crack_elements; where cracks share one, the least."""
    numbers, sizes = numbers_and_sizes(V.body)
    least = np.full(V.mesh.ne, np.inf)
    np.minimum.at(least, numbers, limits * sizes)
    gamma = GridFunction(L2(V.mesh, order=0))
    gamma.vec.FV().NumPy()[:] = np.where(np.isinf(least), 0, least)
    return gamma * tip_weight(V)


def crack_elements(body: CrackedMesh) -> list[ElementLocation]:
    """The ElementLocations of all cracks."""
    return [location for c in range(len(body.cracks)) for location in body.Elements(c)]


def numbers_and_sizes(body: CrackedMesh) -> tuple[np.ndarray, np.ndarray]:
    """Arrays: the element and its h_T for each of crack_elements."""
    elements = crack_elements(body)
    return np.array([T.element for T in elements], dtype=int), np.array([T.h for T in elements])


def materials_of(V: CrackFESpace, material: Isotropic | WithoutPressure) -> list[Any]:
    """The Elasticity in each of crack_elements."""
    numbers, _ = numbers_and_sizes(V.body)
    return [material.InRegion(int(i)) for i in element_regions(V.mesh)[numbers]]


def local_moduli(V: CrackFESpace, material: Isotropic) -> np.ndarray:
    """What R_h is of the order of in each of crack_elements: lam + 2 mu, and 2 mu where the pressure is free."""
    free = is_projected(V, material)
    return np.array([here.Modulus(free * here.projected) for here in materials_of(V, material)])


def carries_pressure(V: CrackFESpace, material: Isotropic | WithoutPressure) -> np.ndarray:
    """For each of crack_elements whether it has a pressure of its own, see `mixed_system`: nearly incompressible, and met by one crack only."""
    return (sharing_cracks(V.body) == 1) & _nearly_incompressible(V, material)


def lacks_pressure(V: CrackFESpace, law: Isotropic | WithoutPressure) -> np.ndarray:
    """For each of crack_elements whether two cracks share it, so that it has no pressure of its own though the law asks for it."""
    return isinstance(law, WithoutPressure) & _nearly_incompressible(V, law) & ~carries_pressure(V, law)


def _nearly_incompressible(V: CrackFESpace, material: Isotropic | WithoutPressure) -> np.ndarray:
    return np.array([here.nearly_incompressible for here in materials_of(V, material)], dtype=bool)


def sharing_cracks(body: CrackedMesh) -> np.ndarray:
    """How many cracks meet each of crack_elements."""
    numbers, _ = numbers_and_sizes(body)
    return np.bincount(numbers)[numbers]


def tip_weight(V: CrackFESpace) -> CoefficientFunction:
    """min(1, r/h_T) around the tips with scalar functions (8), 1 elsewhere."""
    weight, branch = CoefficientFunction(1), core.TipBasis.branch
    points = [tip.point for tip, spec in zip(V.body.tips, V.tip_specs) if spec is not None and spec.basis == branch]
    if points:
        h, (numbers, sizes) = GridFunction(L2(V.mesh, order=0)), numbers_and_sizes(V.body)
        h.vec.FV().NumPy()[numbers] = sizes
    for point in points:
        r = sqrt((x - point[0]) ** 2 + (y - point[1]) ** 2)
        weight = weight * IfPos(h - r, r / h, 1)
    return weight


def softened(gamma: CoefficientFunction, stiffness: Coefficient | None, theta: float = 0.5) -> CoefficientFunction:
    """1/(1/γ + k/θ), k a stiffness.

    Beside a joint of that stiffness R_h holds -k g, and γ R_h² ≤ θ (σ_n² γ/θ + k g²) by Cauchy and Schwarz. Faces that soften by k lose more than a jump of
    the multiplier gives them back by γ unless γ k < 1; γ is large where a crack is short in an element.
    """
    return gamma if gamma is None or stiffness is None else gamma / (1 + gamma * stiffness / theta)


def trace_constants(V: CrackFESpace, material: Isotropic | WithoutPressure, components: Sequence[Component] = (NORMAL,)) -> np.ndarray:
    """C_T for each element of crack_elements: the local eigenproblems of docs/method.md, section 5.

    C_T = m max ∫_{T∩Γ} h_T w R_h(v)² / a_T(v,v) over the functions of V that live on T, w = tip_weight, a_T over the larger
    part beside Γ; with friction |σn|² = σ_n² + σ_t² in place of σ_n². Dimensionless times stress; with γ_T = θ h_T / C_T,
    ∫γ R_h(v)² ≤ θ a(v,v): larger parts of one crack are disjoint, and m cracks that share an element may use one part all.
    They are kept with V.
    """
    known = V.__dict__.setdefault("_trace_constants", {})
    key = material, tuple(components), constants_of_modes(V)
    if key not in known:
        ratios = [_largest_ratios(V, material, components, crack) for crack in range(len(V.body.cracks))]
        known[key] = sharing_cracks(V.body) * numbers_and_sizes(V.body)[1] * np.concatenate(ratios)
    return known[key]


@singledispatch
def constants_of_modes(V: CrackFESpace) -> tuple[tuple[float, float], ...]:
    """(κ, μ) of what is singular in a space."""
    return tuple((spec.kappa, spec.mu) for spec in V.tip_specs if spec is not None)


@constants_of_modes.register(core.SolidFESpace)
def constants_at_fronts(V: core.SolidFESpace) -> tuple[tuple[float, float], ...]:
    """Of the fronts."""
    return () if V.front_spec is None else tuple(V.front_spec.materials)


def _largest_ratios(V: CrackFESpace, material: Isotropic | WithoutPressure, components: Sequence[Component], crack: int) -> np.ndarray:
    """max ∫_{T∩Γ} w R_h(v)² / a_T(v,v) for each of the elements that a crack meets."""
    u, v = V.TnT()
    body, numbers = V.body, [T.element for T in V.body.Elements(crack)]
    squared = tip_weight(V) * ComparedTraction(body, material, BarbosaHughes.sides).Squared(u, v, components)
    trace = BilinearForm(squared * body.dcrack(crack=crack))
    energy = BilinearForm(V)
    add_stress_power(energy, material, body.dlarger(crack=crack))
    (R, dofs, _), (A, _, _) = (core.ElementMatrices(form, numbers) for form in (trace, energy))
    return largest_ratios(R, A, largest_of_kind(np.einsum("eii->ei", A), V, dofs))


def largest_ratios(R: np.ndarray, A: np.ndarray, sizes: np.ndarray, kernel: float = 1e-10) -> np.ndarray:
    """The largest eigenvalues of matrices R against A, (n, k, k) each, beside the common kernels, to which rows of zeros belong.

    Parameters
    ----------
    sizes
        (n, k), of the unit of each diagonal entry of A.
    """
    diagonal = np.einsum("eii->ei", A)
    used = diagonal > 1e-28 * sizes
    scale = np.where(used, 1 / np.sqrt(np.where(used, diagonal, 1)), 0)
    R, A = (M * scale[:, :, None] * scale[:, None, :] for M in (R, A))
    values, vectors = np.linalg.eigh(A)
    regular = values > kernel * values[:, -1:]
    basis = vectors * np.where(regular, 1 / np.sqrt(np.where(regular, values, 1)), 0)[:, None, :]
    return np.linalg.eigvalsh(basis.swapaxes(1, 2) @ R @ basis)[:, -1]


def largest_of_kind(values: np.ndarray, V: CrackFESpace, dofs: np.ndarray) -> np.ndarray:
    """For each unknown of each element the largest of its values that have its unit: of all polynomials, or of the functions of its tip; values and dofs are (n, k)."""
    kinds = Unknowns(V).Kinds(dofs)
    largest = np.zeros(values.shape)
    for kind in range(kinds.max() + 1):
        here = kinds == kind
        largest = np.where(here, np.where(here, values, 0).max(axis=1, keepdims=True), largest)
    return largest
