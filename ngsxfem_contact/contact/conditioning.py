"""The scaling of matrices on a CrackFESpace: their condition number does not depend on where cracks cut (docs/conditioning.md).

Functions ½(H - s_i) φ_i of P_k, k ≥ 2, that live on the same sliver are nearly dependent, so a diagonal scaling is not
enough. All Heaviside unknowns together are one block, orthonormalised by its own sparse factorisation (it is as
large as the crack is long), the tips' unknowns are another; each φ_i is scaled by itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from ngsolve import BitArray
from ngsolve.la import DiagonalMatrix, EigenValues_Preconditioner

from ..algebra.matrices import csr_view
from ..algebra.symmetric_system import unit_scale
from ..errors import SingularSystem
from ..spaces.negligible import without_negligible
from ..spaces.unknowns import Unknowns
from .free_motions import free_motions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import BaseMatrix

    from .._ngsxfem_contact import CrackFESpace
    from .problem import ContactProblem


def CrackScaling(matrix: BaseMatrix, V: CrackFESpace, free: BitArray | None = None) -> BaseMatrix:
    """The inverse of the block diagonal part, an NGSolve matrix: a preconditioner, or with S Sᵀ equal to it the scaling Sᵀ A S.

    Parameters
    ----------
    matrix
        Symmetric positive definite, of a form on V (K - K_γ, a mass matrix).
    V : CrackFESpace
        The space of the matrix.
    free
        Default V.FreeDofs(); functions that are negligible are left out, too.
    """
    V.share.Refuse("CrackScaling")
    others = without_negligible(matrix, V, V.FreeDofs() if free is None else free)
    blocks = []
    for dofs in scaling_blocks(V):
        block = BitArray(V.ndof)
        block.Clear()
        for dof in dofs:
            if others[dof]:
                block.Set(dof)
                others.Clear(dof)
        if block.NumSet():
            blocks.append(matrix.Inverse(block, inverse="sparsecholesky"))
    return sum(blocks, start=matrix.CreateSmoother(others))


def scaling(matrix: BaseMatrix) -> list[BaseMatrix]:
    """The diagonal matrices 1/√a_ii and √a_ii."""
    scale = unit_scale(csr_view(matrix).diagonal())
    matrices = []
    for values in (scale, 1 / scale):
        vector = matrix.CreateColVector()
        vector.FV().NumPy()[:] = values
        matrices.append(DiagonalMatrix(vector))
    return matrices


def scaling_blocks(V: CrackFESpace) -> tuple[Sequence[int], Sequence[int]]:
    """The unknowns of the Heaviside functions, and those of the tips."""
    unknowns = Unknowns(V)
    return range(unknowns.heaviside.start, unknowns.heaviside.stop), unknowns.tips.tolist()


def ConditionNumber(problem: ContactProblem) -> float:
    """The condition number of K - K_γ after CrackScaling, on the free unknowns of a ContactProblem, by Lanczos.

    Parameters
    ----------
    problem : ContactProblem
        Whose K - K_γ it is.

    Raises
    ------
    SingularSystem
        If rigid motions are left free.
    """
    problem.V.share.Refuse("ConditionNumber")
    if free := free_motions(problem):
        raise SingularSystem(free.message)
    matrix = problem.Assemble().stiffness
    scale, inverse = scaling(matrix)  # Lanczos starts from random numbers, which have no units
    scaled, preconditioner = scale @ matrix @ scale, inverse @ CrackScaling(matrix, problem.V, problem.free) @ inverse
    values = np.array(EigenValues_Preconditioner(mat=scaled, pre=preconditioner, tol=1e-16))
    return float(values.max() / values.min())
