"""Contact with friction and K on extruded cracks with kinks beside the plane package, pictures and files of them."""

import numpy as np
import pytest
from ngsolve import Integrate

from ngsxfem_contact import ContactSolution, Coulomb, Crack
from tests.contact.test_curved_contact import assert_drawn_and_kept, plane_solution, quantities, solid_solution

pytestmark = pytest.mark.filterwarnings("ignore")
THROUGH, WING = Crack([(-0.3, 0.55), (0.5, 0.45), (1.3, 0.65)]), Crack([(0.2, 0.52), (0.6, 0.45), (0.8, 0.72)])


def test_a_kink_in_contact_is_that_of_the_plane():
    """Between planes of symmetry: pressure, jump and energy of the plane's solution with friction."""
    law = Coulomb(0.3)
    exact = quantities(plane_solution(law, THROUGH))
    assert (np.abs(quantities(solid_solution(law, 0.08, crack=THROUGH), 0.15) / exact - 1) < [0.01, 0.02, 0.015]).all()


def test_a_wing_crack(tmp_path):
    """It slides along both parts; K at its two ends is that of the plane; it is drawn open along all facets, written and read."""
    law = Coulomb(0.3)
    plane, solution = plane_solution(law, WING), solid_solution(law, 0.07, crack=WING)
    table = plane.Table()
    for number, front in enumerate(solution.body.fronts):
        (K_II,) = np.abs(table.K_II[np.hypot(table.x - front.PointAt(0)[0], table.y - front.PointAt(0)[1]) < 1e-9])
        found = solution.StressIntensity(number)
        assert np.abs(np.abs(found.K_II).mean() / K_II - 1) < 0.06 and (found.K_I == 0).all()
    profile = solution.Profile(0)
    assert profile.area.sum() == pytest.approx(Integrate(1 * solution.body.dcrack, solution.body.mesh))
    assert_drawn_and_kept(solution, profile, tmp_path / "wing")
    assert np.array_equal(ContactSolution.Load(tmp_path / "wing.solution").state.L, solution.state.L)
