# By tools/stubs.py.

from __future__ import annotations
import collections.abc
import netgen.libngpy._NgOCC
import ngsolve.comp
import ngsolve.fem
import ngsolve.la
import numpy
import numpy.typing
import pathlib
import pyngcore.pyngcore
import typing

__all__: list[str] = [
    "BorderedMatrix",
    "Crack",
    "CrackBilinearForm",
    "CrackEnd",
    "CrackFESpace",
    "CrackFacet",
    "CrackedMesh",
    "CrackedSolid",
    "CurveNodes",
    "CutDifferentialSymbol",
    "CutOff",
    "Degeneracy",
    "Domain",
    "ElementKind",
    "ElementLocation",
    "ElementMatrices",
    "ElementOrder",
    "ElementsBeside",
    "EndKind",
    "FormTerm",
    "FromCSR",
    "Front",
    "FrontDemand",
    "FrontSpec",
    "FunctionOf",
    "GridFunctionOf",
    "HeightField",
    "InnerIntegrals",
    "IntegralsOn",
    "IsTestFunction",
    "LinearSheetTraceSpace",
    "MeshTraceBasis",
    "NameOf",
    "NodalTraceBasis",
    "NumKeptRules",
    "NumNegativePivots",
    "NumbersOfVertices",
    "OperatorName",
    "OperatorOf",
    "PartTriangle",
    "PointOf",
    "SchurComplement",
    "Sheet",
    "SheetCell",
    "Side",
    "SolidFESpace",
    "StressPower",
    "TermsOf",
    "Tip",
    "TipBasis",
    "TipModeGradient",
    "TipSpec",
    "TraceBasis",
    "TraceSpace",
    "Variation",
]

class FrontDemand:
    """What functions that are singular at the fronts of a solid ask of the rules of a measure: `body.dx(fronts=FrontDemand())`."""

    def __init__(self, radius: float = 0.0, along: int = 3, angular: int = 4, radial: int = 4, order: int = 5, beta: float = 0.35) -> None: ...
    @property
    def along(self) -> int:
        """Gauss points in s."""

    @property
    def angular(self) -> int:
        """Gauss points in the angle."""

    @property
    def beta(self) -> float:
        """The least distance of a part from the front, relative to its size."""

    @property
    def order(self) -> int:
        """The order of Gauss beside the front."""

    @property
    def radial(self) -> int:
        """Gauss points in √r."""

    @property
    def radius(self) -> float:
        """Elements that come nearer to a front get rules of their own, beside those around it."""

class CutDifferentialSymbol(ngsolve.comp.DifferentialSymbol):
    """A measure of a CrackedMesh: as dx and ds of NGSolve, with rules that respect the cracks. For linear and bilinear forms, and Integrate(f * body.dx, body.mesh)."""

    def Points(self, order: int, space: ngsolve.comp.FESpace | None = None) -> tuple[numpy.ndarray, ...]:
        """Arrays: element, reference coordinates xi and eta (of a solid also zeta), weight, x, y (and z) of the points of a rule of this order; with a space those of its tips' functions."""

    def PrepareRules(self, order: int, space: ngsolve.comp.FESpace | None = None) -> None:
        """Makes the rules of this order now, which are otherwise made when they are first used. They are kept as long as a space on the body, a measure or a form."""

    def __call__(
        self,
        definedon: ngsolve.comp.Region | str | None = None,
        bonus_intorder: int = 0,
        definedonelements: pyngcore.pyngcore.BitArray | None = None,
        crack: int | str | None = None,
        nodes: collections.abc.Sequence[collections.abc.Sequence[float]] | None = None,
        space: ngsolve.comp.FESpace | None = None,
        fronts: FrontDemand | None = None,
    ) -> CutDifferentialSymbol:
        """The same measure, restricted or refined."""

    def __rmul__(self, arg0: float) -> ngsolve.comp.SumOfIntegrals: ...

class _Enumeration:
    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Side(_Enumeration):
    """The side of a crack: Plus to the left of its direction of travel, Minus to the right."""

    Minus: typing.ClassVar[Side]
    Plus: typing.ClassVar[Side]
    __members__: typing.ClassVar[dict[str, Side]]

