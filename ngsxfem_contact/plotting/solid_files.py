"""VTK files of bodies in space: the body open along its sheets, the sheets with what acts there, the fronts with K."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, ElementTree, SubElement

import numpy as np
from ngsolve import CF

from .._ngsxfem_contact import CrackedSolid
from ..arguments import check_type
from ..files import write_all
from ..operators import Jump, Minus, Plus
from ..points import element_regions, mesh_points, reference_coordinates
from .plots import saved_vtk
from .sheet_trace import SheetTrace
from .solid_division import EDGES
from .solid_picture import SolidPicture

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..share import Share

STRESSES = {"stress_xx": (0, 0), "stress_yy": (1, 1), "stress_zz": (2, 2), "stress_xy": (0, 1), "stress_yz": (1, 2), "stress_xz": (0, 2)}
STATES = {"open": 0, "contact": 1, "stick": 1, "slip": 2}
LINE, POLYGON, TETRAHEDRON, QUADRATIC_TETRAHEDRON = 3, 7, 10, 24  # VTK's numbers of cells
VTK_EDGES = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]  # the order of the points on the edges of the last
END = b"</VTKFile>"


@dataclass(frozen=True)
class Grid:
    """Points (N, 3), cells of one kind as arrays of their numbers, data of points and of cells by their names."""

    points: np.ndarray
    cells: list[np.ndarray]
    kind: int
    of_points: dict[str, np.ndarray]
    of_cells: dict[str, np.ndarray]


@saved_vtk.register(CrackedSolid)
def saved_solid(body: CrackedSolid, solution: Any, path: Path, factors: Sequence[Any]) -> str:
    """Three files, all or none: of the body, and beside it of its sheets and fronts, whose names end in _sheets and _fronts. The name of the first. The first process writes."""
    share = solution.problem.V.share
    beside = {part: path.with_name(f"{path.stem}_{part}.vtu") for part in ("sheets", "fronts")}
    grids = {path: body_data(solution), beside["sheets"]: sheet_data(solution)} | ({beside["fronts"]: front_data(body, factors)} if body.fronts else {})
    share.Together(lambda: write_all([(name, vtu_writer(grid), END) for name, grid in grids.items()]) if share.is_first else None)
    return str(path)


def body_data(solution: Any) -> Grid:
    """The body open along its sheets: u at points, and at the middles of edges where it is quadratic; stresses, which jump, at the centres of the cells."""
    picture = SolidPicture(solution)
    split, stress = picture.split, solution.stress
    points, u, cells = split.points, picture.u, split.tets
    if picture.at_edges is not None:
        edges, of_tets = split.edges
        cells = np.column_stack([cells, len(points) + of_tets[:, [EDGES.tolist().index(edge) for edge in VTK_EDGES]]])
        points, u = np.concatenate([points, points[edges].mean(axis=1)]), np.concatenate([u, picture.at_edges])
    values = split.EvaluateCentres(CF((solution.VonMises(), *(stress[i, j] for i, j in STRESSES.values()))))
    of_cells = dict(zip(("von_mises", *STRESSES), values.T)) | {"side": split.side, "region": element_regions(solution.body.mesh)[split.element]}
    share = solution.problem.V.share
    return of_all(share, share.IsOwn(split.element), points, cells, u, of_cells)


def of_all(share: Share, own: np.ndarray, points: np.ndarray, cells: np.ndarray, u: np.ndarray, of_cells: dict[str, np.ndarray]) -> Grid:
    """The Grid of the tetrahedra that processes own, on the first one; points between processes are there once for each of them."""
    used, numbers = np.unique(cells[own], return_inverse=True)
    mine = points[used], u[used], numbers.reshape(-1, cells.shape[1]), {name: values[own] for name, values in of_cells.items()}
    rows = share.AtFirst(mine) or [mine]
    starts = np.cumsum([0, *(len(of_one[0]) for of_one in rows)])
    points, u = (np.concatenate([of_one[k] for of_one in rows]) for k in (0, 1))
    cells = np.concatenate([of_one[2] + start for of_one, start in zip(rows, starts)])
    of_cells = {name: np.concatenate([of_one[3][name] for of_one in rows]) for name in of_cells}
    return Grid(points, list(cells), TETRAHEDRON if cells.shape[1] == 4 else QUADRATIC_TETRAHEDRON, {"displacement": u}, of_cells)


def sheet_data(solution: Any) -> Grid:
    """All sheets. Polygons have points of their own; those of one element have the values of its multiplier."""
    body, u = solution.body, solution.u
    places, cells, of_points, of_cells = [], [], [], []
    first = 0
    for crack in range(len(body.cracks)):
        trace, profile = SheetTrace(body, crack), solution.Profile(crack)
        sheet = body.cracks[crack]
        inside = np.flatnonzero(trace.inside)
        loops = [trace.loops[k] for k in inside]
        at = trace.places[np.concatenate(loops)]
        elements = np.repeat(trace.element[inside], [len(loop) for loop in loops])
        points = mesh_points(body.mesh, elements, *reference_coordinates(body.mesh, elements, at).T)
        values = [np.reshape(f(points), (len(at), 3)) for f in (Plus(u), Minus(u), Jump(u))]
        of_points.append(dict(zip(("displacement_plus", "displacement_minus", "jump"), values)))
        rows = profile.RowsOf(trace.element[inside])
        axes = np.array([sheet.FrameAt(*p)[1:] for p in zip(rows.p_1, rows.p_2)])
        tangential = lambda name, rows=rows, axes=axes: rows[f"{name}_1"][:, None] * axes[:, 0] + rows[f"{name}_2"][:, None] * axes[:, 1]
        states = np.array([STATES[state] for state in rows.state])
        of_cells.append(
            {
                "sheet": np.full(len(rows), crack),
                "pressure": -rows.sigma_n,
                "gap": rows.gap,
                "slip": tangential("slip"),
                "traction": tangential("sigma_t"),
                "state": states,
            }
        )
        places.append(at)
        for loop in loops:
            cells.append(np.arange(first, first + len(loop)))
            first += len(loop)
    joined = lambda parts: {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return Grid(np.concatenate(places), cells, POLYGON, joined(of_points), joined(of_cells))


def front_data(body: CrackedSolid, factors: Sequence[Any]) -> Grid:
    """The fronts in short lines. K and G are linear between the nodes of the FrontFactors, and NaN where there are none."""
    given = checked_factors(body, factors)
    names = [name for name in next(iter(given.values())).columns if name not in {"front", "s", "x", "y", "z"}] if given else []
    places, cells, of_points, number_of = [], [], [], []
    for number, front in enumerate(body.fronts):
        s = along(front, given.get(number))
        cells += [np.array([len(places) + k, len(places) + k + 1]) for k in range(len(s) - 1)]
        number_of += [number] * (len(s) - 1)
        places += [front.PointAt(float(si)) for si in s]
        of_points.append({"s": s} | {name: between_nodes(front, given.get(number), name, s) for name in names})
    joined = {name: np.concatenate([part[name] for part in of_points]) for name in ("s", *names)}
    sheets = np.array([front.sheet for front in body.fronts])
    return Grid(np.array(places), cells, LINE, joined, {"front": np.array(number_of), "sheet": sheets[number_of]})


def check_factors(factors: Any, name: str) -> None:
    """Raises TypeError for what are no FrontFactors."""
    if not all(hasattr(factors, member) for member in ("body", "front", "columns")):
        raise TypeError(f"{name}={repr(factors).partition(chr(10))[0]} is not what StressIntensity(front) of a solution in space gives")


def checked_factors(body: CrackedSolid, factors: Sequence[Any]) -> dict[int, Any]:
    """FrontFactors by their fronts; raises TypeError for what is no list of them, ValueError for those of another body, and for two of the same front."""
    check_type(factors, list | tuple, "factors", "a list of FrontFactors; give [solution.StressIntensity(front)]")
    given: dict[int, Any] = {}
    for found in factors:
        check_factors(found, "factors: an entry")
        if found.body is not body:
            raise ValueError("factors: these are FrontFactors of another body; give those of this solution's StressIntensity(front)")
        if found.front in given:
            raise ValueError(f"factors: there are two of front {found.front}; give one for each front")
        given[found.front] = found
    return given


def along(front: Any, factors: Any) -> np.ndarray:
    """Arc lengths of points of a front: its ends and corners, the nodes of its FrontFactors, and others between them, fewer than 6 degrees apart on a circle."""
    fixed = np.unique(np.concatenate([[0, front.length], front.corners, [] if factors is None else factors.s]))
    return np.unique(np.concatenate([fixed, np.linspace(0, front.length, 65)]))


def between_nodes(front: Any, factors: Any, name: str, s: np.ndarray) -> np.ndarray:
    """Values of a column of FrontFactors at arc lengths (n,), linear between nodes; NaN beyond them."""
    if factors is None:
        return np.full(len(s), np.nan)
    values = factors.columns[name]
    if front.closed:
        return np.interp(s, factors.s, values, period=front.length)
    return np.interp(s, factors.s, values, left=np.nan, right=np.nan)


def vtu_writer(grid: Grid) -> Callable[[Path], Any]:
    """Of a grid."""
    points, cells = grid.points, grid.cells
    root = Element("VTKFile", type="UnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt32")
    piece = SubElement(SubElement(root, "UnstructuredGrid"), "Piece", NumberOfPoints=str(len(points)), NumberOfCells=str(len(cells)))
    parts: list[tuple[str, dict[str, np.ndarray]]] = [("PointData", grid.of_points), ("CellData", grid.of_cells), ("Points", {"points": points})]
    connectivity = {
        "connectivity": np.concatenate(cells),
        "offsets": np.cumsum([len(cell) for cell in cells]),
        "types": np.full(len(cells), grid.kind, np.uint8),
    }
    for title, arrays in [*parts, ("Cells", connectivity)]:
        part = SubElement(piece, title)
        for name, array in arrays.items():
            part.append(data_array(name, array))
    return lambda temporary: ElementTree(root).write(temporary)


def data_array(name: str, array: np.ndarray) -> Element:
    """Its bytes in base64, their number before them."""
    array = np.ascontiguousarray(array, dtype={"f": "<f8", "i": "<i4", "u": "u1"}[array.dtype.kind])
    kind = {"f": "Float64", "i": "Int32", "u": "UInt8"}[array.dtype.kind]
    element = Element("DataArray", type=kind, Name=name, NumberOfComponents=str(array.shape[1] if array.ndim > 1 else 1), format="binary")
    element.text = base64.b64encode(np.array(array.nbytes, "<u4").tobytes() + array.tobytes()).decode()
    return element
