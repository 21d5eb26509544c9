"""What the documents show: files in benchmarks/results/, each written by one command.

Every script takes --results NAME: what it prints goes to benchmarks/results/NAME.txt, too, below the command, the date and the versions.
"""

import argparse
import contextlib
import io
import os
import shlex
import sys
from datetime import date
from importlib.metadata import version
from pathlib import Path

from ngsolve import SetNumThreads

FOLDER = Path(__file__).resolve().parent / "results"


class Both(io.TextIOBase):
    """A stream that writes to several."""

    def __init__(self, *streams):
        self.streams = streams

    def write(self, text):
        return [stream.write(text) for stream in self.streams][-1]

    def flush(self):
        for stream in self.streams:
            stream.flush()


def heading(arguments):
    """The two lines above the figures: the command that writes them, and with what it did."""
    versions = f"ngsxfem_contact {version('ngsxfem_contact')}, NGSolve {version('ngsolve')}"
    return f"# python benchmarks/{shlex.join(arguments)}\n# measured with {versions} on {date.today()}, {os.cpu_count()} cores\n"


def cases_of(description, cases, realisations=10):
    """The arguments of a benchmark that does some of its cases, each for a number of realisations."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=cases)
    parser.add_argument("--realisations", type=int, default=realisations)
    return parser.parse_args()


def run_cases(description, cases, realisations=10):
    """Calls those of the functions `cases` that the command line names, by default all, with the number of realisations."""
    by_name = {case.__name__: case for case in cases}
    arguments = cases_of(description, list(by_name), realisations)
    SetNumThreads(1)
    for name in arguments.cases:
        by_name[name](arguments.realisations)


def recorded(main, folder=FOLDER):
    """Runs main; with --results NAME on the command line keeps what it prints, if it comes to its end."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--results", metavar="NAME")
    found, rest = parser.parse_known_args()
    arguments, sys.argv[1:] = [Path(sys.argv[0]).name, *sys.argv[1:]], rest
    if found.results is None:
        return main()
    kept = io.StringIO()
    with contextlib.redirect_stdout(Both(sys.stdout, kept)):
        main()
    folder.mkdir(exist_ok=True)
    (folder / f"{found.results}.txt").write_text(heading(arguments) + kept.getvalue(), encoding="utf-8")
