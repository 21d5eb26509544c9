"""The Barbosa-Hughes stabilisation of the multiplier: (12), (13) and (38) of [AHLMR12].

R_h(v) is σ_n of the polynomial of the larger part of each cut element, and γ = γ_0 h_T on each. The tip functions
take part in R_h. The two vector modes have σ_n = 0 on the lips; single functions of (8) have σ_n ~ r^{-1/2} there, so
that ∫γ R_h(v)² diverges: with them γ falls linearly to zero within h_T of the tip (docs/method.md, section 5).
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np
from ngsolve import L2, BilinearForm, CoefficientFunction, ElementId, GridFunction, IfPos, sqrt, x, y

from .. import _ngsxfem_contact as core
from ..arguments import check_number, check_positive
from ..loads.face_traction import ComparedTraction
from ..operators import NORMAL
from ..spaces.incompressible import WithoutPressure, is_projected, stress_power


class Stabilisation:
    """What a stabilisation need not say: any object with `sides`, Gamma and IsSafe is one, and has these unless it has its own; see `trait`."""

    @property
    def needs_eigenvalue(self):
        """Whether the factorised matrix may be positive although γ is too large: False where it is K - K_γ."""
        return False

    def Remedy(self, smallest):
        """What to do about the smallest eigenvalue of K - K_γ against K, which is not positive."""
        return f"make what Gamma returns at least {1 - smallest:.3g} times smaller"


REQUIRED = ("sides", "Gamma", "IsSafe")


def trait(stabilisation, name):
    """An attribute of a stabilisation; that of Stabilisation where it has none."""
    return getattr(stabilisation, name, getattr(Stabilisation(), name))


def check_stabilisation(stabilisation, name):
    """Raises TypeError for what is no stabilisation."""
    if isinstance(stabilisation, type) or not any(hasattr(stabilisation, part) for part in REQUIRED):
        raise TypeError(f"{name}={stabilisation!r} is neither an object such as BarbosaHughes() nor None")
    missing = [part for part in REQUIRED if not hasattr(stabilisation, part)]
    if missing:
        raise TypeError(f"{name}={stabilisation!r} has no {' and no '.join(missing)}; docs/extending.md says what they are")


def smaller_gamma0(gamma0, smallest, otherwise):
    """The Remedy for a number gamma0."""
    return f"take gamma0 = {gamma0:g} below {gamma0 / (1 - smallest):.3g}, or {otherwise}"


@dataclass(frozen=True)
class Unstabilised(Stabilisation):
    """K_γ = C_γ = D_γ = 0."""

    sides = {}

    def Gamma(self, V, material, components=(NORMAL,)):
        """None: there is no γ."""
        return None

    def IsSafe(self, V, material, components=(NORMAL,)):
        """True: K is positive."""
        return True


@dataclass(frozen=True)
class BarbosaHughes(Stabilisation):
    """γ on the cracks.

    Parameters
    ----------
    gamma0
        γ = gamma0 h_T with h_T the longest edge of each element; gamma has the unit of length over stress. None (default): γ_T = theta h_T / C_T on each
        element, C_T the largest value of ∫_{T∩Γ} h_T R_h(v)² / a_T(v,v), a_T over the larger part: K - K_γ is coercive with 1 - theta.
    theta
        Between 0 and 1.

    Notes
    -----
    With friction the tangential multiplier is stabilised in the same way, R_h(v)² becoming |σ(v)n|².
    """

    gamma0: float | None = None
    theta: float = 0.5

    sides = {"larger": 1}

    def __post_init__(self):
        if self.gamma0 is not None:
            check_positive(self.gamma0, "BarbosaHughes: gamma0", "; stabilisation=None switches it off")
        check_number(self.theta, "BarbosaHughes: theta", lambda theta: 0 < theta < 1, "lie between 0 and 1")

    def Gamma(self, V, material, components=(NORMAL,)):
        """γ as a CoefficientFunction on the elements that the cracks meet.

        Parameters
        ----------
        V : CrackFESpace
            The displacements.
        material : Elasticity
            Of the body.
        components : Component
            Of the traction that take part: normal, and with friction tangential.

        Returns
        -------
        CoefficientFunction
            γ, on the elements that the cracks meet.
        """
        return element_gamma(V, self.Limits(V, material, components))

    def Limits(self, V, material, components=(NORMAL,)):
        """γ_T / h_T for each of crack_elements.

        Parameters
        ----------
        V : CrackFESpace
            The displacements.
        material : Elasticity
            Of the body.
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

    def Law(self, V, material):
        """The material, or the part of it that γ has to do with: where it is nearly incompressible, pressures of their own take the rest.

        Parameters
        ----------
        V : CrackFESpace
            The displacements.
        material : Elasticity
            Of the body.

        Returns
        -------
        Elasticity
        """
        return WithoutPressure(material) if is_projected(V, material) else material

    def IsSafe(self, V, material, components=(NORMAL,)):
        """Whether the local eigenproblems prove K - K_γ positive.

        Parameters
        ----------
        V : CrackFESpace
            The displacements.
        material : Elasticity
            Of the body.
        components : Component
            Of the traction that take part: normal, and with friction tangential.

        Returns
        -------
        bool
        """
        return self.gamma0 is None or self.gamma0 * trace_constants(V, self.Law(V, material), components).max() < 1

    def Remedy(self, smallest):
        """A smaller γ.

        Parameters
        ----------
        smallest : float
            The smallest eigenvalue of K - K_γ against K.

        Returns
        -------
        str
            The end of the message of NotCoercive.
        """
        if self.gamma0 is None:
            return f"γ was chosen element by element for a coercivity of {1 - self.theta:g}: take a smaller theta"
        return smaller_gamma0(self.gamma0, smallest, "gamma0=None, which chooses γ itself")


