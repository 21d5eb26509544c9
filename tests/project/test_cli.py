"""python -m ngsxfem_contact: what it writes, and what it leaves when it fails."""

import csv
import json
import os
import resource
import subprocess
import sys
import warnings
from contextlib import contextmanager
from pathlib import Path

import matplotlib.figure
import pytest

from ngsxfem_contact import __main__ as cli
from ngsxfem_contact.errors import AccuracyWarning
from ngsxfem_contact.files import write_whole
from ngsxfem_contact.job.part import EXAMPLE, read_part
from study.paper import REFERENCE

FILES = {"summary.txt", "summary.json", "profile.csv", "solution.vtu", "body.png", "profile.png"}
COARSE = ["--maxh", "0.4"]
pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")  # of COARSE


def names(folder):
    return {path.name for path in folder.iterdir()}


def part_file(folder, *changes):
    """The paper's test on a coarse mesh, with texts in it replaced: pairs (old, new)."""
    text = EXAMPLE.read_text(encoding="utf-8")
    for old, new in (("maxh = 0.06", "maxh = 0.4"), *changes):
        assert old in text
        text = text.replace(old, new)
    (folder / "part.toml").write_text(text, encoding="utf-8")
    return str(folder / "part.toml")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "new" / "folder"
    assert cli.main(["--maxh", "0.12", "--output", str(folder)]) == 0
    return folder


def test_writes_all_results(written):
    assert names(written) == FILES
    assert (written / "body.png").read_bytes().startswith(b"\x89PNG") and (written / "profile.png").read_bytes().startswith(b"\x89PNG")
    assert (written / "solution.vtu").read_bytes().rstrip().endswith(b"</VTKFile>")


def test_summary_for_machines(written):
    results = json.loads((written / "summary.json").read_text(encoding="utf-8"))
    exact, (step,) = REFERENCE["B"], results["steps"]
    (crack,), (tip,) = step["cracks"], step["tips"]
    assert results["file"] == "paper.toml" and len(results["unknowns"]) == 2
    assert step["energy"] == pytest.approx(exact["energy"], rel=0.003)
    assert crack["contact_force"] == pytest.approx(exact["contact_force"], rel=0.01)
    assert crack["transitions"] == pytest.approx([exact["transition"]], abs=0.06)
    assert tip["K_I"] == 0 and tip["K_II"] == pytest.approx(exact["K_II"], rel=0.02) and tip["method"] == "interaction"
    assert tip["G"] == pytest.approx(3 / 8 * exact["K_II"] ** 2, rel=0.05)
    assert step["report"]["complementarity"] < 1e-10 and step["report"]["iterations"] > 1
    assert [row["support"] for row in step["reactions"]] == ["pin at (1, -0.5)", "pin at (1, 0.5)", "all"]


def test_the_reference_that_ships_is_that_of_the_study():
    reference, exact = read_part(EXAMPLE).reference, REFERENCE["B"]
    assert (reference["energy"], reference["contact_force"]) == (exact["energy"], [exact["contact_force"]])
    assert (reference["transitions"], reference["K"]) == ([[exact["transition"]]], [[exact["K_I"], exact["K_II"]]])


def test_summary_for_people(written):
    text = (written / "summary.txt").read_text(encoding="utf-8")
    assert text.startswith("The paper's test, load B: ")
    for line in ("reference (boundary-fitted)", "energy ½a(u,u)", "contact force ∫λ", "contact begins or ends, s", "K_II", "support", "converged        True"):
        assert line in text
    assert str(REFERENCE["B"]["energy"])[:8] in text


def test_profile_as_a_table(written):
    rows = list(csv.DictReader((written / "profile.csv").open(encoding="utf-8")))
    assert len(rows) == 200 and list(rows[0]) == ["factor", "crack", "s", "x", "y", "gap", "slip", "sigma_n", "sigma_t"]
    assert (float(rows[-1]["s"]), float(rows[-1]["x"])) == (0.5, 0.5)
    pressure = [float(row["sigma_n"]) for row in rows]
    assert max(pressure) <= 0 and sum(pressure) * 0.5 / 200 == pytest.approx(REFERENCE["B"]["contact_force"], rel=0.02)


def test_says_what_it_wrote(tmp_path, capsys):
    assert cli.main([*COARSE, "--no-figures", "--output", str(tmp_path)]) == 0
    assert names(tmp_path) == FILES - {"body.png", "profile.png"}
    *_, last = capsys.readouterr().out.splitlines()
    assert last.startswith("wrote ") and str(tmp_path) in last and all(name in last for name in names(tmp_path))


