# %% [markdown]
# # The open form
#
# `ContactProblem.Solve()` hides nothing that NGSolve's forms cannot say. Here the matrices of
#
#     (K - K_γ) U - (B - C_γ)ᵀ L = F,      (L' - L)ᵀ ((B - C_γ) U + D_γ L) ≥ 0   for all L' ≤ 0
#
# are assembled by hand. In the end the multipliers fall into two sets. In contact: ((B - C_γ) U + D_γ L)_i = 0; open:
# L_i = 0. With these sets the problem is one linear system, which must give the same u and λ.

# %%
import numpy as np
from ngsolve import BilinearForm, InnerProduct
from scipy.sparse import bmat, csr_matrix
from scipy.sparse.linalg import spsolve

from ngsxfem_contact import Jump, Strain
from ngsxfem_contact.paper import paper_problem, unstructured_mesh

problem = paper_problem(unstructured_mesh(h=0.06))
solution = problem.Solve()
print(solution.report)

# %% [markdown]
# The paper writes ⟦u_n⟧ for minus the gap, b(μ,v) = ∫μ⟦v_n⟧, and R_h(v) for the normal stress of the polynomial of the
# larger part of each cut element. γ is the one that the stabilisation chose.

# %%
V, W, body, stress, gamma = problem.V, problem.W, problem.body, problem.material.Stress, solution.gamma
(u, v), (lam, mu), n = V.TnT(), W.TnT(), body.normal


def minus_gap(v):
    return -InnerProduct(Jump(v), n)


def R(v):
    return InnerProduct(stress(Strain(v, side="larger")) * n, n)


K = BilinearForm(InnerProduct(stress(Strain(u)), Strain(v)) * body.dx - gamma * R(u) * R(v) * body.dcrack)
E = BilinearForm(mu * minus_gap(u) * body.dcrack - gamma * mu * R(u) * body.dcrack)
D = BilinearForm(gamma * lam * mu * body.dcrack)

# %% [markdown]
# Now the linear system of the final active set, on the unknowns that are not pinned and the multipliers in contact.

# %%


def scipy_matrix(form):
    matrix = form.Assemble().mat
    values, columns, rows = matrix.CSR()
    return csr_matrix((values, columns, rows), shape=(matrix.height, matrix.width))


free, contact = np.array(problem.free), solution.report.active[-1]
K, E, D = scipy_matrix(K)[free][:, free], scipy_matrix(E)[contact][:, free], scipy_matrix(D)[contact][:, contact]
F = problem.f.Assemble().vec.FV().NumPy()[free]
UL = spsolve(bmat([[K, -E.T], [E, D]], format="csc"), np.concatenate([F, np.zeros(contact.sum())]))

# %% [markdown]
# The two answers agree to round-off.

# %%
U, L = solution.u.vec.FV().NumPy()[free], solution.multiplier.vec.FV().NumPy()[contact]
error_u, error_lam = np.abs(UL[: len(U)] - U).max() / np.abs(U).max(), np.abs(UL[len(U) :] - L).max() / np.abs(L).max()
print(f"largest relative difference: u {error_u:.1e}, λ {error_lam:.1e}")
assert error_u < 1e-8 and error_lam < 1e-8
