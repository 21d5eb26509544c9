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
from typing import TYPE_CHECKING, Any

import numpy as np
from netgen.meshing import Element1D, Element2D, MeshPoint, Pnt
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, H1, VOL, BitArray, ElementId, Mesh

from . import _ngsxfem_contact as core
from .curved_mesh import Curves
from .processes import Processes

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ngsolve.comp import SumOfIntegrals


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
        """(n,): whether points (n, 2) are this process's, the first one's that has an own element there. Raises ValueError for a point outside of the body."""
        of_all = np.array(self.Gather([self._claim(np.array(point, dtype=float)) for point in points]))
        if not of_all.any(axis=0).all():
            x, y = points[int(np.argmin(of_all.any(axis=0)))]
            raise ValueError(f"({x:g}, {y:g}) lies outside of the body; give a point in the mesh's coordinates")
        return np.argmax(of_all, axis=0) == self.rank

    def _claim(self, point: np.ndarray) -> int:
        """2 where NGSolve finds a point in an own element, 1 where one touches it: of the elements that meet there it finds any."""
        if not self.mesh.Contains(*point):
            return 0
        found = self.mesh(*point).nr
        if self.IsOwn(np.array([found]))[0]:
            return 2
        corners = np.array([self.mesh[vertex].point for vertex in self.mesh[ElementId(VOL, found)].vertices])
        near = point + BESIDE * np.ptp(corners, axis=0).max() * np.array([(np.cos(t), np.sin(t)) for t in np.linspace(0, 2 * np.pi, 36)])
        return int(any(self.mesh.Contains(*other) and self.own[self.mesh(*other).nr] for other in near))

    def AtPoints(self, points: Any, values: Callable[[Any], np.ndarray]) -> np.ndarray:
        """(n, ...): what values(mesh points) gives at points (n, 2), each asked where it is."""
        mine, points = self.Has(points), np.asarray(points, dtype=float)
        here = values(self.mesh(*points[mine].T)) if mine.any() else None
        shape = next(value.shape[1:] for value in self.Gather(here) if value is not None)
        of_all = np.zeros((len(points), *shape))
        of_all[mine] = 0 if here is None else here
        return self.Sum(of_all)

    @cached_property
    def _bits(self) -> tuple[BitArray, BitArray]:
        return BitArray(self.own.tolist()), BitArray(self.own_boundary.tolist())


def share_of(mesh: Mesh, cracks: Sequence[core.Crack]) -> Share:
    """The Share of this process in a mesh with cracks. Raises NotImplementedError as `Processes.Of` and `Curves.Of` do."""
    processes = Processes.Of(mesh, "CrackedMesh")
    if not processes.several:
        return Share(mesh=mesh, source=mesh, vertices=np.arange(mesh.nv))
    abort_on_error(processes.comm)
    part = Part(mesh, processes)
    return shared(part, processes, strip(part, processes, cracks))