class Crack:
    """An oriented curve Γ_C in the plane, in the coordinates of the mesh. Its normal n points to the left of the direction of travel t, from the
    minus to the plus side. Where it ends inside the body it has a tip, on the boundary a mouth,
    on another crack a junction; a closed one has no ends."""

    @staticmethod
    def Arc(start: tuple[float, float], through: tuple[float, float], end: tuple[float, float], name: str = "") -> Crack:
        """The circular arc from start to end through a third point. Raises an Exception for three points on a line."""

    @staticmethod
    def Curve(
        function: collections.abc.Callable[[float], collections.abc.Sequence[float]],
        t0: float,
        t1: float,
        tolerance: float = 1e-07,
        max_pieces: int = 4096,
        name: str = "",
    ) -> Crack:
        """The curve function(t), t from t0 to t1, as a C² cubic spline that deviates by less than tolerance × its length."""

    @staticmethod
    def Join(*cracks: Crack, name: str = "") -> Crack:
        """Cracks end to end as one: a kink where the direction jumps. Raises an Exception for a gap."""

    @staticmethod
    def LevelSet(
        mesh: ngsolve.comp.Mesh,
        phi: ngsolve.fem.CoefficientFunction,
        psi: ngsolve.fem.CoefficientFunction | None = None,
        tolerance: float | None = None,
        max_points: int = 4096,
        name: str = "",
    ) -> Crack:
        """The crack {φ = 0, ψ < 0} of CoefficientFunctions or GridFunctions; n points to φ > 0."""

    @staticmethod
    def OfPieces(pieces: collections.abc.Sequence[tuple[str, collections.abc.Sequence[tuple[float, float]]]], name: str = "") -> Crack:
        """Pieces (kind, points): ('segment', [a, b]), ('arc', [start, through, end]), ('cubic', [p0, d0, p1, d1]) with values and derivatives at t = 0 and 1,
        ('ellipse', [centre, a, b, (t0, t1)]): centre + cos(t) a + sin(t) b."""

    @staticmethod
    def Spline(points: collections.abc.Sequence[collections.abc.Sequence[float]] | numpy.ndarray, ends: str = "not-a-knot", name: str = "") -> Crack:
        """The C² cubic spline through points (n, 2), by chord length: the curve itself is the crack, not a polyline."""

    def ArcLength(self, point: tuple[float, float]) -> float:
        """Arc length of the nearest point of the crack."""

    def CurvatureAt(self, s: float) -> float:
        """The curvature at arc length s, > 0 where the crack turns left."""

    def Distance(self, point: tuple[float, float]) -> float:
        """Distance to the nearest point of the crack."""

    def Outline(self, turn: float = 0.05) -> list[tuple[float, float]]:
        """Points for pictures: a polyline that follows the crack, with kinks of about the angle turn where it is curved."""

    def PointAt(self, s: float) -> tuple[float, float]:
        """The point (x, y) at arc length s, 0 ≤ s ≤ length."""

    def SideOf(self, point: tuple[float, float]) -> Side:
        """The Side of a point (x, y) with respect to the crack and, beyond its ends, to their straight extensions; Plus on the crack itself."""

    def TangentAt(self, s: float) -> tuple[float, float]:
        """The unit tangent at arc length s."""

    def __init__(self, points: collections.abc.Sequence[tuple[float, float]], name: str = "") -> None: ...
    @property
    def closed(self) -> bool:
        """Whether the crack ends where it starts, without a tip or a mouth."""

    @property
    def kinks(self) -> list[float]:
        """Arc lengths at which the direction jumps; of a polyline all inner points."""

    @property
    def length(self) -> float:
        """The arc length from end to end, in the user's unit of length."""

    @property
    def name(self) -> str:
        """What it is called in arguments, messages and tables; empty: nothing."""

    @property
    def pieces(self) -> list[tuple[str, list[tuple[float, float]]]]:
        """What OfPieces takes."""

    @property
    def points(self) -> list[tuple[float, float]]:
        """The points of a polyline; of a curve the ends of its pieces."""

    @property
    def side(self) -> ngsolve.fem.CoefficientFunction:
        """H: +1 on the plus side, -1 on the minus side, a CoefficientFunction."""

class ElementKind(_Enumeration):
    """How a crack meets an element: Uncut, Cut through, Tip inside, or Aligned with an edge that the element carries."""

    Aligned: typing.ClassVar[ElementKind]
    Cut: typing.ClassVar[ElementKind]
    Tip: typing.ClassVar[ElementKind]
    Uncut: typing.ClassVar[ElementKind]
    __members__: typing.ClassVar[dict[str, ElementKind]]

class Degeneracy:
    """The special positions of a crack in an element; each holds to within 1e-10 of the smallest element beside the crack."""

    @property
    def along_edge(self) -> bool:
        """Whether it runs along an edge."""

    @property
    def kink_inside(self) -> bool:
        """Whether its direction jumps inside the element."""

    @property
    def through_vertex(self) -> bool:
        """Whether the crack passes through a vertex of the element."""

    @property
    def tip_on_edge(self) -> bool:
        """Whether it ends on an edge."""

    @property
    def tip_on_vertex(self) -> bool:
        """Whether it ends in a vertex."""

class ElementLocation:
    """Where an element lies with respect to the crack that meets it."""

    @property
    def arclength(self) -> tuple[float, float]:
        """Arc lengths at which the crack enters and leaves it."""

    @property
    def chords(self) -> list[tuple[float, float]]:
        """Arc lengths between which the crack is in the element."""

    @property
    def curved(self) -> bool:
        """Whether the element is curved. Its triangle is then that of its corners."""

    @property
    def degeneracy(self) -> Degeneracy:
        """The special positions that hold."""

    @property
    def element(self) -> int:
        """The number of the element in the mesh."""

    @property
    def h(self) -> float:
        """The longest edge h_T, in the user's unit of length."""

    @property
    def kind(self) -> ElementKind:
        """Its ElementKind: Cut, Tip or Aligned."""

    @property
    def triangle(self) -> typing.Annotated[list[tuple[float, float]], "FixedSize(3)"]:
        """The three corners (x, y) of the element."""

class PartTriangle:
    """A triangle inside a connected part of an element; of a curved element in its straight triangle."""

    def Outline(self, turn: float = 0.05) -> list[tuple[float, float]]:
        """The corners, and between the last two points of the curved side, between which it turns by about turn."""

    @property
    def area(self) -> float:
        """Its area; with a curved side that of the cone over it."""

    @property
    def part(self) -> int:
        """The number of the part in its element, from 0."""

    @property
    def triangle(self) -> typing.Annotated[list[tuple[float, float]], "FixedSize(3)"]:
        """The three corners (x, y)."""

class CrackFacet:
    """A stretch of a crack in an element, between two parts: those of the element, and behind them those of neighbours across its edges."""

    @property
    def arclength(self) -> tuple[float, float]:
        """Where it starts and ends on the crack."""

    @property
    def crack(self) -> int:
        """The number of the crack."""

    @property
    def larger(self) -> Side:
        """The Side of the larger one of the two, of equal ones Plus: the one whose stress is R_h."""

    @property
    def minus(self) -> int:
        """The part on its minus side, the same one beside a tip."""

    @property
    def plus(self) -> int:
        """The part on its plus side."""

class EndKind(_Enumeration):
    """An end of a crack: a Tip inside the body, a Mouth on its boundary, or a Junction on another crack, or where a closed crack starts."""

    Junction: typing.ClassVar[EndKind]
    Mouth: typing.ClassVar[EndKind]
    Tip: typing.ClassVar[EndKind]
    __members__: typing.ClassVar[dict[str, EndKind]]

class CrackEnd:
    """An end of a crack in a mesh."""

    @property
    def kind(self) -> EndKind:
        """Its EndKind: Tip inside the body, Mouth on its boundary, Junction on another crack."""

    @property
    def point(self) -> tuple[float, float]:
        """Its place (x, y)."""

    @property
    def s(self) -> float:
        """Its arc length: 0 or the length of the crack."""

