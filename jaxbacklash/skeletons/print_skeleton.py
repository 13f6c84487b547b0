"""Skeletons as a person reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .result import Skeletons, Value

LABELS = {"backlash": "total play b", "stiffness": "contact stiffness k", "damping": "viscous damping c", "inertia": "inertia J"}
NAMES = {"hilbert": "Hilbert transform", "wavelet": "wavelet ridge"}


def text(found: Skeletons) -> str:
    """The whole report."""
    unit = "m" if found.translational else "rad"
    lines = [found.record.summary()]
    lines += [f"  noise of {name} {level:.3g} {unit}" for name, level in found.noise.items()]
    for method in found.methods:
        lines.append(f"{NAMES[method.method]}: {100.0 * (1.0 - method.masked_fraction):.0f} % of the record counts")
        lines += [line(name, value) for name, value in method.parameters.items()]
    if found.per_inertia:
        lines.append("no inertia was given: stiffness and damping are per unit inertia")
    lines += [f"note: {sentence}" for sentence in found.warnings]
    lines.append(verdict(found))
    return "\n".join(lines)


def line(name: str, value: Value) -> str:
    """One parameter in words."""
    label = f"  {LABELS[name]:<22}"
    if value.value is None or value.stderr is None:
        return f"{label} none: {value.why}"
    shown = f"{label} {value.value:.6g} +- {value.stderr:.2g} {value.unit}"
    if value.unit == "rad":
        shown += f" = {np.degrees(value.value):.4g} deg"
    return shown


def verdict(found: Skeletons) -> str:
    """One sentence: what the two methods say together."""
    both = [m.parameters["backlash"] for m in found.methods]
    told = [v for v in both if v.value is not None]
    if not told:
        whys = list(dict.fromkeys(v.why for v in both))
        return f"No play can be told from this record's skeleton: {'; '.join(whys)}."
    if len(told) == 1:
        name = NAMES["hilbert" if both[0].value is not None else "wavelet"]
        return f"Only the {name} tells the play, {_play(told[0])}."
    a, b = both
    spread = float(np.hypot(a.stderr or 0.0, b.stderr or 0.0))
    apart = abs((a.value or 0.0) - (b.value or 0.0)) / max(spread, 1e-300)
    if apart < 3.0:
        best = a if (a.stderr or 0.0) < (b.stderr or 0.0) else b
        doubt = any("was left out" in sentence for sentence in found.warnings)
        but = ", but both left out the same torque, see the notes: its error allows for that" if doubt else ""
        return f"Both methods agree on a total play of {_play(best)}{but}."
    return (
        f"The methods differ by {apart:.1f} of their standard errors on the play ({_play(a)} and {_play(b)}): "
        "trust neither further than their difference."
    )


def _play(value: Value) -> str:
    assert value.value is not None
    degrees = f" ({np.degrees(value.value):.4g} deg)" if value.unit == "rad" else ""
    return f"{value.value:.5g} {value.unit}{degrees}"
