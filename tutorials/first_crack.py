# %% [markdown]
# # A first crack
#
# The unit square ]0,1[ × ]-½,½[ has an edge crack from its left side to the centre. A body force presses the two faces
# of the crack against each other near the tip and parts them near the mouth. Where do they touch, and how hard do they
# press?
#
# The mesh knows nothing of the crack: it goes through the triangles.

# %%
from math import pi

from ngsolve import CF, cos, sin, specialcf, x, y

from ngsxfem_contact import ContactProblem, Crack, CrackedMesh, CrackFESpace, Elasticity, TipEnrichment, TraceSpace
from ngsxfem_contact.paper import unstructured_mesh

material = Elasticity(lam=1, mu=1)
body = CrackedMesh(unstructured_mesh(h=0.03), Crack([(0, 0), (0.5, 0)]))

# %% [markdown]
# Displacements: quadratic functions that may jump across the crack, and the two √r fields of the tip. Multipliers:
# the contact pressure λ = σ_n ≤ 0, piecewise linear along the crack.

# %%
V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material))
W = TraceSpace(body, order=1)

# %% [markdown]
# The stabilisation chooses its parameter itself. `body.dx` and `body.ds` integrate on both sides of the crack. Three
# pinned components hold the body; the loads are in equilibrium.

# %%
problem = ContactProblem(V, W, material)
v = V.TestFunction()
force = CF((0, 3.5 * x * (1 - x) * y * cos(2 * pi * x)))
traction = 0.04 * sin(2 * pi * y) * specialcf.normal(2)
problem.f += force * v * body.dx(bonus_intorder=6) + traction * v * body.ds("left|right", bonus_intorder=6)
problem.Pin((1, -0.5), "xy")
problem.Pin((1, 0.5), "x")
solution = problem.Solve()
print(solution.report)

# %% [markdown]
# The faces touch from s = 0.264 to the tip at s = 0.5, and press with 0.01036 on each other. The tip slips: K_II ≠ 0,
# K_I = 0. `solution.Profile()` has the curves, `solution.Draw()` shows the body in a notebook, and
# `solution.SaveVTK("crack.vtu")` writes it for ParaView.

# %%
print("contact begins at", solution.Transitions(), " force", solution.ContactForce(), " K_I, K_II", *solution.StressIntensity())
assert abs(solution.ContactForce() + 0.01035791) < 0.005 * 0.01035791 and abs(solution.Transitions()[0] - 0.2641) < 0.03
