"""Pictures of slow records: where z stands on either side of the play, and how the play varies over the angle."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..quasistatic import LostMotion
from .drawing import Where, ink, legend_above, panels, picture
from .style import GAP, MEASURED, MEDIUM, MODEL, with_unit
from .thinning import strided

COLOURS = {-1.0: MEASURED, 1.0: MODEL}
NAMES = {-1.0: "at the lower edge", 1.0: "at the upper edge"}
MOST = 6000
"""Points that are drawn."""


@picture
def lost_motion(found: LostMotion, *, ax: Where = None) -> list[Axes]:
    """z over the angle, the time or the torque, with the edge it is at; beside it the play over the angle, where that turns.

    Parameters
    ----------
    found : from `jaxbacklash.lost_motion`
    ax : where to draw; on one axes, z

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> t = np.arange(0.0, 40.0, 0.01)
    >>> pull = np.sign(np.sin(3.0 * t))
    >>> noise = 1e-4 * np.random.default_rng(0).standard_normal(t.size)
    >>> found = jb.lost_motion(jb.Record(t, {"F": pull, "z": 0.01 * pull + noise}))
    >>> jb.plot.lost_motion(found).get_ylabel()
    'z, less drift [rad]'
    """
    around = found.over_angle if found.applies else None
    axes = panels(ax, 1, 2 if around is not None and around.angle.size > 1 else 1, height=MEDIUM)
    _levels(axes[0], found)
    if len(axes) > 1 and around is not None:
        _play(axes[1], found)
    legend_above(axes[:1])
    return axes


def _levels(ax: Axes, found: LostMotion) -> None:
    record = found.record
    channels = record.channels
    x = channels.get("x")
    z = channels["z"] if "z" in channels else channels["y"] - x if x is not None else channels["y"]
    if found.turned:
        z = -z
    if found.drift.size:
        z = z - found.drift
    if found.way == "loop":
        across, label = channels.get("T", channels.get("F")), with_unit("torque", "N" if found.translational else "N m")
    elif found.way == "carried" and x is not None:
        across, label = x, with_unit("x", found.unit)
    else:
        across, label = record.t, with_unit("t", "s")
    assert across is not None
    some = strided(z.size, MOST)
    at = found.side[some] if found.side.size else np.zeros(z[some].size)
    ax.plot(across[some][at == 0.0], z[some][at == 0.0], ".", color=GAP, ms=1.5, alpha=0.5, rasterized=True)
    ax.plot([], [], "o", color=GAP, ms=4.0, label="not counted")
    for side in (-1.0, 1.0):
        here = at == side
        ax.plot(across[some][here], z[some][here], ".", color=COLOURS[side], ms=2.0, rasterized=True)
        ax.plot([], [], "o", color=COLOURS[side], ms=4.0, label=NAMES[side])
    around = found.over_angle
    if found.applies and around is not None and around.angle.size > 1:
        half = 0.5 * (found.parameters["lost_motion"].value or 0.0)
        for side in (-1.0, 1.0):
            ax.plot(around.fine, around.middle + side * half, color=ink(ax), lw=0.9)
    ax.set(xlabel=label, ylabel=with_unit("z, less drift", found.unit))


def _play(ax: Axes, found: LostMotion) -> None:
    around, whole = found.over_angle, found.parameters["lost_motion"]
    assert around is not None
    assert whole.value is not None
    assert whole.ci95 is not None
    ax.errorbar(around.angle, around.width, yerr=2.0 * around.stderr, fmt="o", ms=3.5, lw=1.0, color=MEASURED)
    ax.axhline(whole.value, color=MODEL, lw=1.2)
    ax.axhspan(*whole.ci95, color=MODEL, alpha=0.2, lw=0)
    reach = max(float(np.max(np.abs(around.width - whole.value) + 2.0 * around.stderr)), whole.ci95[1] - whole.value)
    ax.set(xlabel=with_unit("x", found.unit), ylabel=with_unit("lost motion", found.unit),
           ylim=(whole.value - 1.3 * reach, whole.value + 1.3 * reach))  # fmt: skip
    ax.set_title("over the angle; band: 95 % interval", loc="left")


def levels_sentence(found: LostMotion) -> str:
    """What to see in the picture."""
    over = {"loop": "the torque", "pulled": "time", "carried": "the angle"}[found.way]
    if not found.applies:
        return f"z over {over}. No play is read from it, for the reason above."
    if found.way == "loop":
        return "z over the torque. Colour says on which side it is loaded; the play lies between the two, at no torque."
    said = f"z over {over}. Colour says at which edge of the play it is; the distance of the two is the lost motion."
    return said + (" What both have in common over the angle is the gear's error, not play." if found.over_angle else "")
