"""Functions of V_h from given ones: Definition 3.1 of [AHLMR12], and the L² projection."""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CELL, EDGE, VERTEX, VOL, BilinearForm, BitArray, GridFunction, LinearForm, NodeId, VectorH1

from .. import _ngsxfem_contact as core
from .._ngsxfem_contact import CrackedSolid
from ..algebra.elimination import Elimination
from ..arguments import check_function, check_type
from ..sheets import check_plane
from .exchange import exchange_of
from .unknowns import Unknowns, scalar_flags

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import CoefficientFunction

    from .._ngsxfem_contact import CrackFESpace


def Interpolant(V: CrackFESpace, plus: Any, minus: Any = None, tips: Sequence[Any] = (), fronts: Sequence[Any] = ()) -> GridFunction:
    """Π_h u: a_i = û^{s_i}(y_i), b_i = (û⁺ - û⁻)(y_i), and given coefficients for the tip functions.

    Parameters
    ----------
    V : CrackFESpace
        The space.
    plus, minus
        û⁺, û⁻, smooth extensions of the regular part of u from either side to the whole body, vectors; minus=None: no jump.
    tips
        For each tip the coefficients of its first functions, K_I and K_II of modes; those of the others are zero.
    fronts
        Of a body in space: for each front K_I, K_II, K_III, numbers or functions of the place, which are taken at the nodes with modes.

    Raises
    ------
    ValueError
        For functions that are not finite or have another number of components, for a wrong number of coefficients, for tips of a body in space and fronts of a plane one.

    Notes
    -----
    With several cracks the same pair is used at each.
    """
    check_type(V, core.CrackFESpace | core.SolidFESpace, "Interpolant: V", "a CrackFESpace")
    if len(tips):
        check_plane(V.body, "Interpolant: tips= (fronts= gives the coefficients of modes around fronts)")
    if len(fronts) and not isinstance(V, core.SolidFESpace):
        raise ValueError("Interpolant: fronts= are those of a body in space; tips= gives the coefficients at tips of a plane one")
    V.body.CheckMesh()
    unknowns = Unknowns(V)
    given = ((plus, "plus"), (minus if minus is not None else plus, "minus"))
    one_sided = V.share.Together(lambda: [_smooth(V, f, name) for f, name in given])
    u = GridFunction(V)
    vec = u.vec.FV().NumPy()
    sides = _own_sides(V)
    for component in range(unknowns.components):
        of_plus, of_minus = (values[unknowns.Polynomial(component)] for values in one_sided)
        vec[unknowns.Polynomial(component)] = np.where(sides > 0, of_plus, of_minus)
        vec[unknowns.Heaviside(component)] = (of_plus - of_minus)[unknowns.enriched]
    for tip, coefficients in enumerate(tips):
        dofs = unknowns.Tip(tip)
        if np.ndim(coefficients) != 1 or len(coefficients) > len(dofs) or not np.isfinite(coefficients).all():
            raise ValueError(f"Interpolant: tips[{tip}]={coefficients!r} are not up to {len(dofs)} finite numbers, for the functions at tip {tip}")
        vec[dofs[: len(coefficients)]] = coefficients
    if len(fronts):
        set_modes(V, vec, fronts)
    return u


def set_modes(V: Any, vec: np.ndarray, fronts: Sequence[Any]) -> None:
    """Gives the modes of each front their coefficients, K_I, K_II and K_III at the nodes."""
    if len(fronts) != len(V.body.fronts):
        raise ValueError(f"Interpolant: fronts has {len(fronts)} entries for {len(V.body.fronts)} fronts; give K_I, K_II, K_III of each of body.fronts")
    factors = [check_function(K, f"Interpolant: fronts[{number}]", 3) for number, K in enumerate(fronts)]
    for j, (vertex, front) in enumerate(V.front_nodes):
        for mode, value in enumerate(factors[front](V.mesh(*V.mesh.vertices[vertex].point))):
            vec[V.FrontDof(j, mode)] = value


