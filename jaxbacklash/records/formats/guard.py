"""What every reader of a binary format needs around its library: a sentence where the library is missing, is given a
damaged file or runs out of memory, and quiet where it would print."""

from __future__ import annotations

import contextlib
import gc
import importlib
import importlib.util
import logging
import sys
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

from jaxbacklash.errors import BadInput

from ..checks import wrong

MAX_BYTES = 2 << 30
"""The most that the columns of one file may take in memory [bytes]: 268 million numbers. A file of a few kilobytes can claim
terabytes, so this is asked before anything is allocated."""

ROOM = 1 << 30
"""Bytes for texts whose length only the compiled part of a library sees. Other threads load compiled programs meanwhile, and must
not run short of address space."""


def library(module: str, package: str, path: Path, kind: str, instead: str = "") -> ModuleType:
    """Import what reads a format.

    Parameters
    ----------
    module, package : str
        The module, and the name of the package that pip installs.
    path, kind, instead : Path, str, str
        For the sentence: the file, what it is ("a TDMS file"), and another way out.

    Raises
    ------
    BadInput
        The library is not installed.
    """
    try:
        with quiet():
            return importlib.import_module(module)
    except ImportError:
        raise _missing(package, path, kind, instead) from None


def needed(module: str, package: str, path: Path, kind: str) -> None:
    """Refuse where a library is not installed, as `library` does, without the time that its import takes."""
    if importlib.util.find_spec(module) is None:
        raise _missing(package, path, kind)


def _missing(package: str, path: Path, kind: str, instead: str = "") -> BadInput:
    return wrong(str(path), kind, f'{package} to read it: pip install "jaxbacklash[io]"{instead}')


@contextlib.contextmanager
def guarded(path: Path, kind: str, wanted: str) -> Iterator[None]:
    """Turn whatever a library raises on a damaged file into `BadInput`.

    Parameters
    ----------
    path : Path
    kind, wanted : str
        "a file that is damaged or no TDMS file", "a complete file; copy it again".
    """
    where = str(path)
    with quiet():
        try:
            yield
        except (BadInput, FileNotFoundError, PermissionError):
            raise
        except Exception as why:  # The libraries raise whatever the damage happens to trip.
            _let_go(why)
            if isinstance(why, MemoryError):
                kind = f"more numbers than fit into memory (the file has {path.stat().st_size / 1e6:.3g} MB)"
                wanted = "a shorter record"
            elif isinstance(why, RecursionError):
                kind = "values nested deeper than any record is"
            raise wrong(where, kind, wanted) from why


def _let_go(why: BaseException | None) -> None:
    """Drop what a library holds of a file that it failed to open, while its complaints about that are still kept quiet."""
    while why is not None:
        traceback.clear_frames(why.__traceback__)
        why = why.__cause__ or why.__context__
    gc.collect(1)  # the youngest objects only: all of them take a quarter of a second


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Keep a library's warnings and log lines, which speak of its own insides, off the user's terminal."""
    before, hook = logging.root.manager.disable, sys.unraisablehook
    logging.disable(logging.CRITICAL)
    # Objects that were built by half complain again when they are thrown away.
    sys.unraisablehook = lambda _: None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)
        sys.unraisablehook = hook


@contextlib.contextmanager
def room(size: int = ROOM) -> Iterator[None]:
    """Within it the process may take ``size`` bytes of address space more, for compiled parts that allocate what a file claims.

    They then report that there is no memory, at once, instead of taking it. Where the system keeps no such limit nothing changes.
    """
    try:
        import resource

        before = resource.getrlimit(resource.RLIMIT_AS)
        with open("/proc/self/statm", encoding="ascii") as file:
            most = int(file.read().split()[0]) * resource.getpagesize() + size
        if before[0] != resource.RLIM_INFINITY:
            most = min(most, before[0])
        resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    except (ImportError, OSError, ValueError):
        yield
        return
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


class Budget:
    """What the arrays of a file may still take, by what the file claims, before any of them is allocated."""

    def __init__(self, where: str) -> None:
        self.where, self.taken = where, 0

    @property
    def left(self) -> int:
        """Bytes that may still be taken."""
        return max(MAX_BYTES - self.taken, 0)

    def take(self, size: int, name: str) -> None:
        """Allow for an array of ``size`` bytes. Raises `BadInput` where all together would be more than `MAX_BYTES`."""
        self.taken += size
        bounded(self.taken, f"{self.where}, {name}")


def bounded(size: int, where: str, what: str = "numbers") -> None:
    """Refuse what would take more than `MAX_BYTES` in memory; ``size`` in bytes, as the file claims it."""
    if size > MAX_BYTES:
        most = f"at most {MAX_BYTES / 1e9:.2g} GB: a shorter record or a lower rate"
        raise wrong(where, f"{what} that take {size / 1e9:.4g} GB by what the file says", most)
