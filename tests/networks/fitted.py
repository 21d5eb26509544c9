"""Boundary-fitted solutions for straight cracks that cross, branch and end on each other: what cut elements are compared with.

Nothing of the package is used. A square in plane strain is meshed along the arms, with vertices doubled there: one copy for each fan of triangles that
hang together around a vertex without crossing an arm. Elements are of high order and shrink geometrically towards tips and meeting points.
Faces are loaded by a pressure, and are in contact, with friction or without; sides are loaded by the tractions of a uniform stress.

`cases.py` has the cases that are kept in `reference.json`.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from ngsolve import CF, VERTEX, BilinearForm, BitArray, Grad, GridFunction, InnerProduct, Integrate, LinearForm, NodeId, VectorH1, ds, dx
from scipy.sparse import csr_matrix

from .contact import Pairs
from .meshing import SIDES, Arm, SplitMesh
from .tip_fields import KAPPA, MU, NU, E, TipFields, stress


class FittedBody:
    """The square [-half_width, half_width]² with arms that meet at their ends only.

    Parameters
    ----------
    arms
        Pairs of points.
    half_width
    maxh
        Size of the elements at the arms.
    tip_h
        Size of the elements at the ends of the arms.
    far
        To which they grow elsewhere; default a fourth of half_width.
    order
        Degree of the displacement.
    """

    def __init__(self, arms, half_width=1.0, maxh=0.05, tip_h=1e-4, order=3, far=None):
        self.arms, self.half_width = [Arm(*arm) for arm in arms], half_width
        split = SplitMesh(self.arms, half_width, maxh, tip_h, far or half_width / 4)
        self.mesh, self.points, self.triangles, self.old, self.lips = split.mesh, split.points, split.triangles, split.old, split.lips
        self.space = VectorH1(self.mesh, order=order)
        u, v = self.space.TnT()
        self.K = to_scipy(BilinearForm(InnerProduct(stress(Grad(u)), Grad(v)) * dx).Assemble().mat)
        self.pairs = Pairs(self)

    @cached_property
    def tips(self):
        """(arm, end) of the ends that no other arm has and that are not on a side; end is 0 or 1."""
        ends = [(k, e, p) for k, arm in enumerate(self.arms) for e, p in enumerate((arm.a, arm.b))]
        free = lambda p: sum(np.allclose(p, q) for _, _, q in ends) == 1 and max(abs(p)) < self.half_width
        return [(k, e) for k, e, p in ends if free(p)]

    def Load(self, pressure=0.0, sigma=((0, 0), (0, 0))):
        """Of a pressure on all faces and of the tractions σn on the sides."""
        v, f = self.space.TestFunction(), LinearForm(self.space)
        for side, normal in SIDES.items():
            f += CF(tuple(np.array(sigma, float) @ normal)) * v * ds(side)
        for k, arm in enumerate(self.arms):
            for lip, sign in (("plus", 1), ("minus", -1)):
                f += CF(tuple(sign * pressure * arm.n)) * v * ds(f"{lip}{k}")
        return f.Assemble().vec.FV().NumPy().copy()

    def Solve(self, pressure=0.0, sigma=((0, 0), (0, 0)), contact=True, friction=0.0):
        """A Solution; with contact normal gaps are ≥ 0, and Coulomb's friction acts."""
        load = self.Load(pressure, sigma)
        status, rng = self.pairs.Start(contact, friction), np.random.default_rng(0)
        for step in range(100):
            u, forces = self.pairs.Solve(load, status, friction)
            after = self.pairs.Next(status, self.pairs.Jumps(u), forces, friction) if contact else status
            if after == status:
                return Solution(self, u, pressure, status, forces, friction)
            status = after if step < 10 else self.pairs.Half(status, after, rng)
        raise RuntimeError("the active set did not settle in 100 steps: take another mesh")


def to_scipy(matrix):
    rows, columns, values = matrix.COO()
    return csr_matrix((np.array(values), (np.array(rows), np.array(columns))), shape=(matrix.height, matrix.width))


