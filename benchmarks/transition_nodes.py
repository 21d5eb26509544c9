"""λ and the energy at the contact transition (d), P2/P1, by the nodes of λ: over positions of one mesh, and rates, also on meshes that are refined towards the edge of contact.

python benchmarks/transition_nodes.py [--positions 200] [--realisations 2]
"""

import argparse

import numpy as np
from closed_forms import means, rates
from ngsolve import Mesh, ngsglobals
from positions import closed_position
from results import recorded

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, TraceSpace
from ngsxfem_contact.estimate import ContactEdge
from ngsxfem_contact.exact import closed_forms as cf
from study.paper import MATERIAL

EXACT = cf.contact_transition(MATERIAL)


class Transition:
    """Case (d) on a mesh of a convex body, the crack from left to right on y = 0; the edge of contact lies at the arc length -left."""

    def __init__(self, mesh, left, right):
        self.body, boundary = CrackedMesh(mesh, cf.crack_on_axis(left, right)), "|".join(sorted(set(mesh.GetBoundaries())))
        self.V = CrackFESpace(self.body, order=2, tip=None, dirichlet=boundary, material=MATERIAL)
        self.boundary, self.length, self.edge = boundary, right - left, -left
        self.of_mesh = np.array(TraceSpace(self.body).basis.division[0])

    def Problem(self, nodes=None):
        problem = ContactProblem(self.V, TraceSpace(self.body, nodes=nodes))
        problem.SetDirichlet(EXACT.u, self.boundary)
        return problem

    def Solve(self, nodes):
        return self.Problem(list(nodes)).Solve()

    def Even(self, spacing=None):
        """Equal intervals, as many as the mesh has, or of about a spacing."""
        number = len(self.of_mesh) - 1 if spacing is None else round(self.length / spacing)
        return np.linspace(0, self.length, number + 1)

    def Merged(self, least):
        """The mesh's without nodes that are nearer than that to the one before."""
        kept = [0.0]
        for s in self.of_mesh[1:-1]:
            if s - kept[-1] >= least and self.length - s >= least:
                kept.append(s)
        return [*kept, self.length]

    def At(self, edge):
        """As many intervals as the mesh has, equal on either side of an edge."""
        number = len(self.of_mesh) - 1
        before = min(max(round(number * edge / self.length), 1), number - 1)
        return [*np.linspace(0, edge, before + 1)[:-1], *np.linspace(edge, self.length, number - before + 1)]


def errors(solution):
    return cf.pressure_error(solution, EXACT), cf.energy_error(solution, EXACT)


def variants(seed, maxh=0.06):
    """{nodes: errors} at one position."""
    case = Transition(*closed_position(seed, maxh))
    of_mesh = case.Solve(case.of_mesh)
    nodes = {"equal, as many": case.Even(), "equal, 0.75 h": case.Even(0.75 * maxh), "merged below 0.5 h": case.Merged(0.5 * maxh)}
    nodes |= {"equal, one at the edge as found": case.At(ContactEdge().Value(of_mesh)), "equal, one at the exact edge": case.At(case.edge)}
    return {"of the mesh": errors(of_mesh)} | {name: errors(case.Solve(some)) for name, some in nodes.items()}


def graded(mesh, edge, maxh):
    """Refined to h_T ≤ 2 h √r at the distance r from the edge, until h²."""
    for _ in range(20):
        corners = np.array([[mesh[v].point for v in el.vertices] for el in mesh.Elements()])
        sizes = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        r = np.linalg.norm(corners - (edge, 0), axis=2).min(axis=1)
        marked = sizes > np.maximum(2 * maxh * np.sqrt(r), maxh**2)
        if not marked.any():
            return mesh
        for element, mark in zip(mesh.Elements(), marked):
            mesh.SetRefinementFlag(element, bool(mark))
        mesh.Refine()
    return mesh


def case_of(kind):
    """case(i, maxh, pair) for `means`: (λ, energy)."""

    def case(i, maxh, pair):
        angle, offset = cf.position(i)
        mesh, ends = cf.rotated_square(angle, offset, maxh), cf.mouths(angle, offset)
        case = Transition(mesh, *ends)
        for _ in range(2 if kind == "graded" else 0):  # the edge is known better on the first graded mesh
            edge = ContactEdge().Value(case.Solve(case.of_mesh)) + ends[0]
            case = Transition(graded(Mesh(mesh.ngmesh.Copy()), edge, maxh), *ends)
        return errors(case.Solve(case.Even() if kind == "equal" else case.of_mesh))

    return case


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--positions", type=int, default=200)
    parser.add_argument("--realisations", type=int, default=2)
    arguments = parser.parse_args()
    ngsglobals.msg_level = 0
    maxhs = [0.1, 0.05, 0.025, 0.0125]
    for kind, title in {"mesh": "nodes of the mesh", "equal": "equal nodes", "graded": "graded to the edge"}.items():
        found = means(case_of(kind), maxhs, None, arguments.realisations)
        print(
            f"{title:20} rates of λ, energy {' '.join(f'{r:5.2f}' for r in rates(maxhs, found))}   errors "
            + "  ".join("/".join(f"{e:.1e}" for e in row) for row in found),
            flush=True,
        )
    found = [variants(seed) for seed in range(arguments.positions)]
    for name in found[0]:
        pressure, energy = np.array([each[name] for each in found]).T
        columns = "  ".join(
            f"{what}: median {np.median(e):.2e}  worst {e.max():.2e}  worst/median {e.max() / np.median(e):.2f}"
            for what, e in (("λ", pressure), ("energy", energy))
        )
        print(f"{name:32} {columns}")


if __name__ == "__main__":
    recorded(main)
