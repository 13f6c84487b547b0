"""result.json as the words and numbers of a page: plain strings in plain dicts, for the template to lay out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from ..fitting import percent
from ..plot.style import format_evidence, format_interval, is_number, short, with_unit
from ..plot.words import error_with, stage_name
from .chaos_tiles import chaos_tiles, chosen
from .facts import (
    BASE,
    LABELS,
    UNKNOWN,
    Entry,
    best_method,
    brief,
    cross_check_table,
    facts,
    measured,
    parameters_of,
    parts,
    rests_on,
    share,
    skeleton_tables,
)

SETTLED = ("complete", "chaotic", "regular", "stochastic", "read")  # verdicts that leave nothing open
MARKS = {"found": "✓", "one-sided": "◐", "given": "·"}  # a sign beside each word, for those who see no colour


def summarise(result: Entry) -> dict[str, Any]:
    """Everything the page says in words, from result.json of ``fit``, ``refine`` or ``compare``."""
    stages = [stage for stage in result.get("stages") or [] if isinstance(stage, Mapping)]
    if not stages and ("parameters" in result or "rms_over_noise" in result):
        stages = [result]  # a comparison of one model may come without a list
    record = result.get("record") or {}
    said = str(result.get("verdict_text") or "")
    path = str(record.get("path") or "record")
    return {
        "command": str(result.get("command") or ""),
        "name": PurePosixPath(path.replace("\\", "/")).name or path,
        "verdict": str(result.get("verdict") or ""),
        "settled": result.get("verdict") in SETTLED,
        # The page says the verdict's word itself, so a sentence need not begin with it.
        "verdict_text": said.removeprefix("Incomplete: ").removeprefix("Complete: "),
        "findings": [one for one in (*_causes(result), *map(str, result.get("findings") or [])) if one not in said],
        "next": str(result.get("next") or ""),
        "tiles": chaos_tiles(result)
        if "lyapunov" in result
        else _tiles([best_method(result)] if result.get("command") == "skeleton" else _told(stages, result), record),
        "skeletons": skeleton_tables(result),
        "parameters": parameter_rows(stages, str(result.get("intervals_note") or "")),
        "no_intervals": _no_intervals(result),
        "stages": stage_rows(stages, record) if len(stages) > 1 else [],
        "error_heads": ["rms over noise", *(["held out"] if _some_heldout(stages) else [])],
        "stage_heads": _stage_heads(stages),
        "scores": _scores(stages[-1], record) if stages and "rms_over_noise" in stages[-1] else [],
        "candidates": candidate_tables(stages),
        "alternatives": [" + ".join(map(str, names)) for names in result.get("alternatives") or [] if names],
        "alternatives_text": str(result.get("alternatives_text") or ""),
        "cross_check": cross_check_table(result.get("cross_check"), stages[-1] if stages else {}),
        "facts": [*facts(result, record, path, stages or [best_method(result)]), *chosen(result), *rests_on(result)],
        "per_inertia": bool(result.get("per_inertia")),
        "per_inertia_of": " of the motor, whose torque was not measured" if "command" in record.get("channels", []) else "",
        "command_line": str(result.get("command_line") or ""),
        "version": str(result.get("version") or ""),
    }


def _told(stages: list[Entry], result: Entry) -> list[Entry]:
    """The stages, the values of the last without errors where these would hold only if the model were right: a card has no room
    to say so."""
    if not stages or not result.get("intervals_note"):
        return stages
    bare = {name: {**entry, "stderr": None} for name, entry in parameters_of(stages[-1]).items()}
    return [*stages[:-1], {**stages[-1], "parameters": bare}]


def verdict_words(entry: Entry, doubted: bool = False) -> dict[str, str]:
    """A parameter's verdict as a class, a sign and a sentence; a null value always says why.

    Nothing is ticked where the model is ``doubted``: what it misses may have moved the value by more than any error says.
    """
    known = is_number(entry.get("value"))
    if known and doubted and entry.get("verdict", "found") == "found":
        return {"kind": "other", "mark": "!", "text": "fitted by a model that misses something"}
    verdict = str(entry.get("verdict") or ("found" if known else "not determined"))
    why = str(entry.get("why") or ("" if known else "no reason was recorded"))
    kind = verdict.replace(" ", "-") if verdict in ("found", "one-sided", "not determined") else "other"
    mark = MARKS.get(verdict, "·" if known else "✗")
    return {"kind": kind, "mark": mark, "text": f"{verdict}: {why}" if why else verdict}


def _causes(result: Entry) -> list[str]:
    """Causes of misfit in the record, each a sentence with what to type."""
    listed = [entry for entry in result.get("causes") or [] if isinstance(entry, Mapping)]
    said = []
    for entry in listed:
        remedy = str(entry.get("remedy") or "")
        way = f" {'Pass ' if remedy.startswith('--') else ''}{remedy}." if remedy else ""
        said.append(f"A cause lies in the record: {entry.get('text')}.{way}")
    return said


def parameter_rows(stages: Sequence[Entry], note: str = "") -> list[dict[str, Any]]:
    """One row per parameter of the last stage, the joint's three first, and how far each moved since the first; a ``note`` stands
    in place of every interval that would hold only if the model were right."""
    if not stages:
        return []
    last, first = parameters_of(stages[-1]), parameters_of(stages[0])
    names = [name for name in BASE if name in last] + [name for name in last if name not in BASE]
    rows = []
    for name in names:
        entry = last[name]
        unit = str(entry.get("unit") or "")
        rows.append(
            {
                "name": name,
                "label": LABELS.get(name) or str(entry.get("label") or name),
                "values": [f"{number} {shown}".rstrip() for number, shown in parts(entry)],
                "interval": _noted(format_interval(entry.get("ci95"), entry.get("stderr"), unit), note),
                "moved": _moved(first.get(name), entry) if len(stages) > 1 else "",
                "verdict": verdict_words(entry, bool(note)),
            }
        )
    return rows


def _noted(interval: str, note: str) -> str:
    return "none" if note and interval and interval != UNKNOWN else interval


def _no_intervals(result: Entry) -> str:
    """Why no interval is given, once for all parameters."""
    note = str(result.get("intervals_note") or "")
    return f"No intervals are given: they would hold {note}." if note else ""


def stage_rows(stages: Sequence[Entry], record: Entry) -> list[dict[str, Any]]:
    """One row per model tried and kept: its errors, and where the joint's own parameters stood."""
    rows = []
    for number, stage in enumerate(stages):
        found = parameters_of(stage)
        rows.append(
            {
                "name": stage_name(stage, number).replace("_\n", "_").replace("\n", " "),
                "scores": _errors(stage, record)[: 2 if _some_heldout(stages) else 1],
                "values": [(brief(found.get(name), unit=False), _step((stage.get("moved") or {}).get(name))) for name in BASE],
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
                "rms": short(error_with(entry)),
                "evidence": format_evidence(entry.get("evidence")),
                "why": _remark(entry),
            }
            for entry in listed
        ]
        have = ", ".join(str(name) for name in stage.get("effects") or []) or "the base model"
        tables.append({"stage": number, "have": have, "rows": rows, "reasons": any(row["why"] for row in rows)})
    return tables


