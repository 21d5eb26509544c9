"""Solutions that several processes share as files have them, whole and of one process, and files as several processes have them.

A solution is pickled by one process. What belongs to the mesh is left out and put in again from the other mesh: the mesh itself, the body, supports, and all arrays over
unknowns, which go by keys (`spaces.keys`). Vertices keep their order, so that functions of edges and triangles keep their orientation, and coefficients are carried unchanged.
"""

from __future__ import annotations

import io
import pickle
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import BND, VERTEX, VOL, BitArray, FESpace, GridFunction, Mesh, NodeId, comp

from .. import _ngsxfem_contact as core
from ..algebra.matrices import mask
from ..errors import NotSaved
from ..files import UnreadableFile
from ..geometry import CrackedMesh
from ..loads.changes import is_unchanged
from ..loads.load import LoadForm
from ..loads.reactions import Holder, SupportResidual
from ..loads.supports import HeldSide, Supports
from ..pickling import Unnumbered
from ..processes import DistributedMesh, Processes, alone, world
from ..spaces.exchange import exchange_of
from ..spaces.keys import Keyed, places, unknown_keys
from ..spaces.trace_space import redundant_functions
from ..whole_mesh import whole_mesh
from .load_case import SolvedCase
from .saved import load, save

if TYPE_CHECKING:
    from .solution import ContactSolution

SAME_ENERGY = 1e-9  # relative


def save_whole(solution: ContactSolution, path: str | Path) -> Path:
    """See ContactSolution.Save: all processes gather the solution, the first one writes it."""
    share, whole = solution.problem.V.share, gathered(solution)

    def first() -> None:
        if whole is not None:
            with alone():
                save(whole, path)

    share.Together(first)
    return Path(path)


def load_shared(path: str | Path) -> ContactSolution:
    """See ContactSolution.Load: the first process reads and checks the whole, which is distributed then."""
    processes = Processes(world())

    def first() -> ContactSolution | None:
        with alone():
            return load(path) if processes.is_first else None

    return distributed(processes.Together(first), processes)


def gathered(solution: ContactSolution) -> ContactSolution | None:
    """A solution that several processes share as one of a single process, on the first of them; None on others. Raises NotSaved, on all, for what has no keys."""
    solution.u  # recovered and checked by all
    share = solution.problem.V.share
    if not share.several:
        return solution
    share.Refuse("Save of a body in space", solution.body.mesh.dim != 2)
    carried, stream = taken(solution, share.vertices)
    mesh, vertices = whole_mesh(share)
    energy, same_load = solution.Energy(), is_unchanged(solution.load, solution.case.F, solution.problem.V)

    def first() -> ContactSolution | None:
        if mesh is None:
            return None
        with alone():
            whole = carried.Read(stream, vertices, CrackedMesh(mesh, *solution.body.cracks))
            carried.AddLoads()
            if same_load:
                whole.CheckLoad()
            check_energy(whole, energy, NotSaved, "Save")
        return whole

    return share.Together(first)


def distributed(solution: ContactSolution | None, processes: Processes) -> ContactSolution:
    """A solution of one process, that of the first, None on others, as one that several share."""
    if not processes.several:
        assert solution is not None
        return solution

    def first() -> tuple[Carried, bytes, list[core.Crack], int, float] | None:
        if solution is None:
            return None
        check_distributable(solution)
        mesh = solution.body.mesh
        return *taken(solution, np.arange(mesh.nv)), list(solution.body.cracks), mesh.GetCurveOrder(), solution.Energy()

    carried, stream, cracks, order, energy = processes.FromFirst(processes.Together(first))  # type: ignore[misc]
    mesh = DistributedMesh(lambda: solution.body.mesh.ngmesh.Copy(), processes.comm)  # type: ignore[union-attr]
    if order > 1:
        mesh.Curve(order)
    body = CrackedMesh(mesh, *cracks)
    read = processes.Together(lambda: carried.Read(stream, body.share.vertices, body))
    carried.AddLoads()
    F = read.case.F
    F[:] = exchange_of(read.problem.V).Additive(F)
    check_energy(read, energy, UnreadableFile, "Load")
    return read


