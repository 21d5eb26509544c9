"""The command line: `python -m ngsxfem_contact part.toml` solves a part, docs/job.md; without a file the test of the paper."""

from __future__ import annotations

import argparse
import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ngsolve import TaskManager, ngsglobals

from . import progress
from .errors import SolveError
from .files import UnreadableFile
from .job.part import EXAMPLE, read_part
from .job.results import numbers_of, summary, write_results
from .job.table import RefusedPart

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


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
    progress.tell(f"reading {options.file} ...")
    with TaskManager():
        part = read_part(options.file, options.maxh)
        folder = options.output or Path(part.output.get("folder", "."))
        if folder.exists() and not folder.is_dir():
            raise NotADirectoryError(f"{folder} is a file; give a folder for the results")
        progress.tell(f"solving for {part.problem.V.ndof} + {part.problem.W.ndof} unknowns ...")
        solutions = part.Solve()
        numbers = numbers_of(part, solutions)
        text = summary(numbers, solutions)
        print("\n" + text)
        draws = not options.no_figures and part.output.get("pictures", True) and can_draw()
        written = list(write_results(part, solutions, numbers, text, folder, draws))
    print(f"wrote {', '.join(Path(path).name for path in written)} to {folder.resolve()}")


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
    options = parse(arguments)
    if options.example:
        print(EXAMPLE.read_text(encoding="utf-8"), end="")
        return 0
    progress.say = None if options.quiet else lambda line: print(line, flush=True)
    return ending_well(lambda: run(options))


if __name__ == "__main__":
    sys.exit(main())
