"""What is done with one record of many: read, fit or refine, and told as a row; whatever goes wrong is told as one too."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..criticism.causes_first import causes_first, told
from ..criticism.refine import refine
from ..fitting.fit import fit
from ..records import Record
from .rows import Row, row_of_failure, row_of_fit, row_of_refinement
from .wanted import Source, Wanted, path_of

_own = threading.local()


def row_of(wanted: Wanted, source: Source) -> Row:
    """The row of one record."""
    notes: list[str] = []
    _own.notes = notes
    try:
        record = source if isinstance(source, Record) else wanted.read(Path(source))
        row = _fitted(wanted, record, notes) if wanted.command == "fit" else _refined(wanted, record, notes)
        return row | {"record": path_of(source)}
    except Exception as error:  # a broken record stops nothing: whatever it is, it is one line in the table
        return row_of_failure(source, error, notes)
    finally:
        _own.notes = None


def _fitted(wanted: Wanted, record: Record, notes: list[str]) -> Row:
    found = fit(
        record, model=wanted.model, inertia=wanted.inertia, effects=wanted.effects, system=wanted.system,
        heldout=wanted.heldout, window=wanted.window, starts=wanted.starts, spare_starts=True, seed=wanted.seed,
        translational=wanted.translational,
    )  # fmt: skip
    return row_of_fit(found, notes)


def _refined(wanted: Wanted, record: Record, notes: list[str]) -> Row:
    how: dict[str, Any] = {
        "heldout": wanted.heldout, "model": wanted.model, "inertia": wanted.inertia, "system": wanted.system,
        "window": wanted.window, "translational": wanted.translational, "seed": wanted.seed,
    }  # fmt: skip
    early, causes = causes_first(record, **how)
    return row_of_refinement(early or told(refine(record, **how), causes), notes)


@contextmanager
def warnings_noted() -> Iterator[None]:
    """Within it a warning is a note in the row of the record that it is of, not a line among ten thousand."""

    def note(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        notes = getattr(_own, "notes", None)
        if notes is not None and issubclass(category, UserWarning) and (text := str(message)) not in notes:
            notes.append(text)

    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.showwarning = note
        yield