class Tip:
    """A crack end inside the body: point, crack number, direction ahead, and the clearance that a disk of singular functions has."""

    @property
    def ahead(self) -> tuple[float, float]:
        """The unit direction in which the crack would grow straight on."""

    @property
    def clearance(self) -> float:
        """The largest radius of a disk of singular functions: the least of the distances to the boundary, to other cracks and to the next kink, of
        half the distance to other tips and of half the radius of curvature."""

    @property
    def crack(self) -> int:
        """The number of its crack in body.cracks."""

    @property
    def distances(self) -> list[tuple[float, str]]:
        """Pairs (distance, what is there, in words): of the boundary of the body and of the other cracks."""

    @property
    def limit(self) -> str:
        """What sets the clearance, in words."""

    @property
    def point(self) -> tuple[float, float]:
        """Its place (x, y)."""

    @property
    def s(self) -> float:
        """Its arc length: 0 or the length of the crack."""

class CrackedMesh:
    """A mesh with its cracks; ngsxfem_contact.CrackedMesh says more."""

    @staticmethod
    def _repr_html_(body: typing.Any) -> str:
        """The same as HTML."""

    def CheckMesh(self) -> None:
        """Raises an Exception if the mesh was refined, curved or deformed after the cracks were located in it."""

    def CrackElements(self, crack: int | str | None) -> pyngcore.pyngcore.BitArray:
        """BitArray of the elements that carry a part of a crack (None: of any)."""

    def CrackNumber(self, crack: int | str) -> int:
        """The number of a crack, from 0, by its name. Raises ValueError for a name that no crack has."""

    def CracksOf(self, element: int) -> list[int]:
        """Numbers of the cracks that meet an element."""

    def CutBoundaryElements(self, crack: int | str) -> list[int]:
        """Numbers of the boundary elements that a crack cuts."""

    def CutBoundaryPoints(self, crack: int | str) -> list[tuple[int, tuple[float, float]]]:
        """The boundary elements that a crack cuts, with the points (x, y) at which it cuts them: a list of (number, point)."""

    def Elements(self, crack: int | str) -> list[ElementLocation]:
        """The ElementLocations of the elements that a crack meets."""

    def Ends(self, crack: int | str) -> typing.Annotated[list[CrackEnd], "FixedSize(2)"]:
        """The two CrackEnds of a crack, its start first."""

    def Facets(self, element: int) -> list[CrackFacet]:
        """The CrackFacets in an element, and on those of its edges that it carries for a neighbour, too."""

    def InLargerPart(self, side: str | None) -> ngsolve.fem.CoefficientFunction:
        """1 in the larger parts beside the cracks, 0 elsewhere, a CoefficientFunction: by the position of a point (None), on the cracks for their "plus" or "minus" side."""

    def LimitOnCrack(self, function: ngsolve.fem.CoefficientFunction, side: int) -> ngsolve.fem.CoefficientFunction:
        """The limit of a function on the cracks from the plus (1) or minus side (-1), or that of the larger part (0): a CoefficientFunction, for functions that jump there."""

    def Links(self, edge: int) -> list[typing.Annotated[list[int], "FixedSize(2)"]]:
        """Pairs of parts of the two elements beside an edge of the mesh that hang together across it."""

    def Meetings(self, crack: int | str) -> list[float]:
        """Arc lengths at which a crack meets others, its junctions among them."""

    def MeshNodes(self, crack: int | str, kinks: bool) -> list[float]:
        """Arc lengths at which the crack meets mesh edges, and of its ends (and kinks)."""

    def OnCrack(self, crack: int | str, arclengths: collections.abc.Sequence[float]) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
        """(elements, xi, eta): element numbers and reference coordinates of points on a crack. Raises an Exception for arc lengths beyond its ends."""

    def PartSizes(self, element: int) -> list[float]:
        """The areas of the connected parts of an element (of a curved one in its straight triangle); [1] if no crack meets it."""

    def Parts(self, element: int) -> list[PartTriangle]:
        """The PartTriangles into which the cracks divide an element, a list; none if no crack meets it."""

    def __init__(self, mesh: ngsolve.comp.Mesh, *cracks: Crack, is_part: bool = False) -> None: ...
    @property
    def crack_number(self) -> ngsolve.fem.CoefficientFunction:
        """On the cracks the number of the crack: a CoefficientFunction."""

    @property
    def cracks(self) -> list[Crack]:
        """The Cracks, in the order in which they were given, with their ends fitted to the body."""

    @property
    def dcrack(self) -> CutDifferentialSymbol:
        """The measure on the cracks."""

    @property
    def dlarger(self) -> CutDifferentialSymbol:
        """The measure on the larger part of each element that a crack meets."""

    @property
    def ds(self) -> CutDifferentialSymbol:
        """The measure on the boundary, divided at mouths."""

    @property
    def dx(self) -> CutDifferentialSymbol:
        """The measure on the body without the cracks."""

    @property
    def larger_side(self) -> ngsolve.fem.CoefficientFunction:
        """On the cracks +1 or -1, the side of the larger part of the element, whose stress is R_h: a CoefficientFunction."""

    @property
    def mesh(self) -> ngsolve.comp.Mesh:
        """The mesh of NGSolve."""

    @property
    def normal(self) -> ngsolve.fem.CoefficientFunction:
        """The unit normal n on the cracks, from the minus to the plus side: a CoefficientFunction, for forms over dcrack."""

    @property
    def notes(self) -> list[str]:
        """Sentences on the ends that were cut off or moved, none where all is as given."""

    @property
    def tangent(self) -> ngsolve.fem.CoefficientFunction:
        """The unit tangent t on the cracks, in the direction of travel: a CoefficientFunction, for forms over dcrack."""

    @property
    def tips(self) -> list[Tip]:
        """The Tips of all cracks: for each crack that of its start, then that of its end, where they lie inside the body."""

