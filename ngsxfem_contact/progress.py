"""What is being done, said on anything that takes more than two seconds.

from ngsxfem_contact import progress
progress.say = None      # silent
progress.say = print     # to the standard output instead of the standard error
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENCE = 2.0  # seconds, before the first line and between two lines


def to_stderr(line: str) -> None:
    """Prints a line beside the results of a script."""
    print(line, file=sys.stderr, flush=True)


say: Callable[[str], object] | None = to_stderr
_doing: list[str] = []


def tell(line: str) -> None:
    """Says a line now, unless `say` is None."""
    if say is not None:
        say(line)


@contextmanager
def doing(what: str) -> Iterator[None]:
    """Names what the block does: said if it, or the work that it is a part of, takes more than PATIENCE seconds."""
    finished = Event()
    _doing.append(what)
    if len(_doing) == 1 and say is not None:
        Thread(target=_watch, args=(finished,), daemon=True).start()
    try:
        yield
    finally:
        _doing.remove(what)
        finished.set()


def _watch(finished: Event) -> None:
    start, last = perf_counter(), ""
    while not finished.wait(PATIENCE):
        line = ": ".join(_doing)
        if not last.startswith(line):  # nothing new where only the innermost work has ended
            tell(f"{perf_counter() - start:6.0f} s  {line}")
            last = line
