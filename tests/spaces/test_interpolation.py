"""Interpolant and Projection: functions of the space are kept, others are met as well as the space can."""

import numpy as np
import pytest
from helpers import array, random_function, rectangle, vector
from ngsolve import CF, IfPos, InnerProduct, Integrate, sin, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, TipEnrichment
from ngsxfem_contact.spaces import Interpolant, Projection

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = rectangle(0.15)
THROUGH = CrackedMesh(MESH, Crack([(0, 0.37), (1, 0.58)]))
ABOVE = IfPos(y - 0.37 - 0.21 * x, 1, 0)


def distance(u, f, body):
    return np.sqrt(Integrate(InnerProduct(u - f, u - f) * body.dx(bonus_intorder=6), MESH))


@pytest.mark.parametrize("order", [1, 2, 3])
def test_polynomials_that_jump_are_kept(order):
    V = CrackFESpace(THROUGH, order=order, tip=None)
    f = CF((x**order - y + ABOVE * (1 + 2 * y), 3 * y**order + ABOVE * (x - 1)))
    assert distance(Projection(V, f), f, THROUGH) < 1e-11


@pytest.mark.parametrize("options", [dict(tip=None), dict(tip=TipEnrichment(r0=0.02, r1=0.2, tolerance=1e-8))])
def test_what_a_projection_leaves_is_orthogonal_to_the_space(options):
    body = CrackedMesh(MESH, Crack([(0, 0.37), (0.5, 0.45)]))
    V = CrackFESpace(body, order=1, **options)
    f = CF((sin(7 * x * y), x**3))
    u, v = Projection(V, f), V.TestFunction()
    rest = vector(InnerProduct(f - u, v) * body.dx(bonus_intorder=4))
    assert np.abs(rest).max() < 1e-10 * np.abs(vector(InnerProduct(f, v) * body.dx(bonus_intorder=4))).max()
    assert 1e-4 < distance(u, f, body) <= distance(Interpolant(V, f), f, body)


def test_a_function_of_the_space_is_its_own_projection():
    V = CrackFESpace(THROUGH, order=2, tip=None)
    w = random_function(V, 3)
    assert array(Projection(V, w).vec) == pytest.approx(array(w.vec), abs=1e-8)
