"""Problems of all kinds, and the numbers that are read from their solutions."""

import numpy as np
import pytest
from netgen.geom2d import SplineGeometry, unit_square
from netgen.occ import Circle as OccCircle
from netgen.occ import OCCGeometry, Rectangle, Y
from ngsolve import CF, H1, Grad, GridFunction, InnerProduct, Mesh, Parameter, Sym, VectorH1, exp, specialcf, x, y

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, Jump, Nitsche, TipEnrichment, TraceSpace, Tresca
from ngsxfem_contact.algebra import FixedPoint
from ngsxfem_contact.contact import BothSides, Dugdale, ExponentialCohesive, Joint, LinearCohesive, MohrCoulomb

MATERIAL = Elasticity.PlaneStrain(E=1, nu=0.3)
TIP = Crack([(0, 0.5), (0.5, 0.52)])


def square(h=0.2):
    return Mesh(unit_square.GenerateMesh(maxh=h))


def refined():
    mesh = square(0.3)
    for el in mesh.Elements():
        mesh.SetRefinementFlag(el, any(0.3 < mesh[v].point[1] < 0.7 for v in el.vertices))
    mesh.Refine()
    return mesh


def with_hole(order=3):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"])
    geometry.AddCircle((0.5, 0.5), 0.15, leftdomain=0, rightdomain=1, bc="hole")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.15))
    mesh.Curve(order)
    return mesh


def occ_plate():
    face = Rectangle(1, 1).Face() - OccCircle((0.5, 0.5), 0.15).Face()
    face.edges.Min(Y).name, face.edges.Max(Y).name = "bottom", "top"
    mesh = Mesh(OCCGeometry(face, dim=2).GenerateMesh(maxh=0.15))
    mesh.Curve(2)
    return mesh


def two_materials():
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*p) for p in ((0, 0), (1, 0), (1, 0.3), (0, 0.3), (1, 1), (0, 1))]
    for a, b, left, right, name in (
        (0, 1, 1, 0, "bottom"),
        (1, 2, 1, 0, "right"),
        (2, 3, 1, 2, "inner"),
        (3, 0, 1, 0, "left"),
        (2, 4, 2, 0, "right"),
        (4, 5, 2, 0, "top"),
        (5, 3, 2, 0, "left"),
    ):
        geometry.Append(["line", points[a], points[b]], leftdomain=left, rightdomain=right, bc=name)
    geometry.SetMaterial(1, "layer.1")
    geometry.SetMaterial(2, "rock")
    return Mesh(geometry.GenerateMesh(maxh=0.2))


class Case:
    """A body, its spaces, and the problem of a load factor."""

    def __init__(self, mesh=square, cracks=(TIP,), order=2, multiplier=1, space=(), trace=(), material=MATERIAL, dirichlet="bottom", load=None, **problem):
        self.mesh, self.cracks, self.order, self.multiplier, self.space, self.trace = mesh, cracks, order, multiplier, space, trace
        self.material, self.dirichlet, self.options, self.load = material, dirichlet, problem, load or push

    def Spaces(self):
        mesh = self.mesh()
        cracks = self.cracks(mesh) if callable(self.cracks) else self.cracks
        body, material = CrackedMesh(mesh, *cracks), self.material(mesh) if callable(self.material) else self.material
        V = CrackFESpace(body, order=self.order, material=material, dirichlet=self.dirichlet, **dict(self.space))
        return V, TraceSpace(body, order=self.multiplier, **dict(self.trace))

    def Problem(self, V, W, t):
        options = self.options["make"](V, W) if "make" in self.options else self.options
        problem = ContactProblem(V, W, **options)
        self.load(problem, V.TestFunction(), t)
        return problem


def push(problem, v, t):
    problem.f += CF((0.1 * t, -1 + 0.3 * x)) * v * problem.body.ds("top")


def pull(problem, v, t):
    problem.f += 0.15 * t * v[1] * problem.body.ds("top")


