"""The data of a contact problem: (12) of [AHLMR12] and its matrices (38)."""

import numpy as np
from ngsolve import BilinearForm, CoefficientFunction, GridFunction, InnerProduct, LinearForm, Parameter
from scipy.sparse import block_diag, csr_matrix, vstack

from . import _ngsxfem_contact as core
from .arguments import INFINITY, check_function, check_number, check_type
from .cones import CONES
from .elasticity import Isotropic
from .friction import Friction, Frictionless
from .load import LoadForm
from .operators import Strain
from .solver import solve
from .spaces import to_scipy
from .stabilisation import BarbosaHughes, Unstabilised, squared_traces, summed_traces
from .supports import Supports


def check_modes(V, material):
    """Raises ValueError if V has tip modes of another material: their lips would carry tractions."""
    for tip, spec in zip(V.body.tips, V.tip_specs):
        if spec is not None and spec.basis == core.TipBasis.modes:
            here = material.At(V.mesh, tip.point)
            if not np.allclose((spec.kappa, spec.mu), (here.kappa, here.mu), rtol=1e-12):
                raise ValueError(f"ContactProblem: the tip modes of V belong to another material than {here}; pass the same to TipEnrichment(material=...)")


class ContactProblem:
    """An elastic body with cracks in unilateral contact, with or without friction: find u and λ ≤ 0 of (12).

    V: CrackFESpace.    W: TraceSpace on the same CrackedMesh.    material: Elasticity, or Elasticity.ByRegion(...).
    stabilisation: BarbosaHughes(...) (default: chooses γ itself), None, or Nitsche(theta): no multiplier, W presents the pressure.
    cone: "nonpositive" (M₀⁻, M₁⁻: λ ≤ 0 at the nodes, default) or "weak" (M₁*⁻).
    gap: initial gap g_0 ≥ 0 of the faces, a number or CoefficientFunction, in the unit of length.
    friction: None (default), Tresca(s) or Coulomb(mu_f).

    Add the loads to the linear form `f`:  problem.f += force*v*body.dx + traction*v*body.ds("left"), v a test
    function of V. Hold the body by V's dirichlet regions (zero, or SetDirichlet) or by Pin. Then Solve().
    Raises TypeError for other objects, ValueError for spaces on different bodies, a negative gap, an unknown cone, and modes of another material.

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

    def __init__(self, V, W, material, stabilisation=BarbosaHughes(), cone="nonpositive", gap=0, friction=None):
        check_type(V, core.CrackFESpace, "ContactProblem: V", "a CrackFESpace")
        check_type(W, core.TraceSpace, "ContactProblem: W", "a TraceSpace")
        if V.body is not W.body:
            raise ValueError("ContactProblem: V and W belong to different CrackedMesh objects; build both on one body")
        if cone not in list(CONES):
            raise ValueError(f"ContactProblem: cone={cone!r} is not one of {sorted(CONES)}")
        if isinstance(gap, CoefficientFunction):
            check_function(gap, "ContactProblem: gap", 1)
        else:
            check_number(gap, "ContactProblem: gap", lambda gap: 0 <= gap < INFINITY, "be a finite number >= 0 (the faces do not overlap at first)")
        check_type(material, Isotropic, "ContactProblem: material", "an Elasticity")
        if stabilisation is not None and (not hasattr(stabilisation, "Gamma") or isinstance(stabilisation, type)):
            raise TypeError(f"ContactProblem: stabilisation={stabilisation!r} is neither an object such as BarbosaHughes() nor None")
        if friction is not None and not isinstance(friction, Friction):
            raise TypeError(f"ContactProblem: friction={friction!r} is neither Tresca(s) nor Coulomb(mu_f) nor None")
        check_modes(V, material)
        self.V, self.W, self.material = V, W, material
        self.stabilisation = stabilisation if stabilisation is not None else Unstabilised()
        self.cone = CONES[cone]
        self.friction = friction if friction is not None else Frictionless()
        self.gap = gap if isinstance(gap, CoefficientFunction) else Parameter(gap)
        self.f = LoadForm(V)
        self.supports = Supports(V)

    @property
    def body(self):
        """The CrackedMesh."""
        return self.V.body

    @property
    def given(self):
        """The displacement where it is given, a GridFunction."""
        return self.supports.given

    @property
    def free(self):
        """BitArray of the unknowns that are not given."""
        return self.supports.free

    @property
    def pinned(self):
        """The unknowns that pins fix."""
        return self.supports.pinned

    def Pin(self, point, components, value=0):
        """Fixes components ("x", "y" or "xy") of u at a mesh vertex to a number, or to one number for each component.

        Raises ValueError if there is no vertex at the point (the message names the nearest), if u jumps there, inside the disk of a tip, whose
        functions would move the vertex, and for a value that contradicts another one there.
        """
        self.supports.Pin(point, components, value)

    def SetDirichlet(self, value, region):
        """Sets u on a boundary region of V's dirichlet parts: the weighted L² projection of value's trace, both sides at a mouth.

        Beside a vertex that a mouth nearly meets, functions that hardly reach the boundary become free (`mouths.short_traces`).
        value: CoefficientFunction with two components or tuple; in a tuple None leaves a component free: (0, None) is a roller. What was given on
            the region before is replaced.
        Raises ValueError for a region on which a given component is not held by the space, and for another value than that of a Pin. Regions that
        contradict each other at a common corner are refused by Solve and LoadCase.
        """
        self.supports.SetDirichlet(value, region)

    def Gamma(self):
        """γ as a CoefficientFunction on the elements that the cracks meet, or None without stabilisation."""
        return self.stabilisation.Gamma(self.V, self.material, self.friction.components)

    def Loads(self):
        """F of (38), an array."""
        return self.f.Assemble().vec.FV().NumPy().copy()

    def Assemble(self):
        """The matrices of (38): a ContactSystem."""
        return self.stabilisation.System(self) if hasattr(self.stabilisation, "System") else ContactSystem(self)

    def Solve(self, **options):
        """Solves and returns a ContactSolution; options: inverse, previous, cone, r, start, max_iterations, see `solver.solve`.

        previous: with friction the ContactSolution of the last load step, on the same spaces: slip is measured from there.
        Raises SingularSystem (rigid motions left free, or multipliers that no displacement feels), NotCoercive
        (gamma0 too large), NotConverged.
        """
        return solve(self, **options)


class ContactSystem:
    """K - K_γ as an NGSolve matrix; E = B - C_γ and D_γ as scipy matrices; F, G as arrays: the blocks of (38).

    gamma: γ or None.    nodes: where the signs are taken, W or what stands for it.    weights: ∫ψ_i, the length of Γ_C that
    belongs to each multiplier.

    Stationarity is (K - K_γ) U - (B - C_γ)ᵀ L = F, and the second row's residual (B - C_γ) U + D_γ L - G.
    With friction the multiplier is L = (L_n, L_t), the rows of B are -∫ψ_i g_n and -∫ψ_i g_t, those of C_γ ∫γψ_i R_n and
    ∫γψ_i R_t, R_t = σ_t of the larger part, and K_γ = ∫γ (R_n R_n + R_t R_t).
    """

    def __init__(self, problem):
        self.gamma = problem.Gamma()
        self._assemble(problem)
        self._x, self._y = self.stiffness.CreateColVector(), self.stiffness.CreateColVector()
        self.F = problem.Loads()
        self.G = np.zeros(self.E.shape[0])
        self.G[: self.nodes.ndof] = self.InitialGap(problem)

    def _assemble(self, problem):
        """nodes, stiffness, E, D, weights."""
        V, W, body, material = problem.V, problem.W, problem.body, problem.material
        components = problem.friction.components
        u, v = V.TnT()
        lam, mu = W.TnT()
        stiffness = stiffness_form(problem)
        mass = csr_matrix((W.ndof, W.ndof))
        if self.gamma is not None:
            stiffness += -self.gamma * squared_traces(problem.stabilisation, u, v, material, body, components) * W.dcrack
            mass = to_scipy(BilinearForm(self.gamma * lam * mu * W.dcrack).Assemble().mat)
        self.nodes, self.stiffness = W, stiffness.Assemble().mat
        self.E = vstack([self._coupling(problem, component) for component in components], format="csr")
        self.D = block_diag([mass] * len(components), format="csr")
        self.weights = np.tile(LinearForm(mu * W.dcrack).Assemble().vec.FV().NumPy(), len(components))

    def InitialGap(self, problem):
        """∫ψ_i g_0."""
        mu = problem.W.TestFunction()
        return LinearForm(problem.gap * mu * problem.W.dcrack).Assemble().vec.FV().NumPy()

    def Function(self, problem, values, name):
        """The GridFunction of W for one component of L."""
        function = GridFunction(problem.W, name)
        function.vec.FV().NumPy()[:] = values
        return function

    @property
    def C(self):
        """The rows whose products with (K - K_γ)⁻¹ are needed; the first are E."""
        return self.E

    def Distribute(self, L):
        """The coefficients of C's rows in the forces on the displacements, Cᵀ Distribute(L)."""
        return L

    def Forces(self, L):
        """What L exerts on the displacements, (B - C_γ)ᵀ L."""
        return self.C.T @ self.Distribute(L)

    def _coupling(self, problem, component):
        """The rows of B - C_γ of one component."""
        V, W, body = problem.V, problem.W, problem.body
        u, mu = V.TrialFunction(), W.TestFunction()
        coupling = BilinearForm(trialspace=V, testspace=W)
        coupling += -mu * component.jump(u, body) * W.dcrack
        if self.gamma is not None:
            coupling += -self.gamma * mu * summed_traces(problem.stabilisation, u, problem.material, body, component) * W.dcrack
        return to_scipy(coupling.Assemble().mat)

    def Stiffness(self, U):
        """(K - K_γ) U for an array U."""
        self._x.FV().NumPy()[:] = U
        self._y.data = self.stiffness * self._x
        return self._y.FV().NumPy().copy()

    def Moments(self, U, L):
        """(B - C_γ) U + D_γ L of the second row of (38)."""
        return self.E @ U + self.D @ L

    def Residual(self, U, L):
        """The second row of (38): (B - C_γ) U + D_γ L - G."""
        return self.Moments(U, L) - self.G


def stiffness_form(problem):
    """a(u, v), not assembled."""
    u, v = problem.V.TnT()
    form = core.CrackBilinearForm(problem.V, symmetric=True)
    form += InnerProduct(problem.material.Stress(Strain(u)), Strain(v)) * problem.body.dx
    return form
