"""The folder that a map's tiles are kept in: known as ours by a file in it, used by one process at a time, removed when done.

Nothing in a folder without that file is written, replaced or deleted, and nothing but what a store of tiles consists of is ever
removed: the folder's name follows from the output's, so it may be somebody else's.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..whole_file import write_whole

ARRAYS, RECORDS, MARK, LOCK = "arrays.zarr", "records", "request.json", "lock"
FORMAT = "jaxbacklash tiles 1"
"""What the file `MARK` says in a folder of ours."""
CURE = "remove or rename it, or name another output"


def reserve(path: Path, fingerprint: str) -> None:
    """Make the folder for the tiles of one map, or find it as an earlier run of the same map left it.

    Parameters
    ----------
    path : the folder
    fingerprint : the map's, see `jaxbacklash.dynamics.request.Request.fingerprint`

    Raises
    ------
    BadInput
        There is something else under this name, the folder holds another map's tiles, or it cannot be written.
    """
    with _told(path):
        if path.is_symlink():
            raise BadInput(f"{path}: is a link, wanted a folder of its own as a store of tiles; {CURE}")
        path.mkdir(parents=True, exist_ok=True)
        mark = path / MARK
        if not os.path.lexists(mark):
            # A run that was killed while it wrote the mark leaves what it was writing.
            foreign = sorted(p.name for p in path.iterdir() if p.name != LOCK and not p.name.startswith(f".{MARK}."))
            if foreign:
                raise BadInput(f"{path}: is a folder with {foreign[0]!r} in it and no store of tiles of a map; {CURE}")
            write_whole(mark, json.dumps({"format": FORMAT, "fingerprint": fingerprint}), lasting=True)
        told = _mark(mark)
        if told.get("format") != FORMAT:
            raise BadInput(f"{path}: is a folder whose {MARK} is not that of a store of tiles; {CURE}")
        if told.get("fingerprint") != fingerprint:
            raise BadInput(
                f"{path} holds tiles of another map (other axes, periods, start or version): remove it or name another output"
            )
        for part in (ARRAYS, RECORDS):
            if os.path.lexists(path / part) and not stat.S_ISDIR(os.lstat(path / part).st_mode):
                raise BadInput(f"{path / part}: is not a folder, wanted what an earlier run of this map left; remove {path}")
        (path / RECORDS).mkdir(exist_ok=True)


@contextlib.contextmanager
def used_alone(path: Path) -> Iterator[None]:
    """Within it no other process computes into this folder, which must be there.

    Raises
    ------
    BadInput
        Another process does. One that was killed does not: the system lets go of its lock.
    """
    try:
        import fcntl
    except ImportError:  # not Unix: nothing tells two maps into one file apart
        yield
        return
    with _told(path):
        lock = os.open(path / LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o644)
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            gone = os.fstat(lock).st_nlink == 0  # the other one has ended, and removed it, just now
        except BlockingIOError:
            gone = True
        except OSError:  # a file system without locks
            gone = False
        if gone:
            who = os.read(lock, 20).decode("ascii", "replace").strip()
            named = f"process {who} is" if who.isdigit() else "another process is"
            raise BadInput(f"{path}: {named} computing a map into this folder; wait for it or name another output")
        with contextlib.suppress(OSError):
            os.ftruncate(lock, 0)
            os.pwrite(lock, f"{os.getpid()}\n".encode(), 0)
        yield
    finally:
        os.close(lock)


def remove(path: Path) -> list[str]:
    """Remove a store of tiles; what else somebody put into its folder stays.

    Returns
    -------
    the names of what stays, empty where the folder is gone
    """
    if path.is_symlink() or _mark(path / MARK).get("format") != FORMAT:
        return [path.name]
    for part in (ARRAYS, RECORDS):
        if (path / part).is_dir() and not (path / part).is_symlink():
            shutil.rmtree(path / part, ignore_errors=True)
    for part in (LOCK, MARK):  # the mark last: without it nothing of the rest would be ours
        with contextlib.suppress(OSError):
            (path / part).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        path.rmdir()
        return []
    return sorted(entry.name for entry in path.iterdir()) if path.is_dir() else []


def _mark(mark: Path) -> dict[str, Any]:
    """What the mark says, nothing where it is no file of ours."""
    try:
        if not stat.S_ISREG(os.lstat(mark).st_mode) or mark.stat().st_size > 10_000:
            return {}
        told = json.loads(mark.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return told if isinstance(told, dict) else {}


@contextlib.contextmanager
def _told(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise BadInput(f"{path}: cannot be used as a store of tiles ({error.strerror or error}); {CURE}") from None
