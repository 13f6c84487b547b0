"""Which reader a file needs: by the suffix of its name, and by its first bytes where the suffix says nothing."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path

from ..table import Table

Reader = Callable[[Path], Table]

READERS: dict[str, str] = {
    ".npz": "npz",
    ".npy": "npy",
    ".mat": "mat",
}
"""Modules of this package by suffix; each has `read(path) -> Table`."""

TEXT = frozenset((".csv", ".txt", ".dat", ".tsv", ".asc", ".log", ".gz"))
"""Suffixes of text tables, which are not read here."""

SIGNATURES: tuple[tuple[bytes, str], ...] = (
    (b"\x93NUMPY", ".npy"),
    (b"MATLAB 5.0 MAT-file", ".mat"),
    (b"MATLAB 7.3 MAT-file", ".mat"),
)
"""How files begin, for those whose suffix is none of the above."""

SNIFFED_BYTES = 1024


def reader_for(path: Path) -> Reader | None:
    """What reads a file.

    Parameters
    ----------
    path : Path
        A file that exists.

    Returns
    -------
    callable or None
        Takes the path, returns a `Table`, raises `BadInput`; None for a text table (and whatever is to be tried as one).

    Raises
    ------
    OSError
        When the file cannot be opened.
    """
    suffix = path.suffix.lower()
    if suffix not in READERS:
        if suffix in TEXT:
            return None
        suffix = _by_content(path)
    if suffix not in READERS:
        return None
    return importlib.import_module(f".{READERS[suffix]}", __package__).read


def _by_content(path: Path) -> str:
    """The suffix that a file of this content should have; empty where it may be text."""
    with open(path, "rb") as file:
        head = file.read(SNIFFED_BYTES)
    return next((suffix for begin, suffix in SIGNATURES if head.startswith(begin)), "")
