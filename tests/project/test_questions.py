"""The code of docs/questions.md runs, each block after the first one, and prints what its comments say."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "questions.md").read_text(encoding="utf-8")
FIRST, *BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def printed(number, capsys):
    """What a block prints."""
    exec(FIRST + BLOCKS[number], {})
    return capsys.readouterr().out.strip()


@pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")  # coarse, to be quick
@pytest.mark.parametrize("number, question, value", [(0, "fluid", -0.4), (1, "temperature", -0.5), (2, "springs", 1 / 40), (5, "press on each other", 0)])
def test_numbers(number, question, value, capsys):
    heading = re.findall(r"### (.*)", PAGE[: PAGE.index(BLOCKS[number])])[-1]
    assert question in heading and float(printed(number, capsys)) == pytest.approx(value, rel=1e-5)


@pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")
def test_reaction(capsys):
    assert [float(word) for word in printed(3, capsys).split()] == pytest.approx([-0.2, 1], rel=1e-8)


def test_an_end_that_overshoots(capsys):
    text = printed(4, capsys)
    assert text.endswith("(0.4, 0.5)") and "cut" in text and len(BLOCKS) == 6
