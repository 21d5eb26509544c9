"""What one process holds of a body that several share.

Each has a mesh of its own: its own elements, which together are the body, and those beside cracks and beside ∂Ω, which all processes hold. So what is decided
at cracks and on the boundary is decided by the same code on the same elements everywhere, and nobody has to be asked. Integrals over the body are sums over
own elements.
"""

from __future__ import annotations

import sys
import traceback
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, H1, VOL, BitArray, ElementId, Mesh

from . import _ngsxfem_contact as core
from .curved_mesh import Curves
from .points import element_regions, element_vertices
from .processes import Processes

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ngsolve.comp import SumOfIntegrals


AROUND = 4  # elements: how far from a front all hold them, which tubes for K may reach
SAMPLES = 400  # points of a curve that bounds a sheet
BESIDE = 1e-3  # of an element: so near to a point are all that meet there, beyond the tolerance of NGSolve's search


def nothing(kind: type) -> Any:
    """An empty array in a dataclass."""
    return field(default_factory=lambda: np.zeros(0, dtype=kind))


@dataclass
class Share(Processes):
    """The share of one process; that of a single one is the whole body, and all methods are identities.

    Attributes
    ----------
    mesh
        Of this process, serial.
    source
        The mesh that it was made of, which processes share.
    own
        (ne,), whether an element is its own.
    own_boundary
        The same of boundary elements, which belong to who has the first element beside them.
    everywhere
        (ne,), whether all processes hold an element.
    vertices, elements
        (nv,), (ne,): numbers on which all agree; those of vertices increase.
    interface
        (nv,), whether own elements of several processes meet at a vertex.
    """

    mesh: Any = None
    source: Any = None
    own: np.ndarray = nothing(bool)
    own_boundary: np.ndarray = nothing(bool)
    everywhere: np.ndarray = nothing(bool)
    vertices: np.ndarray = nothing(int)
    elements: np.ndarray = nothing(int)
    interface: np.ndarray = nothing(bool)

    def Own(self, form: SumOfIntegrals) -> SumOfIntegrals:
        """The integrals of a form over own elements."""
        return core.IntegralsOn(form, *self._bits) if self.several else form

    def IsOwn(self, elements: np.ndarray) -> np.ndarray:
        """Whether elements with these numbers are own."""
        return self.own[elements] if self.several else np.ones(len(elements), dtype=bool)

    def OwnOf(self, elements: BitArray | None) -> BitArray | None:
        """Those of some elements (None: all) that are own."""
        if not self.several:
            return elements
        own, _ = self._bits
        return own if elements is None else own & elements

    def Has(self, points: Any) -> np.ndarray:
        """(n,): whether points (n, dimension) are this process's, the first one's that has an own element there. Raises ValueError for a point outside of the body."""
        of_all = np.array(self.Gather([self._claim(np.array(point, dtype=float)) for point in points]))
        if not of_all.any(axis=0).all():
            where = ", ".join(f"{coordinate:g}" for coordinate in points[int(np.argmin(of_all.any(axis=0)))])
            raise ValueError(f"({where}) lies outside of the body; give a point in the mesh's coordinates")
        return np.argmax(of_all, axis=0) == self.rank

    def _claim(self, point: np.ndarray) -> int:
        """2 where NGSolve finds a point in an own element, 1 where one touches it: of the elements that meet there it finds any."""
        if not self.mesh.Contains(*point):
            return 0
        found = self.mesh(*point).nr
        if self.IsOwn(np.array([found]))[0]:
            return 2
        corners = np.array([self.mesh[vertex].point for vertex in self.mesh[ElementId(VOL, found)].vertices])
        near = point + BESIDE * np.ptp(corners, axis=0).max() * directions(self.mesh.dim)
        return int(any(self.mesh.Contains(*other) and self.own[self.mesh(*other).nr] for other in near))

    def AtPoints(self, points: Any, values: Callable[[Any], np.ndarray]) -> np.ndarray:
        """(n, ...): what values(mesh points) gives at points (n, dimension), each asked where it is."""
        mine, points = self.Has(points), np.asarray(points, dtype=float)
        here = values(self.mesh(*points[mine].T)) if mine.any() else None
        shape = next(value.shape[1:] for value in self.Gather(here) if value is not None)
        of_all = np.zeros((len(points), *shape))
        of_all[mine] = 0 if here is None else here
        return self.Sum(of_all)

    @cached_property
    def _bits(self) -> tuple[BitArray, BitArray]:
        return BitArray(self.own.tolist()), BitArray(self.own_boundary.tolist())


def directions(dimension: int) -> np.ndarray:
    """(n, dimension): unit vectors all around."""
    if dimension == 2:
        return np.array([(np.cos(t), np.sin(t)) for t in np.linspace(0, 2 * np.pi, 36)])
    number = np.arange(300) + 0.5  # a spiral on the sphere: equal areas, turns by the golden angle
    height, turn = 1 - number / 150, np.pi * (1 + 5**0.5) * number
    return np.column_stack([np.sqrt(1 - height**2) * np.cos(turn), np.sqrt(1 - height**2) * np.sin(turn), height])


