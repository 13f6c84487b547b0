"""Many records, each fitted or refined by itself: `fit_each` and `refine_each`."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..fitting.search import silent
from ..mechanics import AbstractEffect
from ..precision import require_double_precision
from ..records import Record, read_record
from ..system import System
from .chunk import Item
from .cluster import by_cluster
from .kept import KeptRows
from .table import Each
from .wanted import Source, Wanted, keys_of, path_of
from .workers import Answer, by_processes, here, portable

TOGETHER = 32
"""Records that a process is given at a time."""
Sources = Sequence[Record | str | os.PathLike[str]]


def fit_each(
    records: Sources,
    *,
    model: str = "joint",
    inertia: float | None = None,
    effects: Sequence[AbstractEffect | str] = (),
    system: System | None = None,
    heldout: Record | None = None,
    window: float | None = None,
    starts: int = 4,
    seed: int = 0,
    translational: bool = False,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    client: Any = None,
    read: Callable[[Any], Record] = read_record,
    before: Callable[[], object] | None = None,
    progress: Callable[[str, float], None] = silent,
) -> Each:
    """Fit each of many records by itself, as `fit` does: one joint over months, or a fleet of joints.

    Parameters
    ----------
    records : records or files, in the order in which they were taken
    model, inertia, effects, system, heldout, window, seed, translational : as in `fit`, the same for all; ``heldout`` is
        predicted by the fit of each
    starts : how many starting points are tried where the first one does not lead to a motion that misses by noise alone
    folder : where finished rows are kept: a run that is stopped goes on there with the same result, and records that are added
        later cost only themselves. None: in memory
    workers : processes of this machine, one a core by default; 0: this process alone, one record after another
    client : a dask.distributed client whose workers do the work instead
    read : makes a record of a file
    before : called once in each process, such as what makes a user's own laws known
    progress : told in words and by the share of the work how far it is

    Returns
    -------
    `Each`: prints itself; a row a record, ``to_dataframe()``, ``write(path)`` as CSV or Parquet, ``changes``, ``trends`` and
        ``outliers`` of its parameters. A record that cannot be fitted is a row that says why.

    Raises
    ------
    BadInput
        There is no record, or the folder cannot be written.
    RuntimeError
        JAX is in single precision.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> each = jb.fit_each([record.between(0.0, 2.0), heldout.between(0.0, 2.0)], inertia=3.16, workers=0, starts=1)
    >>> len(each.rows), each.unit("backlash")
    (2, 'rad')
    """
    wanted = Wanted("fit", model, inertia, tuple(effects), system, heldout, window, starts, seed, translational, read, before)
    return _each(wanted, records, folder, workers, client, progress)


def refine_each(
    records: Sources,
    *,
    model: str = "joint",
    inertia: float | None = None,
    system: System | None = None,
    heldout: Record | None = None,
    window: float | None = None,
    seed: int = 0,
    translational: bool = False,
    folder: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    client: Any = None,
    read: Callable[[Any], Record] = read_record,
    before: Callable[[], object] | None = None,
    progress: Callable[[str, float], None] = silent,
) -> Each:
    """Refine each of many records by itself, as `refine` does: which effects does each need beyond the base model?

    The parameters are those of `fit_each` and `refine`, and so is what is returned and raised; the row of a record has its
    ``effects``, and its parameters are those of the model kept.

    Examples
    --------
    >>> each = jb.refine_each(jb.demo_records(), inertia=3.16, workers=1)
    >>> [row["effects"] for row in each.rows]
    [['gravity'], ['gravity']]
    """
    wanted = Wanted("refine", model, inertia, (), system, heldout, window, 0, seed, translational, read, before)
    return _each(wanted, records, folder, workers, client, progress)


def _each(
    wanted: Wanted, records: Sources, folder: str | os.PathLike[str] | None, workers: int | None, client: Any,
    progress: Callable[[str, float], None],
) -> Each:  # fmt: skip
    require_double_precision(f"{wanted.command}_each")
    if isinstance(records, str | os.PathLike | Record):
        raise BadInput("records: found one, wanted a list of many")
    sources: list[Source] = [one if isinstance(one, Record) else Path(one) for one in records]
    if not sources:
        raise BadInput("records: found none, wanted one or more")
    progress("looking at what is done already", 0.0)
    keys = keys_of(wanted, sources)
    place = None if folder is None else Path(folder)
    if place is not None:
        place.mkdir(parents=True, exist_ok=True)
    with KeptRows(place, keys) as kept:
        # Of two records alike one is worked on.
        first = {key: number for number, key in reversed(list(enumerate(keys))) if key not in kept.found}
        items: list[Item] = sorted((number, sources[number]) for number in first.values()) if first else []
        tell = _Pace(progress, len(keys), len(items), wanted.command)
        for number, row in _answers(wanted, items, workers, client):
            kept.put(keys[number], row)
            tell.one_more()
        rows = [kept.found[key] | {"record": path_of(source)} for key, source in zip(keys, sources)]
    return Each(wanted.command, tuple(rows), wanted.translational)


def _answers(wanted: Wanted, items: list[Item], workers: int | None, client: Any) -> Iterator[Answer]:
    if client is not None:
        return by_cluster(wanted, chunks(items, TOGETHER), client)
    if workers == 0 or not portable(wanted):
        return here(wanted, [items])
    # Near the end nobody waits for one who has much left.
    from ..program import cores

    crew = workers or cores()
    return by_processes(wanted, chunks(items, max(1, min(TOGETHER, -(-len(items) // crew)))), workers)


def chunks(items: list[Item], size: int) -> list[list[Item]]:
    """Records, so many at a time."""
    return [items[k : k + size] for k in range(0, len(items), size)]


class _Pace:
    """Tells how many records are done, and how long the rest will take."""

    def __init__(self, progress: Callable[[str, float], None], count: int, missing: int, command: str) -> None:
        self._progress, self._count, self._missing, self._left = progress, count, missing, missing
        self._doing = "fitting" if command == "fit" else "refining"
        self._begun = time.monotonic()
        if missing < count:
            progress(f"{self._doing}, {count - missing} of {count} records were done already", (count - missing) / count)

    def one_more(self) -> None:
        self._left -= 1
        each = (time.monotonic() - self._begun) / (self._missing - self._left)
        done = self._count - self._left
        self._progress(f"{self._doing}, {done} of {self._count} records, {each * self._left:.0f} s left", done / self._count)