class HeightField:
    """Heights f(p1, p2) over a plane, a sum of cubic B-splines on a regular grid: two times continuously differentiable, linear beyond the grid. Sheet.FromTriangles fits one."""

    def At(self, p1: float, p2: float) -> tuple[float, float, float]:
        """The height, and its derivatives by p1 and p2."""

    def __init__(
        self,
        lower: typing.Annotated[collections.abc.Sequence[float], "FixedSize(2)"],
        spacing: typing.Annotated[collections.abc.Sequence[float], "FixedSize(2)"],
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> None: ...
    @property
    def coefficients(self) -> numpy.typing.NDArray[numpy.float64]:
        """(n1, n2), of each B-spline."""

    @property
    def lower(self) -> tuple[float, float]:
        """(p1, p2) of the first knot of the grid."""

    @property
    def spacing(self) -> tuple[float, float]:
        """The distances of its knots in both directions."""

class Sheet:
    """A crack in space: the part of a plane that closed curves bound. Its unit normal n = a1 × a2 points from the minus to the plus side. With a curve it is the part of the
    curved surface that the curve of the plane sweeps along n = a1 × a2, and the normal is that of the curve.
    Sheet.Disk, Sheet.Ellipse, Sheet.Polygon, Sheet.Ring and Sheet.Extrude make common ones. What lies outside of the body is cut off: a sheet that reaches the boundary of the
    body has a mouth there, inside the body it has a front."""

    @staticmethod
    def Disk(center: collections.abc.Sequence[float], normal: collections.abc.Sequence[float], radius: float) -> Sheet:
        """The disk of a radius around a center: a penny-shaped crack."""

    @staticmethod
    def Ellipse(center: collections.abc.Sequence[float], a: collections.abc.Sequence[float], b: collections.abc.Sequence[float]) -> Sheet:
        """The ellipse center + cos(t) a + sin(t) b; its normal is a × b."""

    @staticmethod
    def Extrude(
        crack: Crack,
        direction: collections.abc.Sequence[float],
        origin: collections.abc.Sequence[float] = (0, 0, 0),
        x_axis: collections.abc.Sequence[float] | None = None,
        loops: collections.abc.Sequence[Crack] | None = None,
    ) -> Sheet:
        """The surface that a crack of a plane sweeps along its normal: a curved crack, or one with kinks."""

    @staticmethod
    def FromFace(face: netgen.libngpy._NgOCC.Face, maxh: float) -> Sheet:
        """A face of an OpenCASCADE shape as a sheet: it is triangulated, see Sheet.FromTriangles."""

    @staticmethod
    def FromSTL(path: str | pathlib.Path) -> Sheet:
        """The surface of a file in STL format, text or binary: see Sheet.FromTriangles."""

    @staticmethod
    def FromTriangles(points: typing.Any, triangles: typing.Any) -> Sheet:
        """The smooth surface through the corners of a triangulation, bounded by the smooth curve through its boundary."""

    @staticmethod
    def Polygon(points: collections.abc.Sequence[collections.abc.Sequence[float]] | numpy.ndarray) -> Sheet:
        """The polygon with given corners in a plane; its normal points to where they run counter-clockwise."""

    @staticmethod
    def Ring(center: collections.abc.Sequence[float], normal: collections.abc.Sequence[float], inner: float, outer: float) -> Sheet:
        """What lies between two circles around a center: a ring-shaped crack with two fronts."""

    def Contains(self, point: typing.Annotated[collections.abc.Sequence[float], "FixedSize(3)"]) -> bool:
        """Whether the foot of a point (x, y, z) on the plane, or the nearest point of the curved surface, lies in the sheet."""

    def Flat(self, point: typing.Annotated[collections.abc.Sequence[float], "FixedSize(3)"]) -> tuple[float, float, float]:
        """(p1, p2, height) of a point (x, y, z): the coordinates of its foot, and its distance, positive on the plus side."""

    def FrameAt(self, p1: float, p2: float) -> typing.Annotated[list[typing.Annotated[list[float], "FixedSize(3)"]], "FixedSize(3)"]:
        """The unit normal and the unit tangents along p1 and p2 at the point with coordinates p1, p2."""

    def PointAt(self, p1: float, p2: float) -> typing.Annotated[list[float], "FixedSize(3)"]:
        """The point (x, y, z) with coordinates p1, p2."""

    def __init__(
        self,
        loops: collections.abc.Sequence[Crack],
        origin: typing.Annotated[collections.abc.Sequence[float], "FixedSize(3)"] = [0.0, 0.0, 0.0],
        axes: typing.Annotated[collections.abc.Sequence[typing.Annotated[collections.abc.Sequence[float], "FixedSize(3)"]], "FixedSize(2)"] = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
        ],
        curve: Crack | None = None,
        heights: HeightField | None = None,
    ) -> None: ...
    @property
    def area(self) -> float:
        """Its area, also of what lies outside of a body; of one with heights that of its projection."""

    @property
    def axes(self) -> typing.Annotated[list[typing.Annotated[list[float], "FixedSize(3)"]], "FixedSize(2)"]:
        """The unit vectors a1 and a2 of the plane's coordinates; of a curved sheet those of the plane of its curve."""

    @property
    def curve(self) -> Crack | None:
        """The Crack that is extruded, or None."""

    @property
    def heights(self) -> HeightField | None:
        """The HeightField over the plane, or None."""

    @property
    def loops(self) -> list[Crack]:
        """The curves in the plane, of a curved sheet in its coordinates (p1, p2), with the sheet to their right: the outer one, then those of holes."""

    @property
    def name(self) -> str:
        """Empty: sheets have numbers only."""

    @property
    def normal(self) -> tuple[float, float, float]:
        """The unit normal n, from the minus to the plus side."""

    @property
    def origin(self) -> tuple[float, float, float]:
        """The point (x, y, z) of the plane with p1 = p2 = 0; of a curved sheet the origin of the plane of its curve."""

    @property
    def planar(self) -> bool:
        """Whether it lies in a plane."""

