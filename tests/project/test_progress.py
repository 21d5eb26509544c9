"""Work that takes long says what it does; other work is silent, and so is all work if one wants it to be."""

import threading
from time import sleep

import pytest

from ngsxfem_contact import __main__ as cli
from ngsxfem_contact import progress
from ngsxfem_contact.fracture import GivenIncrement
from ngsxfem_contact.fracture.growth import CrackGrowth
from ngsxfem_contact.progress import doing
from study.paper import paper_problem, unstructured_mesh


@pytest.fixture
def lines(monkeypatch):
    """What is said, with less patience."""
    said = []
    monkeypatch.setattr(progress, "say", said.append)
    monkeypatch.setattr(progress, "PATIENCE", 0.05)
    return said


def wait_for(condition):
    for _ in range(200):
        if condition():
            return
        sleep(0.05)
    raise AssertionError("nothing was said in ten seconds")


def test_long_work_is_named_with_the_work_it_is_a_part_of(lines):
    with doing("growing"):
        with doing("solving"):
            wait_for(lambda: lines)
        assert lines[-1].endswith("s  growing: solving")
        with doing("extending"):
            wait_for(lambda: lines[-1].endswith("s  growing: extending"))


def test_a_line_is_said_once(lines):
    with doing("waiting"):
        with doing("for nothing"):
            wait_for(lambda: lines)
            sleep(0.3)
        sleep(0.3)
    assert len(lines) == 1


def test_nothing_is_said_after_the_end(lines):
    with pytest.raises(ZeroDivisionError), doing("failing"):
        wait_for(lambda: lines)
        1 / 0  # noqa: B018
    number = len(lines)
    sleep(0.3)
    assert len(lines) == number and progress._doing == []


def test_short_work_is_silent(lines, monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 60)
    with doing("counting"):
        sleep(0.2)
    assert lines == []


def test_patience_is_two_seconds():
    assert progress.PATIENCE == 2


def test_silent_by_option(capfd, monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.01)
    monkeypatch.setattr(progress, "say", None)
    threads = threading.active_count()
    with doing("sleeping"):
        assert threading.active_count() == threads
        sleep(0.1)
    assert capfd.readouterr() == ("", "")


def test_says_it_beside_the_results(capsys):
    progress.to_stderr("solving")
    assert capsys.readouterr() == ("", "solving\n")


def test_a_solve_names_its_stages(lines, monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.002)
    problem = paper_problem(unstructured_mesh(0.02))
    problem.Solve()
    assert any(f"solving: assembling, {problem.V.ndof} displacement unknowns" in line for line in lines)


def test_crack_growth_counts_its_steps(lines, monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.002)
    growth = CrackGrowth(lambda cracks: paper_problem(unstructured_mesh(0.1), load="A"), paper_problem(unstructured_mesh(0.1)).body.cracks, GivenIncrement(0.1))
    growth.Run(1)
    assert any("crack growth, step 1 of at most 1" in line for line in lines)


@pytest.mark.parametrize("options, silent", [([], False), (["--quiet"], True)])
def test_command_line(options, silent, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(progress, "say", progress.say)  # restored after the test
    assert cli.main(["--maxh", "0.4", "--no-figures", "--output", str(tmp_path), *options]) == 0
    assert ("solving for" in capsys.readouterr().out) is not silent
