"""Formulas written as text: arithmetic, and nothing else."""

from math import pi

import pytest
from ngsolve import CF, CoefficientFunction, Integrate, Mesh, exp, sin, sqrt, unit_square, x, y

from ngsxfem_contact.job.formula import NoFormula, evaluated

MESH = Mesh(unit_square.GenerateMesh(maxh=0.5))
XY = {"x": x, "y": y}


@pytest.mark.parametrize(
    "text, value",
    [
        ("2", 2),
        ("-1.5e-3", -1.5e-3),
        (" 1 + 2*3 ", 7),
        ("2**-1", 0.5),
        ("-2**2", -4),
        ("(1 - 3)/4", -0.5),
        ("sqrt(2)**2", 2),
        ("cos(pi)", -1),
        ("log(exp(2))", 2),
    ],
)
def test_numbers(text, value):
    found = evaluated(text, XY)
    assert isinstance(found, float) and found == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    "text, function",
    [
        ("3.5*x*(1 - x)*y*sin(2*pi*x)", 3.5 * x * (1 - x) * y * sin(2 * pi * x)),
        ("exp(-y) / sqrt(1 + x)", exp(-y) / sqrt(1 + x)),
        ("(x - 0.5)**3 + 2**y", (x - 0.5) * (x - 0.5) * (x - 0.5) + CF(2) ** y),  # also where the base is negative
        ("(x - 0.7)**-2.0 * (x - 0.7)**3", x - 0.7),
    ],
)
def test_functions(text, function):
    found = evaluated(text, XY)
    assert isinstance(found, CoefficientFunction)
    assert Integrate((found - function) ** 2, MESH) < 1e-26
    for point in ((0.2, 0.9), (0.6, 0.1)):
        assert found(MESH(*point)) == pytest.approx(function(MESH(*point)), rel=1e-12)


def test_other_names():
    assert evaluated("0.3 + t**2", {"t": 2.0}) == 4.3
    with pytest.raises(NoFormula, match="there is no 'x'; allowed are .*pi, t and sqrt, sin"):
        evaluated("x", {"t": 2.0})


@pytest.mark.parametrize(
    "text, why",
    [
        ("", "is no formula"),
        ("1 +", "is no formula"),
        ("z", "there is no 'z'"),
        ("sinh(x)", "there is no function 'sinh'"),
        ("sin(x, y)", "is not allowed"),
        ("sin(x=1)", "is not allowed"),
        ("sin", "there is no 'sin'"),
        ("x if y else 1", "is not allowed"),
        ("x < y", "is not allowed"),
        ("x // 2", "is no formula"),
        ("x ^ 2", "is no formula"),
        ("True", "is not allowed"),
        ("1j", "is not allowed"),
        ("'x'", "is not allowed"),
        ("x.real", "is not allowed"),
        ("[1, 2]", "is not allowed"),
        ("(lambda: 1)()", "is not allowed"),
        ("__import__('os').system('true')", "is not allowed"),
        ("exec('1')", "is not allowed"),
        ("x := 1", "is no formula"),
        ("1; 2", "is no formula"),
        ("1/0", "has no value"),
        ("9.0**9**9", "has no value"),
        ("1e999", "has the value inf"),
        ("(-1)**0.5", "no finite real number"),
        ("sqrt(-1)", "is no formula"),
        ("log(0)", "is no formula"),
        ("(" * 500 + "x" + ")" * 500, "is no formula"),
        ("+" * 1999 + "1", "is no formula"),
        ("x" * 2001, "2001 characters, more than 2000"),
    ],
)
def test_what_is_refused(text, why):
    with pytest.raises(NoFormula, match=why):
        evaluated(text, XY)
