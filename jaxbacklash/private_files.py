"""Files that only this user can have written: what is run without being looked at may come from nowhere else.

Compiled programs are kept as pickles and machine code, so whoever can write them can have this user run anything. They are read
only from folders and files that belong to the user and that nobody else may write, and only from regular files: a link may lead
anywhere, and a pipe or a device never ends.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
LARGEST = 2**30
"""Bytes of a file that is read whole, at most: no program of ours comes near."""


def make_private_folder(path: Path) -> bool:
    """Make a folder, for this user alone if it is not there yet; whether it is one that nobody else may write to."""
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError:
        return False
    return is_private_folder(path)


def is_private_folder(path: Path) -> bool:
    """Whether this is a folder that belongs to the user, that nobody else may write to, and that nobody else may move away."""
    try:
        real = Path(os.path.realpath(path))
        if not (real.is_dir() and _own(os.stat(real)) and os.access(real, os.R_OK | os.W_OK | os.X_OK)):
            return False
        # In a folder that all may write to, and that is not marked sticky, anybody could put another in its place.
        return not any(_open_to_all(os.stat(parent)) for parent in real.parents)
    except OSError:
        return False


def holds_only_own_files(path: Path) -> bool:
    """Whether a folder holds nothing but folders and regular files of this user."""
    try:
        with os.scandir(path) as entries:
            for entry in entries:
                state = entry.stat(follow_symlinks=False)
                if not (stat.S_ISREG(state.st_mode) or stat.S_ISDIR(state.st_mode)) or state.st_uid != _user(state):
                    return False
    except OSError:
        return False
    return True


def read_private(path: str | os.PathLike[str], most: int = LARGEST) -> bytes:
    """The first ``most`` bytes of a file that only this user can have written.

    Raises
    ------
    OSError
        There is no such file, it is a link, a pipe or a device, it belongs to somebody else, or others may write to it.
    """
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with open(os.open(path, flags), "rb") as file:
        state = os.fstat(file.fileno())
        if not stat.S_ISREG(state.st_mode) or not _own(state):
            raise PermissionError(1, "not a file that this user alone can write", os.fspath(path))
        return file.read(most)


def _own(state: os.stat_result) -> bool:
    return state.st_uid == _user(state) and not (os.name == "posix" and state.st_mode & OTHERS_WRITE)


def _user(state: os.stat_result) -> int:
    return os.geteuid() if hasattr(os, "geteuid") else state.st_uid  # elsewhere a home is the user's own by other means


def _open_to_all(state: os.stat_result) -> bool:
    return os.name == "posix" and bool(state.st_mode & stat.S_IWOTH) and not state.st_mode & stat.S_ISVTX
