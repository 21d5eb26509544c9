"""What holds a body: given components, rollers and planes of symmetry, data that contradict each other."""

import numpy as np
import pytest
from helpers import array, rectangle, structured
from netgen.meshing import Element1D, Element2D, FaceDescriptor, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, CF, GridFunction, IfPos, Integrate, Mesh, Parameter, VectorH1, sqrt, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.contact import BarbosaHughes, ContactProblem, Coulomb, LoadCase, LoadSteps, Nitsche
from ngsxfem_contact.errors import SingularSystem

NU = 0.25
MATERIAL = Elasticity.PlaneStrain(E=2, nu=NU)
MESH = rectangle(0.25)
EDGE_CRACK = Crack([(0, 0.52), (0.55, 0.48)])


def problem(crack=EDGE_CRACK, order=1, mesh=MESH, tip=None, **options):
    body = CrackedMesh(mesh, crack)
    held = {name: options.pop(name) for name in ("dirichlet", "dirichletx", "dirichlety") if name in options}
    V = CrackFESpace(body, order=order, tip=tip, **held)
    return ContactProblem(V, TraceSpace(body, order=order - 1), MATERIAL, **options)


def load(p, value, where=None):
    p.f += CF(value) * p.V.TestFunction() * (p.body.ds(where) if where else p.body.dx)
    return p


# Components


@pytest.mark.parametrize("held", [dict(dirichlet="bottom|top"), dict(dirichlety="bottom|top"), dict(dirichlety=["bottom", "top"])])
@pytest.mark.parametrize("value", [(None, -0.02), [None, CF(-0.02)]])
def test_smooth_plates_leave_the_other_component_free(held, value):
    """A block with a closed crack that widens between two plates: σ_yy = -E e/(1 - ν²), u_x = ν/(1 - ν) e x."""
    p = problem(Crack([(0, 0.5), (0.55, 0.5)]), **held)
    p.SetDirichlet(value, "top")
    p.SetDirichlet((None, 0), "bottom")
    p.Pin((0, 0), "x")
    solution, e = p.Solve(), 0.02
    error = solution.u - CF((NU / (1 - NU) * e * x, -e * y))
    assert sqrt(Integrate(error * error * p.body.dx, MESH)) < 1e-10 * e
    assert solution.Profile().sigma_n == pytest.approx(-2 * e / (1 - NU**2), rel=1e-9)


def test_a_component_that_is_free_can_be_given_again():
    p = problem(dirichlet="bottom|right")
    first = np.array(p.free)
    p.SetDirichlet((None, 0.1), "right")
    assert np.count_nonzero(p.free) > np.count_nonzero(first) and np.abs(array(p.given.vec)).max() == pytest.approx(0.1)
    p.SetDirichlet((0, 0), "right")
    assert (np.array(p.free) == first).all() and not array(p.given.vec).any()


def test_a_corner_stays_held_by_the_other_side():
    p = problem(dirichlet="bottom|right")
    p.SetDirichlet((None, 0), "right")
    p.SetDirichlet((0.1, 0), "bottom")
    assert load(p, (0.3, 0.1)).Solve().u(MESH(1, 0)) == pytest.approx((0.1, 0), abs=1e-12)


@pytest.mark.parametrize(
    ("held", "value"), [(dict(dirichletx="top"), (0, 0)), (dict(dirichletx="top"), (None, 0)), (dict(dirichlety="top"), (0.1, None)), ({}, (0, None))]
)
def test_a_component_is_given_where_it_is_held(held, value):
    with pytest.raises(ValueError, match=r"u_[xy] on 'top' is not part of CrackFESpace\(..., dirichlet=...\) or of dirichlet[xy]="):
        problem(dirichlet="bottom", **held).SetDirichlet(value, "top")


@pytest.mark.parametrize("value", [(None, None), (None,), (), (0, None, 0), ("up", None), (None, "0"), ((0, 1), None), None, [None], {}, (None, 1j)])
def test_a_value_that_is_none_is_refused(value):
    with pytest.raises((ValueError, TypeError), match="SetDirichlet: value"):
        problem(dirichlet="top").SetDirichlet(value, "top")


