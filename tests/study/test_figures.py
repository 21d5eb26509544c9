"""The figures of the study and the rates behind them, from made-up records with known rates."""

import json
import os

import numpy as np
import pytest

from study import figures
from study.paper import paper_problem, unstructured_mesh

pytest.importorskip("matplotlib").use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

SIZES = (0.088, 0.057, 0.03, 0.016, 0.008)
PAIRS = ("P2/P1", "P2/P0", "P1+/P1", "P1/P1", "P1/P0")
ABSOLUTE = {"L2": 6.3e-3, "H1": 3.2e-2, "energy": 3e-2, "multiplier": 2.27e-2, "norm": 4e-2}
REFERENCE = {"kind": "reference", "norm": ABSOLUTE}
SINGULAR = "SingularSystem: 3 of 20 multipliers act on no displacement"


def rates(pair):
    L2, H1, multiplier = (2.4, 1.5, 1.0) if pair.startswith("P2") else (2.0, 1.0, 0.9)
    return {"L2": L2, "H1": H1, "energy": H1, "multiplier": 0.42 if pair == "P1/P0" else multiplier, "norm": H1}


def run(pair, h, realisation, stabilisation, noise):
    size = 0.4 if pair.startswith("P2") else 1.0 + 0.3 * PAIRS.index(pair)
    error = {q: size * ABSOLUTE[q] * h ** rates(pair)[q] * noise() for q in ABSOLUTE}
    failed = pair == "P1/P1" and stabilisation == "none" and (h == 0.03 or (h, realisation) == (0.016, 1))
    return {
        **{"kind": "convergence", "mesh": "unstructured", "h": h, "realisation": realisation, "pair": pair, "stabilisation": stabilisation},
        **{"cone": "nonpositive", "error": None if failed else error, "reason": SINGULAR if failed else None},
    }


def gamma0_runs(pair, limit, h=0.03, realisations=3, noise=lambda: 1.0):
    """Errors that fall up to the limit and are erratic beyond it; coercivity is linear in γ_0."""
    for k in range(realisations):
        at = limit * (1 + 0.2 * k)
        for gamma0 in np.logspace(-4, 1, 16):
            wild = noise() ** 8 if gamma0 > at else 1.0
            error = {q: value * (0.02 + (0.1 * wild / (1 + 300 * gamma0) if q == "multiplier" else 0)) * noise() for q, value in ABSOLUTE.items()}
            found = {"coercivity": 1 - gamma0 / at, "error": None if gamma0 > 8 and k == 1 else error, "oscillation": 0.1}
            yield {"kind": "gamma0", "pair": pair, "h": h, "realisation": k, "gamma0": gamma0, **found}
        error = {q: value * 0.022 for q, value in ABSOLUTE.items()}
        yield {"kind": "chosen", "pair": pair, "h": h, "realisation": k, "gamma0": [at / 9, at / 2, at * 2], "coercivity": 0.52, "error": error}


def study(spread=0.15, realisations=5):
    """The records of a whole study, as they come back from a file of JSON lines."""
    random = np.random.default_rng(1)
    noise = lambda: float(np.exp(spread * random.uniform(-1, 1)))
    runs = [(pair, h, k) for pair in PAIRS for h in SIZES for k in range(realisations)]
    records = [run(*key, stabilisation, noise) for stabilisation in ("none", "larger") for key in runs] + [REFERENCE]
    for pair, limit in (("P1/P0", 0.14), ("P1/P1", 0.12), ("P2/P1", 0.03)):
        records += gamma0_runs(pair, limit, noise=noise)
    records += [
        {"kind": "infsup", "pair": p, "h": h, "realisation": k, "value": 1e-9 if p == "P1/P1" and h < 0.05 else 0.2 * h**0.05 * noise()} for p, h, k in runs
    ]
    return [json.loads(json.dumps(record)) for record in records]


@pytest.fixture(scope="module")
def records():
    return study()


@pytest.fixture(autouse=True)
def no_figures_left():
    yield
    plt.close("all")


