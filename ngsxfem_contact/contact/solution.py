"""What a solve returns."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import GridFunction, Id, Integrate

from ..algebra.nodal_newton import FREE
from ..arguments import check_regions, check_whole, crack_number
from ..description import Described
from ..loads.changes import check_unchanged
from ..loads.load import LoadTerms
from ..operators import NORMAL
from ..spaces.incompressible import stress, stress_power
from .at_tips import AtTips
from .descriptions import of_solution
from .mixed_system import LocalPressures
from .of_errors import OfErrors
from .on_faces import OnFaces, tangential
from .profile import CrackProfile, State, changes, profile

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackedMesh
    from ..description import Lines
    from ..loads.face_traction import FaceTractions
    from ..loads.reactions import SupportForces, SupportResidual
    from ..operators import Component
    from .assembled import AssembledProblem
    from .load_case import SolvedCase
    from .mixed_system import PressureField
    from .problem import ContactProblem
    from .report import Report


class ContactSolution(Described, AtTips, OnFaces, OfErrors):
    """What a solve found: displacement, pressure, and what can be read from them.

    With Nitsche's method the multipliers are L² projections of the pointwise law onto W.

    Parameters
    ----------
    problem : ContactProblem
        What was solved.
    recover
        A function without arguments that computes the displacement and the SupportResidual: it is called when one of them is first used.
    multipliers : sequence of GridFunctions
        λ, and with friction λ_t.
    report : Report
        What the solve did.
    gamma : CoefficientFunction or None
        γ on the cracks.
    state : State
        For the next load step.
    case
        The load of this step, a SolvedCase: F, and the terms it comes from.
    reduced
        The AssembledProblem that was solved, whose factors serve estimates of errors; a file does not hold it.

    Attributes
    ----------
    u : GridFunction
        The displacement.
    multiplier : GridFunction
        λ, the normal traction that the faces exert on each other: ≤ 0, but where a law pulls.
    tangential_multiplier : GridFunction or None
        λ_t; None without friction. In space a CoefficientFunction, a vector in the plane of the sheet.
    a : StiffnessForm
        The springs and joints of the solve.

    Other Parameters
    ----------------
    crack : int or str
        Number or name of the crack.
    tip : int
        A number in `body.tips`.
    """

    def __init__(
        self,
        problem: ContactProblem,
        recover: Callable[[], tuple[GridFunction, SupportResidual]],
        multipliers: list[GridFunction],
        report: Report,
        gamma: CoefficientFunction,
        state: State,
        case: SolvedCase,
        reduced: AssembledProblem | None = None,
    ) -> None:
        self.problem, self._recover, self.report, self.gamma, self.state = problem, recover, report, gamma, state
        self.a = problem.a.Copy()
        self.case, self._reduced = case, reduced
        self.multiplier, self.tangential_multiplier = multipliers[0], tangential(multipliers[1:], problem.body)

    def __getstate__(self) -> dict[str, Any]:
        """What pickle saves: all but what follows from it, with the displacement, which is recovered and checked now."""
        self.u
        return {name: value for name, value in vars(self).items() if name != "_pressure"} | {"_reduced": None}

    def Description(self) -> Lines:
        """What was solved, and what was found; what has not been recovered yet is not asked for."""
        return of_solution(self)

    @property
    def u(self) -> GridFunction:
        """The displacement. Raises an Exception if the mesh was refined, curved or deformed since: NGSolve's functions are zero then."""
        self.body.CheckMesh()
        return self._found[0]

    @cached_property
    def _found(self) -> tuple[GridFunction, SupportResidual]:
        found = self._recover()
        del self._recover  # and what it holds, such as a factorisation
        return found

    @property
    def body(self) -> CrackedMesh:
        """The CrackedMesh."""
        return self.problem.body

    @property
    def load(self) -> LoadTerms:
        """The LoadTerms that this was solved for."""
        return self.case.load

    def CheckLoad(self) -> None:
        """Raises ValueError if a coefficient of the load, such as a Parameter, has another value now than in the solve."""
        check_unchanged(self.load, self.case.F, self.problem.V, "the solve")

    @property
    def stress(self) -> CoefficientFunction:
        """σ(u) + σ⁰, a square matrix (CoefficientFunction): with initial stress, temperature, and the stresses that terms in Grad(v) give."""
        return self.StressAt(None)

    def StressAt(self, side: str | None) -> CoefficientFunction:
        """The same on a side of the crack, "plus", "minus" or "larger"; None: by the position of the point.

        Parameters
        ----------
        side : str or None
            "plus", "minus", "larger"; None: by the position of the point.

        Returns
        -------
        CoefficientFunction
            A 2 × 2 matrix, in space 3 × 3.
        """
        elastic, given = self.ElasticStress(side), self.load.stress
        return elastic if given is None else elastic + given

    def ElasticStress(self, side: str | None) -> CoefficientFunction:
        """The same without what is given, C:ε(u).

        Parameters
        ----------
        side : str or None
            As for StressAt.

        Returns
        -------
        CoefficientFunction
            A 2 × 2 matrix, in space 3 × 3.
        """
        elastic = stress(self.problem.material, self.u, side)
        return elastic if self._pressure is None else elastic + self._pressure.At(side) * Id(self.body.mesh.dim)

    @cached_property
    def _pressure(self) -> PressureField | None:
        """π of `mixed_system`, a PressureField, or None."""
        if not self.problem.is_mixed:
            return None
        return LocalPressures(self.problem, self.gamma).Fit(self.multiplier - self._compared(NORMAL, "larger"))

    def Energy(self) -> float:
        """½ a(u, u), the elastic energy for each unit of thickness: stress × length². Springs of problem.a and given stresses have no part in it."""
        power = stress_power(self.problem.material, self.u, self.u, self._pressure)
        own = self.problem.V.share.Own(power * self.body.dx(bonus_intorder=max(0, 2 * self.problem.V.order - 5)))
        return 0.5 * self.problem.V.share.Sum(Integrate(own, self.body.mesh))

    def Reactions(self) -> SupportForces:
        """A table of what the supports exert on the body: a SupportForces, one row for each boundary that holds it and for each pin, and one for springs.

        `total` of the table and the loads are in balance to round-off.
        """
        return self._found[1].Forces(self.stress)

    def Reaction(self, place: str | Sequence[float]) -> np.ndarray:
        """(F_x, F_y), in space (F_x, F_y, F_z), an array: the force that the supports exert on the body.

        Parameters
        ----------
        place
            A boundary region, without the pins on it, or the point of a pin. The force on a corner that two regions hold is divided between them as σn
            on either side says.

        Raises
        ------
        ValueError
            For a region that the mesh does not have and a vertex that is not pinned.
        """
        rows = self.Reactions()
        if isinstance(place, str):
            check_regions(self.body.mesh, place, "Reaction: region")
            boundaries = self.body.mesh.GetBoundaries()
            return rows.OfBoundaries({boundaries[i] for i in np.flatnonzero(list(self.body.mesh.Boundaries(place).Mask()))})
        return rows.OfPin(place)

    def DissipatedEnergy(self) -> float:
        """What the faces dissipate in this load step, stress × length²: friction ∫λ_t Δg_t ≥ 0, with a threshold that changes by the trapezoidal rule, and what cohesive laws lose.

        Without a step before, the threshold is that of the end: a first step whose pressure grows from zero has up to twice its work, and DissipationError says so. LoadSteps that
        begin with Solve(0) take the trapezoidal rule there, too.
        """
        return self.state.work.dissipated

    def DissipationError(self) -> float:
        """How far DissipatedEnergy() may be off because the threshold changes within the step: the difference of the trapezoidal from the end-point rule."""
        return self.state.work.error

    FrictionWork, FrictionWorkError = DissipatedEnergy, DissipationError  # the same, for friction

    def FaceEnergy(self) -> float:
        """What the faces store and would give back, stress × length²: of joints, and of cohesive laws that unload. Joints of problem.a have no part in it."""
        return self.state.work.stored

    def Multipliers(self) -> np.ndarray:
        """L = (L_n, L_t) as one array, in space (L_n, L_1, L_2), at the nodes where the signs are taken; the tangential ones are 0 where there is no friction."""
        L = self.state.L
        return L if self.tangential_multiplier is not None else np.concatenate([L, np.zeros((self.body.mesh.dim - 1) * len(L))])

    def Profile(self, crack: int | str = 0, n: int = 200) -> CrackProfile:
        """A CrackProfile at n ≥ 2 points, equally spaced in arc length from end to end, in the user's units.

        sigma_t is λ_t with friction; without, the tangential traction of the larger part of each element, which exact frictionless contact makes zero.

        Parameters
        ----------
        n : int
            Of points, 2 or more.

        Raises
        ------
        ValueError
            For a crack that is not there and for n < 2.
        """
        check_whole(n, "Profile: n", 2)
        return profile(self, crack_number(crack, self.body), n)

    def FaceTractions(self) -> FaceTractions:
        """What acts on the faces beside contact and friction: the FaceTractions that are given, and those of elastic joints."""
        given, joint = self.load.tractions, self.a.joint
        return given if joint is None else given + joint.Tractions(self.u)

    def Traction(self, component: Component, side: str | None) -> CoefficientFunction:
        """R_h(u) + r_0 of a side ("plus", "minus", "larger"): what the multiplier of a component (`operators.NORMAL`, `TANGENTIAL`) approximates.

        Parameters
        ----------
        component : Component
            `operators.NORMAL` or `operators.TANGENTIAL`.
        side : str
            "plus", "minus" or "larger".
        """
        traction = self._compared(component, side)
        return traction if self._pressure is None else traction + component.traction(self._pressure.At(side) * Id(self.body.mesh.dim), self.body)

    def _compared(self, component: Component, side: str | None) -> CoefficientFunction:
        return self.problem.ComparedTraction(self.a).Of(self.u, component, side) + self.load.Shift(component, side, self.body)

    def Transitions(self, crack: int | str = 0) -> np.ndarray:
        """Arc lengths (an array) at which the active set changes along a crack: between two neighbouring nodes the middle."""
        return self._changes(self.report.active[-1], crack)

    def SlipTransitions(self, crack: int | str = 0) -> np.ndarray:
        """Arc lengths at which nodes that stick or slip neighbour others of another state; nodes without a threshold do not count."""
        tangential = self.report.tangential[-1] if self.report.tangential else np.zeros(len(self.state.nodes))
        return self._changes(tangential, crack, lambda a, b: (a != FREE) & (b != FREE))

    def _changes(self, states: np.ndarray, crack: int | str, where: Callable[..., Any] = lambda a, b: True) -> np.ndarray:
        return changes(self.state.nodes, crack_number(crack, self.body), states, where)

    def VonMises(self) -> CoefficientFunction:
        """The von Mises stress, a CoefficientFunction: σ_zz = 0 in plane stress, ν (σ_xx + σ_yy) - E α ΔT in plane strain."""
        return self.problem.material.VonMises(self.stress, self.problem.temperature)

    def PotentialEnergy(self) -> float:
        """Π = ½ a(u, u) + FaceEnergy() - L(u), springs and given stresses included. Without dissipation on the faces G = -dΠ/da, a the length of the crack."""
        U = self.u.vec.FV().NumPy()
        work = float((0.5 * self.a.Forces(self.u) - self.case.F) @ U)
        return self.Energy() + self.FaceEnergy() + self.problem.V.share.Sum(work)

    def Draw(self, **options: Any) -> Any:
        """Shows the deformed body with the crack open in a notebook.

        Parameters
        ----------
        **options
            field, a CoefficientFunction (default: the von Mises stress), scale of the displacement (default: the largest is 5 % of the body), and those of
            ngsolve.webgui.Draw, see `plotting.draw`.
        """
        from ..plotting.plots import draw

        return draw(self, **options)

    def SaveVTK(self, path: str | Path) -> str:
        """Writes displacement and stresses with the crack open, as a .vtu file for ParaView; returns its name. The file appears when it is complete.

        Parameters
        ----------
        path
            The ending is added if it is missing.

        Raises
        ------
        FileNotFoundError
            If there is no such folder.
        OSError
            If the disk is full.
        """
        from ..plotting.plots import save_vtk

        return save_vtk(self, path)

    def Save(self, path: str | Path) -> Path:
        """Writes the solution with all that it was made of to one file, which Load reads in another process; returns its path.

        Several processes that share the body write one file, that of a single process: any number of processes reads it. Body, spaces, coefficients, loads, supports, material, law and history of the faces, and the report are in it: K, energies, reactions, pictures,
        `previous=` of the next load step and growth go on from what is read. The file appears when it is complete.

        Parameters
        ----------
        path
            Of the file, with any ending.

        Raises
        ------
        NotSaved
            For what cannot be saved, by name, before anything is written: a function of Python as a law or a coefficient, or a coefficient that NGSolve would
            read back as another one.
        NotConverged
            As `u`, where it is used first.
        FileNotFoundError, OSError
            If there is no such folder, or the disk is full.
        """
        from .carried import save_whole

        return save_whole(self, path)

    @staticmethod
    def Load(path: str | Path) -> ContactSolution:
        """The solution that Save wrote, with its problem, spaces and body; its numbers are those that were saved.

        Under mpirun the first process reads the file, and all share what is in it, each a part of the mesh.

        Parameters
        ----------
        path
            Of the file. It is read by pickle, which runs what a file asks for: read files that you trust.

        Raises
        ------
        UnreadableFile
            For a file of another kind or format, one that is not complete, one of another version of NGSolve, and one whose spaces cannot be made again.
        NotImplementedError
            With several processes for TraceSpace(basis="trace") of order 2 or more, and for bodies in space.
        FileNotFoundError
            If there is none.
        """
        from .carried import load_shared

        return load_shared(path)
