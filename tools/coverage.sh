#!/usr/bin/env bash
# Which lines the tests reach: coverage.sh PYTHON [pytest arguments]. Builds in build/coverage, reports there and on the screen.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
export PATH="$(dirname "$python"):$PATH"
out=$root/build/coverage package=$root/build/coverage/package/ngsxfem_contact
mkdir -p "$package"
cp -r "$root"/ngsxfem_contact/*.py "$root"/ngsxfem_contact/*.pyi "$root"/ngsxfem_contact/py.typed "$package"

dir() { "$python" -m "$1.config" get_cmake_dir; }
cmake -S "$root" -B "$out/build" -G Ninja -DCOVERAGE=ON -DCMAKE_BUILD_TYPE=Debug -DPython3_EXECUTABLE="$python" \
  -DNGSolve_DIR="$(dir ngsolve)" -DNetgen_DIR="$(dir netgen)" -DNGSOLVE_VERSION="$("$python" -c 'import ngsolve.config as c; print(c.NGSOLVE_VERSION_PYTHON)')" > "$out/cmake.log"
ninja -C "$out/build"
cp "$out"/build/*.so "$out"/build/_build_info.py "$package"

cd "$out"
find . -name "*.gcda" -delete
rm -f .coverage*
status=0
PYTHONPATH=$out/package "$python" -m coverage run --rcfile="$root/pyproject.toml" --source=ngsxfem_contact -m pytest -q -p no:cacheprovider "$root/tests" "$@" || status=$?
"$python" -m coverage combine -q
"$python" -m coverage report --rcfile="$root/pyproject.toml" | tee python.txt
"$python" -m gcovr --root "$root" --filter "$root/cpp/" --filter "$root/python/" --exclude-throw-branches "$out/build" | tee cpp.txt
exit $status
