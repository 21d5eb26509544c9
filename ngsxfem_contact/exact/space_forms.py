"""Closed forms with a plane crack in space: displacements with gradients at points and as CoefficientFunctions, what acts on the faces, jumps, K along the front."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from ngsolve import CF, CoefficientFunction, Id, Trace, x, y, z

from ..material import Isotropic
from .jets import Jet

SIDES = {None: 0, "plus": 1, "minus": -1}
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

Components = Callable[[Any, Any], tuple[Any, ...]]


@dataclass(frozen=True)
class SpaceForm:
    """Exact fields without body force in the coordinates (X, Y, Z) of a crack in Z = 0, plus side Z > 0; `At` places it in space. Sums are superpositions.

    Parameters
    ----------
    material
        The material, λ_L and μ_L of space (those of plane strain).
    displacement
        (X, Y, Z, side) to three Jets of order 1; side: 0 by the sign of Z, ±1 on a face, where Z = 0.
    traction
        (X, Y) to the components of σn on the faces, the same on both.
    jump
        (X, Y) to the components of the jump of u, plus side - minus side, inside of the crack.
    factors
        (X, Y), arrays of points of the front, to K_I, K_II, K_III in the frame of `Front`: positive where the plus side moves along n, e₁, e₃.
    origin, axes
        Of the coordinates: (3,), and three unit vectors, the third one the normal.
    """

    material: Isotropic
    displacement: Callable[[Any, Any, Any, int], Sequence[Any]]
    traction: Components
    jump: Components = lambda X, Y: (0 * X, 0 * X, 0 * X)
    factors: Components = lambda X, Y: (0 * X, 0 * X, 0 * X)
    origin: tuple[float, ...] = (0.0, 0.0, 0.0)
    axes: tuple[tuple[float, ...], ...] = AXES

    def At(self, origin: Any, axes: Any = AXES) -> SpaceForm:
        """The same around another origin, with other orthonormal axes, (3, 3)."""
        return replace(self, origin=tuple(map(float, origin)), axes=tuple(tuple(map(float, axis)) for axis in axes))

    def __add__(self, other: SpaceForm) -> SpaceForm:
        if (self.origin, self.axes, self.material) != (other.origin, other.axes, other.material):
            raise ValueError("a sum of closed forms needs one material, one origin and the same axes; add them first, then place them")
        both = lambda f, g: lambda *at: tuple(a + b for a, b in zip(f(*at), g(*at)))
        return replace(
            self,
            displacement=both(self.displacement, other.displacement),
            traction=both(self.traction, other.traction),
            jump=both(self.jump, other.jump),
            factors=both(self.factors, other.factors),
        )

    def Displacement(self, points: Any, side: str | None = None) -> np.ndarray:
        """u (n, 3) at points (n, 3); on the faces that of the side "plus" or "minus"."""
        at = self._local(points)
        return np.stack([jet.value + 0 * at[0] for jet in self._jets(at, side)], axis=-1) @ np.array(self.axes)

    def DisplacementGradient(self, points: Any, side: str | None = None) -> np.ndarray:
        """∂_j u_i (n, 3, 3) at points (n, 3)."""
        at, A = self._local(points), np.array(self.axes)
        local = np.array([[slope + 0 * at[0] for slope in jet.slopes] for jet in self._jets(at, side)])
        return np.einsum("pi,pqn,qj->nij", A, local, A)

    def Stress(self, points: Any, side: str | None = None) -> np.ndarray:
        """σ (n, 3, 3) at points (n, 3)."""
        gradient = self.DisplacementGradient(points, side)
        strain = 0.5 * (gradient + gradient.swapaxes(1, 2))
        return 2 * self.material.mu * strain + self.material.lam * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3)

    def Factors(self, points: Any) -> np.ndarray:
        """K_I, K_II, K_III (n, 3) at points (n, 3) of the front."""
        X, Y, _ = self._local(points)
        return np.stack([K + 0 * X for K in self.factors(X, Y)], axis=-1)

    def Jump(self, points: Any) -> np.ndarray:
        """u on the plus side minus u on the minus side (n, 3), at points (n, 3) of the crack."""
        X, Y, _ = self._local(points)
        return np.stack([j + 0 * X for j in self.jump(X, Y)], axis=-1) @ np.array(self.axes)

    def _local(self, points: Any) -> list[np.ndarray]:
        return list(((np.atleast_2d(np.asarray(points, dtype=float)) - self.origin) @ np.array(self.axes).T).T)

    def Fields(self, side: str | None = None) -> tuple[CoefficientFunction, CoefficientFunction]:
        """u (3) and its gradient (3, 3); with a side those on a face."""
        at = self._coordinates()
        jets = self._jets(at, side)
        A = self.axes
        u = CF(tuple(sum(jets[p].value * A[p][i] for p in range(3)) for i in range(3)))
        slopes = [[CF(slope) for slope in jet.slopes] for jet in jets]
        rows = [sum(slopes[p][q] * (A[p][i] * A[q][j]) for p in range(3) for q in range(3)) for i in range(3) for j in range(3)]
        return u.Compile(), CF(tuple(rows), dims=(3, 3)).Compile()

    @property
    def u(self) -> CoefficientFunction:
        """The displacement."""
        return self.Fields()[0]

    @property
    def gradient(self) -> CoefficientFunction:
        """∂_j u_i."""
        return self.Fields()[1]

    @property
    def stress(self) -> CoefficientFunction:
        """σ (3, 3)."""
        gradient = self.gradient
        strain = 0.5 * (gradient + gradient.trans)
        return 2 * self.material.mu * strain + self.material.lam * Trace(strain) * Id(3)

    @property
    def face_traction(self) -> CoefficientFunction:
        """σn on the crack (3)."""
        return self._vector(self.traction)

    @property
    def pressure(self) -> CoefficientFunction:
        """σ_n on the crack, λ of a closed one."""
        return CF(self.traction(*self._coordinates()[:2])[2])

    @property
    def opening(self) -> CoefficientFunction:
        """The jump of u on the crack (3)."""
        return self._vector(self.jump)

    @property
    def gap(self) -> CoefficientFunction:
        """The normal jump on the crack."""
        return CF(self.jump(*self._coordinates()[:2])[2])

    def _vector(self, function: Components) -> CoefficientFunction:
        values = function(*self._coordinates()[:2])
        return CF(tuple(sum(values[p] * self.axes[p][i] for p in range(3)) for i in range(3)))

    def _coordinates(self) -> list[CoefficientFunction]:
        return [sum((c - o) * e for c, o, e in zip((x, y, z), self.origin, axis)) for axis in self.axes]

    def _jets(self, at: list[Any], side: str | None) -> list[Jet]:
        with np.errstate(divide="ignore", invalid="ignore"):
            return [jet if isinstance(jet, Jet) else Jet(jet, (0.0, 0.0, 0.0)) for jet in self.displacement(at[0], at[1], at[2], SIDES[side])]


def uniform_stress(material: Isotropic, stress: Any) -> SpaceForm:
    """A constant stress (3, 3) in the crack's axes: u is linear and does not jump. (3a) is that of compression, σ_zz = -p."""
    sigma = np.asarray(stress, dtype=float)
    lam, mu = material.lam, material.mu
    strain = (sigma - lam / (3 * lam + 2 * mu) * np.trace(sigma) * np.eye(3)) / (2 * mu)

    def displacement(X: Any, Y: Any, Z: Any, side: int) -> list[Any]:
        at = Jet.Variables(X, Y, Z)
        return [sum(float(strain[i, j]) * at[j] for j in range(3)) for i in range(3)]

    return SpaceForm(material, displacement, lambda X, Y: tuple(float(c) + 0 * X for c in sigma[2]))


def stress_matrix(zz: float = 0, xz: float = 0, yz: float = 0, xx: float = 0, yy: float = 0, xy: float = 0) -> np.ndarray:
    """The symmetric (3, 3) of six components."""
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=float)
