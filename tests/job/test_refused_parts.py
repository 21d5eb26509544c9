"""What a part's file cannot mean is refused: the message names the file, the table, the key, and what is allowed."""

import gzip
import re
from pathlib import Path

import pytest

from ngsxfem_contact.job.part import read_part
from ngsxfem_contact.job.table import RefusedPart

DATA = Path(__file__).parents[1] / "data"
pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")

GOOD = """
[mesh]
rectangle = [[0, 0], [1, 1]]
maxh = 0.25

[[material]]
E = 10
nu = 0.3
form = "plane strain"

[[crack]]
polyline = [[0, 0.52], [0.5, 0.52]]

[[load]]
traction = [0, -1]
boundary = "top"

[[support]]
boundary = "bottom"
x = 0
y = 0
"""


def refusal(folder, text, **options):
    (folder / "part.toml").write_text(text, encoding="utf-8")
    with pytest.raises(RefusedPart) as refused:
        read_part(folder / "part.toml", **options).Solve()
    message = str(refused.value)
    assert message.startswith(str(folder / "part.toml"))
    return message.removeprefix(str(folder / "part.toml"))


def test_the_good_one_is_good(tmp_path):
    (tmp_path / "part.toml").write_text(GOOD, encoding="utf-8")
    assert read_part(tmp_path / "part.toml").Solve()[0].report.converged


