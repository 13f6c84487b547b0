"""``jaxbacklash simulate``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from ..effects import Servo
from ..errors import BadInput, NoAnswer
from ..excitation import (
    AbstractExcitation,
    AbstractSignal,
    Chirp,
    Harmonic,
    HeldTorque,
    MotorTorque,
    Multisine,
    Rest,
    Sampled,
    SteppedSine,
)
from ..model_file import input_between, load_model
from ..records import Record, read_record, write_record
from ..records.checks import MIN_SAMPLES, MIN_SECONDS
from ..records.force import SAID, way
from ..records.writer import WRITERS
from ..simulation import as_record, default_panels, measured_base
from ..simulation import simulate as run_system
from ..system import System
from .common import json_text
from .ranges import bounded

WANTED = {
    "harmonic": ("amplitude", "frequency"),
    "chirp": ("amplitude", "f0", "f1"),
    "multisine": ("amplitude", "low", "high", "lines"),
    "stepped": ("amplitude", "low", "high", "steps"),
    "rest": (),
}
ENTRIES = {
    "amplitude": (-1e9, 1e9), "frequency": (0.0, 1e6), "f0": (0.0, 1e6), "f1": (0.0, 1e6), "phase": (-1e6, 1e6),
    "corner": (1e-6, 1e12), "low": (0.0, 1e6), "high": (0.0, 1e6), "lines": (1, 10_000), "steps": (2, 1000),
}  # fmt: skip
"""The range of each entry: rad or N m, Hz, rad, and numbers of lines and steps."""
MOST_SAMPLES = 2_000_000
MOST_STEPS = 2_000_000
"""Steps of a simulation at most: about a minute."""
MOST_SINES = 2e9
"""Values of single sines that a multisine or stepped sine may ask for at most, likewise."""
LARGEST = 1e12
"""A motion beyond this [rad] has grown without bound."""
OPTIONAL = {"chirp": {"corner": 1e9}, "harmonic": {"phase": 0.0}}


def run(
    model: Path,
    *,
    out: Path,
    excitation: str,
    as_force: bool,
    duration: float,
    rate: float,
    noise: float,
    y0: float | None,
    dy0: float | None,
    as_json: bool,
    seed: int,
) -> None:
    """Simulate, add noise, write the record."""
    if out.suffix.lower() not in WRITERS:
        raise BadInput(f"--out {out}: found the suffix {out.suffix!r}, wanted one of {', '.join(WRITERS)}")
    system = load_model(model)
    rng = np.random.default_rng(seed)
    measured = _measured(excitation, system)
    drive: AbstractExcitation
    if measured is None:
        drive, t0 = parse_excitation(excitation, as_force, duration, rng), 0.0
        if system.motor is not None and isinstance(drive, AbstractSignal) and not as_force:
            drive = MotorTorque(drive)
    elif measured.kind == "drive":
        t0, duration = float(measured.t[0]), float(measured.t[-1] - measured.t[0])
        drive = HeldTorque(_f(t0), _f(measured.dt), measured.channels[measured.input_name or "torque"])
    else:
        between = input_between(model)
        drive = measured_base(measured, between=between, panels=default_panels(system, measured.rate_hz))
        t0, duration = float(measured.t[0]), float(measured.t[-1] - measured.t[0])
    check_size(system, drive, duration, rate)
    path = run_system(system, drive, duration=duration, rate=rate, y0=y0, dy0=dy0, t0=t0)
    largest = float(np.max(np.abs(np.asarray(path.observed))))
    if not largest <= LARGEST:
        raise NoAnswer(
            f"{model}: the simulated motion grows without bound; are the signs of its effects right, and is its damping "
            f"one that steps of {1000.0 / rate:.3g} ms can follow (--rate)?"
        )
    record = as_record(path, system, path=str(out))
    if measured is not None and measured.kind != "drive" and (how := way(measured, between)) in SAID:
        # Lines stood for the force between its samples; what a logger shows are the samples.
        at = (record.t - t0) / measured.dt
        at = np.floor(at + 1e-6) if how == "held" else at
        record = record.replace(F=np.interp(at, np.arange(measured.samples), measured.channels["F"]))
    if noise:
        moved = {
            name: values + noise * rng.standard_normal(values.size)
            for name, values in record.channels.items()
            if name in ("x", "y", "z", "motor", "link")
        }
        record = record.replace(**moved)
    write_record(record, out)
    if as_json:
        answer = {"schema": 1, "command": "simulate", "out": str(out), "samples": record.samples, "rate_hz": record.rate_hz}
        sys.stdout.write(json_text(answer | {"channels": ["t", *record.channels]}))
    else:
        print(record.summary())


def check_size(system: System, drive: AbstractExcitation, duration: float, rate: float) -> None:
    """Refuse what takes too long, or gives too little to be a record.

    Raises
    ------
    BadInput
        With the number and the bound.
    """
    where = f"simulate {duration:g} s at {rate:g} Hz"
    samples = duration * rate + 1
    if duration < MIN_SECONDS or samples < MIN_SAMPLES:
        raise BadInput(f"{where}: gives {samples:.6g} samples, wanted {MIN_SECONDS} s and {MIN_SAMPLES} samples at least; "
                       "raise --duration or --rate")  # fmt: skip
    bounded(where, samples, MOST_SAMPLES, "samples", "shorten --duration or lower --rate")
    panels = samples * default_panels(system, rate)
    bounded(where, panels, MOST_STEPS, "steps (of 1 ms or less, 20 a period of the contact)", "shorten --duration")
    signal = drive.signal if isinstance(drive, MotorTorque) else drive
    lines = max((np.size(getattr(signal, name)) for name in signal.series if getattr(signal, name) is not None), default=1)
    if not isinstance(drive, Sampled | HeldTorque):
        bounded(where, panels * lines, MOST_SINES, "values of sines", "shorten --duration or take fewer lines")


def _measured(text: str, system: System) -> Record | None:
    """The record that ``--excitation`` names, of a drive for a model of one; None where it names none.

    Raises
    ------
    BadInput
        The record has nothing to drive with, or cannot be read.
    """
    if text.partition(":")[0] in WANTED or not Path(text).suffix:
        return None
    record = read_record(text, ratio=None if system.motor is None else float(system.motor.ratio))
    if record.input_name is None:
        raise BadInput(f"--excitation {text}: the record has neither x nor F to drive with")
    told = "command" if isinstance(system.motor, Servo) else "torque"
    drives = record.kind != "drive" if system.motor is None else record.input_name == told
    if not drives:
        wanted = {"command": "the command of its servo", "torque": "the torque at the motor"}[told]
        raise BadInput(
            f"--excitation {text}: is a record of kind {record.kind} with {record.input_name}, which does not drive this model; "
            f"wanted {'x or F' if system.motor is None else wanted}"
        )
    return record


def parse_excitation(text: str, as_force: bool, duration: float, rng: np.random.Generator) -> AbstractExcitation:
    """The excitation that ``--excitation`` spells out, over a ``duration`` [s].

    Raises
    ------
    BadInput
        An unknown kind, a missing or unknown entry, or a value that is no number.
    """
    kind, _, rest = text.partition(":")
    if kind not in WANTED:
        raise BadInput(f"--excitation {text}: wanted {', '.join(WANTED)} or the file of a record")
    given: dict[str, float] = dict(OPTIONAL.get(kind, {}))
    for part in filter(None, rest.split(",")):
        name, _, value = part.partition("=")
        if name not in WANTED[kind] and name not in OPTIONAL.get(kind, {}):
            raise BadInput(f"--excitation {kind}: unknown entry {name!r}, wanted {', '.join(WANTED[kind])}")
        try:
            given[name] = float(value)
        except ValueError:
            raise BadInput(f"--excitation {kind}: {name} is {value!r}, wanted a number") from None
        low, high = ENTRIES[name]
        if not low <= given[name] <= high:
            raise BadInput(f"--excitation {kind}: {name} is {value[:40]}, wanted a number from {low:g} to {high:g}")
    missing = [name for name in WANTED[kind] if name not in given]
    if missing:
        raise BadInput(f"--excitation {kind}: {missing[0]} is missing, wanted {kind}:" + ",".join(f"{n}=" for n in WANTED[kind]))
    return _build(kind, given, as_force, duration, rng)


def _build(kind: str, p: dict[str, float], as_force: bool, duration: float, rng: np.random.Generator) -> AbstractExcitation:
    if kind == "rest":
        return Rest()
    level = p["amplitude"]
    if kind == "harmonic":
        return Harmonic(_f(level), _f(2 * np.pi * p["frequency"]), _f(p["phase"]), as_force=as_force)
    if kind == "chirp":
        return Chirp(_f(level), _f(p["f0"]), _f(p["f1"]), _f(duration), _f(p["corner"]), as_force=as_force)
    if not 0.0 < p["low"] < p["high"]:
        raise BadInput(f"--excitation {kind}: low is {p['low']:g} and high {p['high']:g}, wanted 0 < low < high [Hz]")
    if kind == "multisine":
        count = max(1, round(p["lines"]))
        omegas = 2 * np.pi * np.linspace(p["low"], p["high"], count)
        amplitudes = np.full(count, level * np.sqrt(2.0 / count))
        return Multisine(amplitudes, omegas, rng.uniform(0, 2 * np.pi, count), as_force=as_force)
    count = max(2, round(p["steps"]))
    return SteppedSine(np.full(count, level), np.linspace(p["low"], p["high"], count), _f(duration / count), as_force=as_force)


def _f(value: float) -> Any:
    return np.asarray(float(value))
