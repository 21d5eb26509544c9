"""Arguments that make no sense, NaN and infinity first: each is refused where it is given, and named."""

from math import inf, nan

import pytest
from ngsolve import CF, L2, GridFunction, Mesh, x, y

from ngsxfem_contact import Crack, CrackFESpace, CrackGrowth, Elasticity, TraceSpace
from ngsxfem_contact.algebra import FixedPoint, FullNewton
from ngsxfem_contact.contact import BarbosaHughes, BothSides, ContactProblem, Coulomb, InfSup, LoadCase, LoadSteps, Nitsche, Tresca
from ngsxfem_contact.fracture import GivenIncrement, InteractionIntegral, JumpExtrapolation, Paris
from ngsxfem_contact.plotting import plot_body, plot_profile
from ngsxfem_contact.spaces import Interpolant, Projection
from study.paper import BODY_FORCE, MATERIAL, paper_problem, unstructured_mesh

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = unstructured_mesh(0.2)
PROBLEM = paper_problem(MESH, pair="P1/P0")
SOLUTION = PROBLEM.Solve()
V, W = PROBLEM.V, PROBLEM.W


def rough(**options):
    problem = ContactProblem(V, W, MATERIAL, **options)
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    problem.f += BODY_FORCE * V.TestFunction() * problem.body.dx
    return problem


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: Elasticity(nan, 1), "Elasticity: lam=nan must be finite"),
        (lambda: Elasticity(lam=1, mu=inf), "Elasticity: mu=inf must be finite"),
        (lambda: Elasticity.PlaneStrain(nan, 0.3), r"Elasticity.PlaneStrain: E=nan must be positive and finite \(Young's modulus\)"),
        (lambda: Elasticity.PlaneStress(1, nan), "Elasticity.PlaneStress: nu=nan must lie between -1 and 1"),
        (lambda: Elasticity.ByRegion(MESH, {"(": MATERIAL}), r"'\(' is no regular expression"),
        (lambda: Tresca(nan), "Tresca: s=nan must be a finite number >= 0"),
        (lambda: Tresca(CF((1, 2))), r"Tresca: s has 2 component\(s\), it must be a scalar"),
        (lambda: rough(law=Tresca(CF(nan))).Solve(), "Tresca: s is nan at arc length 0.09.* finite and >= 0 on the whole crack"),
        (lambda: Coulomb(nan), "Coulomb: mu_f=nan must be a finite number >= 0"),
        (lambda: rough(law=Coulomb(CF(nan))).Solve(), "Coulomb: mu_f is nan at arc length"),
        (lambda: FixedPoint(tolerance=nan), "FixedPoint: tolerance=nan must be positive"),
        (lambda: FixedPoint(max_iterations=0), "FixedPoint: max_iterations=0 must be 1 or more"),
        (lambda: BarbosaHughes(gamma0=nan), "BarbosaHughes: gamma0=nan must be positive"),
        (lambda: BarbosaHughes(theta=nan), "BarbosaHughes: theta=nan must lie between 0 and 1"),
        (lambda: BothSides(0.1, weight=nan), "BothSides: weight=nan must be positive"),
        (lambda: BothSides(nan), "BothSides: gamma0=nan must be positive"),
        (lambda: Nitsche(theta=nan), "Nitsche: theta=nan is not one of"),
        (lambda: Nitsche(gamma0=nan), "Nitsche: gamma0=nan must be positive"),
        (lambda: Nitsche(coercivity=nan), "Nitsche: coercivity=nan must lie between 0 and 1"),
        (lambda: PROBLEM.Solve(max_iterations=0), "max_iterations=0 must be 1 or more"),
        (lambda: PROBLEM.Solve(start=[True]), "start has 1 entries, there are .* give one boolean for each"),
        (lambda: PROBLEM.Solve(cone="strong"), "cone='strong' is not one of"),
        (lambda: LoadSteps(PROBLEM).Solve(nan), "the factor of load case 0, t=nan must be finite"),
        (lambda: LoadSteps(PROBLEM, [LoadCase(PROBLEM)] * 2).Solve(1, inf), "the factor of load case 1, t=inf must be finite"),
        (lambda: LoadSteps(PROBLEM, []), "there is no load case; give LoadCase"),
        (lambda: SOLUTION.StressIntensity(radius=nan), "at the tip .* radius=nan must be positive"),
        (lambda: SOLUTION.EnergyReleaseRate(radius=nan), "at the tip .* radius=nan must be positive"),
        (lambda: SOLUTION.StressIntensity(tip=nan), "there is no tip nan; body.tips has 1, counted from 0"),
        (lambda: SOLUTION.StressIntensity(tip=0.5), "there is no tip 0.5"),
        (lambda: SOLUTION.StressIntensity(tip=-1), "there is no tip -1"),
        (lambda: JumpExtrapolation(points=1), "points=1 must be 2 or more"),
        (lambda: SOLUTION.Profile(n=0), "Profile: n=0 must be 2 or more"),
        (lambda: SOLUTION.Profile(crack=1), "there is no crack 1; body.cracks has 1, counted from 0"),
        (lambda: SOLUTION.ContactForce(crack=-1), "there is no crack -1"),
        (lambda: SOLUTION.Transitions(crack=-1), "there is no crack -1"),
        (lambda: SOLUTION.SlipTransitions(crack=7), "there is no crack 7"),
        (lambda: SOLUTION.Draw(scale=nan), "scale=nan must be finite"),
        (lambda: plot_body(SOLUTION, scale=inf), "scale=inf must be finite"),
        (lambda: plot_profile(SOLUTION, quantities=("opening",)), "'opening' is not one of .*'gap'"),
        (lambda: GivenIncrement(nan), "GivenIncrement: da=nan must be positive"),
        (lambda: Paris(nan, 2, 0.1), "Paris: C=nan must be positive"),
        (lambda: Paris(1, nan, 0.1), "Paris: m=nan must be positive"),
        (lambda: Paris(1, 2, 0.1, ratio=nan), "Paris: ratio=nan must be at least 0"),
        (lambda: CrackGrowth(paper_problem, V.body.cracks, GivenIncrement(0.1), toughness=nan), "toughness=nan must be a finite number >= 0"),
        (lambda: CrackGrowth(paper_problem, V.body.cracks, GivenIncrement(0.1)).Run(-1), "steps=-1 must be 0 or more"),
        (lambda: CrackGrowth(paper_problem, V.body.cracks, GivenIncrement(0.1)).Animate("a.gif"), r"no step to show; call Run\(steps\) first"),
        (lambda: Interpolant(V, CF((nan, 0))), "Interpolant: plus is not finite"),
        (lambda: Interpolant(V, CF((0, 0)), CF((0, nan))), "Interpolant: minus is not finite"),
        (lambda: Interpolant(V, CF(1)), r"Interpolant: plus has 1 component\(s\), it must have 2"),
        (lambda: Interpolant(V, CF((0, 0)), tips=[(1, 2, 3)]), r"tips\[0\]=\(1, 2, 3\) are not up to 2 finite numbers"),
        (lambda: Interpolant(V, CF((0, 0)), tips=[(1, nan)]), r"tips\[0\]=\(1, nan\) are not up to 2 finite numbers"),
        (lambda: Projection(V, CF((nan, 0))), "Projection: function is not finite"),
        (lambda: InfSup(V, W, weight=CF(nan)), "InfSup: weight must be positive and finite"),
        (lambda: InfSup(V, W, weight=CF(-1)), "InfSup: weight must be positive and finite"),
        (lambda: Crack.Spline([(0, 0), (nan, 1)]), r"Crack.Spline: point 1 is \(nan, 1.0\); coordinates must be finite"),
        (lambda: Crack.Spline("abc"), r"Crack.Spline: 'abc' are no points \(x, y\)"),
        (lambda: Crack.Curve(lambda t: (t, nan), 0, 1), "Crack.Curve: point 0 is .* finite"),
        (lambda: Crack.Curve(lambda t: (t, 0), 0, nan), "Crack.Curve: t1=nan must be finite and larger than t0=0"),
        (lambda: Crack.Curve(lambda t: (t, 0), 1, 1), "Crack.Curve: t1=1 must be finite and larger than t0=1"),
        (lambda: Crack.Curve(lambda t: (t, t * t), 0, 1, tolerance=nan), "Crack.Curve: tolerance=nan must be positive"),
        (lambda: Crack.LevelSet(MESH, CF(nan)), r"Crack.LevelSet: phi is nan at \(.*\); it must be finite in the body"),
        (lambda: Crack.LevelSet(MESH, y - 0.03, CF(nan)), "Crack.LevelSet: psi is nan at"),
        (lambda: Crack.LevelSet(MESH, y - 0.03, CF(1)), "psi is nowhere negative on phi = 0"),
        (lambda: Crack.LevelSet(MESH, CF((x, y))), r"Crack.LevelSet: phi has 2 component\(s\), it must be a scalar"),
        (lambda: Crack.LevelSet(MESH, y - 0.03, x - 0.5, tolerance=nan), "Crack.LevelSet: tolerance=nan must be positive"),
        (lambda: rough(gap=CF((1, 2))), r"ContactProblem: gap has 2 component\(s\), it must be a scalar"),
        (lambda: SOLUTION.SaveVTK(""), "is not the name of a file"),
    ],
)
def test_values(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: Elasticity("1", 1), "Elasticity: lam='1' is not a number"),
        (lambda: Elasticity(1j, 1), "Elasticity: lam=1j is not a number"),
        (lambda: Elasticity.PlaneStrain("1", 0.3), "E='1' is not a number"),
        (lambda: Elasticity.ByRegion(MESH, MATERIAL), "is not a dictionary"),
        (lambda: Elasticity.ByRegion({"x": MATERIAL}, MESH), "is not a Mesh of NGSolve"),
        (lambda: ContactProblem(V, V, MATERIAL), "ContactProblem: W=.* is not a TraceSpace"),
        (lambda: ContactProblem(W, V, MATERIAL), "ContactProblem: V=.* is not a CrackFESpace"),
        (lambda: ContactProblem(V, W, 1.0), "material=1.0 is not an Elasticity"),
        (lambda: rough(stabilisation=BarbosaHughes), "is neither an object such as BarbosaHughes"),
        (lambda: rough(law=Coulomb), "is neither a law such as Coulomb"),
        (lambda: rough(gap="wide"), "gap='wide' is not a number"),
        (lambda: Coulomb(0.3, method=FullNewton), "is neither FullNewton"),
        (lambda: PROBLEM.SetDirichlet((0, 0), None), "region=None is not the name of a boundary"),
        (lambda: PROBLEM.SetDirichlet("up", "top"), "SetDirichlet: value='up' is neither a number nor a CoefficientFunction"),
        (lambda: PROBLEM.Solve(max_iterations=nan), "max_iterations=nan is not a whole number"),
        (lambda: PROBLEM.Solve(previous=3), "previous=3 is not the ContactSolution"),
        (lambda: LoadSteps(PROBLEM, [3]), r"3 is not a LoadCase\(problem\)"),
        (lambda: LoadSteps(PROBLEM).Solve("half"), "t='half' is not a number"),
        (lambda: Nitsche(points=2.5), "points=2.5 is not a whole number"),
        (lambda: SOLUTION.StressIntensity(radius="wide"), "radius='wide' is not a number"),
        (lambda: SOLUTION.StressIntensity(method=3), "method=3 is neither one of"),
        (lambda: SOLUTION.StressIntensity(method=InteractionIntegral), "is neither one of .* nor an object such as InteractionIntegral"),
        (lambda: SOLUTION.Profile(n=nan), "n=nan is not a whole number"),
        (lambda: GivenIncrement("a"), "da='a' is not a number"),
        (lambda: CrackGrowth(3, V.body.cracks, GivenIncrement(0.1)), "make_problem=3 is not a function"),
        (lambda: CrackGrowth(paper_problem, [], GivenIncrement(0.1)), r"cracks=\[\] is not a list of one or more cracks"),
        (lambda: CrackGrowth(paper_problem, V.body.cracks[0], GivenIncrement(0.1)), "is not a list of one or more cracks"),
        (lambda: CrackGrowth(lambda cracks: None, V.body.cracks, GivenIncrement(0.1)).Run(1), "make_problem returned None; it must return a ContactProblem"),
        (lambda: Crack.Curve(5, 0, 1), "function=5 is not a function"),
        (lambda: Crack.LevelSet(y, MESH), "is not a Mesh of NGSolve"),
    ],
)
def test_types(call, message):
    with pytest.raises(TypeError, match=message):
        call()


