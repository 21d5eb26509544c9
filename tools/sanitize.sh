#!/usr/bin/env bash
# Tests under the address and undefined-behaviour sanitizers: sanitize.sh PYTHON [test files and options of pytest]. Builds in build/sanitize.
# Needs g++ with libasan and libubsan (part of Debian's g++). Fails on a finding, which the screen shows with its stack.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
python=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shift
export PATH="$(dirname "$python"):$PATH"
out=$root/build/sanitize
"$root/tools/instrumented_build.sh" "$python" "$out" -DSANITIZE=ON -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O1

# The first finding ends the run, with its stack on the screen: pytest must not capture file descriptor 2 (and log_path is not obeyed by
# libubsan beside libasan). Leaks are not looked for: Python and NGSolve never free their types. FESpace.GetFE of NGSolve's Python allocates
# by new char[] (ngcore::Allocator) and frees by delete: not ours, and the only mismatch; this package allocates by new in python/solver.cpp only.
export LD_PRELOAD="$(g++ -print-file-name=libasan.so) $(g++ -print-file-name=libubsan.so) $(g++ -print-file-name=libstdc++.so)"
export ASAN_OPTIONS=detect_leaks=0:alloc_dealloc_mismatch=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
cd "$out"
PYTHONPATH=$out/package exec "$python" -m pytest -q -p no:cacheprovider --capture=sys "${@:-$root/tests}"
