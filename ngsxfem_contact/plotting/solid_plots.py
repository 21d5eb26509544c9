"""Pictures of bodies in space: the body open along its sheets, what acts on a sheet, the cells of the mesh that it cuts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF, BoundaryFromVolumeCF

from .._ngsxfem_contact import CrackedSolid
from ..arguments import crack_number
from .clipping import below, section
from .plots import LIPS, PROFILES, body_plot, colour_bar, mesh_plot, profile_plot, pyplot, scene, usual_scale, visible_scale
from .sheet_trace import SheetTrace, middle_normal
from .solid_picture import SolidPicture

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ngsolve import CoefficientFunction

    from .split_solid import SplitSolid

ELEVATION, TURN = 22, 28  # degrees: from where a section is looked at
UNDER = {"loc": "upper center", "bbox_to_anchor": (0.5, 0), "borderaxespad": 3.2, "ncols": 3, "frameon": False}  # of legends: below the name of the axis
DARKEST = 0.62  # of the light on faces that look down
Plane = tuple[np.ndarray, np.ndarray]


@usual_scale.register(CrackedSolid)
def usual_scale_of_solid(body: CrackedSolid, solution: Any) -> float:
    """See usual_scale."""
    picture = SolidPicture(solution)
    return visible_scale(picture.split, picture.u)


@scene.register(CrackedSolid)
def scene_of_solid(body: CrackedSolid, solution: Any, field: CoefficientFunction | None, scale: float | None, options: dict[str, Any]) -> Any:
    """See draw."""
    solution.problem.V.share.Refuse("A picture of a body in space")
    from ngsolve.webgui import Draw

    picture = SolidPicture(solution)
    split = picture.split
    values = split.EvaluateInside(solution.VonMises() if field is None else CF(field))
    low, high = colours_of(split, values)
    plane = usual_cut(split)
    defaults: dict[str, Any] = {
        "order": picture.order,
        "autoscale": False,
        "min": float(low),
        "max": float(high),
        "settings": {"Objects": {"Wireframe": False}},
    }
    defaults["euler_angles"] = euler_angles(*view_of(plane))
    if plane is not None:
        point, normal = plane
        defaults["clipping"] = {"vec": (-normal).tolist(), "pnt": point.tolist(), "dist": 0, "function": True}
    merged = {name: value for name, value in (defaults | options).items() if not (name == "clipping" and value is False)}
    deformation = picture.Displacement(visible_scale(split, picture.u, scale))
    # a function that jumps has no values of its own on triangles
    return Draw(BoundaryFromVolumeCF(split.GridFunction(values)), split.mesh, "field", deformation=deformation, **merged)


def colours_of(split: SplitSolid, values: np.ndarray) -> np.ndarray:
    """The range of values (M, 4, dim) without the least and the largest 2 % of what a section shows: tetrahedra count by volume^(2/3), since many small ones are at fronts."""
    sizes = np.linalg.norm(values, axis=-1) if values.shape[-1] > 1 else values[..., 0]
    corners = split.points[split.tets]
    weights = np.repeat(np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) ** (2 / 3), 4)
    order = np.argsort(sizes.ravel())
    below = np.cumsum(weights[order]) / weights.sum()
    return np.asarray(sizes.ravel()[order][np.searchsorted(below, (0.02, 0.98))])


def usual_cut(split: SplitSolid) -> Plane | None:
    """The plane through the middle of the first sheet and its normal, as steep as can be; None where a sheet has a mouth."""
    if len(mouth_edges(split)):
        return None
    normal = middle_normal(split.body.cracks[0])
    across = np.cross(normal, [0.0, 0.0, 1.0])
    across = np.array([0.0, -1.0, 0.0]) if np.linalg.norm(across) < 1e-6 else across / np.linalg.norm(across)
    if across @ np.array([0.3, -1.0, 0.0]) < 0:
        across = -across
    lips = split.points[split.lips[split.lip_crack == 0]]
    areas = np.linalg.norm(np.cross(lips[:, 1] - lips[:, 0], lips[:, 2] - lips[:, 0]), axis=1)
    return np.average(lips.mean(axis=1), axis=0, weights=areas), across


def mouth_edges(split: SplitSolid) -> np.ndarray:
    """(k, 2): points of edges of lips on the boundary of the body."""
    sides = [(0, 1), (1, 2), (2, 0)]
    of_lips, of_faces = (
        np.unique(np.sort(triangles[:, sides].reshape(-1, 2), axis=1), axis=0) for triangles in (split.lips, split.face_corners[split.outside])
    )
    keys = [edges[:, 0] * len(split.points) + edges[:, 1] for edges in (of_lips, of_faces)]
    return of_lips[np.isin(*keys)]


def view_of(plane: Plane | None) -> tuple[float, float]:
    """Degrees above the plane z = 0, and around z, from which a section is seen."""
    if plane is None:
        return ELEVATION, TURN - 60
    normal = plane[1]
    return float(np.sign(normal[2]) * 60 if abs(normal[2]) > 0.9 else ELEVATION), float(np.degrees(np.arctan2(normal[1], normal[0]))) + TURN


def direction(elevation: float, azimuth: float) -> np.ndarray:
    """Of unit length, to where one looks from."""
    up, around = np.radians([elevation, azimuth])
    return np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])


def euler_angles(elevation: float, azimuth: float) -> list[float]:
    """Degrees about x, y and z, in this order from the left, that turn this direction towards the viewer and z up."""
    towards = direction(elevation, azimuth)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    turn = np.array([right, np.cross(towards, right), towards])
    angles = np.arctan2(-turn[1, 2], turn[2, 2]), np.arcsin(np.clip(turn[0, 2], -1, 1)), np.arctan2(-turn[0, 1], turn[0, 0])
    return np.degrees(angles).tolist()


@body_plot.register(CrackedSolid)
def body_plot_of_solid(body: CrackedSolid, solution: Any, ax: Any, scale: float | None, field: CoefficientFunction | None, label: str, cut: Any) -> Any:
    """See plot_body."""
    solution.problem.V.share.Refuse("A picture of a body in space")
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    picture = SolidPicture(solution)
    split, scale = picture.split, visible_scale(picture.split, picture.u, scale)
    plane = usual_cut(split) if cut is None else None if cut is False else checked_plane(cut)
    values = split.EvaluateInside(solution.VonMises() if field is None else CF(field))
    if not (heights(split, plane) < 0).any():
        raise ValueError(f"plot_body: cut={cut!r} leaves nothing of the body; it keeps what lies opposite to the normal, turn that or move the point")
    ax = ax or pyplot().figure(figsize=(7.5, 5.6), layout="constrained").add_subplot(projection="3d")
    ax.view_init(*view_of(plane))
    towards = direction(*view_of(plane))
    triangles, colours, normals = shown(split, split.points + scale * picture.u, values[..., 0], plane)
    front = normals @ towards > 0
    low, high = colours_of(split, values)
    plt = pyplot()
    colour_map, norm = plt.get_cmap("viridis"), plt.Normalize(low, high)
    light = DARKEST + (1 - DARKEST) * np.clip(normals[front] @ np.array([0.35 * towards[0], 0.35 * towards[1], 0.8]), 0, 1)
    shades = colour_map(norm(colours[front]))
    shades[:, :3] *= light[:, None]
    ax.add_collection3d(Poly3DCollection(triangles[front], facecolors=shades, edgecolors=shades, linewidths=0.3, zorder=1))
    for side, (name, colour) in LIPS.items():
        lines = lip_lines(split, split.points + scale * picture.u, plane, side, towards)
        if len(lines):
            ax.add_collection3d(Line3DCollection(lines, colors=colour, linewidths=1.3, zorder=2, label=name))
    ax.computed_zorder = False
    low_corner, high_corner = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    ax.set(xlim=(low_corner[0], high_corner[0]), ylim=(low_corner[1], high_corner[1]), zlim=(low_corner[2], high_corner[2]), xlabel="x", ylabel="y", zlabel="z")
    ax.set_box_aspect(high_corner - low_corner)
    for axis, part in zip((ax.xaxis, ax.yaxis, ax.zaxis), (high_corner - low_corner) / np.ptp([low_corner, high_corner], axis=0).max()):
        axis.set_major_locator(plt.MaxNLocator(5 if part > 0.6 else 3))
    ax.figure.colorbar(plt.cm.ScalarMappable(norm, colour_map), ax=ax, label=label, extend="both", shrink=0.7, pad=0.08)
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.06), ncols=2, frameon=False)
    ax.set_title(f"deformed body, displacement × {scale:g}")
    return ax


def checked_plane(cut: Any) -> Plane:
    """A point and a normal of unit length; raises ValueError for what is none."""
    try:
        point, normal = (np.asarray(vector, dtype=float) for vector in cut)
    except (TypeError, ValueError):
        raise ValueError(f"plot_body: cut={cut!r} is no (point, normal); give two vectors, or False to leave nothing away") from None
    if point.shape != (3,) or normal.shape != (3,) or not np.isfinite([point, normal]).all() or not np.linalg.norm(normal) > 0:
        raise ValueError(f"plot_body: cut={cut!r} is no (point, normal); the normal must not be zero")
    return point, normal / np.linalg.norm(normal)


def heights(split: SplitSolid, plane: Plane | None) -> np.ndarray:
    """(N,): of the undeformed points over a plane; below it without one."""
    return np.full(len(split.points), -1.0) if plane is None else (split.points - plane[0]) @ plane[1]


def shown(split: SplitSolid, moved: np.ndarray, values: np.ndarray, plane: Plane | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Triangles (n, 3, 3) of the surface below a plane and of the section, moved, their values (n,) and their normals (n, 3) out of the body."""
    d, faces = heights(split, plane), np.concatenate([split.outside, split.lip_faces])
    tet, corners = faces // 4, split.Outward(faces)
    local = (split.tets[tet][:, None] == corners[..., None]).argmax(axis=2)
    rows, weights = below(d[corners])
    triangles = weights @ moved[corners[rows]]
    colours = (weights @ values[tet[rows][:, None], local[rows]][..., None]).mean(axis=(1, 2))
    normals = unit_normals(triangles)
    if plane is not None:
        rows, weights = section(d[split.tets])
        cut = weights @ moved[split.tets[rows]]
        of_cut = unit_normals(cut)
        of_cut *= np.where(of_cut @ plane[1] < 0, -1, 1)[:, None]
        triangles, normals = np.concatenate([triangles, cut]), np.concatenate([normals, of_cut])
        colours = np.concatenate([colours, (weights @ values[rows][..., None]).mean(axis=(1, 2))])
    return triangles, colours, normals


