"""One-sided values, jumps, strains and stresses on a crack. The sign conventions of the package live here.

The unit normal n points to the left of the crack's direction of travel t, from its minus to its plus side;
jump(v) = v⁺ - v⁻; the gap g_n = jump(u)·n is ≥ 0 where the crack is open; the slip is g_t = jump(u)·t;
σ_n = n·σn ≤ 0 is compression. [AHLMR12] writes ⟦u_n⟧ = u⁺·n⁺ + u⁻·n⁻, which is -g_n.

Other Parameters
----------------
u : trial function, test function or GridFunction
    Of a CrackFESpace.
body : CrackedMesh
    The body of the cracks.
stress : CoefficientFunction
    A 2 × 2 matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from ngsolve import BND, CF, Cross, FacetFESpace, Grad, GridFunction, IfPos, InnerProduct, Norm, Sym, specialcf

from ._ngsxfem_contact import Variation
from .points import points_into

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction, Mesh

    from ._ngsxfem_contact import CrackedMesh

__all__ = ["Gradient", "Jump", "Minus", "NormalGap", "NormalStress", "OutwardNormal", "Plus", "Slip", "Strain", "TangentialStress", "Variation"]

SIDES = ("plus", "minus", "larger")


def Plus(u: CoefficientFunction) -> CoefficientFunction:
    """The limit u⁺ on the crack, a vector with 2 components."""
    return u.Operator("plus")


def Minus(u: CoefficientFunction) -> CoefficientFunction:
    """The limit u⁻ on the crack, a vector with 2 components."""
    return u.Operator("minus")


def Jump(u: CoefficientFunction) -> CoefficientFunction:
    """The jump u⁺ - u⁻ on the crack, a vector with 2 components."""
    return u.Operator("jump")


def Gradient(u: CoefficientFunction, side: str | None = None) -> CoefficientFunction:
    """The 2 × 2 matrix ∂_j u_i.

    Parameters
    ----------
    side
        None (default), by the position of the point; on the crack "plus", "minus", or "larger": from the polynomial of the larger part of the element, as
        in R_h of (12) of [AHLMR12].

    Returns
    -------
    CoefficientFunction
        A 2 × 2 matrix.

    Raises
    ------
    ValueError
        For another side.
    """
    if side is None:
        return Grad(u)
    if side not in SIDES:
        raise ValueError(f"side={side!r} is not one of {SIDES} (or None: by the position of the point)")
    return u.Operator("grad" + side)


def Strain(u: CoefficientFunction, side: str | None = None) -> CoefficientFunction:
    """ε(u) = ½(∇u + ∇uᵀ), a 2 × 2 matrix.

    Parameters
    ----------
    side : str or None
        As for Gradient.

    Returns
    -------
    CoefficientFunction
        A 2 × 2 matrix.
    """
    return Sym(Gradient(u, side))


def NormalGap(u: CoefficientFunction, body: CrackedMesh) -> CoefficientFunction:
    """The normal gap g_n = jump(u)·n, a length; negative: interpenetration. [AHLMR12] writes -⟦u_n⟧."""
    return InnerProduct(Jump(u), body.normal)


def Slip(u: CoefficientFunction, body: CrackedMesh) -> CoefficientFunction:
    """The slip g_t = jump(u)·t, a length: the plus side moves along t by g_t more than the minus side."""
    return InnerProduct(Jump(u), body.tangent)


def NormalStress(stress: CoefficientFunction, body: CrackedMesh) -> CoefficientFunction:
    """σ_n = n·σn of a stress on the crack; ≤ 0 in compression."""
    return InnerProduct(stress * body.normal, body.normal)


def TangentialStress(stress: CoefficientFunction, body: CrackedMesh) -> CoefficientFunction:
    """σ_t = t·σn of a stress on the crack."""
    return InnerProduct(stress * body.normal, body.tangent)


def OutwardNormal(mesh: Mesh) -> CoefficientFunction:
    """The unit normal on ∂Ω that points out of the body.

    NGSolve's own, `specialcf.normal`, has the side that the elements of the boundary were numbered for: at holes, and in bodies that were mirrored or
    subtracted, it may point into the body.

    Parameters
    ----------
    mesh : Mesh
        Of the body, `body.mesh`.

    Returns
    -------
    CoefficientFunction
        A vector, for the boundary only. On boundaries inside of the body, between two regions, it has the side that the numbers give.
    """
    J = specialcf.JacobianMatrix(mesh.dim, mesh.dim - 1)
    across = CF((J[1], -J[0])) if mesh.dim == 2 else Cross(*(CF(tuple(J[i, k] for i in range(3))) for k in range(2)))
    side = GridFunction(FacetFESpace(mesh, order=0))  # which a file of a refined mesh can hold, unlike functions that live on the boundary alone
    for element, into in zip(mesh.Elements(BND), points_into(mesh, across)):
        side.vec[side.space.GetDofNrs(element)[0]] = -1 if into else 1
    return side / Norm(across) * across


@dataclass(frozen=True)
class Component:
    """One direction(body) on the crack: jump(u, body) of the displacement and traction(stress, body), its work conjugate."""

    jump: Callable[[Any, CrackedMesh], CoefficientFunction]
    traction: Callable[[CoefficientFunction, CrackedMesh], CoefficientFunction]
    direction: Callable[[CrackedMesh], CoefficientFunction]


NORMAL = Component(NormalGap, NormalStress, lambda body: body.normal)
TANGENTIAL = Component(Slip, TangentialStress, lambda body: body.tangent)


def on_crack(body: CrackedMesh, number: int) -> CoefficientFunction:
    """Positive on the crack of a number, negative on the others, for IfPos."""
    return 0.25 - (body.crack_number - number) ** 2


def SheetTangent(body: Any, number: int) -> CoefficientFunction:
    """The unit vector a_1 (number 0) or a_2 (1) of the plane of the sheet on which a point lies, of a curved one that along p_1 or p_2; body: a CrackedSolid."""
    curved = body.tangent if number == 0 else Cross(body.normal, body.tangent)
    vectors = [CF(tuple(sheet.axes[number])) if sheet.planar else curved for sheet in body.cracks]
    tangent = vectors[0]
    for sheet, vector in enumerate(vectors[1:], 1):
        tangent = IfPos(on_crack(body, sheet), vector, tangent)
    return tangent


def in_sheet(number: int) -> Component:
    """That along a tangent of the sheets."""
    tangent = partial(SheetTangent, number=number)
    return Component(lambda u, body: InnerProduct(Jump(u), tangent(body)), lambda stress, body: InnerProduct(stress * body.normal, tangent(body)), tangent)


FIRST_TANGENTIAL, SECOND_TANGENTIAL = in_sheet(0), in_sheet(1)
