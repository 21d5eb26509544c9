"""K along fronts of triangulated surfaces: smooth fields have none, closed forms of an arc, flat ones are disks."""

import numpy as np
import pytest
from ngsolve import CF, Norm, sqrt, x, y

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.fracture.front_fields import FrontField
from ngsxfem_contact.fracture.front_stress_intensity import front_factors
from ngsxfem_contact.fracture.front_tube import FrontCurve
from ngsxfem_contact.fracture.sheet_surfaces import HeightSurface
from ngsxfem_contact.geometry import HeightField, Sheet
from ngsxfem_contact.spaces import FrontEnrichment
from tests.contact.test_curved_contact import ARC, arc_gradient, slab, smooth_field
from tests.sheets.curved_surfaces import cap, circle
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
MESH, FINE, MIDDLE = cube_mesh(0.12), cube_mesh(0.1), (0.49, 0.51, 0.513)


def quadratic(a, b, c, d):
    """a p₁² + b p₁ p₂ + c p₂² + d p₁ as B-splines, whose coefficients are its polar form at three knots."""
    knots = -0.5 + 0.1 * (np.arange(13)[:, None] + [-2, -1, 0])
    mean = knots.mean(axis=1)
    square = (knots * np.roll(knots, 1, axis=1)).mean(axis=1)
    return HeightField((-0.5, -0.5), (0.1, 0.1), a * square[:, None] + b * np.outer(mean, mean) + c * square + d * mean[:, None])


BOWL = Sheet([circle((0.02, -0.01), 0.27)], (0.5, 0.5, 0.5), heights=quadratic(0.5, 0.3, -0.4, 0.2))


def test_second_derivatives_of_heights():
    """Those of the field inside of the grid, and of the polynomial beyond it."""
    surface = HeightSurface(BOWL, BOWL.heights)
    p = np.array([(0.13, -0.21), (-0.37, 0.49), (0.7, 0.8)])
    f, slopes, second = surface.Heights(p)
    assert f == pytest.approx(0.5 * p[:, 0] ** 2 + 0.3 * p[:, 0] * p[:, 1] - 0.4 * p[:, 1] ** 2 + 0.2 * p[:, 0], abs=1e-12)
    assert slopes == pytest.approx(np.stack([p[:, 0] + 0.3 * p[:, 1] + 0.2, 0.3 * p[:, 0] - 0.8 * p[:, 1]], axis=1), abs=1e-11)
    assert second == pytest.approx(np.broadcast_to([[1, 0.3], [0.3, -0.8]], (3, 2, 2)), abs=1e-10)
    assert BOWL.heights.At(*p[0]) == pytest.approx((f[0], *slopes[0]))


def test_coordinates_around_a_front():
    """∇x₁, ∇x₂, ∇s, the volume and the turning of the frames, against differences, where nothing is perpendicular."""
    tube = FrontCurve(CrackedMesh(MESH, BOWL), 0).tube
    at, step = np.array([np.linspace(0.1, 1.5, 5), np.linspace(-0.1, 0.12, 5), np.linspace(0.1, -0.1, 5)]), 1e-5
    places = tube.At(*at)
    moved = [[tube.At(*(at + sign * step * np.eye(3)[axis][:, None])) for sign in (1, -1)] for axis in (1, 2, 0)]
    jacobian = np.stack([(after.points - before.points) / (2 * step) for after, before in moved], axis=2)
    in_frames = np.einsum("npi,nia->npa", places.frames, jacobian)
    assert np.allclose(np.linalg.inv(in_frames), places.dual, atol=1e-7) and np.allclose(np.linalg.det(jacobian), places.volume, atol=1e-7)
    for axis, (after, before) in enumerate(moved):
        assert np.allclose(np.einsum("nik,njk->nij", (after.frames - before.frames) / (2 * step), places.frames), places.turn[:, axis], atol=1e-6)
    front = tube.At(at[0], 0 * at[1], 0 * at[2])
    assert np.allclose(front.frames, tube.curve.Frames(at[0])) and np.allclose(front.volume, tube.curve.Speeds(at[0])) and np.ptp(front.volume) > 0.01


def test_smooth_fields_have_no_factors():
    """With their body force and tractions: no term of the curvature of the sheet is missing."""
    normal = CF((-(x - 0.5 + 0.3 * (y - 0.5) + 0.2), -(0.3 * (x - 0.5) - 0.8 * (y - 0.5)), 1))
    field = smooth_field(normal / Norm(normal))
    found = front_factors(CrackedMesh(FINE, BOWL), field, MATERIAL, radius=0.16, nodes=12)
    assert np.abs([found.K_I, found.K_II, found.K_III, found.G]).max() < 1e-6


def arc_from_triangles(columns):
    """The arc of ARC, from beyond the slab to its last tip, as triangles."""
    angles, heights = np.linspace(np.pi / 2 + 0.55, np.pi / 2 - ARC.alpha, columns + 1), np.linspace(-0.5, 0.8, columns + 1)
    points = np.array([(np.cos(a), np.sin(a), h) for a in angles for h in heights])
    at = lambda i, k: i * (columns + 1) + k
    squares = [(i, k) for i in range(columns) for k in range(columns)]
    triangles = [t for i, k in squares for t in ((at(i, k), at(i, k + 1), at(i + 1, k)), (at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)))]
    return Sheet.FromTriangles(points, triangles)


@pytest.mark.parametrize("columns, bound", [(16, 2e-3), (32, 4e-4)])
def test_exact_fields_around_an_arc(columns, bound):
    """K of the closed form, for each radius, to what the fit of the surface costs."""
    body = CrackedMesh(slab(0.06), arc_from_triangles(columns))
    at = x + 1j * y
    faces = {side: arc_gradient(at / sqrt(x * x + y * y) * (1 + sign * 1e-9)) for side, sign in (("plus", 1), ("minus", -1))}
    found = front_factors(body, FrontField(arc_gradient(at), faces), MATERIAL)
    K = np.array([*ARC.StressIntensity(1), 0])

    assert np.abs(found.by_radius[:, :, :3] - K).max() < bound * K[0]


def pressed_open(mesh, sheet):
    """Unit pressure on both faces, held at the boundary."""
    front = FrontEnrichment(radius=0)  # of planar sheets, too
    V = CrackFESpace(body := CrackedMesh(mesh, sheet), order=1, dirichlet="outer", material=MATERIAL, front=front)
    problem = ContactProblem(V, TraceSpace(body))
    problem.SetDirichlet((0, 0, 0), "outer")
    problem.FacePressure(1.0)
    return problem.Solve()


def factors_of(solution):
    found = solution.StressIntensity(nodes=12)
    return np.stack([found.K_I, found.K_II, found.K_III, found.G])


def test_a_flat_triangulation_is_a_disk():
    sheets = Sheet.Disk(MIDDLE, (0, 0, 1), 0.3), Sheet.FromTriangles(*cap(sphere=np.inf, middle=MIDDLE))
    exact, found = (factors_of(pressed_open(MESH, sheet)) for sheet in sheets)
    means = exact.mean(axis=1), found.mean(axis=1)
    assert means[1] == pytest.approx(means[0], abs=1e-3 * means[0][0])
