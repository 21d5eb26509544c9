"""The command line: `python -m ngsxfem_contact part.toml` solves a part, docs/job.md; without a file the test of the paper."""

from __future__ import annotations

import argparse
import importlib.util
import io
import logging
import sys
import warnings
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ngsolve import TaskManager, ngsglobals

from .errors import AccuracyWarning, SolveError
from .files import UnreadableFile
from .job.part import EXAMPLE, read_part
from .job.results import numbers_of, summary, write_results
from .job.table import RefusedPart
from .processes import num_started

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

logger = logging.getLogger(f"{__package__}.command")


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The options of a command line; ends with a message where one makes no sense."""
    parser = argparse.ArgumentParser(
        prog="python -m ngsxfem_contact",
        description="Contact on the cracks of an elastic body. Writes a summary, profiles along the cracks, VTK files with the cracks open, and pictures.",
        allow_abbrev=False,
    )
    parser.add_argument("file", nargs="?", type=Path, default=EXAMPLE, help="TOML file of a part, see docs/job.md (default: the paper's test, see --example)")
    parser.add_argument("--example", action="store_true", help="print the file of the paper's test, to begin with, and end")
    parser.add_argument("--maxh", type=float, help="mesh size instead of that of the file, where its mesh is a rectangle")
    parser.add_argument("--output", type=Path, help="folder for the results (default: that of the file, or this one)")
    parser.add_argument("--no-figures", action="store_true", help="no pictures (matplotlib is not needed then)")
    parser.add_argument("--quiet", action="store_true", help="say nothing while it runs")
    return parser.parse_args(arguments)


def can_draw() -> bool:
    """Whether there is matplotlib; says so if there is none."""
    try:
        import matplotlib
    except ImportError:
        print("no figures: they need matplotlib, run `pip install ngsxfem_contact[plot]` and this command again", file=sys.stderr)
        return False
    matplotlib.use("Agg")
    return True


def run(options: argparse.Namespace) -> None:
    """Solves, writes, and says so."""
    logger.info("reading %s", options.file)
    with TaskManager(), warnings_said() as said:
        part = read_part(options.file, options.maxh)
        folder = options.output or Path(part.output.get("folder", "."))
        if folder.exists() and not folder.is_dir():
            raise NotADirectoryError(f"{folder} is a file; give a folder for the results")
        logger.info("solving for %d + %d unknowns", part.problem.V.ndof, part.problem.W.ndof)
        solutions = part.Solve()
        numbers = numbers_of(part, solutions) | {"warnings": said}
        text = summary(numbers, solutions)
        print("\n" + text)
        draws = not options.no_figures and part.output.get("pictures", True) and can_draw()
        written = list(write_results(part, solutions, numbers, text, folder, draws))
    print(f"wrote {', '.join(Path(path).name for path in written)} to {folder.resolve()}")


class WithSeconds(logging.Formatter):
    """Lines that begin with the seconds since the start."""

    def format(self, record: logging.LogRecord) -> str:
        """The line of a record."""
        return f"{record.relativeCreated / 1000:7.1f} s  {super().format(record)}"


@contextmanager
def shown(name: str) -> Iterator[None]:
    """Prints what the logger of this name says, from INFO, while the block runs."""
    source, handler = logging.getLogger(name), logging.StreamHandler(sys.stdout)
    level = source.level
    handler.setFormatter(WithSeconds())
    source.addHandler(handler)
    source.setLevel(logging.INFO)
    try:
        yield
    finally:
        source.removeHandler(handler)
        source.setLevel(level)


@contextmanager
def warnings_said() -> Iterator[list[str]]:
    """Says the AccuracyWarnings of the block, each once, as lines without the code that they came from; the list of them, as far as it got."""
    said: list[str] = []

    def say(message: Warning | str, category: type[Warning], *where: Any, **options: Any) -> None:
        if not issubclass(category, AccuracyWarning):
            otherwise(message, category, *where, **options)
        elif str(message) not in said:
            said.append(str(message))
            print(f"warning: {message}", file=sys.stderr)

    with warnings.catch_warnings():
        otherwise = warnings.showwarning
        warnings.showwarning = say
        yield said


def say_what_can_be_said() -> None:
    """Characters that a terminal lacks (γ, ²) become question marks, no errors."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def ending_well(job: Callable[[], None]) -> int:
    """Calls a job; the exit code: 0, 1 without an answer, 2 for a part's file that is refused, 130 after Ctrl-C."""
    say_what_can_be_said()
    try:
        job()
        return 0
    except RefusedPart as error:
        print(f"refused: {error}", file=sys.stderr)
        return 2
    except (SolveError, ImportError, OSError, UnreadableFile) as error:
        print(f"no answer: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command line; returns its exit code."""
    ngsglobals.msg_level = 0
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments[:1] == ["study"]:
        return main_of_study(arguments[1:])
    options = parse(arguments)
    if options.example:
        print(EXAMPLE.read_text(encoding="utf-8"), end="")
        return 0
    if (number := num_started()) > 1:
        print(
            f"refused: this is one of {number} processes, and files of parts are solved by one: leave mpirun out, or write a script with DistributedMesh",
            file=sys.stderr,
        )
        return 2
    with nullcontext() if options.quiet else shown(__package__):
        return ending_well(lambda: run(options))


def main_of_study(arguments: Sequence[str]) -> int:
    """`python -m study`, where the sources of the package are at hand; returns its exit code."""
    if importlib.util.find_spec("study") is None:
        print(
            "there is no `study` here: it lies beside the package, in its sources; run `python -m study` in their folder, with the environment of its `make`",
            file=sys.stderr,
        )
        return 2
    from study.__main__ import main

    return main(arguments)


if __name__ == "__main__":
    sys.exit(main())
