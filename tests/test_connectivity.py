"""The parts into which cracks divide a body, as the space sees them."""

import pytest
from helpers import structured
from ngsolve import CF

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.connectivity import VertexCopies
from ngsxfem_contact.errors import SingularSystem

H = 0.25  # of the squares


@pytest.mark.parametrize("displacement", [0, 1e-15, 1e-12, 1e-10, 1e-9, 1e-8, 1e-6, 1e-3, 0.3])
@pytest.mark.parametrize("end", [(1, 0.62), (0.75, 0), (0.62, 1)], ids=["to the right", "to a vertex below", "to the top"])
def test_a_mouth_beside_a_vertex_leaves_two_parts(displacement, end):
    """A corner of the size of the displacement, squared, holds nothing together; and each part has to be held."""
    body = CrackedMesh(structured(4), Crack([(0, 0.5 + displacement * H), end]))
    V = CrackFESpace(body, order=1, dirichlet="left|bottom" if end[1] == 1 else "top")
    assert VertexCopies(V).parts == 2
    problem = ContactProblem(V, TraceSpace(body, order=1), Elasticity(1, 1))
    problem.f += CF((0, -1e-3)) * V.TestFunction() * body.dx
    if end[1] != 1:  # the lower part hangs free
        with pytest.raises(SingularSystem, match="3 rigid motion"):
            problem.Solve()


@pytest.mark.parametrize("heights, parts", [([0.3], 2), ([0.3, 0.55], 3), ([0.52, 0.58], 3), ([0.51, 0.56, 0.61], 4)])
def test_cracks_through_the_body(heights, parts):
    """In separate elements, and in shared ones."""
    body = CrackedMesh(structured(4), *(Crack([(0, y), (1, y + 0.01)]) for y in heights))
    assert VertexCopies(CrackFESpace(body, order=1)).parts == parts
