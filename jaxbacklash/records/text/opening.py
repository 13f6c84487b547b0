"""The first step of reading a text table: its encoding, and its lines, out of gzip where it is packed."""

from __future__ import annotations

import codecs
import contextlib
import dataclasses
import gzip
import io
import itertools
import os
import shlex
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO, cast

import numpy as np

from jaxbacklash.errors import BadInput

from ..checks import wrong

SNIFFED_BYTES = 65536
"""The encoding is judged by these first bytes."""

AT_ONCE = 2**21
"""Bytes read at once where only the lines are counted.

With a room of less than what a short record takes, the C library hands its memory back to the system and takes it anew at every
step: a tenth of the time of reading 15,000 rows (`benchmarks.read_speed`).
"""

MOST_UNPACKED = 512 * 2**20
"""A packed file that holds more bytes of text than this is refused: it might have no end. Ten million rows are within it."""

MOST_PACKED = 1032
"""Deflate makes nothing smaller than this many times: a size beyond it at the end of a damaged file is no size."""

LONGEST_LINE = 2**20
"""A line of more characters than this is none of a table with one line a sample."""

_OF_TEXT = bytes(byte for byte in range(256) if byte >= 32 or byte in b"\t\n\r\f\v\x1a")

PACKED = {b"BZh": "bzip2", b"\xfd7zXZ": "xz", b"PK\x03\x04": "zip", b"\x28\xb5\x2f\xfd": "zstd", b"7z\xbc\xaf": "7z"}
"""First bytes of packed files that are not unpacked here (a workbook is such a zip file)."""


@dataclasses.dataclass(frozen=True)
class Source:
    """A text file and how to read it: its encoding in Python's name, and whether it is packed by gzip."""

    path: Path
    encoding: str
    gzip: bool

    @contextlib.contextmanager
    def lines(self, skip: int = 0) -> Iterator[TextIO]:
        """The lines of the file after the first ``skip``; CR, LF and CR LF end one.

        Raises
        ------
        BadInput
            Where the packed data are damaged, end too soon or hold more than `MOST_UNPACKED` bytes.
        """
        with unpacked(self.path, self.gzip) as raw:
            # A lone half of a character, or a byte that the encoding does not have, must not hinder numbers.
            file = io.TextIOWrapper(io.BufferedReader(raw, SNIFFED_BYTES), encoding=self.encoding, errors="replace")
            for _ in itertools.islice(file, skip):
                continue
            yield file

    def last_line(self) -> int:
        """`Bytes.last_line`, for which the whole file is gone through."""
        with unpacked(self.path, self.gzip) as raw:
            room = bytearray(AT_ONCE)
            while raw.readinto(room):
                continue
            return raw.last_line()


class Bytes(io.RawIOBase):
    """The bytes of a file, unpacked where need be, up to `MOST_UNPACKED` of those; lines are counted as they pass."""

    def __init__(self, file: gzip.GzipFile | io.FileIO, path: Path, packed: bool):
        self.file, self.path, self.packed = file, path, packed
        self.count = self.feeds = self.returns = 0
        self.tail = b""

    def readable(self) -> bool:
        """Always: this is what `io.RawIOBase` asks."""
        return True

    def readinto(self, buffer) -> int:
        """Fill a buffer; see `io.RawIOBase`. Raises `BadInput` where the file is damaged or too long."""
        # What a damaged archive raises differs by where the damage is.
        try:
            size = self.file.readinto(buffer)
        except EOFError as why:
            wanted = "all of it (copy the file again)"
            raise wrong(str(self.path), "a gzip file that ends in the middle", wanted) from why
        except (gzip.BadGzipFile, zlib.error) as why:
            raise wrong(str(self.path), f"a damaged gzip file ({why})", "one that can be unpacked") from why
        self.count += size
        if self.packed and self.count > MOST_UNPACKED:
            raise _too_long(self.path)
        # As arrays: bytes.count takes a sixth of the time of reading the numbers where lines are short.
        every = np.frombuffer(buffer, dtype=np.uint8, count=size)
        self.feeds += int(np.count_nonzero(every == ord("\n")))
        if not self.feeds:
            self.returns += int(np.count_nonzero(every == ord("\r")))
        last = every[-4096:].tobytes()
        self.tail = last if size >= 1024 else (self.tail + last)[-4096:]
        return size

    def last_line(self) -> int:
        """Number (from 1) of the last line that is not blank, once all is read; blank lines at the end count only far up."""
        mark = b"\n" if self.feeds else b"\r"
        below = self.tail[len(self.tail.rstrip(b" \t\r\n\f\v\0\x1a")) :]
        return (self.feeds or self.returns) + 1 - below.count(mark)


