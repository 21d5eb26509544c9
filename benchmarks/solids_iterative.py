"""Conjugate gradients for a penny in a cube, half of which is closed: against one linear solve of the uncracked body by the same solver, and against direct solvers.

    python benchmarks/solids_iterative.py [sizes] [laws] [agreement] [--realisations 1]

sizes: P1 on meshes of 1e5, 3e5 and 1e6 unknowns, each the fastest of the realisations. "body": the mesh without its crack, by VectorH1, the same multigrid and accuracy.
"solver": multigrid, factors around the crack, and iterations, without spaces and forms. laws: the same body of 1e5 unknowns with friction, and of order 2.
agreement: the largest differences from a direct solver, of λ and u relative to the largest, of K to the largest of K_I, K_II, K_III; nodes whose state differs.
"""

import resource
import sys
import time
from pathlib import Path

import numpy as np
import scipy
from ngsolve import BilinearForm, Grad, GridFunction, InnerProduct, Sym, VectorH1, div, dx
from results import recorded, run_cases

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[1] / "tests" / "sheets")]

from exact_sheets import cube_mesh  # noqa: E402

from ngsxfem_contact import ContactProblem, Coulomb, CrackedMesh, CrackFESpace, Elasticity, TraceSpace, Tresca  # noqa: E402
from ngsxfem_contact.algebra.condensed import CondensedMatrix  # noqa: E402
from ngsxfem_contact.algebra.condensed_newton import CondensedNewton, FaceTerms  # noqa: E402
from ngsxfem_contact.algebra.matrices import csr_view, mask  # noqa: E402
from ngsxfem_contact.algebra.multigrid import rigid_motions  # noqa: E402
from ngsxfem_contact.contact.condensed import CondensedProblem  # noqa: E402
from ngsxfem_contact.exact.pennies import bent_penny  # noqa: E402
from ngsxfem_contact.geometry import Sheet  # noqa: E402

MATERIAL = Elasticity.Solid(E=2.5, nu=0.25)
CENTRE, RADIUS = (0.49, 0.51, 0.513), 0.3
FORM = bent_penny(MATERIAL, RADIUS).At(CENTRE)
MESHES = (0.032, 0.0215, 0.0141)


def clocks():
    return np.array([time.perf_counter(), time.process_time()])


class Timed(CondensedProblem):
    """Whose preparation is timed."""

    def _prepare(self, free, inverse):
        start = clocks()
        super()._prepare(free, inverse)
        self.prepared = clocks() - start


def problem_on(mesh, law=None, order=1):
    body = CrackedMesh(mesh, Sheet.Disk(CENTRE, (0, 0, 1), RADIUS))
    problem = ContactProblem(CrackFESpace(body, order=order, dirichlet="outer", material=MATERIAL), TraceSpace(body), law=law)
    problem.SetDirichlet(FORM.u, "outer")
    return problem


def contact(mesh, law=None, order=1):
    """(solution, seconds of all, of the solver), each of the wall's clock and of the processor's."""
    start = clocks()
    reduced = Timed(problem_on(mesh, law, order))
    begin = clocks()
    solution = reduced.Solve()
    end = clocks()
    return solution, end - start, reduced.prepared + end - begin


def body_alone(mesh, order=1):
    """(iterations, seconds of all, of the solver) of the uncracked body."""
    start = clocks()
    V = VectorH1(mesh, order=order, dirichlet="outer")
    u, v = V.TnT()
    strain = lambda w: Sym(Grad(w))
    form = BilinearForm(V, symmetric=True)
    form += (2 * MATERIAL.mu * InnerProduct(strain(u), strain(v)) + MATERIAL.lam * div(u) * div(v)) * dx
    form.Assemble()
    given = GridFunction(V)
    given.Set(FORM.u, definedon=mesh.Boundaries("outer"))
    begin = clocks()
    nodes = np.arange(V.ndof).reshape(3, -1).T
    none = scipy.sparse.csr_matrix((0, V.ndof))
    matrix = CondensedMatrix(csr_view(form.mat), mask(V.FreeDofs()), none, nodes, rigid_motions(mesh.ngmesh.Coordinates()).reshape(-1, 3, 6))
    terms = FaceTerms(none, np.zeros(0), np.zeros(0))
    result = CondensedNewton(matrix, terms, np.zeros(V.ndof), given.vec.FV().NumPy().copy(), np.zeros(0, dtype=bool)).Solve(1)
    end = clocks()
    return sum(result.linear_iterations), end - start, end - begin


