"""Isotropic linear elasticity in the plane: (1) of [AHLMR12]."""

from dataclasses import dataclass
from math import isfinite

from ngsolve import Id, Trace


def check_engineering_constants(E, nu, limit):
    """Raises ValueError unless E > 0 and -1 < nu < limit."""
    if not (0 < E < float("inf") and -1 < nu < limit):
        raise ValueError(f"E={E}, nu={nu}: Young's modulus must be positive, Poisson's ratio between -1 and {limit}")


@dataclass(frozen=True)
class Elasticity:
    """σ = lam tr(ε) I + 2 mu ε, the stress in the unit of lam and mu.

    lam, mu: Lamé's coefficients λ_L, μ_L of plane strain (for plane stress use PlaneStress).
    Raises ValueError unless mu > 0 and lam + mu > 0: the energy would not be positive.
    """

    lam: float
    mu: float

    def __post_init__(self):
        if not (isfinite(self.lam) and isfinite(self.mu)):
            raise ValueError(f"Elasticity(lam={self.lam}, mu={self.mu}): both must be finite numbers")
        if self.mu <= 0 or self.lam + self.mu <= 0:
            raise ValueError(
                f"Elasticity(lam={self.lam}, mu={self.mu}): the energy is positive only for mu > 0 and lam + mu > 0; "
                "check the sign and the Poisson ratio"
            )

    @staticmethod
    def PlaneStrain(E, nu):
        """From Young's modulus E > 0 and Poisson's ratio -1 < nu < 1/2."""
        check_engineering_constants(E, nu, 0.5)
        return Elasticity(E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)))

    @staticmethod
    def PlaneStress(E, nu):
        """A thin plate, -1 < nu < 1: lam is replaced by E nu / (1 - nu²)."""
        check_engineering_constants(E, nu, 1)
        return Elasticity(E * nu / (1 - nu**2), E / (2 * (1 + nu)))

    @property
    def kappa(self):
        """Kolosov's constant: 3 - 4ν in plane strain, (3 - ν)/(1 + ν) in plane stress."""
        return (self.lam + 3 * self.mu) / (self.lam + self.mu)

    def Stress(self, strain):
        """The 2 × 2 stress of a 2 × 2 strain (a CoefficientFunction of NGSolve)."""
        return self.lam * Trace(strain) * Id(2) + 2 * self.mu * strain
