"""Wrong input to a contact problem is refused, with a message that says what to do."""

from math import nan

import pytest
from ngsolve import CF, VERTEX, NodeId, x

from ngsxfem_contact import BarbosaHughes, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.errors import SingularSystem
from ngsxfem_contact.exact.closed_forms import rotated_square
from study.paper import unstructured_mesh

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MATERIAL = Elasticity(1, 1)
MESH = unstructured_mesh(0.1)
BODY = CrackedMesh(MESH, Crack([(0, 0), (0.5, 0)]))
THROUGH = CrackedMesh(MESH, Crack([(0, 0), (1, 0)]))


def problem(body=BODY, dirichlet="", **options):
    V = CrackFESpace(body, order=1, tip=None, dirichlet=dirichlet)
    return ContactProblem(V, TraceSpace(body), MATERIAL, **options)


def pinned(**options):
    result = problem(**options)
    result.Pin((1, -0.5), "xy")
    result.Pin((1, 0.5), "x")
    return result


# Material


@pytest.mark.parametrize(("lam", "mu"), [(1, 0), (1, -1), (-1, 1), (-2, 1)])
def test_energy_that_is_not_positive(lam, mu):
    with pytest.raises(ValueError, match="positive only for mu > 0 and lam . mu > 0"):
        Elasticity(lam, mu)


@pytest.mark.parametrize(("lam", "mu"), [(nan, 1), (1, nan), (float("inf"), 1)])
def test_material_that_is_not_finite(lam, mu):
    with pytest.raises(ValueError, match="must be finite"):
        Elasticity(lam, mu)


def test_negative_lam_is_a_material():
    assert Elasticity(-0.9, 1).mu == 1


@pytest.mark.parametrize("nu", [0.5, 0.6, -1, -1.1])
def test_poisson_ratio_out_of_range(nu):
    with pytest.raises(ValueError, match="Poisson"):
        Elasticity.PlaneStrain(1, nu)


@pytest.mark.parametrize("nu", [1, 1.1, -1])
def test_poisson_ratio_out_of_range_in_plane_stress(nu):
    with pytest.raises(ValueError, match="Poisson"):
        Elasticity.PlaneStress(1, nu)


def test_material_without_numbers():
    with pytest.raises((TypeError, ValueError), match="number"):
        Elasticity("steel", 1)


# Regions


def test_unknown_dirichlet_region():
    with pytest.raises(ValueError, match=r"dirichlet='lid' matches no boundary; the mesh has \['bottom', 'left', 'right', 'top'\]"):
        CrackFESpace(BODY, dirichlet="lid")


def test_unknown_region_in_set_dirichlet():
    with pytest.raises(ValueError, match=r"SetDirichlet: region='lid' matches no boundary; the mesh has \['bottom'"):
        problem(dirichlet="top").SetDirichlet((0, 0), "lid")


@pytest.mark.parametrize("region", ["top", "top|bottom"])
def test_set_dirichlet_on_a_region_that_was_not_declared(region):
    with pytest.raises(ValueError, match=r"is not part of CrackFESpace\(..., dirichlet=...\)"):
        problem(dirichlet="bottom").SetDirichlet((0, 0), region)


def test_unknown_region_in_a_load():
    p = problem()
    with pytest.raises(Exception, match="restricted to 'lid', which matches no boundary"):
        p.f += CF((0, 1)) * p.V.TestFunction() * p.body.ds("lid")


@pytest.mark.parametrize("value", [0, CF(1), (1, 2, 3)])
def test_set_dirichlet_with_a_wrong_number_of_components(value):
    with pytest.raises(Exception, match="(?i)component|dimension|dim"):
        problem(dirichlet="top").SetDirichlet(value, "top")


# Rigid motions


def test_body_that_nothing_holds():
    with pytest.raises(SingularSystem, match=r"3 rigid motion\(s\) of the body are left free: fix them by dirichlet=.* or by Pin"):
        problem().Solve()


@pytest.mark.parametrize(("pins", "free"), [([("xy", (1, -0.5))], 1), ([("x", (1, -0.5)), ("x", (1, 0.5))], 1), ([("y", (1, -0.5))], 2)])
def test_body_with_too_few_pins(pins, free):
    p = problem()
    for components, point in pins:
        p.Pin(point, components)
    with pytest.raises(SingularSystem, match=rf"{free} rigid motion"):
        p.Solve()


