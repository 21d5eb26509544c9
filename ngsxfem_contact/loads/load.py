"""The forms that a user adds to, and what a solution was solved for: loads on the body, on its faces, given stresses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF, Integrate, LinearForm, fem

from .. import _ngsxfem_contact as core
from ..points import distance_to_segments
from .face_traction import FaceTractions, Joint
from .terms import (
    check_linear,
    check_normal,
    check_symmetric,
    checked_terms,
    coefficient_of_gradient,
    coefficient_of_limits,
    coefficient_of_values,
    inner_interface,
    place_of,
    replaced,
    sample_points,
    tested,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from ngsolve import BilinearForm, BitArray, CoefficientFunction, GridFunction

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace, FormTerm
    from ..operators import Component

NAME_F, NAME_A = "problem.f", "problem.a"
SIDES = ("minus", "larger", "plus")


class LoadForm(LinearForm):
    """L(v) = ∫f·v + ∫g·v + ...: an NGSolve LinearForm that knows what was added to it.

    Parameters
    ----------
    V : CrackFESpace

    Raises
    ------
    TypeError
    ValueError
        For what has no meaning here, see `terms.checked_terms`, and for trial functions.

    Notes
    -----
    form += force*v*body.dx, v a test function of V; also v[1](x, y), a point load. Terms over body.dcrack in Plus(v), Minus(v), Jump(v) are tractions of
    the faces; terms in Grad(v) are given stresses, -∫σ⁰:∇v.
    """

    def __init__(self, V: CrackFESpace) -> None:
        super().__init__(V)
        self.V, self.given = V, []

    def __iadd__(self, form: Any) -> LoadForm:
        if isinstance(form, fem.PointEvaluationFunctional):
            if self.V.mesh.dim == 3:
                raise ValueError(f"{NAME_F}: point loads are there for plane bodies only; distribute the force over a part of the body or of its boundary")
            given: list[Any] = [PointLoad(form)]
            given[0].CheckPlace(self.V)
            if given[0].IsOwn(self.V):
                super().__iadd__(form)
        else:
            given = self.V.share.Together(lambda: self._checked(form))
            super().__iadd__(self.V.share.Own(form))
        self.given += given
        return self

    def __reduce__(self) -> Any:
        return form_of, (self.V, [given.form if isinstance(given, PointLoad) else given.term for given in self.given])

    def Add(self, terms: list[Any]) -> None:
        """Adds FormTerms and point loads.

        Parameters
        ----------
        terms
            FormTerms and PointEvaluationFunctionals.
        """
        for term in terms:
            self += term if isinstance(term, fem.PointEvaluationFunctional) else term.form

    def _checked(self, form: Any) -> list[GivenTerm]:
        terms = checked_terms(form, self.V, NAME_F)
        if any(term.trial for term in terms):
            raise ValueError(f"{NAME_F}: a linear form holds no trial function; springs and elastic joints are added to {NAME_A}")
        for term in terms:
            check_linear(term, NAME_F)
            check_normal(term, NAME_F)
        return [GivenTerm(term) for term in terms]

    def Vector(self) -> np.ndarray:
        """F of (38), an array, additive."""
        return self.Assemble().vec.FV().NumPy().copy()

    def ReplacedBy(self, form: LinearForm) -> LoadForm:
        """The LoadForm that takes the place of this one: itself, or a new one for an empty LinearForm of NGSolve.

        Parameters
        ----------
        form : LoadForm or LinearForm
            What takes its place.

        Raises
        ------
        TypeError
            For others, whose terms are not known.
        """
        if isinstance(form, LoadForm) and form.V is self.V:
            return form
        if isinstance(form, LinearForm) and form.space is self.V and not form.integrators:
            return LoadForm(self.V)
        raise TypeError(f"{NAME_F} cannot be replaced by {form!r}; add terms to it, {NAME_F} += ..., or begin anew by {NAME_F} = LinearForm(problem.V)")


def form_of(V: CrackFESpace, terms: list[Any]) -> LoadForm:
    """The LoadForm of FormTerms and point loads."""
    form = LoadForm(V)
    form.Add(terms)
    return form


class PointLoad:
    """A force in a point, v[1](x, y)."""

    tractions = stress = None

    def __init__(self, functional: fem.PointEvaluationFunctional) -> None:
        self.form, self.point = functional, core.PointOf(functional)

    def __reduce__(self) -> Any:
        return PointLoad, (self.form,)

    def IsOwn(self, V: CrackFESpace) -> bool:
        """Whether the point is this process's. Raises ValueError where it is nobody's."""
        try:
            return bool(V.share.Has([self.point])[0])
        except ValueError as outside:
            raise ValueError(f"{NAME_F}: the point of a load {outside}") from None

    def CheckPlace(self, V: CrackFESpace) -> None:
        """Raises ValueError where the point is on a crack, nearer to it than round-off: there a displacement is two."""
        size = np.ptp(V.mesh.ngmesh.Coordinates()[:, :2], axis=0).max()
        for number, crack in enumerate(V.body.cracks):
            if crack.Distance(self.point) <= 1e-10 * size:
                raise ValueError(
                    f"{NAME_F}: the point {self.point} of a load is on crack {number}, where the faces move apart; take problem.FaceTraction, or a point beside it"
                )

    def BodyForce(self, field: CoefficientFunction, elements: BitArray | None) -> float:
        """0: domains of integration keep clear of the point."""
        return 0.0

    def Obstacle(self, point: tuple[float, float]) -> tuple[float, str]:
        """(distance, what) that a domain of integration around a point has to keep clear of."""
        return float(np.hypot(*np.subtract(self.point, point))), "a point load"


class GivenTerm:
    """One integral of a load. tractions: what it does on the faces, or None.

    Attributes
    ----------
    stress
        The given stress σ⁰ that it is, or None.
    """

    def __init__(self, term: FormTerm) -> None:
        self.term, self.form, self.place = term, term.form, place_of(term)

    def __reduce__(self) -> Any:
        return GivenTerm, (self.term,)

    @cached_property
    def tractions(self) -> FaceTractions | None:
        """FaceTractions of a term over the cracks."""
        return FaceTractions(*coefficient_of_limits(self.term)) if self.place == "crack" else None

    @cached_property
    def stress(self) -> CoefficientFunction | None:
        """σ⁰ of a term -∫σ⁰:∇v."""
        S = coefficient_of_gradient(self.term) if self.place == "bulk" else None
        return None if S is None else -1 * S

    def BodyForce(self, field: CoefficientFunction, elements: BitArray | None) -> float:
        """∫ f·field over some elements (BitArray), f the body force."""
        if self.place != "bulk":
            return 0.0
        return Integrate(core.InnerIntegrals(tested(self.term, {"Id": field}.get), elements), self.term.body.mesh)

    def Obstacle(self, point: tuple[float, float]) -> tuple[float, str]:
        """(distance, what) that a domain of integration around a point has to keep clear of: a loaded inner interface."""
        if self.place != "boundary":
            return float("inf"), ""
        a, b = self._inner_interface
        return distance_to_segments(a, b, np.asarray(point)), "a loaded inner interface"

    @cached_property
    def _inner_interface(self) -> tuple[np.ndarray, np.ndarray]:
        return inner_interface(self.term)


@dataclass(frozen=True)
class LoadTerms:
    """Σ factor · given: what a solution was solved for, whatever is added to the problem's forms later."""

    parts: tuple[tuple[float, PointLoad | GivenTerm], ...] = ()
    dimension: int = 2

    def __reduce__(self) -> Any:
        return LoadTerms, (self.parts, self.dimension)

    @staticmethod
    def Of(form: LoadForm) -> LoadTerms:
        """What a LoadForm holds now."""
        return LoadTerms(tuple((1.0, given) for given in form.given), form.V.mesh.dim)

    def __add__(self, other: LoadTerms) -> LoadTerms:
        return LoadTerms(self.parts + other.parts, self.dimension)

    def __rmul__(self, factor: float) -> LoadTerms:
        return LoadTerms(tuple((factor * f, given) for f, given in self.parts), self.dimension)

    @cached_property
    def tractions(self) -> FaceTractions:
        """The FaceTractions that are given on the cracks."""
        return sum((factor * given.tractions for factor, given in self.parts if given.tractions), FaceTractions.Zero(self.dimension))

    @cached_property
    def stress(self) -> CoefficientFunction | None:
        """The given stress σ⁰, a square matrix, or None."""
        stresses = [factor * given.stress for factor, given in self.parts if given.stress is not None]
        return sum(stresses[1:], stresses[0]) if stresses else None

    @property
    def acts_on_faces(self) -> bool:
        """Whether tractions of the faces or a stress are given: else r_0 = 0."""
        return self.stress is not None or any(given.tractions for _, given in self.parts)

    def Shift(self, component: Component, side: str | None, body: CrackedMesh) -> CoefficientFunction:
        """r_0 of a side: the given part of what the multiplier is compared with."""
        shift = self.tractions.Shift(component, side, body)
        return shift if self.stress is None else shift + component.traction(body.LimitOnCrack(self.stress, SIDES.index(side) - 1), body)

    def BodyForces(self) -> CoefficientFunction:
        """f, the body force, a vector."""
        bulk = [factor * coefficient_of_values(given.term) for factor, given in self.parts if factor and isinstance(given, GivenTerm) and given.place == "bulk"]
        return sum(bulk, CF((0.0,) * self.dimension))

    def BodyForce(self, field: CoefficientFunction, elements: BitArray | None) -> float:
        """∫ f·field, f the body force, over some elements (BitArray) in which the field is not zero."""
        return sum(factor * given.BodyForce(field, elements) for factor, given in self.parts if factor)

    def Vector(self, V: CrackFESpace) -> np.ndarray:
        """F of these terms, with the values that its coefficients have now; additive."""
        return assembled(self, V, lambda given: given.form if isinstance(given, PointLoad) else V.share.Own(given.form), lambda point: point.IsOwn(V))

    def Obstacles(self, point: tuple[float, float]) -> list[tuple[float, str]]:
        """What a domain of integration around a point must not meet: pairs (distance, what)."""
        return [given.Obstacle(point) for factor, given in self.parts if factor]


