"""Condition numbers of K - K_γ, rigid motions removed, against the uncracked stiffness matrix scaled by its diagonal on the same mesh.

    python benchmarks/conditioning.py [--random 100] [--adversarial 16] [--orders 1 2] [--tips none modes branch]
    python benchmarks/conditioning.py --disk     with larger and larger disks of tips
    python benchmarks/conditioning.py --strip    a crack beside a line of edges, closer and closer

Scalings: "H": the functions H φ_i, by the diagonal; "shifted": ½(H - s_i) φ_i, by the diagonal; "dropped": the same without the functions
that have less than 1e-4 of the energy of φ_i; "blocks": CrackScaling of the package.
"softness" is the ratio of the lowest eigenfrequencies, squared, of the body without and with its crack: a body that a crack nearly
divides is soft in any basis. "blocks, corrected" is divided by it.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from ngsolve import BilinearForm, Grad, InnerProduct, Sym, VectorH1, dx, ngsglobals
from results import recorded
from scipy.linalg import eigh

from ngsxfem_contact import BarbosaHughes, Crack, CrackedMesh, CrackFESpace, Strain, TipEnrichment
from ngsxfem_contact.algebra.matrices import to_scipy
from ngsxfem_contact.contact.conditioning import scaling_blocks
from ngsxfem_contact.loads.face_traction import ComparedTraction
from ngsxfem_contact.operators import NORMAL
from ngsxfem_contact.spaces.connectivity import VertexCopies
from ngsxfem_contact.spaces.negligible import without_negligible
from ngsxfem_contact.spaces.unknowns import Unknowns
from study.paper import MATERIAL

sys.path.insert(0, str(Path(__file__).resolve().parent))
import adversarial  # noqa: E402
from bodies import moved_square, random_crack, random_mesh  # noqa: E402

DROPPED = 1e-4


def dense(form):
    return to_scipy(form.Assemble().mat).toarray()


def cracked_matrices(V):
    """K - K_γ, the mass matrix, and which functions are not negligible."""
    u, v = V.TnT()
    stabilisation = BarbosaHughes()
    A = BilinearForm(V, symmetric=True)
    A += InnerProduct(MATERIAL.Stress(Strain(u)), Strain(v)) * V.body.dx
    A += -stabilisation.Gamma(V, MATERIAL) * ComparedTraction(V.body, MATERIAL, stabilisation.sides).Squared(u, v, [NORMAL]) * V.body.dcrack
    kept = np.array(without_negligible(A.Assemble().mat, V, V.FreeDofs()))
    return to_scipy(A.mat).toarray(), dense(BilinearForm(u * v * V.body.dx)), kept


def uncracked_matrices(mesh, order):
    V = VectorH1(mesh, order=order)
    u, v = V.TnT()
    return dense(BilinearForm(InnerProduct(MATERIAL.Stress(Sym(Grad(u))), Sym(Grad(v))) * dx)), dense(BilinearForm(u * v * dx))


def condition(A, rigid=3):
    """Of a positive semi-definite matrix with a kernel of known dimension."""
    values = np.linalg.eigvalsh(A)
    return values[-1] / values[rigid] if values[rigid] > 0 else np.inf


def lowest(A, M, S, rigid=3):
    """The square of the lowest eigenfrequency that is not zero; S: a scaling in which A + M is well-conditioned."""
    A, M = S.T @ A @ S, S.T @ M @ S
    return 1 / eigh(M, A + M, eigvals_only=True)[-1 - rigid] - 1


def by_diagonal(A):
    scale = 1 / np.sqrt(A.diagonal())
    return A * scale[:, None] * scale


def unshifted(V):
    """H φ_i = 2·½(H - s_i) φ_i + s_i φ_i: the change of basis."""
    T, unknowns = np.eye(V.ndof), Unknowns(V)
    for k in (0, 1):
        own = np.arange(V.ndof)[unknowns.Heaviside(k)]
        T[own, own] = 2
        T[unknowns.Polynomial(k).start + unknowns.enriched, own] = unknowns.shifts
    return T


def without_small_parts(A, V):
    kept, unknowns, energies = np.ones(V.ndof, dtype=bool), Unknowns(V), A.diagonal()
    for k in (0, 1):
        kept[unknowns.Heaviside(k)] = energies[unknowns.Heaviside(k)] > DROPPED * energies[unknowns.Polynomial(k)][unknowns.enriched]
    return A[np.ix_(kept, kept)]


def block_scaling(A, V, kept):
    """S with the blocks of CrackScaling; its columns are those of the unknowns kept."""
    scale = 1 / np.sqrt(A.diagonal())
    S = np.diag(scale)
    for dofs in ([dof for dof in block if kept[dof]] for block in scaling_blocks(V)):
        if dofs:
            block = A[np.ix_(dofs, dofs)] * scale[dofs][:, None] * scale[dofs]
            S[np.ix_(dofs, dofs)] = scale[dofs][:, None] * np.linalg.inv(np.linalg.cholesky(block)).T
    return S[:, kept]


def measure(V, uncracked):
    """{scaling: condition number relative to the uncracked one}, and the softness."""
    A, M, kept = cracked_matrices(V)
    K, M0 = uncracked
    rigid, reference = 3 * VertexCopies(V).parts, condition(by_diagonal(K))
    T, S = unshifted(V), block_scaling(A, V, kept)
    scaled = {"H": by_diagonal(T.T @ A @ T), "shifted": by_diagonal(A), "dropped": by_diagonal(without_small_parts(A, V)), "blocks": S.T @ A @ S}
    found = {name: condition(B, rigid) / reference for name, B in scaled.items()}
    found["softness"] = lowest(K, M0, np.diag(1 / np.sqrt(K.diagonal()))) / lowest(A, M, S, rigid)
    found["blocks, corrected"] = found["blocks"] / max(1, found["softness"])
    return found


def bodies(random, samples):
    """(name, mesh, crack)."""
    for seed in range(random):
        rng = np.random.default_rng(seed)
        mesh, _ = random_mesh(rng)
        yield f"random {seed}", mesh, random_crack(rng, mesh)[0]
    for sample in range(-(-samples // len(adversarial.KINDS))):
        for kind in adversarial.KINDS:
            for displacement in adversarial.DISPLACEMENTS:
                mesh, crack, _ = adversarial.position(kind, sample, displacement)
                yield f"{kind}, {sample}, {displacement:.0e}", mesh, crack


def enrichment(name):
    return None if name == "none" else TipEnrichment(material=MATERIAL, functions=name)


def study(arguments):
    found = {}
    for name, mesh, crack in bodies(arguments.random, arguments.adversarial):
        try:
            body = CrackedMesh(mesh, crack)
        except Exception as error:
            print(f"refused: {name}: {str(error)[:100]}")
            continue
        for order in arguments.orders:
            uncracked = uncracked_matrices(mesh, order)
            for tip in arguments.tips if body.tips else ["none"]:
                try:
                    values = measure(CrackFESpace(body, order=order, tip=enrichment(tip)), uncracked)
                except np.linalg.LinAlgError as error:
                    print(f"FAILED: {name}, P{order}, {tip}: {error}")
                    continue
                for scaling, value in values.items():
                    found.setdefault((order, tip, scaling), []).append((value, name))
    print(f"{'order':6}{'tip':8}{'scaling':20}{'number':>7}{'median':>9}{'99 %':>9}{'worst':>9}  where")
    for (order, tip, scaling), values in sorted(found.items(), key=lambda item: item[0][:2]):
        numbers = [value for value, _ in values]
        print(f"P{order:<5}{tip:8}{scaling:20}{len(values):7}{np.median(numbers):9.3g}{np.percentile(numbers, 99):9.3g}{max(numbers):9.3g}  {max(values)[1]}")


def disks():
    """The tip at the origin of a square, its disk up to 30 elements wide."""
    print(f"{'order':6}{'tip':8}{'h':>7}{'r1/h':>6}" + "".join(f"{name:>19}" for name in ("shifted", "blocks", "blocks, corrected")))
    for order, h in ((1, 0.1), (2, 0.1), (1, 0.05), (2, 0.05), (1, 0.03)):
        mesh = moved_square(0.1, (0, 0), h)
        uncracked = uncracked_matrices(mesh, order)
        body = CrackedMesh(mesh, Crack([(-0.5 / np.cos(0.1), 0), (0, 0)]))
        for tip in ("modes", "branch"):
            for r1 in (0.1, 0.2, 0.45):
                found = measure(CrackFESpace(body, order=order, tip=TipEnrichment(r1=r1, material=MATERIAL, functions=tip)), uncracked)
                print(
                    f"P{order:<5}{tip:8}{h:7}{r1 / h:6.1f}" + "".join(f"{found[name]:19.3g}" for name in ("shifted", "blocks", "blocks, corrected")), flush=True
                )


def strips():
    """The functions on the strip between a line of edges and the crack."""
    print(f"{'order':6}{'distance/h':>11}{'H':>10}{'shifted':>10}{'dropped':>10}{'blocks':>10}{'softness':>10}{'blocks, corrected':>19}{'left out':>10}")
    for order in (1, 2):
        for distance in (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9):
            mesh, crack, _ = adversarial.position("along edges", 0, distance)
            V = CrackFESpace(CrackedMesh(mesh, crack), order=order, tip=None)
            found = measure(V, uncracked_matrices(mesh, order))
            names = ("H", "shifted", "dropped", "blocks", "softness")
            left_out = int((~cracked_matrices(V)[2]).sum())
            print(
                f"P{order:<5}{distance:11.0e}" + "".join(f"{found[name]:10.3g}" for name in names) + f"{found['blocks, corrected']:19.3g}{left_out:10}",
                flush=True,
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--random", type=int, default=100)
    parser.add_argument("--adversarial", type=int, default=16)
    parser.add_argument("--orders", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--tips", nargs="+", default=["none", "modes", "branch"], choices=["none", "modes", "branch"])
    parser.add_argument("--disk", action="store_true")
    parser.add_argument("--strip", action="store_true")
    arguments = parser.parse_args()
    ngsglobals.msg_level = 0
    run = disks if arguments.disk else strips if arguments.strip else lambda: study(arguments)
    run()


if __name__ == "__main__":
    recorded(main)
