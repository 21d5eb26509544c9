"""The forces of the supports: the residual of the first row of (38), tested with rigid motions."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, ElementId, GridFunction, x, y

from ..pickling import dofs_of, numbers_of, packed, unpacked
from ..spaces.exchange import exchange_of
from ..spaces.unknowns import Unknowns
from ..tables import Table

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ngsolve import CoefficientFunction, Mesh

    from .._ngsxfem_contact import CrackFESpace


@dataclass(frozen=True)
class Holder:
    """What fixes some functions φ_i.

    Attributes
    ----------
    name
        Of the boundary, or "pin at (x, y)", in space "pin at (x, y, z)".
    dofs
        Unknowns of φ_i.
    shares
        Which part of the force on each is this one's; those of all holders add up to 1.
    point
        Of a pin.
    """

    name: str
    dofs: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    shares: np.ndarray = field(default_factory=lambda: np.zeros(0))
    point: tuple[float, ...] | None = None

    def __add__(self, other: Holder) -> Holder:
        dofs, position = np.unique(np.concatenate([self.dofs, other.dofs]), return_inverse=True)
        return Holder(self.name, dofs, np.bincount(position, np.concatenate([self.shares, other.shares]), len(dofs)), self.point)


@dataclass(frozen=True)
class SupportForce:
    """What one support exerts on the body.

    Attributes
    ----------
    name
        As of its Holder.
    force
        (F_x, F_y), stress × length; in space (F_x, F_y, F_z), stress × area.
    moment
        About the origin, stress × length²; in space (M_x, M_y, M_z), stress × volume.
    point
        Of a pin.
    """

    name: str
    force: np.ndarray
    moment: float | np.ndarray
    point: tuple[float, ...] | None = None


class SupportForces(list[SupportForce]):
    """SupportForce rows; prints as a table."""

    def __init__(self, rows: Iterable[SupportForce] = (), dimension: int = 2) -> None:
        super().__init__(rows)
        self.dimension = dimension

    @property
    def columns(self) -> list[str]:
        """The names of the components."""
        return ["F_x", "F_y", "moment"] if self.dimension == 2 else ["F_x", "F_y", "F_z", "M_x", "M_y", "M_z"]

    @property
    def table(self) -> Table:
        """A Table with a row for each support: its name, F_x, F_y and moment, in space F_x, F_y, F_z, M_x, M_y, M_z. `total` is not among them."""
        values = np.array([components(row) for row in self]).reshape(-1, len(self.columns))
        return Table.Of({"support": [row.name for row in self]} | dict(zip(self.columns, values.T)))

    @property
    def total(self) -> SupportForce:
        """The SupportForce of all: minus the resultant of the loads."""
        no_moment: Any = 0.0 if self.dimension == 2 else np.zeros(3)
        return SupportForce("all", sum((row.force for row in self), np.zeros(self.dimension)), sum((row.moment for row in self), no_moment))

    def OfBoundaries(self, names: set[str]) -> np.ndarray:
        """The force of the boundaries with some names, zero where they hold nothing."""
        return sum((row.force for row in self if row.point is None and row.name in names), np.zeros(self.dimension))

    def OfPin(self, point: Sequence[float]) -> np.ndarray:
        """The force of the pin at a point; raises ValueError where there is none."""
        pins = [row for row in self if row.point is not None]
        for row in pins:
            if np.shape(point) == np.shape(row.point) and np.allclose(row.point, point, rtol=1e-8, atol=1e-8 * np.abs(row.point).max()):
                return row.force
        raise ValueError(f"Reaction: {point!r} is neither the name of a boundary nor the point of a pin; there are {[row.point for row in pins] or 'no pins'}")

    def __str__(self) -> str:
        rows = [*self, self.total]
        width = max(len(row.name) for row in rows)
        lines = [" ".join([f"{row.name:{width}} ", *(f"{value:14.6g}" for value in components(row))]) for row in rows]
        return "\n".join([" ".join([f"{'support':{width}} ", *(f"{name:>14}" for name in self.columns)]), *lines])


def components(row: SupportForce) -> list[float]:
    """Force and moment."""
    return [*row.force, *np.atleast_1d(row.moment)]


@dataclass(frozen=True)
class CornerEdge:
    """An edge of a named boundary at a vertex where it meets another one.

    Parameters
    ----------
    normal
        Of the body, outward, as long as the edge.
    element
        The triangle behind it.
    xi, eta
        Reference coordinates of the point at a third of the edge.
    """

    name: str
    vertex: int
    normal: np.ndarray
    element: int
    xi: float
    eta: float


@dataclass(frozen=True)
class SupportResidual:
    """What supports exert on a solution of (38).

    Parameters
    ----------
    V : CrackFESpace
        Of the solution.
    holders, edges
        What held it, and CornerEdges.
    exerted
        On each unknown, (K - K_γ) U - (B - C_γ)ᵀ L - F.
    springs
        What the terms of problem.a exert.
    """

    V: CrackFESpace
    holders: list[Holder]
    edges: list[CornerEdge]
    exerted: np.ndarray
    springs: np.ndarray

    def __reduce__(self) -> Any:
        V = self.V
        numbers = numbers_of(V, *(holder.dofs for holder in self.holders))
        holders = [replace(holder, dofs=own) for holder, own in zip(self.holders, numbers)]
        return residual_of, (V, holders, self.edges, packed(V, self.exerted), packed(V, self.springs))

    def Forces(self, stress: CoefficientFunction) -> SupportForces:
        """The SupportForces; stress: σ(u), which says how the force on a corner is divided.

        A translation is the sum of the functions of the vertices, a rotation that of Σ x_i φ_i, Σ y_i φ_i (and Σ z_i φ_i), and neither has a jump: their products
        with the residual are forces and moment, and only φ_i count.
        """
        V = self.V
        coordinates, exchange = interpolated_coordinates(V), exchange_of(V)
        here = [support_force(V, coordinates, holder, forces) for holder, forces in zip(self.holders, self._divided(V, stress))]
        of_all = exchange.Gather([row if len(holder.dofs) else None for row, holder in zip(here, self.holders)])
        rows = [next((row for row in of_one if row), own) for own, *of_one in zip(here, *of_all)]  # a pin may be at others only
        if exchange.Max(np.abs(self.springs).max(initial=0)):
            whole = Holder("springs and joints", np.arange(Unknowns(V).polynomial.stop))
            part = support_force(V, coordinates, whole, exchange.Additive(self.springs)[whole.dofs])
            rows.append(SupportForce(whole.name, exchange.Sum(part.force), exchange.Sum(part.moment)))
        return SupportForces(rows, V.mesh.dim)

    def _divided(self, V: CrackFESpace, stress: CoefficientFunction) -> list[np.ndarray]:
        """What each holder exerts on each of its unknowns: ∫ φ_i σn where holders meet, and its share of what is left."""
        tractions, left = self._tractions(V, stress), self.exerted.copy()
        known = [np.array([tractions.get((holder.name, dof), 0) for dof in holder.dofs]) for holder in self.holders]
        for holder, part in zip(self.holders, known):
            left[holder.dofs] -= part
        return [part + holder.shares * left[holder.dofs] for holder, part in zip(self.holders, known)]

    def _tractions(self, V: CrackFESpace, stress: CoefficientFunction) -> dict[tuple[str, int], float]:
        """(name, unknown) → ∫ φ_i σn over the corner edges, exact for linear σ."""
        if not self.edges:
            return {}
        points = V.mesh(np.zeros(len(self.edges)), np.zeros(len(self.edges)))
        points["nr"], points["x"], points["y"] = np.array([(edge.element, edge.xi, edge.eta) for edge in self.edges]).T
        tractions, unknowns = defaultdict(float), Unknowns(V)
        for edge, sigma in zip(self.edges, stress(points).reshape(-1, 2, 2)):
            for k in range(2):
                tractions[edge.name, unknowns.Polynomial(k).start + edge.vertex] += 0.5 * sigma[k] @ edge.normal
        return tractions


def residual_of(V: CrackFESpace, holders: list[Holder], edges: list[CornerEdge], exerted: np.ndarray, springs: np.ndarray) -> SupportResidual:
    """The SupportResidual that was saved: arrays and the unknowns of holders in the order of `pickling.numbering`."""
    dofs = dofs_of(V, *(holder.dofs for holder in holders))
    held = [replace(holder, dofs=own) for holder, own in zip(holders, dofs)]
    return SupportResidual(V, held, edges, unpacked(V, exerted), unpacked(V, springs))


def corner_edge(mesh: Mesh, name: str, boundary_element: int, vertex: int) -> CornerEdge | None:
    """The CornerEdge of a boundary element at one of its vertices; None inside a body, where two triangles meet it."""
    ends = [v.nr for v in mesh[ElementId(BND, boundary_element)].vertices]
    behind = mesh[mesh[ElementId(BND, boundary_element)].edges[0]].elements
    if len(behind) != 1:
        return None
    corners = [v.nr for v in mesh[behind[0]].vertices]
    points = {number: np.array(mesh.vertices[number].point) for number in corners}
    along = points[ends[1]] - points[ends[0]]
    normal = np.array([along[1], -along[0]])
    inside = points[next(number for number in corners if number not in ends)] - points[ends[0]]
    weights = [2 / 3 if number == vertex else 1 / 3 if number in ends else 0 for number in corners]
    return CornerEdge(name, vertex, -normal if normal @ inside > 0 else normal, behind[0].nr, *weights[:2])


def interpolated_coordinates(V: CrackFESpace) -> np.ndarray:
    """The coefficients of x, y (and z) in the functions φ_i, (dimension, n): on straight elements zero but for the vertices."""
    coordinates = np.zeros((V.mesh.dim, Unknowns(V).functions))
    if V.mesh.GetCurveOrder() <= 1:
        coordinates[:, : V.mesh.nv] = V.mesh.ngmesh.Coordinates()[: V.mesh.nv, : V.mesh.dim].T
        return coordinates
    function = GridFunction(V.scalar_space)
    for row, coordinate in zip(coordinates, (x, y)):
        function.Set(coordinate)
        row[:] = function.vec.FV().NumPy()
    return coordinates


def support_force(V: CrackFESpace, coordinates: np.ndarray, holder: Holder, forces: np.ndarray) -> SupportForce:
    """The SupportForce of a Holder; forces: on its unknowns."""
    unknowns, d = Unknowns(V), V.mesh.dim
    force, products = np.zeros(d), np.zeros((d, d))  # products: ∫ x_j f_k
    for k in range(d):
        own = unknowns.Polynomial(k)
        mine = (holder.dofs >= own.start) & (holder.dofs < own.stop)
        functions = holder.dofs[mine] - own.start
        force[k] = forces[mine][functions < V.mesh.nv].sum()
        products[:, k] = coordinates[:, functions] @ forces[mine]
    turns = products - products.T
    return SupportForce(holder.name, force, float(turns[0, 1]) if d == 2 else np.array([turns[1, 2], turns[2, 0], turns[0, 1]]), holder.point)
