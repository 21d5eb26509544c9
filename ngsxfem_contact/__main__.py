"""The command line: `python -m ngsxfem_contact` solves the paper's test and writes what it found; `... study` does all of section 4."""

import argparse
import io
import json
import logging
import sys
from contextlib import contextmanager, nullcontext
from pathlib import Path

from ngsolve import TaskManager, ngsglobals

from .contact.stabilisation import BarbosaHughes
from .errors import SolveError
from .files import UnreadableFile, write_whole
from .study.figures import fitted_rates
from .study.figures import write_figures as write_figures_of_study
from .study.paper import PAIRS, REFERENCE, TRACTION, paper_problem, unstructured_mesh
from .study.study import REFERENCE_CELLS, SIZES, Study

JOBS = ("paper", "study")
logger = logging.getLogger(f"{__package__}.command")
study_logger = logging.getLogger(f"{__package__}.study")


def parse(arguments):
    """The options of a command line; ends with a message where one makes no sense."""
    parser = argparse.ArgumentParser(
        prog="python -m ngsxfem_contact",
        description="Contact on a crack: the numerical section of Amdouni, Hild, Lleras, Moakher, Renard (ESAIM: M2AN 46, 2012). Without a job: paper.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    jobs = parser.add_subparsers(dest="job", metavar="job")
    paper = jobs.add_parser("paper", help="solve the test once: summary, VTK with the crack open, figures (default)")
    add_paper_options(paper)
    parser.epilog = paper.format_help()
    add_study_options(
        jobs.add_parser("study", help="all pairs and meshes against a fine reference: errors, rates, the paper's figures; goes on where it was stopped")
    )
    arguments = sys.argv[1:] if arguments is None else arguments
    if not set(arguments[:1]) & {*JOBS, "-h", "--help"}:
        arguments = ["paper", *arguments]
    options = parser.parse_args(arguments)
    check = {"paper": check_paper_options, "study": check_study_options}[options.job]
    check(parser, options)
    return options


def add_paper_options(parser):
    """Those of `paper`."""
    parser.description = "A unit square with an edge crack that closes near its tip. Writes a summary, a VTK file with the crack open, and figures."
    parser.add_argument("--h", type=float, default=0.03, help="mesh size in the paper's sense, half the longest edge (default 0.03)")
    parser.add_argument("--pair", choices=PAIRS, default="P2/P1", help="displacement/multiplier (default P2/P1)")
    parser.add_argument(
        "--load", choices=TRACTION, default="B", help="B: the paper's computation (default); C: ten times its traction; A: as printed, no contact"
    )
    parser.add_argument("--cone", choices=["nonpositive", "weak"], default="nonpositive", help="of the multipliers (default nonpositive)")
    parser.add_argument("--gamma0", type=float, help="γ = gamma0 h_T instead of the largest safe γ of each element")
    parser.add_argument("--unstabilised", action="store_true", help="no Barbosa-Hughes terms")
    parser.add_argument("--output", type=Path, default=Path("."), help="folder for the results (default: this one)")
    add_common_options(parser)


def check_paper_options(parser, options):
    """Ends with a message for numbers that no mesh or γ can have."""
    if not 0 < options.h <= 0.5:
        parser.error(f"--h {options.h}: must be positive and at most 0.5")
    if options.gamma0 is not None and not 0 < options.gamma0 < float("inf"):
        parser.error(f"--gamma0 {options.gamma0}: must be positive; --unstabilised switches the stabilisation off")
    if options.unstabilised and options.gamma0 is not None:
        parser.error("--gamma0 and --unstabilised exclude each other")


def check_study_options(parser, options):
    """Ends with a message for numbers that no study can have."""
    for h in options.sizes:
        if not 0 < h <= 0.5:
            parser.error(f"--sizes {h}: must be positive and at most 0.5")
    if options.realisations < 1:
        parser.error(f"--realisations {options.realisations}: must be 1 or more")
    if options.cells < 3 or options.cells % 2 == 0:
        parser.error(f"--cells {options.cells}: must be odd, 3 or more, so that the crack crosses cells")


def add_study_options(parser):
    """Those of `study`."""
    parser.description = "Errors of all pairs on all meshes against a fine P2/P1 solution. Every finished solve is kept: run it again to go on."
    parser.add_argument("--output", type=Path, default=Path("study"), help="folder for the results (default: study)")
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES, help=f"mesh sizes h of the paper (default {' '.join(map(str, SIZES))})")
    parser.add_argument("--realisations", type=int, default=5, help="meshes of each size (default 5)")
    parser.add_argument("--structured", action="store_true", help="structured meshes instead of unstructured ones")
    parser.add_argument(
        "--cells", type=int, default=REFERENCE_CELLS, help=f"cells of the reference along a side, odd (default {REFERENCE_CELLS}: the paper's h = 0.0027)"
    )
    add_common_options(parser)


def add_common_options(parser):
    """What all jobs understand."""
    parser.add_argument("--no-figures", action="store_true", help="no figures (matplotlib is not needed then)")
    parser.add_argument("--quiet", action="store_true", help="say nothing while it runs")


def stress_intensity(solution):
    """By the interaction integral, or from the modes on meshes too coarse for its disks."""
    try:
        return solution.StressIntensity()
    except ValueError as reason:
        print(f"K from the coefficients of the modes: {reason}")
        return solution.StressIntensity(method="modes")


