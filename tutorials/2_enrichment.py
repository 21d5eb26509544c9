# %% [markdown]
# # 2. What the enrichment does
#
# The displacements of a cracked body jump across the crack, and grow like $\sqrt r$ at its tip. No polynomial on an
# uncracked mesh does either. Cut-off XFEM adds functions that do:
#
# $$V_h = \Bigl\{ \sum_i a_i \varphi_i + \sum_{i \in N_H} b_i H \varphi_i + \chi \sum_j c_j F_j \Bigr\}$$
#
# with NGSolve's own basis $\varphi_i$, the sign $H = \pm 1$ of the two sides, the set $N_H$ of functions whose support the
# crack cuts **completely**, the singular functions $F_j$ (8) of the tip, and a smooth cut-off $\chi$. This tutorial looks at
# each of them.

# %%
import warnings

import matplotlib.pyplot as plt
import numpy as np
from netgen.geom2d import SplineGeometry
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.geometry import ElementKind
from ngsxfem_contact.plotting import plot_mesh
from ngsxfem_contact.plotting.split_mesh import SplitMesh

geometry = SplineGeometry()
geometry.AddRectangle((0, -0.5), (1, 0.5), bcs=["bottom", "right", "top", "left"])
mesh = Mesh(geometry.GenerateMesh(maxh=0.17))
body = CrackedMesh(mesh, Crack([(0, 0.013), (0.53, 0.013)]))
material = Elasticity(lam=1, mu=1)
V = CrackFESpace(body, order=1, tip=TipEnrichment(r0=0.05, r1=0.35, material=material))

# %% [markdown]
# ## Which functions are enriched
#
# Circles are the vertices of $N_H$. Dark triangles are totally enriched, light ones partly; the triangle with the tip has no
# function $H\varphi_i$ of its own, since the support of its vertices is not cut completely. There the tip functions take over; they
# live in the disk $r < r_1$.

# %%
plot_mesh(V)
plt.show()

# %% [markdown]
# ## $H\varphi_i$: the jump
#
# A `SplitMesh` is the mesh of the pictures: triangles that end at the crack, with the points on the crack doubled. On it we draw one
# component of a basis function as a surface. Left $\varphi_i$, a hat. In the middle $H\varphi_i$, as the paper writes it. Right what the
# space stores: $\frac12 (H - s_i)\varphi_i$, with $s_i$ the side of the larger part of the support. The span is the same, but this function
# vanishes on the larger part, and so its coefficient **is** the jump at the node. (Where several cracks divide a support into more than two
# parts, there is such a function for each part but the largest: [method](../method.md), section 3.)

# %%
split = SplitMesh(body, subdivision=2)


def basis_function(coefficients):
    """The GridFunction of V with these coefficients, {number: value}."""
    function = GridFunction(V)
    for dof, value in coefficients.items():
        function.vec[dof] = value
    return function


def surface(ax, function, component, title):
    """One component of a function of V over the body."""
    values = split.Evaluate(Plus(function), Minus(function), function)[:, component]
    near = split.triangles[(np.abs(split.points[split.triangles] - near_tip) < 0.31).all(axis=(1, 2))]
    ax.plot_trisurf(*split.points.T, values, triangles=near, cmap="coolwarm", vmin=-1, vmax=1, linewidth=0.1, edgecolor="0.4")
    limits = [(c - 0.31, c + 0.31) for c in near_tip]
    ax.set(title=title, xlim=limits[0], ylim=limits[1], zlim=(-1, 1), xlabel="x", ylabel="y")
    ax.view_init(elev=22, azim=-115)


j = max(range(V.num_heaviside), key=lambda j: mesh[NodeId(VERTEX, V.Heaviside(j)[0])].point[0])  # the one next to the tip
i, shift = V.Heaviside(j)
jump_dof = V.HeavisideDof(j, 0)
near_tip = mesh[NodeId(VERTEX, i)].point
figure, axes = plt.subplots(1, 3, figsize=(13, 5), subplot_kw={"projection": "3d"}, layout="constrained")
surface(axes[0], basis_function({i: 1}), 0, r"$\varphi_i$")
surface(axes[1], basis_function({i: shift, jump_dof: 2}), 0, r"$H\varphi_i$")
surface(axes[2], basis_function({jump_dof: 1}), 0, r"$\frac{1}{2}(H - s_i)\varphi_i$")
plt.show()

# %% [markdown]
# ## $\chi F_j$: the tip
#
# With `TipEnrichment(material=...)` the tip has vector fields, two for each power $r^{1/2}, r^{3/2}, \dots$ up to the order of the space. The first two are those of unit stress intensity factors:
#
# $$\frac{1}{2\mu}\sqrt{\frac{r}{2\pi}}\begin{pmatrix}\cos\frac\theta2\,(\kappa - 1 + 2\sin^2\frac\theta2) \\ \sin\frac\theta2\,(\kappa + 1 - 2\cos^2\frac\theta2)\end{pmatrix}
# \quad\text{and}\quad
# \frac{1}{2\mu}\sqrt{\frac{r}{2\pi}}\begin{pmatrix}\sin\frac\theta2\,(\kappa + 1 + 2\cos^2\frac\theta2) \\ -\cos\frac\theta2\,(\kappa - 1 - 2\sin^2\frac\theta2)\end{pmatrix},$$
#
# so that their coefficients are $K_I$ and $K_{II}$, and their lips are free of traction. Mode I opens, mode II slides. Below, the body deformed
# by each, and along the crack the jump, which the cut-off $\chi$ ends between $r_0$ and $r_1$ (dotted).

