"""What holds a body: displacements given on parts of its boundary, and pinned vertices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from ngsolve import VERTEX, BitArray, CoefficientFunction, GridFunction, LinearForm, NodeId, Parameter

from ..arguments import check_function, check_regions, check_type
from ..pickling import dofs_of, numbers_of
from ..share import share_in
from ..spaces.unknowns import Unknowns
from .boundary_samples import boundary_samples
from .mouths import PROJECTION_BONUS, boundary_mass, mouth_weight, short_traces
from .reactions import Holder, corner_edge

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .._ngsxfem_contact import CrackFESpace
    from .reactions import CornerEdge

AXES = "xyz"
TOLERANCE = 1e-5  # of the largest given displacement: what differs by less at one point is the same
DEPENDENT = 1e-12  # of the mass of a trace: what is left of it beside the others is round-off
ROUND_OFF = 1e-12  # of the largest moment of a value


@dataclass
class HeldSide:
    """One component of u on one boundary region.

    Parameters
    ----------
    dofs, values
        Unknowns that are fixed, and their values.
    samples
        The given function at the rows of BoundarySamples.
    explicit
        Given by SetDirichlet; else it is zero because the space declares it.
    """

    dofs: np.ndarray
    values: np.ndarray
    samples: np.ndarray
    explicit: bool


class GivenDisplacement:
    """A value of SetDirichlet as it was written, its region, and its moments with the functions of V."""

    def __init__(self, value: Any, region: str, form: LinearForm) -> None:
        self.value, self.region, self._form = value, region, form
        self.moments = self._Moments()
        if not np.isfinite(self.moments).all():
            raise ValueError(f"SetDirichlet: the value is not finite (NaN or inf) somewhere on {region!r}")

    def _Moments(self) -> np.ndarray:
        return self._form.Assemble().vec.FV().NumPy().copy()

    def HasChanged(self) -> bool:
        """Whether the value has other moments now."""
        return bool(np.abs(self._Moments() - self.moments).max(initial=0) > ROUND_OFF * np.abs(self.moments).max(initial=0))


class Supports:
    """What holds a body, and where: the data behind ContactProblem.Pin and SetDirichlet.

    Attributes
    ----------
    given
        GridFunction, the displacement where it is fixed.
    free
        BitArray of the unknowns that are not.
    sides
        (region, component) → HeldSide.
    pins
        Unknown → (vertex, component, value).
    functions
        What SetDirichlet was given, GivenDisplacements in its order; a file does not hold it.
    points
        Of pins, those that other processes hold among them.
    """

    def __init__(self, V: CrackFESpace) -> None:
        self.V, self.given, self.free = V, GridFunction(V), BitArray(V.FreeDofs())
        self.samples, self.dimension = boundary_samples(V.body), V.mesh.dim
        self._declared = {
            (region, k): HeldSide(dofs[k], np.zeros(len(dofs[k])), self.samples.Zero(region), explicit=False)
            for region, dofs in enumerate(V.BoundaryDofs())
            for k in range(self.dimension)
            if V.HeldRegions(k)[region]
        }
        self.sides, self.pins, self.points = dict(self._declared), {}, []
        self.functions: list[GivenDisplacement] = []

    def __reduce__(self) -> Any:
        numbers = numbers_of(self.V, *(side.dofs for side in self.sides.values()))
        sides = {key: replace(side, dofs=own) for (key, side), own in zip(self.sides.items(), numbers)}
        return supports_of, (self.V, sides, list(self.pins.values()))

    @property
    def pinned(self) -> list[int]:
        """The unknowns that pins fix, in their order."""
        return list(self.pins)

    def Pin(self, point: Sequence[float], components: str, value: Any = 0) -> None:
        """See ContactProblem.Pin."""
        named = component_numbers(self.dimension)
        if components not in named:
            raise ValueError(f"Pin: components={components!r} is not one of {sorted(named)}")
        vertex, at = self._vertex_at(point)
        self.V.share.Together(lambda: self._pin(point, vertex, components, value) if vertex >= 0 else None)
        self.points.append(at)

    def _pin(self, point: Sequence[float], vertex: int, components: str, value: Any) -> None:
        if len(self.V.GetDofNrs(NodeId(VERTEX, vertex))) > self.dimension:
            raise ValueError(f"Pin: u may jump at the vertex {tuple(point)}, beside the crack; pin a vertex away from it")
        check_outside_of_disks(self.V, self.V.mesh[NodeId(VERTEX, vertex)].point)
        self.PinVertex(vertex, dict(zip(component_numbers(self.dimension)[components], pin_values(value, components))))

    def PinVertex(self, vertex: int, values: dict[int, float]) -> None:
        """Fixes components of u at a vertex, given by its number, at which u does not jump."""
        dofs = self.V.GetDofNrs(NodeId(VERTEX, vertex))
        pins = {dofs[k]: (vertex, k, float(number)) for k, number in values.items()}
        for dof, pin in pins.items():
            if dof in self.pins and self.pins[dof][2] != pin[2]:
                raise ValueError(f"Pin: u_{AXES[pin[1]]} is given twice at {place(self.V, vertex)}: {self.pins[dof][2]:g}, and now {pin[2]:g}; pin it once")
        self._check_pins(pins, self._explicit())
        self.pins |= pins
        self._apply()

    def _vertex_at(self, point: Sequence[float]) -> tuple[int, tuple[float, ...]]:
        """Its number, -1 of one that other processes hold, and where it is."""
        if np.shape(point) != (self.dimension,) or not all(isinstance(coordinate, Real) for coordinate in point):
            where, form = ("the plane", "(x, y)") if self.dimension == 2 else ("space", "(x, y, z)")
            raise ValueError(f"Pin: {point!r} is not a point of {where}; give {form}")
        vertices = self.V.mesh.ngmesh.Coordinates()[: self.V.mesh.nv, : self.dimension]
        distance = np.linalg.norm(vertices - np.asarray(point, dtype=float), axis=1)
        nearest = int(np.argmin(distance))
        _, size, best = min(self.V.share.Gather((float(distance[nearest]), float(np.ptp(vertices, axis=0).max()), tuple(vertices[nearest].tolist()))))
        if any(tuple(other) != tuple(point) for other in self.V.share.Gather(tuple(point))):
            raise ValueError(f"Pin: processes pin different points, this one {tuple(point)}; pin the same on all")
        if not np.linalg.norm(np.subtract(best, point)) <= 1e-8 * size:
            raise ValueError(f"Pin: there is no mesh vertex at {tuple(point)}; the nearest is {best}")
        return nearest if tuple(vertices[nearest].tolist()) == best else -1, best

    def SetDirichlet(self, value: Any, region: Any) -> None:
        """See ContactProblem.SetDirichlet."""
        share_in(self.V.body).Together(lambda: self._set_dirichlet(value, region))

    def _set_dirichlet(self, value: Any, region: Any) -> None:
        check_type(region, str, "SetDirichlet: region", "the name of a boundary, or a regular expression")
        check_regions(self.V.mesh, region, "SetDirichlet: region")
        given = value
        value, components = given_components(value, self.dimension)
        regions = np.flatnonzero(list(self.V.mesh.Boundaries(region).Mask())).tolist()
        self._check_declared(region, regions, components)
        weight = mouth_weight(self.V.body)
        function = GivenDisplacement(given, region, moments_form(self.V, value, region, weight))
        values, short = projected_trace(self.V, function.moments, region, weight)
        sides = {}
        for number in regions:
            samples = self.samples.Values(value, number)
            for k in components:
                declared = self._declared[number, k].dofs
                dofs = np.setdiff1d(declared, short) if np.nanmax(np.abs(samples[:, k]), initial=0) > 0 else declared  # zero is what the space holds
                sides[number, k] = HeldSide(dofs, values[dofs], samples[:, k], explicit=True)
        self._check_pins(self.pins, sides)
        kept = {key: side for key, side in self.sides.items() if key[0] not in regions}
        self.sides = kept | sides  # where regions meet the last one counts
        self.functions = [other for other in self.functions if other.region != region] + [function]
        self._apply()

    def Update(self) -> None:
        """Projects again what SetDirichlet was given where its coefficients, a Parameter or a GridFunction, have changed since."""
        if share_in(self.V.body).Max(any(function.HasChanged() for function in self.functions)):
            for function in tuple(self.functions):
                self.SetDirichlet(function.value, function.region)

    def _check_declared(self, region: str, regions: list[int], components: Any) -> None:
        for k in components:
            if any((number, k) not in self._declared for number in regions):
                raise ValueError(
                    f"SetDirichlet: u_{AXES[k]} on {region!r} is not part of CrackFESpace(..., dirichlet=...) or of dirichlet{AXES[k]}=; "
                    "declare it there, or give None for this component to leave it free"
                )

    def _apply(self) -> None:
        """free and given, of what is held now."""
        given = self.given.vec.FV().NumPy()
        given[:] = 0
        self.free.Set()
        for side in self.sides.values():
            given[side.dofs] = side.values
            for dof in side.dofs:
                self.free.Clear(int(dof))
        for dof, (_, _, value) in self.pins.items():
            given[dof] = value
            self.free.Clear(dof)

    def _explicit(self) -> dict[tuple[int, int], HeldSide]:
        return {key: side for key, side in self.sides.items() if side.explicit}

    def Check(self) -> None:
        """Raises ValueError where two of the given displacements contradict each other."""
        self._check_pins(self.pins, self.sides)
        for rows in self.samples.Corners():
            for k in range(self.dimension):
                here = [(row, self.sides[self.samples.region[row], k]) for row in rows if (self.samples.region[row], k) in self.sides]
                for (row, side), (other_row, other) in zip(here, here[1:]):
                    self._check_corner(k, (row, other_row), (side, other))

    def _check_corner(self, k: int, rows: tuple[int, int], sides: tuple[HeldSide, HeldSide]) -> None:
        names = [self.V.mesh.GetBoundaries()[self.samples.region[row]] for row in rows]
        values = [side.samples[row] for row, side in zip(rows, sides)]
        if names[0] != names[1] and differ(*values, *(largest(side) for side in sides)):
            origin = [
                f"{value:g} on {name!r}{'' if side.explicit else ' (zero where SetDirichlet gives nothing)'}" for value, name, side in zip(values, names, sides)
            ]
            raise ValueError(
                f"the given displacements contradict each other at {place(self.V, self.samples.vertex[rows[0]])}: u_{AXES[k]} = {' and '.join(origin)}; "
                "give both the same value there, or leave this component free on one of them"
            )

    def _check_pins(self, pins: dict[int, tuple[int, int, float]], sides: dict[tuple[int, int], HeldSide]) -> None:
        for vertex, k, value in pins.values():
            at = self.samples.vertex == vertex
            for (region, component), side in sides.items():
                there = side.samples[at & (self.samples.region == region)]
                if component == k and len(there) and differ(there[0], value, largest(side)):
                    raise ValueError(
                        f"Pin and SetDirichlet: u_{AXES[k]} at {place(self.V, vertex)} is pinned to {value:g} and given as {there[0]:g} on "
                        f"{self.V.mesh.GetBoundaries()[region]!r}; give both the same value"
                    )

    def Holders(self) -> list[Holder]:
        """What holds which functions φ_i, one Holder for each name of a boundary that holds and for each vertex that only a pin does."""
        unknowns = Unknowns(self.V)
        dofs = {key: side.dofs[side.dofs < unknowns.polynomial.stop] for key, side in self.sides.items()}
        weights = {(region, k): self.samples.Sizes(region, dofs[region, k] - unknowns.Polynomial(k).start) for region, k in dofs}
        total = np.zeros(unknowns.polynomial.stop)
        for key in dofs:
            total[dofs[key]] += weights[key]
        holders: dict[Any, Holder] = {}  # by the names of boundaries and the points of pins
        for key in sorted(dofs):
            name = self.V.mesh.GetBoundaries()[key[0]]
            holders[name] = holders.get(name, Holder(name)) + Holder(name, dofs[key], weights[key] / total[dofs[key]])
        here = [self.V.mesh[NodeId(VERTEX, vertex)].point for vertex, _, _ in self.pins.values()]
        pins = [(point, dof) for point, dof in zip(here, self.pins) if total[dof] == 0]
        for point in dict.fromkeys(point for point in self.points if point not in here or any(point == of_one for of_one, _ in pins)):
            dofs = np.array([dof for of_one, dof in pins if of_one == point], dtype=int)
            holders[point] = Holder(f"pin at ({', '.join(f'{c:g}' for c in point)})", dofs, np.ones(len(dofs)), point)
        return list(holders.values())

    def CornerEdges(self) -> list[CornerEdge]:
        """The edges of boundaries beside the vertices at which they meet, as CornerEdges."""
        mesh, samples = self.V.mesh, self.samples
        if self.dimension == 3:
            return []  # forces on edges between regions are divided by areas
        rows = np.concatenate([np.zeros(0, dtype=int), *samples.Corners()])
        edges = [corner_edge(mesh, mesh.GetBoundaries()[samples.region[row]], samples.element[row], samples.vertex[row]) for row in rows]
        return [edge for edge in edges if edge is not None]

    def NormalJumps(self) -> np.ndarray:
        """The normal jump that is given at each mouth, see BoundarySamples."""
        return self.samples.NormalJumps(self.sides)

    def CheckOverlap(self, jumps: np.ndarray, gap: CoefficientFunction, scale: float) -> None:
        """Raises ValueError where given normal jumps push the faces of a mouth through each other.

        Parameters
        ----------
        jumps
            As NormalJumps, or multiples.
        gap
            g_0, a CoefficientFunction.
        scale
            The largest given displacement.
        """
        for number, ((crack, *_), jump) in enumerate(zip(self.samples.mouths, jumps)):
            if jump < 0 and jump + self.samples.AtMouth(gap, number) < -TOLERANCE * scale:
                where = ", ".join(f"{coordinate:g}" for coordinate in self.samples.Place(number))
                raise ValueError(
                    f"the given displacements push the faces of crack {crack} through each other by {-jump:g} at its mouth ({where}), "
                    "which no displacement fulfils: give a jump that is not negative there, an initial gap, or leave this part of the boundary free"
                )


def supports_of(V: CrackFESpace, sides: dict[tuple[int, int], HeldSide], pins: list[tuple[int, int, float]]) -> Supports:
    """The Supports that were saved: their unknowns in the order of `pickling.numbering`."""
    supports, dofs = Supports(V), dofs_of(V, *(side.dofs for side in sides.values()))
    supports.sides = {key: replace(side, dofs=own) for (key, side), own in zip(sides.items(), dofs)}
    supports.pins = {V.GetDofNrs(NodeId(VERTEX, pin[0]))[pin[1]]: pin for pin in pins}
    supports.points = [V.mesh[NodeId(VERTEX, vertex)].point for vertex, _, _ in pins]
    supports._apply()
    return supports


def largest(side: HeldSide) -> float:
    """The largest size of what is given on a HeldSide."""
    return np.nanmax(np.abs(side.samples), initial=0)


def differ(a: Any, b: Any, *sizes: Any) -> bool:
    """Whether two given displacements are not the same, relative to the largest of them and of some sizes."""
    return abs(a - b) > TOLERANCE * max(abs(a), abs(b), *sizes)


def component_numbers(dimension: int) -> dict[str, list[int]]:
    """{"x": [0], "y": [1], "xy": [0, 1], ...}."""
    some = [numbers for n in range(dimension) for numbers in combinations(range(dimension), n + 1)]
    return {"".join(AXES[k] for k in numbers): list(numbers) for numbers in some}


def given_components(value: Any, dimension: int) -> tuple[CoefficientFunction, list[int]]:
    """(CoefficientFunction with zero for None, the components that are given) of the value of SetDirichlet."""
    components = list(range(dimension))
    if isinstance(value, (tuple, list)):
        components = [k for k, part in enumerate(value) if part is not None]
        if not components:
            raise ValueError(f"SetDirichlet: value={value!r} gives no component; declare what is free by leaving it out of dirichlet=")
        value = tuple(0 if part is None else check_function(part, f"SetDirichlet: value[{k}]", 1) for k, part in enumerate(value))
    return check_function(value, "SetDirichlet: value", dimension), components


def moments_form(V: CrackFESpace, value: CoefficientFunction, region: str, weight: CoefficientFunction) -> LinearForm:
    """∫ weight value·v over a boundary region."""
    zero = CoefficientFunction((Parameter(0),) * V.mesh.dim)  # NGSolve drops a term with a value that is zero, and refuses the form that is left
    return LinearForm(weight * (value + zero) * V.TestFunction() * V.body.ds(region, bonus_intorder=PROJECTION_BONUS))


def projected_trace(V: CrackFESpace, load: np.ndarray, region: str, weight: CoefficientFunction) -> tuple[np.ndarray, np.ndarray]:
    """(values, short): the weighted L² projection of the trace with these moments, for all unknowns, zero at those of short traces, which it leaves out.

    A trace of V's polynomials has no jumps beside it: only what these leave of the value is for the Heaviside functions. Between two mouths in one edge their traces
    may be nearly dependent; what these cannot tell apart has no jump, either: DEPENDENT of their own mass is added to their diagonal.
    """
    mass, short = boundary_mass(V, region, weight), short_traces(V, region)
    diagonal = mass.diagonal()
    dofs = np.setdiff1d(np.flatnonzero(diagonal), short)
    scale = 1 / np.sqrt(diagonal[dofs])
    scaled, load = mass[dofs][:, dofs].multiply(scale).T.multiply(scale).tocsc(), scale * load[dofs]
    is_smooth = dofs < Unknowns(V).heaviside.start
    smooth, projection = np.flatnonzero(is_smooth), np.zeros(len(dofs))
    projection[smooth] = scipy.sparse.linalg.splu(scaled[smooth][:, smooth]).solve(load[smooth])
    rest = load - scaled @ projection
    if np.abs(rest).max(initial=0) > ROUND_OFF * np.abs(load).max(initial=0):
        small = scipy.sparse.diags(np.where(is_smooth, 0.0, DEPENDENT))
        factors = scipy.sparse.linalg.splu((scaled + small).tocsc())
        jumps = factors.solve(rest)
        projection += jumps + factors.solve(rest - scaled @ jumps)
    values = np.zeros(V.ndof)
    values[dofs] = scale * projection
    return values, short


def pin_values(value: Any, components: Any) -> np.ndarray:
    """One finite number for each component of a Pin."""
    try:
        values = np.broadcast_to(np.asarray(value, dtype=float), len(components))
    except (TypeError, ValueError):
        raise ValueError(f"Pin: value={value!r} is not a number{', nor two, one for each component' * (len(components) == 2)}") from None
    if not np.isfinite(values).all():
        raise ValueError(f"Pin: value={value} is not finite; give the displacement in the unit of length")
    return values


def check_outside_of_disks(V: CrackFESpace, point: Sequence[float]) -> None:
    """Raises ValueError for a point at which a tip's functions do not vanish: a vertex's unknowns do not fix u there."""
    for tip, spec in zip(V.body.tips, V.tip_specs):
        r = np.hypot(*np.subtract(point, tip.point))
        if spec is not None and r < spec.r1:
            raise ValueError(
                f"Pin: the vertex {tuple(point)} is in the disk r < r1 = {spec.r1:g} of the tip at ({tip.point[0]:g}, {tip.point[1]:g}), whose functions move it; "
                f"pin a vertex outside, or choose TipEnrichment(r1=...) below {r:g}, or tip=None there"
            )


def place(V: CrackFESpace, vertex: int) -> str:
    """A vertex in words."""
    return f"({', '.join(f'{coordinate:g}' for coordinate in V.mesh[NodeId(VERTEX, int(vertex))].point)})"
