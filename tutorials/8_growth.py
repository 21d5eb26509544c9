# %% [markdown]
# # 8. Stress intensity factors, and growth
#
# At a tip the stress is $\sigma \sim K_I\, \sigma^I + K_{II}\, \sigma^{II}$, both terms of the order $r^{-1/2}$: $K_I$ opens, $K_{II}$ slides. They decide whether the crack grows, and where to.
# This tutorial computes them, also where the faces touch, and lets cracks grow.

# %%
import matplotlib.pyplot as plt
import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.fracture import GivenIncrement, WingCracks
from ngsxfem_contact.exact import closed_forms
from ngsxfem_contact.exact import fracture_solutions
from ngsxfem_contact.plotting import plot_body

material, a = Elasticity(lam=1, mu=1), 0.25
mesh = closed_forms.rotated_square(0.4, (0.02, -0.03), 0.03)


def plate(law=None):
    """A problem with the crack |x| < a, y = 0 and displacements given on the whole boundary."""
    body = CrackedMesh(mesh, Crack([(-a, 0), (a, 0)]))
    V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material), dirichlet="outer")
    return ContactProblem(V, TraceSpace(body, order=1), material, law=law)


# %% [markdown]
# ## The interaction integral
#
# For $u$ and the field $b$ of a mode with unit factor, both in equilibrium, $M = (\sigma_u : \nabla b)\, e - \sigma_u\, \partial_e b - \sigma_b\, \partial_e u$, with $e$ the direction ahead of the tip, has no sources but the body
# force. With a weight $q$, 1 at the tip and 0 for $r \ge \rho$,
#
# $$I(u, b) = -\int \nabla q \cdot M - \int q\, f \cdot \partial_e b + \int_{\text{lips}} q\, M \cdot \nu = \frac{\kappa + 1}{4\mu_L}\, K,$$
#
# whatever $\rho$ is. The last term is what contact adds: lips that touch are not free of traction. `solution.StressIntensity(tip)` evaluates it.
#
# First an open crack in tension, inclined by 40° to the load, with the exact displacement of the infinite plate on the boundary of the mesh: $K_I = \sigma_{yy} \sqrt{\pi a}$, $K_{II} = \sigma_{xy} \sqrt{\pi a}$.

# %%
exact = fracture_solutions.infinite_plate(material, a, *fracture_solutions.inclined(1, np.radians(40)))
problem = plate()
problem.SetDirichlet(exact.u, "outer")
tension = problem.Solve()
factors = tension.StressIntensity(tip=1)
print(f"exact                K_I = {exact.K_I:.6f}, K_II = {exact.K_II:.6f}")
print(f"interaction integral K_I = {factors.K_I:.6f}, K_II = {factors.K_II:.6f}, reported error {factors.error:.1e}")
for method in ("modes", "jump"):
    K_I, K_II = tension.StressIntensity(tip=1, method=method)
    print(f"{method:20} K_I = {K_I:.6f}, K_II = {K_II:.6f}")

# %% [markdown]
# The three methods for all radii. The integral does not depend on $\rho$, up to the error of the finite elements; coefficients of the tip's modes and extrapolated jumps are cheaper, and worse.

# %%
figure, axes = plt.subplots(1, 2, figsize=(12, 4), sharex=True, layout="constrained")
radii = np.linspace(0.08, 0.2, 9)
values = np.array([tuple(tension.StressIntensity(1, radius=radius)) for radius in radii])
for mode, (ax, K) in enumerate(zip(axes, (exact.K_I, exact.K_II))):
    ax.plot(radii, values[:, mode] / K, "o-", label="interaction integral")
    for method, style in (("modes", "--"), ("jump", ":")):
        ax.axhline(tuple(tension.StressIntensity(1, method))[mode] / K, color="0.3", linestyle=style, label=method)
    ax.set(xlabel="radius ρ of the domain", ylabel=("$K_I$ / exact", "$K_{II}$ / exact")[mode])
axes[0].legend(loc="center right")
plt.show()