@dataclass(frozen=True)
class BothSides(Stabilisation):
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

    def __post_init__(self):
        check_positive(self.gamma0, "BothSides: gamma0")
        check_positive(self.weight, "BothSides: weight")

    @property
    def sides(self):
        """The traces that take part, with their weights."""
        return {"plus": self.weight, "minus": self.weight}

    def Gamma(self, V, material, components=(NORMAL,)):
        """γ as a CoefficientFunction on the elements that the cracks meet.

        Parameters
        ----------
        V : CrackFESpace
            The displacements.
        material : Elasticity
            Of the body.
        components : Component
            Of the traction that take part: normal, and with friction tangential.

        Returns
        -------
        CoefficientFunction
            γ, on the elements that the cracks meet.
        """
        return element_gamma(V, np.full(len(crack_elements(V.body)), self.gamma0))

    def IsSafe(self, V, material, components=(NORMAL,)):
        """False: no local bound is known, the eigenvalue has to be computed.

        Parameters
        ----------
        V : CrackFESpace
            The displacements.
        material : Elasticity
            Of the body.
        components : Component
            Of the traction that take part: normal, and with friction tangential.

        Returns
        -------
        bool
        """
        return False

    def Remedy(self, smallest):
        """A smaller γ.

        Parameters
        ----------
        smallest : float
            The smallest eigenvalue of K - K_γ against K.

        Returns
        -------
        str
            The end of the message of NotCoercive.
        """
        return smaller_gamma0(self.gamma0, smallest, "BarbosaHughes(), which chooses γ itself")


def element_gamma(V, limits):
    """γ = limit h_T, weighted at the tips, for one limit on each of crack_elements; where cracks share one, the least."""
    gamma = GridFunction(L2(V.mesh, order=0))
    gamma.vec[:] = np.inf
    for location, limit in zip(crack_elements(V.body), limits):
        gamma.vec[location.element] = min(limit * location.h, gamma.vec[location.element])
    values = gamma.vec.FV().NumPy()
    values[np.isinf(values)] = 0
    return gamma * tip_weight(V)


def crack_elements(body):
    """The ElementLocations of all cracks."""
    return [location for c in range(len(body.cracks)) for location in body.Elements(c)]


def local_moduli(V, material):
    """What R_h is of the order of in each of crack_elements: lam + 2 mu, and 2 mu where the pressure is free."""
    modulus = GridFunction(L2(V.mesh, order=0))
    free = material.projected if is_projected(V, material) else 0
    modulus.Set(CoefficientFunction((1 - free) * material.lam + 2 * material.mu))
    return np.array([modulus.vec[location.element] for location in crack_elements(V.body)])


