"""Uniform pressure on sheets in any position, with multipliers of both orders."""

import numpy as np
import pytest
from exact_sheets import KINDS, axes_of, cube_mesh, random_sheet
from ngsolve import CF, IfPos, InnerProduct, Integrate, x, y, z
from patch_problems import MATERIAL, REASONS, patch, special_sheets
from sheet_checks import whole_plane

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, TraceSpace
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.spaces import FrontEnrichment

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MESH = cube_mesh(0.3, 3)


def body_of(mesh, sheet):
    """None for sheets that are refused."""
    try:
        return CrackedMesh(mesh, sheet)
    except Exception as error:
        assert any(reason in str(error) for reason in REASONS)
        return None


@pytest.mark.parametrize("multipliers", (0, 1))
@pytest.mark.parametrize("seed", range(4))
def test_random_sheets(seed, multipliers):
    """λ = -1 to round-off without modes; S is positive definite and well conditioned."""
    rng, mesh = np.random.default_rng(seed), cube_mesh(0.4, seed)
    for kind in KINDS:
        if (body := body_of(mesh, random_sheet(rng, kind).sheet)) is None:
            continue
        worst, _, least, condition, steps = patch(body, None, multipliers)
        assert worst < 1e-10 and least > 1e-3 and condition < 1e4 and steps <= 4


@pytest.mark.parametrize("multipliers", (0, 1))
@pytest.mark.parametrize("offset", (0, 1e-12, -1e-9))
def test_special_sheets(offset, multipliers):
    """Through vertices, edges and faces, fronts too."""
    for kind, sheet in special_sheets(np.random.default_rng(7), MESH, offset):
        if (body := body_of(MESH, sheet)) is not None:
            worst, _, least, _, steps = patch(body, None, multipliers)
            assert worst < 1e-10 and least > 1e-4 and steps <= 4, kind


@pytest.mark.parametrize("multipliers", (0, 1))
def test_with_modes(multipliers):
    """To what the rules leave."""
    worst, mean, least, _, _ = patch(CrackedMesh(MESH, Sheet.Disk((0.49, 0.51, 0.513), (0.1, 0.2, 1), 0.3)), FrontEnrichment(), multipliers)
    assert worst < 3e-3 and mean < 5e-4 and least > 1e-3


def test_nodes_that_are_nearly_one_are_joined():
    """A plane at 1e-9 beside a vertex cuts all edges there in about one point."""
    vertices = np.array([v.point for v in MESH.vertices])
    inner = vertices[np.argmin(np.linalg.norm(vertices - 0.5, axis=1))]
    normal = np.array([0.3, -0.2, 1]) / np.linalg.norm([0.3, -0.2, 1])
    through, beside = (TraceSpace(CrackedMesh(MESH, whole_plane(inner + d * normal, normal)), order=1) for d in (0, 1e-9))
    assert through.ndof == beside.ndof


@pytest.mark.parametrize("order", (1, 2))
def test_blocks_that_are_moved_apart(order):
    """Planes through the body, both sides held and one of them moved: each is moved as a whole, so that what is given on a side of the boundary holds on that side alone."""
    rng = np.random.default_rng(3)
    for mesh in (MESH, cube_mesh(0.45, 1)):
        for _ in range(6):
            origin, normal = rng.uniform(0.1, 0.9, 3), rng.normal(size=3)
            normal /= np.linalg.norm(normal)
            body = CrackedMesh(mesh, whole_plane(origin, normal))
            problem = ContactProblem(CrackFESpace(body, order=order, dirichlet="outer", front=None, material=MATERIAL), TraceSpace(body, order=0))
            height = InnerProduct(CF((x, y, z)) - CF(tuple(origin)), CF(tuple(normal)))
            moved = IfPos(height, 1, 0) * CF(tuple(0.1 * normal))
            problem.SetDirichlet(moved, "outer")
            solution = problem.Solve()
            off = solution.u - moved
            assert Integrate(InnerProduct(off, off) * body.dx, mesh) < 1e-20 and Integrate(InnerProduct(off, off) * body.ds("outer"), mesh) < 1e-20
            assert solution.ContactArea() == 0 and np.allclose(solution.state.nodes.Means(solution.gap), 0.1, atol=1e-10)


@pytest.mark.parametrize("multipliers", (0, 1))
def test_a_front_that_runs_beside_a_face(multipliers):
    """A disk that enters elements by 1e-9 of their size: there is nothing of it in some of them."""
    vertices = np.array([v.point for v in MESH.vertices])
    inner = vertices[np.argmin(np.linalg.norm(vertices - 0.5, axis=1))]
    for normal in ((0, 0, 1), (0.3, -0.2, 1), (1, 0.1, 0.2)):
        ahead = axes_of(normal)[0]
        for offset in (1e-9, -1e-9, 1e-11):
            worst, _, least, _, _ = patch(CrackedMesh(MESH, Sheet.Disk(inner - (0.15 + offset) * ahead, normal, 0.15)), None, multipliers)
            assert worst < 1e-10 and least > 1e-4
