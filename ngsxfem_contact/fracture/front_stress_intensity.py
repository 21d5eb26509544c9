"""K_I, K_II, K_III and G along the fronts of a solid: section 14 of docs/method.md.

I(u, mode) = 2K/E' for modes I and II, K/μ for mode III, I(u,u) = 2G.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from .._ngsxfem_contact import CrackedSolid
from ..arguments import check_item, check_positive, check_type, check_whole
from ..share import AROUND
from ..tables import Table
from .curved_front import CurvedFrontIntegrals
from .front_fields import FrontField
from .front_integral import FrontIntegrals
from .front_tube import FrontCurve, Hats, Room, TubeRule

if TYPE_CHECKING:
    from ..material import Elasticity, Isotropic

RADII = (1, 0.75, 0.5)  # of the tubes that are compared, relative to the largest
LARGEST, LEAST = AROUND, 1  # radius over h
WORTH = 1.5  # reach over h, from which on tubes keep within it
SPACING = 2  # between nodes, over h
SPREAD, ROUGH = 3, 2  # times the change over radii, and that by smoothing: found by benchmarks/fronts.py
NAMES = ("K_I", "K_II", "K_III")
COLUMNS = ("front", "s", "x", "y", "z", *NAMES, *(f"{name}_error" for name in NAMES), "G", "G_error", "irwin")


@dataclass(eq=False)
class FrontFactors:
    """K_I, K_II, K_III in stress × √length and G in energy for each unit of area, (n,) each, at nodes along a front.

    K_I > 0 opens; for K_II, K_III > 0 the plus side moves along e₁, e₃ of `Front`.

    Attributes
    ----------
    front
        A number in the `fronts` of its CrackedSolid, body.
    s
        (n,), of the nodes, as `Front.PointAt` has it: arc lengths, of a sheet with heights those of the projection onto the plane.
    points
        (n, 3).
    G
        Of the J-integral, ½ I(u,u).
    irwin
        (K_I² + K_II²)/E' + K_III²/(2μ).
    errors
        (n, 3), what K_I, K_II, K_III may be off, the largest of: three times the change over `radii`; twice the difference from parabolas through five nodes, the
        largest of three neighbours; what a doubtful traction of the faces makes.
    G_error
        (n,), in the same way, or the difference from irwin.
    by_radius
        (number of radii, n, 4): K_I, K_II, K_III, G of each of the `radii`.
    """

    body: CrackedSolid = field(repr=False)
    front: int
    s: np.ndarray
    points: np.ndarray
    K_I: np.ndarray
    K_II: np.ndarray
    K_III: np.ndarray
    G: np.ndarray
    irwin: np.ndarray
    errors: np.ndarray
    G_error: np.ndarray
    radii: tuple[float, ...]
    by_radius: np.ndarray = field(repr=False)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Those of the table, by their names."""
        columns = {"front": np.full(len(self.s), self.front), "s": self.s, **dict(zip("xyz", self.points.T))}
        columns |= {name: getattr(self, name) for name in NAMES} | {f"{name}_error": error for name, error in zip(NAMES, self.errors.T)}
        return columns | {"G": self.G, "G_error": self.G_error, "irwin": self.irwin}

    @property
    def table(self) -> Table:
        """A Table with a row for each node: s, x, y, z, K_I, K_II, K_III and their errors, G, its error, and Irwin's value."""
        return Table.Of(self.columns)


