"""Figures of a record's oscillation, as the paper's 8 to 11: envelopes, frequency, and the ridge of its wavelet transform."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.patches import Patch

from ..skeletons import Skeleton, Skeletons
from ..skeletons.fundamental import WaveletFundamental
from .drawing import Where, empty, ink, legend_above, panels, picture, readable_log
from .methods import COLOURS, MARKS, NAMES, half_play, once, surest
from .style import GAP, MEASURED, MEDIUM, MODEL, SHORT, TALL, with_unit
from .thinning import envelope


@picture
def envelopes(found: Skeletons, *, ax: Where = None) -> list[Axes]:
    """What drives and what answers, with both methods' envelopes, the play's edges and the stretches that do not count.

    Parameters
    ----------
    found : from `jaxbacklash.skeleton`
    ax : where to draw; on one axes, what answers

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.skeleton(record, inertia=3.16)
    >>> drive, answer = jb.plot.envelopes(found)
    >>> drive.get_ylabel(), answer.get_ylabel()
    ('x [rad]', 'z [rad]')
    """
    record = found.record
    unit = "m" if found.translational else "rad"
    z = record.channels["z"] if "z" in record.channels else record.channels["y"] - record.channels.get("x", 0.0)
    drive = record.input_name
    axes = panels(ax, 2 if drive else 1, height=TALL if drive else MEDIUM, sharex=True)
    rows = ([(drive, record.channels[drive], "drive")] if drive else []) + [("z", z, "amplitude")]
    for one, (name, values, of) in zip(axes, rows[-len(axes) :]):
        times, low, high = envelope(record.t, values)
        one.fill_between(times, low, high, color=MEASURED, lw=0.3, alpha=0.45)
        for method in found.methods:
            curve = getattr(method, of)
            if curve is not None and curve.size:
                one.plot(method.t, curve, color=COLOURS[method.method], lw=1.2, label=f"{NAMES[method.method]} envelope")
        one.set_ylabel(with_unit(name, ("N" if found.translational else "N m") if name == "F" else unit))
        largest = float(np.max(np.abs(values)))
        one.set_ylim(-1.15 * largest, 1.15 * largest)
    last = axes[-1]
    half = half_play(found)
    if half is not None:
        centre = surest(found).centre
        for edge in (centre - half, centre + half):
            last.axhline(edge, color=ink(last), lw=0.8, ls=(0, (4, 2)))
        last.plot([], [], color=ink(last), lw=0.8, ls=(0, (4, 2)), label="edges of the play")
    _shade_masked(last, surest(found))
    last.set_xlabel("time [s]")
    last.set_xlim(record.t[0], record.t[-1])
    legend_above(axes, *once(axes), columns=4, all_panels=True)
    return axes


@picture
def instantaneous_frequency(found: Skeletons, *, ax: Where = None) -> list[Axes]:
    """Frequency of what sets the pace, and the undamped natural frequency that the joint shows at each moment.

    Parameters
    ----------
    found : from `jaxbacklash.skeleton`
    ax : where to draw

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.skeleton(record, inertia=3.16)
    >>> jb.plot.instantaneous_frequency(found).get_ylabel()
    'frequency [Hz]'
    """
    if not any(method.t.size for method in found.methods):
        return empty(ax, "No oscillation was found.")
    axes = panels(ax, height=SHORT)
    ax = axes[0]
    for method in found.methods:
        if not method.t.size:
            continue
        colour = COLOURS[method.method]
        ax.plot(method.t, method.frequency, color=colour, lw=1.2, label=f"{NAMES[method.method]}: of the motion")
        natural = np.sqrt(np.maximum(method.stiffness, 0.0)) / (2.0 * np.pi)
        ax.plot(
            method.t[method.kept], natural[method.kept], MARKS[method.method], color=colour, ms=2.5, mew=0.7,
            label=f"{NAMES[method.method]}: natural, ω₀/2π",
        )  # fmt: skip
    _shade_masked(ax, surest(found))
    ax.set(xlabel="time [s]", ylabel="frequency [Hz]", xlim=(found.record.t[0], found.record.t[-1]))
    whole = [m.frequency[m.along.whole] for m in found.methods if m.along is not None and m.along.whole.any()]
    highest = [float(np.quantile(frequency, 0.98)) for frequency in whole]
    ax.set_ylim(0.0, 1.25 * max(highest, default=1.0))
    legend_above(axes, *once(axes), columns=4, all_panels=True)
    return axes


@picture
def ridge(found: Skeletons, *, ax: Where = None) -> list[Axes]:
    """The size of the wavelet transform over time and frequency, its ridge, and the cone of influence.

    Parameters
    ----------
    found : from `jaxbacklash.skeleton`
    ax : where to draw

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.skeleton(record, inertia=3.16)
    >>> jb.plot.ridge(found).get_title(loc="left")
    'wavelet transform of x, 50 dB from clear to full'
    """
    along = found.wavelet.along
    if not isinstance(along, WaveletFundamental):
        return empty(ax, "No ridge was followed.")
    shown, kept = along.picture, along.t[along.whole] if np.any(along.whole) else along.t
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    size = np.abs(shown.values)
    level = np.clip(1.0 + np.log10(size / size.max() + 1e-12) / 2.5, 0.0, 1.0)  # 50 dB
    shades = np.column_stack([np.tile(to_rgb(MEASURED), (256, 1)), np.linspace(0.0, 1.0, 256)])
    ax.pcolormesh(
        shown.t, shown.frequencies, level, cmap=ListedColormap(shades), vmin=0.0, vmax=1.0, shading="nearest", rasterized=True
    )
    readable_log(ax, "y", float(shown.frequencies[0]), float(shown.frequencies[-1]))
    ax.plot(shown.t, along.path, color=MODEL, lw=1.2, label="ridge")
    for a, b in ((shown.t[0], float(kept[0])), (float(kept[-1]), shown.t[-1])):
        ax.axvspan(a, b, color=GAP, alpha=0.25, lw=0)
    ax.grid(False)
    ax.set(xlabel="time [s]", ylabel="frequency [Hz]", xlim=(shown.t[0], shown.t[-1]))
    name = found.record.input_name or found.record.observed_name
    ax.set_title(f"wavelet transform of {name}, 50 dB from clear to full", loc="left")
    marks, labels = ax.get_legend_handles_labels()
    marks.append(Patch(color=GAP, alpha=0.3, lw=0))
    ax.legend(marks, [*labels, "atoms reach beyond the record or sweep too fast"], loc="upper left")
    return axes


def _shade_masked(ax: Axes, method: Skeleton) -> None:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], (~method.kept).astype(int), [0]])))
    for begin, end in zip(edges[::2], edges[1::2]):
        ax.axvspan(method.t[begin], method.t[min(end, method.t.size - 1)], color=GAP, alpha=0.18, lw=0, label="masked")
