"""tools/release.py on copies: what it cuts, what it refuses, the README that an index shows. The whole of it takes minutes: docs/release.md."""

import re
import runpy
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOL = runpy.run_path(str(ROOT / "tools" / "release.py"))
FILES = ("pyproject.toml", "CITATION.cff", "CHANGELOG.md")


@pytest.fixture
def copy(tmp_path):
    for name in FILES:
        shutil.copy(ROOT / name, tmp_path / name)
    log = tmp_path / "CHANGELOG.md"
    log.write_text(log.read_text(encoding="utf-8").replace("## [Unreleased]\n", "## [Unreleased]\n\n### Added\n\n- News.\n", 1), encoding="utf-8")
    return tmp_path


def read(folder):
    return {name: (folder / name).read_text(encoding="utf-8") for name in FILES}


def test_the_cut(copy):
    before = read(copy)
    TOOL["cut"](copy, "7.0.1", "2031-02-03")
    after = read(copy)
    assert re.findall(r'^version = "(.*)"$', after["pyproject.toml"], re.M) == ["7.0.1"]
    assert "version: 7.0.1\ndate-released: 2031-02-03\n" in after["CITATION.cff"]
    unreleased, news = after["CHANGELOG.md"].split("## [7.0.1] - 2031-02-03\n")
    assert unreleased.endswith("## [Unreleased]\n\n") and before["CHANGELOG.md"].endswith(news)
    with pytest.raises(SystemExit, match="nothing under"):
        TOOL["cut"](copy, "7.0.2", "2031-02-04")


@pytest.mark.parametrize("version", ["0.0.9", "0.1.0", "1.0", "v1.0.0", "1.0.0rc1"])
def test_versions_that_are_refused(copy, version):
    before = read(copy)
    with pytest.raises(SystemExit, match="is no version after"):
        TOOL["cut"](copy, version, "2031-02-03")
    assert read(copy) == before


def test_nothing_is_written_half(copy):
    (copy / "CITATION.cff").write_text("title: none\n")
    before = read(copy)
    with pytest.raises(SystemExit, match="CITATION.cff: 0 places"):
        TOOL["cut"](copy, "7.0.1", "2031-02-03")
    assert read(copy) == before


def test_the_readme_of_an_index():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    relative = re.compile(r"\]\((?!https?:|#)")
    if not relative.search(readme):
        pytest.skip("this is an sdist, whose README is that of an index already")
    assert len(relative.findall(readme)) > 8
    alone, linked = TOOL["index_readme"](readme), TOOL["index_readme"](readme, "https://example.org/us/it/")
    for text in (alone, linked):
        assert not relative.search(text) and text.startswith("# ngsxfem_contact\n") and "```python" in text
    assert "![" not in alone and "|---" not in alone and "limits" in alone
    assert "](https://example.org/us/it/blob/HEAD/docs/limits.md)" in linked and re.search(
        r"!\[[^\]]+\]\(https://example.org/us/it/raw/HEAD/docs/images/\w+.png\)", linked
    )


def test_metadata_are_complete():
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for key in ("authors", "description", "readme", "license", "keywords", "classifiers", "requires-python"):
        assert re.search(rf"^{key} = ", text, re.M), key
    wheels = re.search(r'^build = "cp31\{(.*)\}-manylinux', text, re.M)[1].split(",")
    assert [f"3.1{minor}" for minor in wheels] == re.findall(r"Python :: (3\.\d+)", text)
