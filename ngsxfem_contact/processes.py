"""Several processes that mpirun has started: meshes that they share, and what they tell each other.

With one process everything here is the identity, and neither MPI nor mpi4py is looked for.
"""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import scipy
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import Mesh

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from scipy.sparse import csr_matrix

T = TypeVar("T")
__all__ = ["DistributedMesh"]
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


is_acting = False  # whether an action of `together` runs


def together(comm: Any, action: Callable[[], T]) -> T:
    """What action() returns on this process; an exception on one process is raised on all.

    Parameters
    ----------
    comm
        Of mpi4py; None: one process.
    action
        Must not wait for other processes. In an action that is within another one the outer one tells the others.
    """
    global is_acting
    if comm is None or comm.size == 1 or is_acting:
        return action()
    result, error, is_acting = None, None, True
    try:
        result = action()
    except Exception as raised:
        error = raised
    finally:
        is_acting = False
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


def num_imported() -> int:
    """The number of processes that mpi4py knows of, if somebody has imported it; 1 otherwise."""
    MPI = sys.modules.get("mpi4py.MPI")
    return int(MPI.COMM_WORLD.size) if MPI is not None and MPI.Is_initialized() and not MPI.Is_finalized() else 1


works_alone = False


@contextmanager
def alone() -> Iterator[None]:
    """In the block the first process works on a whole mesh without the others, so that such a mesh is no mistake; it must not wait for them there."""
    global works_alone
    before, works_alone = works_alone, True
    try:
        yield
    finally:
        works_alone = before


@dataclass
class Processes:
    """Those that share a mesh; methods are collective, and identities for a single one.

    Attributes
    ----------
    comm
        Of mpi4py; None: a single process.
    """

    comm: Any = None

    @staticmethod
    def Of(mesh: Mesh, what: str) -> Processes:
        """Those of a mesh. Raises NotImplementedError for a mesh of one process only where mpirun has started several: each would solve everything."""
        comm: Any = getattr(mesh, "comm", None)
        size = getattr(comm, "size", 1)
        number = max(num_started(), num_imported())
        if size == 1 and number > 1 and not works_alone:
            raise NotImplementedError(
                f"{what}: this is one of {number} processes, each of which has a whole mesh and would solve everything: share one, mesh = DistributedMesh(make), "
                "make() giving the mesh of Netgen, or start the script without mpirun"
            )
        return Processes(None if size == 1 else comm.mpi4py)

    @property
    def several(self) -> bool:
        """Whether there are others."""
        return self.comm is not None

    @property
    def rank(self) -> int:
        """The number of this one, from 0."""
        return self.comm.rank if self.several else 0

    @property
    def is_first(self) -> bool:
        """Whether this is the one that writes files."""
        return self.rank == 0

    def Refuse(self, what: str, condition: bool = True, instead: str = "start the script without mpirun") -> None:
        """Raises NotImplementedError for what several processes cannot do yet, and says what to do instead."""
        if self.several and condition:
            raise NotImplementedError(f"{what} is not supported by several processes yet: {instead}")

    def Sum(self, value: Any) -> Any:
        """Of numbers, arrays, or sparse matrices, one of each process."""
        if not self.several:
            return value
        if isinstance(value, np.ndarray):
            total = np.empty_like(value, order="C")
            self.comm.Allreduce(np.ascontiguousarray(value), total)
            return total
        return self.comm.allreduce(value)

    def Max(self, value: float) -> float:
        """The largest of the numbers of all; NaN if there is one."""
        return float(np.max(self.Gather(float(value))))

    def Gather(self, value: T) -> list[T]:
        """The values of all, in their order."""
        return self.comm.allgather(value) if self.several else [value]

    def AtFirst(self, value: T) -> list[T]:
        """The values of all, in their order, on the first process; nothing on others."""
        return (self.comm.gather(value) or []) if self.several else [value]

    def FromFirst(self, value: T) -> T:
        """That of the first process: what all have computed for themselves may differ by round-off, and must not lead them to different decisions."""
        return self.comm.bcast(value) if self.several else value

    def Together(self, action: Callable[[], T]) -> T:
        """What action() returns, which must not wait for others; an exception on one process is raised on all."""
        return together(self.comm, action)


@dataclass
class Exchange(Processes):
    """How processes share unknowns.

    An array of values is *consistent* where all who hold an unknown have its value, and *additive* where the sum over them is meant.

    Attributes
    ----------
    shared
        Unknowns that others hold, too.
    numbers
        Of these, from 0, the same for all who hold them.
    total
        How many of those there are.
    master
        (n,), whether an unknown counts here: for each exactly one process says so.
    owned
        (n,), whether own elements have it.
    interface
        Those that own elements of several processes have: positions in `shared`.
    """

    shared: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    numbers: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    total: int = 0
    master: np.ndarray = field(default_factory=lambda: np.ones(0, dtype=bool))
    owned: np.ndarray = field(default_factory=lambda: np.ones(0, dtype=bool))
    interface: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    def Cumulated(self, additive: np.ndarray) -> np.ndarray:
        """A consistent array from an additive one."""
        if not self.several:
            return additive
        parts = np.zeros(self.total)
        parts[self.numbers] = additive[self.shared]
        consistent = additive.copy()
        consistent[self.shared] = self.Sum(parts)[self.numbers]
        return consistent

    def Dot(self, additive: np.ndarray, consistent: np.ndarray) -> float:
        """The product of two vectors, the same to the last bit on all processes."""
        return float(sum(self.Gather(float(additive @ consistent))))

    def Numbers(self, size: int) -> np.ndarray:
        """(size,): a number for each unknown, of which this process has `size`, on which all agree."""
        numbers = np.arange(size) + self.total + sum(self.Gather(size)[: self.rank])
        numbers[self.shared] = self.numbers
        return numbers

    def CumulatedRows(self, additive: csr_matrix) -> csr_matrix:
        """A sparse matrix with consistent rows from one with additive rows."""
        if not self.several:
            return additive
        others = np.ones(additive.shape[0])
        others[self.shared] = 0
        place = scipy.sparse.csr_matrix((np.ones(len(self.shared)), (self.shared, self.numbers)), shape=(additive.shape[0], self.total))
        return (scipy.sparse.diags(others) @ additive + place @ self.Sum((place.T @ additive).tocsr())).tocsr()

    def Additive(self, consistent: Any) -> Any:
        """An additive array, or a matrix with additive columns, from a consistent one."""
        if not self.several:
            return consistent
        return consistent * self.master if isinstance(consistent, np.ndarray) else consistent.multiply(self.master[None, :]).tocsr()

    def Count(self, size: int) -> int:
        """The number of different unknowns, of which this process has a number."""
        return int(self.Sum(int(self.master.sum()))) if self.several else size

    def NumInterface(self) -> int:
        """The number of different unknowns that own elements of several processes have."""
        return len(np.unique(np.concatenate(self.Gather(self.numbers[self.interface]))))

    def Rank(self, dofs: np.ndarray) -> np.ndarray:
        """Numbers of shared unknowns that put them in an order on which all agree."""
        if not self.several:
            return dofs
        return self.numbers[np.searchsorted(self.shared, dofs)]
