"""Several processes that mpirun has started: meshes that they share, and what they tell each other.

With one process everything here is the identity, and neither MPI nor mpi4py is looked for.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any, TypeVar

from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")
SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")  # what OpenMPI and MPICH tell the processes that they start


def num_started() -> int:
    """How many processes mpirun has started with this one; 1 without it."""
    return max(int(os.environ.get(name, 1)) for name in SIZES)


def world() -> Any:
    """mpi4py's communicator of all processes that mpirun has started; None for one process. Raises ImportError where several find no mpi4py."""
    if num_started() == 1:
        return None
    try:
        from mpi4py import MPI
    except ImportError as error:
        raise ImportError(f"this is one of {num_started()} processes that mpirun has started, and these need mpi4py: pip install mpi4py") from error
    return MPI.COMM_WORLD


def together(comm: Any, action: Callable[[], T]) -> T:
    """What action() returns on this process; an exception on one process is raised on all.

    Parameters
    ----------
    comm
        Of mpi4py; None: one process.
    action
        Must not wait for other processes.
    """
    if comm is None or comm.size == 1:
        return action()
    result, error = None, None
    try:
        result = action()
    except Exception as raised:
        error = raised
    of_all = comm.allgather(None if error is None else (type(error), str(error)))
    if error is not None:
        raise error
    for rank, failed in enumerate(of_all):
        if failed is not None:
            raise same_kind(failed[0], f"process {rank}: {failed[1]}")
    return result  # type: ignore[return-value]


def same_kind(kind: type[Exception], message: str) -> Exception:
    """An exception like that of another process."""
    try:
        return kind(message)
    except TypeError:  # one that is not made of a message
        return RuntimeError(f"{kind.__name__}: {message}")


def DistributedMesh(make: Callable[[], NetgenMesh], comm: Any = None) -> Mesh:
    """The Mesh of which each process holds a part, in NGSolve's way; Mesh(make()) for one process.

    Parameters
    ----------
    make
        Gives the whole mesh of Netgen, as `lambda: unit_square.GenerateMesh(maxh=0.1)`; it is called by one process only.
    comm
        mpi4py's communicator; default all processes that mpirun has started.

    Raises
    ------
    ImportError
        Where several processes find no mpi4py.
    TypeError
        Unless make() gives a mesh of Netgen.
    Exception
        What make() raises, on all processes.

    Notes
    -----
    Of n processes, n > 1, NGSolve lets n - 1 hold elements; the first one has none.

    Examples
    --------
    >>> from netgen.geom2d import unit_square
    >>> from ngsxfem_contact.processes import DistributedMesh
    >>> DistributedMesh(lambda: unit_square.GenerateMesh(maxh=0.5)).nv  # under mpirun the number on this process
    8
    """
    comm = world() if comm is None else comm
    whole = together(comm, lambda: made(make) if comm is None or comm.rank == 0 else None)
    if comm is None or comm.size == 1:
        return Mesh(whole)
    if whole is not None:
        whole.Distribute(comm)
        return Mesh(whole)
    return Mesh(NetgenMesh.Receive(comm))


def made(make: Callable[[], NetgenMesh]) -> NetgenMesh:
    """make(), checked."""
    mesh = make()
    if not isinstance(mesh, NetgenMesh):
        raise TypeError(f"DistributedMesh: make() gives {mesh!r}, not a mesh of Netgen as `lambda: unit_square.GenerateMesh(maxh=0.1)` does")
    return mesh


def check_one_process(comm: Any, what: str) -> None:
    """Raises NotImplementedError if mpirun has started several processes, the same on all of them.

    Parameters
    ----------
    comm
        That of a mesh, which may be distributed or not, or None.
    what
        The name of what is refused.
    """
    number = max(num_started(), num_imported(), getattr(comm, "size", 1))
    if number > 1:
        raise NotImplementedError(
            f"{what}: this is one of {number} processes, and a cracked body is solved by one process so far: start the script without mpirun; "
            "more threads are used inside `with TaskManager():`"
        )


def num_imported() -> int:
    """The number of processes that mpi4py knows of, if somebody has imported it; 1 otherwise."""
    MPI = sys.modules.get("mpi4py.MPI")
    return int(MPI.COMM_WORLD.size) if MPI is not None and MPI.Is_initialized() and not MPI.Is_finalized() else 1