def check_energy(solution: ContactSolution, energy: float, kind: type[Exception], what: str) -> None:
    """Raises an exception of a kind unless the energy of a solution is the one that it had on the other mesh."""
    if not abs(solution.Energy() - energy) <= SAME_ENERGY * abs(energy):
        raise kind(f"{what}: the energy is {solution.Energy():.15g} on the other mesh, and was {energy:.15g}; please report it with the problem")


def taken(solution: ContactSolution, vertices: np.ndarray) -> tuple[Carried, bytes]:
    """What belongs to the mesh, on the first process, and the pickle of all else; vertices: (nv,) numbers on which all agree, which increase."""
    share, supports, found = solution.problem.V.share, solution.problem.supports, solution._found[1]
    stream, functions, terms = share.Together(lambda: written(solution))
    names = [f"{type(function.space).__name__} {function.name}" for function in functions]
    if any(names != others for others in share.Gather(names)):
        raise NotSaved("Save: processes have different functions in the solution; make the same problem on all")
    keys, of_functions = unknown_keys(solution.problem.V, vertices), share.Together(lambda: [keys_and_values(function, vertices) for function in functions])
    at_first = lambda keyed, add=False: Keyed.Of(rows, add) if (rows := share.AtFirst(keyed)) else keyed
    pins = [(int(vertices[vertex]), k, value) for vertex, k, value in supports.pins.values()]
    chosen = {
        number: names_of_elements(term.body.mesh, vertices, term.on_boundary)[mask(term.elements)]
        for number, term in enumerate(terms)
        if term.elements is not None
    }
    all_chosen = share.Gather(chosen)
    carried = Carried(
        [at_first(one) if isinstance(one, Keyed) else one for one in of_functions],
        {number: np.concatenate([of_one[number] for of_one in all_chosen]) for number in chosen},
        at_first(Keyed(keys, solution.case.F), True),
        at_first(Keyed(keys, found.exerted)),
        at_first(Keyed(keys, found.springs)),
        rows_of(supports, vertices),
        {place: (keys[side.dofs], side) for place, side in supports.sides.items()},  # all processes have the whole boundary
        [pin for of_one in share.Gather(pins) for pin in of_one],
        supports.points,
        [max(of_one, key=lambda known: len(known[0])) for of_one in zip(*share.Gather([(keys[holder.dofs], holder) for holder in found.holders]))],
    )  # of each holder what one knows who has unknowns of it: a pin is at some processes only
    return carried, stream


def check_distributable(solution: ContactSolution) -> None:
    """Raises NotImplementedError for bodies in space, and for multipliers that are numbered by edges."""
    W = solution.problem.W
    if solution.body.mesh.dim != 2:
        raise NotImplementedError("Load: a body in space is not supported by several processes yet: start the script without mpirun")
    if isinstance(getattr(W, "basis", None), core.MeshTraceBasis) and W.order > 1:
        raise NotImplementedError("Load: TraceSpace(basis='trace') of order 2 or more is not supported by several processes; start the script without mpirun")


def keys_and_values(function: GridFunction, vertices: np.ndarray) -> Keyed | np.ndarray:
    """Those of a GridFunction; the values alone of one on the cracks, which are in the same order everywhere. Raises NotSaved where values are at no node."""
    values = function.vec.FV().NumPy()
    if isinstance(function.space, core.TraceSpace):
        return values.copy()
    keys = unknown_keys(function.space, vertices)
    known = keys[:, 0] >= 0
    if values[~known].any():
        raise NotSaved(
            f"the GridFunction {function.name!r} has unknowns of no node of the mesh, which several processes cannot save; interpolate it by one of H1 or L2"
        )
    return Keyed(keys[known], values[known])


def names_of_elements(mesh: Mesh, vertices: np.ndarray, on_boundary: bool) -> np.ndarray:
    """(n, 2) or (n, 3): the agreed numbers of the vertices of elements, sorted."""
    return np.sort(
        np.array([[vertices[vertex.nr] for vertex in element.vertices] for element in mesh.Elements(BND if on_boundary else VOL)], dtype=int), axis=1
    )


def rows_of(supports: Supports, vertices: np.ndarray) -> np.ndarray:
    """(n, WIDTH): agreed names of the rows of BoundarySamples, which are in the order of boundary elements: ends of the element, the vertex, mouth and side."""
    samples = supports.samples
    ends = names_of_elements(samples.body.mesh, vertices, on_boundary=True)
    vertex = np.where(samples.vertex < 0, -1, vertices[samples.vertex])
    zeros = np.zeros(len(vertex), dtype=int)
    return np.column_stack([ends[samples.element], vertex, samples.mouth, samples.side, zeros, zeros])