def test_pins_on_one_line_of_action():
    """Three pins, but both vertical ones act at x = 1: the rotation about neither is held by u_y."""
    p = problem()
    p.Pin((1, -0.5), "y")
    p.Pin((1, 0.5), "y")
    p.Pin((0, 0.5), "y")
    with pytest.raises(SingularSystem, match="1 rigid motion"):
        p.Solve()


def test_part_that_a_crack_cuts_off():
    """Contact may hold it against pressing, nothing against sliding."""
    with pytest.raises(SingularSystem, match=r"1 rigid motion\(s\) of one of the 2 parts into which the cracks divide the body"):
        problem(THROUGH, dirichlet="bottom").Solve()


@pytest.mark.parametrize("regions", ["bottom|top", "left"])
def test_both_parts_held(regions):
    assert problem(THROUGH, dirichlet=regions).Solve().Energy() == 0


# Data that are not numbers


@pytest.mark.parametrize("load", [CF((0, nan)), CF((0, 1 / (x - x)))])
def test_load_that_is_not_finite(load):
    p = pinned()
    p.f += load * p.V.TestFunction() * p.body.dx
    with pytest.raises(ValueError, match=r"the load `f` is not finite .* check its coefficient functions"):
        p.Solve()


def test_given_displacement_that_is_not_finite():
    p = problem(dirichlet="top")
    with pytest.raises(ValueError, match=r"SetDirichlet: the value is not finite \(NaN or inf\) somewhere on 'top'"):
        p.SetDirichlet((nan, 0), "top")
    p.given.vec[0] = nan
    with pytest.raises(ValueError, match="given displacement is not finite .* check Pin and SetDirichlet"):
        p.Solve()


def test_pin_to_a_value_that_is_not_finite():
    p = problem()
    p.Pin((1, -0.5), "xy")
    with pytest.raises(ValueError, match="Pin: value=nan is not finite"):
        p.Pin((1, 0.5), "x", value=nan)


# Pin


def test_pin_beside_a_vertex():
    with pytest.raises(ValueError, match=r"no mesh vertex at \(0.99, -0.49\); the nearest is \(1.0, -0.5\)"):
        problem().Pin((0.99, -0.49), "x")


@pytest.mark.parametrize("components", ["z", "", "yx", "X", None, ("x", "y")])
def test_pin_of_a_component_that_does_not_exist(components):
    with pytest.raises(ValueError, match=r"components=.* is not one of \['x', 'xy', 'y'\]"):
        problem().Pin((1, 0.5), components)


@pytest.mark.parametrize("point", [(1,), (1, 0.5, 0), 1, (nan, 0), "ab", ("a", "b")])
def test_pin_at_something_that_is_no_point(point):
    with pytest.raises(ValueError, match="Pin"):
        problem().Pin(point, "x")


def test_pin_where_the_displacement_jumps():
    p = problem()
    vertex, _ = p.V.Heaviside(0)
    with pytest.raises(ValueError, match="u may jump at the vertex .* pin a vertex away from it"):
        p.Pin(MESH[NodeId(VERTEX, vertex)].point, "x")


def test_pin_with_a_wrong_number_of_values():
    with pytest.raises(ValueError, match=r"value=\(1, 2, 3\) is not a number, nor two, one for each component"):
        problem().Pin((1, 0.5), "xy", value=(1, 2, 3))


@pytest.mark.parametrize("value", ["far", CF(1), (1, 2)])
def test_pin_to_something_that_is_no_number(value):
    with pytest.raises(ValueError, match="Pin: value=.* is not a number$"):
        problem().Pin((1, 0.5), "x", value=value)


# The problem


def test_spaces_of_different_bodies():
    other = CrackedMesh(MESH, Crack([(0, 0), (0.5, 0)]))
    with pytest.raises(ValueError, match="V and W belong to different CrackedMesh objects; build both on one body"):
        ContactProblem(CrackFESpace(BODY, tip=None), TraceSpace(other), MATERIAL)


@pytest.mark.parametrize("gap", [-0.1, nan, float("inf")])
def test_gap_out_of_range(gap):
    with pytest.raises(ValueError, match=r"gap=.* must be a finite number >= 0"):
        pinned(gap=gap)


def test_gap_function_that_is_negative():
    with pytest.raises(ValueError, match="gap"):
        pinned(gap=x - 0.25).Solve()


def test_gap_function_that_is_not_finite():
    with pytest.raises(ValueError, match="the initial gap is not finite .* check `gap` on the whole crack"):
        pinned(gap=CF(nan)).Solve()


def test_unknown_cone():
    with pytest.raises(ValueError, match=r"cone='negative' is not one of \['nonpositive', 'weak'\]"):
        problem(cone="negative")