def carries_pressure(V, material):
    """For each of crack_elements whether it has a pressure of its own, see `mixed_system`: nearly incompressible, and met by one crack only."""
    return np.array([len(V.body.CracksOf(T.element)) == 1 for T in crack_elements(V.body)]) & _nearly_incompressible(V, material)


def lacks_pressure(V, law):
    """For each of crack_elements whether two cracks share it, so that it has no pressure of its own though the law asks for it."""
    return isinstance(law, WithoutPressure) & _nearly_incompressible(V, law) & ~carries_pressure(V, law)


def _nearly_incompressible(V, material):
    index = np.array([V.mesh[ElementId(T.element)].index for T in crack_elements(V.body)], dtype=int)
    regions = getattr(material, "regions", None)
    return np.array([(regions[i] if regions else material).nearly_incompressible for i in index], dtype=bool)


def tip_weight(V):
    """min(1, r/h_T) around the tips with scalar functions (8), 1 elsewhere."""
    h = GridFunction(L2(V.mesh, order=0))
    for location in crack_elements(V.body):
        h.vec[location.element] = location.h
    weight = CoefficientFunction(1)
    for tip, spec in zip(V.body.tips, V.tip_specs):
        if spec is not None and spec.basis == core.TipBasis.branch:
            r = sqrt((x - tip.point[0]) ** 2 + (y - tip.point[1]) ** 2)
            weight = weight * IfPos(h - r, r / h, 1)
    return weight


def softened(gamma, joint, theta=0.5):
    """1/(1/γ + k/θ) beside a joint of stiffness k: R_h holds -k g there, and γ R_h² ≤ θ (σ_n² γ/θ + k g²) by Cauchy and Schwarz."""
    return gamma if gamma is None or joint is None else gamma / (1 + gamma * joint.Stiffness() / theta)


def trace_constants(V, material, components=(NORMAL,)):
    """C_T for each element of crack_elements: the local eigenproblems of docs/method.md, section 5.

    C_T = m max ∫_{T∩Γ} h_T w R_h(v)² / a_T(v,v) over the functions of V that live on T, w = tip_weight, a_T over the larger
    part beside Γ; with friction |σn|² = σ_n² + σ_t² in place of σ_n². Dimensionless times stress; with γ_T = θ h_T / C_T,
    ∫γ R_h(v)² ≤ θ a(v,v): larger parts of one crack are disjoint, and m cracks that share an element may use one part all.
    """
    u, v = V.TnT()
    body = V.body
    traces = tip_weight(V) * ComparedTraction(body, material, BarbosaHughes.sides).Squared(u, v, components)
    sharing = Counter(location.element for location in crack_elements(body))
    constants = []
    for crack in range(len(body.cracks)):
        energy = BilinearForm(stress_power(material, u, v) * body.dlarger(crack=crack))
        trace = BilinearForm(traces * body.dcrack(crack=crack))
        constants += [sharing[T.element] * T.h * _largest_ratio(V, T.element, trace, energy) for T in body.Elements(crack)]
    return np.array(constants)


def _largest_ratio(V, element, trace, energy, kernel=1e-10):
    """The largest eigenvalue of the element matrices of trace against energy, beside the common kernel."""
    ei = ElementId(element)
    fe, trafo = V.GetFE(ei), V.mesh.GetTrafo(ei)
    R, A = (np.array(form.integrators[0].CalcElementMatrix(fe, trafo)) for form in (trace, energy))
    diagonal = A.diagonal().copy()
    used = diagonal > 1e-28 * largest_of_kind(diagonal, V, V.GetDofNrs(ei))
    scale = 1 / np.sqrt(diagonal[used])
    R, A = (M[np.ix_(used, used)] * scale[:, None] * scale for M in (R, A))
    values, vectors = np.linalg.eigh(A)
    regular = values > kernel * values[-1]
    basis = vectors[:, regular] / np.sqrt(values[regular])
    return np.linalg.eigvalsh(basis.T @ R @ basis)[-1]


def largest_of_kind(values, V, dofs):
    """For each unknown the largest of the values that have its unit: of all polynomials, or of the functions of its tip."""
    kind = np.zeros(len(dofs), dtype=int)
    for tip in range(len(V.body.tips)):
        kind[np.isin(dofs, V.TipDofs(tip))] = tip + 1
    largest = np.zeros(kind.max() + 1)
    np.maximum.at(largest, kind, values)
    return largest[kind]
