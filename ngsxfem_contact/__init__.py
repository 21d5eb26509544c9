"""Contact of cracked elastic bodies in NGSolve: cut-off XFEM, stabilised multipliers, active sets.

    from ngsolve import *
    from ngsxfem_contact import *

brings the names of `__all__`, those of a first script. The others are those of the `__all__` of the sub-packages and of geometry, errors, operators and tables:
docs/api.md. Of NGSolve's own names one is replaced: Variation, which does for measures of a CrackedMesh what NGSolve's does for its own, and for
those the same.
"""

import logging

# In the order of dependence: each line knows those above it only (tests/project/test_architecture.py).
from . import _version_check  # first: a mismatch must be seen before the extension is loaded
from .geometry import Crack, CrackedMesh
from .errors import SolveError
from .material import Elasticity
from .operators import Jump, Minus, NormalGap, Plus, Slip, Strain, Variation
from . import algebra  # noqa: F401
from .spaces import CrackFESpace, TipEnrichment, TraceSpace
from . import plotting  # noqa: F401
from .fracture import CrackGrowth, GivenIncrement, Paris
from . import loads  # noqa: F401
from . import estimate  # noqa: F401
from .contact import BarbosaHughes, ContactProblem, ContactSolution, Coulomb, LoadCase, LoadSteps, Nitsche, Tresca
from . import exact  # noqa: F401
from . import job  # noqa: F401

__version__ = _version_check.VERSION
logging.getLogger(__name__).addHandler(logging.NullHandler())

__all__ = [
    "Crack", "CrackedMesh", "CrackFESpace", "TipEnrichment", "TraceSpace", "Elasticity",  # body, spaces, material
    "Plus", "Minus", "Jump", "Strain", "NormalGap", "Slip", "Variation",  # operators
    "ContactProblem", "ContactSolution", "BarbosaHughes", "Nitsche", "Coulomb", "Tresca", "LoadCase", "LoadSteps",  # the problem
    "CrackGrowth", "GivenIncrement", "Paris", "SolveError",  # growth and refusals
]  # fmt: skip


def __getattr__(name: str) -> object:
    """A public name of a sub-package or module: `from ngsxfem_contact import WingCracks` works, too."""
    for part in ("processes", "geometry", "errors", "operators", "tables", "algebra", "spaces", "plotting", "fracture", "loads", "estimate", "contact"):
        if name in globals()[part].__all__:
            return getattr(globals()[part], name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
