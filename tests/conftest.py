"""`python -m pytest` puts the source tree first on the path; test what is installed instead, and find `study`, which is not, after it."""

import sys
from pathlib import Path

ROOT = str(Path(__file__).resolve().parents[1])

if ROOT in sys.path:
    sys.path.remove(ROOT)
sys.path.append(ROOT)