def test_rates_are_recovered(records):
    found = {(r["pair"], r["stabilisation"]): r for r in figures.fitted_rates(records)}
    assert len(found) == 10 and {(r["cone"], r["mesh"]) for r in found.values()} == {("nonpositive", "unstructured")}
    for (pair, stabilisation), rate in found.items():
        assert rate["n"] == (4 if (pair, stabilisation) == ("P1/P1", "none") else 5)
        for quantity, exact in rates(pair).items():
            assert rate[quantity] == pytest.approx(exact, abs=0.12), (pair, quantity)
    json.dumps(list(found.values()), allow_nan=False)


def test_rates_without_noise_are_exact():
    for rate in figures.fitted_rates(study(spread=0, realisations=1)):
        assert {q: rate[q] for q in ABSOLUTE} == pytest.approx(rates(rate["pair"]), rel=1e-10)


def test_a_rate_needs_two_sizes():
    one = [run("P2/P1", 0.03, k, "none", lambda: 1) for k in range(3)]
    assert [(r["L2"], r["n"]) for r in figures.fitted_rates(one)] == [(None, 1)]
    none = [r | {"error": None, "reason": SINGULAR} for r in one]
    assert [(r["L2"], r["n"]) for r in figures.fitted_rates(none)] == [(None, 0)]
    assert figures.fitted_rates([REFERENCE]) == []


def test_a_curve_has_the_mean_the_range_and_what_is_missing():
    runs = [{"h": 0.1, "realisation": k, "error": {"L2": value}} for k, value in enumerate((1.0, 2.0, 6.0))]
    runs += [{"h": 0.1, "realisation": 3, "error": None, "reason": SINGULAR}, {"h": 0.2, "realisation": 0, "error": None, "reason": "NotConverged: no"}]
    c = figures.curve([r | {"pair": "P1/P1"} for r in runs], figures.error_of("L2", 2.0))
    assert [a.tolist() for a in c[:4]] == [[0.1], [1.5], [0.5], [3.0]]
    assert c.missing == [(0.1, 1, 4, "singular"), (0.2, 1, 1, "not converged")]
    assert figures.missing_note(c) == "\nsingular at h = 0.1 (1 of 4)\nnot converged at h = 0.2"


def test_a_repeated_record_counts_once():
    runs = [{"pair": "P1/P1", "h": 0.1, "realisation": 0, "error": {"L2": value}} for value in (1.0, 2.0)]
    assert figures.curve(runs, figures.error_of("L2")).mean == [2.0]


def test_the_largest_gamma0_is_the_zero_of_the_coercivity(records):
    for pair, limit in (("P1/P0", 0.14), ("P1/P1", 0.12), ("P2/P1", 0.03)):
        found = figures.largest_gamma0(figures.select(records, "gamma0", pair=pair))
        assert found == pytest.approx([limit, 1.2 * limit, 1.4 * limit], rel=1e-10)
    safe = [r for r in records if r["kind"] == "gamma0" and r["coercivity"] > 0]
    assert set(figures.largest_gamma0(safe)) == {np.inf}
    beyond = [r for r in gamma0_runs("P1/P0", 0.14) if r["kind"] == "gamma0" and r["gamma0"] > 1]
    assert figures.largest_gamma0(beyond) == pytest.approx([0.14, 0.168, 0.196])


def legend_labels(figure):
    parts = figure.subfigs or [figure]
    return [[text.get_text() for text in part.legends[0].get_texts()] for part in parts]


def marked(ax, colour):
    """The points of the curve in this colour."""
    return next(line for line in ax.lines if line.get_color() == colour and line.get_marker() not in ("None", "_", "|", "*", "x")).get_xydata()


def test_convergence_shows_relative_means_and_slopes(records):
    figure = figures.convergence(records, "none")
    assert [ax.get_title()[:3] for ax in figure.axes] == ["(a)", "(b)", "(c)"]
    assert {(ax.get_xscale(), ax.get_yscale()) for ax in figure.axes} == {("log", "log")}
    labels = legend_labels(figure)
    assert [label.split()[0] for label in labels[0]] == list(PAIRS)
    assert labels[0][0] == "P2/P1 (2.4)" and labels[1][0] == "P2/P1 (1.5)"
    assert all(panel[3].endswith("singular at h = 0.016 (1 of 5), 0.03") for panel in labels)
    x, y = marked(figure.axes[0], "#0072B2").T
    assert x.tolist() == sorted(SIZES)
    assert y == pytest.approx(0.4 * x**2.4, rel=0.15)
    broken = marked(figure.axes[0], "#CC79A7")
    assert broken[:, 0].tolist() == sorted(SIZES) and np.isnan(broken[:, 1]).tolist() == [False, False, True, False, False]
    assert not any("singular" in label for panel in legend_labels(figures.convergence(records, "larger")) for label in panel)


