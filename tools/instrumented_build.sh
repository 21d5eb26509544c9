#!/usr/bin/env bash
# instrumented_build.sh PYTHON FOLDER CMAKE_OPTION...: compiles the package with these options into FOLDER/package, for PYTHONPATH.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$1 out=$2
shift 2
rm -rf "$out/package"
mkdir -p "$out/package"
cp -r "$root/ngsxfem_contact" "$out/package"
rm -f "$out"/package/ngsxfem_contact/*.so

cmake -S "$root" -B "$out/build" -G Ninja -DPython3_EXECUTABLE="$python" "$@" > "$out/cmake.log"
ninja -C "$out/build"
cmake --install "$out/build" --prefix "$out/package" > /dev/null
# Another copy that goes before PYTHONPATH would be tested in its place, and found clean.
cd "$out"
PYTHONPATH=$out/package "$python" -c "from importlib.util import find_spec; print(find_spec('ngsxfem_contact').origin)" | grep "^$out/"
