"""The time series behind the zoomable view, as compact JSON that can stand inside a page."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..plot.drawing import column
from ..plot.thinning import extremes

LIMIT = 20_000  # points; a browser draws so many without effort
EXACT = 22
TENS = np.array([float(10**k) for k in range(EXACT + 1)])
CHANNELS = ("measured", "model", "residual_over_noise")


def series_json(series: Mapping[str, Any], limit: int = LIMIT) -> str:
    """Encode a series for `zoom.js`.

    Parameters
    ----------
    series : ``t`` (N,) [s]; ``measured`` and ``model`` (N,) [unit]; ``residual_over_noise`` (N,) [1]; NaN is a break.
        Optional: ``window_starts`` (K,) [s], where the model's line breaks; ``label`` and ``unit`` of what was measured
    limit : points kept; the extremes of every channel and every break are among them

    Returns
    -------
    JSON in which no ``<``, ``>`` or ``&`` occurs, so that nothing in it can end a script element
    """
    t = column(series.get("t"))
    channels = {}
    for name in CHANNELS:
        values = column(series.get(name))
        channels[name] = values if values.size == t.size else np.full(t.size, np.nan)
    kept = extremes(list(channels.values()), limit)
    text = json.dumps(
        {
            "samples": int(t.size),
            "label": str(series.get("label") or "z"),
            "unit": str(series.get("unit") or ""),
            "t": _plain(t[kept], 9),
            "windows": _plain(column(series.get("window_starts")), 9),
            "measured": _plain(channels["measured"][kept], 7),
            "model": _plain(channels["model"][kept], 7),
            "residual": _plain(channels["residual_over_noise"][kept], 4),
        },
        separators=(",", ":"),
        allow_nan=False,
    )
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _plain(values: np.ndarray, digits: int) -> list[float | None]:
    """Numbers with so many significant digits, but not more than 22 decimals, the shortest that a reader turns into the same."""
    there = np.isfinite(values) & (values != 0.0)
    power = np.floor(np.log10(np.abs(values), out=np.zeros(values.shape), where=there))
    decimals = np.clip(digits - 1 - power, -EXACT, EXACT).astype(int)
    # Powers of ten up to the 22nd are exact, and so a quotient by one is the number nearest to its decimals.
    large, small = TENS[np.maximum(decimals, 0)], TENS[np.maximum(-decimals, 0)]
    rounded = np.rint(np.where(there, values, 0.0) * large / small) * small / large
    return [value if known else None for value, known in zip(rounded.tolist(), np.isfinite(values).tolist())]
