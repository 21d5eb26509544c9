# %% [markdown]
# # 11. A part from CAD with a surface crack
#
# A bracket with a fillet, and at the fillet a half-elliptical crack with its mouth on the surface: where such parts fail. The part is made with the geometry kernel of
# NGSolve here; `OCCGeometry("part.step")` takes one from a file in its place. Lengths are mm, forces N, stresses MPa, $K$ is MPa $\sqrt{\mathrm{mm}}$.

# %%
import matplotlib.pyplot as plt
import numpy as np
from netgen.meshing import MeshingParameters
from netgen.occ import Axes, OCCGeometry, WorkPlane, X, Y, Z
from ngsolve import *
from ngsxfem_contact import *
from ngsxfem_contact.geometry import Sheet
from ngsxfem_contact.plotting import plot_body, plot_front, plot_mesh, plot_profile

length, width, thickness, radius = 60, 40, 12, 10
outline = WorkPlane(Axes((0, width / 2, 0), n=-Y, h=X)).MoveTo(0, 0)
for corner in ((length, 0), (length, thickness), (thickness, thickness), (thickness, length), (0, length), (0, 0)):
    outline.LineTo(*corner)
bracket = outline.Face().Extrude(width)
inner = [edge for edge in bracket.edges if abs(edge.center.x - thickness) < 1e-6 and abs(edge.center.z - thickness) < 1e-6]
bracket = bracket.MakeFillet(inner[:1], radius)
bracket.faces.Max(Z).name, bracket.faces.Max(X).name = "clamp", "end"

# %% [markdown]
# ## The crack
#
# Its plane contains the $y$ axis and the line that halves the angle of the bracket. The ellipse has half axes of 7 mm along the fillet and 4 mm into the part; its middle is on the
# fillet. `Sheet.Ellipse` is the whole ellipse: what lies outside of the body is cut off, whatever the surface looks like. So nothing has to fit, and the mesh needs small
# elements at the front only.

# %%
inward = np.array([-1, 0, -1]) / np.sqrt(2)
middle = np.array([thickness + radius, 0, thickness + radius]) + radius * inward
along, deep = np.array([0, 7.0, 0]), 4.0 * inward
sizes = MeshingParameters(maxh=8)
for t in np.linspace(0, np.pi, 80):
    sizes.RestrictH(*(middle + np.cos(t) * along + np.sin(t) * deep), h=0.8)
mesh = Mesh(OCCGeometry(bracket).GenerateMesh(mp=sizes))

body = CrackedMesh(mesh, Sheet.Ellipse(middle, along, deep))
(front,) = body.fronts
print(f"{mesh.ne} tetrahedra; the front is {front.length:.2f} long, from {np.round(front.PointAt(0), 2)} to {np.round(front.PointAt(front.length), 2)}")

# %% [markdown]
# The ends of the front lie 7 mm from the middle, on the surface of the mesh. This surface is made of triangles: sheets cut straight tetrahedra, so that the mesh is taken before
# `mesh.Curve`, and the fillet is a polyhedron here, up to $h^2/8R$ beside the circle of CAD.
#
# ## Load and solution
#
# The upper face is clamped, the end of the lower arm is pulled down with 2 kN, which opens the fillet.

# %%
steel = Elasticity.Solid(E=210e3, nu=0.3)
V = CrackFESpace(body, order=2, material=steel, dirichlet="clamp")
problem = ContactProblem(V, TraceSpace(body))
force = 2000.0
problem.f += CF((0, 0, -force / (width * thickness))) * V.TestFunction() * body.ds("end")
solution = problem.Solve()
print(solution)
print("reaction of the clamp:", np.round(solution.Reaction("clamp"), 6), "N; area in contact:", f"{solution.ContactArea():.4f} mm²")
plot_mesh(V)
plt.show()

# %% [markdown]
# `plot_body` draws the whole body where a sheet has a mouth; `cut=(point, normal)` leaves away what lies on one side of a plane, here through the middle of the crack. The
# arm moves by 0.3 mm, the crack opens by 0.005 mm: at one scale that is little to see. The stress shows where the crack is, low on its faces and high at its front.

# %%
figure = plt.figure(figsize=(13, 5.4), layout="constrained")
plot_body(solution, ax=figure.add_subplot(1, 2, 1, projection="3d"), label="von Mises stress in MPa")
plot_body(solution, ax=figure.add_subplot(1, 2, 2, projection="3d"), label="von Mises stress in MPa", cut=(middle, (0, -1, 0)))
plt.show()

# %%
solution.Draw()

# %%
plot_profile(solution, quantities=("gap", "slip"))
plt.show()

# %% [markdown]
# The plane of the sheet, seen from its plus side, in mm. The slip is a thirtieth of the gap: the crack opens nearly in mode I.
#
# ## $K$ along the front
#
# The tubes of the interaction integral need room: they must not reach the surface. The radius is four elements by default, about 3.9 mm here; a smaller one brings nodes nearer to
# the ends of the front and costs accuracy. Where the front meets the surface itself, the stress has another singularity than $1/\sqrt r$ and $K$ is not defined, so
# that tables end before.

# %%
factors = solution.StressIntensity(front=0, radius=2.2)
plot_front(factors)
plt.show()
factors.table.SaveCSV("bracket_front.csv")
factors.table

# %% [markdown]
# How far is this off? There is no closed form. Three things tell: the column of errors; $G$ of the J-integral beside Irwin's value from the $K$, which are found in different ways; and
# the symmetry of part and load, which the mesh does not have: $K_I(s)$ must be even about the middle of the front, $K_{III}(s)$ odd.

# %%
half = front.length / 2
mirrored = np.interp(2 * half - factors.s, factors.s, factors.K_I)
inside = np.abs(factors.s - half) <= min(half - factors.s[0], factors.s[-1] - half)
asymmetry = np.abs(factors.K_I - mirrored)[inside].max() / factors.K_I.max()
irwin = np.abs(factors.G / factors.irwin - 1).max()
K_middle = np.interp(half, factors.s, factors.K_I)
print(
    f"K_I in the middle: {K_middle:.1f}; asymmetry {100 * asymmetry:.1f} %; G and Irwin differ by {100 * irwin:.1f} %; largest error in the table {100 * factors.errors[:, 0].max() / K_middle:.1f} %"
)

# %% [markdown]
# ## Files
#
# Three files for ParaView, and the table of the sheet.

# %%
print(solution.SaveVTK("bracket", factors=[factors]))
print(solution.Profile().SaveCSV("bracket_sheet.csv"))

# %% [markdown]
# ## Is it right?
#
# The reaction holds the load, the crack is open, and $K_I$ is what three meshes agree on in the middle of the front: 160.7, 160.9 and 161.0 with elements of 1.2, 1.0 and 0.8 mm there and tubes of four
# elements. Towards the ends values scatter more, as the table says.

# %%
assert np.allclose(solution.Reaction("clamp"), (0, 0, force), atol=1e-6)
assert solution.ContactArea() < 0.01 * np.pi / 2 * 7 * 4 and solution.Profile().gap.max() > 0
assert abs(K_middle / 161 - 1) < 0.02 and asymmetry < 0.05 and irwin < 0.1
