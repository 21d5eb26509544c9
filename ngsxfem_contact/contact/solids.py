"""What a contact problem of a body in space does not have yet, and how large it may be: refused by name, before any work."""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any, cast

from .. import _ngsxfem_contact as core
from ..protocols import LawAtNodes, check_role
from ..spaces.exchange import exchange_of
from .disk_friction import DiskFriction, FrictionByCrack
from .friction import Friction, Frictionless
from .nodal_law import LawByCrack
from .stabilisation import trait

if TYPE_CHECKING:
    from ..material import Isotropic
    from ..protocols import FaceLaw

MOST_UNKNOWNS, MOST_MULTIPLIERS = 200_000, 5_000  # a sparse factorisation takes minutes and 5 GB, dense algebra on the nodes 200 MB for each matrix
CG_PAYS = 30_000  # unknowns; below, direct solvers take seconds


@singledispatch
def check_supported(V: core.CrackFESpace, material: Isotropic, stabilisation: Any) -> None:
    """Raises ValueError for materials and stabilisations that there are not for a body; a plane one has all."""


@check_supported.register(core.SolidFESpace)
def check_solid(V: core.SolidFESpace, material: Isotropic, stabilisation: Any) -> None:
    """Raises ValueError for those that are there for plane bodies only."""
    if material.nearly_incompressible:
        raise ValueError(f"ContactProblem: {material} is nearly incompressible, which bodies in space cannot be yet; take nu <= 0.45")
    if stabilisation is not None and trait(stabilisation, "System") is not None:
        raise ValueError(f"ContactProblem: {stabilisation} is there for plane bodies only; take BarbosaHughes()")


@singledispatch
def law_in(V: core.CrackFESpace, law: FaceLaw) -> FaceLaw:
    """The law of the faces of a body with as many tangential components as it needs."""
    return law


@law_in.register(core.SolidFESpace)
def law_in_space(V: core.SolidFESpace, law: FaceLaw) -> FaceLaw:
    """That of sheets; raises ValueError for laws that are there for plane bodies only."""
    if isinstance(law, Frictionless):
        return law
    if isinstance(law, Friction):
        return DiskFriction(law)
    if isinstance(law, LawByCrack) and all(isinstance(own, Frictionless | Friction) for own in law.laws.values()):
        laws = {crack: own for crack, own in law.laws.items() if isinstance(own, Frictionless | Friction)}
        return DiskFriction(FrictionByCrack(laws)) if any(isinstance(own, Friction) for own in laws.values()) else Frictionless()
    raise ValueError(
        f"ContactProblem: the law {law} is there for plane bodies only; in space take None, Tresca(s) or Coulomb(mu_f), or a mapping of them, {{sheet: law}}"
    )


@singledispatch
def law_at_nodes(V: core.CrackFESpace, law: FaceLaw) -> FaceLaw:
    """The same law, holding node by node. Raises TypeError for one that does not."""
    check_role(law, LawAtNodes, "ContactProblem: parts of the body that only faces hold need a law with At(nodes); law", "a law such as Coulomb(mu_f)")
    return LawByCrack({}, cast(LawAtNodes, law))


@law_at_nodes.register(core.SolidFESpace)
def law_at_nodes_in_space(V: core.SolidFESpace, law: FaceLaw) -> FaceLaw:
    """Raises ValueError."""
    raise ValueError(
        "ContactProblem: in space a part of the body that only friction holds is not solved for: hold it by a support, or by soft springs in problem.a"
    )


@singledispatch
def check_size(V: core.CrackFESpace, W: Any, law: FaceLaw) -> None:
    """Raises ValueError for spaces that are too large for direct solvers; in the plane memory says so."""


@check_size.register(core.SolidFESpace)
def check_solid_size(V: core.SolidFESpace, W: Any, law: FaceLaw) -> None:
    """The same in space, where factors fill up."""
    N, m = size_of(V, W, law)
    if N > MOST_UNKNOWNS or m > MOST_MULTIPLIERS:
        raise ValueError(
            f"ContactProblem: {N} unknowns and {m} multipliers are too many for direct solvers, {MOST_UNKNOWNS} and {MOST_MULTIPLIERS} at most: "
            'take inverse="cg", which needs pyamg, or a coarser mesh away from the sheets'
        )


def size_of(V: Any, W: Any, law: FaceLaw) -> tuple[int, int]:
    """Unknowns and multipliers, of all components."""
    return exchange_of(V).Count(V.ndof), W.ndof * len(law.components)
