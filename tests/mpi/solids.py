"""Bodies in space for several processes: `mpirun -n 3 python tests/mpi/solids.py FOLDER NAME ...` solves some, all without names, and writes what was found to FOLDER/NAME.npz.

As solutions.py; multipliers, which are numbered as elements are, are put in the order of their positions.
"""

import sys
from pathlib import Path

import numpy as np
from netgen.csg import unit_cube
from netgen.occ import Box, Glue, OCCGeometry
from ngsolve import CF, x, y
from ngsolve.meshes import MakeStructured3DMesh

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, Elasticity, TraceSpace, Tresca
from ngsxfem_contact.algebra.matrices import csr_view
from ngsxfem_contact.contact.solver import ReducedProblem
from ngsxfem_contact.processes import DistributedMesh
from ngsxfem_contact.sheets import Sheet
from ngsxfem_contact.spaces.exchange import exchange_of
from ngsxfem_contact.spaces.negligible import negligible_functions

STEEL, STIFF = Elasticity.Solid(E=210e3, nu=0.3), Elasticity.Solid(E=630e3, nu=0.2)
DISK = Sheet.Disk((0.5, 0.5, 0.5), (0.2, 0.1, 1), 0.32)
EDGE = Sheet.Polygon([(-1, -1, 0.47), (0.52, -1, 0.53), (0.52, 2, 0.53), (-1, 2, 0.47)])


def cube(maxh=0.3):
    return lambda: unit_cube.GenerateMesh(maxh=maxh)


def two_regions():
    """A cube with a stiffer layer on the right."""
    soft, stiff = Box((0, 0, 0), (0.7, 1, 1)).mat("soft"), Box((0.7, 0, 0), (1, 1, 1)).mat("stiff")
    solid = Glue([soft, stiff])
    for face in solid.faces:
        face.name = "bottom" if face.center.z < 1e-9 else "top" if face.center.z > 1 - 1e-9 else "side"
    return OCCGeometry(solid).GenerateMesh(maxh=0.3)


def body(*sheets, make=cube(), order=1, multipliers=0, material=STEEL, law=None, dirichlet="bottom", load=CF((20, 10, 20)), **options):
    """A ContactProblem."""
    cracked = CrackedMesh(DistributedMesh(make), *sheets)
    V = CrackFESpace(cracked, order=order, material=material(cracked.mesh) if callable(material) else material, dirichlet=dirichlet)
    problem = ContactProblem(V, TraceSpace(cracked, order=multipliers), law=law, **options)
    problem.f += load * V.TestFunction() * cracked.ds("top")
    problem.f += CF((0, 0, -3)) * V.TestFunction() * cracked.dx
    return problem


def bent():
    """Part of the disk is open, part in contact."""
    return body(DISK, make=cube(0.25), load=CF((20, 10 * y, 200 * (x - 0.55))))


def slip():
    """Friction that sticks here and slips there."""
    return body(DISK, make=cube(0.25), law=Coulomb(0.5), load=CF((40, 10, -200 * x)))


def quadratic():
    return body(DISK, order=2, make=cube(0.35), law=Tresca(5.0), load=CF((40, 10, -100)))


def linear_multipliers():
    return body(DISK, multipliers=1, load=CF((40, 10, -100)))


def edge():
    """A straight front from face to face, and K along it."""
    return body(EDGE, make=cube(0.2))


def edge_in_contact():
    return body(EDGE, make=cube(0.25), law=Coulomb(0.2), load=CF((40, 10, -100)))


def through():
    """Two parts, both held, with displacements given."""
    problem = body(Sheet.Polygon([(-1, -1, 0.45), (2, -1, 0.55), (2, 2, 0.55), (-1, 2, 0.45)]), dirichlet="bottom|top")
    problem.SetDirichlet(CF((0, 0, -1e-4 * (1 + x))), "top")
    return problem


def slivers():
    """The sheet passes vertices of the mesh at a millionth of an element."""
    sheet = Sheet.Polygon([(-1, -1, 0.5 + 2e-7), (0.6, -1, 0.5 + 2e-7), (0.6, 2, 0.5 + 2e-7), (-1, 2, 0.5 + 2e-7)])
    return body(sheet, make=lambda: MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4).ngmesh, load=CF((20, 10, -50)))


