"""The study of section 4 of [AHLMR12], beside the package: what this one paper needs and no other user does.

    python -m study             the convergence and γ_0 studies, with the figures of the paper
    python -m study.analysis    its analysis by number

It lies beside the package, in its sources; the environment of `make` finds it from every folder.
"""

import sys
from pathlib import Path

ROOT = str(Path(__file__).resolve().parents[1])

# Python looks first where it was started; there are the sources of the package, too, and what is installed is to be found before them
if str(Path(sys.path[0]).resolve()) == ROOT:
    sys.path[:] = [*sys.path[1:], ROOT]
