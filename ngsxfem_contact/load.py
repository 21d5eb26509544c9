"""The forms that a user adds to, and what a solution was solved for: loads on the body, on its faces, given stresses."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from ngsolve import BND, Integrate, LinearForm, fem

from . import _ngsxfem_contact as core
from .face_traction import FaceTractions, Joint
from .segments import distance_to_segments
from .terms import checked_terms, coefficient_of_gradient, coefficient_of_limits, elements_of, place_of, replaced, tested, unit_limits, unit_vectors

NAME_F, NAME_A = "problem.f", "problem.a"


class LoadForm(LinearForm):
    """L(v) = ∫f·v + ∫g·v + ...: an NGSolve LinearForm that knows what was added to it.

    V: CrackFESpace.    form += force*v*body.dx, v a test function of V; also v[1](x, y), a point load.
    Terms over body.dcrack in Plus(v), Minus(v), Jump(v) are tractions of the faces; terms in Grad(v) are given stresses, -∫σ⁰:∇v.
    Raises TypeError and ValueError for what has no meaning here, see `terms.checked_terms`, and for trial functions.
    """

    def __init__(self, V):
        super().__init__(V)
        self.V, self.given = V, []

    def __iadd__(self, form):
        given = [PointLoad(form)] if isinstance(form, fem.PointEvaluationFunctional) else self._checked(form)
        super().__iadd__(form)
        self.given += given
        return self

    def _checked(self, form):
        terms = checked_terms(form, self.V, NAME_F)
        if any(term.trial for term in terms):
            raise ValueError(f"{NAME_F}: a linear form holds no trial function; springs and elastic joints are added to {NAME_A}")
        return [GivenTerm(term) for term in terms]


def load_form(form, V):
    """A LoadForm on V: the form itself, or a new one for an empty LinearForm of NGSolve.    Raises TypeError for others, whose terms are not known."""
    if isinstance(form, LoadForm) and form.V is V:
        return form
    if isinstance(form, LinearForm) and form.space is V and not form.integrators:
        return LoadForm(V)
    raise TypeError(f"{NAME_F} cannot be replaced by {form!r}; add terms to it, {NAME_F} += ..., or begin anew by {NAME_F} = LinearForm(problem.V)")


class PointLoad:
    """A force in a point, v[1](x, y)."""

    tractions = stress = None

    def __init__(self, functional):
        self.point = core.PointOf(functional)

    def BodyForce(self, field, elements):
        """0: domains of integration keep clear of the point."""
        return 0.0

    def Obstacle(self, point):
        """(distance, what) that a domain of integration around a point has to keep clear of."""
        return float(np.hypot(*np.subtract(self.point, point))), "a point load"


class GivenTerm:
    """One integral of a load. tractions: what it does on the faces, or None.    stress: the given stress σ⁰ that it is, or None."""

    def __init__(self, term):
        self.term, self.place = term, place_of(term)

    @cached_property
    def tractions(self):
        """FaceTractions of a term over the cracks."""
        return FaceTractions(*coefficient_of_limits(self.term)) if self.place == "crack" else None

    @cached_property
    def stress(self):
        """σ⁰ of a term -∫σ⁰:∇v."""
        S = coefficient_of_gradient(self.term) if self.place == "bulk" else None
        return None if S is None else -1 * S

    def BodyForce(self, field, elements):
        """∫ f·field over some elements (BitArray), f the body force."""
        if self.place != "bulk":
            return 0.0
        return Integrate(core.InnerIntegrals(tested(self.term, {"Id": field}.get), elements), self.term.body.mesh)

    def Obstacle(self, point):
        """(distance, what) that a domain of integration around a point has to keep clear of: a loaded inner interface."""
        if self.place != "boundary":
            return float("inf"), ""
        a, b = self._inner_interface
        return distance_to_segments(a, b, np.asarray(point)), "a loaded inner interface"

    @cached_property
    def _inner_interface(self):
        mesh = self.term.body.mesh
        chosen = elements_of(self.term)
        inner = [el for el in mesh.Elements(BND) if chosen[el.nr] and len(mesh[el.edges[0]].elements) > 1]
        return tuple(np.array([mesh[el.vertices[i]].point for el in inner]).reshape(-1, 2) for i in range(2))


@dataclass(frozen=True)
class AppliedLoad:
    """Σ factor · given: what a solution was solved for, whatever is added to the problem's forms later."""

    parts: tuple = ()

    @staticmethod
    def Of(form):
        """What a LoadForm holds now."""
        return AppliedLoad(tuple((1.0, given) for given in form.given))

    def __add__(self, other):
        return AppliedLoad(self.parts + other.parts)

    def __rmul__(self, factor):
        return AppliedLoad(tuple((factor * f, given) for f, given in self.parts))

    @cached_property
    def tractions(self):
        """The FaceTractions that are given on the cracks."""
        return sum((factor * given.tractions for factor, given in self.parts if given.tractions), FaceTractions())

    @cached_property
    def stress(self):
        """The given stress σ⁰, a 2 × 2 CoefficientFunction, or None."""
        stresses = [factor * given.stress for factor, given in self.parts if given.stress is not None]
        return sum(stresses[1:], stresses[0]) if stresses else None

    @property
    def acts_on_faces(self):
        """Whether tractions of the faces or a stress are given: else r_0 = 0."""
        return self.stress is not None or any(given.tractions for _, given in self.parts)

    def Shift(self, component, side, body):
        """r_0 of a side: the given part of what the multiplier is compared with."""
        shift = self.tractions.Shift(component, side, body)
        return shift if self.stress is None else shift + component.traction(self.stress, body)

    def BodyForce(self, field, elements):
        """∫ f·field, f the body force, over some elements (BitArray) in which the field is not zero."""
        return sum(factor * given.BodyForce(field, elements) for factor, given in self.parts if factor)

    def Obstacles(self, point):
        """What a domain of integration around a point must not meet: pairs (distance, what)."""
        return [given.Obstacle(point) for factor, given in self.parts if factor]