# %%
figure, axes = plt.subplots(2, 2, figsize=(10, 8), height_ratios=[2, 1], layout="constrained")
s = np.linspace(0, body.cracks[0].length, 300)
points = mesh(*np.array([body.cracks[0].PointAt(si) for si in s]).T)
tip, spec = body.tips[0], V.tip_specs[0]
for mode, (above, below) in enumerate(axes.T):
    function = basis_function({V.TipDofs(0)[mode]: 1})
    deformed = split.points + 0.2 * split.Evaluate(Plus(function), Minus(function), function)
    above.tripcolor(
        *deformed.T, split.triangles, facecolors=np.linalg.norm(split.Evaluate(Plus(function), Minus(function), function), axis=1)[split.triangles].mean(axis=1)
    )
    above.set(aspect="equal", title=("mode I", "mode II")[mode], xlabel="x", ylabel="y")
    jump = Jump(function)(points)
    below.plot(s, jump[:, 1], label="normal: gap")
    below.plot(s, jump[:, 0], label="tangential: slip")
    for radius in (spec.r0, spec.r1):
        below.axvline(tip.s - radius, color="0.5", linestyle=":")
    below.set(xlabel="arc length s", ylabel="jump of the displacement")
    below.legend()
plt.show()

# %% [markdown]
# ## Cut quadrature
#
# A Gauss rule on a cut triangle would see the jump as an error. `body.dx` divides each cut triangle along the crack. Around the tip
# it integrates in polar coordinates with $\sqrt r$ as variable, because derivatives of $F_j$ grow like $r^{-1/2}$ there. Below the points of the
# rule, blue on the plus side and red on the minus side; the crosses are those of `body.dcrack`, on the crack itself. (A small disk and
# a tolerance of $10^{-2}$ keep the picture readable; the default is $10^{-5}$.)

# %%
warnings.simplefilter("ignore", AccuracyWarning)  # a disk this small is for the picture
sketch = CrackedMesh(mesh, body.cracks[0])
small_disk = CrackFESpace(sketch, order=1, tip=TipEnrichment(r0=0.03, r1=0.1, material=material, tolerance=1e-2))
*_, X, Y = sketch.dx.Points(2, space=small_disk)
*_, crack_x, crack_y = sketch.dcrack.Points(2, space=small_disk)
figure, axes = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
for ax, (x_range, y_range) in zip(axes, (((0, 0.7), (-0.35, 0.35)), ((0.46, 0.6), (-0.057, 0.083)))):
    plot_mesh(small_disk, ax).get_legend().remove()
    ax.scatter(X, Y, s=5, c=np.where(Y > 0.013, "tab:blue", "tab:red"), zorder=3)
    ax.plot(crack_x, crack_y, "kx", markersize=4, zorder=4)
    ax.set(xlim=x_range, ylim=y_range)
axes[1].set_title("around the tip")
plt.show()

# %% [markdown]
# ## Is it right?
#
# Two things can be checked without solving anything.
#
# 1. **$N_H$.** A vertex is enriched exactly if the crack divides the union of its triangles into two parts. We count, by brute force, the vertices
#    whose triangles have the crack through them and do not hold the tip.
# 2. **The rule at the tip.** $\int_\Omega 1/r$, $r$ the distance to the tip, has a closed form: the tip divides the square into four rectangles, and
#    one with sides $a$, $b$ contributes $a\,\mathrm{arsinh}(b/a) + b\,\mathrm{arsinh}(a/b)$.

# %%
cut = {location.element for location in body.Elements(0)}
holds_tip = {location.element for location in body.Elements(0) if location.kind == ElementKind.Tip}
patches = [{element.nr for element in mesh[NodeId(VERTEX, vertex.nr)].elements} for vertex in mesh.vertices]
expected = sum(bool(patch & cut) and not patch & holds_tip for patch in patches)
print(f"enriched vertices: {V.num_heaviside} of {mesh.nv}, by brute force {expected}")

tip_x, tip_y = tip.point
corners = [(a, b) for a in (tip_x, 1 - tip_x) for b in (tip_y + 0.5, 0.5 - tip_y)]
exact = sum(a * np.arcsinh(b / a) + b * np.arcsinh(a / b) for a, b in corners)
inverse_r = 1 / sqrt((x - tip_x) ** 2 + (y - tip_y) ** 2)
found, plain = Integrate(inverse_r * body.dx(bonus_intorder=10, space=V), mesh), Integrate(inverse_r, mesh, order=10)
print(f"∫1/r: error {abs(found / exact - 1):.1e} with body.dx, {abs(plain / exact - 1):.1e} with Gauss points of order 10")
assert V.num_heaviside == expected
assert abs(found / exact - 1) < 1e-8 < abs(plain / exact - 1)
