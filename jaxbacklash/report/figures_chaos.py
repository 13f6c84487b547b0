"""Figures of a chaos report: the series, the choices made for it, and what the verdict rests on."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..timeseries import ChaosReport
from ..timeseries.driven import GROUP
from .drawing import drawn_in_style, new_figure, readable_log
from .style import GAP, HELDOUT, INK, MEASURED, MEDIUM, MODEL, SHORT, with_unit
from .thinning import envelope

SWINGS = 25
POINTS = 12000


def _clock(seconds: float) -> tuple[float, str]:
    """What to multiply seconds by, and the unit, so that so long a stretch has plain numbers on its axis."""
    units = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns"))
    return next((one for one in units if one[0] * seconds >= 1.0), units[-1])


@drawn_in_style
def chaos_series(found: ChaosReport, name: str, unit: str) -> Figure:
    """The whole series above, some swings of it below, cleaned where it was."""
    values = found.mean + found.deviation * found.series
    factor, clock = _clock(found.dt * values.size)
    t = factor * found.dt * np.arange(values.size)
    figure = new_figure(MEDIUM)
    upper, lower = figure.subplots(2, 1, height_ratios=(1, 1.5))
    times, low, high = envelope(t, values, 900)
    if low is high:
        upper.plot(times, low, color=MEASURED, lw=0.8)
    else:
        upper.fill_between(times, low, high, color=MEASURED, lw=0.4)
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
    upper.axvspan(t[part][0], t[part][-1], color=GAP, alpha=0.35, lw=0)
    upper.set(xlim=(t[0], t[-1]), ylabel=with_unit(name, unit))
    upper.set_title(f"the whole series, time in {clock}")
    lower.set(xlim=(t[part][0], t[part][-1]), xlabel=f"time [{clock}]", ylabel=with_unit(name, unit))
    lower.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


@drawn_in_style
def delay_choice(found: ChaosReport) -> Figure:
    """Average mutual information over the delay, with the delay taken."""
    figure = new_figure(SHORT)
    ax = figure.subplots()
    ax.plot(found.delay.lags, found.delay.information, ".-", color=MEASURED)
    ax.axvline(found.delay.samples, color=MODEL, lw=1.2)
    ax.annotate(f" delay {found.delay.samples}", (found.delay.samples, ax.get_ylim()[1]), color=MODEL, va="top")
    ax.set(xlabel="delay [samples]", ylabel="mutual information [nat]", ylim=(0.0, None))
    return figure


@drawn_in_style
def dimension_choice(found: ChaosReport) -> Figure:
    """Cao's E1 and E2 over the dimension, as measured and cleaned, and false nearest neighbours."""
    figure = new_figure(SHORT + 0.3)
    left, right = figure.subplots(1, 2)
    pairs = [(found.raw_dimension, MEASURED, "as measured", "o")]
    if found.cleaned_dimension is not None:
        pairs.append((found.cleaned_dimension, MODEL, "noise taken off", "s"))
    for one, colour, name, mark in pairs:
        left.plot(one.dimensions, one.e1, mark + "-", color=colour, ms=4, label=f"E1 {name}")
        left.plot(one.dimensions, one.e2, mark + ":", color=colour, ms=3, lw=0.9, label=f"E2 {name}")
        right.plot(one.dimensions, 100.0 * one.false_share, mark + "-", color=colour, ms=4, label=name)
        if one.cao is not None:
            left.plot(one.cao, one.e1[one.cao - 1], mark, color=colour, ms=9, mfc="none", mew=1.6)
    left.axhline(1.0, color=INK, lw=0.5, ls="--")
    left.set(xlabel="embedding dimension", ylabel="Cao's E1, E2", ylim=(0.0, max(1.3, left.get_ylim()[1])))
    right.set(xlabel="embedding dimension", ylabel="false neighbours [%]", ylim=(-2.0, None))
    left.legend(loc="lower right", fontsize=7)
    right.legend(loc="upper right")
    return figure


