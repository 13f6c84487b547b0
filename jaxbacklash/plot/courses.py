"""Pictures of many records: how a parameter goes from record to record."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ..errors import BadInput
from ..many import Each
from ..many.courses import Course
from .drawing import Where, empty, in_degrees, ink, legend_above, panels, picture
from .style import GAP, HELDOUT, MEASURED, MEDIUM, MODEL, with_unit
from .thinning import strided

MOST = 1500
"""Records that are drawn with their error bars; of more every so-many-th, and those that stand out."""


@picture
def course(each: Each, name: str = "backlash", *, ax: Where = None) -> list[Axes]:
    """A parameter over the records' numbers, with 95 % intervals; its change where one is claimed, else its trend.

    Parameters
    ----------
    each : from `jaxbacklash.fit_each` or `jaxbacklash.refine_each`
    name : of the parameter
    ax : where to draw

    Returns
    -------
    the axes

    Raises
    ------
    BadInput
        No record has such a parameter.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> each = jb.fit_each([record.between(0.0, 2.0), heldout.between(0.0, 2.0)], inertia=3.16, workers=0, starts=1)
    >>> jb.plot.course(each).get_ylabel()
    'play [rad]'
    """
    if name not in each.courses:
        raise BadInput(f"{name}: no record has this parameter, wanted one of {', '.join(each.courses) or 'none'}")
    found = each.courses[name]
    if not found.values.size:
        return empty(ax, f"{found.word}: found in no record")
    axes = panels(ax, height=MEDIUM)
    _values(axes[0], found)
    if found.changed:
        _change(axes[0], found)
    elif found.trend is not None and not found.joints:
        _trend(axes[0], found)
    axes[0].set(xlabel="record", ylabel=with_unit(found.word, found.unit))
    in_degrees(axes[0], "right", found.unit)
    legend_above(axes)
    return axes


def _values(ax: Axes, found: Course) -> None:
    out = {one.index for one in (() if found.joints else found.outliers)}
    some = strided(found.values.size, MOST)
    plain = np.array([k for k in np.arange(found.values.size)[some] if k not in out], dtype=int)
    apart = np.array(sorted(out), dtype=int)
    for at, colour, label in ((plain, MEASURED, "record with 95 % interval"), (apart, HELDOUT, "stands out")):
        if at.size:
            ax.errorbar(
                found.numbers[at], found.values[at], yerr=1.96 * found.stderr[at], fmt="o" if label[0] == "r" else "D", ms=3.5,
                lw=0.9, color=colour, label=label,
            )  # fmt: skip


def _change(ax: Axes, found: Course) -> None:
    change = found.change
    assert change is not None
    first, last, at = found.numbers[0], found.numbers[-1], found.numbers[change.at] - 0.5
    sides = ((first, at, change.before, change.before_stderr), (at, last, change.after, change.after_stderr))
    for begin, end, level, error in sides:
        label = "mean before and after" if begin == first else None
        ax.plot([begin, end], [level, level], color=MODEL, lw=1.4, label=label)
        ax.fill_between([begin, end], level - 1.96 * error, level + 1.96 * error, color=MODEL, alpha=0.25, lw=0)
    low, high = (float(found.numbers[k]) for k in change.between)
    ax.axvspan(low - 0.5, high - 0.5 + (0.0 if high > low else 1e-9), color=GAP, alpha=0.25, lw=0)
    ax.axvline(at, color=ink(ax), lw=0.8, ls="--")


def _trend(ax: Axes, found: Course) -> None:
    trend = found.trend
    assert trend is not None
    along = np.linspace(found.numbers[0], found.numbers[-1], 50)
    line, error = trend.band(along)
    ax.plot(along, line, color=MODEL, lw=1.2, label="trend" if trend.claimed else "trend, not told from none")
    ax.fill_between(along, line - 1.96 * error, line + 1.96 * error, color=MODEL, alpha=0.2, lw=0)