def _remark(entry: Entry) -> str:
    """What is remarked on a candidate; nothing where both figures are predicted, as most are, which stands above the table."""
    why = str(entry.get("why") or "")
    return "" if why.startswith("predicted") else why


def _tiles(stages: Sequence[Entry], record: Entry) -> list[dict[str, str]]:
    if not stages:
        return []
    tiles = []
    for name in (*BASE, "inertia"):
        entry = parameters_of(stages[-1]).get(name)
        if entry is None or (name == "inertia" and not is_number(entry.get("stderr"))):  # the inertia only where it was fitted
            continue
        shown = parts(entry)
        # Degrees are what a person pictures, so they come first where there are any; radians stay beside them.
        (number, unit), *others = shown[::-1] or [("not determined", "")]
        rest = " ".join(others[0]) if others else str(entry.get("why") or "")
        label = LABELS.get(name) or str(entry.get("label") or name)
        tiles.append({"label": label, "value": number, "unit": unit, "rest": rest})
    last = stages[-1]
    if is_number(last.get("rms_over_noise")):
        held = last.get("heldout_rms_over_noise")
        beside = share(last, record).removeprefix(", ")
        other = f"held-out record: {short(held)}" if is_number(held) else "1.00 would be noise alone"
        if is_number(held):
            other += share(last, record, "heldout_nrmse")
        rest = f"{beside}; {other}" if beside else other
        error = short(last["rms_over_noise"])
        tiles.append({"label": "prediction error", "value": error, "unit": "× noise", "rest": rest})
    return tiles


def _scores(stage: Entry, record: Entry) -> list[tuple[str, str]]:
    of = f"share of the {measured(record)}"
    names = (
        ("rms_over_noise", "rms over noise"),
        ("nrmse", of),
        ("median_over_noise", "median window"),
        ("heldout_rms_over_noise", "held-out rms"),
        ("heldout_nrmse", f"held-out {of}"),
        ("heldout_median_over_noise", "held-out median"),
    )
    return [(label, _error(stage, key)) for key, label in names]


def _some_heldout(stages: Sequence[Entry]) -> bool:
    return any(is_number(stage.get("heldout_rms_over_noise")) for stage in stages)


def _errors(stage: Entry, record: Entry) -> list[tuple[str, str]]:
    """The error on the record and on the held-out one, each with its share of what was measured and the median window below."""
    pairs = []
    for before in ("", "heldout_"):
        told, median = share(stage, record, f"{before}nrmse").removeprefix(", "), stage.get(f"{before}median_over_noise")
        below = [*([told] if told else []), *([f"median window {short(median)}"] if is_number(median) else [])]
        pairs.append((short(stage.get(f"{before}rms_over_noise")), ", ".join(below)))
    return pairs


def _error(stage: Entry, key: str) -> str:
    value: Any = stage.get(key)
    return percent(value) if key.endswith("nrmse") and is_number(value) else short(value)


def _stage_heads(stages: Sequence[Entry]) -> list[str]:
    heads = []
    for name in BASE:
        units = [str(found[name].get("unit") or "") for found in map(parameters_of, stages) if name in found]
        heads.append(with_unit(LABELS[name], units[0] if units else ""))
    return heads


def _step(step: Any) -> str:
    """How far a parameter moved at a stage."""
    if not isinstance(step, Mapping):
        return ""
    percent, errors = step.get("percent"), step.get("stderrs")
    said = [f"{percent:+.2g} %"] if is_number(percent) else []
    if errors is not None and is_number(errors):
        said.append(f"{abs(errors):.2g} standard errors")
    return ", ".join(said)


def _moved(before: Entry | None, after: Entry) -> str:
    if before is None:
        return "new"
    old, new = before.get("value"), after.get("value")
    if old is None or new is None or not is_number(old) or not is_number(new) or old == 0.0:
        return UNKNOWN
    return f"{100.0 * (new - old) / abs(old):+.2g} %"