@drawn_in_style
def phase_plot(found: ChaosReport, unit: str) -> Figure:
    """The series against itself one delay later, as measured and cleaned, side by side."""
    both = [("as measured", found.series, MEASURED)]
    if found.cleaned is not None:
        both.append(("noise taken off", found.cleaned.series, MODEL))
    figure = new_figure(MEDIUM + 0.2)
    axes = figure.subplots(1, len(both), squeeze=False)[0]
    delay = found.delay.samples
    for ax, (name, series, colour) in zip(axes, both):
        values = (found.mean + found.deviation * series)[: POINTS + delay]
        continuous = found.period > 8.0
        if continuous:
            ax.plot(values[:-delay], values[delay:], color=colour, lw=0.35, alpha=0.7, rasterized=True)
        else:
            ax.plot(values[:-delay], values[delay:], ".", color=colour, ms=1.6, mew=0, rasterized=True)
        ax.set(xlabel=with_unit("now", unit), title=name)
        ax.set_aspect("equal", adjustable="datalim" if len(both) > 1 else "box")
    axes[0].set_ylabel(with_unit(f"{delay} samples later", unit))
    return figure


@drawn_in_style
def stretching_curves(found: ChaosReport) -> Figure:
    """How neighbours part: Kantz's and Rosenstein's curves, the straight part, and the growth that the local maps give."""
    curve, dt = found.curve, found.dt
    figure = new_figure(MEDIUM)
    ax = figure.subplots()
    factor, clock = _clock(float(curve.lags[-1]) * dt)
    times = factor * dt * curve.lags
    ax.plot(times, curve.kantz, color=MEASURED, lw=0.8, alpha=0.5)
    ax.plot(times, curve.smooth, color=MEASURED, lw=1.6, label="Kantz, averaged over a swing")
    ax.plot(times, curve.rosenstein, color=HELDOUT, lw=1.1, label="Rosenstein")
    ax.axhline(curve.plateau, color=INK, lw=0.7, ls="--", label="unrelated points")
    if curve.region is not None:
        part = slice(curve.region.first, curve.region.last + 1)
        ax.axvspan(times[part][0], times[part][-1], color=GAP, alpha=0.2, lw=0)
        line = curve.region.intercept + curve.region.slope * curve.lags[part]
        ax.plot(times[part], line, color=MODEL, lw=2.2, label=f"straight part, {curve.region.slope / dt:.3g} 1/s")
    if found.lyapunov is not None and found.exponent is not None and not found.conditional:
        middle = curve.region.first if curve.region is not None else max(1, curve.lags.size // 20)
        start, top = float(curve.smooth[middle]), curve.plateau
        reach = (top - start) / max(found.exponent.value, 1e-300)
        at = np.array([curve.lags[middle], min(curve.lags[middle] + reach, curve.lags[-1])])
        ax.plot(factor * dt * at, start + found.exponent.value * (at - at[0]), color=INK, lw=1.0, ls=":",
                label=f"local maps, {found.lyapunov:.3g} 1/s")  # fmt: skip
    ax.set(xlabel=f"time [{clock}]", ylabel="mean log distance", xlim=(0.0, times[-1]))
    ax.legend(loc="lower right")
    return figure


@drawn_in_style
def driven_growth(found: ChaosReport, name: str, unit: str) -> Figure:
    """The law of motion that the record shows, and how a small difference grows along it under the measured drive."""
    one, dt = found.driven, found.dt
    assert one is not None
    assert one.surface is not None
    figure = new_figure(SHORT + 0.4)
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.35))
    edges = one.middle + one.deviation * one.surface.edges
    left.plot(edges, -one.deviation * one.surface.force / dt**2, ".-", color=MEASURED, ms=4)
    left.axhline(0.0, color=INK, lw=0.5, ls="--")
    left.set(xlabel=with_unit(name, unit), ylabel=f"force over inertia [{unit or name}/s²]", title="the law of motion")
    factor, clock = _clock(dt * one.samples)
    times = factor * dt * (one.first + GROUP * np.arange(one.rates.size + 1))
    grown = np.concatenate([[0.0], np.cumsum(one.rates)])
    right.plot(times, grown, color=MEASURED, lw=1.2, label="log of a small difference")
    rate = (one.value or 0.0) / dt
    reach = [0.0, rate * (times[-1] - times[0]) / factor]
    right.plot(times[[0, -1]], reach, color=MODEL, lw=1.4, ls=":", label=f"{rate:.3g} 1/s")
    right.axhline(0.0, color=INK, lw=0.5, ls="--")
    right.set(xlabel=f"time [{clock}]", ylabel="log of its growth", xlim=(times[0], times[-1]), title="under the measured drive")
    right.legend(loc="best")
    return figure