def test_a_pair_that_is_never_solved_is_named(records):
    lost = [r | {"error": None, "reason": SINGULAR} if r.get("pair") == "P1/P1" else r for r in records]
    assert legend_labels(figures.convergence(lost, "none"))[2][3] == "P1/P1\nsingular"
    nothing = [REFERENCE, *(r | {"error": None, "reason": SINGULAR} for r in lost if r["kind"] == "convergence")]
    figures.convergence(nothing, "none").canvas.draw()


def test_structured_meshes_are_drawn_where_all_are(records):
    both = records + [r | {"mesh": "structured", "h": r["h"] / 10} for r in records if r["kind"] == "convergence"]
    assert marked(figures.convergence(both, "none").axes[0], "#0072B2")[:, 0].tolist() == sorted(SIZES)
    structured = [r | {"mesh": "structured"} for r in records]
    assert len(figures.convergence(structured, "none").axes) == 3


def spans(ax):
    return sorted((p.get_extents().x0, p.get_extents().x1) for p in (patch.get_path().transformed(patch.get_patch_transform()) for patch in ax.patches))


def test_gamma0_shows_the_zone_without_coercivity(records):
    figure = figures.multiplier_against_gamma0(records, "P1/P0")
    above, below = figure.axes
    for ax in (above, below):
        assert spans(ax) == [pytest.approx((0.14, 0.196)), pytest.approx((0.196, 13))]
        assert ax.get_xscale() == "log" and ax.get_xlim() == pytest.approx((1e-4 / 1.3, 13))
    assert marked(below, "#E69F00")[:, 1].min() == -1 and above.get_yscale() == "log"
    assert [list(line.get_xdata()) for line in above.lines if line.get_marker() == "x"] == [[10.0]]
    star = next(line for line in above.lines if line.get_marker() == "*")
    assert star.get_xydata()[0] == pytest.approx([1.2 * 0.14 / 2, 0.022])
    assert [label for label in legend_labels(figure)[0] if "not coercive" in label] == ["not coercive in some runs", "not coercive"]


def test_gamma0_without_a_limit_or_a_choice(records):
    safe = [r for r in records if r["kind"] == "reference" or r["kind"] == "gamma0" and r["gamma0"] < 0.02]
    for figure in (figures.multiplier_against_gamma0(safe, "P1/P1"), figures.displacement_against_gamma0(safe)):
        figure.canvas.draw()
        assert not any(ax.patches for ax in figure.axes)
        assert not any("chosen" in label or "coercive" in label for label in legend_labels(figure)[0])


def test_a_choice_on_other_meshes_is_left_out(records):
    first = [r for r in records if r["kind"] != "gamma0" or r["realisation"] == 0]
    above = figures.multiplier_against_gamma0(first, "P1/P0").axes[0]
    star = next(line for line in above.lines if line.get_marker() == "*")
    assert star.get_xdata()[0] == pytest.approx(0.07) and spans(above) == [pytest.approx((0.14, 13))]


def test_displacement_against_gamma0(records):
    figure = figures.displacement_against_gamma0(records)
    assert [ax.get_ylim()[1] / ax.get_ylim()[0] > 9.99 for ax in figure.axes] == [True, True]  # flat curves look flat
    assert [label for label in legend_labels(figure)[0] if label.startswith("P")] == [f"{p}, h = 0.03" for p in ("P2/P1", "P1/P1", "P1/P0")]
    at = [line.get_xdata()[0] for line in figure.axes[0].lines if line.get_linestyle() == ":"]
    assert at == pytest.approx([0.03, 0.12, 0.14])


def test_inf_sup_names_zeros(records):
    figure = figures.inf_sup(records + [{"kind": "infsup", "pair": "P1/P0", "h": 0.03, "realisation": 9, "value": None}])
    labels = legend_labels(figure)[0]
    assert labels[3:] == ["P1/P1\nzero at h = 0.008, 0.016, 0.03", "P1/P0\nno answer at h = 0.03 (1 of 6)"]
    assert figure.axes[0].get_ylim()[0] > 1e-3


