"""Contact problems for several processes: `mpirun -n 3 python tests/mpi/solutions.py FOLDER NAME ...` solves some, all without names, and writes what was found to FOLDER/NAME.npz.

The script is that of one process, but for `DistributedMesh`. What processes share is summed here by `Exchange`, so that it can be compared whatever their number.
"""

import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI
from netgen.geom2d import SplineGeometry, unit_square
from ngsolve import CF, Integrate, x, y
from ngsolve.meshes import MakeStructured2DMesh

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, Elasticity, Jump, LoadSteps, Nitsche, TraceSpace
from ngsxfem_contact.algebra.matrices import csr_view
from ngsxfem_contact.algebra.multigrid import is_available
from ngsxfem_contact.contact import Coercivity, InfSup, LinearCohesive, PathSteps
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.fracture import GivenIncrement, JunctionInitiation, StressInitiation
from ngsxfem_contact.points import crack_points
from ngsxfem_contact.processes import DistributedMesh, Processes
from ngsxfem_contact.spaces import Interpolant, Projection
from ngsxfem_contact.spaces.exchange import exchange_of
from ngsxfem_contact.spaces.negligible import negligible_functions

STEEL = Elasticity.PlaneStrain(E=210e3, nu=0.3)
BENDING = CF((20 * y, 100 * (x - 0.6)))


def square():
    return unit_square.GenerateMesh(maxh=0.07)


def two_regions():
    """A square with a stiffer strip on the right, and a round hole."""
    geometry = SplineGeometry()
    points = [geometry.AppendPoint(*point) for point in ((0, 0), (0.8, 0), (1, 0), (1, 1), (0.8, 1), (0, 1))]
    for a, b, left, right, name in (
        (0, 1, 1, 0, "bottom"),
        (1, 2, 2, 0, "bottom"),
        (2, 3, 2, 0, "right"),
        (3, 4, 2, 0, "top"),
        (4, 5, 1, 0, "top"),
        (5, 0, 1, 0, "left"),
        (1, 4, 1, 2, "inner"),
    ):
        geometry.Append(["line", points[a], points[b]], leftdomain=left, rightdomain=right, bc=name)
    geometry.SetMaterial(1, "soft")
    geometry.SetMaterial(2, "stiff")
    geometry.AddCircle((0.25, 0.8), 0.08, leftdomain=0, rightdomain=1, bc="hole")
    return geometry.GenerateMesh(maxh=0.08)


def coarse():
    return unit_square.GenerateMesh(maxh=0.1)


def body(
    *cracks,
    make=square,
    order=2,
    law=None,
    material=STEEL,
    dirichlet="bottom",
    load=BENDING,
    on="top",
    weight=CF((0, -3 * x)),
    basis="nodal",
    curve=1,
    **options,
):
    """A ContactProblem."""
    mesh = DistributedMesh(make)
    if curve > 1:
        mesh.Curve(curve)
    cracked = CrackedMesh(mesh, *cracks)
    V = CrackFESpace(cracked, order=order, material=material(cracked.mesh) if callable(material) else material, dirichlet=dirichlet)
    problem, v = ContactProblem(V, TraceSpace(cracked, order=1, basis=basis), law=law, **options), V.TestFunction()
    problem.f += load * v * cracked.ds(on)
    problem.f += weight * v * cracked.dx
    return problem


EDGE, INCLINED, KINKED = Crack([(0, 0.5), (0.5, 0.5)]), Crack([(0.3, 0.45), (0.7, 0.55)]), Crack([(0.3, 0.3), (0.45, 0.4), (0.7, 0.35)])


def edge(order):
    return body(EDGE, order=order)


def several(order):
    return body(KINKED, Crack([(0, 0.7), (0.4, 0.75)]), order=order)


def crossing(order):
    return body(INCLINED, Crack([(0.48, 0.25), (0.52, 0.75)]), order=order)


def arc(order):
    return body(Crack.Arc((0.3, 0.45), (0.5, 0.55), (0.7, 0.45)), order=order)


def through(order):
    """Both parts are held, and displacements are given."""
    problem = body(Crack([(0, 0.5), (1, 0.52)]), order=order, dirichlet="bottom|top", on="left|right")
    problem.SetDirichlet((0, -1e-4 * (1 + x)), "top")
    return problem


