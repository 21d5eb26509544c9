"""What a part's file describes is what the same problem by the API is."""

import shutil
from math import pi
from pathlib import Path

import numpy as np
import pytest
from helpers import rectangle
from netgen.geom2d import SplineGeometry
from netgen.occ import OCCGeometry, WorkPlane
from ngsolve import CF, Integrate, Mesh, dx, specialcf, x, y

from ngsxfem_contact._ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.algebra import FixedPoint, FullNewton
from ngsxfem_contact.contact import BartonBandis, Coulomb, Dugdale, ExponentialCohesive, Joint, LinearCohesive, MohrCoulomb, Tresca
from ngsxfem_contact.contact.load_steps import LoadSteps
from ngsxfem_contact.contact.nitsche import Nitsche
from ngsxfem_contact.contact.problem import ContactProblem
from ngsxfem_contact.contact.stabilisation import BarbosaHughes, BothSides
from ngsxfem_contact.job.body import crack_of
from ngsxfem_contact.job.conditions import law_of, laws_of, stabilisation_of
from ngsxfem_contact.job.gmsh import read_gmsh
from ngsxfem_contact.job.part import EXAMPLE, read_part
from ngsxfem_contact.job.results import numbers_of, summary, write_profiles
from ngsxfem_contact.job.table import RefusedPart, Table
from ngsxfem_contact.material import Elasticity
from ngsxfem_contact.operators import Jump
from ngsxfem_contact.spaces.crack_fespace import CrackFESpace, TipEnrichment
from ngsxfem_contact.spaces.trace_space import TraceSpace
from study.paper import MATERIAL, paper_problem, unstructured_mesh

GMSH = Path(__file__).parents[1] / "data" / "gmsh"
pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


def part_of(folder, text, **options):
    (folder / "part.toml").write_text(text, encoding="utf-8")
    return read_part(folder / "part.toml", **options)


def same(solution, other):
    """Displacements and multipliers to round-off."""
    for a, b in ((solution.u.vec.FV().NumPy(), other.u.vec.FV().NumPy()), (solution.Multipliers(), other.Multipliers())):
        assert np.abs(b).max() > 0
        assert np.abs(a - b).max() <= 1e-10 * np.abs(b).max()


def test_the_paper():
    (solution,) = read_part(EXAMPLE).Solve()
    other = paper_problem(unstructured_mesh(0.03), tip=TipEnrichment(material=MATERIAL)).Solve()
    same(solution, other)
    assert solution.Energy() == pytest.approx(other.Energy(), rel=1e-12)
    assert tuple(solution.StressIntensity()) == pytest.approx(tuple(other.StressIntensity()), rel=1e-9)


LAYERED = """
[mesh]
file = "{file}"

[[material]]
region = "matrix"
E = 30
nu = 0.2
form = "plane strain"

[[material]]
region = "layer"
E = 60
nu = 0.25
form = "plane stress"
alpha = 0.001

[[crack]]
polyline = [[0, 0.41], [0.4, 0.43]]
"""

FRICTION = """
[displacement]
order = 2

[[law]]
name = "Coulomb"
mu_f = "0.2 + 0.2*x"

[[load]]
traction = [-0.02, -0.1]
boundary = "top"

[[load]]
face_pressure = 0.04

[[support]]
boundary = "bottom"
x = 0
y = 0
"""


def layered(file):
    """(mesh, material, body) of LAYERED."""
    mesh = Mesh(read_gmsh(file))
    material = Elasticity.ByRegion(mesh, {"matrix": Elasticity.PlaneStrain(30, 0.2), "layer": Elasticity.PlaneStress(60, 0.25, alpha=0.001)})
    return mesh, material, CrackedMesh(mesh, Crack([(0, 0.41), (0.4, 0.43)]))


