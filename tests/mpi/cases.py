"""What several processes do: `mpirun -n 3 python tests/mpi/cases.py NAME` runs the case of that name and prints "passed" on each of them."""

import sys

from mpi4py import MPI
from netgen.geom2d import unit_square
from ngsolve import CF, Integrate, Mesh, dx

from ngsxfem_contact import Crack, CrackedMesh
from ngsxfem_contact.processes import DistributedMesh, together

COMM = MPI.COMM_WORLD


def square(maxh=0.3):
    return unit_square.GenerateMesh(maxh=maxh)


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


def what_is_not_supported_is_refused():
    """Before any work, the same on all processes: a mesh of each process, and one that they share."""
    if COMM.size == 1:
        return
    for mesh in (Mesh(square()), DistributedMesh(square)):
        refused(lambda mesh=mesh: CrackedMesh(mesh, Crack([(0.3, 0.5), (0.7, 0.5)])), NotImplementedError, f"one of {COMM.size} processes", "without mpirun")


CASES = [distributed_mesh, errors_are_raised_on_all, what_is_not_supported_is_refused]

if __name__ == "__main__":
    next(case for case in CASES if case.__name__ == sys.argv[1])()
    sys.stdout.write("passed\n")  # in one piece: lines of several processes do not mix
