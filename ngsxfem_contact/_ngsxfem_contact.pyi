# By tools/stubs.py.

from __future__ import annotations
import collections.abc
import ngsolve.comp
import ngsolve.fem
import ngsolve.la
import numpy
import numpy.typing
import pyngcore.pyngcore
import typing

__all__: list[str] = [
    "BorderedMatrix",
    "Crack",
    "CrackBilinearForm",
    "CrackEnd",
    "CrackFESpace",
    "CrackedMesh",
    "CutDifferentialSymbol",
    "CutOff",
    "Degeneracy",
    "ElementKind",
    "ElementLocation",
    "EndKind",
    "InnerIntegrals",
    "MeshTraceBasis",
    "NodalTraceBasis",
    "NumNegativePivots",
    "Piece",
    "SchurComplement",
    "Side",
    "Tip",
    "TipBasis",
    "TipSpec",
    "TraceBasis",
    "TraceSpace",
    "Variation",
]

class CutDifferentialSymbol(ngsolve.comp.DifferentialSymbol):
    def Points(self, order: int) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray, numpy.ndarray, numpy.ndarray, numpy.ndarray]:
        """
        Arrays: element, reference coordinates xi and eta, weight, x, y of the points of a rule of this order.
        """

    def PrepareRules(self, order: int) -> None:
        """
        Makes the rules of this order now, which are otherwise made when they are first used, and kept.
        """

    def __call__(
        self,
        definedon: ngsolve.comp.Region | str | None = None,
        bonus_intorder: int = 0,
        definedonelements: pyngcore.pyngcore.BitArray | None = None,
        crack: int | None = None,
        nodes: collections.abc.Sequence[collections.abc.Sequence[float]] | None = None,
    ) -> CutDifferentialSymbol:
        """
        The same measure, restricted to a region or to elements or to one crack, with higher order, or with rules on the cracks divided at arc lengths (one list for each crack).
        """

    def __rmul__(self, arg0: float) -> ngsolve.comp.SumOfIntegrals: ...

