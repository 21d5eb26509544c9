"""Figures 7 to 11 of [AHLMR12] from a solution and from the records of a study, and the rates of convergence.

records: dicts with a key "kind": convergence, reference, gamma0, chosen or infsup. Errors in them are absolute; figures
show them relative to the norms of the reference. Runs on several meshes of one size differ by their "realisation".
"""

import functools
import os
import textwrap
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ngsxfem_contact.files import write_whole
from ngsxfem_contact.plotting.plots import plot_body, plot_profile, pyplot

WIDTH = 3.4  # inches: a panel fills a column
STYLE = {
    **{"font.size": 9, "axes.titlesize": 9, "axes.labelsize": 9, "legend.fontsize": 8.5, "legend.title_fontsize": 8.5, "legend.frameon": False},
    **{"lines.linewidth": 1.2, "lines.markersize": 5, "errorbar.capsize": 2, "pdf.fonttype": 42},
}
PAIR_STYLES = {"P2/P1": ("#0072B2", "o"), "P2/P0": ("#D55E00", "s"), "P1+/P1": ("#009E73", "^"), "P1/P1": ("#CC79A7", "D"), "P1/P0": ("#E69F00", "v")}
NAMES = {"L2": "displacement, $L^2(\\Omega)$", "H1": "displacement, $H^1(\\Omega)$", "multiplier": "multiplier, $L^2(\\Gamma_C)$"}
SLOPES = {"L2": (2, 2.5), "H1": (1, 1.5), "multiplier": (0.5, 1)}  # drawn for comparison
REASONS = {"SingularSystem": "singular", "NotConverged": "not converged", "NotCoercive": "not coercive", "zero": "zero"}


class Curve(NamedTuple):
    """Over the realisations at each x; missing: (x, how many, of how many, why)."""

    x: np.ndarray
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    missing: list


class NoRecords(ValueError):
    """There is nothing to draw."""


def select(records, kind, **values):
    """The records of a kind with these values; raises NoRecords if there are none."""
    found = [r for r in records if r.get("kind") == kind and all(r.get(key) == value for key, value in values.items())]
    if not found:
        raise NoRecords(f"no records of kind {kind!r}" + "".join(f", {key} = {value}" for key, value in values.items()))
    return found


def grouped(records, *keys):
    """(values of the keys) → records, pairs in the order of PAIR_STYLES."""
    groups = {}
    for record in sorted(records, key=lambda r: list(PAIR_STYLES).index(r["pair"])):
        groups.setdefault(tuple(record.get(key) for key in keys), []).append(record)
    return groups


def error_of(quantity, norm=1.0):
    """record → error / norm, nan if there is none."""
    return lambda record: ((record.get("error") or {}).get(quantity) or np.nan) / norm


def curve(records, value, against="h"):
    """The Curve of value(record), nan where there is none; of equal realisations the last record counts."""
    points, missing = [], []
    for (x,), group in sorted(grouped(records, against).items()):
        runs = list({r.get("realisation"): r for r in group}.values())
        values = np.array([value(r) for r in runs], dtype=float)
        found = values[np.isfinite(values)]
        if len(found):
            points.append((x, found.mean(), found.min(), found.max()))
        if len(found) < len(runs):
            reason = runs[np.flatnonzero(~np.isfinite(values))[0]].get("reason") or ""
            missing.append((x, len(runs) - len(found), len(runs), REASONS.get(reason.split(":")[0], "no answer")))
    x, mean, low, high = np.array(points).reshape(-1, 4).T
    return Curve(x, mean, low, high, missing)


def slope(c):
    """Of log mean against log x by least squares; None for fewer than two points."""
    return float(np.polyfit(np.log(c.x), np.log(c.mean), 1)[0]) if len(c.x) > 1 else None


def fitted_rates(records):
    """Slopes of the mean errors against h, or None: dicts of pair, stabilisation, cone, mesh, the errors and n, the number of h with an answer."""
    keys, rates = ("pair", "stabilisation", "cone", "mesh"), []
    for values, group in grouped([r for r in records if r.get("kind") == "convergence"], *keys).items():
        curves = {quantity: curve(group, error_of(quantity)) for quantity in ("L2", "H1", "energy", "multiplier", "norm")}
        rates.append({**dict(zip(keys, values)), **{quantity: slope(c) for quantity, c in curves.items()}, "n": max(len(c.x) for c in curves.values())})
    return rates


