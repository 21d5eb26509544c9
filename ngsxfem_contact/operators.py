"""One-sided values, jumps, strains and stresses on a crack. The sign conventions of the package live here.

The unit normal n points to the left of the crack's direction of travel t, from its minus to its plus side;
jump(v) = v⁺ - v⁻; the gap g_n = jump(u)·n is ≥ 0 where the crack is open; the slip is g_t = jump(u)·t;
σ_n = n·σn ≤ 0 is compression. [AHLMR12] writes ⟦u_n⟧ = u⁺·n⁺ + u⁻·n⁻, which is -g_n.
"""

from collections.abc import Callable
from dataclasses import dataclass

from ngsolve import Grad, InnerProduct, Sym

SIDES = ("plus", "minus", "larger")


def Plus(u):
    """The limit u⁺ on the crack.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.

    Returns
    -------
    CoefficientFunction
        A vector with 2 components.
    """
    return u.Operator("plus")


def Minus(u):
    """The limit u⁻ on the crack.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.

    Returns
    -------
    CoefficientFunction
        A vector with 2 components.
    """
    return u.Operator("minus")


def Jump(u):
    """The jump u⁺ - u⁻ on the crack.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.

    Returns
    -------
    CoefficientFunction
        A vector with 2 components.
    """
    return u.Operator("jump")


def Gradient(u, side=None):
    """The 2 × 2 matrix ∂_j u_i.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.
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


def Strain(u, side=None):
    """ε(u) = ½(∇u + ∇uᵀ), a 2 × 2 matrix.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.
    side : str or None
        As for Gradient.

    Returns
    -------
    CoefficientFunction
        A 2 × 2 matrix.
    """
    return Sym(Gradient(u, side))


def NormalGap(u, body):
    """The normal gap g_n = jump(u)·n; negative: interpenetration. [AHLMR12] writes -⟦u_n⟧.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.
    body : CrackedMesh
        The body of the cracks.

    Returns
    -------
    CoefficientFunction
        In the user's unit of length.
    """
    return InnerProduct(Jump(u), body.normal)


def Slip(u, body):
    """The slip g_t = jump(u)·t: the plus side moves along t by g_t more than the minus side.

    Parameters
    ----------
    u : trial function, test function or GridFunction
        Of a CrackFESpace.
    body : CrackedMesh
        The body of the cracks.

    Returns
    -------
    CoefficientFunction
        In the user's unit of length.
    """
    return InnerProduct(Jump(u), body.tangent)


def NormalStress(stress, body):
    """σ_n = n·σn of a stress on the crack; ≤ 0 in compression.

    Parameters
    ----------
    stress : CoefficientFunction
        A 2 × 2 matrix.
    body : CrackedMesh
        The body of the cracks.

    Returns
    -------
    CoefficientFunction
        In the unit of the stress.
    """
    return InnerProduct(stress * body.normal, body.normal)


def TangentialStress(stress, body):
    """σ_t = t·σn of a stress on the crack.

    Parameters
    ----------
    stress : CoefficientFunction
        A 2 × 2 matrix.
    body : CrackedMesh
        The body of the cracks.

    Returns
    -------
    CoefficientFunction
        In the unit of the stress.
    """
    return InnerProduct(stress * body.normal, body.tangent)


@dataclass(frozen=True)
class Component:
    """One direction(body) on the crack: jump(u, body) of the displacement and traction(stress, body), its work conjugate."""

    jump: Callable
    traction: Callable
    direction: Callable


NORMAL = Component(NormalGap, NormalStress, lambda body: body.normal)
TANGENTIAL = Component(Slip, TangentialStress, lambda body: body.tangent)
