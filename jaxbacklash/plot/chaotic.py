"""Figures of the witnesses of a verdict on chaos: the attractor, neighbours that part, surrogates, the 0-1 test, the drive."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ..timeseries import ChaosReport
from ..timeseries.driven import GROUP
from .choices import clock_of
from .drawing import Where, empty, ink, panels, picture
from .style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL, SHORT, TALL, with_unit

POINTS = 12000


@picture
def chaos(found: ChaosReport, unit: str = "", *, ax: Where = None) -> list[Axes]:
    """The four witnesses of a verdict: the state one delay apart, how neighbours part, surrogates, and the 0-1 test's walk.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    unit : of the series
    ax : where to draw; on one axes, how neighbours part

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> len(jb.plot.chaos(found))
    4
    """
    axes = panels(ax, mosaic="sp;uw", height=TALL)
    stretching(found, ax=axes[0])
    if len(axes) > 1:
        attractor(found, unit, ax=axes[1])
        surrogates(found, ax=axes[2])
        _walk(axes[3], found)
    return axes


@picture
def attractor(found: ChaosReport, unit: str = "", *, ax: Where = None) -> list[Axes]:
    """The series against itself one delay later, as measured and cleaned, side by side.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    unit : of the series
    ax : where to draw; on one axes, cleaned if it was

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> jb.plot.attractor(found).get_ylabel()
    '1 samples later'
    """
    both = [("as measured", found.series, MEASURED)]
    if found.cleaned is not None and found.cleaned.why_untouched is None:
        both.append(("noise taken off", found.cleaned.series, MODEL))
    axes = panels(ax, 1, len(both), height=MEDIUM + 0.2)
    later = found.delay.samples
    for one, (name, values, colour) in zip(axes, both[-len(axes) :]):
        shown = (found.mean + found.deviation * values)[: POINTS + later]
        continuous = found.period > 8.0
        if continuous:
            one.plot(shown[:-later], shown[later:], color=colour, lw=0.35, alpha=0.7, rasterized=True)
        else:
            one.plot(shown[:-later], shown[later:], ".", color=colour, ms=1.6, mew=0, rasterized=True)
        one.set(xlabel=with_unit("now", unit))
        one.set_title(name, loc="left")
        one.set_aspect("equal", adjustable="datalim" if len(both) > 1 else "box")
    axes[0].set_ylabel(with_unit(f"{later} samples later", unit))
    return axes


@picture
def stretching(found: ChaosReport, *, ax: Where = None) -> list[Axes]:
    """How neighbours part: Kantz's and Rosenstein's curves, the straight part, and the growth that the local maps give.

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
    >>> jb.plot.stretching(found).get_ylabel()
    'mean ln(distance / standard deviation)'
    """
    curve, dt = found.curve, found.dt
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    factor, clock = clock_of(float(curve.lags[-1]) * dt)
    times = factor * dt * curve.lags
    ax.plot(times, curve.kantz, color=MEASURED, lw=0.8, alpha=0.5)
    ax.plot(times, curve.smooth, color=MEASURED, lw=1.6, label="Kantz, averaged over a swing")
    ax.plot(times, curve.rosenstein, color=HELDOUT, lw=1.1, label="Rosenstein")
    ax.axhline(curve.plateau, color=ink(ax), lw=0.7, ls="--", label="unrelated points")
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
        ax.plot(factor * dt * at, start + found.exponent.value * (at - at[0]), color=ink(ax), lw=1.0, ls=":",
                label=f"local maps, {found.lyapunov:.3g} 1/s")  # fmt: skip
    ax.set(xlabel=f"time [{clock}]", ylabel="mean ln(distance / standard deviation)", xlim=(0.0, times[-1]))
    ax.legend(loc="lower right")
    return axes


@picture
def surrogates(found: ChaosReport, *, ax: Where = None) -> list[Axes]:
    """Prediction errors of the surrogates with the series' own, and the walk of the 0-1 test.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    ax : where to draw; on one axes, the surrogates

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> errors, walk = jb.plot.surrogates(found)
    >>> walk.get_title(loc="left")
    '0-1 test: K = ...'
    """
    axes = panels(ax, 1, 2, height=SHORT + 0.4, width_ratios=(1.5, 1))
    left = axes[0]
    one = found.surrogates
    name = f"{one.count} {one.kind.upper()} surrogates"
    # Where neighbours are too few to predict from, there is no error to show.
    told = one.surrogates[np.isfinite(one.surrogates)]
    name += "" if told.size == one.count else f", {told.size} of them told"
    left.hist(told, bins=max(6, one.count // 4), color=GAP, alpha=0.7, label=name)
    left.axvline(one.statistic, color=MODEL, lw=2.0, label="this series")
    spread = np.concatenate([told, [one.statistic] if np.isfinite(one.statistic) else [], [] if told.size else [0.0]])
    pad = 0.06 * float(np.ptp(spread)) + 1e-9
    left.set(xlabel="prediction error [standard deviations]", ylabel="surrogates", xlim=(spread.min() - pad, spread.max() + pad))
    left.set_ylim(0.0, 1.35 * left.get_ylim()[1])
    left.legend(loc="upper center", ncols=2)
    if len(axes) > 1:
        _walk(axes[1], found)
    return axes


def _walk(ax: Axes, found: ChaosReport) -> None:
    ax.plot(found.walk.p, found.walk.q, color=MEASURED, lw=0.5)
    ax.set(xlabel="p [standard deviations]", ylabel="q [standard deviations]")
    ax.set_title(f"0-1 test: K = {found.walk.k:.2f}", loc="left")
    ax.set_aspect("equal", adjustable="datalim")


@picture
def driven_growth(found: ChaosReport, name: str = "z", unit: str = "", *, ax: Where = None) -> list[Axes]:
    """How a small difference grows under the measured drive, along the law of motion that the record shows.

    Parameters
    ----------
    found : from `jaxbacklash.chaos`
    name, unit : what the series is
    ax : where to draw; on one axes, the growth

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> ax = jb.plot.driven_growth(found)  # nothing was measured that drives it
    >>> ax.texts[0].get_text()
    'No law of motion was found.'
    """
    one, dt = found.driven, found.dt
    if one is None or one.surface is None:
        return empty(ax, "No law of motion was found.")
    axes = panels(ax, 1, 2, height=SHORT + 0.4, width_ratios=(1, 1.35))
    right = axes[-1]
    factor, clock = clock_of(dt * one.samples)
    times = factor * dt * (one.first + GROUP * np.arange(one.rates.size + 1))
    grown = np.concatenate([[0.0], np.cumsum(one.rates)])
    right.plot(times, grown, color=MEASURED, lw=1.2, label="ln of a small difference")
    rate = (one.value or 0.0) / dt
    reach = [0.0, rate * (times[-1] - times[0]) / factor]
    right.plot(times[[0, -1]], reach, color=MODEL, lw=1.4, ls=":", label=f"its mean rate, {rate:.3g} 1/s")
    right.axhline(0.0, color=ink(right), lw=0.5, ls="--")
    right.set(xlabel=f"time [{clock}]", ylabel="ln of its growth", xlim=(times[0], times[-1]))
    right.set_title("under the measured drive", loc="left")
    right.legend(loc="best")
    if len(axes) == 1:
        return axes
    left = axes[0]
    edges = one.middle + one.deviation * one.surface.edges
    left.plot(edges, -one.deviation * one.surface.force / dt**2, ".-", color=MEASURED, ms=4)
    left.axhline(0.0, color=ink(left), lw=0.5, ls="--")
    left.set(xlabel=with_unit(name, unit), ylabel=f"force over inertia [{unit or name}/s²]")
    left.xaxis.set_major_locator(MaxNLocator(5))  # long numbers would run into one another
    left.set_title("the law of motion", loc="left")
    return axes
