# %% [markdown]
# # 1. A first crack, in 15 lines
#
# The unit square $(0, 1) \times (-\tfrac12, \tfrac12)$ has an edge crack from the middle of its left side to its centre. A body force presses the
# two faces of the crack against each other near the tip and parts them near the mouth. Where do they touch, and how hard
# do they press?
#
# In classical terms: find the displacement $u$ with
#
# $$-\operatorname{div}\sigma(u) = f, \qquad \sigma = \lambda_L \operatorname{tr}\varepsilon(u)\, I + 2\mu_L\, \varepsilon(u)$$
#
# and, on the crack $\Gamma_C$ without friction, with the gap $g_n$ between its faces and the normal stress $\sigma_n$,
#
# $$g_n \ge 0, \qquad \sigma_n \le 0, \qquad \sigma_n\, g_n = 0, \qquad \sigma_t = 0$$
#
# (equations (1) to (5) of the paper that the README names). Either the faces are apart and free, or they touch and press.
#
# Everything else is NGSolve as you know it. `from ngsxfem_contact import *` adds the crack.

# %%
from math import pi

from netgen.geom2d import SplineGeometry
from ngsolve import *
from ngsxfem_contact import *

# %% [markdown]
# ## The problem
#
# The mesh covers the **uncracked** body and knows nothing of the crack, which runs through its triangles. `CrackedMesh`
# joins the two. `CrackFESpace` holds displacements that may jump across the crack and, at the tip, behave like $\sqrt r$;
# `TraceSpace` holds the unknown contact pressure, $\lambda = \sigma_n \le 0$, on the crack.
#
# `body.dx` and `body.ds` are the measures to integrate with: they see both sides of the crack. Three pinned components hold
# the body; the loads are in equilibrium, so that the pins carry no force.

# %%
geometry = SplineGeometry()
geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
mesh = Mesh(geometry.GenerateMesh(maxh=0.06))
body = CrackedMesh(mesh, Crack([(0, 0), (0.5, 0)]))
material = Elasticity(lam=1, mu=1)
V = CrackFESpace(body, order=2, tip=TipEnrichment(material=material))
W = TraceSpace(body, order=1)
problem = ContactProblem(V, W, material)
v = V.TestFunction()
force = CF((0, 3.5 * x * (1 - x) * y * cos(2 * pi * x)))
traction = 0.04 * sin(2 * pi * y) * specialcf.normal(2)
problem.f += force * v * body.dx(bonus_intorder=6) + traction * v * body.ds("left|right", bonus_intorder=6)
problem.Pin((1, -0.5), "xy")
problem.Pin((1, 0.5), "x")
solution = problem.Solve()

# %% [markdown]
# These are the 15 lines. The report says what the solve did: the number of multipliers in contact in each iteration of the
# active set, and how well the two rows of the discrete problem are fulfilled.

# %%
print(solution.report)

# %% [markdown]
# ## Seeing it
#
# In a notebook `solution.Draw()` shows the deformed body in the browser: turn and zoom it. The crack is open and sharp,
# because the picture is drawn on a mesh whose triangles end at the crack.

# %%
solution.Draw()

# %% [markdown]
# The same with matplotlib, for a paper. Colours are the von Mises stress; any other field goes in as `field=`.

# %%
import matplotlib.pyplot as plt
from ngsxfem_contact.plotting import plot_body, plot_profile

plot_body(solution)
plt.show()

# %% [markdown]
# And along the crack. At the mouth, $s = 0$, the faces are apart; from $s \approx 0.26$ to the tip at $s = 0.5$ they touch
# (grey). Where there is a gap there is no pressure, and the other way round.

# %%
plot_profile(solution)
plt.show()

# %% [markdown]
# ## Numbers
#
# The contact force is $\int_{\Gamma_C} \lambda$. The tip is closed, so that $K_I = 0$, but it slips: $K_{II} \ne 0$, by the
# interaction integral around the tip, with an error of its own ([tutorial 8](8_growth)). `solution.SaveVTK("crack.vtu")` writes it all
# for ParaView, `solution.Save("crack.solution")` keeps it for another day.

# %%
(begin,) = solution.Transitions()
K_I, K_II = solution.StressIntensity(tip=0)
print(f"contact begins at s = {begin:.4f}, the faces press with {solution.ContactForce():.6f}, K_I = {K_I:.1e}, K_II = {K_II:.5f}")

# %% [markdown]
# ## Is it right?
#
# A solution on a mesh that is fitted to the crack, made with another program and polynomials of high order, has the force
# −0.01035791 and the end of contact 0.2641 ([measured](../measured.md)).

# %%
force_error = abs(solution.ContactForce() / -0.01035791 - 1)
print(f"error of the force {force_error:.1e}, of the transition {abs(begin - 0.2641):.3f}")
assert force_error < 0.005 and abs(begin - 0.2641) < 0.03