@dataclass
class Carried:
    """What is put in again.

    Attributes
    ----------
    functions
        Keyed values of GridFunctions, in the order in which the stream has them, and values of those on the cracks.
    chosen
        Number of a term that is taken over some elements → agreed names of these.
    F, exerted, springs
        Keyed.
    rows, sides, pins, points, holders
        Of the supports: names of the rows of samples; (region, component) → (keys, HeldSide); pins with agreed numbers of vertices; points of pins; (keys, Holder).
    loads
        LoadForms with the terms that are not added yet.
    known, vertices
        On the other mesh: keys of spaces, and agreed numbers of vertices.
    """

    functions: list[Keyed | np.ndarray]
    chosen: dict[int, np.ndarray]
    F: Keyed
    exerted: Keyed
    springs: Keyed
    rows: np.ndarray
    sides: dict[tuple[int, int], tuple[np.ndarray, HeldSide]]
    pins: list[tuple[int, int, float]]
    points: list[tuple[float, ...]]
    holders: list[tuple[np.ndarray, Holder]]
    loads: list[tuple[LoadForm, list[Any]]] = field(default_factory=list)
    known: dict[int, tuple[Any, np.ndarray]] = field(default_factory=dict)
    vertices: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    def Read(self, stream: bytes, vertices: np.ndarray, body: core.CrackedMesh) -> ContactSolution:
        """The solution on the mesh of a body, whose vertices have agreed numbers; AddLoads comes next."""
        self.vertices = vertices
        left_out = {name: getattr(self, name) for name in LEFT_OUT} | {"mesh": body.mesh, "body": body}

        class Reader(pickle.Unpickler):
            def persistent_load(self, name: str) -> Any:
                return left_out[name]

        return Reader(io.BytesIO(stream)).load()

    def Keys(self, space: FESpace) -> np.ndarray:
        """Those of the unknowns of a space, kept."""
        if id(space) not in self.known:
            self.known[id(space)] = space, unknown_keys(space, self.vertices)
        return self.known[id(space)][1]

    def Function(self, space: FESpace, name: str, number: int) -> GridFunction:
        """The GridFunction of a number."""
        function, values = GridFunction(space, name), self.functions[number]
        if isinstance(values, Keyed):
            keys = self.Keys(space)
            known = keys[:, 0] >= 0
            function.vec.FV().NumPy()[known] = values.At(keys[known])
        elif len(values) != space.ndof:
            raise Unnumbered(f"there are {space.ndof} multipliers on the other mesh, {len(values)} were saved")
        else:
            function.vec.FV().NumPy()[:] = values
        return function

    def Term(self, before: tuple[Any, ...], number: int | None, after: tuple[Any, ...]) -> core.FormTerm:
        """A term of a form, taken over the elements of its number."""
        term, bits = core.FormTerm.__new__(core.FormTerm), None
        _, body, _, _, _, on_boundary, *_ = before
        if number is not None:
            names = names_of_elements(body.mesh, self.vertices, on_boundary)
            chosen = {tuple(name) for name in self.chosen[number].tolist()}
            bits = BitArray([tuple(name) in chosen for name in names.tolist()])
        term.__setstate__((*before, bits, *after))  # type: ignore[attr-defined]
        return term

    def Load(self, V: Any, terms: list[Any]) -> LoadForm:
        """A LoadForm without its terms, which AddLoads adds."""
        form = LoadForm(V)
        self.loads.append((form, terms))
        return form

    def AddLoads(self) -> None:
        """Adds the terms of loads, which all processes have to do together."""
        for form, terms in self.loads:
            form.Add(terms)

    def Case(self, V: Any, load: Any) -> SolvedCase:
        """A SolvedCase, whose F is consistent."""
        return SolvedCase(V, self.F.At(self.Keys(V)), load)

    def Residual(self, V: Any) -> SupportResidual:
        """The SupportResidual."""
        holders = []
        for keys, holder in self.holders:
            here = places(self.Keys(V), keys)
            holders.append(replace(holder, dofs=here[here >= 0], shares=holder.shares[here >= 0]))
        return SupportResidual(V, holders, Supports(V).CornerEdges(), self.exerted.At(self.Keys(V)), self.springs.At(self.Keys(V)))

    def Supports(self, V: Any) -> Supports:
        """The Supports."""
        supports = Supports(V)
        row = places(self.rows, rows_of(supports, self.vertices))
        if (row < 0).any():
            raise Unnumbered("the boundary elements of the other mesh are not those that were saved")
        supports.sides = {place: replace(side, dofs=self._dofs(V, keys), samples=side.samples[row]) for place, (keys, side) in self.sides.items()}
        number = {vertex: i for i, vertex in enumerate(self.vertices.tolist())}
        here = {(number[vertex], k): (number[vertex], k, value) for vertex, k, value in self.pins if vertex in number}
        supports.pins = {V.GetDofNrs(NodeId(VERTEX, vertex))[k]: pin for (vertex, k), pin in here.items()}
        supports.points = self.points
        supports._apply()
        return supports

    def _dofs(self, V: Any, keys: np.ndarray) -> np.ndarray:
        dofs = places(self.Keys(V), keys)
        if (dofs < 0).any():
            raise Unnumbered("the boundary holds other unknowns on the other mesh than were saved")
        return dofs

    @staticmethod
    def Traces(body: core.CrackedMesh, order: int, nodes: list[list[float]]) -> core.MeshTraceBasis:
        """Traces of functions of the other mesh."""
        return core.MeshTraceBasis(body, order, nodes, redundant_functions(body, order, nodes))