def test_a_cone_by_its_name():
    """As in ContactProblem."""
    problem = paper_problem(MESH, pair="P1/P1", cone="weak")
    assert paper_problem(MESH, pair="P1/P1").Solve(cone="weak").ContactForce() == problem.Solve().ContactForce()


def test_numbers_of_numpy_are_numbers():
    import numpy as np

    assert Elasticity(np.float32(1), np.int64(1)).mu == 1
    assert len(SOLUTION.Profile(crack=np.int64(0), n=np.int32(5)).s) == 5


@pytest.mark.parametrize("name", ["missing/solution.vtu", "missing/other/solution"])
def test_a_folder_that_does_not_exist(name, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"cannot be written: there is no folder .*missing.*; create it first"):
        SOLUTION.SaveVTK(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_the_place_of_a_file(tmp_path):
    (tmp_path / "solution.vtu").mkdir()
    with pytest.raises(IsADirectoryError, match="solution.vtu cannot be written: it is a folder"):
        SOLUTION.SaveVTK(tmp_path / "solution")
    assert [path.name for path in tmp_path.iterdir()] == ["solution.vtu"]


def test_a_picture_that_fails_leaves_no_file(tmp_path, monkeypatch):
    def full(*args):
        raise OSError("no space left on device")

    monkeypatch.setattr("ngsolve.VTKOutput.Do", full)
    with pytest.raises(OSError, match="no space left"):
        SOLUTION.SaveVTK(tmp_path / "solution.vtu")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("load", [CF((nan, 0)), CF((0, inf))])
def test_loads(load):
    problem = rough()
    problem.f += load * V.TestFunction() * problem.body.dx
    with pytest.raises(ValueError, match=r"the load `f` is not finite \(NaN or inf\)"):
        problem.Solve()
    with pytest.raises(ValueError, match="^the load `f` is not finite"):
        LoadCase(problem)


def test_a_load_that_is_not_finite_in_one_element_only():
    load = GridFunction(L2(MESH, order=0))
    load.vec[:] = 0
    load.vec[MESH.ne - 1] = nan
    problem = rough()
    problem.f += load * V.TestFunction()[0] * problem.body.dx
    with pytest.raises(ValueError, match="the load `f` is not finite"):
        problem.Solve()


def test_a_refused_space_leaves_the_body_usable():
    body = PROBLEM.body
    with pytest.raises(TypeError):
        CrackFESpace(body, tip=3)
    assert CrackFESpace(body).ndof > 0 and TraceSpace(body).ndof > 0 and isinstance(body.mesh, Mesh)
