"""Which file is read and how: what a person chooses on the page, the record that comes of it, and what is wrong with it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..records.description import Description, describe
from ..records.options import ReadOptions
from ..records.reader import read_record
from ..records.record import Record
from ..records.remedies import applied
from ..records.units import UNITS

CHANNELS = ("t", "x", "z", "y", "F", "T")
WORDS = {
    "t": "time", "x": "base motion", "z": "relative motion of the link", "y": "absolute motion of the link",
    "F": "force or torque on the link", "T": "transmitted force or torque",
}  # fmt: skip


@dataclass(frozen=True)
class Choice:
    """A file and how it is read; ``name`` within the folder, ``options`` as the command line has them."""

    name: str
    options: ReadOptions = field(default_factory=ReadOptions)

    def with_columns(self, columns: Mapping[str, str], units: Mapping[str, str]) -> Choice:
        """With these columns (``#2`` is the second) and units of channels in place of those chosen before."""
        chosen = {channel: column for channel, column in columns.items() if column}
        stated = {channel: unit for channel, unit in units.items() if unit and (channel in chosen or channel == "t")}
        return replace(self, options=replace(self.options, columns=chosen, units=stated))

    def with_words(self, words: str) -> Choice:
        """With further options as they are typed behind a command, such as ``--unwrap x --from 2``.

        Raises
        ------
        BadInput
            They cannot be understood.
        """
        try:
            return replace(self, options=applied(self.options, words))
        except BadInput:
            raise
        except ValueError as why:
            raise BadInput(f"{words[:100]}: {why}, wanted options of a command, such as --unwrap x") from None


@dataclass(frozen=True, eq=False)
class Opened:
    """What came of a choice.

    Attributes: ``record`` None where the file cannot be used; ``wrong`` then the sentence that says why, ``remedy`` the options
    that would mend it, empty where only a person can know; ``notes`` what is odd but usable; ``facts`` on every column.
    """

    choice: Choice
    record: Record | None
    wrong: str = ""
    remedy: str = ""
    notes: tuple[str, ...] = ()
    facts: Description | None = None


def opened(choice: Choice, path: Path) -> Opened:
    """Read the file of a choice.

    Parameters
    ----------
    choice : what was chosen
    path : where that file lies

    Returns
    -------
    `Opened`; a file that cannot be used raises nothing, and says so
    """
    kept: dict[str, Any] = {one.name: getattr(choice.options, one.name) for one in fields(ReadOptions)}
    record, wrong, remedy = None, "", ""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            record = read_record(path, **kept)
        except BadInput as why:
            wrong, remedy = _bare(str(why), path), why.remedy
        except Exception as why:  # whatever the library of a format raises: a person at a page can do nothing with a traceback
            wrong = f"{choice.name}: cannot be read ({type(why).__name__}: {' '.join(str(why).split())[:200]})"
    notes = tuple(_bare(str(one.message), path) for one in caught if issubclass(one.category, UserWarning))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            facts = describe(path, choice.options)
    except Exception:  # what is wrong has been said above
        facts = None
    return Opened(choice, record, wrong, remedy, notes, facts)


def units_of(channel: str) -> list[str]:
    """Units that a channel may be in."""
    return list(UNITS[channel])


def _bare(text: str, path: Path) -> str:
    """A sentence that names the file as the page does."""
    return text.replace(str(path), path.name)
