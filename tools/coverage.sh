#!/usr/bin/env bash
# Which lines the tests reach: coverage.sh PYTHON [test files and options of pytest]. Builds in build/coverage, reports there and on the screen.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
export PATH="$(dirname "$python"):$PATH"
out=$root/build/coverage
"$root/tools/instrumented_build.sh" "$python" "$out" -DCOVERAGE=ON -DCMAKE_BUILD_TYPE=Debug

cd "$out"
find . -name "*.gcda" -delete
rm -f .coverage*
status=0
PYTHONPATH=$out/package "$python" -m coverage run --rcfile="$root/pyproject.toml" --source=ngsxfem_contact -m pytest -q -p no:cacheprovider "${@:-$root/tests}" || status=$?
"$python" -m coverage combine -q
"$python" -m coverage report --rcfile="$root/pyproject.toml" | tee python.txt
"$python" -m gcovr --root "$root" --filter "$root/cpp/" --filter "$root/python/" --exclude-throw-branches --gcov-suspicious-hits-threshold 0 "$out/build" | tee cpp.txt
exit $status
