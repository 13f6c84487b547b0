"""A model as a TOML file: written by ``fit``, read by ``compare`` and ``simulate``, edited by hand."""

from __future__ import annotations

import json
import re
import stat
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from .effects import Contact, Damper, LimitedServo, Motor, Servo, Spring
from .errors import BadInput
from .mechanics import AbstractEffect, canonical_name, catalogue
from .parameters import specs, unit_text
from .records.force import BETWEEN
from .system import System

OBSERVED = ("z", "y", "T")
OF_A_DRIVE = ("motor", "link", "motor link")
MOST = 1e15
"""No value of a model is larger in size: beyond it nothing of ordinary size is left beside it in double precision."""
LARGEST = 50_000_000
"""Bytes of a model file at most; a learned torque of a fine table takes some."""


def dump_model(
    system: System, *, translational: bool = False, per_inertia: bool = False, heading: str = "",
    between: str | None = None, known_noise: tuple[float, float] = (1.0, 0.0),
) -> str:  # fmt: skip
    """The text of a model file; units stand beside the values as comments.

    ``between`` tells how the force of the fitted record was taken to go on between its samples, one of
    `jaxbacklash.records.force.BETWEEN`, for `simulate` to do the same; None: there was no force.
    ``known_noise`` tells `compare` what the fit has found of the noise, where that is below what the samples alone said: by which
    factor, and its standard deviation.

    Examples
    --------
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=15000.0, damping=20.0)
    >>> print(jb.dump_model(joint))
    [model]
    observed = "z"
    inertia = 3.16  # kg m^2
    backlash = 0.026  # rad
    ...
    """

    def entry(name: str, value: Any, unit: str) -> str:
        text = unit_text(unit, translational=translational, per_inertia=per_inertia)
        return f"{_key(name)} = {_number(value)}  # {_shown(text)}"

    lines = [f"# {_shown(line)}" for line in heading.splitlines()]
    lines += ["[model]", f"observed = {_quoted(system.observed)}"]
    described = specs(system)
    lines.append(entry("inertia", system.inertia, described["inertia"].unit))
    for part in (system.contact, system.damper, system.motor):
        if part is not None:
            lines += [entry(f.name, getattr(part, f.name), f.metadata["spec"].unit) for f in fields(part)]
    if between is not None:
        lines += ["", "[input]", f"force = {_quoted(between)}  # between its samples: {', '.join(BETWEEN)}"]
    if known_noise[0] != 1.0:
        unit = unit_text({"T": "N m"}.get(system.observed, "rad"), translational=translational, per_inertia=False)
        lines += ["", "[noise]", f"factor = {_number(known_noise[0])}  # of what the samples alone said of it"]
        lines.append(f"level = {_number(known_noise[1])}  # {unit}, standard deviation")
    for name in sorted(system.effects):
        effect = system.effects[name]
        lines += ["", f"[effects.{_key(name)}]"]
        for f in fields(effect):
            value, spec = getattr(effect, f.name), f.metadata.get("spec")
            lines.append(f"{_key(f.name)} = {_literal(value)}" if spec is None else entry(f.name, value, spec.unit))
    return "\n".join(lines) + "\n"


def load_model(path: str | Path) -> System:
    """Read a model file.

    Returns
    -------
    the system, ready for `compare` and `simulate`

    Raises
    ------
    BadInput
        A file that is missing or not TOML, an unknown or missing entry, a value that is no number or out of bounds.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> file = Path(mkdtemp()) / "model.toml"
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=15000.0, damping=20.0)
    >>> file.write_text(jb.dump_model(joint)) > 0
    True
    >>> float(jb.load_model(file).contact.stiffness)
    15000.0
    """
    data, where = _read(path)
    return _build(data, where)


def input_between(path: str | Path) -> str | None:
    """How a model file says that a force goes on between its samples, one of `jaxbacklash.records.force.BETWEEN`, or None.

    Raises
    ------
    BadInput
        As `load_model`.
    """
    return _between(*_read(path))


def noise_known(path: str | Path) -> tuple[float, float]:
    """What a model file says of the noise of the record that it was fitted to.

    Returns
    -------
    by which factor it was below what the samples alone said, and its standard deviation; (1, 0) where the file says nothing

    Raises
    ------
    BadInput
        As `load_model`.
    """
    return _noise(*_read(path))


def _noise(data: dict[str, Any], where: str) -> tuple[float, float]:
    told = data.get("noise")
    if told is None:
        return 1.0, 0.0
    if not isinstance(told, dict) or set(told) != {"factor", "level"}:
        raise BadInput(f"{where}: noise is {_cut(repr(told))}, wanted a table [noise] with factor and level")
    factor, level = (_value(told[name], f"{where}: [noise] {name}") for name in ("factor", "level"))
    if not (0.0 < factor <= 1.0 and level > 0.0):
        raise BadInput(f"{where}: [noise] has factor {factor:g} and level {level:g}, wanted 0 < factor <= 1 and a positive level")
    return factor, level


