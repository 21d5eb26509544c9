"""The test of section 4 of [AHLMR12]: Ω = ]0,1[ × ]-½,½[, Γ_C = ]0,½[ × {0}, loads A, B, C and A/4, a quarter of A's traction.

docs/paper.md: the load as printed in the paper (A) opens the crack on its whole length; its authors'
program applies B (later C), whose contact pressure and gap depend on the body force only.
"""

from dataclasses import dataclass
from math import pi
from typing import Any

from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh, cos, sin, specialcf, x, y

from ngsxfem_contact.contact.problem import ContactProblem
from ngsxfem_contact.contact.stabilisation import BarbosaHughes
from ngsxfem_contact.geometry import Crack, CrackedMesh
from ngsxfem_contact.material import Elasticity
from ngsxfem_contact.spaces.crack_fespace import CrackFESpace, TipEnrichment
from ngsxfem_contact.spaces.trace_space import TraceSpace

MATERIAL = Elasticity(lam=1, mu=1)

BODY_FORCE = CF((0, 3.5 * x * (1 - x) * y * cos(2 * pi * x)))

TRACTION = {
    "A": CF((0, 0.04 * sin(2 * pi * y))),
    "A/4": CF((0, 0.01 * sin(2 * pi * y))),
    "B": 0.04 * sin(2 * pi * y) * specialcf.normal(2),
    "C": 0.4 * sin(2 * pi * y) * specialcf.normal(2),
}


# Boundary-fitted hp solutions, independent of this package: ½a(u,u), ∫λ, end of the opening (arc length), K_I and K_II.
REFERENCE: dict[str, dict[str, Any]] = {
    "A/4": {"energy": 2.9008736e-4, "contact_force": -0.00567768, "transition": 0.365140, "K_I": 0.0, "K_II": 0.0},
    "A": {"energy": 0.00117393376, "contact_force": 0.0, "transition": None, "K_I": 0.0457374, "K_II": 0.0},
    "B": {"energy": 3.40135917e-4, "contact_force": -0.01035791, "transition": 0.2641001, "K_I": 0.0, "K_II": -0.00790112},
    "C": {"energy": 0.0129971992, "contact_force": -0.01035791, "transition": 0.2641001, "K_I": 0.0, "K_II": -0.0790112},
}

# The same with friction, one load step from zero: work of friction ∫λ_t g_t, ∫λ_t, changes between slip and stick.
FRICTION_REFERENCE = {
    "C, Coulomb 0.3": {
        "energy": 0.0129048965, "friction_work": 8.67283831e-5, "contact_force": -0.0103579205, "tangential_force": -0.00310737614,
        "transition": 0.264100101, "slip_transition": None, "K_II": -0.064866789,
    },
    "C, Tresca 0.05": {
        "energy": 0.012167274, "friction_work": 2.66536403e-4, "contact_force": -0.010357911, "tangential_force": -0.0243486523,
        "transition": 0.264100101, "slip_transition": 0.466587363, "K_II": 0.0,
    },
    "A/4, Coulomb 0.3": {
        "energy": 2.9008736e-4, "friction_work": 0.0, "contact_force": -0.00567768478, "tangential_force": 0.0,
        "transition": 0.365139871, "slip_transition": None, "K_II": 0.0,
    },
}  # fmt: skip


@dataclass(frozen=True)
class Pair:
    """Orders of the displacement and the multiplier; bubble: P1+."""

    order: int
    multiplier_order: int
    bubble: bool = False


PAIRS = {"P2/P1": Pair(2, 1), "P2/P0": Pair(2, 0), "P1+/P1": Pair(1, 1, bubble=True), "P1/P1": Pair(1, 1), "P1/P0": Pair(1, 0)}


def unstructured_mesh(h):
    """Of the body, boundaries "bottom", "right", "top", "left"; h is the paper's, half the longest edges: maxh = 2h."""
    geometry = SplineGeometry()
    corners = [geometry.AppendPoint(*p) for p in ((0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5))]
    for i, name in enumerate(("bottom", "right", "top", "left")):
        geometry.Append(["line", corners[i], corners[(i + 1) % 4]], bc=name)
    return Mesh(geometry.GenerateMesh(maxh=2 * h))


def varied_mesh(h, realisation):
    """Unstructured meshes of nearly the same size that differ: maxh = 2h, 2h·0.98, 2h·1.02, 2h·0.96, ..."""
    return unstructured_mesh(h * (1 + 0.02 * ((realisation + 1) // 2) * (-1) ** realisation))


def paper_problem(
    mesh, load="B", pair="P2/P1", stabilisation=BarbosaHughes(), cone="nonpositive", tip=TipEnrichment(material=MATERIAL, order=1), law=None, length=0.5
):
    """The ContactProblem on a mesh of the body; load: a key of TRACTION; pair: a key of PAIRS; length of the crack. The paper has √r alone at the tip."""
    body = CrackedMesh(mesh, Crack([(0, 0), (length, 0)]))
    orders = PAIRS[pair]
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip)
    W = TraceSpace(body, order=orders.multiplier_order)
    problem = ContactProblem(V, W, MATERIAL, stabilisation=stabilisation, cone=cone, law=law)
    add_loads(problem, load)
    return problem


def add_loads(problem, load, pressure=0):
    """The paper's forces, a pressure on the top and the bottom, and what holds the body."""
    v, body = problem.V.TestFunction(), problem.body
    problem.f += BODY_FORCE * v * body.dx(bonus_intorder=6) + TRACTION[load] * v * body.ds("left|right", bonus_intorder=6)
    if pressure:
        problem.f += CF((0, -pressure)) * v * body.ds("top") + CF((0, pressure)) * v * body.ds("bottom")
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
