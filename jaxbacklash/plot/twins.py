"""Twins of the source paper's figures of chaos: exponents over the drive, phase plots, noise taken off, Cao's E1."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from .drawing import Where, ink, legend_above, panels, picture
from .style import GAP, MEASURED, MEDIUM, MODEL, SHORT, pretty_unit


@picture
def exponent_bars(
    amplitudes: Any, tangent: Any, series: Any, intervals: Any, words: list[str], *, paper: Any = None, unit: str = "bit/period",
    ax: Where = None,
) -> list[Axes]:  # fmt: skip
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
    ax : where to draw
    """
    tangent, series, intervals = np.atleast_2d(tangent), np.asarray(series, float), np.asarray(intervals, float)
    places = np.arange(len(words))
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    width = 0.27
    if paper is not None:
        ax.bar(places - width, np.asarray(paper), width, color=GAP, label="paper, Table 2")
    inside = np.maximum(tangent, 0.0)
    middle = inside.mean(axis=0)
    ax.bar(places, middle, width, color=MODEL, label="model's tangent; line: its starts")
    ax.vlines(places, inside.min(axis=0), inside.max(axis=0), color=ink(ax), lw=1.2)
    known = np.isfinite(series)
    shown = np.where(known, series, 0.0)
    ax.bar(places + width, shown, width, color=MEASURED, label="noisy series, 95 %")
    reach = np.abs(np.array([shown - intervals[:, 0], intervals[:, 1] - shown]))
    ax.errorbar(places[known] + width, shown[known], reach[:, known], fmt="none", color=ink(ax), lw=1.0, capsize=2)
    for place, word in zip(places, words):
        ax.annotate(word, (place + width, 0.0), (0, -2), textcoords="offset points", ha="center", va="top", fontsize=6.5,
                    rotation=0, color=MEASURED)  # fmt: skip
    ax.set_xticks(places, [f"{a:g}°" for a in np.asarray(amplitudes)])
    ax.tick_params(axis="x", pad=10, length=0)
    ax.set(xlabel="amplitude of the base", ylabel=f"largest exponent [{pretty_unit(unit)}]")
    ax.set_ylim(0.0, None)
    legend_above(axes)
    return axes


@picture
def phase_plots(shown: list[tuple[str, Any, bool]], delay: int, unit: str = "deg", *, ax: Where = None) -> list[Axes]:
    """Series against themselves one delay later, one panel a drive level (the paper's Figure 16).

    Parameters
    ----------
    shown : title, series (N,) and whether it is chaotic, in order
    delay : samples, the same for all
    ax : where to draw
    """
    columns = 4
    rows = -(-len(shown) // columns)
    axes = panels(ax, rows, columns, height=0.4 + 2.1 * rows)
    for ax, (title, values, chaotic) in zip(axes, shown):
        values = np.asarray(values)
        ax.plot(values[:-delay], values[delay:], lw=0.3, color=MODEL if chaotic else MEASURED, rasterized=True)
        ax.set_title(title, loc="left")
        ax.set_aspect("equal", adjustable="datalim")
        ax.tick_params(labelsize=7)
    for ax in axes[len(shown) :]:
        ax.set_visible(False)
    axes[0].figure.supxlabel(f"now [{unit}]", fontsize=9)
    axes[0].figure.supylabel(f"{delay} samples later [{unit}]", fontsize=9)
    return axes


@picture
def cleaned_signal(t: Any, noisy: Any, cleaned: Any, truth: Any = None, unit: str = "deg", *, ax: Where = None) -> list[Axes]:
    """A stretch of a signal as measured and with its noise taken off (the paper's Figure 17); below, what is left of each."""
    t, noisy, cleaned = (np.asarray(a) for a in (t, noisy, cleaned))
    axes = panels(ax, 2 if truth is not None else 1, height=MEDIUM if truth is not None else SHORT, sharex=True)
    axes[0].plot(t, noisy, ".", color=MEASURED, ms=2.0, label="as measured")
    axes[0].plot(t, cleaned, "-", color=MODEL, lw=1.0, label="noise taken off")
    axes[0].set_ylabel(f"z [{unit}]")
    if truth is not None and len(axes) > 1:
        axes[1].plot(t, noisy - truth, ".", color=MEASURED, ms=2.0)
        axes[1].plot(t, cleaned - truth, "-", color=MODEL, lw=1.0)
        axes[1].set_ylabel(f"error [{unit}]")
    axes[-1].set(xlabel="time [s]", xlim=(t[0], t[-1]))
    legend_above(axes)
    return axes


@picture
def cao_before_and_after(
    dimensions: Any, noisy: Any, cleaned: Any, chosen: tuple[int | None, int | None], *, ax: Where = None
) -> list[Axes]:
    """Cao's E1 over the dimension, solid as measured and dashed with the noise taken off (the paper's Figure 18)."""
    axes = panels(ax, height=SHORT + 0.3)
    ax = axes[0]
    for values, line, mark, colour, name, at in (
        (noisy, "-", "o", MEASURED, "as measured", chosen[0]), (cleaned, "--", "s", MODEL, "noise taken off", chosen[1]),
    ):  # fmt: skip
        told = "no dimension found" if at is None else f"dimension {at}"
        ax.plot(dimensions, values, mark + line, color=colour, ms=4, label=f"{name}: {told}")
        if at is not None:
            ax.plot(at, np.asarray(values)[at - 1], mark, color=colour, ms=10, mfc="none", mew=1.6)
    ax.axhline(1.0, color=ink(ax), lw=0.5, ls=":")
    ax.set(xlabel="embedding dimension", ylabel="Cao's E1", ylim=(0.0, 1.15))
    ax.legend(loc="lower right")
    return axes
