"""What can be wrong with a problem before it is solved: each is named, none is a warning."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CF, BilinearForm, Grad, InnerProduct, specialcf

from ..algebra.compliance import Compliance
from ..algebra.elimination import Elimination
from ..algebra.matrices import csr_view, mask, to_scipy
from ..algebra.symmetric_system import unit_scale
from ..errors import NotCoercive, SingularSystem, warn
from ..operators import NormalGap
from ..spaces.exchange import exchange_of
from ..spaces.unknowns import Unknowns
from .contact_system import stiffness_form
from .free_motions import PinnedMotions
from .mixed_system import LocalPressures
from .nodal_law import NodalLaw
from .stabilisation import trait

if TYPE_CHECKING:
    from typing import Any

    from ngsolve import BaseMatrix, CoefficientFunction
    from scipy.sparse import csr_matrix

    from .._ngsxfem_contact import CrackedMesh, CrackFESpace, TraceSpace
    from ..processes import Exchange
    from .contact_system import ContactSystem
    from .problem import ContactProblem

logger = logging.getLogger(__name__)


def check_gap(system: ContactSystem) -> None:
    """Raises ValueError for an initial gap that is not finite, or negative somewhere."""
    gap = system.G[: len(system.nodes)]
    if not np.isfinite(gap).all():
        raise ValueError("the initial gap is not finite (NaN or inf): check `gap` on the whole crack")
    if (gap < -1e-12 * np.abs(gap).max(initial=0)).any():
        raise ValueError("the initial gap is negative on a part of the crack: the faces would overlap at first; check `gap` on the whole crack")


def check_load(F: np.ndarray, given: np.ndarray) -> None:
    """Raises ValueError for a load or given displacements, arrays, that are not finite."""
    for values, what, where in ((F, "the load `f`", "its coefficient functions on the whole body"), (given, "a given displacement", "Pin and SetDirichlet")):
        if not np.isfinite(values).all():
            raise ValueError(f"{what} is not finite (NaN or inf): check {where}")


def check_energies(F: np.ndarray, given: np.ndarray, stiffness: BaseMatrix, exchange: Exchange) -> None:
    """Raises ValueError for a load, additive, or given displacements whose energies with an NGSolve matrix double precision cannot hold."""
    scale = unit_scale(exchange.Cumulated(csr_view(stiffness).diagonal()))
    check_size(exchange.Max(largest_of(exchange.Cumulated(F) * scale)), "the load `f`")
    check_size(exchange.Max(largest_of(given / scale)), "a given displacement")


def largest_of(values: np.ndarray) -> float:
    """The largest size, NaN if there is one."""
    return float(np.abs(values).max(initial=0))


def check_size(largest: float, what: str, limit: float = 1e145) -> None:
    """Raises ValueError if the square of a value, an energy, is too small or too large for double precision; zero is neither."""
    if largest and not 1 / limit < largest < limit:
        size = "small" if largest < 1 else "large"
        raise ValueError(f"{what} is too {size}: its energy is about ({largest:.1e})², beyond double precision; take other units of length or stress")


def check_multiplier(compliance: Compliance, weights: np.ndarray, modulus: float, stabilised: bool, tolerance: float = 1e-10) -> None:
    """Raises SingularSystem if there are multipliers that no displacement feels: the pair of spaces is not stable.

    Parameters
    ----------
    weights
        (m,), of the nodes: forces of size 1 move the faces by about 1/modulus, if any displacement feels them, and much farther on a thin strip.
    modulus
        The largest one beside the cracks, a stress.
    stabilised
        By some γ.
    """
    inverse, Q = compliance.symmetric_inverse, compliance.matrix
    if inverse is not None and tolerance * (weights * (np.abs(inverse) @ weights)).max(initial=0) < modulus:
        return  # no eigenvalue of the inverse exceeds its largest sum of a row
    values = np.linalg.eigvalsh(0.5 * modulus * (Q + Q.T) / weights / weights[:, None])
    deficient = int((values < tolerance).sum())
    if deficient:
        remedy = "a larger γ, which is nearly zero there (or a part of the crack both faces of which are held, set them free)"
        raise SingularSystem(
            f"{deficient} of {len(values)} multipliers act on no displacement of the space (smallest eigenvalue {values[0]:.1e} of the "
            f"Schur complement, for unit forces and moduli): this pair of orders needs "
            f"{remedy if stabilised else 'stabilisation=BarbosaHughes()'}, or a richer displacement space, or a multiplier of lower order"
        )


def check_coercive(problem: ContactProblem, elimination: Elimination) -> None:
    """Raises NotCoercive for a γ for which K - K_γ is not positive definite (against K)."""
    stabilisation = problem.stabilisation
    proved = elimination.positive and not trait(stabilisation, "needs_eigenvalue")
    if proved or (elimination.positive is not False and stabilisation.IsSafe(problem.V, problem.material, problem.law.components)):
        return
    smallest = Coercivity(problem)
    if smallest <= 1e-10:
        remedy = trait(stabilisation, "Remedy")(smallest)
        raise NotCoercive(f"γ is too large: the smallest eigenvalue of K - K_γ against K is {smallest:.3g}; {remedy}")


def warn_of_brittle_faces(problem: ContactProblem, nodes: Any) -> None:
    """Warns of elements larger than E′ / (slope by which the faces soften) there: nodes break one by one, each with a snap-back of its own; nodes: the plane's."""
    if not isinstance(problem.law, NodalLaw):
        return
    slopes = np.broadcast_to(problem.law.At(nodes).steepest, len(nodes))
    if not slopes.any():
        return
    sizes, modulus = sizes_at(problem.body, nodes), nodes.Values(CF(problem.material.E_prime))
    worst = int(np.argmax(sizes * slopes / modulus))
    length = modulus[worst] / slopes[worst]
    if sizes[worst] > length:
        warn(
            f"the faces soften within {length:.3g}, less than an element ({sizes[worst]:.3g}), at {nodes.Place(worst)}: nodes break one by one there, and the load "
            f"that they carry is wrong; refine to h <= {length / 3:.2g} along the crack, or take a larger G_c or a smaller strength"
        )


