"""Figures against time: the record with its model, and what is left between them."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from .drawing import column, drawn_in_style, empty_figure, in_degrees, new_figure, readable_log
from .style import GAP, INK, MEASURED, MODEL, SHORT, TALL, short, with_unit
from .thinning import envelope
from .zooms import stretch_around, window_bounds, window_misfit, worst_and_typical

HUGE = 30.0  # noise units from which a residual is drawn on a logarithmic scale


@drawn_in_style
def measured_against_model(
    t: Any, measured: Any, model: Any, *, window_starts: Any, label: str, unit: str, noise: float | None
) -> Figure:
    """The whole record above; below, the stretch that the model misses most and a typical one.

    Parameters
    ----------
    t, measured, model : (N,) time [s], the measured channel and its windowed prediction [unit]; NaN where there is none
    window_starts : (K,) times at which a prediction starts anew from its own estimated state [s]
    label, unit : what was measured, ``"z"`` in ``"rad"``
    noise : standard deviation of the measurement noise [unit]; None: unknown, no band is drawn

    Returns
    -------
    Figure
    """
    t, measured, model = column(t), column(measured), column(model)
    if t.size < 2:
        return empty_figure("No samples to draw.")
    if not model.size:
        model = np.full(t.size, np.nan)
    edges = window_bounds(t, window_starts)
    misfit = window_misfit(measured - model, edges)
    worst, typical = worst_and_typical(misfit)
    figure = new_figure(TALL)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.15, 1.5, 0.75))
    whole = figure.add_subplot(grid[0, :])
    _overview(whole, t, measured, model)
    whole.set(ylabel=with_unit(label, unit), xlim=(t[0], t[-1]))
    whole.set_title("the whole record, time in s")
    _legend(whole, noise)
    in_degrees(whole, "right", unit)
    for place, (index, name) in enumerate(((worst, "missed most"), (typical, "typical"))):
        stretch = stretch_around(index, edges)
        start, end = t[stretch][0], t[stretch][-1]
        whole.axvspan(start, end, color=GAP, alpha=0.35, lw=0)
        middle = np.clip(0.5 * (start + end), t[0] + 0.01 * (t[-1] - t[0]), t[-1] - 0.01 * (t[-1] - t[0]))
        at = ("data", "axes fraction")
        whole.annotate("AB"[place], (middle, 0.98), xycoords=at, ha="center", va="top", weight="bold")
        upper = figure.add_subplot(grid[1, place])
        lower = figure.add_subplot(grid[2, place], sharex=upper)
        local = [e - stretch.start for e in edges if stretch.start <= e <= stretch.stop]
        _zoom(upper, t[stretch], measured[stretch], model[stretch], local, noise)
        _left_over(lower, t[stretch], (measured - model)[stretch], local, noise, unit)
        missed = _how_far(misfit[index], noise, unit)
        upper.set_title(f"{'AB'[place]}, {name}: {missed}, window from {t[edges[index]]:.5g} s")
        upper.tick_params(labelbottom=False)
        if place == 0:
            upper.set_ylabel(with_unit(label, unit))
        if noise:
            lower.set_ylabel("difference\nover noise" if place == 0 else "")
    return figure


@drawn_in_style
def residual_in_time(t: Any, residual_over_noise: Any, *, window_edges: Any, window_rms: Any) -> Figure:
    """What the model leaves, in units of the noise: every sample above, each window's root mean square below.

    Parameters
    ----------
    t : (N,) [s]
    residual_over_noise : (N,) measured minus model over the standard deviation of the noise [1]
    window_edges : (K,) starts, or (K + 1,) with the last end [s]
    window_rms : (K,) [1]; NaN for a window that is too short to judge

    Returns
    -------
    Figure
    """
    t, residual, rms = column(t), column(residual_over_noise), column(window_rms)
    if t.size < 2:
        return empty_figure("No residual to draw.")
    figure = new_figure(TALL * 0.72 if rms.size else SHORT)
    axes = figure.subplots(2 if rms.size else 1, 1, sharex=True, squeeze=False)[:, 0]
    top = axes[0]
    top.axhspan(-2, 2, color=GAP, alpha=0.25, lw=0, label="±2 times the noise: 95 % of pure noise")
    for limit in (-2, 2):  # once more in front of a dense record
        top.axhline(limit, color=INK, lw=0.5, ls=(0, (3, 3)), zorder=3)
    times, low, high = envelope(t, residual, 900)
    largest = float(np.nanmax(np.abs(residual), initial=0.0))
    if low is high:
        top.plot(times, residual, color=MEASURED, lw=0.7)
    else:
        top.fill_between(times, low, high, color=MEASURED, lw=0.4)
    if largest > HUGE:
        top.set_yscale("symlog", linthresh=3.0, linscale=0.8)
        decades = 10.0 ** np.arange(1, np.ceil(np.log10(largest)) + 0.5, 2 if largest > 1e4 else 1)
        top.set_yticks(np.concatenate([-decades[::-1], [-2, 0, 2], decades]))
        top.yaxis.set_major_formatter(lambda value, _: f"{value:g}".replace("-", "−"))
    reach = 1.15 * max(largest, 4.0)
    top.set(ylabel="residual over noise", xlim=(t[0], t[-1]), ylim=(-reach, reach * (1.6 if largest > HUGE else 1.25)))
    top.legend(loc="upper right")
    axes[-1].set_xlabel("time [s]")
    if rms.size:
        _window_steps(axes[1], t, column(window_edges), rms)
    return figure


def _how_far(misfit: float, noise: float | None, unit: str) -> str:
    if not np.isfinite(misfit):
        return "no prediction"
    return f"{misfit / noise:.3g} times the noise" if noise else f"{short(misfit)} {unit} rms"


def _legend(ax: Axes, noise: float | None) -> None:
    """Names of the marks, on the title's line where no curve can run through them."""
    dots = Line2D([], [], color=MEASURED, marker="o", ms=4, mew=0, ls="none")
    line, shade = Line2D([], [], color=MODEL, lw=1.2), Patch(color=INK, alpha=0.08, lw=0)
    names = ["measured", "model, ±2 times the noise" if noise else "model", "every other window"]
    ax.legend([dots, line, shade], names, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2)


