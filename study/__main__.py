"""The command line of the study: all pairs and meshes against a fine reference. It goes on where it was stopped."""

import argparse
import json
import logging
import sys
from contextlib import nullcontext
from pathlib import Path

from ngsolve import ngsglobals

from ngsxfem_contact.__main__ import can_draw, ending_well, shown
from ngsxfem_contact.files import write_whole

from .figures import fitted_rates, write_figures
from .study import REFERENCE_CELLS, SIZES, Study

logger = logging.getLogger(__package__)


def parse(arguments):
    """The options of a command line; ends with a message where one makes no sense."""
    parser = argparse.ArgumentParser(
        prog="python -m study",
        description="The numerical section of Amdouni, Hild, Lleras, Moakher, Renard (ESAIM: M2AN 46, 2012): errors of all pairs on all meshes against "
        "a fine P2/P1 solution, rates, the paper's figures. Every finished solve is kept: run it again to go on.",
    )
    parser.add_argument("--output", type=Path, default=Path("results/study"), help="folder for the results (default: results/study)")
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES, help=f"mesh sizes h of the paper (default {' '.join(map(str, SIZES))})")
    parser.add_argument("--realisations", type=int, default=5, help="meshes of each size (default 5)")
    parser.add_argument("--structured", action="store_true", help="structured meshes instead of unstructured ones")
    parser.add_argument(
        "--cells", type=int, default=REFERENCE_CELLS, help=f"cells of the reference along a side, odd (default {REFERENCE_CELLS}: the paper's h = 0.0027)"
    )
    parser.add_argument("--no-figures", action="store_true", help="no figures (matplotlib is not needed then)")
    parser.add_argument("--quiet", action="store_true", help="say nothing while it runs")
    options = parser.parse_args(arguments)
    check(parser, options)
    return options


def check(parser, options):
    """Ends with a message for numbers that no study can have."""
    for h in options.sizes:
        if not 0 < h <= 0.5:
            parser.error(f"--sizes {h}: must be positive and at most 0.5")
    if options.realisations < 1:
        parser.error(f"--realisations {options.realisations}: must be 1 or more")
    if options.cells < 3 or options.cells % 2 == 0:
        parser.error(f"--cells {options.cells}: must be odd, 3 or more, so that the crack crosses cells")


def run(options):
    """study.jsonl, study.csv, rates.json and figures."""
    study = Study(options.output, options.sizes, options.realisations, options.structured, options.cells, logger.info)
    records = study.Run()
    rates = fitted_rates(records)
    text = json.dumps(rates, indent=1)
    write_whole(options.output / "rates.json", lambda path: path.write_text(text, encoding="utf-8"))
    print(rates_table(rates))
    draws = not options.no_figures and can_draw()
    if draws:
        write_figures(options.output, records, study.reference.solution)
    print(f"wrote study.jsonl, study.csv, rates.json{' and figures' if draws else ''} to {options.output.resolve()}")


def rates_table(rates):
    """The fitted rates as text."""
    names = ("L2", "H1", "energy", "multiplier", "norm")
    lines = [f"{'pair':9}{'stabilisation':14}{'cone':13}{'mesh':14}" + "".join(f"{name:>12}" for name in names)]
    for rate in rates:
        lines.append(
            f"{rate['pair']:9}{rate['stabilisation']:14}{rate['cone']:13}{rate['mesh']:14}"
            + "".join("           -" if rate[name] is None else f"{rate[name]:12.2f}" for name in names)
        )
    return "\n".join(lines)


def main(arguments=None):
    """Runs a command line; returns its exit code: 0, 1 without an answer, 130 after Ctrl-C."""
    ngsglobals.msg_level = 0
    options = parse(arguments)
    with nullcontext() if options.quiet else shown(logger.name):
        return ending_well(lambda: run(options))


if __name__ == "__main__":
    sys.exit(main())
