"""Whether the elements of a MATLAB file of version 5 are what a reader may rely on, before SciPy is given the file.

SciPy looks up the kind of an element in a table without asking whether there is such a kind, and takes places in a sparse matrix
as they come: a damaged file ends the whole process. Here every element's kind and length is checked first, after the layout
published by MathWorks ("MAT-File Format", chapter 1); what is packed is unpacked once, with a bound, and handed on unpacked.
"""

from __future__ import annotations

import io
import mmap
import struct
import zlib
from pathlib import Path

from .guard import Budget

HEADER_BYTES = 128
MATRIX, COMPRESSED = 14, 15
SIMPLE = frozenset((1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 16, 17, 18))
"""Kinds of elements that hold numbers or text."""
NUMERIC = frozenset(range(4, 16))
"""Classes of matrices that hold nothing but numbers or text: char, sparse, double, single and the whole numbers."""
MAX_DEPTH = 64


def checked(path: Path) -> Path | io.BytesIO:
    """A file whose elements are all well formed: itself, or unpacked where any element is packed.

    Raises
    ------
    ValueError
        An element is of no known kind, or longer than what it stands in.
    BadInput
        The file unpacks to more than fits into memory.
    """
    with open(path, "rb") as file:
        head = file.read(HEADER_BYTES)
        if 0 in head[:4]:
            return path  # version 4 has no elements
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as whole, memoryview(whole) as view:
            order = {b"IM": "<", b"MI": ">"}.get(head[126:128], "")
            if not order:
                raise ValueError("no mark of the order of bytes")
            return _unpacked(view, order, path) or path


def _unpacked(view: memoryview, order: str, path: Path) -> io.BytesIO | None:
    """Walk the variables of a file; the file with all of them unpacked, None where none is packed."""
    parts: dict[tuple[int, int], bytes] = {(0, HEADER_BYTES): b""}
    budget = Budget(str(path))
    at = HEADER_BYTES
    while at < len(view):
        kind, begin, stop, _ = _element(view, at, len(view), order)
        parts[at, stop] = b""
        if kind == COMPRESSED:
            data = _inflated(bytes(view[begin:stop]), budget)
            with memoryview(data) as inner:
                _, _, end, _ = _element(inner, 0, len(inner), order)
                _walk(inner, 0, end, order, 0, frozenset((MATRIX,)))
            parts[at, stop] = data[:end]
        else:
            _walk(view, at, stop, order, 0, frozenset((MATRIX,)))
        at = stop  # SciPy looks for the next variable there too
    if not any(parts.values()):
        return None
    return io.BytesIO(b"".join(data or bytes(view[begin:stop]) for (begin, stop), data in parts.items()))


def _inflated(data: bytes, budget: Budget) -> bytes:
    """A packed variable, all of it and no more than fits."""
    stream = zlib.decompressobj()
    found = stream.decompress(data, budget.left + 1)
    budget.take(len(found), "a packed array")
    if not stream.eof:
        raise ValueError("a packed variable without its end")
    return found


def _element(view: memoryview, at: int, end: int, order: str) -> tuple[int, int, int, int]:
    """Kind of the element at a place, where its content begins and stops, and where the next one is."""
    if at + 8 > end:
        raise ValueError("an element without its head")
    word, size = struct.unpack_from(f"{order}II", view, at)
    if word >> 16:  # up to four bytes stand in the head itself
        kind, size, begin, after = word & 0xFFFF, word >> 16, at + 4, at + 8
        if size > 4:
            raise ValueError("a short element that is long")
    else:
        kind, begin = word, at + 8
        after = begin + size + -size % 8
    if begin + size > end:
        raise ValueError("an element longer than what it stands in")
    return kind, begin, begin + size, after


def _walk(view: memoryview, at: int, end: int, order: str, depth: int, allowed: frozenset[int]) -> None:
    """Check the elements between two places, and those within matrices."""
    if depth > MAX_DEPTH:
        raise ValueError("matrices within matrices without end")
    while at < end:
        kind, begin, stop, after = _element(view, at, end, order)
        if kind not in allowed:
            raise ValueError(f"an element of kind {kind}")
        if kind == MATRIX and stop > begin:
            flags, start, _, _ = _element(view, begin, stop, order)
            if flags != 6:
                raise ValueError("a matrix without its flags")
            numeric = struct.unpack_from(f"{order}I", view, start)[0] & 0xFF in NUMERIC
            _walk(view, begin, stop, order, depth + 1, SIMPLE if numeric else SIMPLE | {MATRIX})
        at = after