@drawn_in_style
def correlation_sums(found: ChaosReport) -> Figure:
    """Correlation sums in several embeddings, and their slopes with the straight parts marked."""
    one = found.correlation
    figure = new_figure(SHORT + 0.4)
    left, right = figure.subplots(1, 2)
    shades = np.linspace(0.35, 1.0, max(1, len(one.dimensions)))
    for m, row, region, shade in zip(one.dimensions, one.sums, one.regions, shades):
        seen = row > 0.0
        left.plot(one.radii[seen], row[seen], color=MEASURED, alpha=shade, lw=1.0)
        log_r, log_c = np.log(one.radii[seen]), np.log(row[seen])
        if log_r.size > 3:
            right.plot(one.radii[seen], np.gradient(log_c, log_r), color=MEASURED, alpha=shade, lw=1.0, label=f"m = {m}")
        if region is not None:
            part = slice(region.first, region.last + 1)
            line = np.exp(region.intercept) * one.radii[part] ** region.slope
            left.plot(one.radii[part], line, color=MODEL, lw=2.0, alpha=shade)
    low = one.sums[one.sums > 0.0].min(initial=1e-3)
    readable_log(left, "y", float(max(low, 1e-7)), 1.2)
    for ax in (left, right):
        readable_log(ax, "x", float(one.radii[0]), float(one.radii[-1]))
        ax.set_xlabel("radius [standard deviations]")
    left.set_ylabel("share of pairs nearer")
    top = 1.2 * (found.correlation.dimensions.max() if one.dimension is None else one.dimension + 1.0)
    right.set(ylabel="local slope", ylim=(0.0, float(top)))
    if one.dimension is not None and one.spread is not None and one.regions[-1] is not None:
        first, last = one.radii[[one.regions[-1].first, one.regions[-1].last]]
        right.fill_between([first, last], one.dimension - one.spread, one.dimension + one.spread, color=MODEL, alpha=0.2, lw=0.0)
        right.plot([first, last], [one.dimension] * 2, color=MODEL, lw=1.6)
    right.legend(loc="upper right", ncols=2, fontsize=7)
    return figure


@drawn_in_style
def surrogates_and_walk(found: ChaosReport) -> Figure:
    """Prediction errors of the surrogates with the series' own, and the walk of the 0-1 test."""
    figure = new_figure(SHORT + 0.4)
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    one = found.surrogates
    name = f"{one.count} {one.kind.upper()} surrogates"
    left.hist(one.surrogates, bins=max(6, one.count // 4), color=GAP, alpha=0.7, label=name)
    left.axvline(one.statistic, color=MODEL, lw=2.0, label="this series")
    spread = np.concatenate([one.surrogates, [one.statistic]])
    pad = 0.06 * float(np.ptp(spread)) + 1e-9
    left.set(xlabel="prediction error [standard deviations]", ylabel="surrogates", xlim=(spread.min() - pad, spread.max() + pad))
    left.set_ylim(0.0, 1.35 * left.get_ylim()[1])
    left.legend(loc="upper center", ncols=2)
    _walk(right, found)
    return figure


def _walk(ax: Axes, found: ChaosReport) -> None:
    ax.plot(found.walk.p, found.walk.q, color=MEASURED, lw=0.5)
    ax.set(xlabel="p", ylabel="q", title=f"0-1 test: K = {found.walk.k:.2f}")
    ax.set_aspect("equal", adjustable="datalim")
