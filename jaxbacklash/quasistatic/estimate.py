"""`lost_motion`: the play of a slow record, without dynamics. Chooses the way of reading by the channels, and puts it into
words."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..records import Record
from ..value import Value
from .carried import carried
from .clustered import quantile
from .loop import loop
from .pulled import pulled
from .reading import Reading
from .result import LostMotion

SIGNS = 3
"""Values of a force up to which only its sign is taken to be known."""
SLANT = 1e-3
"""Slope of z over the angle from which on it is told."""
WORTH = 3.0
"""Standard errors by which the stiffness has to be clear of nothing before wind-up is taken off the lost motion."""


def lost_motion(
    record: Record, *, gear_ratio: float | None = None, wind_up: float | None = None, translational: bool = False
) -> LostMotion:
    """The play of a slow record, from where z stands on either side, without any dynamics.

    It reads three kinds of record: two positions of a link that friction carries (``x`` with ``z`` or ``y``; the torque ``T``
    beside them tells wind-up from play), a link that is pulled to and fro by a force known by its sign (``F`` of -1, 0 and 1,
    with ``z`` or ``y``), and a loop of torque over angle (``T`` or ``F`` with ``z``). Where the record does not show its play,
    ``failed`` says why and what to do.

    Parameters
    ----------
    record : from `read_record`, positions at the link: ``ratio=`` there divides the motor's
    gear_ratio : turns of the motor for a turn of the link, which names the waves of the motor's turn; nothing is divided by it
        here
    wind_up : elastic wind-up that is part of the lost motion, both ways together, where it is known [rad or m]
    translational : positions in m

    Returns
    -------
    LostMotion
        ``parameters["backlash"]`` is the total play with its 95 % interval.

    Raises
    ------
    BadInput
        The record has no channels that could tell.

    Examples
    --------
    >>> t = np.arange(0.0, 40.0, 0.01)
    >>> x = 0.5 * np.sin(0.8 * t)
    >>> z = np.zeros_like(t)
    >>> for i in range(1, t.size):  # a link that stays where it is until it is carried
    ...     z[i] = np.clip(z[i - 1] - (x[i] - x[i - 1]), -0.01, 0.01)
    >>> z += 1e-4 * np.random.default_rng(0).standard_normal(t.size)
    >>> found = jb.lost_motion(jb.Record(t, {"x": x, "z": z}))
    >>> round(found.parameters["backlash"].value, 4)
    0.02
    """
    unit = "m" if translational else "rad"
    read = _read(record, gear_ratio, not translational)
    failed = read.failed
    parameters: dict[str, Value] = {}
    notes = read.notes
    if failed is not None or read.width is None or read.interval is None:
        why = failed.why if failed is not None else "it cannot be read"
        parameters["backlash"] = parameters["lost_motion"] = Value(None, None, None, unit, why)
        includes = False
    else:
        low, high = float(read.interval[0]), float(read.interval[1])
        whole = Value(float(read.width), float(read.stderr), (low, high), unit)
        parameters = {"backlash": whole, "lost_motion": whole} | _others(read, translational)
        includes = read.way != "loop"
        if "torque" in read.extra:
            parameters, apart = _apart(parameters, read, record.channels["T"], translational)
            includes = not apart
        if wind_up is not None:
            taken = replace(whole, value=whole.value - wind_up, ci95=(low - wind_up, high - wind_up))  # type: ignore[operator]
            parameters["backlash"], includes = taken, False
            parameters["wind_up"] = Value(wind_up, 0.0, (wind_up, wind_up), unit)
    if read.slope is not None and failed is None:
        notes = (*notes, *_ratio_said(read, gear_ratio))
    return LostMotion(
        record, read.way, parameters, read.conditions, read.passes, read.side, read.drift, read.noise, read.over_angle,
        read.errors, read.peak_to_peak, includes, translational, read.turned, notes,
    )  # fmt: skip


def _read(record: Record, gear_ratio: float | None, angular: bool) -> Reading:
    """The reading that the channels allow."""
    channels, t = record.channels, record.t
    x = channels.get("x")
    z = channels["z"] if "z" in channels else channels["y"] - x if "y" in channels and x is not None else channels.get("y")
    force = channels.get("F")
    if z is not None and force is not None and np.unique(force).size <= SIGNS:
        return pulled(t, z, np.sign(force), x=x, ratio=gear_ratio, angular=angular)
    if x is not None and z is not None:
        return carried(t, x, x + z, ratio=gear_ratio, angular=angular, torque=channels.get("T"))
    torque = channels.get("T", force)
    if z is not None and torque is not None:
        return loop(t, torque, z)
    where = record.path or "the record"
    raise BadInput(
        f"{where}: found the channels t, {', '.join(channels)}, wanted x with z or y (two positions), F with z or y (a pull by "
        "its sign), or T with z (a loop of torque over angle)."
    )


def _others(read: Reading, translational: bool) -> dict[str, Value]:
    """Stiffness, friction and lag, as far as they show."""
    stiff, torque = ("N/m", "N") if translational else ("N m/rad", "N m")
    found = {}
    for name, (value, error, freedom) in read.extra.items():
        if name == "torque":
            continue
        reach = quantile(freedom) * error
        found[name] = Value(value, error, (value - reach, value + reach), torque if name == "friction" else stiff)
    fits = read.levels
    if fits is not None and fits.lag is not None and abs(fits.lag) > WORTH * fits.lag_stderr:
        reach = quantile(fits.freedom) * fits.lag_stderr
        found["lag"] = Value(fits.lag, fits.lag_stderr, (fits.lag - reach, fits.lag + reach), "s")
    return found


def _apart(parameters: dict[str, Value], read: Reading, torque: np.ndarray, translational: bool) -> tuple[dict[str, Value], bool]:
    """Play and wind-up apart, where the torque varies enough: the levels that are left at no torque are the play's."""
    soft, error, freedom = read.extra["torque"]
    soft = abs(soft)  # load cells often show the opposite torque
    if soft <= WORTH * error or read.levels is None:
        warnings.warn("the torque varies too little on either side to tell wind-up from play", UserWarning, stacklevel=4)
        return parameters, False
    reach = quantile(freedom) * error
    stiffness = Value(1.0 / soft, error / soft**2, (1.0 / (soft + reach), 1.0 / max(soft - reach, 1e-300)),
                      "N/m" if translational else "N m/rad")  # fmt: skip
    side = read.side
    middle = float(np.mean(torque[side > 0.0]) - np.mean(torque[side < 0.0]))
    play = parameters["backlash"]
    assert play.value is not None
    assert play.stderr is not None
    unit = play.unit
    turns = abs(soft * middle)
    whole = play.value + turns
    far = quantile(freedom) * float(np.hypot(play.stderr, middle * error))
    return parameters | {
        "lost_motion": Value(whole, float(np.hypot(play.stderr, middle * error)), (whole - far, whole + far), unit),
        "wind_up": Value(turns, abs(middle) * error, (turns - abs(middle) * reach, turns + abs(middle) * reach), unit),
        "stiffness": stiffness,
    }, True


def _ratio_said(read: Reading, gear_ratio: float | None) -> tuple[str, ...]:
    """What the record says of a ratio that was stated: a straight line of z over the angle is that, or an encoder off its
    centre."""
    assert read.slope is not None
    slope, error = read.slope
    if abs(slope) < max(quantile(read.freedom) * error, SLANT):
        return ()
    by_record = (
        f"{1.0 + slope:.5g} times as far as x" if gear_ratio is None else f"as with a ratio of {gear_ratio / (1.0 + slope):.5g}"
    )
    return (
        f"the link goes {by_record}, by a ratio that is not exact or an encoder off its centre; the play is not touched by that",
    )
