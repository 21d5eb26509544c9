"""Every tutorial runs from start to end, away from the source tree and without a display, and ends in a check."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
TUTORIALS = sorted((Path(__file__).resolve().parents[2] / "tutorials").glob("*.py"), key=lambda path: int(path.name.partition("_")[0]))


def cells(path):
    """The code of the cells of a script in jupytext's percent format; text is left out."""
    parts = path.read_text(encoding="utf-8").split("\n# %%")
    return [part.partition("\n")[2] for part in parts if not part.partition("\n")[0].endswith("[markdown]")]


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.name)
def test_tutorial(path, tmp_path):
    environment = os.environ | {"MPLBACKEND": "Agg", "NGS_NUM_THREADS": "1"}
    run = subprocess.run([sys.executable, str(path)], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_there_are_tutorials():
    assert [path.name.partition("_")[0] for path in TUTORIALS] == [str(i) for i in range(1, len(TUTORIALS) + 1)]


def test_the_first_crack_takes_few_lines():
    """From the mesh to the solution: statements, one a line."""
    (code,) = (cell for cell in cells(TUTORIALS[0]) if "Solve()" in cell)
    statements = ast.parse(code).body
    assert len(statements) <= 15 and code.count("\n") <= len(statements) + 1


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.name)
def test_tutorial_checks_its_answer(path):
    """The last cell measures something and asserts it."""
    assert any(isinstance(statement, ast.Assert) for statement in ast.parse(cells(path)[-1]).body)
    assert path.read_text(encoding="utf-8").startswith("# %% [markdown]\n# # ")
