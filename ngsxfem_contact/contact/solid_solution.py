"""The solution of a problem in space: what is read along fronts stands where that of the plane is read at tips."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import IfPos

from .. import _ngsxfem_contact as core
from ..arguments import check_item, crack_number
from ..fracture.front_fields import FrontField
from ..fracture.front_stress_intensity import COLUMNS, FrontFactors, front_factors
from ..fracture.front_tube import FrontCurve
from ..fracture.given_stress import elements_near_fronts, stress_derivatives
from ..operators import Gradient
from ..share import AROUND
from ..sheets import check_plane
from ..tables import Table
from .sheet_profile import SheetProfile, borders, sheet_profile
from .solution import ContactSolution

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

SIDES = ("plus", "minus")


class SolidSolution(ContactSolution):
    """A ContactSolution of a body in space.

    Other Parameters
    ----------------
    front : int
        A number in `body.fronts`.
    radius : float
        Of the largest tube around a front, a length; default four elements, of order 1 as far as the modes reach (FrontEnrichment), less where there is no room.
    """

    @property
    def body(self) -> Any:
        """The CrackedSolid."""
        return self.problem.body

    def StressIntensity(self, front: int = 0, radius: float | None = None, nodes: int | None = None) -> FrontFactors:  # type: ignore[override]
        """K_I, K_II, K_III and G along a front, with their errors: FrontFactors, by the interaction integral over tubes.

        Parameters
        ----------
        nodes : int
            Into how many intervals, at least 5, each part of the front between corners is divided; default one for two elements.

        Raises
        ------
        ValueError
            For a front that is not there, a tube that does not fit, and a coefficient of the load that has changed since the solve.
        """
        return self._factors(front_field(self), front, radius, nodes)

    def _factors(self, u: FrontField, front: int, radius: float | None = None, nodes: int | None = None) -> FrontFactors:
        """Those of a front; of several processes that of the first, as a search may find another one of two elements beside a point."""
        share = self.problem.V.share
        check_item(front, self.body.fronts, "front", "body.fronts")
        share.Refuse(
            f"A tube with a radius of more than {AROUND} elements",
            isinstance(radius, int | float) and radius > (1 + 1e-9) * AROUND * FrontCurve(self.body, front).h,
        )
        found = share.Together(lambda: front_factors(self.body, u, self.problem.material, front, radius, nodes))
        of_first = share.FromFirst({one.name: getattr(found, one.name) for one in fields(found) if one.name != "body"})
        return replace(found, **of_first)

    def Table(self, radius: float | None = None) -> Table:
        """K, G and their errors at the nodes of all fronts, a row for each node: see FrontFactors.table."""
        field = front_field(self)
        found = [self._factors(field, front, radius).columns for front in range(len(self.body.fronts))]
        return Table.Of({name: np.concatenate([columns[name] for columns in found]) if found else np.zeros(0) for name in COLUMNS})

    def Profile(self, crack: int | str = 0) -> SheetProfile:  # type: ignore[override]
        """A SheetProfile: gap, slip, pressure and state in each polygon in which a sheet cuts an element, in the user's units.

        Raises
        ------
        ValueError
            For a sheet that is not there.
        """
        return sheet_profile(self, crack_number(crack, self.body))

    def Transitions(self, crack: int | str = 0) -> np.ndarray:
        """(k, 2, 3): the edge of contact on a sheet, as the ends of the sides between polygons of which one is open and the other is not."""
        return borders(self, crack_number(crack, self.body), lambda a, b: (a == "open") != (b == "open"))

    def SlipTransitions(self, crack: int | str = 0) -> np.ndarray:
        """(k, 2, 3): in the same way the sides between polygons of which one sticks and the other slips."""
        return borders(self, crack_number(crack, self.body), lambda a, b: {a, b} == {"stick", "slip"})

    def SaveVTK(self, path: str | Path, factors: Sequence[FrontFactors] = ()) -> str:
        """Writes three .vtu files for ParaView and returns the name of the first: all of them appear when they are complete, or none.

        The file `path` has the body, open along its sheets: displacement at points, and of cells, at their centres, von_mises, stress_xx to stress_xz, side (1 plus, -1 minus, of
        those that touch a lip) and region, the number of the material; tetrahedra are quadratic where u is. Points on a sheet are there once for each lip, so that filters
        such as CellDatatoPointData do not mix them; `Clean` would. The one whose name ends in `_sheets` has the polygons in which the sheets cut the elements: pressure -λ, gap, slip, traction λ_t (the
        means of Profile, slip and traction as vectors), sheet, and state (0 open, 1 contact or stick, 2 slip), and at their corners displacement_plus, displacement_minus and
        their difference jump. That in `_fronts` has the fronts as lines, with s and what factors say.

        Parameters
        ----------
        path
            The ending .vtu is added if it is missing.
        factors
            FrontFactors of this solution, `[solution.StressIntensity(0)]`: K_I, K_II, K_III, G and their errors become data of the fronts, linear between nodes and NaN where
            nothing is known.

        Raises
        ------
        ValueError
            For factors of another body, or two of one front.
        FileNotFoundError
            If there is no such folder.
        OSError
            If the disk is full.
        """
        from ..plotting.plots import save_vtk

        return save_vtk(self, path, factors)

    def EnergyReleaseRate(self, *arguments: Any, **named: Any) -> Any:
        """For tips, which a body in space does not have: StressIntensity(front) has G. Raises ValueError."""
        check_plane(self.body, "EnergyReleaseRate (StressIntensity(front) has G)")

    def TStress(self, *arguments: Any, **named: Any) -> Any:
        """For tips, which a body in space does not have. Raises ValueError."""
        check_plane(self.body, "TStress")


@singledispatch
def solution_in(V: core.CrackFESpace) -> type[ContactSolution]:
    """What solutions in a space are."""
    return ContactSolution


@solution_in.register(core.SolidFESpace)
def solution_in_space(V: core.SolidFESpace) -> type[ContactSolution]:
    """SolidSolutions."""
    return SolidSolution


def front_field(solution: SolidSolution) -> FrontField:
    """What integrals around fronts read of a solution. Raises ValueError for a coefficient of the load that has changed since the solve.

    On closed lips σn is what contact and friction say, λ n + λ_t, beside the tractions that are given: σ(u⁺)n = λ n + λ_t - t⁺, σ(u⁻)n = λ n + λ_t + t⁻. How far the mean
    of both sides of σ(u_h)n is from that, where the faces press on each other, is the doubt.
    """
    solution.CheckLoad()
    body, u, given, pressure = solution.body, solution.u, solution.FaceTractions(), solution.multiplier
    contact = pressure * body.normal
    if solution.tangential_multiplier is not None:
        contact = contact + solution.tangential_multiplier
    traction = {"plus": contact - given.plus, "minus": contact + given.minus}
    stress = solution.load.stress
    found = [solution.ElasticStress(side) * body.normal for side in SIDES]
    change = None
    if stress is not None:
        found = [traction_of + body.LimitOnCrack(stress, sign) * body.normal for traction_of, sign in zip(found, (1, -1))]
        change = tuple(stress_derivatives(stress, solution.problem.V, elements_near_fronts(body), "a front"))
    doubt = 0.5 * (traction["plus"] + traction["minus"] - found[0] - found[1])
    faces = {side: Gradient(u, side) for side in SIDES}
    V = solution.problem.V
    reach = V.front_spec.rules.radius if V.order == 1 and V.front_spec is not None else None
    return FrontField(Gradient(u), faces, traction, pressure, IfPos(-1 * pressure, doubt, 0 * doubt), solution.load.BodyForces(), stress, change, reach)