def along_faces():
    """The sheet runs along faces of the mesh, some of them between processes."""
    sheet = Sheet.Polygon([(-1, -1, 0.5), (0.6, -1, 0.5), (0.6, 2, 0.5), (-1, 2, 0.5)])
    return body(sheet, make=lambda: MakeStructured3DMesh(hexes=False, nx=4, ny=4, nz=4).ngmesh, load=CF((20, 10, -50)))


def regions():
    """Two materials, pins and springs."""
    sheet = Sheet.Disk((0.35, 0.5, 0.5), (0, 0, 1), 0.27)
    problem = body(sheet, make=two_regions, material=lambda mesh: Elasticity.ByRegion(mesh, {"soft": STEEL, "stiff": STIFF}), dirichlet="")
    u, v = problem.V.TnT()
    for point, components in (((0, 0, 0), "xyz"), ((1, 0, 0), "yz"), ((0, 1, 0), "z")):
        problem.Pin(point, components)
    problem.a += 100 * u * v * problem.body.ds("bottom")
    return problem


def curved():
    """A sheet that is an arc in the plane y = const, from face to face."""
    arc = Crack.Arc((-0.2, 0.4), (0.3, 0.5), (0.7, 0.4))
    return body(Sheet.Extrude(arc, (0, 3, 0), origin=(0, -1, 1), x_axis=(1, 0, 0)), make=cube(0.2), load=CF((20, 10, 10)))


CASES = {case.__name__: case for case in (bent, slip, quadratic, linear_multipliers, edge, edge_in_contact, through, slivers, along_faces, regions, curved)}
WITH_K = ("edge",)


def by_position(places):
    return np.lexsort(np.round(np.array(places).T, 8))


def facts(name, folder):
    """What does not depend on how unknowns are numbered."""
    problem = CASES[name]()
    reduced = ReducedProblem(problem)
    solution, exchange = reduced.Solve(), exchange_of(problem.V)
    own = lambda values: values[exchange.master] if exchange.several else values
    system, square_sum = reduced.system, lambda values: exchange.Sum(float(values @ values))
    diagonal, F = own(exchange.Cumulated(csr_view(system.stiffness).diagonal())), own(exchange.Cumulated(reduced.case.F))
    nodes, profile, components = system.nodes, solution.Profile(), len(problem.law.components)
    order = by_position(nodes.positions)
    of_all = np.concatenate([order + k * len(order) for k in range(components)])
    rows = by_position(np.column_stack([profile.x, profile.y, profile.z]))
    reactions = solution.Reactions()
    found = {
        "unknowns": np.array([*solution.report.unknowns, problem.V.num_heaviside, len(problem.V.front_nodes), problem.V.num_left_out]),
        "negligible": np.array(len(negligible_functions(system.stiffness, problem.V, problem.free))),
        "counts": np.array(list(solution.report.Counts().values())),
        "forms": np.array([exchange.Sum(float(diagonal.sum())), square_sum(diagonal), square_sum(F)]),
        "EE": (system.E @ system.E.T).toarray()[np.ix_(of_all, of_all)], "D": system.D.toarray()[np.ix_(of_all, of_all)],
        "S": reduced.S[np.ix_(of_all, of_all)], "g": reduced.case.g[of_all], "L": solution.state.L[of_all],
        "active": np.array(solution.report.active[-1])[order], "energies": np.array([solution.Energy(), solution.PotentialEnergy()]),
        "U": np.array(square_sum(own(solution.u.vec.FV().NumPy()))), "force": np.array([solution.ContactForce(0)]),
        "gap": profile.gap[rows], "slip": profile.slip[rows], "pressure": profile.sigma_n[rows], "words": np.array(profile.state[rows]),
        "reactions": np.array([row.force for row in reactions]), "supports": np.array([row.name for row in reactions]),
    }  # fmt: skip
    if name in WITH_K:
        table = solution.Table()
        found |= {"K": np.array([table[key] for key in ("K_I", "K_II", "K_III")]), "released": np.array(table["G"])}
        found |= {"errors": np.array([table[f"{key}_error"] for key in ("K_I", "K_II", "K_III", "G")])}
        assert solution.SaveVTK(folder / "solid") == str(folder / "solid.vtu")
    for key, values in found.items():
        assert all(np.array_equal(values, other) for other in exchange.Gather(values)), key
    return found, exchange.is_first


if __name__ == "__main__":
    folder, *names = Path(sys.argv[1]), *sys.argv[2:]
    for name in names or CASES:
        found, is_first = facts(name, folder)
        if is_first:
            np.savez(folder / f"{name}.npz", **found)
