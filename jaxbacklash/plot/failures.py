"""Figures of where a model fails: misfit and missing torque against what they depend on, in time, and over coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm, to_rgba
from matplotlib.ticker import MaxNLocator

from .drawing import Where, column, empty, in_degrees, ink, legend_above, panels, picture
from .joints import mark_play, play_edges
from .style import GAP, MEASURED, MEDIUM, MODEL, short, with_unit
from .thinning import envelope, strided

POINTS = 6000
SHORT_NAMES = {
    "contact, negative side": "contact −", "negative edge": "edge −", "inside the play": "play", "positive edge": "edge +",
    "contact, positive side": "contact +",
}  # fmt: skip


@picture
def misfit_and_torque(dependences: Sequence[Any], *, unit: str, ax: Where = None) -> list[Axes]:
    """Misfit above and missing torque below, against each coordinate that tells something. On one axes, the first one's misfit.

    Parameters
    ----------
    dependences : see `jaxbacklash.residuals.Dependence` for what each holds; at most three are drawn
    unit : of the torque
    ax : where to draw
    """
    shown = list(dependences)[:3]
    if not shown:
        return empty(ax, "The misfit depends on none of the coordinates that were tried.")
    axes = panels(ax, 2, len(shown), height=MEDIUM + 0.6, sharex="col")
    for place, entry in enumerate(shown[: len(axes)]):
        edges = np.arange(len(entry.names) + 1.0) if entry.names else column(entry.edges)
        upper, lower = axes[place], axes[(place + len(shown)) % len(axes)]
        upper.stairs(column(entry.misfit), edges, fill=True, color=MODEL, alpha=0.85, lw=0)
        upper.axhline(1.0, color=ink(upper), lw=0.8, ls="--")
        if lower is not upper:
            _torque_bins(lower, edges, entry)
        if entry.names:
            lower.set_xticks(0.5 * (edges[1:] + edges[:-1]), [SHORT_NAMES.get(name, name) for name in entry.names])
            if len(entry.names) > 2:
                lower.tick_params(axis="x", rotation=30 if len(shown) > 1 else 0)
        elif len(shown) > 1:
            lower.xaxis.set_major_locator(MaxNLocator(4))  # long numbers would run into one another
        lower.set_xlabel(with_unit(entry.label.replace("'", "′"), entry.unit))
        lower.set_xlim(edges[0], edges[-1])
        share = column(entry.share)
        if entry.names and len(share) <= 6:
            top = 1.22 * float(np.nanmax(column(entry.misfit)))
            upper.set_ylim(0.0, max(top, 1.5))
            upper.set_title("%: share of the torque's mean square", fontsize=8, loc="left")
            for middle, height, part in zip(0.5 * (edges[1:] + edges[:-1]), column(entry.misfit), share):
                if np.isfinite(height):
                    upper.annotate(f"{100 * part:.0f} %", (middle, height), xytext=(0, 2), textcoords="offset points",
                                   ha="center", fontsize=8)  # fmt: skip
    axes[0].set_ylabel("misfit over noise")
    if len(axes) > 1:
        axes[len(shown)].set_ylabel(with_unit("missing torque", unit))
        for before, lower in pairwise(list(axes[len(shown) :])[::-1]):  # said once where all say the same
            if before.get_title(loc="left") == lower.get_title(loc="left"):
                before.set_title("", loc="left")
    return axes


def _torque_bins(ax: Axes, edges: np.ndarray, entry: Any) -> None:
    """Mean of the torque with its error, or its size, in the bins of one coordinate."""
    mean, error, rms = column(entry.mean), column(entry.error), column(entry.rms)
    ax.axhline(0.0, color=ink(ax), lw=0.5)
    if entry.of == "size":
        ax.stairs(rms, edges, baseline=None, color=MEASURED, lw=1.6)
        ax.set_ylim(0.0, None)
        ax.set_title("root mean square", fontsize=8, loc="left")
        return
    for (left, right), middle, spread in zip(pairwise(edges), mean, error):
        if np.isfinite(middle):
            spread = 2.0 * spread if np.isfinite(spread) else 0.0
            ax.fill_between([left, right], middle - spread, middle + spread, color=MEASURED, alpha=0.3, lw=0)
    ax.stairs(mean, edges, baseline=None, color=MEASURED, lw=1.6)
    ax.set_title("mean, with ±2 standard errors", fontsize=8, loc="left")


@picture
def missing_torque_in_time(
    t: Any, torque: Any, stderr: Any, *, unit: str, explained: Any = None, name: str = "", ax: Where = None
) -> list[Axes]:
    """The missing torque with its 95 % band: one stretch where it is large, and above it the whole record. On one axes, the
    stretch.

    Parameters
    ----------
    t, torque, stderr : (N,) time [s], torque and its standard error [unit]
    unit : of the torque
    explained : (N,) the part that is a function of its best coordinates [unit], or None
    name : what those coordinates are
    ax : where to draw
    """
    t, torque, stderr, explained = column(t), column(torque), column(stderr), column(explained)
    if t.size < 2:
        return empty(ax, "No torque to draw.")
    axes = panels(ax, 2, height=MEDIUM + 0.4, height_ratios=(1, 1.5))
    lower = axes[-1]
    length = min(t[-1] - t[0], max(2.0, 0.05 * (t[-1] - t[0])))
    energy = np.concatenate([[0.0], np.cumsum(torque**2)])
    last = np.searchsorted(t, t + length)
    # The stretch of median strength among the strong ones: the very strongest is often a single impact.
    strength = energy[np.minimum(last, t.size)] - energy[: t.size]
    strength[t + length > t[-1] + 1e-9] = -1.0
    start = int(np.argsort(strength)[-max(1, int(0.1 * np.sum(strength >= 0.0)))])
    shown = slice(start, max(int(last[start]), start + 2))
    if len(axes) > 1:
        _whole(axes[0], t, torque, (t[shown][0], t[shown][-1]))
    lower.fill_between(
        t[shown], (torque - 1.96 * stderr)[shown], (torque + 1.96 * stderr)[shown], color=MEASURED, alpha=0.3, lw=0,
        label="95 % band",
    )  # fmt: skip
    lower.plot(t[shown], torque[shown], color=MEASURED, lw=1.1, label="missing torque")
    if explained.size == t.size:
        lower.plot(t[shown], explained[shown], color=MODEL, lw=1.4, label=f"as a function of {name}")
    for one in axes:
        one.axhline(0.0, color=ink(one), lw=0.5)
        one.set_ylabel(with_unit("torque", unit))
    lower.margins(y=0.12)
    lower.set(xlabel="time [s]", xlim=(t[shown][0], t[shown][-1]))
    legend_above([lower])
    return axes


def _whole(ax: Axes, t: np.ndarray, torque: np.ndarray, shown: tuple[float, float]) -> None:
    """The torque of the whole record, with the stretch that is shown beside it."""
    times, low, high = envelope(t, torque, 900)
    if low is high:
        ax.plot(times, torque, color=MEASURED, lw=0.8)
    else:
        ax.fill_between(times, low, high, color=MEASURED, lw=0.4)
    ax.axvspan(*shown, color=GAP, alpha=0.35, lw=0)
    ax.set_xlim(t[0], t[-1])
    ax.set_title("the whole record, time in s", loc="left")


@picture
def missing_torque_curve(
    values: Any, torque: Any, knots: Any, table: Any, stderr: Any, *, label: str, unit: str, coordinate_unit: str,
    edges: Any = None, ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """The missing torque over the one coordinate that explains it best, with the band of the curve.

    Parameters
    ----------
    values, torque : (N,) the coordinate [coordinate_unit] and the missing torque [unit]
    knots, table, stderr : (K,) the curve, piecewise linear, and its standard error
    label : the coordinate
    edges : edges of the play where the coordinate is z, else None
    ax : where to draw
    """
    values, torque, knots = column(values), column(torque), column(knots)
    table, stderr = column(table), column(stderr)
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    thin = strided(values.size, POINTS)
    ax.plot(values[thin], torque[thin], ".", color=MEASURED, ms=2.6, mew=0, alpha=0.5, rasterized=True)
    ax.plot([], [], ".", color=MEASURED, ms=5, mew=0, label="missing torque, moment by moment")
    ax.fill_between(knots, table - 1.96 * stderr, table + 1.96 * stderr, color=MODEL, alpha=0.3, lw=0)
    ax.plot(knots, table, color=MODEL, lw=1.7, label="as a function of this alone, with 95 % band")
    mark_play(ax, play_edges(edges))
    ax.axhline(0.0, color=ink(ax), lw=0.5)
    ax.set(xlabel=with_unit(label, coordinate_unit), ylabel=with_unit("missing torque", unit))
    low, high = np.quantile(torque, [0.002, 0.998])
    low, high = min(low, table.min()), max(high, table.max())
    ax.set_ylim(low - 0.15 * (high - low), high + 0.15 * (high - low))
    if values.size:
        ax.set_xlim(values.min(), values.max())
    in_degrees(ax, "top", coordinate_unit)
    ax.legend(loc="best")
    return axes


@picture
def missing_torque_surface(
    values: Any, torque: Any, knots: Any, table: Any, stderr: Any, *, labels: Any, units: Any, unit: str, ax: Where = None
) -> list[Axes]:
    """The missing torque over two coordinates: slices along the second, one for each of a few values of the first, with bands.

    Parameters
    ----------
    values, torque : (N, 2) the coordinates and (N,) the missing torque [unit]
    knots : two rows of knots; ``table``, ``stderr`` (K1 K2,) values there, the second coordinate running fastest
    labels, units : two names and two units of the coordinates
    ax : where to draw
    """
    values, torque = np.asarray(values, float), column(torque)
    first, second = column(knots[0]), column(knots[1])
    grid, spread = column(table).reshape(first.size, -1), column(stderr).reshape(first.size, -1)
    if first.size == 3 and labels[0] == "side":
        return _slices(values, torque, second, grid, spread, labels, units, unit, ax)
    axes = panels(ax, 1, 2, height=MEDIUM + 0.3, width_ratios=(1.25, 1))
    ax = axes[0]
    reach = float(np.max(np.abs(grid))) or 1.0
    # Clear in the middle, so that it reads on a light page and on a dark one.
    colours = LinearSegmentedColormap.from_list("torque", [to_rgba(MEASURED), to_rgba(GAP, 0.12), to_rgba(MODEL)])
    seen = np.histogram2d(values[:, 0], values[:, 1], bins=(_around(first), _around(second)))[0] > 0
    image = ax.pcolormesh(
        _around(first), _around(second), np.where(seen, grid, np.nan).T, cmap=colours, norm=TwoSlopeNorm(0.0, -reach, reach)
    )
    bar = ax.figure.colorbar(image, ax=ax, label=with_unit("missing torque", unit))
    bar.outline.set_visible(False)
    ax.set(xlabel=with_unit(labels[0], units[0]), ylabel=with_unit(labels[1], units[1]))
    ax.grid(False)
    if len(axes) == 1:
        return axes
    chosen = [0, first.size // 2, first.size - 1]
    for index, style in zip(chosen, ((0, (1, 1)), "-", (0, (4, 2)))):
        used = seen[index]
        line, band = grid[index][used], 1.96 * spread[index][used]
        name = f"{labels[0]} = {short(first[index])}"
        axes[1].plot(second[used], line, color=MODEL, ls=style, lw=1.5, label=name)
        axes[1].fill_between(second[used], line - band, line + band, color=MODEL, alpha=0.18, lw=0)
    axes[1].axhline(0.0, color=ink(axes[1]), lw=0.5)
    axes[1].set(xlabel=with_unit(labels[1], units[1]))
    axes[1].set_title("slices, with 95 % bands", loc="left")
    axes[1].legend(loc="best")
    return axes


def _slices(
    values: np.ndarray, torque: np.ndarray, second: np.ndarray, grid: np.ndarray, spread: np.ndarray, labels: Any, units: Any,
    unit: str, where: Where,
) -> list[Axes]:  # fmt: skip
    """One panel for each side of the play. On one axes, its inside."""
    axes = panels(where, 1, 3, height=MEDIUM, sharey=True)
    sides = ((-1, "contact, negative side"), (0, "inside the play"), (1, "contact, positive side"))
    for ax, (side, name) in zip(axes, sides if len(axes) > 1 else sides[1:2]):
        row, band = grid[side + 1], 1.96 * spread[side + 1]
        here = values[:, 0] == side
        across, up = values[here, 1], torque[here]
        thin = strided(across.size, POINTS // 3)
        ax.plot(across[thin], up[thin], ".", color=MEASURED, ms=2.4, mew=0, alpha=0.5, rasterized=True)
        used = np.ones(second.size, bool)
        if across.size:
            used = (second >= across.min() - 1e-9) & (second <= across.max() + 1e-9)
        ax.fill_between(second[used], (row - band)[used], (row + band)[used], color=MODEL, alpha=0.3, lw=0)
        ax.plot(second[used], row[used], color=MODEL, lw=1.7)
        ax.axhline(0.0, color=ink(ax), lw=0.5)
        ax.set(xlabel=with_unit(labels[1], units[1]))
        ax.set_title(name, loc="left")
    low, high = np.quantile(torque, [0.002, 0.998])
    axes[0].set(ylabel=with_unit("missing torque", unit), ylim=(1.3 * low, 1.3 * high))
    return axes


def _around(centres: np.ndarray) -> np.ndarray:
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
