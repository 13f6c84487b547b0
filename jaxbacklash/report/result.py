"""A fit as the machine-readable result of INTERFACE (result.json)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..causes import Cause
from ..fitting import Comparison, Estimate, Fit, Score
from ..fitting.result import doubt, verdict_text
from ..parameters import specs, unit_text, values
from ..records import Record
from ..regression.equation_error import Start
from ..second_opinion import cross_check as skeletons_beside

SCHEMA = 1


def finite(value: float | None) -> float | None:
    """A plain number, or None for one that is not finite."""
    return None if value is None or not np.isfinite(value) else float(value)


def about_record(record: Record) -> dict[str, Any]:
    """The entry ``record`` of every result."""
    return {
        "path": record.path,
        "samples": record.samples,
        "rate_hz": record.rate_hz,
        "channels": ["t", *record.channels],
        "kind": record.kind,
        "duration_s": record.samples * record.dt,
    }


def rms(score: Score) -> float:
    """Plain prediction error in the measured channel's unit (not whitened)."""
    return float(np.sqrt(np.mean((score.measured - score.predicted) ** 2)))


def errors(score: Score) -> dict[str, float | None]:
    """The errors on a record: in the unit of the measured channel, over the noise, and as a share of the channel."""
    return {
        "rms": finite(rms(score)),
        "rms_over_noise": finite(score.rms),
        "median_over_noise": finite(score.median),
        "nrmse": finite(score.nrmse),
    }


def heldout_errors(held: Score | None) -> dict[str, float | None]:
    """The same of a held-out record, None without one."""
    known = {} if held is None else errors(held)
    return {f"heldout_{name}": known.get(name) for name in ("rms_over_noise", "median_over_noise", "nrmse")}


def stage(fit: Fit, added: str | None = None) -> dict[str, Any]:
    """One entry of ``stages``: a model, how well it predicts, and its parameters."""
    return {
        "added": added,
        "effects": sorted(fit.system.effects),
        **errors(fit.score),
        **heldout_errors(fit.heldout),
        "parameters": {name: clean(estimate) for name, estimate in fit.parameters.items()},
        "intervals_hold": not doubt(fit),  # where not, each ci95 is what it would be if the model were right
        "candidates": [],
    }


def clean(estimate: Estimate) -> dict[str, Any]:
    """A parameter's entry without numbers that JSON cannot carry."""
    entry = estimate.as_json()
    entry["label"] = estimate.label or estimate.name
    for key in ("value", "stderr"):
        entry[key] = finite(entry[key])
    if entry["ci95"] is not None and not all(np.isfinite(entry["ci95"])):
        entry["ci95"] = None
    return entry


def cross_check(fit: Fit, start: Start | None = None) -> dict[str, Any]:
    """Other methods on the same samples, without simulation: skeletons by Hilbert transform and wavelet, and the regression of
    the equation of motion (``start``, by default the one that the fit began from)."""
    found = skeletons_beside(fit).as_json()
    regression = _equation_error(fit, fit.start if start is None else start)
    return found | ({} if regression is None else {"equation_error": regression})


def _equation_error(fit: Fit, start: Start | None) -> dict[str, Any] | None:
    if start is None:
        return None
    found: dict[str, Any] = {}
    agrees = True
    for name in ("backlash", "stiffness", "damping"):
        value = getattr(start, name)
        if value is None or name not in fit.parameters:
            continue
        estimate = fit.parameters[name]
        found[name] = {"value": finite(value), "unit": estimate.unit}
        if estimate.value is not None and name != "damping":
            agrees &= abs(value - estimate.value) <= 0.03 * abs(estimate.value)
    return found | {"agrees": bool(agrees), "tolerance": "3 % of play and stiffness"}


def as_json(
    fit: Fit, *, command: str = "fit", command_line: str = "", version: str = "", checked: dict[str, Any] | None = None,
    causes: Sequence[Cause] = (),
) -> dict[str, Any]:  # fmt: skip
    """The whole result of ``fit``; ``causes`` of misfit in the record are told beside it."""
    record = fit.records[0]
    result: dict[str, Any] = {
        "schema": SCHEMA,
        "command": command,
        "command_line": command_line,
        "version": version,
        "record": about_record(record),
        "noise": {record.observed_name: finite(fit.noise[0])},
        "per_inertia": fit.per_inertia,
        "inertia": {
            "value": float(fit.system.inertia),
            "unit": unit_text("kg m^2", translational=fit.translational, per_inertia=fit.per_inertia),
            "given": "inertia" not in fit.free,
        },
        "model": fit.model,
        "stages": [stage(fit)],
        "effects": sorted(fit.system.effects),
        "alternatives": [],
        "verdict": "complete" if fit.adequate and not causes else "incomplete",
        "verdict_text": verdict_text(fit, causes),
        "causes": [cause.as_json() for cause in causes],
        "intervals_note": doubt(fit),
        "cross_check": cross_check(fit) if checked is None else checked,
        "starts": {"tried": fit.tried, "agreeing": fit.agreeing},
        "windows_tied": fit.tied,
        "seconds": {key: round(value, 4) for key, value in fit.seconds.items()},
    }
    if fit.input_noise[0] > 0.0:
        result["noise"][record.input_name or "x"] = finite(fit.input_noise[0])
    if fit.noise_open and fit.noise_open[0]:
        result["noise_open"] = dict(fit.noise_open[0])
    if len(fit.records) > 1:
        result["records"] = [
            about_record(r) | {"noise": finite(n)} | errors(s) for r, n, s in zip(fit.records, fit.noise, fit.scores)
        ]
    return result


def comparison_json(found: Comparison, model: str, *, command_line: str = "", version: str = "") -> dict[str, Any]:
    """The whole result of ``compare``; one stage, whose parameters are the model file's."""
    record, described, present = found.record, specs(found.system), values(found.system)
    parameters = {
        name: {
            "value": finite(present[name]), "stderr": None, "ci95": None, "verdict": "given", "label": spec.label or name,
            "unit": unit_text(spec.unit, translational=found.translational),
        }
        for name, spec in described.items() if not spec.fixed
    }  # fmt: skip
    only = {
        "added": None, "effects": sorted(found.system.effects), **errors(found.score), **heldout_errors(None),
        "parameters": parameters, "candidates": [],
    }  # fmt: skip
    return {
        "schema": SCHEMA, "command": "compare", "command_line": command_line, "version": version, "model": model,
        "record": about_record(record), "noise": {record.observed_name: finite(found.noise)}, "stages": [only],
        "effects": sorted(found.system.effects), "alternatives": [],
        "verdict": "complete" if found.adequate else "incomplete", "verdict_text": found.sentence(),
    }  # fmt: skip