def everything(problem, v, t):
    """Each kind of load and support."""
    body, u = problem.body, problem.V.TrialFunction()
    field, vector = GridFunction(H1(body.mesh, order=2)), GridFunction(VectorH1(body.mesh, order=2))
    field.Set(0.1 * x * y)
    vector.Set((0.1 * x * y, 0.05 * x))
    problem.f += field * v[0] * body.dx(bonus_intorder=2) + Parameter(0.2 * t) * v[1] * body.dx
    problem.f += -0.3 * InnerProduct(specialcf.normal(2), v) * body.ds("right|top") + CF((0.1 * t, -0.3)) * v * body.ds(body.mesh.Boundaries("top"))
    problem.f += (-0.05 * v[1])(0.9, 0.9)
    problem.f += -Sym(Grad(vector))[0, 1] * Grad(v)[0, 1] * body.dx
    problem.FacePressure(0.02 * exp(x), crack=0)
    problem.FaceTraction(plus=(0.01, 0))
    problem.a += 0.5 * u * v * body.ds("left") + 0.2 * Jump(u) * Jump(v) * body.dcrack
    problem.SetDirichlet((0.001 * x, 0), "bottom")


def level_set(mesh):
    return [Crack.LevelSet(mesh, y - 0.45 - 0.2 * (x - 0.5) ** 2, x - 0.7)]


CASES = {
    "friction": Case(law=Coulomb(0.4)),
    "friction, fixed point, function": Case(law=Coulomb(0.3 + 0.1 * x, method=FixedPoint())),
    "given threshold": Case(law=Tresca(0.1)),
    "given threshold, where closed": Case(law=Tresca(0.1 * x, in_contact_only=True), order=3, multiplier=2),
    "frictionless, P1, P0": Case(order=1, multiplier=0),
    "P1, bubble": Case(order=1, space={"bubble": True}, law=Coulomb(0.2)),
    "branch functions": Case(space={"tip": TipEnrichment(functions="branch")}, law=Coulomb(0.2)),
    "no tip functions": Case(space={"tip": None}, law=Coulomb(0.2)),
    "material said to the problem": Case(material=None, make=lambda V, W: {"material": MATERIAL, "law": Coulomb(0.2)}),
    "Nitsche": Case(stabilisation=Nitsche(1), law=Coulomb(0.4)),
    "Nitsche, theta 0": Case(stabilisation=Nitsche(0)),
    "both sides": Case(stabilisation=BothSides(0.01), law=Coulomb(0.3)),
    "weak cone": Case(cone="weak", law=Tresca(0.1)),
    "gap": Case(gap=0.002 * (1 + x), law=Coulomb(0.4)),
    "traces": Case(trace={"basis": "trace"}, law=Coulomb(0.3)),
    "nodes of its own": Case(trace={"nodes": np.linspace(0, TIP.length, 5).tolist()}, law=Coulomb(0.3)),
    "refined": Case(refined, law=Coulomb(0.4)),
    "refined, everything": Case(refined, law=Coulomb(0.4), load=everything),
    "everything": Case(load=everything, law=Coulomb(0.4)),
    "given stresses": Case(
        material=Elasticity.PlaneStrain(1, 0.3, alpha=0.01),
        make=lambda V, W: {"initial_stress": CF((-0.3, 0.1 * x, 0.1 * x, -0.5), dims=(2, 2)), "temperature": 3 * x, "law": Coulomb(0.4)},
    ),
    "several": Case(cracks=(TIP, Crack.Arc((0.6, 0.3), (0.75, 0.36), (0.9, 0.3)), Crack([(0.3, 1), (0.35, 0.75)])), law={0: Coulomb(0.3), 2: Joint(5, 1)}),
    "crossing": Case(cracks=(Crack([(0.2, 0.4), (0.8, 0.6)]), Crack([(0.45, 0.8), (0.55, 0.2)])), law=Coulomb(0.3)),
    "from side to side": Case(cracks=(Crack([(0, 0.5), (1, 0.52)]),), law={0: Coulomb(0.9)}),
    "closed": Case(cracks=(Crack([(0.3, 0.3), (0.7, 0.35), (0.5, 0.7), (0.3, 0.3)]),), law={0: Coulomb(0.3)}),
    "spline": Case(lambda: square(0.3), cracks=(Crack.Spline([(0.2, 0.4), (0.4, 0.5), (0.6, 0.45), (0.8, 0.55)]),), law=Coulomb(0.3)),
    "level set": Case(lambda: square(0.3), order=1, cracks=level_set, law=Coulomb(0.3)),
    "curved boundary": Case(with_hole, cracks=(Crack([(0, 0.5), (0.4, 0.52)]), Crack([(0.6, 0.5), (0.85, 0.45)])), law=Coulomb(0.3)),
    "curved boundary of CAD": Case(occ_plate, cracks=(Crack([(0, 0.52), (0.5, 0.5)]),), law=Coulomb(0.3)),
    "regions": Case(
        two_materials,
        material=lambda mesh: Elasticity.ByRegion(mesh, {"rock": Elasticity.PlaneStrain(1, 0.3), r"layer\.1": Elasticity.PlaneStress(2, 0.2)}),
        law=Coulomb(0.3),
    ),
    "rubber": Case(material=Elasticity.PlaneStrain(1, 0.4999), law=Coulomb(0.3)),
    "rollers": Case(dirichlet="", space={"dirichletx": "left", "dirichlety": "bottom"}, cracks=(Crack([(0.3, 0.5), (0.7, 0.55)]),), law=Coulomb(0.3)),
    "linear cohesive": Case(law=LinearCohesive(0.1, 0.01), load=pull),
    "exponential cohesive": Case(law=ExponentialCohesive(0.1 + 0.02 * x, 0.02), load=pull),
    "plastic": Case(law=MohrCoulomb(0.3, cohesion=0.01, dilation=0.1)),
    "Dugdale": Case(law={0: Dugdale(0.2)}, load=pull),
}


