"""Pictures and VTK with the crack open and sharp, on the split mesh.

Other Parameters
----------------
scale
    Of the displacement; by default the largest is 5 % of the body's size.
"""

from __future__ import annotations

import logging
from functools import singledispatch
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from ngsolve import CF, VTKOutput

from ..arguments import check_function, check_has, check_number, check_positive
from ..files import write_whole
from ..operators import Minus, Plus
from ..points import mesh_arrays
from ..share import share_in
from ..spaces.unknowns import Unknowns
from ..whole_mesh import whole_mesh
from .picture import Picture
from .split_mesh import SplitMesh

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import CoefficientFunction, Mesh

    from .._ngsxfem_contact import CrackFESpace
    from ..contact.solution import ContactSolution
    from ..material import Isotropic

logger = logging.getLogger(__name__)

LIPS = {1: ("plus lip", "tab:red"), -1: ("minus lip", "tab:blue")}


def von_mises(material: Isotropic, strain: CoefficientFunction) -> CoefficientFunction:
    """The von Mises stress of a strain, in the unit of lam and mu.

    Parameters
    ----------
    material : Elasticity
        Of the body.
    strain : CoefficientFunction
        A 2 × 2 matrix.
    """
    return material.VonMises(material.Stress(strain))


def split_displacement(solution: ContactSolution) -> tuple[SplitMesh, np.ndarray]:
    """The SplitMesh that suits the order of u, and the displacement (N,2) at its points."""
    u = solution.u
    split = SplitMesh(solution.body, subdivision=int(np.ceil(np.log2(u.space.order))))
    return split, split.Evaluate(Plus(u), Minus(u), u)


def visible_scale(split: Any, displacement: np.ndarray, scale: float | None = None) -> float:
    """A given factor, or that of two digits which shows the largest displacement as 5 % of the body's size; raises ValueError unless it is finite."""
    if scale is not None:
        check_number(scale, "scale")
        return scale
    largest = share_in(split.body).Max(np.linalg.norm(displacement, axis=1).max())
    return float(f"{0.05 * np.ptp(split.points, axis=0).max() / largest:.2g}") if largest > 0 else 1.0


@singledispatch
def usual_scale(body: Any, solution: ContactSolution) -> float:
    """That of visible_scale for a solution."""
    return visible_scale(*split_displacement(solution))


def pyplot() -> Any:
    """matplotlib.pyplot; raises ImportError that says how to install it."""
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise ImportError("pictures need matplotlib: run `pip install ngsxfem_contact[plot]`") from None
    return plt


def legend_below(ax: Any) -> None:
    """The legend, under the axes and their label."""
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, frameon=False)


def colour_bar(ax: Any, colours: Any, label: str, **options: Any) -> Any:
    """The scale of colours, as long as the axes are when their units have become equal."""
    return ax.figure.colorbar(colours, cax=ax.inset_axes([1.04, 0, 0.045, 1]), label=label, **options)


def picture_of(solution: ContactSolution, scale: float | None, field: CoefficientFunction | None = None) -> tuple[Picture, float, np.ndarray, np.ndarray]:
    """(Picture, scale, scaled displacement (N, 2), values (M, 3, dim) of a field, one-sided at the lips); field=None: the von Mises stress."""
    split, u = split_displacement(solution)
    picture, scale = Picture(split, solution.problem.V.share), visible_scale(split, u, scale)
    return picture, scale, picture.Whole(scale * u), picture.Whole(split.EvaluateInside(solution.VonMises() if field is None else CF(field)))


def colour_range(values: np.ndarray) -> np.ndarray:
    """Of values (M, 3, dim). Stresses are infinite at tips: the range leaves out the least and the largest 2 %."""
    return np.quantile(np.linalg.norm(values, axis=-1) if values.shape[-1] > 1 else values, (0.02, 0.98))


