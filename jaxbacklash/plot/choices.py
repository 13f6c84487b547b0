"""Figures of the choices that an analysis of chaos made: of the series, of delay and dimension, of straight parts."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..timeseries import ChaosReport
from .drawing import Where, ink, legend_above, panels, picture, readable_log
from .style import GAP, MEASURED, MEDIUM, MODEL, SHORT, with_unit
from .thinning import envelope

SWINGS = 25


def clock_of(seconds: float) -> tuple[float, str]:
    """What to multiply seconds by, and the unit, so that so long a stretch has plain numbers on its axis."""
    units = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns"))
    return next((one for one in units if one[0] * seconds >= 1.0), units[-1])


@picture
def series(found: ChaosReport, name: str = "series", unit: str = "", *, ax: Where = None) -> list[Axes]:
    """Some swings of the series, cleaned where it was, and above them the whole series.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    name, unit : what the series is
    ax : where to draw; on one axes, some swings

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> whole, some = jb.plot.series(found, "position", "mm")
    >>> some.get_ylabel()
    'position [mm]'
    """
    values = found.mean + found.deviation * found.series
    factor, clock = clock_of(found.dt * values.size)
    t = factor * found.dt * np.arange(values.size)
    axes = panels(ax, 2, height=MEDIUM, height_ratios=(1, 1.5))
    lower = axes[-1]
    shown = min(values.size, max(60, int(SWINGS * min(found.period, values.size))), 3000)
    begin = (values.size - shown) // 2
    part = slice(begin, begin + shown)
    marks = ".-" if shown < 400 else "-"
    lower.plot(t[part], values[part], marks, color=MEASURED, lw=0.8, ms=3, label="measured")
    if found.cleaned is not None and found.uses_cleaned:
        first = (values.size - found.cleaned.series.size) // 2
        inside = slice(max(begin - first, 0), min(begin - first + shown, found.cleaned.series.size))
        at = t[first + inside.start : first + inside.stop]
        cleaned = found.mean + found.deviation * found.cleaned.series[inside]
        lower.plot(at, cleaned, color=MODEL, lw=1.0, label="noise taken off")
    lower.set(xlim=(t[part][0], t[part][-1]), xlabel=f"time [{clock}]", ylabel=with_unit(name, unit))
    legend_above([lower])
    if len(axes) == 1:
        return axes
    upper = axes[0]
    times, low, high = envelope(t, values, 900)
    if low is high:
        upper.plot(times, low, color=MEASURED, lw=0.8)
    else:
        upper.fill_between(times, low, high, color=MEASURED, lw=0.4)
    upper.axvspan(t[part][0], t[part][-1], color=GAP, alpha=0.35, lw=0)
    upper.set(xlim=(t[0], t[-1]), ylabel=with_unit(name, unit))
    upper.set_title(f"the whole series, time in {clock}", loc="left")
    return axes


@picture
def delay(found: ChaosReport, *, ax: Where = None) -> list[Axes]:
    """Average mutual information over the delay, with the delay taken.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    ax : where to draw

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> jb.plot.delay(found).get_xlabel()
    'delay [samples]'
    """
    axes = panels(ax, height=SHORT)
    ax = axes[0]
    ax.plot(found.delay.lags, found.delay.information, ".-", color=MEASURED)
    ax.axvline(found.delay.samples, color=MODEL, lw=1.2, label=f"delay taken: {found.delay.samples} samples")
    ax.legend(loc="upper right")
    ax.set(xlabel="delay [samples]", ylabel="mutual information [nat]", ylim=(0.0, None))
    return axes


@picture
def dimension(found: ChaosReport, *, ax: Where = None) -> list[Axes]:
    """Cao's E1 and E2 over the dimension, as measured and cleaned, and false nearest neighbours.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    ax : where to draw; on one axes, E1 and E2

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> cao, neighbours = jb.plot.dimension(found)
    >>> neighbours.get_ylabel()
    'false neighbours [%]'
    """
    axes = panels(ax, 1, 2, height=SHORT + 0.3)
    left, right = axes[0], axes[-1]
    pairs = [(found.raw_dimension, MEASURED, "as measured", "o")]
    if found.cleaned_dimension is not None:
        pairs.append((found.cleaned_dimension, MODEL, "noise taken off", "s"))
    for one, colour, name, mark in pairs:
        left.plot(one.dimensions, one.e1, mark + "-", color=colour, ms=4, label=f"E1 {name}")
        left.plot(one.dimensions, one.e2, mark + ":", color=colour, ms=3, lw=0.9, label=f"E2 {name}")
        if right is not left:
            right.plot(one.dimensions, 100.0 * one.false_share, mark + "-", color=colour, ms=4, label=name)
        if one.cao is not None:
            left.plot(one.cao, one.e1[one.cao - 1], mark, color=colour, ms=9, mfc="none", mew=1.6)
    left.axhline(1.0, color=ink(left), lw=0.5, ls="--")
    left.set(xlabel="embedding dimension", ylabel="Cao's E1, E2", ylim=(0.0, max(1.3, left.get_ylim()[1])))
    left.legend(loc="lower right", fontsize=7)
    if right is not left:
        right.set(xlabel="embedding dimension", ylabel="false neighbours [%]", ylim=(-2.0, None))
        right.legend(loc="upper right")
    return axes


@picture
def correlation(found: ChaosReport, *, ax: Where = None) -> list[Axes]:
    """Correlation sums in several embeddings, and their slopes with the straight parts marked.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    ax : where to draw; on one axes, the sums

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> sums, slopes = jb.plot.correlation(found)
    >>> slopes.get_ylabel()
    'local slope'
    """
    one = found.correlation
    axes = panels(ax, 1, 2, height=SHORT + 0.4)
    left = axes[0]
    shades = np.linspace(0.35, 1.0, max(1, len(one.dimensions)))
    for row, region, shade in zip(one.sums, one.regions, shades):
        seen = row > 0.0
        left.plot(one.radii[seen], row[seen], color=MEASURED, alpha=shade, lw=1.0)
        if region is not None:
            part = slice(region.first, region.last + 1)
            line = np.exp(region.intercept) * one.radii[part] ** region.slope
            left.plot(one.radii[part], line, color=MODEL, lw=2.0, alpha=shade)
    low = one.sums[one.sums > 0.0].min(initial=1e-3)
    readable_log(left, "y", float(max(low, 1e-7)), 1.2)
    left.set_ylabel("share of pairs nearer")
    if len(axes) > 1:
        _local_slopes(axes[1], found, shades)
    for each in axes:
        readable_log(each, "x", float(one.radii[0]), float(one.radii[-1]))
        each.set_xlabel("radius [standard deviations]")
    return axes


def _local_slopes(right: Axes, found: ChaosReport, shades: np.ndarray) -> None:
    """Slopes of the sums, and the dimension on which they agree."""
    one = found.correlation
    for m, row, shade in zip(one.dimensions, one.sums, shades):
        seen = row > 0.0
        log_r, log_c = np.log(one.radii[seen]), np.log(row[seen])
        if log_r.size > 3:
            right.plot(one.radii[seen], np.gradient(log_c, log_r), color=MEASURED, alpha=shade, lw=1.0, label=f"m = {m}")
    top = 1.2 * (found.correlation.dimensions.max() if one.dimension is None else one.dimension + 1.0)
    right.set(ylabel="local slope", ylim=(0.0, float(top)))
    if one.dimension is not None and one.spread is not None and one.regions[-1] is not None:
        first, last = one.radii[[one.regions[-1].first, one.regions[-1].last]]
        right.fill_between([first, last], one.dimension - one.spread, one.dimension + one.spread, color=MODEL, alpha=0.2, lw=0.0)
        right.plot([first, last], [one.dimension] * 2, color=MODEL, lw=1.6)
    right.legend(loc="upper right", ncols=2, fontsize=7)
