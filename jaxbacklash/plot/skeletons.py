"""Figures of the skeletons, as the paper's 12 to 14: stiffness, damping and restoring force over amplitude."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ..skeletons import Skeleton, Skeletons
from ..skeletons.describing_function import axis_crossing, describing_function
from ..skeletons.modal import modal
from .drawing import Where, empty, in_degrees, ink, legend_above, panels, picture
from .methods import COLOURS, MARKS, NAMES, half_play, once, surest
from .style import GAP, MEASURED, MEDIUM, with_unit


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

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.skeleton(record, inertia=3.16)
    >>> backbone, damping = jb.plot.backbone(found)
    >>> damping.get_ylabel()
    'h₀ [1/s]'
    """
    if not any(np.any(method.kept) for method in found.methods):
        return empty(ax, "No part of the record counts.")
    unit = "m" if found.translational else "rad"
    axes = panels(ax, 1, 2, height=MEDIUM)
    left = axes[0]
    for method in found.methods:
        _over_amplitude(left, method, np.sqrt(np.maximum(method.stiffness, 0.0)) / (2.0 * np.pi), "stiffness", _natural)
    best, half = surest(found), half_play(found)
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
    legend_above(axes[-1:], *once(axes), columns=4, all_panels=True)
    return axes


def _damping(ax: Axes, found: Skeletons, unit: str) -> None:
    """The damping curve beside the fitted joint's."""
    for method in found.methods:
        _over_amplitude(ax, method, method.damping, "damping", lambda v: v)
    best = surest(found)
    c = best.parameters["damping"].value
    if c is not None:
        mass = found.inertia or _value(best, "inertia") or 1.0
        ax.axhline(c / (2.0 * mass), color=ink(ax), lw=1.1, ls=(0, (1, 1.5)), label="fitted damping")
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

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.skeleton(record, inertia=3.16)
    >>> jb.plot.skeleton(found).get_xlabel()
    'amplitude of z [rad]'
    """
    best = surest(found)
    if not np.any(best.kept):
        return empty(ax, "No part of the record counts.")
    unit = "m" if found.translational else "rad"
    axes = panels(ax, height=MEDIUM)
    ax = axes[0]
    for method in found.methods:
        _over_amplitude(ax, method, method.restoring_force, "restoring_force", lambda v: v)
    half = half_play(found)
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
    legend_above(axes, all_panels=True)  # the curve may go through every corner but one, and that is the play's
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


def _value(method: Skeleton, name: str) -> float | None:
    return method.parameters[name].value if name in method.parameters else None
