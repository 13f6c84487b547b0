"""Files that appear whole or not at all: written beside their place under another name, then put there in one step.

Everything this package writes for a user goes through here, so that neither a full disk nor a program that is stopped leaves half
a file, or nothing in place of an older one. `jaxbacklash.stopping` removes what was being written when a signal came.
"""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path

LONGEST_NAME = 200
"""Bytes of a file's own name that go into that of the file beside it: file systems take 255 at most."""

_unfinished: set[str] = set()
_lock = threading.Lock()


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A path beside ``path`` to write to; at the end of the block what was written there takes the place of ``path``.

    Parameters
    ----------
    path : the file to make or replace; its folder must be there

    Raises
    ------
    OSError
        ``path`` cannot be written; it is then as it was, and nothing lies beside it.

    Examples
    --------
    >>> with whole_file("result.json") as part:  # doctest: +SKIP
    ...     part.write_text("{}")
    """
    target = Path(path)
    if target.is_dir():
        raise IsADirectoryError(21, "Is a directory", str(target))
    # Process and thread keep two that write the same file apart. Cut by bytes: a name may be as long as the file system takes.
    own = os.fsdecode(os.fsencode(target.name)[:LONGEST_NAME])
    part = target.with_name(f".{own}.{os.getpid()}.{threading.get_ident()}.part")
    with _lock:
        _unfinished.add(os.fspath(part))
    try:
        yield part
        os.replace(part, target)
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        with _lock:
            _unfinished.discard(os.fspath(part))


def write_whole(path: str | os.PathLike[str], content: str | bytes, *, lasting: bool = False, private: bool = False) -> None:
    """Write a file whole or not at all.

    Parameters
    ----------
    path : the file to make or replace
    content : text goes into UTF-8; half characters, as in names of files that are not UTF-8, are written as escapes
    lasting : wait until it is on the disk
    private : for this user alone

    Raises
    ------
    OSError
        The file cannot be written, by the reason the system gives.
    """
    data = content.encode("utf-8", "backslashreplace") if isinstance(content, str) else content
    mode = 0o600 if private else 0o666
    with whole_file(path) as part, open(part, "wb", opener=lambda name, flags: os.open(name, flags, mode)) as file:
        file.write(data)
        if lasting:
            file.flush()
            os.fsync(file.fileno())


def remove_unfinished() -> None:
    """Remove what is being written at this moment, in a process that is about to end; never waits and never raises."""
    for part in list(_unfinished):
        with contextlib.suppress(OSError):
            os.unlink(part)
