"""result.json as the words and numbers of a page: plain strings in plain dicts, for the template to lay out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from .figures_model import stage_name
from .style import format_evidence, format_interval, format_parts, is_number, pretty_unit, short, with_unit

BASE = ("backlash", "stiffness", "damping")
LABELS = {"backlash": "total play b", "stiffness": "contact stiffness k", "damping": "viscous damping c"}
MARKS = {"found": "✓", "one-sided": "◐", "given": "·"}  # a sign beside each word, for those who see no colour
UNKNOWN = "–"

Entry = Mapping[str, Any]


def summarise(result: Entry) -> dict[str, Any]:
    """Everything the page says in words, from result.json of ``fit``, ``refine`` or ``compare``."""
    stages = [stage for stage in result.get("stages") or [] if isinstance(stage, Mapping)]
    if not stages and ("parameters" in result or "rms_over_noise" in result):
        stages = [result]  # a comparison of one model may come without a list
    record = result.get("record") or {}
    path = str(record.get("path") or "record")
    return {
        "command": str(result.get("command") or ""),
        "name": PurePosixPath(path.replace("\\", "/")).name or path,
        "verdict": str(result.get("verdict") or ""),
        "verdict_text": str(result.get("verdict_text") or ""),
        "findings": [str(sentence) for sentence in result.get("findings") or []],
        "tiles": _tiles(stages),
        "parameters": parameter_rows(stages),
        "stages": stage_rows(stages) if len(stages) > 1 else [],
        "stage_heads": _stage_heads(stages),
        "scores": _scores(stages[-1]) if stages else [],
        "candidates": candidate_tables(stages),
        "alternatives": [" + ".join(map(str, names)) for names in result.get("alternatives") or [] if names],
        "cross_check": cross_check_table(result.get("cross_check"), stages[-1] if stages else {}),
        "facts": list(_facts(result, record, path, stages)),
        "per_inertia": bool(result.get("per_inertia")),
        "command_line": str(result.get("command_line") or ""),
        "version": str(result.get("version") or ""),
    }


def verdict_words(entry: Entry) -> dict[str, str]:
    """A parameter's verdict as a class, a sign and a sentence; a null value always says why."""
    known = is_number(entry.get("value"))
    verdict = str(entry.get("verdict") or ("found" if known else "not determined"))
    why = str(entry.get("why") or ("" if known else "no reason was recorded"))
    kind = verdict.replace(" ", "-") if verdict in ("found", "one-sided", "not determined") else "other"
    return {"kind": kind, "mark": MARKS.get(verdict, "✗" if not known else "·"), "text": f"{verdict}: {why}" if why else verdict}


def parameter_rows(stages: Sequence[Entry]) -> list[dict[str, Any]]:
    """One row per parameter of the last stage, the three of the joint first, with how far it moved since the first stage."""
    if not stages:
        return []
    last, first = _parameters(stages[-1]), _parameters(stages[0])
    names = [name for name in BASE if name in last] + [name for name in last if name not in BASE]
    rows = []
    for name in names:
        entry = last[name]
        unit = str(entry.get("unit") or "")
        rows.append(
            {
                "name": name,
                "label": LABELS.get(name) or str(entry.get("label") or name),
                "values": [f"{number} {shown}".rstrip() for number, shown in _parts(entry)],
                "interval": format_interval(entry.get("ci95"), entry.get("stderr"), unit),
                "moved": _moved(first.get(name), entry) if len(stages) > 1 else "",
                "verdict": verdict_words(entry),
            }
        )
    return rows


def stage_rows(stages: Sequence[Entry]) -> list[dict[str, Any]]:
    """One row per model tried and kept: its errors, and where the joint's own parameters stood."""
    rows = []
    for number, stage in enumerate(stages):
        found = _parameters(stage)
        rows.append(
            {
                "name": stage_name(stage, number).replace("_\n", "_").replace("\n", " "),
                "scores": [text for _, text in _scores(stage)],
                "values": [_brief(found.get(name), unit=False) for name in BASE],
            }
        )
    return rows


def candidate_tables(stages: Sequence[Entry]) -> list[dict[str, Any]]:
    """For each stage that ranked absent effects: its name and the ranking."""
    tables = []
    for number, stage in enumerate(stages):
        listed = [entry for entry in stage.get("candidates") or [] if isinstance(entry, Mapping)]
        if not listed:
            continue
        rows = [
            {
                "name": str(entry.get("name", "?")),
                "rms": short(entry.get("predicted_rms_over_noise")),
                "evidence": format_evidence(entry.get("evidence")),
                "why": str(entry.get("why") or ""),
            }
            for entry in listed
        ]
        have = ", ".join(str(name) for name in stage.get("effects") or []) or "the base model"
        tables.append({"stage": number, "have": have, "rows": rows, "reasons": any(row["why"] for row in rows)})
    return tables


def cross_check_table(check: Any, last: Entry) -> dict[str, Any] | None:
    """The fit beside other methods on the same samples: a column per method, a row per parameter."""
    if not isinstance(check, Mapping):
        return None
    methods = [str(key) for key, value in check.items() if isinstance(value, Mapping)]
    fitted = _parameters(last)
    names = [name for name in BASE if any(name in check[method] for method in methods)]
    rows = []
    for name in names:
        unit = str(fitted.get(name, {}).get("unit") or "")
        cells = [_any_value(fitted.get(name), unit), *(_any_value(check[method].get(name), unit) for method in methods)]
        rows.append({"label": LABELS[name], "cells": cells})
    agrees = check.get("agrees")
    words = {True: "The methods agree.", False: "The methods do not agree."}.get(agrees, "No second method could judge this fit.")
    within = f" Tolerance: {check['tolerance']}." if check.get("tolerance") and agrees is not None else ""
    why = f" {_sentence(check['why'])}" if check.get("why") else ""
    return {"methods": [m.replace("_", " ") for m in methods], "rows": rows, "sentence": f"{words}{within}{why}"}


