"""The space of the next order holds the space itself, function by function."""

import numpy as np
import pytest
from helpers import MATERIAL, random_function, rectangle
from ngsolve import Grad, GridFunction

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace
from ngsxfem_contact.spaces.higher_order import HigherOrder, among_cell_functions

CRACKS = {
    "kinked": [Crack([(0, 0.52), (0.3, 0.52), (0.52, 0.63)])],
    "crossing": [Crack([(0.15, 0.5), (0.8, 0.53)]), Crack([(0.4, 0.1), (0.41, 0.9)])],
    "closed": [Crack([(0.3, 0.3), (0.6, 0.27), (0.5, 0.7), (0.3, 0.3)])],
}

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


@pytest.mark.parametrize("name", CRACKS)
@pytest.mark.parametrize("order, bubble", [(1, False), (1, True), (2, False), (2, True), (3, False)])
def test_a_function_keeps_its_values(name, order, bubble):
    body = CrackedMesh(rectangle(0.15), *CRACKS[name])
    V = CrackFESpace(body, order=order, bubble=bubble, material=MATERIAL, dirichlet="bottom", dirichletx="left")
    higher = HigherOrder(V)
    assert higher.space.order == order + 1 and higher.surplus.sum() == higher.space.ndof - V.ndof > V.ndof / 2
    u, w = random_function(V), GridFunction(higher.space)
    w.vec.FV().NumPy()[:] = higher.Prolonged(u.vec.FV().NumPy())
    points = body.mesh(*np.random.default_rng(1).uniform(0, 1, (2, 300)))
    assert np.abs(u(points) - w(points)).max() < 1e-12 and np.abs(Grad(u)(points) - Grad(w)(points)).max() < 1e-10
    free, more = ([bool(bit) for bit in space.FreeDofs()] for space in (V, higher.space))
    assert free == np.array(more)[higher.numbers].tolist()
    assert np.array_equal(higher.Restricted(higher.Prolonged(u.vec.FV().NumPy())), u.vec.FV().NumPy())


@pytest.mark.parametrize("order", [1, 2])
def test_on_a_refined_mesh(order):
    """Whose numbers of edges have gaps."""
    mesh = rectangle(0.4)
    for _level in range(3):
        mesh.SetRefinementFlags([i % 3 == 0 for i in range(mesh.ne)])
        mesh.Refine()
    V = CrackFESpace(CrackedMesh(mesh, *CRACKS["kinked"]), order=order, material=MATERIAL)
    higher, u = HigherOrder(V), random_function(V)
    w = GridFunction(higher.space)
    w.vec.FV().NumPy()[:] = higher.Prolonged(u.vec.FV().NumPy())
    points = mesh(*np.random.default_rng(1).uniform(0, 1, (2, 300)))
    assert np.abs(u(points) - w(points)).max() < 1e-12 and len(set(higher.numbers)) == V.ndof


def test_functions_of_triangles_by_degree():
    """Degree 2 among degree 4: i + j < 2 of the ten with i + j < 4."""
    assert among_cell_functions(3, 10) == [0, 1, 4] and among_cell_functions(0, 1) == [] and among_cell_functions(1, 3) == [0]
