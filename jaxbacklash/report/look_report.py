"""The page of `look`: what a file seems to be, the command to go on with, and a picture of each column."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..plot.columns import column_over_rows
from ..plot.drawing import svg_of
from ..records.description import Description
from .html import Panel, write_report

MOST_PICTURES = 24
"""Columns that are drawn; a file of hundreds of channels is listed whole in result.json."""
UNSTATED = "(the file states no unit)"


def look_report(found: Description, result: dict[str, Any], path: Path) -> None:
    """Write the page of ``look``."""
    page = {
        **result,
        "command": "look",
        "verdict_text": f"It seems to be {found.seems}. {_next(found)}",
        "findings": [*found.questions, *found.notes],
        "record": {"path": found.path, "samples": found.table.rows, "rate_hz": found.rate_hz},
    }
    write_report(path, page, panels(found))


def _next(found: Description) -> str:
    if not found.command:
        return found.obstacle
    return f"{'Next' if found.ready else 'Once what is asked below is settled'}: {found.command}"


def panels(found: Description) -> list[Panel]:
    """One picture a column, those with a role first."""
    ordered = sorted(found.columns, key=lambda column: (not column.role, column.number))
    begins = found.table.first_line or 1
    shown: list[Panel] = []
    for facts in ordered[:MOST_PICTURES]:
        role = f", taken as {facts.role}" if facts.role else ""
        span = "" if facts.low is None else f"{facts.low:.6g} to {facts.high:.6g} {facts.unit or UNSTATED}"
        sentence = ". ".join(text.rstrip(".") for text in facts.findings) or span
        if facts.column.values.dtype.kind == "f":
            picture = svg_of(column_over_rows, facts, begins)
            shown.append(Panel(f"#{facts.number} {facts.name}{role}", f"{sentence}.", picture, f"column-{facts.number}"))
    return shown
