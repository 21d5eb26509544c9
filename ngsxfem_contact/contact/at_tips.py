"""What a solution says of its tips: stress intensity factors, energy release rates, T-stresses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from .. import tables
from ..fracture import stress_intensity as fracture

if TYPE_CHECKING:
    from ..fracture.stress_intensity import EnergyReleaseRate, StressIntensityFactors, TStress
    from ..tables import Table
    from .solution import ContactSolution


NAN = float("nan")
NUMBERS = ("K_I", "K_II", "error", "G", "G_error", "irwin", "T")
TIP_COLUMNS = ("tip", "crack", "x", "y", *NUMBERS, "method", "note")


class AtTips:
    """The part of a ContactSolution that is read at tips.

    Other Parameters
    ----------------
    tip : int
        A number in `body.tips`.
    """

    def Table(self, radius: float | None = None) -> Table:
        """A Table with a row for each tip of `body.tips`.

        Its columns: the numbers of the tip and of its crack, the place x, y; K_I and K_II, their error, and the method that they come from, "interaction", or "modes"
        where a disk has no room; G of the J-integral, its error, and Irwin's value; the T-stress. What cannot be told is NaN, and the note says why.

        Parameters
        ----------
        radius : float
            Of the largest disk, as for StressIntensity.
        """
        solution = self._solution
        rows = (tip_row(solution, tip, radius) | {"T": t_stress_at(solution, tip, radius)} for tip in range(len(solution.body.tips)))
        return tables.Table.OfRows(rows, TIP_COLUMNS)

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


def tip_row(solution: ContactSolution, tip: int, radius: float | None = None) -> dict[str, Any]:
    """A row of the table of tips, without the T-stress."""
    where = solution.body.tips[tip]
    row: dict[str, Any] = {"tip": tip, "crack": where.crack, "x": where.point[0], "y": where.point[1], **dict.fromkeys(NUMBERS, NAN), "method": "", "note": ""}
    try:
        row |= factors_by(solution, tip, "interaction", radius)
        rate = solution.EnergyReleaseRate(tip, radius)
        row |= {"G": rate.G, "G_error": rate.error, "irwin": rate.irwin}
    except ValueError as reason:
        row["note"] = str(reason)
        if not row["method"]:
            row |= factors_from_modes(solution, tip)
    return row


def t_stress_at(solution: ContactSolution, tip: int, radius: float | None) -> float:
    """The T-stress; NaN where it cannot be told, for the reasons of K."""
    try:
        return solution.TStress(tip, radius).T
    except ValueError:
        return NAN


def factors_from_modes(solution: ContactSolution, tip: int) -> dict[str, Any]:
    """K from the coefficients of the modes; nothing where the space has none."""
    try:
        return factors_by(solution, tip, "modes")
    except ValueError:
        return {}


def factors_by(solution: ContactSolution, tip: int, method: str, radius: float | None = None) -> dict[str, Any]:
    """K by one method."""
    K = solution.StressIntensity(tip, method, radius)
    return {"K_I": K.K_I, "K_II": K.K_II, "error": K.error, "method": method}
