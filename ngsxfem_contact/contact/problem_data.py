"""What a ContactProblem is made of, checked: its material, the law of its faces, and stresses that are given."""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CoefficientFunction, dx

from .. import _ngsxfem_contact as core
from ..arguments import check_function, check_type, crack_number, crack_title
from ..material import Isotropic, check_form
from ..protocols import FaceLaw, LawAtNodes, check_role
from ..spaces.solid_fespace import SolidFESpace
from .friction import Frictionless
from .nodal_law import LawByCrack

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace


@singledispatch
def check_modes(V: CrackFESpace, material: Isotropic) -> None:
    """Raises ValueError if V has tip modes of another material: their lips would carry tractions."""
    for tip, spec in zip(V.body.tips, V.tip_specs):
        if spec is not None and spec.basis == core.TipBasis.modes:
            here = material.At(V.mesh, tip.point)
            if not np.allclose((spec.kappa, spec.mu), (here.kappa, here.mu), rtol=1e-12, atol=0):
                raise ValueError(f"ContactProblem: the tip modes of V belong to another material than {here}; pass the same to TipEnrichment(material=...)")


check_modes.register(SolidFESpace, SolidFESpace.CheckModes)


def given_stresses(material: Isotropic, initial_stress: Any, temperature: Any) -> Iterator[CoefficientFunction]:
    """The stresses σ⁰ of initial_stress= and temperature=, CoefficientFunctions of 2 × 2, in space 3 × 3."""
    if initial_stress is not None:
        d = material.dimension
        initial_stress = check_function(initial_stress, "ContactProblem: initial_stress", d * d)
        if tuple(initial_stress.dims) != (d, d):
            entries = "xx, xy, xy, yy" if d == 2 else "xx, xy, xz, xy, yy, yz, xz, yz, zz"
            raise ValueError(f"ContactProblem: initial_stress must be a {d} × {d} matrix, CF(({entries}), dims=({d}, {d}))")
        check_no_function(initial_stress)
        yield initial_stress
    if temperature is not None:
        if isinstance(material.alpha, Real) and material.alpha == 0:
            raise ValueError(
                "ContactProblem: temperature= needs a material that expands: give it alpha=, as Elasticity.PlaneStrain and Elasticity.Solid (E, nu, alpha=...) take it"
            )
        yield material.ThermalStress(check_function(temperature, "ContactProblem: temperature", 1))


def check_no_function(stress: CoefficientFunction) -> None:
    """Raises ValueError for an initial stress that holds trial or test functions."""
    term = core.TermsOf(stress[0, 0] * dx)[0]
    if term.test or term.trial:
        raise ValueError("ContactProblem: initial_stress holds a trial or test function; it is given, a function of the place")


def law_of(law: FaceLaw | Mapping[int | str, LawAtNodes | None] | None, body: CrackedMesh) -> FaceLaw:
    """The law of all faces. Raises TypeError for what is none, ValueError for a crack that is not there."""
    if isinstance(law, Mapping):
        laws: dict[int, LawAtNodes] = {}
        for crack, own in law.items():
            number = crack_number(crack, body)
            if number in laws:
                raise ValueError(f"ContactProblem: law has two laws of {crack_title(body.cracks, number)}, by its number and by its name; keep one of them")
            laws[number] = Frictionless() if own is None else own
        return LawByCrack(laws, Frictionless())
    if law is not None:
        check_role(law, FaceLaw, "ContactProblem: law", "a law such as Coulomb(mu_f), a mapping {crack: law}")
    return Frictionless() if law is None else law


def material_of(V: CrackFESpace, material: Isotropic | None) -> Isotropic:
    """The one that is given, or that of V. Raises TypeError if there is none, ValueError if they are two."""
    own: Isotropic | None = getattr(V, "material", None)
    chosen = own if material is None else material
    if chosen is None:
        raise TypeError("ContactProblem: there is no material; give CrackFESpace(..., material=Elasticity...), or ContactProblem(V, W, material)")
    check_type(chosen, Isotropic, "ContactProblem: material", "an Elasticity")
    check_form(chosen, V.body, "ContactProblem: material")
    if own is not None and chosen.regions != own.regions:
        raise ValueError(f"ContactProblem: material={chosen} is another one than {own} of CrackFESpace(material=...); say it once, to V")
    return chosen
