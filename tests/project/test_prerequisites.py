"""What tools/check_prerequisites.py says of compilers."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

TOOL = Path(__file__).resolve().parents[2] / "tools" / "check_prerequisites.py"


def checked(compiler):
    return subprocess.run([sys.executable, str(TOOL)], env=os.environ | {"CXX": str(compiler)}, capture_output=True, text=True)


@pytest.mark.parametrize("script, said", [("[ $1 = -dumpfullversion ] && echo 11.4.0", "is version 11.4.0"), (None, "there is no ")])
def test_a_compiler_that_is_too_old_or_missing(tmp_path, script, said):
    compiler = tmp_path / "g++"
    if script:
        compiler.write_text(f"#!/bin/sh\n{script}\n")
        compiler.chmod(0o755)
    run = checked(compiler)
    assert run.returncode == 1 and "g++ >= 12" in run.stderr and said in run.stderr and "make CXX=g++-12" in run.stderr


def test_one_that_will_do(tmp_path):
    compiler = tmp_path / "g++"
    compiler.write_text("#!/bin/sh\nexit 0\n")
    compiler.chmod(0o755)
    run = checked(compiler)
    assert "C++20" not in run.stderr
