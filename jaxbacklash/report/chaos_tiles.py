"""The numbers at the head of a chaos page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..plot.style import is_number, short


def chaos_tiles(result: Mapping[str, Any]) -> list[dict[str, str]]:
    """Exponent, growth per drive period, dimensions and the surrogates' chance, from result.json of ``chaos``."""
    found = result["lyapunov"]
    tiles = []
    if is_number(found.get("value")):
        ends = found.get("ci95") or []
        rest = f"{_three(ends[0])} to {_three(ends[1])}; {_three(found.get('bit_per_s'))} bit/s" if len(ends) == 2 else ""
        label = "exponent under this drive" if found.get("conditional_on_drive") else "largest Lyapunov exponent"
        tiles.append({"label": label, "value": _three(found["value"]), "unit": "1/s", "rest": rest})
    else:
        tiles.append({"label": "largest Lyapunov exponent", "value": "none", "unit": "", "rest": str(found.get("why") or "")})
    if is_number(found.get("per_period")):
        rest = f"a period is {short(found.get('drive_period_s'), 4)} s"
        tiles.append({"label": "per drive period", "value": short(found["per_period"]), "unit": "", "rest": rest})
    dimension = result.get("dimension") or {}
    cleaned = dimension.get("cleaned")
    tiles.append(
        {
            "label": "embedding dimension",
            "value": str(dimension.get("raw") or "–"),
            "unit": "",
            "rest": f"{cleaned} with noise taken off" if cleaned else str(dimension.get("why") or ""),
        }
    )
    correlation = result.get("correlation_dimension") or {}
    if is_number(correlation.get("value")):
        rest = f"± {short(correlation.get('spread'), 2)}"
        tiles.append({"label": "correlation dimension", "value": short(correlation["value"]), "unit": "", "rest": rest})
    tested = result.get("surrogates") or {}
    if is_number(tested.get("p_value")):
        rest = f"against {tested.get('count')} {str(tested.get('kind')).upper()} surrogates"
        tiles.append({"label": "chance of linear noise", "value": short(tested["p_value"]), "unit": "", "rest": rest})
    return tiles


def _three(value: Any) -> str:
    """Three digits, also of a number whose whole part has more."""
    return short(float(f"{value:.3g}")) if is_number(value) else short(value)


def chosen(result: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What was chosen and why, as facts; nothing for other commands."""
    return [(str(entry["what"]), str(entry["text"])) for entry in result.get("choices") or []]
