"""What the documents, docstrings and comments refer to exists: files, sections, equations of the paper, links."""

import ast
import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "ngsxfem_contact"
PAGES = sorted([*(ROOT / "docs").glob("*.md"), *ROOT.glob("README.md"), *ROOT.glob("CONTRIBUTING.md"), ROOT / "benchmarks" / "README.md"])
SOURCES = sorted(
    path
    for pattern in ("ngsxfem_contact/**/*.py", "study/*.py", "benchmarks/*.py", "tools/*.py", "tutorials/*.py", "tests/**/*.py", "cpp/*/*.?pp", "python/*.?pp")
    for path in ROOT.glob(pattern)
    if path.name not in ("_build_info.py", "test_references.py")
)
FILE = re.compile(r"(?<![\w/*.<])((?:\.\./)?[\w-]+(?:/[\w.-]+)*\.(?:py|cpp|hpp|md|sh))\b(?![/*])")
METHOD = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
SECTIONS = {int(number): text for number, text in re.findall(r"^## (\d+)\. (.*?)(?=^## |\Z)", METHOD, re.M | re.DOTALL)}
EQUATION_ROWS = re.findall(r"^\| ([^|]*) \|[^|]*\| (`[^|]*`) \| *(\d*) *\|$", METHOD, re.M)


def name_of(path):
    return str(path.relative_to(ROOT))


def found(name, page=ROOT):
    """A file by its path in the repository, in the package, or beside the page: docs/tutorials/ for a tutorial."""
    beside = ROOT / "docs" / "tutorials" if page.parent.name == "tutorials" else page.parent
    places = [Path(os.path.normpath(base / name)) for base in (ROOT, PACKAGE, beside)]
    return next((place for place in places if place.is_file()), None)


def prose(path):
    """Text, or the docstrings and comments of a source, one string for each."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        return [re.sub(r"```.*?```", "", text, flags=re.DOTALL)]
    if path.suffix == ".py":
        nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))]
        return [*(ast.get_docstring(node) or "" for node in nodes), *re.findall(r"(?m)#(?!include) (.*)$", text)]
    return [comment or string for comment, string in re.findall(r'//+ ?(.*)$|(?<!include )"([^"\n]*)"', text, re.M)]


def named_files(text):
    """Those in backticks; in a source all that look like one of the repository's."""
    return FILE.findall(text)


def test_files_that_are_named_exist():
    """By their path; a name alone is a file beside the page."""
    missing = []
    for path in PAGES + SOURCES:
        written = "\n".join(prose(path))
        spans = "\n".join(re.findall(r"`([^`]+)`", written)) if path.suffix == ".md" else written
        missing += [f"{name_of(path)}: {name}" for name in named_files(spans) if found(name, path) is None]
    assert missing == []


@pytest.mark.parametrize("path", PAGES, ids=name_of)
def test_links_lead_to_files_and_headings(path):
    text = path.read_text(encoding="utf-8")
    for target, anchor in re.findall(r"\]\((?!https?:|mailto:)([^)#\s]*)(?:#([^)\s]+))?\)", re.sub(r"\$[^$\n]+\$|`[^`\n]+`", "", text)):
        page = (path.parent / target) if target else path
        assert page.exists() or (ROOT / f"{target}.py").exists(), f"{target} is not there"
        if anchor:
            slugs = {re.sub(r"[^\w -]", "", title).strip().lower().replace(" ", "-") for title in re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.M)}
            assert anchor in slugs


SECTION_OF_METHOD = re.compile(
    r"sections? (\d+)(?: and (\d+))? of docs/method\.md|(?:docs/|\()?(?:\.\./)?method(?:\.md)?\)?,? sections? (\d+)(?: and (\d+))?", re.IGNORECASE
)


def cited_sections(text):
    return [int(number) for groups in SECTION_OF_METHOD.findall(text) for number in groups if number]


def sections_cited_by(path):
    text = "\n".join(prose(path))
    cited = set(cited_sections(text))
    if path.name == "method.md":
        cited |= {
            int(number) for pair in re.findall(r"sections? (\d+)(?: and (\d+))?\b(?! of)", re.sub(r"^\|.*$", "", text, flags=re.M)) for number in pair if number
        }
    return cited


def test_sections_that_are_cited_exist():
    """In the method, whose sections name the files of the package and the core that cite them."""
    cited = {path: sections_cited_by(path) for path in PAGES + SOURCES}
    assert {name_of(path): numbers - SECTIONS.keys() for path, numbers in cited.items() if numbers - SECTIONS.keys()} == {}
    by_files = [(path, number) for path, numbers in cited.items() for number in numbers if PACKAGE in path.parents or ROOT / "cpp" in path.parents]
    assert len(by_files) > 15
    name = lambda path: str(path.relative_to(PACKAGE if PACKAGE in path.parents else ROOT))
    assert [f"{name(path)} cites section {number}, which does not name it" for path, number in by_files if name(path) not in SECTIONS[number]] == []