# %% [markdown]
# ## A closed tip
#
# Now compression at all angles $\psi$ between the load and the crack. The faces touch, $\sigma_n = \sigma_{yy}$ on the crack, $K_I = 0$, and the crack slides if the shear is larger than friction carries:
#
# $$K_{II} = -\sigma \sin\psi\, (\cos\psi - \mu_f \sin\psi)\, \sqrt{\pi a} \quad\text{or}\quad 0.$$
#
# For each law one factorisation: given displacements are load cases, too.

# %%
angles, found = np.radians(np.arange(15, 90, 12.5)), {}
figure, ax = plt.subplots(figsize=(8, 4.5), layout="constrained")
fine = np.radians(np.linspace(5, 90, 200))
for mu_f, colour in ((0, "tab:blue"), (0.3, "tab:red")):
    problem = plate(Coulomb(mu_f) if mu_f else None)
    cases = []
    for psi in angles:
        pressed = fracture_solutions.infinite_plate(material, a, *fracture_solutions.inclined(-1, psi), mu_f)
        problem.SetDirichlet(pressed.u, "outer")
        cases.append((pressed, LoadCase(problem)))
    steps = LoadSteps(problem, [case for _, case in cases])
    options = {"previous": None} if mu_f else {}  # each angle from the unloaded body
    solved = [steps.Solve(*row, **options) for row in np.eye(len(cases))]
    found[mu_f] = [(solution.StressIntensity(1), pressed) for solution, (pressed, _) in zip(solved, cases)]
    curve = [fracture_solutions.infinite_plate(material, a, *fracture_solutions.inclined(-1, psi), mu_f).K_II for psi in fine]
    ax.plot(np.degrees(fine), curve, color=colour, label=f"$K_{{II}}$, closed form, $\\mu_f$ = {mu_f}")
    ax.plot(np.degrees(angles), [K.K_II for K, _ in found[mu_f]], "o", color=colour, label="$K_{II}$ computed")
    ax.plot(np.degrees(angles), [K.K_I for K, _ in found[mu_f]], "x", color=colour, label="$K_I$ computed")
ax.set(xlabel="angle ψ between load and crack, degrees", ylabel="stress intensity factor")
ax.legend(loc="upper left", bbox_to_anchor=(1, 1))
plt.show()

# %% [markdown]
# ## Energy release rate
#
# $I(u, u) = 2G$ is the J-integral, and Irwin's relation $G = \frac{\kappa + 1}{8 \mu_L} (K_I^2 + K_{II}^2)$ a second way. A third needs no integral around a tip: $G = -d\Pi/da$, the potential energy of two cracks that differ
# in length. On the paper's problem, load A, which opens the crack; and on load B, whose tip is closed and under a body force:

# %%
geometry = SplineGeometry()
geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
square, rates = Mesh(geometry.GenerateMesh(maxh=0.05)), {}
traction = {"A": CF((0, 0.04 * sin(2 * np.pi * y))), "B": 0.04 * sin(2 * np.pi * y) * specialcf.normal(2)}
fitted = {"A": (0.0457374, 0), "B": (0, -0.00790112)}  # K_I, K_II of meshes that follow the crack


def paper_problem(load, length=0.5):
    body = CrackedMesh(square, Crack([(0, 0), (length, 0)]))
    V = CrackFESpace(body, order=2, material=material)
    problem, v = ContactProblem(V, TraceSpace(body, order=1)), V.TestFunction()
    force = CF((0, 3.5 * x * (1 - x) * y * cos(2 * np.pi * x)))
    problem.f += force * v * body.dx(bonus_intorder=6) + traction[load] * v * body.ds("left|right", bonus_intorder=6)
    problem.Pin((1, -0.5), "xy")
    problem.Pin((1, 0.5), "x")
    return problem


for load, (K_I, K_II) in fitted.items():
    rate = paper_problem(load).Solve().EnergyReleaseRate()
    longer, shorter = (paper_problem(load, length=0.5 + d).Solve().PotentialEnergy() for d in (0.02, -0.02))
    reference = (material.kappa + 1) / (8 * material.mu) * (K_I**2 + K_II**2)
    rates[load] = np.array([rate.G, rate.irwin, (shorter - longer) / 0.04]) / reference
    print(f"load {load}: G / reference: J {rates[load][0]:.5f}, Irwin {rates[load][1]:.5f}, -dΠ/da {rates[load][2]:.5f}")

