"""Executes the tutorials to notebooks: python tools/notebooks.py [folder], by default docs/tutorials.

A notebook whose script did not change since is kept. A cell that fails, or writes to stderr, ends the run.
"""

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
    nbformat.write(notebook, target)


if __name__ == "__main__":
    os.environ.setdefault("NGS_NUM_THREADS", "1")  # problems this small gain nothing from more, and lose much on a busy machine
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "tutorials"
    folder.mkdir(parents=True, exist_ok=True)
    for script in sorted((ROOT / "tutorials").glob("*.py")):
        target, start = folder / f"{script.stem}.ipynb", perf_counter()
        if not target.exists() or target.stat().st_mtime < script.stat().st_mtime:
            execute(script, target)
            print(f"{target.name}: {perf_counter() - start:.0f} s", flush=True)
