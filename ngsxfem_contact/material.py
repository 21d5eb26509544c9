"""Isotropic linear elasticity, in the plane (1) of [AHLMR12], and in space."""

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from ngsolve import VOL, CoefficientFunction, ElementId, Id, IfPos, InnerProduct, Mesh, Trace, sqrt

from .arguments import INFINITY, check_number, check_type

__all__ = ["Elasticity"]

LEAST, MOST = 1e-100, 1e100  # of moduli: squares and quotients of them are numbers


def check_engineering_constants(E: float, nu: float, limit: float, name: str) -> None:
    """Raises ValueError unless 0 < E < inf, neither of them too near for double precision, and -1 < nu < limit."""
    check_number(E, f"{name}: E", lambda E: 0 < E < INFINITY, "be positive and finite (Young's modulus)")
    check_number(E, f"{name}: E", lambda E: LEAST <= E <= MOST, f"lie between {LEAST:g} and {MOST:g}, take another unit of stress (Young's modulus)")
    check_number(nu, f"{name}: nu", lambda nu: -1 < nu < limit, f"lie between -1 and {limit} (Poisson's ratio)")


def lame_coefficients(E: float, nu: float, name: str) -> tuple[float, float]:
    """(lam, mu) of space and of plane strain. Raises ValueError unless -1 < nu < 1/2, and as check_engineering_constants."""
    check_engineering_constants(E, nu, 0.5, name)
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


def check_form(material: "Isotropic", body: Any, name: str) -> None:
    """Raises ValueError for a material of the plane in a body in space, and for one of space in the plane."""
    dimension = body.mesh.dim
    for region in material.regions:
        if region.dimension != dimension:
            remedy = "Elasticity.PlaneStrain(E, nu) or PlaneStress(E, nu)" if dimension == 2 else "Elasticity.Solid(E, nu)"
            raise ValueError(
                f"{name}={region} is a material of {'the plane' if dimension == 3 else 'space'}, and the mesh has dimension {dimension}; take {remedy}"
            )


NEARLY_INCOMPRESSIBLE = 9  # λ_L/μ_L
FORMS = ("plane strain", "plane stress", "solid")


Coefficient: TypeAlias = float | CoefficientFunction  # a number, or a function of the place


