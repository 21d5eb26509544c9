"""Whether a load is still the one that was solved for: its coefficients may be Parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..spaces.exchange import exchange_of

if TYPE_CHECKING:
    from .._ngsxfem_contact import CrackFESpace
    from .load import LoadTerms


def check_unchanged(load: LoadTerms, F: np.ndarray, V: CrackFESpace, when: str) -> None:
    """Raises ValueError if the coefficients of an LoadTerms do not give F any more."""
    if not is_unchanged(load, F, V):
        raise ValueError(
            f"a coefficient of the load, such as a Parameter, has changed since {when}, and what is asked needs its value then: set it back, or make it anew"
        )


def is_unchanged(load: LoadTerms, F: np.ndarray, V: CrackFESpace) -> bool:
    """Whether the coefficients of a LoadTerms still give F."""
    exchange = exchange_of(V)
    now, before = (exchange.Cumulated(values) for values in (load.Vector(V), F))
    off, size = np.abs(now - before).max(initial=0), np.abs(before).max(initial=0)
    return bool(exchange.Max(off) <= 2e-9 * exchange.Max(size))
