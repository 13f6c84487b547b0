"""Which way round a transmitted force was measured: a link can only take energy from its base, never give on balance."""

from __future__ import annotations

import warnings

import numpy as np

from .record import Record

CLEAR = 0.05
"""Share of all work done to and fro that the balance must exceed to tell the sign."""


def work_share(record: Record) -> float:
    """Work of T on the base, over all work done to and fro: -1 ... 1, negative for a joint that dissipates."""
    x, force = record.channels["x"], record.channels["T"]
    done = 0.5 * (force[1:] + force[:-1]) * np.diff(x)
    return float(np.sum(done) / max(float(np.sum(np.abs(done))), 1e-300))


def oriented(record: Record) -> Record:
    """The record with T as the force that the link exerts on its base; other kinds of record as they are.

    A load cell often shows the opposite force, of the base on the joint. Over a record the link dissipates, so the work of T on
    the base is negative; where it is clearly positive, T is turned, and a warning says so.
    """
    if record.kind != "transmitted" or work_share(record) <= CLEAR:
        return record
    warnings.warn(
        f"{record.path or 'the record'}, column T: does positive work on the base over the record, as no passive joint can; it "
        "is taken as the force of the base on the joint and turned round (--scale T=-1 says the same without this warning)",
        stacklevel=2,
    )
    return record.replace(T=-record.channels["T"])