def plot_body(
    solution: ContactSolution,
    ax: Any = None,
    scale: float | None = None,
    field: CoefficientFunction | None = None,
    label: str = "von Mises stress",
    cut: Any = None,
) -> Any:
    """The deformed body, coloured by a scalar field, and the two lips of each crack; returns the axes, of several processes on the first one, else None.

    Parameters
    ----------
    solution : ContactSolution
        What is drawn.
    ax : Axes
        Of matplotlib; default new ones. In space those of projection="3d".
    field
        CoefficientFunction such as `solution.stress[1, 1]`, with its label; by default the von Mises stress.
    label : str
        Of the field.
    cut : (point, normal) or False
        In space: what lies on this side of a plane is left away, so that a crack inside shows. By default a plane through the middle of the first sheet, perpendicular
        to it; where a sheet reaches the boundary, and for False, the whole body is drawn.

    Notes
    -----
    The colours leave out the least and the largest 2 % of the values. In space u is drawn as linear between points.
    """
    check_has(solution, "problem", "plot_body: solution", "a solution of ContactProblem.Solve()")
    if field is not None:
        field = check_function(field, "plot_body: field, such as solution.stress[1, 1],", 1)
    return body_plot(solution.body, solution, ax, scale, field, label, cut)


@singledispatch
def body_plot(body: Any, solution: ContactSolution, ax: Any, scale: float | None, field: CoefficientFunction | None, label: str, cut: Any) -> Any:
    """See plot_body."""
    if cut is not None:
        raise ValueError("plot_body: cut is there for bodies in space only")
    picture, scale, u, values = picture_of(solution, scale, field)
    return picture.share.Together(lambda: drawn_body(picture, scale, u, values, ax, label) if picture.share.is_first else None)


def drawn_body(picture: Picture, scale: float, u: np.ndarray, values: np.ndarray, ax: Any, label: str) -> Any:
    """The axes with a Picture of the body, displaced by u (N, 2), coloured by values (M, 3, 1)."""
    ax = ax or pyplot().subplots(layout="constrained")[1]
    low, high = colour_range(values)
    shape = picture.points + u
    corners = shape[picture.triangles].reshape(-1, 2)
    numbers = np.arange(len(corners)).reshape(-1, 3)
    colours = ax.tripcolor(*corners.T, numbers, values.ravel(), shading="gouraud", vmin=low, vmax=high)
    colour_bar(ax, colours, label, extend="both")
    for side, (name, colour) in LIPS.items():
        edges = shape[picture.lips[picture.lip_side == side]]
        lines = np.concatenate([edges, np.full_like(edges[:, :1], np.nan)], axis=1).reshape(-1, 2)  # nan lifts the pen
        ax.plot(*lines.T, color=colour, linewidth=1.2, label=name)
    legend_below(ax)
    ax.set(aspect="equal", xlabel="x", ylabel="y", title=f"deformed body, displacement × {scale:g}")
    return ax


PROFILES = {
    "pressure": ("pressure $-\\lambda$", lambda profile: -np.asarray(profile.sigma_n)),
    "gap": ("normal gap $g_n$", lambda profile: profile.gap),
    "slip": ("slip $g_t$", lambda profile: profile.slip),
    "shear": ("tangential stress $\\sigma_t$", lambda profile: profile.sigma_t),
}


def plot_profile(solution: ContactSolution, crack: int | str = 0, ax: Any = None, quantities: Sequence[str] = ("pressure", "gap")) -> list[Any]:
    """Quantities along a crack, the contact zone shaded; in space on a sheet, with the edge of contact.

    Parameters
    ----------
    solution : ContactSolution
        What is drawn.
    crack : int
        Number of the crack.
    ax : Axes
        One for each quantity; default new ones.
    quantities : sequence of str
        Of "pressure" -λ, "gap", "slip", "shear".
    """
    for quantity in quantities:
        if quantity not in PROFILES:
            raise ValueError(f"plot_profile: quantities={quantities!r}: {quantity!r} is not one of {list(PROFILES)}")
    check_has(solution, "Profile", "plot_profile: solution", "a solution of ContactProblem.Solve()")
    return profile_plot(getattr(solution, "body", None), solution, crack, ax, quantities)


@singledispatch
def profile_plot(body: Any, solution: ContactSolution, crack: int | str, ax: Any, quantities: Sequence[str]) -> list[Any]:
    """See plot_profile."""
    profile = solution.Profile(crack=crack, n=400)
    axes = list(np.ravel(pyplot().subplots(len(quantities), 1, sharex=True, layout="constrained")[1] if ax is None else ax))
    pressure = -np.asarray(profile.sigma_n)
    contact = pressure > 1e-8 * np.abs(pressure).max()
    for axis, quantity in zip(axes, quantities):
        label, values = PROFILES[quantity]
        axis.fill_between(profile.s, 0, 1, where=contact, transform=axis.get_xaxis_transform(), color="0.88", label="contact")
        axis.axhline(0, color="0.5", linewidth=0.6)
        axis.plot(profile.s, values(profile), color="tab:blue")
        axis.set_ylabel(label)
    if contact.any():
        axes[0].legend(loc="best")
    axes[-1].set_xlabel("arc length s along the crack")
    return axes


