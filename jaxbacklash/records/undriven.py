"""A motion read as a free decay while what drives it stands unread beside it: the commonest misnaming of columns there is."""

from __future__ import annotations

import numpy as np

from jaxbacklash.errors import BadInput

from .columns import Picked
from .options import ReadOptions
from .record import Record
from .roles import columns_option, numeric
from .table import Table

DECAYED = 0.5
"""Share of the first third's motion that a free decay has left at most in its last third, where nothing drives it."""
SHARED_TONES = 0.5
"""Share of the power of another column, after its own mean is taken away, that lies where the motion has most of its own."""


def undriven(record: Record, table: Table, picked: Picked, options: ReadOptions) -> None:
    """Refuse a free decay that does not decay where a column beside it moves with it.

    A user who maps the motion with `--columns` has said what is what and is believed.

    Raises
    ------
    BadInput
        With the option that takes the other column for the base motion.
    """
    if record.kind != "free_decay" or record.observed_name in options.columns:
        return
    motion = record.channels[record.observed_name]
    third = motion.size // 3
    if np.std(motion[-third:]) < DECAYED * np.std(motion[:third]):
        return
    for number, column in enumerate(table.columns):
        if number in picked.numbers.values() or not numeric(column) or column.values.size != motion.size:
            continue
        if not _moves_with(column.values, motion):
            continue
        roles = picked.numbers | {"x": number}
        option = columns_option(table, roles)
        observed = record.observed_name
        raise BadInput(
            f"{record.path}: found {observed} alone, which is read as a free decay, but it does not decay and the column "
            f"{column.name} moves with it; if that is the base motion say {option}, if it is not say "
            f"--columns {observed}={picked.channels[observed].name}.",
            remedy=option,
        )


def _moves_with(values: np.ndarray, motion: np.ndarray) -> bool:
    """Whether a column has most of its power at the frequencies at which the motion has most of its own."""
    if not np.isfinite(values).all():
        return False
    power = [np.abs(np.fft.rfft((v - v.mean()) * np.hanning(v.size)))[1:] ** 2 for v in (values, motion)]
    width = max(1, power[0].size // 200)
    bands = [p[: p.size // width * width].reshape(-1, width).sum(axis=1) for p in power]
    loud = np.argsort(bands[1])[::-1]
    most = loud[: np.searchsorted(np.cumsum(bands[1][loud]), 0.95 * bands[1].sum()) + 1]
    return bool(bands[0][most].sum() > SHARED_TONES * bands[0].sum())