def test_a_section_is_cited_by_number_and_page():
    """Sections are the method's or the paper's: "section 3" alone leads nowhere."""
    for path in SOURCES:
        if path.is_relative_to(PACKAGE) or path.is_relative_to(ROOT / "cpp"):
            text = " ".join(" ".join(prose(path)).split())
            loose = re.findall(
                r"\b[Ss]ections? \d+\b(?! of (?:docs/method\.md|the paper|\[AHLMR12\]))[^.]{0,20}", re.sub(r"(method\.md), section \d+", r"\1", text)
            )
            assert loose == [], name_of(path)


# Equations of the paper


def equations(text):
    """ "(9), (10)" and "(1)-(5)" as numbers."""
    numbers = set()
    for match in re.finditer(r"\((\d{1,2})\)(?:(?:-| to )\((\d{1,2})\))?", text):
        numbers |= set(range(int(match[1]), int(match[2] or match[1]) + 1))
    return numbers


ROWS = {number: where for what, where, _ in EQUATION_ROWS for number in equations(what)}


def cited_equations(path):
    text = " ".join(" ".join(prose(path)).split())
    lists = re.findall(r"((?:\(\d{1,2}\)(?:, | and | to |-|,? ))+)of \[AHLMR12\]", text)
    cited = set().union(*map(equations, lists)) if lists else set()
    if path.name in ("method.md", "structure.md"):
        cited |= equations(re.sub(r"^\|.*$", "", text, flags=re.M))
    return cited


def test_equations_that_are_cited_are_in_the_table():
    cited = {name_of(path): cited_equations(path) for path in PAGES + SOURCES}
    assert {name: numbers - ROWS.keys() for name, numbers in cited.items() if numbers - ROWS.keys()} == {}
    assert len([name for name, numbers in cited.items() if numbers]) > 12


def defines(path, name):
    """Whether a Python file has a function, class or Class.method, a C++ file a class or a function, of that name."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return bool(re.search(rf"(?:class|struct|enum) {name}\b|\b{name.replace('::', ' *:: *')} *\(", text))
    body = ast.parse(text).body
    for part in name.split("."):
        node = next((node for node in body if getattr(node, "name", None) == part), None)
        if node is None:
            return False
        body = node.body
    return True


def test_the_table_of_equations_names_what_exists():
    assert len(EQUATION_ROWS) >= 14 and {1, 5, 8, 9, 11, 12, 13, 38, 39} <= ROWS.keys()
    for what, where, section in EQUATION_ROWS:
        for path, name in re.findall(r"`([\w./]+):([\w.:]+)`", where):
            assert found(path) and defines(found(path), name), f"{what}: {path}:{name}"
        assert where.count("`") == 2 * len(re.findall(r":[\w]", where.replace("::", ""))) and (not section or int(section) in SECTIONS)


def test_the_method_and_the_structure_name_files_with_their_folder():
    """A unit or module in backticks stands with its folder."""
    stems = {path.stem for path in SOURCES if path.is_relative_to(ROOT / "cpp") or path.is_relative_to(PACKAGE)} - {"material", "load", "problem", "operators"}
    for page in ("method.md", "structure.md"):
        spans = re.findall(r"`([^`]+)`", (ROOT / "docs" / page).read_text(encoding="utf-8"))
        assert [span for span in spans if re.sub(r"\.[chp]?pp$|\.py$", "", span) in stems] == []


def test_the_readers_see_what_they_should(tmp_path):
    """They are not blind."""
    assert equations("(1)-(5) and (8), (10)") == {1, 2, 3, 4, 5, 8, 10} and equations("(6) to (8)") == {6, 7, 8}
    assert cited_sections("section 7 of docs/method.md; docs/method.md, section 3") == [7, 3]
    assert cited_sections("the number of [method.md](method.md), section 7; sections 5 and 7 of docs/method.md") == [7, 5, 7]
    assert named_files("spaces/no_such.py and cpp/cut/element_map.hpp") == ["spaces/no_such.py", "cpp/cut/element_map.hpp"]
    assert found("spaces/no_such.py") is None and found("spaces/unknowns.py") and found("cpp/cut/element_map.hpp")
    assert defines(PACKAGE / "material.py", "Isotropic.Stress") and not defines(PACKAGE / "material.py", "Isotropic.Nothing")
    source = tmp_path / "a.py"
    source.write_text('"""See docs/gone.md."""\n\n\ndef f():\n    """Section 99 of docs/method.md."""  # (8) of [AHLMR12]\n')
    assert prose(source) == ["See docs/gone.md.", "Section 99 of docs/method.md.", "(8) of [AHLMR12]"]
