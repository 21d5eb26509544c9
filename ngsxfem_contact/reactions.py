"""The forces of the supports: the residual of the first row of (38), tested with rigid motions."""

from dataclasses import dataclass, field

import numpy as np
from ngsolve import GridFunction, x, y


@dataclass(frozen=True)
class Holder:
    """What fixes some functions φ_i.

    name: of the boundary, or "pin at (x, y)".    dofs: unknowns of φ_i.    shares: which part of the force on each is this one's; those of all holders add
    up to 1.    point: of a pin.
    """

    name: str
    dofs: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    shares: np.ndarray = field(default_factory=lambda: np.zeros(0))
    point: tuple | None = None

    def __add__(self, other):
        return Holder(self.name, np.concatenate([self.dofs, other.dofs]), np.concatenate([self.shares, other.shares]), self.point)


@dataclass(frozen=True)
class SupportForce:
    """What one support exerts on the body.

    name: of the boundary, or "pin at (x, y)".    force: (F_x, F_y), stress × length.    moment: about the origin, stress × length².    point: of a pin.
    """

    name: str
    force: np.ndarray
    moment: float
    point: tuple | None = None


class SupportForces(list):
    """SupportForce rows; prints as a table."""

    @property
    def total(self):
        """The SupportForce of all: minus the resultant of the loads."""
        return SupportForce("all", sum((row.force for row in self), np.zeros(2)), sum(row.moment for row in self))

    def OfBoundaries(self, names):
        """(F_x, F_y) of the boundaries with some names, zero where they hold nothing."""
        return sum((row.force for row in self if row.point is None and row.name in names), np.zeros(2))

    def OfPin(self, point):
        """(F_x, F_y) of the pin at a point; raises ValueError where there is none."""
        pins = [row for row in self if row.point is not None]
        for row in pins:
            if np.shape(point) == (2,) and np.allclose(row.point, point, rtol=1e-8, atol=1e-8 * np.abs(row.point).max()):
                return row.force
        raise ValueError(f"Reaction: {point!r} is neither the name of a boundary nor the point of a pin; there are {[row.point for row in pins] or 'no pins'}")

    def __str__(self):
        rows = [*self, self.total]
        width = max(len(row.name) for row in rows)
        lines = [f"{row.name:{width}}  {row.force[0]:14.6g} {row.force[1]:14.6g} {row.moment:14.6g}" for row in rows]
        return "\n".join([f"{'support':{width}}  {'F_x':>14} {'F_y':>14} {'moment':>14}", *lines])


def support_forces(V, holders, exerted):
    """The SupportForces of Holders; exerted: what they exert on each unknown, that is (K - K_γ) U - (B - C_γ)ᵀ L - F.

    A translation is the sum of the functions of the vertices, a rotation that of Σ x_i φ_i and Σ y_i φ_i, and neither has a jump: their products
    with the residual are forces and moment, and only φ_i count.
    """
    n, coordinates = V.scalar_space.ndof, interpolated_coordinates(V)
    rows = SupportForces()
    for holder in holders:
        force, moment = np.zeros(2), 0.0
        for k, sign in ((0, -1), (1, 1)):
            mine = (holder.dofs >= k * n) & (holder.dofs < (k + 1) * n)
            functions, forces = holder.dofs[mine] - k * n, holder.shares[mine] * exerted[holder.dofs[mine]]
            force[k] = forces[functions < V.mesh.nv].sum()
            moment += sign * float(coordinates[1 - k, functions] @ forces)
        rows.append(SupportForce(holder.name, force, moment, holder.point))
    return rows


def interpolated_coordinates(V):
    """The coefficients of x and y in the functions φ_i, (2, n): on straight elements zero but for the vertices."""
    coordinates = np.zeros((2, V.scalar_space.ndof))
    if V.mesh.GetCurveOrder() <= 1:
        coordinates[:, : V.mesh.nv] = V.mesh.ngmesh.Coordinates()[: V.mesh.nv, :2].T
        return coordinates
    function = GridFunction(V.scalar_space)
    for row, coordinate in zip(coordinates, (x, y)):
        function.Set(coordinate)
        row[:] = function.vec.FV().NumPy()
    return coordinates
