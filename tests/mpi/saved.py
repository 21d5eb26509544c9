"""Files of solutions: `mpirun -n 3 python tests/mpi/saved.py save FOLDER` solves some problems and saves them, `load FOLDER NAME` reads them and goes on.

What is read from each solution is written to FOLDER/CASE.npz, or FOLDER/CASE.NAME.npz, which other numbers of processes find, too.
"""

import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI
from netgen.geom2d import unit_square
from ngsolve import CF, H1, GridFunction, x, y
from solutions import EDGE, INCLINED, STEEL, body, curved, table_of

from ngsxfem_contact import ContactProblem, ContactSolution, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, Jump, LoadSteps, TraceSpace
from ngsxfem_contact.contact import LinearCohesive, PathSteps
from ngsxfem_contact.fracture import GivenIncrement

COMM = MPI.COMM_WORLD


def square():
    return unit_square.GenerateMesh(maxh=0.12)


def edge():
    """P3, whose functions of edges have directions."""
    return body(EDGE, make=square, order=3)


def crossing():
    """Functions with several copies."""
    return body(INCLINED, Crack([(0.48, 0.25), (0.52, 0.75)]))


def through():
    """Given displacements, pins, springs, a force in a point, a GridFunction, pressure on the faces, and two mouths."""
    problem = body(Crack([(0, 0.5), (1, 0.52)]), make=square, dirichlet="bottom|top", on="left|right", gap=1e-6 * x)
    u, v = problem.V.TnT()
    field = GridFunction(H1(problem.body.mesh, order=3))
    field.Set(x * y * y)
    problem.f += v[1](0.31, 0.87)
    problem.f += 20 * field * v[0] * problem.body.dx
    problem.a += 100 * u * v * problem.body.ds("right") + 50 * Jump(u) * Jump(v) * problem.body.dcrack
    problem.FacePressure(3 * x)
    problem.SetDirichlet((0, -1e-4 * (1 + x)), "top")
    return problem


def pinned():
    """A vertex inside, which one process has, is held."""
    problem = body(INCLINED, make=square, dirichlet="", load=CF((0, 50 * (y - 0.5) * 4)), on="top|bottom")
    problem.Pin((0, 0), "xy")
    problem.Pin((1, 1), "x", 1e-5)
    return problem


def slip():
    return body(INCLINED, make=square, law=Coulomb(0.1), load=CF((30, -100)))


def traced():
    """Multipliers that are numbered as vertices are."""
    return body(EDGE, make=square, order=1, basis="trace")


def torn():
    """Glue, torn in steps whose load is found."""
    return body(EDGE, make=square, order=1, law=LinearCohesive(strength=60, G_c=0.05), load=CF((0, 100)))


def of_regions():
    """Curved elements, and two materials."""
    return curved(2)


CASES = [edge, crossing, through, pinned, slip, traced, torn, of_regions]


def solved(problem):
    """The solution that is saved; of glue a point of a path."""
    if problem().law.__class__ is not LinearCohesive:
        return problem().Solve()
    steps = PathSteps(problem())
    return [steps.Solve(2e-4) for _ in range(2)][-1]


def facts(solution, name=""):
    """What a user reads."""
    profile, tips = solution.Profile(), range(len(solution.body.tips))
    found = {
        "energies": [solution.Energy(), solution.PotentialEnergy(), solution.DissipatedEnergy()],
        "reactions": [component for row in solution.Reactions() for component in row.force],
        "K": [[*solution.StressIntensity(tip), *solution.StressIntensity(tip, method="modes")] for tip in tips],
        **{column: profile[column] for column in ("gap", "slip", "sigma_n", "sigma_t")},
    }
    return {f"{name}{key}": np.array(values) for key, values in found.items()}


def further(solution):
    """The next step, and growth, from a solution."""
    problem, mesh = solution.problem, solution.body.share.source
    if solution.state.path:
        return facts(PathSteps(problem, previous=solution).Solve(2e-4), "next ")
    found = facts(problem.Solve(previous=solution), "next ")
    if isinstance(problem.law, Coulomb):
        steps = LoadSteps(problem)
        steps.last = solution
        found |= facts(steps.Solve(0.3), "back ")

        def make(cracks):
            cracked = CrackedMesh(mesh, *cracks)
            grown = ContactProblem(CrackFESpace(cracked, order=1, material=STEEL, dirichlet="bottom"), TraceSpace(cracked))
            grown.f += CF((30, 100)) * grown.V.TestFunction() * cracked.ds("top")
            return grown

        found |= {"grown": table_of(CrackGrowth(make, solution.body.cracks, GivenIncrement(0.1)), 2)["rows"]}
    return found


def written(path, solution):
    found = facts(solution) | further(solution)
    for key, values in found.items():
        assert all(np.array_equal(values, other) for other in COMM.allgather(values)), key
    if COMM.rank == 0:
        np.savez(path, **found)


if __name__ == "__main__":
    what, folder = sys.argv[1], Path(sys.argv[2])
    for case in CASES:
        file = folder / f"{case.__name__}.solution"
        if what == "save":
            solution = solved(case)
            assert solution.Save(file) == file
            written(folder / f"{case.__name__}.npz", solution)
        else:
            written(folder / f"{case.__name__}.{sys.argv[3]}.npz", ContactSolution.Load(file))
