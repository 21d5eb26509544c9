"""The direct solver for many processes, substructuring, beside PETSc's MUMPS on the same matrix.

python benchmarks/beside_mumps.py --sizes 0.01 0.006 --numbers 1 3 4

Needs mpirun, mpi4py, and petsc4py with MUMPS beside NGSolve: on Debian 12 `apt-get install python3-petsc4py-real`, an environment of `/usr/bin/python3 -m venv --system-site-packages` with this package, and
PYTHONPATH=/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages. An inclined crack in a unit square, P2, on some numbers of processes, of which n - 1
hold elements. "CPU s" and "wall s" are of the process that has most: of substructuring for the factors and S = K A⁻¹Kᵀ; of MUMPS (Cholesky's factors of the assembled A, METIS) for PETSc's matrix, for the factors alone, and
for S by one block of right-hand sides. The difference of both S is relative to the largest entry.
"""

import argparse
import json
import sys
import time

import numpy as np
from processes import measured
from results import recorded

MEMORY = "200"  # ICNTL(14): per cent of working space beyond MUMPS's estimate, which is too small for indefinite or distributed matrices


class Clock:
    """CPU and wall seconds since the last call."""

    def __init__(self, comm):
        self.comm = comm
        self()

    def __call__(self):
        self.comm.Barrier()
        now = np.array([time.process_time(), time.perf_counter()])
        passed, self.now = (now - self.now if hasattr(self, "now") else now), now
        return passed.tolist()


def handed_over(maxh):
    """(matrix, inner, K, exchange) that the elimination hands to its direct solver."""
    from netgen.geom2d import unit_square
    from ngsolve import CF

    from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, DistributedMesh, Elasticity, TraceSpace
    from ngsxfem_contact.algebra import elimination
    from ngsxfem_contact.contact.solver import ReducedProblem

    body = CrackedMesh(DistributedMesh(lambda: unit_square.GenerateMesh(maxh=maxh)), Crack([(0.3, 0.45), (0.7, 0.55)]))
    V = CrackFESpace(body, order=2, material=Elasticity.PlaneStrain(E=210e3, nu=0.3), dirichlet="bottom")
    problem = ContactProblem(V, TraceSpace(body))
    problem.f += CF((20, -100)) * V.TestFunction() * body.ds("top")
    handed, solver = [], elimination.Substructuring

    class Recording(solver):
        def __init__(self, *arguments):
            handed.append(arguments)
            super().__init__(*arguments)

    elimination.Substructuring = Recording
    ReducedProblem(problem, inverse="substructuring")
    elimination.Substructuring = solver
    return handed[0]


def assembled(matrix, inner, exchange):
    """PETSc's A on the unknowns of a BitArray and its numbers (-1: not in it) of the unknowns of this process."""
    from petsc4py import PETSc

    from ngsxfem_contact.algebra.matrices import csr_view, mask

    master = exchange.master if exchange.several else np.ones(matrix.height, dtype=bool)
    chosen = mask(inner)
    counted = int((chosen & master).sum())
    first = sum(exchange.Gather(counted)[: exchange.rank]) if exchange.several else 0
    numbers = np.zeros(matrix.height)
    numbers[chosen & master] = first + np.arange(counted) + 1
    numbers = np.round(exchange.Cumulated(numbers) if exchange.several else numbers).astype(np.int32) - 1
    held = np.flatnonzero(chosen & (numbers >= 0))
    local = csr_view(matrix)[held][:, held].tocsr()
    total = int(exchange.Sum(counted)) if exchange.several else counted
    mapping = PETSc.LGMap().create(numbers[held], comm=PETSc.COMM_WORLD)
    A = PETSc.Mat().createIS(((counted, total), (counted, total)), lgmapr=mapping, lgmapc=mapping, comm=PETSc.COMM_WORLD)
    A.setISLocalMat(PETSc.Mat().createAIJ(local.shape, csr=(local.indptr, local.indices, local.data), comm=PETSc.COMM_SELF))
    A.assemble()
    A = A.convert("aij")
    A.setOption(PETSc.Mat.Option.SPD, True)
    return A, numbers, held


