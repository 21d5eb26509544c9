"""(12) of [AHLMR12] and its relatives: the cones, the laws of friction, the stabilisations, the systems, the problem and its solution."""

from .checks import Coercivity, InfSup
from .conditioning import ConditionNumber, CrackScaling
from .friction import Coulomb, Tresca
from .load_case import LoadCase
from .load_steps import LoadSteps
from .nitsche import Nitsche
from .problem import ContactProblem
from .solution import ContactSolution
from .stabilisation import BarbosaHughes, BothSides

__all__ = [
    "BarbosaHughes", "BothSides", "Nitsche", "Coulomb", "Tresca",  # stabilisations and laws of friction
    "ContactProblem", "ContactSolution", "LoadCase", "LoadSteps",  # the problem and its solutions
    "Coercivity", "InfSup", "ConditionNumber", "CrackScaling",  # checks by number
]  # fmt: skip
