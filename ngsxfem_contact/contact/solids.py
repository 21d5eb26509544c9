"""What a contact problem of a body in space does not have yet, and how large it may be: refused by name, before any work."""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

from .. import _ngsxfem_contact as core
from .friction import Frictionless
from .stabilisation import trait

if TYPE_CHECKING:
    from ..material import Isotropic

MOST_UNKNOWNS, MOST_NODES = 200_000, 5_000  # a sparse factorisation takes minutes and 5 GB, dense algebra on the nodes 200 MB for each matrix


@singledispatch
def check_supported(V: core.CrackFESpace, material: Isotropic, stabilisation: Any, law: Any) -> None:
    """Raises ValueError for materials, stabilisations and laws that there are not for a body; a plane one has all."""


@check_supported.register(core.SolidFESpace)
def check_solid(V: core.SolidFESpace, material: Isotropic, stabilisation: Any, law: Any) -> None:
    """Raises ValueError for those that are there for plane bodies only."""
    if material.nearly_incompressible:
        raise ValueError(f"ContactProblem: {material} is nearly incompressible, which bodies in space cannot be yet; take nu <= 0.45")
    if stabilisation is not None and trait(stabilisation, "System") is not None:
        raise ValueError(f"ContactProblem: {stabilisation} is there for plane bodies only; take BarbosaHughes()")
    if law is not None and not isinstance(law, Frictionless):
        raise ValueError(f"ContactProblem: the law {law} is there for plane bodies only; contact in space is without friction")


@singledispatch
def check_size(V: core.CrackFESpace, W: Any) -> None:
    """Raises ValueError for spaces that are too large for direct solvers; in the plane memory says so."""


@check_size.register(core.SolidFESpace)
def check_solid_size(V: core.SolidFESpace, W: Any) -> None:
    """The same in space, where factors fill up."""
    N, m = V.ndof, W.ndof
    if N > MOST_UNKNOWNS or m > MOST_NODES:
        raise ValueError(
            f"ContactProblem: {N} unknowns and {m} multipliers are too many for the direct solvers that bodies in space have so far, "
            f"{MOST_UNKNOWNS} and {MOST_NODES} at most: take a coarser mesh away from the sheets, or larger elements"
        )
