"""One version, of the package and of the NGSolve that it was built with."""

import re
from pathlib import Path

import ngsolve
import pytest

import ngsxfem_contact
from ngsxfem_contact._version_check import check

ROOT = Path(__file__).parents[2]
PYPROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_another_ngsolve_is_refused_with_a_way_out():
    with pytest.raises(ImportError, match=r"pip install ngsolve==6\.2\.2608"):
        check(installed="6.2.2607", expected="6.2.2608")


def test_the_version_stands_in_pyproject():
    (version,) = re.findall(r'^version = "(\d+\.\d+\.\d+)"$', PYPROJECT, re.MULTILINE)
    assert ngsxfem_contact.__version__ == version
    assert re.findall(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE) == [version]
    released = re.findall(r"^## \[(\d.*?)\]", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert released[:1] in ([], [version])


def test_one_ngsolve_is_pinned():
    """The one to build with is the one to run with, and the one that runs here."""
    assert set(re.findall(r"\bngsolve(==[\d.]+)", PYPROJECT)) == {f"=={ngsolve.__version__}"}
