"""From arrays by name to columns: what .npz, .npy, .mat, .h5 and .json files have in common."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterable, Mapping

import numpy as np

from ..checks import MIN_SAMPLES, listed, wrong
from ..header_units import split_unit
from ..table import Column, Table

MAX_CHANNELS = 256
"""A matrix with more channels than this is a picture or a map, not a record."""
RATES = frozenset(["fs", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "ratehz", "samplesps", "sr"])
PERIODS = frozenset(["dt", "ts", "sampletime", "samplingtime", "sampleperiod", "samplingperiod", "deltat", "wfincrement"])
"""Names of a single number that states the samples per second, or the seconds a sample (lower case, without marks)."""

LOWEST_RATE, HIGHEST_RATE = 1e-2, 1e9
"""A number outside of this is no rate [Hz], whatever its name: a "ts" of 1.7e9 is a date."""


class Columns:
    """Columns gathered from a file, and what was found beside them.

    Attributes
    ----------
    columns : list of Column
    left_out : dict of str
        As `Table` wants it.
    rate_hz : float or None
    notes : list of str
    """

    def __init__(self) -> None:
        self.columns: list[Column] = []
        self.left_out: dict[str, str] = {}
        self.rate_hz: float | None = None
        self.notes: list[str] = []

    def add(self, name: str, values: np.ndarray, unit: str = "", aliases: Iterable[str] = ()) -> None:
        """Take an array of any shape and kind: as a column, as several (a matrix), or as something left out.

        Parameters
        ----------
        name, unit : str
        values : array
            (N,), (N, 1) or (1, N) is one column; (N, C) or (C, N) with at least 64 samples is C columns, called
            "name/column 1" or "name/row 1"; a structured array is a column for each field, "name.field".
        aliases : iterable of str
            Other names of it.
        """
        name, aliases = tidy(name), tuple(tidy(each) for each in aliases)
        if values.dtype.names:
            for field in values.dtype.names:
                self.add(f"{name}.{field}" if name else field, values[field], unit)
            return
        if values.size < 2:
            self._constant(name, values)
            return
        if values.ndim > 2:
            values = np.squeeze(values)
        if values.dtype.kind not in "fiubMmUS":
            self.left_out[name] = "complex values" if values.dtype.kind == "c" else "objects, not numbers"
        elif values.ndim == 1 or (values.ndim == 2 and 1 in values.shape):
            self._vector(name, values.ravel(), unit, aliases)
        elif values.ndim == 2 and max(values.shape) >= MIN_SAMPLES and min(values.shape) <= MAX_CHANNELS:
            self._matrix(name, values, unit, aliases)
        else:
            self.left_out[name] = f"an array of shape {values.shape}"

    def _vector(self, name: str, values: np.ndarray, unit: str, aliases: tuple[str, ...]) -> None:
        """One value a sample."""
        if values.dtype.kind in "fiub":
            values = np.ascontiguousarray(values, dtype=np.float64)
        elif values.dtype.kind in "Mm":
            values, note = seconds(values)
            unit = "s"
            if note:
                self.notes.append(f"column {name} {note}")
        elif values.dtype.kind == "S":
            values = np.char.decode(values, "latin-1")
        name = name or f"column {len(self.columns) + 1}"
        self.columns.append(Column(name, values, unit or split_unit(name.rpartition("/")[2])[1], aliases=aliases))

    def _matrix(self, name: str, values: np.ndarray, unit: str, aliases: tuple[str, ...]) -> None:
        """Samples go along the longer side."""
        way, rows = ("row", values) if values.shape[0] < values.shape[1] else ("column", values.T)
        prefix = f"{name}/" if name else ""
        names = [f"{prefix}{way} {number + 1}" for number in range(len(rows))]
        for number, (each, row) in enumerate(zip(names, rows, strict=True), start=1):
            self._vector(each, row, unit, tuple(f"{alias}/{way} {number}" for alias in aliases))
        for each in {name, *aliases} - {""}:
            self.left_out[each] = f"a matrix of shape {values.shape}, read as the columns {listed(names, limit=6)}"

    def _constant(self, name: str, values: np.ndarray) -> None:
        """A single value is a setting, not a column; it may be the rate."""
        if not values.size:
            self.left_out[name] = "an empty array"
            return
        self.left_out[name] = f"an array of shape {values.shape}, a single value"
        if values.dtype.kind in "fiu":
            self.take_rate(name, float(values.ravel()[0]))

    def take_rate(self, name: str, value: float) -> None:
        """Take the rate from a single number, where its name says that it is one."""
        self.rate_hz = stated_rate(name, value) or self.rate_hz

    def table(self, format: str, details: Mapping[str, str] | None = None) -> Table:
        """All of it, as a reader returns it."""
        columns = with_bare_names(self.columns)
        return Table(columns, format, dict(details or {}), tuple(self.notes), self.rate_hz, left_out=dict(self.left_out))


def stated_rate(name: str, value: float) -> float | None:
    """The rate [Hz] that a single number of this name states; None where it is none."""
    plain = "".join(mark for mark in name.rpartition(".")[2].rpartition("/")[2].lower() if mark.isalnum())
    rate = value if plain in RATES else 1.0 / value if plain in PERIODS and value else 0.0
    return rate if LOWEST_RATE <= rate <= HIGHEST_RATE else None


def with_bare_names(columns: Iterable[Column]) -> tuple[Column, ...]:
    """Columns that may be asked for without their groups too ("rig/x" for "run 1/rig/x"), where no other has that name."""
    columns = tuple(columns)
    shorter = [_endings(column.name) for column in columns]
    count = Counter(name for column, names in zip(columns, shorter, strict=True) for name in (column.name, *names))
    return tuple(
        dataclasses.replace(column, aliases=(*column.aliases, *(name for name in names if count[name] == 1)))
        for column, names in zip(columns, shorter, strict=True)
    )


def _endings(name: str) -> list[str]:
    """What is left of "a/b/c" without its first groups: "b/c", "c"; a mere number is no name."""
    parts = name.split("/")
    endings = ["/".join(parts[first:]) for first in range(1, len(parts))]
    return [ending for ending in endings if not ending.isdecimal()]


def named_matrix(arrays: Mapping[str, np.ndarray], where: str) -> dict[str, np.ndarray]:
    """The arrays of a file in which one matrix has its names in an array `columns` beside it: the matrix by its names.

    Parameters
    ----------
    arrays : mapping of arrays
        Other arrays may stand beside the two; without an array `columns` all are returned as they are.
    where : str
        The file, for the sentence.

    Returns
    -------
    dict of arrays

    Raises
    ------
    BadInput
        When the names do not fit a matrix.
    """
    if "columns" not in arrays or arrays["columns"].dtype.kind not in "USOfiub":
        return dict(arrays)
    names = [text(name) for name in arrays["columns"].ravel()]
    if not all(names):
        raise wrong(f"{where}, array columns", "something other than names", "one name per column of the data")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise wrong(f"{where}, array columns", f'the name "{twice}" more than once', "each name once")
    others = {name: values for name, values in arrays.items() if name != "columns"}
    matrices = {name: values for name, values in others.items() if values.ndim == 2 and min(values.shape) > 1}
    fitting = [name for name, values in matrices.items() if len(names) in values.shape]
    if len(fitting) != 1:
        shapes = [f"{name} {values.shape}" for name, values in matrices.items()]
        found = f"{len(names)} names in columns ({listed(names)}) and the matrices {listed(shapes)}"
        raise wrong(where, found, "one matrix with a column for each name")
    matrix = others.pop(fitting[0])
    # Samples go down unless only the other way round fits.
    rows = matrix.T if matrix.shape[1] == len(names) else matrix
    table = dict(zip(names, rows, strict=True))
    twice = next((name for name in table if name in others), None)
    if twice is not None:
        raise wrong(where, f"{twice} both as an array and among the names in columns", "it once")
    return others | table


def seconds(values: np.ndarray) -> tuple[np.ndarray, str]:
    """Dates (counted from the first) or spans of time in seconds, and the end of a sentence that says so."""
    if values.dtype.kind == "M":
        known = values[~np.isnat(values)]
        first = known[0] if known.size else values[0]
        return (values - first) / np.timedelta64(1, "s"), f"holds dates: counted in seconds from the first, {first}"
    return values / np.timedelta64(1, "s"), ""


def tidy(name: str) -> str:
    """A name on one line without marks that a terminal would obey."""
    return " ".join("".join(mark if mark.isprintable() else " " for mark in name).split())


def text(name: object) -> str:
    """A name out of an array of text: bytes from C programs, padded or boxed text from MATLAB."""
    while isinstance(name, np.ndarray) and name.size == 1:
        name = name.ravel()[0]
    if isinstance(name, bytes):
        name = name.decode("latin-1")
    return tidy(name) if isinstance(name, str) else ""
