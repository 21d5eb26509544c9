"""python -m ngsxfem_contact: what it writes, and what it leaves when it fails."""

import json
import os
import resource
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import matplotlib.figure
import pytest
from ngsolve import Mesh, SetNumThreads

from ngsxfem_contact import __main__ as cli
from ngsxfem_contact.study.paper import REFERENCE, paper_problem, unstructured_mesh

SetNumThreads(1)

DATA = Path(__file__).parents[1] / "data"
FILES = {"summary.txt", "summary.json", "solution.vtu", "body.png", "profile.png"}


def names(folder):
    return {path.name for path in folder.iterdir()}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "new" / "folder"
    assert cli.main(["--h", "0.06", "--output", str(folder)]) == 0
    return folder


def test_writes_all_results(written):
    assert names(written) == FILES
    assert (written / "body.png").read_bytes().startswith(b"\x89PNG") and (written / "profile.png").read_bytes().startswith(b"\x89PNG")
    assert (written / "solution.vtu").read_bytes().rstrip().endswith(b"</VTKFile>")


def test_summary_for_machines(written):
    results = json.loads((written / "summary.json").read_text(encoding="utf-8"))
    assert (results["load"], results["pair"], results["h"], results["stabilised"]) == ("B", "P2/P1", 0.06, True)
    assert results["reference"] == REFERENCE["B"]
    assert results["energy"] == pytest.approx(REFERENCE["B"]["energy"], rel=0.003)
    assert results["contact_force"] == pytest.approx(REFERENCE["B"]["contact_force"], rel=0.01)
    assert results["K_II"] == pytest.approx(REFERENCE["B"]["K_II"], rel=0.15)  # O(h): 3 % at h = 0.03
    assert results["complementarity"] < 1e-10 and results["iterations"] > 1 and len(results["unknowns"]) == 2
    assert results["transitions"] == pytest.approx([REFERENCE["B"]["transition"]], abs=0.06)


def test_summary_for_people(written):
    text = (written / "summary.txt").read_text(encoding="utf-8")
    assert text.startswith("Load B, P2/P1, h = 0.06,")
    for line in ("energy ½a(u,u)", "contact force ∫λ", "contact begins or ends, s", "K_II", "converged        True"):
        assert line in text


def test_says_what_it_wrote(tmp_path, capsys):
    assert cli.main(["--h", "0.06", "--pair", "P2/P0", "--load", "A", "--no-figures", "--output", str(tmp_path)]) == 0
    assert names(tmp_path) == {"summary.txt", "summary.json", "solution.vtu"}
    *_, last = capsys.readouterr().out.splitlines()
    assert last.startswith("wrote ") and str(tmp_path) in last and all(name in last for name in names(tmp_path))
    assert json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["transitions"] == []


def test_gamma0_and_cone_reach_the_problem(tmp_path):
    options = ["--h", "0.2", "--no-figures", "--cone", "weak", "--gamma0", "0.001", "--output", str(tmp_path)]
    assert cli.main(options) == 0


def test_study(tmp_path, capsys):
    """Records, rates and the table of rates; a second call finds all solves done."""
    options = ["study", "--sizes", "0.2", "0.12", "--realisations", "1", "--cells", "15", "--no-figures", "--output", str(tmp_path)]
    assert cli.main(options) == 0
    printed = capsys.readouterr().out
    assert {"study.jsonl", "study.csv", "rates.json"} <= names(tmp_path)
    rates = json.loads((tmp_path / "rates.json").read_text(encoding="utf-8"))
    assert {rate["pair"] for rate in rates} == {"P1/P0", "P1/P1", "P1+/P1", "P2/P0", "P2/P1"}
    orders = [rate["L2"] for rate in rates if (rate["pair"], rate["stabilisation"], rate["mesh"]) == ("P2/P1", "larger", "unstructured")]
    assert orders and min(orders) > 2 and all(f"{order:.2f}" in printed for order in orders)
    kept = (tmp_path / "study.jsonl").read_bytes()
    assert cli.main(options) == 0 and (tmp_path / "study.jsonl").read_bytes() == kept