def test_output_of_the_file(tmp_path, monkeypatch):
    """Its folder is taken from where the command runs."""
    file = part_file(tmp_path, ("[reference]", '[output]\nfolder = "here"\npoints = 7\nvtk = false\npictures = false\n\n[reference]'))
    monkeypatch.chdir(tmp_path)
    assert cli.main([file]) == 0
    assert names(tmp_path / "here") == {"summary.txt", "summary.json", "profile.csv"}
    assert len((tmp_path / "here" / "profile.csv").read_text().splitlines()) == 8
    assert cli.main([file, "--output", "there"]) == 0 and names(tmp_path) == {"part.toml", "here", "there"}


def test_load_steps_have_rows_of_their_own(tmp_path):
    file = part_file(
        tmp_path,
        ("[reference]", "[solve]\nfactors = [0.5, 1]\n\n[[crack]]\npolyline = [[0.6, -0.25], [1, -0.25]]\n\n[reference]"),
        ("maxh = 0.4", "maxh = 0.2"),
    )
    assert cli.main([file, "--output", str(tmp_path / "out")]) == 0
    assert names(tmp_path / "out") == {
        "summary.txt",
        "summary.json",
        "profile.csv",
        "solution_0.vtu",
        "solution_1.vtu",
        "body.png",
        "profile_0.png",
        "profile_1.png",
    }
    half, full = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["steps"]
    assert (half["factor"], full["factor"]) == (0.5, 1) and half["energy"] == pytest.approx(full["energy"] / 4, rel=1e-9)
    rows = list(csv.DictReader((tmp_path / "out" / "profile.csv").open(encoding="utf-8")))
    assert [(row["factor"], row["crack"]) for row in rows[::200]] == [("0.5", "0"), ("0.5", "1"), ("1", "0"), ("1", "1")]
    text = (tmp_path / "out" / "summary.txt").read_text(encoding="utf-8")
    assert "Loads × 0.5" in text and "contact force ∫λ, crack 1" in text and text.count("boundary-fitted") == 1