def assembled(load: LoadTerms, V: CrackFESpace, form_of: Callable[..., Any], counts: Callable[[PointLoad], bool] = lambda point: True) -> np.ndarray:
    """F of LoadTerms on a space, form_of(part) their linear forms there: the integrals at once, and the points that count, for this process."""
    integrals, points = LinearForm(V), np.zeros(V.ndof)
    for factor, given in load.parts:
        if not isinstance(given, PointLoad):
            integrals += form_of(given) if factor == 1 else float(factor) * form_of(given)
        elif counts(given):
            point = LinearForm(V)
            point += form_of(given)
            points += factor * point.Assemble().vec.FV().NumPy()
    return integrals.Assemble().vec.FV().NumPy() + points


def check_symmetric_stress(form: LoadForm) -> None:
    """Raises ValueError for an initial stress, as a LoadForm, whose matrix is not symmetric."""
    for given in form.given:
        d = form.V.mesh.dim
        stress = np.stack([np.ravel(component(sample_points(given.term))) for component in given.stress.Reshape((d * d,))]).reshape(d, d, -1)
        if not np.allclose(stress, stress.swapaxes(0, 1), atol=1e-10 * np.abs(stress).max(initial=0), equal_nan=True):
            raise ValueError(f"ContactProblem: initial_stress is not symmetric; give the same σ_ij and σ_ji in CF(..., dims=({d}, {d}))")


