"""Curved cracks from points, parametrised curves and level sets: Crack.Spline, Crack.Curve, Crack.LevelSet."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import scipy
from ngsolve import CoefficientFunction, Mesh

from ._ngsxfem_contact import Crack
from .arguments import check_function, check_number, check_positive, check_type

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

ENDS = ("not-a-knot", "natural")
# Annotations are values here: tools/stubs.py reads them.
Point: TypeAlias = Sequence[float]
Points: TypeAlias = Sequence[Point] | np.ndarray


def of_spline(spline: "CubicSpline", name: str = "") -> Crack:
    """The Crack along a scipy CubicSpline with two components."""
    t, p, d = spline.x, spline(spline.x), spline(spline.x, 1)
    h = np.diff(t)[:, None]
    pieces = np.stack([p[:-1], h * d[:-1], p[1:], h * d[1:]], axis=1)
    return Crack.OfPieces([("cubic", [(float(x), float(y)) for x, y in piece]) for piece in pieces], name)


def checked(points: Points, name: str) -> np.ndarray:
    """Points as an array (n, 2); raises ValueError for what is none, and for coordinates that are not finite."""
    try:
        array = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {points!r} are no points (x, y)") from None
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 2:
        raise ValueError(f"{name}: give at least two points (x, y), got an array of shape {array.shape}")
    if not np.isfinite(array).all():
        i = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise ValueError(f"{name}: point {i} is {tuple(array[i].tolist())}; coordinates must be finite")
    return array


def spline(points: Points, ends: str = "not-a-knot", name: str = "") -> Crack:
    """The C² cubic spline through points (n, 2), by chord length: the curve itself is the crack, not a polyline.

    Parameters
    ----------
    points : (n, 2)
        Two give a segment.
    ends
        "not-a-knot" or "natural" (no curvature at the ends). Two points give a segment.
    name
        Of the crack.

    Raises
    ------
    ValueError
        For repeated points.
    Exception
        For a curve that meets itself.
    """
    points = checked(points, "Crack.Spline")
    if ends not in ENDS:
        raise ValueError(f"Crack.Spline: ends={ends!r} is not one of {ENDS}")
    chords = np.hypot(*np.diff(points, axis=0).T)
    if chords.min() <= 1e-10 * chords.sum():
        i = int(np.argmin(chords))
        raise ValueError(f"Crack.Spline: points {i} and {i + 1} coincide at {tuple(points[i].tolist())}; remove one of them")
    if len(points) == 2:
        return Crack([tuple(p) for p in points.tolist()], name)
    return of_spline(scipy.interpolate.CubicSpline(np.concatenate([[0], np.cumsum(chords)]), points, bc_type=ends), name)


def curve(function: Callable[[float], Point], t0: float, t1: float, tolerance: float = 1e-7, max_pieces: int = 4096, name: str = "") -> Crack:
    """The curve function(t), t from t0 to t1, as a C² cubic spline that deviates by less than tolerance × its length.

    Parameters
    ----------
    function
        Of a number, two coordinates; smooth, with a derivative that does not vanish. (Cut it at kinks, and use Crack.Join.)
    t0 : float
        Where the curve begins.
    t1 : float
        Where it ends.
    tolerance
        The energy changes by about as much, relatively. The default is far below what a mesh of P2 with 1e4 elements resolves; a smaller one costs
        pieces, tolerance^(-1/4).
    max_pieces : int
        The largest number of cubics.
    name : str
        Of the crack.

    Raises
    ------
    ValueError
        If max_pieces pieces do not reach the tolerance.
    """
    check_type(function, Callable, "Crack.Curve: function", "a function of a number that returns two coordinates")
    check_number(t0, "Crack.Curve: t0")
    check_number(t1, "Crack.Curve: t1", lambda t1: t0 < t1 < float("inf"), f"be finite and larger than t0={t0}")
    check_positive(tolerance, "Crack.Curve: tolerance")
    at = lambda t: checked([function(float(ti)) for ti in t], "Crack.Curve")
    t = np.linspace(t0, t1, 9)
    length = np.hypot(*np.diff(at(t), axis=0).T).sum()
    try:
        return of_spline(fitted(at, t, tolerance * length, max_pieces), name)
    except NotFitted as failed:
        raise ValueError(
            f"Crack.Curve: {failed.pieces} cubics deviate by {failed.error / length:.1e}, more than tolerance={tolerance:g} × length; "
            "the curve must be smooth (join pieces at its kinks), or allow a larger tolerance"
        ) from None


class NotFitted(Exception):
    """A spline with as many pieces as allowed deviates by an error."""

    def __init__(self, pieces: int, error: float) -> None:
        self.pieces, self.error = pieces, error


def fitted(at: Callable[[np.ndarray], np.ndarray], t: np.ndarray, tolerance: float, max_pieces: int) -> "CubicSpline":
    """The CubicSpline through points at(t) that deviates by less than the tolerance, its intervals, at first t, divided as often as that takes.

    Raises
    ------
    NotFitted
        If that is more than max_pieces, or an interval shorter than that many equal ones.
    """
    shortest = (t[-1] - t[0]) / max_pieces
    while True:
        spline = scipy.interpolate.CubicSpline(t, at(t))
        middle = 0.5 * (t[1:] + t[:-1])
        off, tangent = at(middle) - spline(middle), spline(middle, 1)
        errors = np.abs(off[:, 0] * tangent[:, 1] - off[:, 1] * tangent[:, 0]) / np.hypot(*tangent.T)
        if errors.max() <= tolerance:
            return spline
        parts = np.ceil(1.05 * (errors / tolerance) ** 0.25).astype(int).clip(1, max_pieces)  # the error is of fourth order
        if parts.sum() > max_pieces or (np.diff(t) / parts).min() < shortest:
            raise NotFitted(len(t) - 1, errors.max())
        t = np.concatenate([*(np.linspace(a, b, n, endpoint=False) for a, b, n in zip(t, t[1:], parts)), t[-1:]])


def level_set(
    mesh: Mesh, phi: CoefficientFunction, psi: CoefficientFunction | None = None, tolerance: float | None = None, max_points: int = 4096, name: str = ""
) -> Crack:
    """The crack {φ = 0, ψ < 0} of CoefficientFunctions or GridFunctions; n points to φ > 0.

    The signs of φ at the vertices lead from element to element; points of φ = 0 are found to round-off, and a spline through some of them deviates from φ
    = 0 by less than tolerance × its length; default: 1e-6 of the size of the elements that it meets, far below what they resolve. Straight ones become
    segments. The crack ends where ψ = 0, or on ∂Ω (psi=None: only there).

    Parameters
    ----------
    mesh : Mesh
        Of NGSolve.
    phi : CoefficientFunction or GridFunction
        φ, zero on the crack.
    psi : CoefficientFunction or GridFunction
        ψ, negative on the crack; None: the crack goes on to ∂Ω.
    tolerance : float
        Relative to the length; default 1e-6 of the size of the elements that the crack meets.
    max_points : int
        The largest number of points of the spline.
    name : str
        Of the crack.

    Raises
    ------
    ValueError
        If there is no or more than one branch, a closed one, or if the tolerance is not reached: zero sets of P_k functions have kinks on the mesh's
        edges, so ask for a tolerance that fits them.
    """
    check_type(mesh, Mesh, "Crack.LevelSet: mesh", "a Mesh of NGSolve")
    if tolerance is not None:
        check_positive(tolerance, "Crack.LevelSet: tolerance")
    phi = check_function(phi, "Crack.LevelSet: phi", 1)
    psi = None if psi is None else check_function(psi, "Crack.LevelSet: psi", 1)
    chain = LevelSetChain(mesh, phi, psi).Points()
    length = np.hypot(*np.diff(chain.points, axis=0).T).sum()
    return chain.Fitted(1e-6 * chain.size if tolerance is None else tolerance * length, max_points, name)


class LevelSetChain:
    """Points on φ = 0 in order, φ > 0 to the left."""

    def __init__(self, mesh: Mesh, phi: CoefficientFunction, psi: CoefficientFunction | None) -> None:
        self.mesh, self.phi, self.psi = mesh, phi, psi

    def Value(self, cf: CoefficientFunction, points: np.ndarray) -> np.ndarray:
        """Of a function at points (n, 2); raises ValueError where it is not finite."""
        points = np.asarray(points, dtype=float)
        try:
            values = np.ravel(cf(self.mesh(*points.T)))
        except Exception:
            raise ValueError(
                "Crack.LevelSet: the function is evaluated on straight edges, which leave the body at a curved boundary; take the level set on the mesh before mesh.Curve, or Crack.Curve"
            ) from None
        if not np.isfinite(values).all():
            i = int(np.flatnonzero(~np.isfinite(values))[0])
            raise ValueError(
                f"Crack.LevelSet: {'psi' if cf is self.psi else 'phi'} is {values[i]} at {tuple(points[i].tolist())}; it must be finite in the body"
            )
        return values

    def Points(self) -> "LevelSetChain":
        """Finds them where φ = 0 crosses edges, cut off at ψ = 0."""
        vertices = np.array([v.point for v in self.mesh.vertices])
        edges = np.array([[v.nr for v in edge.vertices] for edge in self.mesh.edges])
        plus = self.Value(self.phi, vertices) >= 0
        crossed = np.flatnonzero(plus[edges[:, 0]] != plus[edges[:, 1]])
        if len(crossed) == 0:
            raise ValueError("Crack.LevelSet: phi has one sign at all vertices of the mesh; there is no crack, or the mesh is too coarse to see it")
        self.size = float(np.median(np.hypot(*(vertices[edges[crossed, 1]] - vertices[edges[crossed, 0]]).T)))
        crossing = dict(zip(crossed.tolist(), self.Roots(vertices[edges[crossed, 0]], vertices[edges[crossed, 1]])))
        neighbours = {edge: [] for edge in crossing}
        for element in self.mesh.Elements():
            pair = [edge.nr for edge in element.edges if edge.nr in crossing]
            if pair:
                neighbours[pair[0]].append(pair[1])
                neighbours[pair[1]].append(pair[0])
        branches = [branch for chain in chains(neighbours) for branch in self.Inside(np.array([crossing[edge] for edge in chain]))]
        if not branches:
            raise ValueError("Crack.LevelSet: psi is nowhere negative on phi = 0, so that no crack is left; the crack is where psi < 0")
        if len(branches) != 1:
            places = "; ".join(f"from {tuple(b[0].round(6).tolist())} to {tuple(b[-1].round(6).tolist())}" for b in branches)
            raise ValueError(f"Crack.LevelSet: {len(branches)} branches of phi = 0, psi < 0 ({places}); choose psi so that one is left")
        self.points = self.Oriented(without_short_chords(branches[0]))
        return self

    def Roots(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Where φ changes its sign between points a and b (n, 2)."""
        positive = self.Value(self.phi, a) >= 0
        lo, hi = np.zeros(len(a)), np.ones(len(a))
        for _ in range(54):
            middle = 0.5 * (lo + hi)
            same = (self.Value(self.phi, a + middle[:, None] * (b - a)) >= 0) == positive
            lo, hi = np.where(same, middle, lo), np.where(same, hi, middle)
        return a + lo[:, None] * (b - a)

    def Project(self, points: np.ndarray, normals: np.ndarray, size: np.ndarray) -> np.ndarray:
        """Points on φ = 0 along the normals, by the secant method."""
        shift, other = np.zeros(len(points)), np.full(len(points), 1e-4) * size
        at = lambda tau: self.Value(self.phi, points + tau[:, None] * normals)
        f, g = at(shift), at(other)
        for _ in range(12):
            with np.errstate(divide="ignore", invalid="ignore"):
                step = np.where(f != g, f * (shift - other) / (f - g), 0)
            other, g, shift = shift, f, shift - np.clip(step, -0.5 * size, 0.5 * size)
            f = at(shift)
        return points + shift[:, None] * normals

    def Inside(self, chain: np.ndarray) -> list[np.ndarray]:
        """The parts of a chain in which ψ < 0, with ends on ψ = 0."""
        if self.psi is None:
            return [chain]
        inside, parts = self.Value(self.psi, chain) < 0, []
        starts = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])) == 1)
        ends = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])) == -1)
        for i, j in zip(starts, ends):
            part = list(chain[i:j])
            if i > 0:
                part.insert(0, self.End(chain[i], chain[i - 1]))
            if j < len(chain):
                part.append(self.End(chain[j - 1], chain[j]))
            parts.append(np.array(part))
        return parts

    def End(self, inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
        """The point of φ = 0 between two points of it at which ψ = 0."""
        size = np.hypot(*(outer - inner))
        normal = np.array([[-(outer - inner)[1], (outer - inner)[0]]]) / size
        at = lambda t: self.Project((inner + t * (outer - inner))[None], normal, size)
        lo, hi = 0.0, 1.0
        for _ in range(50):
            middle = 0.5 * (lo + hi)
            lo, hi = (middle, hi) if self.Value(self.psi, at(middle))[0] < 0 else (lo, middle)
        return at(lo)[0]

    def Oriented(self, points: np.ndarray) -> np.ndarray:
        """φ > 0 lies to the left."""
        i = len(points) // 2
        chord = points[i] - points[i - 1]
        left = 0.5 * (points[i] + points[i - 1]) + 0.05 * np.array([-chord[1], chord[0]])
        return points if self.Value(self.phi, left[None])[0] > 0 else points[::-1]

    def Fitted(self, tolerance: float, max_points: int, name: str) -> Crack:
        """The spline through points of φ = 0 above or below the spline through those on edges, as many as the tolerance takes."""
        points = self.points
        ends = points[[0, -1]]
        direction = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
        if np.abs((points - ends[0]) @ [-direction[1], direction[0]]).max() <= tolerance:
            return Crack([tuple(p) for p in ends.tolist()], name)
        chords = np.hypot(*np.diff(points, axis=0).T)
        t = np.concatenate([[0], np.cumsum(chords)])
        first = scipy.interpolate.CubicSpline(t, points)

        def at(s: np.ndarray) -> np.ndarray:
            inner, tangent = (s > 0) & (s < t[-1]), first(s, 1)  # beside the ends there may be no mesh
            normals = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]
            places = first(s)
            places[inner] = self.Project(places[inner], normals[inner], chords.min())
            return places

        try:
            return of_spline(fitted(at, np.linspace(0, t[-1], max(8, len(t) // 4) + 1), tolerance, max_points), name)
        except NotFitted as failed:
            raise ValueError(
                f"Crack.LevelSet: a spline of {failed.pieces} pieces deviates by {failed.error:.1e}, more than {tolerance:.1e}; "
                "phi = 0 must be smooth (P_k functions have kinks on edges): allow a larger tolerance"
            ) from None


def chains(neighbours: dict[Any, list[Any]]) -> list[list[Any]]:
    """Paths through a graph {node: neighbours} in which every node has one or two; raises ValueError for a closed one."""
    left = set(neighbours)
    paths = []
    for start in [node for node, others in neighbours.items() if len(others) == 1]:
        if start not in left:
            continue
        path, node = [], start
        while node is not None:
            path.append(node)
            left.discard(node)
            node = next((other for other in neighbours[node] if other in left), None)
        paths.append(path)
    if left:
        raise ValueError("Crack.LevelSet: phi = 0 has a closed branch; a crack has two ends: change phi away from the crack")
    return paths


def without_short_chords(points: np.ndarray) -> np.ndarray:
    """Leaves out inner points that are much closer to the one before (or to the end) than usual: they would bend a spline."""
    least = 0.3 * np.median(np.hypot(*np.diff(points, axis=0).T))
    kept = [points[0]]
    for p in points[1:-1]:
        if np.hypot(*(p - kept[-1])) > least and np.hypot(*(p - points[-1])) > least:
            kept.append(p)
    return np.array([*kept, points[-1]])


for name, constructor in (("Spline", staticmethod(spline)), ("Curve", staticmethod(curve)), ("LevelSet", staticmethod(level_set))):
    setattr(Crack, name, constructor)
