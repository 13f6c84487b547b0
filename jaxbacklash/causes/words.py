"""What a cause is called, in one sentence, and what to type to undo it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePath
from shlex import quote

import numpy as np

from ..fitting.estimates import Estimate, number
from ..fitting.result import Fit
from ..parameters import channel_unit
from ..records import Record
from .bench import Point
from .cause import Cause
from .kinds import Kind
from .shown import StepChange, first_fresh


def told(
    kind: Kind, point: Point, stderr: float, before: float, left: float, gain: float, certain: bool,
    estimates: Mapping[str, Estimate], record: Record, fit: Fit,
) -> Cause:  # fmt: skip
    """A cause with its sentence and remedy."""
    words, remedy, law = _SAID[kind.name](kind, point.size, stderr if np.isfinite(stderr) else None, fit)
    rest = "" if certain else "; something else is missing beside it"
    sentence = f"{words}: with that the model misses {left:.3g} times the noise instead of {before:.3g}{rest}"
    found = {name: estimate.value for name, estimate in estimates.items()}
    if kind.name == "inertia":  # all torques were divided by it
        found = {name: v if v is None or name == "backlash" else v * point.size for name, v in found.items()}
    size = None if kind.name == "sign" else point.size
    return Cause(
        kind.name, kind.channel, size, stderr if np.isfinite(stderr) else None, kind.unit, before, left, gain, sentence, remedy,
        law, certain, found, record,
    )  # fmt: skip


def _delay(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    late, ms = ("late" if size > 0 else "early"), 1e3
    other = fit.records[0].input_name
    spread = f" +- {ms * error:.2g}" if error else ""
    alone = " alone, though z = y - x was formed of both," if kind.mixed else ""
    by = number(ms * abs(size), ms * error if error else None)
    words = f"{kind.channel}{alone} is {late} by {by}{spread} ms against {other}"
    return words, ("" if kind.mixed else "--effects sensor_delay"), ("" if kind.mixed else "sensor_delay")


def _clock(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    other = fit.records[0].input_name
    spread = f" +- {1e6 * error:.2g}" if error else ""
    way = "fast" if size > 0 else "slow"
    parts = number(1e6 * abs(size), 1e6 * error if error else None)
    end = size * (fit.records[0].t[-1] - fit.records[0].t[0])
    words = (
        f"the clock of {kind.channel} runs {way} by {parts}{spread} ppm against that of {other} "
        f"({1e3 * abs(end):.2g} ms at the end)"
    )
    return words, ("" if kind.mixed else "--effects clock_drift"), ("" if kind.mixed else "clock_drift")


def _scale(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    spread = f" +- {error:.2g}" if error else ""
    words = (
        f"x reads {number(size, error)}{spread} times what {fit.records[0].observed_name} makes of it: "
        "it is in another unit, or behind another gear"
    )
    return words, f"--scale x={1.0 / size:.6g}", ""


def _sign(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    other = fit.records[0].input_name
    return (
        f"{kind.channel} has the other sign than {other}: one of the two was measured the other way round",
        (f"--scale {kind.channel}=-1"),
        "",
    )


def _inertia(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    given = float(fit.system.inertia)
    spread = f" +- {error * given:.2g}" if error else ""
    unit = "kg" if fit.translational else "kg m^2"
    found = number(given * size, error * given if error else None)
    words = (
        f"the measured force tells an inertia of {found}{spread} {unit}, {size:.3g} times the {given:.6g} that was given "
        f"(or F reads {size:.3g} times too large)"
    )
    return words, f"--inertia {given * size:.4g}, or leave --inertia out", ""


def _held_samples(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    record, every = fit.records[0], int(size)
    rate = record.rate_hz / every
    words = f"{kind.channel} is refreshed every {every} samples only ({rate:.4g} Hz) and repeats its last value between"
    # Resampling would smooth the stairs, and keep their lag: only the fresh rows themselves are right.
    path = PurePath(record.path)
    if path.suffix not in (".csv", ".txt", ".tsv", ".dat"):
        return words, "", ""
    name = f"{path.stem}-fresh{path.suffix}"
    keep = f"awk 'NR == 1 || (NR - 2) % {every} == {first_fresh(record) % every}' {quote(record.path)} > {quote(name)}"
    return words, f"`{keep}` keeps the fresh rows below one line of names: use {quote(name)} then", ""


def _held_start(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    return f"the link is held until {size:.4g} s and moves freely only then", f"--from {size:.4g}", ""


def _step(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    unit = channel_unit(kind.channel, translational=fit.translational)
    assert isinstance(kind, StepChange)
    at = kind.at
    when = float(fit.records[0].t[at])
    words = f"{kind.channel} jumps by {size:.4g} {unit} at {when:.6g} s (row {at + 1}) and stays there: counts were lost"
    return words, f"--from {when:.6g}", ""


def _limit(kind: Kind, size: float, error: float | None, fit: Fit) -> tuple[str, str, str]:
    unit = channel_unit("F", translational=fit.translational)
    words = f"the force that acted is limited to about {size:.3g} {unit}, while F shows what was asked for"
    return words, "", ""


_SAID = {
    "delay": _delay, "clock": _clock, "scale": _scale, "sign": _sign, "inertia": _inertia, "held_samples": _held_samples,
    "held_start": _held_start, "step": _step, "force_limit": _limit,
}  # fmt: skip