def test_help(tmp_path):
    run = subprocess.run([sys.executable, "-m", "ngsxfem_contact", "--help"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0 and "--maxh" in run.stdout and run.stderr == ""


def test_example_is_a_file_to_begin_with(tmp_path, capsys):
    assert cli.main(["--example"]) == 0
    printed = capsys.readouterr().out
    assert printed == EXAMPLE.read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(printed, encoding="utf-8")
    assert read_part(tmp_path / "mine.toml").problem.V.ndof > 1000


@pytest.mark.parametrize("options", ["--maxh small", "--h 0.1", "--verbose", "a.toml b.toml"])
def test_bad_options(options, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stopped:
        cli.main(options.split())
    assert stopped.value.code == 2
    assert "error: " in capsys.readouterr().err and names(tmp_path) == set()


@pytest.mark.parametrize("maxh", ["0", "-1", "nan", "inf", "1e-9"])
def test_bad_sizes(maxh, capsys, tmp_path):
    assert cli.main(["--maxh", maxh, "--output", str(tmp_path)]) == 2
    assert "paper.toml: [mesh], maxh: " in capsys.readouterr().err and names(tmp_path) == set()


def test_a_refused_file_writes_nothing(tmp_path, capsys):
    file = part_file(tmp_path, ("order = 2", "ordr = 2"))
    assert cli.main([file, "--output", str(tmp_path / "out")]) == 2
    assert "part.toml: [displacement], ordr: there is no such key, did you mean 'order'?" in capsys.readouterr().err
    assert names(tmp_path) == {"part.toml"}


def test_no_file(tmp_path, capsys):
    assert cli.main([str(tmp_path / "none.toml"), "--output", str(tmp_path)]) == 1
    assert "none.toml" in capsys.readouterr().err and names(tmp_path) == set()


def test_problem_without_an_answer_writes_nothing(tmp_path, capsys):
    """P1/P1 without stabilisation, on a mesh that makes it singular."""
    mesh = f'file = "{Path(__file__).parents[1] / "data" / "u0.057.vol"}"'
    text = (
        ("rectangle = [[0, -0.5], [1, 0.5]]", mesh),
        ("maxh = 0.4", ""),
        ("order = 2", "order = 1"),
        ("[reference]", '[stabilisation]\nmethod = "none"\n[reference]'),
    )
    file = part_file(tmp_path, *text)
    assert cli.main([file, "--output", str(tmp_path / "out")]) == 1
    assert "no answer: 1 of 12 multipliers act on no displacement" in capsys.readouterr().err
    assert names(tmp_path) == {"part.toml"}


def test_gamma0_too_large_is_no_answer(tmp_path, capsys):
    file = part_file(tmp_path, ("[reference]", '[stabilisation]\nmethod = "BarbosaHughes"\ngamma0 = 10\n\n[reference]'))
    assert cli.main([file, "--output", str(tmp_path / "out")]) == 1
    assert "take gamma0 = 10 below" in capsys.readouterr().err and names(tmp_path) == {"part.toml"}


def test_output_that_is_a_file(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert cli.main([*COARSE, "--output", str(tmp_path / "taken")]) == 1
    assert "taken" in capsys.readouterr().err


def interrupted(*args, **kwargs):
    raise KeyboardInterrupt


def half_a_file(figure, path, **options):
    Path(path).write_bytes(b"\x89PNG")
    raise KeyboardInterrupt


def test_interruption_while_writing_leaves_whole_files_only(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(matplotlib.figure.Figure, "savefig", half_a_file)
    (tmp_path / "body.png").write_text("of an earlier run")
    assert cli.main([*COARSE, "--output", str(tmp_path)]) == 130
    assert capsys.readouterr().err.strip() == "stopped"
    assert (tmp_path / "body.png").read_text() == "of an earlier run"
    assert names(tmp_path) == {"summary.txt", "summary.json", "profile.csv", "solution.vtu", "body.png"}
    json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))


def test_interruption_while_solving(monkeypatch, tmp_path):
    monkeypatch.setattr("ngsxfem_contact.contact.problem.ContactProblem.Solve", interrupted)
    assert cli.main([*COARSE, "--output", str(tmp_path)]) == 130
    assert names(tmp_path) == set()


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_a_file_appears_when_it_is_whole(tmp_path, error):
    def write(path):
        path.write_text("half")
        raise error

    with pytest.raises(error):
        write_whole(tmp_path / "result.txt", write)
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
    (solution,) = read_part(EXAMPLE, 0.4).Solve()
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
            write_whole(tmp_path / "result.txt", write)
    with pytest.raises(OSError, match="it broke off after 0 bytes"):
        write_whole(tmp_path / "result.txt", lambda path: None)
    assert names(tmp_path) == set()


def test_without_matplotlib_it_says_so_and_goes_on(monkeypatch, tmp_path, capsys):
    for module in ("matplotlib", "matplotlib.pyplot"):
        monkeypatch.setitem(sys.modules, module, None)
    assert cli.main([*COARSE, "--output", str(tmp_path), "--quiet"]) == 0
    assert names(tmp_path) == FILES - {"body.png", "profile.png"}
    said = capsys.readouterr()
    assert said.err.startswith("no figures: they need matplotlib, run `pip install ngsxfem_contact[plot]`") and "body.png" not in said.out


def test_a_terminal_without_greek_letters(tmp_path):
    command = [sys.executable, "-m", "ngsxfem_contact", *COARSE, "--no-figures", "--output", str(tmp_path)]
    environment = os.environ | {"PYTHONIOENCODING": "ascii", "LANG": "C", "LC_ALL": "C"}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, encoding="ascii")
    assert done.returncode == 0 and "Traceback" not in done.stderr and "contact force ??" in done.stdout
    assert "contact force ∫λ" in (tmp_path / "summary.txt").read_text(encoding="utf-8")


def test_warnings_are_said_once_without_code_and_are_among_the_results(tmp_path, capsys):
    """The crack of the paper's test has not two of such elements."""
    with warnings.catch_warnings():
        warnings.simplefilter("default", AccuracyWarning)
        assert cli.main([*COARSE, "--no-figures", "--output", str(tmp_path)]) == 0
    errors = capsys.readouterr().err
    (warning,) = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["warnings"]
    assert warning.startswith("crack 0 at (0.25, 0) is 0.5 long") and "refine to h <=" in warning
    assert errors == f"warning: {warning}\n"
    assert (tmp_path / "summary.txt").read_text(encoding="utf-8").endswith(f"\nwarning: {warning}\n")
