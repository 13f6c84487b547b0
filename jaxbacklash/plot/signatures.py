"""Figures of chaos as a signature of the play: the exponent over the drive, what levels say of the play, what pattern fits."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ..signature import ExpectedPrecision, ExponentMap, PatternMatch, PlayFromChaos
from .drawing import Where, empty, ink, legend_above, panels, picture, readable_log
from .style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL

NAMES = {"backlash": "total play [deg]", "linear_gravity.G": "gravity G, negative hanging [N m]"}


@picture
def exponent_over_drive(map_: ExponentMap, found: PlayFromChaos | None = None, *, ax: Where = None) -> list[Axes]:
    """The exponent over amplitude / play from every start, and the measured levels where the inferred play puts them.

    Parameters
    ----------
    map_ : without further axes
    found : the play to place its levels by; a bar across is the play's interval, a bar along the exponent's
    ax : where to draw

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> jb.plot.exponent_over_drive(curve).get_xlabel()
    'amplitude of the base / total play'
    """
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    exponent, chaotic = map_.exponent, map_.chaotic
    size = 2.5 if map_.ratios.size > 250 else 5.0
    for row, seen in zip(exponent, chaotic):
        ax.plot(map_.ratios[seen], row[seen], ".", color=MEASURED, ms=size, mew=0)
        ax.plot(map_.ratios[~seen], row[~seen], ".", color=GAP, ms=size, mew=0)
    ax.plot([], [], ".", color=MEASURED, ms=6, label="chaotic")
    ax.plot([], [], ".", color=GAP, ms=6, label="regular")
    ax.axhline(0.0, color=ink(ax), lw=0.6)
    low, high = map_.ratios[0], map_.ratios[-1]
    if found is not None and found.value is not None and found.interval is not None:
        _levels(ax, found, found.value, found.interval)
    floor = min(float(np.nanmin(exponent)), -0.2)
    ax.set_ylim(1.1 * floor, 1.15 * max(float(np.nanmax(exponent)), 0.5))
    readable_log(ax, "x", float(low), float(high))
    _more_ticks(ax, float(low), float(high))
    ax.set(xlabel="amplitude of the base / total play", ylabel="largest exponent [1/drive period]")
    legend_above(axes, columns=4)
    return axes


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


@picture
def play_likelihood(
    found: PlayFromChaos, *, truth: float | None = None, fit: tuple[float, float] | None = None, ax: Where = None
) -> list[Axes]:
    """What every level says of the play, a row each, and all together below. On one axes, all together.

    Parameters
    ----------
    found : the inference
    truth : the true play, where known [rad]
    fit : the interval of a direct fit, for comparison [rad]
    ax : where to draw

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> levels = [jb.signature.Level(0.05, "chaotic", 1.2, 0.05), jb.signature.Level(0.03, "regular")]
    >>> found = jb.signature.play_from_exponents(curve, levels)
    >>> each, together = jb.plot.play_likelihood(found)
    >>> together.get_xlabel()
    'total play [deg]'
    """
    axes = panels(ax, 2, height=MEDIUM + 0.6, height_ratios=(1.3, 1.0), sharex=True)
    lower = axes[-1]
    plays = np.degrees(found.plays)
    if len(axes) > 1:
        _each_level(axes[0], found, plays)
    lower.fill_between(plays, 0.0, found.density, color=HELDOUT, lw=0, alpha=0.8)
    lower.set(
        ylabel="probability density\nof its logarithm", xlabel="total play [deg]", ylim=(0.0, 1.15 * float(found.density.max()))
    )
    lower.set_title(f"all levels together: {found.bits:.1f} bit", loc="left")
    for one in axes:
        if truth is not None:
            one.axvline(np.degrees(truth), color=ink(one), lw=1.0, ls="--", label="true play")
        if fit is not None:
            one.axvspan(*np.degrees(fit), color=MODEL, lw=1.0, label="direct fit, 95 %")
    if truth is not None or fit is not None:
        lower.legend(loc="upper right")
    readable_log(lower, "x", float(plays[0]), float(plays[-1]))
    _more_ticks(lower, float(plays[0]), float(plays[-1]))
    return axes


def _each_level(ax: Axes, found: PlayFromChaos, plays: np.ndarray) -> None:
    """A row for each level, in order of their amplitudes."""
    order = np.argsort([level.amplitude for level in found.levels])
    for row, k in enumerate(order):
        level = found.levels[k]
        colour = MODEL if level.word == "chaotic" else MEASURED if level.word == "regular" else GAP
        ax.fill_between(plays, row, row + 0.85 * found.each[k], color=colour, lw=0, alpha=0.8)
    words = [f"{np.degrees(found.levels[k].amplitude):.3g}° {found.levels[k].word}" for k in order]
    ax.set_yticks(np.arange(len(order)) + 0.35, words)
    ax.grid(False, axis="y")
    ax.set_title("likelihood of each drive level alone", loc="left")


def _more_ticks(ax: Axes, low: float, high: float) -> None:
    """Ticks at round numbers for a logarithmic axis that is hardly longer than a decade."""
    if high / low < 12.0:
        ticks = [tick for tick in MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= tick <= high]
        ax.set_xticks(ticks, [f"{tick:.3g}" for tick in ticks])


@picture
def pattern_region(
    match: PatternMatch, across: str = "linear_gravity.G", up: str = "backlash", *, ax: Where = None
) -> list[Axes]:
    """Where over two parameters the pattern appears: the best chance and the mean chance over all others.

    Parameters
    ----------
    match : from `jaxbacklash.signature.match_pattern`
    across, up : names of the two axes
    ax : where to draw; on one axes, the best chance

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> over = {"damping": [5.0, 9.0]}
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), over=over, starts=2, periods=60, skip=30)
    >>> match = jb.signature.match_pattern(curve, [0.03, 0.05], [False, True], [0.024, 0.026, 0.028])
    >>> len(jb.plot.pattern_region(match, across="damping"))
    2
    """
    names = list(match.axes)
    if across not in names or up not in names or across == up:
        return empty(ax, f"The search has no two axes {across} and {up}.")
    others = tuple(i for i, name in enumerate(names) if name not in (across, up))
    axes = panels(ax, 1, 2, height=MEDIUM, sharey=True)
    x, y = match.axes[across], match.axes[up]
    scale = np.degrees if up == "backlash" else np.asarray
    both = ((match.chance.max(axis=others), "best chance"), (match.chance.mean(axis=others), "mean chance"))
    for one, (values, title) in zip(axes, both):
        shown = values if names.index(across) > names.index(up) else values.T
        image = one.pcolormesh(x, scale(y), shown, cmap="viridis", vmin=0.0, rasterized=True)
        bar = one.figure.colorbar(image, ax=one, shrink=0.85, label="probability")
        bar.ax.tick_params(labelsize=7)
        one.set(xlabel=NAMES.get(across, across))
        one.set_title(f"{title} of the pattern, over the rest", loc="left")
        one.grid(False)
    axes[0].set_ylabel(NAMES.get(up, up))
    return axes


@picture
def expected_precision(results: dict[str, ExpectedPrecision] | ExpectedPrecision, *, ax: Where = None) -> list[Axes]:
    """Half width of the play's interval over the true play, for several sets of drive levels; nothing found lies at the top.

    Parameters
    ----------
    results : what to call each set of levels, and its imagined experiments; or those of one set
    ax : where to draw; on one axes, the first set

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> joint = jb.two_link(3.16, np.radians(1.5), 15000.0, 9.0, -60.0, linearised=True)
    >>> curve = jb.signature.exponent_map(joint, 1.54, (0.6, 5.0, 60), starts=2, periods=60, skip=30)
    >>> found = jb.signature.expected_precision(curve, [0.03, 0.05], (0.02, 0.03), experiments=5)
    >>> jb.plot.expected_precision(found).get_xlabel()
    'true total play [deg]'
    """
    sets = results if isinstance(results, dict) else {"": results}
    axes = panels(ax, 1, len(sets), height=MEDIUM, sharey=True)
    for ax, (name, one) in zip(axes, sets.items()):
        some, covered = one.determined, one.covered
        plays = np.degrees(one.play)
        for chosen, colour, mark, words in (
            (some & covered, MEASURED, "o", "interval holds the truth"), (some & ~covered, MODEL, "x", "misses it"),
        ):  # fmt: skip
            ax.plot(plays[chosen], 100.0 * one.half_width[chosen], mark, color=colour, ms=3.5, mew=0.8, label=words)
        ax.plot(plays[~some], np.full(int((~some).sum()), 90.0), "v", color=GAP, ms=4, label="no play determined")
        ax.set(xlabel="true total play [deg]")
        ax.set_title(name, loc="left")
        readable_log(ax, "y", 0.2, 100.0)
    axes[0].set_ylabel("half width of the interval [%]")
    axes[0].legend(loc="lower right")
    return axes