def missing_note(c):
    """What the legend says of points without a value: "", or lines that begin with a line break."""
    notes = []
    for why in {m[-1]: None for m in c.missing}:
        sizes = [f"{x:g}" + (f" ({n} of {of})" if n < of else "") for x, n, of, reason in c.missing if reason == why]
        notes.append(f"{why} at h = " + ", ".join(sizes) if len(c.x) else why)
    return "".join("\n" + textwrap.fill(note, 40) for note in notes)


def largest_gamma0(records):
    """The zero of the coercivity for each pair, h and realisation; inf if not reached. It is 1 at γ_0 = 0, and linear."""
    limits = []
    for runs in grouped(records, "pair", "h", "realisation").values():
        points = [(r["gamma0"], r["coercivity"]) for r in runs if r.get("coercivity") is not None]
        b, at_b = min((p for p in points if p[1] <= 0), default=(np.inf, 0))
        a, at_a = max((p for p in points if p[1] > 0 and p[0] < b), default=(0, 1))
        limits.append(a + (b - a) * at_a / (at_a - at_b))
    return limits


def styled(function):
    """The function, run in STYLE."""
    return functools.wraps(function)(lambda *args, **options: pyplot().rc_context(STYLE)(function)(*args, **options))


def legend(figure, axes, **options):
    """Below the axes, every label once, curves first."""
    found = [item for ax in axes for item in zip(*ax.get_legend_handles_labels())]
    handles = {label: handle for handle, label in sorted(found, key=lambda item: not hasattr(item[0], "lines"))}
    figure.legend(handles.values(), handles, loc="outside lower center", **options)
    for ax in axes:
        ax.tick_params(which="both", labelsize=8)


def draw_curve(ax, c, pair, label, **options):
    """Marked line of the means, broken where all runs are missing, and bars of the ranges."""
    gaps = [(m[0], *3 * [np.nan]) for m in c.missing if m[1] == m[2]]
    x, mean, low, high = np.transpose(sorted([*zip(*c[:4]), *gaps]))
    spread = np.array([mean - low, high - mean])
    style = {"yerr": np.where(spread > 0, spread, np.nan)} if (spread > 0).any() else {}
    style |= {"color": PAIR_STYLES[pair][0], "marker": PAIR_STYLES[pair][1], "markerfacecolor": "none", "elinewidth": 0.7}
    ax.errorbar(x, mean, label=label, **style, **options)


def draw_slopes(ax, curves, slopes):
    """Light lines below all curves, from one point at the finest h."""
    x, y = (np.concatenate([getattr(c, name) for c in curves]) for name in ("x", "low"))
    ends = np.array([x.min(), x.max()])
    start = 0.6 * (y / (x / ends[0]) ** max(slopes)).min()
    for s in slopes:
        line = start * (ends / ends[0]) ** s
        ax.plot(ends, line, color="0.65", linewidth=0.8, linestyle="--", zorder=0)
        ax.annotate("$h$" if s == 1 else f"$h^{{{s:g}}}$", (ends[1], line[1]), (3, 0), textcoords="offset points", color="0.4", fontsize=8, va="center")


def log_axis(ax, label):
    """The logarithmic y axis, of one decade at least, with more ticks where it is short."""
    ax.set(yscale="log", ylabel=label)
    low, high = ax.get_ylim()
    wider = max(1.0, np.sqrt(10 * low / high))
    ax.set_ylim(low / wider, high * wider)
    if high / low < 30:
        ax.yaxis.set_major_locator(pyplot().LogLocator(subs=(1, 2, 5)))
        ax.yaxis.set_major_formatter(lambda value, _: f"{value:.1g}" if value > 9e-4 else "${}\\cdot 10^{{{}}}$".format(*map(int, f"{value:.0e}".split("e"))))
        ax.yaxis.set_minor_formatter(pyplot().NullFormatter())


def draw_against_h(ax, records, value, label, slopes=()):
    """A curve for each pair, named with its slope if slopes for comparison are given; dashes: a multiplier of order 0."""
    curves = {pair: curve(group, value) for (pair,), group in grouped(records, "pair").items()}
    sizes = sorted({r["h"] for r in records})
    ax.set(xscale="log", xlabel="mesh size h", xlim=(sizes[0] / 1.2, sizes[-1] * 1.5))
    ax.set_xticks(sizes, [f"{h:g}" for h in sizes])
    ax.set_xticks([], minor=True)
    for pair, c in curves.items():
        rate = slope(c) if slopes else None
        draw_curve(ax, c, pair, pair + ("" if rate is None else f" ({rate:.1f})") + missing_note(c), linestyle="--" if pair.endswith("/P0") else "-")
    if slopes and len({x for c in curves.values() for x in c.x}) > 1:
        draw_slopes(ax, curves.values(), slopes)
    log_axis(ax, label)


