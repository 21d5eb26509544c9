"""Fields around a front in its frame (e₁, e₂, e₃): the modes I, II, III as auxiliary fields, and what is read from a displacement.

The auxiliary fields are b = U_i(x₁, x₂) e_i(s), U the fields of unit K of a straight front: displacements with their true gradients, whose stresses are not
in equilibrium where the front is curved. With κ̃ = κ/(1 + κ x₁), e₁' = κ e₃, e₃' = -κ e₁, section 14 of docs/method.md:

    ∇b = ∂_j U_i e_i ⊗ e_j + κ̃ (U₁ e₃ - U₃ e₁) ⊗ e₃.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF, CoefficientFunction

from ..arguments import check_function
from .tip_fields import SIDE

if TYPE_CHECKING:
    from ..material import Elasticity


@dataclass
class FrontField:
    """What an integral around a front reads of a solution: CoefficientFunctions.

    Parameters
    ----------
    gradient
        ∂_j u_i (3, 3) inside of the body.
    faces
        The same on the faces, by "plus" and "minus"; default gradient: for a function without a jump.
    traction
        (3), σn on the faces by "plus" and "minus", of the whole stress, n the sheet's normal. Default: none.
    pressure
        λ ≤ 0 on the faces where they may touch: K_I is 0 where they press on each other.
    doubt
        (3), by how much the traction may be off.
    body_force
        (3), force for each unit of volume.
    given
        (3, 3), a stress σ⁰ in σ = C:ε + σ⁰.
    given_change
        Its derivatives by x, y, z, three of (3, 3); default: it is constant.
    reach
        How far from the front the gradient is accurate, a length: tubes keep within it, if it is more than an element and a half. Default: everywhere.

    Raises
    ------
    TypeError, ValueError
        For what are no functions with as many components, and for other sides.
    """

    gradient: CoefficientFunction
    faces: dict[str, CoefficientFunction] | None = None
    traction: dict[str, CoefficientFunction] = field(default_factory=dict)
    pressure: CoefficientFunction | None = None
    doubt: CoefficientFunction | None = None
    body_force: CoefficientFunction | None = None
    given: CoefficientFunction | None = None
    given_change: tuple[CoefficientFunction, ...] | None = None
    reach: float | None = None

    def __post_init__(self) -> None:
        for name, dim in (("gradient", 9), ("pressure", 1), ("doubt", 3), ("body_force", 3), ("given", 9)):
            if getattr(self, name) is not None:
                check_function(getattr(self, name), f"FrontField: {name}", dim)
        for name, sides, dim in (("faces", self.faces, 9), ("traction", self.traction, 3)):
            if sides and sides.keys() != SIDE.keys():
                raise ValueError(f"FrontField: {name} has the keys {list(sides)}; give both sides, {list(SIDE)}")
            for side, function in (sides or {}).items():
                check_function(function, f"FrontField: {name}[{side!r}]", dim)
        if self.given_change is not None and len(self.given_change) != 3:
            raise ValueError(f"FrontField: given_change has {len(self.given_change)} parts; give the derivatives by x, y and z")
        for part in self.given_change or ():
            check_function(part, "FrontField: given_change", 9)

    def OnFace(self, side: str) -> CoefficientFunction:
        """∂_j u_i on a face.

        Parameters
        ----------
        side : str
            "plus" or "minus".
        """
        return self.gradient if self.faces is None else self.faces[side]


@dataclass
class LocalField:
    """Arrays at n points in the frames there: gradient, stress C:ε and given stress (n, 3, 3), body force (n, 3), derivative of the given stress along e₁ (n, 3, 3)."""

    gradient: np.ndarray
    stress: np.ndarray
    force: np.ndarray
    given: np.ndarray
    given_ahead: np.ndarray

    @property
    def whole(self) -> np.ndarray:
        """The stress with the given one."""
        return self.stress + self.given

    @property
    def ahead(self) -> np.ndarray:
        """∂₁ of the displacement, (n, 3)."""
        return self.gradient[:, :, 0]

    @staticmethod
    def Of(material: Elasticity, gradient: np.ndarray, force: np.ndarray | None = None) -> LocalField:
        """Without given stress."""
        zero = np.zeros_like(gradient)
        return LocalField(gradient, stress_of(material, gradient), zero[:, 0] if force is None else force, zero, zero)


def stress_of(material: Elasticity, gradient: np.ndarray) -> np.ndarray:
    """C:ε, (n, 3, 3)."""
    trace = np.trace(gradient, axis1=1, axis2=2)[:, None, None]
    return material.mu * (gradient + gradient.swapaxes(1, 2)) + material.lam * trace * np.eye(3)


def local_field(field: FrontField, material: Elasticity, points: Any, frames: np.ndarray, side: str | None = None) -> LocalField:
    """Of a FrontField at mesh points, on a face with a side."""
    turned = lambda tensor: np.einsum("npi,nij,nqj->npq", frames, tensor.reshape(-1, 3, 3), frames)
    evaluated = lambda f: np.asarray(CF(f)(points), dtype=float)
    gradient = turned(evaluated(field.gradient if side is None else field.OnFace(side)))
    found = LocalField.Of(material, gradient)
    if field.body_force is not None:
        found.force = np.einsum("npi,ni->np", frames, evaluated(field.body_force))
    if field.given is not None:
        found.given = turned(evaluated(field.given))
    if field.given_change is not None:
        change = np.stack([evaluated(part).reshape(-1, 3, 3) for part in field.given_change])
        found.given_ahead = turned(np.einsum("ni,inpq->npq", frames[:, 0], change))
    return found


def modes(material: Elasticity, r: np.ndarray, theta: np.ndarray, kappa: np.ndarray, kappa_change: np.ndarray) -> list[LocalField]:
    """The auxiliary fields of unit K_I, K_II, K_III at points around a front, with the body force -div σ that they would need.

    Parameters
    ----------
    r, theta
        (n,), θ = ±π on the faces.
    kappa, kappa_change
        The front's curvature κ and κ'(s), (n,).
    """
    lam, mu = material.lam, material.mu
    c, s = np.cos(0.5 * theta), np.sin(0.5 * theta)
    on_face = np.abs(theta) == np.pi
    c = np.where(on_face, 0.0, c)
    cos, sin = np.where(on_face, -1.0, np.cos(theta)), np.where(on_face, 0.0, np.sin(theta))
    h3 = 1 + kappa * r * cos
    turn, turn_change = kappa / h3, kappa_change / h3**3  # κ̃ and its derivative by arc length
    scale, zero = 1 / (2 * mu * np.sqrt(2 * np.pi)), 0 * r
    root = np.sqrt(r)

    def along(g: np.ndarray, dg: np.ndarray) -> tuple[np.ndarray, ...]:
        """U, ∂₁U, ∂₂U of √r g(θ)."""
        return scale * root * g, scale / root * (0.5 * cos * g - sin * dg), scale / root * (0.5 * sin * g + cos * dg)

    fields = []
    for (g1, g2), (dg1, dg2) in angular_functions(material.kappa, c, s):
        (U1, U11, U12), (_, U21, U22) = along(g1, dg1), along(g2, dg2)
        gradient = matrices([[U11, U12, zero], [U21, U22, zero], [zero, zero, turn * U1]])
        shear = mu * (U12 + U21)
        divergence = [lam * turn * (U11 - turn * U1) + 2 * mu * turn * (U11 - turn * U1), lam * turn * U12 + turn * shear, (lam + 2 * mu) * turn_change * U1]
        fields.append(LocalField.Of(material, gradient, -np.stack(divergence, axis=-1)))
    U3, U31, U32 = along(4 * s, 2 * c)
    gradient = matrices([[zero, zero, -turn * U3], [zero, zero, zero], [U31, U32, zero]])
    divergence = [-mu * turn_change * U3, zero, mu * turn * (U31 - turn * U3)]
    fields.append(LocalField.Of(material, gradient, -np.stack(divergence, axis=-1)))
    return fields


def matrices(rows: list[list[np.ndarray]]) -> np.ndarray:
    """(n, 3, 3) of nine arrays (n,)."""
    return np.moveaxis(np.array(rows), -1, 0)


def angular_functions(kappa: float, c: Any, s: Any) -> tuple[tuple[tuple[Any, Any], tuple[Any, Any]], ...]:
    """g(θ) and g'(θ), components ahead and to the left, of the two modes √r g, c = cos(θ/2), s = sin(θ/2): arrays or CoefficientFunctions."""
    first = (c * (kappa - 1 + 2 * s * s), s * (kappa + 1 - 2 * c * c))
    d_first = (s * (-0.5 * (kappa - 1) - s * s + 2 * c * c), c * (0.5 * (kappa + 1) - c * c + 2 * s * s))
    second = (s * (kappa + 1 + 2 * c * c), -c * (kappa - 1 - 2 * s * s))
    d_second = (c * (0.5 * (kappa + 1) + c * c - 2 * s * s), s * (0.5 * (kappa - 1) - s * s + 2 * c * c))
    return (first, d_first), (second, d_second)