REPLACED = [
    # tables and keys
    ("[mesh]", "[mesh", "is no TOML file: .* line 2"),
    ("[mesh]", "[grid]", ": the file, grid: there is no such key; allowed are title, mesh"),
    ("[[crack]]", "[[cracks]]", ": the file, cracks: there is no such key, did you mean 'crack'\\?; allowed are title, mesh, .*output"),
    ("[[crack]]", "[crack]", ": the file, crack: .* must be a list of tables: write the header in double brackets"),
    ("[mesh]", "[[mesh]]", ": the file, mesh: .* must be a table"),
    ("[[crack]]\npolyline = [[0, 0.52], [0.5, 0.52]]", "", ": the file, crack: the key is missing; the table must have mesh, material, crack"),
    ("[[crack]]\npolyline = [[0, 0.52], [0.5, 0.52]]", "[crack]", "must be a list of tables"),
    ("\n[mesh]", "title = 3\n[mesh]", ": the file, title: 3 must be a text in quotes"),
    # the mesh
    ("maxh = 0.25", "", r": \[mesh\], maxh: the key is missing; the table must have rectangle, maxh"),
    ("maxh = 0.25", "maxh = '0.25'", r": \[mesh\], maxh: '0.25' must be a finite number"),
    ("maxh = 0.25", "maxh = true", r": \[mesh\], maxh: True must be a finite number"),
    ("maxh = 0.25", "maxh = nan", r": \[mesh\], maxh: nan must be a finite number"),
    ("maxh = 0.25", "maxh = 0", r": \[mesh\], maxh: 0 must be positive, and at least 0.001"),
    ("maxh = 0.25", "maxh = 1e-7", r": \[mesh\], maxh: 1e-07 must be positive, and at least 0.001"),
    ("maxh = 0.25", "maxh = 0.2\ncurve = 2", r": \[mesh\], curve: there is no such key; allowed are rectangle, maxh"),
    ("maxh = 0.25", "h = 0.25", r": \[mesh\], h: there is no such key.*; allowed are rectangle, maxh"),
    ("maxh = 0.25", "file = 'a.vol'", r": \[mesh\]: it has file and rectangle of file, rectangle; give exactly one of them"),
    ("rectangle = [[0, 0], [1, 1]]", "", r": \[mesh\]: it has none of file, rectangle; give exactly one"),
    ("[[0, 0], [1, 1]]", "[[0, 0], [1, 0]]", r": \[mesh\], rectangle: .* must be the lower left and the upper right corner"),
    ("[[0, 0], [1, 1]]", "[[0, 0], [1]]", r": \[mesh\], rectangle: .* must be two corners"),
    # materials
    ("E = 10", "", r": \[\[material\]\] 1: it has none of E, lam; give exactly one of them"),
    ("E = 10", "E = 10\nlam = 1", r": \[\[material\]\] 1: it has E and lam of E, lam"),
    ("E = 10", "lam = 1", r": \[\[material\]\] 1, nu: there is no such key; allowed are region, lam, mu, form, alpha"),
    ("nu = 0.3", "", r": \[\[material\]\] 1, nu: the key is missing; the table must have E, nu, form"),
    ("form = \"plane strain\"", "", r": \[\[material\]\] 1, form: the key is missing"),
    ("plane strain", "plane", r": \[\[material\]\] 1, form: 'plane' must be one of 'plane strain', 'plane stress'"),
    ("nu = 0.3", "nu = 0.6", r": \[\[material\]\] 1: Elasticity.PlaneStrain: nu=0.6 must lie between -1 and 0.5"),
    ("E = 10", "E = 10\nregion = 'steel'", r": \[\[material\]\] 1: Elasticity.ByRegion: region '.*' of the mesh is matched by no name"),
    ("[[crack]]", "[[material]]\nlam = 1\nmu = 1\n[[crack]]", r": \[\[material\]\] 1, region: the key is missing; each of several"),
    ("[[material]]", "[[material]]\nregion = 'a'\nlam = 1\nmu = 1\n[[material]]\nregion = 'a'", r": \[\[material\]\] 2, region: 'a' has a material already"),
    # cracks
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "", r": \[\[crack\]\] 1: it has none of polyline, arc, spline, curve, level_set, join"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "polyline = [[0, 0.5]]", r": \[\[crack\]\] 1, polyline: .* must be a list of two or more points"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "polyline = [[0, 0.5], [0, 0.5]]", r": \[\[crack\]\] 1: "),
    ("polyline =", "ends = 'natural'\npolyline =", r": \[\[crack\]\] 1, ends: there is no such key; allowed are polyline"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "arc = [[0, 0], [1, 1]]", r": \[\[crack\]\] 1, arc: .* must be three points"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "spline = [[0, 0.5], [1, 0.5]]\nends = 'free'", r": \[\[crack\]\] 1: Crack.Spline: ends='free' is not one of"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "curve = ['t', 't']", r": \[\[crack\]\] 1, t: the key is missing; the table must have curve, t"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "curve = ['t', 'x']\nt = [0, 1]", r": \[\[crack\]\] 1: 'x' is no formula: there is no 'x'; allowed are .*pi, t and sqrt"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "level_set = 'x - z'", r": \[\[crack\]\] 1, level_set: 'x - z' is no formula: there is no 'z'; allowed are numbers.*pi, x, y"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "level_set = 'x - 5'", r": \[\[crack\]\] 1: Crack.LevelSet: phi has one sign"),
    ("polyline = [[0, 0.52], [0.5, 0.52]]", "join = [{polyline = [[0, 0.5], [0.2, 0.5]]}, {arcs = 1}]", r": \[\[crack\]\] 1, join 2: it has none of polyline"),
    ("[[load]]", "[[crack]]\npolyline = [[0.1, 0.52], [0.3, 0.52]]\n[[load]]", r": \[\[crack\]\]: CrackedMesh: cracks 0 and 1 coincide near"),
    # spaces
    ("[[load]]", "[displacement]\norder = 1.5\n[[load]]", r": \[displacement\], order: 1.5 must be a whole number"),
    ("[[load]]", "[displacement]\norder = 0\n[[load]]", r": \[displacement\]: CrackFESpace: order=0 must be 1 or more"),
    ("[[load]]", "[displacement]\ntip = true\n[[load]]", r": \[displacement\], tip: True must be false, or a table"),
    ("[[load]]", "[displacement]\ntip = {r = 1}\n[[load]]", r": \[displacement\], tip, r: there is no such key.*; allowed are r0, r1"),
    ("[[load]]", "[displacement]\ntip = {r1 = 2}\n[[load]]", r": \[displacement\]: "),
    ("[[load]]", "[multiplier]\nbasis = 'modal'\n[[load]]", r": \[multiplier\]: TraceSpace: basis='modal' is not 'nodal' or 'trace'"),
    # contact
    ("[[load]]", "[contact]\ncone = 'strong'\n[[load]]", r": \[contact\], cone: 'strong' must be one of 'nonpositive', 'weak'"),
    ("[[load]]", "[contact]\ngap = -1\n[[load]]", r": \[contact\], \[initial\], \[\[law\]\]: ContactProblem: gap=-1 must be a finite number >= 0"),
    ("[[load]]", "[stabilisation]\n[[load]]", r": \[stabilisation\], method: the key is missing; it is one of BarbosaHughes, BothSides, Nitsche, none"),
    ("[[load]]", "[stabilisation]\nmethod = 'Nitsch'\n[[load]]", r": \[stabilisation\], method: 'Nitsch' must be one of"),
    ("[[load]]", "[stabilisation]\nmethod = 'none'\ntheta = 1\n[[load]]", r": \[stabilisation\], theta: there is no such key; allowed are method"),
    ("[[load]]", "[stabilisation]\nmethod = 'Nitsche'\ntheta = 2\n[[load]]", r": \[stabilisation\]: Nitsche: theta=2 is not one of -1, 0, 1"),
    ("[[load]]", "[[law]]\nmu_f = 0.3\n[[load]]", r": \[\[law\]\] 1, name: the key is missing; it is one of Coulomb, Tresca"),
    ("[[load]]", "[[law]]\nname = 'Coulomb'\n[[load]]", r": \[\[law\]\] 1: .*missing.*mu_f"),
    ("[[load]]", "[[law]]\nname = 'Coulomb'\nmu_f = -0.3\n[[load]]", r": \[\[law\]\] 1: Coulomb: mu_f=-0.3 must be a finite number >= 0"),
    ("[[load]]", "[[law]]\nname = 'Coulomb'\nmu_f = 'x - 1'\n[[load]]", r": \[solve\]: Coulomb: mu_f is -.* at arc length"),
    ("[[load]]", "[[law]]\nname = 'Coulomb'\nmu_f = 0.3\nmethod = 'FixedPoint'\n[[load]]", r": \[\[law\]\] 1, method: 'FixedPoint' must be a table"),
    ("[[load]]", "[[law]]\nname = 'Coulomb'\nmu_f = 0.3\nmethod = {name = 'Newton'}\n[[load]]", r": \[\[law\]\] 1, method, name: 'Newton' must be one of"),
    ("[[load]]", "[initial]\nstress = [1, 2]\n[[load]]", r": \[initial\], stress: \[1, 2\] must be a matrix"),
    ("[[load]]", "[initial]\nstress = [[1, 2], [0, 1]]\n[[load]]", r": \[contact\], \[initial\], \[\[law\]\]: ContactProblem: initial_stress is not symmetric"),
    ("[[load]]", "[initial]\ntemperature = 40\n[[load]]", r"ContactProblem: temperature= needs a material that expands"),
    # loads
    ("boundary = \"top\"", "", r": \[\[load\]\] 1, boundary: the key is missing; the table must have traction, boundary"),
    ("boundary = \"top\"", "boundary = 'roof'", r": \[\[load\]\] 1, boundary: 'roof' matches no boundary; the mesh has bottom, left, right, top"),
    ("boundary = \"top\"", "boundary = 'top'\nbonus_order = 2", r": \[\[load\]\] 1, bonus_order: there is no such key, did you mean 'bonus_intorder'\?"),
    ("traction = [0, -1]", "", r": \[\[load\]\] 1: it has none of body_force, traction, pressure"),
    ("traction = [0, -1]", "traction = 1", r": \[\[load\]\] 1, traction: 1 must be two numbers or formulas"),
    ("traction = [0, -1]", "traction = [0, 'import os']", r": \[\[load\]\] 1, traction: 'import os' is no formula"),
    ("traction = [0, -1]", "pressure = 1\ntraction = [0, 1]", r": \[\[load\]\] 1: it has traction and pressure of"),
    ("traction = [0, -1]\nboundary = \"top\"", "body_force = [0, 1]\nregion = 'steel'", r": \[\[load\]\] 1, region: 'steel' matches no region; the mesh has "),
    ("traction = [0, -1]\nboundary = \"top\"", "point_force = [0, 1]", r": \[\[load\]\] 1, at: the key is missing"),
    ("traction = [0, -1]\nboundary = \"top\"", "point_force = [0, 1]\nat = [3, 3]", r": \[\[load\]\] 1, at: \[3, 3\] is not in the body"),
    ("traction = [0, -1]\nboundary = \"top\"", "face_pressure = 1\ncrack = 1", r": \[\[load\]\] 1: there is no crack 1; body.cracks has 1, counted from 0"),
    ("traction = [0, -1]\nboundary = \"top\"", "face_traction = [1, 0]", r": \[\[load\]\] 1, face_traction: \[1, 0\] must be a table"),
    ("traction = [0, -1]\nboundary = \"top\"", "face_traction = {}", r": \[\[load\]\] 1, face_traction: it has neither plus nor minus"),
    ("traction = [0, -1]\nboundary = \"top\"", "face_traction = {left = [1, 0]}", r": \[\[load\]\] 1, face_traction, left: there is no such key; allowed are plus, minus"),
    # supports
    ("x = 0\ny = 0", "", r": \[\[support\]\] 1: it holds nothing; give x, y or both"),
    ("x = 0\ny = 0", "z = 0", r": \[\[support\]\] 1, z: there is no such key; allowed are boundary, x, y"),
    ("x = 0\ny = 0", "x = [0, 0]", r": \[\[support\]\] 1, x: \[0, 0\] must be a finite number, or a formula in x and y in quotes"),
    ("boundary = \"bottom\"", "boundary = 'floor'", r": \[\[support\]\] 1, boundary: 'floor' matches no boundary"),
    ("boundary = \"bottom\"", "", r": \[\[support\]\] 1: it has none of boundary, pin, springs, foundation, joint"),
    ("boundary = \"bottom\"", "pin = [0.5, 0.123]", r": \[\[support\]\] 1: Pin: there is no mesh vertex at \(0.5, 0.123\)"),
    ("boundary = \"bottom\"\nx = 0\ny = 0", "pin = [0, 0]", r": \[\[support\]\] 1: it holds nothing"),
    ("boundary = \"bottom\"\nx = 0\ny = 0", "springs = [1, 1]", r": \[\[support\]\] 1, boundary: the key is missing; the table must have springs, boundary"),
    ("boundary = \"bottom\"\nx = 0\ny = 0", "foundation = 1", r": \[\[support\]\] 1, foundation: 1 must be two numbers or formulas"),
    ("boundary = \"bottom\"\nx = 0\ny = 0", "joint = 1\ncrack = 2", r": \[\[support\]\] 1: there is no crack 2"),
    ("[[support]]", "[[support]]\nboundary = 'left|bottom'\nx = 0\n[[support]]", r": \[\[support\]\] 2, boundary: 'bottom' is held by \[\[support\]\] 1 already"),
    ("[[support]]", "[[support]]\nboundary = 'right'\nx = 1\n[[support]]", r": \[solve\]: the given displacements contradict each other"),
    # solve, output, reference
    ("[[load]]", "[solve]\nfactors = []\n[[load]]", r": \[solve\], factors: \[\] must be a list of numbers"),
    ("[[load]]", "[solve]\ninverse = 'lu'\n[[load]]", r": \[solve\]: "),
    ("[[load]]", "[output]\npoints = 1\n[[load]]", r": \[output\], points: 1 must lie between 2 and 1000000"),
    ("[[load]]", "[output]\nvtk = 'no'\n[[load]]", r": \[output\], vtk: 'no' must be true or false"),
    ("[[load]]", "[reference]\nK = [1, 2]\n[[load]]", r": \[reference\], K: \[1, 2\] must be a list of lists of numbers"),
    ("[[load]]", "[reference]\nK = [[1, 2], [3, 4]]\n[[load]]", r": \[reference\], K: it has 2 entries, one for each of the tips, of which there are 1"),
    ("[[load]]", "[reference]\ncontact_force = [1, 2]\n[[load]]", r": \[reference\], contact_force: it has 2 entries, one for each of the cracks"),
    ("[[load]]", "[reference]\nforce = 1\n[[load]]", r": \[reference\], force: there is no such key; allowed are from, energy"),
]  # fmt: skip


