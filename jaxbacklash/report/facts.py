"""What was measured and how the answer was checked, in words: facts of the record and the cross-check's table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..fitting import measures, percent
from ..plot.style import format_parts, is_number, pretty_unit, short

BASE = ("backlash", "stiffness", "damping")
LABELS = {"backlash": "total play b", "stiffness": "contact stiffness k", "damping": "viscous damping c"}
UNKNOWN = "–"

Entry = Mapping[str, Any]


def facts(result: Entry, record: Entry, path: str, stages: Sequence[Entry]) -> Iterator[tuple[str, str]]:
    """Pairs of a label and a text about the record and the run; whatever result.json lacks is left out."""
    yield "file", path
    if is_number(record.get("samples")):
        rate = f" at {record['rate_hz']:.6g} Hz" if is_number(record.get("rate_hz")) else ""
        seconds = record.get("duration_s")
        if not is_number(seconds) and rate and record["rate_hz"]:
            seconds = record["samples"] / record["rate_hz"]
        yield "samples", f"{record['samples']}{rate}" + (f", {seconds:.6g} s" if is_number(seconds) else "")
    if record.get("channels"):
        yield "channels", ", ".join(map(str, record["channels"]))
    if record.get("kind"):
        yield "kind of record", str(record["kind"]).replace("_", " ")
    length, inertia = length_unit(stages), result.get("inertia")
    for channel, value in (result.get("noise") or {}).items():
        own = {"m": "N", "rad": "N m"}.get(length, "") if channel in ("F", "T") else length
        unit = (record.get("units") or {}).get(channel) or own
        yield f"noise of {channel}", f"{short(value)} {pretty_unit(unit)} (standard deviation, from the data)"
    if isinstance(inertia, Mapping) and is_number(inertia.get("value")) and not result.get("per_inertia"):
        how = "given" if inertia.get("given") else "fitted"
        yield "inertia", f"{inertia['value']:.6g} {pretty_unit(str(inertia.get('unit') or ''))}, {how}"
    if result.get("model"):
        effects = ", ".join(map(str, result.get("effects") or [])) or "none"
        yield "model", f"{result['model']}; effects beyond it: {effects}"
    starts = result.get("starts")
    if isinstance(starts, Mapping) and is_number(starts.get("tried")):
        yield "starting points", f"{starts.get('agreeing')} of {starts['tried']} reached this minimum"
    for other in (result.get("records") or [])[1:]:
        yield "also fitted", f"{other.get('path')}: {short(other.get('rms_over_noise'))} times its noise{share(other, record)}"


def rests_on(result: Entry) -> Iterator[tuple[str, str]]:
    """What a reading without a model rests on: each condition, whether it holds, and what was found."""
    conditions = result.get("conditions") or []
    unit = str((result.get("transmission_error") or {}).get("unit") or "")
    if conditions and unit:
        yield "lengths below", f"in {unit}"
    for entry in conditions:
        holds = {True: "yes", False: "no"}.get(entry.get("holds"), "the record cannot tell")
        yield f"condition: {entry.get('name')}", f"{holds}; {entry.get('found')}"


def share(errors: Entry, record: Entry, key: str = "nrmse") -> str:
    """What an error is of what was measured, to stand after it: ``, 12 % of the motion``; nothing where that is not known."""
    known: Any = errors.get(key)
    return f", {percent(known)} of the {measured(record)}" if is_number(known) else ""


def measured(record: Entry) -> str:
    """What a record's observed channel measures, in a word."""
    return measures("T" if record.get("kind") == "transmitted" else "z")


def cross_check_table(check: Any, last: Entry) -> dict[str, Any] | None:
    """The fit beside other methods on the same samples: a column per method, a row per parameter."""
    if not isinstance(check, Mapping):
        return None
    methods = [str(key) for key, value in check.items() if isinstance(value, Mapping)]
    fitted = parameters_of(last)
    names = [name for name in BASE if any(name in check[method] for method in methods)]
    repeated = _repeated([check[method].get(name) for name in names for method in methods])
    rows = []
    for name in names:
        unit = str(fitted.get(name, {}).get("unit") or "")
        told = (_any_value(check[method].get(name), unit, repeated) for method in methods)
        rows.append({"label": LABELS[name], "cells": [brief(fitted.get(name)), *told]})
    agrees = check.get("agrees")
    words = "No second method could judge this fit."
    if agrees is not None:
        words = "The methods agree." if agrees else "The methods do not agree."
    if check.get("text"):
        said = [str(check["text"]), *(_sentence(why) for why in repeated if why not in str(check["text"]))]
        return {"methods": [_method(m) for m in methods], "rows": rows, "sentence": " ".join(said)}
    within = f" Tolerance: {check['tolerance']}." if check.get("tolerance") and agrees is not None else ""
    why = f" {_sentence(check['why'])}" if check.get("why") else ""
    return {"methods": [_method(m) for m in methods], "rows": rows, "sentence": f"{words}{within}{why}"}


