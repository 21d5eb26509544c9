# %% [markdown]
# # 3. Contact: pressure, gap, active set, and the form itself
#
# What does `ContactProblem.Solve()` solve, and what can be read from its answer? The problem of tutorial 1 is in the package, as
# a file that describes a [part](../job.md): a square with an edge crack that closes near its tip (section 4 of the paper, load B).

# %%
import matplotlib.pyplot as plt
import numpy as np
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.job.part import EXAMPLE, read_part
from ngsxfem_contact.plotting import plot_profile
from scipy.sparse import bmat, csr_matrix
from scipy.sparse.linalg import spsolve

problem = read_part(EXAMPLE, maxh=0.12).problem
solution = problem.Solve()
print(solution.report)

# %% [markdown]
# ## Signs
#
# A crack is an oriented line. Its normal $n$ points **to the left** of the direction of travel, from the minus to the plus side, and
# jump$(u) = u^+ - u^-$. The gap $g_n$ = jump$(u)\cdot n$ is positive where the crack is open, the multiplier $\lambda = \sigma_n$ is negative in
# compression, and the slip $g_t$ = jump$(u)\cdot t$ is along the direction of travel. The last row is the tangential stress, zero without
# friction; what is left of it is the error of the finite elements.

# %%
figure, axes = plt.subplots(4, 1, figsize=(7, 8), sharex=True, layout="constrained")
plot_profile(solution, ax=axes, quantities=("pressure", "gap", "slip", "shear"))
plt.show()

# %% [markdown]
# `solution.Profile()` has the arrays behind the figure. Off the crack, `solution.u` is a GridFunction like any other; on the crack it has two values.
# `Plus(u)`, `Minus(u)` and `Jump(u)` name them, in forms and in integrals: the volume that the opening encloses, for example.

# %%
n = problem.body.normal
opening = Integrate(InnerProduct(Jump(solution.u), n) * problem.body.dcrack, problem.V.mesh)
profile = solution.Profile(n=2001)
print(f"area of the opening: {opening:.8f} by body.dcrack, {np.trapezoid(profile.gap, profile.s):.8f} by the profile")

# %% [markdown]
# ## The active set
#
# The multiplier has a node wherever the crack meets a mesh edge. The solver guesses which nodes are in contact, solves the linear problem for that
# guess, and corrects: a node in contact that would have to pull is released, an open one whose faces overlap is closed. This is the semi-smooth Newton
# method for (39), and it ends when the set repeats. Every row below is one iteration.

# %%
history = np.array(solution.report.active)
nodes = problem.W.NodalPositions()[0]
figure, ax = plt.subplots(figsize=(7, 3), layout="constrained")
iteration, node = np.nonzero(history)
ax.plot(np.take(nodes, node), iteration, "s", color="tab:red", label="in contact")
iteration, node = np.nonzero(~history)
ax.plot(np.take(nodes, node), iteration, "s", color="tab:blue", markerfacecolor="none", label="open")
ax.set(xlabel="arc length s of the node", ylabel="iteration")
ax.set_yticks(range(len(history)))
ax.invert_yaxis()
ax.legend(loc="upper left", bbox_to_anchor=(1, 1))
plt.show()

# %% [markdown]
# ## The open form
#
# Nothing is hidden that NGSolve's forms cannot say. Here the matrices (38) of the stabilised problem (12)
#
# $$(K - K_\gamma) U - (B - C_\gamma)^T L = F, \qquad (L' - L)^T \bigl((B - C_\gamma) U + D_\gamma L\bigr) \ge 0 \quad\text{for all } L' \le 0$$
#
# are assembled by hand. In the end the multipliers fall into two sets. In contact: $((B - C_\gamma) U + D_\gamma L)_i = 0$; open: $L_i = 0$. With these
# sets the problem is one linear system, which must give the same $u$ and $\lambda$.
#
# The paper writes $\lbrack\lbrack u_n\rbrack\rbrack$ for minus the gap, $b(\mu, v) = \int \mu \lbrack\lbrack v_n\rbrack\rbrack$, and $R_h(v)$ for the normal stress of the polynomial of the larger part of each
# cut element. $\gamma$ is the one that the stabilisation chose; the next tutorial is about it.

# %%
V, W, body, stress, gamma = problem.V, problem.W, problem.body, problem.material.Stress, solution.gamma
(u, v), (lam, mu) = V.TnT(), W.TnT()


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
# ## Is it right?
#
# The two answers agree to round-off, and so do the two ways to the area of the opening up to the trapezoidal rule.

# %%
U, L = solution.u.vec.FV().NumPy()[free], solution.multiplier.vec.FV().NumPy()[contact]
error_u, error_lam = np.abs(UL[: len(U)] - U).max() / np.abs(U).max(), np.abs(UL[len(U) :] - L).max() / np.abs(L).max()
print(f"largest relative difference: u {error_u:.1e}, λ {error_lam:.1e}")
assert error_u < 1e-8 and error_lam < 1e-8
assert abs(np.trapezoid(profile.gap, profile.s) / opening - 1) < 1e-4
