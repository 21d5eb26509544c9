"""Every tutorial runs from start to end, away from the source tree and without a display."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

TUTORIALS = sorted((Path(__file__).resolve().parents[1] / "tutorials").glob("*.py"))


def user_code(path):
    """The lines of code beside imports."""
    lines = [line.strip() for line in path.read_text(encoding="utf-8").splitlines()]
    return [line for line in lines if line and not line.startswith(("#", "import ", "from "))]


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.name)
def test_tutorial(path, tmp_path):
    environment = os.environ | {"MPLBACKEND": "Agg", "NGS_NUM_THREADS": "1"}
    run = subprocess.run([sys.executable, str(path)], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "converged        True" in run.stdout


def test_there_are_tutorials():
    assert {"first_crack.py", "open_form.py"} <= {path.name for path in TUTORIALS}


def test_the_first_crack_takes_few_lines():
    (first,) = (path for path in TUTORIALS if path.name == "first_crack.py")
    assert len(user_code(first)) <= 15


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.name)
def test_tutorial_checks_its_answer(path):
    assert any(line.startswith("assert ") for line in user_code(path))
    assert path.read_text(encoding="utf-8").startswith("# %%")
