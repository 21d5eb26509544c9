"""Pictures and VTK show the crack open."""

import base64
import builtins
import re
import xml.etree.ElementTree as ElementTree
from types import SimpleNamespace

import numpy as np
import pytest
from netgen.geom2d import SplineGeometry
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, LinearForm, Mesh

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, Strain, TipEnrichment
from ngsxfem_contact.plotting import plots as plotting
from ngsxfem_contact.plotting import split_mesh
from ngsxfem_contact.plotting.split_mesh import SplitMesh
from ngsxfem_contact.points import crack_points

MATERIAL = Elasticity(1, 1)


def unstructured(maxh=0.15):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=maxh))


@pytest.fixture(scope="module")
def solution():
    """A cracked square that is pulled open."""
    body = CrackedMesh(unstructured(), Crack([(0, 0.013), (0.5, 0.013)]))
    V = CrackFESpace(body, order=2, tip=TipEnrichment(material=MATERIAL), dirichlet="bottom")
    u, v = V.TnT()
    stiffness = BilinearForm(InnerProduct(MATERIAL.Stress(Strain(u)), Strain(v)) * body.dx).Assemble()
    load = LinearForm(V)
    load += CF((0, 0.3)) * v * body.ds("top")
    load.Assemble()
    pulled = GridFunction(V)
    pulled.vec.data = stiffness.mat.Inverse(V.FreeDofs(), "umfpack") * load.vec
    stress = MATERIAL.Stress(Strain(pulled))
    return SimpleNamespace(
        u=pulled, body=body, problem=SimpleNamespace(material=MATERIAL, V=V), Profile=profile, stress=stress, VonMises=lambda: MATERIAL.VonMises(stress)
    )


def profile(crack=0, n=200):
    """A contact zone 0.1 < s < 0.3."""
    s = np.linspace(0, 0.5, n)
    inside = (s > 0.1) & (s < 0.3)
    zero = 0 * s
    return SimpleNamespace(s=s, x=s, y=zero, gap=np.where(inside, 0, 1e-3), slip=zero, sigma_n=np.where(inside, -0.2, 0), sigma_t=zero)


def test_von_mises():
    mesh = unstructured()
    at = mesh(0.5, 0.1)  # holds no reference to the mesh
    material = Elasticity.PlaneStrain(1, 0.3)
    shear = plotting.von_mises(material, CF((0, 0.1, 0.1, 0), dims=(2, 2)))
    assert shear(at) == pytest.approx(np.sqrt(3) * 2 * material.mu * 0.1)
    stretch = plotting.von_mises(material, CF((0.1, 0, 0, 0), dims=(2, 2)))  # uniaxial strain: |σ_xx - σ_yy|
    assert stretch(at) == pytest.approx(2 * material.mu * 0.1)


def test_body_is_drawn_with_the_crack_open(solution, pyplot):
    ax = plotting.plot_body(solution, scale=0.1)
    plus, minus = (line.get_xydata() for line in ax.lines)
    plus, minus = (line[np.isfinite(line[:, 0])] for line in (plus, minus))
    mouth = Jump(solution.u)(crack_points(solution.body, 0, [0.0]))[0]
    drawn = plus[np.argmin(np.hypot(*(plus - plus[np.argmin(plus[:, 0])]).T))] - minus[np.argmin(minus[:, 0])]
    assert mouth[1] > 0.1
    assert np.allclose(drawn, 0.1 * mouth, atol=1e-10)
    assert ax.get_aspect() == 1 and "0.1" in ax.get_title()
    assert [bar.get_ylabel() for bar in ax.child_axes] == ["von Mises stress"]


def test_automatic_scale_shows_five_percent(solution, pyplot):
    title = plotting.plot_body(solution, ax=pyplot.subplots()[1]).get_title()
    scale = float(re.search(r"× (\S+)", title).group(1))
    largest = np.linalg.norm(SplitMesh(solution.body, 1).Evaluate(Plus(solution.u), Minus(solution.u), solution.u), axis=1).max()
    assert scale * largest == pytest.approx(0.05, rel=0.05)


def test_profile_shades_the_contact_zone(solution, pyplot):
    pressure, gap = plotting.plot_profile(solution)
    assert pressure.lines[-1].get_ydata().max() == 0.2 and gap.lines[-1].get_ydata().max() == 1e-3
    for ax in (pressure, gap):
        zone = ax.collections[0].get_paths()[0].get_extents()
        assert (zone.x0, zone.x1) == pytest.approx((0.1, 0.3), abs=0.003)