class Front:
    """Where a sheet ends inside the body: a curve C(s) with the frame e1 ahead, out of the sheet, e2 = n and e3 = e1 × e2, the direction in which s grows."""

    def CurvatureAt(self, s: float) -> float:
        """The curvature at arc length s, > 0 where the sheet is convex."""

    def Distance(self, point: typing.Annotated[collections.abc.Sequence[float], "FixedSize(3)"]) -> float:
        """The distance of a point (x, y, z)."""

    def FrameAt(self, s: float) -> typing.Annotated[list[typing.Annotated[list[float], "FixedSize(3)"]], "FixedSize(3)"]:
        """The unit vectors e1, e2, e3 at arc length s."""

    def PointAt(self, s: float) -> typing.Annotated[list[float], "FixedSize(3)"]:
        """The point (x, y, z) at arc length s, 0 ≤ s ≤ length."""

    def Tube(self, point: typing.Annotated[collections.abc.Sequence[float], "FixedSize(3)"]) -> tuple[float, float, float]:
        """(x1, x2, s) of a point (x, y, z) = C(s) + x1 e1 + x2 e2, C(s) the nearest point; x2 is exactly 0 on the sheet."""

    @property
    def closed(self) -> bool:
        """Whether it is a whole closed curve; else it ends on the boundary of the body."""

    @property
    def corners(self) -> list[float]:
        """Arc lengths at which its direction jumps."""

    @property
    def length(self) -> float:
        """The arc length, in the user's unit of length."""

    @property
    def loop(self) -> int:
        """The number of the curve of the sheet that it is a part of."""

    @property
    def sheet(self) -> int:
        """The number of its sheet in body.cracks."""

    @property
    def tube(self) -> ngsolve.fem.CoefficientFunction:
        """The coordinates (x1, x2, s) of Tube: a CoefficientFunction."""

class SheetCell:
    """What a sheet's plane cuts out of an element, or a face of the mesh on the plane."""

    @property
    def chords(self) -> list[tuple[int, float, float]]:
        """Where the curves that bound the sheet run through the polygon: numbers of loops, and arc lengths from and to."""

    @property
    def element(self) -> int:
        """The number of the element in the mesh."""

    @property
    def h(self) -> float:
        """The longest edge of the element."""

    @property
    def heights(self) -> typing.Annotated[list[float], "FixedSize(4)"]:
        """Heights of the element's corners over the plane, by the numbers of the vertices; 0 on the plane."""

    @property
    def kind(self) -> ElementKind:
        """Its ElementKind: Cut, Tip (a front is inside) or Aligned."""

    @property
    def neighbour(self) -> int | None:
        """The element on the other side of a face on the plane, which this one carries for both, or None."""

    @property
    def nodes(self) -> list[typing.Annotated[list[int], "FixedSize(2)"]]:
        """Of each corner of the polygon the two vertices of the mesh, in the order of their numbers, between which the plane cuts the edge; twice the same one on the plane."""

    @property
    def points(self) -> list[typing.Annotated[list[float], "FixedSize(3)"]]:
        """The corners (x, y, z)."""

    @property
    def polygon(self) -> list[tuple[float, float]]:
        """The corners in the plane's coordinates, counter-clockwise."""

class CrackedSolid:
    """What CrackedMesh(mesh, sheet, ...) makes of a mesh of tetrahedra: the body with its sheets, with the measures dx, ds, dcrack and dlarger as in the plane."""

    @staticmethod
    def _repr_html_(body: typing.Any) -> str:
        """The same as HTML."""

    def BoundaryPartSizes(self, element: int) -> list[float]:
        """The areas of the parts of a boundary element, the plus side first; [1] if no sheet divides it."""

    def CheckMesh(self) -> None:
        """Raises an Exception if the mesh was refined, curved or deformed after the sheets were located in it."""

    def CrackElements(self, crack: int | None) -> pyngcore.pyngcore.BitArray:
        """BitArray of the elements that carry a part of a crack (None: of any)."""

    def CracksOf(self, element: int) -> list[int]:
        """Numbers of the sheets that meet an element."""

    def CutBoundaryElements(self, crack: int) -> list[int]:
        """Numbers of the boundary elements that a crack divides: its mouths."""

    def Elements(self, crack: int) -> list[SheetCell]:
        """The SheetCells of a crack, one for each element that carries a part of it."""

    def FacetArea(self, element: int) -> float:
        """The area of the sheet in an element, exact but for round-off."""

    def FrontElements(self, crack: int) -> set[int]:
        """Numbers of the elements whose closure holds a stretch of a front of a crack."""

    def LimitOnCrack(self, function: ngsolve.fem.CoefficientFunction, side: int) -> ngsolve.fem.CoefficientFunction:
        """The limit of a function on the sheets from the plus (1) or minus side (-1), or that of the larger part (0): a CoefficientFunction, for functions that jump there."""

    def Links(self, face: int) -> list[typing.Annotated[list[int], "FixedSize(2)"]]:
        """Pairs of parts of the two elements beside a face of the mesh that hang together across it."""

    def PartSizes(self, element: int) -> list[float]:
        """The volumes of the connected parts of an element, the plus side first; [1] if no sheet meets it."""

    def __init__(self, mesh: ngsolve.comp.Mesh, sheets: collections.abc.Sequence[Sheet]) -> None: ...
    @property
    def crack_number(self) -> ngsolve.fem.CoefficientFunction:
        """On the cracks the number of the crack: a CoefficientFunction."""

    @property
    def cracks(self) -> list[Sheet]:
        """The Sheets, in the order in which they were given."""

    @property
    def dcrack(self) -> CutDifferentialSymbol:
        """The measure on the cracks."""

    @property
    def dlarger(self) -> CutDifferentialSymbol:
        """The measure on the larger part of each element that a crack meets."""

    @property
    def ds(self) -> CutDifferentialSymbol:
        """The measure on the boundary, divided at mouths."""

    @property
    def dx(self) -> CutDifferentialSymbol:
        """The measure on the body without the cracks."""

    @property
    def fronts(self) -> list[Front]:
        """The Fronts of all sheets, those of the first sheet first."""

    @property
    def larger_side(self) -> ngsolve.fem.CoefficientFunction:
        """On the cracks +1 or -1, the side of the larger part of the element: a CoefficientFunction."""

    @property
    def mesh(self) -> ngsolve.comp.Mesh:
        """The mesh of NGSolve."""

    @property
    def normal(self) -> ngsolve.fem.CoefficientFunction:
        """The unit normal n on the cracks, from the minus to the plus side: a CoefficientFunction, for forms over dcrack."""

    @property
    def notes(self) -> list[str]:
        """Sentences on what was moved: none, sheets stay where they are."""

    @property
    def tangent(self) -> ngsolve.fem.CoefficientFunction:
        """The first unit tangent on the cracks: a1 of a planar sheet, of a curved one the direction along p1 in each element."""

    @property
    def tips(self) -> list[tuple[numpy.ndarray, numpy.ndarray]]:
        """None: a body in space has fronts."""

