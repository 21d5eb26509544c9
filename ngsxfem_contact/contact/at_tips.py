"""What a solution says of its tips: stress intensity factors, energy release rates, T-stresses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from ..fracture import stress_intensity as fracture

if TYPE_CHECKING:
    from ..fracture.stress_intensity import EnergyReleaseRate, StressIntensityFactors, TStress
    from .solution import ContactSolution


class AtTips:
    """The part of a ContactSolution that is read at tips.

    Other Parameters
    ----------------
    tip : int
        A number in `body.tips`.
    """

    @property
    def _solution(self) -> ContactSolution:
        return cast("ContactSolution", self)

    def StressIntensity(self, tip: int = 0, method: Any = "interaction", radius: float | None = None) -> StressIntensityFactors:
        """K_I, K_II at a tip of `body.tips`: StressIntensityFactors, also as  K_I, K_II = solution.StressIntensity(tip).

        Parameters
        ----------
        method
            "interaction" (default), the interaction integral over disks around the tip, with the body force and the tractions of closed lips; "modes", the
            coefficients of the space's modes; "jump", extrapolated jumps; or an object with Evaluate(solution, tip): InteractionIntegral, ModeCoefficients,
            JumpExtrapolation.
        radius
            Of the largest disk, in the unit of length; default eight elements, less where there is no room.

        Raises
        ------
        ValueError
            For a disk that does not fit, for a method that the space does not allow, and for a load on derivatives of the test function.

        Notes
        -----
        The crack may bend inside the disk; ∂Ω and other cracks must be outside. The material is the same in the disk, and coefficients of the load (such as a
        Parameter) have the values of the solve.
        """
        return fracture.stress_intensity(self._solution, tip, method, radius)

    def EnergyReleaseRate(self, tip: int = 0, radius: float | None = None) -> EnergyReleaseRate:
        """G at a tip by the J-integral over disks, and by Irwin from K_I, K_II; see EnergyReleaseRate of `fracture`.

        J is quadratic in u: with P1 on coarse meshes Irwin's value is the better one. Raises as StressIntensity.

        Parameters
        ----------
        radius : float
            Of the largest disk, a length; default eight elements, less where there is no room.
        """
        return fracture.energy_release_rate(self._solution, tip, radius)

    def TStress(self, tip: int = 0, radius: float | None = None) -> TStress:
        """The T-stress at a tip, by an interaction integral with the field of a force in the tip: a TStress, float(...) is its value.

        It is the constant part of σ_ee, e the direction ahead: with given stresses, pressure on the faces and contact. radius: as for StressIntensity.

        Raises as StressIntensity.

        Parameters
        ----------
        radius : float
            Of the largest disk, a length; default eight elements, less where there is no room.
        """
        return fracture.t_stress(self._solution, tip, radius)
