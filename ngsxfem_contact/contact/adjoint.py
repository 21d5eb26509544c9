"""A solved problem, linearised with the states that were found: how multipliers, and quantities that are linear in (U, L), change with the right-hand sides of (38).

Section 17 of docs/method.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy

from ..algebra.nodal_newton import STICK

if TYPE_CHECKING:
    from typing import Any

    from ..algebra.matrices import Matrix
    from .solution import ContactSolution
    from .solver import ReducedProblem


def adjoint(reduced: ReducedProblem, solution: ContactSolution, J_u: np.ndarray, J_L: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(z, ζ): the derivatives of J_u·U + J_L·L by the right-hand sides F and G of the two rows of (38), as far as the states stay.

    Let L = T p, p = N q with the q that are free: pressures in contact, shear that sticks; where a node slips its shear follows the pressure. The rows that hold are those of
    the q, Mᵀ Tᵀ (E U + D L - G) = 0. Transposed,

        A z - Eᵀ ζ = J_u,  -Nᵀ Tᵀ (C_θ z + Dᵀ ζ) = Nᵀ Tᵀ J_L,  ζ ∈ range of T M,

    with C_θ = E, but for Nitsche's method with θ ≠ 1. The factors are those of the solve.

    Raises
    ------
    ValueError
        For laws of the faces that hold node by node, and for parts that only the faces hold.
    """
    system, elimination = reduced.system, reduced.elimination
    TN, TM = free_multipliers(reduced, solution)
    size = len(system.distribution.T @ np.zeros(system.C.shape[0]))
    forces = elimination.Reduce(np.where(elimination.fixed, 0, J_u))
    compliance = system.distribution.T @ elimination.S[:, :size] + system.D.T.toarray()
    right = TN.T @ (J_L + system.distribution.T @ forces.crack)
    zeta = -TM @ np.linalg.solve(TN.T @ compliance @ TM, right) if TN.shape[1] else np.zeros(size)
    return elimination.Recover(forces, np.concatenate([zeta, np.zeros(system.C.shape[0] - size)])), zeta


def response(reduced: ReducedProblem, solution: ContactSolution, G: np.ndarray) -> np.ndarray:
    """The L of the linear problem with a right-hand side G of the second row of (38) alone: Mᵀ Tᵀ (S L - G) = 0, L = T N q. Raises ValueError as `adjoint`."""
    TN, TM = free_multipliers(reduced, solution)
    return TN @ np.linalg.solve(TM.T @ reduced.S @ TN, TM.T @ G) if TN.shape[1] else np.zeros(len(G))


def free_multipliers(reduced: ReducedProblem, solution: ContactSolution) -> tuple[Matrix, Matrix]:
    """(T N, T M) of `adjoint`. Raises ValueError for what is not linearised."""
    law = reduced.problem.law
    if hasattr(law, "softening") or len(reduced.motions):
        raise ValueError(
            f"Goal: the law {law} is not linearised, nor are parts of the body that only the faces hold; the error of a goal is told for contact, Tresca and Coulomb"
        )
    T, _ = reduced.Signs(solution.state.cone)
    N, M = tangent_space(solution)
    return T @ N, T @ M


def tangent_space(solution: ContactSolution) -> tuple[Matrix, Matrix]:
    """(N, M): p as a function of those that are free, and which these are; one column for each."""
    report, state = solution.report, solution.state
    contact = np.asarray(report.active[-1], dtype=bool)
    if not report.tangential:
        M = np.eye(len(contact))[:, contact]
        return M, M
    tangential = np.asarray(report.tangential[-1])
    stick = tangential == STICK
    M = np.eye(2 * len(contact))[:, np.concatenate([contact, stick])]
    law: Any = solution.problem.law  # Tresca or Coulomb
    slope = law.Threshold(state.nodes, state.cone).slope
    follows = np.where(contact & ~stick, -tangential * slope, 0)
    return scipy.sparse.bmat([[scipy.sparse.identity(len(contact)), None], [scipy.sparse.diags(follows), scipy.sparse.identity(len(contact))]]) @ M, M
