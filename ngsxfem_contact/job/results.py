"""What is written about the solutions of a part: numbers, profiles, VTK, pictures. Each file appears when it is whole."""

from __future__ import annotations

import csv
import json
from typing import TYPE_CHECKING, Any

from ..contact.at_tips import tip_row
from ..files import write_whole
from ..plotting.plots import plot_body, plot_profile, pyplot

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ..contact.solution import ContactSolution
    from .part import Part


FACTOR_KEYS = ("K_I", "K_II", "error", "method", "G", "note")


def numbers_of(part: Part, solutions: list[ContactSolution]) -> dict[str, Any]:
    """All numbers of the solutions of a Part, for JSON."""
    problem = part.problem
    return {
        "title": part.title,
        "file": part.file.name,
        "triangles": problem.V.mesh.ne,
        "unknowns": list(solutions[0].report.unknowns),
        "reference": part.reference,
        "steps": [{"factor": factor, **numbers_of_step(solution)} for factor, solution in zip(part.factors or [1], solutions, strict=True)],
    }


def numbers_of_step(solution: ContactSolution) -> dict[str, Any]:
    """Those of one solution."""
    report, cracks = solution.report, range(len(solution.body.cracks))
    return {
        "energy": solution.Energy(),
        "dissipated_energy": solution.DissipatedEnergy(),
        "face_energy": solution.FaceEnergy(),
        "cracks": [
            {
                "name": solution.body.cracks[crack].name,
                "contact_force": solution.ContactForce(crack),
                "tangential_force": solution.TangentialForce(crack),
                "transitions": solution.Transitions(crack).tolist(),
            }
            for crack in cracks
        ],
        "tips": [{"crack": tip.crack, "point": list(tip.point), **factors_of(solution, number)} for number, tip in enumerate(solution.body.tips)],
        "reactions": [{"support": row.name, "force": row.force.tolist(), "moment": row.moment} for row in (*solution.Reactions(), solution.Reactions().total)],
        "report": {
            "inverse": report.inverse,
            "iterations": report.iterations,
            "residual": report.residual,
            "complementarity": report.complementarity,
            "seconds": report.timings,
            "notes": report.notes,
        },
    }


def factors_of(solution: ContactSolution, tip: int) -> dict[str, Any]:
    """K and G at a tip, None where they cannot be told, and a note that says why, or None."""
    row = tip_row(solution, tip)
    known = lambda value: value if value == value and value != "" else None
    return {name: known(row[name]) for name in FACTOR_KEYS}


# For people


def summary(numbers: dict[str, Any], solutions: list[ContactSolution]) -> str:
    """The numbers as text, beside the reference where there is one."""
    lines = [f"{numbers['title']}: {numbers['triangles']} triangles, {numbers['unknowns'][0]} + {numbers['unknowns'][1]} unknowns"]
    for step, solution in zip(numbers["steps"], solutions, strict=True):
        if len(solutions) > 1:
            lines += ["", f"Loads × {step['factor']:g}"]
        reference = numbers["reference"] if step is numbers["steps"][-1] else {}
        lines += [*table(step, reference), "", str(solution.Reactions()), "", str(solution.report)]
    if numbers.get("warnings"):
        lines += ["", *(f"warning: {warning}" for warning in numbers["warnings"])]
    return "\n".join(lines) + "\n"


def table(step: dict[str, Any], reference: dict[str, Any]) -> Iterator[str]:
    """Lines of what was computed, and of what is known."""
    yield f"  {'':34}{'computed':>16}" + (f"   reference ({reference.get('from', 'of the file')})" if reference else "")
    for name, value, exact in rows(step, reference):
        yield f"  {name:34}{'-' if value is None else format(value, '16.8g'):>16}" + ("" if exact is None else f"   {exact:.8g}")
    for tip, found in enumerate(step["tips"]):
        if found["note"]:
            yield f"  tip {tip}: {found['note']}"


