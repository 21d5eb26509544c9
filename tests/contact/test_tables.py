"""Profiles, tips, reactions, steps and growth as tables; and what objects say of themselves."""

import csv

import numpy as np
import pytest
from saved_cases import CASES, MATERIAL, Case, pull, solved, square

from ngsxfem_contact import ContactProblem, Coulomb, Crack, CrackedMesh, CrackFESpace, CrackGrowth, GivenIncrement, LoadCase, LoadSteps, TraceSpace
from ngsxfem_contact.contact import LinearCohesive, PathSteps
from ngsxfem_contact.tables import Table

pytestmark = pytest.mark.filterwarnings("ignore::ngsxfem_contact.errors.AccuracyWarning")


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def test_a_table_is_a_record_array(tmp_path):
    table = Table.Of({"tip": [0, 1], "K_I": np.array([0.1, 1 / 3]), "note": ["", "no <room>, here"]})
    assert table.K_I.sum() == table["K_I"].sum() == 0.1 + 1 / 3 and table[1].note == "no <room>, here" and table[1:].tip.tolist() == [1]
    assert type(table.K_I) is np.ndarray and type(table[:1]) is Table and table.dtype.names == ("tip", "K_I", "note")
    assert str(table).splitlines() == ["tip       K_I  note", "  0       0.1", "  1  0.333333  no <room>, here"]
    assert "<th>K_I</th>" in table._repr_html_() and "no &lt;room&gt;" in table._repr_html_()
    rows = read(table.SaveCSV(tmp_path / "t.csv"))
    assert rows[0] == ["tip", "K_I", "note"] and float(rows[2][1]) == 1 / 3 and rows[2][2] == "no <room>, here"
    with pytest.raises(FileNotFoundError, match="no folder"):
        table.SaveCSV(tmp_path / "none" / "t.csv")


def test_tables_without_rows_and_long_ones():
    assert len(Table.OfRows([], ["a", "b"])) == 0 and str(Table.OfRows([], ["a", "b"])) == "a  b"
    long = Table.Of({"n": np.arange(1000)})
    assert "... 1000 rows" in str(long) and len(str(long).splitlines()) == 42 and "1000 rows" in long._repr_html_()


def test_pandas_takes_every_table():
    pandas = pytest.importorskip("pandas")
    solution = solved()
    for table in (solution.Profile(), solution.Table(), solution.Reactions().table):
        frame = pandas.DataFrame(table)
        assert tuple(frame.columns) == table.dtype.names and len(frame) == len(table)
        assert all(np.array_equal(frame[name].to_numpy(), table[name], equal_nan=table[name].dtype.kind == "f") for name in table.dtype.names)


def test_tips_are_rows():
    V, W = Case(lambda: square(0.08), cracks=(Crack([(0.3, 0.45), (0.7, 0.5)]), Crack([(0.85, 1), (0.9, 0.93)])), law=Coulomb(0.3)).Spaces()
    problem = ContactProblem(V, W)
    pull(problem, V.TestFunction(), 1)
    solution = problem.Solve()
    table = solution.Table()
    assert table.tip.tolist() == [0, 1, 2] and table.crack.tolist() == [0, 0, 1]
    assert np.column_stack([table.x, table.y]).tolist() == [list(tip.point) for tip in solution.body.tips]
    for tip, row in enumerate(table):
        if row.method == "interaction":
            K, G = solution.StressIntensity(tip), solution.EnergyReleaseRate(tip)
            assert (row.K_I, row.K_II, row.error, row.G, row.G_error, row.irwin) == (*K, K.error, G.G, G.error, G.irwin)
            assert row["T"] == solution.TStress(tip).T and row.note == ""
        else:
            assert row.method == "modes" and "less than two elements" in row.note and np.isnan([row.G, row["T"]]).all()
            assert (row.K_I, row.K_II) == tuple(solution.StressIntensity(tip, "modes"))
    assert set(table.method) == {"interaction", "modes"}


def test_a_body_without_tips_has_an_empty_table():
    table = solved("closed").Table()
    assert len(table) == 0 and "K_I" in table.dtype.names