def slivers(order):
    """The crack passes mesh vertices at a millionth of an element."""
    return body(Crack([(0, 0.5 + 7e-8), (0.5, 0.5 + 7e-8)]), order=order)


def regions(order):
    """Two materials, and a hole."""
    stiff = lambda mesh: Elasticity.ByRegion(mesh, {"soft": STEEL, "stiff": Elasticity.PlaneStrain(E=630e3, nu=0.2)})
    return body(Crack([(0.3, 0.5), (0.6, 0.55)]), make=two_regions, order=order, material=stiff)


def curved(order):
    """From the hole, whose elements are curved, to the interface of two materials."""
    stiff = lambda mesh: Elasticity.ByRegion(mesh, {"soft": STEEL, "stiff": Elasticity.PlaneStrain(E=630e3, nu=0.2)})
    return body(Crack([(0.3, 0.74), (0.5, 0.5)]), make=two_regions, curve=3, order=order, material=stiff)


def along_edges(order):
    """The crack runs along edges of the mesh, some of them between processes, where equals have to be decided in the same way."""
    return body(EDGE, make=lambda: MakeStructured2DMesh(quads=False, nx=14, ny=14).ngmesh, order=order)


def slip(order):
    """Friction that slips."""
    return body(INCLINED, order=order, law=Coulomb(0.1), load=CF((30, -100)))


def pinned(order):
    """Held by two pins, under loads in balance, with a spring."""
    problem = body(INCLINED, order=order, dirichlet="", load=CF((0, 50 * (y - 0.5) * 4)), on="top|bottom", weight=CF((0, 0)))
    u, v = problem.V.TnT()
    problem.Pin((0, 0), "xy")
    problem.Pin((1, 0), "y")
    problem.a += 100 * u * v * problem.body.ds("right")
    return problem


def propped(order):
    """Held by pins at a corner and inside, with forces in points and a foundation."""
    problem = body(INCLINED, make=structured, order=order, dirichlet="", load=CF((0, 50 * (y - 0.5) * 4)), on="top|bottom", weight=CF((0, 0)))
    u, v = problem.V.TnT()
    problem.Pin((0, 0), "xy")
    problem.Pin((0.8, 0.8), "y", 1e-5)
    problem.Pin((0.8, 0.2), "y")
    problem.f += v[1](0.31, 0.87)
    problem.f += v[0](0.6, 0.13)
    problem.a += 100 * u * v * problem.body.dx
    return problem


def structured():
    return MakeStructured2DMesh(quads=False, nx=15, ny=15).ngmesh


def block(order):
    """The upper part is held by friction alone."""
    return body(Crack([(0, 0.5), (1, 0.52)]), make=coarse, order=order, law=Coulomb(0.6), load=CF((10, -100)))


def held_mouth(order):
    """The crack begins on a boundary that is held."""
    return body(EDGE, make=coarse, order=order, dirichlet="left", on="right|top")


def points(order):
    """Nitsche's method."""
    return body(EDGE, make=coarse, order=order, stabilisation=Nitsche())


def points_with_friction(order):
    """The same, coercive for every γ, whose rows are not each other's transposes."""
    return body(INCLINED, make=coarse, order=order, law=Coulomb(0.1), load=CF((30, -100)), stabilisation=Nitsche(theta=-1))


def incompressible(order):
    """Rubber, whose divergence is projected."""
    return body(EDGE, make=lambda: unit_square.GenerateMesh(maxh=0.14), order=order, material=Elasticity.PlaneStrain(E=210e3, nu=0.4999))


def heated(order):
    """Given stresses, with K in them."""
    return body(
        INCLINED,
        make=coarse,
        order=order,
        material=Elasticity.PlaneStrain(E=210e3, nu=0.3, alpha=1e-5),
        temperature=30 * x * y,
        initial_stress=CF((0, 0, 0, 20 * x), dims=(2, 2)),
    )


def traced(order):
    """Multipliers that are traces of functions of the mesh."""
    return body(EDGE, make=coarse, order=order, basis="trace")


def torn(order):
    """Glue, torn step by step."""
    return body(EDGE, make=coarse, order=order, law=LinearCohesive(strength=60, G_c=0.05), load=CF((0, 100)))