def rows(step: dict[str, Any], reference: dict[str, Any]) -> Iterator[tuple[str, float, float | None]]:
    """(name, computed, reference or None)."""
    yield "energy ½a(u,u)", step["energy"], reference.get("energy")
    for number, crack in enumerate(step["cracks"]):
        where = f", {crack['name'] or f'crack {number}'}" if len(step["cracks"]) > 1 else ""
        yield f"contact force ∫λ{where}", crack["contact_force"], entry(reference, "contact_force", number)
        if crack["tangential_force"]:
            yield f"tangential force ∫λ_t{where}", crack["tangential_force"], None
        for i, s in enumerate(crack["transitions"]):
            yield f"contact begins or ends, s{where}", s, entry(reference, "transitions", number, i)
    for number, tip in enumerate(step["tips"]):
        where = f", tip {number}" if len(step["tips"]) > 1 else ""
        for i, name in enumerate(("K_I", "K_II")):
            yield name + where + (" of the modes" if tip["method"] == "modes" else ""), tip[name], entry(reference, "K", number, i)
        yield f"G{where}", tip["G"], None


def entry(reference: dict[str, Any], key: str, *indices: int) -> Any:
    """A number of a reference, or None where it has none."""
    value = reference.get(key)
    for i in indices:
        value = value[i] if value is not None and i < len(value) else None
    return value


# Files


def write_results(part: Part, solutions: list[ContactSolution], numbers: dict[str, Any], text: str, folder: Path, pictures: bool) -> Iterator[Any]:
    """Writes all files; yields their paths.

    Parameters
    ----------
    numbers, text
        `numbers_of` and `summary` of the solutions.
    pictures
        Whether body.png and profile.png are among the files.
    """
    document = json.dumps(numbers, indent=1)
    folder.mkdir(parents=True, exist_ok=True)
    yield write_whole(folder / "summary.txt", lambda path: path.write_text(text, encoding="utf-8"))
    yield write_whole(folder / "summary.json", lambda path: path.write_text(document, encoding="utf-8"))
    yield write_whole(folder / "profile.csv", lambda path: write_profiles(path, part, solutions))
    if part.output.get("vtk", True):
        for number, solution in enumerate(solutions):
            yield solution.SaveVTK(folder / (f"solution_{number}.vtu" if len(solutions) > 1 else "solution.vtu"))
    if pictures:
        yield from write_pictures(solutions[-1], folder)


def write_profiles(path: Path, part: Part, solutions: list[ContactSolution]) -> None:
    """One row for each point of each crack in each step."""
    options = {"n": part.output["points"]} if "points" in part.output else {}
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        for number, (factor, solution) in enumerate(zip(part.factors or [1], solutions, strict=True)):
            for crack, curve in enumerate(solution.body.cracks):
                profile = solution.Profile(crack, **options)
                if number == crack == 0:
                    writer.writerow(["factor", "crack", *(profile.dtype.names or ())])
                writer.writerows([factor, curve.name or crack, *row] for row in profile.tolist())


def write_pictures(solution: ContactSolution, folder: Path) -> Iterator[Any]:
    """body.png and profile.png, of each crack where there are several."""
    plt = pyplot()
    figure, ax = plt.subplots(figsize=(6.5, 6), layout="constrained")
    plot_body(solution, ax)
    yield save(figure, folder / "body.png")
    cracks = len(solution.body.cracks)
    for crack in range(cracks):
        figure, axes = plt.subplots(2, 1, figsize=(6.5, 5), sharex=True, layout="constrained")
        plot_profile(solution, crack, axes)
        yield save(figure, folder / (f"profile_{crack}.png" if cracks > 1 else "profile.png"))


def save(figure: Any, path: Path) -> Path:
    """Writes a figure and forgets it."""
    write_whole(path, lambda temporary: figure.savefig(temporary, dpi=150))
    pyplot().close(figure)
    return path
