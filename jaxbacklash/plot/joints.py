"""Figures of the joint itself: where it moves, and the torque it carries, against the relative motion z."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from .drawing import Where, column, empty, in_degrees, ink, legend_above, panels, picture
from .style import GAP, MEASURED, MEDIUM, MODEL, pretty_unit, short, with_unit
from .thinning import strided

CELLS = (760, 380)  # of a density, across a whole figure and up
DENSE = 600_000  # points that a trajectory is filled in to, so that a coarse rate does not fall apart into dots
POINTS = 30_000  # measured points that are drawn one by one


@picture
def phase_plane(
    z: Any, dz: Any, *, edges: Any, model_z: Any = None, model_dz: Any = None, unit: str = "rad", ax: Where = None
) -> list[Axes]:
    """How often the joint passes each relative position and speed, with the play between its two edges.

    Parameters
    ----------
    z, dz : (N,) relative motion [unit] and its rate [unit/s]; NaN breaks the path
    edges : lower and upper edge of the play [unit], or None
    model_z, model_dz : (M,) the same of the model, drawn beside it on the same scales
    unit : ``"rad"`` or ``"m"``
    ax : where to draw
    """
    paths = [("measured", column(z), column(dz), MEASURED)]
    if model_z is not None and model_dz is not None:
        paths.append(("model", column(model_z), column(model_dz), MODEL))
    shown = [np.isfinite(across) & np.isfinite(up) for _, across, up, _ in paths]
    if max(int(s.sum()) for s in shown) < 2:
        return empty(ax, "No motion to draw.")
    widths = [_reach(np.concatenate([path[k][s] for path, s in zip(paths, shown)])) for k in (1, 2)]
    play = play_edges(edges)
    if play:  # both edges stay in the picture, however little the joint moves
        margin = 0.15 * (play[1] - play[0])
        widths[0] = (min(widths[0][0], play[0] - margin), max(widths[0][1], play[1] + margin))
    axes = panels(ax, 1, len(paths), height=MEDIUM, sharex=True, sharey=True)
    for one, (name, across, up, colour) in zip(axes, paths):
        _density(one, across, up, widths, colour, CELLS[0] // len(paths))
        mark_play(one, play)
        one.set(xlabel=with_unit("z", unit), xlim=widths[0], ylim=widths[1])
        one.set_title(name, loc="left")
        one.grid(False)
        one.xaxis.set_major_locator(MaxNLocator(6 if len(paths) > 1 else 9))
    axes[0].set_ylabel(with_unit("z′", f"{unit}/s"))
    if play:
        legend_above(axes, [Patch(color=GAP, alpha=0.4, lw=0)], [_play_text(play, unit)], all_panels=True)
    return axes


@picture
def restoring_force(
    z: Any,
    torque_points: Any,
    *,
    model_z: Any,
    model_torque: Any,
    edges: Any,
    unit: str,
    length_unit: str = "rad",
    label: str = "torque of the joint",
    ax: Where = None,
) -> list[Axes]:
    """Measured torque against relative motion as points, the fitted law as a line, the edges of the play marked.

    Parameters
    ----------
    z, torque_points : (N,) relative motion [length_unit] and the torque from smoothed acceleration [unit]
    model_z, model_torque : (M,) the model's law [length_unit], [unit]
    edges : lower and upper edge of the play [length_unit], or None when it was not found
    unit, length_unit : ``"N m"`` and ``"rad"``; ``"rad/s^2"`` per unit inertia; ``"N"``, ``"m"`` of a translating mass
    label : what the torque is
    ax : where to draw
    """
    z, points = column(z), column(torque_points)
    line_z, line = column(model_z), column(model_torque)
    if not z.size and not line_z.size:
        return empty(ax, "No torque to draw.")
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    thin = strided(z.size, POINTS)
    many = z[thin].size
    opacity = 0.5 if many > 4000 else 0.7
    ax.plot(z[thin], points[thin], ".", color=MEASURED, ms=2.4, mew=0, alpha=opacity, rasterized=many > 500)
    # A proxy, since the legend of a faint dot would be invisible.
    ax.plot([], [], ".", color=MEASURED, ms=5, mew=0, label="measured, from smoothed acceleration")
    ax.plot(line_z, line, color=MODEL, lw=1.6, label="model")
    play = play_edges(edges)
    mark_play(ax, play)
    ax.axhline(0.0, color=ink(ax), lw=0.5)
    ax.margins(x=0.02, y=0.08)
    if play:
        ax.fill([], [], color=GAP, alpha=0.4, lw=0, label=_play_text(play, length_unit))
    ax.set(xlabel=with_unit("z", length_unit), ylabel=with_unit(label, unit))
    in_degrees(ax, "top", length_unit)
    ax.legend(loc="best", markerscale=1.2)
    return axes


@picture
def force_loop(
    x: Any, force: Any, model: Any, *, level: float, unit: str, length_unit: str = "m", label: str = "transmitted force T",
    ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """Transmitted force against base motion, measured and modelled, with the band in which it counts as nothing.

    Parameters
    ----------
    x : (N,) base motion [length_unit]
    force, model : (N,) transmitted force as measured and as predicted [unit]; NaN breaks the lines
    level : force below which the joint counts as carrying nothing [unit]
    unit, length_unit : ``"N"`` and ``"m"``, or ``"N m"`` and ``"rad"``
    ax : where to draw
    """
    x, force, model = column(x), column(force), column(model)
    if x.size < 2:
        return empty(ax, "No force to draw.")
    axes = panels(ax, 1, 2, height=MEDIUM, sharex=True, sharey=True)
    thin = strided(x.size, POINTS)
    pairs = axes if len(axes) == 2 else axes * 2  # on one axes, one over the other
    for one, (name, values, colour) in zip(pairs, (("measured", force, MEASURED), ("model", model, MODEL))):
        one.axhspan(-level, level, color=GAP, alpha=0.16 if len(axes) > 1 else 0.08, lw=0, zorder=0)
        one.plot(x[thin], values[thin], color=colour, lw=0.8, rasterized=x[thin].size > 4000, label=name)
        one.axhline(0.0, color=ink(one), lw=0.5)
        one.set(xlabel=with_unit("x", length_unit))
        if len(axes) > 1:
            one.set_title(name, loc="left")
        one.xaxis.set_major_locator(MaxNLocator(6))
        one.margins(x=0.03, y=0.06)
    axes[0].set_ylabel(with_unit(label, unit))
    shade, words = [Patch(color=GAP, alpha=0.4, lw=0)], ["a tenth of the sliding force"]
    lines = axes[0].get_lines()[::2] if len(axes) == 1 else []
    legend_above(axes, [*lines, *shade], [*(str(line.get_label()) for line in lines), *words], all_panels=True)
    return axes


def play_edges(edges: Any) -> tuple[float, float] | None:
    """Both edges of the play in ascending order, or None when either is missing."""
    if edges is None or len(edges) != 2 or any(e is None for e in edges):
        return None
    low, high = sorted(float(e) for e in edges)
    return (low, high) if math.isfinite(low) and math.isfinite(high) and high > low else None


def mark_play(ax: Axes, play: tuple[float, float] | None) -> None:
    """Shade the gap and draw its two edges."""
    if play is None:
        return
    ax.axvspan(*play, color=GAP, alpha=0.16, lw=0, zorder=0)
    for edge in play:
        ax.axvline(edge, color=GAP, lw=1.0, ls=(0, (4, 2)))


def _play_text(play: tuple[float, float], unit: str) -> str:
    low, high = play
    text = f"total play b = {short(high - low, 4)} {pretty_unit(unit)}"
    if unit == "rad":
        text += f" = {short(math.degrees(high - low), 4)} deg"
    return text


def _reach(values: np.ndarray) -> tuple[float, float]:
    """Limits that hold all but a few strays: a rate is often wild in the first and last samples."""
    low, high = np.quantile(values, [0.001, 0.999])
    wide = 0.15 * (high - low)
    low, high = max(low - wide, values.min()), min(high + wide, values.max())
    margin = 0.05 * (high - low) or 1.0
    return float(low - margin), float(high + margin)


def _density(ax: Axes, across: np.ndarray, up: np.ndarray, widths: list[tuple[float, float]], colour: str, cells: int) -> None:
    """Visits per cell of the straight lines between samples, as opacity on a logarithmic scale."""
    if across.size < 2:
        return
    fill = max(1, min(40, DENSE // across.size))
    at = np.arange(0, (across.size - 1) * fill + 1) / fill
    own = np.arange(across.size)
    fine = np.interp(at, own, across), np.interp(at, own, up)
    visits, _, _ = np.histogram2d(*fine, bins=(cells, CELLS[1]), range=widths)
    if not visits.max() > 0.0:
        return
    # A palette of one hue whose opacity rises reads on white and on black, where light-to-dark would vanish on one.
    shades = np.column_stack([np.tile(to_rgb(colour), (256, 1)), np.concatenate([[0.0], np.linspace(0.4, 1.0, 255)])])
    level = np.log1p(visits) / math.log1p(visits.max())
    ax.imshow(
        level.T, origin="lower", extent=(*widths[0], *widths[1]), aspect="auto", cmap=ListedColormap(shades),
        vmin=0.0, vmax=1.0, interpolation="none", zorder=2,
    )  # fmt: skip
