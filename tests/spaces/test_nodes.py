"""Nodes of multipliers: positions, weights, neighbours, nodal functions; of a TraceSpace and of Nitsche's method."""

import numpy as np
import pytest
from helpers import matrix, rectangle, structured, vector
from ngsolve import CF, GridFunction, x, y

from ngsxfem_contact import Crack, CrackedMesh, TraceSpace
from ngsxfem_contact.contact.cones import CONES
from ngsxfem_contact.contact.nitsche import CrackPoints
from ngsxfem_contact.protocols import Nodes

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.AccuracyWarning")  # coarse on purpose

MESH = rectangle(0.15)
BODIES = {
    "kinked": CrackedMesh(MESH, Crack([(0, 0.43), (0.37, 0.52), (0.72, 0.47)])),
    "two": CrackedMesh(MESH, Crack([(0, 0.31), (0.6, 0.3)]), Crack([(0.3, 0.7), (1, 0.74)])),
    "arc": CrackedMesh(MESH, Crack.Arc((0.25, 0.3), (0.4, 0.52), (0.7, 0.5))),
    "aligned": CrackedMesh(structured(6), Crack([(0, 0.5), (0.6, 0.5)])),
    "curves": CrackedMesh(MESH, Crack.Spline([(0, 0.4), (0.2, 0.46), (0.45, 0.41)]), Crack.Arc((0.6, 0.2), (0.7, 0.25), (0.8, 0.2))),
}
KINDS = {
    "order 0": lambda body: TraceSpace(body, order=0).nodes, "order 1": lambda body: TraceSpace(body, order=1).nodes,
    "order 4": lambda body: TraceSpace(body, order=4).nodes, "points": lambda body: CrackPoints(body, 3),
    "own": lambda body: TraceSpace(body, order=1, nodes=[np.linspace(0, crack.length, 5) for crack in body.cracks]).nodes,
}  # fmt: skip
bodies = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
kinds = pytest.mark.parametrize("nodes_of", KINDS.values(), ids=KINDS.keys())


@kinds
def test_all_kinds_have_what_is_asked_for(nodes_of):
    nodes = nodes_of(BODIES["two"])
    assert all(hasattr(nodes, name) for name in vars(Nodes) if not name.startswith("_")) and len(nodes) > 4
    n = len(nodes)
    shapes = [part.shape for part in (nodes.cracks, nodes.positions, nodes.weights, nodes.functions, nodes.mass)]
    assert shapes == [(n,), (n, 2), (n,), (n, n), (n, n)]


@bodies
@kinds
def test_positions_lie_on_the_crack(body, nodes_of):
    nodes = nodes_of(body)
    for c, position in zip(nodes.cracks, nodes.positions):
        crack = body.cracks[c]
        assert crack.PointAt(crack.ArcLength(tuple(position))) == pytest.approx(tuple(position), abs=1e-14)
    assert nodes.Values(x) == pytest.approx(nodes.positions[:, 0], abs=1e-14)
    assert nodes.Values(y) == pytest.approx(nodes.positions[:, 1], abs=1e-14)
    assert nodes.Values(body.crack_number) == pytest.approx(nodes.cracks, abs=0)


@bodies
@kinds
def test_weights_sum_to_the_lengths(body, nodes_of):
    nodes = nodes_of(body)
    lengths = [nodes.weights[nodes.cracks == c].sum() for c in range(len(body.cracks))]
    assert lengths == pytest.approx([crack.length for crack in body.cracks], rel=1e-12) and (nodes.weights > 0).all()


@bodies
@kinds
def test_neighbours_are_the_next_on_the_same_crack(body, nodes_of):
    """By brute force: no node of the crack lies between them; symmetric, as pairs without an order, each once."""
    nodes = nodes_of(body)
    s, pairs = nodes.arclengths, nodes.neighbours
    assert len({frozenset(pair) for pair in pairs.tolist()}) == len(pairs) == len(nodes) - len(body.cracks)
    for i, j in pairs:
        on = nodes.cracks == nodes.cracks[i]
        assert nodes.cracks[j] == nodes.cracks[i] and not (on & (s > min(s[i], s[j])) & (s < max(s[i], s[j]))).any()


@pytest.mark.parametrize("options", [dict(order=0), dict(order=1), dict(order=3), dict(order=1, basis="trace")])
def test_weights_and_mass_are_integrals_of_nodal_functions(options):
    W = TraceSpace(BODIES["two"], **options)
    nodes, (lam, mu) = W.nodes, W.TnT()
    assert nodes.weights == pytest.approx(nodes.functions.T @ vector(mu * W.dcrack), abs=1e-8 if "basis" in options else 1e-14)
    assert nodes.mass.sum() == pytest.approx(nodes.weights.sum(), rel=1e-7)
    assert nodes.mass == pytest.approx(nodes.functions.T @ matrix(lam * mu * W.dcrack).toarray() @ nodes.functions, abs=1e-14)


@pytest.mark.parametrize("options", [dict(order=0), dict(order=1), dict(order=2, basis="trace")])
@pytest.mark.parametrize("cone", CONES.values(), ids=CONES.keys())
def test_cones_are_changes_of_variables(options, cone):
    """T takes the values that a cone gives to nodal values back to a function with these."""
    W = TraceSpace(BODIES["two"], **options)
    nodes, function = W.nodes, GridFunction(W)
    nodal = np.random.default_rng(1).uniform(-1, 1, len(nodes))
    function.vec.FV().NumPy()[:] = cone.Transformation(nodes) @ cone.Values(nodes, nodal)
    assert nodes.Values(CF(function)) == pytest.approx(nodal, abs=1e-9)
    assert cone is CONES["nonpositive"] or cone.Values(nodes, nodal) == pytest.approx(
        nodes.functions.T @ vector(function * W.TestFunction() * W.dcrack(bonus_intorder=2)), abs=1e-9
    )


def test_traces_without_a_sign_for_each_node_are_refused():
    """A bent crack has more restrictions than points at which it meets edges."""
    W = TraceSpace(BODIES["arc"], order=1, basis="trace")
    assert W.ndof != len(W.NodalPositions()[0])
    with pytest.raises(ValueError, match=f"{W.ndof} independent traces for {len(W.NodalPositions()[0])} nodes, .* use basis='nodal'"):
        W.nodes


def test_places_in_words():
    nodes = TraceSpace(BODIES["two"], order=1).nodes
    assert nodes.Place(0) == "arc length 0 of crack 0" and nodes.Place(len(nodes) - 1) == f"arc length {np.hypot(0.7, 0.04):.6g} of crack 1"