def share_of(mesh: Mesh, cracks: Sequence[core.Crack | core.Sheet]) -> Share:
    """The Share of this process in a mesh with cracks, or sheets. Raises NotImplementedError as `Processes.Of` and `Curves.Of` do."""
    processes = Processes.Of(mesh, "CrackedMesh")
    if not processes.several:
        return Share(mesh=mesh, source=mesh, vertices=np.arange(mesh.nv))
    abort_on_error(processes.comm)
    part = Part(mesh, processes)
    return shared(part, processes, strip(part, processes, cracks))


def share_in(body: core.CrackedMesh | core.CrackedSolid) -> Share:
    """That of a body."""
    return body.share if hasattr(body, "share") else share_of(body.mesh, body.cracks)


def abort_on_error(comm: Any) -> None:
    """What one process raises and nobody catches ends all of them: the others would wait for it for ever."""

    def hook(kind: Any, error: Any, trace: Any) -> None:
        sys.stderr.write(f"process {comm.rank}:\n{''.join(traceback.format_exception(kind, error, trace))}")
        sys.stderr.flush()
        comm.Abort(1)

    sys.excepthook = hook


class Part:
    """The elements of a process in an NGSolve mesh that is distributed.

    Attributes
    ----------
    corners, facets
        (ne, dimension + 1), (n, dimension): vertices of elements and boundary elements, in numbers on which all agree.
    regions, boundaries
        Their regions.
    curves
        The Curves of the mesh.
    """

    def __init__(self, mesh: Mesh, processes: Processes) -> None:
        parallel = H1(mesh, order=1).ParallelDofs()
        refined = processes.Max(mesh.levels) > 1  # the vertices of other meshes keep the numbers of the mesh that was distributed
        self.mesh, self.dimension = mesh, mesh.dim
        ids = np.array(list(parallel.EnumerateGlobally()[0]) if refined else core.NumbersOfVertices(mesh), dtype=int)
        self.points = dict(zip(ids.tolist(), mesh.ngmesh.Coordinates()[: mesh.nv, : mesh.dim].tolist() if mesh.nv else []))
        facets = list(mesh.Elements(BND))
        self.corners, self.regions = ids[element_vertices(mesh).reshape(-1, mesh.dim + 1)], element_regions(mesh)
        self.boundaries = np.array([facet.index for facet in facets], dtype=int)
        self.facets = ids[np.array([[vertex.nr for vertex in facet.vertices] for facet in facets], dtype=int).reshape(-1, mesh.dim)]
        others = [np.array(list(parallel.Proc2Dof(other)), dtype=int) for other in parallel.ExchangeProcs()]
        self.interface = np.unique(ids[np.concatenate([np.zeros(0, dtype=int), *others])])
        self.first = sum(processes.Gather(mesh.ne)[: processes.comm.rank])
        self.curves = Curves.Of(mesh, processes)

    def PointsOf(self, vertices: np.ndarray) -> np.ndarray:
        """(..., dimension)."""
        return np.array([self.points[vertex] for vertex in vertices.ravel().tolist()]).reshape(*vertices.shape, self.dimension)

    def Sizes(self) -> np.ndarray:
        """The longest edges."""
        corners = self.PointsOf(self.corners)
        return np.max([np.linalg.norm(corners[:, i] - corners[:, j], axis=1) for i, j in combinations(range(self.dimension + 1), 2)], axis=0)


def facets_of(corners: np.ndarray) -> np.ndarray:
    """(n k,), of simplices with corners (n, k): names of the facets opposite to each corner."""
    n, k = corners.shape
    return names_of(np.stack([np.delete(corners, i, axis=1) for i in range(k)], axis=1).reshape(n * k, k - 1))


def names_of(facets: np.ndarray) -> np.ndarray:
    """(n,): a name for each of facets (n, k), whatever the order of its vertices; names have an order."""
    ordered = np.ascontiguousarray(np.sort(facets, axis=1).astype(">i8"))
    return ordered.view(f"V{8 * facets.shape[1]}").ravel()


def strip(part: Part, processes: Processes, cracks: Sequence[core.Crack | core.Sheet]) -> np.ndarray:
    """Which elements all processes shall hold.

    Those that cracks may meet and their neighbours, so that all around a node of these is there and cracks may end a little farther; those around fronts; those
    beside ∂Ω and interfaces; and the smallest one, by which tolerances go.
    """
    beside, around = (np.zeros(len(part.corners), dtype=bool) for _ in range(2))
    for crack in cracks:
        beside[list(core.ElementsBeside(part.mesh, crack) if len(beside) else ())] = True
        if isinstance(crack, core.Sheet):
            around |= around_fronts(part, processes, crack, beside)
    for _ in range(2):
        vertices = np.unique(np.concatenate(processes.Gather(np.unique(part.corners[beside]))))
        beside = np.isin(part.corners, vertices).any(axis=1)
    facets = np.concatenate(processes.Gather(names_of(part.facets)))
    sizes = part.Sizes()
    smallest = -processes.Max(-sizes.min(initial=np.inf))
    return beside | around | np.isin(facets_of(part.corners), facets).reshape(part.corners.shape).any(axis=1) | (sizes == smallest)


