"""Some of many records, worked on by one process: its rows come one by one, in the order in which they are done."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from ..lockstep import in_lockstep
from .one import row_of, warnings_noted
from .rows import Row
from .wanted import Source, Wanted

Item = tuple[int, Source]
"""A record with its number."""


def rows_of(wanted: Wanted, items: Sequence[Item]) -> Iterator[tuple[int, Row]]:
    """The rows of some records, each with its record's number."""
    with warnings_noted():
        if wanted.command == "refine":  # each tries other models, whose programs would not be the same
            yield from ((number, row_of(wanted, source)) for number, source in items)
            return
        yield from in_lockstep([(number, partial(row_of, wanted, source)) for number, source in items])


def begin(wanted: Wanted) -> None:
    """What a process does before its first record, if it has not done it for the same before."""
    if wanted.before is not None and wanted.before not in _begun:
        wanted.before()
        _begun.append(wanted.before)


_begun: list[object] = []
