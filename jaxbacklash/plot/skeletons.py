"""Figures of the skeletons, as the paper's 8 to 14: envelopes, instantaneous frequency, ridge, and the curves over amplitude."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.patches import Patch

from ..skeletons import Skeleton, Skeletons
from ..skeletons.describing_function import axis_crossing, describing_function
from ..skeletons.fundamental import WaveletFundamental
from ..skeletons.modal import modal
from .drawing import Where, empty, in_degrees, ink, legend_above, panels, picture, readable_log
from .style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL, SHORT, TALL, with_unit
from .thinning import envelope

COLOURS = {"hilbert": MODEL, "wavelet": HELDOUT}
NAMES = {"hilbert": "Hilbert", "wavelet": "wavelet"}
MARKS = {"hilbert": "o", "wavelet": "x"}


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
    half = _half_play(found)
    if half is not None:
        centre = _best(found).centre
        for edge in (centre - half, centre + half):
            last.axhline(edge, color=ink(last), lw=0.8, ls=(0, (4, 2)))
        last.plot([], [], color=ink(last), lw=0.8, ls=(0, (4, 2)), label="edges of the play")
    _shade_masked(last, _best(found))
    last.set_xlabel("time [s]")
    last.set_xlim(record.t[0], record.t[-1])
    legend_above(axes, *_once(axes), columns=4, all_panels=True)
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
    _shade_masked(ax, _best(found))
    ax.set(xlabel="time [s]", ylabel="frequency [Hz]", xlim=(found.record.t[0], found.record.t[-1]))
    whole = [m.frequency[m.along.whole] for m in found.methods if m.along is not None and m.along.whole.any()]
    highest = [float(np.quantile(frequency, 0.98)) for frequency in whole]
    ax.set_ylim(0.0, 1.25 * max(highest, default=1.0))
    legend_above(axes, *_once(axes), columns=4, all_panels=True)
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


@picture
def backbone(found: Skeletons, *, ax: Where = None) -> list[Axes]:
    """Undamped natural frequency and modal damping over amplitude; bars are two standard errors of a bin's mean.

    Parameters
    ----------
    found : from `jaxbacklash.skeleton`
    ax : where to draw; on one axes, the natural frequency

    Returns
    -------
    the axes, or an array of them
    """
    if not any(np.any(method.kept) for method in found.methods):
        return empty(ax, "No part of the record counts.")
    unit = "m" if found.translational else "rad"
    axes = panels(ax, 1, 2, height=MEDIUM)
    left = axes[0]
    for method in found.methods:
        _over_amplitude(left, method, np.sqrt(np.maximum(method.stiffness, 0.0)) / (2.0 * np.pi), "stiffness", _natural)
    best, half = _best(found), _half_play(found)
    if half is not None:
        k = best.parameters["stiffness"].value
        grid = np.linspace(half, float(np.max(best.amplitude[best.kept])), 400)
        if k is not None:
            mass = found.inertia or _value(best, "inertia") or 1.0
            left.plot(grid, np.sqrt(k / mass * describing_function(grid, half)) / (2.0 * np.pi), color=ink(left), lw=0.9,
                      ls=(0, (5, 2)), label="fitted joint under a pure sine")  # fmt: skip
        left.axvline(half, color=GAP, lw=1.0, label="half play")
    left.set(xlabel=with_unit("amplitude of z", unit), ylabel="ω₀/2π [Hz]", xlim=(0.0, None), ylim=(0.0, None))
    if len(axes) > 1:
        left.set_title("backbone", loc="left")
        _damping(axes[1], found, unit)
    legend_above(axes[-1:], *_once(axes), columns=4, all_panels=True)
    return axes


def _damping(ax: Axes, found: Skeletons, unit: str) -> None:
    """The damping curve beside the fitted joint's."""
    for method in found.methods:
        _over_amplitude(ax, method, method.damping, "damping", lambda v: v)
    best = _best(found)
    c = best.parameters["damping"].value
    if c is not None:
        mass = found.inertia or _value(best, "inertia") or 1.0
        ax.axhline(c / (2.0 * mass), color=ink(ax), lw=0.9, ls=(0, (5, 2)), label="fitted joint")
        ax.set_ylim(0.0, max(2.5 * c / (2.0 * mass), 1.2 * float(np.max(best.curve("damping").mean, initial=0.0))))
    ax.set(xlabel=with_unit("amplitude of z", unit), ylabel="h₀ [1/s]", xlim=(0.0, None))
    ax.set_title("damping curve", loc="left")