class StiffnessForm:
    """Bilinear terms beside ∫σ(u):ε(v): springs on ∂Ω, a foundation in the body, elastic joints on the cracks.

    Parameters
    ----------
    V : CrackFESpace

    Other Parameters
    ----------------
    u : GridFunction
        The displacement.

    Raises
    ------
    ValueError
        For terms that are not symmetric and for terms in gradients.

    Notes
    -----
    form += k*u*v*body.ds("bottom") or k*Jump(u)*Jump(v)*body.dcrack, u, v of V.TnT().
    """

    def __init__(self, V: CrackFESpace) -> None:
        self.V, self.terms = V, []

    def __iadd__(self, form: Any) -> StiffnessForm:
        self.terms += self.V.share.Together(lambda: checked_bilinear(form, self.V))
        return self

    def AddTo(self, form: BilinearForm) -> None:
        """Adds the terms to an NGSolve BilinearForm.

        Parameters
        ----------
        form : BilinearForm
            What the terms are added to.
        """
        for term in self.terms:
            form += self.V.share.Own(term.form)

    def Forces(self, u: GridFunction) -> np.ndarray:
        """The terms as a linear form of v for a GridFunction u, an additive array: minus what springs and joints exert on the body."""
        operator = lambda name: u if name == "Id" else u.Operator(name)
        form = LinearForm(self.V)
        for term in self.terms:
            form += self.V.share.Own(term.form.Replace(replaced(term.trial, operator)))
        return form.Assemble().vec.FV().NumPy().copy() if self.terms else np.zeros(self.V.ndof)

    def Copy(self) -> StiffnessForm:
        """The terms that there are now."""
        copy = StiffnessForm(self.V)
        copy.terms = list(self.terms)
        return copy

    def BodyForce(self, u: GridFunction, field: CoefficientFunction, elements: BitArray | None) -> float:
        """∫ f·field over some elements (BitArray), f what foundations in the body exert for a GridFunction u.

        Parameters
        ----------
        field : CoefficientFunction
            In the place of the test function.
        elements : BitArray
            On which elements.
        """
        of = lambda term: replaced(term.trial, {"Id": u}.get) | replaced(term.test, {"Id": field}.get)
        bulk = [term.form.Replace(of(term)) for term in self.terms if place_of(term) == "bulk"]
        return -sum(Integrate(core.InnerIntegrals(form, elements), self.V.mesh) for form in bulk)

    def Obstacles(self, point: tuple[float, float]) -> list[tuple[float, str]]:
        """What a domain of integration around a point must not meet: inner interfaces on springs.

        Parameters
        ----------
        point : (x, y)
            From where the distances are.
        """
        ends = [inner_interface(term) for term in self.terms if place_of(term) == "boundary"]
        return [(distance_to_segments(a, b, np.asarray(point)), "an inner interface on springs") for a, b in ends]

    @property
    def joint(self) -> Joint | None:
        """The Joint of the terms over the cracks, or None."""
        terms = [term for term in self.terms if place_of(term) == "crack"]
        return Joint(terms) if terms else None


def checked_bilinear(form: Any, V: CrackFESpace) -> list[FormTerm]:
    """The core.FormTerms of springs and joints. Raises as `terms.checked_terms` and `check_bilinear`."""
    terms = checked_terms(form, V, NAME_A)
    for term in terms:
        check_bilinear(term)
    return terms


def check_bilinear(term: FormTerm) -> None:
    """Raises ValueError for a term without trial or test function, with gradients, that is not linear in either, or not symmetric."""
    if not term.trial or not term.test:
        raise ValueError(f"{NAME_A}: a term needs a trial and a test function, u and v of V.TnT(); loads are added to {NAME_F}")
    if any(core.OperatorName(proxy) == "grad" for proxy in (*term.trial, *term.test)):
        raise ValueError(f"{NAME_A}: terms in gradients belong to the material; here are springs and joints, terms in u, v and their limits on cracks")
    check_linear(term, NAME_A)
    check_symmetric(term, NAME_A)