@pytest.mark.parametrize("flags", [dict(dirichletx="left|bottom", dirichlety="top"), dict(dirichlet="left", dirichletx="top"), dict(dirichlety=".*")])
@pytest.mark.parametrize("order", [1, 3])
def test_rollers_hold_what_those_of_ngsolve_hold(flags, order):
    """On a body whose crack is far from its boundary, where there are no other functions."""
    V = CrackFESpace(CrackedMesh(structured(6), Crack([(0.4, 0.45), (0.6, 0.55)])), order=order, tip=None, **flags)
    other, n = VectorH1(V.mesh, order=order, **flags), V.scalar_space.ndof
    assert (np.array(V.FreeDofs())[: 2 * n] == np.array(other.FreeDofs())).all() and all(np.array(V.FreeDofs())[2 * n :])


def test_a_roller_that_no_boundary_has():
    with pytest.raises(ValueError, match="CrackFESpace: dirichletx='lid' matches no boundary"):
        problem(dirichletx="lid")


@pytest.mark.parametrize("height", [1e-9, 1e-3, 0.3, 0.5, 1 - 1e-9])
@pytest.mark.parametrize("order", [1, 2])
def test_the_parts_beside_a_mouth_on_a_roller_slide_apart(height, order):
    """A crack through a body on two vertical rollers: its parts move up by what their other supports say, without stress."""
    p = problem(Crack([(0, (1 + height) / 3), (1, (1 + height) / 3)]), order, structured(3), dirichletx="left", dirichlety="bottom|top")
    p.SetDirichlet((None, 0.01), "top")
    solution = p.Solve()
    assert solution.Energy() < 1e-14 * 0.01**2 and solution.Profile(n=7).gap == pytest.approx(0.01, rel=1e-8)


def test_a_mouth_between_two_rollers_is_refused():
    """At the corner u_x is held on one side of the crack and u_y on the other: no function of the space does both."""
    with pytest.raises(Exception, match=r"at the vertex \(0, 0\), where u_x is held on one side of it only and u_y on the other"):
        problem(Crack([(0, 0), (0.6, 0.5)]), dirichletx="left", dirichlety="bottom")
    assert problem(Crack([(0, 0), (0.6, 0.5)]), dirichletx="left", dirichlety="left|bottom").V.ndof


# Symmetry


