"""docs/job.md: its example is solved, its code runs, and it has every key that the tables take."""

import re
from pathlib import Path
from shutil import copy

import pytest

from ngsxfem_contact.job import body, conditions
from ngsxfem_contact.job.part import read_part
from ngsxfem_contact.job.table import RefusedPart

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "job.md").read_text(encoding="utf-8")
pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


def test_the_example(tmp_path):
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "part.toml").write_text(text, encoding="utf-8")
    copy(ROOT / "tests" / "data" / "gmsh" / "layered-4.1.msh", tmp_path / "plate.msh")
    part = read_part(tmp_path / "part.toml")
    first, _, last = part.Solve()
    assert part.title == "Plate with a stiff layer" and last.Energy() > 4 * first.Energy() and last.report.converged
    assert 0 > first.ContactForce() > last.ContactForce() and last.TangentialForce() != 0


def test_the_code():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names = {}
    exec(code, names)
    assert names["solution"].report.converged and names["problem"] is names["part"].problem


TABLES = {
    "mesh": ["rectangle = [[0, 0], [1, 1]]\nmaxh = 0.5", "file = 'a.vol'"],
    "material": ["lam = 1\nmu = 1", "E = 1\nnu = 0.2"],
    "crack": [f"{shape} = 1" for shape in body.SHAPES],
    "load": [f"{kind} = 1" for kind in conditions.LOADS],
    "support": [f"{kind} = 1" for kind in conditions.SUPPORTS],
    "stabilisation": [f"method = '{name}'" for name in conditions.STABILISATIONS],
    "law": [f"name = '{name}'" for name in ("Coulomb", "Tresca", "MohrCoulomb", "BartonBandis", "Joint", "LinearCohesive", "ExponentialCohesive", "Dugdale")],
    **{name: [""] for name in ("displacement", "multiplier", "contact", "initial", "solve", "output", "reference")},
}


def allowed(folder, name, keys):
    """What the message lists where a table has a key that no table has."""
    first = {"mesh": ["rectangle = [[0, 0], [1, 1]]\nmaxh = 0.5"], "material": ["lam = 1\nmu = 1"], "crack": ["polyline = [[0, 0.52], [0.6, 0.52]]"]}
    parts = {table: first.get(table, [""])[0] for table in first} | {name: f"{keys}\nno_key = 1"}
    many = ("material", "crack", "law", "load", "support")
    text = "\n".join(f"[[{table}]]\n{lines}" if table in many else f"[{table}]\n{lines}" for table, lines in parts.items())
    (folder / "part.toml").write_text(text, encoding="utf-8")
    with pytest.raises(RefusedPart, match="no_key: there is no such key.*allowed are") as refused:
        read_part(folder / "part.toml")
    return str(refused.value).split("allowed are ")[1].split(", ")


def section_of(name):
    """What the page says under the heading of a table."""
    (text,) = (part for part in re.split(r"^## ", PAGE, flags=re.M) if re.match(rf"`[^\n]*\[{name}\]", part))
    return text


@pytest.mark.parametrize("name, keys", [(name, keys) for name, variants in TABLES.items() for keys in variants])
def test_every_key_is_described(tmp_path, name, keys):
    found = allowed(tmp_path, name, keys)
    assert found and {key for key in found if not re.search(rf"`(?:{key}\b[^`]*|[^`]*\b{key} = [^`]*)`", section_of(name))} == set()


def test_every_table_is_described():
    headings = set(re.findall(r"\[(\w+)\]+`", "\n".join(line for line in PAGE.splitlines() if line.startswith("## "))))
    assert headings == set(TABLES)