def shade(ax, limits):
    """Grey from the largest admissible γ_0 on."""
    right = ax.get_xlim()[1]
    low, high = min(*limits, right), min(max(limits), right)
    for start, end, grey, label in ((low, high, "0.92", "not coercive in some runs"), (high, right, "0.8", "not coercive")):
        if start < end:
            ax.axvspan(start, end, color=grey, linewidth=0, zorder=-2, label=label)
    ax.set_xlim(right=right)


def draw_chosen(ax, records, value, pair):
    """A star at the chosen γ_T/h_T: the median over the elements, with their range."""
    y, ranges = np.array([value(r) for r in records], dtype=float), np.array([r["gamma0"] for r in records], dtype=float)
    if np.isfinite(y).any():
        low, middle, high = ranges[:, 0].min(), np.median(ranges[:, 1]), ranges[:, 2].max()
        style = {"fmt": "*", "color": PAIR_STYLES[pair][0], "markeredgecolor": "black", "markersize": 9, "elinewidth": 1.5, "zorder": 5}
        ax.errorbar(middle, np.nanmean(y), xerr=[[middle - low], [high - middle]], label="$\\gamma_T/h_T$ as chosen (median, range)", **style)


def draw_against_gamma0(ax, records, value, **which):
    """A curve for each pair and h, crosses at the top where an answer is missing, the chosen γ, and the zone."""
    found = select(records, "gamma0", **which)
    all_gamma0, sizes = [r["gamma0"] for r in found], sorted({r["h"] for r in found}, reverse=True)
    ax.set(xscale="log", xlim=(min(all_gamma0) / 1.3, max(all_gamma0) * 1.3))
    for (pair, h), group in grouped(found, "pair", "h").items():
        c = curve(group, value, against="gamma0")
        draw_curve(ax, c, pair, f"{pair}, h = {h:g}", linestyle=["-", "--", ":", "-."][sizes.index(h) % 4])
        for gamma0, *_ in c.missing:
            ax.plot([gamma0], [0.96], "x", color=PAIR_STYLES[pair][0], transform=ax.get_xaxis_transform(), label="a run without an answer")
    meshes = {(r["pair"], r["h"], r.get("realisation")) for r in found}
    chosen = [r for r in records if r.get("kind") == "chosen" and (r["pair"], r["h"], r.get("realisation")) in meshes]
    for (pair, _), group in grouped(chosen, "pair", "h").items():
        draw_chosen(ax, group, value, pair)
    shade(ax, largest_gamma0(found))


@styled
def reference_von_mises(solution):
    """Figure 7a: the von Mises stress on the deformed body."""
    figure, ax = pyplot().subplots(figsize=(WIDTH, 3.1), layout="compressed")
    plot_body(solution, ax).collections[0].set_rasterized(True)
    ax.set_title(ax.get_title().replace(", ", "\n"))
    ax.get_legend().remove()
    legend(figure, [ax], ncols=2)
    return figure


@styled
def reference_contact_stress(solution):
    """Figure 7b: normal contact stress and gap along the crack."""
    figure, axes = pyplot().subplots(2, 1, figsize=(WIDTH, 3.6), sharex=True, layout="constrained")
    plot_profile(solution, ax=axes)
    axes[0].set_ylabel("contact stress $-\\lambda$")
    for ax in axes:
        ax.ticklabel_format(axis="y", scilimits=(-2, 3), useMathText=True)
    return figure


@styled
def convergence(records, stabilisation, cone="nonpositive", mesh=None):
    """Figures 8 ("none") and 9 ("larger"): relative errors against h, with their slopes, in L²(Ω), H¹(Ω) and L²(Γ_C); mesh=None: unstructured, if any is."""
    mesh = mesh or ("unstructured" if "unstructured" in {r.get("mesh") for r in records} else "structured")
    found = select(records, "convergence", stabilisation=stabilisation, cone=cone, mesh=mesh)
    norm = select(records, "reference")[-1]["norm"]
    figure = pyplot().figure(figsize=(3 * WIDTH, 4.2), layout="constrained")
    for part, letter, (quantity, name) in zip(figure.subfigures(1, 3), "abc", NAMES.items()):
        ax = part.subplots()
        draw_against_h(ax, found, error_of(quantity, norm[quantity]), "relative error", SLOPES[quantity])
        ax.set_title(f"({letter}) {name}")
        legend(part, [ax], title="mean and range over meshes (slope)")
    return figure


