"""Figures against time: the record with its model, and what is left between them."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from .drawing import Where, column, empty, in_degrees, ink, legend_above, panels, picture, readable_log
from .style import GAP, MEASURED, MEDIUM, MODEL, SHORT, TALL, short, with_unit
from .thinning import envelope
from .zooms import stretch_around, window_bounds, window_misfit, worst_and_typical

HUGE = 30.0  # noise units from which a residual is drawn on a logarithmic scale


@picture
def measured_against_model(
    t: Any, measured: Any, model: Any, *, window_starts: Any, label: str, unit: str, noise: float | None,
    window_rms: Any = None, ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """The whole record above; below, the stretch that the model misses most and a typical one. On one axes, the whole record.

    Parameters
    ----------
    t, measured, model : (N,) time [s], the measured channel and its windowed prediction [unit]; NaN where there is none
    window_starts : (K,) times at which a prediction starts anew from its own estimated state [s]
    label, unit : what was measured, ``"z"`` in ``"rad"``
    noise : standard deviation of the measurement noise [unit]; None: unknown, no band is drawn
    window_rms : (K,) the prediction error of each window over the noise [1], which counts that of the input as well, as every
        error does that is told; None: the difference itself tells which window is missed most
    ax : where to draw
    """
    t, measured, model = column(t), column(measured), column(model)
    if t.size < 2:
        return empty(ax, "No samples to draw.")
    if not model.size:
        model = np.full(t.size, np.nan)
    axes = panels(ax, mosaic="ww;AB;ab", height=TALL, height_ratios=(1.15, 1.5, 0.75))
    whole = axes[0]
    _overview(whole, t, measured, model)
    whole.set(ylabel=with_unit(label, unit), xlim=(t[0], t[-1]))
    in_degrees(whole, "right", unit)
    if len(axes) == 1:
        legend_above(axes, *_marks(whole, None, label, windows=False))
        whole.set_xlabel("time [s]")
        return axes
    legend_above(axes, *_marks(whole, noise, label))
    whole.set_title("the whole record, time in s", loc="left")
    edges = window_bounds(t, window_starts)
    misfit, over_noise = window_misfit(measured - model, edges), column([] if window_rms is None else window_rms)
    judged = over_noise.size == misfit.size
    misfit = over_noise if judged else misfit
    for place, (index, name) in enumerate(zip(worst_and_typical(misfit), ("missed most", "typical"))):
        stretch = stretch_around(index, edges)
        start, end = t[stretch][0], t[stretch][-1]
        whole.axvspan(start, end, color=GAP, alpha=0.35, lw=0)
        middle = np.clip(0.5 * (start + end), t[0] + 0.01 * (t[-1] - t[0]), t[-1] - 0.01 * (t[-1] - t[0]))
        at = ("data", "axes fraction")
        whole.annotate("AB"[place], (middle, 0.98), xycoords=at, ha="center", va="top", weight="bold")
        upper, lower = axes[1 + place], axes[3 + place]
        local = [e - stretch.start for e in edges if stretch.start <= e <= stretch.stop]
        _zoom(upper, t[stretch], measured[stretch], model[stretch], local, noise)
        _left_over(lower, t[stretch], (measured - model)[stretch], local, noise, unit)
        missed = f"{misfit[index]:.3g} times the noise" if judged else _how_far(misfit[index], noise, label, unit)
        upper.set_title(f"{'AB'[place]}, {name}: {missed},\nwindow from {t[edges[index]]:.5g} s", loc="left")
        upper.tick_params(labelbottom=False)
        lower.set_xlim(upper.get_xlim())
        if place == 0:
            upper.set_ylabel(with_unit(label, unit))
        if noise:
            lower.set_ylabel(f"difference over\nnoise of {label}" if place == 0 else "")
    return axes


@picture
def stretch_of_model(
    t: Any, measured: Any, model: Any, *, window_starts: Any, label: str, unit: str, noise: float | None,
    between: tuple[float, float], ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """A stretch sample by sample: dots measured, a line for each window's prediction; below, what is left between them.

    Parameters
    ----------
    t, measured, model, window_starts, label, unit, noise : see `measured_against_model`
    between : first and last time that is shown [s]
    ax : where to draw; on one axes, without what is left
    """
    t, measured, model = column(t), column(measured), column(model)
    shown = np.flatnonzero((t >= between[0]) & (t <= between[1]))
    if shown.size < 2:
        return empty(ax, f"No samples between {between[0]:g} and {between[1]:g} s.")
    axes = panels(ax, 2, height=MEDIUM, height_ratios=(2.0, 1.0), sharex=True)
    stretch = slice(int(shown[0]), int(shown[-1]) + 1)
    edges = window_bounds(t, window_starts)
    inner = [int(e) for e in edges if stretch.start < e < stretch.stop]
    local = [e - stretch.start for e in (stretch.start, *inner, stretch.stop)]
    _zoom(axes[0], t[stretch], measured[stretch], model[stretch], local, noise)
    axes[0].set_ylabel(with_unit(label, unit))
    legend_above(axes, *_marks(axes[0], noise, label))
    if len(axes) == 1:
        axes[0].set_xlabel("time [s]")
        return axes
    _left_over(axes[1], t[stretch], (measured - model)[stretch], local, noise, unit)
    if noise:
        axes[1].set_ylabel(f"difference over\nnoise of {label}")
    return axes


@picture
def residual_in_time(t: Any, residual_over_noise: Any, *, window_edges: Any, window_rms: Any, ax: Where = None) -> list[Axes]:
    """What the model leaves, in units of the noise: every sample above, each window's root mean square below.

    Parameters
    ----------
    t : (N,) [s]
    residual_over_noise : (N,) measured minus model over the standard deviation of the noise [1]
    window_edges : (K,) starts, or (K + 1,) with the last end [s]
    window_rms : (K,) [1]; NaN for a window that is too short to judge
    ax : where to draw; on one axes, every sample
    """
    t, residual, rms = column(t), column(residual_over_noise), column(window_rms)
    if t.size < 2:
        return empty(ax, "No residual to draw.")
    axes = panels(ax, 2 if rms.size else 1, height=TALL * 0.72 if rms.size else SHORT, sharex=True)
    top = axes[0]
    top.axhspan(-2, 2, color=GAP, alpha=0.25, lw=0, label="±2 times the noise: 95 % of pure noise")
    for limit in (-2, 2):  # once more in front of a dense record
        top.axhline(limit, color=ink(top), lw=0.5, ls=(0, (3, 3)), zorder=3)
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
    axes[-1].set(xlabel="time [s]", xlim=(t[0], t[-1]))
    if len(axes) > 1:
        _window_steps(axes[1], t, column(window_edges), rms)
    return axes


@picture
def channels_in_time(t: Any, channels: dict[str, tuple[Any, str]], *, ax: Where = None) -> list[Axes]:
    """What was measured, one panel a channel.

    Parameters
    ----------
    t : (N,) [s]
    channels : by name, values (N,) and their unit
    ax : where to draw; on one axes, the first channel
    """
    t = column(t)
    axes = panels(ax, len(channels), height=0.7 + 1.5 * len(channels), sharex=True)
    for one, (name, (values, unit)) in zip(axes, channels.items()):
        times, low, high = envelope(t, values)
        if low is high:
            one.plot(times, low, color=MEASURED)
        else:
            one.fill_between(times, low, high, color=MEASURED, lw=0.4)
        one.set(ylabel=with_unit(name, unit), xlim=(t[0], t[-1]))
        in_degrees(one, "right", unit)
    axes[-1].set_xlabel("time [s]")
    return axes


def _how_far(misfit: float, noise: float | None, label: str, unit: str) -> str:
    """The rms of a difference in the channel's own noise: the prediction error counts the noise of the input as well."""
    if not np.isfinite(misfit):
        return "no prediction"
    return f"{misfit / noise:.3g} times the noise of {label}" if noise else f"{short(misfit)} {unit} rms"