def _parameters(stage: Entry) -> dict[str, Entry]:
    return {name: entry for name, entry in (stage.get("parameters") or {}).items() if isinstance(entry, Mapping)}


def _tiles(stages: Sequence[Entry]) -> list[dict[str, str]]:
    if not stages:
        return []
    tiles = []
    for name in BASE:
        entry = _parameters(stages[-1]).get(name)
        if entry is None:
            continue
        parts = _parts(entry)
        # Degrees are what a person pictures, so they come first where there are any; radians stay beside them.
        (number, unit), *others = parts[::-1] or [("not determined", "")]
        rest = " ".join(others[0]) if others else str(entry.get("why") or "")
        tiles.append({"label": LABELS[name], "value": number, "unit": unit, "rest": rest})
    last = stages[-1]
    if is_number(last.get("rms_over_noise")):
        held = last.get("heldout_rms_over_noise")
        rest = f"held-out record: {short(held)}" if is_number(held) else "1.00 would be noise alone"
        tiles.append({"label": "prediction error", "value": short(last["rms_over_noise"]), "unit": "× noise", "rest": rest})
    return tiles


def _scores(stage: Entry) -> list[tuple[str, str]]:
    names = (
        ("rms_over_noise", "rms over noise"),
        ("median_over_noise", "median window"),
        ("heldout_rms_over_noise", "held-out rms"),
        ("heldout_median_over_noise", "held-out median"),
    )
    return [(label, short(stage.get(key))) for key, label in names]


def _parts(entry: Entry) -> list[tuple[str, str]]:
    return format_parts(entry.get("value"), entry.get("stderr"), str(entry.get("unit") or ""))


def _stage_heads(stages: Sequence[Entry]) -> list[str]:
    heads = []
    for name in BASE:
        units = [str(found[name].get("unit") or "") for found in map(_parameters, stages) if name in found]
        heads.append(with_unit(LABELS[name], units[0] if units else ""))
    return heads


def _brief(entry: Entry | None, *, unit: bool = True) -> str:
    parts = [] if entry is None else _parts(entry)
    return (" ".join(parts[0]).rstrip() if unit else parts[0][0]) if parts else UNKNOWN


def _any_value(entry: Any, unit: str) -> str:
    if isinstance(entry, Mapping):
        if not is_number(entry.get("value")):
            return f"none: {entry['why']}" if entry.get("why") else UNKNOWN
        return _brief({"unit": unit, **entry})
    return _brief({"value": entry, "unit": unit}) if is_number(entry) else UNKNOWN


def _moved(before: Entry | None, after: Entry) -> str:
    if before is None:
        return "new"
    old, new = before.get("value"), after.get("value")
    if not is_number(old) or not is_number(new) or old == 0.0:
        return UNKNOWN
    return f"{100.0 * (new - old) / abs(old):+.2g} %"  # type: ignore[operator]


def _sentence(text: Any) -> str:
    text = str(text).strip()
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")


def _facts(result: Entry, record: Entry, path: str, stages: Sequence[Entry]) -> Iterable[tuple[str, str]]:
    yield "file", path
    if is_number(record.get("samples")):
        rate = f" at {short(record['rate_hz'], 5)} Hz" if is_number(record.get("rate_hz")) else ""
        length = record.get("duration_s")
        if not is_number(length) and rate and record["rate_hz"]:
            length = record["samples"] / record["rate_hz"]
        yield "samples", f"{record['samples']}{rate}" + (f", {short(length, 4)} s" if is_number(length) else "")
    if record.get("channels"):
        yield "channels", ", ".join(map(str, record["channels"]))
    if record.get("kind"):
        yield "kind of record", str(record["kind"])
    play = next((s["backlash"].get("unit") for s in map(_parameters, stages) if "backlash" in s), None)
    inertia = result.get("inertia")
    for channel, value in (result.get("noise") or {}).items():
        unit = (record.get("units") or {}).get(channel) or (play if channel in ("x", "y", "z") else "")
        yield f"noise of {channel}", f"{short(value)} {pretty_unit(unit)} (standard deviation, from the data)"
    if isinstance(inertia, Mapping) and is_number(inertia.get("value")) and not result.get("per_inertia"):
        how = "given" if inertia.get("given") else "fitted"
        yield "inertia", f"{short(inertia['value'], 5)} {pretty_unit(str(inertia.get('unit') or ''))}, {how}"
    if result.get("model"):
        effects = ", ".join(map(str, result.get("effects") or [])) or "none"
        yield "model", f"{result['model']}; effects beyond it: {effects}"
    starts = result.get("starts")
    if isinstance(starts, Mapping) and is_number(starts.get("tried")):
        yield "starting points", f"{starts.get('agreeing')} of {starts['tried']} reached this minimum"
    for other in (result.get("records") or [])[1:]:
        yield "also fitted", f"{other.get('path')}: {short(other.get('rms_over_noise'))} times its noise"
