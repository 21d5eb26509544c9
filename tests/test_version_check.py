import ngsolve
import pytest
from netgen.geom2d import unit_square

from ngsxfem_contact import NumberOfElements
from ngsxfem_contact._version_check import check


def test_another_ngsolve_is_refused_with_a_way_out():
    with pytest.raises(ImportError, match=r"pip install ngsolve==6\.2\.2608"):
        check(installed="6.2.2607", expected="6.2.2608")


def test_extension_shares_types_with_ngsolve():
    mesh = ngsolve.Mesh(unit_square.GenerateMesh(maxh=0.3))
    assert NumberOfElements(mesh) == mesh.ne
