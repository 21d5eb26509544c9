"""The terms of the forms that a user adds to a problem: what is refused by name, and what their coefficients are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, CF, L2, CoefficientFunction, GridFunction, IfPos, comp, specialcf

from .. import _ngsxfem_contact as core
from ..algebra.matrices import mask
from ..operators import on_crack
from ..points import boundary_points, element_regions, mesh_points, points_into, points_of_crack

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ngsolve import BitArray
    from ngsolve.comp import SumOfIntegrals

    from .._ngsxfem_contact import CrackFESpace, FormTerm

LIMITS = ("plus", "minus", "jump")
ALLOWED = {"bulk": ("Id", "grad"), "boundary": ("Id",), "crack": LIMITS}
HINTS = {
    "bulk": "inside of the body write v or Grad(v); Jump, Plus and Minus go with body.dcrack",
    "boundary": "on the boundary write v",
    "crack": "there a function has two limits: write Plus(v), Minus(v) or Jump(v), or use problem.FacePressure or problem.FaceTraction",
}


def place_of(term: FormTerm) -> str:
    """Where a term is integrated: "bulk", "boundary" or "crack"."""
    return "boundary" if term.on_boundary else "crack" if term.domain == core.Domain.Crack else "bulk"


def checked_terms(form: SumOfIntegrals, V: CrackFESpace, name: str) -> list[FormTerm]:
    """The core.FormTerms of a form on V.

    Raises
    ------
    TypeError
        For what is no sum of integrals.
    ValueError
        For a measure of NGSolve or of another body, functions of another space, NGSolve's normal vector where it is zero, and operators that have no
        meaning on the measure.
    """
    if not isinstance(form, (comp.SumOfIntegrals, comp.Integral)):
        raise TypeError(f"{name}: {form!r} is no symbolic form such as force*v*body.dx, v a test function of the problem's V")
    terms = core.TermsOf(form)
    for term in terms:
        check_term(term, V, name)
    return terms


def check_term(term: FormTerm, V: CrackFESpace, name: str) -> None:
    """Raises as checked_terms."""
    if not term.body:
        measure = "ds" if term.on_boundary else "dx"
        raise ValueError(f"{name}: the rules of NGSolve's own {measure} do not see the cracks; write body.{measure}, body the problem's CrackedMesh")
    if term.body is not V.body:
        raise ValueError(f"{name}: the measure belongs to another CrackedMesh than the problem's V")
    if term.integrand.dim != 1:
        raise ValueError(f"{name}: an integrand has {term.integrand.dim} components; write vector*v, such as CF((0, -1))*v, or a component, v[1]")
    place = place_of(term)
    if term.element_normal and place != "boundary":
        raise ValueError(f"{name}: NGSolve's normal vector is zero away from the boundary; on a crack write body.normal")
    for proxy in (*term.test, *term.trial):
        check_function_of_form(proxy, V, place, name)


def check_normal(term: FormTerm, name: str) -> None:
    """Raises ValueError for a load in NGSolve's normal vector on a part of the boundary where it points into the body."""
    if term.element_normal:
        mesh = term.body.mesh
        wrong = elements_of(term) & points_into(mesh, specialcf.normal(mesh.dim))
        if wrong.any():
            where = sorted({element.mat for element, into in zip(mesh.Elements(BND), wrong) if into})
            raise ValueError(
                f"{name}: NGSolve's normal points into the body on {', '.join(map(repr, where))}, where the elements of the boundary run the other way round; "
                "take problem.Pressure, or OutwardNormal(mesh) of ngsxfem_contact.operators in its place"
            )


def check_function_of_form(proxy: CoefficientFunction, V: CrackFESpace, place: str, name: str) -> None:
    """Raises ValueError for a trial or test function of another space, or with an operator that does not go with its place."""
    if proxy.space is not V:
        raise ValueError(f"{name}: a function belongs to another space than the problem's V; take v = problem.V.TestFunction()")
    operator = core.OperatorName(proxy)
    if operator not in ALLOWED[place]:
        raise ValueError(f"{name}: the operator {operator!r} has no meaning on the {place}; {HINTS[place]}")


@dataclass(frozen=True)
class Limits:
    """A function on the cracks with given limits: what the operators Plus, Minus and Jump need of it."""

    plus: CoefficientFunction
    minus: CoefficientFunction

    def Operator(self, name: str) -> CoefficientFunction:
        """The limit "plus" or "minus", or the "jump"."""
        return {"plus": self.plus, "minus": self.minus, "jump": self.plus - self.minus}[name]


