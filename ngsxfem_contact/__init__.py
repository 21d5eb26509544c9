"""Contact of cracked elastic bodies in NGSolve: cut-off XFEM, stabilised multipliers, active sets."""

from . import (
    _version_check,  # noqa: F401  first: a mismatch must be seen before the extension is loaded
    geometry,  # noqa: F401  gives Crack its curves
)
from ._ngsxfem_contact import Crack, CrackBilinearForm, CrackedMesh, ElementKind, EndKind, Side, Variation
from .checks import Coercivity, InfSup
from .conditioning import ConditionNumber, CrackScaling
from .elasticity import Elasticity
from .errors import NotCoercive, NotConverged, SingularSystem, SolveError
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
