"""The derivatives of a given stress σ⁰, which the integrals around tips and fronts need."""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import numpy as np
import scipy
from ngsolve import CF, H1, L2, BitArray, GridFunction, Integrate, grad

from .front_tube import FrontCurve

if TYPE_CHECKING:
    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackedSolid, CrackFESpace

REACH = 6  # elements around a front: more than the largest tube has
SAMPLES = 400  # points of a front


def stress_derivatives(stress: CoefficientFunction, V: CrackFESpace, near: BitArray, where: str) -> list[CoefficientFunction]:
    """∂_x σ⁰, ∂_y σ⁰ and, in space, ∂_z σ⁰, square matrices: those of its projection onto polynomials of order k + 2 on each element.

    Parameters
    ----------
    stress
        σ⁰, a square matrix.
    near
        The elements in which it has to be continuous.
    where
        What they are near to.

    Raises
    ------
    ValueError
        For a stress that jumps there, whose derivative is no function.
    """
    share, mesh, order, d = V.share, V.mesh, V.order + 2, V.mesh.dim
    gradients = {}
    for i, j in combinations_with_replacement(range(d), 2):
        projected, continuous = (GridFunction(space(mesh, order=order)) for space in (L2, H1))
        for function in (projected, continuous):
            function.Set(stress[i, j])
        measure = V.body.dx(definedonelements=near)
        jump, size = (Integrate(f * f * measure, mesh) for f in (projected - continuous, projected))
        if share.Max(jump - 1e-6 * size) > 0:
            raise ValueError(
                f"the given stress jumps near {where}, so that K, G and T-stress cannot be told; give a continuous one there, such as a GridFunction of H1"
            )
        gradients[i, j] = gradients[j, i] = grad(projected)
    return [CF(tuple(gradients[i, j][k] for i in range(d) for j in range(d)), dims=(d, d)) for k in range(d)]


def elements_near_fronts(body: CrackedSolid) -> BitArray:
    """BitArray of the elements that tubes around the fronts may reach."""
    mesh = body.mesh
    vertices, near = mesh.ngmesh.Coordinates(), np.zeros(mesh.nv, dtype=bool)
    for number in range(len(body.fronts)):
        curve = FrontCurve(body, number)
        distance, _ = scipy.spatial.cKDTree(curve.Points(np.linspace(0, curve.length, SAMPLES))).query(vertices, distance_upper_bound=REACH * curve.h)
        near |= np.isfinite(distance)
    return BitArray(near[mesh.ngmesh.Elements3D().NumPy()["nodes"][:, :4].astype(int) - 1].any(axis=1).tolist())
