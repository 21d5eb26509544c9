"""The body of a part: its mesh, materials, cracks and spaces."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import netgen.meshing
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Integrate, Mesh, ds

from .._ngsxfem_contact import Crack
from ..files import UnreadableFile
from ..material import FORMS, Elasticity
from ..spaces.crack_fespace import CrackFESpace, TipEnrichment
from ..spaces.trace_space import TraceSpace
from .formula import evaluated
from .gmsh import read_gmsh
from .table import Wrong, array, boolean, choice, formula, number, point, points, tables, text, whole

if TYPE_CHECKING:
    from pathlib import Path

    from .._ngsxfem_contact import CrackedMesh
    from ..material import Isotropic
    from .table import Kind, Table

SIDES = ("bottom", "right", "top", "left")
LARGEST = 1000  # elements along a side


# The mesh


def mesh_of(table: Table) -> Mesh:
    """The Mesh of [mesh]: of a file, or of a rectangle."""
    if table.OneOf(("file", "rectangle")) == "rectangle":
        return rectangle(table, **table.Take({"rectangle": array(point, "two corners [[x, y], [x, y]]", 2, 2), "maxh": number}, ["rectangle", "maxh"]))
    values = table.Take({"file": text, "curve": whole})
    mesh = read_mesh(table, values["file"])
    if "curve" in values:
        curve_boundary(table, mesh, values["curve"])
    return mesh


def read_mesh(table: Table, name: str) -> Mesh:
    """A .vol or .msh file, beside the part's file unless its path is absolute."""
    path = table.file.parent / name
    of_gmsh = path.suffix.lower() == ".msh"
    read = read_gmsh if of_gmsh else read_netgen
    if not of_gmsh and not name.endswith((".vol", ".vol.gz")):
        table.Refuse(f"{name!r} must be a mesh of Netgen, .vol or .vol.gz, or of gmsh, .msh", "file")
    if not path.is_file():
        table.Refuse(f"there is no file {path}", "file")
    try:
        mesh = Mesh(read(path))
    except (OSError, UnreadableFile) as error:
        table.Refuse(str(error), "file")
    if mesh.dim != 2 or mesh.ne == 0:
        table.Refuse(f"{path} has no mesh of the plane", "file")
    return mesh


def read_netgen(path: Path) -> netgen.meshing.Mesh:
    """The netgen mesh of a .vol or .vol.gz file. Raises UnreadableFile for what is none, or not a whole one: Netgen's reader does not survive it."""
    try:
        with (gzip.open if path.suffix == ".gz" else open)(path, "rt", encoding="utf-8", errors="replace") as file:
            lines = {line.strip() for line in file}
    except (EOFError, zlib.error) as error:
        raise UnreadableFile(f"{path} is no whole file: {error}") from None
    if not {"mesh3d", "endmesh"} <= lines:
        raise UnreadableFile(f"{path} is no mesh of Netgen, or not a whole one: it lacks a line mesh3d or endmesh")
    mesh = netgen.meshing.Mesh()
    mesh.Load(str(path))
    return mesh


def curve_boundary(table: Table, mesh: Mesh, order: int) -> None:
    """Curves the elements at the boundary. Refuses orders that are none, and files without the geometry that it takes."""
    if not 1 <= order <= 10:
        table.Refuse(f"{order} must lie between 1 and 10", "curve")
    length = lambda: Integrate(CF(1) * ds, mesh)
    straight = length()
    mesh.Curve(order)
    if order > 1 and abs(length() / straight - 1) < 1e-13:
        table.Refuse(
            "no element of the boundary is curved by it: the file holds no curved geometry; save the mesh of an OCCGeometry, or leave the key out", "curve"
        )


def rectangle(table: Table, rectangle: list[list[float]], maxh: float) -> Mesh:
    """An unstructured mesh between two corners; boundaries "bottom", "right", "top", "left"."""
    low, high = rectangle
    if not (low[0] < high[0] and low[1] < high[1]):
        table.Refuse(f"{[low, high]} must be the lower left and the upper right corner", "rectangle")
    size = max(high[0] - low[0], high[1] - low[1])
    if not size / LARGEST <= maxh < float("inf"):
        table.Refuse(f"{maxh} must be positive, and at least {size / LARGEST:g}, a thousandth of the longer side", "maxh")
    geometry = SplineGeometry()
    geometry.AddRectangle(low, high, bcs=SIDES)
    return Mesh(geometry.GenerateMesh(maxh=maxh))


# Materials


def material_of(entries: list[Table], mesh: Mesh) -> Isotropic:
    """The Elasticity of the [[material]] tables, by region where there are several."""
    found = {}
    for table in entries:
        region, material = one_material(table)
        if region is None and len(entries) > 1:
            table.Refuse("the key is missing; each of several materials names its region", "region")
        if region in found:
            table.Refuse(f"{region!r} has a material already", "region")
        found[region] = material
    if list(found) == [None]:
        return found[None]
    with entries[0].Blamed():
        return Elasticity.ByRegion(mesh, {region: material for region, material in found.items() if region is not None})


