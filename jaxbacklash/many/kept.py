"""The rows that are done, kept in one file as they come: a run that is stopped at any moment goes on from there.

A line a record: its key, which tells what was wanted and what was in the record, and its row. A line is written in one piece; one
that a machine's end has cut is passed over. Since a row depends on nothing but its key, a run that was stopped ends with the same
table as one that was not, and records that are added later cost only themselves.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Any

from ..errors import BadInput, NoAnswer
from .rows import Row

NAME = "rows.jsonl"
FORMAT = "jaxbacklash rows 1"


class KeptRows:
    """Rows in the file ``rows.jsonl`` of a folder, by their keys; None: in memory alone.

    Raises
    ------
    BadInput
        The file is another program's, another process writes it, or it cannot be written.
    """

    def __init__(self, folder: Path | None, keys: Iterable[str]) -> None:
        self._path = None if folder is None else folder / NAME
        self.found: dict[str, Row] = {}
        self._file: Any = None
        if self._path is None:
            return
        wanted = set(keys)
        try:
            self._file = self._path.open("a+b")
            _lock(self._file, self._path)
            self._file.seek(0)
            self._read(wanted)
        except OSError as error:
            raise BadInput(f"{self._path}: cannot be written ({error.strerror}), wanted a folder to write into") from None

    def _read(self, wanted: set[str]) -> None:
        lead, end = self._file.readline(), b"\n"
        if not lead:
            self._file.write(json.dumps({"format": FORMAT}).encode() + b"\n")
            self._file.flush()
            return
        if FORMAT.encode() not in lead:
            raise BadInput(f"{self._path}: is no file of rows of jaxbacklash; move it, or name another folder as --out")
        for line in self._file:
            end = line[-1:]
            try:
                told = json.loads(line)
                if told["key"] in wanted:
                    self.found[told["key"]] = told["row"]
            except (ValueError, KeyError, TypeError):
                continue  # cut by a machine's end: that record is worked on again
        if end != b"\n":
            self._file.write(b"\n")

    def put(self, key: str, row: Row) -> None:
        """Keep one more row.

        Raises
        ------
        NoAnswer
            It cannot be written; those before it are kept.
        """
        self.found[key] = row
        if self._file is None:
            return
        try:
            self._file.write(json.dumps({"key": key, "row": row}, allow_nan=False).encode("utf-8", "backslashreplace") + b"\n")
            self._file.flush()
        except OSError as error:
            raise NoAnswer(
                f"{self._path}: cannot be written ({error.strerror}); the rows written so far are kept, the same command goes on "
                "from there"
            ) from None

    def __enter__(self) -> KeptRows:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._file is not None:
            try:
                os.fsync(self._file.fileno())
            finally:
                self._file.close()


def _lock(file: Any, path: Path) -> None:
    """Keep other processes from writing the same file; the system lets go when this one ends, however that is."""
    try:
        import fcntl
    except ImportError:  # not Unix: nothing tells two runs apart
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise BadInput(f"{path}: another process is writing it; wait for it or name another folder") from None
    except OSError:  # a file system without locks
        return
