"""Meshes of gmsh, text files of format 2.2 and 4.1: triangles of physical surfaces, boundaries of physical curves."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import netgen.meshing as ngm
import numpy as np

from ..files import UnreadableFile

if TYPE_CHECKING:
    from collections.abc import Sequence

LINE, TRIANGLE, POINT = 1, 2, 15
KINDS = {LINE: "curve", TRIANGLE: "surface"}
Elements: TypeAlias = tuple[dict[int, tuple[float, ...]], list[tuple[int, list[int], int, list[int]]]]  # see format_2
DEFAULT = "default"  # the name of the boundary that no physical curve covers


def read_gmsh(path: Path) -> ngm.Mesh:
    """The netgen mesh of a .msh file.

    Regions and boundaries have the names of their physical groups, or "surface3", "curve3" after the tag of the group, or of the entity where it is in none.
    Raises UnreadableFile for other files and formats, elements that are no triangles, and elements in more than one group.
    """
    sections = read_sections(path)
    version, is_binary, _ = fields(sections, "MeshFormat", path)[0]
    if version not in FORMATS or is_binary != "0":
        raise UnreadableFile(
            f"{path} has gmsh's format {version}{'' if is_binary == '0' else ', binary'}; text of format 2.2 or 4.1 is read: gmsh -save -format msh41"
        )
    try:
        names = {(int(dim), int(tag)): name.strip().strip('"') for dim, tag, name in physical_names(sections)}
        points, elements = FORMATS[version](sections, path)
        return netgen_mesh(points, named(elements, names, path), path)
    except UnreadableFile:
        raise
    except (ValueError, IndexError, KeyError, StopIteration) as error:
        raise UnreadableFile(f"{path} is no whole mesh of gmsh, format {version}: {type(error).__name__} {error}; write it again") from None


def read_sections(path: Path) -> dict[str, list[str]]:
    """Name of a section → its lines."""
    sections, current = {}, None
    for line in Path(path).read_text(encoding="utf-8", errors="replace").splitlines():
        if line.startswith("$End"):
            current = None
        elif line.startswith("$"):
            current = sections.setdefault(line[1:].strip(), [])
        elif current is not None and line.strip():
            current.append(line)
    if current is not None:
        raise UnreadableFile(f"{path} breaks off in section ${list(sections)[-1]}; write it again")
    return sections


def fields(sections: dict[str, list[str]], name: str, path: Path) -> list[list[str]]:
    """The words of the lines of a section."""
    if not sections.get(name):
        raise UnreadableFile(f"{path} has no section ${name}; it is no mesh of gmsh, or not a whole one")
    return [line.split() for line in sections[name]]


def physical_names(sections: dict[str, list[str]]) -> list[list[str]]:
    """(dimension, tag, name in quotes) of the physical groups."""
    return [line.split(maxsplit=2) for line in sections.get("PhysicalNames", ["0"])[1:]]


def format_2(sections: dict[str, list[str]], path: Path) -> Elements:
    """Points by their tags, and (kind, physical tag, tag of the entity, corners) of the elements."""
    points = {int(tag): tuple(map(float, place)) for tag, *place in fields(sections, "Nodes", path)[1:]}
    elements = []
    for _, kind, number, *rest in fields(sections, "Elements", path)[1:]:
        tags, corners = [int(word) for word in rest[: int(number)]], [int(word) for word in rest[int(number) :]]
        elements.append((int(kind), [tags[0]] if tags[0] else [], tags[1], corners))
    return points, elements


def format_4(sections: dict[str, list[str]], path: Path) -> Elements:
    """The same, from blocks of entities."""
    groups = entity_groups(fields(sections, "Entities", path)) if "Entities" in sections else {}
    points, lines = {}, iter(fields(sections, "Nodes", path)[1:])
    for *_, number in lines:
        tags = [int(next(lines)[0]) for _ in range(int(number))]
        points |= {tag: tuple(float(word) for word in next(lines)[:3]) for tag in tags}
    elements, lines = [], iter(fields(sections, "Elements", path)[1:])
    for dim, entity, kind, number in lines:
        for _ in range(int(number)):
            corners = [int(word) for word in next(lines)[1:]]
            elements.append((int(kind), groups.get((int(dim), int(entity)), []), int(entity), corners))
    return points, elements


def entity_groups(lines: list[list[str]]) -> dict[tuple[int, int], list[int]]:
    """(dimension, tag of an entity) → the tags of its physical groups."""
    (numbers, *entities), groups = lines, {}
    dims = [dim for dim, number in enumerate(numbers) for _ in range(int(number))]
    for dim, (tag, *words) in zip(dims, entities, strict=True):
        words = words[3 if dim == 0 else 6 :]  # after a point, or a box
        groups[dim, int(tag)] = [abs(int(word)) for word in words[1 : 1 + int(words[0])]]
    return groups


FORMATS = {"2.2": format_2, "4.1": format_4}


def named(elements: Any, names: dict[tuple[int, int], str], path: Path) -> dict[int, list[tuple[str, list[int]]]]:
    """kind → (name, corners) of its elements."""
    found = {LINE: [], TRIANGLE: []}
    for kind, groups, entity, corners in elements:
        if kind == POINT:
            continue
        if kind not in KINDS:
            raise UnreadableFile(f"{path} has elements of type {kind}; a body is meshed with triangles of first order: Mesh.ElementOrder = 1, no recombination")
        if len(groups) > 1:
            raise UnreadableFile(f"{path}: {KINDS[kind]} {entity} is in {len(groups)} physical groups; leave it in one, whose name it has")
        tag = groups[0] if groups else entity
        found[kind].append((names.get((kind, tag)) if groups else None, tag, corners))
    if not found[TRIANGLE]:
        raise UnreadableFile(f"{path} has no triangles; mesh the surface, and save it: a physical surface, or Mesh.SaveAll = 1")
    return {kind: [(name or f"{KINDS[kind]}{tag}", corners) for name, tag, corners in rows] for kind, rows in found.items()}


def netgen_mesh(points: dict[int, tuple[float, ...]], elements: Any, path: Path) -> ngm.Mesh:
    """The mesh of points by tags and named elements; the body lies to the left of its boundary."""
    triangles = [(name, counterclockwise(corners, points)) for name, corners in elements[TRIANGLE]]
    edges = Counter((a, b) for _, c in triangles for a, b in zip(c, c[1:] + c[:1]))
    check_edges(edges, points, path)
    lines = [(name, directed(corners, edges, path)) for name, corners in elements[LINE]]
    covered = {frozenset(corners) for _, corners in lines}
    if len(covered) < len(lines):
        raise UnreadableFile(f"{path} has elements of curves twice; leave each curve in one physical group")
    lines += [(DEFAULT, edge) for edge in edges if edge[::-1] not in edges and frozenset(edge) not in covered]
    mesh = ngm.Mesh(dim=2)
    number = {tag: mesh.Add(ngm.MeshPoint(ngm.Pnt(*points[tag][:2], 0))) for tag in sorted({tag for _, c in triangles for tag in c})}
    regions, boundaries = (list(dict.fromkeys(name for name, _ in rows)) for rows in (triangles, lines))
    for i in range(1, max(len(regions), len(boundaries)) + 1):
        mesh.Add(ngm.FaceDescriptor(surfnr=i, domin=1, bc=i))
    for i, name in enumerate(regions):
        mesh.SetMaterial(i + 1, name)
    for i, name in enumerate(boundaries):
        mesh.SetBCName(i, name)
    for name, corners in triangles:
        mesh.Add(ngm.Element2D(regions.index(name) + 1, [number[tag] for tag in corners]))
    for name, edge in lines:
        mesh.Add(ngm.Element1D([number[tag] for tag in edge], index=boundaries.index(name) + 1))
    return mesh


def counterclockwise(corners: Sequence[int], points: dict[int, tuple[float, ...]]) -> list[int]:
    """Three corners of a triangle in this order."""
    a, b, c = (np.array(points[tag]) for tag in corners)
    return list(corners) if (b - a)[0] * (c - a)[1] > (b - a)[1] * (c - a)[0] else list(corners)[::-1]


def check_edges(edges: Counter[tuple[int, int]], points: dict[int, tuple[float, ...]], path: Path) -> None:
    """Raises UnreadableFile for triangles that overlap or do not lie in the plane."""
    if any(count > 1 for count in edges.values()):
        raise UnreadableFile(f"{path} has triangles twice; leave each surface in one physical group")
    if np.ptp([points[tag][2] for edge in edges for tag in edge]) > 0:
        raise UnreadableFile(f"{path}: the triangles do not lie in a plane z = constant")


def directed(corners: Sequence[int], edges: Counter[tuple[int, int]], path: Path) -> tuple[int, ...]:
    """The ends of an element of a curve, the body to the left."""
    for edge in (tuple(corners), tuple(corners)[::-1]):
        if edge in edges:
            return edge
    raise UnreadableFile(f"{path}: the element of a curve from node {corners[0]} to {corners[1]} is no edge of a triangle; mesh curve and surface together")
