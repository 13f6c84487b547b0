"""What a held-out record must be beside the records that are fitted: of their kind, and another one."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from ..errors import BadInput
from ..records import Record


def check_heldout(records: Sequence[Record], heldout: Record | None) -> None:
    """Refuse a held-out record that the fitted model does not predict; warn of one that is fitted too.

    Parameters
    ----------
    records : those that are fitted, of one kind
    heldout : the record to predict, None where there is none

    Raises
    ------
    BadInput
        It is of another kind, or measures another channel.
    """
    if heldout is None:
        return
    lead = records[0]
    words = " ".join(["t", *lead.channels])
    if any(getattr(heldout, of) != getattr(lead, of) for of in ("kind", "input_name", "observed_name")):
        raise BadInput(
            f"--heldout {heldout.path}: is a {_words(heldout)} record with t {' '.join(heldout.channels)}, and {lead.path} a "
            f"{_words(lead)} record with {words}; wanted a record of that kind with these channels"
        )
    if any(_same(heldout, record) for record in records):
        warnings.warn(
            f"--heldout {heldout.path}: is a record that is fitted too, so how well it is predicted says nothing about others",
            stacklevel=2,
        )


def _words(record: Record) -> str:
    return record.kind.replace("_", " ")


def _same(one: Record, other: Record) -> bool:
    return one.samples == other.samples and all(
        name in other.channels and np.array_equal(values, other.channels[name]) for name, values in one.channels.items()
    )
