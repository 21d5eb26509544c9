"""The layout of the unknowns is that of the core."""

import numpy as np
import pytest
from netgen.geom2d import unit_square
from ngsolve import GridFunction, Mesh

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment
from ngsxfem_contact.spaces.unknowns import Unknowns

MATERIAL = Elasticity.PlaneStrain(E=1, nu=0.3)
BODY = CrackedMesh(Mesh(unit_square.GenerateMesh(maxh=0.15)), Crack([(0, 0.31), (0.52, 0.33)]), Crack([(0.3, 0.72), (0.75, 0.74)]))


@pytest.mark.parametrize("functions", ["modes", "branch"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_each_unknown_has_one_kind(order, functions):
    size = 2 * order if functions == "modes" else 8
    V = CrackFESpace(BODY, order=order, tip=TipEnrichment(r1=0.1, material=MATERIAL, functions=functions))
    unknowns, every = Unknowns(V), np.arange(V.ndof)
    parts = [every[part] for k in (0, 1) for part in (unknowns.Polynomial(k), unknowns.Heaviside(k))] + [unknowns.Tip(t) for t in range(3)]
    assert np.array_equal(np.sort(np.concatenate(parts)), every) and [len(unknowns.Tip(t)) for t in range(3)] == [size] * 3
    assert np.array_equal(np.sort(np.concatenate([every[unknowns.polynomial], every[unknowns.heaviside], unknowns.tips])), every)
    assert np.array_equal(np.concatenate([every[unknowns.regular], unknowns.tips]), every)
    assert [V.HeavisideDof(j, k) for k in (0, 1) for j in range(V.num_heaviside)] == every[unknowns.heaviside].tolist() and unknowns.jumps > 5
    assert [tuple(pair) for pair in zip(unknowns.enriched, unknowns.shifts)] == [V.Heaviside(j) for j in range(V.num_heaviside)]
    assert unknowns.Kinds(every).tolist() == [0] * unknowns.regular.stop + [t + 1 for t in range(3) for _ in range(size)]


def test_polynomials_of_a_component_move_along_it():
    V = CrackFESpace(BODY, order=2, tip=None)
    u = GridFunction(V)
    for k in (0, 1):
        u.vec[:] = 0
        u.vec.FV().NumPy()[Unknowns(V).Polynomial(k)][: BODY.mesh.nv] = 1  # the vertices' functions add up to one
        assert np.allclose(u(BODY.mesh(0.9, 0.1)), np.eye(2)[k])
    assert len(Unknowns(V).tips) == 0
