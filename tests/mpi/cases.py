"""What several processes do: `mpirun -n 3 python tests/mpi/cases.py NAME` runs the case of that name and prints "passed" on each of them."""

import sys

from mpi4py import MPI
from netgen.geom2d import SplineGeometry, unit_square
from ngsolve import CF, IfPos, Integrate, Mesh, dx, sqrt, x, y

from ngsxfem_contact import BarbosaHughes, ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, Nitsche, TraceSpace
from ngsxfem_contact.contact import Coercivity, ConditionNumber, InfSup, PathSteps
from ngsxfem_contact.errors import SingularSystem
from ngsxfem_contact.plotting import plot_body
from ngsxfem_contact.processes import DistributedMesh, together
from ngsxfem_contact.spaces import Interpolant, Projection

COMM = MPI.COMM_WORLD
STEEL = Elasticity.PlaneStrain(E=210e3, nu=0.3)
INCLINED, THROUGH = Crack([(0.3, 0.45), (0.7, 0.55)]), Crack([(0, 0.5), (1, 0.52)])


def square(maxh=0.15):
    return unit_square.GenerateMesh(maxh=maxh)


def disk():
    geometry = SplineGeometry()
    geometry.AddCircle((0, 0), 1)
    return geometry.GenerateMesh(maxh=0.3)


def refused(action, kind, *words):
    """Whether action() is refused with the same words on all processes; none of them waits for another one."""
    message = None
    try:
        action()
    except kind as error:
        message = str(error)
    messages = COMM.allgather(message)
    assert all(message is not None and all(word in message for word in words) for message in messages), messages
    return messages


def distributed_mesh():
    """All elements are there, once."""
    mesh = DistributedMesh(square)
    assert COMM.allreduce(mesh.ne) == COMM.bcast(Mesh(square()).ne if COMM.rank == 0 else None)
    assert abs(COMM.allreduce(Integrate(CF(1) * dx, mesh)) - 1) < 1e-14
    assert mesh.comm.size == COMM.size


def errors_are_raised_on_all():
    """Whichever process fails, and where make() does."""
    assert together(COMM, lambda: COMM.rank) == COMM.rank
    for failing in range(COMM.size):
        messages = refused(lambda failing=failing: together(COMM, lambda: 1 / (COMM.rank - failing)), ZeroDivisionError, "division by zero")
        assert [message.startswith("process") for message in messages] == [rank != failing for rank in range(COMM.size)]

    def wrong():
        raise KeyError("no mesh today")

    refused(lambda: DistributedMesh(wrong), KeyError, "no mesh today")
    refused(lambda: DistributedMesh(lambda: 3), TypeError, "not a mesh of Netgen")


def a_mesh_of_each_process_is_refused():
    """It would solve everything several times."""
    if COMM.size > 1:
        refused(lambda: CrackedMesh(Mesh(square()), INCLINED), NotImplementedError, f"one of {COMM.size} processes", "DistributedMesh")


def problem(crack=INCLINED, make=square, material=STEEL, load=(0, 1), **options):
    body = CrackedMesh(DistributedMesh(make), crack)
    V = CrackFESpace(body, order=2, material=material, dirichlet=options.pop("dirichlet", "bottom"), tip=None)
    problem = ContactProblem(V, TraceSpace(body), **options)
    problem.f += CF(load) * V.TestFunction() * body.ds("top")
    return problem


def what_is_not_supported_is_refused():
    """In words, the same on all processes, before any work."""
    if COMM.size == 1:
        return
    words = "not supported by several processes"
    curved = DistributedMesh(disk)
    curved.Curve(2)
    solution = problem().Solve()
    for action in (
        lambda: CrackedMesh(curved, Crack([(-0.2, 0), (0.3, 0)])),
        lambda: TraceSpace(solution.body, basis="trace"),
        lambda: problem(stabilisation=Nitsche()),
        lambda: problem(material=Elasticity.PlaneStrain(E=1, nu=0.4999)),
        lambda: problem(THROUGH, dirichlet="bottom", load=(0, -1)).Solve(),  # the upper part is held by contact and by nothing else
        lambda: problem(stabilisation=BarbosaHughes(gamma0=1)).Solve(),
        lambda: problem().Solve(inverse="sparsecholesky"),
        lambda: Coercivity(solution.problem),
        lambda: ConditionNumber(solution.problem),
        lambda: InfSup(solution.problem.V, solution.problem.W),
        lambda: Interpolant(solution.problem.V, (0, 0)),
        lambda: Projection(solution.problem.V, (0, 0)),
        lambda: PathSteps(solution.problem),
        lambda: solution.Save("body.solution"),
        solution.Draw,
        lambda: plot_body(solution),
    ):
        refused(action, NotImplementedError, words)
    refused(lambda: CrackedMesh(solution.body.mesh, INCLINED), NotImplementedError, "DistributedMesh")  # growth, and what is read from a file


def what_is_wrong_is_refused_on_all():
    """Also where one process alone sees it."""
    refused(lambda: problem(THROUGH, dirichlet="bottom|top").Pin((0.123, 0.5), "x"), ValueError, "no mesh vertex")
    refused(lambda: problem(Crack([(0.2, 0.5), (2, 3), (0.4, 0.5)])), Exception, "leaves the body")
    refused(lambda: problem(dirichlet="").Solve(), SingularSystem, "3 rigid motion(s)")
    nowhere = IfPos((x - 0.85) ** 2 + (y - 1) ** 2 - 0.01, 0, sqrt(-1 - x))
    refused(lambda: problem(load=(0, nowhere)).Solve(), ValueError, "the load `f` is not finite")


def an_error_of_one_process_ends_all():
    """Run by a test of its own: the others wait for it."""
    solved = problem()
    if COMM.rank == COMM.size - 1:
        raise RuntimeError("of one process")
    solved.Solve()


CASES = [distributed_mesh, errors_are_raised_on_all, a_mesh_of_each_process_is_refused, what_is_not_supported_is_refused, what_is_wrong_is_refused_on_all]

if __name__ == "__main__":
    globals()[sys.argv[1]]()
    sys.stdout.write("passed\n")  # in one piece: lines of several processes do not mix
