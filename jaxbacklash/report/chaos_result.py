"""What a series says about chaos, as the machine-readable result of INTERFACE."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..records import MeasuredSeries
from ..timeseries import ChaosReport
from ..timeseries.result import drift_words, tables_in_words, why_wide
from .result import SCHEMA, finite


def chaos_json(found: ChaosReport, source: MeasuredSeries, *, command_line: str = "", version: str = "") -> dict[str, Any]:
    """The whole result of ``chaos``; what could not be found is null with a "why" beside it."""
    dt = found.dt
    return {
        "schema": SCHEMA,
        "command": "chaos",
        "command_line": command_line,
        "version": version,
        "record": {
            "path": source.path, "samples": int(source.t.size), "rate_hz": 1.0 / source.dt,
            "duration_s": source.t.size * source.dt,
            "channels": ["t", *([source.drive_name] if source.drive_name else []), source.name], "channel": source.name,
        },
        "used": {"samples": int(found.series.size), "rate_hz": 1.0 / dt, "text": found.shortened},
        "drift": _drift(found),
        "delay_samples": found.delay.samples,
        "delay_s": found.delay.samples * dt,
        "delay_why": found.delay.why,
        "mean_period_s": found.period * dt,
        "theiler_samples": found.theiler,
        "dimension": _dimension(found),
        "noise_reduction": _noise_reduction(found),
        "correlation_dimension": _with_why(
            found.correlation.dimension, found.correlation.why, spread=finite(found.correlation.spread)
        ),
        "lyapunov": _lyapunov(found),
        "driven": _driven(found),
        "stretching": _stretching(found),
        "prediction_error": None if found.raw_exponent is None else finite(found.raw_exponent.error),
        "surrogates": {
            "kind": found.surrogates.kind, "count": found.surrogates.count, "p_value": found.surrogates.p_value,
            "statistic": "rms error of predictions one delay ahead, in standard deviations",
            "value": finite(found.surrogates.statistic), "of_surrogates": [finite(v) for v in found.surrogates.surrogates],
        },
        "zero_one": {"k": finite(found.walk.k), "samples": found.walk.samples, "stride": found.walk.stride},
        "seed": found.seed,
        "verdict": found.verdict.word,
        "verdict_text": found.verdict.text,
        "choices": [{"what": what, "text": text} for what, text in choices(found)],
    }  # fmt: skip


def choices(found: ChaosReport) -> list[tuple[str, str]]:
    """What was chosen, and why, for the table of a page."""
    dt, raw = found.dt, found.raw_dimension
    rows = [
        *([("used", found.shortened)] if found.shortened else []),
        *([("drift", found.drift.text)] if found.drift.text else []),
        ("delay", f"{found.delay.samples} samples, {found.delay.samples * dt:.4g} s: {found.delay.why}"),
        ("Theiler window", f"{found.theiler} samples: a swing takes {found.period:.4g}"),
        ("embedding dimension", f"{_words(raw.cao)} by Cao's E1, {_words(raw.false_neighbours)} by false nearest neighbours"),
    ]
    if found.raw_exponent is not None:
        maps = ", ".join(f"{one.dimension} with {one.neighbours}" for one in (found.exponent or found.raw_exponent).maps)
        rows.append(("local maps", f"those that predict best out of sample; coordinates with neighbours: {maps}"))
    if found.driven is not None and found.driven.value is not None:
        what = f"the acceleration over position and velocity, read as {tables_in_words(found.driven.used)}"
        rows.append(("law of motion", f"{what}: those that predict best on stretches they were not fitted to"))
        if found.driven.drift:
            rows.append(("the law drifts", f"{drift_words(found.driven.drift)}; a law that may drift predicts clearly better"))
    if found.cleaned is not None:
        used = "the exponent is from the cleaned series" if found.uses_cleaned else "the exponent is from the series as measured"
        used = "the exponent is not from it" if found.conditional else used
        gain = "cannot be told" if found.cleaned.gain_db is None else f"is about {found.cleaned.gain_db:.1f} dB"
        size = f"{100 * found.cleaned.noise:.2g} % of the signal's spread"
        done = found.cleaned.why_untouched or f"the gain of taking it off {gain}"
        rows.append(("noise reduction", f"noise of {size}; {done}; {used}"))
    p = found.surrogates
    how = f"{p.count} of kind {p.kind.upper()} over {p.samples} samples with matched ends, seed {found.seed}"
    rows.append(("surrogates", how))
    return rows


def _words(value: int | None) -> str:
    return "none found" if value is None else str(value)


def _with_why(value: Any, why: str | None, **more: Any) -> dict[str, Any]:
    entry = {"value": value if isinstance(value, int) else finite(value), **more}
    return entry if entry["value"] is not None else {**entry, "why": why or "it could not be found"}


def _dimension(found: ChaosReport) -> dict[str, Any]:
    raw, cleaned = found.raw_dimension, found.cleaned_dimension
    entry: dict[str, Any] = {
        "raw": raw.cao,
        "cleaned": None if cleaned is None else cleaned.cao,
        "rule": "Cao's E1",
        "false_neighbours": {
            "raw": raw.false_neighbours, "cleaned": None if cleaned is None else cleaned.false_neighbours,
        },
    }  # fmt: skip
    if raw.cao is None or entry["cleaned"] is None:
        missing = "no noise was taken off" if cleaned is None and raw.cao is not None else "E1 does not settle"
        entry["why"] = missing
    return entry


def _noise_reduction(found: ChaosReport) -> dict[str, Any]:
    if found.cleaned is None:
        return {"method": None, "why": "it was not asked for", "used": False}
    cleaned = found.cleaned
    return {
        "method": cleaned.method, "window": cleaned.window, "delay_samples": cleaned.delay, "directions_kept": cleaned.kept,
        "noise": finite(cleaned.noise * found.deviation), "noise_share": finite(cleaned.noise),
        "gain_db": finite(cleaned.gain_db),
        "removed_rms": finite(cleaned.removed * found.deviation), "samples": int(cleaned.series.size), "used": found.uses_cleaned,
    }  # fmt: skip


def _lyapunov(found: ChaosReport) -> dict[str, Any]:
    value, interval = found.lyapunov, found.interval
    entry: dict[str, Any] = {
        "value": finite(value),
        "widened": why_wide(found),
        "ci95": None if interval is None else [finite(end) for end in interval],
        "unit": "1/s",
        "per_period": None,
        "bit_per_s": None if value is None else value / math.log(2.0),
        "conditional_on_drive": found.conditional,
        "method": "tangent of the measured law of motion under the measured drive" if found.conditional
        else "local maps (Sano and Sawada, 1985)",
    }  # fmt: skip
    if value is None:
        return entry | {"why": found.why_no_number}
    if found.drive_period is None:
        return entry | {"per_period_why": found.why_no_period}
    return entry | {"per_period": value * found.drive_period, "drive_period_s": found.drive_period}


def _drift(found: ChaosReport) -> dict[str, Any]:
    """What changes slowly in the series, and what was done about it."""
    one = found.drift
    return {
        "kind": one.kind, "removed": one.removed, "degree": one.degree if one.removed else None, "change": finite(one.change),
        "at_sample": one.at, "size_factor": finite(one.factor), "dickey_fuller": finite(one.unit_root),
        "dickey_fuller_1_percent": finite(one.bound), "text": one.text,
    }  # fmt: skip


def _driven(found: ChaosReport) -> dict[str, Any]:
    """Growth of small differences under the measured drive."""
    one = found.driven
    if one is None:
        return {"value": None, "why": found.why_no_period, "unit": "1/s"}
    if one.value is None or one.interval is None or one.second is None:
        return {"value": None, "why": one.why, "unit": "1/s", "prediction_error": finite(one.error)}
    return {
        "value": one.value / found.dt, "ci95": [end / found.dt for end in one.interval], "unit": "1/s",
        "second": one.second / found.dt, "two_motions": one.word, "prediction_error": finite(one.error),
        "samples": one.samples, "first_sample": one.first, "drift": one.drift,
        "laws": [
            {"cells": cells, "friction": friction, "prediction_error": finite(error), "value": value / found.dt}
            for (cells, friction, error), value in zip(one.used, one.values)
        ],
    }  # fmt: skip


def _stretching(found: ChaosReport) -> dict[str, Any]:
    curve, dt = found.curve, found.dt
    if curve.region is None or curve.slope is None or curve.interval is None:
        return {"value": None, "why": "no straight part rises by a factor of two below saturation", "unit": "1/s"}
    ends = curve.lags[[curve.region.first, curve.region.last]] * dt
    return {
        "value": curve.slope / dt, "ci95": [end / dt for end in curve.interval], "unit": "1/s",
        "rosenstein": finite(None if curve.rosenstein_slope is None else curve.rosenstein_slope / dt),
        "region_s": [float(end) for end in ends], "rise": float(np.ptp(curve.smooth[curve.region.first : curve.region.last + 1])),
    }  # fmt: skip
