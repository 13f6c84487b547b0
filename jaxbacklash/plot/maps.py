"""Figures of what a model does: maps of exponent and period, exponent and bifurcation curves, basins of attraction."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap

from .drawing import Where, column, empty, ink, legend_above, panels, picture
from .style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL, TALL, with_unit

SIGNED = LinearSegmentedColormap.from_list("signed", ["#134a78", MEASURED, "#f4f4f2", MODEL, "#7a2c05"]).with_extremes(bad=GAP)
PERIODS = 6
"""Periods that have a colour of their own; longer ones share one."""
PERIOD_COLOURS = ["#8a8f98", "#a32c0e", "#dcecf7", "#9cc9e8", "#2b83c6", "#0f9d78", "#8ccf6a", "#f1d33c", "#d9a01a"]
PERIOD_NAMES = ["unresolved", "chaotic", *(str(T) for T in range(1, PERIODS + 1)), f"over {PERIODS}"]
BASINS = [MEASURED, MODEL, HELDOUT, "#9467bd", "#e3c130", "#5b3a1e", "#d977a8", "#4a4f57"]
LABELS = {
    "inverse_alpha": "1/α", "zeta": "ζ", "Omega": "Ω", "drive.amplitude": "drive amplitude", "drive.frequency": "drive frequency",
}  # fmt: skip


def axis_label(name: str, unit: str | None) -> str:
    """A parameter as it stands beside an axis: ``1/α``, ``stiffness [N m/rad]``."""
    return with_unit(LABELS.get(name, name), unit)


@picture
def exponent_and_period_map(
    x: Any, y: Any, exponent: Any, period: Any, *, names: Sequence[str], units: Sequence[str], exponent_unit: str,
    ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """Two maps over two parameters: the largest exponent (zero is white) and the period of the motion.

    Parameters
    ----------
    x, y : (M,), (N,) values of the two parameters, evenly spaced
    exponent, period : (M, N); the period as `jaxbacklash.dynamics.periodicity` gives it
    names, units : of x and y
    exponent_unit : of the exponent
    ax : where to draw
    """
    x, y = column(x), column(y)
    exponent, period = np.asarray(exponent, dtype=float).T, np.asarray(period).T
    if not np.isfinite(exponent).any():
        return empty(ax, "No cell of this map could be followed.")
    axes = panels(
        ax, 1, 2, height=MEDIUM + 0.5, margins=(0.75, 0.1, 0.45, 0.1), sharex=True, sharey=True, gridspec_kw={"wspace": 0.14}
    )
    left = axes[0]
    extent = (*_sides(x), *_sides(y))
    known = exponent[np.isfinite(exponent)]
    reach = max(float(np.quantile(np.abs(known), 0.995)), 1e-9)
    image = left.imshow(exponent, vmin=-reach, vmax=reach, cmap=SIGNED, **_imaged(extent))
    bar = left.figure.colorbar(image, ax=left, location="top", shrink=0.9, aspect=30)
    bar.set_label(with_unit("largest exponent: orange chaotic, blue regular", exponent_unit), fontsize=8.0)
    if len(axes) > 1:
        _periods(axes[1], period, extent)
    for one in axes:
        one.grid(visible=False)
        one.set_xlabel(axis_label(names[0], units[0]))
    left.set_ylabel(axis_label(names[1], units[1]))
    return axes


def _periods(ax: Axes, period: np.ndarray, extent: tuple[float, float, float, float]) -> None:
    """The map of periods, a colour for each."""
    classes = np.clip(period, -1, PERIODS + 1) + 1
    image = ax.imshow(classes, cmap=ListedColormap(PERIOD_COLOURS), norm=BoundaryNorm(np.arange(-0.5, 9.5), 9), **_imaged(extent))
    bar = ax.figure.colorbar(image, ax=ax, location="top", shrink=0.9, aspect=30, ticks=range(9))
    bar.ax.set_xticklabels(["none", "chaos", *PERIOD_NAMES[2:8], f">{PERIODS}"], fontsize=7.0)
    bar.set_label("drive periods until the motion repeats", fontsize=8.0)


@picture
def exponent_curve(
    x: Any, exponent: Any, stderr: Any, *, name: str, unit: str, exponent_unit: str, samples: Any = None, title: str = "",
    play: tuple[float, float] | None = (-1.0, 1.0), length: str = "half plays", ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """The largest exponent against one parameter with its error bar; below, if given, the bifurcation diagram.

    Parameters
    ----------
    x : (N,) values of the parameter
    exponent, stderr : (N,)
    name, unit, exponent_unit : words for the axes
    samples : (S, N) stroboscopic samples of the position [half plays, or the system's unit]; None: only the curve
    play : edges of the play in the samples' unit, drawn as a band; None: no band
    length : unit of the samples
    ax : where to draw
    """
    x, exponent, stderr = column(x), column(exponent), column(stderr)
    axes = panels(
        ax, 2 if samples is not None else 1, height=TALL if samples is not None else MEDIUM,
        margins=(0.75, 0.1, 0.45, 0.5 if title else 0.35), sharex=True, gridspec_kw={"hspace": 0.08},
    )  # fmt: skip
    top = axes[0]
    top.axhline(0.0, color=ink(top), lw=0.8)
    wide = np.nan_to_num(2.0 * stderr)
    top.fill_between(x, exponent - wide, exponent + wide, color=MODEL, alpha=0.25, lw=0, label="±2 standard errors")
    top.plot(x, exponent, color=MODEL, lw=0.7)
    top.plot(x, np.where(exponent > wide, exponent, np.nan), "o", color=MODEL, ms=4.0, mew=0, label="chaotic: above zero")
    top.plot(x, np.where(exponent <= wide, exponent, np.nan), "v", color=MEASURED, ms=4.5, mew=0, label="not above zero")
    top.set(ylabel=with_unit("largest exponent", exponent_unit), xlim=(x.min(), x.max()))
    top.set_title(title, loc="left")
    legend_above(axes)
    if samples is not None and len(axes) > 1:
        scatter_samples(axes[1], x, np.asarray(samples), MEASURED, play)
        axes[1].set_ylabel(with_unit("p at whole periods" if length == "half plays" else "z at whole periods", length))
    axes[-1].set_xlabel(axis_label(name, unit))
    return axes


def scatter_samples(ax: Axes, x: np.ndarray, samples: np.ndarray, colour: str, play: tuple[float, float] | None) -> None:
    """Stroboscopic samples against a parameter, as dots; pixels keep their colour, so it may not be that of ink."""
    many = np.broadcast_to(x, samples.shape)
    size = float(np.clip(300.0 / max(x.size, 1), 1.4, 3.0))  # few columns leave room for dots that are seen
    ax.plot(many.ravel(), samples.ravel(), ".", ms=size, mew=0, color=colour, rasterized=True)
    if play is not None:
        ax.axhspan(*play, color=GAP, alpha=0.15, lw=0)
    ax.grid(visible=False)


@picture
def bifurcation_diagram(
    x: Any, branches: dict[str, Any], *, name: str, unit: str, length: str = "half plays",
    play: tuple[float, float] | None = (-1.0, 1.0), ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """Stroboscopic samples against one parameter: swept up, swept down, and from many starts, one above the other. On one axes,
    all in one.

    Parameters
    ----------
    x : (N,) values of the parameter
    branches : by a name for the legend, (..., N) samples
    name, unit : of the parameter; length: unit of the samples
    play : edges of the play in that unit, drawn as a band; None: no band
    ax : where to draw
    """
    x = column(x)
    shown = {label: np.asarray(s, dtype=float).reshape(-1, x.size) for label, s in branches.items()}
    if not shown:
        return empty(ax, "No samples to draw.")
    axes = panels(ax, len(shown), height=1.1 + 1.7 * len(shown), sharex=True, sharey=True)
    bands = [play] * len(axes) + [None] * len(shown)  # once on each axes
    for one, (label, samples), colour, band in zip(cycle(axes), shown.items(), cycle((MEASURED, MODEL, HELDOUT)), bands):
        scatter_samples(one, x, samples, colour, band)
        one.set(ylabel=f"{'p' if length == 'half plays' else 'z'} [{length}]", xlim=(x.min(), x.max()))
        if len(axes) == len(shown):
            one.set_title(label, loc="left")
        else:
            one.plot([], [], ".", color=colour, label=label)
    if len(axes) < len(shown):
        legend_above(axes)
    axes[-1].set_xlabel(axis_label(name, unit))
    return axes


@picture
def basin_picture(
    p: Any, v: Any, attractor: Any, *, words: Sequence[str], samples: Sequence[Any] = (), length: str = "half plays",
    play: tuple[float, float] | None = (-1.0, 1.0), ax: Where = None,
) -> list[Axes]:  # fmt: skip
    """Which attractor each start leads to.

    Parameters
    ----------
    p, v : (M,), (N,) starting positions and speeds, evenly spaced
    attractor : (M, N) number of the attractor, -1 where none was settled on
    words : a name for each attractor
    samples : for each attractor, (2, S) its stroboscopic positions and speeds; drawn as dots
    length, play : unit of the starts, and the edges of the play in it; None: no edges
    ax : where to draw
    """
    p, v = column(p), column(v)
    number = np.asarray(attractor).T
    # No colour stands in the legend that is not in the picture.
    first = 0 if (number < 0).any() or not words else 1
    shown = ["unsettled", *words][first:]
    colours = [GAP, *(BASINS[k % len(BASINS)] for k in range(len(words)))][first:]
    axes = panels(ax, height=MEDIUM + 1.0)
    ax = axes[0]
    image = ax.imshow(
        number + 1 - first, cmap=ListedColormap(colours), norm=BoundaryNorm(np.arange(-0.5, len(shown)), len(shown)),
        **_imaged((*_sides(p), *_sides(v))),
    )  # fmt: skip
    bar = ax.figure.colorbar(image, ax=ax, ticks=range(len(shown)))
    bar.ax.set_yticklabels(shown, fontsize=8.0)
    for k, dots in enumerate(samples):
        dots = np.asarray(dots, dtype=float)
        many = dots.shape[1] >= 30
        # Each in the colour of its basin, ringed so that it shows on every one.
        ring, size = (0.3, 2.0) if many else (1.3, 6.5)
        ax.plot(dots[0], dots[1], "o", color=BASINS[k % len(BASINS)], mec="white", mew=ring, ms=size)
    for edge in play or ():
        ax.axvline(edge, color="black", lw=0.8, ls="--")
    letter, speed = ("p", "half plays per τ") if length == "half plays" else ("z", f"{length}/s")
    ax.set(xlabel=f"{letter} at the start [{length}]", ylabel=f"{letter}′ at the start [{speed}]", xlim=_sides(p), ylim=_sides(v))
    ax.grid(visible=False)
    return axes


def _sides(values: np.ndarray) -> tuple[float, float]:
    """The outer sides of evenly spaced cells."""
    half = 0.5 * (values[-1] - values[0]) / max(values.size - 1, 1) or 0.5
    return float(values[0] - half), float(values[-1] + half)


def _imaged(extent: tuple[float, float, float, float]) -> dict[str, Any]:
    return {"origin": "lower", "aspect": "auto", "extent": extent, "interpolation": "nearest"}
