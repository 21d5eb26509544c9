"""Pictures and VTK files of bodies in space: the data that they show."""

import base64
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from ngsolve import CF, x, z

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, Jump, Minus, Plus, TraceSpace
from ngsxfem_contact.exact.pennies import penny_in_tension
from ngsxfem_contact.fracture.front_stress_intensity import FrontFactors
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.plotting import plot_body, plot_front, plot_mesh, plot_profile, solid_plots
from ngsxfem_contact.plotting.clipping import below, section
from ngsxfem_contact.plotting.solid_files import between_nodes
from ngsxfem_contact.plotting.solid_picture import SolidPicture
from ngsxfem_contact.points import mesh_points, reference_coordinates
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE, RADIUS = (0.49, 0.51, 0.513), 0.3
MESH = cube_mesh(0.13)


def solved(sheet, u, law=None, order=1, mesh=MESH):
    V = CrackFESpace(body := CrackedMesh(mesh, sheet), order=order, dirichlet="outer", material=MATERIAL)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet(u, "outer")
    return problem.Solve()


@pytest.fixture(scope="module")
def opened():
    """A penny under tension, order 2."""
    return solved(Sheet.Disk(CENTRE, (0, 0, 1), RADIUS), penny_in_tension(MATERIAL, RADIUS).At(CENTRE).u, order=2)


@pytest.fixture(scope="module")
def bent():
    """A penny that opens on one side, is closed on the other, and slips."""
    return solved(Sheet.Disk(CENTRE, (0, 0, 1), RADIUS), CF((0.04 * z, 0, -0.05 * z * (0.6 - x))), Coulomb(0.3))


@pytest.fixture(scope="module")
def mouth():
    return solved(Sheet.Polygon([(0.2, -1, 0.5), (0.8, -1, 0.5), (0.8, 0.4, 0.5), (0.2, 0.4, 0.5)]), CF((0, 0, 0.02 * z)))


def made_factors(body):
    """Of a front, as StressIntensity gives them."""
    s = np.linspace(0, 2 * np.pi * RADIUS, 9)[:-1]
    points = np.array([body.fronts[0].PointAt(float(si)) for si in s])
    K_I, K_II, K_III = 1 + 0.2 * np.cos(s / RADIUS), 0.1 * np.sin(s / RADIUS), 0.1 * np.cos(s / RADIUS)
    G = K_I**2 / MATERIAL.E_prime
    return FrontFactors(body, 0, s, points, K_I, K_II, K_III, G, G, 0.01 * np.ones((8, 3)), 0.01 * G, (0.1,), np.zeros((1, 8, 4)))


def read_vtu(path):
    """{part: {name: array}} of a file with arrays in base64."""
    types, found = {"Float64": np.float64, "Int32": np.int32, "UInt8": np.uint8}, {}
    piece = ElementTree.parse(path).getroot().find("UnstructuredGrid/Piece")
    for part in piece:
        arrays = {}
        for array in part:
            content = base64.b64decode(array.text)
            assert np.frombuffer(content, "<u4", 1)[0] == len(content) - 4
            data, width = np.frombuffer(content[4:], types[array.get("type")]), int(array.get("NumberOfComponents"))
            arrays[array.get("Name")] = data.reshape(-1, width) if width > 1 else data
        found[part.tag] = arrays
    assert len(found["Points"]["points"]) == int(piece.get("NumberOfPoints")) and len(found["Cells"]["types"]) == int(piece.get("NumberOfCells"))
    return found


def cells_of(grid):
    return np.split(grid["Cells"]["connectivity"], grid["Cells"]["offsets"][:-1])


def at_places(solution, elements, places, function):
    points = mesh_points(solution.body.mesh, elements, *reference_coordinates(solution.body.mesh, elements, places).T)
    return np.reshape(function(points), (len(places), -1))


