"""A fitted parameter as a person reads it."""

from __future__ import annotations

import numpy as np

from .estimates import Estimate


def number(value: float, stderr: float | None) -> str:
    """A value with as many digits as its standard error allows (two of the error)."""
    if not stderr or not np.isfinite(stderr):
        return f"{value:.6g}"
    decimals = int(1 - np.floor(np.log10(stderr)))
    if decimals >= 0 and abs(value) < 1e7:
        return f"{value:.{decimals}f}"
    return f"{value:.6g}"


def line(estimate: Estimate, note: str = "") -> str:
    """One parameter in words: value and standard error, or why there is none; a ``note`` stands beside an error."""
    name = f"  {estimate.label:<24}"
    if estimate.value is None:
        return f"{name} {estimate.verdict}: {estimate.why}"
    value = number(estimate.value, estimate.stderr)
    unit = "" if estimate.unit == "1" else estimate.unit
    if estimate.stderr is None:
        return f"{name} {value} {unit}"
    share = f"{100 * estimate.stderr / abs(estimate.value):.2g} %" if estimate.value else ""
    text = f"{name} {value} +- {estimate.stderr:.2g} {unit}" + (f" ({share})" if share else "")
    if estimate.unit == "rad" and abs(estimate.value) < 1.0:
        text += f" = {np.degrees(estimate.value):.4g} deg"
    return f"{text}  [{note}]" if note else text
