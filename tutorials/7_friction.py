# %% [markdown]
# # 7. Friction
#
# Faces that touch may stick or slip. With the tangential stress $\sigma_t$ and the slip $g_t$ = jump$(u)\cdot t$ on the crack, a threshold $s \ge 0$, and
# $\sigma_t = 0$ of (4) replaced by
#
# $$|\sigma_t| \le s, \qquad \sigma_t = s\, \frac{g_t}{|g_t|} \quad\text{where } g_t \ne 0,$$
#
# **Tresca's** law gives $s$, **Coulomb's** has $s = \mu_f |\sigma_n|$, with the coefficient of friction $\mu_f$. The law is an argument of `ContactProblem`; a second multiplier
# $\lambda_t \approx \sigma_t$ then lives beside $\lambda$, in the same space and stabilised in the same way.

# %%
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from netgen.geom2d import SplineGeometry
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.algebra import FixedPoint, FullNewton
from ngsxfem_contact.exact import closed_forms
from ngsxfem_contact.plotting import plot_profile

# %% [markdown]
# ## The paper's problem with friction
#
# The paper's square again, with load C: it presses like load B, and shears ten times as much. Three laws on one mesh.

# %%
geometry = SplineGeometry()
geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
mesh = Mesh(geometry.GenerateMesh(maxh=0.06))


def paper_problem(friction):
    body = CrackedMesh(mesh, Crack([(0, 0), (0.5, 0)]))
    V = CrackFESpace(body, order=2, material=Elasticity(lam=1, mu=1))
    problem, v = ContactProblem(V, TraceSpace(body, order=1), law=friction), V.TestFunction()
    force, traction = CF((0, 3.5 * x * (1 - x) * y * cos(2 * np.pi * x))), 0.4 * sin(2 * np.pi * y) * specialcf.normal(2)
    problem.f += force * v * body.dx(bonus_intorder=6) + traction * v * body.ds("left|right", bonus_intorder=6)
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    return problem


laws = {"no friction": None, "Coulomb, $\\mu_f$ = 0.3": Coulomb(0.3), "Tresca, $s$ = 0.05": Tresca(0.05)}
solutions = {name: paper_problem(law).Solve() for name, law in laws.items()}
figure, axes = plt.subplots(3, 3, figsize=(13, 8), sharex=True, sharey="row", layout="constrained")
for column, (name, solution) in zip(axes.T, solutions.items()):
    plot_profile(solution, ax=column, quantities=("pressure", "slip", "shear"))
    column[0].set_title(name)
    profile = solution.Profile(n=400)
    threshold = {"C": 0.3 * np.abs(profile.sigma_n), "T": np.full(400, 0.05)}.get(name[0])
    if threshold is not None:
        column[2].plot(profile.s, threshold, "k:", label="threshold")
        column[2].plot(profile.s, -threshold, "k:")
axes[2, 1].legend()
for ax in axes[:, 1:].flat:
    ax.set_ylabel("")
plt.show()

# %% [markdown]
# The shear slides the upper face to the left, $g_t < 0$. Coulomb's threshold vanishes with the pressure, so that the whole contact zone slips. Tresca's acts on the open part
# as well (`in_contact_only=True` limits it), and the crack sticks near the tip: there $|\lambda_t| < s$ and $K_{II} = 0$. The report counts nodes in each state.

# %%
for name, solution in list(solutions.items())[1:]:
    print(f"{name}: {solution.report.Counts()}, slip ends at s = {solution.SlipTransitions()}, work of friction {solution.DissipatedEnergy():.3e}")
print(solutions["Coulomb, $\\mu_f$ = 0.3"].report)

# %% [markdown]
# "uniqueness" is a number which, if it is below 1, proves that Coulomb's discrete problem has one solution ([method](../method.md), section 7). There may be several
# for large $\mu_f$.
#
# ## Two ways to solve Coulomb's law
#
# `FullNewton()`, the default, has the derivative of the threshold in its matrix, which is not symmetric then. `FixedPoint()` solves a sequence of Tresca's problems, each a
# convex minimisation, with the threshold $\mu_f |\lambda|$ of the one before. Both must give the same answer; the fixed point needs more steps, and their number grows with $\mu_f$.

# %%
figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
difference = 0
for mu_f in (0.2, 0.5, 1.0):
    newton, fixed = (paper_problem(Coulomb(mu_f, method)).Solve() for method in (FullNewton(), FixedPoint()))
    difference = max(difference, np.abs(newton.Multipliers() - fixed.Multipliers()).max() / np.abs(newton.Multipliers()).max())
    changes = np.maximum(fixed.report.threshold_changes, 1e-17)
    ax.semilogy(np.arange(1, len(changes) + 1), changes, "o-", label=f"$\\mu_f$ = {mu_f}")
    print(f"mu_f = {mu_f}: {newton.report.iterations} iterations of Newton, {len(changes)} steps of the fixed point")
ax.set(xlabel="step of the fixed point", ylabel="relative change of the threshold")
ax.legend()
plt.show()
print(f"largest relative difference of the multipliers: {difference:.1e}")

# %% [markdown]
# ## Load steps: a map of stick and slip
#
# Friction remembers: slip counts from where the faces were. A crack is pressed by $\sigma_{yy} = -(0.02 + 0.08\,x)$, more at its tip than at its mouth, and sheared by $\sigma_{xy}$ forth, back
# and forth again. Two load cases, one factorisation, and `LoadSteps` hands each state to the next step.

