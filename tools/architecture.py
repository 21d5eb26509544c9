"""Draws docs/images/architecture.svg from the #include and import lines of the sources: python tools/architecture.py [file.svg]

A unit stands above all that it uses. Lines that follow from others are left out (a uses c, if a uses b and b uses c). The
file carries its lines as text, so that a test can compare it with the sources.
"""

import ast
import re
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
GROUPS = {
    "geometry": "box_tree curve_piece crack tip_curve element_division interpolant element_map element_location element_clips body_boundary crack_ends cut_rule curved_rule cut_element cracked_mesh body_rules crack_normal geometry segments",
    "spaces": "tip_functions crack_element diffops crack_fespace crack_enrichment crack_bilinearform trace_space dilatation spaces tip_disk resolution interpolation",
    "forms": "cut_integral form_terms operators elasticity incompressible mouths boundary_samples terms face_traction load",
    "methods": "bordered_matrix schur_complement elimination pardiso active_set box_path nodal_newton cones friction stabilisation nitsche contact_system mixed_system checks conditioning connectivity negligible",
    "problem and solver": "problem supports reactions solver load_steps solution report errors",
    "reading solutions": "fracture tip_integral factor_error fracture_solutions tip_fields growth split_mesh plotting closed_forms arc_solution",
    "the paper and its study": "paper shapes study analysis figures __main__",
}
COLOURS = ("#cfe2f3", "#d9ead3", "#fff2cc", "#f9d5c5", "#ead1dc", "#d9d2e9", "#eeeeee")
LEFT_OUT = {"__init__", "_build_info", "_version_check", "files", "arguments", "progress"}  # of no interest, or used by all


def cpp_graph(folder):
    """Unit → units that its files include."""
    graph = {}
    for path in sorted(folder.glob("*.?pp")):
        included = re.findall(r'^\s*#\s*include\s*"([^"]+)"', path.read_text(encoding="utf-8"), re.M)
        graph.setdefault(path.stem, set()).update(Path(name).stem for name in included)
    return {unit: used & set(graph) - {unit} for unit, used in graph.items()}


def python_graph(folder):
    """Module → modules of the package that it imports, inside functions, too."""
    graph = {}
    for path in sorted(folder.glob("*.py")):
        nodes = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.ImportFrom) and node.level == 1]
        graph[path.stem] = {name for node in nodes for name in ([node.module] if node.module else [alias.name for alias in node.names])}
    return {module: used & set(graph) - LEFT_OUT for module, used in graph.items() if module not in LEFT_OUT}


def reachable(graph, start):
    found = set()
    for used in graph[start]:
        found |= {used} | reachable(graph, used)
    return found


def reduced(graph):
    """The graph without lines that follow from others."""
    return {unit: {used for used in uses if not any(used in reachable(graph, other) for other in uses - {used})} for unit, uses in graph.items()}


def levels(graph):
    """Unit → its layer: above all that it uses."""
    level = {}
    for unit in sorted(graph, key=lambda unit: len(reachable(graph, unit))):
        level[unit] = 1 + max((level[used] for used in graph[unit]), default=-1)
    return level


def routes(graph, level):
    """Each line as the places it passes, one for each layer: units at its ends, (unit, used, layer) between."""
    return [[unit, *((unit, used, i) for i in range(level[unit] - 1, level[used], -1)), used] for unit, uses in graph.items() for used in sorted(uses)]


def positions(graph):
    """(position of each place, routes): layers are ordered by the means of their neighbours, so that lines are short."""
    level = levels(graph)
    lines = routes(graph, level)
    level |= {place: place[2] for line in lines for place in line[1:-1]}
    neighbours = {place: [] for place in level}
    for a, b in ((a, b) for line in lines for a, b in zip(line, line[1:])):
        neighbours[a].append(b)
        neighbours[b].append(a)
    rows = [sorted((place for place in level if level[place] == i), key=str) for i in range(max(level.values()) + 1)]
    x = {}

    def arrange(i):
        width = np.array([1.0 if isinstance(place, str) else 0.25 for place in rows[i]])
        x.update(zip(rows[i], (np.cumsum(width) - 0.5 * width) / width.sum()))

    for i in range(len(rows)):
        arrange(i)
    for sweep in range(24):
        for i in range(len(rows)) if sweep % 2 else reversed(range(len(rows))):
            mean = {place: np.mean([x[n] for n in neighbours[place]]) if neighbours[place] else 0.5 for place in rows[i]}
            rows[i].sort(key=lambda place: (mean[place], str(place)))
            arrange(i)
    return {place: (x[place], level[place]) for place in level}, lines


def draw(ax, graph, title):
    """One graph on its axes."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Curve

    at, lines = positions(reduced(graph))
    colour = {unit: shade for units, shade in zip(GROUPS.values(), COLOURS) for unit in units.split()}
    for line in lines:
        for (x0, y0), (x1, y1) in zip([at[place] for place in line], [at[place] for place in line[1:]]):
            bend = [(x0, y0), (x0, y0 - 0.5), (x1, y1 + 0.5), (x1, y1)]
            ax.add_patch(PathPatch(Curve(bend, [Curve.MOVETO] + 3 * [Curve.CURVE4]), fill=False, edgecolor="0.55", linewidth=0.7, zorder=1))
    for unit in graph:
        box = {"boxstyle": "round,pad=0.35", "facecolor": colour.get(unit, "white"), "edgecolor": "0.4", "linewidth": 0.7}
        ax.text(*at[unit], unit, ha="center", va="center", fontsize=8.5, bbox=box, zorder=2)
    ax.set(xlim=(0, 1), ylim=(-0.6, max(y for _, y in at.values()) + 0.6), title=title)
    ax.axis("off")


def graphs():
    """The two graphs by what they are."""
    return {
        "cpp/: the core, C++ without Python": cpp_graph(ROOT / "cpp"),
        "ngsxfem_contact/: the package, Python on top of the core": python_graph(ROOT / "ngsxfem_contact"),
    }


def edges():
    """All lines as text, "a > b" for a uses b."""
    return sorted(f"{unit} > {used}" for graph in graphs().values() for unit, uses in reduced(graph).items() for used in uses)


def picture(path):
    """Writes the SVG."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.patches import Patch

    plt.rcParams.update({"svg.hashsalt": "architecture", "svg.fonttype": "none", "font.family": "sans-serif"})
    drawn = graphs()
    heights = [1 + max(levels(graph).values()) for graph in drawn.values()]
    figure, axes = plt.subplots(2, 1, figsize=(13, 0.62 * sum(heights)), height_ratios=heights, layout="constrained")
    for ax, (title, graph) in zip(axes, drawn.items()):
        draw(ax, graph, title)
    figure.legend(handles=[Patch(facecolor=c, edgecolor="0.4", label=g) for g, c in zip(GROUPS, COLOURS)], loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, metadata={"Date": None, "Description": "; ".join(edges())})


if __name__ == "__main__":
    picture(sys.argv[1] if len(sys.argv) > 1 else ROOT / "docs" / "images" / "architecture.svg")
