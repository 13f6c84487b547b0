"""The records that come with the package, for the demo, for tours and for examples."""

from __future__ import annotations

from importlib import resources

from .records import Record, read_record


def demo_records() -> tuple[Record, Record]:
    """The demo's record, and a second one of the same joint that was shaken in another way, to judge by.

    A link of 3.16 kg m^2 hangs behind a joint with play; its base is shaken, and encoders measure the base's motion ``x`` and the
    link's motion against it, ``z`` [rad], 6001 samples at 500 Hz. The base model of play, stiffness and damping lacks one effect.

    Returns
    -------
    the record to fit, and the one to keep aside

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> record.samples, sorted(record.channels)
    (6001, ['x', 'z'])
    """
    data = resources.files("jaxbacklash") / "data"
    with resources.as_file(data / "demo_train.csv") as path, resources.as_file(data / "demo_heldout.csv") as other:
        return read_record(path), read_record(other)
