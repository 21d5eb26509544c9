"""Coordinates at a tip, the weight q of domain integrals, and the gradients of the two modes of docs/method.md, section 3."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BND, CF, IfPos, sqrt, x, y

from .. import _ngsxfem_contact as core
from ..spaces.tip_disk import check_off_interface, distance_to_others

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction, Mesh

    from .._ngsxfem_contact import CrackedMesh
    from ..material import Isotropic

SIDE = {"plus": 1, "minus": -1}


class TipFrame:
    """Coordinates X, Y, r at a tip of `body.tips`, X ahead; θ = ±π on the lips, at the tip and along the crack as it bends."""

    def __init__(self, body: CrackedMesh, number: int) -> None:
        self.body, self.tip = body, body.tips[number]
        self.crack = body.cracks[self.tip.crack]
        a, b = self.tip.ahead
        self.ahead, self.left = CF((a, b)), CF((-b, a))
        dx, dy = x - self.tip.point[0], y - self.tip.point[1]
        self.X, self.Y = a * dx + b * dy, a * dy - b * dx
        self.r = sqrt(self.X**2 + self.Y**2 + 1e-200)
        self.orientation = 1 if self.tip.s > 0 else -1  # the sign of θ on the plus side

    @property
    def h(self) -> float:
        """The longest edge of the largest element that carries the tip."""
        at_tip = lambda location: min(abs(s - self.tip.s) for s in location.arclength) <= 1e-9 * self.crack.length
        return max(location.h for location in self.body.Elements(self.tip.crack) if at_tip(location))

    def Weight(self, radius: float) -> CoefficientFunction:
        """q = 1 - t³ (10 - 15 t + 6 t²), t = r/radius: 1 at the tip, 0 for r ≥ radius, C²."""
        t = self.r / radius
        return IfPos(1 - t, 1 - t**3 * (10 - 15 * t + 6 * t**2), 0)

    def WeightGradient(self, radius: float) -> CoefficientFunction:
        """∇q."""
        t = self.r / radius
        return IfPos(1 - t, -30 * t * (1 - t) ** 2 / radius**2, 0) * (self.X * self.ahead + self.Y * self.left)

    def ModeGradients(self, material: Isotropic, side: str | None = None) -> list[CoefficientFunction]:
        """∂_j u_i of the fields of unit K_I and of unit K_II; side: None by position, or "plus", "minus" of the crack."""
        tip, number = self.tip, 0 if side is None else SIDE[side]
        return [core.TipModeGradient(self.crack, tip.point, tip.ahead, self.orientation, number, mode, material.kappa, material.mu) for mode in range(2)]

    def _matrix(self, rows: list[CoefficientFunction]) -> CoefficientFunction:
        """The gradient of a displacement whose components ahead and to the left have these gradients."""
        a, b = self.ahead, self.left
        return CF(tuple(a[i] * rows[0][j] + b[i] * rows[1][j] for i in range(2) for j in range(2)), dims=(2, 2))

    def PointForceGradient(self, material: Isotropic) -> CoefficientFunction:
        """∂_j u_i under a unit force ahead in the tip, the crack on θ = ±π: σ_rr = -cos θ / (π r) and no other stress.

        It has one value on both lips.

        References
        ----------
        Cardew, Goldthorpe, Howard, Kfouri (1984).
        """
        cos, sin, r = self.X / self.r, self.Y / self.r, self.r
        scale, kappa = 1 / (4 * pi * material.mu), material.kappa
        along_r = (-0.5 * (kappa + 1) / r, 0 * r)
        across = (-2 * sin * cos / r, (cos**2 - sin**2 - 0.5 * (kappa - 1)) / r)  # ∂_θ / r
        rows = [scale * ((cos * dr - sin * dt) * self.ahead + (sin * dr + cos * dt) * self.left) for dr, dt in zip(along_r, across)]
        return self._matrix(rows)

    def Clearance(self, material: Isotropic | None = None, obstacles: list[tuple[float, str]] | tuple[()] = ()) -> tuple[float, str]:
        """(distance, what is there): of ∂Ω, other cracks, the crack's other end, and parts of it that bend ahead of the tip.

        Domains of integrals may hold kinks, and reach farther than half the way to other tips: they have more room than disks of functions.

        Parameters
        ----------
        material
            With that of several regions also of the regions that are not of the tip's material.
        obstacles
            Further pairs (distance, what).
        """
        point, crack = np.array(self.tip.point), self.crack
        to_others = distance_to_others(self.body.mesh, point, material)
        check_off_interface(self.tip, to_others)
        found = [*self.tip.distances, *obstacles, (to_others, "another material")]
        path = np.array([crack.PointAt(s) for s in np.linspace(0, crack.length, 500)]) - point
        distance = np.hypot(*path.T)
        found.append((distance[0 if self.tip.s > 0 else -1], "the crack's other end"))
        bent = path @ self.tip.ahead > 1e-9 * crack.length
        if bent.any():
            found.append((distance[bent].min(), "a part of the same crack"))
        return min(found)


def boundary_segments(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Their two ends, (n, 2) each, without those of inner interfaces."""
    outer = [el for el in mesh.Elements(BND) if len(mesh[el.edges[0]].elements) == 1]
    return tuple(np.array([mesh[el.vertices[i]].point for el in outer]) for i in range(2))


def distance_along(a: np.ndarray, b: np.ndarray, point: np.ndarray, direction: np.ndarray) -> float:
    """From a point in a direction of unit length to the first of the segments from a to b, (n, 2) each; infinity if it meets none."""
    side = b - a
    across = direction[0] * side[:, 1] - direction[1] * side[:, 0]
    across = np.where(across == 0, np.nan, across)
    start = a - point
    way = (start[:, 0] * side[:, 1] - start[:, 1] * side[:, 0]) / across
    share = (start[:, 0] * direction[1] - start[:, 1] * direction[0]) / across
    return way[(way > 0) & (share >= -1e-12) & (share <= 1 + 1e-12)].min(initial=np.inf)
