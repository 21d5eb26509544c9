"""Boundary-fitted solutions for straight cracks that cross, branch and end on each other: what cut elements are compared with.

Nothing of the package is used. A square in plane strain is meshed along the arms, with vertices doubled there: one copy for each fan of triangles that
hang together around a vertex without crossing an arm. Elements are of high order and shrink geometrically towards tips and meeting points.
Faces are loaded by a pressure, or are in frictionless contact; sides are loaded by the tractions of a uniform stress.

`cases.py` has the cases that are kept in `reference.json`.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from ngsolve import CF, VERTEX, BilinearForm, BitArray, Grad, GridFunction, InnerProduct, Integrate, LinearForm, NodeId, VectorH1, ds, dx
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix
from scipy.sparse.linalg import splu

from .meshing import SIDES, Arm, SplitMesh
from .tip_fields import NU, E, TipFields, stress


class FittedBody:
    """The square [-half_width, half_width]² with arms that meet at their ends only.

    Parameters
    ----------
    arms
        Pairs of points.
    half_width
    maxh
        Size of the elements at the arms; elsewhere they grow to a fourth of half_width.
    tip_h
        Size of the elements at the ends of the arms.
    order
        Degree of the displacement.
    """

    def __init__(self, arms, half_width=1.0, maxh=0.05, tip_h=1e-4, order=3):
        self.arms, self.half_width = [Arm(*arm) for arm in arms], half_width
        split = SplitMesh(self.arms, half_width, maxh, tip_h)
        self.mesh, self.points, self.triangles, self.old, self.lips = split.mesh, split.points, split.triangles, split.old, split.lips
        self.space = VectorH1(self.mesh, order=order)
        u, v = self.space.TnT()
        self.K = to_scipy(BilinearForm(InnerProduct(stress(Grad(u)), Grad(v)) * dx).Assemble().mat)
        self._Rows()

    def _Rows(self):
        """Normal gaps as rows on pairs of unknowns: of vertices (arm, plus, minus) and of edges, by the place they stand at."""
        edges = {tuple(v.nr for v in edge.vertices): edge for edge in self.mesh.edges}
        dofs = lambda edge: self.space.components[0].GetDofNrs(edges[tuple(sorted(edge))])
        self.pairs = sorted({(arm, p[k], m[k]) for arm, p, m in self.lips for k in (0, 1) if p[k] != m[k]})
        number = {pair: i for i, pair in enumerate(self.pairs)}
        self.edge_ends = [[number[arm, p[k], m[k]] for k in (0, 1) if p[k] != m[k]] for arm, p, m in self.lips]
        self.edge_dofs = [list(zip(dofs(p), dofs(m))) for _, p, m in self.lips]

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

    def Solve(self, pressure=0.0, sigma=((0, 0), (0, 0)), contact=True):
        """A Solution; with contact the normal gaps are ≥ 0, found by an active set of vertices."""
        load = self.Load(pressure, sigma)
        closed = np.full(len(self.pairs), contact)
        for _ in range(60):
            u, force = self._SolveClosed(load, closed)
            gap = np.array([self.Gap(u, *pair) for pair in self.pairs])
            before, closed = closed, np.where(closed, force > 0, gap < -1e-12 * np.abs(u).max()) if contact else closed
            if np.array_equal(before, closed):
                return Solution(self, u, load, pressure, closed, force)
        raise RuntimeError("the active set did not settle in 60 steps: take another mesh")

    def Gap(self, u, arm, plus, minus):
        """Normal gap of a pair of unknowns of the two lips of an arm."""
        n = len(u) // 2
        return (u[[plus, n + plus]] - u[[minus, n + minus]]) @ self.arms[arm].n

    def _ActiveRows(self, closed):
        """The rows (group, arm, plus, minus) that are closed. An edge is when its ends are, a tip always being closed; groups share unknowns."""
        for row in np.flatnonzero(closed):
            yield int(self.old[self.pairs[row][1]]), *self.pairs[row]
        for (arm, _, _), ends, dofs in zip(self.lips, self.edge_ends, self.edge_dofs):
            if len(ends) and closed[ends].all():
                yield from ((-1 - int(plus), arm, plus, minus) for plus, minus in dofs)

    def _SolveClosed(self, load, closed):
        """The displacement with these gaps zero, and the contact force at each vertex pair: zero where it is open."""
        groups = {}
        for group, *row in self._ActiveRows(closed):
            groups.setdefault(group, []).append(row)
        basis, matrices = self._Basis(groups)
        reduced = csc_matrix(basis.T @ self.K @ basis)
        u = basis @ splu(reduced, permc_spec="MMD_AT_PLUS_A", options=dict(SymmetricMode=True), diag_pivot_thresh=0.0).solve(basis.T @ load)
        residual, number, force = self.K @ u - load, {pair: i for i, pair in enumerate(self.pairs)}, np.zeros(len(closed))
        for group, (dofs, rows) in matrices.items():
            if group >= 0:
                force[[number[tuple(row)] for row in groups[group]]] = np.linalg.lstsq(rows.T, residual[dofs], rcond=None)[0]
        return u, force

    def _Basis(self, groups):
        """Columns that span the displacements with the gaps of the groups zero and three unknowns held; the rows of each group."""
        n, matrices, entries = self.space.ndof // 2, {}, []
        corner = lambda sx: int(np.argmin(np.abs(self.points - (sx * self.half_width, -self.half_width)).sum(axis=1)))
        held = {corner(-1), n + corner(-1), n + corner(1)}
        for group, rows in groups.items():
            dofs = sorted({d for _, plus, minus in rows for p in (plus, minus) for d in (p, n + p)})
            place, matrix = {d: i for i, d in enumerate(dofs)}, np.zeros((len(rows), len(dofs)))
            for i, (arm, plus, minus) in enumerate(rows):
                for sign, p in ((1, plus), (-1, minus)):
                    matrix[i, [place[p], place[n + p]]] += sign * self.arms[arm].n
            matrices[group] = dofs, matrix
            _, values, vectors = np.linalg.svd(matrix)
            entries += [(dofs, column) for column in vectors[np.sum(values > 1e-10) :]]
        single = set(range(2 * n)) - held - {d for dofs, _ in matrices.values() for d in dofs}
        entries += [([d], [1.0]) for d in sorted(single)]
        columns = np.repeat(np.arange(len(entries)), [len(dofs) for dofs, _ in entries])
        data = np.concatenate([values for _, values in entries]), (np.concatenate([dofs for dofs, _ in entries]), columns)
        return csr_matrix(coo_matrix(data, shape=(2 * n, len(entries)))), matrices


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

    def __init__(self, body, u, load, pressure, closed, force):
        self.body, self.pressure, self.closed, self.force = body, pressure, closed, force
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
        """Resultant normal force on an arm, > 0 in compression; without the share of the tip's vertex, half a tip_h of pressure."""
        return float(sum(f for f, pair in zip(self.force, self.body.pairs) if pair[0] == arm))

    def ClosedPart(self, arm):
        """Closed length over length."""
        edges = [(p, ends) for (k, p, _), ends in zip(self.body.lips, self.body.edge_ends) if k == arm]
        size = lambda edge: np.linalg.norm(np.subtract(*self.body.points[list(edge)]))
        return float(sum(size(p) for p, ends in edges if ends and self.closed[ends].all()) / self.body.arms[arm].length)

    def StressIntensity(self, tip, radius):
        """(K_I, K_II) at (arm, end) by the interaction integral over a disk that has no other arm; K_I is nan where faces touch in it.

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
        touching = any(c and p[0] == tip[0] and np.linalg.norm(self.body.points[p[1]] - frame.tip) < radius for c, p in zip(self.closed, self.body.pairs))
        K[0] += np.nan if touching else self.pressure * frame.faces
        return tuple(E / (2 * (1 - NU**2)) * k for k in K)

    def _Near(self, place, radius):
        """The elements that a disk meets, as a BitArray; some more."""
        corners = self.body.points[self.body.triangles]
        size = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
        return BitArray(list(map(bool, np.linalg.norm(corners.mean(axis=1) - place, axis=1) < radius + size)))
