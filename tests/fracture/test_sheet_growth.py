"""Sheets that grow in their plane by Paris' law, with K known in closed form: cycles, shapes, and what is refused."""

import numpy as np
import pytest
from ngsolve.meshes import MakeStructured3DMesh
from scipy.integrate import solve_ivp
from test_fronts_in_space import MATERIAL, MESH, TubeRule, field_of

from ngsxfem_contact import CrackedMesh
from ngsxfem_contact.exact.pennies import ellipse, penny_in_tension
from ngsxfem_contact.fracture import GivenIncrement, Paris, SheetGrowth, front_factors, grown_sheet
from ngsxfem_contact.fracture.front_stress_intensity import FrontFactors
from ngsxfem_contact.fracture.front_tube import FrontCurve
from ngsxfem_contact.geometry import Sheet

COARSE = MakeStructured3DMesh(hexes=False, nx=6, ny=6, nz=6)
PLACE = (0.5, 0.5, 0.52)


def known(body, K_I, count=24, error=0.0, front=0):
    """FrontFactors of a function K_I of points (n, 3)."""
    curve = FrontCurve(body, front)
    s = curve.length * np.arange(count) / count
    points = curve.Points(s)
    values, zero = K_I(points), np.zeros(count)
    return FrontFactors(body, front, s, points, values, zero, zero, values**2, values**2, np.full((count, 3), error), zero, (0.1,), np.zeros((1, count, 4)))


def penny(sheets):
    radius = lambda points: np.linalg.norm(points - PLACE, axis=1)
    return [known(CrackedMesh(COARSE, *sheets), lambda points: 2 * np.sqrt(radius(points) / np.pi))]


def test_a_penny_stays_one():
    growth = SheetGrowth(penny, [Sheet.Disk(PLACE, (0.1, 0.2, 1), 0.2)], Paris(C=1e-3, m=3, da=0.01))
    table = growth.Run(6)
    radii = np.linalg.norm(np.stack([table.x, table.y, table.z], axis=-1) - PLACE, axis=1)
    assert len(table) == 6 * 24 and radii == pytest.approx(0.2 + 0.01 * table.step, rel=1e-7) and table.advance == pytest.approx(0.01)
    assert growth.sheets[0].area == pytest.approx(np.pi * 0.26**2, rel=1e-7)
    assert growth.sheets[0].normal == pytest.approx(np.array([0.1, 0.2, 1]) / np.sqrt(1.05), abs=1e-14)


def test_the_cycles_converge_with_the_increment():
    """∫ da / (C K^m) from .2 to .24, of order 1."""
    C, m = 1e-3, 3
    exact = (np.pi / 4) ** 1.5 / C * 2 * (0.2**-0.5 - 0.24**-0.5)
    errors = []
    for steps in (4, 8):
        growth = SheetGrowth(penny, [Sheet.Disk(PLACE, (0, 0, 1), 0.2)], Paris(C, m, 0.04 / steps))
        growth.Run(steps)
        errors.append(growth.cycles / exact - 1)
    assert 0 < errors[0] < 0.1 and errors[0] / errors[1] == pytest.approx(2, rel=0.05)


def half_axes(points):
    return np.abs(points - PLACE)[:, :2].max(axis=0)


def test_an_ellipse_becomes_a_circle():
    """With Irwin's K of the ellipse that has its axes, beside the two equations da/dN = C K_a^m, db/dN = C K_b^m."""
    a0, b0, C, m = 0.24, 0.12, 1e-3, 3

    def irwin(sheets):
        body = CrackedMesh(COARSE, *sheets)
        a, b = half_axes(FrontCurve(body, 0).Points(np.linspace(0, body.fronts[0].length, 2001)))
        form = ellipse(MATERIAL, a, b).At(PLACE)
        return [known(body, lambda points: form.Factors(points)[:, 0], 32)]

    growth = SheetGrowth(irwin, [Sheet.Ellipse(PLACE, (a0, 0, 0), (0, b0, 0))], Paris(C, m, 0.01))
    growth.Run(10)
    a, b = half_axes(growth.evaluate(growth.sheets)[0].points)
    K = lambda axes: ellipse(MATERIAL, *axes).Factors(np.array([(axes[0], 0, 0), (0, axes[1], 0)]))[:, 0]
    path = solve_ivp(lambda _, axes: C * K(axes) ** m, (0, growth.cycles), (a0, b0), rtol=1e-8).y[:, -1]
    assert b0 / a0 == 0.5 and b / a > 0.75 and (a, b) == pytest.approx(path, rel=0.02)