def skeleton_tables(result: Entry) -> dict[str, Any] | None:
    """The Hilbert and wavelet answers of ``skeleton`` side by side: a column a method, a row a parameter; None for others."""
    if result.get("command") != "skeleton":
        return None
    methods = [name for name in ("hilbert", "wavelet") if isinstance(result.get(name), Mapping)]
    repeated = _repeated([result[method].get(name) for method in methods for name in BASE])
    rows = []
    for name in (*BASE, "inertia"):
        if any(name in result[method] for method in methods):
            cells = []
            for entry in (result[method].get(name, {}) for method in methods):
                shown, why = [f"{number} {unit}".rstrip() for number, unit in parts(entry)], str(entry.get("why") or "")
                cells.append({"lines": shown, "why": "" if why in repeated else why})
            rows.append({"label": LABELS.get(name, "inertia J"), "cells": cells})
    warnings = [str(sentence) for sentence in result.get("warnings") or []]
    said = [*(why for why in repeated if why not in warnings), *warnings]
    return {
        "methods": [_method(m) for m in methods],
        "rows": rows,
        "warnings": [_sentence(why).removesuffix(".") for why in said],
    }


def _repeated(entries: Sequence[Any]) -> list[str]:
    """Reasons that more than one missing value has, each once: they are told beside the table, not in every cell."""
    whys = [str(one["why"]) for one in entries if isinstance(one, Mapping) and not is_number(one.get("value")) and one.get("why")]
    return [why for k, why in enumerate(whys) if whys.count(why) > 1 and why not in whys[:k]]


def best_method(result: Entry) -> dict[str, Any]:
    """A stage that holds the parameters of the method whose play has the smaller error, for the tiles."""
    methods = [result[name] for name in ("wavelet", "hilbert") if isinstance(result.get(name), Mapping)]
    told = [m for m in methods if is_number((m.get("backlash") or {}).get("stderr"))]
    best = min(told, key=lambda m: m["backlash"]["stderr"]) if told else (methods or [{}])[0]
    return {"parameters": {name: best[name] for name in BASE if name in best}}


def length_unit(stages: Sequence[Entry]) -> str:
    """``rad`` or ``m``: what the joint moves in, by the units of its parameters; empty when they do not tell."""
    units = [str(entry.get("unit") or "") for stage in stages for entry in parameters_of(stage).values()]
    if any("rad" in unit for unit in units):
        return "rad"
    return "m" if any(unit == "m" or unit.endswith("/m") for unit in units) else ""


def parameters_of(stage: Entry) -> dict[str, Entry]:
    """The parameters of a stage that are written as result.json says."""
    return {name: entry for name, entry in (stage.get("parameters") or {}).items() if isinstance(entry, Mapping)}


def parts(entry: Entry) -> list[tuple[str, str]]:
    """A parameter as (number, unit) pairs, see `style.format_parts`."""
    return format_parts(entry.get("value"), entry.get("stderr"), str(entry.get("unit") or ""))


def brief(entry: Entry | None, *, unit: bool = True) -> str:
    """A parameter in its own unit alone, or a dash."""
    shown = [] if entry is None else parts(entry)
    if not shown:
        return UNKNOWN
    return " ".join(shown[0]).rstrip() if unit else shown[0][0]


def _any_value(entry: Any, unit: str, repeated: Sequence[str] = ()) -> str:
    if isinstance(entry, Mapping):
        if not is_number(entry.get("value")):
            why = str(entry.get("why") or "")
            return UNKNOWN if not why else "none" if why in repeated else f"none: {why}"
        return brief({"unit": unit, **entry})
    return brief({"value": entry, "unit": unit}) if is_number(entry) else UNKNOWN


def _method(name: str) -> str:
    """A method's name as people write it."""
    return name.replace("_", " ").replace("hilbert", "Hilbert transform")


def _sentence(text: Any) -> str:
    text = str(text).strip()
    symbol = len(text.split(" ")[0]) == 1 and text[:1] in "txyzb"  # z is not Z
    return (text[:1] if symbol else text[:1].upper()) + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")