@cache
def unit_vectors(dimension: int) -> list[CoefficientFunction]:
    """(1, 0) and (0, 1), or those of space."""
    return [CF(tuple(row)) for row in np.eye(dimension).tolist()]


@cache
def unit_matrices(dimension: int) -> list[CoefficientFunction]:
    """The square matrices with one 1, row by row."""
    return [CF(tuple(row), dims=(dimension, dimension)) for row in np.eye(dimension**2).tolist()]


def unit_limits(dimension: int) -> tuple[list[Limits], list[Limits]]:
    """Limits that are unit vectors on one face and zero on the other: those on the plus face, those on the minus face."""
    zero, units = CF((0.0,) * dimension), unit_vectors(dimension)
    return [Limits(e, zero) for e in units], [Limits(zero, e) for e in units]


def replaced(functions: list[CoefficientFunction], operator: Callable[[str], Any]) -> dict[CoefficientFunction, CoefficientFunction]:
    """What to replace trial or test functions by: operator(name of theirs), None for zero."""
    zero = lambda proxy: CF(tuple([0.0] * proxy.dim), dims=tuple(proxy.dims))
    values = {proxy: operator(core.OperatorName(proxy)) for proxy in functions}
    return {proxy: zero(proxy) if value is None else value for proxy, value in values.items()}


class NotLookedInto(ValueError):
    """NGSolve cannot replace functions in a term."""


def tested(term: FormTerm, operator: Callable[..., Any]) -> SumOfIntegrals:
    """The form of a term with its test functions replaced by operator(name), None for zero.

    Raises NotLookedInto for a term with a part that NGSolve does not look into.
    """
    try:
        return term.form.Replace(replaced(term.test, operator))
    except Exception as error:
        if "Transform not" not in str(error):
            raise
        raise NotLookedInto(
            "a term of problem.f or problem.a holds a function whose parts NGSolve does not tell apart (compiled, Inv, or an InnerProduct of a function with "
            f"itself: write X*X or Norm(X)**2); interpolate it by a GridFunction, or write it in other words ({error})"
        ) from None


def coefficient_of_limits(term: FormTerm) -> tuple[CoefficientFunction, CoefficientFunction]:
    """(t⁺, t⁻) of a term ∫ t⁺·v⁺ + t⁻·v⁻ over the cracks, vectors; zero on cracks and elements that it is not taken over."""
    here = restriction(term)
    return tuple(here * CF(tuple(tested(term, v.Operator)[0].coef for v in pair)) for pair in unit_limits(term.body.mesh.dim))


def coefficient_of_values(term: FormTerm) -> CoefficientFunction:
    """f of a term ∫ f·v, a vector; zero where it is not taken."""
    return restriction(term) * CF(tuple(tested(term, {"Id": unit}.get)[0].coef for unit in unit_vectors(term.body.mesh.dim)))


def coefficient_of_gradient(term: FormTerm) -> CoefficientFunction | None:
    """S of a term ∫ S:∇v, a square matrix, or None if there is no gradient in it; zero where it is not taken."""
    if not any(core.OperatorName(proxy) == "grad" for proxy in term.test):
        return None
    d = term.body.mesh.dim
    return restriction(term) * CF(tuple(tested(term, {"grad": unit}.get)[0].coef for unit in unit_matrices(d)), dims=(d, d))


def restriction(term: FormTerm) -> CoefficientFunction:
    """1 where a term over the body or its cracks is taken, 0 elsewhere: a CoefficientFunction."""
    inside = CF(1.0)
    mesh = term.body.mesh
    chosen = elements_of(term)
    whole = term.body.CrackElements(None) if term.domain == core.Domain.Crack else None
    if not contains(chosen, whole, mesh.ne):
        indicator = GridFunction(L2(mesh, order=0))
        indicator.vec.FV().NumPy()[:] = chosen
        inside = indicator
    if term.crack is not None and len(term.body.cracks) > 1:
        inside = inside * IfPos(on_crack(term.body, term.crack), 1.0, 0.0)
    return inside


def contains(chosen: np.ndarray, whole: BitArray | None, number: int) -> bool:
    """Whether a boolean array holds all elements of a BitArray (None: all of the mesh)."""
    return chosen[chosen_of(whole, number)].all()


def chosen_of(bits: BitArray | None, number: int) -> np.ndarray:
    """A BitArray, or None for all, as a boolean array."""
    return np.ones(number, dtype=bool) if bits is None else mask(bits)


def elements_of(term: FormTerm) -> np.ndarray:
    """The elements (of the boundary for a term over it) that a term is taken over, a boolean array."""
    mesh = term.body.mesh
    index = np.array([el.index for el in mesh.Elements(BND)]) if term.on_boundary else element_regions(mesh)
    chosen = chosen_of(term.elements, len(index))
    return chosen if term.regions is None else chosen & mask(term.regions)[index]


