"""What was found in many records, as result.json."""

from __future__ import annotations

from typing import Any

from ..many import Each
from ..many.rows import COMPLETE, FAILED, INCOMPLETE
from .result import SCHEMA


def many_json(found: Each, *, command_line: str = "", version: str = "") -> dict[str, Any]:
    """The whole result of ``fit --each`` and ``refine --each``.

    ``parameters`` tells of each parameter how it goes from record to record; ``rows`` are the records in the order given, each
    with a ``verdict`` and its ``parameters``, or ``why`` it has none.
    """
    return {
        "schema": SCHEMA,
        "command": found.command,
        "each": True,
        "command_line": command_line,
        "version": version,
        "records": len(found.rows),
        "counts": {verdict: found.count(verdict) for verdict in (COMPLETE, INCOMPLETE, FAILED)},
        "verdict_text": found.sentence() + ".",
        "parameters": {name: course.as_json() for name, course in found.courses.items()},
        "rows": list(found.rows),
    }