def _between(data: dict[str, Any], where: str) -> str | None:
    told = data.get("input", {})
    if not isinstance(told, dict):
        raise BadInput(f"{where}: input is not a table, wanted [input] with force")
    stray = sorted(set(told) - {"force"})
    if stray:
        raise BadInput(f"{where}: [input] has an entry {stray[0]}, wanted only force")
    between = told.get("force")
    if between is not None and between not in BETWEEN:
        raise BadInput(f"{where}: [input] force is {_cut(repr(between))}, wanted one of {', '.join(BETWEEN)}")
    return between


def _read(path: str | Path) -> tuple[dict[str, Any], str]:
    """What a model file holds, and its name as it is told."""
    where = _shown(str(path))
    try:
        state = Path(path).stat()
        if not stat.S_ISREG(state.st_mode):  # a pipe or a device may never end
            what = "a folder" if stat.S_ISDIR(state.st_mode) else "no regular file"
            raise BadInput(f"{where}: is {what}, wanted a model file (TOML)")
        if state.st_size > LARGEST:
            raise BadInput(f"{where}: has {state.st_size} bytes, wanted a model file (TOML) of at most {LARGEST}")
        text = Path(path).read_text(encoding="utf-8-sig")
        data = tomllib.loads(text)
    except FileNotFoundError:
        raise BadInput(f"{where}: no such file, wanted a model file (TOML), as fit --out writes it") from None
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{where}: cannot be read as text ({type(error).__name__}), wanted a model file (TOML)") from None
    except RecursionError:
        raise BadInput(
            f"{where}: holds lists or tables nested too deep, wanted TOML with a [model] table, as fit --out writes it"
        ) from None
    except ValueError as error:  # among them a number of thousands of digits
        if isinstance(error, BadInput):
            raise
        raise BadInput(
            f"{where}: not a model file: {str(error).splitlines()[0]}, wanted TOML with a [model] table, as fit --out writes it"
        ) from None
    return data, where


def _build(data: dict[str, Any], where: str) -> System:
    model = data.get("model")
    if not isinstance(model, dict):
        raise BadInput(f"{where}: found no [model] table, wanted one with inertia, stiffness, damping and, with play, backlash")
    stray = sorted(set(data) - {"model", "input", "noise", "effects"})
    if stray:
        raise BadInput(f"{where}: found a table [{stray[0]}], wanted [model], [input], [noise] and [effects.NAME] only")
    _between(data, where)
    _noise(data, where)
    values = dict(model)
    observed = values.pop("observed", "z")
    drive = bool({f.name for f in fields(LimitedServo)} & set(values))
    kind = LimitedServo if "tmax" in values else Servo if {"Kp", "Kd"} & set(values) else Motor
    of_motor = {f.name for f in fields(kind)}
    known = OF_A_DRIVE if drive else OBSERVED
    if observed not in known:
        raise BadInput(f"{where}: [model] observed is {observed!r}, wanted one of {', '.join(known)}")
    if drive and not of_motor <= set(values):
        raise BadInput(f"{where}: [model] lacks {min(of_motor - set(values))}, wanted {', '.join(sorted(of_motor))} of a drive")
    allowed = {"inertia", "backlash", "stiffness", "width", "damping"} | of_motor
    unknown = sorted(set(values) - allowed)
    if unknown:
        raise BadInput(f"{where}: [model] has an entry {unknown[0]}, wanted only {', '.join(sorted(allowed))}")
    if "backlash" in values and "stiffness" not in values:
        raise BadInput(f"{where}: [model] has a backlash but no stiffness, wanted both, or neither for a free axis")
    numbers = {name: _value(value, f"{where}: [model] {name}") for name, value in values.items()}
    for name in ("inertia", "stiffness", "motor_inertia", "ratio", "Kp", "tmax"):
        if name in numbers and numbers[name] <= 0.0:
            raise BadInput(f"{where}: [model] {name} is {numbers[name]:g}, wanted a positive number")
    contact: Contact | Spring | None = None
    for name, what in (
        ("backlash", "the total play"),
        ("damping", "a damping"),
        ("width", "a length"),
        ("motor_damping", "a damping"),
        ("Kd", "a gain"),
    ):
        if numbers.get(name, 0.0) < 0.0:
            raise BadInput(f"{where}: [model] {name} is {numbers[name]:g}, wanted {what}, zero or more")
    if "backlash" in numbers:
        contact = Contact(numbers["backlash"], numbers["stiffness"], numbers.get("width", 0.0))
    elif "stiffness" in numbers:
        contact = Spring(numbers["stiffness"])
    motor = kind(**{name: numbers[name] for name in of_motor}) if drive else None
    system = System(numbers.get("inertia", 1.0), contact, Damper(numbers.get("damping", 0.0)), observed=observed, motor=motor)
    tables = data.get("effects", {})
    if not isinstance(tables, dict):
        raise BadInput(f"{where}: effects is not a table, wanted [effects.NAME]")
    effects = [_effect(name, entries, where) for name, entries in tables.items()]
    at_motor = next((canonical_name(effect) for effect in effects if effect.port == "motor"), None)
    if at_motor is not None and not drive:
        raise BadInput(f"{where}: [effects.{at_motor}] acts on a motor, wanted motor_inertia, motor_damping and ratio in [model]")
    return system.with_effects(*effects)


