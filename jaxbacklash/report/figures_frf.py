"""The frequency response of a preloaded joint, as the paper's Figure 11."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ..skeletons import Response
from .drawing import drawn_in_style, new_figure, readable_log
from .style import GAP, HELDOUT, INK, MEASURED, MEDIUM, MODEL, with_unit


@drawn_in_style
def frequency_response(found: Response) -> Figure:
    """Size of the receptance, H1 and H2 and the fitted mode, with stiffness and mass line; below, phase and coherence."""
    values = {name: value.value or 0.0 for name, value in found.values.items()}
    line, used = found.frequency, found.used
    shown = (line >= 0.6 * line[used][0]) & (line <= 1.5 * line[used][-1])
    low, high = float(line[shown][0]), float(line[shown][-1])
    grid = np.geomspace(low, high, 500)
    omega = 2.0 * np.pi * grid
    k, c, j = (values[name] for name in ("stiffness", "damping", "inertia"))
    mode = 1.0 / (k - j * omega**2 + 1j * c * omega)
    figure = new_figure(1.25 * MEDIUM)
    size, phase, share = figure.subplots(3, 1, sharex=True, gridspec_kw={"height_ratios": [3.0, 1.4, 1.0]})
    size.plot(line[shown], np.abs(found.h2[shown]), color=HELDOUT, lw=0.9, label="H2")
    size.plot(line[shown], np.abs(found.h1[shown]), color=MEASURED, lw=1.2, label="H1")
    size.plot(grid, np.abs(mode), color=MODEL, lw=1.2, ls=(0, (5, 2)), label="fitted mode")
    size.plot(grid, 1.0 / (j * omega**2), color=INK, lw=0.8, ls=":", label="mass line, 1/(Jω²)")
    size.axhline(1.0 / k, color=INK, lw=0.8, ls=(0, (1, 1)), label="stiffness line, 1/k")
    readable_log(size, "y", 0.3 * float(np.min(np.abs(mode))), 3.0 * float(np.max(np.abs(mode))))
    unit = found.values["stiffness"].unit
    size.set_ylabel(with_unit("|Y/F|", "m/N" if unit == "N/m" else "rad/(N m)"))
    phase.plot(line[shown], _lag(found.h1[shown]), color=MEASURED, lw=1.2)
    phase.plot(grid, _lag(mode), color=MODEL, lw=1.2, ls=(0, (5, 2)))
    phase.set(ylabel="phase [deg]", ylim=(-200.0, 30.0), yticks=[-180, -90, 0])
    share.plot(line[shown], found.coherence[shown], color=MEASURED, lw=1.2)
    share.set(ylabel="coherence", ylim=(0.0, 1.05), xlabel="frequency [Hz]")
    for ax in (size, phase, share):
        readable_log(ax, "x", low, high)
        whole = ax.get_xaxis_transform()
        ax.fill_between(line[shown], 0.0, 1.0, where=~used[shown], transform=whole, color=GAP, alpha=0.18, lw=0)
    figure.legend(*size.get_legend_handles_labels(), loc="outside upper right", ncols=5)
    return figure


def _lag(response: np.ndarray) -> np.ndarray:
    """Phase [deg] from -270 to 90, so that one near -180 does not jump."""
    return (np.degrees(np.angle(response)) + 270.0) % 360.0 - 270.0