@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_two_regions_of_gmsh_friction_and_pressure_on_the_faces(tmp_path, version):
    file = GMSH / f"layered-{version}.msh"
    (solution,) = part_of(tmp_path, LAYERED.format(file=file) + FRICTION).Solve()
    friction = FRICTION.replace("[[law]]\nname", "[friction]\nlaw")  # the same
    assert part_of(tmp_path, LAYERED.format(file=file) + friction).problem.law.mu_f is not None
    _, material, body = layered(file)
    V = CrackFESpace(body, order=2, material=material, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body), law=Coulomb(0.2 + 0.2 * x))
    problem.f += CF((-0.02, -0.1)) * V.TestFunction() * body.ds("top")
    problem.FacePressure(0.04)
    other = problem.Solve()
    same(solution, other)
    assert other.ContactForce() < -0.01 and abs(other.TangentialForce()) > 1e-3  # λ and λ_t have something to say


EVERYTHING = """
[contact]
cone = "weak"
gap = "0.0001*(1 + x)"

[stabilisation]
method = "BarbosaHughes"
theta = 0.4

[initial]
stress = [["-0.02 - 0.01*y", 0.005], [0.005, -0.1]]
temperature = "0.1*x"

[[load]]
body_force = ["0.1*y", -0.05]
region = "layer"
bonus_intorder = 2

[[load]]
body_force = [0.01, 0]

[[load]]
pressure = "0.1*x*x"
boundary = "top"

[[load]]
point_force = [0, -0.02]
at = [0.7, 0.9]

[[load]]
face_traction = {plus = [0.003, 0], minus = [-0.003, "0.001*x"]}
crack = 0

[[support]]
boundary = "default"
x = "0.001*y"

[[support]]
boundary = "bottom"
y = 0

[[support]]
springs = [0, "2 + y"]
boundary = "right side"

[[support]]
foundation = [0.3, 0]
region = "matrix"

[[support]]
joint = 0.5
crack = 0

[[support]]
pin = [1, 1]
x = 0.002
"""


def test_every_load_and_support(tmp_path):
    file = GMSH / "layered-4.1.msh"
    (solution,) = part_of(tmp_path, LAYERED.format(file=file) + EVERYTHING).Solve()
    mesh, material, body = layered(file)
    V = CrackFESpace(body, material=material, dirichletx="default", dirichlety="bottom")
    stress = CF((-0.02 - 0.01 * y, 0.005, 0.005, -0.1), dims=(2, 2))
    options = {"cone": "weak", "gap": 0.0001 * (1 + x), "initial_stress": stress, "temperature": 0.1 * x}
    problem = ContactProblem(V, TraceSpace(body), stabilisation=BarbosaHughes(theta=0.4), **options)
    (u, v), n = V.TnT(), specialcf.normal(2)
    problem.f += CF((0.1 * y, -0.05)) * v * body.dx("layer", bonus_intorder=2) + CF((0.01, 0)) * v * body.dx - 0.1 * x * x * n * v * body.ds("top")
    problem.f += (-0.02 * v[1])(0.7, 0.9)
    problem.FaceTraction(plus=(0.003, 0), minus=(-0.003, 0.001 * x), crack=0)
    problem.SetDirichlet((0.001 * y, None), "default")
    problem.a += (2 + y) * u[1] * v[1] * body.ds("right side") + 0.3 * u[0] * v[0] * body.dx(mesh.Materials("matrix")) + 0.5 * Jump(u) * Jump(v) * body.dcrack
    problem.Pin((1, 1), "x", 0.002)
    other = problem.Solve()
    same(solution, other)
    assert other.ContactForce() < 0


def test_what_is_left_out_has_the_defaults_of_the_package(tmp_path):
    part = part_of(tmp_path, SQUARE.format(crack="polyline = [[0, 0.51], [0.5, 0.51]]"))
    V, W = CrackFESpace(part.problem.body, material=Elasticity(1, 1), dirichlet="bottom"), TraceSpace(part.problem.body)
    other = ContactProblem(V, W)
    assert (part.title, part.factors, part.inverse) == ("part", None, None)
    assert (part.problem.V.ndof, part.problem.V.order, part.problem.W.order) == (V.ndof, V.order, W.order)
    assert (part.problem.stabilisation, part.problem.law, part.problem.cone) == (other.stabilisation, other.law, other.cone)
    assert [spec.r1 for spec in part.problem.V.tip_specs] == [spec.r1 for spec in V.tip_specs]


