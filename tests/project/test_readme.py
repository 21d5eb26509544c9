"""The first example of the README runs as it stands."""

import re
from pathlib import Path

README = Path(__file__).parents[2] / "README.md"


def test_the_first_crack():
    (code,) = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    names = {}
    exec(code, names)
    solution = names["solution"]
    assert solution.report.converged and solution.ContactForce() < 0
    profile = solution.Profile(n=11)
    assert profile.sigma_n[0] < 0 < profile.gap[8]  # pressed together at the mouth, open beside the tip
    assert len([line for line in code.splitlines() if line.strip() and "import" not in line]) <= 15


def test_what_builds_documents_and_draws_examples_is_pinned():
    """A new version of a tool must not turn a green run red, nor draw other examples: every tool of these extras has one version."""
    root = Path(__file__).parents[2]
    extras = re.findall(r"^(?:test|docs|plot) = \[(.*?)\]", (root / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
    tools = {re.match(r"[\w-]+", tool.strip(' "'))[0] for extra in extras for tool in extra.split(",")}
    pinned = {line.split("==")[0] for line in (root / "tools" / "constraints.txt").read_text(encoding="utf-8").splitlines() if not line.startswith("#")}
    assert len(extras) == 3 and tools <= pinned
    assert "-c tools/constraints.txt" in (root / "Makefile").read_text(encoding="utf-8")
