"""Links of the README and of all pages to files and headings beside them lead somewhere, on a forge as in the built documents."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [page for folder in (".", "docs", "docs/questions", "benchmarks", "examples", ".github") for page in sorted((ROOT / folder).glob("*.md"))]
CODE = re.compile(r"^```.*?^```$|`[^`\n]*`", re.MULTILINE | re.DOTALL)


def anchors(page):
    """Of its headings, as GitHub and Sphinx make them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def target(page, path):
    """The file that a link leads to; notebooks of the tutorials are made from scripts."""
    if re.fullmatch(r"(\.\./)?tutorials/\w+", path):
        return ROOT / "tutorials" / f"{Path(path).name}.py"
    return page.parent / path if path else page


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)\s]+)\)", CODE.sub("", page.read_text(encoding="utf-8")))
    for path, _, anchor in (link.partition("#") for link in links if not re.match(r"https?:", link)):
        file = target(page, path)
        assert file.exists(), (path, "is not there")
        assert not anchor or anchor in anchors(file), (path, anchor)


def test_a_page_has_links():
    """The pattern finds them."""
    assert sum("](" in page.read_text(encoding="utf-8") for page in PAGES) > 50