def fastest(runs):
    """The run whose processor seconds are fewest."""
    return min(runs, key=lambda run: run[1][1])


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


HEAD = f"{'N':>9}{'m':>6}{'steps':>6}{'cg':>5}{'GB':>6}{'all: wall':>11}{'cpu':>7}{'solver: wall':>14}{'cpu':>7}"


def row(solution, memory, whole, solver):
    report = solution.report
    return f"{report.unknowns[0]:9}{len(solution.state.L):6}{report.iterations:6}{sum(report.linear_iterations):5}{memory:6.2f}{whole[0]:11.1f}{whole[1]:7.1f}{solver[0]:14.2f}{solver[1]:7.2f}"


def sizes(number):
    print(f"{HEAD}   body: cg{'all: cpu':>10}{'solver: cpu':>13}   ratio: all{'solver':>8}", flush=True)
    cost = []
    for maxh in MESHES:
        mesh = cube_mesh(maxh)
        solution, whole, solver = fastest([contact(mesh) for _ in range(number)])
        memory = peak()
        solution.ReleaseFactors()
        iterations, body, body_solver = fastest([body_alone(mesh) for _ in range(number)])
        print(
            row(solution, memory, whole, solver),
            f"{iterations:10}{body[1]:10.1f}{body_solver[1]:13.2f}{whole[1] / body[1]:13.2f}{solver[1] / body_solver[1]:8.2f}",
            flush=True,
        )
        cost.append((solution.report.unknowns[0], whole[1], solver[1]))
    N, *seconds = np.array(cost).T
    print(
        "processor seconds grow like "
        + ", ".join(f"N^{np.log(s[-1] / s[0]) / np.log(N[-1] / N[0]):.2f} ({name})" for s, name in zip(seconds, ("all", "solver")))
    )


def laws(number):
    print(f"{'':22}{HEAD}")
    for name, maxh, law, order in (
        ("without friction", MESHES[0], None, 1),
        ("Tresca 0.02", MESHES[0], Tresca(0.02), 1),
        ("Coulomb 0.3", MESHES[0], Coulomb(0.3), 1),
        ("P2, without friction", 0.06, None, 2),
        ("P2, Coulomb 0.3", 0.06, Coulomb(0.3), 2),
    ):
        mesh = cube_mesh(maxh)
        solution, whole, solver = fastest([contact(mesh, law, order) for _ in range(number)])
        print(f"{name:22}" + row(solution, peak(), whole, solver), flush=True)


def agreement(number):
    print(f"{'':22}{'N':>9}{'m':>6}{'λ':>10}{'u':>10}{'K':>10}{'nodes':>7}{'direct: cpu':>13}{'cg: cpu':>9}")
    for name, maxh, law, order in (
        ("without friction", 0.06, None, 1),
        ("Tresca 0.02", 0.06, Tresca(0.02), 1),
        ("Coulomb 0.3", 0.06, Coulomb(0.3), 1),
        ("P2, without friction", 0.1, None, 2),
        ("P2, Coulomb 0.3", 0.1, Coulomb(0.3), 2),
        ("without friction", MESHES[0], None, 1),
    ):
        problem, seconds, found = problem_on(cube_mesh(maxh), law, order), [], []
        for inverse in ("sparsecholesky", "cg"):
            start = clocks()
            found.append(problem.Solve(inverse=inverse))
            seconds.append((clocks() - start)[1])
        L, U = ([values(solution) for solution in found] for values in (lambda s: s.state.L, lambda s: s.u.vec.FV().NumPy()))
        K = [np.column_stack([f.K_I, f.K_II, f.K_III]) for f in (solution.StressIntensity() for solution in found)]
        off = [np.abs(cg - direct).max() / np.abs(direct).max() for direct, cg in (L, U, K)]
        other = int((found[0].report.active[-1] != found[1].report.active[-1]).sum())
        print(
            f"{name:22}{problem.V.ndof:9}{len(L[0]):6}" + "".join(f"{one:10.1e}" for one in off) + f"{other:7}{seconds[0]:13.1f}{seconds[1]:9.1f}", flush=True
        )


def main():
    run_cases(__doc__, (sizes, laws, agreement), 1)


if __name__ == "__main__":
    recorded(main)
