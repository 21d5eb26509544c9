"""λ at the contact transition (d), P2/P1, at random positions of one mesh: beside the best approximation, and by the interval that holds the transition.

python benchmarks/transition.py [--positions 200]
"""

import argparse

import numpy as np
from ngsolve import GridFunction, LinearForm, ngsglobals
from positions import closed_position
from results import recorded
from scipy.optimize import lsq_linear

from ngsxfem_contact import ContactProblem, CrackedMesh, CrackFESpace, TraceSpace
from ngsxfem_contact.exact import closed_forms as cf
from ngsxfem_contact.spaces.trace_space import mass_matrix
from study.paper import MATERIAL


def best_approximation(W, exact, bonus_intorder=10):
    """The function of W, nonpositive at the nodes, that is nearest to the pressure in L²."""
    root = np.linalg.cholesky(mass_matrix(W).toarray())
    moments = LinearForm(exact.pressure * W.TestFunction() * W.dcrack(bonus_intorder=bonus_intorder)).Assemble().vec.FV().NumPy()
    best = GridFunction(W)
    best.vec.FV().NumPy()[:] = lsq_linear(root.T, np.linalg.solve(root, moments), (-np.inf, 0), tol=1e-14).x
    return best


def errors(seed):
    """(of λ_h, of the best approximation, where in its interval the transition lies, that interval's length relative to the mean)."""
    mesh, left, right = closed_position(seed)
    exact, body = cf.contact_transition(MATERIAL), CrackedMesh(mesh, cf.crack_on_axis(left, right))
    boundary = "|".join(sorted(set(mesh.GetBoundaries())))
    V, W = CrackFESpace(body, order=2, tip=None, dirichlet=boundary), TraceSpace(body, order=1)
    problem = ContactProblem(V, W, MATERIAL)
    problem.SetDirichlet(exact.u, boundary)
    solution = problem.Solve()
    best = cf.error_on_crack(solution, best_approximation(W, exact) - exact.pressure, 10)
    nodes = np.array(W.basis.division[0]) + left
    i = np.searchsorted(nodes, 0) - 1
    return cf.pressure_error(solution, exact), best, -nodes[i] / (nodes[i + 1] - nodes[i]), (nodes[i + 1] - nodes[i]) / 0.06


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--positions", type=int, default=200)
    number = parser.parse_args().positions
    ngsglobals.msg_level = 0
    computed, best, place, length = np.array([errors(seed) for seed in range(number)]).T
    for name, values in (("λ_h", computed), ("best approximation", best)):
        print(f"{name:20} median {np.median(values):.2e}  worst/median {values.max() / np.median(values):.2f}  (position {values.argmax()})")
    print(f"{'λ_h / best':20} median {np.median(computed / best):.1f}  worst {(computed / best).max():.1f}")
    print(f"intervals of {length.min():.2f} to {length.max():.2f} h; the ten worst are of {length[np.argsort(computed)[-10:]].min():.2f} h and more")
    tenth = np.minimum((10 * place).astype(int), 9)
    medians = " ".join(f"{np.median(computed[tenth == i]) / np.median(computed):.1f}" for i in range(10) if (tenth == i).any())
    print(f"medians of λ_h by the tenth of its interval in which the transition lies, relative to that of all: {medians}")


if __name__ == "__main__":
    recorded(main)
