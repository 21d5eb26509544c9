"""How far λ_h and the gap are from being complementary."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from ngsolve import CoefficientFunction, IfPos, specialcf

from ..operators import NormalGap

if TYPE_CHECKING:
    from ..contact.solution import ContactSolution


def stiffness_of_plane(solution: ContactSolution) -> CoefficientFunction:
    """k = π E'/(4 h), stress / length: against an opening whose sign changes from element to element, of wavelength 2h.

    The square of the energy norm of such an opening of amplitude g is k g² for each length.
    """
    return 0.25 * pi * solution.problem.material.E_prime / specialcf.mesh_size


def contact_defect(solution: ContactSolution) -> CoefficientFunction:
    """(λ_h - min(0, λ_h + k (g_n + g_0)))²/k, 0 where λ_h ≤ 0, g_n + g_0 ≥ 0 and one of them is 0."""
    k, pressure = stiffness_of_plane(solution), solution.multiplier
    gap = NormalGap(solution.u, solution.body) + solution.problem.gap
    return IfPos(pressure + k * gap, pressure * pressure / k, k * gap * gap)