CASES = {
    f"{case.__name__}_P{order}": (case, order)
    for case, orders in (
        (edge, (1, 2, 3)),
        (several, (3,)),
        (crossing, (2,)),
        (arc, (2,)),
        (through, (1, 2)),
        (slivers, (2,)),
        (regions, (2,)),
        (curved, (2,)),
        (along_edges, (1, 2)),
        (slip, (1, 2)),
        (pinned, (2,)),
        (propped, (2,)),
        (block, (2,)),
        (held_mouth, (2,)),
        (points, (1,)),
        (points_with_friction, (2,)),
        (incompressible, (2,)),
        (heated, (2,)),
        (traced, (1,)),
        (torn, (1,)),
    )
    for order in orders
}


def facts(problem, folder):
    """What does not depend on how unknowns are numbered; the body in its last shape is written to body.vtu."""
    reduced = ReducedProblem(problem)
    solution, exchange = reduced.Solve(), exchange_of(problem.V)
    own = lambda values: values[exchange.master] if exchange.several else values
    system, square_sum = reduced.system, lambda values: exchange.Sum(float(values @ values))
    diagonal, F = own(exchange.Cumulated(csr_view(system.stiffness).diagonal())), own(exchange.Cumulated(reduced.case.F))
    found = {
        "unknowns": np.array([*solution.report.unknowns, problem.V.num_heaviside]),
        "negligible": np.array(len(negligible_functions(system.stiffness, problem.V, problem.free))),
        "counts": np.array(list(solution.report.Counts().values())),
        "forms": np.array([exchange.Sum(float(diagonal.sum())), square_sum(diagonal), square_sum(F)]),
        "EE": (system.E @ system.E.T).toarray(), "D": system.D.toarray(), "S": reduced.S, "g": reduced.case.g, "L": solution.state.L,
        "active": np.array(solution.report.active), "energies": np.array([solution.Energy(), solution.PotentialEnergy()]),
        "U": np.array(square_sum(own(solution.u.vec.FV().NumPy()))),
        "force": np.array([solution.ContactForce(c) for c in range(len(problem.body.cracks))]), "gap": solution.Profile().gap, "pressure": solution.Profile().sigma_n,
        "tips": np.array([tip.clearance for tip in problem.body.tips]),
        "K": np.array([[*solution.StressIntensity(tip), *solution.StressIntensity(tip, method="modes")] for tip in range(len(problem.body.tips))]),
        "released": np.array([solution.EnergyReleaseRate(tip).G for tip in range(len(problem.body.tips))]),
    }  # fmt: skip
    reactions = solution.Reactions()
    found |= {"reactions": np.array([row.force for row in reactions]), "supports": np.array([row.name for row in reactions])}
    assert solution.SaveVTK(folder / "body") == str(folder / "body.vtu")
    return found, exchange


def by_conjugate_gradients(problem):
    """What they find, which is approximate."""
    solution = problem.Solve(inverse="cg")
    assert solution.report.inverse == "cg" and 0 < max(solution.report.linear_iterations) <= 45
    return {
        "cg active": np.array(solution.report.active[-1]),
        "cg L": solution.state.L,
        "cg energies": np.array([solution.Energy(), solution.PotentialEnergy()]),
        "cg K": np.array([[*solution.StressIntensity(tip)] for tip in range(len(problem.body.tips))]),
    }


def steps(problem, inverse=None, name="step"):
    """Load steps forth and back."""
    load = LoadSteps(problem, inverse=inverse)
    return {f"{name} {t}": load.Solve(t).state.L for t in (0.5, 1.0, 0.3)}


def hoop(problem):
    """The stress around the crossing."""
    around = JunctionInitiation(strength=1.0, length=0.2, radius=0.1)
    return {"hoop": np.nan_to_num(around.HoopStress(problem.Solve(), np.array([0.5, 0.5]), np.linspace(0, 2 * np.pi, 72, endpoint=False)))}


def path(problem):
    """Steps whose load is found."""
    steps = PathSteps(problem)
    last = [steps.Solve(2e-4) for _ in range(3)][-1]
    return {"loads": np.array(steps.table["t"]), "path": last.state.L}