class StiffnessForm:
    """Bilinear terms beside ∫σ(u):ε(v): springs on ∂Ω, a foundation in the body, elastic joints on the cracks.

    V: CrackFESpace.    form += k*u*v*body.ds("bottom") or k*Jump(u)*Jump(v)*body.dcrack, u, v of V.TnT().
    Raises as LoadForm, and ValueError for terms that are not symmetric and for terms in gradients.
    """

    def __init__(self, V):
        self.V, self.terms = V, []

    def __iadd__(self, form):
        terms = checked_terms(form, self.V, NAME_A)
        for term in terms:
            check_symmetric(term)
        self.terms += terms
        return self

    def AddTo(self, form):
        """Adds the terms to an NGSolve BilinearForm."""
        for term in self.terms:
            form += term.form

    def Forces(self, u):
        """The terms as a linear form of v for a GridFunction u, an array: minus what springs and joints exert on the body."""
        operator = lambda name: u if name == "Id" else u.Operator(name)
        form = LinearForm(self.V)
        for term in self.terms:
            form += term.form.Replace(replaced(term.trial, operator))
        return form.Assemble().vec.FV().NumPy().copy() if self.terms else np.zeros(self.V.ndof)

    @property
    def joint(self):
        """The Joint of the terms over the cracks, or None."""
        terms = [term for term in self.terms if place_of(term) == "crack"]
        return Joint(terms) if terms else None


def check_symmetric(term):
    """Raises ValueError for a bilinear term without trial or test function, with gradients, or without symmetry."""
    if not term.trial or not term.test:
        raise ValueError(f"{NAME_A}: a term needs a trial and a test function, u and v of V.TnT(); loads are added to {NAME_F}")
    names = sorted({core.OperatorName(proxy) for proxy in (*term.trial, *term.test)})
    if "grad" in names:
        raise ValueError(f"{NAME_A}: terms in gradients belong to the material; here are springs and joints, terms in u, v and their limits on cracks")
    on_crack = place_of(term) == "crack"
    units = [u.Operator for pair in unit_limits() for u in pair] if on_crack else [{"Id": e}.get for e in unit_vectors()]
    form = lambda a, b: Integrate(tested(term, b).Replace(replaced(term.trial, a)), term.body.mesh)
    moments = np.array([[form(a, b) for a in units] for b in units])
    if not np.allclose(moments, moments.T, atol=1e-10 * np.abs(moments).max()):
        raise ValueError(f"{NAME_A}: a term is not symmetric in u and v; the solver needs a(u, v) = a(v, u)")
