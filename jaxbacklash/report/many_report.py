"""The page of many records: what changed, each parameter over the records, and which have no result."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .. import plot
from ..many import Each
from ..many.courses import Course
from ..many.rows import FAILED
from ..plot.drawing import svg_of
from .html import Panel, write_report

PANELS = 12
"""Parameters that are drawn at most, the joint's own first."""
NAMED = 10
"""Records without a result that are named on the page."""
BEGUN_WITH = ("backlash", "stiffness", "damping")


def many_report(found: Each, result: dict[str, Any], path: Path) -> None:
    """Write the page of ``fit --each`` or ``refine --each``."""
    own = [name for name in BEGUN_WITH if name in found.courses]
    courses = [found.courses[name] for name in [*own, *(name for name in found.courses if name not in own)]]
    drawn = [one for one in courses if one.values.size][:PANELS]
    panels = [
        Panel(f"{one.word[0].upper()}{one.word[1:]}", str(one), svg_of(plot.course, found, one.name), one.name, _detail(one))
        for one in drawn
    ]
    told = {
        "command": f"{found.command} --each", "command_line": result["command_line"], "version": result["version"],
        "record": {"path": f"{len(found.rows)} records"}, "verdict_text": result["verdict_text"],
        "findings": [*(text for one in courses for text in _news(one)), *_failures(found)],
    }  # fmt: skip
    write_report(path, told, panels)


def _news(one: Course) -> list[str]:
    """What is to be told first: a change, a trend, or a joint that differs."""
    if one.differ or one.changed or (one.trend is not None and one.trend.claimed and not one.joints):
        return one.sentences()[1:2]
    return []


def _detail(one: Course) -> str | None:
    said = []
    if one.change is not None and not one.joints:
        said.append(
            "For every place at which the records may be parted, the weighted means of both sides are compared; how large the "
            "largest difference is by chance is found by putting the records in random order. A change is claimed at p = 0.01."
        )
    if one.joints or one.outliers:
        said.append(
            "Whatever differs from the rest by more than their scatter is found by Rosner's test, which names one where none "
            "differs once in a hundred times."
        )
    return " ".join(said) or None


def _failures(found: Each) -> list[str]:
    failed = [(k, row) for k, row in enumerate(found.rows, 1) if row["verdict"] == FAILED]
    said = [f"Record {k} has no result: {row['why']}" for k, row in failed[:NAMED]]
    return said + ([f"{len(failed) - NAMED} more records have no result, see table.csv."] if len(failed) > NAMED else [])
