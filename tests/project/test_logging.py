"""The package says what it does to the logger "ngsxfem_contact", which is silent unless a program listens; the command listens."""

import logging
import subprocess
import sys
import threading

import pytest

from ngsxfem_contact import Coercivity, CrackGrowth, GivenIncrement, LoadSteps
from ngsxfem_contact import __main__ as cli
from study.paper import paper_problem, unstructured_mesh

STAGES = ["checking rigid motions", "assembling", "eliminating", "eliminating", "contact on", "recovering"]


@pytest.fixture
def said(caplog):
    """The messages of a level, in order."""
    caplog.set_level(logging.DEBUG, logger="ngsxfem_contact")
    return lambda level: [record.getMessage() for record in caplog.records if record.levelno == level and record.name.startswith("ngsxfem_contact.")]


@pytest.fixture(scope="module")
def problem():
    return paper_problem(unstructured_mesh(0.2))


def test_a_solve_names_its_stages_where_they_begin_and_their_seconds_where_they_end(problem, said):
    solution = problem.Solve()
    assert [line[: len(stage)] for line, stage in zip(said(logging.INFO), STAGES, strict=True)] == STAGES
    assert said(logging.INFO)[1] == f"assembling, {problem.V.ndof} displacement unknowns"
    seconds = [float(line.rpartition(": ")[2].removesuffix(" s")) for line in said(logging.DEBUG)]
    assert seconds == pytest.approx(list(solution.report.timings.values()), abs=6e-4)


def test_a_stage_that_fails_is_the_last_that_was_named(problem, said):
    with pytest.raises(ValueError):
        problem.Solve(start="nonsense")
    assert said(logging.INFO)[-1].startswith("contact on") and not said(logging.DEBUG)[-1].startswith("contact on")


def test_load_steps_and_growth_count(problem, said):
    LoadSteps(problem).Solve(0.5)
    assert "load step, factors 0.5" in said(logging.INFO)
    make_problem = lambda cracks: paper_problem(unstructured_mesh(0.1), load="A")
    CrackGrowth(make_problem, make_problem(None).body.cracks, GivenIncrement(0.1)).Run(1)
    assert "crack growth, step 1 of at most 1" in said(logging.INFO)


def test_coercivity_says_what_it_computes(problem, said):
    Coercivity(problem)
    assert said(logging.INFO)[-1] == f"smallest eigenvalue of K - K_γ against K, {problem.V.ndof} unknowns"


def test_silent_by_default():
    """In a fresh process, where nobody has set up logging: nothing on either stream, no thread."""
    script = (
        "import threading\nfrom study.paper import paper_problem, unstructured_mesh\nfrom ngsolve import ngsglobals\nngsglobals.msg_level = 0\n"
        "threads = threading.active_count()\npaper_problem(unstructured_mesh(0.2)).Solve()\nassert threading.active_count() == threads\n"
    )
    run = subprocess.run([sys.executable, "-W", "ignore", "-c", script], check=True, capture_output=True, text=True, timeout=120)
    assert (run.stdout, run.stderr) == ("", "")


@pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")  # of a mesh this coarse
@pytest.mark.parametrize("options, silent", [([], False), (["--quiet"], True)])
def test_the_command_says_what_it_does(options, silent, tmp_path, capsys):
    threads = threading.active_count()
    assert cli.main(["--maxh", "0.2", "--no-figures", "--output", str(tmp_path), *options]) == 0
    out, err = capsys.readouterr()
    assert ("solving for" in out) is ("assembling" in out) is not silent and err == ""
    logger = logging.getLogger("ngsxfem_contact")
    assert [type(handler) for handler in logger.handlers] == [logging.NullHandler] and logger.level == logging.NOTSET
    assert threading.active_count() == threads