def plot_mesh(V: CrackFESpace, ax: Any = None) -> Any:
    """The mesh, the cracks, and what enriches the space: circles on vertices with a Heaviside function, the disks of the tips' functions.

    Triangles are light if some of their vertices are enriched, darker if all are. In space: the polygons in which the sheets cut the elements, those that a front enters
    in another colour. Returns the axes. Of several processes the first one draws the whole mesh, the others return None.

    Parameters
    ----------
    V : CrackFESpace
        Whose mesh, cracks and functions are drawn.
    ax : Axes
        Of matplotlib; default new ones. In space one for each sheet.
    """
    check_has(V, "body", "plot_mesh: V", "a CrackFESpace")
    V.share.Refuse("A picture of a mesh in space", V.mesh.dim != 2)
    return mesh_plot(V.body, V, ax)


@singledispatch
def mesh_plot(body: Any, V: CrackFESpace, ax: Any) -> Any:
    """See plot_mesh."""
    (mesh, numbers), share = whole_mesh(V.share), V.share
    return share.Together(lambda: drawn_mesh(mesh, np.asarray(np.searchsorted(numbers, share.vertices)), V, ax) if mesh is not None else None)


def drawn_mesh(mesh: Mesh, place: np.ndarray, V: CrackFESpace, ax: Any) -> Any:
    """The picture of a whole mesh in which the vertices of the mesh of V have the numbers place (nv,)."""
    body, ax = V.body, ax or pyplot().subplots(layout="constrained")[1]
    vertices, elements = mesh_arrays(mesh)
    enriched = place[[dof for dof in Unknowns(V).enriched if dof < len(place)]]  # dof i of P_k is vertex i
    count = np.isin(elements, enriched).sum(axis=1)
    if count.any():
        ax.tripcolor(*vertices.T, elements[count > 0], facecolors=np.where(count == 3, 2.0, 1.0)[count > 0], cmap="Blues", vmin=0, vmax=6)
    ax.triplot(*vertices.T, elements, color="0.7", linewidth=0.5)
    ax.plot(*vertices[enriched].T, "o", color="tab:blue", markerfacecolor="none", markersize=5, label="Heaviside function")
    for i, crack in enumerate(body.cracks):
        ax.plot(*np.array(crack.Outline()).T, color="tab:red", linewidth=2, label="" if i else "crack")
    disks = [(tip, spec) for tip, spec in zip(body.tips, V.tip_specs) if spec]
    for i, (tip, spec) in enumerate(disks):
        angle = np.linspace(0, 2 * np.pi, 100)
        ring = np.array(tip.point)[:, None] + spec.r1 * np.array([np.cos(angle), np.sin(angle)])
        ax.plot(*ring, "--", color="tab:green", label="" if i else "tip functions, $r < r_1$")
    legend_below(ax)
    ax.set(aspect="equal", xlabel="x", ylabel="y")
    return ax


def save_vtk(solution: ContactSolution, path: str | Path, factors: Sequence[Any] = ()) -> str:
    """Writes displacement, stresses and side on the split mesh as .vtu (ending added if missing); returns the file's name.

    In space two files more, whose names end in _sheets and _fronts: see SolidSolution.SaveVTK. The files appear when they are complete: an interrupted run, or a full disk
    (OSError), leaves none, or the ones before.

    Parameters
    ----------
    solution : ContactSolution
        What is written.
    path : str
        The ending .vtu is added if it is missing.
    factors
        In space: FrontFactors of some fronts, which the file of the fronts shows.

    Returns
    -------
    str
        The name of the file.
    """
    path = Path(path)
    if not path.name:
        raise ValueError(f"SaveVTK: {str(path)!r} is not the name of a file")
    return saved_vtk(solution.body, solution, path if path.suffix == ".vtu" else path.with_name(path.name + ".vtu"), factors)


