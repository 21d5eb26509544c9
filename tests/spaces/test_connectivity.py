"""The parts into which cracks divide a body, as the space sees them."""

import pytest
from helpers import structured
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace
from ngsxfem_contact.errors import SingularSystem
from ngsxfem_contact.spaces.connectivity import VertexCopies

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
        with pytest.raises(SingularSystem, match="1 rigid motion"):
            problem.Solve()


@pytest.mark.parametrize("heights, parts", [([0.3], 2), ([0.3, 0.55], 3), ([0.52, 0.58], 3), ([0.51, 0.56, 0.61], 4)])
def test_cracks_through_the_body(heights, parts):
    """In separate elements, and in shared ones."""
    body = CrackedMesh(structured(4), *(Crack([(0, y), (1, y + 0.01)]) for y in heights))
    assert VertexCopies(CrackFESpace(body, order=1)).parts == parts


# Hinges

LOWER = [(0, 0), (3, 0), (3, 1), (2, 1), (1, 1), (0, 1)]
SQUARE = [(1, 1), (1.5, 1.5), (1, 2), (0.5, 1.5)]  # turned, on one corner
ARCH = [(1, 1), (1.5, 1.5), (2, 1), (2.5, 2), (0.5, 2)]  # on two


def polygons(*outlines, maxh=0.4):
    """A mesh of polygons that share points; "bottom" is the first line, "roof" the last but one of the last."""
    geometry, numbers = SplineGeometry(), {}
    for domain, outline in enumerate(outlines):
        points = [numbers.setdefault(p, len(numbers)) for p in outline]
        for point in outline:
            if geometry.GetNPoints() <= numbers[point]:
                geometry.AppendPoint(*point)
        for i, (a, b) in enumerate(zip(points, points[1:] + points[:1])):
            name = "bottom" if (domain, i) == (0, 0) else "roof" if (domain, i) == (len(outlines) - 1, len(points) - 2) else "side"
            geometry.Append(["line", a, b], bc=name, leftdomain=domain + 1, rightdomain=0)
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def hinged(*outlines, crack=Crack([(0, 0.5), (1.2, 0.5)]), order=1):
    body = CrackedMesh(polygons(*outlines), crack)
    V = CrackFESpace(body, order=order, tip=None, dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body, order=order - 1), Elasticity(1, 1))
    problem.f += CF((0.1, 0.2)) * V.TestFunction() * body.dx
    return problem


@pytest.mark.parametrize("order", [1, 2])
def test_a_part_that_hangs_on_one_vertex_can_turn(order):
    problem = hinged(LOWER, SQUARE, order=order)
    message = r"1 rigid motion\(s\) of the part of the body around \(1, 1.5\), which hangs on others by the vertex \(1, 1\) alone, are left free"
    with pytest.raises(SingularSystem, match=message):
        problem.Solve()
    problem.Pin((0.5, 1.5), "x")
    solution = problem.Solve()
    assert solution.u(problem.V.mesh(0.5, 1.5))[0] == pytest.approx(0, abs=1e-12)
    # the pin is as high as the centre of the square, of area ½: it takes the whole horizontal load
    assert solution.Reaction((0.5, 1.5)) == pytest.approx((-0.5 * 0.1, 0), abs=1e-10)


def test_a_pin_whose_force_meets_the_hinge_holds_nothing():
    problem = hinged(LOWER, SQUARE)
    problem.Pin((1, 2), "y")
    with pytest.raises(SingularSystem, match="1 rigid motion"):
        problem.Solve()


def test_two_hinges_hold():
    problem = hinged(LOWER, ARCH)
    assert VertexCopies(problem.V).parts == 2
    assert problem.Solve().report.converged


def test_a_chain_of_hinges():
    """The upper square turns about its own corner though the lower one is held."""
    upper = [(1, 2), (1.5, 2.5), (1, 3), (0.5, 2.5)]
    problem = hinged(LOWER, SQUARE, upper)
    problem.Pin((0.5, 1.5), "x")
    with pytest.raises(SingularSystem, match=r"part of the body around \(1, 2.5\), which hangs on others by the vertex \(1, 2\) alone"):
        problem.Solve()
    problem.Pin((0.5, 2.5), "x")
    assert problem.Solve().report.converged


def test_a_crack_can_make_a_hinge_and_a_mechanism():
    """The arch cut through: each half turns about its own foot."""
    problem = hinged(LOWER, ARCH, crack=Crack([(1.5, 1.5), (1.5, 2)]))
    with pytest.raises(SingularSystem, match=r"1 rigid motion\(s\) of the part of the body around .* by the vertex \([12], 1\) alone"):
        problem.Solve()


def test_a_crack_through_a_hinge_is_refused():
    with pytest.raises(Exception, match=r"passes through the vertex \(1, 1\), where parts of the body hang together by this point alone"):
        hinged(LOWER, SQUARE, crack=Crack([(1, 1), (1.5, 0.3)]))