@pytest.fixture(scope="module")
def solution():
    return paper_problem(unstructured_mesh(0.1), pair="P1/P0").Solve()


def test_contact_stress_and_gap(solution):
    axes = figures.reference_contact_stress(solution).axes
    assert [ax.get_ylabel() for ax in axes] == ["contact stress $-\\lambda$", "normal gap $g_n$"]
    assert axes[0].lines[-1].get_ydata() == pytest.approx(-solution.Profile(n=400).sigma_n)


def test_von_mises(solution):
    figure = figures.reference_von_mises(solution)
    assert figure.axes[0].collections[0].get_rasterized() and legend_labels(figure) == [["plus lip", "minus lip"]]
    assert outside(figure) == []


@pytest.fixture
def unsaved(monkeypatch):
    """Figures are drawn up, and their files are empty: what takes long is laid out and saved in other tests."""
    monkeypatch.setattr(plt.Figure, "savefig", lambda figure, path, **options: path.write_bytes(b" "))


def test_every_file_is_named(records, solution, tmp_path, unsaved):
    paths = figures.write_figures(tmp_path / "new", records, solution)
    names = [f"figure_{name}.{ending}" for name in ("7a", "7b", "8", "9", "10a", "10b", "11", "inf_sup") for ending in ("png", "pdf")]
    assert [path.name for path in paths] == names
    assert sorted(p.name for p in (tmp_path / "new").iterdir()) == sorted(names)
    assert plt.get_fignums() == []


def test_files_are_pictures(records, solution, tmp_path):
    paths = figures.write_figures(tmp_path, [r for r in records if r["kind"] == "infsup"], solution)
    assert [path.name for path in paths] == [f"figure_{name}.{ending}" for name in ("7a", "7b", "inf_sup") for ending in ("png", "pdf")]
    assert all(path.read_bytes()[:4] == (b"\x89PNG" if path.suffix == ".png" else b"%PDF") for path in paths)


def test_figures_without_records_are_skipped(records, tmp_path, unsaved):
    names = lambda *kinds: [p.stem for p in figures.write_figures(tmp_path, [r for r in records if r["kind"] in kinds]) if p.suffix == ".png"]
    assert names() == names("reference") == names("convergence", "gamma0", "chosen") == []  # relative errors need a reference
    assert names("infsup") == ["figure_inf_sup"]
    assert names("convergence", "reference") == ["figure_8", "figure_9"]
    assert names("gamma0", "reference") == ["figure_10a", "figure_10b", "figure_11"]
    assert plt.get_fignums() == []
    with pytest.raises(figures.NoRecords, match="stabilisation = both"):
        figures.convergence(records, "both")


def test_an_interrupted_run_leaves_the_file_before(records, tmp_path, monkeypatch):
    (tmp_path / "figure_inf_sup.png").write_text("before")

    def interrupted(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        figures.write_figures(tmp_path, [r for r in records if r["kind"] == "infsup"])
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("figure_inf_sup.png", "before")]


def test_files_do_not_depend_on_when_they_are_written(records, tmp_path):
    for path in figures.write_figures(tmp_path, [r for r in records if r["kind"] == "infsup"]):
        assert b"Date" not in path.read_bytes()


def outside(figure):
    """Texts and axes that leave the figure, and legends that cover axes."""
    figure.draw_without_rendering()
    width, height = figure.bbox.size
    parts = figure.subfigs or [figure]
    boxes = [(ax.get_title(), ax.get_tightbbox()) for ax in figure.axes] + [("legend", part.legends[0].get_window_extent()) for part in parts]
    bad = [name for name, box in boxes if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1]
    return bad + [ax.get_title() for part in parts for ax in part.axes if part.legends[0].get_window_extent().overlaps(ax.get_tightbbox())]


def test_nothing_overlaps_or_leaves_the_figure(records):
    """The figures with the longest legends, one of each kind."""
    drawn = [figures.convergence(records, "none"), figures.displacement_against_gamma0(records)]
    drawn += [figures.multiplier_against_gamma0(records, "P1/P0"), figures.inf_sup(records)]
    assert [outside(figure) for figure in drawn] == [[]] * 4
    sizes = {text.get_fontsize() for figure in drawn for ax in figure.axes for text in ax.get_xticklabels() + ax.get_yticklabels()}
    assert min(sizes) >= 8
