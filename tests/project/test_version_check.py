import pytest

from ngsxfem_contact._version_check import check


def test_another_ngsolve_is_refused_with_a_way_out():
    with pytest.raises(ImportError, match=r"pip install ngsolve==6\.2\.2608"):
        check(installed="6.2.2607", expected="6.2.2608")
