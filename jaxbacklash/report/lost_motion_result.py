"""A slow record's play as the machine-readable result (result.json)."""

from __future__ import annotations

from typing import Any

from ..quasistatic import LostMotion
from ..quasistatic.result import LABELS, verdict
from .result import SCHEMA, about_record, finite


def lost_motion_json(found: LostMotion, *, command_line: str = "", version: str = "") -> dict[str, Any]:
    """The whole result of ``lost-motion``: ``backlash`` and ``lost_motion``, and all that is told among
    ``parameters``, null with a ``why``."""
    result: dict[str, Any] = {
        "schema": SCHEMA,
        "command": "lost-motion",
        "command_line": command_line,
        "version": version,
        "record": about_record(found.record),
        "way": found.way,
        "backlash": found.parameters["backlash"].as_json(),
        "lost_motion": found.parameters["lost_motion"].as_json(),
        "parameters": {name: value.as_json() | {"label": LABELS[name]} for name, value in found.parameters.items()},
        "includes_wind_up": found.includes_wind_up,
        "passes": found.passes,
        "noise": {} if found.noise is None else {"z": finite(found.noise)},
        "conditions": [
            {"name": one.name, "holds": one.holds, "found": one.found}
            | ({"why": one.why, "way_out": one.way_out} if one.why else {})
            for one in found.conditions
        ],
        "transmission_error": {
            "peak_to_peak": finite(found.peak_to_peak) if found.applies else None,
            "waves": [
                {"turn": one.turn, "order": one.order, "amplitude": finite(one.amplitude), "stderr": finite(one.stderr)}
                for one in found.transmission_error if found.applies
            ],
            "unit": found.unit,
        },
        "verdict": "read" if found.applies else "not shown",
        "verdict_text": verdict(found),
        "findings": list(found.notes),
    }  # fmt: skip
    around = found.over_angle
    if around is not None and found.applies:
        result["over_angle"] = {
            "angle": around.angle.tolist(), "lost_motion": around.width.tolist(), "stderr": around.stderr.tolist(),
            "unit": found.unit,
        }  # fmt: skip
    return result