def right_hand_sides(K, numbers, held, A):
    """Kᵀ, a dense matrix of PETSc."""
    from petsc4py import PETSc

    (low, high), (_, total) = A.getOwnershipRange(), A.getSize()
    rows = K.tocsc()[:, held].tocoo()
    own = A.createVecRight()
    columns = []
    for k in range(K.shape[0]):
        at = rows.row == k
        own.set(0)
        own.setValues(numbers[held[rows.col[at]]], rows.data[at], addv=PETSc.InsertMode.ADD)
        own.assemble()
        columns.append(own.getArray().copy())
    dense = np.array(columns).T.reshape(high - low, K.shape[0])
    B = PETSc.Mat().createDense(((high - low, total), (None, K.shape[0])), array=np.asfortranarray(dense), comm=PETSc.COMM_WORLD)
    B.assemble()
    return B, dense


def measure(maxh):
    """Both solvers on the processes that mpirun has started; the first one prints a JSON line."""
    import petsc4py
    from mpi4py import MPI

    from ngsxfem_contact.algebra.substructuring import Substructuring

    petsc4py.init(["-mat_mumps_icntl_14", MEMORY])
    from petsc4py import PETSc

    comm = MPI.COMM_WORLD
    matrix, inner, K, exchange = handed_over(maxh)
    clock, found = Clock(comm), {}
    own = Substructuring(matrix, inner, K, exchange)
    found["substructuring"] = clock()
    A, numbers, held = assembled(matrix, inner, exchange)
    found["PETSc"] = clock()
    solver = PETSc.PC().create(PETSc.COMM_WORLD)
    solver.setOperators(A)
    solver.setType("cholesky")
    solver.setFactorSolverType("mumps")
    solver.setUp()
    factors = solver.getFactorMatrix()
    if factors.getMumpsInfog(1):
        raise RuntimeError(f"MUMPS: INFOG(1) = {factors.getMumpsInfog(1)}, INFOG(2) = {factors.getMumpsInfog(2)}")
    found["factors"] = clock()
    B, dense = right_hand_sides(K, numbers, held, A)
    X = B.duplicate()
    clock()
    factors.matSolve(B, X)
    S = np.zeros((K.shape[0],) * 2)
    comm.Allreduce(dense.T @ X.getDenseArray(), S)
    found["S"] = clock()
    found["difference"] = float(np.abs(S - own.schur).max() / np.abs(S).max())
    found["unknowns"], found["rows"] = A.getSize()[0], K.shape[0]
    of_all = comm.gather(found)
    if of_all:
        sys.stdout.write(json.dumps(of_all) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=float, nargs="+", default=[0.01, 0.006])
    parser.add_argument("--numbers", type=int, nargs="+", default=[1, 3, 4])
    parser.add_argument("--measure", type=float)
    chosen = parser.parse_args()
    if chosen.measure is not None:
        return measure(chosen.measure)
    parts = ("substructuring", "PETSc", "factors", "S")
    print("                           CPU s: substructuring   MUMPS:                     wall s: substructuring   MUMPS:")
    print("processes  unknowns  rows         factors and S   matrix  factors      S             factors and S   matrix  factors      S  difference of S")
    for maxh in chosen.sizes:
        for number in chosen.numbers:
            rows = measured(__file__, number, maxh)
            most = {part: np.max([row[part] for row in rows], axis=0) for part in parts}  # CPU, wall
            seconds = [" ".join(f"{most[part][k]:{width}.2f}" for part, width in zip(parts, (21 if k == 0 else 23, 8, 8, 6))) for k in (0, 1)]
            print(f"{number:9} {rows[0]['unknowns']:9} {rows[0]['rows']:5} {seconds[0]}  {seconds[1]} {rows[0]['difference']:16.1e}")


if __name__ == "__main__":
    recorded(main)
