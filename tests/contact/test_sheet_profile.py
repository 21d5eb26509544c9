"""Tables of what is on a sheet in space, and the edge of contact."""

import csv

import numpy as np
import pytest
from ngsolve import CF, x, z

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, TraceSpace, Tresca
from ngsxfem_contact.exact.pennies import partially_closed
from ngsxfem_contact.exact.space_forms import stress_matrix, uniform_stress
from ngsxfem_contact.geometry import Sheet
from tests.sheets.exact_sheets import cube_mesh

pytestmark = pytest.mark.filterwarnings("ignore:CrackFESpace. .* nodes around fronts have no modes")

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE = (0.49, 0.51, 0.513)
COARSE, MEDIUM = cube_mesh(0.25), cube_mesh(0.13)


def plane(height=CENTRE[2]):
    return Sheet.Polygon([(-1, -1, height), (2, -1, height), (2, 2, height), (-1, 2, height)])


def solved(mesh, sheets, u, law=None, front=None):
    V = CrackFESpace(body := CrackedMesh(mesh, *sheets), dirichlet="outer", material=MATERIAL, front=front)
    problem = ContactProblem(V, TraceSpace(body), law=law)
    problem.SetDirichlet(u, "outer")
    return problem.Solve()


def test_the_table_of_a_uniform_state(tmp_path):
    """(3a) below the threshold of friction, on a tilted sheet: each row has the stress of the plane, nothing opens or slips; areas add up."""
    sheet = Sheet.Polygon([(a, b, 0.47 + 0.3 * (a - 0.5) - 0.2 * (b - 0.5)) for a, b in ((-1, -1), (2, -1), (2, 2), (-1, 2))])
    stress = stress_matrix(zz=-1, xz=0.1)
    solution = solved(COARSE, [sheet], uniform_stress(MATERIAL, stress).At((0, 0, 0)).u, Tresca(0.5))
    profile, axes = solution.Profile(), np.array([*sheet.axes, sheet.normal])
    traction = axes @ np.asarray(stress) @ axes[2]
    assert np.allclose(np.column_stack([profile.sigma_t_1, profile.sigma_t_2, profile.sigma_n]), traction, atol=1e-9)
    assert set(profile.state) == {"stick"} and np.allclose(profile.sigma_t, np.hypot(*traction[:2]), atol=1e-9)
    assert np.allclose([profile.gap, profile.slip], 0, atol=1e-10)
    assert profile.area.sum() == pytest.approx(np.sqrt(1 + 0.09 + 0.04)) == pytest.approx(solution.ContactArea())
    places = np.array(sheet.origin) + np.column_stack([profile.p_1, profile.p_2]) @ axes[:2]
    assert np.allclose(places, np.column_stack([profile.x, profile.y, profile.z]), atol=1e-12)
    rows = list(csv.reader(profile.SaveCSV(tmp_path / "sheet.csv").open()))
    assert rows[0] == list(profile.dtype.names) and len(rows) == 1 + len(profile) and float(rows[1][rows[0].index("area")]) == profile.area[0]
    assert len(solution.Transitions()) == 0 == len(solution.SlipTransitions())


def test_the_table_adds_up():
    """Forces and areas of the rows are those of the solution; without friction the traction is what is left of σ."""
    solution = solved(MEDIUM, [plane()], CF((0, 0, -0.05 * z * (0.6 - x))))
    profile = solution.Profile(0)
    assert (profile.sigma_n * profile.area).sum() == pytest.approx(solution.ContactForce())
    closed = profile.state == "contact"
    assert profile.area[closed].sum() == pytest.approx(solution.ContactArea()) and 0 < closed.mean() < 1
    assert (profile.sigma_n[closed] < 0).all() and (profile.sigma_n[~closed] == 0).all() and profile.gap[~closed].max() > 5 * np.abs(profile.gap[closed]).max()
    assert profile.sigma_t.max() < 0.5 * np.abs(profile.sigma_n).max() and profile.sigma_t.max() > 0
    with pytest.raises(ValueError, match="crack"):
        solution.Profile(1)


def test_each_sheet_has_its_rows():
    solution = solved(MEDIUM, [plane(0.3), plane(0.72)], CF((0, 0, -0.02 * z)))
    first, second = (solution.Profile(k) for k in (0, 1))
    assert np.allclose(first.z, 0.3) and np.allclose(second.z, 0.72) and len(first) + len(second) == len(solution.state.nodes)
    assert first.area.sum() == pytest.approx(1) == pytest.approx(second.area.sum())


def test_the_edge_of_contact():
    """(3g): around the open part of a plane, closed, and near its circle; all of what it bounds is open."""
    form = partially_closed(MATERIAL, 0.3).At(CENTRE)
    solution = solved(MEDIUM, [plane()], form.u)
    edge = solution.Transitions()
    assert edge.shape[1:] == (2, 3) and np.allclose(edge[..., 2], CENTRE[2], atol=1e-12)
    radius = np.linalg.norm(edge.mean(axis=1) - CENTRE, axis=1)
    assert abs(radius.mean() - 0.3) < 0.05
    _, count = np.unique(edge.reshape(-1, 3).round(9), axis=0, return_counts=True)
    assert set(count % 2) == {0}  # closed lines
    angles = np.unwrap(np.sort(np.arctan2(*(edge.mean(axis=1)[:, :2] - CENTRE[:2]).T)))
    assert np.diff(angles).max() < 0.8 and len(edge) > 8


def test_the_border_between_stick_and_slip():
    """A penny under shear and a pressure that grows along x slips where it is small."""
    solution = solved(MEDIUM, [plane()], CF((0.12 * z, 0, -0.1 * z * (0.2 + x))), Coulomb(0.35))
    profile = solution.Profile()
    assert {"stick", "slip"} <= set(profile.state)
    border = solution.SlipTransitions()
    sticks, slips = (profile.x[profile.state == state].mean() for state in ("stick", "slip"))
    assert len(border) and slips < border[..., 0].mean() < sticks
    assert solution.report.slipping.sum() == (profile.state == "slip").sum()
