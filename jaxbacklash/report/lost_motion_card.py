"""The card of a slow record's play."""

from __future__ import annotations

from ..plot.style import format_interval, format_parts
from ..quasistatic import LostMotion
from ..quasistatic.result import LABELS, MARKS, WAYS, verdict
from .card import Card, Picture, card_of, grid, name_of


@card_of.register
def of_lost_motion(found: LostMotion) -> Card:
    """Play and what else shows, what the reading rests on, and z at both edges."""
    rows = []
    for name, value in found.parameters.items():
        shown = "\n".join(f"{number} {unit}".rstrip() for number, unit in format_parts(value.value, value.stderr, value.unit))
        interval = format_interval(None if value.ci95 is None else list(value.ci95), value.stderr, value.unit)
        rows.append([LABELS[name], shown or f"none: {value.why}", interval])
    conditions = [[one.name, MARKS[one.holds].strip().lower(), one.found] for one in found.conditions]
    title = f"Play of {name_of(found.record.path)}: {WAYS[found.way]}"
    return Card(
        title, (verdict(found), *found.notes),
        (grid(["parameter", "value ± standard error", "95 % interval"], rows), grid(["rests on", "holds", "found"], conditions)),
        (Picture("lost_motion", (found,)),),
    )  # fmt: skip
