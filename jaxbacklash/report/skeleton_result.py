"""Skeletons as the machine-readable result of INTERFACE (result.json)."""

from __future__ import annotations

from typing import Any

from ..skeletons import Skeletons
from ..skeletons.result import verdict
from .result import SCHEMA, about_record, finite


def skeletons_json(found: Skeletons, *, command_line: str = "", version: str = "") -> dict[str, Any]:
    """The whole result of ``skeleton``: a method's entry holds its parameters, a null value with its ``why``."""
    result: dict[str, Any] = {
        "schema": SCHEMA,
        "command": "skeleton",
        "command_line": command_line,
        "version": version,
        "record": about_record(found.record),
        "noise": {name: finite(level) for name, level in found.noise.items()},
        "per_inertia": found.per_inertia,
    }
    if found.inertia is not None and not found.per_inertia:
        unit = "kg" if found.translational else "kg m^2"
        result["inertia"] = {"value": float(found.inertia), "unit": unit, "given": True}
    for method in found.methods:
        result[method.method] = {name: value.as_json() for name, value in method.parameters.items()}
    result["masked_fraction"] = float(found.masked_fraction)
    result["warnings"] = list(found.warnings)
    result["curves"] = {method.method: _curves(found, number) for number, method in enumerate(found.methods)}
    result["verdict_text"] = verdict(found)
    return result


def _curves(found: Skeletons, number: int) -> dict[str, Any]:
    """Backbone, damping and restoring force in bins of amplitude, with standard errors."""
    method = found.methods[number]
    curves = {name: method.curve(name) for name in ("stiffness", "damping", "restoring_force", "damping_force")}
    return {
        "amplitude": [float(a) for a in curves["stiffness"].amplitude],
        **{
            name: {"mean": [float(v) for v in curve.mean], "stderr": [float(v) for v in curve.stderr]}
            for name, curve in curves.items()
        },
        "units": "modal: stiffness omega_0^2 in 1/s^2, damping h_0 in 1/s, forces per unit inertia",
    }
