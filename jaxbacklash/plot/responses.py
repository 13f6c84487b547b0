"""The frequency response of a preloaded joint, as the paper's Figure 11."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..skeletons import Response
from .drawing import Where, ink, legend_above, panels, picture, readable_log
from .style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL, with_unit


@picture
def frequency_response(found: Response, *, ax: Where = None) -> list[Axes]:
    """Size of the receptance, H1 and H2 and the fitted mode, with stiffness and mass line; below, phase and coherence.

    Parameters
    ----------
    found : from `jaxbacklash.frequency_response`
    ax : where to draw; on one axes, the size

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> held = jb.base_motion_joint(3.16, 0.026, 15000.0, 22.0).with_effects(jb.Preload(120.0))
    >>> lines = np.arange(2.0, 60.0, 0.11)
    >>> push = jb.Multisine(np.ones(lines.size), 2.0 * np.pi * lines, lines**2, as_force=True)
    >>> shaken = jb.simulate(held, push, duration=30.0, rate=500.0, y0=0.021)
    >>> channels = {"F": np.asarray(shaken.drive.force), "y": np.asarray(shaken.y)}
    >>> found = jb.frequency_response(jb.Record(np.asarray(shaken.t), channels), segment=4.0, band=(4.0, 40.0))
    >>> size, phase, coherence = jb.plot.frequency_response(found)
    >>> size.get_ylabel()
    '|Y/F| [rad/(N m)]'
    """
    values = {name: value.value or 0.0 for name, value in found.values.items()}
    line, used = found.frequency, found.used
    shown = (line >= 0.6 * line[used][0]) & (line <= 1.5 * line[used][-1])
    low, high = float(line[shown][0]), float(line[shown][-1])
    grid = np.geomspace(low, high, 500)
    omega = 2.0 * np.pi * grid
    k, c, j = (values[name] for name in ("stiffness", "damping", "inertia"))
    mode = 1.0 / (k - j * omega**2 + 1j * c * omega)
    axes = panels(ax, 3, height=1.25 * MEDIUM, sharex=True, height_ratios=(3.0, 1.4, 1.0))
    size = axes[0]
    size.plot(line[shown], np.abs(found.h2[shown]), color=HELDOUT, lw=0.9, label="H2")
    size.plot(line[shown], np.abs(found.h1[shown]), color=MEASURED, lw=1.2, label="H1")
    size.plot(grid, np.abs(mode), color=MODEL, lw=1.2, ls=(0, (5, 2)), label="fitted mode")
    size.plot(grid, 1.0 / (j * omega**2), color=ink(size), lw=0.8, ls=":", label="mass line, 1/(Jω²)")
    size.axhline(1.0 / k, color=ink(size), lw=0.8, ls=(0, (1, 1)), label="stiffness line, 1/k")
    readable_log(size, "y", 0.3 * float(np.min(np.abs(mode))), 3.0 * float(np.max(np.abs(mode))))
    unit = found.values["stiffness"].unit
    size.set_ylabel(with_unit("|Y/F|", "m/N" if unit == "N/m" else "rad/(N m)"))
    if len(axes) > 1:
        _phase_and_coherence(axes[1], axes[2], found, shown, grid, mode)
    axes[-1].set_xlabel("frequency [Hz]")
    for one in axes:
        readable_log(one, "x", low, high)
        whole = one.get_xaxis_transform()
        one.fill_between(line[shown], 0.0, 1.0, where=~used[shown], transform=whole, color=GAP, alpha=0.18, lw=0)
    legend_above(axes, columns=5, all_panels=True)
    return axes


def _phase_and_coherence(
    phase: Axes, share: Axes, found: Response, shown: np.ndarray, grid: np.ndarray, mode: np.ndarray
) -> None:
    line = found.frequency
    phase.plot(line[shown], _lag(found.h1[shown]), color=MEASURED, lw=1.2)
    phase.plot(grid, _lag(mode), color=MODEL, lw=1.2, ls=(0, (5, 2)))
    phase.set(ylabel="phase [deg]", ylim=(-200.0, 30.0), yticks=[-180, -90, 0])
    share.plot(line[shown], found.coherence[shown], color=MEASURED, lw=1.2)
    share.set(ylabel="coherence", ylim=(0.0, 1.05))


def _lag(response: np.ndarray) -> np.ndarray:
    """Phase [deg] from -270 to 90, so that one near -180 does not jump."""
    return (np.degrees(np.angle(response)) + 270.0) % 360.0 - 270.0
