"""Programs that the last run of a command asked for, read and linked while this run's libraries load.

XLA needs a second to read the programs of `refine` from its cache, and does it without Python, which is busy importing
meanwhile.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path

import jax

from . import compiled

SUFFIX = ".used"


@contextlib.contextmanager
def reading_ahead(command: str, folder: Path | None) -> Iterator[None]:
    """Within it, what the last run of ``command`` used is being read; at its end, what this run used is written down.

    Parameters
    ----------
    command : the name under which runs are alike
    folder : the cache of compiled programs; None or a missing one: nothing is read ahead
    """
    if folder is None or not (folder / "programs").is_dir():
        yield
        return
    notes, ended = folder / "programs" / f"{command}{SUFFIX}", threading.Event()
    for name in _names(notes):
        compiled.ahead[name] = Future()
    reader = threading.Thread(target=_read, args=(folder / "programs", list(compiled.ahead), ended))
    reader.start()
    try:
        yield
    finally:
        ended.set()  # a thread that is left inside XLA while Python goes takes the process with it
        reader.join()
        compiled.ahead.clear()
        # What the main thread waits for comes first.
        if asked := [*compiled.used, *compiled.used_aside]:
            _write(notes, asked)


def _read(folder: Path, names: list[str], ended: threading.Event) -> None:
    """Make one program after the other ready to be called, in the order in which they were used."""
    for name in names:
        found = None
        if not ended.is_set():
            with contextlib.suppress(Exception):  # missing, half written, of another making: the one who needs it makes it anew
                text, _ = pickle.loads((folder / name).read_bytes())
                exported = jax.export.deserialize(text)
                call = compiled.caller(exported)
                compiled.link(exported, call)
                found = exported, call
        compiled.ahead[name].set_result(found)


def _names(notes: Path) -> list[str]:
    try:
        return list(dict.fromkeys(notes.read_text(encoding="utf-8").split()))
    except (OSError, UnicodeDecodeError):
        return []


def _write(notes: Path, names: list[str]) -> None:
    text = "\n".join(dict.fromkeys(names)) + "\n"
    with contextlib.suppress(OSError):  # a full disk or a read-only home costs time, nothing else
        own = notes.with_name(f"{notes.name}.{os.getpid()}")
        own.write_text(text, encoding="utf-8")
        os.replace(own, notes)
