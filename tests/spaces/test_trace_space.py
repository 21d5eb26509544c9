"""TraceSpace: dimensions, reproduction, nodes of its own, the basis of traces."""

import pickle

import numpy as np
import pytest
from helpers import array, matrix, on_crack, random_function, rectangle, structured, threads
from ngsolve import CF, BilinearForm, GridFunction, InnerProduct, Integrate, LinearForm, x, y

from ngsxfem_contact import Crack, CrackedMesh, CrackFESpace, Jump, TraceSpace

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = rectangle(0.15)
STRAIGHT = [(0, 0.43), (0.7, 0.53)]
CRACKS = {
    "straight": (MESH, [STRAIGHT]), "kinked": (MESH, [[(0, 0.43), (0.37, 0.52), (0.72, 0.47)]]),
    "two": (MESH, [[(0, 0.31), (0.6, 0.3)], [(0.3, 0.7), (1, 0.74)]]), "aligned": (structured(6), [[(0, 0.5), (0.6, 0.5)]]),
    "through vertices": (structured(6), [[(0, 1 / 3), (1, 2 / 3)]]),
}  # fmt: skip
cracks = pytest.mark.parametrize("mesh, lines", CRACKS.values(), ids=CRACKS.keys())


def body_of(mesh, lines):
    return CrackedMesh(mesh, *(Crack(points) for points in lines))


BODY = body_of(*CRACKS["straight"])


def crossings(mesh, crack):
    """Arc lengths at which a straight crack meets edges of the mesh, and of its ends, by brute force."""
    p, q = np.array(crack.points[0]), np.array(crack.points[1])
    t = (q - p) / crack.length
    found = [0, crack.length]
    for edge in mesh.edges:
        a, b = (np.array(mesh[v].point) - p for v in edge.vertices)
        da, db = (t[0] * c[1] - t[1] * c[0] for c in (a, b))
        found += [(c @ t) for c, d in ((a, da), (b, db)) if abs(d) < 1e-12]
        if da * db < 0 and min(abs(da), abs(db)) > 1e-12:
            found.append((a + da / (da - db) * (b - a)) @ t)
    inside = np.sort([s for s in found if -1e-12 <= s <= crack.length + 1e-12])
    return inside[np.append(True, np.diff(inside) > 1e-10)]


@pytest.mark.parametrize("name", ["straight", "aligned", "through vertices"])
def test_nodes_are_where_the_crack_meets_edges(name):
    mesh, lines = CRACKS[name]
    W = TraceSpace(body_of(mesh, lines), order=1)
    assert W.basis.division[0] == pytest.approx(crossings(mesh, Crack(lines[0])), abs=1e-12)


@cracks
@pytest.mark.parametrize("order", [0, 1, 2, 3, 5])
def test_dimension(mesh, lines, order):
    W = TraceSpace(body_of(mesh, lines), order=order)
    intervals = [len(nodes) - 1 for nodes in W.basis.division]
    assert W.ndof == sum(n * order + 1 if order else n for n in intervals)
    assert [len(s) for s in W.NodalPositions()] == [n * order + 1 if order else n for n in intervals]


def test_kinks_are_nodes_for_continuous_functions_only():
    body = body_of(*CRACKS["kinked"])
    kink = np.hypot(0.37, 0.09)
    assert min(abs(s - kink) for s in TraceSpace(body, order=1).basis.division[0]) < 1e-12
    assert min(abs(s - kink) for s in TraceSpace(body, order=0).basis.division[0]) > 1e-6


@cracks
@pytest.mark.parametrize("order", [0, 1, 2, 4])
def test_partition_of_unity(mesh, lines, order):
    body = body_of(mesh, lines)
    one = GridFunction(TraceSpace(body, order=order))
    one.vec[:] = 1
    for c, crack in enumerate(body.cracks):
        assert one(on_crack(body, np.linspace(0, crack.length, 37), c)) == pytest.approx(1, abs=1e-12)


