"""`python -m pytest` puts the source tree first on the path; test what is installed instead, and find `study`, which is not, after it.

The processes of `-n` share the cores among them: one thread each for BLAS, whose threads would fight for them.
"""

import os
import sys
from pathlib import Path

ROOT = str(Path(__file__).resolve().parents[1])

if ROOT in sys.path:
    sys.path.remove(ROOT)
sys.path.append(ROOT)

if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OMP_NUM_THREADS", "1")
