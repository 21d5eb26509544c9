"""Loads, springs and supports of a problem on another space of the same body, such as one of higher order: the same functionals of other test functions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import LinearForm

from .. import _ngsxfem_contact as core
from ..pickling import functional_of, operator_of, proxy_of
from .load import PointLoad, assembled
from .supports import Supports
from .terms import replaced, tested

if TYPE_CHECKING:
    from collections.abc import Callable

    from ngsolve import BilinearForm, CoefficientFunction, GridFunction
    from ngsolve.comp import SumOfIntegrals
    from ngsolve.fem import PointEvaluationFunctional

    from .._ngsxfem_contact import CrackFESpace
    from .load import GivenTerm, LoadTerms, StiffnessForm


def load_on(load: LoadTerms, space: CrackFESpace) -> np.ndarray:
    """F of LoadTerms on another space, with the values that coefficients have now."""
    return assembled(load, space, lambda given: given_on(given, space))


def given_on(given: GivenTerm | PointLoad, space: CrackFESpace) -> SumOfIntegrals | PointEvaluationFunctional:
    """One part of a load."""
    if not isinstance(given, PointLoad):
        return tested(given.term, functions_of(space, True))
    (term,) = core.TermsOf(core.FunctionOf(given.form) * space.body.dx)
    return functional_of(tested(term, functions_of(space, True))[0].coef, given.point)


def functions_of(space: CrackFESpace, is_test: bool) -> Callable[[str], CoefficientFunction]:
    """The test (or trial) function of a space with an operator, by the operator's name."""
    return lambda name: proxy_of(space, is_test, name)


def add_springs(form: BilinearForm, springs: StiffnessForm) -> None:
    """Adds the terms of a StiffnessForm to a bilinear form on another space."""
    for term in springs.terms:
        trial, test = (replaced(functions, functions_of(form.space, functions is term.test)) for functions in (term.trial, term.test))
        form += term.form.Replace(trial | test)


def spring_forces_on(springs: StiffnessForm, u: GridFunction, space: CrackFESpace) -> np.ndarray:
    """The terms of a StiffnessForm for u, a linear form on another space."""
    form = LinearForm(space)
    for term in springs.terms:
        trial = replaced(term.trial, lambda name: u if name == "Id" else operator_of(u, name))
        form += term.form.Replace(trial | replaced(term.test, functions_of(space, True)))
    return form.Assemble().vec.FV().NumPy().copy() if springs.terms else np.zeros(space.ndof)


def supports_on(supports: Supports, space: CrackFESpace) -> Supports:
    """The same displacements given on the same boundaries and at the same vertices."""
    supports.Update()
    there = Supports(space)
    for function in supports.functions:
        there.SetDirichlet(function.value, function.region)
    for vertex, component, value in supports.pins.values():
        there.PinVertex(vertex, {component: value})
    return there
