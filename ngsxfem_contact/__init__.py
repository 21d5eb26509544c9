"""Contact of cracked elastic bodies in NGSolve: cut-off XFEM, stabilised multipliers, active sets.

    from ngsolve import *
    from ngsxfem_contact import *

brings the names of `__all__`. Of NGSolve's own names one is replaced: Variation, which does for measures of a CrackedMesh
what NGSolve's does for its own, and for those the same.
"""

import logging

# In the order of dependence: each line knows those above it only (tests/project/test_architecture.py).
from . import _version_check  # first: a mismatch must be seen before the extension is loaded
from ._ngsxfem_contact import Crack, CrackBilinearForm, CrackedMesh, ElementKind, EndKind, Side, Variation
from . import curves  # noqa: F401  gives Crack its curves
from .errors import AccuracyWarning, NotCoercive, NotConverged, SingularSystem, SolveError
from .material import Elasticity
from .operators import Gradient, Jump, Minus, NormalGap, NormalStress, Plus, Slip, Strain, TangentialStress
from .algebra.nodal_newton import FixedPoint, FullNewton
from .spaces.crack_fespace import CrackFESpace, TipEnrichment
from .spaces.trace_space import TraceSpace
from .spaces.interpolation import Interpolant, Projection
from . import pictures  # noqa: F401
from .fracture.stress_intensity import InteractionIntegral, JumpExtrapolation, ModeCoefficients
from .fracture.growth import CrackGrowth, GivenIncrement, MaximumHoopStress, Paris, WingCracks
from . import loads  # noqa: F401
from .contact.stabilisation import BarbosaHughes, BothSides
from .contact.nitsche import Nitsche
from .contact.friction import Coulomb, Tresca
from .contact.problem import ContactProblem
from .contact.solution import ContactSolution
from .contact.load_steps import LoadCase, LoadSteps
from .contact.checks import Coercivity, InfSup
from .contact.conditioning import ConditionNumber, CrackScaling
from . import exact  # noqa: F401

__version__ = _version_check.VERSION
logging.getLogger(__name__).addHandler(logging.NullHandler())

__all__ = [
    "Crack", "CrackedMesh", "Side", "EndKind", "ElementKind",  # body and crack
    "CrackFESpace", "TipEnrichment", "TraceSpace", "Interpolant", "Projection",  # spaces
    "Plus", "Minus", "Jump", "Gradient", "Strain", "NormalGap", "Slip", "NormalStress", "TangentialStress", "Variation",  # operators
    "ContactProblem", "CrackBilinearForm", "Elasticity", "BarbosaHughes", "BothSides", "Nitsche",  # the problem
    "Tresca", "Coulomb", "FullNewton", "FixedPoint", "LoadCase", "LoadSteps",  # friction and load steps
    "ContactSolution", "InteractionIntegral", "ModeCoefficients", "JumpExtrapolation",  # the answer
    "CrackGrowth", "GivenIncrement", "MaximumHoopStress", "Paris", "WingCracks",  # growth
    "Coercivity", "InfSup", "ConditionNumber", "CrackScaling",  # checks by number
    "SolveError", "NotConverged", "SingularSystem", "NotCoercive", "AccuracyWarning",  # exceptions and warnings
]  # fmt: skip
