"""Which rows of a file a record's rows are, for messages: a part of it may be used (`--from`), or every k-th row (`--despike`).

Checks count the rows that they are given. Here what they say is brought back to the rows of the file.
"""

from __future__ import annotations

import dataclasses
import re

from .finding import Finding
from .table import Table

_ROW = re.compile(r"\brows? [0-9]")


@dataclasses.dataclass(frozen=True)
class RowsUsed:
    """The rows ``first``, ``first + every``, ... (from 0) of the rows of a table."""

    table: Table
    first: int = 0
    every: int = 1

    def further(self, first: int, every: int = 1) -> RowsUsed:
        """The same after rows were left out once more: of those used so far only ``first``, ``first + every``, ..."""
        return RowsUsed(self.table, self.first + self.every * first, self.every * every)

    def place(self, row: int) -> str:
        """How a message names a row (from 0) of those used: by its row and line in the file."""
        return self.table.place(self.first + self.every * row)

    def told(self, sentence: str) -> str:
        """A sentence that names rows as they are counted here, with how to find them in the file.

        Examples
        --------
        >>> RowsUsed(Table((), "csv"), 500).told("stands out at row 12")
        'stands out at row 12 (row 1 here is row 501 of the file)'
        """
        if not _ROW.search(sentence) or (self.first, self.every) == (0, 1):
            return sentence
        steps = f", and each further one lies {self.every} rows on" if self.every > 1 else ""
        end = "." if sentence.endswith(".") else ""
        return f"{sentence.removesuffix('.')} (row 1 here is row {self.first + 1} of the file{steps}){end}"

    def said(self, findings: list[Finding]) -> list[Finding]:
        """Findings whose sentences name rows, with how to find these in the file."""
        return [dataclasses.replace(one, found=self.told(one.found)) for one in findings]
