"""Draws docs/images/architecture.svg from the sources: python tools/architecture.py [file.svg]

Folders are layers. Those of the core stand in the order of CMakeLists.txt, those of the package in that of ngsxfem_contact/__init__.py.
The picture carries its layers and arrows as text, so that a test can compare it with the sources.
"""

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE, PACKAGE = ROOT / "cpp", ROOT / "ngsxfem_contact"
BASE = "base"  # the modules beside the folders of the package
LEFT_OUT = {"__init__", "__main__", "_build_info", "_version_check"}
COLOURS = {"core": "#cfe2f3", "package": "#fff2cc"}


def core_layers():
    """Folder of cpp/ → its units, from the lowest one."""
    folders = dict.fromkeys(re.findall(r"cpp/(\w+)/", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")))
    return {folder: sorted({path.stem for path in (CORE / folder).glob("*.?pp")}) for folder in folders}


def package_layers():
    """Folder of the package → its modules, from the lowest one."""
    tree = ast.parse((PACKAGE / "__init__.py").read_text(encoding="utf-8"))
    names = [node.module or node.names[0].name for node in tree.body if isinstance(node, ast.ImportFrom)]
    folders = dict.fromkeys(name.split(".")[0] for name in names if (PACKAGE / name.split(".")[0]).is_dir())
    return {folder: sorted({path.stem for path in folder_of(folder).glob("*.py")} - LEFT_OUT) for folder in (BASE, *folders)}


def folder_of(layer):
    return PACKAGE if layer == BASE else PACKAGE / layer


def core_uses(folder):
    """The folders of cpp/ that a folder includes."""
    text = "".join(path.read_text(encoding="utf-8") for path in (CORE / folder).glob("*.?pp"))
    return set(re.findall(r'^\s*#\s*include\s*"(\w+)/', text, re.M)) - {folder}


class Running(ast.NodeTransformer):
    """Without what stands there for the reader of types alone."""

    def visit_If(self, node):
        return None if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING" else self.generic_visit(node)


def imports(path):
    """(layer, module) of the imports of a module from this package, those inside functions, too, those of names of types not; module "" for the core."""
    layer = BASE if path.parent == PACKAGE else path.parent.name
    for node in ast.walk(Running().visit(ast.parse(path.read_text(encoding="utf-8")))):
        if isinstance(node, ast.ImportFrom) and node.level:
            parts = (node.module or "").split(".") if node.module else []
            at = PACKAGE if node.level == 2 or layer == BASE else path.parent
            for names in [parts] if parts else [[alias.name] for alias in node.names]:
                to = at.joinpath(*names)
                if to.is_dir():
                    yield from ((names[0], alias.name) for alias in node.names)
                elif to.with_suffix(".py").exists():
                    yield (BASE if to.parent == PACKAGE else to.parent.name, to.name)


def package_uses(layer):
    """The layers of the package that a layer imports from."""
    return {to for path in folder_of(layer).glob("*.py") if path.stem not in LEFT_OUT for to, _ in imports(path)} - {layer}


def layers():
    """(title, layer → units, layer → layers it uses) of the two halves."""
    core, package = core_layers(), package_layers()
    return [("core", core, {layer: core_uses(layer) for layer in core}), ("package", package, {layer: package_uses(layer) for layer in package})]


def reduced(uses):
    """Without arrows that follow from others."""

    def reachable(layer):
        return uses[layer].union(*(reachable(other) for other in uses[layer]))

    return {layer: {to for to in used if not any(to in reachable(other) for other in used - {to})} for layer, used in uses.items()}


def description():
    """All that the picture says, as text."""
    for title, units, uses in layers():
        for layer, names in units.items():
            yield f"{title}/{layer}: {' '.join(names)} > {' '.join(sorted(reduced(uses)[layer]))}"


def rows_of(names, width):
    """Names in rows of at most so many characters."""
    rows = [[]]
    for name in names:
        if sum(len(other) + 3 for other in rows[-1]) + len(name) > width and rows[-1]:
            rows.append([])
        rows[-1].append(name)
    return rows


def draw_layer(ax, title, layer, names, bottom):
    """A band with its units; its height."""
    rows = rows_of(names, 88)
    height = 0.62 + 0.62 * len(rows)
    ax.add_patch(ax.patch_class((0, bottom), 112, height, facecolor=COLOURS[title], edgecolor="0.5", linewidth=0.8))
    ax.text(1.5, bottom + height / 2, f"{layer}/" if layer != BASE else "beside the folders", va="center", fontsize=11, fontweight="bold")
    for i, row in enumerate(rows):
        x = 21.0
        for name in row:
            ax.text(x, bottom + height - 0.62 * (i + 1), name, va="center", fontsize=9, family="monospace")
            x += len(name) + 3
    return height


def draw(ax):
    """Both halves, the core below, with arrows from each layer to those it uses."""
    from matplotlib.patches import FancyArrowPatch, Rectangle

    ax.patch_class, bottom = Rectangle, 0.0
    for title, units, uses in layers():
        at = {}
        for layer, names in units.items():
            height = draw_layer(ax, title, layer, names, bottom)
            at[layer] = bottom, bottom + height
            bottom += height + 0.3
        arrows = [(layer, to) for layer, used in reduced(uses).items() for to in used]
        for i, (layer, to) in enumerate(sorted(arrows, key=lambda arrow: at[arrow[0]][0] - at[arrow[1]][0])):
            x = 113 + 1.6 * (i + 1)
            y0, y1 = sum(at[layer]) / 2 - 0.15, sum(at[to]) / 2 + 0.15
            ax.plot([112, x, x], [y0, y0, y1], color="0.35", linewidth=0.9)
            ax.add_patch(FancyArrowPatch((x, y1), (112, y1), arrowstyle="-|>", mutation_scale=9, color="0.35", linewidth=0.9, shrinkA=0, shrinkB=0))
        ax.text(
            0, bottom, {"core": "ngsxfem_contact/: the package, in Python, on python/, the exports of the core", "package": ""}[title], fontsize=10, va="bottom"
        )
        bottom += 0.9
    ax.text(0, -0.35, "cpp/: the core, in C++ without Python", fontsize=10, va="top")
    ax.set(xlim=(-1, 136), ylim=(-1.1, bottom - 0.8))
    ax.axis("off")


def picture(path):
    """Writes the SVG."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "architecture", "svg.fonttype": "none"})
    figure, ax = plt.subplots(figsize=(12.5, 9), layout="constrained")
    draw(ax)
    figure.savefig(path, metadata={"Date": None, "Description": "; ".join(description())})
    return figure


if __name__ == "__main__":
    picture(sys.argv[1] if len(sys.argv) > 1 else ROOT / "docs" / "images" / "architecture.svg")
