"""Tables of a part's file: every key is known, has the type that it must have, and is there if it must be."""

from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeAlias

from netgen.meshing import NgException
from ngsolve import CF, x, y

from .formula import NoFormula, evaluated

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from ngsolve import CoefficientFunction

    from ..material import Coefficient

    Kind: TypeAlias = Callable[[Any], Any]  # converts a value of the file; raises Wrong for one that it cannot be


class RefusedPart(ValueError):
    """A part's file says what cannot be meant; the message names file, table and key, and what is allowed."""


class Wrong(ValueError):
    """A value is not what its key needs; the message goes on after "must be"."""


@dataclass(frozen=True)
class Table:
    """values: of the file.

    Parameters
    ----------
    name
        Of the table, in messages.
    file
        The path of the file.
    """

    values: dict[str, Any]
    name: str
    file: Path

    def Refuse(self, why: str, key: str | None = None) -> NoReturn:
        """Raises RefusedPart."""
        raise RefusedPart(f"{self.file}: {self.name}{'' if key is None else f', {key}'}: {why}")

    def Take(self, kinds: Mapping[str, Kind], required: Sequence[str] = ()) -> dict[str, Any]:
        """The values, converted by kinds: key → a function that raises Wrong for what the key cannot have."""
        for key in self.values:
            if key not in kinds:
                meant = get_close_matches(key, kinds, 1)
                self.Refuse(f"there is no such key{f', did you mean {meant[0]!r}?' if meant else ''}; allowed are {', '.join(kinds)}", key)
        for key in required:
            if key not in self.values:
                self.Refuse(f"the key is missing; the table must have {', '.join(required)}", key)
        return {key: self.Convert(key, kinds[key]) for key in self.values}

    def Convert(self, key: str, kind: Kind) -> Any:
        """One value."""
        try:
            return kind(self.values[key])
        except Wrong as wrong:
            self.Refuse(f"{self.values[key]!r} must be {wrong}", key)
        except NoFormula as error:
            self.Refuse(str(error), key)

    def OneOf(self, keys: Iterable[str]) -> str:
        """The one of some keys that the table has."""
        found = [key for key in keys if key in self.values]
        if len(found) != 1:
            self.Refuse(f"it has {' and '.join(found) or 'none'} of {', '.join(keys)}; give exactly one of them")
        return found[0]

    @contextmanager
    def Blamed(self) -> Iterator[None]:
        """What the package refuses inside the block is refused by this table."""
        try:
            yield
        except RefusedPart:
            raise
        except (ValueError, TypeError, NgException) as error:
            self.Refuse(str(error))


# Kinds of values


def number(value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise Wrong("a finite number")
    return value


def whole(value: Any) -> int:
    """A whole number."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise Wrong("a whole number")
    return value


def which(value: Any) -> int | str:
    """A crack, by its number or its name."""
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise Wrong("the number of a crack, or its name in quotes")
    return value


def boolean(value: Any) -> bool:
    """true or false."""
    if not isinstance(value, bool):
        raise Wrong("true or false")
    return value


def text(value: Any) -> str:
    """A string that is not empty."""
    if not isinstance(value, str) or not value.strip():
        raise Wrong("a text in quotes")
    return value


def choice(*names: str) -> Kind:
    """One of some texts."""

    def kind(value: Any) -> Any:
        if value not in names:
            raise Wrong(f"one of {', '.join(map(repr, names))}")
        return value

    return kind


def array(kind: Kind, what: str, least: int = 1, most: int | None = None) -> Kind:
    """A list of values of a kind; what: it is, in words."""

    def of(value: Any) -> Any:
        if not isinstance(value, list) or len(value) < least or (most is not None and len(value) > most):
            raise Wrong(what)
        try:
            return [kind(entry) for entry in value]
        except Wrong:
            raise Wrong(what) from None

    return of


point = array(number, "a point [x, y]", 2, 2)
points = array(point, "a list of two or more points [[x, y], ...]", 2)


def formula(value: Any) -> Coefficient:
    """A number, or a formula in x and y: a number or a CoefficientFunction."""
    if isinstance(value, str):
        return evaluated(value, {"x": x, "y": y})
    try:
        return number(value)
    except Wrong:
        raise Wrong("a finite number, or a formula in x and y in quotes") from None


two_formulas = array(formula, "two numbers or formulas [x, y]", 2, 2)


def vector(value: Any) -> CoefficientFunction:
    """Two formulas: a CoefficientFunction with two components."""
    return CF(tuple(two_formulas(value)))


def subtable(value: Any) -> dict[str, Any]:
    """A table in a table."""
    if not isinstance(value, dict):
        raise Wrong("a table")
    return value


def tables(value: Any) -> list[dict[str, Any]]:
    """A list of tables."""
    if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
        raise Wrong("a list of tables: write the header in double brackets")
    return value