class CutOff(_Enumeration):
    """The cut-off χ of the tip functions: cubic is C¹, quintic C², septic C³."""

    __members__: typing.ClassVar[dict[str, CutOff]]
    cubic: typing.ClassVar[CutOff]
    quintic: typing.ClassVar[CutOff]
    septic: typing.ClassVar[CutOff]

class TipBasis(_Enumeration):
    """The functions at a tip: branch, the four of (8) of [AHLMR12] in each component; modes, pairs of fields of Williams' expansion, those of unit K_I and K_II first."""

    __members__: typing.ClassVar[dict[str, TipBasis]]
    branch: typing.ClassVar[TipBasis]
    modes: typing.ClassVar[TipBasis]

class TipSpec:
    """What a space needs to know at one tip; TipEnrichment makes it."""

    def __init__(self, basis: TipBasis, cutoff: CutOff, r0: float, r1: float, kappa: float, mu: float, order: int = 1) -> None: ...
    @property
    def basis(self) -> TipBasis:
        """The TipBasis."""

    @property
    def cutoff(self) -> CutOff:
        """The CutOff."""

    @property
    def kappa(self) -> float:
        """Kolosov's constant of the material at the tip; of modes only."""

    @property
    def mu(self) -> float:
        """The shear modulus at the tip; of modes only."""

    @property
    def order(self) -> int:
        """How many powers r^{1/2}, r^{3/2}, ... there are; of modes only."""

    @property
    def r0(self) -> float:
        """χ = 1 for r ≤ r0, a length."""

    @property
    def r1(self) -> float:
        """χ = 0 for r ≥ r1, a length."""

class CrackFESpace(ngsolve.comp.FESpace):
    """The enriched space; ngsxfem_contact.CrackFESpace builds it from a TipEnrichment. Unknowns in this order: φ_i for x, φ_i for y, ½(H - s_i) φ_i for x, the
    same for y, the tips."""

    def BoundaryDofs(self) -> list[tuple[numpy.ndarray, numpy.ndarray]]:
        """For each boundary region one array for each component: its unknowns with a trace on the region."""

    def Heaviside(self, j: int) -> tuple[int, int]:
        """(i, s_i): the number of the j-th enriched function φ_i, and the side on which its copy sees the largest part of the support."""

    def HeavisideCrack(self, j: int) -> int:
        """The number of the crack at which it jumps, of the largest one of several."""

    def HeavisideDof(self, j: int, component: int) -> int:
        """The number of the unknown of the j-th Heaviside function, component 0 (x), 1 (y), ..."""

    def HeavisideFactors(self, j: int, element: int) -> list[int]:
        """By how much φ_i is multiplied in the j-th Heaviside function, ±1 or 0, on each part of an element. Raises an Exception outside of the support."""

    def HeldRegions(self, component: int) -> pyngcore.pyngcore.BitArray:
        """The boundary regions (BitArray) on which component 0 (x), 1 (y), ... is fixed."""

    def SetTipMaterial(self, tip: int, kappa: float, mu: float) -> None:
        """Gives the modes at a tip the kappa and mu of another material: unknowns and rules stay what they are."""

    def TipDofs(self, tip: int) -> list[int]:
        """The numbers of the unknowns of a tip; of modes that of K_I, that of K_II, then the pairs of higher powers of r. Empty without tip functions."""

    def __init__(self, body: CrackedMesh, tips: collections.abc.Sequence[TipSpec | None], tolerance: float, **flags: typing.Any) -> None: ...
    @property
    def body(self) -> CrackedMesh:
        """The CrackedMesh."""

    @property
    def num_heaviside(self) -> int:
        """The number of Heaviside functions of one component."""

    @property
    def order(self) -> int:
        """The order k of the functions φ_i."""

    @property
    def scalar_space(self) -> ngsolve.comp.FESpace:
        """The scalar space of the functions φ_i."""

    @property
    def tip_specs(self) -> list[TipSpec | None]:
        """For each of body.tips its TipSpec, or None where there are no tip functions."""

class CrackBilinearForm(ngsolve.comp.BilinearForm):
    """NGSolve's BilinearForm on a CrackFESpace, with the rows of the tip functions, as long as their disks are large, written directly:
    the same matrix, assembled faster. Flags as for BilinearForm, but for those that choose another storage."""

    def __init__(self, space: CrackFESpace, name: str = "crack_form", **flags: typing.Any) -> None: ...

class CurveNodes:
    """Nodes on the cracks, crack by crack, in the order of arc length: one list of arc lengths, increasing, and one of weights for each."""

    @typing.overload
    def __init__(self, nodes: CurveNodes) -> None: ...
    @typing.overload
    def __init__(
        self,
        body: CrackedMesh,
        arclengths: collections.abc.Sequence[collections.abc.Sequence[float]],
        weights: collections.abc.Sequence[collections.abc.Sequence[float]],
    ) -> None: ...
    def __len__(self) -> int:
        """The number of nodes."""

    @property
    def arclengths(self) -> numpy.ndarray:
        """Array (n,): of each node the arc length on its crack."""

    @property
    def body(self) -> CrackedMesh:
        """The CrackedMesh."""

    @property
    def cracks(self) -> numpy.ndarray:
        """Array (n,): of each node the number of its crack."""

    @property
    def neighbours(self) -> numpy.typing.NDArray[numpy.uint64]:
        """Array (k, 2): the numbers of two nodes beside each other on a crack."""

    @property
    def positions(self) -> numpy.typing.NDArray[numpy.float64]:
        """Array (n, 2): the points."""

    @property
    def weights(self) -> numpy.ndarray:
        """Array (n,): ∫ψ_i, the length of the cracks that belongs to each node."""

class TraceSpace(ngsolve.comp.FESpace):
    """The space of multipliers on the cracks; ngsxfem_contact.TraceSpace builds it from a name."""

    def __init__(self, body: CrackedMesh, basis: TraceBasis, order: int) -> None: ...
    @property
    def basis(self) -> TraceBasis:
        """The TraceBasis."""

    @property
    def body(self) -> CrackedMesh:
        """The CrackedMesh."""

    @property
    def dcrack(self) -> CutDifferentialSymbol:
        """The measure on the cracks, its rules divided where the intervals of this space end."""

    @property
    def order(self) -> int:
        """The order of the functions."""

