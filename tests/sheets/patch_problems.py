"""Uniform compression across a sheet, whose solution every space has: λ = -1; sheets in special positions."""

import numpy as np
from exact_sheets import axes_of
from sheet_checks import degenerate_planes, whole_plane

from ngsxfem_contact import ContactProblem, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import Sheet

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
REASONS = ("20 degrees", "smaller than an element", "along the boundary", "same element", "outside of the body")  # in the words of refusals


def patch(body, front, multipliers=0):
    """(largest |λ + 1|, that in L² with lumped weights, smallest eigenvalue of S with unit diagonal, its condition number, steps)."""
    sheet = body.cracks[0]
    form = uniform_stress(MATERIAL, stress_matrix(zz=-1)).At(sheet.origin, np.array([*sheet.axes, sheet.normal]))
    problem = ContactProblem(CrackFESpace(body, dirichlet="outer", front=front, material=MATERIAL), TraceSpace(body, order=multipliers))
    problem.SetDirichlet(form.u, "outer")
    reduced = ReducedProblem(problem)
    scale = 1 / np.sqrt(np.diag(reduced.S))
    values = np.linalg.eigvalsh(reduced.S * scale * scale[:, None])
    solution = reduced.Solve()
    off, weights = np.abs(solution.state.L + 1), solution.state.nodes.weights
    return off.max(), np.sqrt(off**2 @ weights / weights.sum()), values[0], values[-1] / values[0], solution.report.iterations


def special_sheets(rng, mesh, offset):
    """(kind, sheet): planes and disks through a vertex, an edge, a face, moved along the normal; fronts through a vertex and along an edge, moved in their plane."""
    for kind, point, normal in degenerate_planes(rng, mesh):
        moved, kind = point + offset * normal, {"edge": "an edge"}.get(kind, f"a {kind}")
        yield f"plane through {kind}", whole_plane(moved, normal)
        yield f"disk through {kind}", Sheet.Disk(moved + axes_of(normal).T @ rng.uniform(-0.05, 0.05, 2), normal, rng.uniform(0.15, 0.3))
        radius, angle = rng.uniform(0.15, 0.3), rng.uniform(0, 2 * np.pi)
        ahead = axes_of(normal).T @ np.array([np.cos(angle), np.sin(angle)])
        yield f"front through {kind}", Sheet.Disk(point - (radius + offset) * ahead, normal, radius)
    vertices = np.array([v.point for v in mesh.vertices])
    edges = [[v.nr for v in edge.vertices] for edge in mesh.edges]
    inner = [pair for pair in edges if np.all((0.01 < vertices[pair]) & (vertices[pair] < 0.99))]
    a, b = vertices[inner[rng.integers(len(inner))]]
    along = (b - a) / np.linalg.norm(b - a)
    across = np.cross(along, rng.normal(size=3))
    across /= np.linalg.norm(across)
    a, b = a + offset * across - 0.1 * along, b + offset * across + 0.1 * along
    yield "front along an edge", Sheet.Polygon([a, b, b + 0.3 * across, a + 0.3 * across])
