"""The first example of the README runs as it stands."""

import re
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_the_first_crack():
    (code,) = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    names = {}
    exec(code, names)
    solution = names["solution"]
    assert solution.report.converged and solution.ContactForce() < 0
    profile = solution.Profile(n=11)
    assert profile.sigma_n[0] < 0 < profile.gap[8]  # pressed together at the mouth, open beside the tip
    assert len([line for line in code.splitlines() if line.strip() and "import" not in line]) <= 15