# %%
geometry = SplineGeometry()
geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
body = CrackedMesh(Mesh(geometry.GenerateMesh(maxh=0.04)), Crack([(0, 0.01), (0.7, 0.01)]))
material, mu_f = Elasticity(lam=1, mu=1), 0.4
V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material))
problem = ContactProblem(V, TraceSpace(body, order=1), material, law=Coulomb(mu_f))
problem.Pin((1, -0.5), "xy")
problem.Pin((1, 0.5), "x")
v, n = V.TestFunction(), specialcf.normal(2)
problem.f += CF((0, -(0.02 + 0.08 * x) * n[1])) * v * body.ds
press = LoadCase(problem)
problem.f += 0.03 * CF((n[1], n[0])) * v * body.ds
both = LoadCase(problem)

steps = LoadSteps(problem, [press, both])
cycle = np.concatenate([np.linspace(0, 1, 21), np.linspace(0.9, -1, 20), np.linspace(-0.9, 1, 20)])
history = [steps.Solve(1 - t, t) for t in cycle]

# %% [markdown]
# Each column of the map is the crack at one step, from the mouth below to the tip above. Slip begins at the mouth, where the threshold is low, and spreads; when the load turns, everything sticks, and the
# slip in the other direction begins at the mouth again. The tip itself is reached last.

# %%
states = np.array([np.where(solution.report.active[-1], solution.report.tangential[-1], 3) for solution in history])
s = problem.W.NodalPositions()[0]
order = np.argsort(s)
names, colours = ("slip, $g_t$ falls", "slip, $g_t$ grows", "stick", "open"), ("tab:blue", "tab:red", "0.85", "white")
code = {-1: 0, 1: 1, 2: 2, 3: 3, 0: 3}
picture = np.vectorize(code.get)(states[:, order]).T
figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 6), sharex=True, height_ratios=[3, 1], layout="constrained")
mesh_of_states = top.pcolormesh(
    np.arange(len(cycle)), np.array(s)[order], picture, cmap=ListedColormap(colours), norm=BoundaryNorm(np.arange(-0.5, 4), 4), shading="nearest"
)
bar = figure.colorbar(mesh_of_states, ax=top, ticks=range(4))
bar.ax.set_yticklabels(names)
top.set_ylabel("arc length s")
bottom.plot(0.03 * cycle, "k.-")
bottom.set(xlabel="load step", ylabel="shear $\\sigma_{xy}$")
plt.show()

# %% [markdown]
# The loop that it makes, and the work that friction dissipates. `DissipatedEnergy()` is $\int \lambda_t\, \Delta g_t \ge 0$ of one step.

# %%
slip = [Integrate(Slip(solution.u, body) * body.dcrack, body.mesh) for solution in history]
work = [solution.DissipatedEnergy() for solution in history]
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
left.plot(slip, 0.03 * cycle, "k.-")
left.set(xlabel="$\\int g_t$ over the crack", ylabel="shear $\\sigma_{xy}$")
right.plot(np.cumsum(work), "k.-")
right.set(xlabel="load step", ylabel="dissipated work")
plt.show()
print(f"least work of a step {min(work):.1e}, of the whole cycle {sum(work):.3e}")

# %% [markdown]
# ## Is it right?
#
# 1. **Closed form (e)** of [method](../method.md), section 10: the crack is pressed by $-p$ and slides on its whole length under $\sigma_{xy} = \mu_f\, p$, with a field of $K_{II} = 1$ on top. Exact
#    displacements on the boundary of a rotated square; errors of $u$ in the energy norm, of $\lambda$, $\lambda_t$ and $g_t$ in $L^2(\Gamma_C)$.
# 2. **Fitted meshes**: energies and forces of the paper's problem with friction.

# %%
exact, mouth = closed_forms.sliding_tip(material, mu_f), closed_forms.mouths(0.4, (0.03, -0.02))[0]
rows, sizes = [], (0.12, 0.08, 0.05)
for h in sizes:
    square = CrackedMesh(closed_forms.rotated_square(0.4, (0.03, -0.02), h), closed_forms.crack_on_axis(mouth, 0))
    space = CrackFESpace(square, order=2, tip=TipEnrichment(material=material), dirichlet="outer")
    sliding = ContactProblem(space, TraceSpace(square, order=1), material, law=Coulomb(mu_f))
    sliding.SetDirichlet(exact.u, "outer")
    solution = sliding.Solve()
    measures = (closed_forms.energy_error, closed_forms.pressure_error, closed_forms.shear_error, closed_forms.slip_error)
    rows.append([measure(solution, exact) for measure in measures] + [abs(solution.StressIntensity(0).K_II - 1)])
plt.figure(figsize=(7, 4), layout="constrained")
for values, label in zip(np.transpose(rows), ("u, energy norm", "$\\lambda$", "$\\lambda_t$", "slip", "$K_{II}$")):
    plt.loglog(sizes, values, "o-", label=f"{label} ({np.polyfit(np.log(sizes), np.log(values), 1)[0]:.1f})")
plt.xlabel("maxh")
plt.ylabel("error (slope)")
plt.legend(loc="upper left", bbox_to_anchor=(1, 1))
plt.show()

# %%
fitted = {"Coulomb, $\\mu_f$ = 0.3": (0.0129048965, -0.00310737614), "Tresca, $s$ = 0.05": (0.012167274, -0.0243486523)}
for name, (energy, force) in fitted.items():
    solution = solutions[name]
    of_energy, of_force = abs(solution.Energy() / energy - 1), abs(solution.TangentialForce() / force - 1)
    print(f"{name:24} relative error of the energy {of_energy:.1e}, of the tangential force {of_force:.1e}")
    assert of_energy < 1e-3 and of_force < 0.01
orders = [np.polyfit(np.log(sizes), np.log(values), 1)[0] for values in np.transpose(rows)]
assert orders[0] > 1.8 and min(orders[1:4]) > 1.5 and rows[-1][4] < 1e-2
assert difference < 1e-9 and min(work) > -1e-12 * sum(work)
