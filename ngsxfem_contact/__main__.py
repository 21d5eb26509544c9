"""The command line: `python -m ngsxfem_contact` solves the paper's test and writes what it found."""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

from ngsolve import TaskManager, ngsglobals

from .errors import SolveError
from .paper import PAIRS, REFERENCE, TRACTION, paper_problem, unstructured_mesh
from .stabilisation import BarbosaHughes


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="python -m ngsxfem_contact",
        description="Solves the crack problem of section 4 of Amdouni, Hild, Lleras, Moakher, Renard (ESAIM: M2AN 46, 2012): a unit square "
        "with an edge crack that closes near its tip. Writes a summary, a VTK file with the crack open, and figures.",
    )
    parser.add_argument("--h", type=float, default=0.03, help="mesh size in the paper's sense, half the longest edge (default 0.03)")
    parser.add_argument("--pair", choices=PAIRS, default="P2/P1", help="displacement/multiplier (default P2/P1)")
    parser.add_argument("--load", choices=TRACTION, default="B", help="B: the paper's computation (default); C: ten times its traction; A: as printed, no contact")
    parser.add_argument("--cone", choices=["nonpositive", "weak"], default="nonpositive", help="of the multipliers (default nonpositive)")
    parser.add_argument("--gamma0", type=float, help="γ = gamma0 h_T instead of the largest safe γ of each element")
    parser.add_argument("--unstabilised", action="store_true", help="no Barbosa-Hughes terms")
    parser.add_argument("--output", type=Path, default=Path("."), help="folder for the results (default: this one)")
    parser.add_argument("--no-figures", action="store_true", help="no figures (matplotlib is not needed then)")
    options = parser.parse_args(arguments)
    if not 0 < options.h <= 0.5:
        parser.error(f"--h {options.h}: must be positive and at most 0.5")
    if options.gamma0 is not None and not 0 < options.gamma0 < float("inf"):
        parser.error(f"--gamma0 {options.gamma0}: must be positive; --unstabilised switches the stabilisation off")
    if options.unstabilised and options.gamma0 is not None:
        parser.error("--gamma0 and --unstabilised exclude each other")
    return options


def results_of(solution, options):
    """The numbers of a solution, for JSON."""
    K_I, K_II = solution.StressIntensity()
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
        "K_I": K_I,
        "K_II": K_II,
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


def write_whole(path, write):
    """Calls write(temporary path) and moves the complete file to its place."""
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        temporary = Path(folder) / path.name
        write(temporary)
        os.replace(temporary, path)
    return path


def write_figures(solution, folder):
    """body.png and profile.png."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from .plotting import plot_body, plot_profile

    figure, ax = plt.subplots(figsize=(6.5, 6), layout="constrained")
    plot_body(solution, ax)
    yield write_whole(folder / "body.png", lambda path: figure.savefig(path, dpi=150))
    figure, axes = plt.subplots(2, 1, figsize=(6.5, 5), sharex=True, layout="constrained")
    plot_profile(solution, ax=axes)
    yield write_whole(folder / "profile.png", lambda path: figure.savefig(path, dpi=150))


def run(options):
    """Solves, writes, and says so; the exit code."""
    options.output.mkdir(parents=True, exist_ok=True)
    stabilisation = None if options.unstabilised else BarbosaHughes(options.gamma0)
    print(f"meshing with h = {options.h:g} ...", flush=True)
    problem = paper_problem(unstructured_mesh(options.h), options.load, options.pair, stabilisation, options.cone)
    print(f"solving for {problem.V.ndof} + {problem.W.ndof} unknowns ...", flush=True)
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
    if not options.no_figures:
        written += write_figures(solution, options.output)
    print(f"wrote {', '.join(Path(path).name for path in written)} to {options.output.resolve()}")
    return 0


def main(arguments=None):
    """Runs a command line; returns its exit code: 0, 1 without an answer, 130 after Ctrl-C."""
    ngsglobals.msg_level = 0
    try:
        return run(parse(arguments))
    except (SolveError, ImportError, OSError) as error:
        print(f"no answer: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