class Isotropic(ABC):
    """σ = lam tr(ε) I + 2 mu ε for numbers or functions lam, mu.

    Attributes
    ----------
    nu
        Poisson's ratio.
    alpha
        Coefficient of thermal expansion, in 1 / temperature.
    confined
        1 in plane strain (ε_zz = 0), 0 in plane stress.
    nearly_incompressible
        Whether it is so anywhere.
    projected
        1 where it is, 0 elsewhere.
    """

    lam: Coefficient
    mu: Coefficient
    nu: Coefficient
    alpha: Coefficient
    confined: Coefficient
    nearly_incompressible: bool
    projected: int | CoefficientFunction

    @property
    @abstractmethod
    def regions(self) -> "list[Elasticity]":
        """The Elasticity of each region of the mesh; one, if there is but one material."""

    @abstractmethod
    def InRegion(self, number: int) -> "Elasticity":
        """The Elasticity of a region of the mesh, counted from 0."""

    @abstractmethod
    def At(self, mesh: Mesh, point: Sequence[float]) -> "Elasticity":
        """The Elasticity at a point of the mesh."""

    @property
    def dimension(self) -> int:
        """Of the body that it is a material of: 2 or 3."""
        return 3 if self.regions[0].form == "solid" else 2

    @property
    def E(self) -> Coefficient:
        """Young's modulus."""
        return 2 * self.mu * (1 + self.nu)

    @property
    def kappa(self) -> Coefficient:
        """Kolosov's constant: 3 - 4ν in plane strain, (3 - ν)/(1 + ν) in plane stress."""
        return (self.lam + 3 * self.mu) / (self.lam + self.mu)

    @property
    def E_prime(self) -> Coefficient:
        """E' = 8μ/(κ + 1): E/(1 - ν²) in plane strain, E in plane stress; Irwin's G = (K_I² + K_II²)/E'."""
        return 8 * self.mu / (self.kappa + 1)

    @property
    def nu_prime(self) -> Coefficient:
        """ν' = (3 - κ)/(1 + κ), the lateral stress of a strain in one direction: ν/(1 - ν) in plane strain, ν in plane stress."""
        return (3 - self.kappa) / (1 + self.kappa)

    @property
    def compliance(self) -> Coefficient:
        """1/λ_L, of the pressure λ_L div u."""
        return 1 / self.lam

    def Modulus(self, free: Coefficient = 0) -> Coefficient:
        """λ_L + 2μ, what the stress is of the order of; 2μ where the pressure is free (free = 1)."""
        return (1 - free) * self.lam + 2 * self.mu

    def Stress(self, strain: CoefficientFunction, dilatation: Coefficient | None = None) -> CoefficientFunction:
        """The stress of a strain, both 2 × 2 (in space 3 × 3) CoefficientFunctions, in the unit of lam and mu: (1) of [AHLMR12].

        Parameters
        ----------
        dilatation
            What takes the place of the strain's trace where the material is nearly incompressible, see `spaces.incompressible`.
        """
        return self.lam * (Trace(strain) if dilatation is None else dilatation) * Id(strain.dims[0]) + 2 * self.mu * strain

    def StressPower(
        self,
        strain: CoefficientFunction,
        other: CoefficientFunction,
        dilatations: tuple[CoefficientFunction, CoefficientFunction] | None = None,
        pressure: CoefficientFunction | None = None,
    ) -> CoefficientFunction:
        """σ(ε):ε', the integrand of a(u, v), of two 2 × 2 strains.

        Parameters
        ----------
        dilatations
            In place of their traces; with a pressure π D + π/λ_L.
        """
        if dilatations is None:
            return InnerProduct(self.Stress(strain), other)
        more = 0 if pressure is None else pressure / IfPos(self.lam, self.lam, 1)
        first, second = dilatations
        return self.lam * (first + more) * (second + more) + 2 * self.mu * InnerProduct(strain, other)

    def Strain(self, stress: CoefficientFunction) -> CoefficientFunction:
        """The 2 × 2 strain of a 2 × 2 stress, the inverse of Stress."""
        return (stress - self.lam / (2 * (self.lam + self.mu)) * Trace(stress) * Id(2)) / (2 * self.mu)

    def ThermalStress(self, temperature: Coefficient) -> CoefficientFunction:
        """The stress of a body that is heated by ΔT and held: -E α ΔT / (1 - 2ν) I in plane strain and in space, -E α ΔT / (1 - ν) I in plane stress."""
        return -2 * (self.lam + self.mu) * (1 + self.confined * self.nu) * self.alpha * temperature * Id(self.dimension)

    def VonMises(self, stress: CoefficientFunction, temperature: Coefficient = 0) -> CoefficientFunction:
        """The von Mises stress of a stress; of a 2 × 2 one with σ_zz = 0 in plane stress and ν (σ_xx + σ_yy) - E α ΔT in plane strain."""
        if stress.dims[0] == 3:
            deviator = stress - Trace(stress) / 3 * Id(3)
            return sqrt(1.5 * InnerProduct(deviator, deviator))
        xx, yy, xy = stress[0, 0], stress[1, 1], stress[0, 1]
        zz = self.confined * (self.nu * (xx + yy) - self.E * self.alpha * temperature)
        return sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * xy**2)


