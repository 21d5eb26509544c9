"""A mesh of some triangles with the true curves of its boundary, of which NGSolve gives a process the straight elements only.

Netgen's file of a mesh has for the ends of each boundary element their parameters on the curve, which its Python interface does not give: the mesh of a
process is written, its triangles, boundary elements and points are replaced, it is read, and curved by the geometry of the whole one.
"""

from __future__ import annotations

import pickle
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from netgen.meshing import Mesh as NetgenMesh
from ngsolve import BND, Mesh

from .processes import Processes

if TYPE_CHECKING:
    from collections.abc import Sequence

TRIANGLES, SEGMENTS, POINTS = "surfaceelements", "edgesegmentsgi3", "points"


def rows_of(text: str, name: str) -> list[list[str]]:
    """The words of the lines of a section, below its name and their number."""
    number, *lines = text.partition(f"\n{name}\n")[2].split("\n")
    return [line.split() for line in lines[: int(number or 0)]]


def with_rows(text: str, name: str, rows: Sequence[Sequence[Any]]) -> str:
    """The text with other lines in a section."""
    head, title, tail = text.partition(f"\n{name}\n")
    number, *lines = tail.split("\n")
    return head + title + "\n".join([str(len(rows)), *(" ".join(map(str, row)) for row in rows), *lines[int(number) :]])


@dataclass
class Curves:
    """What a process knows of the curves of a mesh that several share.

    Attributes
    ----------
    order
        Of the curved elements; 1: the mesh is straight, and nothing else is known.
    parameters
        (n, 5) words of each own boundary element: two without meaning here, the parameters of its ends, its curve.
    frame
        The file of one process.
    prefixes
        Region → what comes before the points of a triangle there.
    geometry
        Of Netgen.
    """

    order: int
    parameters: np.ndarray
    frame: str = ""
    prefixes: dict[int, list[str]] | None = None
    geometry: Any = None

    @staticmethod
    def Of(mesh: Mesh, processes: Processes) -> Curves:
        """Those of a mesh. Raises NotImplementedError for a geometry that cannot be sent to other processes."""
        order = int(processes.Max(mesh.GetCurveOrder()))  # that of a process without elements is 1
        processes.Refuse("A curved mesh in space", order > 1 and mesh.dim == 3)
        if order == 1:
            return Curves(1, np.zeros((mesh.GetNE(BND), 5), dtype="<U32"))
        geometry = pickle.loads(processes.FromFirst(processes.Together(lambda: sent(mesh) if processes.is_first else b"")))
        text = saved(mesh.ngmesh)
        frame = next(other for other in processes.Gather(text if mesh.ne else None) if other)
        regions = mesh.ngmesh.Elements2D().NumPy()["index"].astype(int) - 1
        own = {int(region): row[:5] for region, row in zip(regions, rows_of(text, TRIANGLES))}
        prefixes = {region: words for of_one in processes.Gather(own) for region, words in of_one.items()}
        parameters = np.array([row[2:] for row in rows_of(text, SEGMENTS)], dtype="<U32").reshape(-1, 5)
        return Curves(order, parameters, frame, prefixes, geometry)

    def Mesh(self, points: np.ndarray, corners: np.ndarray, regions: np.ndarray, segments: np.ndarray, parameters: np.ndarray) -> Mesh:
        """The curved Mesh of triangles (n, 3) in regions (n,) and boundary elements (m, 2) with their parameters (m, 5), between points (k, 2)."""
        assert self.prefixes is not None
        triangles = [[*self.prefixes[region], *nodes] for region, nodes in zip(regions.tolist(), (corners + 1).tolist())]
        text = with_rows(self.frame, TRIANGLES, triangles)
        text = with_rows(text, SEGMENTS, [[*ends, *words] for ends, words in zip((segments + 1).tolist(), parameters.tolist())])
        text = with_rows(text, POINTS, [[repr(x), repr(y), 0] for x, y in points.tolist()])
        mesh = NetgenMesh(dim=2)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "part.vol").write_text(text, encoding="utf-8")
            mesh.Load(str(Path(folder) / "part.vol"))
        mesh.SetGeometry(self.geometry)
        curved = Mesh(mesh)
        curved.Curve(self.order)
        return curved


def saved(mesh: NetgenMesh) -> str:
    """The file of a mesh."""
    with tempfile.TemporaryDirectory() as folder:
        mesh.Save(str(Path(folder) / "part.vol"))
        return (Path(folder) / "part.vol").read_text(encoding="utf-8")


def sent(mesh: Mesh) -> bytes:
    """The geometry of a mesh, pickled."""
    geometry = mesh.ngmesh.GetGeometry()
    try:
        return pickle.dumps(geometry)
    except Exception as error:
        raise NotImplementedError(
            f"A curved mesh whose geometry, {geometry!r}, cannot be sent to other processes is not supported by several processes: make it by "
            "DistributedMesh(make) of a geometry of netgen.geom2d or netgen.occ, or start the script without mpirun"
        ) from error
