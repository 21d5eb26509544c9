"""Meshes of gmsh: those in tests/data/gmsh were written by gmsh 4.15, both formats from one model."""

from pathlib import Path

import pytest
from ngsolve import CF, Integrate, Mesh, ds, dx, specialcf, x, y

from ngsxfem_contact.files import UnreadableFile
from ngsxfem_contact.job.gmsh import read_gmsh

DATA = Path(__file__).parents[1] / "data" / "gmsh"
FILES = ["layered-2.2.msh", "layered-4.1.msh"]


@pytest.mark.parametrize("name", FILES)
def test_regions_boundaries_and_normals(name):
    """A unit square: "matrix" below, "layer" above y = 0.8, whose surface is turned; the left side is in no physical group."""
    mesh = Mesh(read_gmsh(DATA / name))
    assert (mesh.ne, mesh.nv) == (194, 116)
    assert mesh.GetMaterials() == ("matrix", "layer") and set(mesh.GetBoundaries()) == {"bottom", "right side", "top", "default"}
    assert {region: Integrate(CF(1) * dx(region), mesh) for region in mesh.GetMaterials()} == pytest.approx({"matrix": 0.8, "layer": 0.2})
    centres = {side: [Integrate(f * ds(side), mesh) for f in (CF(1), x, y)] for side in mesh.GetBoundaries()}
    exact = {"bottom": [1, 0.5, 0], "right side": [1, 1, 0.5], "top": [1, 0.5, 1], "default": [1, 0, 0.5]}
    assert all(centres[side] == pytest.approx(exact[side], abs=1e-12) for side in exact)
    n = specialcf.normal(2)
    assert [Integrate(n[i] * CF((x, y))[i] * ds, mesh) for i in (0, 1)] == pytest.approx([1, 1])  # outward


def changed(tmp_path, *changes, name=FILES[1]):
    text = (DATA / name).read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "mesh.msh").write_text(text)
    return tmp_path / "mesh.msh"


def test_names_without_groups(tmp_path):
    """Where there are no physical groups, names come from the entities; where a group has no name, from its tag."""
    mesh = Mesh(
        read_gmsh(
            changed(tmp_path, ('5\n1 1 "bottom"\n', "4\n"), ("2 0 0.8 0 1 1 0 1 5", "2 0 0.8 0 1 1 0 0"), ("$EndPhysicalNames\n", "$EndPhysicalNames\n\n"))
        )
    )
    assert set(mesh.GetMaterials()) == {"matrix", "surface2"} and "curve1" in mesh.GetBoundaries()


@pytest.mark.parametrize("name, old, new, why", [
    (FILES[1], "4.1 0 8", "4.0 0 8", "has gmsh's format 4.0; text of format 2.2 or 4.1 is read"),
    (FILES[1], "4.1 0 8", "4.1 1 8", "format 4.1, binary"),
    (FILES[1], "$MeshFormat", "$Format", "has no section \\$MeshFormat"),
    (FILES[0], "$Nodes", "$Knots", "has no section \\$Nodes"),
    (FILES[0], "\n1 0 0 0\n", "\n1 0 0 0.5\n", "do not lie in a plane"),
    (FILES[0], "\n1 0 0 0\n", "\n1 0 zero 0\n", "is no whole mesh of gmsh, format 2.2"),
    (FILES[1], "2 0 0.8 0 1 1 0 1 5", "2 0 0.8 0 1 1 0 2 4 5", "surface 2 is in 2 physical groups"),
])  # fmt: skip
def test_what_is_refused(tmp_path, name, old, new, why):
    with pytest.raises(UnreadableFile, match=f"mesh.msh.*{why}"):
        read_gmsh(changed(tmp_path, (old, new), name=name))


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("part", [0.02, 0.3, 0.7, 0.97])
def test_half_a_file_is_refused(tmp_path, name, part):
    text = (DATA / name).read_text()
    (tmp_path / "mesh.msh").write_text(text[: int(part * len(text))])
    with pytest.raises(UnreadableFile, match="mesh.msh"):
        read_gmsh(tmp_path / "mesh.msh")


ELEMENTS = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n{}\n{}\n$EndElements\n"


@pytest.mark.parametrize("elements, why", [
    (["1 3 2 0 1 1 2 3 4"], "elements of type 3; a body is meshed with triangles"),
    (["1 1 2 0 1 1 2"], "has no triangles"),
    (["1 2 2 0 1 1 2 3", "2 2 2 0 1 1 2 3"], "triangles twice"),
    (["1 2 2 0 1 1 2 3", "2 1 2 0 1 1 4"], "from node 1 to 4 is no edge of a triangle"),
    (["1 2 2 0 1 1 2 3", "2 1 2 0 1 1 2", "3 1 2 0 2 2 1"], "elements of curves twice"),
])  # fmt: skip
def test_elements_that_make_no_body(tmp_path, elements, why):
    (tmp_path / "mesh.msh").write_text(ELEMENTS.format(len(elements), "\n".join(elements)))
    with pytest.raises(UnreadableFile, match=why):
        read_gmsh(tmp_path / "mesh.msh")