class Side:
    """
    The side of a crack: Plus to the left of its direction of travel, Minus to the right.

    Members:

      Minus

      Plus
    """

    Minus: typing.ClassVar[Side]
    Plus: typing.ClassVar[Side]
    __members__: typing.ClassVar[dict[str, Side]]

    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Crack:
    """
    An oriented curve: Crack(points) a polyline, Crack.Arc, Crack.Spline, Crack.Curve and Crack.LevelSet true curves. Its normal points to the left of the direction of travel, from the minus to the plus side.
    """

    @staticmethod
    def Arc(start: tuple[float, float], through: tuple[float, float], end: tuple[float, float]) -> Crack:
        """
        The circular arc from start to end through a third point. Raises an Exception for three points on a line.
        """

    @staticmethod
    def Curve(function, t0, t1, tolerance=1e-12, max_pieces=4096):
        """
        The curve function(t), t from t0 to t1, as a C² cubic spline that deviates by less than tolerance × its length.

            function: of a number, two coordinates; smooth, with a derivative that does not vanish. (Cut it at kinks, and use Crack.Join.)
            Raises ValueError if max_pieces pieces do not reach the tolerance.

        """

    @staticmethod
    def Join(*args) -> Crack:
        """
        Cracks end to end as one: a kink where the direction jumps. Raises an Exception for a gap.
        """

    @staticmethod
    def LevelSet(mesh, phi, psi=None, tolerance=1e-10, max_points=4096):
        """
        The crack {φ = 0, ψ < 0} of CoefficientFunctions or GridFunctions; n points to φ > 0.

            The signs of φ at the vertices lead from element to element; points of φ = 0 are found to round-off, and a spline
            through them deviates from φ = 0 by less than tolerance × its length. Straight ones become segments.
            The crack ends where ψ = 0, or on ∂Ω (psi=None: only there).
            Raises ValueError if there is no or more than one branch, a closed one, or if the tolerance is not reached:
            zero sets of P_k functions have kinks on the mesh's edges, so ask for a tolerance that fits them.

        """

    @staticmethod
    def OfPieces(pieces: collections.abc.Sequence[tuple[str, collections.abc.Sequence[tuple[float, float]]]]) -> Crack:
        """
        Pieces (kind, points): ('segment', [a, b]), ('arc', [start, through, end]), ('cubic', [p0, d0, p1, d1]) with values and derivatives at t = 0 and 1.
        """

    @staticmethod
    def Spline(points, ends="not-a-knot"):
        """
        The C² cubic spline through points (n, 2), by chord length: the curve itself is the crack, not a polyline.

            ends: "not-a-knot" or "natural" (no curvature at the ends). Two points give a segment.
            Raises ValueError for repeated points, Exception for a curve that meets itself.

        """

    def ArcLength(self, point: tuple[float, float]) -> float:
        """
        Arc length of the nearest point of the crack.
        """

    def CurvatureAt(self, s: float) -> float:
        """
        The curvature at arc length s, > 0 where the crack turns left.
        """

    def Distance(self, point: tuple[float, float]) -> float:
        """
        Distance to the nearest point of the crack.
        """

    def Outline(self, turn: float = 0.05) -> list[tuple[float, float]]:
        """
        Points for pictures: a polyline that follows the crack, with kinks of about the angle turn where it is curved.
        """

    def PointAt(self, s: float) -> tuple[float, float]:
        """
        The point at arc length s.
        """

    def SideOf(self, point: tuple[float, float]) -> Side: ...
    def TangentAt(self, s: float) -> tuple[float, float]:
        """
        The unit tangent at arc length s.
        """

    def __init__(self, points: collections.abc.Sequence[tuple[float, float]]) -> None: ...
    @property
    def kinks(self) -> list[float]:
        """
        Arc lengths at which the direction jumps; of a polyline all inner points.
        """

    @property
    def length(self) -> float: ...
    @property
    def pieces(self) -> list[tuple[str, list[tuple[float, float]]]]:
        """
        What OfPieces takes.
        """

    @property
    def points(self) -> list[tuple[float, float]]:
        """
        The points of a polyline; of a curve the ends of its pieces.
        """

    @property
    def side(self) -> ngsolve.fem.CoefficientFunction:
        """
        H: +1 on the plus side, -1 on the minus side, a CoefficientFunction.
        """

class ElementKind:
    """
    How a crack meets an element: Uncut, Cut through, Tip inside, or Aligned with an edge that the element carries.

    Members:

      Uncut

      Cut

      Tip

      Aligned
    """

    Aligned: typing.ClassVar[ElementKind]
    Cut: typing.ClassVar[ElementKind]
    Tip: typing.ClassVar[ElementKind]
    Uncut: typing.ClassVar[ElementKind]
    __members__: typing.ClassVar[dict[str, ElementKind]]

    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Degeneracy:
    @property
    def along_edge(self) -> bool: ...
    @property
    def kink_inside(self) -> bool: ...
    @property
    def through_vertex(self) -> bool: ...
    @property
    def tip_on_edge(self) -> bool: ...
    @property
    def tip_on_vertex(self) -> bool: ...

class Piece:
    @property
    def curved(self) -> tuple[float, float] | None:
        """
        Arc lengths between which the side opposite of corner 0 is a part of the crack, or None.
        """

    @property
    def side(self) -> Side: ...
    @property
    def triangle(self) -> typing.Annotated[list[tuple[float, float]], "FixedSize(3)"]: ...