def test_growth_by_the_integral():
    """One step from the exact field: the new front is a circle to the accuracy of K."""
    form = penny_in_tension(MATERIAL, 0.27).At(PLACE)
    evaluate = lambda sheets: [front_factors(CrackedMesh(MESH, *sheets), field_of(form), MATERIAL, rule=TubeRule(6, 5, 32))]
    growth = SheetGrowth(evaluate, [Sheet.Disk(PLACE, (0, 0, 1), 0.27)], Paris(1e-3, 3, 0.02))
    assert growth.Step()
    points = FrontCurve(CrackedMesh(MESH, *growth.sheets), 0).Points(np.linspace(0, 1.7, 50))
    assert np.linalg.norm(points - PLACE, axis=1) == pytest.approx(0.29, rel=1e-5)


def test_what_one_node_has_alone_is_smoothed():
    body, advances = CrackedMesh(COARSE, Sheet.Disk(PLACE, (0, 0, 1), 0.2)), np.full(24, 0.02)
    factors = known(body, lambda points: np.ones(len(points)))
    wave = 0.01 * np.cos(2 * np.pi * np.arange(24) / 24)
    noise = 0.01 * (-1.0) ** np.arange(24)
    areas = [grown_sheet(factors, advances + more).area for more in (0, noise, wave)]
    assert areas[1] == pytest.approx(areas[0], rel=1e-12)
    assert areas[2] == pytest.approx(areas[0] + np.pi * 0.01**2 / 2, rel=1e-4)


def test_holes_and_points_that_stay():
    """The inner front of a ring grows into the hole, where K_I is more than the toughness and its error."""
    ring = Sheet.Ring(PLACE, (0, 0, 1), 0.2, 0.4)
    evaluate = lambda sheets: [known(CrackedMesh(COARSE, *sheets), lambda points: np.full(len(points), 2.0), front=1)]
    growth = SheetGrowth(evaluate, [ring], GivenIncrement(0.03), toughness=1)
    growth.Run(1)
    assert growth.sheets[0].area == pytest.approx(np.pi * (0.4**2 - 0.17**2), rel=1e-7)
    for options in (dict(toughness=3), dict(error=2.5)):
        stays = lambda sheets: [known(CrackedMesh(COARSE, *sheets), lambda points: np.full(len(points), 2.0), error=options.get("error", 0))]
        growth = SheetGrowth(stays, [ring], GivenIncrement(0.03), toughness=options.get("toughness", 0))
        assert len(growth.Run(5)) == 24 and growth.sheets == [ring] and (growth.table.advance == 0).all()


def test_what_is_refused():
    body = CrackedMesh(COARSE, Sheet.Polygon([(-1, -1, 0.52), (0.5, -1, 0.52), (0.5, 2, 0.52), (-1, 2, 0.52)]))
    open_front = known(body, lambda points: np.ones(len(points)))
    with pytest.raises(ValueError, match="front 0 has corners or ends on the boundary"):
        grown_sheet(open_front, np.ones(24))
    disk = Sheet.Disk(PLACE, (0, 0, 1), 0.2)
    for arguments, error, match in (
        ((3, [disk], GivenIncrement(1)), TypeError, "not a function"),
        ((penny, [], GivenIncrement(1)), TypeError, "not a list of one or more sheets"),
        ((penny, [disk], 0.1), TypeError, "law=0.1"),
        ((penny, [disk], GivenIncrement(1), -1), ValueError, "finite number >= 0"),
    ):
        with pytest.raises(error, match=match):
            SheetGrowth(*arguments)
    both = lambda sheets: [known(CrackedMesh(COARSE, *sheets), lambda points: np.ones(len(points)), front=i) for i in (0, 1)]
    with pytest.raises(ValueError, match="two fronts of sheet 0 grow"):
        SheetGrowth(both, [Sheet.Ring(PLACE, (0, 0, 1), 0.2, 0.4)], GivenIncrement(0.02)).Step()
