"""A model as a TOML file: written by ``fit``, read by ``compare`` and ``simulate``, edited by hand."""

from __future__ import annotations

import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from .effects import Contact, Damper, Spring
from .errors import BadInput
from .mechanics import AbstractEffect, canonical_name, catalogue
from .parameters import specs, unit_text
from .system import System

OBSERVED = ("z", "y", "T")


def dump_model(system: System, *, translational: bool = False, per_inertia: bool = False, heading: str = "") -> str:
    """The text of a model file; units stand beside the values as comments."""

    def entry(name: str, value: Any, unit: str) -> str:
        text = unit_text(unit, translational=translational, per_inertia=per_inertia)
        return f"{name} = {_number(value)}  # {text}"

    lines = [f"# {line}" for line in heading.splitlines()]
    lines += ["[model]", f'observed = "{system.observed}"']
    described = specs(system)
    lines.append(entry("inertia", system.inertia, described["inertia"].unit))
    for part in (system.contact, system.damper):
        if part is not None:
            lines += [entry(f.name, getattr(part, f.name), f.metadata["spec"].unit) for f in fields(part)]
    for name in sorted(system.effects):
        effect = system.effects[name]
        lines += ["", f"[effects.{name}]"]
        for f in fields(effect):
            value, spec = getattr(effect, f.name), f.metadata.get("spec")
            lines.append(f"{f.name} = {_literal(value)}" if spec is None else entry(f.name, value, spec.unit))
    return "\n".join(lines) + "\n"


def load_model(path: str | Path) -> System:
    """Read a model file.

    Raises
    ------
    BadInput
        A file that is missing or not TOML, an unknown or missing entry, a value that is no number or out of bounds.
    """
    where = str(path)
    try:
        text = Path(path).read_text(encoding="utf-8")
        data = tomllib.loads(text)
    except FileNotFoundError:
        raise BadInput(f"{where}: no such file, wanted a model file (TOML)") from None
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{where}: cannot be read as text ({type(error).__name__}), wanted a model file (TOML)") from None
    except tomllib.TOMLDecodeError as error:
        raise BadInput(f"{where}: not a model file: {str(error).splitlines()[0]}, wanted TOML with a [model] table") from None
    return _build(data, where)


def _build(data: dict[str, Any], where: str) -> System:
    model = data.get("model")
    if not isinstance(model, dict):
        raise BadInput(f"{where}: found no [model] table, wanted one with inertia, stiffness, damping and, with play, backlash")
    stray = sorted(set(data) - {"model", "effects"})
    if stray:
        raise BadInput(f"{where}: found a table [{stray[0]}], wanted [model] and [effects.NAME] only")
    values = dict(model)
    observed = values.pop("observed", "z")
    if observed not in OBSERVED:
        raise BadInput(f"{where}: [model] observed is {observed!r}, wanted one of {', '.join(OBSERVED)}")
    allowed = {"inertia", "backlash", "stiffness", "width", "damping"}
    unknown = sorted(set(values) - allowed)
    if unknown:
        raise BadInput(f"{where}: [model] has an entry {unknown[0]}, wanted only {', '.join(sorted(allowed))}")
    if "backlash" in values and "stiffness" not in values:
        raise BadInput(f"{where}: [model] has a backlash but no stiffness, wanted both, or neither for a free axis")
    numbers = {name: _value(value, f"{where}: [model] {name}") for name, value in values.items()}
    for name in ("inertia", "stiffness"):
        if name in numbers and numbers[name] <= 0.0:
            raise BadInput(f"{where}: [model] {name} is {numbers[name]:g}, wanted a positive number")
    contact: Contact | Spring | None = None
    if "backlash" in numbers:
        if numbers["backlash"] < 0.0:
            raise BadInput(f"{where}: [model] backlash is {numbers['backlash']:g}, wanted the total play, zero or more")
        contact = Contact(numbers["backlash"], numbers["stiffness"], numbers.get("width", 0.0))
    elif "stiffness" in numbers:
        contact = Spring(numbers["stiffness"])
    system = System(numbers.get("inertia", 1.0), contact, Damper(numbers.get("damping", 0.0)), observed=observed)
    tables = data.get("effects", {})
    if not isinstance(tables, dict):
        raise BadInput(f"{where}: effects is not a table, wanted [effects.NAME]")
    return system.with_effects(*(_effect(name, entries, where) for name, entries in tables.items()))


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
    numbers = {key: _value(value, f"{where}: [effects.{name}] {key}") for key, value in entries.items() if key in described}
    others = {key: _setting(value, f"{where}: [effects.{name}] {key}") for key, value in entries.items() if key in settings}
    try:
        effect = cls(**numbers, **others)
    except ValueError as error:
        raise BadInput(f"{where}: [effects.{name}]: {error}") from None
    except TypeError:
        missing = sorted(set(described) - set(entries))
        raise BadInput(f"{where}: [effects.{name}] lacks {missing[0]}, wanted {', '.join(described)}") from None
    for key, value in numbers.items():
        spec = described[key].metadata["spec"]
        if not spec.lower <= value <= spec.upper:
            raise BadInput(f"{where}: [effects.{name}] {key} is {value:g}, wanted {spec.lower:g} to {spec.upper:g}")
    assert canonical_name(effect) == name
    return effect


def _value(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise BadInput(f"{where} is {value!r}, wanted a finite number")
    return float(value)


def _setting(value: Any, where: str) -> Any:
    """Text, a number, or rows of them, as what a law holds beside its parameters."""
    if isinstance(value, list):
        return tuple(_setting(part, where) for part in value)
    return value if isinstance(value, str) else _value(value, where)


def _literal(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_literal(part) for part in value) + "]"
    return f'"{value}"' if isinstance(value, str) else _number(value)


def _number(value: Any) -> str:
    text = repr(float(value))
    return text if any(c in text for c in ".en") else text + ".0"