@cracks
@pytest.mark.parametrize("order", [1, 2, 3, 6])
def test_polynomials_in_arc_length_are_reproduced(mesh, lines, order):
    """From values at NodalPositions, along kinks too, by a different polynomial for each crack."""
    body = body_of(mesh, lines)
    W = TraceSpace(body, order=order)
    f, first = GridFunction(W), 0
    for c, positions in enumerate(W.NodalPositions()):
        for s in positions:
            f.vec[first] = (s - 0.2 - c) ** order
            first += 1
    for c, crack in enumerate(body.cracks):
        s = np.linspace(0, crack.length, 41)
        assert f(on_crack(body, s, c)).ravel() == pytest.approx((s - 0.2 - c) ** order, abs=1e-11)


def test_constants_on_intervals_take_the_value_of_their_interval():
    W = TraceSpace(BODY, order=0)
    f, nodes = random_function(W), np.array(W.basis.division[0])
    values = f(on_crack(BODY, 0.5 * (nodes[1:] + nodes[:-1]))).ravel()
    assert values == pytest.approx(array(f.vec), abs=0)


@cracks
@pytest.mark.parametrize("order", [0, 1, 3])
def test_mass_matrix_is_exact(mesh, lines, order):
    W = TraceSpace(body_of(mesh, lines), order=order)
    u, v = W.TnT()
    usual, higher = (matrix(u * v * W.dcrack(bonus_intorder=b, nodes=W.basis.division)) for b in (0, 6))
    assert abs(usual - higher).max() < 1e-14
    assert matrix(u * v * W.dcrack).sum() == pytest.approx(sum(c.length for c in W.body.cracks), rel=1e-13)


FREE = [[0, 0.1234, 0.13, 0.4, 0.55, Crack(STRAIGHT).length]]


def exact_mass(nodes):
    """Of the hat functions on nodes."""
    mass = np.zeros((len(nodes), len(nodes)))
    for i, length in enumerate(np.diff(nodes)):
        mass[i : i + 2, i : i + 2] += length / 6 * np.array([[2, 1], [1, 2]])
    return mass


def test_free_nodes_with_their_own_measure():
    """W.dcrack divides the rules at the nodes and is exact; body.dcrack does not know them."""
    W = TraceSpace(BODY, order=1, nodes=FREE[0])
    u, v = W.TnT()
    assert W.ndof == len(FREE[0])
    exact = exact_mass(FREE[0])
    assert matrix(u * v * W.dcrack).toarray() == pytest.approx(exact, abs=1e-14)
    assert np.abs(matrix(u * v * BODY.dcrack).toarray() - exact).max() > 1e-4


def test_cracks_with_different_numbers_of_nodes():
    body = CrackedMesh(BODY.mesh, Crack([(0, 0.3), (0.4, 0.3)]), Crack([(1, 0.7), (0.6, 0.7)]))
    W = TraceSpace(body, order=1, nodes=[[0, 0.1, 0.4], [0, 0.1, 0.2, 0.4]])
    assert [len(nodes) for nodes in W.NodalPositions()] == [3, 4]


@pytest.mark.parametrize("order", [0, 1, 2])
def test_free_nodes_coarser_than_the_mesh(order):
    nodes = np.linspace(0, BODY.cracks[0].length, 4)
    W = TraceSpace(BODY, order=order, nodes=list(nodes))
    assert W.ndof == max(3 * order + 1, 3)
    f, degree = GridFunction(W), max(order, 0)
    for i, s in enumerate(W.NodalPositions()[0]):
        f.vec[i] = s**degree
    s = np.linspace(0, nodes[-1], 50)
    assert f(on_crack(BODY, s)).ravel() == pytest.approx(s**degree, abs=1e-12)


def test_coupling_with_displacements():
    """∫λ jump(u)·n by matrix, by linear form and by integral; in the spaces' product, too."""
    V, W = CrackFESpace(BODY, order=2, tip=None), TraceSpace(BODY, order=1)
    u, mu = V.TrialFunction(), W.TestFunction()
    w, lam = random_function(V), random_function(W)
    dcrack = BODY.dcrack(bonus_intorder=2)
    form = BilinearForm(trialspace=V, testspace=W)
    form += mu * InnerProduct(Jump(u), BODY.normal) * dcrack
    with threads():
        form.Assemble()
    value = InnerProduct((form.mat * w.vec).Evaluate(), lam.vec)
    assert value == pytest.approx(Integrate(lam * InnerProduct(Jump(w), BODY.normal) * dcrack, MESH), rel=1e-11)
    load = LinearForm(mu * InnerProduct(Jump(w), BODY.normal) * dcrack).Assemble()
    assert InnerProduct(load.vec, lam.vec) == pytest.approx(value, rel=1e-11)
    product = V * W
    (u, _), (_, mu) = product.TnT()
    both = matrix(mu * InnerProduct(Jump(u), BODY.normal) * dcrack)
    assert array(lam.vec) @ (both[V.ndof :, : V.ndof] @ array(w.vec)) == pytest.approx(value, rel=1e-11)


