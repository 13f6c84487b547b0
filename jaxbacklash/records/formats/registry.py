"""Which reader a file needs: by the suffix of its name, and by its first bytes where the suffix says nothing."""

from __future__ import annotations

import functools
import importlib
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

from ..checks import listed, wrong
from ..table import Table

Reader = Callable[..., Table]

READERS: dict[str, str] = {
    **dict.fromkeys((".npz",), "npz"),
    **dict.fromkeys((".npy",), "npy"),
    **dict.fromkeys((".mat",), "mat"),
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".he5", ".nc"), "hdf5"),
    **dict.fromkeys((".json", ".jsonl", ".ndjson"), "json_file"),
    **dict.fromkeys((".xlsx", ".xlsm"), "xlsx"),
    **dict.fromkeys((".tdms",), "tdms"),
    **dict.fromkeys((".mf4", ".mdf"), "mdf"),
    **dict.fromkeys((".uff", ".unv"), "uff"),
    **dict.fromkeys((".bag", ".db3"), "rosbag"),
    **dict.fromkeys((".mcap",), "mcap_file"),
    **dict.fromkeys((".wav",), "wav"),
}
"""Modules of this package by suffix; each has `read(path) -> Table`."""

WITH_DECIMAL = frozenset(("xlsx",))
"""Modules whose `read` takes the decimal mark of numbers written as text."""

SIGNATURES: tuple[tuple[bytes, str], ...] = (
    (b"\x93NUMPY", ".npy"),
    (b"MATLAB 5.0 MAT-file", ".mat"),
    (b"MATLAB 7.3 MAT-file", ".mat"),
    (b"\x89HDF\r\n\x1a\n", ".h5"),
    (b"TDSm", ".tdms"),
    (b"MDF     ", ".mf4"),
    (b"UnFinMF ", ".mf4"),
    (b"#ROSBAG V", ".bag"),
    (b"SQLite format 3\0", ".db3"),
    (b"\x89MCAP0\r\n", ".mcap"),
    (b"RIFF", ".wav"),
    (b"    -1\n", ".uff"),
    (b"    -1\r\n", ".uff"),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", ".xls"),
    (b"PAR1", ".parquet"),
    (b"ARROW1", ".feather"),
    (b"FEA1", ".feather"),
    (b"\x80\x02", ".pkl"),
    (b"\x80\x03", ".pkl"),
    (b"\x80\x04", ".pkl"),
    (b"\x80\x05", ".pkl"),
)
"""How files begin, for those whose suffix is none of the above."""

JSON_BEGINS = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:\{\s*(?:\"|$)|\[\s*[\[{])")
"""A text that begins so is JSON; "[Header]" and the like are the preamble of a text table."""

SNIFFED_BYTES = 1024


def reader_for(path: Path) -> Reader | None:
    """What reads a file.

    Parameters
    ----------
    path : Path
        A file that exists, or a folder that ROS 2 recorded, with its metadata.yaml.

    Returns
    -------
    callable or None
        Takes the path and perhaps the decimal mark that the user said (`decimal`), returns a `Table`, raises `BadInput`; None
        for a text table (and whatever is to be tried as one).

    Raises
    ------
    OSError
        When the file cannot be opened.
    """
    if path.is_dir():
        return functools.partial(_read, "rosbag") if (path / "metadata.yaml").is_file() else None
    suffix = path.suffix.lower()
    if suffix not in READERS:
        suffix = _by_content(path) or suffix
    module = READERS.get(suffix)
    if module is not None:
        return functools.partial(_read, module)
    from .refused import WAYS_OUT, refuse

    return functools.partial(refuse, suffix) if suffix in WAYS_OUT else None


def _by_content(path: Path) -> str:
    """The suffix that a file of this content should have; empty where it may be text."""
    with open(path, "rb") as file:
        head = file.read(SNIFFED_BYTES)
    if head.startswith(b"PK\x03\x04"):
        return _by_members(path)
    found = next((suffix for begin, suffix in SIGNATURES if head.startswith(begin)), "")
    if not found and JSON_BEGINS.match(head):
        return ".json"
    # Instruments write text under suffixes of programs that open it: what is no such file may be a table.
    return found or ("" if b"\0" in head else ".txt")


def _by_members(path: Path) -> str:
    """What a zip archive is, by what is in it."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError):
        return ".zip"
    if any(name.startswith("xl/") for name in names):
        return ".xlsx"
    if "content.xml" in names:
        return ".ods"
    return ".npz" if any(name.endswith(".npy") for name in names) else ".zip"


def _read(module: str, path: Path, decimal: str | None = None) -> Table:
    """The table of a file, or a sentence about what is in one that holds none."""
    reader = importlib.import_module(f".{module}", __package__).read
    table = reader(path, decimal) if module in WITH_DECIMAL else reader(path)
    if table.columns:
        return table
    found = listed((f"{name} ({what})" for name, what in table.left_out.items()), limit=4)
    raise wrong(str(path), f"no channel of samples but {found}", "a record: times and motions, one value a sample")