class Solution:
    """What a FittedBody does under a load.

    Attributes
    ----------
    u : GridFunction
    energy
        ½ ∫ σ:ε.
    """

    def __init__(self, body, u, pressure, status, forces, friction):
        self.body, self.pressure, self.closed, self.forces, self.friction = body, pressure, status.closed, forces, friction
        self.u = GridFunction(body.space)
        self.u.vec.FV().NumPy()[:] = u
        self.energy = 0.5 * u @ (body.K @ u)

    def Jump(self, arm, fraction):
        """(opening, slip) at a + fraction (b - a): u⁺ - u⁻ along n and t."""
        line, points = self.body.arms[arm], self.body.points
        place = line.a + fraction * (line.b - line.a)
        ahead = [(place - points[list(p)]) @ line.t if k == arm else (-1, -1) for k, p, _ in self.body.lips]
        lip = np.argmax([min(to_first, -to_second) for to_first, to_second in ahead])
        plus, minus = (self._At(edge, place) for edge in self.body.lips[lip][1:])
        return float((plus - minus) @ line.n), float((plus - minus) @ line.t)

    def _At(self, edge, place):
        """u in the triangle that has an edge of a lip; the reference triangle has the vertices (1,0), (0,1), (0,0)."""
        mesh = self.body.mesh
        element = next(el for el in mesh[NodeId(VERTEX, int(edge[0]))].elements if int(edge[1]) in [v.nr for v in mesh[el].vertices])
        p, q, r = (self.body.points[v.nr] for v in mesh[element].vertices)
        where = mesh(*[[c] for c in (p + q + r) / 3])
        where["nr"], (where["x"], where["y"]) = element.nr, np.linalg.solve(np.column_stack([p - r, q - r]), place - r)
        return self.u(where)[0]

    def ContactForce(self, arm):
        """Resultants on an arm (normal, > 0 in compression; tangential, along t on the plus side); the tip's vertex is left out, half a tip_h of pressure."""
        return tuple(map(float, self.forces[:, [pair[0] == arm for pair in self.body.pairs.vertices]].sum(axis=1)))

    def ClosedPart(self, arm):
        """Closed length over length."""
        edges = [(p, ends) for (k, p, _), ends in zip(self.body.lips, self.body.pairs.edge_ends) if k == arm]
        size = lambda edge: np.linalg.norm(np.subtract(*self.body.points[list(edge)]))
        return float(sum(size(p) for p, ends in edges if ends and self.closed[ends].all()) / self.body.arms[arm].length)

    def StressIntensity(self, tip, radius):
        """(K_I, K_II) at (arm, end) by the interaction integral over a disk that has no other arm; K_I is nan where faces touch in it, K_II where they rub.

        K_II > 0 where the left face, seen towards the tip, is ahead of the right one.
        """
        arm, end = self.body.arms[tip[0]], tip[1]
        e1 = CF(tuple(arm.t if end else -arm.t))
        frame = TipFields(arm.b if end else arm.a, arm.t if end else -arm.t, radius)
        gradient, K = Grad(self.u), []
        for aux in frame.Gradients():
            term = (stress(gradient) * (aux * e1) + stress(aux) * (gradient * e1)) * frame.q_gradient
            term -= InnerProduct(stress(aux), gradient) * (e1 * frame.q_gradient)
            near = self._Near(frame.tip, radius)
            K.append(Integrate(term.Compile() * dx(definedonelements=near, bonus_intorder=self.body.space.globalorder + 8), self.body.mesh))
        K[0] += self.pressure * frame.faces
        if self._Touches(tip[0], frame.tip, radius):
            K = [np.nan, np.nan if self.friction else K[1]]
        return tuple(E / (2 * (1 - NU**2)) * k for k in K)

    def StressIntensityFromJumps(self, tip, distance):
        """(K_I, K_II) from opening and slip at two small distances behind the tip, extrapolated to it; whatever the faces do."""
        arm, end = self.body.arms[tip[0]], tip[1]
        jump = lambda r: np.array(self.Jump(tip[0], 1 - r / arm.length if end else r / arm.length))
        K = lambda r: MU / (KAPPA + 1) * np.sqrt(2 * np.pi / r) * jump(r)
        return tuple(map(float, 2 * K(distance) - K(2 * distance)))

    def _Touches(self, arm, place, radius):
        near = lambda vertex: np.linalg.norm(self.body.points[vertex] - place) < radius
        return any(closed and k == arm and near(plus) for closed, (k, plus, _) in zip(self.closed, self.body.pairs.vertices))

    def _Near(self, place, radius):
        """The elements that a disk meets, as a BitArray; some more."""
        corners = self.body.points[self.body.triangles]
        size = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
        return BitArray(list(map(bool, np.linalg.norm(corners.mean(axis=1) - place, axis=1) < radius + size)))
