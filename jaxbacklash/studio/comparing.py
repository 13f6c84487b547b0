"""Two models of the tree side by side: their errors, their parameters, and in how many windows which of them is nearer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..plot.style import format_value, short
from .tree import Model


@dataclass(frozen=True)
class Row:
    """A line of the table: what it is of, and the text for either model; an empty text where the model has no such thing."""

    what: str
    first: str
    second: str


def compared(first: Model, second: Model) -> list[Row]:
    """Two models line by line, errors first.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> tree = Tree()
    >>> one = tree.add(None, (), jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1))
    >>> two = tree.add(0, ("gravity",), jb.fit(record.between(0.0, 2.0), inertia=3.16, effects=["gravity"], starts=1))
    >>> [row.what for row in compared(one, two)][:3]
    ['error over the noise, all windows', 'error over the noise, median window', 'windows in which it is nearer']
    """
    rows = [
        Row("error over the noise, all windows", short(first.rms), short(second.rms)),
        Row("error over the noise, median window", short(first.fit.score.median), short(second.fit.score.median)),
    ]
    nearer = windows_nearer(first, second)
    if nearer is not None:
        rows.append(Row("windows in which it is nearer", str(nearer[0]), str(nearer[1])))
    if first.heldout_rms is not None or second.heldout_rms is not None:
        rows.append(Row("error over the noise, held-out record", short(first.heldout_rms), short(second.heldout_rms)))
    one, two = first.fit.parameters, second.fit.parameters
    for name in dict.fromkeys((*one, *two)):
        rows.append(Row(name, *(told(found.get(name)) for found in (one, two))))
    return rows


def windows_nearer(first: Model, second: Model) -> tuple[int, int] | None:
    """In how many windows either model is nearer to the record; None where they were not cut alike."""
    one, two = np.asarray(first.fit.score.window_rms), np.asarray(second.fit.score.window_rms)
    if one.shape != two.shape:
        return None
    return int(np.sum(one < two)), int(np.sum(two < one))


def told(estimate: object) -> str:
    """A parameter as it is printed: ``0.02618 ± 0.00002 rad``, or why there is no number."""
    if estimate is None:
        return ""
    value, stderr, unit = (getattr(estimate, name, None) for name in ("value", "stderr", "unit"))
    if value is None:
        return f"not found: {getattr(estimate, 'why', '') or 'the record does not tell'}"
    return format_value(value, stderr, unit)
