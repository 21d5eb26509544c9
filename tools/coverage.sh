#!/usr/bin/env bash
# Which lines the tests reach: coverage.sh PYTHON [--results NAME] [test files and options of pytest].
# Builds in build/coverage, reports there and on the screen; --results keeps the sums in benchmarks/results/NAME.txt, for the documents.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
results=""
if [ "${1-}" = --results ]; then
  results=$root/benchmarks/results/$2.txt
  heading="# tools/coverage.sh .venv/bin/python --results $2"
  shift 2
fi
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
if [ -n "$results" ]; then
  {
    echo "$heading"
    echo "# measured with $("$python" -m coverage --version | head -n 1) on $(date +%F)"
    awk '/^TOTAL/ { print "Python", $NF, "of", $2, "lines" }' python.txt
    awk '/^TOTAL/ { print "C++ core and exports", $4, "of", $2, "lines" }' cpp.txt
  } > "$results"
fi
exit $status