SQUARE = """
mesh.rectangle = [[0, 0], [1, 1]]
mesh.maxh = 0.2

[[material]]
lam = 1
mu = 1

[[crack]]
{crack}

[[support]]
boundary = "bottom"
x = 0
y = 0
"""


def square(maxh):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=maxh))


@pytest.mark.parametrize("values, crack", [
    ({"polyline": [[0, 0.5], [0.3, 0.6], [0.5, 0.5]]}, Crack([(0, 0.5), (0.3, 0.6), (0.5, 0.5)])),
    ({"arc": [[0.2, 0.5], [0.4, 0.6], [0.6, 0.5]]}, Crack.Arc((0.2, 0.5), (0.4, 0.6), (0.6, 0.5))),
    ({"spline": [[0.2, 0.5], [0.4, 0.6], [0.6, 0.5], [0.7, 0.4]], "ends": "natural"}, Crack.Spline([(0.2, 0.5), (0.4, 0.6), (0.6, 0.5), (0.7, 0.4)], "natural")),
    ({"curve": ["0.5 + 0.2*cos(t)", "0.4 + 0.3*sin(t)"], "t": [0, 2], "tolerance": 1e-5},
     Crack.Curve(lambda t: (0.5 + 0.2 * np.cos(t), 0.4 + 0.3 * np.sin(t)), 0, 2, 1e-5)),
    ({"level_set": "x**2 + y**2 - 0.5", "psi": "x - 0.6"}, Crack.LevelSet(square(0.2), x**2 + y**2 - 0.5, x - 0.6)),
    ({"join": [{"polyline": [[0.1, 0.5], [0.2, 0.5]]}, {"arc": [[0.2, 0.5], [0.4, 0.6], [0.6, 0.5]]}]},
     Crack.Join(Crack([(0.1, 0.5), (0.2, 0.5)]), Crack.Arc((0.2, 0.5), (0.4, 0.6), (0.6, 0.5)))),
])  # fmt: skip
def test_shapes(values, crack):
    found = crack_of(Table(values, "[[crack]] 1", Path("part.toml")), square(0.2))
    assert found.length == pytest.approx(crack.length, rel=1e-12)
    for s in np.linspace(0, crack.length, 7):
        assert found.PointAt(s) == pytest.approx(crack.PointAt(s), abs=1e-12)


def table(values):
    return Table(values, "[table]", Path("part.toml"))


def test_stabilisations():
    made = lambda **values: stabilisation_of(table(values))
    assert made(method="none") is None
    assert made(method="BarbosaHughes", gamma0=0.1) == BarbosaHughes(0.1)
    assert made(method="BothSides", gamma0=0.1, weight=0.5) == BothSides(0.1, 0.5)
    assert made(method="Nitsche", theta=-1, gamma0=0.1, coercivity=0.4, points=3) == Nitsche(-1, 0.1, 0.4, 3)


def test_laws_of_the_faces():
    made = lambda **values: law_of(table(values))
    assert made(name="Coulomb", mu_f=0.3) == Coulomb(0.3, FullNewton())
    assert made(name="Coulomb", mu_f=0.3, method={"name": "FixedPoint", "tolerance": 1e-9}) == Coulomb(0.3, FixedPoint(1e-9))
    assert made(name="Tresca", s=0.1, in_contact_only=True) == Tresca(0.1, True)
    mesh = square(0.5)
    assert made(name="Tresca", s="0.1*x").s(mesh(0.4, 0.5)) == pytest.approx(0.04)
    assert made(name="MohrCoulomb", mu_f=0.3, cohesion=1, k_n=float("inf")) == MohrCoulomb(0.3, 1)
    assert made(name="BartonBandis", k_n0=4, v_m=0.1, mu_f=0.2) == BartonBandis(4, 0.1, 0.2)
    assert made(name="Joint", k_n=3, k_t=2, crack=1) == Joint(3, 2)
    assert made(name="LinearCohesive", strength=1, G_c=2) == LinearCohesive(1, 2)
    assert made(name="ExponentialCohesive", strength=1, G_c=2, beta=0.5) == ExponentialCohesive(1, 2, 0.5)
    assert made(name="Dugdale", strength=1) == Dugdale(1)