def _smooth(V: CrackFESpace, function: Any, name: str) -> np.ndarray:
    """Coefficients of the interpolant of a smooth function in (P_k)², component after component."""
    plain = GridFunction(VectorH1(V.mesh, **scalar_flags(V)))
    plain.Set(check_function(function, f"Interpolant: {name}", V.mesh.dim), dual=True)
    return finite(plain.vec.FV().NumPy().copy(), f"Interpolant: {name}")


def finite(values: np.ndarray, name: str) -> np.ndarray:
    """The values; raises ValueError unless all are finite."""
    if not np.isfinite(values).all():
        raise ValueError(f"{name} is not finite (NaN or inf) somewhere in the body")
    return values


def _own_sides(V: CrackFESpace) -> np.ndarray:
    """+1 or -1 for each φ_i: the side of the larger part of its support, or of its node if it is not enriched."""
    unknowns = Unknowns(V)
    sides = np.ones(unknowns.functions, dtype=int)
    points = np.array([vertex.point for vertex in V.mesh.vertices])
    nodes = [(NodeId(VERTEX, v.nr), points[v.nr]) for v in V.mesh.vertices]
    nodes += [(NodeId(EDGE, e.nr), points[[v.nr for v in e.vertices]].mean(axis=0)) for e in V.mesh.edges]
    nodes += [(NodeId(CELL, el.nr), points[[v.nr for v in el.vertices]].mean(axis=0)) for el in V.mesh.Elements(VOL)]
    for node, place in nodes:
        dofs = list(V.scalar_space.GetDofNrs(node))
        if dofs:
            sides[dofs] = side_of_nearest(V.body, tuple(place))
    sides[unknowns.enriched] = unknowns.shifts
    return sides


@singledispatch
def side_of_nearest(body: Any, point: Any) -> int:
    """±1: on which side of the nearest crack a point lies."""
    cracks = body.cracks
    distance = lambda crack: np.hypot(*np.subtract(crack.PointAt(crack.ArcLength(point)), point))
    nearest = cracks[0] if len(cracks) == 1 else min(cracks, key=distance)
    return int(nearest.SideOf(point))


@side_of_nearest.register(CrackedSolid)
def side_of_nearest_sheet(body: CrackedSolid, point: Any) -> int:
    """The same of sheets."""
    heights = [sheet.Flat(point)[2] for sheet in body.cracks]
    to_fronts = lambda number: min((front.Distance(point) for front in body.fronts if front.sheet == number), default=np.inf)
    distances = [abs(height) if sheet.Contains(point) else to_fronts(number) for number, (sheet, height) in enumerate(zip(body.cracks, heights))]
    return 1 if heights[int(np.argmin(distances))] >= 0 else -1


def Projection(V: CrackFESpace, function: CoefficientFunction, bonus_intorder: int = 4) -> GridFunction:
    """The L²(Ω∖Γ_C) projection onto V, a GridFunction.

    Parameters
    ----------
    V : CrackFESpace
    function
        CoefficientFunction, a vector, which may jump across the cracks.
    bonus_intorder
        Of the rule for it, default 4.

    Raises
    ------
    ValueError
        For a function that is not finite or has another number of components.
    """
    check_type(V, core.CrackFESpace | core.SolidFESpace, "Projection: V", "a CrackFESpace")
    share, (u, v) = V.share, V.TnT()
    mass = BilinearForm(share.Own(u * v * V.body.dx), symmetric=True).Assemble().mat
    function = check_function(function, "Projection: function", V.mesh.dim)
    load = LinearForm(share.Own(function * v * V.body.dx(bonus_intorder=bonus_intorder))).Assemble().vec.FV().NumPy()
    share.Together(lambda: finite(load, "Projection: function"))
    result = GridFunction(V)
    everything = BitArray(V.ndof)
    everything.Set()
    result.vec.FV().NumPy()[:] = Elimination(mass, everything, Unknowns(V).tips, exchange=exchange_of(V)).SolveRefined(load)
    return result