def _effect(name: str, entries: Any, where: str) -> AbstractEffect:
    known = catalogue()
    if name not in known or not isinstance(entries, dict):
        raise BadInput(f"{where}: [effects.{name}] is not an effect, wanted one of {', '.join(known)}")
    cls = known[name]
    described = {f.name: f for f in fields(cls) if "spec" in f.metadata}
    settings = [f.name for f in fields(cls) if f.metadata.get("static", False)]
    unknown = sorted(set(entries) - set(described) - set(settings))
    if unknown:
        raise BadInput(f"{where}: [effects.{name}] has an entry {unknown[0]}, wanted {', '.join([*described, *settings])}")
    spec_of = {key: field.metadata["spec"] for key, field in described.items()}
    missing = [key for key, spec in spec_of.items() if key not in entries and not spec.fixed and spec.usual is None]
    if missing:
        raise BadInput(f"{where}: [effects.{name}] lacks {missing[0]}, wanted {', '.join(described)}")
    numbers = {key: _value(value, f"{where}: [effects.{name}] {key}") for key, value in entries.items() if key in described}
    others = {key: _setting(value, f"{where}: [effects.{name}] {key}") for key, value in entries.items() if key in settings}
    try:
        effect = cls(**numbers, **others)
    except (ValueError, LookupError, AttributeError, ArithmeticError) as error:
        raise BadInput(f"{where}: [effects.{name}]: {error}") from None
    except TypeError:
        lacking = sorted((set(described) | set(settings)) - set(entries))
        raise BadInput(f"{where}: [effects.{name}] lacks {lacking[0] if lacking else 'an entry'}, wanted "
                       f"{', '.join([*described, *settings])}") from None  # fmt: skip
    for key, value in numbers.items():
        spec = spec_of[key]
        if not spec.lower <= value <= spec.upper:
            raise BadInput(f"{where}: [effects.{name}] {key} is {value:g}, wanted {spec.lower:g} to {spec.upper:g}")
    assert canonical_name(effect) == name
    return effect


def _value(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or (isinstance(value, float) and not np.isfinite(value)):
        raise BadInput(f"{where} is {_cut(repr(value))}, wanted a finite number")
    if not abs(value) <= MOST:
        raise BadInput(f"{where} is {_cut(str(value))}, wanted a number of at most {MOST:g} in size")
    return float(value)


def _cut(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:30]}... ({len(text)} characters)"


def _setting(value: Any, where: str) -> Any:
    """Text, a number, or rows of them, as what a law holds beside its parameters."""
    if isinstance(value, list):
        return tuple(_setting(part, where) for part in value)
    return value if isinstance(value, str) else _value(value, where)


def _literal(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_literal(part) for part in value) + "]"
    return _quoted(value) if isinstance(value, str) else _number(value)


def _key(name: str) -> str:
    """A name as TOML takes it: bare where it is of ASCII letters, digits, - and _."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _quoted(name)


def _quoted(text: str) -> str:
    """A TOML string: as JSON writes it, half characters of file names as escapes, DEL escaped too."""
    whole = text.encode("utf-8", "backslashreplace").decode("utf-8")
    return json.dumps(whole, ensure_ascii=False).replace("\x7f", "\\u007f")


def _shown(text: str) -> str:
    """Text for a comment or a sentence: what TOML allows in no comment, and half characters, as escapes."""
    whole = text.encode("utf-8", "backslashreplace").decode("utf-8")
    return "".join(c if c.isprintable() or c == "\t" else c.encode("unicode_escape").decode("ascii") for c in whole)


def _number(value: Any) -> str:
    text = repr(float(value))
    return text if any(c in text for c in ".en") else text + ".0"