def mirrored(half):
    """A mesh with x ≥ 0 and its mirror image."""
    mesh, numbers = NetgenMesh(dim=2), {}
    for sign in (1, -1):
        for i, (a, b, *_) in enumerate(half.ngmesh.Coordinates()):
            shared = sign < 0 and a == 0
            numbers[sign, i] = numbers[1, i] if shared else mesh.Add(MeshPoint(Pnt(sign * a, b, 0)))
    mesh.Add(FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    names = ["bottom", "right", "top"]
    for sign in (1, -1):
        for element in half.Elements():
            corners = [numbers[sign, v.nr] for v in element.vertices]
            mesh.Add(Element2D(1, corners[::sign]))
        for element in half.Elements(BND):
            if element.mat in names:
                mesh.Add(Element1D([numbers[sign, v.nr] for v in element.vertices], index=1 + names.index(element.mat)))
    for number, name in enumerate(names):
        mesh.SetBCName(number, name)
    return Mesh(mesh)


HALF = rectangle(0.3)
FULL = mirrored(HALF)
TIP = TipEnrichment(material=MATERIAL, r1=0.2, tolerance=1e-8)
ACROSS = [Crack([(0, 0.53), (0.52, 0.53)])], [Crack([(-0.52, 0.53), (0.52, 0.53)])]
BENT = [Crack([(0, 0.4), (0.52, 0.53)])], [Crack([(-0.52, 0.53), (0, 0.4), (0.52, 0.53)])]
AT_A_VERTEX = [Crack([(0, 0.5), (0.52, 0.53)])], [Crack([(-0.52, 0.53), (0, 0.5), (0.52, 0.53)])]
BESIDE = [Crack([(1, 0.53), (0.48, 0.47)])], [Crack([(1, 0.53), (0.48, 0.47)]), Crack([(-1, 0.53), (-0.48, 0.47)])]


def symmetric_problem(mesh, cracks, order, multiplier, tip=TIP, law=None, stabilisation=BarbosaHughes(), **held):
    body = CrackedMesh(mesh, *cracks)
    V = CrackFESpace(body, order=order, tip=tip, dirichlety="bottom", **held)
    p = ContactProblem(V, TraceSpace(body, order=multiplier), MATERIAL, law=law, stabilisation=stabilisation)
    load(p, (0.3 * x, -1 + 4 * x * x), "top")
    return load(p, (x, 0.2))


@pytest.mark.parametrize("cracks", [ACROSS, BENT, AT_A_VERTEX, BESIDE], ids=["across", "bent", "at a vertex", "beside"])
@pytest.mark.parametrize(
    "method",
    [
        dict(order=1, multiplier=1),
        dict(order=2, multiplier=1),
        dict(order=2, multiplier=0, law=Coulomb(0.3)),
        dict(order=1, multiplier=0, stabilisation=Nitsche()),
    ],
)
def test_a_half_model_is_the_full_one(cracks, method):
    """The plane of symmetry x = 0 is a roller, on which the crack has a mouth that is none of the whole body."""
    half = symmetric_problem(HALF, cracks[0], dirichletx="left", **method).Solve()
    whole = symmetric_problem(FULL, cracks[1], **method)
    whole.Pin((0, 0), "x")
    whole = whole.Solve()
    assert 2 * half.Energy() == pytest.approx(whole.Energy(), rel=1e-10)
    one, other = half.Profile(n=21), whole.Profile(n=21 if cracks is BESIDE else 41)
    first = int(bool(whole.body.cracks[0].kinks))  # at a kink the whole crack has two directions
    for name in ("gap", "slip", "sigma_n"):
        ours, theirs = getattr(one, name)[first:], getattr(other, name)[first - 21 :]
        assert np.abs(ours - theirs).max() <= 1e-10 * np.abs(theirs).max()
    assert np.abs(one.gap).max() > 1e-3
    assert half.Reaction("bottom")[1] == pytest.approx(0.5 * whole.Reaction("bottom")[1], rel=1e-10)


# Data that contradict each other


def test_two_pins_at_one_vertex():
    p = problem()
    p.Pin((0, 1), "xy", (0, 0.5))
    p.Pin((0, 1), "y", 0.5)
    with pytest.raises(ValueError, match=r"Pin: u_y is given twice at \(0, 1\): 0.5, and now 0.25"):
        p.Pin((0, 1), "xy", (0, 0.25))
    assert len(p.pinned) == 2


@pytest.mark.parametrize("first", ["side", "pin"])
def test_a_pin_on_a_side_that_is_given(first):
    message = r"u_y at \(0, 1\) is pinned to 0 and given as 0.1 on 'top'"
    p = problem(dirichlet="top")
    steps = [lambda: p.SetDirichlet((0, 0.1 * (1 - x)), "top"), lambda: p.Pin((0, 1), "xy")]
    one, other = steps if first == "side" else steps[::-1]
    one()
    with pytest.raises(ValueError, match=message):
        other()
    p = problem(dirichlet="top")
    p.Pin((1, 1), "xy")
    p.SetDirichlet((0, 0.1 * (1 - x)), "top")  # zero there
    p.Pin((0, 1), "y", 0.1)


def test_a_pin_on_a_side_that_is_held_at_zero():
    p = load(problem(dirichlet="top"), (0, 1))
    p.Pin((0, 1), "y", 0.1)
    with pytest.raises(ValueError, match=r"u_y at \(0, 1\) is pinned to 0.1 and given as 0 on 'top'"):
        p.Solve()
    p.SetDirichlet((0, 0.1), "top")
    p.Solve()


@pytest.mark.parametrize("right", [(0, 0), None])
def test_two_sides_with_other_values_at_their_corner(right):
    """The one given as zero, or zero by declaration."""
    p = problem(dirichlet="bottom|top|right")
    p.SetDirichlet((0, 0.1 * x), "top")
    if right:
        p.SetDirichlet(right, "right")
    message = r"contradict each other at \(1, 1\): u_y = (0.1 on 'top' and 0 on 'right'|0 on 'right'.* and 0.1 on 'top')"
    for solve in (p.Solve, lambda: LoadCase(p)):
        with pytest.raises(ValueError, match=message):
            solve()
    p.SetDirichlet((0, 0.1 * y), "right")
    p.Solve()


def test_two_sides_that_agree_but_for_their_projections():
    """A function that no polynomial is: the projections of its traces differ at the corners, the function does not."""
    p = problem(dirichlet=".*")
    u = CF((0.1 * sqrt(1 + 3 * x + y * y), IfPos(y - x - 0.2, 0.1 * (y - x - 0.2), 0) ** 2))
    for side in ("left", "bottom", "right", "top"):
        p.SetDirichlet(u, side)
    assert p.Solve().report.converged


def test_load_steps_replace_what_was_given():
    p = problem(dirichlet="bottom|top")
    cases = []
    for value in ((0, -1e-3), (1e-3, 0)):
        p.SetDirichlet(value, "top")
        cases.append(LoadCase(p))
    solution = LoadSteps(p, cases).Solve(2, 3)
    assert solution.u(MESH(0.3, 1)) == pytest.approx((3e-3, -2e-3))
    p.SetDirichlet((None, 0), "top")
    with pytest.raises(ValueError, match="SetDirichlet has freed or fixed components since a load case was made"):
        LoadSteps(p, cases)


@pytest.mark.parametrize("tip", [TipEnrichment(material=MATERIAL, r1=0.3), TipEnrichment(r1=0.3)])
def test_a_pin_in_the_disk_of_a_tip(tip):
    mesh = structured(10)
    p = problem(Crack([(0, 0.52), (0.52, 0.52)]), mesh=mesh, tip=tip)
    with pytest.raises(ValueError, match=r"the vertex \(0.7, 0.6\) is in the disk r < r1 = 0.3 of the tip at \(0.52, 0.52\)"):
        p.Pin((0.7, 0.6), "x")
    p.Pin((0.9, 0.5), "xy")
    p.Pin((0.9, 0.7), "x")
    assert load(p, (1, y)).Solve().u(mesh(0.9, 0.5)) == pytest.approx((0, 0), abs=1e-12)


@pytest.mark.parametrize(("crack", "mesh"), [(Crack([(0, 0.52), (0.55, 0.52)]), MESH), (Crack([(0.55, 0.5), (0, 0.5)]), structured(4))], ids=["edge", "vertex"])
def test_given_displacements_that_push_the_faces_through_each_other(crack, mesh):
    shift = -0.02 if mesh is not MESH else 0
    apart = CF((0, IfPos(y - 0.52 - shift, 0.01, -0.01)))
    p = problem(crack, mesh=mesh, dirichlet="left")
    p.SetDirichlet(apart, "left")
    assert p.Solve().Profile(n=3).gap.max() == pytest.approx(0.02)
    p.SetDirichlet(CF((0.3, 0.01 * y)), "left")  # continuous
    p.Solve()
    p.SetDirichlet(-apart, "left")
    with pytest.raises(ValueError, match=r"push the faces of crack 0 through each other by 0.02 at its mouth \(0, 0.5"):
        p.Solve()
    steps = LoadSteps(p, [LoadCase(p)])
    steps.Solve(-0.5)
    with pytest.raises(ValueError, match=r"by 0.01 at its mouth"):
        steps.Solve(0.5)
    p = problem(crack, mesh=mesh, dirichlet="left", gap=0.03)
    p.SetDirichlet(-apart, "left")
    p.Solve()


def test_a_normal_jump_that_is_not_given_is_not_refused():
    """On a roller the faces of a horizontal crack move up and down as contact says."""
    p = problem(Crack([(0, 0.52), (0.55, 0.52)]), dirichletx="left", dirichlety="bottom")
    p.SetDirichlet((IfPos(y - 0.52, -0.01, 0.01), None), "left")
    assert p.Solve().report.converged


# Flags


@pytest.mark.parametrize(
    ("flags", "error", "message"),
    [
        (dict(dirchlet="bottom"), TypeError, r"no argument 'dirchlet' \(did you mean 'dirichlet'\?\)"),
        (dict(bogus=1), TypeError, "no argument 'bogus'; it takes body, order, tip, bubble, dirichlet, dirichletx, dirichlety, material, orderinner, print"),
        (dict(dirichletz="top"), TypeError, "no argument 'dirichletz'"),
        (dict(dim=3), ValueError, "dim=3 is not supported; u has as many components"),
        (dict(definedon="inner"), ValueError, "definedon='inner' is not supported; the space lives on the whole body"),
        (dict(dgjumps=True), ValueError, "dgjumps=True is not supported"),
        (dict(dirichlet_bbnd="corner"), ValueError, r"hold a vertex by problem.Pin\(point, components\)"),
    ],
)
def test_flags_that_are_refused(flags, error, message):
    with pytest.raises(error, match=f"CrackFESpace: .*{message}"):
        CrackFESpace(CrackedMesh(MESH, EDGE_CRACK), tip=None, **flags)


def test_free_rollers_are_rigid_motions():
    with pytest.raises(SingularSystem, match="1 rigid motion"):
        load(problem(dirichlety="bottom"), (0, 1)).Solve()


@pytest.mark.parametrize("d", [1e-3, 1e-5, 1e-7])
def test_zero_said_twice_is_said_once(d):
    """The mouth beside the corner at which the held side ends: SetDirichlet with zero changes nothing."""
    energies = []
    for again in (False, True):
        p = problem(Crack([(1 - d, 0), (0.45, 0.5)]), order=2, mesh=rectangle(0.15), dirichlet="bottom")
        load(p, (0.1, 1), "top")
        if again:
            p.SetDirichlet((0, 0), "bottom")
        energies.append(p.Solve().Energy())
    assert energies[1] == pytest.approx(energies[0], rel=1e-12)


def stretched(t, order=1):
    p = problem(order=order, mesh=MESH, dirichlet="bottom|top")
    p.SetDirichlet((0, t * 0.1 * (1 + x)), "top")
    return p


def test_a_parameter_in_what_is_given_has_the_value_of_the_solve():
    t = Parameter(1)
    p = stretched(t)
    first = p.Solve()
    t.Set(-2)
    second = p.Solve()
    assert np.allclose(array(second.u.vec), array(stretched(-2.0).Solve().u.vec), atol=1e-12)
    assert np.allclose(array(first.u.vec), array(stretched(1.0).Solve().u.vec), atol=1e-12)
    case = LoadCase(p)
    t.Set(1)
    steps = LoadSteps(p, [LoadCase(p), case])
    assert np.allclose(array(steps.Solve(1, 0).u.vec), array(first.u.vec), atol=1e-12)
    assert np.allclose(array(steps.Solve(0, 1).u.vec), array(second.u.vec), atol=1e-12)


def test_a_gridfunction_in_what_is_given_has_the_values_of_the_solve():
    t = GridFunction(VectorH1(MESH, order=1))
    p = problem(mesh=MESH, dirichlet="bottom|top")
    t.Set(CF((0, 0.1)))
    p.SetDirichlet(t, "top")
    first = p.Solve().Reaction("top")
    t.vec[:] *= 3
    assert np.allclose(p.Solve().Reaction("top"), 3 * first)


def test_the_error_of_a_solution_whose_parameter_has_changed():
    """It is that of the displacement which was solved for: the factor between them is seen."""
    t = Parameter(1)
    p = stretched(t, order=2)
    solution = p.Solve()
    before = solution.ErrorEstimate().energy
    t.Set(3)
    assert solution.ErrorEstimate().energy == pytest.approx(before, rel=1e-9)