def _overview(ax: Axes, t: np.ndarray, measured: np.ndarray, model: np.ndarray) -> None:
    times, low, high = envelope(t, measured)
    if low is high:
        ax.plot(t, measured, color=MEASURED, lw=1.8)
        ax.plot(t, model, color=MODEL, lw=0.6)
        return
    ax.fill_between(times, low, high, color=MEASURED, lw=0.3, alpha=0.8)
    _, below, above = envelope(t, model)
    ax.plot(times, below, color=MODEL, lw=0.5)
    ax.plot(times, above, color=MODEL, lw=0.5)


def _shade(ax: Axes, t: np.ndarray, edges: list[int]) -> None:
    for start, end in list(pairwise(edges))[::2]:
        ax.axvspan(t[start], t[min(end, t.size - 1)], color=INK, alpha=0.06, lw=0)


def _zoom(
    ax: Axes, t: np.ndarray, measured: np.ndarray, model: np.ndarray, edges: list[int], noise: float | None
) -> None:
    _shade(ax, t, edges)
    many = t.size > 1500
    ax.plot(t, measured, "o", color=MEASURED, ms=2.6, mew=0, rasterized=many)
    for start, end in pairwise(edges):
        inside = slice(start, end)
        if noise:
            ax.fill_between(
                t[inside], model[inside] - 2 * noise, model[inside] + 2 * noise, color=MODEL, alpha=0.3, lw=0
            )
        ax.plot(t[inside], model[inside], color=MODEL, lw=0.9)
    ax.set_xlim(t[0], t[-1])
    ax.margins(y=0.12)


def _left_over(
    ax: Axes, t: np.ndarray, difference: np.ndarray, edges: list[int], noise: float | None, unit: str
) -> None:
    _shade(ax, t, edges)
    if noise:
        ax.axhspan(-2, 2, color=GAP, alpha=0.25, lw=0)
    else:
        ax.set_ylabel(with_unit("difference", unit))
    ax.plot(t, difference / (noise or 1.0), "o", color=MEASURED, ms=1.8, mew=0, rasterized=t.size > 1500)
    reach = float(np.nanmax(np.abs(difference), initial=0.0)) / (noise or 1.0)
    reach = 1.15 * max(reach, 3.5 if noise else 0.0) or 1.0
    ax.set(ylim=(-reach, reach), xlabel="time [s]")


def _window_steps(ax: Axes, t: np.ndarray, edges: np.ndarray, rms: np.ndarray) -> None:
    if edges.size == rms.size:
        edges = np.append(edges, t[-1])
    if edges.size != rms.size + 1:
        edges = np.linspace(t[0], t[-1], rms.size + 1)
    ax.stairs(rms, edges, baseline=None, color=MODEL, lw=1.1)
    ax.axhline(1.0, color=INK, lw=0.8, ls="--", label="1: all that is left is noise")
    known = rms[np.isfinite(rms)]
    if known.size and known.max() > HUGE / 3:
        readable_log(ax, "y", 0.7 * min(1.0, known[known > 0.0].min()), 2.0 * known.max())
    else:
        ax.set_ylim(0.0, 1.3 * max(1.6, known.max(initial=0.0)))
    ax.set_ylabel("rms of each window\nover noise")
    ax.legend(loc="upper right")
