"""The table of many records: a row each, its parameters as columns, what changed from record to record and what stands out."""

from __future__ import annotations

import csv
import io
import os
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..frames import dataframe, needed
from ..showing import Shown
from ..whole_file import write_whole
from .courses import Course, course_of
from .rows import COMPLETE, FAILED, INCOMPLETE, Row

PLAIN = (
    "record", "verdict", "why", "samples", "rate_hz", "rms_over_noise", "median_over_noise", "nrmse", "heldout_rms_over_noise",
    "heldout_median_over_noise", "heldout_nrmse", "noise", "per_inertia", "effects", "alternatives", "intervals_hold", "notes",
)  # fmt: skip
"""Columns that no parameter is told in, in their order."""
OF_EACH = ("value", "stderr", "low", "high", "unit", "verdict", "why")
"""What is told of each parameter: ``backlash`` is its value, the others are ``backlash.stderr`` and so on."""
NAMED = 5
"""Failed records that are named where the whole is told in words."""


@dataclass(frozen=True)
class Each(Shown):
    """What was found in each of many records.

    Attributes: ``command``, ``"fit"`` or ``"refine"``; ``rows``, one a record in the order given, as plain data: ``record`` (its
    path), ``verdict`` (``complete``, ``incomplete`` or ``failed``), ``why`` in words, ``rms_over_noise`` and the other errors,
    ``effects``, and ``parameters`` by name with ``value``, ``stderr``, ``low`` and ``high`` of the 95 % interval, ``unit``,
    ``verdict``; ``translational``, whether units are of a mass that slides.
    """

    command: str
    rows: tuple[Row, ...]
    translational: bool = False

    @cached_property
    def names(self) -> tuple[str, ...]:
        """All parameters that any record has, in the order in which they appear."""
        return tuple(dict.fromkeys(name for row in self.rows for name in row["parameters"]))

    def unit(self, name: str) -> str:
        """The unit of a parameter."""
        return next(str(row["parameters"][name]["unit"]) for row in self.rows if name in row["parameters"])

    def count(self, verdict: str) -> int:
        """How many records have this verdict."""
        return Counter(row["verdict"] for row in self.rows)[verdict]

    def numbers(self, name: str, what: str = "value") -> np.ndarray:
        """``value``, ``stderr``, ``low`` or ``high`` of a parameter in each record (N,), NaN where there is none."""
        found = (row["parameters"].get(name, {}).get(what) for row in self.rows)
        return np.array([np.nan if value is None else value for value in found], dtype=float)

    @cached_property
    def courses(self) -> dict[str, Course]:
        """How each parameter goes from record to record: its trend, where it changes, and which records or joints stand out."""
        records = [str(row["record"]) for row in self.rows]
        return {
            name: course_of(name, self.unit(name), self.numbers(name), self.numbers(name, "stderr"), records)
            for name in self.names
        }

    def columns(self) -> dict[str, list[Any]]:
        """The whole table by columns: what is told of the record, then of each parameter; None where there is nothing."""
        table: dict[str, list[Any]] = {"number": list(range(1, len(self.rows) + 1))}
        for name in PLAIN:
            if any(row.get(name) not in (None, [], "") for row in self.rows):
                table[name] = [_cell(row.get(name)) for row in self.rows]
        for name in self.names:
            of = [row["parameters"].get(name, {}) for row in self.rows]
            for what in OF_EACH:
                if what in ("value", "stderr", "low", "high", "unit", "verdict") or any(what in one for one in of):
                    table[name if what == "value" else f"{name}.{what}"] = [one.get(what) for one in of]
        return table

    def to_dataframe(self) -> Any:
        """The table as a `pandas.DataFrame`, a row a record, numbered from 1."""
        return dataframe(self.columns(), "number", units={name: self.unit(name) for name in self.names}, command=self.command)

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the table: Parquet where the name ends in ``.parquet``, else CSV.

        Raises
        ------
        BadInput
            It cannot be written, or pyarrow is not installed.
        """
        target = Path(path)
        content: str | bytes
        if target.suffix == ".parquet":
            content = self._parquet()
        else:
            text = io.StringIO()
            table = self.columns()
            writer = csv.writer(text, lineterminator="\n")
            writer.writerow(table)
            writer.writerows(zip(*table.values()))
            content = text.getvalue()
        try:
            write_whole(target, content)
        except OSError as error:
            raise BadInput(f"{target}: cannot be written ({error.strerror}), wanted a folder to write into") from None
        return target

    def _parquet(self) -> bytes:
        arrow = needed("pyarrow", "a Parquet file")
        parquet = needed("pyarrow.parquet", "a Parquet file")
        sink = arrow.BufferOutputStream()
        parquet.write_table(arrow.table(self.columns()), sink)
        return bytes(sink.getvalue().to_pybytes())

    def __str__(self) -> str:
        return "\n".join([self.sentence(), *(str(course) for course in self.courses.values()), *self._failures()])

    def sentence(self) -> str:
        """How many records there are, and how they ended."""
        told = {COMPLETE: "explained to their noise", INCOMPLETE: "with something missing", FAILED: "without a result"}
        counts = ", ".join(f"{self.count(verdict)} {words}" for verdict, words in told.items() if self.count(verdict))
        return f"{len(self.rows)} records: {counts}"

    def _failures(self) -> list[str]:
        failed = [(k, row) for k, row in enumerate(self.rows, 1) if row["verdict"] == FAILED]
        lines = [f"  record {k}: {_with_name(row)}" for k, row in failed[:NAMED]]
        return lines + ([f"  and {len(failed) - NAMED} more without a result, see the table"] if len(failed) > NAMED else [])


def _with_name(row: Row) -> str:
    """Why a record has no result, with its name, which most sentences begin with."""
    return str(row["why"]) if str(row["why"]).startswith(str(row["record"])) else f"{row['record'] or 'no name'}: {row['why']}"


def _cell(value: Any) -> Any:
    """What a table can hold: of lists, one text."""
    if not isinstance(value, list):
        return value
    return "; ".join(" + ".join(one) if isinstance(one, list) else str(one) for one in value)
