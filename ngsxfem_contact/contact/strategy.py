"""How a contact problem is solved: its displacements eliminated by a direct solver, or found by conjugate gradients, in space with its multipliers eliminated."""

from __future__ import annotations

from contextlib import suppress
from functools import singledispatch
from typing import TYPE_CHECKING, Any

from .. import _ngsxfem_contact as core
from ..algebra.elimination import CG
from ..algebra.multigrid import is_available
from ..spaces.exchange import exchange_of
from .condensed import CondensedProblem, NotCondensed
from .iterative import IterativeProblem
from .solids import CG_PAYS, MOST_MULTIPLIERS, MOST_UNKNOWNS, size_of
from .solver import ReducedProblem

if TYPE_CHECKING:
    from .assembled import AssembledProblem
    from .problem import ContactProblem

MOST_BETWEEN = 10_000  # unknowns between processes: a dense matrix of them takes 40 s and, with its copies, 2.4 GB on each (docs/measured.md)


def assembled(problem: ContactProblem, inverse: str | None) -> AssembledProblem:
    """The problem ready to be solved by what inverse names: "cg", or a direct solver; None chooses."""
    if inverse is None:
        return chosen(problem.V, problem)
    return iterative(problem.V, problem) if inverse == CG else ReducedProblem(problem, inverse)


@singledispatch
def iterative(V: core.CrackFESpace, problem: Any) -> AssembledProblem:
    """By conjugate gradients: in the plane the multipliers are not eliminated."""
    return IterativeProblem(problem)


@iterative.register(core.SolidFESpace)
def iterative_in_space(V: core.SolidFESpace, problem: ContactProblem) -> AssembledProblem:
    """With the multipliers eliminated, as S is dense."""
    return CondensedProblem(problem)


@singledispatch
def chosen(V: core.CrackFESpace, problem: Any) -> AssembledProblem:
    """By a direct solver: in the plane factors are small. By conjugate gradients where what lies between processes is not, and pyamg is there."""
    between = exchange_of(V).NumInterface()
    if between > MOST_BETWEEN and is_available():
        with suppress(NotCondensed):
            return IterativeProblem(problem, f"{between} unknowns between processes: a dense matrix of them would cost more")
    return ReducedProblem(problem)


@chosen.register(core.SolidFESpace)
def chosen_in_space(V: core.SolidFESpace, problem: ContactProblem) -> AssembledProblem:
    """By conjugate gradients where factors or the dense matrix of the nodes would cost more, and pyamg is there; raises ValueError where neither can."""
    N, m = size_of(problem.V, problem.W, problem.law)
    too_large = N > MOST_UNKNOWNS or m > MOST_MULTIPLIERS
    if (N > CG_PAYS and is_available()) or too_large:
        try:
            return CondensedProblem(problem, f"{N} unknowns, {m} multipliers: factors would cost more")
        except (NotCondensed, NotImplementedError):
            if too_large:
                raise
    return ReducedProblem(problem)
