#!/usr/bin/env bash
# Tests under the address and undefined-behaviour sanitizers: sanitize.sh PYTHON [test files and options of pytest]. Builds in build/sanitize. Needs g++ with
# libasan and libubsan (part of Debian's g++) and some GB of memory. Fails on a finding, which the screen shows with its stack.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
export PATH="$(dirname "$python"):$PATH"
out=$root/build/sanitize
"$root/tools/instrumented_build.sh" "$python" "$out" -DSANITIZE=ON -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O1

# Findings go to files: pytest would swallow what a dying process writes. Leaks are not looked for: Python and NGSolve never free their types.
# FESpace.GetFE of NGSolve's Python allocates by new char[] (ngcore::Allocator) and frees by delete: not ours, and the only mismatch, as
# this package allocates by new in one place (python/solver.cpp).
cd "$out"
rm -f findings.*
status=0
LD_PRELOAD="$(g++ -print-file-name=libasan.so) $(g++ -print-file-name=libubsan.so) $(g++ -print-file-name=libstdc++.so)" \
ASAN_OPTIONS="detect_leaks=0:alloc_dealloc_mismatch=0:log_path=$out/findings" UBSAN_OPTIONS="print_stacktrace=1:log_path=$out/findings" \
PYTHONPATH=$out/package "$python" -m pytest -q -p no:cacheprovider "${@:-$root/tests}" || status=$?
if compgen -G "findings.*" > /dev/null; then
  cat findings.*
  exit 1
fi
exit $status
