"""(12) of [AHLMR12] and its relatives: the cones, the laws of friction, the stabilisations, the systems, the problem and its solution."""

from .checks import Coercivity, InfSup
from .conditioning import ConditionNumber, CrackScaling
from .faces import FaceHistory
from .friction import Coulomb, Tresca
from .laws import BartonBandis, Dugdale, ExponentialCohesive, Joint, LinearCohesive, MohrCoulomb
from .load_case import LoadCase
from .load_steps import LoadSteps
from .nitsche import Nitsche
from .path_steps import PathSteps
from .problem import ContactProblem
from .solution import ContactSolution
from .stabilisation import BarbosaHughes, BothSides

__all__ = [
    "BarbosaHughes", "BothSides", "Nitsche",  # stabilisations
    "Coulomb", "Tresca", "MohrCoulomb", "Joint", "BartonBandis", "LinearCohesive", "ExponentialCohesive", "Dugdale",  # laws of the faces
    "ContactProblem", "ContactSolution", "LoadCase", "LoadSteps", "PathSteps", "FaceHistory",  # the problem and its solutions
    "Coercivity", "InfSup", "ConditionNumber", "CrackScaling",  # checks by number
]  # fmt: skip