class ElementLocation:
    @property
    def arclength(self) -> tuple[float, float]: ...
    @property
    def area_minus(self) -> float: ...
    @property
    def area_plus(self) -> float: ...
    @property
    def chords(self) -> list[tuple[float, float]]:
        """
        Arc lengths between which the crack is in the element.
        """

    @property
    def degeneracy(self) -> Degeneracy: ...
    @property
    def element(self) -> int: ...
    @property
    def h(self) -> float:
        """
        longest edge
        """

    @property
    def kind(self) -> ElementKind: ...
    @property
    def larger(self) -> Side: ...
    @property
    def pieces(self) -> list[Piece]: ...
    @property
    def triangle(self) -> typing.Annotated[list[tuple[float, float]], "FixedSize(3)"]: ...

class EndKind:
    """
    An end of a crack: a Tip inside the body or a Mouth on its boundary.

    Members:

      Tip

      Mouth
    """

    Mouth: typing.ClassVar[EndKind]
    Tip: typing.ClassVar[EndKind]
    __members__: typing.ClassVar[dict[str, EndKind]]

    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class CrackEnd:
    @property
    def kind(self) -> EndKind: ...
    @property
    def point(self) -> tuple[float, float]: ...
    @property
    def s(self) -> float: ...

class Tip:
    """
    A crack end inside the body: point, crack number, direction ahead, and the clearance that a disk of singular functions has.
    """

    @property
    def ahead(self) -> tuple[float, float]: ...
    @property
    def clearance(self) -> float: ...
    @property
    def crack(self) -> int: ...
    @property
    def limit(self) -> str: ...
    @property
    def point(self) -> tuple[float, float]: ...
    @property
    def s(self) -> float: ...

class CrackedMesh:
    """
    A mesh with cracks. dx: Omega without the cracks; ds: its boundary, both sides at a mouth; dcrack: the cracks; dlarger: the larger part of each element that a crack meets.
    """

    def CrackElements(self, crack: int | None) -> pyngcore.pyngcore.BitArray:
        """
        BitArray of the elements that carry a part of a crack (None: of any).
        """

    def CutBoundaryElements(self, crack: int) -> list[int]: ...
    def Elements(self, crack: int) -> list[ElementLocation]:
        """
        The elements that a crack meets.
        """

    def Ends(self, crack: int) -> typing.Annotated[list[CrackEnd], "FixedSize(2)"]: ...
    def MeshNodes(self, crack: int, kinks: bool) -> list[float]:
        """
        Arc lengths at which the crack meets mesh edges, and of its ends (and kinks).
        """

    def OnCrack(self, crack: int, arclengths: collections.abc.Sequence[float]) -> tuple:
        """
        Element numbers and reference coordinates of points on a crack.
        """

    def __init__(self, mesh: ngsolve.comp.Mesh, *args) -> None: ...
    @property
    def cracks(self) -> list[Crack]: ...
    @property
    def dcrack(self) -> CutDifferentialSymbol: ...
    @property
    def dlarger(self) -> CutDifferentialSymbol: ...
    @property
    def ds(self) -> CutDifferentialSymbol: ...
    @property
    def dx(self) -> CutDifferentialSymbol: ...
    @property
    def mesh(self) -> ngsolve.comp.Mesh: ...
    @property
    def normal(self) -> ngsolve.fem.CoefficientFunction: ...
    @property
    def tangent(self) -> ngsolve.fem.CoefficientFunction: ...
    @property
    def tips(self) -> list[Tip]: ...

class CutOff:
    """
    Members:

      cubic

      quintic
    """

    __members__: typing.ClassVar[dict[str, CutOff]]
    cubic: typing.ClassVar[CutOff]
    quintic: typing.ClassVar[CutOff]

    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class TipBasis:
    """
    Members:

      branch

      modes
    """

    __members__: typing.ClassVar[dict[str, TipBasis]]
    branch: typing.ClassVar[TipBasis]
    modes: typing.ClassVar[TipBasis]

    def __index__(self) -> int: ...
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class TipSpec:
    def __init__(self, basis: TipBasis, cutoff: CutOff, r0: float, r1: float, kappa: float, mu: float) -> None: ...
    @property
    def basis(self) -> TipBasis: ...
    @property
    def cutoff(self) -> CutOff: ...
    @property
    def kappa(self) -> float: ...
    @property
    def mu(self) -> float: ...
    @property
    def r0(self) -> float: ...
    @property
    def r1(self) -> float: ...

