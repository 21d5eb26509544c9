"""The convergence study on small meshes: errors, resumption, the two ways to stabilise."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from ngsolve import Integrate

from ngsxfem_contact import BarbosaHughes, NormalGap
from ngsxfem_contact.contact import BothSides
from ngsxfem_contact.errors import NotCoercive
from ngsxfem_contact.files import UnreadableFile, only_one
from study import __main__ as cli
from study.paper import MATERIAL, PAIRS, paper_problem
from study.study import ErrorMeasure, Reference, Study, oscillation, read_records, reference_solution, structured_mesh


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module")
def reference(folder):
    return Reference(reference_solution(folder, cells=31))


def test_the_reference_has_no_error_against_itself(reference):
    problem = paper_problem(structured_mesh(31))
    solution = problem.Solve()
    measure = ErrorMeasure(problem.V, reference)
    errors = measure.Errors(solution, BarbosaHughes().Gamma(problem.V, MATERIAL))
    norms = measure.Norms()
    assert errors["L2"] < 1e-11 * norms["L2"] and errors["multiplier"] < 1e-11 * norms["multiplier"]
    # a point beside an edge may be found in the neighbour, whose gradient is another
    assert errors["H1"] < 1e-6 * norms["H1"] and errors["energy"] < 1e-6 * norms["energy"]


def test_norms_are_those_of_the_authors_program(reference):
    """‖u‖ in L² and H¹ and ‖λ‖ of their finest solution: 6.300e-3, 3.223e-2, 2.271e-2."""
    norms = ErrorMeasure(paper_problem(structured_mesh(31)).V, reference).Norms()
    assert norms["L2"] == pytest.approx(6.300e-3, rel=2e-3)
    assert norms["H1"] == pytest.approx(3.223e-2, rel=2e-3)
    assert norms["multiplier"] == pytest.approx(2.271e-2, rel=5e-3)


@pytest.fixture
def few_pairs(monkeypatch):
    """What a study does with its records, on two of the pairs."""
    monkeypatch.setattr("study.study.PAIRS", {name: PAIRS[name] for name in ("P2/P1", "P1/P0")})


def run(folder):
    study = Study(folder, sizes=(0.2,), realisations=1, cells=5, progress=lambda line: None)
    return study.Run()


def test_a_stopped_study_goes_on_where_it_was(tmp_path):
    records = run(tmp_path)
    path = tmp_path / "study.jsonl"
    lines = path.read_text().splitlines()
    assert len(lines) == len(records) and {r["kind"] for r in records} == {"reference", "convergence", "infsup"}
    unstructured = [r for r in records if r["kind"] == "convergence" and r["mesh"] == "unstructured"]
    assert len(unstructured) == 16  # five pairs with and without stabilisation, three of them with two cones
    path.write_text("\n".join(lines[:5]) + '\n{"kind": "conv')  # stopped while it wrote the sixth
    again = run(tmp_path)
    key = lambda r: json.dumps([r.get(k) for k in ("kind", "mesh", "pair", "stabilisation", "cone")])
    assert sorted(map(key, again)) == sorted(map(key, records))
    assert (tmp_path / "study.csv").read_text().count("\n") == 1 + sum(r["kind"] == "convergence" for r in records)
    assert len(read_records(path)) == len(again)


def tiny_study(folder, cells=5):
    return Study(folder, sizes=(0.3,), realisations=1, structured=True, cells=cells, progress=lambda line: None)


def test_other_references_and_versions_are_other_studies(tmp_path, monkeypatch, few_pairs):
    """What is in the folder is kept, and no part of what is asked for."""
    numbers = lambda records: sorted(record["error"]["H1"] for record in records if record["kind"] == "convergence")
    first = numbers(tiny_study(tmp_path).Run())
    other = numbers(tiny_study(tmp_path, cells=9).Run())
    assert len(first) == len(other) and not np.allclose(first, other, rtol=1e-3)
    monkeypatch.setattr("study.study.versions", lambda: "another")
    study = tiny_study(tmp_path)
    assert numbers(study.Run()) == pytest.approx(first, rel=1e-10) and {record["versions"] for record in study.records} == {"another"}
    settings = [(record["cells"], record["versions"]) for record in read_records(tmp_path / "study.jsonl")]
    assert len(set(settings)) == 3
    assert (tmp_path / "study.csv").read_text().count("\n") == 1 + len(first)


@pytest.mark.parametrize("line", ["{not json", "[1, 2]", '{"mesh": "structured"}', "\0\0\0", ""])
def test_damaged_lines_are_named(tmp_path, line):
    good = json.dumps({"kind": "reference", "norm": {}})
    (tmp_path / "study.jsonl").write_text(f"{good}\n{line}\n{good}\n")
    with pytest.raises(UnreadableFile, match="study.jsonl, line 2 is no record of a study .*; delete the line"):
        tiny_study(tmp_path).Run()
    assert (tmp_path / "study.jsonl").read_text() == f"{good}\n{line}\n{good}\n"


def test_a_damaged_reference_is_named(tmp_path, few_pairs):
    tiny_study(tmp_path).Run()
    (path,) = tmp_path.glob("reference-5-*.solution")
    path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(UnreadableFile, match="reference-5-.*is no reference solution .*; delete it"):
        tiny_study(tmp_path).Run()


def test_two_studies_do_not_work_in_one_folder(tmp_path, few_pairs):
    with only_one(tmp_path / "study.lock", "this folder"):
        with pytest.raises(BlockingIOError, match="is in use by another process; wait for it, or take another folder"):
            tiny_study(tmp_path).Run()
    assert tiny_study(tmp_path).Run()  # a lock file that is left over is none


def test_errors_fall_with_the_mesh(reference):
    errors = []
    for cells in (5, 9, 15):
        problem = paper_problem(structured_mesh(cells), pair="P1/P0")
        errors.append(ErrorMeasure(problem.V, reference).Errors(problem.Solve(), BarbosaHughes().Gamma(problem.V, MATERIAL)))
    for name in ("L2", "H1", "multiplier"):
        assert errors[0][name] > 1.2 * errors[1][name] > 1.2**2 * errors[2][name]


def test_stabilisation_removes_the_oscillation_of_P1_P0():
    mesh = structured_mesh(15)
    plain, stable = (oscillation(paper_problem(mesh, pair="P1/P0", stabilisation=s).Solve()) for s in (None, BarbosaHughes()))
    assert plain > 0.3 and stable < 0.1


def contact_gap(stabilisation):
    """∫gap over ∫γ|λ| in the part that is closed for certain."""
    from ngsolve import IfPos, x

    solution = paper_problem(structured_mesh(31), stabilisation=stabilisation).Solve()
    closed = IfPos(x - 0.3, 1, 0) * IfPos(0.45 - x, 1, 0)
    integral = lambda f: Integrate(closed * f * solution.body.dcrack(bonus_intorder=8), solution.body.mesh)
    return integral(NormalGap(solution.u, solution.body)) / integral(-solution.gamma * solution.multiplier)


def test_both_sides_against_one_mass_term_impose_a_gap():
    """gap = γ|λ| in contact: the scheme of the authors' program is not consistent; halved it is."""
    assert contact_gap(BothSides(0.005)) == pytest.approx(1, abs=0.05)
    assert abs(contact_gap(BothSides(0.005, weight=0.5))) < 0.05
    assert abs(contact_gap(BarbosaHughes())) < 0.05


