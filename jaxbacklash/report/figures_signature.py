"""Figures of chaos as a signature of the play: the exponent over the drive, what levels say of the play, what pattern fits."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..signature import ExponentMap, PatternMatch, PlayFromChaos, Worth
from .drawing import drawn_in_style, empty_figure, new_figure, readable_log
from .style import GAP, HELDOUT, INK, MEASURED, MEDIUM, MODEL, SHORT, pretty_unit

NAMES = {"backlash": "total play [deg]", "linear_gravity.G": "gravity G, negative hanging [N m]"}


@drawn_in_style
def exponent_over_drive(map_: ExponentMap, found: PlayFromChaos | None = None) -> Figure:
    """The exponent over amplitude / play from every start, and the measured levels where the inferred play puts them.

    Parameters
    ----------
    map_ : without further axes
    found : the play to place its levels by; a bar across is the play's interval, a bar along the exponent's
    """
    figure = new_figure(MEDIUM)
    ax = figure.subplots()
    exponent, chaotic = map_.exponent, map_.chaotic
    size = 2.5 if map_.ratios.size > 250 else 5.0
    for row, seen in zip(exponent, chaotic):
        ax.plot(map_.ratios[seen], row[seen], ".", color=MEASURED, ms=size, mew=0)
        ax.plot(map_.ratios[~seen], row[~seen], ".", color=GAP, ms=size, mew=0)
    ax.plot([], [], ".", color=MEASURED, ms=6, label="chaotic")
    ax.plot([], [], ".", color=GAP, ms=6, label="regular")
    ax.axhline(0.0, color=INK, lw=0.6)
    low, high = map_.ratios[0], map_.ratios[-1]
    if found is not None and found.value is not None and found.interval is not None:
        _levels(ax, found, found.value, found.interval)
    floor = min(float(np.nanmin(exponent)), -0.2)
    ax.set_ylim(1.1 * floor, 1.15 * max(float(np.nanmax(exponent)), 0.5))
    readable_log(ax, "x", float(low), float(high))
    _more_ticks(ax, float(low), float(high))
    ax.set(xlabel="amplitude of the base / total play", ylabel="largest exponent [1/drive period]")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.2)
    return figure


def _levels(ax: Axes, found: PlayFromChaos, play: float, interval: tuple[float, float]) -> None:
    """Measured levels over amplitude / play: numbers with their bars, regular ones at zero."""
    for kind in ("chaotic", "regular"):
        chosen = [level for level in found.levels if level.word == kind]
        if not chosen:
            continue
        at = np.array([level.amplitude for level in chosen])
        place = at / play
        across = np.abs(np.array([at / interval[1], at / interval[0]]) - place)
        value = np.array([level.exponent or 0.0 for level in chosen])
        along = 1.96 * np.array([level.stderr or 0.0 for level in chosen])
        mark, fill = ("s", MODEL) if kind == "chaotic" else ("v", "none")
        ax.errorbar(place, value, along, across, mark, color=MODEL, mfc=fill, ms=6, lw=1.2, zorder=5, label=f"measured, {kind}")


@drawn_in_style
def play_likelihood(found: PlayFromChaos, *, truth: float | None = None, fit: tuple[float, float] | None = None) -> Figure:
    """What every level says of the play, a row each, and all together below.

    Parameters
    ----------
    found : the inference
    truth : the true play, where known [rad]
    fit : the interval of a direct fit, for comparison [rad]
    """
    order = np.argsort([level.amplitude for level in found.levels])
    figure = new_figure(MEDIUM + 0.6)
    upper, lower = figure.subplots(2, 1, height_ratios=(1.3, 1.0), sharex=True)
    plays = np.degrees(found.plays)
    for row, k in enumerate(order):
        level = found.levels[k]
        colour = MODEL if level.word == "chaotic" else MEASURED if level.word == "regular" else GAP
        upper.fill_between(plays, row, row + 0.85 * found.each[k], color=colour, lw=0, alpha=0.8)
    words = [f"{np.degrees(found.levels[k].amplitude):.3g}° {found.levels[k].word}" for k in order]
    upper.set_yticks(np.arange(len(order)) + 0.35, words)
    upper.grid(False, axis="y")
    upper.set_title("likelihood of each drive level alone")
    lower.fill_between(plays, 0.0, found.density, color=HELDOUT, lw=0, alpha=0.8)
    lower.set(ylabel="probability density", xlabel="total play [deg]", ylim=(0.0, 1.15 * float(found.density.max())))
    lower.set_title(f"all levels together: {found.bits:.1f} bit")
    for ax in (upper, lower):
        if truth is not None:
            ax.axvline(np.degrees(truth), color=INK, lw=1.0, ls="--", label="true play")
        if fit is not None:
            ax.axvspan(*np.degrees(fit), color=MODEL, lw=1.0, label="direct fit, 95 %")
    if truth is not None or fit is not None:
        lower.legend(loc="upper right")
    readable_log(lower, "x", float(plays[0]), float(plays[-1]))
    _more_ticks(lower, float(plays[0]), float(plays[-1]))
    return figure


def _more_ticks(ax: Axes, low: float, high: float) -> None:
    """Ticks at round numbers for a logarithmic axis that is hardly longer than a decade."""
    if high / low < 12.0:
        ticks = [tick for tick in MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= tick <= high]
        ax.set_xticks(ticks, [f"{tick:.3g}" for tick in ticks])


@drawn_in_style
def pattern_region(match: PatternMatch, across: str = "linear_gravity.G", up: str = "backlash") -> Figure:
    """Where over two parameters the pattern appears: the best chance and the mean chance over all others."""
    names = list(match.axes)
    if across not in names or up not in names or across == up:
        return empty_figure(f"The search has no two axes {across} and {up}.")
    others = tuple(i for i, name in enumerate(names) if name not in (across, up))
    figure = new_figure(MEDIUM)
    axes = figure.subplots(1, 2, sharey=True)
    x, y = match.axes[across], match.axes[up]
    scale = np.degrees if up == "backlash" else np.asarray
    for ax, values, title in (
        (axes[0], match.chance.max(axis=others), "best chance"), (axes[1], match.chance.mean(axis=others), "mean chance"),
    ):  # fmt: skip
        shown = values if names.index(across) > names.index(up) else values.T
        image = ax.pcolormesh(x, scale(y), shown, cmap="viridis", vmin=0.0, rasterized=True)
        figure.colorbar(image, ax=ax, shrink=0.85).ax.tick_params(labelsize=7)
        ax.set(xlabel=NAMES.get(across, across), title=f"{title} of the pattern, over the rest")
        ax.grid(False)
    axes[0].set_ylabel(NAMES.get(up, up))
    return figure


@drawn_in_style
def worth_over_play(results: dict[str, Worth], unit: str = "deg") -> Figure:
    """Half width of the play's interval over the true play, for several sets of drive levels; nothing found lies at the top.

    Parameters
    ----------
    results : what to call each set of levels, and its imagined experiments
    """
    figure = new_figure(MEDIUM)
    axes = figure.subplots(1, len(results), sharey=True, squeeze=False)[0]
    for ax, (name, one) in zip(axes, results.items()):
        some, held = one.determined, one.held
        plays = np.degrees(one.play)
        for chosen, colour, mark, words in (
            (some & held, MEASURED, "o", "interval holds the truth"), (some & ~held, MODEL, "x", "misses it"),
        ):  # fmt: skip
            ax.plot(plays[chosen], 100.0 * one.half_width[chosen], mark, color=colour, ms=3.5, mew=0.8, label=words)
        ax.plot(plays[~some], np.full(int((~some).sum()), 90.0), "v", color=GAP, ms=4, label="no play determined")
        ax.set(xlabel=f"true total play [{unit}]", title=name)
        readable_log(ax, "y", 0.2, 100.0)
    axes[0].set_ylabel("half width of the interval [%]")
    axes[0].legend(loc="lower right")
    return figure


@drawn_in_style
def exponent_bars(
    amplitudes: Any, tangent: Any, series: Any, intervals: Any, words: list[str], *, paper: Any = None, unit: str = "bit/period"
) -> Figure:
    """Exponents at several drive levels: from the model's tangent, from the measured series, and as published.

    Parameters
    ----------
    amplitudes : (L,) [deg]
    tangent : (S, L) from S starts; regular motion counts as 0, as in the paper's Table 2
    series : (L,) from the measured series, NaN where the verdict gives no number
    intervals : (L, 2) their intervals
    words : (L,) the verdicts
    paper : (L,) published values
    unit : of all of them
    """
    tangent, series, intervals = np.atleast_2d(tangent), np.asarray(series, float), np.asarray(intervals, float)
    places = np.arange(len(words))
    figure = new_figure(MEDIUM)
    ax = figure.subplots()
    width = 0.27
    if paper is not None:
        ax.bar(places - width, np.asarray(paper), width, color=GAP, label="paper, Table 2")
    inside = np.maximum(tangent, 0.0)
    middle = inside.mean(axis=0)
    ax.bar(places, middle, width, color=MODEL, label="model's tangent; line: its starts")
    ax.vlines(places, inside.min(axis=0), inside.max(axis=0), color=INK, lw=1.2)
    known = np.isfinite(series)
    shown = np.where(known, series, 0.0)
    ax.bar(places + width, shown, width, color=MEASURED, label="noisy series, 95 %")
    reach = np.abs(np.array([shown - intervals[:, 0], intervals[:, 1] - shown]))
    ax.errorbar(places[known] + width, shown[known], reach[:, known], fmt="none", color=INK, lw=1.0, capsize=2)
    for place, word in zip(places, words):
        ax.annotate(word, (place + width, 0.0), (0, -2), textcoords="offset points", ha="center", va="top", fontsize=6.5,
                    rotation=0, color=MEASURED)  # fmt: skip
    ax.set_xticks(places, [f"{a:g}°" for a in np.asarray(amplitudes)])
    ax.tick_params(axis="x", pad=10, length=0)
    ax.set(xlabel="amplitude of the base", ylabel=f"largest exponent [{pretty_unit(unit)}]")
    ax.set_ylim(0.0, None)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2)
    return figure


@drawn_in_style
def phase_plots(panels: list[tuple[str, Any, bool]], delay: int, unit: str = "deg") -> Figure:
    """Series against themselves one delay later, one panel a drive level (the paper's Figure 16).

    Parameters
    ----------
    panels : title, series (N,) and whether it is chaotic, in order
    delay : samples, the same for all
    """
    columns = 4
    rows = -(-len(panels) // columns)
    figure = new_figure(0.4 + 2.1 * rows)
    axes = figure.subplots(rows, columns, squeeze=False)
    for ax, (title, values, chaotic) in zip(axes.ravel(), panels):
        values = np.asarray(values)
        ax.plot(values[:-delay], values[delay:], lw=0.3, color=MODEL if chaotic else MEASURED, rasterized=True)
        ax.set_title(title)
        ax.set_aspect("equal", adjustable="datalim")
        ax.tick_params(labelsize=7)
    for ax in axes.ravel()[len(panels) :]:
        ax.set_visible(False)
    figure.supxlabel(f"now [{unit}]", fontsize=9)
    figure.supylabel(f"{delay} samples later [{unit}]", fontsize=9)
    return figure


@drawn_in_style
def cleaned_signal(t: Any, noisy: Any, cleaned: Any, truth: Any = None, unit: str = "deg") -> Figure:
    """A stretch of a signal as measured and with its noise taken off (the paper's Figure 17); below, what is left of each."""
    t, noisy, cleaned = (np.asarray(a) for a in (t, noisy, cleaned))
    figure = new_figure(MEDIUM if truth is not None else SHORT)
    axes = figure.subplots(2 if truth is not None else 1, 1, sharex=True, squeeze=False)[:, 0]
    axes[0].plot(t, noisy, ".", color=MEASURED, ms=2.0, label="as measured")
    axes[0].plot(t, cleaned, "-", color=MODEL, lw=1.0, label="noise taken off")
    axes[0].set_ylabel(f"z [{unit}]")
    if truth is not None:
        axes[1].plot(t, noisy - truth, ".", color=MEASURED, ms=2.0)
        axes[1].plot(t, cleaned - truth, "-", color=MODEL, lw=1.0)
        axes[1].set_ylabel(f"error [{unit}]")
    axes[-1].set(xlabel="time [s]", xlim=(t[0], t[-1]))
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


@drawn_in_style
def cao_before_and_after(dimensions: Any, noisy: Any, cleaned: Any, chosen: tuple[int | None, int | None]) -> Figure:
    """Cao's E1 over the dimension, solid as measured and dashed with the noise taken off (the paper's Figure 18)."""
    figure = new_figure(SHORT + 0.3)
    ax = figure.subplots()
    for values, line, mark, colour, name, at in (
        (noisy, "-", "o", MEASURED, "as measured", chosen[0]), (cleaned, "--", "s", MODEL, "noise taken off", chosen[1]),
    ):  # fmt: skip
        told = "no dimension found" if at is None else f"dimension {at}"
        ax.plot(dimensions, values, mark + line, color=colour, ms=4, label=f"{name}: {told}")
        if at is not None:
            ax.plot(at, np.asarray(values)[at - 1], mark, color=colour, ms=10, mfc="none", mew=1.6)
    ax.axhline(1.0, color=INK, lw=0.5, ls=":")
    ax.set(xlabel="embedding dimension", ylabel="Cao's E1", ylim=(0.0, 1.15))
    ax.legend(loc="lower right")
    return figure