# %% [markdown]
# ## Growth
#
# `CrackGrowth` solves, evaluates both factors at every tip, extends the cracks where the criterion and the law say, and begins again. The mesh never changes. The criterion of the largest hoop stress (Erdogan, Sih
# 1963) turns by $\theta = 2 \arctan\bigl(-2 K_{II} / (K_I + \sqrt{K_I^2 + 8 K_{II}^2})\bigr)$.
#
# An inclined crack in tension turns across the load. In compression its tips are closed and stay as they are, unless they may kink: `WingCracks()` lets a closed tip that slides open a wing at 70.5°.

# %%
geometry = SplineGeometry()
geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
plain = Mesh(geometry.GenerateMesh(maxh=0.035))
start = [Crack([(0.38, -0.1), (0.62, 0.1)])]


def loaded(stress):
    """A function that makes the problem of the square under σ_yy = stress for given cracks."""

    def problem(cracks):
        body = CrackedMesh(plain, *cracks)
        V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material))
        problem, v = ContactProblem(V, TraceSpace(body, order=1), material), V.TestFunction()
        problem.f += CF((0, stress)) * v * body.ds("top") + CF((0, -stress)) * v * body.ds("bottom")
        problem.Pin((1, -0.5), "xy")
        problem.Pin((1, 0.5), "x")
        return problem

    return problem


runs = {
    "tension": CrackGrowth(loaded(1), start, GivenIncrement(0.12)),
    "compression": CrackGrowth(loaded(-1), start, GivenIncrement(0.12)),
    "compression, wings": CrackGrowth(loaded(-1), start, GivenIncrement(0.12), WingCracks()),
}
for name, run in runs.items():
    run.Run(3)
    print(f"{name}\n{run}\n")

# %% [markdown]
# The last state of each; the wings are open, the crack between them is closed and slides.

# %%
figure, axes = plt.subplots(1, 3, figsize=(16, 5.5), layout="constrained")
for ax, (name, run) in zip(axes, runs.items()):
    plot_body(run.solutions[-1], ax).set_title(name)
plt.show()

# %%
run.solutions[-1].Draw()  # the wings, to zoom

# %%
table = runs["compression, wings"].table
first = table[table["end"] == "end"]
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
for crack, style in zip((start[0], runs["compression, wings"].cracks[0]), ("k-", "r--")):
    left.plot(*np.array(crack.Outline()).T, style)
left.set(aspect="equal", xlim=(0, 1), ylim=(-0.5, 0.5), xlabel="x", ylabel="y", title="first and last crack")
for name in ("K_I", "K_II"):
    right.plot(first["length"], first[name], "o-", label=f"${name[0]}_{{{name[2:]}}}$")
right.axhline(0, color="0.5", linewidth=0.6)
right.set(xlabel="length of the crack", ylabel="factor at its end", title="wings grow into compression")
right.legend()
plt.show()

# %% [markdown]
# `SaveTable("growth.csv")` and `Animate("growth.gif")` keep it; `Paris(C, m, da)` counts cycles of fatigue instead.
#
# ## Is it right?
#
# Factors against the infinite plate, open and closed, with and without friction; independence of the radius; energy release rates against fitted meshes; and the angle of the first kink, 70.53°.

# %%
error = max(abs(factors.K_I - exact.K_I), abs(factors.K_II - exact.K_II)) / exact.K_I
spread = np.ptp(values, axis=0).max() / exact.K_I
largest = max(abs(pressed.K_II) for _, pressed in found[0])
closed = max(max(abs(K.K_I), abs(K.K_II - pressed.K_II)) for pairs in found.values() for K, pressed in pairs) / largest
print(f"open: error {error:.1e}, spread over radii {spread:.1e}; closed: error {closed:.1e}; rates: {max(np.abs(r - 1).max() for r in rates.values()):.1e}")
assert error < 1e-3 and spread < 1e-3 and closed < 0.01
assert all(np.abs(rate - 1).max() < 0.01 for rate in rates.values())
assert np.allclose(table["angle"][:2], 70.53, atol=0.01) and (table["K_I"][2:] > 0).all() and not runs["compression"].table["advance"].any()