def numbers(solution):
    """What a user reads."""
    rows = [
        *solution.u(solution.body.mesh(0.83, 0.21)),
        *solution.u(solution.body.mesh(0.2, 0.7)),
        solution.Energy(),
        solution.PotentialEnergy(),
        solution.DissipatedEnergy(),
    ]
    rows += [solution.FaceEnergy(), solution.DissipationError(), solution.VonMises()(solution.body.mesh(0.83, 0.21))]
    for crack in range(len(solution.body.cracks)):
        profile = solution.Profile(crack, n=9)
        rows += [
            solution.ContactForce(crack),
            solution.TangentialForce(crack),
            *profile.gap,
            *profile.slip,
            *profile.sigma_n,
            *profile.sigma_t,
            *solution.Transitions(crack),
        ]
    for row in solution.Reactions():
        rows += [*row.force, row.moment]
    return np.array(rows)


def factors(solution, name):
    """K and G where there is room for them; of few tips where their integrals take long."""
    found, few = [], {"spline": 1, "level set": 1, "several": 1, "refined, everything": 0}
    for tip in range(few.get(name, len(solution.body.tips))):
        for read in (solution.StressIntensity, solution.EnergyReleaseRate):
            try:
                value = read(tip)
                found += [*value, value.error] if read == solution.StressIntensity else [value.G]
            except ValueError:
                found.append(0.0)
    return np.array(found)


def same(a, b, tolerance=1e-14):
    assert a.shape == b.shape
    assert np.nan_to_num(a) == pytest.approx(np.nan_to_num(b), rel=tolerance, abs=tolerance * max(1, np.nanmax(np.abs(b), initial=0)))


def solved(name="friction"):
    case = CASES[name]
    V, W = case.Spaces()
    return case.Problem(V, W, 6).Solve()