def _too_long(path: Path) -> BadInput:
    """The refusal of a packed file that holds too much."""
    found = f"a gzip file of more than {MOST_UNPACKED >> 20} MB of text"
    return wrong(str(path), found, f"less; unpack it first with gunzip -k {shlex.quote(str(path))}")


def last_line(file: TextIO) -> int:
    """`Bytes.last_line` of a file that `Source.lines` opened."""
    # A class of our own around the text would know its bytes, but Python reads lines of such a class more slowly.
    return cast(Bytes, cast(io.TextIOWrapper, file).buffer.raw).last_line()  # type: ignore[attr-defined]


@contextlib.contextmanager
def unpacked(path: Path, packed: bool) -> Iterator[Bytes]:
    """The bytes of a file, out of gzip where ``packed``."""
    with gzip.open(path, "rb") if packed else open(path, "rb", buffering=0) as file:
        yield Bytes(file, path, packed)


def open_text(path: Path) -> Source:
    """Find out how a file is to be read.

    Parameters
    ----------
    path : Path
        An existing file.

    Returns
    -------
    Source

    Raises
    ------
    BadInput
        The file is empty, binary, packed by something other than gzip, or damaged.
    """
    with open(path, "rb") as file:
        start = file.read(8)
        packed = start.startswith(b"\x1f\x8b")
        # A packed file ends with the size of what it holds: one that says so is refused before any of it is kept.
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - 4))
        if packed and MOST_UNPACKED < int.from_bytes(file.read(4), "little") <= size * MOST_PACKED:
            raise _too_long(path)
    name = next((name for mark, name in PACKED.items() if start.startswith(mark)), None)
    if name == "zip":
        wanted = "a table (unpack it; an Excel workbook keeps its suffix .xlsx, a NumPy archive .npz)"
        raise wrong(str(path), "binary data, packed as zip", wanted)
    if name is not None:
        raise wrong(str(path), f"binary data, packed by {name}", "text; unpack it first")
    with unpacked(path, packed) as raw:
        head = io.BufferedReader(raw, SNIFFED_BYTES).read(SNIFFED_BYTES)
    return Source(path, encoding_of(head, str(path)), packed)


def encoding_of(head: bytes, where: str) -> str:
    """The encoding that the first bytes of a file show, in Python's name.

    Raises
    ------
    BadInput
        The file is empty, or these are no bytes of text.
    """
    if head.startswith((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)):
        return "utf-32"
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if not head.strip(b" \t\r\n\f\v\0"):
        raise wrong(where, "nothing but NUL bytes" if b"\0" in head else "an empty file", "a header line and numbers")
    wide = _wide(head)
    if wide is not None:
        return wide
    strange = head.translate(None, _OF_TEXT)
    if strange:
        odd = head.index(strange[:1])
        before = head[:odd].decode("latin-1")
        if head[odd] == 0 and before.count("\n") > 2 and before.isascii():
            found = f"binary data: NUL bytes from line {before.count(chr(10)) + 1} on"
            raise wrong(where, found, "text throughout (delete them, or copy the file again)")
        raise wrong(where, "binary data", "text (a .npz or .mat file must keep its suffix)")
    try:
        # Not final: the cut may go through a character.
        codecs.utf_8_decode(head, "strict", False)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def _wide(head: bytes) -> str | None:
    """UTF-16 without a byte order mark: a table is digits and blanks, and there every second byte of theirs is 0."""
    pairs = len(head) // 2
    if pairs < 2 or b"\0" not in head:
        return None
    first, second = head[: 2 * pairs : 2], head[1 : 2 * pairs : 2]
    for high, low, name in ((second, first, "utf-16-le"), (first, second, "utf-16-be")):
        if high.count(0) > 0.8 * pairs and low.count(0) == 0:
            return name
    return None