@pytest.mark.parametrize("old, new, why", REPLACED, ids=lambda text: text[:40])
def test_refusals(tmp_path, old, new, why):
    assert old in GOOD
    message = refusal(tmp_path, GOOD.replace(old, new, 1))
    assert re.search(why, message), message


@pytest.mark.parametrize("name, text, why", [
    ("body.vol", None, r"\[mesh\], file: there is no file .*body.vol"),
    ("body.stl", "", r"\[mesh\], file: 'body.stl' must be a mesh of Netgen, .vol or .vol.gz, or of gmsh, .msh"),
    ("body.vol", "no mesh", r"\[mesh\], file: .*body.vol is no mesh of Netgen, or not a whole one"),
    ("body.vol", (DATA / "u0.088.vol").read_text()[:3000], r"\[mesh\], file: .*body.vol is no mesh of Netgen, or not a whole one"),
    ("body.vol.gz", "not zipped", r"\[mesh\], file: "),
    ("body.msh", "$MeshFormat\n4.1 1 8\n$EndMeshFormat", r"\[mesh\], file: .*body.msh has gmsh's format 4.1, binary"),
])  # fmt: skip
def test_meshes_that_cannot_be_read(tmp_path, name, text, why):
    if text is not None:
        (tmp_path / name).write_text(text)
    assert re.search(why, refusal(tmp_path, GOOD.replace("rectangle = [[0, 0], [1, 1]]\nmaxh = 0.25", f'file = "{name}"')))