# The basis of traces


def scaled_mass(W):
    u, v = W.TnT()
    mass = matrix(u * v * W.dcrack).toarray()
    scale = 1 / np.sqrt(mass.diagonal())
    return mass * np.outer(scale, scale)


@pytest.mark.parametrize("name", ["straight", "two", "kinked", "aligned", "through vertices"])
@pytest.mark.parametrize("order", [1, 2])
def test_no_redundant_trace_is_left(name, order):
    assert np.linalg.cond(scaled_mass(TraceSpace(body_of(*CRACKS[name]), order=order, basis="trace"))) < 1e8


def projection_errors(onto, of):
    """Relative L² distance of each function of one space from another one."""
    u, v = onto.TnT()
    (cu, cv), body = of.TnT(), onto.body
    mass = matrix(u * v * onto.dcrack).toarray()
    other = matrix(cu * cv * of.dcrack).toarray()
    mixed = BilinearForm(trialspace=of, testspace=onto)
    mixed += cu * v * body.dcrack
    mixed.Assemble()
    columns = np.array([array((mixed.mat * e.vec).Evaluate()) for e in unit_functions(of)]).T
    rest = other.diagonal() - np.einsum("ij,ij->j", columns, np.linalg.solve(mass, columns))
    return np.abs(rest) / other.diagonal()


def unit_functions(space):
    for i in range(space.ndof):
        function = GridFunction(space)
        function.vec[i] = 1
        yield function


@pytest.mark.parametrize("name", ["straight", "two", "aligned", "through vertices"])
def test_traces_span_what_the_nodal_basis_does_on_straight_cracks(name):
    """Squares of relative distances: 1e-10 is far above round-off of the redundancy test (1e-9 in the squares)."""
    body = body_of(*CRACKS[name])
    nodal, trace = TraceSpace(body, order=1), TraceSpace(body, order=1, basis="trace")
    assert trace.ndof == nodal.ndof
    assert projection_errors(nodal, trace).max() < 1e-10
    assert projection_errors(trace, nodal).max() < 1e-7


def test_nodal_functions_of_traces():
    """A trace basis takes given values at the nodes."""
    trace = TraceSpace(BODY, order=1, basis="trace")
    f, values = GridFunction(trace), np.random.default_rng(0).uniform(-1, 1, trace.ndof)
    f.vec.FV().NumPy()[:] = trace.nodes.functions @ values
    assert f(on_crack(BODY, trace.NodalPositions()[0])).ravel() == pytest.approx(values, abs=1e-12)


@pytest.mark.parametrize("options", [dict(order=0), dict(order=2), dict(order=1, nodes=FREE[0]), dict(order=1, basis="trace")])
def test_pickling(options):
    W = TraceSpace(BODY, **options)
    f = random_function(W)
    W2, body, f2 = pickle.loads(pickle.dumps((W, BODY, f)))
    assert W2.body is body and f2.space.body is body and W2.ndof == W.ndof and W2.basis.division == W.basis.division
    s = np.linspace(0.01, 0.99, 9) * BODY.cracks[0].length
    assert f2(on_crack(body, s)) == pytest.approx(f(on_crack(BODY, s)), abs=0)
    assert Integrate(f2 * W2.dcrack, body.mesh) == pytest.approx(Integrate(f * W.dcrack, MESH), rel=1e-14)


def test_a_multiplier_is_zero_off_its_cracks():
    one = GridFunction(TraceSpace(BODY, order=1))
    one.vec[:] = 1
    uncut = next(i for i in range(MESH.ne) if not BODY.CrackElements(None)[i])
    assert Integrate(one * CF(1 + x + y) * BODY.dx, MESH, element_wise=True)[uncut] == 0