def front_factors(
    body: CrackedSolid, u: FrontField, material: Isotropic, front: int = 0, radius: float | None = None, nodes: int | None = None, rule: TubeRule | None = None
) -> FrontFactors:
    """K and G along a front of `body.fronts` by the interaction integral over tubes.

    Parameters
    ----------
    body
        The CrackedSolid.
    u
        What is known of the displacement, and what acts.
    material
        λ_L, μ_L of space.
    front
        A number in `body.fronts`.
    radius
        Of the largest tube; default four elements, or as far as u reaches, less where there is no room.
    nodes
        Into how many intervals, at least 5, each part of the front between corners is divided; default one for two elements. At their ends are the nodes.
    rule
        Of quadrature.

    Raises
    ------
    ValueError
        If the tube leaves the body or the material, meets another front or sheet or itself, with the place, or has less than one element in its radius; for
        fields that are not finite.
    TypeError
        For other arguments.

    Notes
    -----
    h is the longest edge of an element that holds the front, the mean of them. On a front that ends on ∂Ω, or has corners, nodes are where discs normal to it
    have room; at ends K as such does not exist in general (the corner's singularity is another one), so that values there are those of the domains before it.
    """
    check_type(body, CrackedSolid, "front_factors: body", "a body in space; build one by CrackedMesh(mesh, sheet, ...)")
    check_type(u, FrontField, "front_factors: u", "a FrontField")
    check_item(front, body.fronts, "front", "body.fronts")
    if getattr(material, "form", "") == "plane stress":
        raise ValueError("front_factors: the material is one of plane stress; in space give Lamé's coefficients, as Elasticity.Solid(E, nu) has them")
    curve = FrontCurve(body, front)
    h = curve.h
    if radius is not None:
        check_positive(radius, f"front_factors: radius at front {front}")
    if nodes is not None:
        check_whole(nodes, "front_factors: nodes", 5)
    if rule is not None:
        check_type(rule, TubeRule, "front_factors: rule", "a TubeRule")
    radius, stretches = _room(curve, Room(curve, material), h, radius, LARGEST * h if u.reach is None or u.reach < WORTH * h else min(LARGEST * h, u.reach))
    parts = []
    for start, end in stretches:
        least = 12 if curve.closed else 4
        hats = Hats(start, end, nodes or max(least, round((end - start) / (SPACING * h))), curve.closed)
        here = material.At(body.mesh, tuple(curve.Points(np.array([0.5 * (start + end)]))[0]))
        parts.append(_on_stretch(curve, here, u, hats, tuple(part * radius for part in RADII), rule or TubeRule(), h))
    s = curve.Inside(np.concatenate([part.s for part in parts]))
    K, values, errors, irwin = (np.concatenate([getattr(part, name) for part in parts], axis=axis) for name, axis in _Found.arrays)
    G, (K_I, K_II, K_III) = values[0, :, 3], K.T
    G_error = np.maximum(errors[:, 3], np.abs(G - irwin))
    return FrontFactors(body, front, s, curve.Points(s), K_I, K_II, K_III, G, irwin, errors[:, :3], G_error, tuple(part * radius for part in RADII), values)


def _room(curve: FrontCurve, room: Room, h: float, given: float | None, usual: float) -> tuple[float, list[tuple[float, float]]]:
    """The radius, and the stretches of the front around which such a tube has room."""
    radius = given or usual
    while True:
        found = [room.Stretch(start, end, radius, h) for start, end in curve.Parts()]
        met = [part for part in found if isinstance(part, str)]
        if not met and radius >= LEAST * h:
            return radius, [part for part in found if not isinstance(part, str)]
        if given is not None or 0.85 * radius < LEAST * h:
            break
        radius *= 0.85
    smaller = 0.85 * radius >= LEAST * h
    remedy = "choose a smaller radius or refine" if smaller else f"a tube needs {LEAST * h:.4g}, an element: refine the mesh there"
    what = f"meets {met[0]}; {remedy}" if met else f"is narrower than an element (h = {h:.4g}); refine the mesh there"
    raise ValueError(f"front_factors: the tube of radius {radius:.4g} around front {curve.number} {what}")


@dataclass
class _Found:
    """On a stretch: s and K (n, 3) of n nodes, values (number of radii, n, 4), errors (n, 4), irwin (n,)."""

    arrays = (("K", 0), ("values", 1), ("errors", 0), ("irwin", 0))

    s: np.ndarray
    K: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    irwin: np.ndarray


def _on_stretch(curve: FrontCurve, material: Elasticity, u: FrontField, hats: Hats, radii: tuple[float, ...], rule: TubeRule, h: float) -> _Found:
    integrals = (FrontIntegrals if curve.sheet.planar else CurvedFrontIntegrals)(curve, material, u, hats, radii, rule)
    scale = np.array([0.5 * material.E_prime, 0.5 * material.E_prime, material.mu, 0.5])
    moments = integrals() * scale
    if not np.isfinite(moments).all():
        raise ValueError(f"front_factors: the fields around front {curve.number} are not finite everywhere in the tube of radius {radii[0]:.4g}")
    speed = curve.Speeds(hats.nodes)[:, None]
    values = np.stack([hats.Values(of_radius) / speed for of_radius in moments])
    doubt, pressed = integrals.Doubt() * scale[:3] / (hats.weights[:, None] * speed), integrals.Pressed(h)
    rough = hats.Largest(np.abs(hats.Values(moments[0], 5) / speed - values[0]))
    errors = np.maximum(SPREAD * np.ptp(values, axis=0), ROUGH * rough)
    errors[:, :3] = np.maximum(errors[:, :3], doubt)
    K = values[0, :, :3].copy()
    K[pressed, 0], errors[pressed, 0] = 0, 0
    irwin = (K[:, 0] ** 2 + K[:, 1] ** 2) / material.E_prime + K[:, 2] ** 2 / (2 * material.mu)
    return _Found(hats.nodes, K, values, errors, irwin)