def _marks(ax: Axes, noise: float | None, label: str, *, windows: bool = True) -> tuple[list[Any], list[str]]:
    """The marks of a record and its model, and their names."""
    dots = Line2D([], [], color=MEASURED, marker="o", ms=4, mew=0, ls="none")
    line, shade = Line2D([], [], color=MODEL, lw=1.2), Patch(color=ink(ax), alpha=0.08, lw=0)
    names = ["measured", f"model, ±2 times the noise of {label}" if noise else "model", "every other window"]
    return [dots, line, shade][: 2 + windows], names[: 2 + windows]


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
        ax.axvspan(t[start], t[min(end, t.size - 1)], color=ink(ax), alpha=0.06, lw=0)


def _zoom(ax: Axes, t: np.ndarray, measured: np.ndarray, model: np.ndarray, edges: list[int], noise: float | None) -> None:
    _shade(ax, t, edges)
    many = t.size > 1500
    ax.plot(t, measured, "o", color=MEASURED, ms=2.6, mew=0, rasterized=many)
    for start, end in pairwise(edges):
        inside = slice(start, end)
        if noise:
            ax.fill_between(t[inside], model[inside] - 2 * noise, model[inside] + 2 * noise, color=MODEL, alpha=0.3, lw=0)
        ax.plot(t[inside], model[inside], color=MODEL, lw=0.9)
    ax.set_xlim(t[0], t[-1])
    ax.margins(y=0.12)


def _left_over(ax: Axes, t: np.ndarray, difference: np.ndarray, edges: list[int], noise: float | None, unit: str) -> None:
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
    ax.axhline(1.0, color=ink(ax), lw=0.8, ls="--", label="1: all that is left is noise")
    known = rms[np.isfinite(rms)]
    if known.size and known.max() > HUGE / 3:
        readable_log(ax, "y", 0.7 * min(1.0, known[known > 0.0].min()), 2.0 * known.max())
    else:
        ax.set_ylim(0.0, 1.3 * max(1.6, known.max(initial=0.0)))
    ax.set_ylabel("rms of each window\nover noise")
    ax.legend(loc="upper right")