def test_both_sides_depend_on_slivers():
    with pytest.raises(NotCoercive, match="γ is too large.*take gamma0 = 0.1 below"):
        paper_problem(structured_mesh(15), stabilisation=BothSides(0.1)).Solve()


def test_bad_gamma0():
    with pytest.raises(ValueError, match="gamma0=0 must be positive"):
        BothSides(0)


def test_gamma_of_both_sides_is_gamma0_h():
    problem = paper_problem(structured_mesh(5))
    gamma = BothSides(0.01).Gamma(problem.V, MATERIAL)
    (_, _, _, weights, _, _), h = problem.body.dcrack.Points(2), np.sqrt(2) / 5
    assert Integrate(gamma * problem.body.dcrack, problem.body.mesh) == pytest.approx(0.01 * h * weights.sum(), rel=1e-10)


# The command


def test_command(tmp_path, capsys):
    """Records, rates and the table of rates; a second call finds all solves done."""
    options = ["--sizes", "0.15", "0.06", "--structured", "--realisations", "1", "--cells", "15", "--no-figures", "--output", str(tmp_path)]
    assert cli.main(options) == 0
    printed = capsys.readouterr().out
    assert {"study.jsonl", "study.csv", "rates.json"} <= {path.name for path in tmp_path.iterdir()}
    rates = json.loads((tmp_path / "rates.json").read_text(encoding="utf-8"))
    assert {rate["pair"] for rate in rates} == {"P1/P0", "P1/P1", "P1+/P1", "P2/P0", "P2/P1"}
    orders = [rate["L2"] for rate in rates if (rate["pair"], rate["stabilisation"], rate["mesh"]) == ("P2/P1", "larger", "structured")]
    assert orders and min(orders) > 2 and all(f"{order:.2f}" in printed for order in orders)
    kept = (tmp_path / "study.jsonl").read_bytes()
    assert cli.main(options) == 0 and (tmp_path / "study.jsonl").read_bytes() == kept


@pytest.mark.parametrize("options", ["--sizes 0", "--sizes 0.1 nan", "--realisations 0", "--cells 4", "--cells 1", "study"])
def test_bad_options(options, capsys, tmp_path):
    with pytest.raises(SystemExit) as stopped:
        cli.main([*options.split(), "--output", str(tmp_path)])
    assert stopped.value.code == 2
    assert "error: " in capsys.readouterr().err and list(tmp_path.iterdir()) == []


def test_it_does_not_hide_the_installed_package():
    """Run in the folder of the sources, it looks there last."""
    root = Path(__file__).resolve().parents[2]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    run = subprocess.run([sys.executable, "-c", "import study, sys; print(*sys.path, sep='\\n')"], cwd=root, env=environment, capture_output=True, text=True)
    path = run.stdout.splitlines()
    assert "" not in path and set(path[path.index(str(root)) :]) == {str(root)}
