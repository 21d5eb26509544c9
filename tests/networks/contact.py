"""Unilateral contact with Coulomb's friction between doubled vertices of equal meshes, without penalty: an active set of pairs of unknowns.

A closed pair has no normal gap, a sticking one no slip. So u is in the kernel of rows of gaps, and because a force F of contact pulls a force μ F against the
slip behind it, equilibrium holds for test functions in the kernel of the rows gap - μ sign(slip) slip. (No history: the load acts in one step.)
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, hstack, identity
from scipy.sparse.linalg import splu


class Status:
    """Of each pair: closed or open, sliding with sign +1 or -1, or sticking with 0; without friction closed pairs slide."""

    def __init__(self, closed, sliding):
        self.closed, self.sliding = closed, sliding

    def __eq__(self, other):
        return np.array_equal(self.closed, other.closed) and np.array_equal(self.sliding, other.sliding)


class Pairs:
    """The pairs of unknowns of a FittedBody.

    Attributes
    ----------
    vertices
        (arm, vertex on the plus side, on the minus side), tips left out.
    edge_ends
        For each edge of the body's lips the numbers of its pairs; one at a tip.
    edge_dofs
        For each the pairs of the scalar space's unknowns inside.
    """

    def __init__(self, body):
        self.body, self.n = body, body.space.ndof // 2
        edges = {tuple(v.nr for v in edge.vertices): edge for edge in body.mesh.edges}
        dofs = lambda edge: body.space.components[0].GetDofNrs(edges[tuple(sorted(edge))])
        self.vertices = sorted({(arm, p[k], m[k]) for arm, p, m in body.lips for k in (0, 1) if p[k] != m[k]})
        number = {pair: i for i, pair in enumerate(self.vertices)}
        self.edge_ends = [[number[arm, p[k], m[k]] for k in (0, 1) if p[k] != m[k]] for arm, p, m in body.lips]
        self.edge_dofs = [list(zip(dofs(p), dofs(m))) for _, p, m in body.lips]

    def Start(self, contact, friction):
        """All pairs closed and sticking, or, without friction, sliding."""
        return Status(np.full(len(self.vertices), contact), np.full(len(self.vertices), 0 if friction else 1))

    def Jumps(self, u):
        """Normal gaps and slips (2, pairs)."""
        arm, plus, minus = np.array(self.vertices).reshape(-1, 3).T
        jump = np.stack([u[plus] - u[minus], u[self.n + plus] - u[self.n + minus]])
        axes = np.array([[a.n, a.t] for a in self.body.arms])[arm]
        return np.einsum("pkx,xp->kp", axes, jump)

    def Next(self, status, jumps, forces, friction):
        """The status that follows from gaps, slips and forces."""
        gap, slip = jumps
        normal, tangential = forces
        closed = np.where(status.closed, normal > 0, gap < -1e-12 * np.abs(jumps).max())
        if not friction:
            return Status(closed, status.sliding)
        starts = np.where(np.abs(tangential) > friction * normal, -np.sign(tangential), 0)
        stays = np.where(slip * status.sliding > 0, status.sliding, 0)
        return Status(closed, np.where(status.closed, np.where(status.sliding == 0, starts, stays), np.sign(slip)).astype(int))

    @staticmethod
    def Half(before, after, rng):
        """A status with half of the changes, by chance: this ends cycles."""
        chosen = rng.random(len(before.closed)) < 0.5
        return Status(np.where(chosen, after.closed, before.closed), np.where(chosen, after.sliding, before.sliding))

    def Rows(self, status):
        """(group, arm, plus, minus, sliding, number) of closed pairs, number -1 for those inside edges; groups are those at one place.

        An edge is closed where its ends are, a tip always being closed, and slides where an end does, unless the other end slides the other way.
        """
        for i in np.flatnonzero(status.closed):
            yield int(self.body.old[self.vertices[i][1]]), *self.vertices[i], status.sliding[i], i
        for (arm, _, _), ends, dofs in zip(self.body.lips, self.edge_ends, self.edge_dofs):
            if len(ends) and status.closed[ends].all():
                yield from ((-1 - int(plus), arm, plus, minus, np.sign(status.sliding[ends].sum()), -1) for plus, minus in dofs)

    def Solve(self, load, status, friction):
        """The displacement, and normal and tangential forces (2, pairs) on the plus side, the normal one in the direction of n."""
        groups = {}
        for group, *row in self.Rows(status):
            groups.setdefault(group, []).append(row)
        local = {group: self._Matrices(rows, friction) for group, rows in groups.items()}
        trial, test = self._Bases(local)
        matrix = csc_matrix(test.T @ self.body.K @ trial)
        options = dict(permc_spec="MMD_AT_PLUS_A", options=dict(SymmetricMode=True), diag_pivot_thresh=0.01 if friction else 0.0)
        u = trial @ splu(matrix, **options).solve(test.T @ load)
        residual, forces = self.body.K @ u - load, np.zeros((2, len(self.vertices)))
        for group, (dofs, _, rows) in local.items():
            if group >= 0:
                self._Forces(forces, groups[group], np.linalg.lstsq(rows.T, residual[dofs], rcond=None)[0], friction)
        return u, forces

    def _Matrices(self, rows, friction):
        """Unknowns of a group, rows that are zero for u, rows that are zero for test functions: normal ones first, then tangential ones of what sticks."""
        dofs = sorted({d for _, plus, minus, *_ in rows for p in (plus, minus) for d in (p, self.n + p)})
        place = {d: i for i, d in enumerate(dofs)}

        def row(arm, plus, minus, direction):
            values = np.zeros(len(dofs))
            for sign, p in ((1, plus), (-1, minus)):
                values[[place[p], place[self.n + p]]] += sign * direction
            return values

        arms = self.body.arms
        normal = [row(*r[:3], arms[r[0]].n) for r in rows]
        behind = [row(*r[:3], arms[r[0]].n - friction * r[3] * arms[r[0]].t) for r in rows]
        stick = [row(*r[:3], arms[r[0]].t) for r in rows if r[3] == 0]
        return dofs, np.array(normal + stick), np.array(behind + stick)

    @staticmethod
    def _Forces(forces, rows, values, friction):
        """Writes the forces of a group of vertices."""
        sticking = iter(values[len(rows) :])
        for (*_, sliding, i), normal in zip(rows, values):
            forces[:, i] = normal, next(sticking) if sliding == 0 else -friction * sliding * normal

    def _Bases(self, local):
        """Columns that span the displacements and the test functions; three unknowns at the lower corners are held."""
        points, w = self.body.points, self.body.half_width
        corner = lambda sx: int(np.argmin(np.abs(points - (sx * w, -w)).sum(axis=1)))
        held = {corner(-1), self.n + corner(-1), self.n + corner(1)}
        trial, test = [], []
        for dofs, rows, test_rows in local.values():
            basis, other = kernel(rows), kernel(test_rows)
            trial += [(dofs, column) for column in basis]
            test += [(dofs, column) for column in basis @ other.T @ other]
        single = np.ones(2 * self.n, dtype=bool)
        single[[*held, *(d for dofs, _, _ in local.values() for d in dofs)]] = False
        return columns(trial, single), columns(test, single)


def kernel(rows):
    """An orthonormal basis, one vector a row."""
    _, values, vectors = np.linalg.svd(rows)
    return vectors[np.sum(values > 1e-10) :]


def columns(entries, single):
    """The matrix with columns (rows, values), and a column of the unit matrix for each single unknown."""
    rest = identity(len(single), format="csc")[:, single]
    if not entries:
        return rest
    number = np.repeat(np.arange(len(entries)), [len(rows) for rows, _ in entries])
    values, rows = (np.concatenate([entry[k] for entry in entries]) for k in (1, 0))
    return hstack([coo_matrix((values, (rows, number)), shape=(len(single), len(entries))), rest], format="csc")
