"""The report of a solve is a table: a name, a value, line by line."""

import re

import numpy as np
import pytest

from ngsxfem_contact import Coulomb, LoadSteps, Nitsche
from ngsxfem_contact.algebra import FixedPoint
from ngsxfem_contact.contact.report import Report
from study.paper import paper_problem, unstructured_mesh

MESH = unstructured_mesh(0.1)
PLAIN = ["unknowns", "direct solver", "converged", "in contact", "residual", "complementarity", "seconds"]
FRICTION = [*PLAIN[:4], "states", "method", "uniqueness", *PLAIN[4:]]


def rows(report):
    """{name: value} of the lines of a report."""
    return dict(re.fullmatch(r"(\S.{15}) (\S.*)", line).groups() for line in str(report).splitlines())


def names(report):
    return [name.strip() for name in rows(report)]


@pytest.mark.parametrize(
    "options, expected",
    [
        ({}, PLAIN),
        ({"stabilisation": Nitsche(0)}, PLAIN),
        ({"law": Coulomb(0.3)}, FRICTION),
        ({"law": Coulomb(0.3, FixedPoint())}, [*FRICTION[:6], "threshold", *FRICTION[6:]]),
    ],
    ids=["contact", "Nitsche", "Coulomb", "fixed point"],
)
def test_lines(options, expected):
    report = paper_problem(MESH, **options).Solve().report
    assert names(report) == expected
    assert "nan" not in str(report) and repr(report) == str(report)


def test_a_load_step_before_its_displacement_is_used():
    solution = LoadSteps(paper_problem(MESH)).Solve(1)
    assert rows(solution.report)["residual        "] == "measured when solution.u is first used"
    solution.u  # noqa: B018
    assert float(rows(solution.report)["residual        "]) < 1e-10


def test_seconds_add_up():
    report = Report((10, 2), "pardiso", timings={"assemble": 1.0, "factor": 0.25}, active=[np.ones(2, dtype=bool)])
    assert rows(report)["seconds         "] == "1.250: assemble 1.000  factor 0.250"