class TraceBasis:
    """The functions of a TraceSpace, and where they live."""

    def Nodes(self) -> CurveNodes:
        """The points of the Lagrange functions of this order on the intervals, as CurveNodes: of order 0 their middles."""

    @property
    def division(self) -> list[list[float]]:
        """Arc lengths that divide each crack into intervals, from 0 to its length."""

    @property
    def ndof(self) -> int:
        """The number of functions."""

class NodalTraceBasis(TraceBasis):
    """Lagrange functions: order 0 one constant for each interval, order j ≥ 1 continuous, at Gauss-Lobatto points."""

    def __init__(self, body: CrackedMesh, order: int, division: collections.abc.Sequence[collections.abc.Sequence[float]]) -> None: ...

class MeshTraceBasis(TraceBasis):
    """Restrictions to the cracks of the P_j functions of the mesh, but for those of the numbers left_out, on which the others must not depend."""

    def __init__(
        self, body: CrackedMesh, order: int, division: collections.abc.Sequence[collections.abc.Sequence[float]], left_out: collections.abc.Set[int]
    ) -> None: ...

class LinearSheetTraceSpace(ngsolve.comp.FESpace):
    """Multipliers of order 1 on the sheets of a body in space; ngsxfem_contact.TraceSpace builds it."""

    def __init__(self, body: CrackedSolid) -> None: ...
    @property
    def body(self) -> CrackedSolid:
        """The CrackedSolid."""

    @property
    def neighbours(self) -> list[typing.Annotated[list[int], "FixedSize(2)"]]:
        """Pairs of nodes that a side of a polygon joins."""

    @property
    def positions(self) -> list[typing.Annotated[list[float], "FixedSize(3)"]]:
        """The nodes: the points (x, y, z) in which planes of sheets cut edges of the mesh."""

    @property
    def sheets(self) -> list[int]:
        """Of each node the number of its sheet."""

class FrontSpec:
    """What a space of a solid needs to know of its fronts; FrontEnrichment makes it."""

    def __init__(self, materials: collections.abc.Sequence[tuple[float, float]], rules: FrontDemand) -> None: ...
    @property
    def materials(self) -> list[tuple[float, float]]:
        """(kappa, mu) of the modes of each of body.fronts."""

    @property
    def rules(self) -> FrontDemand:
        """The FrontDemand; nodes nearer to a front than its radius have modes, too."""

class SolidFESpace(ngsolve.comp.FESpace):
    """The enriched space of a body in space; ngsxfem_contact.CrackFESpace builds it. Unknowns in this order: φ_i for x, for y, for z, ½(H - s_i) φ_i for x, for y,
    for z, and for each node with modes those of K_I, K_II, K_III."""

    def BoundaryDofs(self) -> list[tuple[numpy.ndarray, numpy.ndarray]]:
        """For each boundary region one array for each component: its unknowns with a trace on the region."""

    def FrontDof(self, j: int, mode: int) -> int:
        """The number of the unknown of the j-th node with modes, mode 0 (I), 1 (II) or 2 (III)."""

    def Heaviside(self, j: int) -> tuple[int, int]:
        """(i, s_i): the number of the j-th enriched function φ_i, and the side on which its copy sees the largest part of the support."""

    def HeavisideCrack(self, j: int) -> int:
        """The number of the crack at which it jumps, of the largest one of several."""

    def HeavisideDof(self, j: int, component: int) -> int:
        """The number of the unknown of the j-th Heaviside function, component 0 (x), 1 (y), ..."""

    def HeavisideFactors(self, j: int, element: int) -> list[int]:
        """By how much φ_i is multiplied in the j-th Heaviside function, ±1 or 0, on each part of an element. Raises an Exception outside of the support."""

    def HeldRegions(self, component: int) -> pyngcore.pyngcore.BitArray:
        """The boundary regions (BitArray) on which component 0 (x), 1 (y), ... is fixed."""

    def SetFrontMaterial(self, front: int, kappa: float, mu: float) -> None:
        """Gives the modes of a front the kappa and mu of another material: unknowns and rules stay what they are."""

    def __init__(self, body: CrackedSolid, fronts: FrontSpec | None, **flags: typing.Any) -> None: ...
    @property
    def body(self) -> CrackedSolid:
        """The CrackedSolid."""

    @property
    def front_nodes(self) -> list[tuple[int, int]]:
        """(vertex, front) for each node with modes."""

    @property
    def front_spec(self) -> FrontSpec | None:
        """The FrontSpec, or None where there are no modes."""

    @property
    def num_heaviside(self) -> int:
        """The number of Heaviside functions of one component."""

    @property
    def num_left_out(self) -> int:
        """The number of nodes around fronts without modes: beside corners, where two fronts are near, and where some components of u are held and others are not."""

    @property
    def order(self) -> int:
        """The order k of the functions φ_i."""

    @property
    def scalar_space(self) -> ngsolve.comp.FESpace:
        """The scalar space of the functions φ_i."""

class Domain(_Enumeration):
    """What a measure integrates over: the Bulk of the body or its boundary, the Larger parts of cut elements, or the Crack."""

    Bulk: typing.ClassVar[Domain]
    Crack: typing.ClassVar[Domain]
    Larger: typing.ClassVar[Domain]
    __members__: typing.ClassVar[dict[str, Domain]]

class FormTerm:
    """One integral of a form: its measure, and which functions of which spaces it holds."""

    @property
    def body(self) -> typing.Any:
        """The CrackedMesh of its measure; None for a measure of NGSolve."""

    @property
    def crack(self) -> int | None:
        """The number of the only crack that it is taken over, or None."""

    @property
    def domain(self) -> Domain:
        """The Domain of its measure."""

    @property
    def element_normal(self) -> bool:
        """Whether it holds NGSolve's normal vector, which is zero inside of elements."""

    @property
    def elements(self) -> pyngcore.pyngcore.BitArray:
        """BitArray of the elements that it is restricted to, or None."""

    @property
    def form(self) -> ngsolve.comp.SumOfIntegrals:
        """The integral as a form."""

    @property
    def integrand(self) -> ngsolve.fem.CoefficientFunction:
        """The function that is integrated."""

    @property
    def on_boundary(self) -> bool:
        """Whether it is taken over the boundary, or an inner interface."""

    @property
    def regions(self) -> pyngcore.pyngcore.BitArray:
        """BitArray of the regions (materials or boundaries) that it is restricted to, or None."""

    @property
    def test(self) -> list[ngsolve.comp.ProxyFunction]:
        """The test functions in it, one for each operator that is applied to them."""

    @property
    def trial(self) -> list[ngsolve.comp.ProxyFunction]:
        """The trial functions in it, one for each operator that is applied to them."""