def test_laws_by_crack():
    """One for all, one for some, and what is left."""
    joint, rough = {"name": "Joint", "k_n": 3, "k_t": 2}, {"name": "Coulomb", "mu_f": 0.3}
    body = CrackedMesh(rectangle(0.5), *(Crack([(0, y), (1, y)], name) for y, name in ((0.3, ""), (0.5, "fault"), (0.8, ""))))
    made = lambda *tables: laws_of([table(values) for values in tables], body)
    assert made() is None and made(rough) == Coulomb(0.3)
    assert made(rough | {"crack": 1}) == {1: Coulomb(0.3)} == made(rough | {"crack": "fault"})
    assert made(joint, rough | {"crack": 1}) == {0: Joint(3, 2), 1: Coulomb(0.3), 2: Joint(3, 2)}
    for twice in ((joint, rough), (joint | {"crack": 1}, rough | {"crack": 1}), (joint | {"crack": 1}, rough | {"crack": "fault"})):
        with pytest.raises(RefusedPart, match="crack: another table gives the law of"):
            made(*twice)


def test_names_of_cracks(tmp_path):
    """In laws, loads and joints; the results call the crack so."""
    text = """
[mesh]
rectangle = [[0, 0], [1, 1]]
maxh = 0.2
[[material]]
E = 100
nu = 0.3
form = "plane strain"
[[crack]]
arc = [[0, 0.7], [0.5, 0.75], [1, 0.7]]
[[crack]]
polyline = [[0, 0.3], [1, 0.3]]
name = "fault"
[[law]]
name = "Joint"
k_n = 3
k_t = 2
[[law]]
name = "Coulomb"
mu_f = 0.3
crack = KEY
[[load]]
face_pressure = 0.1
crack = KEY
[[support]]
joint = 2
crack = KEY
[[support]]
boundary = "bottom|top"
x = 0
y = 0
"""
    named, numbered = (part_of(tmp_path, text.replace("KEY", key)) for key in ('"fault"', "1"))
    (one,), (other,) = named.Solve(), numbered.Solve()
    same(one, other)
    write_profiles(tmp_path / "profile.csv", named, [one])
    assert {line.split(",")[1] for line in (tmp_path / "profile.csv").read_text().splitlines()[1:]} == {"0", "fault"}
    numbers = numbers_of(named, [one])
    assert [crack["name"] for crack in numbers["steps"][0]["cracks"]] == ["", "fault"] and "contact force ∫λ, fault" in summary(numbers, [one])
    with pytest.raises(RefusedPart, match="no crack is named 'valt'; there is 'fault'"):
        part_of(tmp_path, text.replace("KEY", '"valt"'))
    with pytest.raises(RefusedPart, match="must be the number of a crack, or its name in quotes"):
        part_of(tmp_path, text.replace("KEY", "1.5"))


SPACES = """
[displacement]
order = 1
bubble = true
tip = {r0 = 0.01, r1 = 0.3, cutoff = "cubic", tolerance = 1e-4}

[multiplier]
order = 0
"""


def test_spaces(tmp_path):
    crack = "polyline = [[0, 0.51], [0.5, 0.51]]"
    part = part_of(tmp_path, SQUARE.format(crack=crack) + SPACES)
    body = part.problem.body
    tip = TipEnrichment(r0=0.01, r1=0.3, cutoff="cubic", tolerance=1e-4)
    V = CrackFESpace(body, order=1, bubble=True, material=Elasticity(1, 1), tip=tip, dirichlet="bottom")
    assert (part.problem.V.ndof, part.problem.W.ndof) == (V.ndof, TraceSpace(body, order=0).ndof)
    (spec,), (other,) = part.problem.V.tip_specs, V.tip_specs
    assert all(getattr(spec, name) == getattr(other, name) for name in ("r0", "r1", "cutoff", "kappa", "mu", "basis"))
    assert part_of(tmp_path, SQUARE.format(crack=crack) + "[displacement]\ntip = false\n").problem.V.tip_specs == [None]
    branch = part_of(tmp_path, SQUARE.format(crack=crack) + '[displacement]\ntip = {functions = "branch"}\n').problem.V
    assert len(branch.TipDofs(0)) == 8