def test_stabilisation_that_is_none_of_ours():
    with pytest.raises((TypeError, ValueError), match="stabilisation"):
        problem(stabilisation=0.05)


@pytest.mark.parametrize("gamma0", [0, -0.1, nan, float("inf")])
def test_gamma0_out_of_range(gamma0):
    with pytest.raises(ValueError, match="gamma0=.* must be positive and finite; stabilisation=None switches it off"):
        BarbosaHughes(gamma0=gamma0)


@pytest.mark.parametrize("theta", [0, 1, -0.5, 2, nan])
def test_theta_out_of_range(theta):
    with pytest.raises(ValueError, match="theta=.* must lie between 0 and 1"):
        BarbosaHughes(theta=theta)


def test_modes_of_another_material():
    """Their coefficients would not be the stress intensity factors, and their lips not free of traction."""
    V = CrackFESpace(BODY, order=1, tip=TipEnrichment(material=Elasticity(5, 1)))
    with pytest.raises(ValueError, match="material"):
        ContactProblem(V, TraceSpace(BODY), MATERIAL)


def test_disk_that_leaves_the_body():
    with pytest.raises(Exception, match=r"the disk r1 = 0.7 of the tip at .* reaches the boundary.*, at 0.5; choose r1 below that"):
        CrackFESpace(BODY, tip=TipEnrichment(r1=0.7))


def test_disk_that_meets_another_crack():
    body = CrackedMesh(MESH, Crack([(0, 0), (0.5, 0)]), Crack([(0, 0.2), (1, 0.2)]))
    with pytest.raises(Exception, match=r"the disk r1 = 0.3 of the tip at .* reaches .*crack.* at 0.2; choose r1 below that"):
        CrackFESpace(body, tip=TipEnrichment(r1=0.3))


@pytest.mark.parametrize(("r0", "r1"), [(0.3, 0.2), (0.2, 0.2), (-0.1, 0.2), (nan, 0.2)])
def test_radii_in_wrong_order(r0, r1):
    with pytest.raises(Exception, match="needs 0 <= r0 < r1"):
        CrackFESpace(BODY, tip=TipEnrichment(r0=r0, r1=r1))


@pytest.mark.parametrize("option", [{"cutoff": "linear"}, {"functions": "modal"}, {"functions": "modes"}])
def test_tip_options_that_do_not_exist(option):
    with pytest.raises(ValueError, match=f"TipEnrichment: {next(iter(option))}="):
        TipEnrichment(**option)


def test_wrong_number_of_tips():
    with pytest.raises(ValueError, match="2 tip enrichments for 1 tips; give one for each of body.tips"):
        CrackFESpace(BODY, tip=[None, None])


@pytest.mark.parametrize("order", [0, -1])
def test_order_of_the_displacement(order):
    with pytest.raises(ValueError, match=f"order={order} must be 1 or more"):
        CrackFESpace(BODY, order=order)


def test_order_of_the_multiplier():
    with pytest.raises(ValueError, match="order=-1 must be 0 or more"):
        TraceSpace(BODY, order=-1)


def test_unknown_multiplier_basis():
    with pytest.raises(ValueError, match="basis='dual' is not 'nodal' or 'trace'"):
        TraceSpace(BODY, basis="dual")


@pytest.mark.parametrize("nodes", [[0.1, 0.5], [0, 0.7], [0, 0.3, 0.2, 0.5], [0, nan, 0.5], [0]])
def test_nodes_that_do_not_run_along_the_crack(nodes):
    with pytest.raises(Exception, match="(?i)nodes"):
        TraceSpace(BODY, nodes=nodes)


def test_a_body_with_one_boundary_name():
    body = CrackedMesh(rotated_square(0.3, (0, 0), 0.3), Crack([(-0.1, 0), (0.1, 0)]))
    with pytest.raises(ValueError, match=r"dirichlet='top' matches no boundary; the mesh has \['outer'\]"):
        CrackFESpace(body, tip=None, dirichlet="top")


def test_stress_intensity_without_tip_functions():
    V = CrackFESpace(BODY, order=1, tip=None)
    p = ContactProblem(V, TraceSpace(BODY), MATERIAL)
    p.Pin((1, -0.5), "xy")
    p.Pin((1, 0.5), "x")
    with pytest.raises(ValueError, match=r"no modes at tip 0; build it with tip=TipEnrichment\(material=material, functions='modes'\)"):
        p.Solve().StressIntensity(method="modes")
