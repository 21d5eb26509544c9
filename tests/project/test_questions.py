"""The code of each page of docs/questions runs by itself, and prints what the comments beside its prints say."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
CODE = {
    page.stem: "\n".join(re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)) for page in sorted((DOCS / "questions").glob("*.md"))
}


def words(line):
    """Numbers as such, where a word is one."""
    return [float(word) if re.fullmatch(r"-?\d+(\.\d*)?(e[+-]?\d+)?", word) else word for word in line.split()]


def same(printed, said):
    """Whether a word is what a comment says, which gives fewer digits of a number."""
    return printed == (pytest.approx(said, rel=1e-5, abs=1e-9) if isinstance(said, float) else said)


@pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")  # coarse, to be quick
@pytest.mark.parametrize("page", [page for page, code in CODE.items() if code])
def test_prints(page, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some write files
    exec(CODE[page], {})
    said = re.findall(r"^ *print\(.*\)  # (.*)$", CODE[page], re.MULTILINE)
    printed = capsys.readouterr().out.splitlines()
    assert len(said) == len(printed) > 0 and CODE[page].count("print(") == len(said)
    for line, comment in zip(printed, said, strict=True):
        if comment.endswith(" ..."):
            assert line.startswith(comment[:-4])
        else:
            assert len(words(line)) == len(words(comment)) and all(map(same, words(line), words(comment))), (line, comment)


def test_every_page_is_in_the_index():
    listed = re.findall(r"\(questions/([\w-]+)\.md\)", (DOCS / "questions.md").read_text(encoding="utf-8"))
    assert sorted(listed) == sorted(CODE)