def around_fronts(part: Part, processes: Processes, sheet: core.Sheet, beside: np.ndarray) -> np.ndarray:
    """The elements that come nearer to the curves around a sheet than AROUND of the largest elements `beside` that hold these; distances and sizes are bounded."""
    curves = np.array([sheet.PointAt(*loop.PointAt(s)) for loop in sheet.loops for s in np.linspace(0, loop.length, SAMPLES)])
    sizes, centres = part.Sizes(), part.PointsOf(part.corners).mean(axis=1).reshape(-1, 3)
    distance = scipy.spatial.cKDTree(curves).query(centres)[0] - max(loop.length for loop in sheet.loops) / SAMPLES
    largest = processes.Max(sizes[beside & (distance < sizes)].max(initial=0))
    return np.asarray(distance < AROUND * largest + sizes)


def shared(part: Part, processes: Processes, everywhere: np.ndarray) -> Share:
    """The Share of this process: its own elements, and those of the others that all hold."""
    mine = np.flatnonzero(everywhere)
    held = np.unique(part.corners[mine])
    of_all = processes.Gather(
        (part.corners[mine], part.regions[mine], part.first + mine, held, part.PointsOf(held), part.facets, part.boundaries, part.curves.parameters)
    )
    others = [rows for rank, rows in enumerate(of_all) if rank != processes.comm.rank]
    stack = lambda own, column, rows=of_all: np.concatenate([own, *(row[column] for row in rows)])
    corners, regions, elements = (
        stack(own, column, others) for column, own in enumerate((part.corners, part.regions, part.first + np.arange(len(part.corners))))
    )
    own = np.arange(len(corners)) < len(part.corners)
    all_over = np.concatenate([everywhere, np.ones(len(corners) - len(everywhere), dtype=bool)])
    order = np.lexsort((elements, ~all_over))  # those that all hold come first, in one order
    corners, regions, elements, own, all_over = (column[order] for column in (corners, regions, elements, own, all_over))
    points = part.points | {vertex: point for rows in of_all for vertex, point in zip(rows[3].tolist(), rows[4].tolist())}
    vertices = np.unique(corners)
    numbers, first = np.unique(names_of(np.concatenate([rows[5] for rows in of_all])), return_index=True)
    facets, boundaries, parameters = (np.concatenate([rows[column] for rows in of_all])[first] for column in (5, 6, 7))
    names = [max(processes.Gather(list(names)), key=len) for names in (part.mesh.GetMaterials(), part.mesh.GetBoundaries())]
    place_of = lambda numbers: np.searchsorted(vertices, numbers).astype(int)
    at = np.array([points[vertex] for vertex in vertices.tolist()])
    if part.curves.order > 1:
        mesh = part.curves.Mesh(at, place_of(corners), regions, place_of(facets), parameters)
    else:
        mesh = serial_mesh(at, place_of(corners), regions, place_of(facets), boundaries, *names)
    beside, of_facet = elements.repeat(corners.shape[1]), facets_of(corners)
    place = np.minimum(np.searchsorted(numbers, of_facet), len(numbers) - 1)
    on_it = numbers[place] == of_facet
    owner = np.full(len(numbers), elements.max() + 1)
    np.minimum.at(owner, place[on_it], beside[on_it])
    return Share(processes.comm, mesh, part.mesh, own, np.isin(owner, elements[own]), all_over, vertices, elements, np.isin(vertices, part.interface))


def serial_mesh(points: np.ndarray, corners: np.ndarray, regions: np.ndarray, facets: np.ndarray, boundaries: np.ndarray, materials: Any, names: Any) -> Mesh:
    """A Mesh of triangles or tetrahedra (n, d + 1) and boundary elements (m, d) between points (k, d), with their regions and the names of these."""
    d = points.shape[1]
    mesh = NetgenMesh(dim=d)
    mesh.AddPoints(np.column_stack([points, np.zeros((len(points), 3 - d))]))
    for dim, simplices, of_simplex, of_dim in ((d, corners, regions, materials), (d - 1, facets, boundaries, names)):
        numbers = [mesh.AddRegion(name, dim=dim) for name in of_dim]
        starts = np.flatnonzero(np.diff(of_simplex, prepend=-1))  # of rows in one region
        for start, rows in zip(starts, np.split(simplices, starts[1:])):
            mesh.AddElements(dim, numbers[of_simplex[start]], np.ascontiguousarray(rows, dtype=np.int32))
    return Mesh(mesh)