def test_help(tmp_path):
    run = subprocess.run([sys.executable, "-m", "ngsxfem_contact", "--help"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0 and "--pair" in run.stdout and run.stderr == ""


@pytest.mark.parametrize(
    "options", ["--h 0", "--h -1", "--h 0.6", "--h nan", "--h small", "--pair P3/P1", "--load D", "--gamma0 0.1 --unstabilised", "--verbose"]
)
def test_bad_options(options, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stopped:
        cli.main(options.split())
    assert stopped.value.code == 2
    assert "error: " in capsys.readouterr().err and names(tmp_path) == set()


@pytest.mark.parametrize("gamma0", ["0", "-1", "nan"])
def test_bad_gamma0(gamma0, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stopped:
        cli.main(["--gamma0", gamma0])
    assert stopped.value.code == 2
    assert "gamma0" in capsys.readouterr().err and names(tmp_path) == set()


def test_problem_without_an_answer_writes_nothing(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(cli, "unstructured_mesh", lambda h: Mesh(str(DATA / "u0.057.vol")))
    assert cli.main(["--pair", "P1/P1", "--unstabilised", "--output", str(tmp_path)]) == 1
    assert "no answer: 1 of 12 multipliers act on no displacement" in capsys.readouterr().err
    assert names(tmp_path) == set()


def test_gamma0_too_large_is_no_answer(tmp_path, capsys):
    assert cli.main(["--h", "0.2", "--gamma0", "10", "--output", str(tmp_path)]) == 1
    assert "take gamma0 = 10 below" in capsys.readouterr().err and names(tmp_path) == set()


def test_output_that_is_a_file(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert cli.main(["--h", "0.2", "--output", str(tmp_path / "taken")]) != 0
    assert "taken" in capsys.readouterr().err


def interrupted(*args, **kwargs):
    raise KeyboardInterrupt


def half_a_file(figure, path, **options):
    Path(path).write_bytes(b"\x89PNG")
    raise KeyboardInterrupt


def test_interruption_while_writing_leaves_whole_files_only(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(matplotlib.figure.Figure, "savefig", half_a_file)
    (tmp_path / "body.png").write_text("of an earlier run")
    assert cli.main(["--h", "0.2", "--output", str(tmp_path)]) == 130
    assert capsys.readouterr().err.strip() == "stopped"
    assert (tmp_path / "body.png").read_text() == "of an earlier run"
    assert names(tmp_path) == {"summary.txt", "summary.json", "solution.vtu", "body.png"}
    json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))


def test_interruption_while_solving(monkeypatch, tmp_path):
    monkeypatch.setattr("ngsxfem_contact.contact.problem.ContactProblem.Solve", interrupted)
    assert cli.main(["--h", "0.2", "--output", str(tmp_path)]) == 130
    assert names(tmp_path) == set()


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_a_file_appears_when_it_is_whole(tmp_path, error):
    def write(path):
        path.write_text("half")
        raise error

    with pytest.raises(error):
        cli.write_whole(tmp_path / "result.txt", write)
    assert names(tmp_path) == set()


@contextmanager
def files_limited_to(size):
    """As if the disk were full after that many bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("old", [None, "of an earlier run"])
def test_a_full_disk_is_an_error_and_leaves_no_half_file(tmp_path, old):
    solution = paper_problem(unstructured_mesh(0.2), "B", "P2/P1").Solve()
    path = tmp_path / "crack.vtu"
    whole = Path(solution.SaveVTK(tmp_path / "whole.vtu")).stat().st_size
    if old:
        path.write_text(old)
    for size in (0, whole // 3, whole - 20):
        with files_limited_to(size), pytest.raises(OSError, match="crack.vtu cannot be written: it broke off after .* bytes; is the disk full"):
            solution.SaveVTK(path)
        assert names(tmp_path) == {"whole.vtu", *(["crack.vtu"] if old else [])} and (not old or path.read_text() == old)
    solution.SaveVTK(path)
    assert path.stat().st_size == whole


def test_every_other_writer_reports_a_full_disk(tmp_path):
    for write in (lambda path: path.write_text("x" * 5000), lambda path: path.write_bytes(b"x" * 5000)):
        with files_limited_to(1000), pytest.raises(OSError):
            cli.write_whole(tmp_path / "result.txt", write)
    with pytest.raises(OSError, match="it broke off after 0 bytes"):
        cli.write_whole(tmp_path / "result.txt", lambda path: None)
    assert names(tmp_path) == set()


def test_without_matplotlib_it_says_so_and_goes_on(monkeypatch, tmp_path, capsys):
    for module in ("matplotlib", "matplotlib.pyplot"):
        monkeypatch.setitem(sys.modules, module, None)
    assert cli.main(["--h", "0.2", "--output", str(tmp_path), "--quiet"]) == 0
    assert names(tmp_path) == {"summary.txt", "summary.json", "solution.vtu"}
    said = capsys.readouterr()
    assert said.err.startswith("no figures: they need matplotlib, run `pip install ngsxfem_contact[plot]`") and "body.png" not in said.out


def test_a_terminal_without_greek_letters(tmp_path):
    command = [sys.executable, "-m", "ngsxfem_contact", "--h", "0.2", "--no-figures", "--output", str(tmp_path)]
    environment = os.environ | {"PYTHONIOENCODING": "ascii", "LANG": "C", "LC_ALL": "C"}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, encoding="ascii")
    assert done.returncode == 0 and "Traceback" not in done.stderr and "contact force ??" in done.stdout
    assert "contact force ∫λ" in (tmp_path / "summary.txt").read_text(encoding="utf-8")
