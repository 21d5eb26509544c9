"""V_h of a body in space: section 15 of docs/method.md."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _ngsxfem_contact as core
from ..arguments import check_number, check_regions, check_type, check_whole
from ..description import Described, numbered
from ..errors import warn
from ..material import Elasticity, Isotropic, check_form
from ..share import share_in
from .flags import check_flags, joined_names
from .resolution import size_at_front, warn_of_coarse_sheets, warn_of_thin_ligaments

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackedSolid, FrontDemand
    from ..description import Lines

INFINITY = float("inf")
REACH = 2  # elements, of the modes of order 1 around planar sheets
UNKNOWN = Elasticity.Solid(E=2.6, nu=0.3)  # μ = 1: the modes of a front until its material is known


@dataclass(frozen=True)
class FrontEnrichment:
    """φ_i v_m around fronts: hats times the vector modes of unit K_I, K_II and K_III, three unknowns for each node.

    The nodes are those of the elements that a front is in, or touches, and those nearer than a radius.

    Parameters
    ----------
    radius
        A length: nodes nearer to a front have modes, too; 0 for none of these. Default: of order 1 two elements (the longest edges of those that hold a front, their mean, at the
        front where they are shortest), which halves the error of K; 0 of order 2, and where a sheet is curved.
    material
        An Elasticity (or Elasticity.ByRegion), whose modes are taken. Default: that of CrackFESpace(material=...), else of the ContactProblem that is made of the space.
    rules
        A FrontDemand: the rules in the elements around fronts; default FrontDemand(), good to 5e-3 of the energy around a front.

    Raises
    ------
    TypeError, ValueError
        For what is none of these, and a radius that is negative or not finite.
    """

    radius: float | None = None
    material: Isotropic | None = None
    rules: FrontDemand | None = None

    def __post_init__(self) -> None:
        if self.radius is not None:
            check_number(self.radius, "FrontEnrichment: radius", lambda radius: 0 <= radius < INFINITY, "be 0 or positive, and finite")
        check_type(self.material, Isotropic | None, "FrontEnrichment: material", "an Elasticity")
        check_type(self.rules, core.FrontDemand | None, "FrontEnrichment: rules", "a FrontDemand")

    def Spec(self, body: CrackedSolid, order: int, material: Isotropic | None) -> core.FrontSpec:
        """What the space needs to know.

        Parameters
        ----------
        body : CrackedSolid
            Of the space.
        order : int
            Of the space.
        material : Elasticity or None
            That of the space.

        Raises
        ------
        ValueError
            For a front that leaves its material.
        """
        own = self.material or material
        if own is not None:
            check_form(own, body, "FrontEnrichment: material")
        rules = self.rules or core.FrontDemand()
        demand = core.FrontDemand(reach_of(self, body, order), rules.along, rules.angular, rules.radial, rules.order, rules.beta)
        return core.FrontSpec([constants_at(body, own or UNKNOWN, front) for front in range(len(body.fronts))], demand)


class SolidFESpace(Described, core.SolidFESpace):
    """V_h = {Σ a_i φ_i + Σ_{N_H} b_i H φ_i + Σ φ_i (c_iI v_I + c_iII v_II + c_iIII v_III)} of a body in space.

    N_H are the functions with completely cut support, stored as in the plane. The last sum is over the nodes around the fronts.

    Parameters
    ----------
    body : CrackedSolid
        What CrackedMesh(mesh, sheet, ...) gives.
    order
        Of φ_i, 1 or 2.
    front
        FrontEnrichment for all fronts, or None for no modes.
    dirichlet
        Names (a regular expression) of the boundaries on which u is held.
    dirichletx, dirichlety, dirichletz
        Of those on which that component is held: rollers, planes of symmetry.
    material
        Elasticity.Solid (or Elasticity.ByRegion of such): the modes are its modes, and ContactProblem(V, W) takes it.
    **flags
        print as for NGSolve's H1.

    Raises
    ------
    TypeError, ValueError
        For another order, an unknown boundary, a material of the plane and other flags.

    Warns
    -----
    AccuracyWarning
        Of fronts without a material, of nodes around fronts without modes, where the crack is held together, of sheets that are small against the elements that they cut, and of fronts
        that pass the boundary without an element between.

    Notes
    -----
    Nodes beside corners of a front, where two fronts of a sheet are near, and on boundaries where some components of u are held and others are not have no modes:
    `num_left_out`.
    """

    def __init__(
        self,
        body: CrackedSolid,
        order: int = 1,
        front: FrontEnrichment | None = FrontEnrichment(),
        dirichlet: str | list[str] = "",
        dirichletx: str | list[str] = "",
        dirichlety: str | list[str] = "",
        dirichletz: str | list[str] = "",
        material: Isotropic | None = None,
        **flags: Any,
    ) -> None:
        check_flags(flags, ("front", "dirichlet", "dirichletx", "dirichlety", "dirichletz"), ("print",))
        check_type(body, core.CrackedSolid, "SolidFESpace: body", "a CrackedMesh of a mesh in space")
        check_whole(order, "CrackFESpace: order", 1)
        if order > 2:
            raise ValueError(f"CrackFESpace: order={order} is not there for bodies in space; take 1 or 2")
        check_type(material, Isotropic | None, "CrackFESpace: material", "an Elasticity")
        check_type(front, FrontEnrichment | None, "CrackFESpace: front", "a FrontEnrichment, or None for no modes")
        if material is not None:
            check_form(material, body, "CrackFESpace: material")
        for name, pattern in (("dirichlet", dirichlet), ("dirichletx", dirichletx), ("dirichlety", dirichlety), ("dirichletz", dirichletz)):
            if pattern:
                flags[name] = joined_names(pattern)
                check_regions(body.mesh, flags[name], f"CrackFESpace: {name}")
        share = share_in(body)
        has_modes = front is not None and len(body.fronts) > 0
        is_far = front is not None and has_modes and asks_for_more(front) and reach_of(front, body, order) > (1 + 1e-9) * REACH * least_size(body)
        share.Refuse(f"FrontEnrichment(radius) of more than {REACH} elements", is_far)
        super().__init__(body, front.Spec(body, order, material) if front is not None and has_modes else None, order=order, **flags)
        self.material, self.share, self._body = material, share, body  # with its share
        warn_of_left_out(self)
        warn_of_coarse_sheets(body, has_modes)
        warn_of_thin_ligaments(body)
        self.undecided = list(range(len(body.fronts))) if front is not None and (front.material or material) is None else []
        if self.undecided:
            warn(
                "CrackFESpace: no material is given, so the fronts have modes of a material with ν = 0.3 until a ContactProblem says which; "
                "with another one forms of your own would be less accurate. Give CrackFESpace(..., material=Elasticity.Solid(E, nu))"
            )

    tip_specs: tuple[Any, ...] = ()  # a body in space has fronts

    def Description(self) -> Lines:
        """Order, unknowns, and the material."""
        modes = f"{3 * len(self.front_nodes)} modes at {numbered(len(self.front_nodes), 'node')} around {numbered(len(self.body.fronts), 'front')}"
        return [
            ("order", str(self.order)),
            ("unknowns", f"{self.ndof}, of them {numbered(3 * self.num_heaviside, 'Heaviside function')} and {modes}"),
            ("material", str(self.material)),
        ]

    def Decide(self, material: Isotropic) -> None:
        """Gives the fronts whose material was not known that of a problem.

        Parameters
        ----------
        material : Elasticity
            Of the problem.
        """
        for number in self.undecided:
            self.SetFrontMaterial(number, *constants_at(self.body, material, number))
        self.undecided = []

    def CheckModes(self, material: Isotropic) -> None:
        """Raises ValueError for modes of another material: their lips would carry tractions.

        Parameters
        ----------
        material : Elasticity
            Of the problem.
        """
        if self.front_spec is None:
            return
        for number, constants in enumerate(self.front_spec.materials):
            if not np.allclose(constants, constants_at(self.body, material, number), rtol=1e-12, atol=0):
                raise ValueError(
                    f"ContactProblem: the modes of front {number} belong to another material than {material}; give it to CrackFESpace(..., material=...)"
                )

    def __getstate__(self) -> Any:
        return super().__getstate__(), self.material, self.undecided

    def __setstate__(self, state: Any) -> None:
        of_core, material, undecided = state
        super().__setstate__(of_core)
        self.material, self.undecided, self.share = material, undecided, share_in(self.body)


def asks_for_more(front: FrontEnrichment) -> bool:
    """Whether more nodes may have modes than by default."""
    return bool(front.radius) or (front.rules is not None and front.rules.radius > 0)


def reach_of(front: FrontEnrichment, body: CrackedSolid, order: int) -> float:
    """Nodes nearer to a front have modes, whatever its elements are."""
    return max(usual_reach(body, order) if front.radius is None else front.radius, front.rules.radius if front.rules else 0.0)


def usual_reach(body: CrackedSolid, order: int) -> float:
    """How far from a front there are modes if nothing is said: polynomials of order 1 need them where K is read."""
    if order > 1 or not all(sheet.planar for sheet in body.cracks):
        return 0.0
    return REACH * least_size(body)


def least_size(body: CrackedSolid) -> float:
    """Of the elements at fronts, where they are shortest."""
    return min((size_at_front(body, number) for number in range(len(body.fronts))), default=0.0)


def warn_of_left_out(V: SolidFESpace) -> None:
    """Nodes around fronts without modes: these have no copies, either."""
    if V.num_left_out:
        warn(
            f"CrackFESpace: {V.num_left_out} of {V.num_left_out + len(V.front_nodes)} nodes around fronts have no modes, and the crack is held together there: beside "
            "corners of a front, where the front turns or two fronts are near within two elements, or where some components of u are held and others are not. "
            "Refine the mesh there, or round the corners; where a front ends on rollers that are not normal to it, stiff springs (problem.a) in their place keep the modes"
        )


def constants_at(body: CrackedSolid, material: Isotropic, number: int) -> tuple[float, float]:
    """(κ, μ) of the material at a front. Raises ValueError for a front that leaves it."""
    front = body.fronts[number]
    here = (
        {material.At(body.mesh, front.PointAt(s)) for s in (np.arange(24) + 0.37) / 24 * front.length} if len(material.regions) > 1 else {material.regions[0]}
    )
    if len(here) > 1:
        raise ValueError(f"CrackFESpace: front {number} goes through several materials; the modes are those of one. Take front=None, which has none")
    (one,) = here
    return float(one.kappa), float(one.mu)
