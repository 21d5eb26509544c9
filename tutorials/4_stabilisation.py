# %% [markdown]
# # 4. Stabilisation and γ₀
#
# Multipliers that the displacements cannot control oscillate, or are not determined at all. The cure of Barbosa and Hughes adds to the energy of the
# problem the term $-\frac12\int\gamma\,(\lambda - R_h(u))^2$ on the crack. It vanishes for the exact solution, where $\lambda = \sigma_n = R_h$, and it controls
# $\lambda$ whatever the spaces are. The price is a parameter, $\gamma = \gamma_0 h_T$. This tutorial shows the illness, the cure, and how $\gamma$ is chosen.
#
# The problem is again the paper's, load B. A P2/P1 solution on a finer mesh tells us what is right.

# %%
import matplotlib.pyplot as plt
import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.contact import Coercivity
from ngsxfem_contact.errors import NotCoercive, SingularSystem

MATERIAL, ENERGY = Elasticity(lam=1, mu=1), 3.40135917e-4  # the energy is that of a mesh which follows the crack
SPACES = {"P2/P1": (2, 1), "P1/P1": (1, 1), "P1/P0": (1, 0)}


def square(maxh):
    geometry = SplineGeometry()
    geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
    return Mesh(geometry.GenerateMesh(maxh=maxh))


def paper_problem(mesh, pair="P2/P1", stabilisation=BarbosaHughes()):
    body, (order, multiplier_order) = CrackedMesh(mesh, Crack([(0, 0), (0.5, 0)])), SPACES[pair]
    V, W = CrackFESpace(body, order=order, material=MATERIAL), TraceSpace(body, order=multiplier_order)
    problem, v = ContactProblem(V, W, stabilisation=stabilisation), V.TestFunction()
    force, traction = CF((0, 3.5 * x * (1 - x) * y * cos(2 * np.pi * x))), 0.04 * sin(2 * np.pi * y) * specialcf.normal(2)
    problem.f += force * v * body.dx(bonus_intorder=6) + traction * v * body.ds("left|right", bonus_intorder=6)
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    return problem


reference = paper_problem(square(maxh=0.032)).Solve().Profile(n=4001)
mesh = square(maxh=0.06)


def pressure_error(solution):
    """‖λ_h - λ‖ / ‖λ‖ in L²(Γ_C)."""
    difference = solution.Profile(n=4001).sigma_n - reference.sigma_n
    return np.sqrt((difference**2).sum() / (reference.sigma_n**2).sum())


def energy_error(solution):
    return abs(solution.Energy() / ENERGY - 1)


# %% [markdown]
# ## The illness
#
# P1 displacements with P1 multipliers have one multiplier for each crossing of the crack with a mesh edge, more than the jumps beside it can feel. The
# package does not return an answer that means nothing:

# %%
try:
    paper_problem(mesh, pair="P1/P1", stabilisation=None).Solve()
except SingularSystem as error:
    print(f"SingularSystem: {error}")

# %% [markdown]
# With one constant for each element, P1/P0, there is an answer, and it oscillates (upper row). With P2 displacements it oscillates less.
#
# ## The cure
#
# `BarbosaHughes()` is the default of `ContactProblem`. The same spaces with it are in the lower row.

# %%
pairs = ("P1/P1", "P1/P0", "P2/P1")
figure, axes = plt.subplots(2, 3, figsize=(13, 6), sharex=True, layout="constrained")
errors = {}
for column, pair in zip(axes.T, pairs):
    for ax, stabilisation in zip(column, (None, BarbosaHughes())):
        ax.set_title(pair + (", stabilised" if stabilisation else ""))
        ax.plot(reference.s, -reference.sigma_n, "k:", label="fine mesh")
        try:
            solution = paper_problem(mesh, pair=pair, stabilisation=stabilisation).Solve()
        except SingularSystem:
            ax.text(0.5, 0.9, "singular", ha="center", transform=ax.transAxes)
            continue
        errors[pair, stabilisation is not None] = pressure_error(solution), energy_error(solution)
        profile = solution.Profile(n=1000)
        ax.plot(profile.s, -profile.sigma_n, label="computed")
        ax.legend(loc="upper left")