@pytest.mark.parametrize("more, why", [
    ("maxh = 0.1", r"\[mesh\], maxh: there is no such key; allowed are file, curve"),
    ("curve = 0", r"\[mesh\], curve: 0 must lie between 1 and 10"),
    ("curve = 2", r"\[mesh\], curve: no element of the boundary is curved by it"),
])  # fmt: skip
def test_what_a_mesh_that_is_read_cannot_have(tmp_path, more, why):
    file = f'file = "{DATA / "u0.088.vol"}"\n{more}'
    assert re.search(why, refusal(tmp_path, GOOD.replace("rectangle = [[0, 0], [1, 1]]\nmaxh = 0.25", file)))


@pytest.mark.parametrize("damage", [lambda data: data[: len(data) // 2], lambda data: data[:200] + bytes(100) + data[300:]])
def test_damaged_compressed_meshes(tmp_path, damage):
    (tmp_path / "body.vol.gz").write_bytes(damage(gzip.compress((DATA / "u0.088.vol").read_bytes())))
    message = refusal(tmp_path, GOOD.replace("rectangle = [[0, 0], [1, 1]]\nmaxh = 0.25", 'file = "body.vol.gz"'))
    assert re.search(r"\[mesh\], file: .*body.vol.gz is no whole file", message)


def test_another_size_for_a_mesh_that_is_read(tmp_path):
    text = GOOD.replace("rectangle = [[0, 0], [1, 1]]\nmaxh = 0.25", f'file = "{DATA / "u0.088.vol"}"')
    assert re.search(r"\[mesh\]: another size is asked for, but the mesh is read from a file", refusal(tmp_path, text, maxh=0.1))


def test_a_file_that_is_no_text(tmp_path):
    (tmp_path / "part.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(RefusedPart, match="part.toml is no TOML file"):
        read_part(tmp_path / "part.toml")