@singledispatch
def saved_vtk(body: Any, solution: ContactSolution, path: Path, factors: Sequence[Any]) -> str:
    """See save_vtk."""
    if len(factors):
        raise ValueError("SaveVTK: factors are there for fronts of bodies in space only")
    share, (split, u) = solution.problem.V.share, split_displacement(solution)
    stress = solution.stress
    names = ["von_mises", "stress_xx", "stress_yy", "stress_xy"]
    scalars = CF((solution.VonMises(), stress[0, 0], stress[1, 1], stress[0, 1]))
    values, side = split.EvaluateInside(scalars), np.repeat(split.side, 3).reshape(-1, 3, 1)
    picture = Picture(split, share)
    columns = [picture.Whole(u), *(picture.Whole(values[..., [i]]) for i in range(4)), picture.Whole(side)]

    def write(temporary: Path) -> None:
        u, *others = map(picture.GridFunction, columns)
        VTKOutput(picture.mesh, [CF((u, 0)), *others], ["displacement", *names, "side"], filename=str(temporary.with_suffix(""))).Do()

    return share.Together(lambda: str(write_whole(path, write, end=b"</VTKFile>") if share.is_first else path))


def draw(solution: ContactSolution, field: CoefficientFunction | None = None, scale: float | None = None, **options: Any) -> Any:
    """ngsolve.webgui.Draw of a field on the deformed split mesh, the lips drawn as edges; of several processes the first one draws, others return None.

    Parameters
    ----------
    solution : ContactSolution
        What is drawn.
    field
        CoefficientFunction such as `solution.u` or `solution.stress[1, 1]`; by default the von Mises stress.
    **options
        Of ngsolve.webgui.Draw, such as filename="u.html", min=0, max=1, settings={"Objects": {"Wireframe": True}}. In space a clipping plane opens the body where no
        sheet reaches the boundary; clipping={"vec": (0, 1, 0), "pnt": (0, 0, 0)} takes another one, clipping=False none.
    """
    return scene(solution.body, solution, field, scale, options)


@singledispatch
def scene(body: Any, solution: ContactSolution, field: CoefficientFunction | None, scale: float | None, options: dict[str, Any]) -> Any:
    """See draw."""
    from ngsolve.webgui import Draw

    picture, _, u, values = picture_of(solution, scale, field)
    return picture.share.Together(lambda: drawn_in_webgui(Draw, picture, u, values, options) if picture.share.is_first else None)


def drawn_in_webgui(Draw: Any, picture: Picture, u: np.ndarray, values: np.ndarray, options: dict[str, Any]) -> Any:
    """What Draw of NGSolve's webgui returns for a Picture, displaced by u (N, 2), coloured by values (M, 3, dim)."""
    low, high = colour_range(values)
    defaults = {"order": 1, "autoscale": False, "min": float(low), "max": float(high), "settings": {"Objects": {"Wireframe": False}}}
    # scaled here: Draw applies its own scale to no deformation that is a function
    return Draw(picture.GridFunction(values), picture.mesh, "field", deformation=picture.GridFunction(u), **defaults | options)


def animate(solutions: Sequence[ContactSolution], path: str | Path, titles: Sequence[str], scale: float | None = None, seconds: float = 0.5) -> str:
    """Writes plot_body of every solution, at one scale, as an animated GIF; returns its name. It appears when it is complete."""
    solutions[0].problem.V.share.Refuse("An animation")
    plt = pyplot()
    from matplotlib.animation import PillowWriter

    check_positive(seconds, "seconds")
    scale = scale or min(usual_scale(solution.body, solution) for solution in solutions)
    figure, fps = plt.figure(figsize=(6, 6), layout="constrained"), cast(int, 1 / seconds)

    def write(temporary: Path) -> None:
        with PillowWriter(fps=fps).saving(figure, temporary, dpi=80) as frames:
            for number, (solution, title) in enumerate(zip(solutions, titles)):
                logger.info("picture %d of %d of %s", number + 1, len(solutions), Path(path).name)
                figure.clear()
                plot_body(solution, figure.add_subplot(projection="3d" if solution.body.mesh.dim == 3 else None), scale).set_title(title, fontsize=9)
                frames.grab_frame()

    try:
        return str(write_whole(Path(path), write))
    finally:
        plt.close(figure)