def BorderedMatrix(
    matrix: ngsolve.la.SparseMatrixd,
    inner: pyngcore.pyngcore.BitArray,
    height: int,
    first: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    row: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """Upper triangle of [A, K^T; K, 0], A on the inner unknowns, in CSR format: (first, column, value). K in CSC format."""

def ElementMatrices(
    form: ngsolve.comp.BilinearForm, elements: typing.Annotated[numpy.typing.ArrayLike, numpy.int32]
) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
    """(matrices, rows, columns) of the volume integrals of a bilinear form, which need not be assembled, on some elements: arrays (n, height, width), and the
    numbers of the test and trial functions; smaller matrices are filled up with zeros, numbers with -1."""

def ElementOrder(space: ngsolve.comp.FESpace) -> numpy.typing.NDArray[numpy.int32]:
    """The unknowns of a space of NGSolve, an array, in the order in which the elements name them first; those of no element are left out."""

@typing.overload
def ElementsBeside(mesh: ngsolve.comp.Mesh, crack: Crack) -> list[int]:
    """Numbers of the elements of a mesh that a crack may meet, by boxes around both."""

@typing.overload
def ElementsBeside(mesh: ngsolve.comp.Mesh, sheet: Sheet) -> list[int]:
    """The same of a sheet, by its box and the heights of corners."""

def FromCSR(
    first: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    column: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    width: int,
) -> ngsolve.la.BaseMatrix:
    """A sparse matrix of NGSolve from one in CSR format, the columns of each row in ascending order."""

def FunctionOf(functional: ngsolve.fem.PointEvaluationFunctional) -> ngsolve.fem.CoefficientFunction:
    """The function v of an evaluation such as v(x, y)."""

def GridFunctionOf(function: ngsolve.comp.GridFunctionCoefficientFunction) -> ngsolve.comp.GridFunction:
    """The GridFunction that a function such as Grad(u) or Jump(u) is an operator of."""

def InnerIntegrals(form: ngsolve.comp.SumOfIntegrals, elements: pyngcore.pyngcore.BitArray) -> ngsolve.comp.SumOfIntegrals:
    """The integrals of a form over the body and its cracks, without those over its boundary, on some elements (BitArray)."""

def IntegralsOn(
    form: ngsolve.comp.SumOfIntegrals, elements: pyngcore.pyngcore.BitArray, boundary_elements: pyngcore.pyngcore.BitArray
) -> ngsolve.comp.SumOfIntegrals:
    """The integrals of a form on some elements of the mesh and of its boundary (BitArrays)."""

def IsTestFunction(proxy: ngsolve.comp.ProxyFunction) -> bool:
    """Whether a trial or test function is a test function."""

def NameOf(function: ngsolve.fem.CoefficientFunction) -> str:
    """What NGSolve calls a function, such as 'normal vector'."""

def NumKeptRules(body: CrackedMesh) -> int:
    """How many sets of rules of a body, for different disks around its tips, spaces, measures and forms keep."""

def NumNegativePivots(factors: ngsolve.la.BaseMatrix) -> int:
    """Number of negative eigenvalues of a factorised matrix; -1: a pivot is not finite."""

def NumbersOfVertices(mesh: ngsolve.comp.Mesh) -> numpy.typing.NDArray[numpy.int64]:
    """The numbers, an array, that the vertices of a mesh of several processes had in the mesh that was distributed."""

def OperatorName(proxy: ngsolve.comp.ProxyFunction) -> str:
    """The name of the operator of a trial or test function: Id, grad, plus, minus, jump, gradlarger, ..."""

def OperatorOf(function: ngsolve.comp.GridFunctionCoefficientFunction) -> str | None:
    """The name of the operator that a function is of its GridFunction, 'deriv' for Deriv(); None where NGSolve does not know."""

def PointOf(functional: ngsolve.fem.PointEvaluationFunctional) -> tuple[float, float]:
    """The point (x, y) of an evaluation such as v(x, y) in a linear form."""

def SchurComplement(
    factors: ngsolve.la.BaseMatrix,
    height: int,
    first: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    row: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]:
    """K inv(A) K^T, dense, from sparsecholesky factors of A and K in CSC format."""

@typing.overload
def StressPower(
    space: CrackFESpace, lam: ngsolve.fem.CoefficientFunction, mu: ngsolve.fem.CoefficientFunction, measure: CutDifferentialSymbol
) -> ngsolve.fem.BFI:
    """∫ σ(u):ε(v) for a bilinear form on a CrackFESpace, σ = lam tr(ε) I + 2 mu ε: an integrator for form += ..., the same as the symbolic form, assembled faster."""

@typing.overload
def StressPower(
    space: SolidFESpace, lam: ngsolve.fem.CoefficientFunction, mu: ngsolve.fem.CoefficientFunction, measure: CutDifferentialSymbol
) -> ngsolve.fem.BFI:
    """The same in space."""

def TermsOf(form: ngsolve.comp.SumOfIntegrals) -> list[FormTerm]:
    """The FormTerms of a form, one for each integral."""

def TipModeGradient(
    crack: Crack, point: tuple[float, float], ahead: tuple[float, float], plus_sign: int, side: int, mode: int, kappa: float, mu: float
) -> ngsolve.fem.CoefficientFunction:
    """∂_j u_i of the field of unit K_I (mode 0) or K_II (mode 1) at a tip, a 2 x 2 CoefficientFunction. θ has the sign plus_sign on the plus side behind the tip."""

def Variation(form: ngsolve.comp.SumOfIntegrals) -> ngsolve.comp.SumOfIntegrals:
    """An energy whose first and second variations NGSolve's BilinearForm applies, linearises and assembles, over measures of a CrackedMesh or of NGSolve."""