def unit_normals(triangles: np.ndarray) -> np.ndarray:
    """(n, 3), of triangles (n, 3, 3); 0 for those that are lines."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)


def lip_lines(split: SplitSolid, moved: np.ndarray, plane: Plane | None, side: int, towards: np.ndarray) -> np.ndarray:
    """(k, 2, 3): where a lip meets the section, and its mouths on faces that are seen."""
    lips, d = split.lips[split.lip_side == side], heights(split, plane)
    lines = []
    is_below = d[lips] < 0
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # corner i alone on its side
        alone = lips[(is_below[:, i] != is_below[:, j]) & (is_below[:, i] != is_below[:, k])]
        part = lambda a, b: (d[b][:, None] * moved[a] - d[a][:, None] * moved[b]) / (d[b] - d[a])[:, None]
        lines.append(np.stack([part(alone[:, i], alone[:, j]), part(alone[:, i], alone[:, k])], axis=1))
    mouths = mouth_edges(split)
    mouths = mouths[(split.point_side[mouths] != -side).all(axis=1) & (split.point_side[mouths] == side).any(axis=1) & (d[mouths] < 0).all(axis=1)]
    outer = split.Outward(split.outside)
    seen = np.sort(outer[unit_normals(moved[outer]) @ towards > 0][:, [(0, 1), (1, 2), (2, 0)]].reshape(-1, 2), axis=1)
    key = lambda edges: edges[:, 0] * len(moved) + edges[:, 1]
    lines.append(moved[mouths[np.isin(key(mouths), key(seen))]])
    return np.concatenate(lines)


@profile_plot.register(CrackedSolid)
def profile_plot_of_solid(body: CrackedSolid, solution: Any, crack: int | str, ax: Any, quantities: Sequence[str]) -> list[Any]:
    """See plot_profile."""
    number = crack_number(crack, body)
    trace, profile = SheetTrace(body, number), solution.Profile(number)
    rows = profile.RowsOf(trace.element[trace.inside])
    return sheet_axes(trace, ax, [(PROFILES[quantity][0], np.asarray(COLUMNS[quantity](rows))) for quantity in quantities], solution.Transitions(number))


COLUMNS = {"pressure": lambda rows: -rows.sigma_n, "gap": lambda rows: rows.gap, "slip": lambda rows: rows.slip, "shear": lambda rows: rows.sigma_t}


class SheetView:
    """The plane of a sheet, of a curved one that normal to it in the middle, as a picture shows it: to the right and up two of x, y and z where the plane holds them, else the directions nearest to them.

    Parameters
    ----------
    trace : SheetTrace
    """

    def __init__(self, trace: SheetTrace) -> None:
        self.trace, normal = trace, middle_normal(trace.sheet)
        right, up = (np.eye(3)[k] for k in range(3) if k != np.abs(np.round(normal, 9)).argmax())
        right = right - (right @ normal) * normal
        right /= np.linalg.norm(right)
        across = np.cross(normal, right)
        self.axes = np.round([right, across if across @ up > 0 else -across], 12) + 0.0
        self.points = self.Of(trace.places)

    def Of(self, places: np.ndarray) -> np.ndarray:
        """Coordinates (..., 2) of places (..., 3)."""
        return np.asarray(places) @ self.axes.T

    @property
    def outline(self) -> np.ndarray:
        """(k, 2, 2): sides of polygons beyond which the sheet does not go on."""
        return self.points[self.trace.outline]

    @property
    def is_flat(self) -> bool:
        """Whether the sheet is much wider than high."""
        width, height = np.ptp(self.outline.reshape(-1, 2), axis=0)
        return bool(height < 0.5 * width)

    def Bar(self, axis: Any, shown: Any, label: str) -> None:
        """The scale of colours: below a flat sheet, else beside it."""
        if not self.is_flat:
            colour_bar(axis, shown, label)
        else:
            bar = axis.figure.colorbar(shown, ax=axis, label=label, location="bottom", shrink=0.85)
            bar.locator = pyplot().MaxNLocator(5)
            bar.formatter.set_powerlimits((-3, 4))
            bar.update_ticks()

    def Name(self, axis: Any) -> None:
        """Equal axes of matplotlib with the names of the directions."""
        names = ["xyz"[int(np.argmax(v))] if v.max() == 1 else f"along ({', '.join(f'{c:.3g}' for c in v)})" for v in self.axes]
        axis.autoscale_view()
        axis.set(aspect="equal", xlabel=names[0], ylabel=names[1])
        axis.xaxis.set_major_locator(pyplot().MaxNLocator(5))


def sheet_axes(trace: SheetTrace, ax: Any, fields: Sequence[tuple[str, np.ndarray]], edge: np.ndarray) -> list[Any]:
    """Axes with the polygons of a sheet, coloured by fields, (label, values of those inside) each, and lines (k, 2, 3) around the contact zone."""
    from matplotlib.collections import LineCollection, PolyCollection

    number, view = len(fields), SheetView(trace)
    if ax is None:
        ax = pyplot().subplots(1, number, figsize=(4.8 * number, 3.2 if view.is_flat else 4.4), layout="constrained", squeeze=False)[1]
    axes = list(np.ravel(ax))
    polygons = [view.points[loop] for loop, inside in zip(trace.loops, trace.inside) if inside]
    for axis, (label, values) in zip(axes, fields):
        shown = axis.add_collection(PolyCollection(polygons, array=values, cmap="viridis", edgecolors="face", linewidths=0.4))
        view.Bar(axis, shown, label)
        axis.add_collection(LineCollection(list(view.outline), colors="0.3", linewidths=1.0))
        view.Name(axis)
        if len(edge):
            axis.add_collection(LineCollection(list(view.Of(edge)), colors="tab:red", linewidths=1.8, label="edge of contact"))
            axis.legend(**UNDER)
    return axes


@mesh_plot.register(CrackedSolid)
def mesh_plot_of_solid(body: CrackedSolid, V: Any, ax: Any) -> Any:
    """See plot_mesh."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.patches import Patch

    number = len(body.cracks)
    if ax is None:
        ax = pyplot().subplots(1, number, figsize=(5.2 * number, 4.6), layout="constrained", squeeze=False)[1]
    for axis, crack in zip(np.ravel(ax), range(number)):
        trace = SheetTrace(body, crack)
        view, entered = SheetView(trace), np.array([bool(trace.cells[cell].chords) for cell in trace.loop_cell])
        kinds = [
            (~entered, "tab:blue", "Heaviside function"),
            (entered & trace.inside, "tab:green", "front inside"),
            (entered & ~trace.inside, "0.7", "ahead of the front"),
        ]
        for chosen, colour, _ in kinds:
            polygons = [view.points[trace.loops[k]] for k in np.flatnonzero(chosen)]
            axis.add_collection(PolyCollection(polygons, facecolors=colour, alpha=0.3, edgecolors="none"))
            axis.add_collection(PolyCollection(polygons, facecolors="none", edgecolors="0.55", linewidths=0.5))
        axis.add_collection(LineCollection(list(view.outline), colors="tab:red", linewidths=1.6))
        handles = [Patch(color=colour, alpha=0.3, label=label) for chosen, colour, label in kinds if chosen.any()]
        axis.legend(handles=handles, **UNDER)
        view.Name(axis)
    return np.ravel(ax)[0] if number == 1 else np.ravel(ax)
