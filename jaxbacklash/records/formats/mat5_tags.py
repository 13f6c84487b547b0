"""Whether the elements of a MATLAB file of version 5 are what a reader may rely on, before SciPy is given the file.

SciPy looks up the kind of an element in a table without asking whether there is such a kind, and takes places in a sparse matrix
as they come: a damaged file ends the whole process. Here every element's kind and length is checked first, after the layout
published by MathWorks ("MAT-File Format", chapter 1); what is packed is unpacked once, with a bound, and handed on unpacked.
"""

from __future__ import annotations

import bisect
import itertools
import math
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
FLAGS, CHAR, SPARSE = 6, 4, 5
CONTAINERS = frozenset((1, 2, 3))
"""Classes of cells, structs and objects."""
ELEMENTS = {SPARSE: 6}
"""Elements of a matrix where they are more than four (flags, lengths, name, numbers); imaginary parts come on top."""
MAX_EMPTY = 4096
"""An array of structs without fields has no values of its own; longer ones are damage."""
MAX_DEPTH = 64


class Parts:
    """Pieces of bytes as one file to read from; a megabyte that is asked for as it stands is not copied."""

    def __init__(self, pieces: list[bytes]) -> None:
        self.pieces, self.place = pieces, 0
        self.ends = list(itertools.accumulate(map(len, pieces)))

    def read(self, size: int = -1) -> bytes:
        """The next ``size`` bytes, or all that are left."""
        left = self.ends[-1] - self.place
        size = left if size < 0 else min(size, left)
        found = []
        while size > 0:
            number = bisect.bisect_right(self.ends, self.place)
            piece = self.pieces[number]
            begin = self.place - self.ends[number] + len(piece)
            found.append(piece[begin : begin + size])
            size -= len(found[-1])
            self.place += len(found[-1])
        return found[0] if len(found) == 1 else b"".join(found)

    def seek(self, offset: int, whence: int = 0) -> int:
        """Go to a place, as files do."""
        self.place = offset + (0, self.place, self.ends[-1])[whence]
        return self.place

    def tell(self) -> int:
        """Where the next byte comes from."""
        return self.place


def checked(path: Path) -> Path | Parts:
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


def _unpacked(view: memoryview, order: str, path: Path) -> Parts | None:
    """Walk the variables of a file; the file with all of them unpacked, None where none is packed."""
    parts: dict[tuple[int, int], bytes] = {(0, HEADER_BYTES): b""}
    budget = Budget(str(path))
    at = HEADER_BYTES
    while at < len(view):
        kind, begin, stop, _ = _element(view, at, len(view), order)
        parts[at, stop] = b""
        if kind == COMPRESSED:
            with view[begin:stop] as part:  # let go even where it is refused: the file cannot be closed before
                data = _inflated(part, budget)
            with memoryview(data) as inner:
                _, _, end, _ = _element(inner, 0, len(inner), order)
                _walk(inner, 0, end, order, 0, frozenset((MATRIX,)))
            parts[at, stop] = data if end == len(data) else data[:end]
        else:
            _walk(view, at, stop, order, 0, frozenset((MATRIX,)))
        at = stop  # SciPy looks for the next variable there too
    if not any(parts.values()):
        return None
    return Parts([data or bytes(view[begin:stop]) for (begin, stop), data in parts.items()])


def _inflated(data: memoryview, budget: Budget) -> bytes:
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


def _walk(view: memoryview, at: int, end: int, order: str, depth: int, allowed: frozenset[int]) -> int:
    """Check the elements between two places, and those within matrices; returns how many there are."""
    if depth > MAX_DEPTH:
        raise ValueError("matrices within matrices without end")
    count = 0
    while at < end:
        kind, begin, stop, at = _element(view, at, end, order)
        if kind not in allowed:
            raise ValueError(f"an element of kind {kind}")
        if kind == MATRIX and stop > begin:
            _check_matrix(view, begin, stop, order, depth)
        count += 1
    return count


def _check_matrix(view: memoryview, begin: int, stop: int, order: str, depth: int) -> None:
    """Check that a matrix has the elements that its flags and its lengths announce: where one is missing, SciPy takes the next
    variable's for it."""
    kind, start, _, after = _element(view, begin, stop, order)
    if kind != FLAGS:
        raise ValueError("a matrix without its flags")
    flags = struct.unpack_from(f"{order}I", view, start)[0]
    own, two = flags & 0xFF, flags >> 11 & 1
    numeric = own in NUMERIC
    count = _walk(view, begin, stop, order, depth + 1, SIMPLE if numeric else SIMPLE | {MATRIX})
    if numeric and count < ELEMENTS.get(own, 4) + (two if own != CHAR else 0):
        raise ValueError("a matrix without its numbers")
    if own in CONTAINERS:
        kind, start, end, _ = _element(view, after, stop, order)
        lengths = struct.unpack_from(f"{order}{(end - start) // 4}i", view, start)
        if kind != 5 or math.prod(lengths) > count + MAX_EMPTY or min(lengths, default=0) < 0:
            raise ValueError("cells or structs without their values")
