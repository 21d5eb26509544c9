"""Builds the C++ extension with CMake and Ninja; everything else is in pyproject.toml."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext


class CMakeBuild(build_ext):
    """`pip install .` builds afresh; an editable install keeps build/dev and compiles what changed."""

    def run(self):
        import netgen.config
        import ngsolve.config

        build = "build/dev" if self.inplace else self.build_temp
        prefix = Path("." if self.inplace else self.build_lib).resolve()
        arguments = [
            f"-DPython3_EXECUTABLE={sys.executable}",
            f"-DNetgen_DIR={netgen.config.get_cmake_dir()}",
            f"-DNGSolve_DIR={ngsolve.config.get_cmake_dir()}",
            f"-DNGSOLVE_VERSION={ngsolve.config.NGSOLVE_VERSION_PYTHON}",
            *([] if self.inplace else ["--fresh"]),
            *shlex.split(os.environ.get("CMAKE_ARGS", "")),
        ]
        subprocess.check_call(["cmake", "-S", ".", "-B", build, "-G", "Ninja", *arguments])
        subprocess.check_call(["cmake", "--build", build])
        subprocess.check_call(["cmake", "--install", build, "--prefix", str(prefix)])


setup(ext_modules=[Extension("ngsxfem_contact._ngsxfem_contact", sources=[])], cmdclass={"build_ext": CMakeBuild})
