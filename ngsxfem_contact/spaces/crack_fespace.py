"""V_h, the displacements: section 3 of docs/method.md, (6) to (8) of [AHLMR12]."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import singledispatch, wraps
from typing import TYPE_CHECKING, Any

from .. import _ngsxfem_contact as core
from ..arguments import INFINITY, check_number, check_positive, check_regions, check_type, check_whole
from ..description import Described, numbered
from ..errors import warn
from ..material import Elasticity, Isotropic, check_form
from ..points import place
from ..protocols import TipFunctions, check_role
from ..share import share_in
from ..sheets import check_plane_body
from .flags import check_flags, joined_names
from .resolution import warn_of_coarse
from .solid_fespace import SolidFESpace
from .tip_disk import check_disk, largest_disk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .._ngsxfem_contact import CrackedMesh, Tip, TipSpec
    from ..description import Lines

UNKNOWN = Elasticity.PlaneStrain(E=2.6, nu=0.3)  # μ = 1: the modes at a tip until its material is known

MOST_POWERS = 4  # of r at a tip: cpp/spaces/tip_functions.hpp has room for no more


@dataclass(frozen=True)
class TipEnrichment:
    """χ F_j at a tip: the singular functions and the cut-off χ = 1 for r ≤ r0, 0 for r ≥ r1.

    Parameters
    ----------
    r0
        Default r1 / 50.
    r1
        Default 0.9 × the largest possible radius: the tip's clearance (see `body.tips`), and the distance to curved elements and, for the modes, to other
        materials.
    cutoff
        "cubic" (χ is C¹), "quintic" (C²) or "septic" (C³). Default: quintic, and septic where CrackFESpace has order 3 or more, which a third derivative that jumps
        would limit to h^{5/2}.
    material
        With an Elasticity (or Elasticity.ByRegion) the vector modes of Williams' expansion, whose lips are free of traction; the first two coefficients are
        K_I and K_II. Default: that of CrackFESpace(material=...).
    functions
        "modes", or "branch" for the four scalar functions (8) of [AHLMR12] in each component, 8 unknowns, whose lips carry tractions: in contact
        pressures and K_I are less accurate. Default: modes; without a material those of the ContactProblem that is made of the space.
    tolerance
        Of the integration rules around the tip, relative to the integral over an element. Default: 1e-5, and 1e-9 where CrackFESpace has order 3 or more. It changes
        the mean errors of energy and K by less than a hundredth of themselves (tests/contact/test_contact.py).
    order
        m: the modes r^{1/2}, r^{3/2}, ..., r^{m-1/2}, 2 m unknowns for each tip, m = 1 to 4. Default: that of CrackFESpace, which then keeps its order at the tips of straight
        cracks. With functions="branch" there is r^{1/2} only.

    Raises
    ------
    ValueError
        Unless 0 <= r0 < r1 < inf.
    TypeError
        For a material that is none; CrackFESpace raises for a disk that does not fit the body.

    Notes
    -----
    r0 and r1 are lengths.
    """

    r0: float | None = None
    r1: float | None = None
    cutoff: str | None = None
    material: Isotropic | None = None
    functions: str | None = None
    tolerance: float | None = None
    order: int | None = None

    def __post_init__(self) -> None:
        if self.cutoff is not None and self.cutoff not in core.CutOff.__members__:
            raise ValueError(f"TipEnrichment: cutoff={self.cutoff!r} is not one of {list(core.CutOff.__members__)}")
        if self.tolerance is not None:
            check_number(self.tolerance, "TipEnrichment: tolerance", lambda tolerance: 0 < tolerance < 1, "lie between 0 and 1")
        if self.r1 is not None:
            check_positive(self.r1, "TipEnrichment: r1")
        if self.r0 is not None:
            r1 = INFINITY if self.r1 is None else self.r1
            check_number(self.r0, "TipEnrichment: r0", lambda r0: 0 <= r0 < r1, f"be less than r1={self.r1}: the cut-off needs 0 <= r0 < r1")
        if self.functions not in (None, "modes", "branch"):
            raise ValueError(f"TipEnrichment: functions={self.functions!r} is not 'modes' or 'branch'")
        if self.functions == "modes" and self.material is None:
            raise ValueError("TipEnrichment: functions='modes' needs material=Elasticity(...), which the modes depend on")
        check_type(self.material, Isotropic | None, "TipEnrichment: material", "an Elasticity")
        if self.order is not None:
            check_whole(self.order, "TipEnrichment: order", 1)
            most = 1 if self.functions == "branch" else MOST_POWERS
            if self.order > most:
                raise ValueError(
                    f"TipEnrichment: order={self.order} is more than {most}, what the functions {self.functions or 'modes'!r} have; choose 1 to {most}"
                )

    def Spec(self, body: CrackedMesh, tip: Tip) -> TipSpec:
        """What the space needs to know at one tip.

        Raises
        ------
        ValueError
            For a disk that does not fit.
        """
        material = None if self.functions == "branch" else self.material
        r1 = 0.9 * largest_disk(body, tip, material)[0] if self.r1 is None else self.r1
        check_disk("TipEnrichment", body, tip, r1, material, "tip=None")
        r0 = r1 / 50 if self.r0 is None else self.r0
        cutoff = core.CutOff.__members__[self.cutoff or "quintic"]
        if self.functions == "branch":
            return core.TipSpec(core.TipBasis.branch, cutoff, r0, r1, 0, 1)
        here = UNKNOWN if material is None else material.At(body.mesh, tip.point)
        return core.TipSpec(core.TipBasis.modes, cutoff, r0, r1, here.kappa, here.mu, self.order or 1)

    def With(self, material: Isotropic | None, order: int) -> TipEnrichment:
        """The same with the modes of a material (or None), unless it has functions of its own, and with what suits an order, unless it says that itself.

        Parameters
        ----------
        material : Elasticity or None
            Whose modes are taken.
        order : int
            Of the polynomials beside them.
        """
        suited = replace(self, cutoff=self.cutoff or ("quintic" if order < 3 else "septic"))
        if self.functions == "branch":
            return suited
        return replace(suited, material=material if self.material is None else self.material, order=self.order or min(order, MOST_POWERS))

    @property
    def undecided(self) -> bool:
        """Whether there is neither a material nor a choice of functions."""
        return self.material is None and self.functions is None


class CrackFESpace(Described, core.CrackFESpace):
    """V_h = {Σ a_i φ_i + Σ_{N_H} b_i H φ_i + χ Σ c_j F_j}: vector-valued, one FESpace.

    N_H are the functions with completely cut support. They are stored as ½(H - s_i) φ_i, s_i the sign of the larger
    part of the support: the span is the same, b_i is the nodal jump, and thin parts do no harm.

    Parameters
    ----------
    body : CrackedMesh
        Of a mesh in space gives a SolidFESpace, which has front= in place of tip=.
    order
        Of φ_i, 1 or more.
    tip
        TipEnrichment for all tips, a list with one (or None) for each of `body.tips`, or None for no tip functions.
    bubble
        With order 1 the cubic bubble of each triangle ("P1+"), with higher orders all bubbles of degree order + 1, which nearly incompressible materials
        need; default: where the material is one and order > 1.
    dirichlet
        Names (a regular expression) of the boundaries on which u is held.
    dirichletx, dirichlety
        Of those on which that component is held: rollers, planes of symmetry.
    material
        Elasticity (or Elasticity.ByRegion) of the body: the tips have its modes, and ContactProblem(V, W) takes it.
    **flags
        orderinner, print as for NGSolve's H1.

    Raises
    ------
    TypeError, ValueError
        For an order that is no whole number ≥ 1, another number of tips than the body has, an unknown boundary and other flags.
    Exception
        For a disk that leaves the body or meets another crack.

    Warns
    -----
    AccuracyWarning
        Of tips without a material, of cracks of less than 2 elements for each tip, and of tips whose functions have less than 2 elements of room.

    References
    ----------
    Section 3 of [AHLMR12], (6) to (8).
    """

    def __init__(
        self,
        body: CrackedMesh,
        order: int = 1,
        tip: TipFunctions | Sequence[TipFunctions | None] | None = TipEnrichment(),
        bubble: bool | None = None,
        dirichlet: str | list[str] = "",
        dirichletx: str | list[str] = "",
        dirichlety: str | list[str] = "",
        material: Isotropic | None = None,
        **flags: Any,
    ) -> None:
        check_flags(flags, ("tip", "bubble", "dirichlet", "dirichletx", "dirichlety"), ("orderinner", "print"))
        check_plane_body(body, "CrackFESpace: body")
        check_whole(order, "CrackFESpace: order", 1)
        check_type(material, Isotropic | None, "CrackFESpace: material", "an Elasticity")
        if material is not None:
            check_form(material, body, "CrackFESpace: material")
        for name, pattern in (("dirichlet", dirichlet), ("dirichletx", dirichletx), ("dirichlety", dirichlety)):
            if pattern:
                flags[name] = joined_names(pattern)
                check_regions(body.mesh, flags[name], f"CrackFESpace: {name}")
        tips = tip_enrichments(tip, body, material, order)
        if len(tips) != len(body.tips):
            raise ValueError(f"CrackFESpace: {len(tips)} tip enrichments for {len(body.tips)} tips; give one for each of body.tips")
        specs = [None if enrichment is None else enrichment.Spec(body, tip) for enrichment, tip in zip(tips, body.tips)]
        tolerance = min((enrichment.tolerance or (1e-5 if order < 3 else 1e-9) for enrichment in tips if enrichment), default=1)
        if bubble is None:
            bubble = order > 1 and any(map(is_nearly_incompressible, [material, *(getattr(enrichment, "material", None) for enrichment in tips)]))
        if bubble:
            flags["orderinner"] = max(3, order + 1)
        super().__init__(body, specs, tolerance, order=order, **flags)
        self.material, self.share = material, share_in(body)
        self.undecided = [number for number, enrichment in enumerate(tips) if isinstance(enrichment, TipEnrichment) and enrichment.undecided]
        warn_of_undecided(body, self.undecided)
        warn_of_coarse(body, specs, material)

    @wraps(__init__, assigned=(), updated=())  # type: ignore[misc]  # the signature is that of __init__
    def __new__(cls, *arguments: Any, **named: Any) -> Any:
        """The SolidFESpace of a body in space, with its arguments."""
        body = arguments[0] if arguments else named.get("body")
        return SolidFESpace(*arguments, **named) if isinstance(body, core.CrackedSolid) else super().__new__(cls)

    def Description(self) -> Lines:
        """Order, unknowns, and the material."""
        at_tips = sum(len(self.TipDofs(tip)) for tip in range(len(self.body.tips)))
        unknowns = f"{self.ndof}, of them {numbered(2 * self.num_heaviside, 'Heaviside function')} and {at_tips} at {numbered(len(self.body.tips), 'tip')}"
        return [("order", str(self.order)), ("unknowns", unknowns), ("material", str(self.material))]

    def __getstate__(self) -> Any:
        return super().__getstate__(), self.material, self.undecided

    def __setstate__(self, state: Any) -> None:
        of_core, material, undecided = state
        super().__setstate__(of_core)
        self.material, self.undecided, self.share = material, undecided, share_in(self.body)


def tip_enrichments(tip: Any, body: CrackedMesh, material: Isotropic | None, order: int) -> list[TipFunctions | None]:
    """One for each tip, those that are undecided with the modes of the material and of the order of the space."""
    tips = tip if isinstance(tip, (list, tuple)) else [tip] * len(body.tips)
    for enrichment in tips:
        if enrichment is not None:
            check_role(enrichment, TipFunctions, "CrackFESpace: tip", "a TipEnrichment")
    return [enrichment.With(material, order) if isinstance(enrichment, TipEnrichment) else enrichment for enrichment in tips]


def warn_of_undecided(body: CrackedMesh, tips: list[int]) -> None:
    """Tips whose material is not known."""
    if tips:
        warn(
            f"CrackFESpace: no material is given, so the tips at {', '.join(place(body.tips[number].point) for number in tips)} have modes of a material with ν = 0.3 "
            "until a ContactProblem says which; with another one forms of your own would be less accurate at the tips, and K from the modes wrong. "
            "Give CrackFESpace(..., material=...), or tip=TipEnrichment(functions='branch') for functions that need none"
        )


@singledispatch
def decide(V: CrackFESpace, material: Isotropic) -> None:
    """Gives the tips of V whose material was not known that of the problem. Raises ValueError for a disk that reaches another material."""
    for number in getattr(V, "undecided", []):
        tip, spec, here = V.body.tips[number], V.tip_specs[number], material.At(V.mesh, V.body.tips[number].point)
        check_disk("ContactProblem", V.body, tip, spec.r1, material, "give CrackFESpace(..., material=...), so that the disk ends before")
        V.SetTipMaterial(number, here.kappa, here.mu)
    if isinstance(V, CrackFESpace):
        V.undecided = []


decide.register(SolidFESpace, SolidFESpace.Decide)


def is_nearly_incompressible(material: Isotropic | None) -> bool:
    """Whether a material, or None, is nearly incompressible."""
    return material is not None and material.nearly_incompressible
