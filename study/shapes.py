"""Three problems beside the paper's: a circular arc, two cracks, a kinked crack, with boundary-fitted reference values.

All on Ω = ]0,1[ × ]-½,½[, λ_L = μ_L = 1, body force and load C of `paper`, pins as there.
"""

from dataclasses import dataclass

from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh

from ngsxfem_contact.contact.problem import ContactProblem
from ngsxfem_contact.contact.stabilisation import BarbosaHughes
from ngsxfem_contact.geometry import Crack, CrackedMesh
from ngsxfem_contact.spaces.crack_fespace import CrackFESpace, TipEnrichment
from ngsxfem_contact.spaces.trace_space import TraceSpace

from .paper import BODY_FORCE, MATERIAL, PAIRS, TRACTION

KINK = (0.3, 0.02)


@dataclass(frozen=True)
class Shape:
    """A problem of this module.

    Parameters
    ----------
    pressure
        An additional traction (0, -pressure) on the top and (0, pressure) on the bottom.
    energy
        ½a(u,u).
    contact_force
        ∫λ on each crack.
    transitions
        Arc lengths at which contact begins or ends, on each crack.
    K
        (K_I, K_II) at each tip. From boundary-fitted hp solutions (p = 7 to 10, graded meshes) that are independent of this package; energies to 1e-10,
        forces to 1e-8, K to 1e-6, relative.
    """

    cracks: tuple
    pressure: float
    energy: float
    contact_force: tuple
    transitions: tuple
    K: tuple


SHAPES = {
    "arc": Shape((Crack.Arc((0, 0), (0.25, 0.05), (0.5, 0)),), 0, 0.0131360698, (-0.0162790993,), ((0.333137744,),), ((0.0, -0.0580771372),)),
    "two-cracks": Shape(
        (Crack([(0, 0.1), (0.4, 0.1)]), Crack([(0.63, -0.12), (1, -0.12)])), 0.05, 0.013516351,
        (-0.022577768, -0.0235970259), ((0.170034865,), ()), ((0.0, -0.071921491), (0.0, 0.0477563261)),
    ),
    "kinked": Shape(
        (Crack([(0, 0.02), KINK, (0.52, 0.13)]),), 0.02, 0.0140286407,
        (-0.00277683439,), ((0.267763691, 0.3),), ((0.00508379798, -0.156925256),),
    ),
}  # fmt: skip


def body_mesh(maxh, refined_at=None, size=None):
    """Unstructured, boundaries "bottom", "right", "top", "left"; with elements of about `size` at a point, growing linearly."""
    geometry = SplineGeometry()
    corners = [geometry.AppendPoint(*p) for p in ((0, -0.5), (1, -0.5), (1, 0.5), (0, 0.5))]
    for i, name in enumerate(("bottom", "right", "top", "left")):
        geometry.Append(["line", corners[i], corners[(i + 1) % 4]], bc=name)
    if refined_at is None:
        return Mesh(geometry.GenerateMesh(maxh=maxh))
    from netgen.meshing import MeshingParameters

    parameters = MeshingParameters(maxh=maxh, grading=0.2)
    parameters.RestrictH(x=refined_at[0], y=refined_at[1], z=0, h=size)
    return Mesh(geometry.GenerateMesh(mp=parameters))


def shape_problem(name, mesh, pair="P2/P1", stabilisation=BarbosaHughes(), tip=TipEnrichment(material=MATERIAL)):
    """The ContactProblem of a key of SHAPES on a mesh of the body; pair: a key of `paper.PAIRS`."""
    shape, orders = SHAPES[name], PAIRS[pair]
    body = CrackedMesh(mesh, *shape.cracks)
    V = CrackFESpace(body, order=orders.order, bubble=orders.bubble, tip=tip)
    problem = ContactProblem(V, TraceSpace(body, order=orders.multiplier_order), MATERIAL, stabilisation=stabilisation)
    v = V.TestFunction()
    problem.f += BODY_FORCE * v * body.dx(bonus_intorder=6) + TRACTION["C"] * v * body.ds("left|right", bonus_intorder=6)
    if shape.pressure:
        problem.f += CF((0, -shape.pressure)) * v * body.ds("top") + CF((0, shape.pressure)) * v * body.ds("bottom")
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    return problem


def deviations(name, solution):
    """Relative deviations from the reference: energy, the worst of the contact forces, the worst K (to the largest |K|)."""
    shape = SHAPES[name]
    force = max(abs(solution.ContactForce(c) / exact - 1) for c, exact in enumerate(shape.contact_force))
    K = [abs(k - e) for tip, exact in enumerate(shape.K) for k, e in zip(solution.StressIntensity(tip), exact)]
    return {"energy": abs(solution.Energy() / shape.energy - 1), "contact_force": force, "K": max(K) / max(abs(k) for exact in shape.K for k in exact)}
