"""Read a record from a file, by the suffix of its name."""

from collections.abc import Callable, Collection, Mapping
from os import PathLike
from pathlib import Path

import numpy as np

from . import checks, time_axis
from .checks import listed, wrong
from .columns import pick, wanted_columns
from .csv_reader import read_csv
from .mat_reader import read_mat
from .npz_reader import read_npz
from .record import Record
from .resample import resampled
from .suspicions import warn_of_oddities
from .units import factors

Reader = Callable[[Path, Collection[str]], dict[str, np.ndarray]]
READERS: dict[str, Reader] = {
    **dict.fromkeys((".csv", ".txt", ".dat", ".tsv"), read_csv),
    ".npz": read_npz,
    ".mat": read_mat,
}


def read_record(
    path: str | PathLike[str],
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    scales: Mapping[str, float] | None = None,
    resample: bool | float | None = None,
) -> Record:
    """Read a record.

    Parameters
    ----------
    path : str or path
        A .csv, .txt, .dat, .tsv, .npz or .mat file.
    columns : mapping of str, optional
        Names of the file's columns by channel; a channel not named is the column of its own name.
    units : mapping of str, optional
        Units of channels that are not in s, rad (or m), N m (or N); converted. See `units.UNITS`.
    scales : mapping of float, optional
        Factors of channels.
    resample : bool or float, optional
        True makes uneven times even, at the median rate; a number is the rate wanted, Hz.

    Returns
    -------
    Record
        Warns (UserWarning) where the record is odd but usable, see `suspicions`.

    Raises
    ------
    BadInput
        When there is no such file, it cannot be read, or what it holds cannot be used.
    """
    columns, units, scales = columns or {}, units or {}, scales or {}
    where = str(path)
    table = _read_table(Path(path), wanted_columns(columns))
    found, extras = pick(table, columns, where)
    channels = {name: checks.real_vector(values, name, where) for name, values in found.items()}
    for name, factor in factors(units, scales, channels, where).items():
        channels[name] = channels[name] * factor
    t = channels.pop("t")
    # Beside the samples a file may hold settings and tables of another length; only columns are kept.
    extras = {name: values for name, values in extras.items() if values.shape == t.shape}
    confirmed = frozenset(units)
    # `True` is a number too, 1 Hz; as a rate it means the median one.
    if resample is not None and resample is not False:
        rate = None if resample is True else float(resample)
        t, channels, extras = _resampled(t, channels, extras, rate, confirmed, where)
    record = Record(t, channels, where, extras, confirmed)
    warn_of_oddities(record.channels, record.extras, where)
    return record


def _read_table(path: Path, wanted: Collection[str]) -> dict[str, np.ndarray]:
    """The columns of a file, or a sentence about why there are none."""
    reader = READERS.get(path.suffix.lower())
    where = str(path)
    try:
        if path.is_dir():
            raise wrong(where, "a folder", "a file")
        if not path.exists():
            raise wrong(where, "no such file", "a record")
        if reader is None:
            raise wrong(where, f'the suffix "{path.suffix}"', f"one of {listed(READERS)}")
        if not path.stat().st_size:
            raise wrong(where, "an empty file", "a record")
        return reader(path, wanted)
    except OSError as why:
        raise wrong(where, f"a file that cannot be read ({why.strerror or why})", "one that can") from why


def _resampled(t, channels, extras, rate, confirmed, where):
    """The record's columns on an even grid; first what the times must be for that."""
    for name, values in channels.items():
        checks.same_length(values, name, t, where)
        checks.finite(values, name, where)
    checks.finite(t, "t", where)
    checks.long_enough(t, where)
    time_axis.increasing(t, where)
    time_axis.in_seconds(t, confirmed, where)
    t, every = resampled(t, channels | {f"extra {name}": values for name, values in extras.items()}, rate, where)
    return t, {name: every[name] for name in channels}, {name: every[f"extra {name}"] for name in extras}