for ax in axes[:, 0]:
    ax.set_ylabel("pressure −λ")
for ax in axes[1]:
    ax.set_xlabel("arc length s")
plt.show()
for (pair, stabilised), (of_pressure, of_energy) in errors.items():
    print(f"{pair} {'stabilised' if stabilised else 'plain':10}  relative error of λ {of_pressure:.1e}, of the energy {of_energy:.1e}")

# %% [markdown]
# The displacement hardly notices; the pressure does.
#
# ## How large may $\gamma_0$ be?
#
# The matrix $K - K_\gamma$ must stay positive, (13): too much of the cure kills. `Coercivity(problem)` is the smallest eigenvalue of
# $K - K_\gamma$ against $K$: it is 1 for $\gamma_0 = 0$ and falls linearly to 0, where the method breaks down. Up to there the pressure gets better.
# `BarbosaHughes()` without a number solves a small eigenvalue problem on each cut element and takes half of the largest $\gamma$ that is safe there (star). One $\gamma_0$ for all has to
# be safe on the worst element; a choice for each can be larger on most of them, and is coercive all the same.

# %%
gamma0 = np.geomspace(1e-4, 0.3, 11)
coercivity, error_of_pressure = [], []
for number in gamma0:
    problem = paper_problem(mesh, pair="P1/P0", stabilisation=BarbosaHughes(gamma0=number))
    coercivity.append(Coercivity(problem))
    try:
        error_of_pressure.append(pressure_error(problem.Solve()))
    except NotCoercive as error:
        error_of_pressure.append(np.nan)
        reason = f"NotCoercive, γ₀ = {number:.2f}: {error}"
print(reason)

chosen = paper_problem(mesh, pair="P1/P0", stabilisation=BarbosaHughes())
limits = chosen.stabilisation.Limits(chosen.V, MATERIAL)  # γ_T / h_T of each cut element
error_of_chosen, middle = pressure_error(chosen.Solve()), np.median(limits)
figure, axes = plt.subplots(2, 1, figsize=(7, 6), sharex=True, layout="constrained")
axes[0].loglog(gamma0, error_of_pressure, "o-", label="γ = γ₀ h on every element")
axes[0].errorbar(
    middle, error_of_chosen, xerr=[[middle - limits.min()], [limits.max() - middle]], fmt="k*", markersize=12, label="as chosen: median and range of γ/h"
)
axes[0].set(ylabel="relative error of λ")
axes[0].legend()
axes[1].semilogx(gamma0, np.maximum(coercivity, -1), "o-")
axes[1].semilogx(middle, Coercivity(chosen), "k*", markersize=12)
axes[1].axhline(0, color="0.5")
axes[1].set(xlabel="γ₀", ylabel="smallest eigenvalue", ylim=(-1.05, 1.05))
plt.show()

# %% [markdown]
# ## Is it right?
#
# The choice must be coercive, by at least the $1 - \theta = \tfrac12$ that it promises; the error of $\lambda$ that it gives must be near the best of all $\gamma_0$ that are safe;
# and the stabilised P1/P0 pressure must be better than the plain one, the energy not worse.

# %%
best = np.nanmin(np.array(error_of_pressure)[np.array(coercivity) > 0])
print(f"coercivity of the choice {Coercivity(chosen):.3f}; its error of λ {error_of_chosen:.2e}, the best of all safe γ₀ {best:.2e}")
assert Coercivity(chosen) >= 0.5
assert error_of_chosen < 1.5 * best
assert errors["P1/P0", True][0] < 0.5 * errors["P1/P0", False][0] and errors["P1/P0", True][1] < 1.05 * errors["P1/P0", False][1]
