"""Arguments of NGSolve's spaces that spaces on cracks take, or refuse."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

NO_FLAGS = {
    "complex": "the space is real",
    "dim": "u has as many components as the body has dimensions",
    "definedon": "the space lives on the whole body; take a mesh of the body alone",
    "dgjumps": "u is continuous off the cracks",
    "autoupdate": "the cracks are located in one mesh",
    "dirichlet_bbnd": "hold a vertex by problem.Pin(point, components)",
}


def check_flags(flags: dict[str, Any], own: Sequence[str], taken: Sequence[str]) -> None:
    """Raises ValueError for a flag of NGSolve's spaces that makes no sense here, TypeError for any other name; own: arguments beside order and material, taken: flags."""
    for name, value in flags.items():
        if name in NO_FLAGS and value:
            raise ValueError(f"CrackFESpace: {name}={value!r} is not supported; {NO_FLAGS[name]}")
        if name not in taken and name not in NO_FLAGS:
            allowed = ["order", *own, "material", *taken]
            meant = get_close_matches(name, allowed, 1)
            raise TypeError(
                f"CrackFESpace: there is no argument {name!r}{f' (did you mean {meant[0]!r}?)' if meant else ''}; it takes body, {', '.join(allowed)}"
            )


def joined_names(pattern: Any) -> Any:
    """One regular expression for a list of them; what is none is left to check_regions."""
    return "|".join(pattern) if isinstance(pattern, (list, tuple)) and all(isinstance(name, str) for name in pattern) else pattern
