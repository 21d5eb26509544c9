"""`python -m pytest` puts the source tree first on the path; test what is installed instead. `study` is found by the file that make puts into .venv.

One thread each for NGSolve and BLAS: these problems are too small to gain from more, and the processes of `-n` would fight for the cores.
`helpers.threads` is for tests of threads.
"""

import os
import sys
from pathlib import Path

ROOT = str(Path(__file__).resolve().parents[1])

if ROOT in sys.path:
    sys.path.remove(ROOT)
    sys.path.append(ROOT)

for threads in ("NGS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(threads, "1")