def share_in(body: core.CrackedMesh) -> Share:
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
    corners, segments
        (ne, 3), (n, 2): vertices of elements and boundary elements, in numbers on which all agree.
    regions, boundaries
        Their regions.
    curves
        The Curves of the mesh.
    """

    def __init__(self, mesh: Mesh, processes: Processes) -> None:
        parallel = H1(mesh, order=1).ParallelDofs()
        refined = processes.Max(mesh.levels) > 1  # the vertices of other meshes keep the numbers of the mesh that was distributed
        self.mesh, ids = mesh, np.array(list(parallel.EnumerateGlobally()[0]) if refined else core.NumbersOfVertices(mesh), dtype=int)
        self.points = dict(zip(ids.tolist(), mesh.ngmesh.Coordinates()[: mesh.nv, :2].tolist() if mesh.nv else []))
        table, segments = mesh.ngmesh.Elements2D().NumPy(), list(mesh.Elements(BND))
        self.corners = ids[table["nodes"][:, :3].astype(int).reshape(-1, 3) - 1]
        self.regions, self.boundaries = table["index"].astype(int) - 1, np.array([segment.index for segment in segments], dtype=int)
        self.segments = ids[np.array([[vertex.nr for vertex in segment.vertices] for segment in segments], dtype=int).reshape(-1, 2)]
        others = [np.array(list(parallel.Proc2Dof(other)), dtype=int) for other in parallel.ExchangeProcs()]
        self.interface = np.unique(ids[np.concatenate([np.zeros(0, dtype=int), *others])])
        self.first = sum(processes.Gather(mesh.ne)[: processes.comm.rank])
        self.curves = Curves.Of(mesh, processes)

    def PointsOf(self, vertices: np.ndarray) -> np.ndarray:
        """(..., 2)."""
        return np.array([self.points[vertex] for vertex in vertices.ravel().tolist()]).reshape(*vertices.shape, 2)

    def Sizes(self) -> np.ndarray:
        """The longest edges."""
        corners = self.PointsOf(self.corners)
        return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0)


def edges_of(corners: np.ndarray) -> np.ndarray:
    """(3 n,): a number for each edge of triangles (n, 3), or for each of (n, 2), whatever its direction."""
    pairs = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2) if corners.shape[1] == 3 else corners, axis=1)
    return pairs[:, 0] * (1 << 31) + pairs[:, 1]


def strip(part: Part, processes: Processes, cracks: Sequence[core.Crack]) -> np.ndarray:
    """Which elements all processes shall hold.

    Those that cracks may meet and their neighbours, so that all around a node of these is there and cracks may end a little farther; those beside ∂Ω and
    interfaces; and the smallest one, by which tolerances go.
    """
    beside = np.zeros(len(part.corners), dtype=bool)
    for crack in cracks if len(beside) else ():
        beside[core.ElementsBeside(part.mesh, crack)] = True
    for _ in range(2):
        vertices = np.unique(np.concatenate(processes.Gather(np.unique(part.corners[beside]))))
        beside = np.isin(part.corners, vertices).any(axis=1)
    segments = np.concatenate(processes.Gather(edges_of(part.segments)))
    sizes = part.Sizes()
    smallest = -processes.Max(-sizes.min(initial=np.inf))
    return beside | np.isin(edges_of(part.corners), segments).reshape(-1, 3).any(axis=1) | (sizes == smallest)


def shared(part: Part, processes: Processes, everywhere: np.ndarray) -> Share:
    """The Share of this process: its own elements, and those of the others that all hold."""
    mine = np.flatnonzero(everywhere)
    held = np.unique(part.corners[mine])
    of_all = processes.Gather(
        (part.corners[mine], part.regions[mine], part.first + mine, held, part.PointsOf(held), part.segments, part.boundaries, part.curves.parameters)
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
    numbers, first = np.unique(edges_of(np.concatenate([rows[5] for rows in of_all])), return_index=True)
    segments, boundaries, parameters = (np.concatenate([rows[column] for rows in of_all])[first] for column in (5, 6, 7))
    names = [max(processes.Gather(list(names)), key=len) for names in (part.mesh.GetMaterials(), part.mesh.GetBoundaries())]
    place_of = lambda numbers: np.searchsorted(vertices, numbers).astype(int)
    at = np.array([points[vertex] for vertex in vertices.tolist()])
    if part.curves.order > 1:
        mesh = part.curves.Mesh(at, place_of(corners), regions, place_of(segments), parameters)
    else:
        mesh = serial_mesh(at, place_of(corners), regions, place_of(segments), boundaries, *names)
    beside, of_edge = elements.repeat(3), edges_of(corners)
    place = np.minimum(np.searchsorted(numbers, of_edge), len(numbers) - 1)
    on_it = numbers[place] == of_edge
    owner = np.full(len(numbers), elements.max() + 1)
    np.minimum.at(owner, place[on_it], beside[on_it])
    return Share(processes.comm, mesh, part.mesh, own, np.isin(owner, elements[own]), all_over, vertices, elements, np.isin(vertices, part.interface))


def serial_mesh(points: np.ndarray, corners: np.ndarray, regions: np.ndarray, segments: np.ndarray, boundaries: np.ndarray, materials: Any, names: Any) -> Mesh:
    """A Mesh of triangles (n, 3) and boundary elements (m, 2) between points, with their regions and the names of these."""
    mesh = NetgenMesh(dim=2)
    numbers = [mesh.Add(MeshPoint(Pnt(x, y, 0))) for x, y in points.tolist()]
    domains, edges = ([mesh.AddRegion(name, dim=dim) for name in of_dim] for dim, of_dim in ((2, materials), (1, names)))
    for triangle, region in zip(corners.tolist(), regions.tolist()):
        mesh.Add(Element2D(domains[region], [numbers[vertex] for vertex in triangle]))
    for segment, region in zip(segments.tolist(), boundaries.tolist()):
        mesh.Add(Element1D([numbers[vertex] for vertex in segment], index=edges[region]))
    return Mesh(mesh)