@dataclass(frozen=True)
class Elasticity(Isotropic):
    """σ = lam tr(ε) I + 2 mu ε, the stress in the unit of lam and mu.

    Parameters
    ----------
    lam, mu
        The coefficients λ_L, μ_L of this law in the plane: Lamé's in plane strain and in space; for plane stress use PlaneStress.
    form
        "plane strain" (ε_zz = 0, default) or "plane stress" (σ_zz = 0), what E, ν and σ_zz follow from, or "solid", of bodies in space.
    alpha
        Coefficient of thermal expansion, for ContactProblem(..., temperature=ΔT).

    Other Parameters
    ----------------
    E
        Young's modulus, a stress > 0.
    alpha
        Thermal expansion.

    Raises
    ------
    TypeError
        For what is no number.
    ValueError
        For another form and unless mu > 0 and lam + mu > 0: the energy would not be positive.

    Notes
    -----
    Several materials in one body: Elasticity.ByRegion(mesh, {"steel": Elasticity(...), "rubber": Elasticity(...)}).

    Examples
    --------
    >>> steel = Elasticity.PlaneStrain(E=210e3, nu=0.3)  # MPa
    >>> round(steel.lam), round(steel.mu), round(steel.kappa, 2)
    (121154, 80769, 1.8)
    """

    lam: float
    mu: float
    form: str = "plane strain"
    alpha: float = 0.0
    nu: float = field(init=False, repr=False, compare=False)
    confined: float = field(init=False, repr=False, compare=False)
    nearly_incompressible: bool = field(init=False, repr=False, compare=False)
    projected: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("lam", "mu", "alpha"):
            check_number(getattr(self, name), f"Elasticity: {name}")
        if self.mu <= 0 or self.lam + self.mu <= 0:
            raise ValueError(
                f"Elasticity(lam={self.lam}, mu={self.mu}): the energy is positive only for mu > 0 and lam + mu > 0; check the sign and the Poisson ratio"
            )
        for value, name in ((self.mu, "mu"), (self.lam + self.mu, "lam + mu")):
            check_number(
                value,
                f"Elasticity: {name}",
                lambda value: LEAST * 1e-3 <= value <= MOST * 1e3,
                f"lie between {LEAST:g} and {MOST:g}, take another unit of stress",
            )
        if self.form not in FORMS:
            raise ValueError(f"Elasticity: form={self.form!r} is not one of {list(FORMS)}")
        is_strain = self.form != "plane stress"
        object.__setattr__(self, "nu", self.lam / (2 * (self.lam + self.mu)) if is_strain else self.lam / (self.lam + 2 * self.mu))
        object.__setattr__(self, "confined", float(is_strain))
        object.__setattr__(self, "nearly_incompressible", self.lam > NEARLY_INCOMPRESSIBLE * self.mu)
        object.__setattr__(self, "projected", int(self.nearly_incompressible))

    @staticmethod
    def PlaneStrain(E: float, nu: float, alpha: float = 0.0) -> "Elasticity":
        """The material of a long body, ε_zz = 0: lam = E nu / ((1 + nu)(1 - 2 nu)), mu = E / (2 (1 + nu)).

        Parameters
        ----------
        nu
            Poisson's ratio, -1 < nu < 1/2.

        Raises
        ------
        ValueError
            Outside of these.
        """
        return Elasticity(*lame_coefficients(E, nu, "Elasticity.PlaneStrain"), alpha=alpha)

    @staticmethod
    def PlaneStress(E: float, nu: float, alpha: float = 0.0) -> "Elasticity":
        """The material of a thin plate, σ_zz = 0: lam = E nu / (1 - nu²), mu = E / (2 (1 + nu)).

        Parameters
        ----------
        nu
            Poisson's ratio, -1 < nu < 1.

        Raises
        ------
        ValueError
            Outside of these.
        """
        check_engineering_constants(E, nu, 1, "Elasticity.PlaneStress")
        return Elasticity(E * nu / (1 - nu**2), E / (2 * (1 + nu)), "plane stress", alpha)

    @staticmethod
    def Solid(E: float, nu: float, alpha: float = 0.0) -> "Elasticity":
        """The material of a body in space: lam = E nu / ((1 + nu)(1 - 2 nu)), mu = E / (2 (1 + nu)).

        Parameters
        ----------
        nu
            Poisson's ratio, -1 < nu < 1/2.

        Raises
        ------
        ValueError
            Outside of these.
        """
        return Elasticity(*lame_coefficients(E, nu, "Elasticity.Solid"), "solid", alpha)

    @staticmethod
    def ByRegion(mesh: Mesh, materials: "dict[str, Elasticity]") -> "RegionElasticity":
        """A RegionElasticity: one Elasticity for each region (material) of the mesh.

        Parameters
        ----------
        mesh
            Of NGSolve.
        materials
            {name of a region, or a regular expression: Elasticity}.

        Raises
        ------
        ValueError
            Unless each region is matched by exactly one name.
        TypeError
            For other objects.
        """
        return RegionElasticity(mesh, materials)

    @property
    def regions(self) -> "list[Elasticity]":
        """This one."""
        return [self]

    def InRegion(self, number: int) -> "Elasticity":
        """The Elasticity of a region: this one."""
        return self

    def At(self, mesh: Mesh, point: Sequence[float]) -> "Elasticity":
        """The Elasticity at a point: this one."""
        return self


