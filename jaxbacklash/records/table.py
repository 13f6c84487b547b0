"""What a file holds, before anything is taken for a channel: columns by name with the units that the file itself states.

Every reader (`text`, `formats`) returns a `Table`; `columns` picks the channels from it, `look` describes it.
"""

from __future__ import annotations

import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True, eq=False)
class Column:
    """One column of a file.

    Parameters
    ----------
    name : str
        As the file has it, stripped of blanks; "column 3" where it has none; "group/channel" where channels come in groups.
    values : array of shape (N,)
        float64 with NaN where the file holds none, or text (dtype kind "U") where it is no column of numbers.
    unit : str
        As the file states it ("deg", "ms"), in its own spelling; empty where it states none.
    clock : array of shape (N,) or None
        Times of this column's own samples [s], where the file keeps one for each channel.
    aliases : tuple of str
        Other names by which a user may ask for it: the path "signals(1).values" of a signal that is listed by its label.
    """

    name: str
    values: np.ndarray
    unit: str = ""
    clock: np.ndarray | None = None
    aliases: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True, eq=False)
class Table:
    """The columns of a file and how it was read.

    Parameters
    ----------
    columns : tuple of Column
        In the order of the file. Names may occur twice; `columns.pick` says which is taken.
    format : str
        "csv", "xlsx", "tdms", ...
    details : dict of str
        What a person would like to know of how it was read: "encoding", "separator", "decimal mark", "header line",
        "first line of values"; only those that apply.
    notes : tuple of str
        Sentences, without the file's name, about what was read in a way that could be wrong: "lines 1 to 7 above the header
        are passed over", "the row of units under the header is used". Printed as warnings.
    rate_hz : float or None
        Samples per second where the file states that beside the samples, as scopes and loggers do; None where it does not.
    first_line : int or None
        Line of the file (from 1) that holds the first row, for messages; None for files without lines.
    left_out : dict of str
        What the file holds beside its columns, by name, as the middle of a sentence ("complex values", "an array of shape
        (3, 3)"): said when somebody asks for it.
    lines : array of shape (N,) or None
        Line of the file (from 1) of each row, where rows do not follow each other line by line; None where they do.
    """

    columns: tuple[Column, ...]
    format: str
    details: dict[str, str] = dataclasses.field(default_factory=dict)
    notes: tuple[str, ...] = ()
    rate_hz: float | None = None
    first_line: int | None = None
    left_out: dict[str, str] = dataclasses.field(default_factory=dict)
    lines: np.ndarray | None = None

    @property
    def names(self) -> list[str]:
        """Names of the columns, in order."""
        return [column.name for column in self.columns]

    def called(self, name: str) -> list[Column]:
        """The columns of this name; where there are none, those that may be asked for by it too."""
        return [one for one in self.columns if one.name == name] or [one for one in self.columns if name in one.aliases]

    @property
    def rows(self) -> int:
        """Rows of the longest column."""
        return max((column.values.size for column in self.columns), default=0)

    def place(self, row: int) -> str:
        """How a message names a row (from 0): by its line where the file has lines."""
        if self.lines is not None:
            return f"row {row + 1} (line {self.lines[row]})"
        return f"row {row + 1}" if self.first_line is None else f"row {row + 1} (line {self.first_line + row})"