class CrackFESpace(ngsolve.comp.FESpace):
    def Heaviside(self, j: int) -> tuple[int, int]:
        """
        Number i of the j-th enriched function phi_i, and its shift s_i.
        """

    def HeavisideDof(self, j: int, component: int) -> int: ...
    def HeavisideSide(self, j: int, element: int) -> int: ...
    def TipDofs(self, tip: int) -> list[int]: ...
    def __init__(self, body: CrackedMesh, tips: collections.abc.Sequence[TipSpec | None], tolerance: float, **kwargs) -> None: ...
    @property
    def body(self) -> CrackedMesh: ...
    @property
    def num_heaviside(self) -> int: ...
    @property
    def order(self) -> int: ...
    @property
    def scalar_space(self) -> ngsolve.comp.FESpace:
        """
        The space of the functions phi_i.
        """

    @property
    def tip_specs(self) -> list[TipSpec | None]: ...

class CrackBilinearForm(ngsolve.comp.BilinearForm):
    """
    NGSolve's BilinearForm on a CrackFESpace, with the rows of the tip functions, as long as their disks are large, written directly:
    the same matrix, assembled faster. Flags as for BilinearForm, but for those that choose another storage.
    """

    def __init__(self, space: CrackFESpace, name: str = "crack_form", **kwargs) -> None: ...

class TraceSpace(ngsolve.comp.FESpace):
    def __init__(self, body: CrackedMesh, basis: TraceBasis, order: int) -> None: ...
    @property
    def basis(self) -> TraceBasis: ...
    @property
    def body(self) -> CrackedMesh: ...
    @property
    def dcrack(self) -> CutDifferentialSymbol:
        """
        The measure on the cracks, its rules divided at the nodes of this space.
        """

    @property
    def order(self) -> int: ...

class TraceBasis:
    @property
    def ndof(self) -> int: ...
    @property
    def nodes(self) -> list[list[float]]: ...

class NodalTraceBasis(TraceBasis):
    def DofPositions(self, crack: int) -> list[float]: ...
    def __init__(self, body: CrackedMesh, order: int, nodes: collections.abc.Sequence[collections.abc.Sequence[float]]) -> None: ...

class MeshTraceBasis(TraceBasis):
    def __init__(
        self, body: CrackedMesh, order: int, nodes: collections.abc.Sequence[collections.abc.Sequence[float]], left_out: collections.abc.Set[int]
    ) -> None: ...

def BorderedMatrix(
    matrix: ngsolve.la.SparseMatrixd,
    inner: pyngcore.pyngcore.BitArray,
    height: int,
    first: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    row: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> tuple:
    """
    Upper triangle of [A, K^T; K, 0], A on the inner unknowns, in CSR format: (first, column, value). K in CSC format.
    """

def InnerIntegrals(form: ngsolve.comp.SumOfIntegrals, elements: pyngcore.pyngcore.BitArray) -> ngsolve.comp.SumOfIntegrals:
    """
    The integrals of a form over the body and its cracks, without those over its boundary, on some elements (BitArray).
    """

def NumNegativePivots(factors: ngsolve.la.BaseMatrix) -> int:
    """
    Number of negative eigenvalues of a factorised matrix; -1: a pivot is not finite.
    """

def SchurComplement(
    factors: ngsolve.la.BaseMatrix,
    height: int,
    first: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    row: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    value: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]:
    """
    K inv(A) K^T, dense, from sparsecholesky factors of A and K in CSC format.
    """

def Variation(form: ngsolve.comp.SumOfIntegrals) -> ngsolve.comp.SumOfIntegrals:
    """
    An energy whose first and second variations NGSolve's BilinearForm applies, linearises and assembles, over measures of a CrackedMesh or of NGSolve.
    """
