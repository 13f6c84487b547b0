"""The picture of each item, drawn from the numbers in its file alone."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain

import numpy as np
from matplotlib.axes import Axes

from jaxbacklash.plot.drawing import Page, ink, legend_above, on_page, panels, picture, readable_log, styled
from jaxbacklash.plot.maps import exponent_curve
from jaxbacklash.plot.style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL, SHORT, TALL
from jaxbacklash.plot.twins import cao_before_and_after, cleaned_signal, exponent_bars, phase_plots

from .item import Item


def page_of(item: Item) -> Page | None:
    """The item's picture as a page's figure; None for a table without one."""
    draw = DRAWN.get(item.key)
    return None if draw is None else draw(item)


def _exponents(item: Item) -> Page:
    c = item.curves
    page = on_page(exponent_curve, c["inverse_alpha"], c["exponent"], c["stderr"], name="inverse_alpha", unit="1",
                   exponent_unit="1/tau")  # fmt: skip
    ax = page.axes[0]
    with styled():
        ax.plot(c["checked_at"], c["checked"], "o", mfc="none", mec=ink(ax), mew=0.6, ms=5.0, label="Taylor series")
        legend_above(page.axes, columns=4)
    return page


@picture
def _bifurcation(c: dict[str, np.ndarray], *, ax: object = None) -> list[Axes]:
    axes = panels(ax, 2, height=TALL, sharex=True)
    for one, name, words in zip(axes, ("up", "down"), ("swept up", "swept down")):
        many = np.broadcast_to(c["inverse_alpha"], c[name].shape)
        one.axhspan(-1.0, 1.0, color=GAP, alpha=0.15, lw=0)
        one.plot(many.ravel(), c[name].ravel(), ".", ms=2.4, mew=0, color=MEASURED, rasterized=True)
        one.set(ylabel="p at whole periods [half plays]", title=words)
        one.grid(visible=False)
    axes[-1].set(xlabel="1/α = k₀x₀/A", xlim=(c["inverse_alpha"].min(), c["inverse_alpha"].max()))
    return axes


@picture
def _series(c: dict[str, np.ndarray], label: str, *, ax: object = None) -> list[Axes]:
    axes = panels(ax, height=SHORT)
    axes[0].fill_between(c["t"], c["low"], c["high"], color=MEASURED, lw=0.4)
    for edge in c.get("edges", ()):
        axes[0].axhline(edge, color=ink(axes[0]), lw=0.9, ls=(0, (4, 3)), label=None if edge < 0 else "edges of the play")
    if "edges" in c:
        axes[0].legend(loc="upper right")
    axes[0].set(xlabel="time [s]", ylabel=label, xlim=(c["t"][0], c["t"][-1]))
    top = axes[0].secondary_xaxis("top", functions=(lambda t: 0.4 * t, lambda f: f / 0.4))
    top.set_xlabel("frequency of the base [Hz]", fontsize=8.0)
    top.spines[:].set_visible(False)
    return axes


@picture
def _response(c: dict[str, np.ndarray], *, ax: object = None) -> list[Axes]:
    axes = panels(ax, 2, height=MEDIUM, sharex=True, height_ratios=(3.0, 1.0))
    size, line = axes[0], c["frequency"]
    inertia, stiffness, damping = c["mode"]
    omega = 2.0 * np.pi * line
    mode = np.abs(1.0 / (stiffness - inertia * omega**2 + 1j * damping * omega))
    size.plot(line, c["size"], color=MEASURED, lw=1.4, label="H1")
    size.plot(line, mode, color=MODEL, lw=1.2, ls=(0, (5, 2)), label="fitted mode")
    size.plot(line, 1.0 / (inertia * omega**2), color=ink(size), lw=0.8, ls=":", label="mass line, 1/(Jω²)")
    readable_log(size, "y", 0.3 * float(mode.min()), 3.0 * float(mode.max()))
    size.set_ylabel("|Y/F| [rad/(N m)]")
    axes[1].plot(line, c["coherence"], color=MEASURED, lw=1.0)
    axes[1].set(xlabel="frequency [Hz]", ylabel="coherence", ylim=(0.0, 1.05))
    for one in axes:
        readable_log(one, "x", float(line[0]), float(line[-1]))
    legend_above(axes)
    return axes


METHODS = {"hilbert": ("Hilbert transform", GAP, 0.5), "filtered": ("low-passed at 0.5 %", MEASURED, 1.2),
           "wavelet": ("wavelet ridge", MODEL, 1.2)}  # fmt: skip


@picture
def _envelopes(c: dict[str, np.ndarray], *, ax: object = None) -> list[Axes]:
    axes = panels(ax, 1, 2, height=MEDIUM)
    for name, (label, colour, width) in METHODS.items():
        axes[0].plot(c[f"{name}_t"], c[f"{name}_amplitude"], color=colour, lw=width, label=label)
        axes[1].plot(c[f"{name}_t"], c[f"{name}_frequency"], color=colour, lw=width)
    axes[1].plot([0.0, 30.0], [0.0, 12.0], color=ink(axes[1]), lw=1.3, ls=(0, (1, 2)), zorder=4, label="the base's own")
    axes[0].set(xlabel="time [s]", ylabel="envelope [deg]", xlim=(0.0, 30.0), ylim=(0.0, None))
    axes[1].set(xlabel="time [s]", ylabel="frequency [Hz]", xlim=(0.0, 30.0), ylim=(0.0, 15.0))
    handles, labels = (list(chain(*both)) for both in zip(*(one.get_legend_handles_labels() for one in axes)))
    legend_above(axes, handles, labels, columns=4, all_panels=True)
    return axes


@picture
def _restoring(c: dict[str, np.ndarray], *, ax: object = None) -> list[Axes]:
    axes = panels(ax, 1, 2, height=MEDIUM, sharex=True, sharey=True)
    for one, names in zip(axes, (("hilbert_1", "hilbert_05"), ("wavelet",))):
        one.plot(c["true_amplitude"], c["true_force"], color=ink(one), lw=0.8, ls=":", label="true: describing function")
        for name, colour in zip(names, (MEASURED, HELDOUT) if len(names) > 1 else (MODEL,)):
            label = {"hilbert_1": "Hilbert, 1 %", "hilbert_05": "Hilbert, 0.5 %", "wavelet": "wavelet"}[name]
            one.plot(c[f"{name}_amplitude"], c[f"{name}_force"], ".", ms=2.2, mew=0, color=colour, label=label)
            upper = c[f"{name}_amplitude"] > np.median(c[f"{name}_amplitude"])
            slope, offset = np.polyfit(c[f"{name}_amplitude"][upper], c[f"{name}_force"][upper], 1)
            reach = np.array([-offset / slope, c["true_amplitude"].max()])
            one.plot(reach, slope * reach + offset, color=colour, lw=1.0, ls=(0, (5, 2)))
        one.plot([], [], color=GAP, lw=1.0, ls=(0, (5, 2)), label="line through the upper half")
        one.set(xlabel="amplitude of z [deg]", xlim=(0.0, None), ylim=(-5.0, 1.1 * float(c["true_force"].max())))
        one.legend(loc="upper left", markerscale=3.0)
    axes[0].set_ylabel("restoring torque [N m]")
    return axes


@picture
def _response_in_time(c: dict[str, np.ndarray], *, ax: object = None) -> list[Axes]:
    axes = panels(ax, height=SHORT)
    axes[0].plot(c["t"], c["x"], color=GAP, lw=0.9, label="base x")
    axes[0].plot(c["t"], c["z"], color=MODEL, lw=1.0, label="across the joint z")
    axes[0].set(xlabel="time [s]", ylabel="angle [deg]", xlim=(c["t"][0], c["t"][-1]))
    legend_above(axes)
    return axes


def _levels(item: Item) -> Page:
    c = item.curves
    words = ["chaotic" if yes else "regular" for yes in c["chaotic"]]
    return on_page(exponent_bars, c["amplitude"], c["tangent"], c["series"], c["interval"], words, paper=c["paper"])


def _phases(item: Item) -> Page:
    c, delay = item.curves, int(item.curves["delay"][0])
    shown = [(f"{a:.2f}°", now, later, bool(yes)) for a, now, later, yes in
             zip(c["amplitude"], c["now"], c["later"], c["chaotic"])]  # fmt: skip
    page = on_page(phase_plots, [(title, np.zeros(delay + 1), yes) for title, _, _, yes in shown], delay)
    for ax, (_, now, later, yes) in zip(page.axes, shown):  # the file holds both axes, not the series that they come from
        ax.lines[0].remove()
        ax.plot(now, later, lw=0.3, color=MODEL if yes else MEASURED, rasterized=True)
        ax.relim()
        ax.autoscale_view()
    return page


def _cleaned(item: Item) -> Page:
    c = item.curves
    return on_page(cleaned_signal, c["t"], c["noisy"], c["simple"], c["truth"])


def _dimensions(item: Item) -> Page:
    c = item.curves
    chosen = [None if np.isnan(one) else int(one) for one in c["chosen"]]
    return on_page(cao_before_and_after, c["dimension"], c["noisy"], c["cleaned"], (chosen[0], chosen[1]))


DRAWN: dict[str, Callable[[Item], Page]] = {
    "figure_02": _exponents,
    "figure_03": lambda item: on_page(_bifurcation, item.curves),
    "figure_08": lambda item: on_page(_series, item.curves, "x [deg]"),
    "figure_09": lambda item: on_page(_series, item.curves, "y [deg]"),
    "figure_10": lambda item: on_page(_series, item.curves, "z [deg]"),
    "figure_11": lambda item: on_page(_response, item.curves),
    "figure_12": lambda item: on_page(_envelopes, item.curves),
    "figure_13": lambda item: on_page(_envelopes, item.curves),
    "figure_14": lambda item: on_page(_restoring, item.curves),
    "figure_15": lambda item: on_page(_response_in_time, item.curves),
    "figure_16": _phases,
    "figure_17": _cleaned,
    "figure_18": _dimensions,
    "table_2": _levels,
}