LEFT_OUT = ("Function", "Term", "Load", "Case", "Residual", "Supports", "Traces")


class LeftOut:
    """What the reader puts in by name; pickle wants it to be callable."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self) -> None:
        raise TypeError(f"{self.name} is put in by the reader")


def written(solution: ContactSolution) -> tuple[bytes, list[GridFunction], list[core.FormTerm]]:
    """(pickle, GridFunctions, terms of forms) of a solution without what belongs to its mesh. Raises NotSaved for what cannot be pickled, and for functions on other meshes."""
    names = {id(solution.body.mesh): "mesh", id(solution.body): "body"}
    functions: list[GridFunction] = []
    terms: list[core.FormTerm] = []
    by_name = {name: LeftOut(name) for name in LEFT_OUT}

    class Writer(pickle.Pickler):
        def persistent_id(self, obj: Any) -> str | None:
            if isinstance(obj, LeftOut):
                return obj.name
            if isinstance(obj, (Mesh, core.CrackedMesh)) and id(obj) not in names:
                raise pickle.PicklingError("a function belongs to another mesh than that of the body; take solution.body.mesh, or interpolate it there")
            return names.get(id(obj))

        def reducer_override(self, obj: Any) -> Any:
            if isinstance(obj, GridFunction):
                if isinstance(obj, comp.ComponentGridFunction) or obj.space.is_complex or len(obj.vecs) > 1:
                    raise pickle.PicklingError(
                        "components of GridFunctions, complex ones and those with many vectors are not saved by several processes; take a real one"
                    )
                functions.append(obj)
                return by_name["Function"], (obj.space, obj.name, len(functions) - 1)
            if isinstance(obj, core.FormTerm):
                *before, chosen, regions, fronts = obj.__getstate__()  # type: ignore[attr-defined]
                terms.append(obj)
                return by_name["Term"], (before, None if chosen is None else len(terms) - 1, (regions, fronts))
            if isinstance(obj, LoadForm):
                return by_name["Load"], obj.__reduce__()[1]
            if isinstance(obj, SolvedCase):
                return by_name["Case"], (obj.V, obj.load)
            if isinstance(obj, SupportResidual):
                return by_name["Residual"], (obj.V,)
            if isinstance(obj, Supports):
                return by_name["Supports"], (obj.V,)
            if isinstance(obj, core.MeshTraceBasis):
                return by_name["Traces"], tuple(obj.__getstate__()[:3])  # type: ignore[attr-defined]
            return NotImplemented

    buffer = io.BytesIO()
    try:
        Writer(buffer, protocol=5).dump(solution)
    except Exception as error:
        raise NotSaved(
            f"Save: the solution cannot be saved ({' '.join(str(error).split()) or type(error).__name__}); functions of Python must have a name in a module, "
            "and functions of NGSolve that it does not save can be interpolated by a GridFunction"
        ) from error
    return buffer.getvalue(), functions, terms
