"""The speed harness on a tiny mesh: its file has the fields and finite positive numbers. No time is judged."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "speed.py"


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    file = tmp_path_factory.mktemp("speed") / "speed.json"
    options = ["--sizes", "150", "--pairs", "P2/P1", "--bodies", "edge", "interior", "--threads", "1", "2", "--repeats", "2"]
    subprocess.run([sys.executable, str(SCRIPT), *options, "--json", str(file)], check=True, capture_output=True)
    return json.loads(file.read_text(encoding="utf-8"))


def test_every_case_has_every_time(result):
    assert [(c["body"], c["threads"]) for c in result["cases"]] == [("edge", 1), ("edge", 2), ("interior", 1), ("interior", 2)]
    for case in result["cases"]:
        times = case["times"]
        compared = {"space", "assembly", "whole solve"}
        alone = {"crack location", "rules", "rules of cut elements", "plain factorisation", "one load step"}
        assert compared | alone <= set(times)
        assert all({"plain", "ratio"} <= set(times[name]) for name in compared)
        for figure in times.values():
            assert all(math.isfinite(value) and value > 0 for value in figure.values())
        assert case["unknowns"] > case["plain unknowns"] > case["triangles"] > 50
        assert case["iterations"] > 0 and case["cut elements"] > 0 and case["set-up / assembly"] > 0


def test_memory_and_getfem(result):
    assert [(m["body"], m["pair"]) for m in result["memory"]] == [("edge", "P2/P1"), ("interior", "P2/P1")]
    assert all(m[which]["peak"] > max(1e7, m[which]["growth"]) for m in result["memory"] for which in ("contact", "plain"))
    (getfem,) = result["getfem"]
    assert getfem.get("seconds", 0) > 0 or "apt-get" in getfem["absent"]


def test_the_machine_is_named(result):
    assert result["machine"]["cores"] >= 1 and result["machine"]["processor"] and result["machine"]["ngsolve"]