def table_of(growth, steps):
    """Numbers and words of the states of a growth."""
    table = growth.Run(steps)
    words = np.array([f"{row['name']} {row['end']} {row['state'].partition(':')[0]}" for row in table])
    return {
        "counts": table["step"],
        "words": words,
        "rows": np.array([np.nan_to_num(table[column].astype(float)) for column in ("x", "y", "length", "K_I", "K_II", "driving", "angle", "stress")]),
    }


def grown():
    """A crack that turns as it grows, and others that start on the boundary and in the body."""
    mesh = DistributedMesh(coarse)

    def make(cracks):
        body = CrackedMesh(mesh, *cracks)
        V = CrackFESpace(body, order=1, material=STEEL, dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body))
        problem.f += CF((-40, 100)) * V.TestFunction() * body.ds("top")
        return problem

    return table_of(CrackGrowth(make, [EDGE], GivenIncrement(0.1), initiation=StressInitiation(240, 0.1, 0.25)), 3)


def started():
    """A crack in a body that had none."""
    mesh = DistributedMesh(lambda: MakeStructured2DMesh(quads=False, nx=12, ny=12, mapping=lambda x, y: (1.8 * x - 0.9, 1.8 * y - 0.9)).ngmesh)

    def make(cracks):
        body = CrackedMesh(mesh, *cracks)
        V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(1, 0), dirichlet=".*")
        problem = ContactProblem(V, TraceSpace(body))
        problem.f += CF((x, 3 * y)) * V.TestFunction() * body.dx
        problem.SetDirichlet(CF((0, y - y**3 / 3 - x * x * y)), ".*")
        return problem

    return table_of(CrackGrowth(make, [], GivenIncrement(0.4), toughness=9.0, initiation=StressInitiation(0.9, 0.2, 0.6)), 2)


def functions():
    """Functions of V_h from given ones, and the inf-sup constant."""
    cracked = CrackedMesh(DistributedMesh(coarse), KINKED)
    V, W, share = CrackFESpace(cracked, order=2, material=STEEL, dirichlet="bottom"), TraceSpace(cracked), cracked.share
    norm = lambda u: share.Sum(Integrate(share.Own(u * u * cracked.dx), cracked.mesh))
    plus, minus = CF((x * y, y)), CF((0, x))
    interpolated = Interpolant(V, plus, minus, tips=[[1, 2], [3, 4]])
    crack = np.linspace(0, cracked.cracks[0].length, 20)
    return {
        "norms": np.array([norm(interpolated), norm(Projection(V, plus)), norm(Projection(V, interpolated) - interpolated)]),
        "jumps": np.array([Jump(interpolated)(point) for point in crack_points(cracked, 0, crack)]),
        "inf_sup": np.array([InfSup(V, W)]),
    }


STUDIES = {study.__name__: study for study in (grown, started, functions)}


def solved(name, folder):
    """The facts of a case or a study, the same on all processes, and whether this process writes them."""
    if name in STUDIES:
        found, share = STUDIES[name](), Processes(MPI.COMM_WORLD)
        return same_on_all(found, share), share.is_first
    case, order = CASES[name]
    problem = case(order)
    found, exchange = facts(problem, folder)
    if case is not incompressible and is_available():
        found |= by_conjugate_gradients(problem)
    if case is traced:  # whose multipliers are numbered as the vertices are
        found |= {
            "S": np.linalg.eigvalsh(found["S"]),
            "g": np.sort(found["g"]),
            "L": np.sort(found["L"]),
            "EE": np.sort(found["EE"].diagonal()),
            "D": np.sort(found["D"].diagonal()),
            **{key: np.sort(found[key]) for key in ("cg L",) if key in found},
        }
    if case in (slip, torn, crossing):
        found |= {slip: steps, torn: path, crossing: hoop}[case](problem)
    if case is slip:
        found |= (steps(problem, "cg", "cg step") if is_available() else {}) | {"coercivity": np.array([Coercivity(problem)])}
    return same_on_all(found, exchange), exchange.is_first


def same_on_all(found, processes):
    """The same, checked."""
    for key, values in found.items():
        assert all(np.array_equal(values, other) for other in processes.Gather(values)), key
    return found


if __name__ == "__main__":
    folder, *names = Path(sys.argv[1]), *sys.argv[2:]
    for name in names or [*CASES, *STUDIES]:
        found, is_first = solved(name, folder)
        if is_first:
            np.savez(folder / f"{name}.npz", **found)
