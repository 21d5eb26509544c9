"""The data of a contact problem: (12) of [AHLMR12]."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from typing import TYPE_CHECKING, Any

from ngsolve import CoefficientFunction, InnerProduct, Parameter

from .. import _ngsxfem_contact as core
from ..arguments import INFINITY, check_function, check_number, check_regions, check_type, crack_number
from ..description import Described
from ..loads.face_traction import ComparedTraction
from ..loads.load import LoadForm, StiffnessForm, check_symmetric_stress
from ..loads.supports import Supports
from ..material import Isotropic
from ..operators import NORMAL, Gradient, Minus, OutwardNormal, Plus
from ..protocols import FaceLaw, LawAtNodes, Stabilisation, check_role
from ..spaces.crack_fespace import decide
from ..spaces.incompressible import is_projected, projection_degree, warn_of_locking
from ..spaces.linear_sheet_trace_space import LinearSheetTraceSpace
from ..spaces.sheet_trace_space import SheetTraceSpace
from .cones import CONES
from .contact_system import ContactSystem
from .descriptions import of_problem
from .friction import Frictionless
from .mixed_system import MixedSystem
from .nodal_law import NodalLaw
from .options import Start, StepOptions
from .problem_data import check_modes, given_stresses, law_of, material_of
from .solids import check_supported, law_at_nodes, law_in
from .solution import ContactSolution
from .stabilisation import BarbosaHughes, Unstabilised, softened, trait
from .strategy import assembled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import BitArray, GridFunction, LinearForm

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace, TraceSpace
    from ..description import Lines
    from ..material import Coefficient
    from .assembled import AssembledProblem
    from .faces import FaceHistory


class ContactProblem(Described):
    """An elastic body with cracks in unilateral contact, with or without friction: find u and λ ≤ 0 of (12).

    Parameters
    ----------
    V : CrackFESpace
    W
        TraceSpace on the same CrackedMesh.
    material
        Elasticity, or Elasticity.ByRegion(...); default that of V.
    stabilisation
        BarbosaHughes(...) (default: chooses γ itself), None, or Nitsche(theta): no multiplier, W presents the pressure.
    cone
        "nonpositive" (M₀⁻, M₁⁻: λ ≤ 0 at the nodes, default) or "weak" (M₁*⁻).
    gap
        Initial gap g_0 ≥ 0 of the faces, a number or CoefficientFunction, in the unit of length. Laws that pull do so on g_n + g_0.
    law
        Of the faces: None (default), contact without friction; Tresca(s), Coulomb(mu_f), MohrCoulomb, Joint, BartonBandis, LinearCohesive, ExponentialCohesive,
        Dugdale; or {number or name of a crack: its law}, None on the others.
    initial_stress
        σ⁰, a symmetric 2 × 2 (in space 3 × 3) CoefficientFunction, a stress: the stress of the body is σ(u) + σ⁰.
    temperature
        ΔT, a number or CoefficientFunction, the change since the body was free of stress; the material needs alpha=.
    friction
        Tresca(s) or Coulomb(mu_f): another name of law.

    Raises
    ------
    TypeError
        For other objects, and for both law= and friction=.
    ValueError
        For spaces on different bodies, a negative gap, an unknown cone, and modes of another material.

    Notes
    -----
    Add the loads to the linear form `f`:  problem.f += force*v*body.dx + traction*v*body.ds("left"), v a test function of V; load the faces of the cracks
    by FacePressure and FaceTraction. Springs and elastic joints are added to `a`: problem.a += k*u*v*body.ds("bottom") + c*Jump(u)*Jump(v)*body.dcrack.
    Hold the body by V's dirichlet regions (zero, or SetDirichlet) or by Pin. Then Solve().

    Examples
    --------
    >>> from ngsolve import *
    >>> from netgen.geom2d import unit_square
    >>> from ngsxfem_contact import *
    >>> mesh = Mesh(unit_square.GenerateMesh(maxh=0.3))
    >>> body = CrackedMesh(mesh, Crack([(0, 0.5), (1, 0.5)]))  # from side to side
    >>> V, W = CrackFESpace(body, order=1, dirichlet="bottom|top"), TraceSpace(body, order=1)
    >>> problem = ContactProblem(V, W, Elasticity.PlaneStrain(E=100, nu=0))
    >>> problem.SetDirichlet((0, -0.01), "top")  # presses by 1 %
    >>> print(f"{problem.Solve().ContactForce():.6f}")
    -1.000000
    """

    def __init__(
        self,
        V: CrackFESpace,
        W: TraceSpace,
        material: Isotropic | None = None,
        stabilisation: Stabilisation | None = BarbosaHughes(),
        cone: str = "nonpositive",
        gap: Coefficient = 0,
        law: FaceLaw | Mapping[int | str, LawAtNodes | None] | None = None,
        initial_stress: CoefficientFunction | None = None,
        temperature: Coefficient | None = None,
        friction: FaceLaw | None = None,
    ) -> None:
        check_type(V, core.CrackFESpace | core.SolidFESpace, "ContactProblem: V", "a CrackFESpace")
        check_type(W, core.TraceSpace | SheetTraceSpace | LinearSheetTraceSpace, "ContactProblem: W", "a TraceSpace")
        if V.body is not W.body:
            raise ValueError("ContactProblem: V and W belong to different CrackedMesh objects; build both on one body")
        if cone not in list(CONES):
            raise ValueError(f"ContactProblem: cone={cone!r} is not one of {sorted(CONES)}")
        if isinstance(gap, CoefficientFunction):
            check_function(gap, "ContactProblem: gap", 1)
        else:
            check_number(gap, "ContactProblem: gap", lambda gap: 0 <= gap < INFINITY, "be a finite number >= 0 (the faces do not overlap at first)")
        material = material_of(V, material)
        if stabilisation is not None:
            check_role(stabilisation, Stabilisation, "ContactProblem: stabilisation", "an object such as BarbosaHughes()")
        decide(V, material)
        check_modes(V, material)
        check_supported(V, material, stabilisation)
        warn_of_locking(V, material, stabilisation)
        self.V, self.W, self.material = V, W, material
        self.stabilisation: Stabilisation = stabilisation if stabilisation is not None and V.body.cracks else Unstabilised()
        self.cone = CONES[cone]
        if law is not None and friction is not None:
            raise TypeError("ContactProblem: friction= and law= both give the law of the faces; keep one of them")
        self.law = law_in(V, law_of(friction if law is None else law, V.body)) if V.body.cracks else Frictionless()
        self.gap = gap if isinstance(gap, CoefficientFunction) else Parameter(gap)
        self._f, self._a, self.initial = LoadForm(V), StiffnessForm(V), LoadForm(V)
        self.temperature = 0 if temperature is None else check_function(temperature, "ContactProblem: temperature", 1)
        for stress in given_stresses(material, initial_stress, temperature):
            self.initial += -InnerProduct(stress, Gradient(V.TestFunction())) * V.body.dx
        check_symmetric_stress(self.initial)
        self.supports = Supports(V)

    def Description(self) -> Lines:
        """Spaces, material, law of the faces, stabilisation, loads and supports."""
        return of_problem(self)

    def AtNodes(self) -> ContactProblem:
        """The same problem with a law that holds node by node, as the rigid motions of parts need that only faces with friction hold."""
        law = self.law
        if isinstance(law, NodalLaw) or law.components == (NORMAL,):
            return self
        problem = copy(self)
        problem.law = law_at_nodes(self.V, law)
        return problem

    @property
    def body(self) -> CrackedMesh:
        """The CrackedMesh."""
        return self.V.body

    @property
    def f(self) -> LoadForm:
        """The loads, a LoadForm: add terms by +=."""
        return self._f

    @f.setter
    def f(self, form: LinearForm) -> None:
        """Itself after +=, or an empty LinearForm(problem.V), to begin anew."""
        self._f = self._f.ReplacedBy(form)

    @property
    def a(self) -> StiffnessForm:
        """Springs and elastic joints, a StiffnessForm: add terms by +=."""
        return self._a

    @a.setter
    def a(self, form: StiffnessForm) -> None:
        """Itself after +=."""
        if form is not self._a:
            raise TypeError(f"problem.a cannot be replaced by {form!r}; add terms to it, problem.a += ...")

    def Pressure(self, p: Coefficient, region: str, bonus_intorder: int = 0) -> None:
        """Adds a pressure on a part of ∂Ω: -∫p n·v, n the OutwardNormal.

        Parameters
        ----------
        p
            Number or CoefficientFunction, a stress; positive presses.
        region : str
            Names of boundaries, a regular expression.
        bonus_intorder
            For functions that are no polynomials along the boundary, and for curved elements.
        """
        p = check_function(p, "Pressure: p", 1)
        check_regions(self.body.mesh, region, "Pressure: region")
        self.f += -1 * p * OutwardNormal(self.body.mesh) * self.V.TestFunction() * self.body.ds(region, bonus_intorder=bonus_intorder)

    def FacePressure(self, p: Coefficient, crack: int | str | None = None, bonus_intorder: int = 0) -> None:
        """Adds a pressure on both faces, of a fluid in the crack: it opens the crack where p > 0, and λ ≤ 0 carries what it leaves.

        Parameters
        ----------
        p
            Number or CoefficientFunction, a stress.
        crack
            Number or name of the crack, default all of them.
        bonus_intorder
            For functions that are no polynomials along the crack.
        """
        p = check_function(p, "FacePressure: p", 1)
        self.FaceTraction(p * self.body.normal, -1 * p * self.body.normal, crack, bonus_intorder)

    def FaceTraction(self, plus: Any = 0, minus: Any = 0, crack: int | str | None = None, bonus_intorder: int = 0) -> None:
        """Adds tractions on the plus and on the minus face, forces on the body for each unit of length, in space of area: ∫ t⁺·v⁺ + t⁻·v⁻ over the cracks.

        Parameters
        ----------
        plus, minus
            Vectors, CoefficientFunctions or tuples, stresses; 0: none.
        crack, bonus_intorder
            As for FacePressure.
        """
        zero, components = (0,) * self.V.mesh.dim, self.V.mesh.dim
        given = (("plus", zero if is_zero(plus) else plus), ("minus", zero if is_zero(minus) else minus))
        plus, minus = (check_function(t, f"FaceTraction: {name}", components) for name, t in given)
        number = None if crack is None else crack_number(crack, self.body)
        v, measure = self.V.TestFunction(), self.body.dcrack(crack=number, bonus_intorder=bonus_intorder)
        traction = (plus * Plus(v) + minus * Minus(v)) * measure
        if any(term.test for term in core.TermsOf(traction)):  # none where NGSolve sees that both are zero
            self.f += traction

    @property
    def given(self) -> GridFunction:
        """The displacement where it is given, a GridFunction."""
        return self.supports.given

    @property
    def free(self) -> BitArray:
        """BitArray of the unknowns that are not given."""
        return self.supports.free

    @property
    def pinned(self) -> list[int]:
        """The unknowns that pins fix."""
        return self.supports.pinned

    def Pin(self, point: Sequence[float], components: str, value: Any = 0) -> None:
        """Fixes components of u at a vertex of the mesh.

        Parameters
        ----------
        point : (x, y) or (x, y, z)
            A vertex of the mesh.
        components : str
            "x", "y" or "xy", in space also "z", "yz", ...
        value : float or tuple
            The displacement, a length: one number, or one for each component; default 0.

        Raises
        ------
        ValueError
            If there is no vertex at the point (the message names the nearest), if u jumps there, inside the disk of a tip, whose functions would move the
            vertex, and for a value that contradicts another one there.
        """
        self.supports.Pin(point, components, value)

    def SetDirichlet(self, value: Any, region: str) -> None:
        """Sets u on a boundary region of V's dirichlet parts: the weighted L² projection of value's trace, both sides at a mouth.

        Beside a vertex that a mouth nearly meets, functions that hardly reach the boundary become free (`mouths.short_traces`).

        Parameters
        ----------
        value
            CoefficientFunction, a vector, or tuple; in a tuple None leaves a component free: (0, None) is a roller. What was given on the region
            before is replaced. A Parameter or a GridFunction in it counts with the value that it has in Solve or LoadCase.
        region : str
            Names of boundaries, a regular expression.

        Raises
        ------
        ValueError
            For a region on which a given component is not held by the space, and for another value than that of a Pin. Regions that contradict each other at
            a common corner are refused by Solve and LoadCase.
        """
        self.supports.SetDirichlet(value, region)

    def ComparedTraction(self, a: StiffnessForm | None = None) -> ComparedTraction:
        """R_h of this problem: a ComparedTraction.

        Parameters
        ----------
        a
            Springs and joints, a StiffnessForm; default those of the problem.
        """
        return ComparedTraction(self.body, self.material, self.stabilisation.sides, (self.a if a is None else a).joint)

    def Gamma(self) -> CoefficientFunction | None:
        """γ as a CoefficientFunction on the elements that the cracks meet, or None without stabilisation."""
        gamma = self.stabilisation.Gamma(self.V, self.material, self.law.components)
        joint = self.a.joint
        return softened(softened(gamma, joint and joint.Stiffness()), getattr(self.law, "softening", None))

    @property
    def projection(self) -> int | None:
        """The degree of the polynomials onto which div u is projected where the material is nearly incompressible, or None."""
        return projection_degree(self.V) if is_projected(self.V, self.material) else None

    @property
    def is_mixed(self) -> bool:
        """Whether the parts beside the cracks have pressures of their own, see `mixed_system`."""
        return trait(self.stabilisation, "frees_pressure") and is_projected(self.V, self.material)

    def Assemble(self) -> ContactSystem:
        """The matrices of (38): a ContactSystem."""
        own = trait(self.stabilisation, "System")
        return own(self) if own else MixedSystem(self) if self.is_mixed else ContactSystem(self)

    def Solve(
        self,
        *,
        inverse: str | None = None,
        cone: str | None = None,
        start: Start = None,
        max_iterations: int = StepOptions.max_iterations,
        previous: ContactSolution | FaceHistory | None = None,
    ) -> ContactSolution:
        """Solves the problem.

        Parameters
        ----------
        inverse
            NGSolve's name of the direct solver for K - K_γ, see `Elimination`; default "sparsecholesky", and "pardiso" for large problems where MKL is
            installed. "cg": conjugate gradients (pyamg), with multigrid for bodies in space, where they are the default for large ones; in the plane with two
            levels, for many processes. The report says so.
        cone
            "nonpositive" or "weak"; default the problem's.
        start
            First active set: boolean, one for each nodal sign, or a ContactSolution on any mesh whose cracks have the same arc lengths; default: that of
            `previous`, or from coarser sets.
        max_iterations
            Of the active set.
        previous
            The ContactSolution of the last load step, with the same cracks, or shorter ones: slip is measured from there, and damage stays; what is new of a
            crack has not gone through anything. Or a FaceHistory at the nodes of the multiplier.


        Raises
        ------
        SingularSystem
            Rigid motions left free, or multipliers that no displacement feels.
        NotCoercive
            gamma0 too large.
        NotConverged
            If an iteration stops before its goal, or the answer does not satisfy its own equations.
        ValueError
            For data that are not finite, for a previous solution with other cracks, and for what "cg" is not there for.
        ImportError
            For "cg", and for bodies in space that are too large for factors, where pyamg is not installed.

        Notes
        -----
        As everywhere in NGSolve, more than one thread is used inside `with TaskManager():`.
        """
        options = StepOptions(cone, start, max_iterations, previous)
        return self.Reduced(inverse).Solve(options)

    def Reduced(self, inverse: str | None = None) -> AssembledProblem:
        """The problem with all done that does not depend on loads and starts: a ReducedProblem, its displacements eliminated, or a CondensedProblem.

        Parameters
        ----------
        inverse
            As for Solve.
        """
        return assembled(self, inverse)


def is_zero(value: Any) -> bool:
    """Whether a traction is the number 0."""
    return isinstance(value, (int, float)) and value == 0
