"""What a solution says of its faces as a whole: forces, the area in contact, the gap."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
from ngsolve import Integrate

from ..arguments import crack_number
from ..operators import FIRST_TANGENTIAL, SECOND_TANGENTIAL, NormalGap

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction, GridFunction

    from .._ngsxfem_contact import CrackedMesh
    from .solution import ContactSolution


class OnFaces:
    """The part of a ContactSolution that is read on the faces of cracks.

    Other Parameters
    ----------------
    crack : int or str
        Number or name of the crack.
    """

    @property
    def _solved(self) -> ContactSolution:
        return cast("ContactSolution", self)

    def ContactForce(self, crack: int | str = 0) -> float:
        """∫λ over a crack, ≤ 0 unless a law pulls: the normal force that its faces exert on each other, stress × length.

        Returns
        -------
        float
            Stress × length.

        Raises
        ------
        ValueError
            For a crack that is not there.
        """
        return self._along(self._solved.multiplier, crack)

    def ContactArea(self, crack: int | str = 0) -> float:
        """The length of a crack, in space the area of a sheet, of the nodes in contact, with their weights ∫ψ_i.

        Raises
        ------
        ValueError
            For a crack that is not there.
        """
        nodes, number = self._solved.state.nodes, crack_number(crack, self._solved.body)
        return float(nodes.weights[self._solved.report.active[-1] & (nodes.cracks == number)].sum())

    @property
    def gap(self) -> CoefficientFunction:
        """g_n + g_0 on the cracks, a CoefficientFunction: how far the faces are apart."""
        return NormalGap(self._solved.u, self._solved.body) + self._solved.problem.gap

    def TangentialForce(self, crack: int | str = 0) -> Any:
        """∫λ_t over a crack, with the sign of the slip: the force on its minus side along t, in space a vector (3,); 0 without friction.

        Returns
        -------
        float or array
            Stress × length, in space × area.
        """
        return self._along(self._solved.tangential_multiplier, crack)

    def _along(self, function: CoefficientFunction | None, crack: int | str) -> Any:
        """∫ over a crack; of a vector its components."""
        number, mesh = crack_number(crack, self._solved.body), self._solved.body.mesh
        if function is None:
            return 0.0
        measure = self._solved.problem.W.dcrack(crack=number)
        return np.array([Integrate(part * measure, mesh) for part in function]) if function.dim > 1 else Integrate(function * measure, mesh)


def tangential(multipliers: list[GridFunction], body: CrackedMesh) -> CoefficientFunction | None:
    """λ_t of the multipliers for its components: none, that along the tangent, or in space the vector of those along both."""
    if len(multipliers) < 2:
        return multipliers[0] if multipliers else None
    first, second = multipliers
    return first * FIRST_TANGENTIAL.direction(body) + second * SECOND_TANGENTIAL.direction(body)