@picture
def skeleton(found: Skeletons, *, ax: Where = None) -> list[Axes]:
    """Restoring force (3.7) over amplitude, what the inverted describing function makes of it, and the straight line's trap.

    Parameters
    ----------
    found : from `jaxbacklash.skeleton`
    ax : where to draw

    Returns
    -------
    the axes, or an array of them
    """
    best = _best(found)
    if not np.any(best.kept):
        return empty(ax, "No part of the record counts.")
    unit = "m" if found.translational else "rad"
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    for method in found.methods:
        _over_amplitude(ax, method, method.restoring_force, "restoring_force", lambda v: v)
    half = _half_play(found)
    if half is not None and best.terms is not None:
        order = np.argsort(best.amplitude[best.kept])
        ax.plot(best.amplitude[best.kept][order], _modelled_force(found, best, half)[best.kept][order], color=MEASURED, lw=1.3,
                label="describing function of the measured motion, at the play found", zorder=1)  # fmt: skip
        mass, k = found.inertia or _value(best, "inertia") or 1.0, best.parameters["stiffness"].value
        grid = np.linspace(0.0, 1.04 * float(np.max(best.amplitude[best.kept])), 400)
        if k is not None:
            sine = k / mass * grid * describing_function(grid, half)
            ax.plot(grid, sine, color=ink(ax), lw=0.9, ls=(0, (5, 2)), label="of a pure sine")
        upper = best.kept & (best.amplitude > np.median(best.amplitude[best.kept]))  # where the curve looks straight
        slope, crossing = axis_crossing(best.amplitude[upper], best.restoring_force[upper])
        ax.plot(grid, np.maximum(slope * (grid - crossing), 0.0), color=GAP, lw=1.0, ls=":",
                label=f"straight line: cuts at {crossing / half:.2f} half plays")  # fmt: skip
        ax.axvline(half, color=GAP, lw=1.0)
        ax.axvspan(0.0, half, color=GAP, alpha=0.16, lw=0, label="inside the play")
    ax.axhline(0.0, color=ink(ax), lw=0.5)
    ax.set(xlabel=with_unit("amplitude of z", unit), ylabel=with_unit("f_s = A ω₀²", f"{unit}/s^2"), xlim=(0.0, None))
    in_degrees(ax, "top", unit)
    ax.legend(loc="upper left")
    return axes


def _modelled_force(found: Skeletons, method: Skeleton, half: float) -> np.ndarray:
    """The modal restoring force of the fitted joint on the measured waveform, (M,)."""
    assert method.terms is not None
    terms, mass = method.terms, found.inertia or _value(method, "inertia") or 1.0
    k, c = (_value(method, name) or 0.0 for name in ("stiffness", "damping"))
    right = (k * terms.deflection(half, method.centre) + c * terms.velocity) / mass
    return method.amplitude * modal(terms.position, terms.velocity, right)[0]


def _over_amplitude(ax: Axes, method: Skeleton, values: np.ndarray, name: str, shown: Any) -> None:
    if not np.any(method.kept):
        return
    colour = COLOURS[method.method]
    ax.plot(method.amplitude[method.kept], values[method.kept], MARKS[method.method], color=colour, ms=2.2, mew=0.6, alpha=0.35)
    curve = method.curve(name)
    low, middle, high = (shown(curve.mean + step * curve.stderr) for step in (-2.0, 0.0, 2.0))
    bars = np.maximum([middle - low, high - middle], 0.0)
    mark = MARKS[method.method]
    ax.errorbar(curve.amplitude, middle, yerr=bars, fmt=mark, color=colour, ms=4.5, lw=1.0, label=NAMES[method.method])


def _natural(stiffness: np.ndarray) -> np.ndarray:
    return np.sqrt(np.maximum(stiffness, 0.0)) / (2.0 * np.pi)


def _best(found: Skeletons) -> Skeleton:
    """The method with the smaller error of the play; the wavelet where neither tells one."""
    told = [m for m in found.methods if m.parameters["backlash"].stderr is not None]
    return min(told, key=lambda m: m.parameters["backlash"].stderr or np.inf) if told else found.wavelet


def _half_play(found: Skeletons) -> float | None:
    value = _best(found).parameters["backlash"].value
    return None if value is None else 0.5 * value


def _value(method: Skeleton, name: str) -> float | None:
    return method.parameters[name].value if name in method.parameters else None


def _shade_masked(ax: Axes, method: Skeleton) -> None:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], (~method.kept).astype(int), [0]])))
    for begin, end in zip(edges[::2], edges[1::2]):
        ax.axvspan(method.t[begin], method.t[min(end, method.t.size - 1)], color=GAP, alpha=0.18, lw=0, label="masked")


def _once(axes: Any) -> tuple[list[Any], list[str]]:
    """Marks and names of the legend, each name once."""
    named: dict[str, Any] = {}
    for ax in axes:
        for mark, label in zip(*ax.get_legend_handles_labels()):
            named.setdefault(label, mark)
    return list(named.values()), list(named)