def sample_points(term: FormTerm, number: int = 12) -> np.ndarray:
    """NGSolve's mesh points at which a term is looked at: in the middle of some of its elements, on the boundary, or on a crack."""
    mesh, place = term.body.mesh, place_of(term)
    if place == "crack":
        return points_of_crack(term.body, term.crack or 0, number)
    chosen = np.flatnonzero(elements_of(term))
    chosen = chosen[np.unique(np.linspace(0, len(chosen) - 1, number).astype(int))] if len(chosen) else chosen
    if place != "boundary":
        return mesh_points(mesh, chosen, *(np.full(len(chosen), at) for at in (0.3, 0.4, 0.2)[: mesh.dim]))
    return boundary_points(mesh, chosen, *(np.full(len(chosen), at) for at in (0.3, 0.4)[: mesh.dim - 1]))


def values_of(term: FormTerm, points: Any, test: Callable[..., Any], trial: Any = None) -> np.ndarray:
    """The integrand at some points, its functions replaced by test(name) and trial(name), see `replaced`."""
    form = tested(term, test)
    form = form.Replace(replaced(term.trial, trial)) if term.trial else form
    return np.ravel(form[0].coef(points))


def combined(weights: Sequence[float], fields: Sequence[Callable[..., Any]]) -> Callable[..., Any]:
    """Σ weight × field."""

    def operator(name: str) -> CoefficientFunction:
        if fields[0](name) is None:
            return None
        first, *others = (weight * field(name) for weight, field in zip(weights, fields))
        return sum(others, first)

    return operator


def check_linear(term: FormTerm, name: str) -> None:
    """Raises ValueError for a term without a test function, or that is not linear in its test and its trial function."""
    points = sample_points(term)
    if not term.test:
        if not np.any(term.integrand(points)):
            return  # what NGSolve makes of a load that is zero
        raise ValueError(f"{name}: a term has no test function; write force*v*body.dx, v a test function of the problem's V")
    try:
        tested(term, lambda name: None)
    except NotLookedInto:
        return  # it is a load all the same, where nobody has to know its coefficients
    fields = fields_of(term)
    some, other = combined((0.7, 0.3, -0.5, 0.2, 0.4, -0.6), fields), combined((-0.4, 0.9, 0.6, -0.8, 0.5, 0.1), fields)
    as_test, as_trial = (lambda field: values_of(term, points, field, some)), (lambda field: values_of(term, points, some, field))
    for at in (as_test, as_trial) if term.trial else (as_test,):
        first, second = at(some), at(other)
        size = max(np.abs(first).max(initial=0), np.abs(second).max(initial=0))
        if not np.isfinite(size):
            return  # found when it is assembled
        for a, b in ((0.0, 0.0), (-2.0, 0.0), (1.0, 1.0)):
            if not np.allclose(at(combined((a, b), (some, other))), a * first + b * second, rtol=1e-9, atol=1e-9 * size):
                raise ValueError(f"{name}: a term is not linear in its test or trial function; only linear terms have a place here")


def check_symmetric(term: FormTerm, name: str) -> None:
    """Raises ValueError for a bilinear term that is not symmetric."""
    fields, points = fields_of(term), sample_points(term)
    values = np.array([[values_of(term, points, b, a) for a in fields] for b in fields])
    if not np.allclose(values, values.swapaxes(0, 1), atol=1e-10 * np.abs(values).max(initial=0)):
        raise ValueError(f"{name}: a term is not symmetric in u and v; the solver needs a(u, v) = a(v, u)")


def fields_of(term: FormTerm) -> list[Callable[..., Any]]:
    """Constant fields as functions of the operators' names: on a crack on one face at a time, elsewhere with a gradient of their own."""
    d = term.body.mesh.dim
    if place_of(term) == "crack":
        return [u.Operator for pair in unit_limits(d) for u in pair]
    return [{"Id": e, "grad": g}.get for e, g in zip(unit_vectors(d), unit_matrices(d))]


def inner_interface(term: FormTerm) -> tuple[np.ndarray, np.ndarray]:
    """The ends a, b (n, 2) of the boundary elements of a term over the boundary that lie inside of the body."""
    mesh, chosen = term.body.mesh, elements_of(term)
    inner = [el for el in mesh.Elements(BND) if chosen[el.nr] and len(mesh[el.edges[0]].elements) > 1]
    return tuple(np.array([mesh[el.vertices[i]].point for el in inner]).reshape(-1, 2) for i in range(2))
