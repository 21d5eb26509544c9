"""The material that is said once, and the warnings where the mesh is too coarse for a crack."""

import warnings
from functools import cache

import numpy as np
import pytest
from helpers import rectangle
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.errors import AccuracyWarning

STEEL, WOOD = Elasticity.PlaneStrain(E=2, nu=0.3), Elasticity.PlaneStrain(E=1, nu=0.2)


@cache
def square(maxh=0.1):
    return rectangle(maxh, (-1, -1), (1, 1))


def body_of(*cracks, mesh=None):
    return CrackedMesh(mesh or square(), *(Crack(points) for points in cracks))


EDGE = [(-1, 0.01), (0, 0.01)]


def silent(make):
    """make() without an AccuracyWarning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", AccuracyWarning)
        return make()


# The material


def test_the_material_is_said_once():
    """Modes of it at the tip, and the problem takes it: K as with the longer form, to the last digit."""
    body, K = body_of(EDGE), []
    for V in (silent(lambda: CrackFESpace(body, order=1, material=STEEL)), CrackFESpace(body, order=1, tip=TipEnrichment(material=STEEL))):
        problem = ContactProblem(V, TraceSpace(body)) if V.material else ContactProblem(V, TraceSpace(body), STEEL)
        assert problem.material is STEEL and V.tip_specs[0].kappa == STEEL.kappa
        v = V.TestFunction()
        problem.f += CF((0, 1)) * v * body.ds("top") - CF((0, 1)) * v * body.ds("bottom")
        problem.Pin((1, -1), "xy")
        problem.Pin((1, 1), "x")
        K.append(tuple(problem.Solve().StressIntensity()))
    assert K[0] == pytest.approx(K[1], rel=1e-12)


def test_options_of_a_tip_keep_the_material_of_the_space():
    V = silent(lambda: CrackFESpace(body_of(EDGE), tip=TipEnrichment(r1=0.5), material=STEEL))
    assert (V.tip_specs[0].r1, V.tip_specs[0].mu) == (0.5, STEEL.mu) and len(V.TipDofs(0)) == 2
    assert len(CrackFESpace(body_of(EDGE), tip=TipEnrichment(functions="branch"), material=STEEL).TipDofs(0)) == 8


def test_two_materials_are_refused():
    body = body_of(EDGE)
    V = CrackFESpace(body, material=STEEL)
    assert ContactProblem(V, TraceSpace(body), STEEL).material == STEEL
    with pytest.raises(ValueError, match="is another one than .*say it once"):
        ContactProblem(V, TraceSpace(body), WOOD)
    with pytest.raises(TypeError, match="there is no material; give CrackFESpace"):
        ContactProblem(CrackFESpace(body, tip=None), TraceSpace(body))
    with pytest.raises(TypeError, match="material=2 is not an Elasticity"):
        CrackFESpace(body, material=2)


def test_regions_are_one_material_however_often_they_are_written():
    body, write = body_of(EDGE), lambda m: Elasticity.ByRegion(square(), {".*": m})
    V = CrackFESpace(body, material=write(STEEL))
    assert ContactProblem(V, TraceSpace(body), write(STEEL)).material.regions == [STEEL]
    with pytest.raises(ValueError, match="another one"):
        ContactProblem(V, TraceSpace(body), write(WOOD))


def test_tips_without_a_material_warn():
    """By default and where only the disk is chosen; not where (8) are asked for, where there are no tips or no functions at them."""
    body = body_of(EDGE)
    for make in (lambda: CrackFESpace(body), lambda: CrackFESpace(body, tip=TipEnrichment(r1=0.5))):
        with pytest.warns(AccuracyWarning, match=r"no material is given, so the tips at \(0, 0.01\).*material=") as said:
            make()
        assert len(said) == 1 and said[0].filename == __file__
    silent(lambda: CrackFESpace(body, tip=TipEnrichment(functions="branch")))
    silent(lambda: CrackFESpace(body, tip=None))
    silent(lambda: CrackFESpace(body_of([(-1, 0.01), (1, 0.01)])))


def closed_arc(tip, maxh=0.08):
    """K at a tip of a closed arc, K_I = 0."""
    body = CrackedMesh(square(maxh), Crack.Arc((-0.4, 0), (0, 0.15), (0.4, 0)))
    V = CrackFESpace(body, order=2, tip=tip)
    problem, v = ContactProblem(V, TraceSpace(body), STEEL), V.TestFunction()
    problem.Pin((-1, -1), "xy")
    problem.Pin((1, -1), "y")
    for side, traction in {"top": (0.8, -1), "bottom": (-0.8, 1), "right": (-1, 0.8), "left": (1, -0.8)}.items():
        problem.f += CF(traction) * v * body.ds(side)
    return problem.Solve().StressIntensity(0)


def test_a_problem_decides_the_modes_of_tips_without_a_material():
    """The default is as good as TipEnrichment(material=...): the same numbers. The functions (8), turned with the crack, have K_I = 0.08 K_II, 0.2 with fixed axes."""
    with pytest.warns(AccuracyWarning, match="no material"):
        default = closed_arc(TipEnrichment())
    given = closed_arc(TipEnrichment(material=STEEL))
    assert tuple(default) == pytest.approx(tuple(given), rel=1e-9) and default.modes == pytest.approx(given.modes, rel=1e-9)
    assert abs(default.K_I) < 0.03 * abs(default.K_II) and abs(default.K_I) < default.error
    branch = closed_arc(TipEnrichment(functions="branch"))
    assert abs(branch.K_I) < min(0.1 * abs(branch.K_II), branch.error)


def test_the_first_problem_decides():
    body = body_of(EDGE)
    with pytest.warns(AccuracyWarning):
        V = CrackFESpace(body)
    assert len(V.TipDofs(0)) == 2
    ContactProblem(V, TraceSpace(body), WOOD)
    assert (V.tip_specs[0].kappa, V.tip_specs[0].mu) == (WOOD.kappa, WOOD.mu)
    with pytest.raises(ValueError, match="modes of V belong to another material"):
        ContactProblem(V, TraceSpace(body), STEEL)


# Coarse meshes


@pytest.mark.parametrize("length, warns", [(0.06, True), (0.25, True), (0.7, False)])
def test_short_cracks(length, warns):
    make = lambda: CrackFESpace(body_of([(0.013, 0.02), (0.013 + length, 0.02)]), order=2, tip=None)
    if warns:
        with pytest.warns(AccuracyWarning, match=f"crack 0 at .* is {length} long, .* elements: .*refine to h <= {length / 4:.2g} there") as said:
            make()
        assert len(said) == 1
    else:
        silent(make)


NEXT_TO = {
    "another tip": ([[(-0.5, 0.01), (0, 0.01)], [(0.16, 0.01), (0.5, 0.01)]], r"half the way to the tip at"),
    "another crack": ([[(-0.5, 0.01), (0, 0.01)], [(0.05, -0.5), (0.05, 0.5)]], "crack 1, at 0.05"),
    "the boundary": ([[(0.2, 0.01), (0.95, 0.01)]], "the boundary of the body, at 0.05"),
    "a kink": ([[(-0.5, 0.01), (0, 0.01), (0.06, 0.05)]], "another piece of the same crack"),
}


@pytest.mark.parametrize("name", NEXT_TO)
@pytest.mark.parametrize("tip", [TipEnrichment(material=STEEL), None], ids=["modes", "none"])
def test_tips_without_room(name, tip):
    cracks, what = NEXT_TO[name]
    with pytest.warns(AccuracyWarning, match=f"the tip at .*{what}.*elements of room.*refine to h <= "):
        CrackFESpace(body_of(*cracks), order=1, tip=tip)


def test_a_disk_that_is_chosen_too_small():
    with pytest.warns(AccuracyWarning, match="r1 = 0.05 leaves it 0.4.* choose r1 >= 0\\.[12]"):
        CrackFESpace(body_of(EDGE), tip=TipEnrichment(r1=0.05, material=STEEL))
    silent(lambda: CrackFESpace(body_of(EDGE), tip=TipEnrichment(r1=0.3, material=STEEL)))


def test_a_disk_that_an_interface_cuts_small():
    geometry = SplineGeometry()
    geometry.AddRectangle((-1, -1), (1, 1))
    geometry.AddRectangle((0.06, -0.5), (0.6, 0.5), leftdomain=2, rightdomain=1)
    geometry.SetMaterial(1, "outer")
    geometry.SetMaterial(2, "inner")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.1))
    body, material = body_of(EDGE, mesh=mesh), Elasticity.ByRegion(mesh, {"outer": STEEL, "inner": WOOD})
    with pytest.warns(AccuracyWarning, match="another material"):
        CrackFESpace(body, material=material)
    with pytest.warns(AccuracyWarning, match="no material"):
        V = CrackFESpace(body)
    with pytest.raises(ValueError, match="the disk r1 = .* reaches another material.*give CrackFESpace"):
        ContactProblem(V, TraceSpace(body), material)


# Small kinks, which the tip's functions follow


def pulled_K(points):
    body = body_of(points)
    V = CrackFESpace(body, order=2, material=STEEL)
    problem, v = ContactProblem(V, TraceSpace(body)), V.TestFunction()
    problem.f += CF((0, 1)) * v * body.ds("top") - CF((0, 1)) * v * body.ds("bottom")
    problem.Pin((1, -1), "xy")
    problem.Pin((1, 1), "x")
    return np.array(tuple(problem.Solve().StressIntensity()))


@pytest.mark.parametrize("length", [0.02, 0.1])
@pytest.mark.parametrize("degrees", [0.05, 2, -4])
def test_a_short_last_piece_that_hardly_turns(length, degrees):
    """K of the crack in one piece, but for what the turn itself makes: K_I changes by cos³ of half of it, less than 0.4 %."""
    turn = np.radians(degrees)
    kinked = [*EDGE[:1], (-length, 0.01), (-length + length * np.cos(turn), 0.01 + length * np.sin(turn))]
    straight, bent = silent(lambda: pulled_K(EDGE)), silent(lambda: pulled_K(kinked))
    assert bent[0] == pytest.approx(straight[0], rel=0.005) and abs(bent[1] - straight[1]) < 0.6 * abs(turn) * straight[0] + 1e-3