def test_profile_of_chosen_quantities(solution, pyplot):
    slip, shear = plotting.plot_profile(solution, quantities=("slip", "shear"))
    assert (slip.get_ylabel(), shear.get_ylabel()) == ("slip $g_t$", "tangential stress $\\sigma_t$")
    with pytest.raises(ValueError, match="'opening' is not one of"):
        plotting.plot_profile(solution, quantities=("opening",))


def test_body_is_coloured_by_a_field(solution, pyplot):
    stress = MATERIAL.Stress(Strain(solution.u))[1, 1]
    ax = plotting.plot_body(solution, field=stress, label="σ_yy")
    split, _ = plotting.split_displacement(solution)
    assert np.allclose(ax.collections[0].get_array(), split.EvaluateInside(stress).ravel())
    assert [bar.get_ylabel() for bar in ax.child_axes] == ["σ_yy"]


def test_profile_of_an_open_crack_has_no_contact_zone(solution, pyplot):
    zero = np.zeros(5)
    open_crack = SimpleNamespace(Profile=lambda **_: SimpleNamespace(s=np.arange(5.0), gap=zero + 1, sigma_n=zero))
    pressure, _ = plotting.plot_profile(open_crack)
    assert pressure.collections[0].get_paths() == [] and pressure.get_legend() is None


def test_mesh_shows_enriched_vertices(solution, pyplot):
    V = solution.problem.V
    ax = plotting.plot_mesh(V)
    circles = next(line for line in ax.lines if line.get_label() == "Heaviside function").get_xydata()
    assert len(circles) == CrackFESpace(solution.body, order=1).num_heaviside > 0
    disk = next(line for line in ax.lines if "tip" in line.get_label()).get_xydata()
    assert np.allclose(np.linalg.norm(disk - [0.5, 0.013], axis=1), V.tip_specs[0].r1)


def test_missing_matplotlib_is_explained(solution, monkeypatch):
    found = builtins.__import__

    def without_matplotlib(name, *args, **kwargs):
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return found(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without_matplotlib)
    with pytest.raises(ImportError, match=r"pip install ngsxfem_contact\[plot\]"):
        plotting.plot_mesh(solution.problem.V)


def read_vtu(path):
    """The arrays of a .vtu file with appended raw data: name → array (n, components)."""
    content = open(path, "rb").read()
    start = content.index(b"_", content.index(b"<AppendedData")) + 1
    header = ElementTree.fromstring(content[: content.index(b"<AppendedData")] + b"</VTKFile>")
    types = {"Float64": np.float64, "Int32": np.int32, "UInt8": np.uint8}
    arrays = {}
    for array in header.iter("DataArray"):
        offset = start + int(array.get("offset"))
        size = int(np.frombuffer(content, np.uint32, 1, offset)[0])
        data = np.frombuffer(content[offset + 4 : offset + 4 + size], types[array.get("type")])
        arrays[array.get("Name")] = data.reshape(-1, int(array.get("NumberOfComponents") or 1))
    return arrays


def check_open(points, shown, solution):
    """The points at the mouth have two displacements, and they differ by the jump."""
    there = np.linalg.norm(points[:, :2] - [0, 0.013], axis=1) < 1e-12
    values = np.unique(shown[there].round(12), axis=0)
    jump = Jump(solution.u)(crack_points(solution.body, 0, [0.0]))[0]
    assert len(values) == 2
    assert np.ptp(values, axis=0)[1] == pytest.approx(jump[1], abs=1e-10)


def test_vtk_has_the_crack_open(solution, tmp_path):
    name = plotting.save_vtk(solution, tmp_path / "body")
    assert name == str(tmp_path / "body.vtu")
    assert [p.name for p in tmp_path.iterdir()] == ["body.vtu"]
    arrays = read_vtu(name)
    check_open(arrays["Points"], arrays["displacement"], solution)
    assert set(np.unique(arrays["side"])) == {-1, 0, 1}
    assert {"von_mises", "stress_xx", "stress_yy", "stress_xy"} < set(arrays)
    assert np.all(np.isfinite(arrays["von_mises"])) and arrays["von_mises"].min() >= 0


