"""Arguments that make no sense are refused where they are given: what is wrong, its value, what it must be."""

from __future__ import annotations

from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CoefficientFunction

from ._ngsxfem_contact import CrackedSolid

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence, Sized

    from ngsolve import Mesh

    from ._ngsxfem_contact import Crack, CrackedMesh

INFINITY = float("inf")


def check_number(value: Any, name: str, holds: Callable[[Any], bool] = lambda value: -INFINITY < value < INFINITY, must: str = "be finite") -> None:
    """Raises TypeError for what is no number, ValueError unless holds(value); write conditions that NaN does not fulfil."""
    if not isinstance(value, Real):
        raise TypeError(f"{name}={value!r} is not a number")
    if not holds(value):
        raise ValueError(f"{name}={value} must {must}")


def check_positive(value: Any, name: str, hint: str = "") -> None:
    """Raises unless value is a number, 0 < value < inf."""
    check_number(value, name, lambda number: 0 < number < INFINITY, f"be positive and finite{hint}")


def check_whole(value: Any, name: str, least: int) -> None:
    """Raises unless value is a whole number, at least `least`."""
    if not isinstance(value, int | np.integer):
        raise TypeError(f"{name}={value!r} is not a whole number")
    if value < least:
        raise ValueError(f"{name}={value} must be {least} or more")


def check_item(number: Any, items: Sized, what: str, where: str) -> None:
    """Raises ValueError unless number is that of an item, counted from the first one."""
    if not isinstance(number, int | np.integer) or not 0 <= number < len(items):
        raise ValueError(f"there is no {what} {number!r}; {where} has {len(items)}, counted from 0")


def crack_number(crack: Any, body: CrackedMesh | CrackedSolid) -> int:
    """The number of a crack that is given by its number or its name. Raises ValueError if there is none."""
    if isinstance(crack, str) and not isinstance(body, CrackedSolid):  # sheets have no names
        return body.CrackNumber(crack)
    check_item(crack, body.cracks, "crack", "body.cracks")
    return int(crack)


def crack_title(cracks: Sequence[Crack], number: int) -> str:
    """A crack in a message: its number, and its name if it has one."""
    name = cracks[number].name
    return f"crack {number}" + (f" '{name}'" if name else "")


def check_type(value: Any, types: Any, name: str, must: str) -> None:
    """Raises TypeError unless value is an instance of one of the types; must: what it has to be, in words."""
    if not isinstance(value, types):
        raise TypeError(f"{name}={repr(value).partition(chr(10))[0]} is not {must}")


def check_has(value: Any, member: str, name: str, must: str) -> None:
    """Raises TypeError unless value has a member, which tells objects of layers above; must: what it has to be, in words."""
    if not hasattr(value, member):
        raise TypeError(f"{name}={repr(value).partition(chr(10))[0]} is not {must}")


def is_function(value: Any) -> bool:
    """Whether NGSolve takes a value for a real CoefficientFunction; it does not survive None."""
    if isinstance(value, (tuple, list, np.ndarray)):
        return len(value) > 0 and all(map(is_function, value))
    return isinstance(value, Real) or (isinstance(value, CoefficientFunction) and not value.is_complex)


def check_function(value: Any, name: str, dim: int) -> CoefficientFunction:
    """The CoefficientFunction of a value; raises TypeError for what is none, ValueError unless it has `dim` components."""
    if not is_function(value):
        raise TypeError(f"{name}={value!r} is neither a number nor a CoefficientFunction")
    function = CoefficientFunction(tuple(value) if isinstance(value, (list, np.ndarray)) else value)
    if function.dim != dim:
        raise ValueError(f"{name} has {function.dim} component(s), it must {'be a scalar' if dim == 1 else f'have {dim}'}")
    return function


def check_regions(mesh: Mesh, pattern: Any, what: str) -> None:
    """Raises TypeError for what is no pattern of boundary names, ValueError if it matches nothing."""
    check_type(pattern, str, what, "the name of a boundary, or a regular expression")
    if not mesh.Boundaries(pattern).Mask().NumSet():
        raise ValueError(f"{what}={pattern!r} matches no boundary; the mesh has {sorted(set(mesh.GetBoundaries()))}")