def test_vtk_of_the_body(opened, tmp_path):
    """Quadratic tetrahedra that fill the cube; u at their points, the middles of their edges in VTK's order; stresses at their centres."""
    assert opened.SaveVTK(tmp_path / "body") == str(tmp_path / "body.vtu")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["body.vtu", "body_fronts.vtu", "body_sheets.vtu"]
    grid = read_vtu(tmp_path / "body.vtu")
    points, cells, u = grid["Points"]["points"], np.array(cells_of(grid)), grid["PointData"]["displacement"]
    corners = points[cells[:, :4]]
    assert set(grid["Cells"]["types"]) == {24} and np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6 == pytest.approx(1)
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))):
        assert np.allclose(points[cells[:, 4 + k]], 0.5 * (corners[:, i] + corners[:, j]), atol=1e-12)
    element = SolidPicture(opened).split.element
    away = (grid["CellData"]["side"] == 0) & ~np.isin(element, list(opened.body.FrontElements(0)))
    near = 1e-9 * corners.mean(axis=1) + (1 - 1e-9) * points[cells[:, 4]]
    assert np.allclose(at_places(opened, element[away], near[away], opened.u), u[cells[away, 4]], atol=1e-8)
    sides = grid["CellData"]["side"]
    assert set(sides) == {-1, 0, 1} and set(grid["CellData"]["region"]) == {0}
    centre = corners.mean(axis=1)
    for name, function in (("von_mises", opened.VonMises()), ("stress_zz", opened.stress[2, 2]), ("stress_xz", opened.stress[0, 2])):
        assert np.allclose(at_places(opened, element, centre, function).ravel(), grid["CellData"][name], atol=1e-10)
    above = sides != 0
    assert (np.sign(centre[above, 2] - CENTRE[2]) == sides[above]).all()
    places, number = np.unique(points[: cells[:, :4].max() + 1].round(12), axis=0, return_inverse=True)
    inside = np.linalg.norm(places - CENTRE, axis=1) < 0.8 * RADIUS
    doubled = np.flatnonzero((np.bincount(number) == 2) & inside)
    opening = [np.ptp(u[: len(number)][number == k][:, 2]) for k in doubled]
    assert len(doubled) > 20 and np.allclose(opening, np.abs(jump_at(opened, places[doubled])[:, 2]), atol=1e-9)


def jump_at(solution, places):
    """Of u at places (n, 3) on a sheet, in the elements in which NGSolve finds them."""
    return np.reshape(Jump(solution.u)(solution.body.mesh(*places.T)), (len(places), 3))


