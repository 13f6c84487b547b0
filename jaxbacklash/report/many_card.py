"""The card of many records."""

from __future__ import annotations

from typing import Any

from ..many import Each
from ..many.table import OF_EACH
from ..plot.style import format_parts
from .card import Card, Picture, card_of, grid

ROWS = 20
"""Records that are listed."""


@card_of.register
def of_each(found: Each) -> Card:
    """What changed, the first records, and the play over all."""
    names = found.names[:4]
    rows = []
    for number, row in enumerate(found.rows[:ROWS], 1):
        cells = [_cell(row["parameters"].get(name)) for name in names]
        rows.append([str(number), row["record"] or "", row["verdict"], *cells])
    more = f"the first {ROWS} of {len(found.rows)} records" if len(found.rows) > ROWS else ""
    drawn = [name for name in found.names if found.courses[name].values.size][:1]
    return Card(
        f"{found.command} of {len(found.rows)} records", (found.sentence(), *(str(one) for one in found.courses.values())),
        (grid(["", "record", "verdict", *names], rows, title=more),), tuple(Picture("course", (found, name)) for name in drawn),
    )  # fmt: skip


def _cell(entry: dict[str, Any] | None) -> str:
    if entry is None:
        return ""
    told = {name: entry.get(name) for name in OF_EACH}
    return "\n".join(
        f"{number} {unit}".rstrip() for number, unit in format_parts(told["value"], told["stderr"], str(told["unit"]))
    )