def sizes_at(body: CrackedMesh, nodes: Any) -> np.ndarray:
    """(n,): the h of the element at each node, of two the first."""
    sizes = np.empty(len(nodes))
    for crack in range(len(body.cracks)):
        here = nodes.cracks == crack
        ends, h = np.array(sorted((max(T.arclength), T.h) for T in body.Elements(crack))).T
        sizes[here] = h[np.minimum(np.searchsorted(ends, nodes.arclengths[here]), len(h) - 1)]
    return sizes


def Coercivity(problem: ContactProblem) -> float:
    """The smallest eigenvalue of K - K_γ against K, (13) of [AHLMR12]: 1 - θ; negative where γ is too large.

    Parameters
    ----------
    problem : ContactProblem
        Whose K and K_γ they are.

    Raises
    ------
    SingularSystem
        If rigid motions are left free that no face feels.
    """
    motions = PinnedMotions(problem)
    gamma = problem.Gamma()
    if gamma is None:
        return 1.0
    V, exchange = problem.V, exchange_of(problem.V)
    u, v = V.TnT()
    K = stiffness_form(problem).Assemble().mat
    squared = problem.ComparedTraction().Squared(u, v, problem.law.components)
    K_gamma = to_scipy(BilinearForm(gamma * squared * problem.body.dcrack).Assemble().mat)
    if problem.is_mixed:
        K_gamma -= LocalPressures(problem, gamma).Stiffness()
    free = motions.Without(problem.free, K)  # they change neither K nor K_γ
    logger.info("smallest eigenvalue of K - K_γ against K, %d unknowns", V.ndof)
    return 1 - largest_eigenvalue(K_gamma, K, Elimination(K, free, Unknowns(V).tips, exchange=exchange), mask(free), exchange)


def largest_eigenvalue(A: csr_matrix, M: BaseMatrix, M_inverse: Elimination, free: np.ndarray, exchange: Exchange) -> float:
    """Of A x = θ M x on the free unknowns, by Lanczos; A a scipy matrix, whole on all processes, M NGSolve's, its inverse an Elimination.

    Vectors of Lanczos' method are whole on all processes, so that each does the same with them.
    """
    x, y = M.CreateColVector(), M.CreateColVector()
    numbers = exchange.Numbers(len(free))
    size = 1 + int(exchange.Max(numbers.max(initial=0)))

    def whole(consistent: np.ndarray) -> np.ndarray:
        array = np.zeros(size)
        array[numbers] = exchange.Additive(np.where(free, consistent, 0))
        return exchange.FromFirst(exchange.Sum(array))

    def multiply(array: np.ndarray) -> np.ndarray:
        x.FV().NumPy()[:] = np.where(free, array, 0)
        y.data = M * x
        return exchange.Cumulated(y.FV().NumPy().copy())

    operator = lambda function: scipy.sparse.linalg.LinearOperator((size, size), matvec=lambda array: whole(function(array.ravel()[numbers])), dtype=float)
    restricted = operator(lambda v: A @ np.where(free, v, 0))
    inverse = operator(lambda v: M_inverse.Solve(exchange.Additive(np.where(free, v, 0))))
    start = inverse.matvec(restricted.matvec(np.random.default_rng(0).standard_normal(size)))
    return float(scipy.sparse.linalg.eigsh(restricted, k=1, M=operator(multiply), Minv=inverse, which="LA", v0=start, tol=1e-8)[0][0])


def InfSup(V: CrackFESpace, W: TraceSpace, weight: CoefficientFunction = specialcf.mesh_size) -> float:
    """β_h = inf_μ sup_v b(μ,v) / (‖v‖_{H¹} ‖w^{1/2} μ‖_{L²(Γ_C)}); zero: the pair is singular. Dense algebra of the size of W.

    Parameters
    ----------
    V : CrackFESpace
    W
        TraceSpace on the same body.
    weight
        w, a length, by default the element size. With this β_h falls like (shortest cut / h)^{1/2}: a multiplier on a tiny cut acts on little.

    Raises
    ------
    ValueError
        For a weight that is not positive and finite.

    Notes
    -----
    `study.analysis.local_inf_sup` weighs with the length of each cut instead, which separates that effect from the pair's own.
    """
    u, v = V.TnT()
    lam, mu = W.TnT()
    coupling = BilinearForm(trialspace=V, testspace=W)
    coupling += mu * NormalGap(u, V.body) * W.dcrack
    B = to_scipy(coupling.Assemble().mat)
    H1 = BilinearForm(V.share.Own((InnerProduct(Grad(u), Grad(v)) + u * v) * V.body.dx), symmetric=True).Assemble().mat
    M = to_scipy(BilinearForm(weight * lam * mu * W.dcrack).Assemble().mat).toarray()
    if not (np.diag(M) > 0).all() or not np.isfinite(M).all():
        raise ValueError("InfSup: weight must be positive and finite on the whole crack")
    exchange = exchange_of(V)
    S = Elimination(H1, V.FreeDofs(), Unknowns(V).tips, exchange.Additive(B), exchange=exchange).S
    return float(np.sqrt(max(scipy.linalg.eigh(S, M, eigvals_only=True)[0], 0)))
