"""Contact of cracked elastic bodies in NGSolve: cut-off XFEM, stabilised multipliers, active sets.

    from ngsolve import *
    from ngsxfem_contact import *

brings the names of `__all__`. Of NGSolve's own names one is replaced: Variation, which does for measures of a CrackedMesh
what NGSolve's does for its own, and for those the same.
"""

from . import (
    _version_check,  # noqa: F401  first: a mismatch must be seen before the extension is loaded
    geometry,  # noqa: F401  gives Crack its curves
)
from ._ngsxfem_contact import Crack, CrackBilinearForm, CrackedMesh, ElementKind, EndKind, Side, Variation
from .checks import Coercivity, InfSup
from .conditioning import ConditionNumber, CrackScaling
from .elasticity import Elasticity
from .errors import AccuracyWarning, NotCoercive, NotConverged, SingularSystem, SolveError
from .fracture import InteractionIntegral, JumpExtrapolation, ModeCoefficients
from .friction import Coulomb, Tresca
from .growth import CrackGrowth, GivenIncrement, MaximumHoopStress, Paris, WingCracks
from .interpolation import Interpolant, Projection
from .load_steps import LoadCase, LoadSteps
from .nitsche import Nitsche
from .nodal_newton import FixedPoint, FullNewton
from .operators import Gradient, Jump, Minus, NormalGap, NormalStress, Plus, Slip, Strain, TangentialStress
from .problem import ContactProblem
from .solution import ContactSolution
from .spaces import CrackFESpace, TipEnrichment, TraceSpace
from .stabilisation import BarbosaHughes, BothSides

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