def results_of(solution, options):
    """The numbers of a solution, for JSON."""
    intensity = stress_intensity(solution)
    report = solution.report
    return {
        "load": options.load,
        "pair": options.pair,
        "h": options.h,
        "stabilised": solution.gamma is not None,
        "triangles": solution.body.mesh.ne,
        "unknowns": list(report.unknowns),
        "iterations": report.iterations,
        "residual": report.residual,
        "complementarity": report.complementarity,
        "energy": solution.Energy(),
        "contact_force": solution.ContactForce(),
        "transitions": [float(s) for s in solution.Transitions()],
        "K_I": intensity.K_I,
        "K_II": intensity.K_II,
        "reference": REFERENCE[options.load],
        "seconds": report.timings,
    }


def summary(results, report):
    """The results as text, beside the reference."""
    reference = results["reference"]
    row = lambda name, value, exact: f"  {name:26}{value:>16.8g}   {'-' if exact is None else format(exact, '.8g')}"
    lines = [
        f"Load {results['load']}, {results['pair']}, h = {results['h']:g}, {results['triangles']} triangles, "
        + ("stabilised" if results["stabilised"] else "not stabilised"),
        f"  {'':26}{'computed':>16}   reference (boundary-fitted)",
        row("energy ½a(u,u)", results["energy"], reference["energy"]),
        row("contact force ∫λ", results["contact_force"], reference["contact_force"]),
        *(row("contact begins or ends, s", s, reference["transition"]) for s in results["transitions"]),
        row("K_I", results["K_I"], reference["K_I"]),
        row("K_II", results["K_II"], reference["K_II"]),
        "",
        str(report),
    ]
    return "\n".join(lines) + "\n"


def can_draw():
    """Whether there is matplotlib; says so if there is none."""
    try:
        import matplotlib
    except ImportError:
        print("no figures: they need matplotlib, run `pip install ngsxfem_contact[plot]` and this command again", file=sys.stderr)
        return False
    matplotlib.use("Agg")
    return True


def write_figures(solution, folder):
    """body.png and profile.png."""
    import matplotlib.pyplot as plt

    from .pictures.plotting import plot_body, plot_profile

    figure, ax = plt.subplots(figsize=(6.5, 6), layout="constrained")
    plot_body(solution, ax)
    yield write_whole(folder / "body.png", lambda path: figure.savefig(path, dpi=150))
    figure, axes = plt.subplots(2, 1, figsize=(6.5, 5), sharex=True, layout="constrained")
    plot_profile(solution, ax=axes)
    yield write_whole(folder / "profile.png", lambda path: figure.savefig(path, dpi=150))


def run_study(options):
    """The convergence study: study.jsonl, study.csv, rates.json and figures; the exit code."""
    study = Study(options.output, options.sizes, options.realisations, options.structured, options.cells, study_logger.info)
    records = study.Run()
    rates = fitted_rates(records)
    text = json.dumps(rates, indent=1)
    write_whole(options.output / "rates.json", lambda path: path.write_text(text, encoding="utf-8"))
    print(rates_table(rates))
    draws = not options.no_figures and can_draw()
    if draws:
        write_figures_of_study(options.output, records, study.reference.Solution())
    print(f"wrote study.jsonl, study.csv, rates.json{' and figures' if draws else ''} to {options.output.resolve()}")
    return 0


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


def run_paper(options):
    """Solves, writes, and says so; the exit code."""
    options.output.mkdir(parents=True, exist_ok=True)
    stabilisation = None if options.unstabilised else BarbosaHughes(options.gamma0)
    logger.info("meshing with h = %g", options.h)
    problem = paper_problem(unstructured_mesh(options.h), options.load, options.pair, stabilisation, options.cone)
    logger.info("solving for %d + %d unknowns", problem.V.ndof, problem.W.ndof)
    with TaskManager():
        solution = problem.Solve()
    results = results_of(solution, options)
    text = summary(results, solution.report)
    print("\n" + text)
    written = [
        write_whole(options.output / "summary.txt", lambda path: path.write_text(text, encoding="utf-8")),
        write_whole(options.output / "summary.json", lambda path: path.write_text(json.dumps(results, indent=1), encoding="utf-8")),
        solution.SaveVTK(options.output / "solution.vtu"),
    ]
    if not options.no_figures and can_draw():
        written += write_figures(solution, options.output)
    print(f"wrote {', '.join(Path(path).name for path in written)} to {options.output.resolve()}")
    return 0


class WithSeconds(logging.Formatter):
    """Lines that begin with the seconds since the start."""

    def format(self, record):
        """The line of a record."""
        return f"{record.relativeCreated / 1000:7.1f} s  {super().format(record)}"


@contextmanager
def shown(name):
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


def say_what_can_be_said():
    """Characters that a terminal lacks (γ, ²) become question marks, no errors."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def main(arguments=None):
    """Runs a command line; returns its exit code: 0, 1 without an answer, 130 after Ctrl-C."""
    ngsglobals.msg_level = 0
    say_what_can_be_said()
    try:
        options = parse(arguments)
        run = {"paper": run_paper, "study": run_study}[options.job]
        with nullcontext() if options.quiet else shown(__package__ if options.job == "paper" else study_logger.name):
            return run(options)
    except (SolveError, ImportError, OSError, UnreadableFile) as error:
        print(f"no answer: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