class RegionElasticity(Isotropic):
    """Different materials in the regions of a mesh; lam, mu, nu, alpha and confined are CoefficientFunctions.

    Parameters
    ----------
    materials
        {name of a region, or a regular expression: Elasticity}.

    Raises
    ------
    ValueError
        Unless each region of the mesh is matched by exactly one name, and each name matches a region.
    """

    def __init__(self, mesh: Mesh, materials: dict[str, Elasticity]) -> None:
        check_type(mesh, Mesh, "Elasticity.ByRegion: mesh", "a Mesh of NGSolve")
        check_type(materials, dict, "Elasticity.ByRegion: materials", "a dictionary {name of a region: Elasticity}")
        for name, material in materials.items():
            if not isinstance(material, Elasticity):
                raise TypeError(f"Elasticity.ByRegion: {name!r} has the material {material!r}, which is not an Elasticity")
        names = mesh.GetMaterials()
        try:
            matches = {region: [name for name in materials if re.fullmatch(name, region)] for region in names}
        except re.error as error:
            raise ValueError(f"Elasticity.ByRegion: {error.pattern!r} is no regular expression ({error}); escape special characters by \\") from None
        for region, found in matches.items():
            if len(found) != 1:
                raise ValueError(
                    f"Elasticity.ByRegion: region {region!r} of the mesh is matched by {found or 'no name'}; give it exactly one material of {sorted(materials)}"
                )
        unused = set(materials) - {name for found in matches.values() for name in found}
        if unused:
            raise ValueError(f"Elasticity.ByRegion: {sorted(unused)} match no region; the mesh has {sorted(set(names))}")
        self.mesh, self._regions = mesh, [materials[matches[region][0]] for region in names]
        by_name = dict(zip(names, self._regions))
        piecewise = lambda field: mesh.MaterialCF({name: getattr(material, field) for name, material in by_name.items()})
        self.lam, self.mu, self.nu, self.alpha, self.confined, self.projected = map(piecewise, ("lam", "mu", "nu", "alpha", "confined", "projected"))
        self.nearly_incompressible = any(material.nearly_incompressible for material in self._regions)

    def __reduce__(self) -> tuple[type, tuple[Mesh, dict[str, Elasticity]]]:
        return RegionElasticity, (self.mesh, {re.escape(name): material for name, material in zip(self.mesh.GetMaterials(), self._regions)})

    @property
    def regions(self) -> list[Elasticity]:
        """The Elasticity of each region of the mesh."""
        return self._regions

    def InRegion(self, number: int) -> Elasticity:
        """The Elasticity of a region, counted from 0."""
        return self._regions[number]

    def At(self, mesh: Mesh, point: Sequence[float]) -> Elasticity:
        """The Elasticity of the region that contains a point; on an interface that of either side."""
        return self._regions[mesh[ElementId(VOL, mesh(*map(float, point)).nr)].index]

    def __repr__(self) -> str:
        return f"RegionElasticity({self._regions})"
