"""Programs that the last run of a command asked for, read while this run's libraries load.

XLA needs a second to read the programs of `refine`, and does it without Python, which is busy importing meanwhile.
"""

from __future__ import annotations

import contextlib
import re
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path

from jax.stages import Compiled

from . import program_file
from .private_files import is_private_folder, read_private
from .whole_file import write_whole

SUFFIX = ".used"
NAME = re.compile(rf"[\w-]+{re.escape(program_file.SUFFIX)}", re.ASCII)
"""How a program's file is named: a bare name, with no way to another folder."""
LONGEST_LIST = 100_000
"""Bytes of a list that are read at most."""
FIRST = 40
"""Programs that are read ahead at most. What a run calls late depends on what it finds, but records of one rig find the like, and
the largest, of friction that gives, take a second each to read."""
LONG = 0.1
"""Programs that are so large a part of the largest are read first: a wait for others is short."""

ahead: dict[str, Future[Compiled | None]] = {}
"""Programs by file name that are read before they are asked for; None if they cannot be."""
used: dict[str, None] = {}
used_aside: dict[str, None] = {}
"""File names of the programs that this process's main thread has called, in order, and those called by other threads."""


@contextlib.contextmanager
def reading_ahead(command: str, folder: Path | None) -> Iterator[None]:
    """Within it, what the last run of ``command`` used is being read; at its end, what this run used is written down.

    Parameters
    ----------
    command : the name under which runs are alike
    folder : the cache of compiled programs; None or a missing one: nothing is read ahead
    """
    if folder is None or not is_private_folder(folder / "programs"):
        yield
        return
    notes, ended = folder / "programs" / f"{command}{SUFFIX}", threading.Event()
    coming: dict[str, Future[Compiled | None]] = {name: Future() for name in _long_first(notes.parent, _names(notes))}
    reader = threading.Thread(target=_read, args=(folder / "programs", coming, ended))
    try:
        reader.start()
    except RuntimeError:  # no more threads for this user: each is read when it is asked for
        yield
        return
    ahead.update(coming)
    try:
        yield
    finally:
        ended.set()  # a thread that is left inside XLA while Python goes takes the process with it
        reader.join()
        ahead.clear()
        # What the main thread waits for comes first.
        if asked := [*used, *used_aside][:FIRST]:
            _write(notes, asked)


def read(path: Path) -> Compiled:
    """What calls a kept program, read ahead or now. Raises whatever is wrong with its file."""
    begun = ahead.get(path.name)
    # One whose turn has not come need not wait for it.
    found = begun.result() if begun is not None and not begun.cancel() else None
    return program_file.read(path) if found is None else found


def _read(folder: Path, coming: dict[str, Future[Compiled | None]], ended: threading.Event) -> None:
    """Make one program after the other ready to be called, unless somebody was faster."""
    for name, future in coming.items():
        if not future.set_running_or_notify_cancel():
            continue
        found = None
        if not ended.is_set():
            with contextlib.suppress(Exception):  # missing, half written, of another making: the one who needs it makes it anew
                found = program_file.read(folder / name)
        future.set_result(found)


def _long_first(folder: Path, names: list[str]) -> list[str]:
    sizes = {}
    for name in names:
        with contextlib.suppress(OSError):
            sizes[name] = (folder / name).stat().st_size
    long = LONG * max(sizes.values(), default=0)
    return sorted(sizes, key=lambda name: sizes[name] < long)


def _names(notes: Path) -> list[str]:
    """Names of programs in the folder of the list, and of nothing elsewhere."""
    try:
        told = dict.fromkeys(read_private(notes, LONGEST_LIST).decode("utf-8").split())
    except (OSError, UnicodeDecodeError):
        return []
    return [name for name in told if NAME.fullmatch(name)]


def _write(notes: Path, names: list[str]) -> None:
    text = "\n".join(dict.fromkeys(names)) + "\n"
    with contextlib.suppress(OSError):  # a full disk or a read-only home costs time, nothing else
        write_whole(notes, text, private=True)