@styled
def multiplier_against_gamma0(records, pair):
    """Figures 10a (P1/P0) and 10b (P1/P1): the multiplier's relative error, and the smallest eigenvalue of K - K_γ against K."""
    select(records, "gamma0", pair=pair)
    norm = select(records, "reference")[-1]["norm"]["multiplier"]
    figure, axes = pyplot().subplots(2, 1, figsize=(WIDTH, 4.6), sharex=True, height_ratios=[2, 1], layout="constrained")
    draw_against_gamma0(axes[0], records, error_of("multiplier", norm), pair=pair)
    draw_against_gamma0(axes[1], records, lambda r: np.nan if r.get("coercivity") is None else np.clip(r["coercivity"], -1, 1), pair=pair)
    log_axis(axes[0], "relative error")
    axes[0].set_title(NAMES["multiplier"])
    axes[1].axhline(0, color="0.4", linewidth=0.6)
    axes[1].set(ylim=(-1.2, 1.2), ylabel="smallest\neigenvalue", xlabel="$\\gamma_0$")
    axes[1].set_yticks([-1, 0, 1], ["≤ −1", "0", "1"])
    legend(figure, axes)
    return figure


@styled
def displacement_against_gamma0(records):
    """Figure 11: relative errors of the displacement, with dotted lines at each pair's largest admissible γ_0."""
    found, norm = select(records, "gamma0"), select(records, "reference")[-1]["norm"]
    figure, axes = pyplot().subplots(1, 2, figsize=(2 * WIDTH, 3.8), layout="constrained")
    for ax, quantity in zip(axes, ("L2", "H1")):
        draw_against_gamma0(ax, records, error_of(quantity, norm[quantity]))
        for (pair,), group in grouped(found, "pair").items():
            ax.axvline(min(*largest_gamma0(group), ax.get_xlim()[1]), color=PAIR_STYLES[pair][0], linestyle=":", linewidth=1)
        log_axis(ax, "relative error")
        ax.set(xlabel="$\\gamma_0$", title=NAMES[quantity])
    legend(figure, axes, ncols=2)
    return figure


@styled
def inf_sup(records, negligible=1e-6):
    """β_h against h for each pair; values below `negligible` are zero up to round-off and only named."""
    found = [r if r["value"] is None else {**r, "reason": "zero"} for r in select(records, "infsup")]
    figure, ax = pyplot().subplots(figsize=(WIDTH, 3.8), layout="constrained")
    draw_against_h(ax, found, lambda r: r["value"] if (r["value"] or 0) > negligible else np.nan, "inf-sup constant $\\beta_h$")
    legend(figure, [ax], title="mean and range over meshes")
    return figure


@styled
def write_figures(folder, records, solution=None):
    """Writes figure_7a to figure_11 and figure_inf_sup, those that there is something for, as .png and .pdf; returns their paths."""
    folder, paths = Path(folder), []
    os.makedirs(folder, exist_ok=True)
    figures = {"7a": lambda: reference_von_mises(solution), "7b": lambda: reference_contact_stress(solution)} if solution is not None else {}
    figures |= {"8": lambda: convergence(records, "none"), "9": lambda: convergence(records, "larger")}
    figures |= {"10a": lambda: multiplier_against_gamma0(records, "P1/P0"), "10b": lambda: multiplier_against_gamma0(records, "P1/P1")}
    figures |= {"11": lambda: displacement_against_gamma0(records), "inf_sup": lambda: inf_sup(records)}
    for name, draw in figures.items():
        with suppress(NoRecords):
            figure = draw()
            for ending, options in (("png", {"dpi": 200}), ("pdf", {"dpi": 300, "metadata": {"CreationDate": None}})):
                save = lambda temporary, figure=figure, options=options: figure.savefig(temporary, **options)
                paths.append(write_whole(folder / f"figure_{name}.{ending}", save))
            pyplot().close(figure)
    return paths
