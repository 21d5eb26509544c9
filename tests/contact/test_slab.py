"""A straight front between planes of symmetry has in each cross-section what the plane package finds there."""

import numpy as np
import pytest
from slabs import deviations, plane_solution, slab_solution

from ngsxfem_contact import Coulomb

OPEN, CLOSES, SLIDES = ((0, 1), None), ((0.3, -1), None), ((0.5, -1), Coulomb(0.3))


@pytest.mark.parametrize("load, law", (OPEN, CLOSES, SLIDES), ids=("open", "closes", "slides"))
def test_order_two(load, law):
    """K inside and at the ends, no K_III, force and energy, beside those of the plane."""
    K, ends, third, _, force, energy = deviations(slab_solution(load, law, 12, order=2, radius=0.2), plane_solution(load, law))
    assert K < 0.006 and ends < 0.02 and third < 0.006 and force < 0.002 and energy < 0.003


@pytest.mark.parametrize("load, law, of_pressure", ((*OPEN, 0), (*SLIDES, 0), (*SLIDES, 1)), ids=("open", "slides", "slides, λ of order 1"))
def test_orders_of_convergence(load, law, of_pressure):
    """P1 with modes within a fixed radius: the energy falls faster than with the first power of h, gap and pressure with the first."""
    plane, sizes = plane_solution(load, law), (12, 20)
    _, _, _, faces, _, energy = np.array([deviations(slab_solution(load, law, n, radius=0.2, multipliers=of_pressure), plane) for n in sizes]).T
    order = lambda errors: np.log(errors[0] / errors[1]) / np.log(sizes[1] / sizes[0])
    assert order(energy) > 1.3 and order(faces) > 0.9