def test_profiles_and_reactions_are_tables(tmp_path):
    solution = solved()
    profile = solution.Profile(n=5)
    assert isinstance(profile, Table) and profile.dtype.names == ("s", "x", "y", "gap", "slip", "sigma_n", "sigma_t")
    assert len(read(profile.SaveCSV(tmp_path / "p.csv"))) == 6
    reactions = solution.Reactions()
    assert reactions.table.support.tolist() == ["bottom"]
    assert [*reactions.table[0]][1:] == [*reactions[0].force, reactions[0].moment]


def test_steps_are_rows():
    problem = CASES["friction"].Problem(*CASES["friction"].Spaces(), 6)
    steps = LoadSteps(problem)
    assert len(steps.table) == 0
    solutions = [steps.Solve(t) for t in (0.5, 1, 0.2)]
    table = steps.table
    assert table.t.tolist() == [0.5, 1, 0.2] and table.iterations.tolist() == [solution.report.iterations for solution in solutions]
    for row, solution in zip(table, solutions):
        assert row.contact_force == pytest.approx(solution.ContactForce(), rel=1e-12)
        assert row.tangential_force == pytest.approx(solution.TangentialForce(), rel=1e-12)
        assert row.dissipated == solution.DissipatedEnergy() and 0 < row.in_contact < 1
    two = LoadSteps(problem, [LoadCase(problem), LoadCase(problem)])
    two.Solve(0.5, 0.1)
    assert two.table.dtype.names[:2] == ("t_0", "t_1") and [*two.table[0]][:2] == [0.5, 0.1]


def test_steps_of_a_path_are_rows():
    V, W = Case(order=1, cracks=(Crack([(0, 0.5), (1, 0.5)]),), dirichlet="bottom|top").Spaces()
    problem = ContactProblem(V, W, law=LinearCohesive(0.1, 0.005))
    problem.SetDirichlet((0, 1), "top")
    steps, factors = PathSteps(problem), []
    for _ in range(2):
        steps.Solve(0.01)
        factors.append(steps.t)
    assert steps.table.t.tolist() == factors and (steps.table.contact_force > 0).all()


def test_growth_is_a_table(tmp_path):
    def make(cracks):
        body = CrackedMesh(mesh, *cracks)
        V = CrackFESpace(body, order=2, material=MATERIAL, dirichlet="bottom")
        problem = ContactProblem(V, TraceSpace(body, order=1))
        pull(problem, V.TestFunction(), 1)
        return problem

    mesh = square(0.1)
    growth = CrackGrowth(make, [Crack([(0, 0.5), (0.4, 0.5)])], GivenIncrement(0.15))
    table = growth.Run(2)
    assert isinstance(table, Table) and table.step.tolist() == [0, 1] and table.K_I[0] == growth.rows[0].K_I
    assert read(growth.SaveTable(tmp_path / "g.csv")) == read(table.SaveCSV(tmp_path / "t.csv"))


def test_objects_say_what_they_are():
    solution = solved("several")
    problem, V, W = solution.problem, solution.problem.V, solution.problem.W
    said = [
        (solution.body, ["52 triangles", "mouth (0, 0.5), tip (0.5, 0.52)"]),
        (V, ["order     2", f"{V.ndof}, of them", "16 at 4 tips", "Elasticity"]),
        (W, ["nodal", f"{W.ndof} on 3 cracks"]),
        (problem, ["3 cracks, 4 tips", "Coulomb", "Joint", "1 term in f", "bottom", "BarbosaHughes"]),
        (solution, [f"{V.ndof} unknowns", "converged, residual", "% open"]),
    ]
    for thing, words in said:
        assert repr(thing).splitlines()[0] == type(thing).__name__ and all(word in repr(thing) for word in words)
        assert thing._repr_html_().startswith(f"<b>{type(thing).__name__}</b><table>") and "<th>" in thing._repr_html_()
    assert "3 terms in" not in repr(solved("everything").problem) and "in a" in repr(solved("everything").problem)
    steps = LoadSteps(CASES["friction"].Problem(*CASES["friction"].Spaces(), 6))
    step = steps.Solve(1)
    assert "u not recovered yet" in repr(step) and "nodes: contact" in repr(step)