def test_vtk_opens_in_pyvista(solution, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.read(plotting.save_vtk(solution, tmp_path / "body.vtu"))
    check_open(np.asarray(grid.points), np.asarray(grid["displacement"]), solution)
    assert grid.compute_cell_sizes()["Area"].sum() == pytest.approx(1)


def test_interrupted_vtk_leaves_the_old_file(solution, tmp_path, monkeypatch):
    (tmp_path / "body.vtu").write_text("before")

    def interrupted(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr("ngsxfem_contact.files.os.replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        plotting.save_vtk(solution, tmp_path / "body.vtu")
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("body.vtu", "before")]


def webgui_points(data):
    """Corners (M, 3, 3) and values (M, 3) of what webgui is told to draw."""
    arrays = [np.frombuffer(base64.b64decode(part), np.float32).reshape(-1, 4) for part in data["Bezier_trig_points"]]
    points = np.stack(arrays, axis=1).astype(float)
    return points[..., :3], points[..., 3]


def lips(solution, s, scale):
    """The points (n, 2) of the deformed plus and minus lip at arc lengths s."""
    points, undeformed = crack_points(solution.body, 0, s), np.column_stack([s, np.full(len(s), 0.013)])
    return [undeformed + scale * side(solution.u)(points) for side in (Plus, Minus)]


def covered(triangles, points):
    """Which points (n, 2) lie in one of the triangles (M, 3, 2) at least."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    sides = [split_mesh.cross(q - p, points[:, None] - p) for p, q in ((a, b), (b, c), (c, a))]
    return (np.min(sides, axis=0) >= 0).any(axis=1)


def test_draw_shows_the_crack_open(solution):
    """No triangle lies between the lips, every other place is covered; colours are the one-sided stresses."""
    pytest.importorskip("webgui_jupyter_widgets")
    data = plotting.draw(solution, scale=0.1).GetData()
    points, values = webgui_points(data)
    plus, minus = lips(solution, np.linspace(0.01, 0.45, 12), 0.1)
    drawn = points[..., :2]
    opposite = split_mesh.cross(drawn[:, 1] - drawn[:, 0], drawn[:, 2] - drawn[:, 0]) < 0
    drawn[opposite] = drawn[opposite, ::-1]
    across = (plus - minus) / np.linalg.norm(plus - minus, axis=1, keepdims=True)
    assert not covered(drawn, np.concatenate([(1 - t) * plus + t * minus for t in (0.1, 0.5, 0.9)])).any()
    assert covered(drawn, np.concatenate([plus + 0.01 * across, minus - 0.01 * across, [(0.7, 0.1)]])).all()
    exact = plotting.split_displacement(solution)[0].EvaluateInside(plotting.von_mises(MATERIAL, Strain(solution.u)))
    assert np.sort(values.ravel()) == pytest.approx(np.sort(exact.ravel()), rel=1e-4, abs=1e-6)
    assert (data["funcmin"], data["funcmax"]) == pytest.approx(np.quantile(exact, (0.02, 0.98)))


def test_draw_of_a_field_writes_a_page(solution, tmp_path):
    pytest.importorskip("webgui_jupyter_widgets")
    plotting.draw(solution, field=solution.u, filename=str(tmp_path / "u.html"))
    assert '"funcdim": 2' in (tmp_path / "u.html").read_text(encoding="utf-8")


def background(ax, x, y):
    """Which points of the plane are white in the picture of these axes."""
    figure = ax.figure
    figure.canvas.draw()
    image = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    columns, rows = ax.transData.transform(np.column_stack([x, y])).astype(int).T
    return (image[image.shape[0] - 1 - rows, columns] == 255).all(axis=1)


def test_picture_shows_the_opening(solution, pyplot):
    """The pixels themselves: white between the lips, none of it in the uncracked part."""
    ax = plotting.plot_body(solution, ax=pyplot.figure(figsize=(6, 6), dpi=150).gca(), scale=0.1)
    plus, minus = lips(solution, np.linspace(0.02, 0.3, 8), 0.1)
    assert background(ax, *np.concatenate([(1 - t) * plus + t * minus for t in (0.3, 0.5, 0.7)]).T).all()
    assert not background(ax, *np.concatenate([plus + (0, 0.05), minus - (0, 0.05)]).T).any()
    ahead = np.linspace(-0.1, 0.15, 200)
    assert not background(ax, 0 * ahead + 0.7, ahead).any()


@pytest.mark.parametrize("call, kind, message", [
    (lambda s: plotting.plot_body(s, field=s.stress), ValueError, r"plot_body: field, such as solution.stress\[1, 1\], has 4 component\(s\), it must be a scalar"),
    (lambda s: plotting.plot_body(s, field="s_xx"), TypeError, "plot_body: field, .*='s_xx' is neither a number nor a CoefficientFunction"),
    (lambda s: plotting.plot_body(s.u), TypeError, "plot_body: solution=.* is not a solution of ContactProblem.Solve"),
    (lambda s: plotting.plot_profile(s.body), TypeError, "plot_profile: solution=.* is not a solution"),
    (lambda s: plotting.plot_mesh(s.body), TypeError, "plot_mesh: V=CrackedMesh is not a CrackFESpace"),
])  # fmt: skip
def test_what_cannot_be_drawn(solution, call, kind, message):
    with pytest.raises(kind, match=message):
        call(solution)
