"""Executes the tutorials to notebooks: python tools/notebooks.py [folder], by default docs/tutorials.

A notebook whose script did not change since is kept. A cell that fails, or writes to stderr, ends the run. Scenes of solution.Draw() stay scenes in the
pages of the documents, which bring NGSolve's webgui.js along (docs/conf.py).
"""

import html
import json
import os
import sys
from pathlib import Path
from time import perf_counter

import jupytext
import nbformat
from nbclient import NotebookClient

ROOT = Path(__file__).resolve().parents[1]


def execute(script, target):
    """Writes the executed notebook of a script in jupytext's percent format."""
    notebook = jupytext.read(script)
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(target.parent)}}).execute()
    said = [output.text for cell in notebook.cells for output in cell.get("outputs", []) if output.get("name") == "stderr"]
    if said:
        sys.exit(f"{script.name} writes to stderr, which its page would show: {''.join(said)}")
    show_scenes(notebook)
    nbformat.write(notebook, target)


def show_scenes(notebook):
    """Gives what a widget of webgui draws to pages, which have no kernel, as a frame of HTML, and leaves out the name of its class."""
    states = notebook.metadata.get("widgets", {}).get("application/vnd.jupyter.widget-state+json", {}).get("state", {})
    for cell in notebook.cells:
        outputs = cell.get("outputs", [])
        for output in outputs:
            shown = output.get("data", {}).get("application/vnd.jupyter.widget-view+json")
            if shown:
                output.data["text/html"] = scene(states[shown["model_id"]]["state"]["value"])
        outputs[:] = [output for output in outputs if output.get("data", {}).get("text/plain") != "WebGLScene"]


def scene(data):
    """A frame that webgui.js fills with its data."""
    script = f"new webgui.Scene().init(document.body, {json.dumps(data)}, {{preserveDrawingBuffer: false}});"
    # at 16 px the numbers of the scale overlap; the last 8 px are half a line of webgui's own
    page = f'<body style="margin: 0; overflow: hidden; font-size: 11px"><script src="../_static/webgui.js"></script><script>{script}</script></body>'
    style = "width: 100%; height: 28rem; border: 0; clip-path: inset(0 0 8px 0)"
    return f'<iframe srcdoc="{html.escape(page)}" style="{style}" title="The body: turn it, zoom it" loading="lazy"></iframe>'


if __name__ == "__main__":
    os.environ.setdefault("NGS_NUM_THREADS", "1")  # problems this small gain nothing from more, and lose much on a busy machine
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "tutorials"
    folder.mkdir(parents=True, exist_ok=True)
    for script in sorted((ROOT / "tutorials").glob("*.py")):
        target, start = folder / f"{script.stem}.ipynb", perf_counter()
        if not target.exists() or target.stat().st_mtime < script.stat().st_mtime:
            execute(script, target)
            print(f"{target.name}: {perf_counter() - start:.0f} s", flush=True)
