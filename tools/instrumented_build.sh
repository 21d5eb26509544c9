#!/usr/bin/env bash
# instrumented_build.sh PYTHON FOLDER CMAKE_OPTION...: compiles the package with these options into FOLDER/package, for PYTHONPATH.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$1 out=$2 package=$2/package/ngsxfem_contact
shift 2
mkdir -p "$package"
cp -r "$root"/ngsxfem_contact/*.py "$root"/ngsxfem_contact/*.pyi "$root"/ngsxfem_contact/py.typed "$package"

dir() { "$python" -m "$1.config" get_cmake_dir; }
cmake -S "$root" -B "$out/build" -G Ninja -DPython3_EXECUTABLE="$python" -DNGSolve_DIR="$(dir ngsolve)" -DNetgen_DIR="$(dir netgen)" \
  -DNGSOLVE_VERSION="$("$python" -c 'import ngsolve.config as c; print(c.NGSOLVE_VERSION_PYTHON)')" "$@" > "$out/cmake.log"
ninja -C "$out/build"
cp --remove-destination "$out"/build/*.so "$out"/build/_build_info.py "$package"