def test_vtk_of_linear_functions(bent, tmp_path):
    bent.SaveVTK(tmp_path / "linear.vtu")
    grid = read_vtu(tmp_path / "linear.vtu")
    assert set(grid["Cells"]["types"]) == {10}
    faces = np.sort(np.array(cells_of(grid))[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
    single, count = np.unique(faces, axis=0, return_counts=True)
    a, b, c = np.moveaxis(grid["Points"]["points"][single[count == 1]], 1, 0)
    assert count.max() == 2
    surface = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()  # the file is open along both lips, and nowhere else
    assert surface == pytest.approx(6 + 2 * np.pi * RADIUS**2, rel=1e-3)


def test_vtk_of_sheets(bent, tmp_path):
    """Polygons with the multiplier's values, forces that are those of the solution, and the displacement of both lips at their corners."""
    bent.SaveVTK(tmp_path / "bent")
    grid, profile = read_vtu(tmp_path / "bent_sheets.vtu"), bent.Profile()
    points, cells, of_cells, of_points = grid["Points"]["points"], cells_of(grid), grid["CellData"], grid["PointData"]
    area = np.array([0.5 * np.abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) for x, y in (points[cell][:, :2].T for cell in cells)])
    assert set(grid["Cells"]["types"]) == {7} and area.sum() == pytest.approx(np.pi * RADIUS**2, rel=2e-3) and np.allclose(points[:, 2], CENTRE[2], atol=1e-9)
    assert (of_cells["pressure"] * area).sum() == pytest.approx(-bent.ContactForce(), rel=5e-3)
    assert np.allclose(area @ of_cells["traction"], bent.TangentialForce(), atol=5e-3 * np.abs(bent.TangentialForce()).max())
    assert np.allclose(of_points["jump"], of_points["displacement_plus"] - of_points["displacement_minus"], atol=1e-14)
    assert {(p > 0, s > 0) for p, s in zip(of_cells["pressure"], of_cells["state"])} == {(True, True), (False, False)}
    assert np.isclose(np.sort(np.unique(of_cells["gap"])), np.sort(np.unique(profile.gap))).all()
    mean = np.array([of_points["jump"][cell].mean(axis=0) for cell in cells])
    assert np.abs(mean[:, :2] - of_cells["slip"][:, :2])[area > 1e-3].max() < 0.25 * np.abs(of_cells["slip"]).max()
    assert (of_cells["slip"] * of_cells["traction"]).sum(axis=1)[of_cells["state"] > 0].min() > 0  # friction opposes the slip of the minus side


def test_vtk_of_fronts(opened, tmp_path):
    """Lines along the circle; K between nodes; nothing known is NaN."""
    factors = made_factors(opened.body)
    opened.SaveVTK(tmp_path / "with", [factors])
    opened.SaveVTK(tmp_path / "without")
    grid = read_vtu(tmp_path / "with_fronts.vtu")
    points, data = grid["Points"]["points"], grid["PointData"]
    assert set(grid["Cells"]["types"]) == {3} and np.allclose(np.linalg.norm(points - CENTRE, axis=1), RADIUS)
    cells = np.array(cells_of(grid))
    assert np.linalg.norm(np.diff(points[cells], axis=1), axis=2).sum() == pytest.approx(2 * np.pi * RADIUS, rel=1e-3)
    for name in ("K_I", "K_II", "K_III", "G", "K_I_error"):
        at_nodes = [data[name][np.argmin(np.abs(data["s"] - s))] for s in factors.s]
        assert np.allclose(at_nodes, factors.columns[name], rtol=1e-9, atol=1e-12)
    assert set(read_vtu(tmp_path / "without_fronts.vtu")["PointData"]) == {"s"}
    assert set(grid["CellData"]["front"]) == {0} == set(grid["CellData"]["sheet"])
    with pytest.raises(ValueError, match="two of front 0"):
        opened.SaveVTK(tmp_path / "twice", [factors, factors])


def test_vtk_beyond_nodes_is_unknown():
    """Open fronts have nodes where tubes have room only."""
    front = type("Front", (), {"closed": False, "length": 1.0})()
    factors = type("Factors", (), {"s": np.array([0.2, 0.8]), "columns": {"K_I": np.array([1.0, 2.0])}})()
    values = between_nodes(front, factors, "K_I", np.array([0.0, 0.2, 0.5, 0.9]))
    assert np.allclose(values[1:3], [1, 1.5]) and np.isnan(values[[0, 3]]).all() and np.isnan(between_nodes(front, None, "K_I", values)).all()


def test_vtk_appears_whole_or_not_at_all(bent, opened, tmp_path, monkeypatch):
    factors = made_factors(opened.body)
    with pytest.raises(ValueError, match="FrontFactors of another body"):
        bent.SaveVTK(tmp_path / "bent", [factors])
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        bent.SaveVTK(tmp_path / "nowhere" / "bent")
    (tmp_path / "bent_fronts.vtu").mkdir()
    with pytest.raises(IsADirectoryError):
        bent.SaveVTK(tmp_path / "bent")
    assert [p.name for p in tmp_path.iterdir()] == ["bent_fronts.vtu"]


def test_vtk_opens_in_pyvista(bent, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    bent.SaveVTK(tmp_path / "bent")
    assert pyvista.read(tmp_path / "bent.vtu").volume == pytest.approx(1)


def webgui_triangles(data):
    """Corners (M, 3, 3) and values (M, 3) of what webgui is told to draw on the surface, order 1."""
    arrays = [np.frombuffer(base64.b64decode(part), np.float32).reshape(-1, 4) for part in data["Bezier_trig_points"]]
    points = np.stack(arrays, axis=1).astype(float)
    return points[..., :3], points[..., 3]


def test_draw_shows_both_lips(bent):
    """The triangles of webgui: the surface of the cube and both lips, displaced by the limits of u, with one-sided values."""
    pytest.importorskip("webgui_jupyter_widgets")
    scale, field = 0.5, bent.stress[0, 2]
    data = bent.Draw(field=field, scale=scale).GetData()
    points, values = webgui_triangles(data)
    split = SolidPicture(bent).split
    assert len(points) == len(split.boundary[0]) and data["draw_vol"]
    u = split.Evaluate(Plus(bent.u), Minus(bent.u), bent.u)
    moved = (split.points + scale * u)[split.lips]
    drawn = {tuple(row) for row in np.sort(points, axis=1).reshape(-1, 9).round(5)}
    assert {tuple(row) for row in np.sort(moved.astype(np.float32), axis=1).astype(float).reshape(-1, 9).round(5)} <= drawn
    inside = split.EvaluateInside(field)[..., 0]
    faces = np.concatenate([split.outside, split.lip_faces])
    of_faces = np.array([np.delete(inside[face // 4], face % 4) for face in faces])
    assert np.allclose(np.sort(values.ravel()), np.sort(of_faces.ravel()), atol=1e-5)
    volume = np.linalg.det((corners := split.points[split.tets])[:, 1:] - corners[:, :1])
    within = (inside > data["funcmin"]) & (inside < data["funcmax"])
    assert ((within.mean(axis=1) * volume ** (2 / 3)).sum() / (volume ** (2 / 3)).sum()) == pytest.approx(0.96, abs=0.005)


def test_draw_opens_what_cannot_be_seen(bent, mouth, tmp_path):
    """A clipping plane through sheets inside, none where there is a mouth; another one, or none, on demand; files."""
    pytest.importorskip("webgui_jupyter_widgets")
    data = bent.Draw().GetData()
    assert data["clipping"] and data["clipping_z"] == 0 and np.allclose(data["mesh_center"], CENTRE, atol=0.02)
    assert "clipping" not in mouth.Draw().GetData() and "clipping" not in bent.Draw(clipping=False).GetData()
    assert bent.Draw(clipping={"vec": (0, 0, 1), "pnt": (0, 0, 0)}).GetData()["clipping_z"] == 1
    mouth.Draw(field=mouth.u, filename=str(tmp_path / "u.html"))
    assert '"funcdim": 3' in (tmp_path / "u.html").read_text(encoding="utf-8")


def test_the_view_of_webgui():
    """Its angles turn the direction of the viewer to the third axis, and z up."""
    for elevation, azimuth in ((22, -32), (60, 100), (-40, 170)):
        a, b, c = np.radians(solid_plots.euler_angles(elevation, azimuth))
        about = lambda angle, i, j: (
            np.array([[np.cos(angle) if k == m and k in (i, j) else float(k == m) for m in range(3)] for k in range(3)])
            + np.array([[-np.sin(angle) if (k, m) == (i, j) else np.sin(angle) if (k, m) == (j, i) else 0 for m in range(3)] for k in range(3)])
        )
        turn = about(a, 1, 2) @ about(b, 2, 0) @ about(c, 0, 1)
        assert np.allclose(turn @ solid_plots.direction(elevation, azimuth), (0, 0, 1)) and (turn @ [0, 0, 1])[1] > 0 and abs((turn @ [0, 0, 1])[0]) < 1e-12


@pytest.mark.parametrize("height", (0.31, 0.5, 2.0))
def test_a_plane_cuts_bodies(bent, height):
    """The volume below a plane, by the divergence theorem over what is shown of the body; x itself is interpolated exactly."""
    split = SolidPicture(bent).split
    d = solid_plots.heights(split, (np.array([0, 0, height]), np.array([0.6, 0.0, 0.8])))
    rows, weights = section(d[split.tets])
    cut = weights @ split.points[split.tets[rows]]
    assert np.allclose((cut - [0, 0, height]) @ [0.6, 0.0, 0.8], 0, atol=1e-12)
    area = lambda t: 0.5 * np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=1).sum()
    chord = max(0.0, min(1.0, height / 0.75) - max(0.0, (height - 1) / 0.75))
    assert area(cut) == pytest.approx(1.25 * chord, abs=1e-10)
    surface = split.boundary[0]
    rows, weights = below(d[surface])
    shown = weights @ split.points[surface[rows]]
    normal = np.cross(shown[:, 1] - shown[:, 0], shown[:, 2] - shown[:, 0])
    volume = np.einsum("ij,ij->", shown.mean(axis=1), normal) / 6 + area(cut) * 0.8 * height / 3
    exact = np.trapezoid(np.clip(height - 0.75 * np.linspace(0, 1, 4001), 0, 1), dx=1 / 4000)
    assert volume == pytest.approx(exact, abs=1e-6)


def test_body_is_drawn_open(mouth, pyplot):
    """The lines of both lips in the section, as far apart as the jump says."""
    opened = solved(Sheet.Disk(CENTRE, (0, 0, 1), RADIUS), penny_in_tension(MATERIAL, RADIUS).At(CENTRE).u, mesh=cube_mesh(0.1))
    ax = plot_body(opened, scale=5)
    lines = {line.get_label(): np.concatenate(line._segments3d) for line in ax.collections[1:]}
    plus, minus = lines["plus lip"], lines["minus lip"]
    along = np.linspace(CENTRE[0] - 0.95 * RADIUS, CENTRE[0] + 0.95 * RADIUS, 200)
    y = solid_plots.usual_cut(SolidPicture(opened).split)[0][1]
    exact = jump_at(opened, np.column_stack([along, 0 * along + y, 0 * along + CENTRE[2]]))[:, 2]
    assert y == pytest.approx(CENTRE[1], abs=1e-3) and exact.max() > 0.2 and "× 5" in ax.get_title()
    assert plus[:, 2].max() - minus[:, 2].min() == pytest.approx(5 * exact.max(), rel=0.05)
    assert [a.get_ylabel() for a in ax.figure.axes if a is not ax] == ["von Mises stress"]
    whole = plot_body(mouth, field=mouth.stress[2, 2], label="σ_zz")
    assert np.ptp(whole.get_xlim()) > 0.99 and np.ptp(whole.get_ylim()) > 0.99
    half = plot_body(mouth, cut=((0.5, 0, 0), (1, 0, 0)))
    assert whole.get_xlim()[1] == pytest.approx(1, abs=0.05) and half.get_xlim()[1] == pytest.approx(0.5, abs=0.05)
    for wrong in ("x", ((0, 0, 0), (0, 0, 0)), ((0, 0), (1, 0))):
        with pytest.raises(ValueError, match="is no \\(point, normal\\)"):
            plot_body(mouth, cut=wrong)
    with pytest.raises(ValueError, match="must be a scalar"):
        plot_body(mouth, field=mouth.u)


def test_profile_is_drawn_on_the_sheet(bent, pyplot):
    """Polygons with the values of the table, places in x and y, the edge of contact."""
    axes = plot_profile(bent, quantities=("pressure", "gap", "slip", "shear"))
    profile = bent.Profile()
    for axis, column in zip(axes, (-profile.sigma_n, profile.gap, profile.slip, profile.sigma_t)):
        polygons = axis.collections[0]
        assert set(np.round(polygons.get_array(), 12)) == set(np.round(column, 12))
        corners = np.concatenate([path.vertices for path in polygons.get_paths()])
        assert np.allclose(corners.max(axis=0), np.add(CENTRE[:2], RADIUS), atol=0.01) and (axis.get_xlabel(), axis.get_ylabel()) == ("x", "y")
        assert axis.get_aspect() == 1
        edge = [line for line in axis.collections if line.get_label() == "edge of contact"]
        assert len(edge[0].get_paths()) == len(bent.Transitions())
    with pytest.raises(ValueError, match="'opening' is not one of"):
        plot_profile(bent, quantities=("opening",))


def test_cells_of_the_sheet_are_drawn(mouth, pyplot):
    V = mouth.problem.V
    ax = plot_mesh(V)
    drawn = sum(len(part.get_paths()) for part in ax.collections) / 2
    cells = V.body.Elements(0)
    assert drawn >= len(cells) and [text.get_text() for text in ax.get_legend().get_texts()] == ["Heaviside function", "front inside", "ahead of the front"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x", "y")


def test_k_is_drawn_along_the_front(opened, pyplot):
    factors = made_factors(opened.body)
    left, right = plot_front(factors)
    line = right.lines[0].get_xydata()
    assert np.allclose(line[:-1, 1], factors.K_I) and np.allclose(line[-1], (factors.s[0] + 2 * np.pi * RADIUS, factors.K_I[0]))
    front = left.collections[1]
    assert front.get_array().min() >= factors.K_I.min() and front.get_array().max() <= factors.K_I.max()
    assert re.search(r"K_\{\\mathrm\{I\}\}", left.child_axes[0].get_ylabel()) and plot_front(factors, quantity="G")
    with pytest.raises(ValueError, match="quantity='K' is not one of"):
        plot_front(factors, quantity="K")