def one_material(table: Table) -> tuple[str | None, Elasticity]:
    """(region or None, Elasticity)."""
    kinds = {"region": text, "E": number, "nu": number, "lam": number, "mu": number, "form": choice(*FORMS), "alpha": number}
    lame = table.OneOf(("E", "lam")) == "lam"
    needed = ["lam", "mu"] if lame else ["E", "nu", "form"]
    values = table.Take({key: kind for key, kind in kinds.items() if key in needed or key in ("region", "form", "alpha")}, needed)
    region = values.pop("region", None)
    make = MATERIALS[None if lame else values.pop("form")]
    with table.Blamed():
        return region, make(**values)


# By the form; None: from Lamé's coefficients, with the form among the arguments.
MATERIALS: dict[str | None, Callable[..., Elasticity]] = {None: Elasticity, "plane strain": Elasticity.PlaneStrain, "plane stress": Elasticity.PlaneStress}


# Cracks

NAME: dict[str, Kind] = {"name": text}  # of a key that all shapes have


def crack_of(table: Table, mesh: Mesh) -> Crack:
    """The Crack of a table."""
    shape = table.OneOf(SHAPES)
    with table.Blamed():
        return SHAPES[shape](table, mesh)


def polyline(table: Table, mesh: Mesh) -> Crack:
    """Crack([...])."""
    return Crack(pairs(table.Take({"polyline": points} | NAME)["polyline"]), name_of(table))


def arc(table: Table, mesh: Mesh) -> Crack:
    """Crack.Arc."""
    start, through, end = pairs(table.Take({"arc": array(point, "three points: start, a point between, end", 3, 3)} | NAME)["arc"])
    return Crack.Arc(start, through, end, name_of(table))


def spline(table: Table, mesh: Mesh) -> Crack:
    """Crack.Spline."""
    values = table.Take({"spline": points, "ends": text} | NAME)
    return Crack.Spline(pairs(values.pop("spline")), **values)


def curve(table: Table, mesh: Mesh) -> Crack:
    """Crack.Curve, of two formulas in t."""
    two = array(text, "two formulas in t in quotes", 2, 2)
    values = table.Take({"curve": two, "t": array(number, "two numbers [t0, t1]", 2, 2), "tolerance": number, "max_pieces": whole} | NAME, ["curve", "t"])
    coordinates, (t0, t1) = values.pop("curve"), values.pop("t")
    return Crack.Curve(lambda t: tuple(evaluated(text, {"t": t}) for text in coordinates), t0, t1, **values)


def level_set(table: Table, mesh: Mesh) -> Crack:
    """Crack.LevelSet."""
    values = table.Take({"level_set": formula, "psi": formula, "tolerance": number, "max_points": whole} | NAME)
    return Crack.LevelSet(mesh, values.pop("level_set"), **values)


def join(table: Table, mesh: Mesh) -> Crack:
    """Crack.Join of cracks that are written as in [[crack]]."""
    parts = table.Take({"join": tables} | NAME)["join"]
    return Crack.Join(*(crack_of(type(table)(part, f"{table.name}, join {i + 1}", table.file), mesh) for i, part in enumerate(parts)), name=name_of(table))


def name_of(table: Table) -> str:
    """That of a crack, empty if it has none."""
    return table.Convert("name", text) if "name" in table.values else ""


def pairs(rows: Any) -> list[tuple[float, float]]:
    """Points as tuples."""
    return [(x, y) for x, y in rows]


SHAPES = {"polyline": polyline, "arc": arc, "spline": spline, "curve": curve, "level_set": level_set, "join": join}


# Spaces


def displacements(table: Table, body: CrackedMesh, material: Isotropic, held: dict[str, Any]) -> CrackFESpace:
    """The CrackFESpace of [displacement]; held: dirichlet, dirichletx, dirichlety."""
    values = table.Take({"order": whole, "bubble": boolean, "tip": tip_of(table)})
    with table.Blamed():
        return CrackFESpace(body, material=material, **values, **held)


def tip_of(table: Table) -> Kind:
    """The kind of a key that is false, for no tip functions, or a table of what TipEnrichment takes."""
    kinds = {"r0": number, "r1": number, "cutoff": text, "functions": choice("branch"), "tolerance": number, "order": whole}

    def kind(value: Any) -> Any:
        if value is False:
            return None
        if not isinstance(value, dict):
            raise Wrong("false, or a table")
        inner = type(table)(value, f"{table.name}, tip", table.file)
        with inner.Blamed():
            return TipEnrichment(**inner.Take(kinds))

    return kind


def multipliers(table: Table, body: CrackedMesh) -> TraceSpace:
    """The TraceSpace of [multiplier]."""
    values = table.Take({"order": whole, "basis": text})
    with table.Blamed():
        return TraceSpace(body, **values)