def test_a_mesh_with_curved_elements(tmp_path):
    OCCGeometry(WorkPlane().Circle(1).Face(), dim=2).GenerateMesh(maxh=0.5).Save(str(tmp_path / "disk.vol"))
    text = SQUARE.format(crack="polyline = [[-0.5, 0.02], [0.5, 0.02]]")
    text = text.replace("mesh.rectangle = [[0, 0], [1, 1]]\nmesh.maxh = 0.2", 'mesh.file = "disk.vol"\nmesh.curve = 3').replace(
        'boundary = "bottom"', 'boundary = ".*"'
    )
    part = part_of(tmp_path, text)  # the file is looked for beside the part
    assert Integrate(CF(1) * dx, part.problem.V.mesh) == pytest.approx(pi, rel=1e-3)


STEPS = """
[[load]]
traction = ["0.1*(0.6 - x)", "0.2*(x - 0.3)"]
boundary = "top"

[[law]]
name = "Coulomb"
mu_f = 0.3

[solve]
factors = [0.5, -1, 1]
inverse = "sparsecholesky"
"""


def test_load_steps(tmp_path):
    """Each begins where the last one ended: the same as LoadSteps of the same problem."""
    part = part_of(tmp_path, SQUARE.format(crack="polyline = [[0, 0.51], [0.5, 0.51]]") + STEPS, maxh=0.1)
    steps = LoadSteps(part.problem)
    for solution, factor in zip(part.Solve(), (0.5, -1, 1), strict=True):
        same(solution, steps.Solve(factor))
    assert part.problem.V.mesh.ne == square(0.1).ne


def test_a_name_of_two_boundaries_holds_both(tmp_path):
    text = (
        SQUARE.format(crack="polyline = [[0, 0.51], [0.5, 0.51]]").replace('boundary = "bottom"', 'boundary = "bottom|top"')
        + '[[support]]\nboundary = "r.*"\nx = 0\n'
    )
    V = part_of(tmp_path, text).problem.V
    other = CrackFESpace(V.body, material=Elasticity(1, 1), dirichlet="bottom|top", dirichletx="right")
    assert list(V.FreeDofs()) == list(other.FreeDofs())


ZERO = """
[[load]]
{load}

[[load]]
traction = [0, -0.1]
boundary = "top"

[[support]]
{support}
"""


@pytest.mark.parametrize("load", ["face_pressure = 0", "face_traction = {plus = [0, 0]}", "point_force = [0, 0]\nat = [0.5, 0.9]", "body_force = [0, 0]"])
@pytest.mark.parametrize("support", ["joint = 0", 'springs = [0, 0]\nboundary = "top"'])
def test_what_is_zero_is_as_if_it_were_not_there(tmp_path, load, support):
    text = SQUARE.format(crack="polyline = [[0, 0.51], [0.5, 0.51]]")
    (solution,) = part_of(tmp_path, text + ZERO.format(load=load, support=support)).Solve()
    (other,) = part_of(tmp_path, text + '[[load]]\ntraction = [0, -0.1]\nboundary = "top"\n').Solve()
    same(solution, other)


def test_a_file_of_an_editor_that_marks_its_encoding(tmp_path):
    text = SQUARE.format(crack="polyline = [[0, 0.51], [0.5, 0.51]]")
    (tmp_path / "part.toml").write_text('title = "σ"\n' + text, encoding="utf-8-sig")
    assert read_part(tmp_path / "part.toml").title == "σ"


def test_a_compressed_mesh(tmp_path):
    square(0.2).ngmesh.Save(str(tmp_path / "square.vol.gz"))
    text = SQUARE.format(crack="polyline = [[0, 0.51], [0.5, 0.51]]").replace("rectangle = [[0, 0], [1, 1]]\nmaxh = 0.2", 'file = "square.vol.gz"')
    assert part_of(tmp_path, text).problem.V.mesh.ne == square(0.2).ne


def test_a_mesh_of_gmsh_whose_name_is_in_capitals(tmp_path):
    shutil.copy(GMSH / "layered-4.1.msh", tmp_path / "LAYERED.MSH")
    assert part_of(tmp_path, LAYERED.format(file="LAYERED.MSH") + FRICTION).problem.V.mesh.GetMaterials() == ("matrix", "layer")
