"""Checks what pip cannot install: Python >= 3.10, venv, Python.h, a C++20 compiler (g++ >= 12). Runs on any Python 3.

Debian 12 and 13 and Ubuntu 24.04 and 26.04 have them in python3-venv, python3-dev, g++; Ubuntu 22.04 has g++ 11, beside which g++-12 is installed.
"""

import os
import shlex
import subprocess
import sys
import sysconfig

CXX = os.environ.get("CXX", "g++")
PROGRAM = "#include <concepts>\n#include <ranges>\nint main() { return 0; }\n"


def has_python():
    return sys.version_info >= (3, 10)


def has_venv():
    try:
        import ensurepip, venv  # noqa: E401, F401
    except ImportError:
        return False
    return True


def has_headers():
    return os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h"))


def has_compiler():
    command = shlex.split(CXX) + "-x c++ -std=c++20 -fabi-version=17 -fsyntax-only -".split()
    try:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL)
    except OSError:
        return False
    process.communicate(PROGRAM.encode())
    return process.returncode == 0


def compiler():
    """What is there, with its version."""
    try:
        version = subprocess.check_output(shlex.split(CXX) + ["-dumpfullversion", "-dumpversion"], stderr=subprocess.DEVNULL).decode().strip()
    except (OSError, subprocess.CalledProcessError):
        return "there is no " + CXX
    return "%s is version %s" % (CXX, version)


CHECKS = [
    (has_python, "Python >= 3.10, not %d.%d" % sys.version_info[:2], "python3 (then: make PYTHON=/path/to/python3)"),
    (has_venv, "Python's venv and ensurepip modules", "python3-venv"),
    (has_headers, "Python's headers (Python.h)", "python3-dev"),
    (has_compiler, "a compiler for C++20, g++ >= 12: " + compiler(), "g++ (where that is older: g++-12, then make CXX=g++-12 ...)"),
]

missing = [(what, package) for works, what, package in CHECKS if not works()]
for what, package in missing:
    print("missing: %s\n  on Debian/Ubuntu: sudo apt-get install %s" % (what, package), file=sys.stderr)
sys.exit(1 if missing else 0)
